"""Where the recordings of real people are under ``WALKLAB_DATA``, and which of them are there."""

from __future__ import annotations

from pathlib import Path

GOAL_DIRECTED = Path("maroger_laas", "human_float32.npz")
FEET = Path("gaitmap_mocap", "mocap_sample.csv")
CMU = Path("cmu_walk_amc")


def present(folder: str | Path) -> list[Path]:
    """Files of the recordings that exist under a folder, the single ones first."""
    root = Path(folder)
    single = [path for path in (root / GOAL_DIRECTED, root / FEET) if path.is_file()]
    return single + sorted((root / CMU).rglob("*.a[sm][fc]"))
