"""Points that bodies carry: where they are, and how they move."""

from __future__ import annotations

try:
    import cython
except ImportError:
    from heuncli.kernel.shadow import cython

if not cython.compiled:
    from heuncli.kernel.algebra import Vec3, add, add_cross, centripetal, rotate, sub
    from heuncli.kernel.scene import Body, Scene
    from heuncli.kernel.shadow import cython
    from heuncli.kernel.values import Carried


def carried(scene: cython.pointer[Scene], body: cython.int, x: Vec3) -> Carried:
    """How the body's point at the world place x moves; the ground's does not."""
    if body < 0:
        zero: Vec3 = Vec3(0.0, 0.0, 0.0)
        return Carried(zero, zero, zero)
    on: cython.pointer[Body] = cython.address(scene.bodies[body])
    arm: Vec3 = sub(x, on.r)
    return Carried(add_cross(on.v, on.omega, arm), centripetal(on.omega, arm), on.omega)


def place_of(scene: cython.pointer[Scene], body: cython.int, q: Vec3) -> Vec3:
    """World place of a body's point, given from its joint point in its axes; a ground point as it is."""
    if body < 0:
        return q
    return add(rotate(scene.bodies[body].R, q), scene.bodies[body].r)
