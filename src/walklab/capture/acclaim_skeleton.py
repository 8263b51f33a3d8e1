"""A skeleton of rigid bones and where its joints are while it moves (Acclaim ASF/AMC conventions)."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray
from scipy.spatial.transform import Rotation

Array = NDArray[np.float64]

ROOT = "root"


@dataclass(frozen=True)
class Bone:
    """One rigid bone.

    Attributes
    ----------
    name : as the hierarchy and the motion call it
    parent : the bone at whose end it starts; ``"root"`` for those at the root
    direction : unit vector of the bone in the rest pose, in the frame of the world
    length : in units of the file
    axis_rad, axis_order : the local frame, rotations about fixed axes in this order, e.g. "xyz"
    channels : rotations the motion gives for this bone, in their order, e.g. "xyz" or "x"; empty for a rigid joint
    """

    name: str
    parent: str
    direction: tuple[float, float, float]
    length: float
    axis_rad: tuple[float, float, float] = (0.0, 0.0, 0.0)
    axis_order: str = "xyz"
    channels: str = ""


@dataclass(frozen=True)
class Root:
    """Where the hierarchy hangs: channels such as ``("tx", "ty", "tz", "rx", "ry", "rz")`` and the pose at zero."""

    channels: tuple[str, ...]
    position: tuple[float, float, float] = (0.0, 0.0, 0.0)
    orientation_rad: tuple[float, float, float] = (0.0, 0.0, 0.0)
    axis_order: str = "xyz"


@dataclass(frozen=True)
class Skeleton:
    """Bones in an order in which every parent comes before its children."""

    root: Root
    bones: Mapping[str, Bone] = field(default_factory=dict)

    def rest_pose(self) -> dict[str, Array]:
        """End of each bone with all channels at zero and the root at the origin, file units, (3,) arrays."""
        ends: dict[str, Array] = {ROOT: np.zeros(3)}
        for bone in self.bones.values():
            ends[bone.name] = ends[bone.parent] + bone.length * np.asarray(bone.direction)
        return ends


@dataclass(frozen=True)
class Motion:
    """Channel values per frame.

    Attributes
    ----------
    root : (frames, channels of the root) array, translations in file units, rotations in radians
    rotations_rad : bone -> (frames, channels of the bone) array
    """

    root: Array
    rotations_rad: Mapping[str, Array]

    def __len__(self) -> int:
        return len(self.root)


def joint_positions(skeleton: Skeleton, motion: Motion) -> dict[str, Array]:
    r"""Forward kinematics: the end of every bone in every frame.

    With the bone's local frame :math:`C`, its channel rotations :math:`M(t)` and its rest vector :math:`b`,

    .. math:: G_{child} = G_{parent}\, C\, M\, C^{-1}, \qquad x_{child} = x_{parent} + G_{child}\, b .

    Rotations are about fixed axes in the listed order: "xyz" means :math:`R_z R_y R_x`.

    Parameters
    ----------
    skeleton, motion : from one ASF file and an AMC file made for it

    Returns
    -------
    dict: bone name (and ``"root"``) -> (frames, 3) array, file units
    """
    positions, orientations = _root_pose(skeleton.root, motion.root)
    ends, frames = {ROOT: positions}, {ROOT: orientations}
    for bone in skeleton.bones.values():
        turned = frames[bone.parent]
        if bone.channels:
            local = Rotation.from_euler(bone.axis_order, bone.axis_rad).as_matrix()
            turned = turned @ local @ _rotation(bone.channels, motion.rotations_rad[bone.name]) @ local.T
        frames[bone.name] = turned
        ends[bone.name] = ends[bone.parent] + turned @ (bone.length * np.asarray(bone.direction))
    return ends


def _root_pose(root: Root, values: Array) -> tuple[Array, Array]:
    positions = np.tile(np.asarray(root.position, dtype=float), (len(values), 1))
    for column, channel in enumerate(root.channels):
        if channel[0] == "t":
            positions[:, "xyz".index(channel[1])] += values[:, column]
    turning = [column for column, channel in enumerate(root.channels) if channel[0] == "r"]
    local = Rotation.from_euler(root.axis_order, root.orientation_rad).as_matrix()
    if not turning:
        return positions, np.tile(local, (len(values), 1, 1))
    order = "".join(root.channels[column][1] for column in turning)
    return positions, local @ _rotation(order, values[:, turning])


def _rotation(order: str, angles_rad: Array) -> Array:
    return Rotation.from_euler(order, angles_rad).as_matrix()
