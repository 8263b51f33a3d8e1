"""Reading Acclaim skeletons (ASF) and motions (AMC); every complaint names the file and the line."""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass, field
from pathlib import Path
from typing import NoReturn

import numpy as np

from walklab.capture.acclaim_skeleton import ROOT, Bone, Motion, Root, Skeleton
from walklab.errors import InputError

# No length or angle of a person comes near; beyond, sums and squares of what is read would overflow.
LARGEST = 1e6
LONGEST_FRAME_NUMBER = 12


@dataclass
class _Lines:
    """The lines of a file that carry content, with their numbers; one can be handed back."""

    path: Path
    content: list[tuple[int, list[str]]]
    at: int = 0

    def __iter__(self) -> Iterator[list[str]]:
        while self.at < len(self.content):
            self.at += 1
            yield self.content[self.at - 1][1]

    def back(self) -> None:
        self.at -= 1

    def fail(self, problem: str) -> NoReturn:
        number = self.content[self.at - 1][0] if self.at else 1
        raise InputError(f"{self.path}, line {number}: {problem}")

    def numbers(self, words: list[str], count: int, what: str) -> tuple[float, ...]:
        if len(words) != count:
            self.fail(f"{what} needs {count} numbers, has {len(words)}; correct the line")
        try:
            values = tuple(float(word) for word in words)
        except ValueError:
            self.fail(f"{what} has a value that is no number in {' '.join(words)!r}; correct the line")
        if not all(math.isfinite(value) for value in values):
            self.fail(f"{what} is not finite: {' '.join(words)!r}; correct the line")
        if max(map(abs, values), default=0.0) > LARGEST:
            self.fail(f"{what} is larger than {LARGEST:g}: {' '.join(words)!r}; correct the line")
        return values


def _read_lines(path: str | Path, kind: str) -> _Lines:
    source = Path(path)
    try:
        text = source.read_text(encoding="utf-8")
    except (OSError, UnicodeDecodeError) as error:
        raise InputError(f"{source}: not a readable {kind} file ({error}); check the path") from error
    content = []
    for number, line in enumerate(text.splitlines(), start=1):
        words = line.partition("#")[0].split()
        if words:
            content.append((number, words))
    if not content:
        raise InputError(f"{source}, line 1: the file is empty; an {kind} file was expected")
    return _Lines(source, content)


@dataclass
class _Draft:
    """What has been read of an ASF file so far."""

    radians: bool = False
    root: Root | None = None
    bones: dict[str, dict] = field(default_factory=dict)
    parents: dict[str, str] = field(default_factory=dict)


def read_skeleton(path: str | Path) -> Skeleton:
    """Read an ASF file.

    Lengths stay in units of the file; angles become radians.

    Raises
    ------
    InputError
        One line with file and line number: unreadable number, unknown axis order or channel, a bone without
        direction or length, a hierarchy that names an unknown bone, gives a bone two parents or does not reach it.
    """
    lines, draft = _read_lines(path, "ASF"), _Draft()
    for words in lines:
        section = words[0].lower()
        if section == ":units":
            _read_units(lines, draft)
        elif section == ":root":
            draft.root = _read_root(lines, draft)
        elif section == ":bonedata":
            _read_bones(lines, draft)
        elif section == ":hierarchy":
            _read_hierarchy(lines, draft)
    if draft.root is None:
        lines.fail("the file ends without a :root section; is it an ASF file?")
    if not draft.bones:
        lines.fail("the file ends without any bone; is it an ASF file?")
    return Skeleton(draft.root, _ordered(lines, draft))


def _in_section(lines: _Lines) -> Iterator[list[str]]:
    """The lines up to the next section."""
    for words in lines:
        if words[0].startswith(":"):
            lines.back()
            return
        yield words


def _read_units(lines: _Lines, draft: _Draft) -> None:
    for words in _in_section(lines):
        if words[0].lower() == "angle":
            if words[1:] not in (["deg"], ["rad"]):
                lines.fail(f"angle unit must be deg or rad, not {' '.join(words[1:])!r}")
            draft.radians = words[1] == "rad"


def _angles(draft: _Draft, values: tuple[float, ...]) -> tuple[float, ...]:
    return values if draft.radians else tuple(math.radians(value) for value in values)


def _axis_order(lines: _Lines, word: str) -> str:
    if sorted(word.lower()) != ["x", "y", "z"]:
        lines.fail(f"axis order must be an order of XYZ, not {word!r}")
    return word.lower()


def _read_root(lines: _Lines, draft: _Draft) -> Root:
    values: dict = {"channels": ("tx", "ty", "tz", "rx", "ry", "rz")}
    for words in _in_section(lines):
        key, rest = words[0].lower(), words[1:]
        if key == "order":
            values["channels"] = tuple(word.lower() for word in rest)
            if len(set(rest)) != len(rest) or not set(values["channels"]) <= {"tx", "ty", "tz", "rx", "ry", "rz"}:
                lines.fail(f"root order must list TX TY TZ RX RY RZ once each at most, not {' '.join(rest)!r}")
        elif key == "axis":
            values["axis_order"] = _axis_order(lines, rest[0] if rest else "")
        elif key == "position":
            values["position"] = lines.numbers(rest, 3, "root position")
        elif key == "orientation":
            values["orientation_rad"] = _angles(draft, lines.numbers(rest, 3, "root orientation"))
    return Root(**values)


def _read_bones(lines: _Lines, draft: _Draft) -> None:
    for words in _in_section(lines):
        if words[0].lower() != "begin":
            lines.fail(f"a bone starts with 'begin', not {words[0]!r}")
        bone = _read_bone(lines, draft)
        if bone["name"] in draft.bones or bone["name"] == ROOT:
            lines.fail(f"bone {bone['name']!r} is described twice; keep one")
        draft.bones[bone["name"]] = bone


