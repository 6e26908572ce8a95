"""A cam: a disc a that turns on a carrier c and moves a follower b, which slides or turns on it too.

    x_b = L(phi)                    gap, L the lift over the disc's angle
    f . w_b = 1,  f . w_a = L'      f the load at the place Q of contact, w_b and w_a how fast the follower and the disc
                                    pass there by a unit of their rates, against the carrier
So f does on both what the gap does: it stands across L' w_b - w_a, in which the follower's point passes the disc. Of a
roller or a point that is the normal of the path of its centre in the disc; of a flat face f is along the face's normal,
and Q where the face has no speed along it against the disc, a distance L' beside the axis where the follower slides.
All of it lies across the disc's axis, in the plane through the follower's point. e x (L' w - e x C), C the follower's
point from the disc's axis, points out of the disc wherever that point runs, for its path goes round the axis once.
Where the flank has no place or no normal, or the follower is not moved by what stands across it, there is none (NaN).
"""

from __future__ import annotations

try:
    import cython
except ImportError:
    from heuncli.kernel.shadow import cython

if not cython.compiled:
    from heuncli.kernel.algebra import Vec3, add, add_cross, add_scaled, cross, dot, norm, scaled, sub
    from heuncli.kernel.carried_points import carried, place_of
    from heuncli.kernel.directions import direction_of
    from heuncli.kernel.libm import NAN
    from heuncli.kernel.paths import path_point
    from heuncli.kernel.scene import Closure, FreedomTangent, Scene
    from heuncli.kernel.shadow import cython
    from heuncli.kernel.tangent_motion import point_along, swung
    from heuncli.kernel.values import CamContact, CamStance, Carried, PathPoint, RowTangent


def lift_of(scene: cython.pointer[Scene], row: cython.pointer[Closure]) -> PathPoint:
    """The lift, L, L', L'' and L''' in the first components."""
    return path_point(scene, row.lift, row.pieces, row.period, scene.freedoms[row.freedom].q)


def cam_of(scene: cython.pointer[Scene], row: cython.pointer[Closure], slope: cython.double) -> CamStance:
    """Where the parts of a cam are: O and e the disc's axis, C the follower's point, P and g its axis or guide."""
    O: Vec3 = place_of(scene, row.c, row.p)
    C: Vec3 = place_of(scene, row.b, row.q)
    e: Vec3 = direction_of(scene, row.c, row.e)
    g: Vec3 = direction_of(scene, row.c, row.g)
    w: Vec3 = cross(g, sub(C, place_of(scene, row.c, row.pivot))) if row.swings else g
    h: Vec3 = direction_of(scene, row.b, row.h)
    return CamStance(e, g, sub(C, O), w, h, slope)


def divide_or_nan(a: cython.double, b: cython.double) -> cython.double:
    """a / b."""
    return a / b if b != 0.0 else NAN


def contact_of(row: cython.pointer[Closure], cam: CamStance) -> CamContact:
    """The place of contact from the follower's point on, and the load there, before it is divided by f . w_b."""
    zero: Vec3 = Vec3(0.0, 0.0, 0.0)
    n: Vec3
    if row.faced:
        k: Vec3 = cross(cam.e, cam.h)
        swept: Vec3 = cross(cam.e, k)
        if row.swings:
            swept = add_scaled(swept, -cam.slope, cross(cam.g, k))
        top: cython.double = cam.slope * dot(cam.h, cam.w) - dot(cam.h, cross(cam.e, cam.C))
        return CamContact(scaled(divide_or_nan(top, dot(cam.h, swept)), k), cam.h)
    n = cross(cam.e, sub(scaled(cam.slope, cam.w), cross(cam.e, cam.C)))
    if row.radius == 0.0:
        return CamContact(zero, n)
    return CamContact(scaled(-divide_or_nan(row.radius, norm(n)), n), n)


def cam_part(scene: cython.pointer[Scene], row: cython.pointer[Closure]) -> cython.void:
    """gamma = -L'' phidot^2 - f . (h_b - h_a), h what of the acceleration at Q against the carrier velocities make."""
    lift: PathPoint = lift_of(scene, row)
    cam: CamStance = cam_of(scene, row, lift.slope.x)
    there: CamContact = contact_of(row, cam)
    u: cython.double = scene.freedoms[row.freedom].u
    u_b: cython.double = scene.freedoms[row.freedom_b].u
    w: Vec3 = add_cross(cam.w, cam.g, there.beside) if row.swings else cam.w
    row.Q = add(place_of(scene, row.b, row.q), there.beside)
    row.f = scaled(divide_or_nan(1.0, dot(there.n, w)), there.n)
    row.m = Vec3(0.0, 0.0, 0.0)
    row.gap = scene.freedoms[row.freedom_b].q - lift.r.x - row.length
    row.rate = u_b - lift.slope.x * u
    apart: Vec3 = turning(scene, row.a, row.c, place_of(scene, row.c, row.p), scaled(u, cam.e), row.Q)
    own: Vec3 = sliding(scene, row.b, row.c, scaled(u_b, cam.g), row.Q)
    if row.swings:
        own = turning(scene, row.b, row.c, place_of(scene, row.c, row.pivot), scaled(u_b, cam.g), row.Q)
    row.gamma = -lift.bend.x * u * u - dot(row.f, sub(own, apart))


