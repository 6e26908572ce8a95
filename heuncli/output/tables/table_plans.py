"""Plans of the tables: which quantities they show, under which heading, with which note on each object.

A plan is one table of the report: it takes the named quantities of one kind of results, in their order.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from heuncli.base.joint_kinds import TYPES
from heuncli.base.load_kinds import LOAD_KINDS
from heuncli.base.named_tuples import NamedTuple
from heuncli.results.results import Results
from heuncli.results.results_schema import RESULTANTS, STRESSES
from heuncli.study.quantities.digits import OPEN, OPEN_NOTE
from heuncli.study.quantities.labels import Labels

BEARING = ".bearings."  # in the names of a joint's bearings
POINT_PHRASES = ("the origin", "the point")
NO_AXIS = ("none", "none: no axis, the force is zero")


class TablePlan(NamedTuple):
    """How a kind of results becomes a block: the quantities in their order, and the texts.

    what: heads the column of names
    only: takes one name of the kind
    has_extremes: False for a line in space, which is shown at instants only
    missing: the text for nan, and the note that explains it
    part: takes only the names that have this word, which other plans of the kind do not take
    is_detail: whether it is shown only to those who request its report
    """

    key: str
    kind: str
    what: str
    quantities: tuple[str, ...]
    heading: Callable[[Results, Labels], str]
    note: Callable[[str, Labels], str] = lambda name, labels: ""
    only: str | None = None
    has_extremes: bool = True
    missing: tuple[str, str] = (OPEN, OPEN_NOTE)
    part: str = ""
    is_detail: bool = False

    @property
    def is_foundation(self) -> bool:
        """Whether it shows the foundation's total with its supports and elements."""
        return self.kind == "foundation" and self.only is None


def _format_moment_point(results: Results, labels: Labels) -> str:
    unit, per_si = labels.units.find("m")
    point = per_si * np.asarray(results.foundation.get("about", (0.0, 0.0, 0.0))) + 0.0
    place = f"({', '.join(f'{component:.6g}' for component in point)}) {unit}"
    return f"{labels.moment_point} = {place}" if labels.moment_point else f"{POINT_PHRASES[bool(point.any())]} {place}"


def _format_axes(results: Results) -> str:
    """Format the axes in which joint loads are given."""
    body = results.model.get("axes")
    return f'axes of the "{body}" body' if body else "world axes"


def _make_joint_note(name: str, labels: Labels) -> str:
    info = labels.joints.get(name)
    return f"{info.type}, {info.first_end} → {info.second_end}" if info else ""


def _make_bearing_note(name: str, labels: Labels) -> str:
    joint, _, number = name.partition(BEARING)
    info = labels.joints.get(joint)
    if info is None or not info.bearings:
        return ""
    unit, per_si = labels.units.find("m")
    return f"at {per_si * info.bearings[int(number)]:.6g} {unit} along the axis"


def _make_sensor_note(name: str, labels: Labels) -> str:
    return labels.sensors.get(name, "")


def _make_force_note(name: str, labels: Labels) -> str:
    info = labels.forces.get(name)
    if info is None or not info.joint:
        return LOAD_KINDS[info.type].display_name if info else ""
    joint = labels.joints.get(info.joint)
    slides = joint is not None and "angle" not in TYPES[joint.type].coordinates
    kind = "force" if info.type == "torque" and slides else LOAD_KINDS[info.type].display_name
    return f"{kind} on {info.joint}"


def _make_stop_note(name: str, labels: Labels) -> str:
    info = labels.stops.get(name)
    if info is None:
        return ""
    unit, per_si = labels.units.find("rad" if info.coordinate.endswith(".angle") else "m")
    if info.latch:
        place = (
            f" at {per_si * info.catch:.6g} {unit}" if isinstance(info.catch, float) else f" at the stop {info.catch}"
        )
        return f"latch, {info.coordinate}{place if info.catch is not None else ''}"
    limits = (("≥", info.low), ("≤", info.high))
    limit_texts = [f"{word} {per_si * limit:.6g}" for word, limit in limits if limit is not None]
    return f"{info.coordinate} {' and '.join(limit_texts)} {unit}"