def _read_bone(lines: _Lines, draft: _Draft) -> dict:
    bone: dict = {}
    for words in lines:
        key, rest = words[0].lower(), words[1:]
        if key == "end":
            for needed in ("name", "direction", "length"):
                if needed not in bone:
                    lines.fail(f"bone {bone.get('name', '?')!r} has no {needed}; add it")
            return bone
        if key == "name":
            bone["name"] = rest[0] if rest else lines.fail("a bone's name is empty")
        elif key == "direction":
            bone["direction"] = _direction(lines, lines.numbers(rest, 3, "direction"))
        elif key == "length":
            bone["length"] = lines.numbers(rest, 1, "length")[0]
            if bone["length"] < 0:
                lines.fail(f"length is negative: {bone['length']}")
        elif key == "axis":
            bone["axis_order"] = _axis_order(lines, rest[3] if len(rest) == 4 else "")
            bone["axis_rad"] = _angles(draft, lines.numbers(rest[:3], 3, "axis"))
        elif key == "dof":
            bone["channels"] = _channels(lines, rest)
        elif key == "begin" or key.startswith(":"):
            lines.fail("the bone before it has no 'end'; add it")
    return lines.fail("the file ends inside a bone; it seems to be cut off")


def _direction(lines: _Lines, values: tuple[float, ...]) -> tuple[float, ...]:
    norm = math.hypot(*values)
    if abs(norm - 1) > 0.01:
        lines.fail(f"direction has length {norm:.4g}, not 1; correct the line")
    return tuple(value / norm for value in values)


def _channels(lines: _Lines, words: list[str]) -> str:
    channels = [word.lower() for word in words]
    if not channels or len(set(channels)) != len(channels) or not set(channels) <= {"rx", "ry", "rz"}:
        lines.fail(
            f"dof must list rotations rx ry rz once each at most, not {' '.join(words)!r}; sliding joints are not supported"
        )
    return "".join(channel[1] for channel in channels)


def _read_hierarchy(lines: _Lines, draft: _Draft) -> None:
    for words in _in_section(lines):
        if words[0].lower() in ("begin", "end"):
            continue
        for name in words:
            if name != ROOT and name not in draft.bones:
                lines.fail(f"the hierarchy names bone {name!r}, which :bonedata does not describe")
        for name in words[1:]:
            if name in draft.parents or name == ROOT:
                lines.fail(f"the hierarchy gives {name!r} a second parent")
            draft.parents[name] = words[0]


def _ordered(lines: _Lines, draft: _Draft) -> dict[str, Bone]:
    """Parents before children; fails if a bone cannot be reached from the root."""
    ordered: dict[str, Bone] = {}
    waiting = dict(draft.bones)
    while waiting:
        ready = [name for name in waiting if draft.parents.get(name) == ROOT or draft.parents.get(name) in ordered]
        if not ready:
            lines.fail(f"the hierarchy does not connect {sorted(waiting)} to the root")
        for name in ready:
            ordered[name] = Bone(parent=draft.parents[name], **waiting.pop(name))
    return ordered


def read_motion(path: str | Path, skeleton: Skeleton) -> Motion:
    """Read an AMC file made for a skeleton.

    Frame numbers may start anywhere but must go on by one: a missing frame is a gap in time.

    Raises
    ------
    InputError
        One line with file and line number: unknown bone, wrong number of values, no number, a bone that is
        missing from or repeated in a frame, frame numbers that do not follow each other, no frames.
    """
    lines = _read_lines(path, "AMC")
    counts = {bone.name: len(bone.channels) for bone in skeleton.bones.values() if bone.channels}
    counts[ROOT] = len(skeleton.root.channels)
    columns: dict[str, list[tuple[float, ...]]] = {name: [] for name in counts}
    degrees, number, frames = True, 0, 0
    for words in lines:
        name = words[0]
        if name.startswith(":"):
            degrees = degrees and name.upper() != ":RADIANS"
        elif name.isdecimal() and len(words) == 1:
            if len(name) > LONGEST_FRAME_NUMBER:
                lines.fail(f"a frame number has {len(name)} digits; correct the line")
            _check_frame(lines, columns, frames)
            if frames and int(name) != number + 1:
                lines.fail(f"frame {name} follows frame {number}; the recording has a gap, cut it there")
            number, frames = int(name), frames + 1
        else:
            if not frames:
                lines.fail(f"{name!r} comes before the first frame number; is it an AMC file?")
            if name not in counts:
                lines.fail(f"bone {name!r} is not one the skeleton moves; does this motion belong to another skeleton?")
            if len(columns[name]) == frames:
                lines.fail(f"bone {name!r} appears twice in frame {number}")
            columns[name].append(lines.numbers(words[1:], counts[name], f"bone {name!r}"))
    if not frames:
        lines.fail("the file has no frames; is it an AMC file?")
    _check_frame(lines, columns, frames)
    return _motion(skeleton, {name: np.array(values) for name, values in columns.items()}, degrees)


def _check_frame(lines: _Lines, columns: dict[str, list[tuple[float, ...]]], frames: int) -> None:
    for name, values in columns.items():
        if len(values) != frames:
            lines.fail(f"the frame before it lacks bone {name!r}; the file seems to be cut off or damaged")


def _motion(skeleton: Skeleton, values: dict[str, np.ndarray], degrees: bool) -> Motion:
    factor = math.pi / 180 if degrees else 1.0
    root = values.pop(ROOT)
    turning = np.array([factor if channel[0] == "r" else 1.0 for channel in skeleton.root.channels])
    return Motion(root * turning, {name: angles * factor for name, angles in values.items()})
