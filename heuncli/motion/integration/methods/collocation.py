"""Methods by collocation: Gauss's nodes (symmetric, symplectic) and Radau's (stiff), all from the nodes.

    a_ij = integral of l_j over 0..c_i,   b_j = integral over 0..1,   l_j(c_i) = 1 where i = j, else 0
With y1 = y + sum d_i Z_i, d = b A^-1. The estimate's formula has the derivative f_0 at the start for a further node 0:
the polynomial through the f_i misses it by f_0 - sum w_i f_i, w_i = l_i(0), and h f is A^-1 Z. Everything by fractions,
whose digits are the same on every machine. A^-1 = T L T^-1: `back` is T, last row 1 and, of a pair, 1 and 0; `real` and
`pairs` are L. Hairer, Wanner, Solving ODEs II (1996), IV.5 and IV.8; Hairer, Lubich, Wanner, Geometric Numerical
Integration (2006), II.1.
"""

from __future__ import annotations

from fractions import Fraction

from heuncli.base.records import record, replace
from heuncli.motion.integration.methods.method import Method, Row

Matrix = list[list[Fraction]]


@record
class Nodes:
    """The nodes of a method, and what makes its equations those of one number or a pair at a time."""

    nodes: tuple[float, ...]
    real: float
    pairs: tuple[float, ...]
    back: tuple[tuple[float, ...], ...]


def method_by(name: str, order: int, of: Nodes, *, error_order: int, within: tuple[float, ...] = ()) -> Method:
    """The method with these nodes; of Radau's steps are judged by an error of that order in h, of Gauss's given."""
    c = [Fraction(x) for x in of.nodes]
    A, b, fixed = integrals(c, c), integrals(c, [Fraction(1)])[0], not error_order
    inverse = inverted(A)
    at_start = [-x for x in values(c, Fraction(0))]
    collocation = {
        "real": of.real,
        "parts": list(of.pairs),
        "into": flat(inverted([[Fraction(x) for x in row] for row in of.back])),
        "back": [x for row in of.back for x in row],
        "end": flat(times([b], inverse)),
        "error": flat(times([at_start], inverse)),
    }
    return Method(
        name=name, order=order, nodes=(0.0, *of.nodes), stages=tuple(row_of([Fraction(0), *row]) for row in A),
        solution=row_of([Fraction(0), *b]), error_order=error_order or 1, dense=between(c), fixed=fixed,
        by_step=fixed, implicit=True, collocation=collocation, within=within,
    )  # fmt: skip


# Polynomials through nodes


def values(c: list[Fraction], x: Fraction) -> list[Fraction]:
    """l_j(x)."""
    found = []
    for j, cj in enumerate(c):
        product = Fraction(1)
        for k, ck in enumerate(c):
            if k != j:
                product *= (x - ck) / (cj - ck)
        found.append(product)
    return found


def integrals(c: list[Fraction], ends: list[Fraction]) -> Matrix:
    """The integrals of all l_j from 0 to each of the ends, by the powers that they are the sums of."""
    powers = inverted([[x**k for k in range(len(c))] for x in c])
    of_powers = [[x ** (k + 1) / (k + 1) for k in range(len(c))] for x in ends]
    return times(of_powers, powers)


def between(c: list[Fraction]) -> tuple[Row, ...]:
    """Rows of the interpolating polynomial beside the cubic's, so that it goes through all stages within the step.

    At x = c_i the stage is off the cubic by x^2 (1 - x)^2 (F3 + x (F4 + (1 - x) (F5 + ...))). Of the Z_i, from 1 on,
    and then of F0, F1 and F2, which make the cubic x (F0 + (1 - x) (F1 + x F2)).
    """
    inner = [i for i, x in enumerate(c) if x < 1]
    off, shapes = [], []
    for i in inner:
        x, shape = c[i], [Fraction(1)]
        stages = [Fraction(int(i == j)) for j in range(len(c))]
        off.append([y / (x * (1 - x)) ** 2 for y in (Fraction(0), *stages, -x, -x * (1 - x), -x * x * (1 - x))])
        for k in range(1, len(inner)):
            shape.append(shape[-1] * (x if k % 2 else 1 - x))
        shapes.append(shape)
    return tuple(row_of(row) for row in times(inverted(shapes), off))


