"""Print the tables of docs/evidence.md from what `make`, `replicates`, `recovery`, `multiverse` and `resampled` left.

    python workflow/evidence.py [RESULTS] [--write]

RESULTS is the folder of the runs (default: results); --write puts the tables there.

The tables stand between the markers `<!-- name -->` and `<!-- /name -->`; the words around them are written by hand.
"""

import re
import sys
from pathlib import Path

import pandas as pd

from evidence_forecasts import (
    findings,
    limits,
    markdown,
    multiverse_findings,
    pairs,
    real,
    real_pairs,
    real_sentences,
    realism_sentences,
    replicated_findings,
    replicated_leans,
    resampled_findings,
    scores,
    sharpness,
    split,
    split_pairs,
    trial_pairs,
)

ROOT = Path(__file__).parents[1]
PAGE = ROOT / "docs/evidence.md"
READINGS = (
    "uniform",
    "P_Prob (literal)",
    "P_Prob (one exponent by the scores)",
    "P_Prob (exponent nearest to the truth)",
    "P_Prob, sharpened before blending",
    "true parameters of the neighbours",
    "perfect sample",
)
VERDICTS = ("reproduced", "partly", "not reproduced", "not checkable")
QUARTILES = ("median", "q25", "q75")
MEASURES = ("ks", "bias", "spread")
MODELS = ("P_Prob (calibrated)", "P_Prob (extended)", "P_Prob (extended), earlier walks")


def interval(row, digits=3, factor=1.0):
    """A value with its interval."""
    value, low, high = (f"{row[name] * factor:.{digits}f}" for name in ("value", "low", "high"))
    return f"{value} [{low}, {high}]"


def replicated_scores(folder):
    """CRPS, energy score and coverage of every forecast: means over populations."""
    scores = pd.read_csv(folder / "scores.csv")
    scores = scores[scores["hull"] == "all"]
    keyed = scores[scores["against"].isna()].set_index(["model", "scenario", "measure"])
    scenarios = list(dict.fromkeys(scores["scenario"]))
    rows = []
    for model in dict.fromkeys(keyed.index.get_level_values("model")):
        cells = [interval(keyed.loc[(model, scenario, "crps_s")]) for scenario in scenarios]
        energies = [(model, scenario, "energy_m") for scenario in scenarios]
        cells += [interval(keyed.loc[key]) if key in keyed.index else "-" for key in energies]
        cells += [interval(keyed.loc[(model, scenario, "coverage_90")], 0, 100) for scenario in scenarios]
        rows.append([model, *cells])
    names = [scenario.replace("_", " ") for scenario in scenarios]
    columns = [f"{measure}, {name}" for measure in ("CRPS (s)", "energy score (m)", "90 % interval holds (%)") for name in names]
    return f"{scores['replicates'].max()} populations:\n\n" + markdown(["forecast", *columns], rows)


def replicated_differences(folder):
    """CRPS, then energy score, of the learned models minus that of every other forecast."""
    scores = pd.read_csv(folder / "scores.csv")
    tables = [_differences(scores, "crps_difference_s", "CRPS of (s)", 3)]
    if "energy_difference_m" in set(scores["measure"]):
        tables.append(_differences(scores, "energy_difference_m", "energy score of (m)", 4))
    return "\n\n".join(tables)


def _differences(scores, measure, words, digits):
    rows = scores[(scores["hull"] == "all") & (scores["measure"] == measure) & scores["model"].isin(MODELS)]
    keyed = rows.set_index(["against", "model", "scenario"])
    pairs = [(model, scenario) for model in MODELS for scenario in dict.fromkeys(rows["scenario"])]
    table = []
    for against in dict.fromkeys(rows["against"]):
        keys = [(against, *pair) for pair in pairs]
        table.append([against, *(interval(keyed.loc[key], digits) if key in keyed.index else "-" for key in keys)])
    header = [f"{model}, {scenario.replace('_', ' ')}" for model, scenario in pairs]
    return markdown([f"minus the {words}", *header], table)


