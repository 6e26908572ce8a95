"""Directions that bodies carry: how they stand in the world."""

from __future__ import annotations

from heuncli.kernel.algebra import Vec3, rotate
from heuncli.kernel.scene import Scene
from heuncli.kernel.structs import Pointer


def direction_of(scene: Pointer[Scene], body: int, a: Vec3) -> Vec3:
    """World components of a direction fixed in a body, or in the ground (-1)."""
    if body < 0:
        return a
    return rotate(scene.bodies[body].R, a)
