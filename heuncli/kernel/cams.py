"""A cam: a disc a that turns on a carrier c and moves a follower b, which slides or turns on the carrier too.

    x_b = L(phi)                    gap, L the lift over the disc's angle
    f . w_b = 1,  f . w_a = L'      f the load at the contact point Q, w_b and w_a the velocities of follower and disc
                                    there for unit rates, relative to the carrier

So f acts on both as the gap demands: it is perpendicular to L' w_b - w_a, the direction in which the follower's point
passes the disc. For a roller or a point that is the normal of the path of its centre in the disc. For a flat face f is
along the face's normal, and Q is where the face has no velocity along its normal relative to the disc, at the distance
L' from the axis if the follower slides. All of it is perpendicular to the disc's axis, in the plane through the
follower's point. e x (L' w - e x C), with C the follower's point from the disc's axis, points out of the disc wherever
that point is, because its path goes round the axis once. Where the flank has no point or no normal, or the follower
cannot be moved by a force normal to it, the load is NaN.
"""

from __future__ import annotations

from heuncli.kernel.carried_points import point_motion, world_place
from heuncli.kernel.declarations import *
from heuncli.kernel.libm import NAN
from heuncli.kernel.paths import evaluate_lift, evaluate_path
from heuncli.kernel.tangent_motion import point_tangent, vector_tangent


def cam_lift(scene: cython.pointer[Scene], row: cython.pointer[Closure]) -> PathPoint:
    """Return the lift: L, L', L'' and L''' in the first components."""
    if row.piece_branch:
        return evaluate_lift(scene, row)
    return evaluate_path(scene, row.lift, row.pieces, row.period, scene.freedoms[row.freedom].q)


def cam_stance(scene: cython.pointer[Scene], row: cython.pointer[Closure], slope: cython.double) -> CamStance:
    """Return the parts of a cam: O and e the disc's axis, C the follower's point, P and g its axis or guide."""
    O: Vec3 = world_place(scene, row.c, row.p)
    C: Vec3 = world_place(scene, row.b, row.q)
    e: Vec3 = world_direction(scene, row.c, row.e)
    g: Vec3 = world_direction(scene, row.c, row.g)
    w: Vec3 = cross(g, sub(C, world_place(scene, row.c, row.pivot))) if row.swings else g
    h: Vec3 = world_direction(scene, row.b, row.h)
    return CamStance(e, g, sub(C, O), w, h, slope)


def divide_or_nan(a: cython.double, b: cython.double) -> cython.double:
    """a / b, or NaN if b is zero."""
    return a / b if b != 0.0 else NAN


def find_cam_contact(row: cython.pointer[Closure], cam: CamStance) -> CamContact:
    """Find the contact point, from the follower's point on, and the direction of the load there before division by f .
    w_b.
    """
    zero: Vec3 = Vec3(0.0, 0.0, 0.0)
    n: Vec3
    if row.faced:
        k: Vec3 = cross(cam.e, cam.h)
        swept: Vec3 = cross(cam.e, k)
        if row.swings:
            swept = add_scaled(swept, -cam.slope, cross(cam.g, k))
        top: cython.double = cam.slope * dot(cam.h, cam.w) - dot(cam.h, cross(cam.e, cam.C))
        return CamContact(scale_vector(divide_or_nan(top, dot(cam.h, swept)), k), cam.h)
    n = cross(cam.e, sub(scale_vector(cam.slope, cam.w), cross(cam.e, cam.C)))
    if row.radius == 0.0:
        return CamContact(zero, n)
    return CamContact(scale_vector(-divide_or_nan(row.radius, norm(n)), n), n)


