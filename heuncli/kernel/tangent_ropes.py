"""The change of an elastic rope along a direction of the state (ropes.py)."""

from __future__ import annotations

from heuncli.kernel.declarations import *
from heuncli.kernel.ropes import free_length, rope_stiffness, rope_stretch
from heuncli.kernel.tangent_conditions import condition_tangent
from heuncli.kernel.tangent_sheaves import body_rotation, point_displacement


def rope_tangent(scene: cython.pointer[Scene], load: cython.pointer[Load]) -> RopeMotion:
    """Return the changes of S and S': dS = sum of f . (displacement of b - that of a at Q) + m . (rotation of b - that
    of a).
    """
    i: cython.Py_ssize_t
    longer: cython.double = 0.0
    faster: cython.double = 0.0
    for i in range(load.part, load.part + load.part_count):
        part: cython.pointer[Closure] = cython.address(scene.parts[i])
        part_change: cython.double = dot(
            part.f, sub(point_displacement(scene, part.b, part.Q), point_displacement(scene, part.a, part.Q))
        )
        part_change += dot(part.m, sub(body_rotation(scene, part.b), body_rotation(scene, part.a)))
        longer += part.factor * part_change
        faster += part.factor * condition_tangent(scene, part).rate
    return RopeMotion(longer, faster)


def rope_power_tangent(
    scene: cython.pointer[Scene], load: cython.pointer[Load], pull: cython.double, d: RopeMotion
) -> cython.double:
    """Return the change of value S' + dV/dt for a change `pull` of `value`, and d of S and S', at one instant."""
    free: Jet = free_length(scene, load)
    power: cython.double = pull * load.rate + load.value * d.rate
    x: cython.double = rope_stretch(load, load.span, free.value)
    if x == 0.0 and load.in_body:
        return power
    k: cython.double = rope_stiffness(load, free.value)
    power += k * (d.S * (load.rate - free.rate) + x * d.rate)
    if load.y.count:
        power -= k * x * d.S * free.rate / free.value
    return power
