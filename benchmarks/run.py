"""Measure every benchmark beside its baseline in this one run; write results/bench/summary.json and print a table.

Usage: python benchmarks/run.py [name ...]   (all modules bench_*.py by default)

Each module has a function ``measure()`` that returns rows ``{key: {ours, baseline, baseline_name, ratio, unit}}``. A key
whose peer is not installed is left out, and the reason is printed. Only the ratios mean anything on another machine.
"""

from __future__ import annotations

import importlib
import sys
from pathlib import Path

FOLDER = Path(__file__).resolve().parent
SUMMARY = FOLDER.parent / "results/bench/summary.json"


def main(names: list[str]) -> None:
    from walklab.storage import read_json, write_json

    sys.path.insert(0, str(FOLDER))
    modules = names or sorted(path.stem for path in FOLDER.glob("bench_*.py"))
    summary = read_json(SUMMARY) if names and SUMMARY.is_file() else {}
    for module in modules:
        print(f"{module} ...", flush=True)
        summary |= importlib.import_module(module).measure()
        # Written after each module: a long run that is stopped keeps what it has.
        write_json(summary, SUMMARY)
    print_table(summary)


def print_table(summary: dict[str, dict]) -> None:
    print("\n| key | ours | baseline | ratio |\n|---|---|---|---|")
    for key, row in summary.items():
        ours, baseline, ratio = (number(row.get(name)) for name in ("ours", "baseline", "ratio"))
        print(f"| `{key}` | {ours} {row['unit']} | {baseline} {row['unit']} ({row.get('baseline_name') or '-'}) | {ratio} |")


def number(value: float | None) -> str:
    return "-" if value is None else f"{value:.3g}"


if __name__ == "__main__":
    main(sys.argv[1:])
