"""The strain of a load between two bodies: the length of its line or rope, or a bushing's shift and rotation.

A bushing, in its own axes:

    d = T' (x_b - x_a)              shift of b's point relative to a's, in the axes T = R_a F_a, which turn with a
    exp [phi] = T' R_b F_b          rotation vector of b relative to a, in the same axes; |phi| <= pi
    l = |x_b - x_a|,  l' = n . (v_b - v_a)
    phi' = J^-1 omega               J^-1 = 1 - [phi]/2 + c [phi]^2,  c = (1 - theta/2 cot(theta/2)) / theta^2

theta = |phi|; J is the left Jacobian of rotations: Sola, Deray, Atchuthan, A micro Lie theory (2018), (145)-(146).

An elastic rope, which also has its energy here:

    S = sum of the parts       conditions between two bodies, as closure rows have them (sheaves.py); those of an
                               elastic rope belong to no row, and its load applies `value` times their unit loads
    x = S - l0                 l0: free length, a number, or a law in time
    V = 1/2 k x^2
    k = k0 L / l0              k0: at the length L, for a shorter rope of the same kind is stiffer

A rope that only pulls stores nothing if it is shorter than l0: it is slack there.

Below each: the change along a direction of the state, t the rotation of a, with which T turns:

    D = l n:   dl = n . dD,  dn = (dD - n dl) / l,  d(l') = dn . v + n . dv
    dd = T' (dD - t x D),   dphi = J^-1 T' (t_b - t_a)
"""

from __future__ import annotations

from math import atan2, sqrt

from heuncli.kernel.carried_points import point_motion, world_place
from heuncli.kernel.conditions import condition_tangent, measure_condition, set_load_places
from heuncli.kernel.declarations import *
from heuncli.kernel.jets import jet
from heuncli.kernel.libm import tan
from heuncli.kernel.sheaves import body_rotation, point_displacement
from heuncli.kernel.tangent_motion import point_tangent, rotation_tangent, vector_tangent


def bushing_axes(scene: cython.pointer[Scene], load: cython.pointer[Load]) -> Mat3:
    """Return T, axes of a bushing to world."""
    return load.frame if load.a < 0 else product(scene.bodies[load.a].R, load.frame)


def find_span_vector(scene: cython.pointer[Scene], load: cython.pointer[Load]) -> Vec3:
    """Return the vector from a's point to b's, world axes."""
    return sub(world_place(scene, load.b, load.q), world_place(scene, load.a, load.p))


def find_bushing_rotation(scene: cython.pointer[Scene], load: cython.pointer[Load]) -> Vec3:
    """Return the rotation vector phi of b relative to a, bushing axes."""
    T: Mat3 = bushing_axes(scene, load)
    B: Mat3 = load.to_frame if load.b < 0 else product(scene.bodies[load.b].R, load.to_frame)
    x: Vec3 = rotate_back(T, Vec3(B.xx, B.yx, B.zx))
    y: Vec3 = rotate_back(T, Vec3(B.xy, B.yy, B.zy))
    z: Vec3 = rotate_back(T, Vec3(B.xz, B.yz, B.zz))
    return find_rotation_vector(Mat3(x.x, y.x, z.x, x.y, y.y, z.y, x.z, y.z, z.z))


def find_bushing_shift(scene: cython.pointer[Scene], load: cython.pointer[Load]) -> Vec3:
    """Return the shift d of b's point relative to a's, bushing axes."""
    return rotate_back(bushing_axes(scene, load), find_span_vector(scene, load))


def bushing_strain(scene: cython.pointer[Scene], load: cython.pointer[Load]) -> Vec3:
    """Return d or phi, depending on the part of a bushing that the load is."""
    return find_bushing_shift(scene, load) if load.kind == BUSHING_SHIFT else find_bushing_rotation(scene, load)


def other_strain(scene: cython.pointer[Scene], load: cython.pointer[Load]) -> Vec3:
    """Return the strain of the other part of a bushing: phi or d."""
    return find_bushing_rotation(scene, load) if load.kind == BUSHING_SHIFT else find_bushing_shift(scene, load)


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


