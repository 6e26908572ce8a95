"""What gears and belts look like: pitch circles on wheels, pitch lines on racks, strands on what carries the wheels."""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Sequence
from types import SimpleNamespace
from typing import Any

import numpy as np

from heuncli.errors import Finding
from heuncli.mechanism.build import joint
from heuncli.mechanism.gearing import GearMember, line_on, members, mesh_of
from heuncli.mechanism.strands import strands
from heuncli.results import Array
from heuncli.shapes.rotations import perpendicular
from heuncli.spec.couplings import Belt, Gear
from heuncli.spec.models import Spec

CORNERS = 48  # of a circle
Lines = dict[str, tuple[Array, ...]]


def pitch_lines(spec: Spec) -> tuple[Lines, Lines]:
    """Circles of each body, and strands on each body or the ground: lines (n, 3) in their axes, by their names."""
    index = {name: i for i, name in enumerate(spec.bodies)} | {"ground": -1}
    names = {i: name for name, i in index.items()}
    joints = [joint(j, index[j.a], index[j.b], spec.space == "planar") for j in spec.joints.values()]
    number = {name: k for k, name in enumerate(spec.joints)}
    bodies: list[Any] = [
        SimpleNamespace(name=name, rotation=None if b.rotation is None else np.array(b.rotation).reshape(3, 3))
        for name, b in spec.bodies.items()
    ]
    circles, straight = defaultdict[str, list[Array]](list), defaultdict[str, list[Array]](list)
    for own in spec.couplings.values():
        if not isinstance(own, Gear | Belt):
            continue
        of = number[own.terms[0].joint], number[own.terms[1].joint]
        try:
            carrier, first, second = members(joints, bodies, of)
            if isinstance(own, Gear):
                at = None if own.at is None else np.array(own.at.point)
                P = mesh_of(own, carrier, first, second, at).P
                radii = [float(np.sqrt(m.arm(P) @ m.arm(P))) for m in (first, second)]
                heights = [float((P - m.point) @ m.axis) for m in (first, second)]
                wheel = next((r for m, r in zip((first, second), radii, strict=True) if m.turns), 0.0)
            else:
                radii, off = list(own.radii), float((first.point - second.point) @ second.axis)
                heights = [0.0, off]
                straight[names[carrier]] += [np.array([s.begin, s.end]) for s in strands(own, first, second)]
        except Finding:  # which is told where the scene is solved
            continue
        for k, member, r, height in zip(of, (first, second), radii, heights, strict=True):
            if member.turns:
                circles[names[member.body]].append(circle(joints, bodies, k, member, r, height))
            elif isinstance(own, Gear):
                circles[names[member.body]].append(pitch_line(joints[k], bodies, member, P, wheel))
    return {b: tuple(x) for b, x in circles.items()}, {b: tuple(x) for b, x in straight.items()}


def circle(joints: Sequence[Any], bodies: Sequence[Any], k: int, member: GearMember, r: float, height: float) -> Array:
    """A circle about a member's axis, in its body's axes, (CORNERS + 1, 3)."""
    point, axis = line_on(joints[k], bodies, member.body)
    e, f = perpendicular(axis)
    turn = np.linspace(0.0, 2.0 * np.pi, CORNERS + 1)[:, None]
    found: Array = point + height * axis + r * (np.cos(turn) * e + np.sin(turn) * f)
    return found


def pitch_line(joint: Any, bodies: Sequence[Any], member: GearMember, P: Array, wheel: float) -> Array:
    """A rack's line through the pitch point P, in its body's axes, as long as one turn of the wheel, (2, 3)."""
    point, axis = line_on(joint, bodies, member.body)
    given = (
        None if i < 0 else bodies[i].rotation for i in (joint.a if joint.b == member.body else joint.b, member.body)
    )
    carrier, own = (np.eye(3) if R is None else R for R in given)
    at = point + own.T @ carrier @ (P - member.point)
    return np.array([at - np.pi * wheel * axis, at + np.pi * wheel * axis])
