"""Ropes that stretch: how long a rope is that a load pulls along, and what it keeps of the work done on it.

    S = sum of the parts       conditions of two bodies each, as closure rows have them (sheaves.py); those of a rope
                               that stretches belong to no row, and its load puts `value` times their unit loads
    x = S - l0,  V = 1/2 k x^2 l0: a number, or a law in time
    k = k0 L / l0              k0: at the length L, for a shorter rope of the same kind is stiffer
A rope that pulls alone keeps nothing where it is shorter than l0: it hangs slack there.
"""

from __future__ import annotations

try:
    import cython
except ImportError:
    from heuncli.kernel.shadow import cython

if not cython.compiled:
    from heuncli.kernel.conditions import enter, measure_condition
    from heuncli.kernel.jets import jet
    from heuncli.kernel.programs import Jet
    from heuncli.kernel.scene import Closure, Load, Scene
    from heuncli.kernel.shadow import cython
    from heuncli.kernel.values import RopeMotion


def motion_of_rope(scene: cython.pointer[Scene], load: cython.pointer[Load]) -> RopeMotion:
    """S and S' as the bodies stand; the unit loads of its parts are found with them."""
    i: cython.Py_ssize_t
    S: cython.double = 0.0
    rate: cython.double = 0.0
    for i in range(load.part, load.part + load.part_count):
        part: cython.pointer[Closure] = cython.address(scene.parts[i])
        measure_condition(scene, part)
        enter(scene, part)
        S += part.factor * part.gap
        rate += part.factor * part.rate
    return RopeMotion(S, rate)


def free_length(scene: cython.pointer[Scene], load: cython.pointer[Load]) -> Jet:
    """l0 with its rate."""
    if load.y.count:
        return jet(scene.programs, load.y, scene.programs.variables[0])
    return Jet(load.length, 0.0, 0.0)


def stiffness_at(load: cython.pointer[Load], free: cython.double) -> cython.double:
    """k at a length l0."""
    return load.stiffness * load.length / free if load.y.count else load.stiffness


def stretch_of(load: cython.pointer[Load], S: cython.double, free: cython.double) -> cython.double:
    """x; 0 where the rope hangs slack."""
    x: cython.double = S - free
    return 0.0 if load.in_body and x < 0.0 else x


def rope_energy(scene: cython.pointer[Scene], load: cython.pointer[Load]) -> cython.double:
    """V as the bodies stand [J]."""
    free: cython.double = free_length(scene, load).value
    x: cython.double = stretch_of(load, motion_of_rope(scene, load).S, free)
    return 0.5 * stiffness_at(load, free) * x * x


def rope_power(scene: cython.pointer[Scene], load: cython.pointer[Load]) -> cython.double:
    """value S' + dV/dt [W]: what damping takes, and what draws the rope in or pays it out gives.

    dV/dt = k x (S' - l0') - 1/2 k x^2 l0' / l0
    """
    free: Jet = free_length(scene, load)
    x: cython.double = stretch_of(load, load.span, free.value)
    pull: cython.double = stiffness_at(load, free.value) * x
    found: cython.double = load.value * load.rate + pull * (load.rate - free.rate)
    if load.y.count:
        found -= 0.5 * pull * x * free.rate / free.value
    return found