def _name_stop_load(labels: Labels) -> str:
    """Return "force", "moment" or both, for what the stops of a scene exert."""
    turning = {info.coordinate.endswith(".angle") for info in labels.stops.values()}
    return "force or moment" if len(turning) != 1 else "moment" if True in turning else "force"


def _make_section_note(name: str, labels: Labels) -> str:
    info = labels.sections.get(name)
    return f"{info.body}; e1 = {info.first_axis}; moments about {info.moment_point}" if info else ""


def _make_foundation_note(name: str, labels: Labels) -> str:
    kind, _, object_name = name.partition(" ")
    if kind == "element" and object_name in labels.stops:
        return ("" if labels.stops[object_name].latch else "stop, ") + _make_stop_note(object_name, labels)
    notes = {"support": _make_joint_note, "element": _make_force_note}
    return notes[kind](object_name, labels) if kind in notes else ""


FOUNDATION = TablePlan(
    "foundation",
    "foundation",
    "",
    ("force", "moment"),
    lambda results, labels: (
        f"FOUNDATION  force and moment ON the ground, world axes, moment about {_format_moment_point(results, labels)}"
    ),
    _make_foundation_note,
)
MASS_EFFECT = TablePlan(
    "foundation",
    "foundation",
    "",
    ("force", "moment_orbital", "moment_spin"),
    lambda results, labels: (
        "MASS EFFECT  F = Σ m ẍ, moments d/dt Σ m x × ẋ (orbital) and d/dt Σ I ω (spin),"
        f" world axes, about {_format_moment_point(results, labels)}"
    ),
    only="mass_effect",
    is_detail=True,
)
AXIS = TablePlan(
    "foundation",
    "foundation",
    "",
    ("point", "direction", "pitch"),
    lambda results, labels: (
        "CENTRAL AXIS  of the foundation load, with its point nearest the moment reference point, world axes"
    ),
    only="axis",
    has_extremes=False,
    missing=NO_AXIS,
    is_detail=True,
)
JOINTS = TablePlan(
    "joints",
    "joints",
    "joint",
    ("force", "moment", "axial", "radial", "tilting", "tension", "torque", "pressure", "drive"),
    lambda results, labels: (
        f'JOINTS  reaction of "from" on "to"; drive and friction are listed separately; {_format_axes(results)}, '
        'moment about the "to" point'
    ),
    _make_joint_note,
)
BEARINGS = TablePlan(
    "joints",
    "joints",
    "bearing",
    ("radial_force", "axial"),
    lambda results, labels: (
        f'BEARINGS  load on "to" of the two bearings of a joint, across its axis and along it; {_format_axes(results)}'
    ),
    _make_bearing_note,
    part=BEARING,
)
SENSORS = TablePlan(
    "joints",
    "sensors",
    "sensor",
    ("force", "moment"),
    lambda results, labels: "SENSORS  reactions about other points, in the axes of each sensor",
    _make_sensor_note,
)
STOPS = TablePlan(
    "joints",
    "stops",
    "stop",
    ("force", "moment"),
    lambda results, labels: f'STOPS  {_name_stop_load(labels)} on "to" along the limited coordinate; 0 without contact',
    _make_stop_note,
)
COUPLING_QUANTITIES = (
    *("normal", "friction", "along", "aside", "grip", "force", "moment", "contact", "pressure_angle"),
    *("radial", "axial", "torque", "efficiency", "reserve", "tight", "slack", "tension", "last_tension"),
)
COUPLINGS = TablePlan(
    "joints",
    "couplings",
    "coupling",
    COUPLING_QUANTITIES,
    lambda results, labels: "COUPLINGS  transmitted load",
)
SECTIONS = TablePlan(
    "sections",
    "sections",
    "section",
    (*RESULTANTS, *STRESSES),
    lambda results, labels: "SECTIONS  force of the far side on the near side of the cut; N > 0 tension; e2 = n × e1",
    _make_section_note,
)
BUCKLING = TablePlan(
    "sections",
    "sections",
    "section",
    ("buckling",),
    lambda results, labels: (
        "BUCKLING  Euler's load over the largest compression along the run; 1000: any larger value, and tension"
    ),
)
ENERGY = TablePlan(
    "energy",
    "energy",
    "",
    ("kinetic", "potential", "work"),
    lambda results, labels: "ENERGY  potential relative to the world origin; kinetic + potential − work is constant",
)
FORCES = TablePlan(
    "forces",
    "forces",
    "force",
    ("value", "length", "angle", "shift", "turn", "force", "moment", "rate", "power", "reserve"),
    lambda results, labels: (
        "FORCES  force value, length or angle, rate, power"
        + ("; bushings in their own axes" if any("shift" in own for own in results.forces.values()) else "")
    ),
    _make_force_note,
)
PLANS = (
    TablePlan(
        "motion",
        "bodies",
        "body",
        ("center", "center_velocity", "center_acceleration", "angular_velocity", "angular_acceleration"),
        lambda results, labels: "MOTION  of the centres of mass, and angular motion of the bodies, world axes",
    ),
    TablePlan(
        "motion",
        "coordinates",
        "joint",
        ("angle", "rate", "travel", "speed", "acceleration", "angular_acceleration"),
        lambda results, labels: 'COORDINATES  of the joints, "to" relative to "from"',
        _make_joint_note,
    ),
    TablePlan(
        "points",
        "points",
        "point",
        ("position", "velocity", "acceleration"),
        lambda results, labels: "POINTS  world axes",
    ),
    FOUNDATION,
    MASS_EFFECT,
    AXIS,
    JOINTS,
    BEARINGS,
    SENSORS,
    STOPS,
    COUPLINGS,
    SECTIONS,
    BUCKLING,
    FORCES,
    ENERGY,
)
# Tables of an impact under its instant and names: for impulses the same tables as for loads.
IMPULSES = (
    TablePlan(
        "bodies",
        "bodies",
        "body",
        ("center_velocity_jump", "angular_velocity_jump"),
        lambda results, labels: "BODIES  changes in centre-of-mass velocity and angular velocity, world axes",
    ),
    FOUNDATION._replace(
        heading=lambda results, labels: (
            "FOUNDATION  impulse and its moment ON the ground, world axes, moment about "
            f"{_format_moment_point(results, labels)}"
        )
    ),
    AXIS._replace(
        heading=lambda results, labels: (
            "CENTRAL AXIS  of the foundation impulse, with its point nearest the moment reference point, world axes"
        ),
        missing=("none", "none: no axis, the impulse is zero"),
    ),
    JOINTS._replace(
        heading=lambda results, labels: (
            f'JOINTS  reaction impulse of "from" on "to"; drive is listed separately; {_format_axes(results)}, '
            'moment about the "to" point'
        )
    ),
    BEARINGS,
    SENSORS._replace(
        key="sensors",
        heading=lambda results, labels: "SENSORS  impulses about other points, in the axes of each sensor",
    ),
    STOPS._replace(
        key="stops",
        heading=lambda results, labels: 'STOPS  impulse on "to" along the limited coordinate',
    ),
    COUPLINGS._replace(key="couplings", heading=lambda results, labels: "COUPLINGS  transmitted impulse"),
    SECTIONS._replace(
        quantities=RESULTANTS,
        heading=lambda results, labels: (
            "SECTIONS  impulse of the far side on the near side of the cut; N > 0 tension; e2 = n × e1"
        ),
    ),
    ENERGY._replace(
        kind="",
        quantities=("energy_before", "energy_after", "energy_jump"),
        heading=lambda results, labels: "ENERGY  kinetic energy before and after",
    ),
)
