"""What couplings mean: their references followed, defaults filled in; a row a type of entry.

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
from heuncli.scene.file_format.format_rolling import RollingEntry, axle, centre
from heuncli.scene.file_format.models import End, ResultCondition, Z

PUSHES = "the slack strand of the belt {} would have to push: it needs a pretension of {} N"


class Following(Protocol):
    """What follows the references of a document (resolve.py)."""

    document: whole.Document

    def end(self, end: EndEntry) -> End:
        """The point that an end names."""

    def placed(self, value: Expression, path: str) -> Expression:
        """An expression with its place in the file; path: dotted."""


def meant(by: Following, name: str, entry: f.CouplingEntry) -> c.Coupling:
    """The coupling that an entry means; name: of it, for the places of its expressions."""
    found: c.Coupling = MEANINGS[entry.type](by, name, entry)
    return found


def ratio(by: Following, name: str, entry: f.RatioEntry) -> c.Ratio:
    """A linear relation of coordinates."""
    rows = zip(entry.of, entry.factors, strict=True)
    return c.Ratio(tuple(term(by, word, factor) for word, factor in rows), entry.is_)


def wheel_meant(by: Following, entry: RollingEntry) -> c.RollingWheel:
    """The wheel that an entry of `rolling` means; in the plane all are round about z."""
    joints = by.document.joints
    axis = Z if by.document.head.space == "planar" else axle(entry, joints) if entry.shape == "disc" else None
    wheel = centre(entry, joints)
    assert wheel is not None
    return c.RollingWheel(
        by.end(wheel), axis, entry.radius, by.end(entry.on),
        entry.normal, entry.friction, entry.slides is not None, entry.held,
    )  # fmt: skip


def conditions_of_wheels(rolling: Mapping[str, RollingEntry]) -> Iterator[ResultCondition]:
    """What is watched for of wheels: where one lifts off its plane, which ends the motion, and where one slips."""
    for name, entry in rolling.items():
        if not entry.held:
            why = f"the wheel {name} lifts: it would have to be pulled onto its plane"
            yield below_zero(f"{name}_lifts", f"couplings.{name}.normal", why, ends=True)
        if entry.friction is not None:
            why = f"the wheel {name} slips: it would take more friction than there is"
            yield below_zero(f"{name}_slips", f"couplings.{name}.grip", why, ends=False)


def conditions_of_belts(couplings: Mapping[str, f.CouplingEntry]) -> Iterator[ResultCondition]:
    """What is watched for of belts: where a strand would have to push."""
    for name, entry in couplings.items():
        if isinstance(entry, f.BeltEntry):
            why, of = PUSHES.format(name, "{}"), f"couplings.{name}.slack"
            yield below_zero(f"{name}_pushes", of, why, ends=False)._replace(given=entry.pretension)


def at_least(least: float) -> str:
    """A number above zero with four digits, rounded up, but for its own rounding: what is written so is enough."""
    quantum = 10.0 ** (math.floor(math.log10(least)) - 3)
    return f"{math.ceil(least / quantum * (1.0 - tolerances.SAME_VALUE)) * quantum:.4g}"


def below_zero(name: str, of: str, why: str, *, ends: bool) -> ResultCondition:
    """The condition that a number of the results is below zero."""
    return ResultCondition(name, f"{of} below 0", ends, of, 0.0, False, why)


def gear(by: Following, name: str, entry: f.GearEntry) -> c.Gear:
    """Two gears."""
    teeth = None if entry.teeth is None else (entry.teeth[0], entry.teeth[1])
    at = None if entry.at is None else by.end(entry.at)
    return c.Gear(
        tuple(term(by, word) for word in entry.of), entry.ratio, teeth, entry.internal, at,
        entry.pressure_angle, entry.helix,
    )  # fmt: skip


def screw(by: Following, name: str, entry: f.ScrewEntry) -> c.Screw:
    """A thread: of a cylinder its two coordinates."""
    terms = tuple(term(by, word) for word in entry.of)
    if len(entry.of) == 1:
        terms = tuple(c.Term(entry.of[0], quantity, 1.0) for quantity in ("angle", "travel"))
    return c.Screw(terms, entry.lead, None if entry.friction is None else rubbing(entry.friction, entry.lead))


def rubbing(given: f.ThreadFrictionEntry, lead: float) -> c.ThreadFriction:
    """The friction of a thread: of an efficiency eta, tan(lambda + rho) = tan(lambda) / eta.

    tan(lambda) = lead / (2 pi radius) is its slope, tan(rho) = coefficient / cos(flank_angle).
    """
    if given.coefficient is not None:
        coefficient = given.coefficient / math.cos(given.flank_angle)
    else:
        assert given.efficiency is not None
        slope = abs(lead) / (math.tau * given.radius)
        coefficient = math.tan(math.atan(slope / given.efficiency) - math.atan(slope))
    return c.ThreadFriction(coefficient, given.radius, given.speed)


def belt(by: Following, name: str, entry: f.BeltEntry) -> c.Belt:
    """A belt over two pulleys."""
    terms = tuple(term(by, word) for word in entry.of)
    return c.Belt(terms, (entry.radii[0], entry.radii[1]), entry.crossed, entry.pretension)


def differential(by: Following, name: str, entry: f.DifferentialEntry) -> c.Differential:
    """Two shafts and their carrier."""
    return c.Differential(tuple(term(by, word) for word in entry.of), entry.ratio)


def term(by: Following, word: str, factor: float = 1.0) -> c.Term:
    """A coordinate by its joint's name, which has one, or by `joint.angle`, `joint.travel`."""
    joint, _, named = word.partition(".")
    quantity: Any = named
    return c.Term(joint, quantity or TYPES[by.document.joints[joint].type].coordinates[0], factor)


def cam(by: Following, name: str, entry: f.CamEntry) -> c.Cam:
    """A disc and its follower."""
    shaft, follower = entry.of
    return c.Cam(
        shaft, follower, entry.lift, by.end(entry.at).point, entry.contact, entry.radius or 0.0, entry.normal,
        entry.phase, entry.two_sided, entry.restitution,
    )  # fmt: skip


def rope(by: Following, name: str, entry: f.RopeEntry) -> c.Rope:
    """A rope."""
    through = tuple(passage(by, given) for given in entry.through)
    length, law = None, entry.length
    if law is not None and law.constant is not None:
        length, law = law.constant, None
    elif law is not None:
        law = by.placed(law, f"couplings.{name}.length")
    stretching = entry.stiffness, entry.damping or 0.0
    return c.Rope(through, length, entry.tension_only, entry.restitution, law, *stretching)


def passage(by: Following, given: f.PassageEntry) -> c.Passage:
    """Where a rope passes."""
    written = given.point if given.point is not None else given.sheave
    assert written is not None
    end = by.end(written)
    return c.Passage(end, given.radius or 0.0, given.axis, given.side, given.slip == "none")


MEANINGS: dict[str, Callable[..., c.Coupling]] = {
    "ratio": ratio, "gear": gear, "screw": screw, "belt": belt, "differential": differential, "cam": cam, "rope": rope,
}  # fmt: skip
