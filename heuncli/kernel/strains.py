"""The strain of a load between two bodies: the length of its line, or a bushing's shift and rotation in its own axes.

d = T' (x_b - x_a)              shift of b's point relative to a's, in the axes T = R_a F_a, which turn with a
exp [phi] = T' R_b F_b          rotation vector of b relative to a, in the same axes; |phi| <= pi
l = |x_b - x_a|,  l' = n . (v_b - v_a)
"""

from __future__ import annotations

from math import atan2, sqrt

from heuncli.kernel.carried_points import point_motion, world_place
from heuncli.kernel.declarations import *
from heuncli.kernel.ropes import free_length, measure_rope


def bushing_axes(scene: cython.pointer[Scene], load: cython.pointer[Load]) -> Mat3:
    """Return T, axes of a bushing to world."""
    return load.frame if load.a < 0 else product(scene.bodies[load.a].R, load.frame)


def find_span_vector(scene: cython.pointer[Scene], load: cython.pointer[Load]) -> Vec3:
    """Return the vector from a's point to b's, world axes."""
    return sub(world_place(scene, load.b, load.q), world_place(scene, load.a, load.p))


def find_bushing_rotation(scene: cython.pointer[Scene], load: cython.pointer[Load]) -> Vec3:
    """Return phi."""
    T: Mat3 = bushing_axes(scene, load)
    B: Mat3 = load.to_frame if load.b < 0 else product(scene.bodies[load.b].R, load.to_frame)
    x: Vec3 = rotate_back(T, Vec3(B.xx, B.yx, B.zx))
    y: Vec3 = rotate_back(T, Vec3(B.xy, B.yy, B.zy))
    z: Vec3 = rotate_back(T, Vec3(B.xz, B.yz, B.zz))
    return find_rotation_vector(Mat3(x.x, y.x, z.x, x.y, y.y, z.y, x.z, y.z, z.z))


def bushing_strain(scene: cython.pointer[Scene], load: cython.pointer[Load]) -> Vec3:
    """Return d or phi, depending on the part of a bushing that the load is."""
    if load.kind == BUSHING_SHIFT:
        return rotate_back(bushing_axes(scene, load), find_span_vector(scene, load))
    return find_bushing_rotation(scene, load)


def find_rotation_vector(R: Mat3) -> Vec3:
    """Return phi of a rotation, from its quaternion."""
    q: Quaternion = find_quaternion(R)
    v: Vec3 = Vec3(q.x, q.y, q.z)
    s: cython.double = norm(v)
    if s < 1e-3:
        return scale_vector(2.0 + s * s * (1.0 / 3.0 + 0.15 * s * s), v)
    return scale_vector(2.0 * atan2(s, q.w) / s, v)


def find_quaternion(R: Mat3) -> Quaternion:
    """Return the quaternion of a rotation with w >= 0, without cancellation."""
    trace: cython.double = R.xx + R.yy + R.zz
    w: cython.double
    x: cython.double
    y: cython.double
    z: cython.double
    r: cython.double
    if trace >= R.xx and trace >= R.yy and trace >= R.zz:
        r = sqrt(1.0 + trace)
        w = 0.5 * r
        x = 0.5 * (R.zy - R.yz) / r
        y = 0.5 * (R.xz - R.zx) / r
        z = 0.5 * (R.yx - R.xy) / r
    elif R.xx >= R.yy and R.xx >= R.zz:
        r = sqrt(1.0 + R.xx - R.yy - R.zz)
        w = 0.5 * (R.zy - R.yz) / r
        x = 0.5 * r
        y = 0.5 * (R.xy + R.yx) / r
        z = 0.5 * (R.xz + R.zx) / r
    elif R.yy >= R.zz:
        r = sqrt(1.0 + R.yy - R.xx - R.zz)
        w = 0.5 * (R.xz - R.zx) / r
        x = 0.5 * (R.xy + R.yx) / r
        y = 0.5 * r
        z = 0.5 * (R.yz + R.zy) / r
    else:
        r = sqrt(1.0 + R.zz - R.xx - R.yy)
        w = 0.5 * (R.yx - R.xy) / r
        x = 0.5 * (R.xz + R.zx) / r
        y = 0.5 * (R.yz + R.zy) / r
        z = 0.5 * r
    return Quaternion(w, x, y, z) if w >= 0.0 else Quaternion(-w, -x, -y, -z)


def evaluate_load_variable(scene: cython.pointer[Scene], variable: cython.pointer[Variable]) -> cython.double:
    """Return the length of a load's line or rope, its rate, or a component of a bushing's strain, as the variable asks
    for.
    """
    load: cython.pointer[Load] = cython.address(scene.loads[variable.load])
    if variable.part == DRAWN:
        return free_length(scene, load).rate
    if load.kind == ROPE:
        rope: RopeMotion = measure_rope(scene, load)
        return rope.rate if variable.is_rate else rope.S
    if variable.part != ALONG_LINE:
        return vector_component(bushing_strain(scene, load), variable.part)
    return line_rate(scene, load) if variable.is_rate else norm(find_span_vector(scene, load))


def vector_component(x: Vec3, part: cython.int) -> cython.double:
    """Return a vector's component along one of the axes."""
    return x.x if part == 0 else x.y if part == 1 else x.z


def line_rate(scene: cython.pointer[Scene], load: cython.pointer[Load]) -> cython.double:
    """Return l'; 0 if the length is zero."""
    span: Vec3 = find_span_vector(scene, load)
    length: cython.double = norm(span)
    return dot(span, separation_velocity(scene, load)) / length if length > 0.0 else 0.0


def separation_velocity(scene: cython.pointer[Scene], load: cython.pointer[Load]) -> Vec3:
    """Return the velocity of b's point minus that of a's, world axes."""
    end_place: Vec3 = world_place(scene, load.b, load.q)
    start_place: Vec3 = world_place(scene, load.a, load.p)
    return sub(point_motion(scene, load.b, end_place).v, point_motion(scene, load.a, start_place).v)
