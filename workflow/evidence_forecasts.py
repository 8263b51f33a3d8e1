"""The tables and sentences of docs/evidence.md that tell how the forecasts did; evidence.py puts them there."""

import pandas as pd

from walklab.evaluation.forecasts import FITTED, GAUSSIAN_PROCESS, QUADRATIC_REGRESSION
from walklab.evaluation.paired_tests import STATED_EFFECT_S
from walklab.evaluation.score_tables import information
from walklab.evaluation.subject_scores import OWN_MAP
from walklab.report.findings import (
    BASELINES,
    CALIBRATED,
    EXTENDED,
    GOAL_HIGH,
    GOAL_LOW,
    forecast_findings,
    real_findings,
    realism_findings,
)

# How candidates.csv calls each way of choosing the sharpness -> how the page does.
WAYS = {
    "constant": "one number, by the scores alone",
    "covering constant": "one number that covers",
    "law": "a law, by the scores alone",
    "covering law": "**a law that covers (the rule)**",
}
# What each step of P_Prob (extended) added: exponent, degree of the trend, ignored dependencies.
STEPS = {
    "start: all dependencies, exponent 80, one mean pace": (80, 0, None),
    "neighbours searched without height": (80, 0, "height"),
    "and the mean pace a polynomial of degree 2": (80, 2, "height"),
}
SIGNIFICANT = 0.05


def markdown(header, rows):
    """A table in Markdown."""
    lines = [header, ["---"] * len(header), *rows]
    return "\n".join(f"| {' | '.join(line)} |" for line in lines)


def bullets(sentences):
    """A list in Markdown."""
    return "\n".join(f"- {sentence}" for sentence in sentences)


def bracketed(row, name, digits=3):
    """A value with its interval."""
    return f"{row[name]:.{digits}f} [{row[f'{name}_low']:.{digits}f}, {row[f'{name}_high']:.{digits}f}]"


def sharpness(folder):
    """Each way of choosing how sharp the density is, scored on training walks."""
    table = pd.read_csv(folder / "0/calibrate_model/candidates.csv").query("model == 'P_Prob'")
    literal = table[(table["kind"] == "exponent") & (table["value"] == 1)].iloc[0]
    ways = [("1 (literal)", literal), *((name, table[table["kind"] == kind].iloc[0]) for kind, name in WAYS.items())]
    rows = [[name, f"{row['crps_s']:.3f}", f"{row['energy_m']:.3f}", f"{100 * row['coverage_90']:.1f}"] for name, row in ways]
    header = ["exponent, nested leave-one-participant-out", "CRPS (s)", "energy score (m)", "90 % interval holds (%)"]
    best = [
        f"{kind} {row['crps_s']:.3f} s (at {row['value']:.3g})"
        for kind in ("exponent", "threshold", "temperature")
        for row in [table.loc[table.loc[table["kind"] == kind, "crps_s"].idxmin()]]
    ]
    return f"{markdown(header, rows)}\n\nSmallest CRPS of each kind, one value for all walks, not nested: {', '.join(best)}."


def scores(folder):
    """Every forecast of both scenarios."""
    table = pd.read_csv(folder / "scores.csv").query("hull == 'all'")
    keyed, scenarios = table.set_index(["model", "scenario"]), list(dict.fromkeys(table["scenario"]))
    rows = []
    for model in dict.fromkeys(table["model"]):
        found = [keyed.loc[(model, scenario)] for scenario in scenarios]
        scored = all(pd.notna(row["energy_m"]) for row in found)
        energy = " / ".join(f"{row['energy_m']:.3f}" for row in found) if scored else "-"
        holds = "-" if model == OWN_MAP else " / ".join(f"{100 * row['coverage_90']:.1f}" for row in found)
        name, knows = model, information(model)
        rows.append([name, knows, *(bracketed(row, "crps_s") for row in found), energy, holds])
    header = ["forecast", "knows", *(f"CRPS, {name.replace('_', ' ')} (s)" for name in scenarios)]
    return markdown([*header, "energy score, 1 / 2 (m)", "90 % interval holds, 1 / 2 (%)"], rows)


