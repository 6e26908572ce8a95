"""What a rope that stretches changes by along a direction of the state (ropes.py)."""

from __future__ import annotations

try:
    import cython
except ImportError:
    from heuncli.kernel.shadow import cython

if not cython.compiled:
    from heuncli.kernel.algebra import dot, sub
    from heuncli.kernel.programs import Jet
    from heuncli.kernel.ropes import free_length, stiffness_at, stretch_of
    from heuncli.kernel.scene import Closure, Load, Scene
    from heuncli.kernel.shadow import cython
    from heuncli.kernel.tangent_conditions import condition_along
    from heuncli.kernel.tangent_sheaves import carried_by, swung_by
    from heuncli.kernel.values import RopeMotion


def rope_along(scene: cython.pointer[Scene], load: cython.pointer[Load]) -> RopeMotion:
    """What S and S' change by: dS = sum of f . (way of b - way of a at Q) + m . (turn of b - turn of a)."""
    i: cython.Py_ssize_t
    longer: cython.double = 0.0
    faster: cython.double = 0.0
    for i in range(load.part, load.part + load.part_count):
        part: cython.pointer[Closure] = cython.address(scene.parts[i])
        own: cython.double = dot(part.f, sub(carried_by(scene, part.b, part.Q), carried_by(scene, part.a, part.Q)))
        own += dot(part.m, sub(swung_by(scene, part.b), swung_by(scene, part.a)))
        longer += part.factor * own
        faster += part.factor * condition_along(scene, part).rate
    return RopeMotion(longer, faster)


def rope_power_along(
    scene: cython.pointer[Scene], load: cython.pointer[Load], pull: cython.double, d: RopeMotion
) -> cython.double:
    """What value S' + dV/dt changes by as `value` does by `pull`, and S and S' by d, at one instant."""
    free: Jet = free_length(scene, load)
    found: cython.double = pull * load.rate + load.value * d.rate
    x: cython.double = stretch_of(load, load.span, free.value)
    if x == 0.0 and load.in_body:
        return found
    k: cython.double = stiffness_at(load, free.value)
    found += k * (d.S * (load.rate - free.rate) + x * d.rate)
    if load.y.count:
        found -= k * x * d.S * free.rate / free.value
    return found
