"""Elastic ropes: the length of a rope that pulls as a load, and the energy it stores.

    S = sum of the parts       conditions between two bodies, as closure rows have them (sheaves.py); those of an
                               elastic rope belong to no row, and its load applies `value` times their unit loads
    x = S - l0,  V = 1/2 k x^2 l0: a number, or a law in time
    k = k0 L / l0              k0: at the length L, for a shorter rope of the same kind is stiffer

A rope that only pulls stores nothing if it is shorter than l0: it is slack there.

Below: its change along a direction of the state.
"""

from __future__ import annotations

from heuncli.kernel.conditions import condition_tangent, measure_condition, set_load_places
from heuncli.kernel.declarations import *
from heuncli.kernel.jets import jet
from heuncli.kernel.sheaves import body_rotation, point_displacement


def measure_rope(scene: cython.pointer[Scene], load: cython.pointer[Load]) -> RopeMotion:
    """Find S and S' at the present pose, and the unit loads of the rope's parts."""
    i: cython.Py_ssize_t
    S: cython.double = 0.0
    rate: cython.double = 0.0
    for i in range(load.part, load.part + load.part_count):
        part: cython.pointer[Closure] = cython.address(scene.parts[i])
        measure_condition(scene, part)
        set_load_places(scene, part)
        S += part.factor * part.gap
        rate += part.factor * part.rate
    return RopeMotion(S, rate)


def free_length(scene: cython.pointer[Scene], load: cython.pointer[Load]) -> Jet:
    """Return l0 with its rate."""
    if load.y.count:
        return jet(scene.programs, load.y, scene.programs.variables[0])
    return Jet(load.length, 0.0, 0.0)


def rope_stiffness(load: cython.pointer[Load], free: cython.double) -> cython.double:
    """Return k at a length l0."""
    return load.stiffness * load.length / free if load.y.count else load.stiffness


def rope_stretch(load: cython.pointer[Load], S: cython.double, free: cython.double) -> cython.double:
    """Return x; 0 if the rope is slack."""
    x: cython.double = S - free
    return 0.0 if load.in_body and x < 0.0 else x


def rope_energy(scene: cython.pointer[Scene], load: cython.pointer[Load]) -> cython.double:
    """Return V at the present pose [J]."""
    free: cython.double = free_length(scene, load).value
    x: cython.double = rope_stretch(load, measure_rope(scene, load).S, free)
    return 0.5 * rope_stiffness(load, free) * x * x


def rope_power(scene: cython.pointer[Scene], load: cython.pointer[Load]) -> cython.double:
    """value S' + dV/dt [W]: the power that damping takes, and that a winch gives when it draws the rope in or pays it
    out.

    dV/dt = k x (S' - l0') - 1/2 k x^2 l0' / l0
    """
    free: Jet = free_length(scene, load)
    x: cython.double = rope_stretch(load, load.span, free.value)
    pull: cython.double = rope_stiffness(load, free.value) * x
    power: cython.double = load.value * load.rate + pull * (load.rate - free.rate)
    if load.y.count:
        power -= 0.5 * pull * x * free.rate / free.value
    return power


# Along a direction of the state


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
