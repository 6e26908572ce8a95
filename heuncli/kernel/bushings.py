"""Bushings: springs and dampers between two bodies, three along and three about the axes T of body a.

    d, phi                          shift of b's point, rotation vector of b relative to a, in the axes T (strains.py)
    f = g(d) - K d - X phi - D d' - Y omega                              force on b at its point
    m = J^-T (g(phi) - C phi - X'd) - E omega - Y'd',  phi' = J^-1 omega          J: strains.py

Body a takes the opposite of f and m at b's point. g is a preload minus the tables, each a function of the component
along its own axis. K, C, D, E are symmetric. So everything but the damping has a potential at any angle: 1/2 d'Kd, d'X
phi and 1/2 phi' C phi minus the integrals of g. The rate of d is the velocity of b's point as seen from a, the rate of
phi follows from omega = T'(omega_b - omega_a), and m'omega = g'phi'. At a half turn phi and -phi are the same attitude,
and the moment jumps between two values: there it has no value.

A bushing has two loads, its shift and its turn. Each knows its own blocks, and as `coupled` X and Y, or X' and Y'.

Below: its change along a direction of the state, line by line.
"""

from __future__ import annotations

from heuncli.kernel.declarations import *
from heuncli.kernel.evaluator import area_under, read_table
from heuncli.kernel.kinematics import add_load_to_body
from heuncli.kernel.libm import NAN
from heuncli.kernel.strains import (
    bushing_axes,
    bushing_moment,
    bushing_moment_tangent,
    bushing_strain,
    other_strain,
    other_strain_tangent,
    strain_tangent,
)
from heuncli.kernel.tangent_motion import vector_tangent


def elastic_load(scene: cython.pointer[Scene], load: cython.pointer[Load], x: Vec3) -> Vec3:
    """Return K d + X phi of a strain x = d, or C phi + X'd of x = phi."""
    found: Vec3 = rotate(load.own_stiffness, x)
    if load.is_coupled:
        found = add(found, rotate(load.coupled_stiffness, other_strain(scene, load)))
    return found


def drag_load(load: cython.pointer[Load], T: Mat3, rates: BushingRates) -> Vec3:
    """Return D d' + Y omega, or E omega + Y'd', in the axes T."""
    found: Vec3 = rotate(load.own_damping, rotate_back(T, rates.own))
    if load.is_coupled:
        found = add(found, rotate(load.coupled_damping, rotate_back(T, rates.other)))
    return found


def apply_bushing_load(
    scene: cython.pointer[Scene], load: cython.pointer[Load], preload: Vec3, rates: BushingRates
) -> cython.double:
    """Apply the force or moment of a bushing to both bodies. Returns the power of its damping, which has no potential.

    preload: force or moment that does not depend linearly on the strain, in the axes T

    A bushing within one body strains only that body and moves nothing.
    """
    T: Mat3 = bushing_axes(scene, load)
    load.strain = bushing_strain(scene, load)
    load.span = norm(load.strain)
    load.place_on_a = load.place
    if load.a == load.b:
        rates = BushingRates(Vec3(0.0, 0.0, 0.0), Vec3(0.0, 0.0, 0.0))
    rate: Vec3 = rotate_back(T, rates.own)
    gamma: Vec3 = sub(preload, elastic_load(scene, load, load.strain))
    drag: Vec3 = drag_load(load, T, rates)
    load.rate = norm(rate)
    total: Vec3
    if load.kind == BUSHING_SHIFT:
        total = sub(gamma, drag)
        load.force = rotate(T, total)
    else:
        total = sub(bushing_moment(load.strain, gamma), drag)
        if not load.span < load.length:  # half a turn: the moment has two values
            total = Vec3(NAN, NAN, NAN)
        load.moment = rotate(T, total)
    load.value = norm(total)
    load.power = dot(total, rate)
    if load.a != load.b:
        add_load_to_body(scene, load.b, load.place, load.force, load.moment)
        add_load_to_body(scene, load.a, load.place, scale_vector(-1.0, load.force), scale_vector(-1.0, load.moment))
    return -dot(drag, rate)


def bushing_energy(scene: cython.pointer[Scene], load: cython.pointer[Load]) -> cython.double:
    """1/2 x'Kx + 1/2 d'X phi + the areas under the tables, minus the work of a preload, for x = d or phi [J]."""
    x: Vec3 = bushing_strain(scene, load)
    found: cython.double = 0.5 * dot(x, elastic_load(scene, load, x)) - dot(load.vector, x)
    if load.x.count:
        found += table_area(scene.programs, load.x, x.x)
    if load.y.count:
        found += table_area(scene.programs, load.y, x.y)
    if load.z.count:
        found += table_area(scene.programs, load.z, x.z)
    return found


def table_area(programs: cython.pointer[Programs], program: Program, x: cython.double) -> cython.double:
    """Return the area, from 0 to x, under the one table of a component's program, without its preload."""
    position: cython.Py_ssize_t = program.start
    while programs.code[position].op != TABLE:
        position += 1
    k: cython.int = programs.code[position].argument
    return area_under(programs.tables[k], read_table(programs, position + 1, k), x)


# Along a direction of the state


def bushing_tangent(
    scene: cython.pointer[Scene],
    load: cython.pointer[Load],
    vector: Vec3,
    preload_change: Vec3,
    rates: BushingRates,
    rate_changes: BushingRates,
) -> BushingTangent:
    """Return the change of the force or moment on b, world axes, and its share in that of the damping's power.

    vector: its given components, and preload_change: their change
    """
    T: Mat3 = bushing_axes(scene, load)
    changes: BushingRates = BushingRates(
        sub(rate_changes.own, vector_tangent(scene, load.a, rates.own)),
        sub(rate_changes.other, vector_tangent(scene, load.a, rates.other)),
    )
    drag: Vec3 = drag_load(load, T, changes)
    loss: cython.double = -2.0 * dot(drag_load(load, T, rates), rotate_back(T, changes.own))
    x: Vec3 = load.strain
    dx: Vec3 = strain_tangent(scene, load, x)
    change: Vec3 = sub(preload_change, rotate(load.own_stiffness, dx))
    if load.is_coupled:
        change = sub(change, rotate(load.coupled_stiffness, other_strain_tangent(scene, load)))
    load_on_b: Vec3
    if load.kind == BUSHING_SHIFT:
        load_on_b = load.force
    else:
        change = bushing_moment_tangent(x, sub(vector, elastic_load(scene, load, x)), dx, change)
        load_on_b = load.moment
    turned: Vec3 = vector_tangent(scene, load.a, load_on_b)
    return BushingTangent(add(rotate(T, sub(change, drag)), turned), loss)
