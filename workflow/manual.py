"""Write config/README.md from the schema, or with --check say whether it is up to date."""

import sys
from pathlib import Path

from walklab.configuration import load_schema, manual
from walklab.storage import write_text

ROOT = Path(__file__).resolve().parent.parent
TARGET = ROOT / "config/README.md"

if __name__ == "__main__":
    text = manual(load_schema(ROOT / "workflow/schemas/config.schema.yaml"))
    if "--check" not in sys.argv:
        write_text(text, TARGET)
    elif not TARGET.is_file() or TARGET.read_text() != text:
        sys.exit("config/README.md is not what the schema says; run make manual")
