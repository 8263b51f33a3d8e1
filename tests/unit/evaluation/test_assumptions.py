"""Which comments count as assumptions."""

from pathlib import Path

import pytest

from walklab.errors import InputError
from walklab.evaluation.assumptions import list_assumptions

PYTHON = '''"""A module."""

# ASSUME: The first one runs over
# two lines.
VALUE = 1

TEXT = """
# ASSUME: no comment, but a string
"""


def function() -> int:
    # ASSUME: The second.
    # ASSUME: The third, directly below.
    #
    # A comment after an empty comment line is another one.
    return 3  # ASSUME: The fourth, behind code.
'''


def test_assumptions_of_code_and_configuration_are_found_with_their_lines(tmp_path: Path) -> None:
    code, config = tmp_path / "src" / "walklab", tmp_path / "config" / "scenes"
    code.mkdir(parents=True)
    config.mkdir(parents=True)
    (code / "module.py").write_text(PYTHON)
    (config / "plan.yaml").write_text("# ASSUME: The car is 4.5 m long,\n# which figure 10 does not say.\nbox: [0, 0, 4, 2]\n")
    (config / "notes.txt").write_text("# ASSUME: not read\n")
    table = list_assumptions(tmp_path)
    assert table.values.tolist() == [
        ["config/scenes/plan.yaml", 1, "The car is 4.5 m long, which figure 10 does not say."],
        ["src/walklab/module.py", 3, "The first one runs over two lines."],
        ["src/walklab/module.py", 13, "The second."],
        ["src/walklab/module.py", 14, "The third, directly below."],
        ["src/walklab/module.py", 17, "The fourth, behind code."],
    ]


def test_this_checkout_states_assumptions_in_full_sentences() -> None:
    table = list_assumptions(Path(__file__).parents[3])
    own = table[table["file"].str.startswith("src/walklab/evaluation/")]
    assert len(own) >= 4
    assert own["text"].str.endswith(".").all()


def test_a_folder_that_is_no_checkout_is_refused(tmp_path: Path) -> None:
    with pytest.raises(InputError, match="has none of the folders src/walklab, workflow, config"):
        list_assumptions(tmp_path)