def split(folder):
    """CRPS and coverage of the walks inside the training dependencies and of those outside."""
    table = pd.read_csv(folder / "scores.csv").query("hull != 'all'")
    keyed = table.set_index(["model", "scenario", "hull"])
    parts = list(dict.fromkeys(zip(table["scenario"], table["hull"], strict=True)))
    rows = []
    for model in dict.fromkeys(table["model"]):
        found = [keyed.loc[(model, *part)] for part in parts]
        holds = "-" if model == OWN_MAP else " / ".join(f"{100 * row['coverage_90']:.0f}" for row in found)
        rows.append([model, *(bracketed(row, "crps_s") for row in found), holds])
    sizes = [keyed.xs(part, level=("scenario", "hull")).iloc[0] for part in parts]
    header = [
        f"{scenario.replace('_', ' ')}, {hull} ({int(row['walks'])} walks of {int(row['participants'])} people)"
        for (scenario, hull), row in zip(parts, sizes, strict=True)
    ]
    return markdown(["CRPS (s)", *header, "90 % interval holds, in that order (%)"], rows)


def split_pairs(folder):
    """The pairs whose mixed model tells them apart inside the training dependencies, and outside."""
    return _split_pairs(_tests(folder))


def _split_pairs(table):
    told = []
    for hull in ("inside", "outside"):
        part = table[table["hull"] == hull]
        people = ", ".join(f"{row['participants']} in {row['scenario'].replace('_', ' ')}" for row in _firsts(part))
        told.append(f"{hull.capitalize()} (people: {people}), significant after Holm: {_significant(part, 'p_mixed_holm')}.")
    return bullets(told)


def _firsts(part):
    return part.drop_duplicates("scenario").to_dict("records")


def findings(folder):
    """Who wins, by how much, and what the intervals hold."""
    return bullets(forecast_findings(pd.read_csv(folder / "scores.csv"), _tests(folder)))


def _tests(folder):
    return pd.read_csv(folder / "0/compare_forecasts/tests.csv")


def pairs(folder):
    """Every tested pair over all walks, and what is significant."""
    return pairs_of(_tests(folder))


def trial_pairs(folder):
    """The same of the models' trials, by |dt|, with the walks inside the training dependencies and those outside."""
    tests = pd.read_csv(folder / "0/compare_forecasts/trial_tests.csv")
    return f"{pairs_of(tests, error='abs. dt')}\n{_split_pairs(tests)}"


def pairs_of(tests, measure="mean_difference_s", error="CRPS"):
    """A table of pairs over all walks with the floor of the exact test, sizes of the tests and what is significant."""
    table = tests.query("hull == 'all'")
    several = len(set(table["scenario"])) > 1
    rows = [
        [
            *([row["scenario"].removeprefix("scenario_")] if several else []),
            row["first"],
            row["second"],
            bracketed(row, measure),
            f"{row['p_mixed_holm']:.2g}",
            f"{row['p_participants_holm']:.2g}",
            f"{row['power_are']:.2f}",
            f"{row['power_participants']:.2f}",
            f"{100 * row['size_mixed']:.1f}",
            f"{row['power_mixed']:.2f}",
        ]
        for row in table.to_dict("records")
    ]
    header = [*(["scenario"] if several else []), "first", "second", f"{error}, first - second (s)", "p, mixed model"]
    header += ["p, participants' means", "power, A.R.E.", "power, participants' means, simulated"]
    text = markdown([*header, "size, mixed model (%)", f"power of it at {STATED_EFFECT_S:g} s"], rows)
    names = ("size_walks", "size_participants", "size_mixed")
    sizes = [f"{100 * table[name].min():.0f} to {100 * table[name].max():.0f} %" for name in names]
    floor = ", ".join(f"{value:.2g}" for value in sorted(set(table["p_participants_holm_floor"])))
    where, people = " of both scenarios" if several else "", table["participants"].max()
    told = [
        f"p values are after Holm's correction over all {len(table)} pairs{where}. The exact test on the means of {people} people"
        f" cannot go below {floor} after it, even where all of them agree.",
        f"Where there is no effect the paper's test on walks rejects in {sizes[0]} of simulated studies,"
        f" that on participants' means in {sizes[1]}, the mixed model in {sizes[2]}; {100 * SIGNIFICANT:.0f} % were asked for.",
        f"A true difference of {STATED_EFFECT_S:g} s is found by the mixed model, before Holm's correction, with power"
        f" {table['power_mixed'].min():.2f} to {table['power_mixed'].max():.2f}; at least 0.8 for"
        f" {int((table['power_mixed'] >= 0.8).sum())} of {len(table)} pairs.",
    ]
    for name, words in (("p_mixed_holm", "the mixed model"), ("p_participants_holm", "participants' means")):
        told.append(f"Significant after Holm by {words}: {_significant(table, name)}.")
    return f"{text}\n\n{bullets(told)}"