def replicated_claims(folder):
    """Which claims held in most of the populations, by the whole of their Wilson interval."""
    claims = pd.read_csv(folder / "claims.csv")
    directed, checked = claims["direction_held"].notna(), claims["replicates"] > 0
    reproduced, direction = claims["reproduced_low"] > 0.5, claims["direction_held_low"] > 0.5
    fails = claims["direction_held_high"].where(directed, claims["reproduced_high"]) < 0.5
    groups = {
        "reproduced in most": reproduced,
        "direction holds in most, figure not": direction & ~reproduced,
        "fails in most": fails,
        "undecided": checked & ~(reproduced | direction | fails),
        "not checkable": ~checked,
    }
    rows = [[name, str(int(rows.sum())), ", ".join(claims.loc[rows, "id"]) or "-"] for name, rows in groups.items()]
    return markdown([f"in {claims['replicates'].max()} populations", "claims", "which"], rows)


def recovery(folder):
    """Energy distance of all parameters from the known distribution, by number of walks, resolution and reading."""
    table = pd.read_csv(folder / "recovery.csv")
    table = table[table["measure"] == "energy"]
    order = [name for name in READINGS if name in set(table["model"])]
    means = table.groupby(["walks", "resolution", "model"])["value"].mean().unstack("model").sort_index()
    rows = [[f"{walks}", f"{values}", *(f"{row[name]:.2f}" for name in order)] for (walks, values), row in means.iterrows()]
    return "Energy distance (true sd):\n\n" + markdown(["walks", "values per parameter", *order], rows)


def recovery_by_task(folder):
    """KS distance, bias and spread task by task on the case in which both series meet."""
    table = pd.read_csv(folder / "recovery.csv")
    cases = table.drop_duplicates(["walks", "resolution"])
    walks, resolution = cases["walks"].mode()[0], cases["resolution"].mode()[0]
    kept = ("P_Prob (one exponent by the scores)", "P_Prob, sharpened before blending")
    chosen = table[(table["walks"] == walks) & (table["resolution"] == resolution) & table["model"].isin(kept)]
    means = chosen.groupby(["task", "model", "measure", "parameter"], sort=False)["value"].mean()
    names = [name for name in dict.fromkeys(table["parameter"]) if name != "all"]
    rows = [
        [task, model, *("{:.2f} ({:+.1f}, {:.1f})".format(*(means[task, model, m, name] for m in MEASURES)) for name in names)]
        for task, model in dict.fromkeys(means.index.droplevel([2, 3]))
    ]
    caption = f"{walks} walks, {resolution} values of each parameter; KS distance (bias in true sd, spread over true spread):\n\n"
    return caption + markdown(["task", "reading", *names], rows)


def effects_of(claims):
    """The main effects of the multiverse in the order of its figure: claim -> rows."""
    names = [name for name in dict.fromkeys(claims["claim"]) if name.startswith(("median_reduction_", "crps_reduction_"))]
    return {name: claims[claims["claim"] == name] for name in names}


def multiverse(folder):
    """The main effects: by default, how often they are above zero, and how far they go."""
    claims, table = pd.read_csv(folder / "claims.csv"), pd.read_csv(folder / "specifications.csv")
    kinds = {"choice": "other readings", "constant": "ends of constants", "combination": "combinations"}
    rows = []
    for name, found in effects_of(claims).items():
        own = found[found["kind"] == "default"].iloc[0]
        counts = [found.loc[found["kind"] == kind, "held"] for kind in kinds]
        low, middle, high = found["ours"].quantile([0, 0.5, 1])
        default = f"{own['ours']:.2f} [{own['ours_low']:.2f}, {own['ours_high']:.2f}]"
        words = name.replace("_reduction", "").replace("_", " ")
        rows.append(
            [words, default, *(f"{int(held.sum())} of {len(held)}" for held in counts), f"{low:.2f}, {middle:.2f}, {high:.2f}"]
        )
    walks = table.loc[table["specification"] == "default", [name for name in table if name.startswith("walks_")]].iloc[0]
    sizes = ", ".join(f"{int(count)} {name.removeprefix('walks_').replace('_', ' ')}" for name, count in walks.items())
    lost = table[table["outcome"] != "ran"]
    caption = f"{len(table)} specifications, {len(lost)} of which could not be run; walks by default: {sizes}.\n\n"
    header = ["relative reduction", "default", *(f"above 0, {words}" for words in kinds.values()), "smallest, median, largest"]
    return caption + markdown(header, rows)


