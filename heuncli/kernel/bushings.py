"""Bushings: springs and dampers between two bodies, three along and three about the axes T of body a.

    d, phi                          shift of b's point, rotation vector of b relative to a, in the axes T (strains.py)
    f = g(d) - K d - D d'           force on b at its point
    m = J^-T (g(phi) - C phi) - D omega,  phi' = J^-1 omega          J: strains.py

Body a takes the opposite of f and m at b's point. g is a preload minus the tables, each a function of the component
along its own axis. So everything but the damping has a potential at any angle: 1/2 d'Kd and 1/2 phi' C phi minus the
integrals of g. The rate of d is the velocity of b's point as seen from a, the rate of phi follows from omega =
T'(omega_b - omega_a), and m'omega = g'phi'. At a half turn phi and -phi are the same attitude, and the moment jumps
between two values: there it has no value.

Below: its change along a direction of the state, line by line.
"""

from __future__ import annotations

from heuncli.kernel.declarations import *
from heuncli.kernel.evaluator import area_under, read_table
from heuncli.kernel.kinematics import add_load_to_body
from heuncli.kernel.libm import NAN
from heuncli.kernel.strains import bushing_axes, bushing_moment, bushing_moment_tangent, bushing_strain, strain_tangent
from heuncli.kernel.tangent_motion import vector_tangent


def multiply_components(k: Vec3, x: Vec3) -> Vec3:
    """Multiply two vectors component by component."""
    return Vec3(k.x * x.x, k.y * x.y, k.z * x.z)


def apply_bushing_load(
    scene: cython.pointer[Scene], load: cython.pointer[Load], preload: Vec3, velocity: Vec3
) -> cython.double:
    """Apply the force or moment of a bushing to both bodies. Returns the power of its damping, which has no potential.

    preload: force or moment that does not depend linearly on the strain, in the axes T
    velocity: velocity of b's point, or angular velocity of b, as seen from a

    A bushing within one body strains only that body and moves nothing.
    """
    T: Mat3 = bushing_axes(scene, load)
    load.strain = bushing_strain(scene, load)
    load.span = norm(load.strain)
    load.place_on_a = load.place
    rate: Vec3 = rotate_back(T, velocity)
    if load.a == load.b:
        rate = Vec3(0.0, 0.0, 0.0)
    gamma: Vec3 = sub(preload, multiply_components(load.stiffnesses, load.strain))
    drag: Vec3 = multiply_components(load.resistances, rate)
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
    """1/2 x'Kx + the areas under the tables, minus the work of a preload, for x = d or phi [J]."""
    x: Vec3 = bushing_strain(scene, load)
    found: cython.double = 0.5 * dot(x, multiply_components(load.stiffnesses, x)) - dot(load.vector, x)
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
    velocity: Vec3,
    velocity_change: Vec3,
) -> BushingTangent:
    """Return the change of the force or moment on b, world axes, and of the power of its damping.

    vector: its given components, and preload_change: their change
    velocity: of b as seen from a, world axes, and its change
    """
    T: Mat3 = bushing_axes(scene, load)
    rate: Vec3 = rotate_back(T, velocity)
    d_rate: Vec3 = rotate_back(T, sub(velocity_change, vector_tangent(scene, load.a, velocity)))
    drag: Vec3 = multiply_components(load.resistances, d_rate)
    loss: cython.double = -2.0 * dot(multiply_components(load.resistances, rate), d_rate)
    x: Vec3 = load.strain
    dx: Vec3 = strain_tangent(scene, load, x)
    change: Vec3 = sub(preload_change, multiply_components(load.stiffnesses, dx))
    load_on_b: Vec3
    if load.kind == BUSHING_SHIFT:
        load_on_b = load.force
    else:
        change = bushing_moment_tangent(x, sub(vector, multiply_components(load.stiffnesses, x)), dx, change)
        load_on_b = load.moment
    turned: Vec3 = vector_tangent(scene, load.a, load_on_b)
    return BushingTangent(add(rotate(T, sub(change, drag)), turned), loss)
