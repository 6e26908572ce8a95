"""The change of bushings along a direction of the state: bushings.py, differentiated line by line."""

from __future__ import annotations

from heuncli.kernel.bushings import bushing_moment_tangent, multiply_components
from heuncli.kernel.declarations import *
from heuncli.kernel.loads import evaluate_load_vector
from heuncli.kernel.strains import bushing_axes
from heuncli.kernel.tangent_motion import vector_tangent
from heuncli.kernel.tangent_strains import strain_tangent


def bushing_tangent(
    scene: cython.pointer[Scene],
    load: cython.pointer[Load],
    preload_change: Vec3,
    velocity: Vec3,
    velocity_change: Vec3,
) -> BushingTangent:
    """Return the change of the force or moment on b, world axes, and of the power of its damping.

    preload_change: of its given components
    velocity: of b as seen from a, world axes, and its change
    """
    T: Mat3 = bushing_axes(scene, load)
    given: Vec3 = evaluate_load_vector(scene, load)
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
        change = bushing_moment_tangent(x, sub(given, multiply_components(load.stiffnesses, x)), dx, change)
        load_on_b = load.moment
    turned: Vec3 = vector_tangent(scene, load.a, load_on_b)
    return BushingTangent(add(rotate(T, sub(change, drag)), turned), loss)
