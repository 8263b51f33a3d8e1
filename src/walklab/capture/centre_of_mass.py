"""The centre of mass from the pose of a controller at the belt (Agethen et al. 2017, section 7.2)."""

from __future__ import annotations

import numpy as np
import pandas as pd

from walklab.errors import InputError

_LABELS = ["recording", "participant", "configuration", "scene", "time_s"]


def from_belt_pose(poses: pd.DataFrame, participants: pd.DataFrame, controller_offset_m: float) -> pd.DataFrame:
    """Follow the controller's z axis into the body by half the torso depth and the distance between controller and skin.

    ``c = p + (d / 2 + o) * R(q) e_z``, projected onto the floor. The z axis is tilted when
    the person bends, and so is the line along which the centre is sought.

    Parameters
    ----------
    poses : DataFrame with the labels, x_m, y_m, z_m and the unit quaternion qw, qx, qy, qz
    participants : DataFrame with participant and torso_depth_m
    controller_offset_m : distance between controller and skin, metres

    Returns
    -------
    DataFrame[recording, participant, configuration, scene, time_s, x_m, y_m]

    Raises
    ------
    InputError
        If a participant of the poses is missing from the participants, or a quaternion has no unit length.
    """
    depth = dict(zip(participants["participant"].astype(str), participants["torso_depth_m"], strict=True))
    codes, names = pd.factorize(poses["participant"].astype("category"))
    if missing := [str(name) for name in names if str(name) not in depth]:
        raise InputError(f"participants: no row for {missing[0]}, who has poses; add the participant with torso_depth_m")
    reach = np.array([depth[str(name)] / 2 for name in names])[codes] + controller_offset_m
    w, x, y, z = (poses[name].to_numpy() for name in ("qw", "qx", "qy", "qz"))
    norm = w * w + x * x + y * y + z * z
    if np.any(wrong := np.abs(norm - 1) > 1e-3):
        row = int(np.flatnonzero(wrong)[0])
        raise InputError(
            f"poses: columns qw, qx, qy, qz, row {row}: quaternion has length {norm[row] ** 0.5:.4g}; give unit quaternions"
        )
    inwards = np.column_stack([2 * (x * z + w * y), 2 * (y * z - w * x)])
    result = poses[_LABELS].copy()
    result["x_m"] = poses["x_m"].to_numpy() + reach * inwards[:, 0]
    result["y_m"] = poses["y_m"].to_numpy() + reach * inwards[:, 1]
    return result