def multiverse_turns(folder):
    """Which single changes turn the sign of a main effect."""
    rows = []
    for name, found in effects_of(pd.read_csv(folder / "claims.csv")).items():
        own = found.loc[found["kind"] == "default", "held"].iloc[0]
        single = found[found["kind"].isin(["choice", "constant"]) & (found["held"] != own)]
        turns = [f"{row['specification']} ({row['ours']:.2f})" for _, row in single.iterrows()]
        rows.append(
            [name.replace("_reduction", "").replace("_", " "), "above 0" if own else "not above 0", ", ".join(turns) or "none"]
        )
    return markdown(["effect", "by default", "turned by (to)"], rows)


def multiverse_claims(folder):
    """How robust each claim of the paper is: the share of the specifications in which its direction holds."""
    table = pd.read_csv(folder / "summary.csv")
    share = table["held_share"]
    groups = {
        "in all": share == 1,
        "in at least nine of ten": (share >= 0.9) & (share < 1),
        "in half to nine of ten": (share >= 0.5) & (share < 0.9),
        "in some, less than half": (share > 0) & (share < 0.5),
        "in none": share == 0,
    }
    rows = [[name, str(int(found.sum())), ", ".join(table.loc[found, "claim"]) or "-"] for name, found in groups.items()]
    return markdown(["holds", "claims", "which"], rows)


def realism(folder):
    """Synthetic and recorded medians and quartiles; of what is split by distance, the shortest and the longest."""
    table = pd.read_csv(folder / "realism.csv").query("n_recorded > 0")
    table = table[~table["source"].str.contains(",")]  # neither subjects with spikes nor a part of the walks
    rows = []
    for quantity, part in table.groupby("quantity", sort=False):
        for _, row in part.iloc[sorted({0, len(part) - 1})].iterrows():
            span = "" if row["distance_low_m"] == 0 else f", {row['distance_low_m']:g}-{row['distance_high_m']:g} m"
            ours, theirs = (
                "{:.3g} [{:.3g}, {:.3g}]".format(*(row[f"{n}_{q}"] for q in QUARTILES)) for n in ("synthetic", "recorded")
            )
            distance = "-" if pd.isna(row["ks_distance"]) else f"{row['ks_distance']:.2f}"
            name = f"{quantity.replace('_', ' ')} ({row['unit']}){span}"
            rows.append([name, ours, theirs, f"{row['n_recorded']}", distance, row["source"]])
    return markdown(["median [quartiles]", "synthetic", "recorded", "recorded walks", "KS distance", "recording"], rows)


def resampled_verdicts(folder):
    """How many verdicts agree, and the claims whose verdicts differ."""
    table = pd.read_csv(folder / "verdicts.csv")
    names = [name for name in VERDICTS if name in set(table["verdict"]) | set(table["verdict_other"])]
    counts = pd.crosstab(table["verdict_other"], table["verdict"]).reindex(index=names, columns=names, fill_value=0)
    agreement = markdown(["synthetic down, resampled across", *names], [[name, *map(str, counts.loc[name])] for name in names])
    differ = table[~table["agrees"]]
    rows = [
        [str(cell) if pd.notna(cell) else "-" for cell in row]
        for row in differ[["id", "published", "ours_other", "ours", "verdict_other", "verdict"]].itertuples(index=False)
    ]
    header = ["claim with another verdict", "published", "synthetic", "resampled", "verdict, synthetic", "verdict, resampled"]
    same = f"{int(table['agrees'].sum())} of {len(table)} verdicts are the same.\n\n"
    return f"{same}{agreement}\n\n{markdown(header, rows)}"


