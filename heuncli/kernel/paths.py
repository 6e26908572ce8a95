"""Paths: where a point that runs along one is, and which way it goes on there.

    r(q) = c0 + c1 h + c2 h^2 + c3 h^3,  h = q - q_k        in the piece from q_k on; r', r'', r''' its derivatives
Beyond an open end there is none (NaN). Behind the pieces of a path stands one that says where the last of them ends.
The centre of a roller of radius R runs beside a path in a plane with normal N:

    p = r + R n,  n = N x r' / |r'|;   p' = (1 - k) r',  k = R a / b^(3/2),  a = N . r' x r'',  b = r' . r'
for n' = -a / b^(3/2) r'; what follows is exact, too, as the fourth derivative of a cubic is zero.
"""

from __future__ import annotations

try:
    import cython
except ImportError:
    from heuncli.kernel.shadow import cython

if not cython.compiled:
    from heuncli.kernel.algebra import Mat3, Vec3, add_scaled, cross, dot, norm, rotate, scaled
    from heuncli.kernel.libm import NAN, floor
    from heuncli.kernel.scene import Freedom, PathPiece, Scene
    from heuncli.kernel.shadow import cython
    from heuncli.kernel.values import PathPoint


def run_along(scene: cython.pointer[Scene], parent: cython.int, freedom: cython.pointer[Freedom]) -> Vec3:
    """Where the point of a path is, world axes; its direction, bend and their change go into the freedom."""
    here: PathPoint = path_point(scene, freedom.path, freedom.pieces, freedom.period, freedom.q)
    if freedom.radius > 0.0:
        here = beside(here, freedom.radius, freedom.normal)
    if parent < 0:
        freedom.s, freedom.curved, freedom.twisted = here.slope, here.bend, here.twist
        return here.r
    R: Mat3 = scene.bodies[parent].R
    freedom.s, freedom.curved = rotate(R, here.slope), rotate(R, here.bend)
    freedom.twisted = rotate(R, here.twist)
    return rotate(R, here.r)


def path_point(
    scene: cython.pointer[Scene], path: cython.int, count: cython.int, period: cython.double, q: cython.double
) -> PathPoint:
    """The point of the path of `count` pieces from `path` on, in its own axes."""
    first: cython.double = scene.pieces[path].begin
    if period > 0.0:
        q = q - period * floor((q - first) / period)
    elif not (q >= first and q <= scene.pieces[path + count].begin):
        q = NAN
    piece: cython.pointer[PathPiece] = cython.address(scene.pieces[path + piece_at(scene, path, count, q)])
    h: cython.double = q - piece.begin
    r: Vec3 = add_scaled(piece.c0, h, add_scaled(piece.c1, h, add_scaled(piece.c2, h, piece.c3)))
    slope: Vec3 = add_scaled(piece.c1, h, add_scaled(scaled(2.0, piece.c2), 3.0 * h, piece.c3))
    bend: Vec3 = add_scaled(scaled(2.0, piece.c2), 6.0 * h, piece.c3)
    return PathPoint(r, slope, bend, scaled(6.0, piece.c3))


def beside(at: PathPoint, R: cython.double, N: Vec3) -> PathPoint:
    """The centre of a roller of radius R that touches a path at a place, to the left of it seen from where N points."""
    v: cython.double = norm(at.slope)
    b: cython.double = v * v
    b1: cython.double = 2.0 * dot(at.slope, at.bend)
    b2: cython.double = 2.0 * (dot(at.bend, at.bend) + dot(at.slope, at.twist))
    a: cython.double = dot(N, cross(at.slope, at.bend))
    a1: cython.double = dot(N, cross(at.slope, at.twist))
    a2: cython.double = dot(N, cross(at.bend, at.twist))
    c: cython.double = R / (b * v)
    along: cython.double = 1.0 - c * a
    along1: cython.double = -c * (a1 - 1.5 * a * b1 / b)
    along2: cython.double = -c * (a2 - 3.0 * a1 * b1 / b - 1.5 * a * b2 / b + 3.75 * a * b1 * b1 / (b * b))
    return PathPoint(
        add_scaled(at.r, R / v, cross(N, at.slope)),
        scaled(along, at.slope),
        add_scaled(scaled(along, at.bend), along1, at.slope),
        add_scaled(add_scaled(scaled(along, at.twist), 2.0 * along1, at.bend), along2, at.slope),
    )


def piece_at(scene: cython.pointer[Scene], path: cython.int, count: cython.int, q: cython.double) -> cython.int:
    """Number of the piece that holds q, by bisection; a knot belongs to the piece that begins there."""
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
