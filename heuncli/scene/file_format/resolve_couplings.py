"""Resolve couplings: follow references and fill in defaults; one function per type of entry.

For documents in which no rule found an error.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator, Mapping
from typing import Any, Protocol

from heuncli.base import tolerances
from heuncli.base.joint_kinds import TYPES
from heuncli.scene.expressions.programs import Expression
from heuncli.scene.file_format import couplings as c
from heuncli.scene.file_format import format as whole
from heuncli.scene.file_format import format_couplings as f
from heuncli.scene.file_format.fields import EndEntry
from heuncli.scene.file_format.format_couplings import RollingEntry, find_axle_direction, find_centre
from heuncli.scene.file_format.loads import Vector
from heuncli.scene.file_format.models import End, ResultCondition, Z
from heuncli.scene.file_format.segments import QUANTITY_DIMENSIONS, close_revolution, read_segments

SLACK_BELT_MESSAGE = "the slack strand of the belt {} would have to push: it needs a pretension of {} N"


class ReferenceResolver(Protocol):
    """Resolves the references of a document (resolve.py)."""

    document: whole.Document

    def end(self, end: EndEntry) -> End:
        """Return the point that an end refers to."""

    def attach_location(self, value: Expression, path: str) -> Expression:
        """Return an expression with its location in the file.

        path: dotted path of the value
        """

    def attach_locations(
        self, values: tuple[Expression, Expression, Expression], path: str, key: str = "vector"
    ) -> Vector:
        """Return the components of a vector with their locations; path: of what has the vector under a key."""


def resolve_coupling(resolver: ReferenceResolver, name: str, entry: f.CouplingEntry) -> c.Coupling:
    """Resolve a coupling entry; `name` gives the locations of its expressions."""
    resolved: c.Coupling = MEANINGS[entry.type](resolver, name, entry)
    return resolved


def resolve_ratio(resolver: ReferenceResolver, name: str, entry: f.RatioEntry) -> c.Ratio:
    """Resolve a linear relation of coordinates."""
    rows = zip(entry.of, entry.factors, strict=True)
    return c.Ratio(tuple(term(resolver, word, factor) for word, factor in rows), entry.is_)


def resolve_wheel(resolver: ReferenceResolver, entry: RollingEntry) -> c.RollingWheel:
    """Resolve an entry of `rolling`; in a planar scene every wheel is round about z."""
    joints = resolver.document.joints
    axis = (
        Z
        if resolver.document.head.space == "planar"
        else find_axle_direction(entry, joints)
        if entry.shape == "disc"
        else None
    )
    wheel = find_centre(entry, joints)
    assert wheel is not None
    return c.RollingWheel(
        resolver.end(wheel), axis, entry.radius, resolver.end(entry.on),
        entry.normal, entry.friction, entry.slides is not None, entry.held,
    )  # fmt: skip


def iter_wheel_conditions(rolling: Mapping[str, RollingEntry]) -> Iterator[ResultCondition]:
    """Yield the conditions of wheels: one that lifts off its plane ends the motion, one that slips is reported."""
    for name, entry in rolling.items():
        if not entry.held:
            why = f"the wheel {name} lifts off: its plane would have to pull it"
            yield make_below_zero_condition(f"{name}_lifts", f"couplings.{name}.normal", why, ends=True)
        if entry.friction is not None:
            why = f"the wheel {name} slips: rolling would need more friction than available"
            yield make_below_zero_condition(f"{name}_slips", f"couplings.{name}.grip", why, ends=False)


def iter_belt_conditions(couplings: Mapping[str, f.CouplingEntry]) -> Iterator[ResultCondition]:
    """Yield the conditions of belts: a slack strand would have to push."""
    for name, entry in couplings.items():
        if isinstance(entry, f.BeltEntry):
            why, result_path = SLACK_BELT_MESSAGE.format(name, "{}"), f"couplings.{name}.slack"
            yield make_below_zero_condition(f"{name}_pushes", result_path, why, ends=False)._replace(
                entry_value=entry.pretension
            )


def format_rounded_up(lower_bound: float) -> str:
    """Format a number above zero with four digits, rounded up (except for its own rounding error), so that it
    suffices.
    """
    quantum = 10.0 ** (math.floor(math.log10(lower_bound)) - 3)
    return f"{math.ceil(lower_bound / quantum * (1.0 - tolerances.SAME_VALUE)) * quantum:.4g}"


def make_below_zero_condition(name: str, result_path: str, why: str, *, ends: bool) -> ResultCondition:
    """Make the condition that a result is below zero."""
    return ResultCondition(name, f"{result_path} below 0", ends, result_path, 0.0, False, why)


def resolve_gear(resolver: ReferenceResolver, name: str, entry: f.GearEntry) -> c.Gear:
    """Resolve a gear mesh."""
    teeth = None if entry.teeth is None else (entry.teeth[0], entry.teeth[1])
    pitch_point = None if entry.at is None else resolver.end(entry.at)
    return c.Gear(
        tuple(term(resolver, word) for word in entry.of), entry.ratio, teeth, entry.internal, pitch_point,
        entry.pressure_angle, entry.helix,
    )  # fmt: skip


def resolve_screw(resolver: ReferenceResolver, name: str, entry: f.ScrewEntry) -> c.Screw:
    """Resolve a screw thread; of a cylinder it couples both coordinates."""
    terms = tuple(term(resolver, word) for word in entry.of)
    if len(entry.of) == 1:
        terms = tuple(c.Term(entry.of[0], quantity, 1.0) for quantity in ("angle", "travel"))
    return c.Screw(
        terms, entry.lead, None if entry.friction is None else make_thread_friction(entry.friction, entry.lead)
    )


def make_thread_friction(entry: f.ThreadFrictionEntry, lead: float) -> c.ThreadFriction:
    """Make the friction of a thread; for an efficiency eta, tan(lambda + rho) = tan(lambda) / eta.

    tan(lambda) = lead / (2 pi radius) is its slope, tan(rho) = coefficient / cos(flank_angle).
    """
    if entry.coefficient is not None:
        coefficient = entry.coefficient / math.cos(entry.flank_angle)
    else:
        assert entry.efficiency is not None
        slope = abs(lead) / (math.tau * entry.radius)
        coefficient = math.tan(math.atan(slope / entry.efficiency) - math.atan(slope))
    static = coefficient if entry.static is None else entry.static / math.cos(entry.flank_angle)
    return c.ThreadFriction(coefficient, entry.radius, entry.speed, static)


def resolve_belt(resolver: ReferenceResolver, name: str, entry: f.BeltEntry) -> c.Belt:
    """Resolve a belt over two pulleys."""
    terms = tuple(term(resolver, word) for word in entry.of)
    return c.Belt(terms, (entry.radii[0], entry.radii[1]), entry.crossed, entry.pretension)


def resolve_differential(resolver: ReferenceResolver, name: str, entry: f.DifferentialEntry) -> c.Differential:
    """Resolve two shafts and their carrier."""
    return c.Differential(tuple(term(resolver, word) for word in entry.of), entry.ratio)


def term(resolver: ReferenceResolver, word: str, factor: float = 1.0) -> c.Term:
    """Make the term of a coordinate: the name of a joint that has one, or `joint.angle`, `joint.travel`."""
    joint, _, quantity_name = word.partition(".")
    quantity: Any = quantity_name
    return c.Term(joint, quantity or TYPES[resolver.document.joints[joint].type].coordinates[0], factor)


def resolve_cam(resolver: ReferenceResolver, name: str, entry: f.CamEntry) -> c.Cam:
    """Resolve a disc and its follower."""
    shaft, follower = entry.of
    lift: Any = entry.lift
    if entry.segments is not None:
        dimension = QUANTITY_DIMENSIONS[TYPES[resolver.document.joints[follower].type].coordinates[0]]
        lift = close_revolution(read_segments(entry.segments, entry.base, dimension))
    return c.Cam(
        shaft, follower, lift, resolver.end(entry.at).point, entry.contact, entry.radius or 0.0, entry.normal,
        entry.phase, entry.two_sided, entry.restitution,
    )  # fmt: skip


def resolve_rope(resolver: ReferenceResolver, name: str, entry: f.RopeEntry) -> c.Rope:
    """Resolve a rope."""
    passages = tuple(resolve_passage(resolver, entry_passage) for entry_passage in entry.through)
    length, law = None, entry.length
    if law is not None and law.constant is not None:
        length, law = law.constant, None
    elif law is not None:
        law = resolver.attach_location(law, f"couplings.{name}.length")
    elastic_properties = entry.stiffness, entry.damping or 0.0
    tension = entry.tension
    if tension is not None:
        tension = resolver.attach_location(tension, f"couplings.{name}.tension")
    return c.Rope(passages, length, entry.tension_only, entry.restitution, law, *elastic_properties, tension)


def resolve_passage(resolver: ReferenceResolver, entry: f.PassageEntry) -> c.RopePassage:
    """Resolve a place that a rope passes."""
    written_end = entry.point if entry.point is not None else entry.sheave
    assert written_end is not None
    end = resolver.end(written_end)
    return c.RopePassage(end, entry.radius or 0.0, entry.axis, entry.side, entry.slip == "none")


MEANINGS: dict[str, Callable[..., c.Coupling]] = {
    "ratio": resolve_ratio,
    "gear": resolve_gear,
    "screw": resolve_screw,
    "belt": resolve_belt,
    "differential": resolve_differential,
    "cam": resolve_cam,
    "rope": resolve_rope,
}
