"""The card of a saved model: what it was trained on, where it holds, how it scored, what it reveals about people."""

from __future__ import annotations

import os
import shutil
from collections.abc import Sequence
from pathlib import Path

import pandas as pd

from walklab.steering.model_file import read_model
from walklab.steering.probabilistic import ProbabilisticModel
from walklab.storage import atomic_path

SCORES = {
    "crps_s": "CRPS of travel time (s)",
    "energy_m": "energy score (m)",
    "coverage_90": "90 % interval holds (share)",
    "bias_s": "bias (s)",
}

VARIANTS = (
    "`P_Prob (literal)` is this file as it stands. `P_Prob (calibrated)` sharpens what it says of a "
    "walk. `P_Prob (extended)` sharpens it too, may choose other neighbours, and adds a trend of the travel time and the pace of "
    "people. `P_Prob without dependencies` is the sharpened mean of all its maps, the same for every walk."
)

SOURCES = {
    "synthetic": "**synthetic** walks, made by the generator of walklab; no person's movement is in it",
    "table": "captured walks from a table of the user's own",
    "acclaim": "captured walks from Acclaim ASF/AMC recordings",
}


def model_card(path: str | Path, source: str, scores: pd.DataFrame) -> str:
    """The card of one model file as Markdown.

    Parameters
    ----------
    path : the model file
    source : ``source.kind`` of the run that trained it; a kind that is not known here is named as it is
    scores : scores of forecasts (``scores.csv``, or ``summary.csv`` of real walks); rows of P_Prob are shown

    Raises
    ------
    InputError
        If the model file is damaged.
    """
    model = read_model(path)
    return "\n".join(
        [
            f"# Model card: {Path(path).name}",
            "",
            "## What it is",
            "",
            "A distribution of steering parameters for a walk of given "
            f"{', '.join(model.dependencies)}, after Agethen, Gaisbauer & Rukzio (2017).",
            "",
            *_parameters(model),
            "",
            "## Trained on",
            "",
            *_training(model, source),
            "",
            "## Where it holds",
            "",
            *_domain(model),
            "",
            "## How it scored",
            "",
            *_scores(scores),
            "",
            "## Not for",
            "",
            "- people unlike the training group (age, health, load, footwear, haste), stairs and slopes, groups of people",
            "- decisions about a single person; safety clearances: the planner avoids obstacles, not the model",
            "",
            "## People's privacy",
            "",
            "The file holds one map and one vector of dependencies per training walk, body heights among them. "
            "See docs/privacy.md before sharing a model of captured walks.",
            "",
        ]
    )


def publish_model(source: str | Path, target: str | Path) -> None:
    """Give a model file a second name: a link where the file system can, else a copy."""
    with atomic_path(target) as temporary:
        temporary.unlink()
        try:
            os.link(source, temporary)
        except OSError:
            shutil.copyfile(source, temporary)


def _parameters(model: ProbabilisticModel) -> list[str]:
    rows = [
        f"| {axis.name} | {axis.unit or '-'} | {axis.values[0]:g} to {axis.values[-1]:g} | {len(axis.values)} |"
        + (f" held at {model.fixed[axis.name]:g} |" if axis.name in model.fixed else " drawn |")
        for axis in model.space.axes
    ]
    settings = f"k {model.k}, weights {model.weights}, exponent {model.exponent:g}, basis {model.interpolant.name}"
    return ["| parameter | unit | range | values | |", "|---|---|---|---|---|", *rows, "", f"Settings: {settings}."]


def _training(model: ProbabilisticModel, source: str) -> list[str]:
    captured = int((~model.blending.is_blend).sum())
    provenance = [f"- {name}: {value}" for name, value in model.provenance.items()]
    return [
        f"- {SOURCES.get(source, source)}",
        f"- {captured} captured walks, up-sampled to {len(model.blending)} maps",
        *provenance,
    ]


def _domain(model: ProbabilisticModel) -> list[str]:
    captured = model.blending.vectors[~model.blending.is_blend]
    rows = [
        f"| {name} | {unit or '-'} | {column.min():.3g} to {column.max():.3g} |"
        for name, unit, column in zip(model.dependencies, model.dependency_units, captured.T, strict=True)
    ]
    return [
        "Inside the convex hull of the training walks; a draw outside of it warns.",
        "",
        "| dependency | unit | trained |",
        "|---|---|---|",
        *rows,
    ]


def _scores(scores: pd.DataFrame) -> list[str]:
    shown = scores[scores["model"].str.startswith("P_Prob")]
    if "hull" in shown:
        shown = shown[shown["hull"] == "all"]
    keys = [name for name in ("scenario", "model") if name in shown]
    values = [name for name in SCORES if name in shown]
    if shown.empty:
        return ["No forecast of this model was scored in its run."]
    lines = [_row([*keys, *(SCORES[name] for name in values)]), _row(["---"] * (len(keys) + len(values)))]
    table = shown[[*keys, *values]].itertuples(index=False)
    lines += [_row([cell if isinstance(cell, str) else _number(cell) for cell in row]) for row in table]
    return [*lines, "", VARIANTS]


def _number(value: float | None) -> str:
    return "-" if pd.isna(value) else f"{value:.3g}"


def _row(cells: Sequence[str]) -> str:
    return f"| {' | '.join(cells)} |"
