"""Elastic ropes: the length of a rope that pulls as a load, and the energy it stores.

    S = sum of the parts       conditions between two bodies, as closure rows have them (sheaves.py); those of an
                               elastic rope belong to no row, and its load applies `value` times their unit loads
    x = S - l0,  V = 1/2 k x^2 l0: a number, or a law in time
    k = k0 L / l0              k0: at the length L, for a shorter rope of the same kind is stiffer

A rope that only pulls stores nothing if it is shorter than l0: it is slack there.
"""

from __future__ import annotations

from heuncli.kernel.conditions import measure_condition, set_load_places
from heuncli.kernel.declarations import *
from heuncli.kernel.jets import jet


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
