"""What holds for every figure: units, sizes, nothing cut off, the same bytes twice, no blank pictures."""

from __future__ import annotations

import re
from collections.abc import Callable
from pathlib import Path

import figure_inputs as inputs
import numpy as np
import pandas as pd
import pytest
from figure_inputs import FIGURES
from matplotlib.axes import Axes
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.colors import to_hex, to_rgba
from matplotlib.figure import Figure
from matplotlib.text import Text

from walklab.errors import InputError
from walklab.figures import (
    blending,
    capture,
    claims,
    comparison,
    evaluation,
    forecasts,
    maps,
    multiverse,
    real,
    realism,
    recovery,
    replicates,
)
from walklab.figures.style import DOUBLE_MM, MODEL_COLOURS, PNG_DPI, SINGLE_MM, colour, save, style

every_figure = pytest.mark.parametrize("draw", FIGURES.values(), ids=FIGURES)


def label_of(ax: Axes, name: str) -> str:
    """The label of an axis: its own, that of axes which share it, or that of the whole (sub)figure."""
    sharing = getattr(ax, f"get_shared_{name}_axes")().get_siblings(ax) if name != "z" else [ax]
    own = [getattr(other, f"get_{name}label")() for other in sharing]
    return next((text for text in own if text), getattr(ax.get_figure(), f"get_sup{name}label", str)())


def numbered(ax: Axes, name: str) -> bool:
    """Whether numbers are drawn at the axis; names need no label."""
    ticks = getattr(ax, f"{name}axis").get_major_ticks()
    texts = [tick.label1.get_text() for tick in ticks if tick.label1.get_visible()]
    return any(re.fullmatch(r"[-\u2212]?[\d.]+", text) for text in texts)


def labelled(ax: Axes, label: str) -> np.ndarray:
    """Data of all lines of this label, (n, 2)."""
    found = [line.get_xydata() for line in ax.get_lines() if str(line.get_label()).startswith(label)]
    return np.concatenate(found) if found else np.empty((0, 2))


@every_figure
def test_axes_have_labels_with_units(draw: Callable[[], Figure]) -> None:
    figure = draw()
    assert isinstance(figure, Figure)
    with style():
        figure.draw_without_rendering()
    axes = [(ax, name) for ax in figure.axes if ax.axison for name in "xyz" if hasattr(ax, f"{name}axis")]
    own = [text for ax, name in axes if (text := getattr(ax, f"get_{name}label")())]
    of_numbers = {(ax.get_title(loc="left"), name): label_of(ax, name) for ax, name in axes if numbered(ax, name)}
    assert of_numbers
    assert [place for place, text in of_numbers.items() if not text] == []
    assert [text for text in [*own, *of_numbers.values()] if not re.search(r"\([^()]+\)", text)] == []


@every_figure
def test_fits_a_column_and_cuts_nothing_off(draw: Callable[[], Figure], monkeypatch: pytest.MonkeyPatch) -> None:
    figure = draw()
    width_mm = figure.get_size_inches()[0] * 25.4
    assert min(abs(width_mm - SINGLE_MM), abs(width_mm - DOUBLE_MM)) < 0.01
    nothing_is_cut_off(figure, monkeypatch)


def nothing_is_cut_off(figure: Figure, monkeypatch: pytest.MonkeyPatch) -> None:
    figure.set_dpi(PNG_DPI)  # as it is saved: letters may be wider there than where the figure was laid out
    drawn: list[Text] = []  # matplotlib also keeps tick labels that it does not draw
    original = Text.draw
    monkeypatch.setattr(Text, "draw", lambda text, renderer: (drawn.append(text), original(text, renderer)))
    canvas = FigureCanvasAgg(figure)
    with style():
        canvas.draw()
    frame = figure.bbox
    texts = [text for text in drawn if text.get_visible() and text.get_text().strip()]
    assert texts
    for text in texts:
        box = text.get_window_extent(canvas.get_renderer())
        inside = box.x0 > frame.x0 - 1 and box.x1 < frame.x1 + 1 and box.y0 > frame.y0 - 1 and box.y1 < frame.y1 + 1
        assert inside, f"{text.get_text()!r} leaves the figure"
        assert text.get_fontsize() >= 6, f"{text.get_text()!r} is too small to read"


