"""Loads and accelerations of a scene in sixty decimals: what the doubles in its spec mean, whatever the condition.

    M a − Jᵀ λ = f − σ × I σ,  J a = −γ,    and of the rates  J V = 0 with the held ones as given

Bodies as drawn (axes of the world, origin in its origin), at rest or turning about z; as many independent rows as the
joints have, so that what is solved has one answer. Elimination by `decimal`: sixty digits outlast any condition that
sixteen digits can write down.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from decimal import Context, Decimal, localcontext
from typing import Any, NamedTuple

DIGITS = 60
SAME = Decimal("1e-40")  # of the largest pivot: less is nought, and the scene has no one answer
ZERO, ONE = Decimal(0), Decimal(1)

Vector = tuple[Decimal, ...]
Rows = list[list[Decimal]]


class Exact(NamedTuple):
    """What joints exert on `to`, force and moment about the `to` point; accelerations of centres, and angular ones."""

    force: dict[str, Vector]
    moment: dict[str, Vector]
    center: dict[str, Vector]
    angular: dict[str, Vector]


class Row(NamedTuple):
    """A condition of a joint: `to` shifts along n at its point, or turns about n, as `from` does."""

    joint: str
    ends: tuple[str, str]
    point: Vector
    n: Vector
    turns: bool
    square: tuple[Vector, Vector] | None = None  # of a rod: the arm between its points, over its length


class NotOne(Exception):
    """The joints hold something twice, or a mass is missing: there is no one answer."""


def vector(x: Iterable[Any]) -> Vector:
    return tuple(Decimal(float(c)) for c in x)


def plus(a: Vector, b: Vector) -> Vector:
    return tuple(x + y for x, y in zip(a, b, strict=True))


def minus(a: Vector, b: Vector) -> Vector:
    return tuple(x - y for x, y in zip(a, b, strict=True))


def times(s: Decimal, a: Vector) -> Vector:
    return tuple(s * x for x in a)


def dot(a: Sequence[Decimal], b: Sequence[Decimal]) -> Decimal:
    return sum((x * y for x, y in zip(a, b, strict=True)), ZERO)


def cross(a: Vector, b: Vector) -> Vector:
    return (a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0])


def unit(a: Vector) -> Vector:
    length = dot(a, a).sqrt()
    return tuple(x / length for x in a)


AXES: tuple[Vector, ...] = ((ONE, ZERO, ZERO), (ZERO, ONE, ZERO), (ZERO, ZERO, ONE))
NOWHERE: Vector = (ZERO, ZERO, ZERO)


def across(n: Vector) -> tuple[Vector, Vector]:
    """Two unit vectors that make a right angle with n and each other."""
    least = min(AXES, key=lambda e: abs(dot(e, n)))
    e = unit(cross(n, least))
    return e, cross(n, e)


def solution(scene: Mapping[str, Any], rates: Mapping[str, float] | None = None) -> Exact:
    """The one answer; rates: angular velocities about z of some bodies, from which those of all others follow."""
    with localcontext(Context(prec=DIGITS)):
        return _solution(scene, rates or {})


def _solution(scene: Mapping[str, Any], given: Mapping[str, float]) -> Exact:
    names = list(scene["bodies"])
    planar = scene.get("space") == "planar"
    free = (0, 1, 5) if planar else tuple(range(6))
    centers = {n: vector(scene["bodies"][n].get("center", (0, 0, 0))) for n in names}
    rows = [row for name in scene["joints"] for row in rows_of(scene, name, planar)]
    J = [part(row, names, centers, free) for row in rows]
    V = velocities(names, centers, rows, J, free, given)
    M = [[ZERO] * len(names) * len(free) for _ in range(len(names) * len(free))]
    f: list[Decimal] = []
    for k, name in enumerate(names):
        place(M, k, len(free), inertia(scene["bodies"][name]), free)
        f += loads(scene, name, centers[name], free)
    K = [[*m, *(-j[i] for j in J)] for i, m in enumerate(M)] + [[*j, *([ZERO] * len(J))] for j in J]
    x = solved(K, [*f, *(-gamma(row, centers, V) for row in rows)])
    return answers(scene, names, free, rows, x)


def rows_of(scene: Mapping[str, Any], name: str, planar: bool) -> list[Row]:
    """What a joint holds, as drawn."""
    spec = scene["joints"][name]
    ends = tuple(spec[e].split(".")[0] for e in ("from", "to"))
    p, q = (point(scene, spec[e]) for e in ("from", "to"))
    kind = spec["type"]
    in_space = AXES[:2] if planar else AXES
    if kind == "rod":
        arm = minus(q, p)
        L = dot(arm, arm).sqrt()
        return [Row(name, ends, q, unit(arm), False, (p, times(ONE / L, (ONE, ONE, ONE))))]
    if kind == "plane":
        return [Row(name, ends, q, unit(vector(spec["normal"])), False)]
    if kind == "line":
        return [Row(name, ends, q, e, False) for e in across(unit(vector(spec["axis"])))]
    assert kind in ("ball", "pin"), kind
    held = [Row(name, ends, q, e, False) for e in in_space]
    if kind == "pin" and not planar:
        held += [Row(name, ends, q, e, True) for e in across(unit(vector(spec["axis"])))]
    return held


def point(scene: Mapping[str, Any], end: str) -> Vector:
    owner, name = end.split(".")
    points = scene["ground"]["points"] if owner == "ground" else scene["bodies"][owner]["points"]
    return vector(points[name])


def part(row: Row, names: list[str], centers: Mapping[str, Vector], free: Sequence[int]) -> list[Decimal]:
    """A row of J on the velocities of the centres and the angular ones of all bodies."""
    found = [ZERO] * (len(names) * len(free))
    for end, sign in zip(row.ends, (-ONE, ONE), strict=True):
        if end == "ground":
            continue
        k = names.index(end)
        own = (*NOWHERE, *row.n) if row.turns else (*row.n, *cross(minus(row.point, centers[end]), row.n))
        for i, c in enumerate(free):
            found[k * len(free) + i] += sign * own[c]
    return found


def velocities(
    names: list[str], centers: Mapping[str, Vector], rows: list[Row], J: Rows, free: Sequence[int],
    given: Mapping[str, float],
) -> dict[str, tuple[Vector, Vector]]:  # fmt: skip
    """Those of centres and angular ones, from the rates given about z: as many as there are freedoms."""
    n = len(free)
    if not given:
        return dict.fromkeys(names, (NOWHERE, NOWHERE))
    held = []
    for name in given:
        row = [ZERO] * (len(names) * n)
        row[names.index(name) * n + list(free).index(5)] = ONE
        held.append(row)
    x = solved([*J, *held], [ZERO] * len(J) + [Decimal(float(v)) for v in given.values()])
    found = {}
    for k, name in enumerate(names):
        full = dict(zip(free, x[k * n : (k + 1) * n], strict=True))
        found[name] = (tuple(full.get(c, ZERO) for c in range(3)), tuple(full.get(c, ZERO) for c in range(3, 6)))
    return found


def gamma(row: Row, centers: Mapping[str, Vector], V: Mapping[str, tuple[Vector, Vector]]) -> Decimal:
    """What of a row's acceleration the velocities make: of balls and parallel pins, and of rods."""
    if row.turns:
        return ZERO

    def moved(end: str, p: Vector) -> tuple[Vector, Vector]:
        if end == "ground":
            return NOWHERE, NOWHERE
        v, spin = V[end]
        arm = minus(p, centers[end])
        return plus(v, cross(spin, arm)), cross(spin, cross(spin, arm))

    far = row.square[0] if row.square else row.point
    (va, aa), (vb, ab) = moved(row.ends[0], far), moved(row.ends[1], row.point)
    found = dot(row.n, minus(ab, aa))
    if row.square:
        v = minus(vb, va)
        along = dot(row.n, v)
        found += (dot(v, v) - along * along) * row.square[1][0]
    return found