# The map between turns and rotation vectors


def square_coefficient(phi: Vec3) -> cython.double:
    """Return c of J^-1 = 1 - [phi]/2 + c [phi]^2."""
    square: cython.double = dot(phi, phi)
    if square < 4e-4:
        return 1.0 / 12.0 + square * (1.0 / 720.0 + square / 30240.0)
    half: cython.double = 0.5 * sqrt(square)
    return (1.0 - half / tan(half)) / square


def square_coefficient_slope(phi: Vec3) -> cython.double:
    """Return e of dc = e phi . dphi, the change of c (square_coefficient)."""
    square: cython.double = dot(phi, phi)
    if square < 4e-2:
        return 1.0 / 360.0 + square * (1.0 / 7560.0 + square * (1.0 / 201600.0 + square / 5987520.0))
    theta: cython.double = sqrt(square)
    s: cython.double = 1.0 / tan(0.5 * theta)  # 1/sin^2 = 1 + cot^2
    return ((0.25 * (1.0 + s * s) * theta + 0.5 * s) * theta - 2.0) / (square * square)


def rotation_vector_rate(phi: Vec3, omega: Vec3) -> Vec3:
    """Return J^-1 omega, using that J^-1 of phi is J^-T of -phi."""
    return bushing_moment(scale_vector(-1.0, phi), omega)


def bushing_moment(phi: Vec3, gamma: Vec3) -> Vec3:
    """Return J^-T gamma."""
    first: Vec3 = cross(phi, gamma)
    return add_scaled(add_scaled(gamma, 0.5, first), square_coefficient(phi), cross(phi, first))


def bushing_moment_tangent(phi: Vec3, gamma: Vec3, dphi: Vec3, dgamma: Vec3) -> Vec3:
    """Return the change of J^-T gamma."""
    first: Vec3 = cross(phi, gamma)
    change: Vec3 = cross(dphi, gamma)
    found: Vec3 = add_scaled(bushing_moment(phi, dgamma), 0.5, change)
    found = add_scaled(found, square_coefficient(phi), add(cross(dphi, first), cross(phi, change)))
    return add_scaled(found, square_coefficient_slope(phi) * dot(phi, dphi), cross(phi, first))


# Along a direction of the state


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
                scene.has_slopes = 1


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
    return bushing_shift_tangent(scene, load, x) if load.kind == BUSHING_SHIFT else bushing_turn_tangent(scene, load, x)


def other_strain_tangent(scene: cython.pointer[Scene], load: cython.pointer[Load]) -> Vec3:
    """Return the change of the strain of the other part of a bushing between two bodies."""
    x: Vec3 = other_strain(scene, load)
    return bushing_turn_tangent(scene, load, x) if load.kind == BUSHING_SHIFT else bushing_shift_tangent(scene, load, x)


def bushing_shift_tangent(scene: cython.pointer[Scene], load: cython.pointer[Load], d: Vec3) -> Vec3:
    """Return the change of a bushing's shift d."""
    displacement: Vec3 = sub(point_tangent(scene, load.b, load.q).x, point_tangent(scene, load.a, load.p).x)
    swept: Vec3 = vector_tangent(scene, load.a, rotate(bushing_axes(scene, load), d))
    return rotate_back(bushing_axes(scene, load), sub(displacement, swept))


def bushing_turn_tangent(scene: cython.pointer[Scene], load: cython.pointer[Load], phi: Vec3) -> Vec3:
    """Return the change of a bushing's rotation vector phi."""
    relative_rotation: Vec3 = sub(rotation_tangent(scene, load.b), rotation_tangent(scene, load.a))
    return rotation_vector_rate(phi, rotate_back(bushing_axes(scene, load), relative_rotation))


# Elastic ropes


def only_pulls(load: cython.pointer[Load]) -> cython.bint:
    """Return whether a rope only pulls, and is slack where it is shorter than l0."""
    return load.in_body != 0


