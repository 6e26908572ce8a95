"""The change of points fixed in bodies, and of bodies' angular accelerations, along a direction of the state."""

from __future__ import annotations

from heuncli.kernel.declarations import *


def point_acceleration(scene: cython.pointer[Scene], body: cython.int, x: Vec3) -> Vec3:
    """Return the acceleration, minus gravity, of the body's point at the place x; in a planar scene its part in the
    plane.
    """
    if body < 0:
        return Vec3(-scene.gravity.x, -scene.gravity.y, 0.0 if scene.flat else -scene.gravity.z)
    carrier: cython.pointer[Body] = cython.address(scene.bodies[body])
    base: cython.pointer[BodyAtState] = cython.address(scene.at_state[body])
    arm: Vec3 = sub(x, carrier.r)
    return add(add_cross(base.a, base.alpha, arm), centripetal(carrier.omega, arm))


def point_motion_tangent(scene: cython.pointer[Scene], body: cython.int, x: Vec3, change: Vec3) -> MotionTangent:
    """Return the changes of velocity and acceleration of the body's point at the place x as that place changes."""
    if body < 0:
        return MotionTangent(Vec3(0.0, 0.0, 0.0), Vec3(0.0, 0.0, 0.0))
    carrier: cython.pointer[Body] = cython.address(scene.bodies[body])
    d: cython.pointer[BodyTangent] = cython.address(scene.tangents[body])
    arm: Vec3 = sub(x, carrier.r)
    displacement: Vec3 = sub(change, d.r)
    swept: Vec3 = add_cross(cross(d.omega, arm), carrier.omega, displacement)
    a: Vec3 = add_cross(add_cross(d.a, d.alpha, arm), scene.at_state[body].alpha, displacement)
    a = add_cross(add_cross(a, d.omega, cross(carrier.omega, arm)), carrier.omega, swept)
    return MotionTangent(add(d.v, swept), a)


def body_alpha(scene: cython.pointer[Scene], body: cython.int) -> Vec3:
    """Return the angular acceleration of a body at the state; zero for the ground."""
    if body < 0:
        return Vec3(0.0, 0.0, 0.0)
    return scene.at_state[body].alpha


def alpha_tangent(scene: cython.pointer[Scene], body: cython.int) -> Vec3:
    """Return the change of a body's angular acceleration."""
    if body < 0:
        return Vec3(0.0, 0.0, 0.0)
    return scene.tangents[body].alpha
