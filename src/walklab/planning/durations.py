"""Duration of a simulated walk, by the same thresholds as that of a captured one."""

from __future__ import annotations

import numpy as np

from walklab.geometry.scene import Task
from walklab.geometry.standing import moving_span, speeds
from walklab.planning.protocol import Arrival, Trajectory

STANDING_FRAMES = 2


def trajectory_travel_time_s(trajectory: Trajectory, task: Task, threshold_m_s: float) -> float:
    """Time from the last standing frame to the first standing frame, seconds.

    Where the task starts (ends) at a speed of at least the threshold, the walk starts with its first frame
    (ends with its last, the arrival). A walk that ended stands from then on; one that timed out counts up to the time limit
    unless it had come to stand before.

    Parameters
    ----------
    threshold_m_s : speed below which a person stands; ``Standing.standing_speed_m_s`` of the captured walks
    """
    points, step_s = trajectory.positions_m, trajectory.step_s
    last = len(points) - 1
    after = 0 if trajectory.arrival == Arrival.TIMEOUT else STANDING_FRAMES
    standing = np.concatenate([np.repeat(points[:1], STANDING_FRAMES, axis=0), points, np.repeat(points[-1:], after, axis=0)])
    start, end = (frame - STANDING_FRAMES for frame in moving_span(speeds(standing, step_s), threshold_m_s))
    if start == end == -STANDING_FRAMES:  # nothing moves
        start = end = 0
    if task.start.speed_m_s >= threshold_m_s:
        start = 0
    if task.end.speed_m_s >= threshold_m_s:
        end = last
    return (end - start) * step_s
