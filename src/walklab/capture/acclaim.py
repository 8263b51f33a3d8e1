"""Real walks from Acclaim ASF/AMC recordings: whole-body centre of mass on the floor, stature from the skeleton."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

import numpy as np
import pandas as pd
from numpy.typing import NDArray

from walklab.capture.acclaim_files import read_motion, read_skeleton
from walklab.capture.acclaim_skeleton import joint_positions
from walklab.capture.body_segments import CMU_SEGMENTS, Segment, StatureRule, centre_of_mass, stature
from walklab.capture.imported_walks import ImportRules, Positions, build_tables
from walklab.capture.walks import SAMPLES, WALKS, check
from walklab.errors import InputError
from walklab.geometry.standing import Standing

Array = NDArray[np.float64]

# The CMU motion capture database (mocap.cs.cmu.edu): lengths are inches times 0.45, recorded at 120 Hz, y is up.
CMU_UNIT_M = 0.0254 / 0.45
CMU_RATE_HZ = 120.0


def floor_plan(points: Array, up: str) -> Array:
    """Plan view of points in space, (n, 3) -> (n, 2): the two axes that follow ``up`` in cyclic order.

    Seen from above the plan is right-handed, so that a left turn is a positive angle: y up gives (z, x), z up (x, y).
    """
    vertical = "xyz".index(up)
    return points[:, [(vertical + 1) % 3, (vertical + 2) % 3]]


def import_walks(
    folder: str | Path,
    unit_m: float = CMU_UNIT_M,
    rate_hz: float = CMU_RATE_HZ,
    standing: Standing | None = None,
    curvature_scale_m: float = 0.1,
    rules: ImportRules | None = None,
    segments: Sequence[Segment] = CMU_SEGMENTS,
    stature_rule: StatureRule | None = None,
    dataset: str = "cmu",
    scene: str = "open",
    walks_per_subject: int | None = None,
) -> tuple[pd.DataFrame, pd.DataFrame]:
    """Walks of every subject under a folder: ``<subject>/<subject>.asf`` with its ``*.amc`` beside it.

    Each motion is one candidate for a walk. Positions are the whole-body centre of mass on the floor; heights are
    derived from the skeleton (:func:`walklab.capture.body_segments.stature`), not measured. Boundaries and the
    speeds at moving ends are those of :func:`walklab.capture.imported_walks.cut_walk`.

    Parameters
    ----------
    folder : searched at any depth for ASF files, in the order of their paths
    unit_m : metres per unit of the files
    rate_hz : frames per second; the files do not say
    curvature_scale_m : smoothing of the curvature along the path
    walks_per_subject : only the first motions of each subject; default all

    Returns
    -------
    walks, samples : conforming to ``capture.walks.WALKS`` and ``SAMPLES``; walk ids such as "cmu/35/35_02"

    Raises
    ------
    InputError
        If the folder holds no skeleton, a skeleton has no motion, a file is malformed (with its line), or the
        statures are not human.
    """
    skeletons = sorted(Path(folder).rglob("*.asf"))
    if not skeletons:
        raise InputError(f"{folder}: no .asf file in this folder; set the path to the recordings (WALKLAB_DATA)")
    rule = stature_rule or StatureRule()
    candidates = []
    for path in skeletons:
        candidates += _subject(path, unit_m, rate_hz, segments, rule, dataset, scene, walks_per_subject)
    walks, samples = build_tables(candidates, standing or Standing(), curvature_scale_m, rules or ImportRules())
    return check(walks, WALKS, folder), check(samples, SAMPLES, folder)


def _subject(
    path: Path,
    unit_m: float,
    rate_hz: float,
    segments: Sequence[Segment],
    rule: StatureRule,
    dataset: str,
    scene: str,
    walks: int | None,
) -> list[Positions]:
    skeleton = read_skeleton(path)
    height_m = stature(skeleton, rule) * unit_m
    if not 0.5 <= height_m <= 2.5:
        raise InputError(f"{path}: the skeleton is {height_m:.3g} m tall; check the unit (now {unit_m:g} m)")
    motions = sorted(path.parent.glob("*.amc"))
    if not motions:
        raise InputError(f"{path}: no .amc file beside this skeleton; add its motions or remove it")
    found = []
    for motion_path in motions[:walks]:
        joints = joint_positions(skeleton, read_motion(motion_path, skeleton))
        position_m = floor_plan(centre_of_mass(joints, segments), rule.up) * unit_m
        walk = f"{dataset}/{path.stem}/{motion_path.stem}"
        found.append(Positions(walk, path.stem, scene, "walk", height_m, 0.0, rate_hz, position_m))
    return found