def measure_cam(scene: cython.pointer[Scene], row: cython.pointer[Closure]) -> cython.void:
    """Find unit load, gap, rate and gamma: gamma = -L'' phidot^2 - f . (h_b - h_a), where h is the velocity-dependent
    part of the acceleration at Q relative to the carrier.
    """
    lift: PathPoint = cam_lift(scene, row)
    cam: CamStance = cam_stance(scene, row, lift.slope.x)
    contact: CamContact = find_cam_contact(row, cam)
    u: cython.double = scene.freedoms[row.freedom].u
    u_b: cython.double = scene.freedoms[row.freedom_b].u
    w: Vec3 = add_cross(cam.w, cam.g, contact.offset) if row.swings else cam.w
    row.Q = add(world_place(scene, row.b, row.q), contact.offset)
    row.f = scale_vector(divide_or_nan(1.0, dot(contact.n, w)), contact.n)
    row.m = Vec3(0.0, 0.0, 0.0)
    row.gap = scene.freedoms[row.freedom_b].q - lift.r.x - row.length
    row.rate = u_b - lift.slope.x * u
    disc: Vec3 = pin_acceleration(scene, row.a, row.c, world_place(scene, row.c, row.p), scale_vector(u, cam.e), row.Q)
    follower: Vec3 = slider_acceleration(scene, row.b, row.c, scale_vector(u_b, cam.g), row.Q)
    if row.swings:
        follower = pin_acceleration(
            scene, row.b, row.c, world_place(scene, row.c, row.pivot), scale_vector(u_b, cam.g), row.Q
        )
    row.gamma = -lift.bend.x * u * u - dot(row.f, sub(follower, disc))


def pin_acceleration(
    scene: cython.pointer[Scene], body: cython.int, c: cython.int, pivot: Vec3, rate: Vec3, Q: Vec3
) -> Vec3:
    """Return, for a body that turns on the carrier at `rate`: cen_c(P) - cen(P) + (omega_c x rate) x (Q - P)."""
    carrier: PointKinematics = point_motion(scene, c, pivot)
    found: Vec3 = sub(carrier.centripetal, point_motion(scene, body, pivot).centripetal)
    return add_cross(found, cross(carrier.omega, rate), sub(Q, pivot))


def slider_acceleration(scene: cython.pointer[Scene], body: cython.int, c: cython.int, speed: Vec3, Q: Vec3) -> Vec3:
    """Return, for a body that slides on the carrier at `speed`: cen_c(Q) - cen(Q) + 2 omega_c x speed."""
    carrier: PointKinematics = point_motion(scene, c, Q)
    return add_scaled(
        sub(carrier.centripetal, point_motion(scene, body, Q).centripetal), 2.0, cross(carrier.omega, speed)
    )


def cam_tangent(scene: cython.pointer[Scene], row: cython.pointer[Closure]) -> RowTangent:
    """Return the change of a cam's row; its acceleration is that of the coordinates, x_b'' - L' phi'' - L'' phi'^2."""
    lift: PathPoint = cam_lift(scene, row)
    cam: CamStance = cam_stance(scene, row, lift.slope.x)
    contact: CamContact = find_cam_contact(row, cam)
    a: cython.pointer[FreedomTangent] = cython.address(scene.freedom_tangents[row.freedom])
    b: cython.pointer[FreedomTangent] = cython.address(scene.freedom_tangents[row.freedom_b])
    u: cython.double = scene.freedoms[row.freedom].u
    rate: cython.double = b.u - lift.slope.x * a.u - lift.bend.x * a.q * u
    bent: cython.double = lift.bend.x * (a.q * a.udot + 2.0 * u * a.u) + lift.twist.x * a.q * u * u
    d: CamStance = cam_stance_tangent(scene, row, cam, lift.bend.x * a.q)
    change_of_contact: CamContact = cam_contact_tangent(row, cam, contact, d)
    w: Vec3 = cam.w
    dw: Vec3 = d.w
    if row.swings:
        w = add_cross(w, cam.g, contact.offset)
        dw = add_cross(add_cross(dw, d.g, contact.offset), cam.g, change_of_contact.offset)
    work: cython.double = dot(contact.n, w)
    change: cython.double = dot(change_of_contact.n, w) + dot(contact.n, dw)
    f: Vec3 = scale_vector(
        divide_or_nan(1.0, work), add_scaled(change_of_contact.n, -divide_or_nan(change, work), contact.n)
    )
    Q: Vec3 = add(point_tangent(scene, row.b, row.q).x, change_of_contact.offset)
    return RowTangent(Q, f, Vec3(0.0, 0.0, 0.0), rate, -bent)


