"""Libraries without the parts that only cost time."""

from __future__ import annotations

import sys
from collections.abc import Iterator
from contextlib import contextmanager


@contextmanager
def without(*modules: str) -> Iterator[None]:
    """Within it, importing these modules raises ImportError, as if they were not installed; what is loaded already stays.

    For libraries that do without them: a run is some fifty processes, each of which pays for every import.
    """
    absent = [name for name in modules if name not in sys.modules]
    sys.modules.update(dict.fromkeys(absent))  # type: ignore[arg-type]  # None is how Python marks what must not be imported
    try:
        yield
    finally:
        for name in absent:
            del sys.modules[name]
