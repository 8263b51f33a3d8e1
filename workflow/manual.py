"""Write the generated pages, or with --check say which are out of date."""

import sys
from pathlib import Path

from data_dictionary import data_dictionary
from walklab.configuration import load_schema, manual
from walklab.storage import write_text

ROOT = Path(__file__).resolve().parent.parent


def pages() -> dict[Path, str]:
    """Every generated page with its text."""
    return {
        ROOT / "config/README.md": manual(load_schema(ROOT / "workflow/schemas/config.schema.yaml")),
        ROOT / "docs/data.md": data_dictionary(),
    }


if __name__ == "__main__":
    for target, text in pages().items():
        if "--check" not in sys.argv:
            write_text(text, target)
        elif not target.is_file() or target.read_text() != text:
            sys.exit(f"{target.relative_to(ROOT)} is not what the schemas say; run make manual")
