"""What every script of a rule needs: its log file, its threads and one clear message when the input is bad."""

import contextlib
import logging
import os
import sys
from collections.abc import Iterator
from typing import Any

from walklab.errors import InputError


@contextlib.contextmanager
def job(snakemake: Any) -> Iterator[None]:
    """Run the body of a script: output goes to the rule's log, an InputError ends in one line."""
    if "numba" in sys.modules:
        import numba

        numba.set_num_threads(min(snakemake.threads, numba.config.NUMBA_NUM_THREADS))
    # The real standard error stays open for the one line a user must see.
    terminal = os.fdopen(os.dup(2), "w")
    with open(snakemake.log[0], "w") as log:
        os.dup2(log.fileno(), 1)
        os.dup2(log.fileno(), 2)
        logging.basicConfig(level=logging.INFO, stream=sys.stderr, format="%(levelname)s %(name)s: %(message)s")
        try:
            yield
        except InputError as error:
            for stream in (log, terminal):
                print(f"error in {snakemake.rule}: {error}", file=stream, flush=True)
            # Past this point only Snakemake speaks: a traceback would hide the message.
            os._exit(1)
