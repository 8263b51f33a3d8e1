"""The recordings of real walks that the synthetic capture is compared with, each where it is present."""

from __future__ import annotations

from pathlib import Path

from walklab.capture import acclaim, foot_markers, goal_directed
from walklab.capture.realism import Sample, gait_samples, goal_directed_samples, ramp_samples
from walklab.capture.recording_files import CMU, FEET, GOAL_DIRECTED
from walklab.capture.walks import pair

# Twenty of the 47 walks are of one subject; the first two of each count alike and are read in a second.
CMU_WALKS_PER_SUBJECT = 2


def recorded_samples(folder: str | Path) -> tuple[list[Sample], list[str]]:
    """What can be measured on the recordings under a folder.

    Returns
    -------
    samples, absent : measures, and one sentence for each recording that is not there
    """
    root = Path(folder)
    samples: list[Sample] = []
    absent: list[str] = []
    if (root / GOAL_DIRECTED).is_file():
        samples += goal_directed_samples(goal_directed.read_goal_directed(root / GOAL_DIRECTED))
    else:
        absent.append(_absent(GOAL_DIRECTED))
    if (root / CMU).is_dir():
        walks, positions = acclaim.import_walks(root / CMU, walks_per_subject=CMU_WALKS_PER_SUBJECT)
        samples += gait_samples(pair(walks, positions, root / CMU))
    else:
        absent.append(_absent(CMU))
    if (root / FEET).is_file():
        samples += ramp_samples(foot_markers.ramps(foot_markers.read_feet(root / FEET)))
    else:
        absent.append(_absent(FEET))
    return samples, absent


def _absent(path: Path) -> str:
    return f"no {path.as_posix()} under WALKLAB_DATA"
