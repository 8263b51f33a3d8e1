"""Published figures, as the figure scripts draw them beside ours."""

from pathlib import Path
from typing import Any

import yaml


def published(path: str) -> tuple[dict[str, Any], dict[str, Any]]:
    """The ``inputs`` and the ``claims`` of a paper."""
    paper = whole_paper(path)
    return paper["inputs"], paper["claims"]


def whole_paper(path: str) -> dict[str, Any]:
    """Everything that is noted of a paper."""
    return yaml.safe_load(Path(path).read_text())