def inertia(body: Mapping[str, Any]) -> Rows:
    """Mass and moments about the centre, (6, 6); of thin rods as shapes, from end to end."""
    m = Decimal(float(body["mass"]))
    given = body["inertia"]
    moments = [given] * 3 if isinstance(given, float) else given
    D = [[ZERO] * 6 for _ in range(6)]
    for i in range(3):
        D[i][i], D[i + 3][i + 3] = m, Decimal(float(moments[i]))
    return D


def place(M: Rows, k: int, n: int, D: Rows, free: Sequence[int]) -> None:
    for i, r in enumerate(free):
        for j, c in enumerate(free):
            M[k * n + i][k * n + j] = D[r][c]


def loads(scene: Mapping[str, Any], name: str, center: Vector, free: Sequence[int]) -> list[Decimal]:
    """Weight, forces and couples on a body, about its centre. A turn about a principal axis leaves no σ × I σ."""
    m = Decimal(float(scene["bodies"][name]["mass"]))
    F = times(m, vector(scene.get("gravity", (0, 0, 0))))
    N = NOWHERE
    for load in scene.get("forces", {}).values():
        on, *at = load["on"].split(".")
        if on != name:
            continue
        k = vector(load["vector"])
        if load["type"] == "couple":
            N = plus(N, k)
        else:
            F = plus(F, k)
            N = plus(N, cross(minus(vector(scene["bodies"][on]["points"][at[0]]), center), k))
    return [(*F, *N)[c] for c in free]


