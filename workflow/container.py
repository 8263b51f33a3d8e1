"""Write the Containerfile from the lock file, or with --check say whether it is up to date.

The image holds what ``make`` would set up: the locked packages and walklab. The digest of the lock file is in it, so that an
image tells which lock it was built from.
"""

import hashlib
import re
import sys
from pathlib import Path

from walklab.storage import write_text

ROOT = Path(__file__).resolve().parent.parent
TARGET = ROOT / "Containerfile"

TEMPLATE = """# Generated from requirements.lock by `make container`. Build: docs/reuse.md, "In a container"
# Run: podman run --rm -v "$PWD/results:/walklab/results" walklab
FROM docker.io/library/python:{python}-slim-bookworm
LABEL org.opencontainers.image.title="walklab" \\
      org.opencontainers.image.licenses="MIT" \\
      walklab.lock.sha256="{digest}"
WORKDIR /walklab
COPY requirements.lock .
RUN python -m pip install --no-cache-dir --require-hashes -r requirements.lock
COPY . .
RUN python -m pip install --no-cache-dir --no-deps --no-build-isolation -e . && chmod -R a+rwX /walklab
# Jobs compile their kernels on first use; the cache must be writable for whoever runs the image.
ENV NUMBA_CACHE_DIR=/tmp/numba
# The image has neither git nor the history: run.json tells the commit that is given here. Last, so that nothing is built again.
ARG WALKLAB_COMMIT
ARG WALKLAB_DIRTY
ENV WALKLAB_COMMIT=$WALKLAB_COMMIT WALKLAB_DIRTY=$WALKLAB_DIRTY
LABEL org.opencontainers.image.revision=$WALKLAB_COMMIT
ENTRYPOINT ["snakemake"]
CMD ["--cores", "all"]
"""


def containerfile(lock: bytes, python: str) -> str:
    """The text of the Containerfile."""
    return TEMPLATE.format(python=python, digest=hashlib.sha256(lock).hexdigest())


def python_version(project: str) -> str:
    """The lowest Python that the project allows, which the lock file was resolved for."""
    return re.search(r'requires-python = ">=([\d.]+)"', project)[1]


if __name__ == "__main__":
    text = containerfile((ROOT / "requirements.lock").read_bytes(), python_version((ROOT / "pyproject.toml").read_text()))
    if "--check" not in sys.argv:
        write_text(text, TARGET)
    elif not TARGET.is_file() or TARGET.read_text() != text:
        sys.exit("Containerfile is not what requirements.lock says; run make container")
