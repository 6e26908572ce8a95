"""Which quantities the tables show, under which heading, by which short names.

A block is one table of the report, a group what belongs to one name in it, a row one number over the instants. The rows
of BLOCKS say which quantities of which kind go into a block; the walk over the results does the rest.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable
from typing import NamedTuple

import numpy as np

from heuncli.report.labels import Labels
from heuncli.report.numbers import OPEN, OPEN_NOTE
from heuncli.report.quantities import Series
from heuncli.results import Array, Results
from heuncli.results_schema import XYZ


class Row(NamedTuple):
    """One number over the instants, (n_t,). Rows of one `family` share their decimals.

    An `even` one is a magnitude: never negative, with a kink at zero that its square does not have. Components and
    magnitude of one vector have its symbol as `vector`.
    """

    label: str
    unit: str
    family: str
    values: Array
    even: bool = False
    vector: str = ""


class Group(NamedTuple):
    """The rows of one joint, force, ...; `note` says what it is, `whole` that it stands for the scene as a whole."""

    name: str
    note: str
    rows: tuple[Row, ...]
    whole: bool = False


class Block(NamedTuple):
    """One table of the report before it is laid out; `what` heads the column of the groups' names.

    `missing` is what stands for nan, and the note that explains it.
    """

    key: str
    heading: str
    what: str
    groups: tuple[Group, ...]
    notes: tuple[str, ...] = ()
    missing: tuple[str, str] = (OPEN, OPEN_NOTE)


class Plan(NamedTuple):
    """How a kind of results becomes a block: the quantities in their order, and the text about it.

    `only` takes one name of the kind. What is not `lasting` (a line in space) has no extremes: it shows at instants.
    `missing` as in Block.
    """

    key: str
    kind: str
    what: str
    quantities: tuple[str, ...]
    heading: Callable[[Results, Labels], str]
    note: Callable[[str, Labels], str] = lambda name, labels: ""
    only: str | None = None
    lasting: bool = True
    missing: tuple[str, str] = (OPEN, OPEN_NOTE)


# Vector -> the short name its components begin with. What is not listed is called by its own name.
SYMBOLS = {
    "force": "F",
    "moment": "M",
    "moment_orbital": "M orbital ",
    "moment_spin": "M spin ",
    "position": "",
    "center": "",
    "velocity": "v",
    "center_velocity": "v",
    "acceleration": "a",
    "center_acceleration": "a",
    "angular_velocity": "ω",
    "angular_acceleration": "α",
}
# Quantities that share their decimals with another: a noise in one is told from its companions.
FAMILIES = {
    **dict.fromkeys(("axial", "radial", "tension", "N", "Q1", "Q2"), "force"),
    **dict.fromkeys(("tilting", "T", "M1", "M2", "moment_orbital", "moment_spin"), "moment"),
}
STRESSES = ("normal_max", "normal_min", "shear_torsion", "shear_mean", "mises", "utilisation")
PLACES = frozenset({"position", "center", "point", "direction"})  # vectors whose length tells nothing
EVEN = frozenset({"radial", "tilting"})
FREE = "nothing stands on the ground: the scene is free"
POINTS = ("the origin", "the point")
SPOKEN_UNITS = {"Pa": ("MPa", 1e-6)}  # what the tables say instead, and how large it is
NO_AXIS = ("none", "none: there is no force, so no axis")


def _about(results: Results, labels: Labels) -> str:
    about = np.asarray(results.foundation.get("about", (0.0, 0.0, 0.0))) + 0.0
    x, y, z = (f"{component:.6g}" for component in about)
    return f"{labels.about} = ({x}, {y}, {z}) m" if labels.about else f"{POINTS[bool(about.any())]} ({x}, {y}, {z}) m"


def _joint_note(name: str, labels: Labels) -> str:
    info = labels.joints.get(name)
    return f"{info.type}, {info.from_} → {info.to}" if info else ""


def _force_note(name: str, labels: Labels) -> str:
    info = labels.forces.get(name)
    return (f"{info.type} on {info.joint}" if info.joint else info.type) if info else ""


def _section_note(name: str, labels: Labels) -> str:
    info = labels.sections.get(name)
    return f"{info.body}; e1 = {info.first_axis}; moments about {info.about}" if info else ""


def _foundation_note(name: str, labels: Labels) -> str:
    kind, _, own = name.partition(" ")
    notes = {"support": _joint_note, "element": _force_note}
    return notes[kind](own, labels) if kind in notes else ""


FOUNDATION = Plan(
    "foundation",
    "foundation",
    "",
    ("force", "moment"),
    lambda results, labels: (
        f"FOUNDATION  force and moment ON the ground, world axes, moment about {_about(results, labels)}"
    ),
    _foundation_note,
)
MASS_EFFECT = Plan(
    "foundation",
    "foundation",
    "",
    ("force", "moment_orbital", "moment_spin"),
    lambda results, labels: (
        "MASS EFFECT  F = Σ m ẍ, orbital and spin moment the rates of Σ m x × ẋ and Σ I σ,"
        f" world axes, about {_about(results, labels)}"
    ),
    only="mass_effect",
)
BLOCKS = (
    Plan(
        "motion",
        "bodies",
        "body",
        ("center", "center_velocity", "center_acceleration", "angular_velocity", "angular_acceleration"),
        lambda results, labels: "MOTION  of the centres of mass, and angular velocity of the bodies, world axes",
    ),
    Plan(
        "motion",
        "coordinates",
        "joint",
        ("angle", "rate", "travel", "speed", "acceleration", "angular_acceleration"),
        lambda results, labels: 'COORDINATES  of the joints, of "to" against "from"',
        _joint_note,
    ),
    Plan(
        "points",
        "points",
        "point",
        ("position", "velocity", "acceleration"),
        lambda results, labels: "POINTS  world axes",
    ),
    FOUNDATION,
    MASS_EFFECT,
    Plan(
        "foundation",
        "foundation",
        "",
        ("point", "direction", "pitch"),
        lambda results, labels: "CENTRAL AXIS  of the foundation's wrench: its point nearest the moment's, world axes",
        only="axis",
        lasting=False,
        missing=NO_AXIS,
    ),
    Plan(
        "joints",
        "joints",
        "joint",
        ("force", "moment", "axial", "radial", "tilting", "tension", "drive"),
        lambda results, labels: (
            'JOINTS  what "from" exerts ON "to" (drive, friction apart), world axes, moment about the "to" point'
        ),
        _joint_note,
    ),
    Plan(
        "sections",
        "sections",
        "section",
        ("N", "Q1", "Q2", "T", "M1", "M2", *STRESSES),
        lambda results, labels: "SECTIONS  the piece beyond the cut ON the part before it; N > 0 tension; e2 = n × e1",
        _section_note,
    ),
    Plan(
        "forces",
        "forces",
        "force",
        ("value", "length", "rate", "power"),
        lambda results, labels: "FORCES  value, length of its line, rate of its length or turning, power it puts in",
        _force_note,
    ),
    Plan(
        "energy",
        "energy",
        "",
        ("kinetic", "potential", "work"),
        lambda results, labels: "ENERGY  potential from the world's origin; kinetic + potential − work is constant",
    ),
)


def build(plan: Plan, results: Results, labels: Labels, series: Iterable[Series]) -> Block | None:
    """The block of one plan out of the walked series of its kind; None where there is nothing to show.

    Runs of cuts are left to report/runs.py.
    """
    runs = {name for name, section in results.sections.items() if "s" in section} if plan.kind == "sections" else set()
    named: dict[str, dict[str, Series]] = {}
    for item in series:
        if item.kind != plan.kind or item.quantity not in plan.quantities or plan.only not in (None, item.name):
            continue
        if plan is FOUNDATION and item.name == MASS_EFFECT.only:
            continue
        if item.name.split(".")[0] not in runs:
            named.setdefault(item.name.removesuffix(".stress"), {})[item.quantity] = item
    groups = []
    for name, own in named.items():
        rows = [row for quantity in plan.quantities if quantity in own for row in rows_of(own[quantity])]
        label = _group_name(plan, name)
        groups.append(Group(label, plan.note(label, labels), tuple(rows), whole=not name))
    notes: tuple[str, ...] = ()
    if plan is FOUNDATION:
        groups, notes = _supports(groups, results)
    if plan.kind == "joints":
        notes = _chosen(results)
    if plan.kind == "energy" and groups:
        groups = [_with_sum(groups[0])]
    heading = plan.heading(results, labels)
    return Block(plan.key, heading, plan.what, tuple(groups), notes, plan.missing) if groups else None


def rows_of(series: Series) -> list[Row]:
    """The rows of one quantity: itself, or its components and the magnitude of a free vector."""
    quantity, (unit, size) = series.quantity, SPOKEN_UNITS.get(series.unit, (series.unit, 1.0))
    spoken, family = quantity.replace("_", " "), FAMILIES.get(quantity, quantity)
    if len(series.components) == 1:
        return [Row(spoken, unit, family, size * series.values[:, 0], even=quantity in EVEN)]
    symbol = SYMBOLS.get(quantity, f"{spoken} ")
    vector = "" if quantity in PLACES else symbol.strip()
    columns = zip(series.components, series.values.T, strict=True)
    rows = [Row(f"{symbol}{component}", unit, family, column, vector=vector) for component, column in columns]
    if series.components == XYZ and vector:
        squares = np.einsum("ij,ij->i", series.values, series.values)
        rows.append(Row(f"|{vector}|", unit, family, np.sqrt(squares), even=True, vector=vector))
    return rows


def _group_name(plan: Plan, name: str) -> str:
    if plan is not FOUNDATION:
        return "" if plan.only else name
    return name.replace("supports.", "support ", 1).replace("elements.", "element ", 1) or "total"


def _supports(groups: list[Group], results: Results) -> tuple[list[Group], tuple[str, ...]]:
    """Groups and notes of the foundation: a support alone is the total, apart from the point of its moment."""
    supports, elements = results.foundation.get("supports", {}), results.foundation.get("elements", {})
    if not supports and not elements:
        return groups, (FREE,)
    if len(supports) == 1 and not elements:
        only = f"all of it goes through {next(iter(supports))}, the only support"
        return [group for group in groups if group.whole], (only,)
    return groups, ('supports: moment about the joint\'s "to" point; elements: about their own point',)


def _chosen(results: Results) -> tuple[str, ...]:
    """Which components stand for one choice among many."""
    chosen = [
        f"{name} {' '.join(short(component) for component in joint['chosen'])}"
        for name, joint in results.joints.items()
        if joint.get("chosen")
    ]
    return (f"chosen, not certain: {', '.join(chosen)}",) if chosen else ()


def short(component: str) -> str:
    """A component as the tables call it: `force.z` is `Fz`; others keep their name."""
    quantity, _, axis = component.partition(".")
    return f"{SYMBOLS[quantity]}{axis}" if axis in XYZ and quantity in SYMBOLS else component


def _with_sum(group: Group) -> Group:
    """The energies and their constant sum, for the eye."""
    part = {row.label: row.values for row in group.rows}
    if not {"kinetic", "potential", "work"} <= part.keys():
        return group
    total = part["kinetic"] + part["potential"] - part["work"]
    return Group(group.name, group.note, (*group.rows, Row("sum", "J", "sum", total)), whole=True)