def _significant(table, name):
    found = []
    for row in table[table[name] < SIGNIFICANT].to_dict("records"):
        ahead = row["mean_difference_s"] > 0
        better, worse = (row["second"], row["first"]) if ahead else (row["first"], row["second"])
        found.append(f"{better} before {worse}{_place(row['scenario'])} ({row[name]:.2g})")
    return "; ".join(found) or "nothing"


def _place(scenario):
    return f" in {scenario.replace('_', ' ')}" if scenario.startswith("scenario") else ""


def limits(folder):
    """What each step of P_Prob (extended) added on training walks."""
    table = pd.read_csv(folder / "0/calibrate_model/candidates.csv")
    table = table[table["model"] == EXTENDED]
    rows = []
    for name, (value, degree, ignored) in STEPS.items():
        same = table["ignored"].isna() if ignored is None else table["ignored"] == ignored
        row = table[(table["value"] == value) & (table["degree"] == degree) & same].iloc[0]
        rows.append([name, f"{row['crps_s']:.3f}", f"{row['crps_earlier_s']:.3f}"])
    return markdown(["step", "CRPS of somebody new (s)", "with earlier walks (s)"], rows)


def realism_sentences(folder):
    """How far the synthetic walks are from recorded ones."""
    return bullets(realism_findings(pd.read_csv(folder / "realism.csv")))


def real(folder):
    """Every forecast of real walks, every participant left out in turn and counted once."""
    table = pd.read_csv(folder / "summary.csv")
    forecasts = table[table["kind"] == "forecast"].sort_values("crps_s")
    reference = str(forecasts["reference"].iloc[0])
    rows = [
        [
            row["model"],
            information(row["model"]),
            bracketed(row, "crps_s"),
            "-" if pd.isna(row["energy_m"]) else f"{row['energy_m']:.3f}",
            " / ".join(f"{100 * row[f'coverage_{level}']:.0f}" for level in (50, 80, 90, 95)),
            f"{row['bias_s']:+.2f}",
            f"{row['median_abs_dt_s']:.2f}",
            bracketed(row, "crps_minus_reference_s"),
        ]
        for row in forecasts.to_dict("records")
    ]
    header = ["forecast", "knows", "CRPS (s)", "energy score (m)", "50 / 80 / 90 / 95 % intervals hold (%)", "bias (s)"]
    header += ["median abs. dt of a draw (s)", f"CRPS minus that of {reference} (s)"]
    clear = forecasts.loc[forecasts["crps_minus_reference_s_high"] < 0, "model"]
    best = forecasts.iloc[0]
    told = [
        f"{best['walks']} walks of {best['participants']} people. The smallest mean CRPS has {best['model']}.",
        f"Better than {reference} with an interval that excludes zero: {', '.join(clear) or 'none'}.",
    ]
    return f"{bullets(told)}\n\n{markdown(header, rows)}"


def real_sentences(folder):
    """Whether the learned models beat the baselines on real walks."""
    return bullets(real_findings(pd.read_csv(folder / "tests.csv")))


def real_pairs(folder):
    """Every tested pair on real walks, every participant counting once."""
    return pairs_of(pd.read_csv(folder / "tests.csv"), "participants_difference_s")


def replicated_findings(folder):
    """In how many populations the interval is held, and how the learned models stand to the best baseline, over populations."""
    table = pd.read_csv(folder / "scores.csv").query("hull == 'all'")
    told = []
    for scenario, part in table.groupby("scenario", sort=False):
        means = part[(part["measure"] == "crps_s") & part["model"].isin(BASELINES)].set_index("model")["value"]
        best, words = str(means.idxmin()), str(scenario).replace("_", " ").capitalize()
        text = f"{words}: the best baseline by its mean CRPS is {best} ({means[best]:.3f} s)."
        text += _against_best(part, "crps_difference_s", best, "s", 3)
        told.append(text + _held_goal(folder, scenario))
        told += _replicated_trajectories(part, words)
    return bullets(told)


def _replicated_trajectories(part, words):
    """The learned models' trajectories beside the best of those along the planned route, by energy score over populations."""
    means = part[(part["measure"] == "energy_m") & part["model"].isin(FITTED)].set_index("model")["value"]
    if means.empty:
        return []
    best = str(means.idxmin())
    text = (
        f"{words}, trajectories: of the planned route, walked in a forecast time, that of {best} is best ({means[best]:.4f} m)."
    )
    return [text + _against_best(part, "energy_difference_m", best, "m", 4)]


