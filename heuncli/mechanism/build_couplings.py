"""Couplings of the spec -> conditions between bodies: a row a kind, which alone knows how it is made of them."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

from heuncli.mechanism.couplings import Coordinate, CoupledRow, Coupling, CouplingPart
from heuncli.mechanism.model import Joint
from heuncli.records import replace
from heuncli.spec import couplings as c
from heuncli.spec.models import Spec

SIZE = 0.0  # weight of gaps that are angles: the scene's size


def couplings_of(spec: Spec, joints: Sequence[Joint], number: Mapping[str, int]) -> tuple[Coupling, ...]:
    """All couplings, in the order of the spec; number: of the joints by their names."""
    return tuple(
        Coupling(name, MADE[given.type](given, joints, number), given) for name, given in spec.couplings.items()
    )


def ratio(given: c.Ratio, joints: Sequence[Joint], number: Mapping[str, int]) -> tuple[CoupledRow, ...]:
    """The sum of coordinates, each times its factor: a couple about each axis, a force along each guide."""
    parts = tuple(of_coordinate(joints, number[x.joint], x.quantity, x.factor) for x in given.terms)
    turning = all(x.quantity == "angle" for x in given.terms)
    return (CoupledRow(parts, given.is_, SIZE if turning else 1.0),)


def of_coordinate(joints: Sequence[Joint], k: int, quantity: str, factor: float) -> CouplingPart:
    """The condition on a joint's coordinate: of an angle its couple, of a travel its force."""
    joint = joints[k]
    found = CouplingPart("guide", joint.a, joint.b, joint.p, joint.q, joint.axis, factor=factor)
    return found if quantity == "travel" else replace(found, kind="turn", coordinates=(Coordinate(k, "angle", 1.0),))


MADE = {"ratio": ratio}
