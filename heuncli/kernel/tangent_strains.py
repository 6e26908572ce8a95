"""What the variables that hang on where bodies are change by along a direction of the state (strains.py).

l = |D|, D = l n:   dl = n . dD,  dn = (dD - n dl) / l,  d(l') = dn . v + n . dv
dd = T' (dD - t x D),   dphi = J^-1 T' (t_b - t_a)                  t: what a turns by, T turns with it
"""

from __future__ import annotations

try:
    import cython
except ImportError:
    from heuncli.kernel.shadow import cython

if not cython.compiled:
    from heuncli.kernel.algebra import Vec3, add_scaled, dot, norm, rotate, rotate_back, scaled, sub
    from heuncli.kernel.bushings import rate_of_vector
    from heuncli.kernel.scene import ALONG_LINE, BUSHING_SHIFT, DRAWN, OF_LOAD, ROPE, Load, Scene, Variable
    from heuncli.kernel.shadow import cython
    from heuncli.kernel.strains import axes_of, component_of, find_span_vector, parting_of, strain_of
    from heuncli.kernel.tangent_motion import point_along, swung, turn_along_of
    from heuncli.kernel.tangent_ropes import rope_along
    from heuncli.kernel.values import LineTangent, PointMotion, RopeMotion


def variables_along(scene: cython.pointer[Scene]) -> cython.void:
    """Of the variables that are of points or loads."""
    i: cython.Py_ssize_t
    for i in range(1, scene.variable_count):
        variable: cython.pointer[Variable] = cython.address(scene.variables[i])
        if variable.is_point:
            if variable.is_point == OF_LOAD:
                scene.slopes[i] = of_load_along(scene, variable)
            else:
                there: PointMotion = point_along(scene, variable.body, variable.q)
                scene.slopes[i] = dot(variable.direction, there.v if variable.is_rate else there.x)
            if scene.slopes[i] != 0.0:
                scene.sloping = 1


def of_load_along(scene: cython.pointer[Scene], variable: cython.pointer[Variable]) -> cython.double:
    """Of a variable that is of a load."""
    load: cython.pointer[Load] = cython.address(scene.loads[variable.load])
    if variable.part == DRAWN:
        return 0.0
    if load.kind == ROPE:
        rope: RopeMotion = rope_along(scene, load)
        return rope.rate if variable.is_rate else rope.S
    if variable.part == ALONG_LINE:
        line: LineTangent = line_along(scene, load)
        return line.rate if variable.is_rate else line.length
    return component_of(strain_along(scene, load, strain_of(scene, load)), variable.part)


def line_along(scene: cython.pointer[Scene], load: cython.pointer[Load]) -> LineTangent:
    """Of the line between a load's two points; of one without length nothing is told."""
    span: Vec3 = find_span_vector(scene, load)
    length: cython.double = norm(span)
    if load.a == load.b or not length > 0.0:
        return LineTangent(Vec3(0.0, 0.0, 0.0), 0.0, 0.0)
    w: cython.double = 1.0 / length
    n: Vec3 = scaled(w, span)
    there: PointMotion = point_along(scene, load.b, load.q)
    here: PointMotion = point_along(scene, load.a, load.p)
    change: Vec3 = sub(there.x, here.x)
    longer: cython.double = dot(n, change)
    turned: Vec3 = scaled(w, add_scaled(change, -longer, n))
    return LineTangent(turned, longer, dot(turned, parting_of(scene, load)) + dot(n, sub(there.v, here.v)))


def strain_along(scene: cython.pointer[Scene], load: cython.pointer[Load], x: Vec3) -> Vec3:
    """Of a bushing's shift or turn x."""
    if load.a == load.b:
        return Vec3(0.0, 0.0, 0.0)
    if load.kind == BUSHING_SHIFT:
        moved: Vec3 = sub(point_along(scene, load.b, load.q).x, point_along(scene, load.a, load.p).x)
        swept: Vec3 = swung(scene, load.a, rotate(axes_of(scene, load), x))
        return rotate_back(axes_of(scene, load), sub(moved, swept))
    turned: Vec3 = sub(turn_along_of(scene, load.b), turn_along_of(scene, load.a))
    return rate_of_vector(x, rotate_back(axes_of(scene, load), turned))
