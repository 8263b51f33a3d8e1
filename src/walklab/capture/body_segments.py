"""Whole-body centre of mass and stature from the joints of a captured skeleton."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from walklab.capture.acclaim_skeleton import Skeleton
from walklab.errors import InputError

Array = NDArray[np.float64]


@dataclass(frozen=True)
class Segment:
    """A part of the body between two landmarks.

    Attributes
    ----------
    mass : share of the body's mass
    centre : place of the segment's centre of mass between the proximal (0) and the distal (1) landmark
    proximal, distal : bones whose ends are averaged to the landmark
    """

    name: str
    mass: float
    centre: float
    proximal: tuple[str, ...]
    distal: tuple[str, ...]


def _both_sides(name: str, mass: float, centre: float, proximal: str, distal: str) -> tuple[Segment, Segment]:
    left, right = (
        Segment(f"{side}_{name}", mass, centre, (side[0] + proximal,), (side[0] + distal,)) for side in ("left", "right")
    )
    return left, right


# Shares and centres of mass: Winter, Biomechanics and Motor Control of Human Movement, 4th ed. 2009, table 4.1
# (Dempster 1955), which holds for either sex; the sex of the CMU subjects is not published.
# ASSUME: joints of the CMU skeletons stand for Winter's landmarks (hip for the greater trochanter, end of the clavicle
# for the glenohumeral joint, end of the upper neck for the ear canal), because the skeletons have no nearer points.
CMU_SEGMENTS: tuple[Segment, ...] = (
    Segment("head_and_neck", 0.081, 1.0, ("thorax",), ("upperneck",)),
    Segment("trunk", 0.497, 0.5, ("lhipjoint", "rhipjoint"), ("lclavicle", "rclavicle")),
    *_both_sides("upper_arm", 0.028, 0.436, "clavicle", "humerus"),
    # The forearm of these skeletons is two bones, so that it can be rotated along its length.
    *_both_sides("forearm", 0.016, 0.430, "humerus", "wrist"),
    *_both_sides("hand", 0.006, 0.506, "wrist", "hand"),
    *_both_sides("thigh", 0.100, 0.433, "hipjoint", "femur"),
    *_both_sides("shank", 0.0465, 0.433, "femur", "tibia"),
    *_both_sides("foot", 0.0145, 0.5, "tibia", "foot"),
)


def centre_of_mass(joints: Mapping[str, Array], segments: Sequence[Segment] = CMU_SEGMENTS) -> Array:
    r"""Whole-body centre of mass.

    .. math:: x = \sum_s m_s \, (p_s + c_s (d_s - p_s)) / \sum_s m_s

    Parameters
    ----------
    joints : bone -> (frames, 3) array, the ends of the bones in any unit
    segments : shares of the mass, and the landmarks between which each centre lies

    Returns
    -------
    (frames, 3) array in the unit of the joints

    Raises
    ------
    InputError
        If the skeleton lacks a bone that a segment names.
    """
    total = sum(segment.mass for segment in segments)
    centre: Array = np.zeros(3)
    for segment in segments:
        proximal, distal = _landmark(joints, segment.proximal), _landmark(joints, segment.distal)
        centre = centre + segment.mass / total * (proximal + segment.centre * (distal - proximal))
    return centre


def _landmark(joints: Mapping[str, Array], bones: Sequence[str]) -> Array:
    missing = [bone for bone in bones if bone not in joints]
    if missing:
        raise InputError(
            f"the skeleton has no bone {missing[0]!r}, which the table of body segments needs; name its own bones there"
        )
    return np.mean([joints[bone] for bone in bones], axis=0)


@dataclass(frozen=True)
class StatureRule:
    """How a skeleton's bones add up to the height of the person.

    Attributes
    ----------
    legs : per leg the bones from hip to ankle; their lengths are added (a straight leg) and the legs averaged
    hips, head : bones whose ends are the hips and the top of the skeleton; their vertical distance in the rest pose counts
    up : vertical axis of the skeleton, "x", "y" or "z"
    sole_share : ankle to floor, as a share of stature
    crown_share : top of the skeleton to the crown of the head, as a share of stature
    """

    legs: tuple[tuple[str, ...], ...] = (("lfemur", "ltibia"), ("rfemur", "rtibia"))
    hips: tuple[str, ...] = ("lhipjoint", "rhipjoint")
    head: str = "head"
    up: str = "y"
    # Drillis and Contini 1966, in Winter 2009, fig. 4.1: the ankle is at 0.039 of stature.
    sole_share: float = 0.039
    # ASSUME: the head of a CMU skeleton ends at the brow, where the head band's markers sit, 0.95 of stature, because the
    # eyes are at 0.936 (Drillis and Contini 1966); legs of 0.491 of stature give the same statures within 2 cm in the median.
    crown_share: float = 0.05


def stature(skeleton: Skeleton, rule: StatureRule | None = None) -> float:
    r"""Height of the person, in the skeleton's unit: a derived figure, not a measured one.

    .. math:: H = (\text{leg} + \text{hips to head, upright}) / (1 - s_{sole} - s_{crown})

    Raises
    ------
    InputError
        If the skeleton lacks a bone that the rule names.
    """
    rule = rule or StatureRule()
    rest, up = skeleton.rest_pose(), "xyz".index(rule.up)
    for bone in {bone for leg in rule.legs for bone in leg} - set(skeleton.bones):
        raise InputError(f"the skeleton has no bone {bone!r}, which the rule for the stature needs; name its own bones there")
    leg = float(np.mean([sum(skeleton.bones[bone].length for bone in leg) for leg in rule.legs]))
    upper = _landmark(rest, (rule.head,))[up] - _landmark(rest, rule.hips)[up]
    return (leg + float(upper)) / (1 - rule.sole_share - rule.crown_share)
