"""What bushings change by along a direction of the state: bushings.py, differentiated line by line."""

from __future__ import annotations

try:
    import cython
except ImportError:
    from heuncli.kernel.shadow import cython

if not cython.compiled:
    from heuncli.kernel.algebra import Mat3, Vec3, add, dot, rotate, rotate_back, sub
    from heuncli.kernel.bushings import moment_along, multiply_components
    from heuncli.kernel.loads import given_vector
    from heuncli.kernel.scene import BUSHING_SHIFT, Load, Scene
    from heuncli.kernel.shadow import cython
    from heuncli.kernel.strains import axes_of
    from heuncli.kernel.tangent_motion import swung
    from heuncli.kernel.tangent_strains import strain_along
    from heuncli.kernel.values import BushingTangent


def bushing_along(
    scene: cython.pointer[Scene], load: cython.pointer[Load], slope: Vec3, motion: Vec3, d_motion: Vec3
) -> BushingTangent:
    """Of force or moment on b, world axes, and of the power of its damping.

    slope: of its given components; motion: of b as seen from a, world axes, and what that changes by.
    """
    T: Mat3 = axes_of(scene, load)
    given: Vec3 = given_vector(scene, load)
    rate: Vec3 = rotate_back(T, motion)
    d_rate: Vec3 = rotate_back(T, sub(d_motion, swung(scene, load.a, motion)))
    drag: Vec3 = multiply_components(load.resistances, d_rate)
    loss: cython.double = -2.0 * dot(multiply_components(load.resistances, rate), d_rate)
    x: Vec3 = load.strain
    dx: Vec3 = strain_along(scene, load, x)
    change: Vec3 = sub(slope, multiply_components(load.stiffnesses, dx))
    acts: Vec3
    if load.kind == BUSHING_SHIFT:
        acts = load.force
    else:
        change = moment_along(x, sub(given, multiply_components(load.stiffnesses, x)), dx, change)
        acts = load.moment
    turned: Vec3 = swung(scene, load.a, acts)
    return BushingTangent(add(rotate(T, sub(change, drag)), turned), loss)
