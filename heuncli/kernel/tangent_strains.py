"""The change of variables that depend on the bodies' places, along a direction of the state (strains.py).

l = |D|, D = l n:   dl = n . dD,  dn = (dD - n dl) / l,  d(l') = dn . v + n . dv
dd = T' (dD - t x D),   dphi = J^-1 T' (t_b - t_a)                  t: rotation of a, T turns with it
"""

from __future__ import annotations

from heuncli.kernel.bushings import rotation_vector_rate
from heuncli.kernel.declarations import *
from heuncli.kernel.strains import (
    bushing_axes,
    bushing_strain,
    find_span_vector,
    separation_velocity,
    vector_component,
)
from heuncli.kernel.tangent_motion import point_tangent, rotation_tangent, vector_tangent
from heuncli.kernel.tangent_ropes import rope_tangent


def set_variable_slopes(scene: cython.pointer[Scene]) -> cython.void:
    """Set the changes of the variables that belong to points or loads."""
    i: cython.Py_ssize_t
    for i in range(1, scene.variable_count):
        variable: cython.pointer[Variable] = cython.address(scene.variables[i])
        if variable.is_point:
            if variable.is_point == OF_LOAD:
                scene.slopes[i] = load_variable_slope(scene, variable)
            else:
                point: PointMotion = point_tangent(scene, variable.body, variable.q)
                scene.slopes[i] = dot(variable.direction, point.v if variable.is_rate else point.x)
            if scene.slopes[i] != 0.0:
                scene.sloping = 1


def load_variable_slope(scene: cython.pointer[Scene], variable: cython.pointer[Variable]) -> cython.double:
    """Return the change of a variable that belongs to a load."""
    load: cython.pointer[Load] = cython.address(scene.loads[variable.load])
    if variable.part == DRAWN:
        return 0.0
    if load.kind == ROPE:
        rope: RopeMotion = rope_tangent(scene, load)
        return rope.rate if variable.is_rate else rope.S
    if variable.part == ALONG_LINE:
        line: LineTangent = line_tangent(scene, load)
        return line.rate if variable.is_rate else line.length
    return vector_component(strain_tangent(scene, load, bushing_strain(scene, load)), variable.part)


def line_tangent(scene: cython.pointer[Scene], load: cython.pointer[Load]) -> LineTangent:
    """Return the change of the line between a load's two points; zero if its length is zero."""
    span: Vec3 = find_span_vector(scene, load)
    length: cython.double = norm(span)
    if load.a == load.b or not length > 0.0:
        return LineTangent(Vec3(0.0, 0.0, 0.0), 0.0, 0.0)
    w: cython.double = 1.0 / length
    n: Vec3 = scale_vector(w, span)
    end_change: PointMotion = point_tangent(scene, load.b, load.q)
    start_change: PointMotion = point_tangent(scene, load.a, load.p)
    change: Vec3 = sub(end_change.x, start_change.x)
    longer: cython.double = dot(n, change)
    direction_change: Vec3 = scale_vector(w, add_scaled(change, -longer, n))
    return LineTangent(
        direction_change,
        longer,
        dot(direction_change, separation_velocity(scene, load)) + dot(n, sub(end_change.v, start_change.v)),
    )


def strain_tangent(scene: cython.pointer[Scene], load: cython.pointer[Load], x: Vec3) -> Vec3:
    """Return the change of a bushing's shift or rotation x."""
    if load.a == load.b:
        return Vec3(0.0, 0.0, 0.0)
    if load.kind == BUSHING_SHIFT:
        displacement: Vec3 = sub(point_tangent(scene, load.b, load.q).x, point_tangent(scene, load.a, load.p).x)
        swept: Vec3 = vector_tangent(scene, load.a, rotate(bushing_axes(scene, load), x))
        return rotate_back(bushing_axes(scene, load), sub(displacement, swept))
    relative_rotation: Vec3 = sub(rotation_tangent(scene, load.b), rotation_tangent(scene, load.a))
    return rotation_vector_rate(x, rotate_back(bushing_axes(scene, load), relative_rotation))