def test_a_comparison_of_runs_shows_what_moved_and_cuts_nothing_off(monkeypatch: pytest.MonkeyPatch) -> None:
    models = ["P_Stat", "regression"]
    scores = pd.DataFrame({"measure": "crps_s", "model": models, "scenario": "scenario_1", "participant": ""})
    scores = scores.assign(before=0.2, after=[0.2, 0.3], difference=[0.0, 0.1])
    verdicts = pd.DataFrame({"verdict_before": ["reproduced", "partly"], "verdict_after": ["not reproduced", "partly"]})
    cost = pd.DataFrame({"stage": ["simulate_trials", "score_maps"], "before": [80.0, 20.0], "after": [70.0, 30.0]})
    names = ("results/steering", "results/small")
    figure = comparison.draw_comparison(verdicts, scores, cost, names)
    nothing_is_cut_off(figure, monkeypatch)
    assert [text.get_text() for text in figure.axes[1].get_yticklabels()] == ["regression scenario 1"]
    long = comparison.draw_comparison(verdicts, scores, cost, tuple(f"results/{'long_' * 20}{name}" for name in names))
    nothing_is_cut_off(long, monkeypatch)
    dots = {str(line.get_color()) for ax in figure.axes[1:] for line in ax.get_lines()}
    assert len(dots) == 2
    assert not dots & set(MODEL_COLOURS.values())
    still = comparison.draw_comparison(verdicts, scores.iloc[:1], cost, names)
    assert [text.get_text() for text in still.axes[1].texts] == ["no forecast moved"]


@every_figure
def test_drawn_twice_gives_the_same_bytes(draw: Callable[[], Figure], tmp_path: Path) -> None:
    for name in ("first", "second"):
        save(draw(), tmp_path / f"{name}.svg", tmp_path / f"{name}.png", dpi=80)
    for suffix in ("svg", "png"):
        assert (tmp_path / f"first.{suffix}").read_bytes() == (tmp_path / f"second.{suffix}").read_bytes()


def test_every_model_has_its_colour_in_every_figure() -> None:
    papers = ("Ref", "P_Stat", "P_Adapt", "P_Prob")
    used: dict[str, set[str]] = {name: set() for name in MODEL_COLOURS}
    fig11, fig15, fig10, scores = (FIGURES[name]() for name in ("fig11", "fig15", "fig10", "scores"))
    for ax, name in zip(fig11.axes, ("P_Stat", "P_Adapt", "P_Prob"), strict=False):
        used[name] |= {to_hex(patch.get_facecolor()).upper() for patch in ax.patches}
    ticks = [text.get_text() for text in fig15.axes[0].get_xticklabels()]
    boxes = {round(np.mean(p.get_path().vertices[:4, 0])): to_hex(p.get_facecolor()).upper() for p in fig15.axes[0].patches}
    used["P_Prob"].add(boxes[ticks.index("$P_{Prob}$\n(literal)")])
    lines = [line for line in fig10.axes[0].get_lines() if line.get_marker() == "None"]
    for line, name in zip(lines, papers, strict=True):
        used[name].add(to_hex(line.get_color()).upper())
    means = [line for line in scores.axes[0].get_lines() if line.get_marker() == "D"]
    for line, name in zip(means, ("P_Stat", "P_Prob"), strict=False):
        used[name].add(to_hex(line.get_markerfacecolor()).upper())
    rows = [line for line in FIGURES["forecast_scores"]().axes[0].get_lines() if line.get_marker() == "None"]
    used["P_Prob (calibrated)"] |= {to_hex(row.get_color()).upper() for row in rows if 0.5 < row.get_ydata()[0] < 1.5}
    used["P_Prob (extended)"].add(str(colour("P_Prob (extended), earlier walks")).upper())  # a variant has its model's
    assert used == {name: {hue} for name, hue in MODEL_COLOURS.items()}


def test_in_the_recovery_only_the_model_itself_has_a_models_colour() -> None:
    assert {name for name, (hue, _) in recovery.LINES.items() if hue in MODEL_COLOURS.values()} == {"P_Prob (literal)"}


