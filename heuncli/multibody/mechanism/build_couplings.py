"""Couplings of the spec -> conditions between bodies: a row a kind, which alone knows how it is made of them."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence

import numpy as np

from heuncli.base.errors import Finding, Problem, SpecError
from heuncli.base.joint_kinds import JOINTS
from heuncli.base.records import record
from heuncli.multibody.mechanism.couplings import CamShape, Coordinate, CoupledRow, Coupling, CouplingPart
from heuncli.multibody.mechanism.directions import unit
from heuncli.multibody.mechanism.gearing import gear_row
from heuncli.multibody.mechanism.model import GROUND, Body, Joint, Load
from heuncli.multibody.mechanism.strands import belt_row, pretension_of
from heuncli.multibody.mechanism.threads import friction_of, screw_row
from heuncli.multibody.mechanism.wheels import WheelEnds, ball_rows, disc_rows
from heuncli.results.results import Array
from heuncli.scene.expressions.paths import path_of
from heuncli.scene.file_format import couplings as c
from heuncli.scene.file_format.models import End, Spec

SIZE = 0.0  # weight of gaps that are angles: the scene's size


def couplings_of(
    spec: Spec, joints: Sequence[Joint], bodies: Sequence[Body], number: Mapping[str, int]
) -> tuple[Coupling, ...]:
    """All couplings, in the order of the spec; number: of joints by their names. Raises SpecError with all misfits."""
    drawn = CoupledDrawing(spec, joints, bodies, number)
    found, problems = [], []
    for name, given in spec.couplings.items():
        try:
            found.append(Coupling(name, MADE[given.type](given, drawn), given))
        except Finding as misfit:
            path = f"{'rolling' if given.type == 'wheel' else 'couplings'}.{name}"
            problems.append(Problem(misfit.code, misfit.message, spec.location(path), misfit.hint))
    if problems:
        raise SpecError(*problems)
    return tuple(found)


def loads_beside(
    spec: Spec, joints: Sequence[Joint], bodies: Sequence[Body], number: Mapping[str, int]
) -> tuple[Load, ...]:
    """The loads that couplings have beside what they hold, by their names.

    What belts pull their pulleys together with; what rubs in threads.
    """
    drawn = CoupledDrawing(spec, joints, bodies, number)
    found: list[Load] = []
    for k, (name, own) in enumerate(spec.couplings.items()):
        of = tuple(drawn.of(own.terms)) if isinstance(own, c.Belt | c.Screw) else ()
        if isinstance(own, c.Belt) and own.pretension > 0.0:
            found.append(pretension_of(name, own, joints, bodies, (of[0], of[1])))
        elif isinstance(own, c.Screw) and own.friction is not None:
            found.append(friction_of(name, k, own, own.friction, joints, bodies, (of[0], of[1])))
    return tuple(found)


@record
class CoupledDrawing:
    """The joints and bodies that couplings look at; number: of the joints by their names."""

    spec: Spec
    joints: Sequence[Joint]
    bodies: Sequence[Body]
    number: Mapping[str, int]

    def of(self, terms: Sequence[c.Term]) -> list[int]:
        """The joints of terms."""
        return [self.number[x.joint] for x in terms]

    def place(self, end: End) -> tuple[int, Array]:
        """A body's number, or the ground's, and its point."""
        names = [body.name for body in self.bodies]
        return (names.index(end.body) if end.body in names else GROUND), np.array(end.point)


def ratio(given: c.Ratio, drawn: CoupledDrawing) -> tuple[CoupledRow, ...]:
    """The sum of coordinates, each times its factor: a couple about each axis, a force along each guide."""
    parts = tuple(of_coordinate(drawn, x, x.factor) for x in given.terms)
    turning = all(x.quantity == "angle" for x in given.terms)
    return (CoupledRow(parts, given.is_, SIZE if turning else 1.0),)


def differential(given: c.Differential, drawn: CoupledDrawing) -> tuple[CoupledRow, ...]:
    """first - ratio second - (1 - ratio) carrier stays what it is."""
    factors = (1.0, -given.ratio, given.ratio - 1.0)
    parts = tuple(of_coordinate(drawn, x, factor) for x, factor in zip(given.terms, factors, strict=True))
    return (CoupledRow(parts, None, SIZE),)


def gear(given: c.Gear, drawn: CoupledDrawing) -> tuple[CoupledRow, ...]:
    """The tooth force at the pitch point."""
    one, other = drawn.of(given.terms)
    at = None if given.at is None else drawn.place(given.at)
    return (gear_row(given, drawn.joints, drawn.bodies, (one, other), at),)


def screw(given: c.Screw, drawn: CoupledDrawing) -> tuple[CoupledRow, ...]:
    """The thrust along the axis, and the torque about it."""
    one, other = drawn.of(given.terms)
    return (screw_row(given, drawn.joints, drawn.bodies, (one, other)),)


def belt(given: c.Belt, drawn: CoupledDrawing) -> tuple[CoupledRow, ...]:
    """The pulls of both strands."""
    one, other = drawn.of(given.terms)
    return (belt_row(given, drawn.joints, drawn.bodies, (one, other)),)


def of_coordinate(drawn: CoupledDrawing, term: c.Term, factor: float) -> CouplingPart:
    """The condition on a joint's coordinate: of an angle its couple, of a travel its force."""
    k = drawn.number[term.joint]
    joint = drawn.joints[k]
    if term.quantity == "travel":
        return CouplingPart("guide", joint.a, joint.b, joint.p, joint.q, joint.axis, factor=factor)
    coordinates = (Coordinate(k, "angle", 1.0),)
    return CouplingPart(
        "turn", joint.a, joint.b, joint.p, joint.q, joint.axis, factor=factor, coordinates=coordinates
    )  # fmt: skip


