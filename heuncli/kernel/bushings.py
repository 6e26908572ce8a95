"""Bushings: springs and dampers between two bodies, three along and three about the axes T of the body a.

    d, phi                          shift of b's point, rotation vector of b against a, in the axes T (strains.py)
    f = g(d) - K d - D d'           force on b at its point
    m = J^-T (g(phi) - C phi) - D omega,  phi' = J^-1 omega,  J^-1 = 1 - [phi]/2 + c [phi]^2
    c = (1 - theta/2 cot(theta/2)) / theta^2,  theta = |phi|

a takes the opposite of f and m at b's point. g is a preload less tables, each of the component along its own axis. So
all but damping has potentials at any angle, 1/2 d'Kd and 1/2 phi' C phi less the integrals of g: what moves d is the
motion of b's point as seen from a, what turns phi is omega = T'(omega_b - omega_a), and m'omega = g'phi'. J is the left
Jacobian of the turns: Sola, Deray, Atchuthan, A micro Lie theory (2018), (145)-(146). At half a turn phi and -phi are
one attitude, and the moment jumps from one to the other: there it has no value.
"""

from __future__ import annotations

try:
    import cython
except ImportError:
    from heuncli.kernel.shadow import cython

if not cython.compiled:
    from math import sqrt

    from heuncli.kernel.algebra import Mat3, Vec3, add, add_scaled, cross, dot, norm, rotate, rotate_back, scaled, sub
    from heuncli.kernel.evaluator import area_under, table_at
    from heuncli.kernel.libm import NAN, tan
    from heuncli.kernel.programs import TABLE, Program, Programs
    from heuncli.kernel.scene import BUSHING_SHIFT, Load, Scene
    from heuncli.kernel.shadow import cython
    from heuncli.kernel.strains import axes_of, strain_of
    from heuncli.kernel.tree import push


# The map between turns and rotation vectors


def bend(phi: Vec3) -> cython.double:
    """c."""
    square: cython.double = dot(phi, phi)
    if square < 4e-4:
        return 1.0 / 12.0 + square * (1.0 / 720.0 + square / 30240.0)
    half: cython.double = 0.5 * sqrt(square)
    return (1.0 - half / tan(half)) / square


def bend_slope(phi: Vec3) -> cython.double:
    """e with dc = e phi . dphi."""
    square: cython.double = dot(phi, phi)
    if square < 4e-2:
        return 1.0 / 360.0 + square * (1.0 / 7560.0 + square * (1.0 / 201600.0 + square / 5987520.0))
    theta: cython.double = sqrt(square)
    s: cython.double = 1.0 / tan(0.5 * theta)  # 1/sin^2 = 1 + cot^2
    return ((0.25 * (1.0 + s * s) * theta + 0.5 * s) * theta - 2.0) / (square * square)


def rate_of_vector(phi: Vec3, omega: Vec3) -> Vec3:
    """J^-1 omega: J^-1 of phi is J^-T of -phi."""
    return moment_of(scaled(-1.0, phi), omega)


def moment_of(phi: Vec3, gamma: Vec3) -> Vec3:
    """J^-T gamma."""
    turned: Vec3 = cross(phi, gamma)
    return add_scaled(add_scaled(gamma, 0.5, turned), bend(phi), cross(phi, turned))


def moment_along(phi: Vec3, gamma: Vec3, dphi: Vec3, dgamma: Vec3) -> Vec3:
    """What J^-T gamma changes by."""
    turned: Vec3 = cross(phi, gamma)
    change: Vec3 = cross(dphi, gamma)
    found: Vec3 = add_scaled(moment_of(phi, dgamma), 0.5, change)
    found = add_scaled(found, bend(phi), add(cross(dphi, turned), cross(phi, change)))
    return add_scaled(found, bend_slope(phi) * dot(phi, dphi), cross(phi, turned))


# What it does


def multiply_components(k: Vec3, x: Vec3) -> Vec3:
    """Component by component."""
    return Vec3(k.x * x.x, k.y * x.y, k.z * x.z)


def bushing_load(scene: cython.pointer[Scene], load: cython.pointer[Load], given: Vec3, motion: Vec3) -> cython.double:
    """Force or moment of a bushing, put on both bodies; power of its damping, which has no potential.

    motion: velocity of b's point, or angular velocity of b, as seen from a. Within one body it loads what lies between,
    and moves nothing.
    """
    T: Mat3 = axes_of(scene, load)
    load.strain = strain_of(scene, load)
    load.span = norm(load.strain)
    load.from_at = load.at
    rate: Vec3 = rotate_back(T, motion)
    if load.a == load.b:
        rate = Vec3(0.0, 0.0, 0.0)
    gamma: Vec3 = sub(given, multiply_components(load.stiffnesses, load.strain))
    drag: Vec3 = multiply_components(load.resistances, rate)
    load.rate = norm(rate)
    acts: Vec3
    if load.kind == BUSHING_SHIFT:
        acts = sub(gamma, drag)
        load.force = rotate(T, acts)
    else:
        acts = sub(moment_of(load.strain, gamma), drag)
        if not load.span < load.length:  # half a turn: the moment has two values
            acts = Vec3(NAN, NAN, NAN)
        load.moment = rotate(T, acts)
    load.value = norm(acts)
    load.power = dot(acts, rate)
    if load.a != load.b:
        push(scene, load.b, load.at, load.force, load.moment)
        push(scene, load.a, load.at, scaled(-1.0, load.force), scaled(-1.0, load.moment))
    return -dot(drag, rate)


def bushing_energy(scene: cython.pointer[Scene], load: cython.pointer[Load]) -> cython.double:
    """1/2 x'Kx + the areas under the tables, less what a preload has given, of x = d or phi [J]."""
    x: Vec3 = strain_of(scene, load)
    found: cython.double = 0.5 * dot(x, multiply_components(load.stiffnesses, x)) - dot(load.vector, x)
    if load.x.count:
        found += area_in(scene.programs, load.x, x.x)
    if load.y.count:
        found += area_in(scene.programs, load.y, x.y)
    if load.z.count:
        found += area_in(scene.programs, load.z, x.z)
    return found


def area_in(programs: cython.pointer[Programs], program: Program, x: cython.double) -> cython.double:
    """The area, from 0 to x, under the one table that a given component is, less a preload."""
    at: cython.Py_ssize_t = program.start
    while programs.code[at].op != TABLE:
        at += 1
    k: cython.int = programs.code[at].argument
    return area_under(programs.tables[k], table_at(programs, at + 1, k), x)