# Matrices of fractions


def times(A: Matrix, B: Matrix) -> Matrix:
    """A B."""
    return [[sum((x * y for x, y in zip(row, column, strict=True)), Fraction(0)) for column in zip(*B, strict=True)]
            for row in A]  # fmt: skip


def inverted(A: Matrix) -> Matrix:
    """A^-1, by elimination; exact, so any pivot but zero will do."""
    n = len(A)
    M = [[*row, *(Fraction(int(i == j)) for j in range(n))] for i, row in enumerate(A)]
    for k in range(n):
        at = next(i for i in range(k, n) if M[i][k])
        M[k], M[at] = M[at], M[k]
        M[k] = [x / M[k][k] for x in M[k]]
        for i in range(n):
            if i != k and M[i][k]:
                M[i] = [x - M[i][k] * y for x, y in zip(M[i], M[k], strict=True)]
    return [row[n:] for row in M]


def flat(A: Matrix) -> list[float]:
    """All numbers, by rows."""
    return [float(x) for row in A for x in row]


def row_of(numbers: list[Fraction]) -> Row:
    """Stage and coefficient of all but zeros."""
    return tuple((stage, float(x)) for stage, x in enumerate(numbers) if x)


GAUSS_2 = Nodes(
    nodes=(0.2113248654051871, 0.7886751345948129),
    real=0.0,
    pairs=(3.0, 1.7320508075688772),
    back=(
        (0.0, 0.2679491924311227),
        (1.0, 0.0),
    ),
)
GAUSS_3 = Nodes(
    nodes=(0.11270166537925831, 0.5, 0.8872983346207417),
    real=4.644370709252171,
    pairs=(3.6778146453739144, 3.5087619195674433),
    back=(
        (0.07215185205520017, -0.08224123057363067, -0.0601207386193085),
        (0.11883257874127781, 0.053065090742061394, 0.3162050511322916),
        (1.0, 1.0, 0.0),
    ),
)
RADAU_3 = Nodes(
    nodes=(0.1550510257216822, 0.6449489742783178, 1.0),
    real=3.637834252744496,
    pairs=(2.6810828736277523, 3.0504301992474105),
    back=(
        (0.09443876248897524, -0.1412552950209542, -0.030029194105147424),
        (0.2502131229653333, 0.20412935229379994, 0.3829421127572619),
        (1.0, 1.0, 0.0),
    ),
)
RADAU_5 = Nodes(
    nodes=(0.05710419611451768, 0.2768430136381238, 0.5835904323689168, 0.8602401356562195, 1.0),
    real=6.2867047517292765,
    pairs=(5.70095329867179, 3.2102656003085497, 3.655694325463572, 6.543736899360077),
    back=(
        (0.013576867344947943, -0.011478515255229515, -0.01401985889287541, -0.010242047817908826, 0.04767387729029572),
        (0.0016179004017190875, -0.007668830749180163, 0.024708578426518527, 0.05017286451737106, -0.09433181918161143),
        (0.07915785334744721, 0.01939846399882895, 0.08180035370375117, -0.23053953404341795, 0.1027030453801259),
        (0.41225608268046143, 0.40760117128019907, 0.19968242788680252, 0.37789390224886127, 0.46674413033249434),
        (1.0, 1.0, 0.0, 1.0, 0.0),
    ),
)
# What decays within a small part of a step stays by Gauss's methods as it was, |R(-inf)| = 1, at any step: two runs of
# one err alike there. Radau's lets it go.
CHECK = method_by("Radau9", 9, RADAU_5, error_order=0)
GAUSS4 = replace(method_by("Gauss4", 4, GAUSS_2, error_order=0), check=CHECK)
GAUSS6 = replace(method_by("Gauss6", 6, GAUSS_3, error_order=0), check=CHECK)
RADAU5 = method_by("Radau5", 5, RADAU_3, error_order=4, within=(0.3, 0.75))
RADAU9 = method_by("Radau9", 9, RADAU_5, error_order=6, within=(0.125, 0.4, 0.675))
