"""What points that bodies carry, and turns of bodies, change by along a direction of the state."""

from __future__ import annotations

try:
    import cython
except ImportError:
    from heuncli.kernel.shadow import cython

if not cython.compiled:
    from heuncli.kernel.algebra import Vec3, add, add_cross, centripetal, cross, sub
    from heuncli.kernel.scene import Body, BodyAtState, BodyTangent, Scene
    from heuncli.kernel.shadow import cython
    from heuncli.kernel.values import MotionTangent


def acceleration_at(scene: cython.pointer[Scene], body: cython.int, x: Vec3) -> Vec3:
    """Acceleration, less gravity, of the body's point at the place x; in a planar scene what lies in the plane."""
    if body < 0:
        return Vec3(-scene.gravity.x, -scene.gravity.y, 0.0 if scene.flat else -scene.gravity.z)
    on: cython.pointer[Body] = cython.address(scene.bodies[body])
    at: cython.pointer[BodyAtState] = cython.address(scene.at_state[body])
    arm: Vec3 = sub(x, on.r)
    return add(add_cross(at.a, at.alpha, arm), centripetal(on.omega, arm))


def carried_along(scene: cython.pointer[Scene], body: cython.int, x: Vec3, change: Vec3) -> MotionTangent:
    """What velocity and acceleration of the body's point at the place x change by as that place does."""
    if body < 0:
        return MotionTangent(Vec3(0.0, 0.0, 0.0), Vec3(0.0, 0.0, 0.0))
    on: cython.pointer[Body] = cython.address(scene.bodies[body])
    d: cython.pointer[BodyTangent] = cython.address(scene.tangents[body])
    arm: Vec3 = sub(x, on.r)
    way: Vec3 = sub(change, d.r)
    swept: Vec3 = add_cross(cross(d.omega, arm), on.omega, way)
    a: Vec3 = add_cross(add_cross(d.a, d.alpha, arm), scene.at_state[body].alpha, way)
    a = add_cross(add_cross(a, d.omega, cross(on.omega, arm)), on.omega, swept)
    return MotionTangent(add(d.v, swept), a)


def alpha_at(scene: cython.pointer[Scene], body: cython.int) -> Vec3:
    """Angular acceleration of a body at the state; none of the ground's."""
    if body < 0:
        return Vec3(0.0, 0.0, 0.0)
    return scene.at_state[body].alpha


def alpha_along(scene: cython.pointer[Scene], body: cython.int) -> Vec3:
    """What the angular acceleration of a body changes by."""
    if body < 0:
        return Vec3(0.0, 0.0, 0.0)
    return scene.tangents[body].alpha
