"""What every script of a rule needs: its log, its threads, checksums, its cost, one clear message when something is wrong."""

import contextlib
import errno
import logging
import os
import sys
from collections.abc import Iterator
from pathlib import Path
from typing import Any

from walklab.errors import InputError
from walklab.runs import checksums, cost

# What a user can put right; the job has left nothing half-written.
REMEDIES = {
    errno.ENOSPC: "free some space, then start the same run again",
    errno.EDQUOT: "free some space, then start the same run again",
    errno.EROFS: "make the folder writable, then start the same run again",
    errno.EACCES: "make the file accessible, then start the same run again",
}


@contextlib.contextmanager
def job(snakemake: Any) -> Iterator[None]:
    """Run the body of a script: output goes to the rule's log, an InputError ends in one line."""
    if "numba" in sys.modules:
        import numba

        numba.set_num_threads(min(snakemake.threads, numba.config.NUMBA_NUM_THREADS))
    # The real standard error stays open for the one line a user must see.
    terminal = os.fdopen(os.dup(2), "w")
    try:
        with open(snakemake.log[0], "w") as log:
            os.dup2(log.fileno(), 1)
            os.dup2(log.fileno(), 2)
            logging.basicConfig(level=logging.INFO, stream=sys.stderr, format="%(levelname)s %(name)s: %(message)s")
            checksums.verify(snakemake.input)
            yield
            folder = Path(snakemake.log[0]).parent
            checksums.record(snakemake.output, folder)
            cost.write(folder)
    except InputError as error:
        _stop(f"error in {snakemake.rule}: {error}", terminal, snakemake.log[0])
    except OSError as error:
        if error.errno not in REMEDIES:
            raise
        _stop(f"error in {snakemake.rule}: {' '.join(str(error).split())}; {REMEDIES[error.errno]}", terminal, snakemake.log[0])


def _stop(message: str, terminal: Any, log: str) -> None:
    """Say it in the terminal and the log, and end the job."""
    print(message, file=terminal, flush=True)
    # The log may be on the disk that is full.
    with contextlib.suppress(OSError), open(log, "a") as file:
        print(message, file=file)
    # Past this point only Snakemake speaks: a traceback would hide the message.
    os._exit(1)
