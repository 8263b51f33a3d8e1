"""Small finished runs: a folder with a record, tables and a figure."""

from pathlib import Path

import pandas as pd
import pytest

from walklab.runs.record import record
from walklab.storage import write_json, write_table, write_text

ROOT = Path(__file__).parents[3]


def make_run(folder: Path, k: int = 100, ours: float = 0.4, crps_s: float = 0.2, wall_s: float = 2.0) -> Path:
    """A run's folder ``results/<name>`` below ``folder.parent``, as the DAG leaves it."""
    write_table(
        pd.DataFrame(
            {
                "id": ["first", "second"],
                "published": [0.453, 1.0],
                "ours": [ours, None],
                "ours_low": [ours - 0.1, None],
                "ours_high": [ours + 0.1, None],
                "verdict": ["reproduced" if ours < 0.5 else "not reproduced", "not checkable"],
            }
        ),
        folder / "claims.csv",
    )
    write_table(
        pd.DataFrame(
            {
                "scenario": ["scenario_1", "scenario_1"],
                "hull": ["all", "inside"],
                "model": ["P_Prob (calibrated)", "P_Prob (calibrated)"],
                "information": ["task", "task"],
                "crps_s": [crps_s, 9.0],
                "energy_m": [None, None],
                "coverage_90": [0.9, 0.1],
            }
        ),
        folder / "scores.csv",
    )
    write_text("<svg xmlns='http://www.w3.org/2000/svg'/>", folder / "figures/fig11.svg")
    products = [str(folder / name) for name in ("claims.csv", "scores.csv", "figures/fig11.svg")]
    config = {
        "run": folder.name,
        "seed": 1,
        "model": {"k": k},
        "scenarios": {"scenario_1": "config/scenes/scenario_1.yaml"},
        "compare_verdicts": {"other": None},
        "source": {"kind": "synthetic", "path": None, "plans": []},
    }
    found = record(config, ROOT, [], {"score_maps.py": f"digest {k}"}, products, folder, "record_run")
    cost = {"wall_s": wall_s, "cpu_s": 1.5, "peak_memory_mb": 90.0}
    found["stages"] = [{"stage": "score_maps", "part": "0", "replicate": 0, **cost}]
    write_json(found, folder / "run.json")
    return folder


@pytest.fixture
def run(tmp_path: Path) -> Path:
    return make_run(tmp_path / "results/study")


@pytest.fixture
def other(tmp_path: Path) -> Path:
    return make_run(tmp_path / "results/other", k=50, ours=0.6, crps_s=0.3, wall_s=4.0)
