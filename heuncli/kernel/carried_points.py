"""Points fixed in bodies: their places, their motion, and the change of both along a direction of the state."""

from __future__ import annotations

from math import atan2, fabs

from heuncli.kernel.declarations import *
from heuncli.kernel.tangent_motion import omega_tangent


def point_motion(scene: cython.pointer[Scene], body: cython.int, x: Vec3) -> PointKinematics:
    """Return how a body's point at the world place x moves; a ground point does not."""
    if body < 0:
        zero: Vec3 = Vec3(0.0, 0.0, 0.0)
        return PointKinematics(zero, zero, zero)
    carrier: cython.pointer[Body] = cython.address(scene.bodies[body])
    arm: Vec3 = sub(x, carrier.r)
    return PointKinematics(add_cross(carrier.v, carrier.omega, arm), centripetal(carrier.omega, arm), carrier.omega)


def relative_centripetal(a: PointKinematics, b: PointKinematics, v: Vec3) -> Vec3:
    """Return cen_b - cen_a - 2 omega_a x v, of the points of two bodies at one place, v = v_b - v_a: the acceleration
    of b's as seen from a, less what the freedoms' accelerations contribute.
    """
    return add_scaled(sub(b.centripetal, a.centripetal), -2.0, cross(a.omega, v))


def world_place(scene: cython.pointer[Scene], body: cython.int, q: Vec3) -> Vec3:
    """Return the world place of a body's point, given from its joint point in the body's axes; a ground point is
    returned as it is.
    """
    if body < 0:
        return q
    return add(rotate(scene.bodies[body].R, q), scene.bodies[body].r)


def body_omega(scene: cython.pointer[Scene], body: cython.int) -> Vec3:
    """Return the angular velocity of a body; zero for the ground."""
    if body < 0:
        return Vec3(0.0, 0.0, 0.0)
    return scene.bodies[body].omega


# Along a direction of the state


def point_acceleration(scene: cython.pointer[Scene], body: cython.int, x: Vec3) -> Vec3:
    """Return the acceleration, minus gravity, of the body's point at the place x; in a planar scene its part in the
    plane.
    """
    if body < 0:
        return Vec3(-scene.gravity.x, -scene.gravity.y, 0.0 if scene.flat else -scene.gravity.z)
    carrier: cython.pointer[Body] = cython.address(scene.bodies[body])
    base: cython.pointer[BodyAtState] = cython.address(scene.state_values[body])
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
    a: Vec3 = add_cross(add_cross(d.a, d.alpha, arm), scene.state_values[body].alpha, displacement)
    a = add_cross(add_cross(a, d.omega, cross(carrier.omega, arm)), carrier.omega, swept)
    return MotionTangent(add(d.v, swept), a)


def find_relative_motion(scene: cython.pointer[Scene], row: cython.pointer[Closure], dQ: Vec3) -> RelativeMotion:
    """Find how b's point at Q of a row moves as seen from a, A = A_b - A_a - 2 omega_a x v; dQ: the change of Q."""
    b: MotionTangent = point_motion_tangent(scene, row.b, row.Q, dQ)
    a: MotionTangent = point_motion_tangent(scene, row.a, row.Q, dQ)
    omega: Vec3 = body_omega(scene, row.a)
    v: Vec3 = sub(point_motion(scene, row.b, row.Q).v, point_motion(scene, row.a, row.Q).v)
    dv: Vec3 = sub(b.v, a.v)
    A: Vec3 = sub(point_acceleration(scene, row.b, row.Q), point_acceleration(scene, row.a, row.Q))
    A = add_scaled(A, -2.0, cross(omega, v))
    dA: Vec3 = add_scaled(sub(b.a, a.a), -2.0, add_cross(cross(omega_tangent(scene, row.a), v), omega, dv))
    return RelativeMotion(v, A, dv, dA)


def body_alpha(scene: cython.pointer[Scene], body: cython.int) -> Vec3:
    """Return the angular acceleration of a body at the state; zero for the ground."""
    if body < 0:
        return Vec3(0.0, 0.0, 0.0)
    return scene.state_values[body].alpha


def alpha_tangent(scene: cython.pointer[Scene], body: cython.int) -> Vec3:
    """Return the change of a body's angular acceleration."""
    if body < 0:
        return Vec3(0.0, 0.0, 0.0)
    return scene.tangents[body].alpha


# Angles of pins


def angle_of_pin(scene: cython.pointer[Scene], row: cython.pointer[Closure]) -> cython.double:
    """Return the angle of a TURN beyond its length; of a pin that was cut between marks of its bodies, to a turn."""
    if row.freedom >= 0:
        return scene.freedoms[row.freedom].q - row.length
    n: Vec3 = world_direction(scene, row.a, row.e)
    reference: Vec3 = world_direction(scene, row.a, find_perpendicular(row.e))
    mark: Vec3 = world_direction(scene, row.b, row.g)
    half: cython.double = 3.141592653589793
    angle: cython.double = atan2(dot(n, cross(reference, mark)), dot(reference, mark)) - row.length
    if angle > half:
        angle -= 2.0 * half
    elif angle < -half:
        angle += 2.0 * half
    return angle


def find_perpendicular(n: Vec3) -> Vec3:
    """Return a vector perpendicular to n."""
    if fabs(n.x) <= fabs(n.y) and fabs(n.x) <= fabs(n.z):
        return cross(n, Vec3(1.0, 0.0, 0.0))
    if fabs(n.y) <= fabs(n.z):
        return cross(n, Vec3(0.0, 1.0, 0.0))
    return cross(n, Vec3(0.0, 0.0, 1.0))
