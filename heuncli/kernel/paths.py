"""Paths: the place of a point that moves along one, and the derivatives there.

    r(q) = c0 + c1 h + c2 h^2 + c3 h^3,  h = q - q_k        in the piece from q_k on; r', r'', r''' its derivatives

Outside an open path there is no place (NaN). After the pieces of a path comes one that says where the last of them
ends. The centre of a roller of radius R moves at a distance from a path in a plane with normal N:

    p = r + R n,  n = N x r' / |r'|;   p' = (1 - k) r',  k = R a / b^(3/2),  a = N . r' x r'',  b = r' . r'

for n' = -a / b^(3/2) r'; the higher derivatives are exact too, as the fourth derivative of a cubic is zero.

A piece of a cam's lift in segments is the sum of a polynomial of degree 7 and a sine:

    L = A + h^4 B + S sin(w h + p)      A is the x of r, B its y; S, w and p are the z of c0, c1 and c2
"""

from __future__ import annotations

from math import fabs

from heuncli.kernel.declarations import *
from heuncli.kernel.libm import NAN, cos, floor, sin


def place_on_path(scene: cython.pointer[Scene], parent: cython.int, freedom: cython.pointer[Freedom]) -> Vec3:
    """Return the place of a path's point in world axes; store its slope, bend and twist in the freedom."""
    point: PathPoint = evaluate_path(scene, freedom.path, freedom.pieces, freedom.period, freedom.q)
    if freedom.radius > 0.0:
        point = offset_path(point, freedom.radius, freedom.normal)
    if parent < 0:
        freedom.s, freedom.curved, freedom.twisted = point.slope, point.bend, point.twist
        return point.r
    R: Mat3 = scene.bodies[parent].R
    freedom.s, freedom.curved = rotate(R, point.slope), rotate(R, point.bend)
    freedom.twisted = rotate(R, point.twist)
    return rotate(R, point.r)


def evaluate_path(
    scene: cython.pointer[Scene], path: cython.int, count: cython.int, period: cython.double, q: cython.double
) -> PathPoint:
    """Return the point of the path of `count` pieces from `path` on, in its own axes."""
    first: cython.double = scene.pieces[path].begin
    if period > 0.0:
        q = q - period * floor((q - first) / period)
    elif not (q >= first and q <= scene.pieces[path + count].begin):
        q = NAN
    piece: cython.pointer[PathPiece] = cython.address(scene.pieces[path + find_path_piece(scene, path, count, q)])
    return evaluate_path_piece(piece, q - piece.begin)


def evaluate_path_piece(piece: cython.pointer[PathPiece], h: cython.double) -> PathPoint:
    """Return the point of a piece at the distance h from its begin."""
    r: Vec3 = add_scaled(piece.c0, h, add_scaled(piece.c1, h, add_scaled(piece.c2, h, piece.c3)))
    slope: Vec3 = add_scaled(piece.c1, h, add_scaled(scale_vector(2.0, piece.c2), 3.0 * h, piece.c3))
    bend: Vec3 = add_scaled(scale_vector(2.0, piece.c2), 6.0 * h, piece.c3)
    return PathPoint(r, slope, bend, scale_vector(6.0, piece.c3))


def evaluate_lift(scene: cython.pointer[Scene], row: cython.pointer[Closure]) -> PathPoint:
    """Return a lift in segments and its three derivatives, in the first components.

    While branches are held, the held piece continues past its ends, so that a step does not see the next one.
    """
    number: cython.double = find_lift_piece(scene, row)
    if scene.programs.holding == HELD:
        number = scene.programs.branches[row.piece_branch - 1]
    turns: cython.double = floor(number / row.pieces) if row.period > 0.0 else 0.0
    number = number - turns * row.pieces
    k: cython.int = int(number) if number >= 0.0 and number < row.pieces else -1
    if k < 0:
        return combine_lift(cython.address(scene.pieces[row.lift]), NAN)
    piece: cython.pointer[PathPiece] = cython.address(scene.pieces[row.lift + k])
    return combine_lift(piece, scene.freedoms[row.freedom].q - row.period * turns - piece.begin)