def turning(scene: cython.pointer[Scene], body: cython.int, c: cython.int, pivot: Vec3, spin: Vec3, Q: Vec3) -> Vec3:
    """Of a body that turns on the carrier by `spin`: cen_c(P) - cen(P) + (omega_c x spin) x (Q - P)."""
    on: Carried = carried(scene, c, pivot)
    found: Vec3 = sub(on.centripetal, carried(scene, body, pivot).centripetal)
    return add_cross(found, cross(on.omega, spin), sub(Q, pivot))


def sliding(scene: cython.pointer[Scene], body: cython.int, c: cython.int, speed: Vec3, Q: Vec3) -> Vec3:
    """Of a body that slides on the carrier by `speed`: cen_c(Q) - cen(Q) + 2 omega_c x speed."""
    on: Carried = carried(scene, c, Q)
    return add_scaled(sub(on.centripetal, carried(scene, body, Q).centripetal), 2.0, cross(on.omega, speed))


def cam_along(scene: cython.pointer[Scene], row: cython.pointer[Closure]) -> RowTangent:
    """What a cam's row changes by: its acceleration is that of the coordinates, x_b'' - L' phi'' - L'' phi'^2."""
    lift: PathPoint = lift_of(scene, row)
    cam: CamStance = cam_of(scene, row, lift.slope.x)
    there: CamContact = contact_of(row, cam)
    a: cython.pointer[FreedomTangent] = cython.address(scene.freedom_tangents[row.freedom])
    b: cython.pointer[FreedomTangent] = cython.address(scene.freedom_tangents[row.freedom_b])
    u: cython.double = scene.freedoms[row.freedom].u
    rate: cython.double = b.u - lift.slope.x * a.u - lift.bend.x * a.q * u
    bent: cython.double = lift.bend.x * (a.q * a.udot + 2.0 * u * a.u) + lift.twist.x * a.q * u * u
    d: CamStance = cam_moved(scene, row, cam, lift.bend.x * a.q)
    turned: CamContact = contact_along(row, cam, there, d)
    w: Vec3 = cam.w
    dw: Vec3 = d.w
    if row.swings:
        w = add_cross(w, cam.g, there.beside)
        dw = add_cross(add_cross(dw, d.g, there.beside), cam.g, turned.beside)
    work: cython.double = dot(there.n, w)
    change: cython.double = dot(turned.n, w) + dot(there.n, dw)
    f: Vec3 = scaled(divide_or_nan(1.0, work), add_scaled(turned.n, -divide_or_nan(change, work), there.n))
    Q: Vec3 = add(point_along(scene, row.b, row.q).x, turned.beside)
    return RowTangent(Q, f, Vec3(0.0, 0.0, 0.0), rate, -bent)


def cam_moved(
    scene: cython.pointer[Scene], row: cython.pointer[Closure], cam: CamStance, slope: cython.double
) -> CamStance:
    """What of a cam changes by as its bodies move, and its slope by `slope`."""
    C: Vec3 = point_along(scene, row.b, row.q).x
    g: Vec3 = swung(scene, row.c, cam.g)
    w: Vec3 = g
    if row.swings:
        arm: Vec3 = sub(place_of(scene, row.b, row.q), place_of(scene, row.c, row.pivot))
        w = add_cross(cross(g, arm), cam.g, sub(C, point_along(scene, row.c, row.pivot).x))
    h: Vec3 = swung(scene, row.b, cam.h)
    return CamStance(swung(scene, row.c, cam.e), g, sub(C, point_along(scene, row.c, row.p).x), w, h, slope)


def contact_along(row: cython.pointer[Closure], cam: CamStance, there: CamContact, d: CamStance) -> CamContact:
    """What place and normal change by."""
    if row.faced:
        return face_along(row, cam, there, d)
    passing: Vec3 = sub(scaled(cam.slope, cam.w), cross(cam.e, cam.C))
    change: Vec3 = add_scaled(scaled(d.slope, cam.w), cam.slope, d.w)
    change = sub(change, add_cross(cross(d.e, cam.C), cam.e, d.C))
    n: Vec3 = add_cross(cross(d.e, passing), cam.e, change)
    if row.radius == 0.0:
        return CamContact(there.beside, n)
    size: cython.double = norm(there.n)
    along: cython.double = divide_or_nan(dot(there.n, n), size * size)
    return CamContact(scaled(-divide_or_nan(row.radius, size), add_scaled(n, -along, there.n)), n)


def face_along(row: cython.pointer[Closure], cam: CamStance, there: CamContact, d: CamStance) -> CamContact:
    """The same of a flat face: of s k, k = e x h, s = top / bottom."""
    k: Vec3 = cross(cam.e, cam.h)
    dk: Vec3 = add_cross(cross(d.e, cam.h), cam.e, d.h)
    passing: Vec3 = sub(scaled(cam.slope, cam.w), cross(cam.e, cam.C))
    change: Vec3 = add_scaled(scaled(d.slope, cam.w), cam.slope, d.w)
    change = sub(change, add_cross(cross(d.e, cam.C), cam.e, d.C))
    top: cython.double = dot(cam.h, passing)
    dtop: cython.double = dot(d.h, passing) + dot(cam.h, change)
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
    return CamContact(add_scaled(scaled(ds, k), s, dk), d.h)