def test_published_markers_stand_at_the_values_passed_in() -> None:
    bottom = FIGURES["fig03"]().axes[1]
    assert labelled(bottom, "published").tolist() == [[2.0, 75.0], [4.0, 95.0]]
    medians = sorted(labelled(FIGURES["fig11"]().axes[3], "published")[:, 0])
    assert medians == pytest.approx([0.45, 0.45, 0.51, 0.51])  # two ends of the median line of each box
    assert labelled(FIGURES["fig13"]().axes[0], "published")[:, 0].tolist() == list(inputs.PUBLISHED_ABLATIONS.values())
    top, bottom = FIGURES["fig14"]().axes
    assert labelled(top, "published")[:, 1].tolist() == list(inputs.PUBLISHED_ERROR_OF_K.values())
    assert labelled(bottom, "published")[:, 1].tolist() == list(inputs.PUBLISHED_MS.values())
    long = FIGURES["fig15"]().axes[0]
    assert labelled(long, "published")[:, 1].tolist() == [6.31, 6.4]
    bars = [line.get_ydata() for line in long.get_lines() if line.get_linewidth() == 1.0 and len(line.get_ydata()) == 2]
    assert [6.31 - 0.27, 6.31 + 0.27] in [pytest.approx(list(bar)) for bar in bars]


def test_published_markers_are_hollow() -> None:
    for name in ("fig03", "fig13", "fig14", "fig15"):
        for ax in FIGURES[name]().axes:
            for line in ax.get_lines():
                if str(line.get_label()).startswith("published"):
                    assert to_rgba(line.get_markerfacecolor()) == to_rgba("white")


def test_our_values_stand_where_they_belong() -> None:
    assert labelled(FIGURES["fig13"]().axes[0], "P_Prob (calibrated)")[:, 0].tolist() == [0.5, 0.52, 0.7]
    assert labelled(FIGURES["fig14"]().axes[1], "ours")[:, 1].tolist() == [0.01, 0.05]
    ratio, beyond = labelled(FIGURES["claims"]().axes[0], "ours")
    assert ratio.tolist() == pytest.approx([0.6 / 0.5, 0])
    assert beyond.tolist() == pytest.approx([1 / claims.REACH, 1])  # 0.05 of 38.4 lies left of the axis


def test_a_claim_in_words_has_a_verdict_but_no_ratio() -> None:
    only_words = inputs.claim_rows().iloc[2:]
    ax = claims.fig_claims(only_words).axes[0]
    assert len(labelled(ax, "ours")) == 0
    assert any(line.get_marker() == "^" for line in ax.get_lines())


def test_a_counted_claim_stands_at_its_share_and_one_that_was_never_checked_is_not_drawn() -> None:
    ax = replicates.fig_counted_claims(inputs.counted_claims()).axes[0]
    points = [tuple(line.get_xydata()[0]) for line in ax.get_lines() if line.get_marker() != "None"]
    assert sorted(x for x, _ in points) == [0.15, 0.75, 1.0]
    assert [text.get_text().split("  ")[1] for text in ax.get_yticklabels()] == ["a median", "a statement"]


@pytest.mark.parametrize("axes", [2, 4])
def test_maps_over_two_or_four_parameters_are_drawn(axes: int) -> None:
    base = inputs.space().axes[0]
    space = type(inputs.space())(tuple(type(base)(name, "m/s", base.values) for name in ("v", "a", "omega", "b")[:axes]))
    grid = np.random.default_rng(0).random(space.shape)
    assert len(maps.fig05(grid, space).axes) == {2: 2, 4: 5}[axes]
    assert maps.fig08([grid.ravel()], [1.0], space, 0.0, 1.8).axes
    for dependencies in (1, 2, 4):
        names, units = tuple("klmn")[:dependencies], ("m",) * dependencies
        vectors = np.random.default_rng(1).random((9, dependencies))
        assert blending.fig06(vectors, np.arange(9) > 4, names, units, {3: grid}, space).axes


