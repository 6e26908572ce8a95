"""Describe what a report must know of the scene beyond the numbers: the kind of each joint and force, and what a
section cuts.

The kinds decide the units that the results alone leave open: a pin's drive is a torque, a slide's a force.
"""

from __future__ import annotations

from collections.abc import Collection, Mapping
from types import MappingProxyType
from typing import Any

import numpy as np

from heuncli.base import tolerances
from heuncli.base.joint_kinds import TYPES, JointKind
from heuncli.base.load_kinds import LOAD_KINDS
from heuncli.base.named_tuples import NamedTuple
from heuncli.base.records import record
from heuncli.scene.file_format.labels import GROUND
from heuncli.scene.file_format.loads import Friction
from heuncli.scene.file_format.models import End, Force, Section, Sensor, Spec, Stop, Vec
from heuncli.scene.shapes.section_axes import choose_default_axis, find_nearest_axis
from heuncli.study.quantities.table_units import Units

AXES = ("x", "y", "z")
MOMENT_POINTS = {"at": "the cut's point", "centroid": "the cut's centroid", "line": "the cut's point, and Heun's line"}


class JointInfo(NamedTuple):
    """A joint's type, its two ends as `body.point`, and where its two bearings are along its axis, if it has them."""

    type: str
    first_end: str
    second_end: str
    bearings: tuple[float, ...] = ()


class ForceInfo(NamedTuple):
    """A force's type, the joint it acts in if it does, and whether it resists turning if the type leaves that open."""

    type: str
    joint: str | None = None
    turning: bool | None = None


class StopInfo(NamedTuple):
    """The coordinate that a stop limits, as `joint.coordinate`, its limits [rad] or [m], and its restitution.

    latch: whether it is one
    catch: where a latch catches: a value, the name of a stop, or None for wherever the coordinate is
    """

    coordinate: str
    low: float | None
    high: float | None
    restitution: float = 0.0
    latch: bool = False
    catch: float | str | None = None


class SectionInfo(NamedTuple):
    """The body that is cut, the first axis, and the point of the moments, in words."""

    body: str
    first_axis: str = "body x"
    moment_point: str = "the cut's point"


DEFAULT_UNITS = Units()
NO_ENTRIES: Mapping[str, Any] = MappingProxyType({})


@record
class Labels:
    """The kinds of everything named in the results.

    sensors: what each reads, about which point and in which axes, in words
    moment_point: the name of the ground point that M_s is taken about, if it has one
    units: the display units of tables
    captions: texts for readers in place of names, by paths such as joints.main (captions.py)
    """

    joints: Mapping[str, JointInfo] = NO_ENTRIES
    forces: Mapping[str, ForceInfo] = NO_ENTRIES
    sections: Mapping[str, SectionInfo] = NO_ENTRIES
    stops: Mapping[str, StopInfo] = NO_ENTRIES
    sensors: Mapping[str, str] = NO_ENTRIES
    moment_point: str | None = None
    units: Units = DEFAULT_UNITS
    captions: Mapping[str, str] = NO_ENTRIES

    def is_rotational(self, block: str, name: str) -> bool:
        """Return whether a quantity of `block` is rotational for `name`: this decides between its two units."""
        if block == "coordinates":
            return self._find_joint_kind(name).coordinates == ("angle",)
        if block == "joints":
            return self._find_joint_kind(name).drives == ("angle",)
        return self._is_force_rotational(self.forces.get(name))

    def _find_joint_kind(self, joint: str | None) -> JointKind:
        """Return the kind of a joint; that of a pin for an unknown one."""
        info = self.joints.get(joint or "")
        return TYPES[info.type if info else "pin"]

    def _is_force_rotational(self, force: ForceInfo | None) -> bool:
        """Return whether a load is a torque."""
        if force is None:
            return False
        if force.turning is not None:
            return force.turning
        return (LOAD_KINDS[force.type].unit or self._find_joint_kind(force.joint).load_unit) == "N·m"


