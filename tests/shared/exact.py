"""Loads and accelerations of a scene in sixty decimals: what the doubles in its spec mean, whatever the condition.

    M a − Jᵀ λ = f − σ × I σ,  J a = −γ,    and of the rates  J V = 0 with the held ones as given

Bodies as drawn (axes of the world, origin in its origin), at rest or turning about z. Elimination by `decimal`: sixty
digits outlast any condition that sixteen digits can write down.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from decimal import Context, Decimal, localcontext
from typing import Any, NamedTuple

DIGITS = 60
SAME = Decimal("1e-40")  # of the largest pivot, or of a null vector: less is nought
CONTRADICTS = Decimal("1e-30")  # of unit rows: what is left on the right of rows that say nothing new
ZERO, ONE = Decimal(0), Decimal(1)

Vector = tuple[Decimal, ...]
Rows = list[list[Decimal]]


class Exact(NamedTuple):
    """What joints exert on `to`, force and moment about the `to` point; accelerations of centres, and angular ones.

    nan: open.
    """

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
    rod: tuple[Vector, Decimal] | None = None  # its `from` point and its length


class NoAnswer(Exception):
    """The rates given do not fit the joints."""


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
        return [Row(name, ends, q, unit(arm), False, (p, L))]
    if kind == "plane":
        return [Row(name, ends, q, unit(vector(spec["normal"])), False)]
    if kind == "line":
        return [Row(name, ends, q, e, False) for e in across(unit(vector(spec["axis"])))]
    if kind == "slide":
        u, v = across(unit(vector(spec["axis"])))
        if planar:
            u, v = cross(AXES[2], unit(vector(spec["axis"]))), AXES[2]
            return [Row(name, ends, q, u, False), Row(name, ends, q, v, True)]
        return [Row(name, ends, q, e, turns) for e, turns in ((u, False), (v, False), *((e, True) for e in AXES))]
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
    x, null = solved([*J, *held], [ZERO] * len(J) + [Decimal(float(v)) for v in given.values()])
    assert not null, "rates that are not all given"
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

    far = row.rod[0] if row.rod else row.point
    (va, aa), (vb, ab) = moved(row.ends[0], far), moved(row.ends[1], row.point)
    found = dot(row.n, minus(ab, aa))
    if row.rod:
        v = minus(vb, va)
        found += (dot(v, v) - dot(row.n, v) ** 2) / row.rod[1]
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


class Answer(NamedTuple):
    """x, and the vectors that may be added to it at will."""

    x: list[Decimal]
    null: Rows


def solved(A: Rows, b: list[Decimal]) -> Answer:
    """A x = b by elimination with complete pivoting, rows of unit size; refuses what has no answer."""
    n = len(A[0])
    rows = []
    for row, right in zip(A, b, strict=True):
        size = max(abs(x) for x in row)
        rows.append([*(x / size for x in row), right / size])
    order, rank, first = list(range(n)), 0, ZERO
    for k in range(min(n, len(rows))):
        best = max(
            ((i, j) for i in range(k, len(rows)) for j in range(k, n)), key=lambda p: abs(rows[p[0]][order[p[1]]])
        )
        rows[k], rows[best[0]] = rows[best[0]], rows[k]
        order[k], order[best[1]] = order[best[1]], order[k]
        pivot, c = rows[k], order[k]
        first = max(first, abs(pivot[c]))
        if abs(pivot[c]) <= SAME * first:
            break
        rank += 1
        rows[k] = pivot = [x / pivot[c] for x in pivot]
        for i, row in enumerate(rows):
            if i != k and row[c]:
                factor = row[c]
                rows[i] = [x - factor * y for x, y in zip(row, pivot, strict=True)]
    if any(abs(row[n]) > CONTRADICTS for row in rows[rank:]):
        raise NoAnswer
    x = [ZERO] * n
    for k, c in enumerate(order[:rank]):
        x[c] = rows[k][n]
    null = []
    for free in order[rank:]:
        v = [ZERO] * n
        v[free] = ONE
        for k, c in enumerate(order[:rank]):
            v[c] = -rows[k][free]
        null.append(v)
    return Answer(x, null)


def answers(scene: Mapping[str, Any], names: list[str], free: Sequence[int], rows: list[Row], found: Answer) -> Exact:
    """Multipliers as forces and moments on `to`, about its point; nan where a null vector has a share."""
    n = len(free)
    wrenches = [wrenches_of(scene, rows, x[n * len(names) :]) for x in (found.x, *found.null)]
    for own, *shares in zip(*(w.values() for w in wrenches), strict=True):
        for part in range(2):
            for c in range(3):
                if any(abs(share[part][c]) > SAME for share in shares):
                    own[part][c] = Decimal("nan")
    force = {name: tuple(w[0]) for name, w in wrenches[0].items()}
    moment = {name: tuple(w[1]) for name, w in wrenches[0].items()}
    center, angular = {}, {}
    for k, name in enumerate(names):
        full = dict(zip(free, found.x[k * n : (k + 1) * n], strict=True))
        center[name] = tuple(full.get(c, ZERO) for c in range(3))
        angular[name] = tuple(full.get(c, ZERO) for c in range(3, 6))
    return Exact(force, moment, center, angular)


def wrenches_of(scene: Mapping[str, Any], rows: list[Row], values: list[Decimal]) -> dict[str, Rows]:
    """Force and moment of every joint."""
    found = {name: [[ZERO] * 3, [ZERO] * 3] for name in scene["joints"]}
    for row, value in zip(rows, values, strict=True):
        of = found[row.joint]
        of[row.turns] = list(plus(tuple(of[row.turns]), times(value, row.n)))
    return found
