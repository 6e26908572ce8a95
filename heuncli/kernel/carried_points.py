"""Points fixed in bodies: their places and their motion."""

from __future__ import annotations

from heuncli.kernel.declarations import *


def point_motion(scene: cython.pointer[Scene], body: cython.int, x: Vec3) -> PointKinematics:
    """Return how a body's point at the world place x moves; a ground point does not."""
    if body < 0:
        zero: Vec3 = Vec3(0.0, 0.0, 0.0)
        return PointKinematics(zero, zero, zero)
    carrier: cython.pointer[Body] = cython.address(scene.bodies[body])
    arm: Vec3 = sub(x, carrier.r)
    return PointKinematics(add_cross(carrier.v, carrier.omega, arm), centripetal(carrier.omega, arm), carrier.omega)


def world_place(scene: cython.pointer[Scene], body: cython.int, q: Vec3) -> Vec3:
    """Return the world place of a body's point, given from its joint point in the body's axes; a ground point is
    returned as it is.
    """
    if body < 0:
        return q
    return add(rotate(scene.bodies[body].R, q), scene.bodies[body].r)
