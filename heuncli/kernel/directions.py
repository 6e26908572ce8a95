"""Directions fixed in bodies, in world axes."""

from __future__ import annotations

from heuncli.kernel.algebra import Vec3, rotate
from heuncli.kernel.scene import Scene
from heuncli.kernel.structs import Pointer


def world_direction(scene: Pointer[Scene], body: int, a: Vec3) -> Vec3:
    """Return the world components of a direction fixed in a body, or in the ground (-1)."""
    if body < 0:
        return a
    return rotate(scene.bodies[body].R, a)
