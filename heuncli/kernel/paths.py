"""Paths: the place of a point that moves along one, and the derivatives there.

    r(q) = c0 + c1 h + c2 h^2 + c3 h^3,  h = q - q_k        in the piece from q_k on; r', r'', r''' its derivatives

Outside an open path there is no place (NaN). After the pieces of a path comes one that says where the last of them
ends. The centre of a roller of radius R moves at a distance from a path in a plane with normal N:

    p = r + R n,  n = N x r' / |r'|;   p' = (1 - k) r',  k = R a / b^(3/2),  a = N . r' x r'',  b = r' . r'

for n' = -a / b^(3/2) r'; the higher derivatives are exact too, as the fourth derivative of a cubic is zero.
"""

from __future__ import annotations

from heuncli.kernel.declarations import *
from heuncli.kernel.libm import NAN, floor


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
    h: cython.double = q - piece.begin
    r: Vec3 = add_scaled(piece.c0, h, add_scaled(piece.c1, h, add_scaled(piece.c2, h, piece.c3)))
    slope: Vec3 = add_scaled(piece.c1, h, add_scaled(scale_vector(2.0, piece.c2), 3.0 * h, piece.c3))
    bend: Vec3 = add_scaled(scale_vector(2.0, piece.c2), 6.0 * h, piece.c3)
    return PathPoint(r, slope, bend, scale_vector(6.0, piece.c3))


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
