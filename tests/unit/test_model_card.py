"""docs/model-card.md is made of the cards of runs: their words, one heading lower, with the commit of each."""

import json
from pathlib import Path
from types import ModuleType

import pytest
from loading import module_at

from walklab.errors import InputError

ROOT = Path(__file__).parents[2]
CARD = "# Model card: {name}\n\n## How it scored\n\n0.267 of {name}\n\nSee docs/privacy.md.\n"


@pytest.fixture(scope="module")
def cards() -> ModuleType:
    return module_at(ROOT / "workflow/model_card.py")


def leave(folder: Path, commit: dict) -> None:
    folder.mkdir()
    (folder / "model_card.md").write_text(CARD.format(name=folder.name))
    (folder / "run.json").write_text(json.dumps({"commit": commit}))


def test_every_card_is_a_section_with_its_commit(cards, tmp_path):
    leave(tmp_path / "steering", {"id": "0123456789abcdef", "dirty": False})
    leave(tmp_path / "cmu", {"id": "fedcba9876543210", "dirty": True})
    text = cards.page(tmp_path)
    synthetic, real = text.split("\n## ")[1:]
    assert synthetic.startswith("steering\n\nFrom `make`, commit `0123456789ab`: ")
    assert "### How it scored\n\n0.267 of steering" in synthetic
    assert real.startswith("cmu\n\nFrom `make real`, commit `fedcba987654` with local changes: ")
    assert "[privacy](privacy.md)" in real
    assert text.count("\n# ") == 0, "one title"


def test_a_run_that_is_not_there_is_left_out(cards, tmp_path):
    leave(tmp_path / "steering", {})
    text = cards.page(tmp_path)
    assert "no commit known" in text
    assert "make real" not in text


def test_without_any_run_it_is_said_what_to_run(cards, tmp_path):
    with pytest.raises(InputError, match="run make or make real first"):
        cards.page(tmp_path)


def test_the_page_has_the_card_of_the_study(cards):
    assert "\n## steering\n\nFrom `make`, commit `" in cards.PAGE.read_text()