def test_the_slice_goes_through_the_best_cell() -> None:
    grid = inputs.suitability()
    best = np.unravel_index(np.argmax(grid), grid.shape)
    values = np.array(inputs.space().axes[0].values)
    for ax, pair in zip(maps.fig05(grid, inputs.space()).axes[1:4], ((0, 1), (0, 2), (1, 2)), strict=True):
        ring = ax.get_lines()[0].get_xydata()[0]
        assert ring.tolist() == pytest.approx([values[best[pair[0]]], values[best[pair[1]]]])
        shown = np.asarray(ax.collections[0].get_array()).reshape(4, 4).T
        assert shown[best[pair[0]], best[pair[1]]] == grid.max()


def without_values(frame: pd.DataFrame) -> pd.DataFrame:
    """The same table with every number missing."""
    return frame.assign(**dict.fromkeys(frame.select_dtypes("number").columns, np.nan))


BLANK: dict[str, Callable[[Callable[[pd.DataFrame], pd.DataFrame]], Figure]] = {
    "fig03": lambda empty: capture.fig03(empty(inputs.classes())),
    "fig04": lambda empty: capture.fig04(inputs.walks(), empty(inputs.samples()), {}),
    "dependency_clouds": lambda empty: blending.dependency_clouds(
        empty(inputs.clouds()), inputs.clouds(), {}, dict(zip(inputs.NAMES, inputs.UNITS, strict=True))
    ),
    "fig10": lambda empty: capture.fig10({"s": inputs.plan("s")}, {"s": empty(inputs.samples())}, {"s": inputs.simulated()}),
    "fig11": lambda empty: evaluation.fig11(empty(inputs.trials()), inputs.description(), inputs.pairs(), {}),
    "fig12": lambda empty: evaluation.fig12(inputs.trials(), empty(inputs.description()), inputs.pairs(), {}),
    "fig13": lambda empty: evaluation.fig13(empty(inputs.ablations()), {}),
    "fig14": lambda empty: evaluation.fig14(empty(inputs.sweep()), inputs.timings(), {}, {}),
    "fig15": lambda empty: evaluation.fig15(empty(inputs.long_times()), inputs.long_published()),
    "scores": lambda empty: real.fig_scores(empty(inputs.scores()), inputs.summary()),
    "forecast_scores": lambda empty: forecasts.fig_forecast_scores(empty(inputs.forecast_scores())),
    "calibration": lambda empty: forecasts.fig_calibration(empty(inputs.calibration()), inputs.forecast_scores()),
    "pit": lambda empty: forecasts.fig_pit(empty(inputs.calibration())),
    "replicated_claims": lambda empty: replicates.fig_counted_claims(empty(inputs.counted_claims())),
    "replicated_scores": lambda empty: replicates.fig_pooled_scores(empty(inputs.pooled_scores())),
    "recovery": lambda empty: recovery.fig_recovery(inputs.recovered(), empty(inputs.recovered_densities())),
    "specification_curve": lambda empty: multiverse.fig_specification_curve(
        empty(inputs.effects()), inputs.listed(), ["scenario_1", "scenario_2"]
    ),
}


@pytest.mark.parametrize("name", BLANK)
@pytest.mark.parametrize("empty", [lambda frame: frame.iloc[:0], without_values], ids=["no rows", "only NaN"])
def test_nothing_to_draw_is_an_error_not_a_blank_figure(name: str, empty: Callable[[pd.DataFrame], pd.DataFrame]) -> None:
    with pytest.raises(InputError, match=r"^\w+: .+") as caught:
        BLANK[name](empty)
    assert "\n" not in str(caught.value)


def test_a_map_without_values_or_of_another_space_is_an_error() -> None:
    with pytest.raises(InputError, match="no finite value"):
        maps.fig05(np.full(inputs.space().shape, np.nan), inputs.space())
    with pytest.raises(InputError, match="cells"):
        maps.fig05(np.ones(7), inputs.space())
    with pytest.raises(InputError, match="no rows"):
        claims.fig_claims(inputs.claim_rows().iloc[:0])


def test_long_distances_of_two_splits_are_not_mixed() -> None:
    times = pd.concat([inputs.long_times().assign(split=split) for split in ("repetition", "participant")])
    with pytest.raises(InputError, match="splits"):
        evaluation.fig15(times, inputs.long_published())