def has_length_law(load: cython.pointer[Load]) -> cython.bint:
    """Return whether l0 of a rope is a law in time."""
    return load.y.count > 0


def measure_rope(scene: cython.pointer[Scene], load: cython.pointer[Load]) -> RopeMotion:
    """Find S and S' at the present pose, and the unit loads of the rope's parts."""
    i: cython.Py_ssize_t
    S: cython.double = 0.0
    rate: cython.double = 0.0
    for i in range(load.part, load.part + load.part_count):
        part: cython.pointer[Closure] = cython.address(scene.parts[i])
        measure_condition(scene, part)
        set_load_places(scene, part)
        S += part.factor * part.gap
        rate += part.factor * part.rate
    return RopeMotion(S, rate)


def free_length(scene: cython.pointer[Scene], load: cython.pointer[Load]) -> Jet:
    """Return l0 with its rate."""
    if has_length_law(load):
        return jet(scene.programs, load.y, scene.programs.variables[0])
    return Jet(load.length, 0.0, 0.0)


def rope_stiffness(load: cython.pointer[Load], free: cython.double) -> cython.double:
    """Return k at a length l0."""
    return load.stiffness * load.length / free if has_length_law(load) else load.stiffness


def rope_stretch(load: cython.pointer[Load], S: cython.double, free: cython.double) -> cython.double:
    """Return x; 0 if the rope is slack."""
    x: cython.double = S - free
    return 0.0 if only_pulls(load) and x < 0.0 else x


def rope_energy(scene: cython.pointer[Scene], load: cython.pointer[Load]) -> cython.double:
    """Return V at the present pose [J]."""
    free: cython.double = free_length(scene, load).value
    x: cython.double = rope_stretch(load, measure_rope(scene, load).S, free)
    return 0.5 * rope_stiffness(load, free) * x * x


def rope_power(scene: cython.pointer[Scene], load: cython.pointer[Load]) -> cython.double:
    """Return the power value S' + dV/dt [W] that damping takes, and that a winch gives when it draws the rope in or
    pays it out.

    dV/dt = k x (S' - l0') - 1/2 k x^2 l0' / l0
    """
    free: Jet = free_length(scene, load)
    x: cython.double = rope_stretch(load, load.span, free.value)
    pull: cython.double = rope_stiffness(load, free.value) * x
    power: cython.double = load.value * load.rate + pull * (load.rate - free.rate)
    if has_length_law(load):
        power -= 0.5 * pull * x * free.rate / free.value
    return power


# Elastic ropes along a direction of the state


def rope_tangent(scene: cython.pointer[Scene], load: cython.pointer[Load]) -> RopeMotion:
    """Return the changes of S and S': dS = sum of f . (displacement of b - that of a at Q) + m . (rotation of b - that
    of a).
    """
    i: cython.Py_ssize_t
    longer: cython.double = 0.0
    faster: cython.double = 0.0
    for i in range(load.part, load.part + load.part_count):
        part: cython.pointer[Closure] = cython.address(scene.parts[i])
        part_change: cython.double = dot(
            part.f, sub(point_displacement(scene, part.b, part.Q), point_displacement(scene, part.a, part.Q))
        )
        part_change += dot(part.m, sub(body_rotation(scene, part.b), body_rotation(scene, part.a)))
        longer += part.factor * part_change
        faster += part.factor * condition_tangent(scene, part).rate
    return RopeMotion(longer, faster)


def rope_power_tangent(
    scene: cython.pointer[Scene], load: cython.pointer[Load], value_change: cython.double, d: RopeMotion
) -> cython.double:
    """Return the change of value S' + dV/dt at one instant; d: changes of S and S'."""
    free: Jet = free_length(scene, load)
    power: cython.double = value_change * load.rate + load.value * d.rate
    x: cython.double = rope_stretch(load, load.span, free.value)
    if x == 0.0 and only_pulls(load):
        return power
    k: cython.double = rope_stiffness(load, free.value)
    power += k * (d.S * (load.rate - free.rate) + x * d.rate)
    if has_length_law(load):
        power -= k * x * d.S * free.rate / free.value
    return power