def distinguish(name: str, words: Collection[str], kind: str = "force") -> str:
    """Append its kind to a name that the table uses for its own numbers; return other names unchanged."""
    return f"{name} ({kind})" if name in words else name


def make_unit_labels(spec: Spec) -> Labels:
    """Make labels that suffice to find units: the kinds of joints and forces, and the bodies that joints connect."""
    joints = {name: JointInfo(joint.kind, joint.a, joint.b) for name, joint in spec.joints.items()}
    forces = {name: _make_force_info(force) for name, force in spec.forces.items()}
    return Labels(joints, forces, captions=spec.labels)


def make_labels(spec: Spec) -> Labels:
    """Make the labels of a loaded spec."""
    joints = {
        name: JointInfo(
            j.kind,
            _format_end(End(j.a, j.p, j.p_name)),
            _format_end(End(j.b, j.q, j.q_name)),
            j.bearings.at if j.bearings is not None else (),
        )
        for name, j in spec.joints.items()
    }
    forces = {name: _make_force_info(force) for name, force in spec.forces.items()}
    sections = {name: _make_section_info(section) for name, section in spec.sections.items()}
    moment_point = spec.foundation.about or (0.0, 0.0, 0.0)
    point_name = next((name for name, point in spec.ground.points.items() if tuple(point) == tuple(moment_point)), None)
    stops = {name: _make_stop_info(stop) for name, stop in {**spec.stops, **spec.latches}.items()}
    sensors = {name: _describe_sensor(sensor) for name, sensor in spec.sensors.items()}
    return Labels(joints, forces, sections, stops, sensors, point_name, captions=spec.labels)


def _describe_sensor(sensor: Sensor) -> str:
    """Describe what a sensor reads: "main, about arm.flange, in the axes of arm"."""
    about = "" if sensor.point is None else f", about {_format_end(sensor.point)}"
    axes = "world axes" if sensor.body == GROUND else f"in the axes of {sensor.body}"
    return f"{sensor.joint or sensor.section}{about}, {axes}"


def _make_stop_info(stop: Stop[str]) -> StopInfo:
    """Collect what tables say of a stop."""
    coordinate, latch = f"{stop.joint}.{stop.quantity}", stop.latch
    if latch is None:
        return StopInfo(coordinate, stop.low, stop.high, stop.restitution)
    return StopInfo(coordinate, None, None, latch=True, catch=latch.position if latch.stop is None else latch.stop)


def _make_force_info(force: Force) -> ForceInfo:
    """Collect what tables say of a load."""
    turning = force.torque is not None or force.radius is not None if isinstance(force, Friction) else None
    return ForceInfo(force.type, getattr(force, "joint", None), turning)


def _make_section_info(section: Section) -> SectionInfo:
    """Collect what tables say of a section."""
    moment_point = section.reduce_to
    return SectionInfo(
        section.body,
        _describe_first_axis(section),
        MOMENT_POINTS[moment_point] if isinstance(moment_point, str) else _format_end(moment_point),
    )


def _describe_first_axis(section: Section) -> str:
    """Describe e1: as given, or the body axis that it is made of and the one that n is nearest to."""
    if section.first_axis is not None:
        return f"body {_format_vector(section.first_axis)}"
    n = np.asarray(section.normal, dtype=float)
    n = n / np.sqrt(n @ n)
    axis = choose_default_axis(n)
    askew = abs(float(n[axis])) > tolerances.PARALLEL
    construction = f", made perpendicular to n (n is closest to body {AXES[find_nearest_axis(n)]})" if askew else ""
    return f"body {AXES[axis]}{construction}"


def _format_end(end: End) -> str:
    """Format an end as `body.point`, or with its coordinates in body axes if the point has no name."""
    return f"{end.body}.{end.name}" if end.name else f"{end.body} at {_format_vector(end.point)}"


def _format_vector(vector: Vec) -> str:
    """Format a vector to six digits."""
    return f"({', '.join(f'{component:.6g}' for component in vector)})"
