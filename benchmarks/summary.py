"""Rows ``{key: {ours, baseline, baseline_name, ratio, unit}}`` of ``results/bench/summary.json``, and their table.

``python benchmarks/summary.py`` prints the table; ``python benchmarks/summary.py README.md`` puts it between the two marks there.
"""

from __future__ import annotations

import sys
from pathlib import Path
from typing import Any

from walklab.storage import read_json, write_json, write_text

FOLDER = Path(__file__).resolve().parents[1] / "results/bench"
SUMMARY = FOLDER / "summary.json"
MARKS = ("<!-- benchmarks -->", "<!-- end of benchmarks -->")

# What each row has to reach: (least ratio, largest value of ours).
GOALS: dict[str, tuple[float | None, float | None]] = {
    "sweep_vs_rvo": (80, None),
    "sweep_vs_jupedsim": (300, None),
    "sweep_vs_python": (1000, None),
    "sweep_vs_scalar": (8, None),
    "maps_1848": (None, 3),
    "lazy_theta_star": (700, None),
    "sample_rbf_k100": (300, None),
    "sample_k100": (700, None),
    "sample_k500": (200, None),
    "sample_batch": (1000, None),
    "model_load": (0.5, None),
    "study": (None, 150),
    "study_memory": (None, 2000),
    "sampling_memory": (None, 200),
}

Row = dict[str, Any]


def row(ours: float, baseline: float | None, name: str, unit: str) -> Row:
    """A row of the table."""
    ratio = None if baseline is None else baseline / ours
    return {"ours": ours, "baseline": baseline, "baseline_name": name, "ratio": ratio, "unit": unit}


def add(key: str, found: Row) -> None:
    """Put a row into the file at once: a long run that is stopped keeps what it has."""
    rows = read_json(SUMMARY) if SUMMARY.is_file() else {}
    write_json({**rows, key: found}, SUMMARY)


def table(rows: dict[str, Row]) -> str:
    """The rows as a Markdown table, in the order of the goals."""
    lines = ["| key | ours | baseline in the same run | ratio | goal | reached |", "|---|---|---|---|---|---|"]
    for key, (least_ratio, largest) in GOALS.items():
        if key not in rows:
            lines.append(f"| `{key}` | not measured | | | | |")
            continue
        found = rows[key]
        goal = f"at least {least_ratio:g}" if least_ratio is not None else f"at most {largest:g} {found['unit'].split(',')[0]}"
        reached = found["ratio"] >= least_ratio if least_ratio is not None else found["ours"] <= largest
        beside = "-" if found["baseline"] is None else f"{found['baseline']:.3g} ({found['baseline_name']})"
        ratio = "-" if found["ratio"] is None else f"{found['ratio']:.3g}"
        lines.append(
            f"| `{key}` | {found['ours']:.3g} {found['unit']} | {beside} | {ratio} | {goal} | {'yes' if reached else 'no'} |"
        )
    return "\n".join(lines)


def main(arguments: list[str]) -> None:
    found = table(read_json(SUMMARY))
    if not arguments:
        print(found)
        return
    path = Path(arguments[0])
    before, rest = path.read_text().split(MARKS[0])
    after = rest.split(MARKS[1])[1]
    write_text(f"{before}{MARKS[0]}\n{found}\n{MARKS[1]}{after}", path)


if __name__ == "__main__":
    main(sys.argv[1:])
