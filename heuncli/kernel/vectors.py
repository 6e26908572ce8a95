"""Vectors of bodies and of arrays: directions fixed in bodies, vectors and quaternions among the numbers of a state."""

from __future__ import annotations

from heuncli.kernel.algebra import Quaternion, Vec3, rotate
from heuncli.kernel.scene import Scene
from heuncli.kernel.structs import Pointer, Size


def world_direction(scene: Pointer[Scene], body: int, a: Vec3) -> Vec3:
    """Return the world components of a direction fixed in a body, or in the ground (-1)."""
    if body < 0:
        return a
    return rotate(scene.bodies[body].R, a)


def write_number(numbers: list[float], offset: Size, x: float) -> Size:
    """Write a number at `offset`; return the offset behind it."""
    numbers[offset] = x
    return offset + 1


def read_vector(numbers: list[float], offset: Size) -> Vec3:
    """Return the vector whose components begin at `offset`."""
    return Vec3(numbers[offset], numbers[offset + 1], numbers[offset + 2])


def write_vector(numbers: list[float], offset: Size, a: Vec3) -> Size:
    """Write a vector from `offset` on; return the offset behind it."""
    numbers[offset] = a.x
    numbers[offset + 1] = a.y
    numbers[offset + 2] = a.z
    return offset + 3


def read_quaternion(numbers: list[float], offset: Size) -> Quaternion:
    """Return the quaternion whose components begin at `offset`."""
    return Quaternion(numbers[offset], numbers[offset + 1], numbers[offset + 2], numbers[offset + 3])


def write_quaternion(numbers: list[float], offset: Size, q: Quaternion) -> Size:
    """Write a quaternion from `offset` on; return the offset behind it."""
    numbers[offset] = q.w
    numbers[offset + 1] = q.x
    numbers[offset + 2] = q.y
    numbers[offset + 3] = q.z
    return offset + 4