def resampled_scores(folder):
    """CRPS of every forecast under both generators, and coverage under the second."""
    runs = {"synthetic": folder.parent / "steering/scores.csv", "resampled": folder / "scores.csv"}
    keyed = {name: pd.read_csv(path).query("hull == 'all'").set_index(["model", "scenario"]) for name, path in runs.items()}
    models, scenarios = (list(dict.fromkeys(keyed["resampled"].index.get_level_values(level))) for level in (0, 1))
    columns = [(scenario, name) for scenario in scenarios for name in runs]
    rows = []
    for model in models:
        found = [keyed[name].loc[(model, scenario)] for scenario, name in columns]
        cells = [f"{row['crps_s']:.3f} [{row['crps_s_low']:.3f}, {row['crps_s_high']:.3f}]" for row in found]
        holds = " / ".join(f"{100 * keyed['resampled'].loc[(model, scenario), 'coverage_90']:.0f}" for scenario in scenarios)
        rows.append([model, *cells, holds])
    header = [f"{scenario.replace('_', ' ')}, {name}" for scenario, name in columns]
    return markdown(["CRPS (s)", *header, "90 % interval holds, resampled (%)"], rows)


TABLES = {
    "sharpness": (sharpness, "steering"),
    "scores": (scores, "steering"),
    "findings": (findings, "steering"),
    "split": (split, "steering"),
    "limits": (limits, "steering"),
    "pairs": (pairs, "steering"),
    "split_pairs": (split_pairs, "steering"),
    "trial_pairs": (trial_pairs, "steering"),
    "realism": (realism, "steering"),
    "realism_findings": (realism_sentences, "steering"),
    "real": (real, "cmu"),
    "real_findings": (real_sentences, "cmu"),
    "real_pairs": (real_pairs, "cmu"),
    "resampled_findings": (resampled_findings, "resampled"),
    "resampled_verdicts": (resampled_verdicts, "resampled"),
    "resampled_scores": (resampled_scores, "resampled"),
    "multiverse_findings": (multiverse_findings, "multiverse"),
    "multiverse": (multiverse, "multiverse"),
    "multiverse_turns": (multiverse_turns, "multiverse"),
    "multiverse_claims": (multiverse_claims, "multiverse"),
    "replicated_findings": (replicated_findings, "replicates"),
    "replicated_leans": (replicated_leans, "replicates"),
    "replicated_scores": (replicated_scores, "replicates"),
    "replicated_differences": (replicated_differences, "replicates"),
    "replicated_claims": (replicated_claims, "replicates"),
    "recovery": (recovery, "recovery"),
    "recovery_by_task": (recovery_by_task, "recovery"),
}


def main(results, write):
    """Print what can be made, or put it into the page."""
    page = PAGE.read_text()
    for name, (make, run) in TABLES.items():
        if not (results / run).is_dir():
            print(f"{name}: there is no {results / run}; run make {run} first", file=sys.stderr)
            continue
        try:
            text = f"<!-- {name} -->\n{make(results / run)}\n<!-- /{name} -->"
        except FileNotFoundError as error:
            print(f"{name}: there is no {error.filename}", file=sys.stderr)
            continue
        page, found = re.subn(rf"<!-- {name} -->.*?<!-- /{name} -->", lambda _, text=text: text, page, flags=re.DOTALL)
        print(text if not write else f"{name}: {'written' if found else 'has no place in the page'}")
    if write:
        PAGE.write_text(page)


if __name__ == "__main__":
    arguments = [argument for argument in sys.argv[1:] if argument != "--write"]
    main(Path(arguments[0] if arguments else ROOT / "results"), "--write" in sys.argv)
