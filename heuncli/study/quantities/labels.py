"""What a report must know of the scene beyond the numbers: of what kind each joint and force is, what a section cuts.

From the kinds follow the units that the results alone do not determine: a pin's drive is a torque, a slide's a force.
"""

from __future__ import annotations

from collections.abc import Collection, Mapping
from types import MappingProxyType
from typing import Any

import numpy as np

from heuncli.base import tolerances
from heuncli.base.joint_kinds import TYPES, Kind
from heuncli.base.named_tuples import NamedTuple
from heuncli.base.records import record
from heuncli.loads.kinetostatics.section_axes import default_axis, nearest_axis
from heuncli.scene.file_format.models import End, Force, Friction, Section, Spec, Stop, Vec
from heuncli.study.quantities.table_units import Units

PUSHING_FORCES = frozenset({"force", "distributed", "bushing", "actuator", "spring"})
AXES = ("x", "y", "z")
ABOUT = {"at": "the cut's point", "centroid": "the cut's centroid", "line": "the cut's point, and Heun's line"}


class JointInfo(NamedTuple):
    """A joint's type and its two ends as `body.point`."""

    type: str
    from_: str
    to: str


class ForceInfo(NamedTuple):
    """A force's type, the joint it acts in if it does, and whether it resists turning if the type leaves that open."""

    type: str
    joint: str | None = None
    turning: bool | None = None


class StopInfo(NamedTuple):
    """The coordinate that a stop limits, as `joint.coordinate`, its limits [rad] or [m], and its restitution.

    latch: whether it is one; at: where that catches, by a value or the stop of a name; None: where the coordinate is.
    """

    coordinate: str
    low: float | None
    high: float | None
    restitution: float = 0.0
    latch: bool = False
    at: float | str | None = None


class SectionInfo(NamedTuple):
    """The body cut, the first axis and the point of the moments, in words."""

    body: str
    first_axis: str = "body x"
    about: str = "the cut's point"


SHOWN = Units()
NONE: Mapping[str, Any] = MappingProxyType({})


@record
class Labels:
    """The kinds of everything named in the results; `about` is the ground point where M_s is taken, if one is there.

    units: in which tables show them.
    """

    joints: Mapping[str, JointInfo] = NONE
    forces: Mapping[str, ForceInfo] = NONE
    sections: Mapping[str, SectionInfo] = NONE
    stops: Mapping[str, StopInfo] = NONE
    about: str | None = None
    units: Units = SHOWN

    def turns(self, block: str, name: str) -> bool:
        """Whether it turns, not slides: which of the two units of a quantity of `block` holds for `name`."""
        if block == "coordinates":
            return self._kind(name).coordinates == ("angle",)
        if block == "joints":
            return self._kind(name).drives == ("angle",)
        return self._force_turns(self.forces.get(name))

    def _kind(self, joint: str | None) -> Kind:
        info = self.joints.get(joint or "")
        return TYPES[info.type if info else "pin"]

    def _force_turns(self, force: ForceInfo | None) -> bool:
        if force is None or force.type in PUSHING_FORCES:
            return False
        if force.turning is not None:
            return force.turning
        return force.type == "couple" or self._kind(force.joint).motions[:1] == ("turning",)


def distinguish(name: str, words: Collection[str], kind: str = "force") -> str:
    """The name, with its kind behind it where it is one of the words that the table has for its own numbers."""
    return f"{name} ({kind})" if name in words else name


def labels_for_units(spec: Spec) -> Labels:
    """What units hang on: of which kind joints and forces are; of a joint's ends the bodies alone."""
    joints = {name: JointInfo(joint.kind, joint.a, joint.b) for name, joint in spec.joints.items()}
    return Labels(joints, {name: _force(force) for name, force in spec.forces.items()})


def labels_of(spec: Spec) -> Labels:
    """The labels of a loaded spec."""
    joints = {
        name: JointInfo(j.kind, _end(End(j.a, j.p, j.p_name)), _end(End(j.b, j.q, j.q_name)))
        for name, j in spec.joints.items()
    }
    forces = {name: _force(force) for name, force in spec.forces.items()}
    sections = {name: _section(section) for name, section in spec.sections.items()}
    about = spec.foundation.about or (0.0, 0.0, 0.0)
    named = next((name for name, point in spec.ground.points.items() if tuple(point) == tuple(about)), None)
    stops = {name: _stop(stop) for name, stop in {**spec.stops, **spec.latches}.items()}
    return Labels(joints, forces, sections, stops, named)


def _stop(stop: Stop[str]) -> StopInfo:
    coordinate, latch = f"{stop.joint}.{stop.quantity}", stop.latch
    if latch is None:
        return StopInfo(coordinate, stop.low, stop.high, stop.restitution)
    return StopInfo(coordinate, None, None, latch=True, at=latch.at if latch.stop is None else latch.stop)


def _force(force: Force) -> ForceInfo:
    turning = force.torque is not None or force.radius is not None if isinstance(force, Friction) else None
    return ForceInfo(force.type, getattr(force, "joint", None), turning)


def _section(section: Section) -> SectionInfo:
    about = section.reduce_to
    return SectionInfo(section.body, _first_axis(section), ABOUT[about] if isinstance(about, str) else _end(about))


def _first_axis(section: Section) -> str:
    """e1 in words: as given, else the body axis that it is made of, with the one beside which it is the first."""
    if section.first_axis is not None:
        return f"body {_vector(section.first_axis)}"
    n = np.asarray(section.normal, dtype=float)
    n = n / np.sqrt(n @ n)
    axis = default_axis(n)
    askew = abs(float(n[axis])) > tolerances.PARALLEL
    why = f" made perpendicular to n, which is nearest to body {AXES[nearest_axis(n)]}" if askew else ""
    return f"body {AXES[axis]}{why}"


def _end(end: End) -> str:
    """An end as `body.point`, or with its coordinates in body axes where the point has no name."""
    return f"{end.body}.{end.name}" if end.name else f"{end.body} at {_vector(end.point)}"


def _vector(vector: Vec) -> str:
    return f"({', '.join(f'{component:.6g}' for component in vector)})"
