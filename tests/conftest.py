"""What all tests share."""

import os
from pathlib import Path

from walklab.code_digest import source_digest

ROOT = Path(__file__).parents[1]

# Before any kernel is imported: see source_digest for why the cache is keyed by the sources.
os.environ["NUMBA_CACHE_DIR"] = str(ROOT / ".snakemake/numba" / source_digest(ROOT / "src/walklab"))
os.environ.setdefault("WALKLAB_DATA", str(ROOT.parent / "shared/data"))
