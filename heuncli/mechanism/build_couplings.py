"""Couplings of the spec -> conditions between bodies: a row a kind, which alone knows how it is made of them."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence

from heuncli.mechanism.couplings import Coordinate, CoupledRow, Coupling, CouplingPart
from heuncli.mechanism.directions import unit
from heuncli.mechanism.model import Joint
from heuncli.mechanism.wheels import Ends, ball_rows, disc_rows
from heuncli.records import record, replace
from heuncli.spec import couplings as c
from heuncli.spec.models import Spec

SIZE = 0.0  # weight of gaps that are angles: the scene's size


@record
class Numbered:
    """What couplings are made between: the joints, and the numbers of bodies and joints by their names.

    planar: whether the scene was declared so.
    """

    joints: Sequence[Joint]
    joint: Mapping[str, int]
    body: Mapping[str, int]
    planar: bool


def couplings_of(spec: Spec, of: Numbered) -> tuple[Coupling, ...]:
    """All couplings, in the order of the spec."""
    return tuple(Coupling(name, MADE[given.type](given, of), given) for name, given in spec.couplings.items())


def ratio(given: c.Ratio, of: Numbered) -> tuple[CoupledRow, ...]:
    """The sum of coordinates, each times its factor: a couple about each axis, a force along each guide."""
    parts = tuple(of_coordinate(of.joints, of.joint[x.joint], x.quantity, x.factor) for x in given.terms)
    turning = all(x.quantity == "angle" for x in given.terms)
    return (CoupledRow(parts, given.is_, SIZE if turning else 1.0),)


def of_coordinate(joints: Sequence[Joint], k: int, quantity: str, factor: float) -> CouplingPart:
    """The condition on a joint's coordinate: of an angle its couple, of a travel its force."""
    joint = joints[k]
    found = CouplingPart("guide", joint.a, joint.b, joint.p, joint.q, joint.axis, factor=factor)
    return found if quantity == "travel" else replace(found, kind="turn", coordinates=(Coordinate(k, "angle", 1.0),))


def wheel(given: c.Wheel, of: Numbered) -> tuple[CoupledRow, ...]:
    """A wheel on its plane."""
    ends: Ends = {
        "a": of.body[given.on.body], "b": of.body[given.wheel.body], "p": given.on.point, "q": given.wheel.point,
        "e": unit(given.normal),
    }  # fmt: skip
    if given.axis is None:
        return ball_rows(ends, given.radius)
    way = {"along": not given.slides, "aside": not of.planar}  # in the plane nothing goes aside
    return disc_rows(ends, unit(given.axis), given.radius, way)


MADE: dict[str, Callable[..., tuple[CoupledRow, ...]]] = {"ratio": ratio, "wheel": wheel}