def _against_best(part, measure, best, unit, digits):
    """How the learned models stand to the best baseline by one measure, over populations."""
    text = ""
    for model in (CALIBRATED, EXTENDED):
        found = part[(part["measure"] == measure) & (part["model"] == model) & (part["against"] == best)]
        for row in found.to_dict("records"):
            verb = "wins" if row["high"] < 0 else "loses" if row["low"] > 0 else "differs by less than the interval"
            value, low, high = (f"{row[name]:+.{digits}f}" for name in ("value", "low", "high"))
            text += f" Against it {model} {verb}: {value} {unit} [{low}, {high}],"
            text += f" less in {row['below_zero']} of {row['replicates']} populations."
    return text


def replicated_leans(folder):
    """Bias and coverage of the learned models and of what is fitted, over populations: do they lean, are they too wide?"""
    pooled = pd.read_csv(folder / "scores.csv").query("hull == 'all' and measure == 'bias_s'").set_index(["model", "scenario"])
    scenarios, rows = list(dict.fromkeys(pooled.index.get_level_values("scenario"))), []
    for model in (CALIBRATED, EXTENDED, QUADRATIC_REGRESSION, GAUSSIAN_PROCESS):
        biases = ["{value:+.3f} [{low:+.3f}, {high:+.3f}]".format(**pooled.loc[(model, scenario)]) for scenario in scenarios]
        held = [_shares(folder, scenario, model) for scenario in scenarios]
        rows.append([model, *biases, *(_counted(shares) for shares in held)])
    names = [scenario.replace("_", " ") for scenario in scenarios]
    goal = f"{100 * GOAL_LOW:.0f} / {100 * GOAL_LOW:.0f} to {100 * GOAL_HIGH:.0f} / above {100 * GOAL_HIGH:.0f} %"
    header = [f"mean forecast minus captured time, {name} (s)" for name in names]
    header += [f"90 % interval holds, {name} (%; populations below {goal})" for name in names]
    return markdown(["over populations", *header], rows)


def _counted(shares):
    below, above = sum(share < GOAL_LOW for share in shares), sum(share > GOAL_HIGH for share in shares)
    return f"{100 * sum(shares) / len(shares):.1f} ({below} / {_inside(shares)} / {above})"


def _inside(shares):
    return sum(GOAL_LOW <= share <= GOAL_HIGH for share in shares)


def _shares(folder, scenario, model):
    """Share of the walks that the 90 % interval of a forecast holds in each population."""
    tables = [pd.read_csv(path) for path in sorted(folder.glob("[0-9]*/score_forecasts/scores.csv"))]
    asked = [table[(table["hull"] == "all") & (table["scenario"] == scenario) & (table["model"] == model)] for table in tables]
    return [share for table in asked for share in table["coverage_90"]]


def _held_goal(folder, scenario):
    shares = _shares(folder, scenario, CALIBRATED)
    if not shares:
        return ""
    held = _inside(shares)
    goal = f"{100 * GOAL_LOW:.0f} to {100 * GOAL_HIGH:.0f} %"
    return f" The 90 % interval of {CALIBRATED} held {goal} of the walks in {held} of {len(shares)} populations."


def multiverse_findings(folder):
    """How many claims hold whatever is chosen, and whether P_Prob's effects do."""
    table = pd.read_csv(folder / "summary.csv")
    share = table["held_share"].dropna()
    told = [
        f"Of {len(share)} claims {int((share == 1).sum())} hold in every specification, {int((share == 0).sum())} in none;"
        f" {int(((share > 0) & (share < 1)).sum())} depend on what is chosen."
    ]
    effects = table[table["claim"].str.startswith("crps_reduction_")]
    told += [
        f"{row['statement'].replace('_', ' ', 1)}: {row['default']:+.2f} by default, from {row['smallest']:+.2f} to"
        f" {row['largest']:+.2f} over all; above 0 in {row['held']} of {row['specifications']}."
        for row in effects.to_dict("records")
    ]
    return bullets(told)


def resampled_findings(folder):
    """The same sentences of the walks resampled from recordings."""
    tests = folder / "0/compare_forecasts/tests.csv"
    return bullets(forecast_findings(pd.read_csv(folder / "scores.csv"), pd.read_csv(tests) if tests.exists() else None))
