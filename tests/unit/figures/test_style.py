"""Style and saving."""

from __future__ import annotations

import re
from pathlib import Path

import matplotlib
import numpy as np
import pandas as pd
import pytest
from figure_inputs import FIGURES
from matplotlib.colors import to_rgb

from walklab.errors import InputError
from walklab.figures import style
from walklab.figures.tables import number


def test_text_stays_text_and_nothing_tells_the_date(tmp_path: Path) -> None:
    style.save(FIGURES["fig13"](), tmp_path / "a.svg", tmp_path / "a.png")
    svg = (tmp_path / "a.svg").read_text()
    assert ">without length</text>" in svg
    assert "<dc:date>" not in svg
    assert matplotlib.__version__ not in re.sub(r"<dc:format>.*", "", svg)
    assert b"Software" not in (tmp_path / "a.png").read_bytes()


def test_a_failed_save_leaves_no_file(tmp_path: Path) -> None:
    figure = FIGURES["fig13"]()
    figure.axes[0].set_xlabel("$\\broken{$")
    with pytest.raises(ValueError, match="broken"):
        style.save(figure, tmp_path / "a.svg", tmp_path / "a.png")
    assert list(tmp_path.iterdir()) == []


def test_the_callers_settings_change_nothing_and_are_kept(tmp_path: Path) -> None:
    style.save(FIGURES["fig14"](), tmp_path / "a.svg", tmp_path / "a.png")
    with matplotlib.rc_context({"font.size": 20, "svg.fonttype": "path", "axes.grid": True, "lines.linewidth": 9}):
        style.save(FIGURES["fig14"](), tmp_path / "b.svg", tmp_path / "b.png")
        assert matplotlib.rcParams["font.size"] == 20
    assert (tmp_path / "a.svg").read_bytes() == (tmp_path / "b.svg").read_bytes()


def test_models_data_sets_and_published_can_be_told_apart() -> None:
    hues = [*style.MODEL_COLOURS.values(), *style.SET_COLOURS[:3], style.PUBLISHED]
    # Red-green blindness (Vienot et al. 1999): the red and the green channel are seen as one mixture.
    seen = np.array([[0.3 * r + 0.7 * g, b] for r, g, b in map(to_rgb, hues)])
    for i in range(len(style.MODEL_COLOURS)):
        for j in range(i):
            assert np.linalg.norm(seen[i] - seen[j]) > 0.1, (hues[i], hues[j])
    assert len(set(hues)) == len(hues)


def test_variants_have_their_models_colour() -> None:
    assert style.colour("P_Prob without dependencies") == style.colour("P_Prob") == style.MODEL_COLOURS["P_Prob"]
    assert style.colour("climatology") not in style.MODEL_COLOURS.values()
    assert style.model_label("P_Prob without dependencies") == "$P_{Prob}$ without dependencies"
    assert style.ordered_models(["regression", "P_Prob", "P_Stat"]) == ["P_Stat", "P_Prob", "regression"]


@pytest.mark.parametrize(
    ("name", "unit", "label"),
    [("v", "m/s", r"$\mathit{v}$ (m/s)"), ("a", "m/s2", r"$\mathit{a}$ (m/s²)"), ("a", "m/s²", r"$\mathit{a}$ (m/s²)"),
     ("omega", "1/m", r"$\mathit{\omega}$ (1/m)"), ("start_speed", "m/s", "start speed (m/s)")],
)  # fmt: skip
def test_quantities_are_set_with_their_units(name: str, unit: str, label: str) -> None:
    assert style.quantity(name, unit) == label


def test_a_missing_column_is_named() -> None:
    with pytest.raises(InputError, match="figure: the table lacks column 'b'"):
        style.require(pd.DataFrame({"a": [1.0]}), ["a"], "figure", ["b"])


def test_spread_points_keep_apart() -> None:
    places = style.spread(20, 1.0)
    assert np.abs(places).max() <= 0.5
    assert np.diff(np.sort(places)).min() > 0.02


def test_numbers_of_a_table() -> None:
    assert [number(v) for v in (np.nan, None, 1e-9, 0.0, 0.1234, 12, "x")] == ["–", "–", "< 0.001", "0.000", "0.123", "12", "x"]