def test_walks_beyond_the_axis_are_counted() -> None:
    late = inputs.trials()
    late.loc[0, "abs_dt_s"] = 500.0
    figure = evaluation.fig11(late, inputs.description(), inputs.pairs(), {})
    notes = [text.get_text() for text in figure.axes[0].texts]
    assert figure.axes[0].get_xlim()[1] < 10
    beyond = int((late.loc[late["model"] == "P_Stat", "abs_dt_s"] > figure.axes[0].get_xlim()[1]).sum())
    assert beyond >= 1
    assert any(f"{beyond} beyond the axis" in note for note in notes)


def test_speeds_beyond_the_axis_are_counted_and_profiles_stand_where_they_were_measured() -> None:
    values = inputs.realism_values()
    peaks = values["quantity"] == "peak_speed"
    values.loc[peaks, "value"] = [5.0, 2.7, *[1.0] * (peaks.sum() - 2)]
    figure = realism.fig_realism(values)
    assert figure.axes[3].get_title(loc="left").endswith("2 beyond 2.6 m/s")
    start = figure.axes[7].get_lines()[1].get_xydata()
    np.testing.assert_allclose(start, [[0, 0.2], [0.5, 0.6], [1, 1.0]])


def test_walks_that_missed_the_end_are_told_from_those_that_timed_out() -> None:
    trials = inputs.trials()
    trials.loc[trials["model"] == "P_Prob", "arrival"] = ["passed"] * 7 + ["arrived"] * 33
    heads = [text.get_text() for text in evaluation.fig11(trials, inputs.description(), inputs.pairs(), {}).axes[4].texts]
    assert "missed the end" in heads
    assert "timed out" not in heads
    trials.loc[0, "arrival"] = "timeout"
    texts = [text.get_text() for text in evaluation.fig11(trials, inputs.description(), inputs.pairs(), {}).axes[4].texts]
    columns = texts.index("p") + 1
    rows = {texts[at]: texts[at + 2 : at + 4] for at in range(columns, len(texts), columns)}
    assert texts[2:4] == ["missed the end", "timed out"]
    assert rows == {"$P_{Stat}$": ["0", "1"], "$P_{Adapt}$": ["0", "0"], "$P_{Prob}$ (literal)": ["7", "0"]}


def test_a_wide_spread_turns_the_time_axis_logarithmic_without_hiding_anything() -> None:
    times = inputs.long_times()
    narrow = evaluation.fig15(times, inputs.long_published()).axes[0]
    times.loc[times["model"] == "P_Prob", "travel_time_s"] = [6.0, 13.0, 90.0]
    wide = evaluation.fig15(times, inputs.long_published()).axes[0]
    assert (narrow.get_yscale(), wide.get_yscale()) == ("linear", "log")
    data = np.concatenate([np.asarray(line.get_ydata(), dtype=float) for line in wide.get_lines()])
    assert wide.get_ylim()[0] < data.min()
    assert data.max() < wide.get_ylim()[1]


def test_a_specification_curve_ascends_and_its_dots_stand_below_their_effects() -> None:
    rows, table = inputs.effects(), inputs.listed()
    figure = multiverse.fig_specification_curve(rows, table, ["scenario_1", "scenario_2"])
    claim = next(iter(multiverse.EFFECTS)).format("scenario_1")
    wanted = rows[rows["claim"] == claim].sort_values("ours")
    columns = len(multiverse.EFFECTS)
    curve, dots = figure.axes[0], figure.axes[columns]
    shown = next(line.get_xydata() for line in curve.get_lines() if len(line.get_xydata()) == len(wanted))
    assert shown[:, 1].tolist() == pytest.approx(wanted["ours"].tolist())
    names = [label.get_text() for label in dots.get_yticklabels()]
    uniform = names.index("weights: uniform")
    marked = {float(x) for line in dots.get_lines() for x, y in line.get_xydata() if y == uniform and line.get_marker() == "."}
    chosen = table.set_index("specification").loc[wanted["specification"], "weights"] == "uniform"
    assert marked == set(np.flatnonzero(chosen).astype(float))
    assert "1 more could not be run" in figure.get_supxlabel()