def cam_stance_tangent(
    scene: cython.pointer[Scene], row: cython.pointer[Closure], cam: CamStance, slope: cython.double
) -> CamStance:
    """Return the change of the cam's parts as its bodies move and its slope changes by `slope`."""
    C: Vec3 = point_tangent(scene, row.b, row.q).x
    g: Vec3 = vector_tangent(scene, row.c, cam.g)
    w: Vec3 = g
    if row.swings:
        arm: Vec3 = sub(world_place(scene, row.b, row.q), world_place(scene, row.c, row.pivot))
        w = add_cross(cross(g, arm), cam.g, sub(C, point_tangent(scene, row.c, row.pivot).x))
    h: Vec3 = vector_tangent(scene, row.b, cam.h)
    return CamStance(vector_tangent(scene, row.c, cam.e), g, sub(C, point_tangent(scene, row.c, row.p).x), w, h, slope)


def cam_contact_tangent(row: cython.pointer[Closure], cam: CamStance, contact: CamContact, d: CamStance) -> CamContact:
    """Return the change of the contact point and the load's direction."""
    if row.faced:
        return face_contact_tangent(row, cam, contact, d)
    velocity: Vec3 = sub(scale_vector(cam.slope, cam.w), cross(cam.e, cam.C))
    change: Vec3 = add_scaled(scale_vector(d.slope, cam.w), cam.slope, d.w)
    change = sub(change, add_cross(cross(d.e, cam.C), cam.e, d.C))
    n: Vec3 = add_cross(cross(d.e, velocity), cam.e, change)
    if row.radius == 0.0:
        return CamContact(contact.offset, n)
    size: cython.double = norm(contact.n)
    along: cython.double = divide_or_nan(dot(contact.n, n), size * size)
    return CamContact(scale_vector(-divide_or_nan(row.radius, size), add_scaled(n, -along, contact.n)), n)


def face_contact_tangent(row: cython.pointer[Closure], cam: CamStance, contact: CamContact, d: CamStance) -> CamContact:
    """Return the same for a flat face: the change of s k with k = e x h and s = top / bottom."""
    k: Vec3 = cross(cam.e, cam.h)
    dk: Vec3 = add_cross(cross(d.e, cam.h), cam.e, d.h)
    velocity: Vec3 = sub(scale_vector(cam.slope, cam.w), cross(cam.e, cam.C))
    change: Vec3 = add_scaled(scale_vector(d.slope, cam.w), cam.slope, d.w)
    change = sub(change, add_cross(cross(d.e, cam.C), cam.e, d.C))
    top: cython.double = dot(cam.h, velocity)
    dtop: cython.double = dot(d.h, velocity) + dot(cam.h, change)
    swept: Vec3 = cross(cam.e, k)
    dswept: Vec3 = add_cross(cross(d.e, k), cam.e, dk)
    if row.swings:
        w: Vec3 = cross(cam.g, k)
        swept = add_scaled(swept, -cam.slope, w)
        dswept = add_scaled(dswept, -d.slope, w)
        dswept = add_scaled(dswept, -cam.slope, add_cross(cross(d.g, k), cam.g, dk))
    bottom: cython.double = dot(cam.h, swept)
    dbottom: cython.double = dot(d.h, swept) + dot(cam.h, dswept)
    s: cython.double = divide_or_nan(top, bottom)
    ds: cython.double = divide_or_nan(dtop - s * dbottom, bottom)
    return CamContact(add_scaled(scale_vector(ds, k), s, dk), d.h)
