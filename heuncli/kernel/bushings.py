"""Bushings: springs and dampers between two bodies, three along and three about the axes T of body a.

    d, phi                          shift of b's point, rotation vector of b relative to a, in the axes T (strains.py)
    f = g(d) - K d - D d'           force on b at its point
    m = J^-T (g(phi) - C phi) - D omega,  phi' = J^-1 omega,  J^-1 = 1 - [phi]/2 + c [phi]^2
    c = (1 - theta/2 cot(theta/2)) / theta^2,  theta = |phi|

Body a takes the opposite of f and m at b's point. g is a preload minus the tables, each a function of the component
along its own axis. So everything but the damping has a potential at any angle: 1/2 d'Kd and 1/2 phi' C phi minus the
integrals of g. The rate of d is the velocity of b's point as seen from a, the rate of phi follows from omega =
T'(omega_b - omega_a), and m'omega = g'phi'. J is the left Jacobian of rotations: Sola, Deray, Atchuthan, A micro Lie
theory (2018), (145)-(146). At a half turn phi and -phi are the same attitude, and the moment jumps between two values:
there it has no value.
"""

from __future__ import annotations

from math import sqrt

from heuncli.kernel.declarations import *
from heuncli.kernel.evaluator import area_under, read_table
from heuncli.kernel.libm import NAN, tan
from heuncli.kernel.strains import bushing_axes, bushing_strain
from heuncli.kernel.tree import add_load_to_body

# The map between turns and rotation vectors


def square_coefficient(phi: Vec3) -> cython.double:
    """Return c of the module's formulas."""
    square: cython.double = dot(phi, phi)
    if square < 4e-4:
        return 1.0 / 12.0 + square * (1.0 / 720.0 + square / 30240.0)
    half: cython.double = 0.5 * sqrt(square)
    return (1.0 - half / tan(half)) / square


def square_coefficient_slope(phi: Vec3) -> cython.double:
    """Return e with dc = e phi . dphi."""
    square: cython.double = dot(phi, phi)
    if square < 4e-2:
        return 1.0 / 360.0 + square * (1.0 / 7560.0 + square * (1.0 / 201600.0 + square / 5987520.0))
    theta: cython.double = sqrt(square)
    s: cython.double = 1.0 / tan(0.5 * theta)  # 1/sin^2 = 1 + cot^2
    return ((0.25 * (1.0 + s * s) * theta + 0.5 * s) * theta - 2.0) / (square * square)


def rotation_vector_rate(phi: Vec3, omega: Vec3) -> Vec3:
    """Return J^-1 omega, using that J^-1 of phi is J^-T of -phi."""
    return bushing_moment(scale_vector(-1.0, phi), omega)


def bushing_moment(phi: Vec3, gamma: Vec3) -> Vec3:
    """Return J^-T gamma."""
    first: Vec3 = cross(phi, gamma)
    return add_scaled(add_scaled(gamma, 0.5, first), square_coefficient(phi), cross(phi, first))


def bushing_moment_tangent(phi: Vec3, gamma: Vec3, dphi: Vec3, dgamma: Vec3) -> Vec3:
    """Return the change of J^-T gamma."""
    first: Vec3 = cross(phi, gamma)
    change: Vec3 = cross(dphi, gamma)
    found: Vec3 = add_scaled(bushing_moment(phi, dgamma), 0.5, change)
    found = add_scaled(found, square_coefficient(phi), add(cross(dphi, first), cross(phi, change)))
    return add_scaled(found, square_coefficient_slope(phi) * dot(phi, dphi), cross(phi, first))


# What it does


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
    load.from_at = load.at
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
        add_load_to_body(scene, load.b, load.at, load.force, load.moment)
        add_load_to_body(scene, load.a, load.at, scale_vector(-1.0, load.force), scale_vector(-1.0, load.moment))
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