def solved(A: Rows, b: list[Decimal]) -> list[Decimal]:
    """A x = b by elimination with rows of unit size; A may have rows to spare, which then must agree."""
    n = len(A[0])
    rows = []
    for row, right in zip(A, b, strict=True):
        size = max(abs(x) for x in row)
        if size == ZERO:
            raise NotOne
        rows.append([*(x / size for x in row), right / size])
    if len(rows) != n:
        raise NotOne
    largest = ZERO
    for k in range(n):
        best = max(range(k, n), key=lambda i: abs(rows[i][k]))
        rows[k], rows[best] = rows[best], rows[k]
        pivot = rows[k]
        largest = max(largest, abs(pivot[k]))
        if abs(pivot[k]) <= SAME * largest:
            raise NotOne
        for i in range(k + 1, n):
            if rows[i][k]:
                factor = rows[i][k] / pivot[k]
                rows[i] = [
                    *rows[i][:k],
                    ZERO,
                    *(x - factor * y for x, y in zip(rows[i][k + 1 :], pivot[k + 1 :], strict=True)),
                ]
    x = [ZERO] * n
    for k in reversed(range(n)):
        x[k] = (rows[k][n] - dot(rows[k][k + 1 : n], x[k + 1 :])) / rows[k][k]
    return x


def answers(
    scene: Mapping[str, Any], names: list[str], free: Sequence[int], rows: list[Row], x: list[Decimal]
) -> Exact:
    """Multipliers as forces and moments on `to`, about its point."""
    n = len(free)
    force = dict.fromkeys(scene["joints"], NOWHERE)
    moment = dict.fromkeys(scene["joints"], NOWHERE)
    for row, value in zip(rows, x[n * len(names) :], strict=True):
        of = moment if row.turns else force
        of[row.joint] = plus(of[row.joint], times(value, row.n))
    center, angular = {}, {}
    for k, name in enumerate(names):
        full = dict(zip(free, x[k * n : (k + 1) * n], strict=True))
        center[name] = tuple(full.get(c, ZERO) for c in range(3))
        angular[name] = tuple(full.get(c, ZERO) for c in range(3, 6))
    return Exact(force, moment, center, angular)
