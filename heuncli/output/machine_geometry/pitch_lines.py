"""What gears and belts look like: pitch circles on wheels, pitch lines on racks, strands on what carries the wheels."""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Sequence
from types import SimpleNamespace
from typing import Any

import numpy as np

from heuncli.base import tolerances
from heuncli.base.errors import Finding
from heuncli.base.named_tuples import NamedTuple
from heuncli.multibody.mechanism.build import joint
from heuncli.multibody.mechanism.gearing import GearMember, line_on, members, mesh_of
from heuncli.multibody.mechanism.strands import strands
from heuncli.output.machine_geometry.discs import Disc
from heuncli.results.results import Array, Block
from heuncli.scene.file_format.couplings import Belt, Gear
from heuncli.scene.file_format.models import Spec
from heuncli.scene.shapes.rotations import cross


class BeltLook(NamedTuple):
    """A belt: its strands (2, 2, 3) as they run, in the axes of what carries the pulleys; the one that drives first.

    pulled: the bodies of the pulleys, first and second. counted: joints, and by how much the belt runs per angle [m].
    """

    name: str
    carrier: str
    strands: Array
    pulled: tuple[str, str]
    counted: tuple[tuple[str, float], ...]

    def run(self, coordinates: Block) -> Array:
        """How far the belt has run at the instants of some results, (n,) [m]."""
        parts = [factor * np.asarray(coordinates[name]["angle"]) for name, factor in self.counted]
        return np.asarray(np.sum(parts, axis=0))


class PitchLooks(NamedTuple):
    """Discs of bodies and of the ground, lines of racks in their axes, (2, 3), and belts."""

    discs: dict[str, list[Disc]]
    racks: dict[str, list[Array]]
    belts: list[BeltLook]


class _Placed(NamedTuple):
    """The joints and bodies of a spec as gearing reads them; names: of the bodies by their numbers."""

    joints: Sequence[Any]
    bodies: Sequence[Any]
    names: dict[int, str]
    number: dict[str, int]


def pitch_looks(spec: Spec) -> PitchLooks:
    """All gears and belts of a spec, but for those that are refused where the scene is solved."""
    index = {name: i for i, name in enumerate(spec.bodies)} | {"ground": -1}
    joints = [joint(j, index[j.a], index[j.b], spec.space == "planar") for j in spec.joints.values()]
    bodies: list[Any] = [
        SimpleNamespace(name=name, rotation=None if b.rotation is None else np.array(b.rotation).reshape(3, 3))
        for name, b in spec.bodies.items()
    ]
    placed = _Placed(joints, bodies, {i: x for x, i in index.items()}, {x: k for k, x in enumerate(spec.joints)})
    found = PitchLooks(defaultdict(list), defaultdict(list), [])
    for name, own in spec.couplings.items():
        if isinstance(own, Gear | Belt):
            try:
                if isinstance(own, Gear):
                    _gear(found, placed, own)
                else:
                    _belt(found, placed, name, own)
            except Finding:
                continue
    return found


def _gear(found: PitchLooks, placed: _Placed, own: Gear) -> None:
    """A pair of wheels, or a wheel and its rack. Raises Finding."""
    of = placed.number[own.terms[0].joint], placed.number[own.terms[1].joint]
    carrier, *pair = members(placed.joints, placed.bodies, of)
    P = mesh_of(own, carrier, pair[0], pair[1], None if own.at is None else np.array(own.at.point)).P
    radii = [float(np.sqrt(m.arm(P) @ m.arm(P))) if m.turns else 0.0 for m in pair]
    for k, member, r in zip(of, pair, radii, strict=True):
        body = placed.names[member.body]
        if member.turns:
            ring = r == max(radii) and lies_within(pair, P)
            found.discs[body].append(disc(placed, k, member, r, float((P - member.point) @ member.axis), not ring))
        else:
            found.racks[body].append(pitch_line(placed, k, member, P, max(radii)))


def lies_within(pair: Sequence[GearMember], P: Array) -> bool:
    """Whether one of two wheels lies within the other: parallel axes on one side of the pitch point."""
    one, other = pair
    across = cross(one.axis, other.axis)
    parallel = float(across @ across) <= tolerances.TYPED_AXES**2
    return one.turns and other.turns and parallel and float(one.arm(P) @ other.arm(P)) > 0.0


def _belt(found: PitchLooks, placed: _Placed, name: str, own: Belt) -> None:
    """Two pulleys and the strands between them. Raises Finding."""
    of = placed.number[own.terms[0].joint], placed.number[own.terms[1].joint]
    carrier, first, second = members(placed.joints, placed.bodies, of)
    tight, slack = strands(own, first, second)
    off = float((first.point - second.point) @ second.axis)
    for k, member, r, height in zip(of, (first, second), own.radii, (0.0, off), strict=True):
        found.discs[placed.names[member.body]].append(disc(placed, k, member, r, height))
    names = placed.names[first.body], placed.names[second.body]
    ways = np.array(
        [(tight.end, tight.begin), (slack.begin, slack.end)]
    )  # the first pulley draws the one that it pulls
    joints = list(placed.number)
    counted = tuple((joints[x.joint], own.radii[0] * x.ratio / first.sign) for x in first.coordinates)
    found.belts.append(BeltLook(name, placed.names[carrier], ways, names, counted))


def disc(placed: _Placed, k: int, member: GearMember, r: float, height: float, solid: bool = True) -> Disc:
    """A circle about a member's axis, in its body's axes; k: its joint."""
    point, axis = line_on(placed.joints[k], placed.bodies, member.body)
    return Disc(point + height * axis, axis, r, solid, spins=solid)


def pitch_line(placed: _Placed, k: int, member: GearMember, P: Array, wheel: float) -> Array:
    """A rack's line through the pitch point P, in its body's axes, as long as one turn of the wheel, (2, 3)."""
    own_joint, bodies = placed.joints[k], placed.bodies
    point, axis = line_on(own_joint, bodies, member.body)
    base = own_joint.a if own_joint.b == member.body else own_joint.b
    given = (None if i < 0 else bodies[i].rotation for i in (base, member.body))
    carrier, own = (np.eye(3) if R is None else R for R in given)
    at = point + own.T @ carrier @ (P - member.point)
    return np.array([at - np.pi * wheel * axis, at + np.pi * wheel * axis])