def cam(given: c.Cam, drawn: CoupledDrawing) -> tuple[CoupledRow, ...]:
    """A disc and its follower."""
    k, n = drawn.number[given.shaft], drawn.number[given.follower]
    return cam_rows(given, k, drawn.joints[k], n, drawn.joints[n])


def cam_rows(given: c.Cam, k: int, shaft: Joint, n: int, follower: Joint) -> tuple[CoupledRow, ...]:
    """The follower's coordinate is the lift; one that is pressed alone has the opposite row, which only pulls."""
    swings = JOINTS[follower.kind].coordinates[0] == "angle"
    shape = CamShape(
        path_of((given.lift, 0.0, 0.0)).later(given.phase), swings, follower.p, given.radius,
        None if given.normal is None else unit(given.normal),
    )  # fmt: skip
    coordinates = Coordinate(k, "angle", 1.0), Coordinate(n, "angle" if swings else "travel", 1.0)
    part = CouplingPart(
        "cam", shaft.b, follower.b, shaft.p, np.array(given.at), shaft.axis, follower.axis,
        1.0 if given.both else -1.0, shaft.a, coordinates, cam=shape,
    )  # fmt: skip
    return (CoupledRow((part,), 0.0, SIZE if swings else 1.0, not given.both, given.restitution),)


def wheel(given: c.RollingWheel, drawn: CoupledDrawing) -> tuple[CoupledRow, ...]:
    """A wheel on its plane."""
    (b, q), (a, p) = drawn.place(given.wheel), drawn.place(given.on)
    ends: WheelEnds = {"a": a, "b": b, "p": p, "q": q, "e": unit(given.normal)}
    if given.axis is None:
        return ball_rows(ends, given.radius)
    ways = {"along": not given.slides, "aside": drawn.spec.space != "planar"}  # in the plane nothing goes aside
    return disc_rows(ends, unit(given.axis), given.radius, ways)


def at_start(given: c.Rope, drawn: CoupledDrawing) -> tuple[CoupledRow, ...]:
    """None yet: what they hold is found where the bodies stand (multibody/tree/couplings_at_start.py)."""
    return ()


MADE: dict[str, Callable[..., tuple[CoupledRow, ...]]] = {
    "ratio": ratio, "gear": gear, "screw": screw, "belt": belt, "differential": differential, "cam": cam,
    "wheel": wheel, "rope": at_start,
}  # fmt: skip