def find_lift_piece(scene: cython.pointer[Scene], row: cython.pointer[Closure]) -> cython.double:
    """Return the number of the piece in which the disc is, counted on over the turns; -1 outside an open lift.

    At the end of a piece, up to the rounding of its instant, it is the one into which the disc turns.
    """
    q: cython.double = scene.freedoms[row.freedom].q
    u: cython.double = scene.freedoms[row.freedom].u
    first: cython.double = scene.pieces[row.lift].begin
    last: cython.double = scene.pieces[row.lift + row.pieces].begin
    rounding: cython.double = fabs(q) + fabs(u * scene.programs.variables[0]) + last - first
    rounding = 4.0 * scene.limits.one_instant * rounding
    if row.period == 0.0 and not (q >= first and q <= last):
        return -1.0
    q = q + rounding if u > 0.0 else q - rounding if u < 0.0 else q
    turns: cython.double = floor((q - first) / row.period) if row.period > 0.0 else 0.0
    return turns * row.pieces + find_path_piece(scene, row.lift, row.pieces, q - row.period * turns)


def hold_lift_pieces(scene: cython.pointer[Scene]) -> cython.void:
    """Hold the pieces of the lifts in segments in which their discs are."""
    i: cython.int
    for i in range(scene.part_count):
        if scene.parts[i].piece_branch:
            scene.programs.branches[scene.parts[i].piece_branch - 1] = find_lift_piece(
                scene, cython.address(scene.parts[i])
            )


def combine_lift(piece: cython.pointer[PathPiece], h: cython.double) -> PathPoint:
    """Combine A + h^4 B + S sin(w h + p), and its derivatives, at the distance h from the begin of a piece."""
    a: PathPoint = evaluate_path_piece(piece, h)
    h2: cython.double = h * h
    h3: cython.double = h2 * h
    h4: cython.double = h2 * h2
    w: cython.double = piece.c1.z
    sine: cython.double = piece.c0.z * sin(w * h + piece.c2.z)
    cosine: cython.double = w * piece.c0.z * cos(w * h + piece.c2.z)
    lift: cython.double = a.r.x + h4 * a.r.y + sine
    slope: cython.double = a.slope.x + 4.0 * h3 * a.r.y + h4 * a.slope.y + cosine
    bend: cython.double = a.bend.x + 12.0 * h2 * a.r.y + 8.0 * h3 * a.slope.y + h4 * a.bend.y - w * w * sine
    twist: cython.double = a.twist.x + 24.0 * h * a.r.y + 36.0 * h2 * a.slope.y + 12.0 * h3 * a.bend.y
    twist = twist + h4 * a.twist.y - w * w * cosine
    return PathPoint(Vec3(lift, 0.0, 0.0), Vec3(slope, 0.0, 0.0), Vec3(bend, 0.0, 0.0), Vec3(twist, 0.0, 0.0))


def offset_path(point: PathPoint, R: cython.double, N: Vec3) -> PathPoint:
    """Return the centre of a roller of radius R that touches a path at a point, to the left of it seen from where N
    points.
    """
    v: cython.double = norm(point.slope)
    b: cython.double = v * v
    b1: cython.double = 2.0 * dot(point.slope, point.bend)
    b2: cython.double = 2.0 * (dot(point.bend, point.bend) + dot(point.slope, point.twist))
    a: cython.double = dot(N, cross(point.slope, point.bend))
    a1: cython.double = dot(N, cross(point.slope, point.twist))
    a2: cython.double = dot(N, cross(point.bend, point.twist))
    c: cython.double = R / (b * v)
    factor: cython.double = 1.0 - c * a
    factor_rate: cython.double = -c * (a1 - 1.5 * a * b1 / b)
    factor_second: cython.double = -c * (a2 - 3.0 * a1 * b1 / b - 1.5 * a * b2 / b + 3.75 * a * b1 * b1 / (b * b))
    return PathPoint(
        add_scaled(point.r, R / v, cross(N, point.slope)),
        scale_vector(factor, point.slope),
        add_scaled(scale_vector(factor, point.bend), factor_rate, point.slope),
        add_scaled(
            add_scaled(scale_vector(factor, point.twist), 2.0 * factor_rate, point.bend), factor_second, point.slope
        ),
    )


def find_path_piece(scene: cython.pointer[Scene], path: cython.int, count: cython.int, q: cython.double) -> cython.int:
    """Return the number of the piece that contains q, by bisection; a knot belongs to the piece that begins there."""
    low: cython.int = 0
    high: cython.int = count
    middle: cython.int
    while high - low > 1:
        middle = (low + high) >> 1
        if scene.pieces[path + middle].begin <= q:
            low = middle
        else:
            high = middle
    return low
