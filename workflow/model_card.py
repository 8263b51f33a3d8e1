"""Write docs/model-card.md from the cards that `make` and `make real` left beside their models.

    python workflow/model_card.py [RESULTS]

RESULTS is the folder of the runs (default: results). A run that is not there has no card in the page.
"""

import re
import sys
from pathlib import Path

from walklab.errors import InputError
from walklab.storage import read_json, write_text

ROOT = Path(__file__).parents[1]
PAGE = ROOT / "docs/model-card.md"
RUNS = {"steering": "make", "cmu": "make real"}  # what makes each
INTRODUCTION = """# Model cards

<!-- Written by `make model-card`; edit src/walklab/runs/card.py or workflow/model_card.py instead. -->

One card for each model that is saved by {makers}, as the run leaves it in `results/<run>/model_card.md`;
`make model-card` puts them here. Models of other runs have such a card too, but not on this page. The scores are of one run,
`steering` on the synthetic population on which the models were designed: how they fare on others, and how sure that is,
is in [evidence](evidence.md).
"""


def section(folder: Path) -> str:
    """The card of a finished run as a section of the page, with the commit it is of."""
    record = read_json(folder / "run.json")["commit"]
    commit = f"commit `{record['id'][:12]}`{' with local changes' if record['dirty'] else ''}" if record else "no commit known"
    title, body = (folder / "model_card.md").read_text().split("\n", 1)
    body = re.sub("^#", "##", body, flags=re.MULTILINE).replace("docs/privacy.md", "[privacy](privacy.md)")
    name = title.removeprefix("# Model card: ")
    return f"## {name}\n\nFrom `{RUNS[folder.name]}`, {commit}: `results/{folder.name}/model.safetensors`.\n{body}"


def page(results: Path) -> str:
    """The whole page.

    Raises
    ------
    InputError
        If no run has left a card.
    """
    found = [run for run in RUNS if (results / run / "model_card.md").is_file()]
    if not found:
        raise InputError(f"{results}: no run with a model card in it; run {' or '.join(RUNS.values())} first")
    makers = " and ".join(f"`{RUNS[run]}`" for run in found)
    return "\n".join([INTRODUCTION.format(makers=makers), *(section(results / run) for run in found)])


if __name__ == "__main__":
    try:
        write_text(page(Path(sys.argv[1] if len(sys.argv) > 1 else ROOT / "results")), PAGE)
    except InputError as error:
        sys.exit(str(error))
