"""Collocation methods: Gauss's nodes (symmetric, symplectic) and Radau's (stiff), all computed from the nodes.

    a_ij = integral of l_j over 0..c_i,   b_j = integral over 0..1,   l_j(c_i) = 1 where i = j, else 0

With y1 = y + sum d_i Z_i, d = b A^-1. The error estimate uses the derivative f_0 at the start as a further node 0: the
polynomial through the f_i misses it by f_0 - sum w_i f_i, w_i = l_i(0), and h f is A^-1 Z. All is computed with
fractions, whose digits are the same on every machine. A^-1 = T L T^-1: `back` is T, last row 1 and, of a pair, 1 and 0;
`real` and `pairs` are L. Hairer, Wanner, Solving ODEs II (1996), IV.5 and IV.8; Hairer, Lubich, Wanner, Geometric
Numerical Integration (2006), II.1.

SciPy's stiff and switching integrators are independent checks (motion/integration/run/scipy_loop.py); their orders
vary. They see loads only at their stages and may miss a pulse between two of them; so may a finer run of the same
method. Therefore the check run is the kernel's, which bounds the loads within a step.
"""

from __future__ import annotations

from fractions import Fraction

from heuncli.base.records import record, replace
from heuncli.motion.integration.methods.method import Method, Row

# Collocation

Matrix = list[list[Fraction]]


@record
class CollocationNodes:
    """The nodes of a method, and the transformation that splits its equations into single numbers and pairs."""

    nodes: tuple[float, ...]
    real: float
    pairs: tuple[float, ...]
    back: tuple[tuple[float, ...], ...]


def make_method(
    name: str,
    order: int,
    collocation_nodes: CollocationNodes,
    *,
    error_order: int,
    sample_fractions: tuple[float, ...] = (),
) -> Method:
    """Make the method with these nodes.

    error_order: of Radau's error estimate in h; 0 for Gauss's methods, whose step is fixed
    """
    c = [Fraction(x) for x in collocation_nodes.nodes]
    A, b, is_fixed = integrate_lagrange(c, c), integrate_lagrange(c, [Fraction(1)])[0], not error_order
    inverse = invert(A)
    at_start = [-x for x in evaluate_lagrange(c, Fraction(0))]
    collocation = {
        "real": collocation_nodes.real,
        "parts": list(collocation_nodes.pairs),
        "into": flatten(invert([[Fraction(x) for x in row] for row in collocation_nodes.back])),
        "back": [x for row in collocation_nodes.back for x in row],
        "end": flatten(multiply([b], inverse)),
        "error": flatten(multiply([at_start], inverse)),
    }
    return Method(
        name=name,
        order=order,
        nodes=(0.0, *collocation_nodes.nodes),
        stages=tuple(make_sparse_row([Fraction(0), *row]) for row in A),
        solution=make_sparse_row([Fraction(0), *b]),
        error_order=error_order or 1,
        dense=make_dense_output_rows(c),
        has_fixed_step=is_fixed,
        by_step=is_fixed,
        implicit=True,
        collocation=collocation,
        sample_fractions=sample_fractions,
    )


# Polynomials through nodes


def evaluate_lagrange(c: list[Fraction], x: Fraction) -> list[Fraction]:
    """Return the values l_j(x)."""
    products = []
    for j, cj in enumerate(c):
        product = Fraction(1)
        for k, ck in enumerate(c):
            if k != j:
                product *= (x - ck) / (cj - ck)
        products.append(product)
    return products


def integrate_lagrange(c: list[Fraction], ends: list[Fraction]) -> Matrix:
    """Return the integrals of all l_j from 0 to each of the ends, as sums of powers."""
    powers = invert([[x**k for k in range(len(c))] for x in c])
    power_integrals = [[x ** (k + 1) / (k + 1) for k in range(len(c))] for x in ends]
    return multiply(power_integrals, powers)


def make_dense_output_rows(c: list[Fraction]) -> tuple[Row, ...]:
    """Return the rows that extend the cubic to the polynomial through all stages within the step.

    At x = c_i the stage differs from the cubic by x^2 (1 - x)^2 (F3 + x (F4 + (1 - x) (F5 + ...))). Rows apply to the
    Z_i, from 1 on, and then to F0, F1 and F2, which make the cubic x (F0 + (1 - x) (F1 + x F2)).
    """
    inner = [i for i, x in enumerate(c) if x < 1]
    differences, shapes = [], []
    for i in inner:
        x, shape = c[i], [Fraction(1)]
        stages = [Fraction(int(i == j)) for j in range(len(c))]
        differences.append([y / (x * (1 - x)) ** 2 for y in (Fraction(0), *stages, -x, -x * (1 - x), -x * x * (1 - x))])
        for k in range(1, len(inner)):
            shape.append(shape[-1] * (x if k % 2 else 1 - x))
        shapes.append(shape)
    return tuple(make_sparse_row(row) for row in multiply(invert(shapes), differences))


# Matrices of fractions


def multiply(A: Matrix, B: Matrix) -> Matrix:
    """Return A B."""
    return [[sum((x * y for x, y in zip(row, column, strict=True)), Fraction(0)) for column in zip(*B, strict=True)]
            for row in A]  # fmt: skip


def invert(A: Matrix) -> Matrix:
    """Return A^-1 by elimination; exact, so any pivot but zero will do."""
    n = len(A)
    M = [[*row, *(Fraction(int(i == j)) for j in range(n))] for i, row in enumerate(A)]
    for k in range(n):
        pivot = next(i for i in range(k, n) if M[i][k])
        M[k], M[pivot] = M[pivot], M[k]
        M[k] = [x / M[k][k] for x in M[k]]
        for i in range(n):
            if i != k and M[i][k]:
                M[i] = [x - M[i][k] * y for x, y in zip(M[i], M[k], strict=True)]
    return [row[n:] for row in M]


def flatten(A: Matrix) -> list[float]:
    """Return all numbers, row by row."""
    return [float(x) for row in A for x in row]


def make_sparse_row(numbers: list[Fraction]) -> Row:
    """Return stage and coefficient of all numbers except zeros."""
    return tuple((stage, float(x)) for stage, x in enumerate(numbers) if x)


GAUSS_2 = CollocationNodes(
    nodes=(0.2113248654051871, 0.7886751345948129),
    real=0.0,
    pairs=(3.0, 1.7320508075688772),
    back=(
        (0.0, 0.2679491924311227),
        (1.0, 0.0),
    ),
)
GAUSS_3 = CollocationNodes(
    nodes=(0.11270166537925831, 0.5, 0.8872983346207417),
    real=4.644370709252171,
    pairs=(3.6778146453739144, 3.5087619195674433),
    back=(
        (0.07215185205520017, -0.08224123057363067, -0.0601207386193085),
        (0.11883257874127781, 0.053065090742061394, 0.3162050511322916),
        (1.0, 1.0, 0.0),
    ),
)
RADAU_3 = CollocationNodes(
    nodes=(0.1550510257216822, 0.6449489742783178, 1.0),
    real=3.637834252744496,
    pairs=(2.6810828736277523, 3.0504301992474105),
    back=(
        (0.09443876248897524, -0.1412552950209542, -0.030029194105147424),
        (0.2502131229653333, 0.20412935229379994, 0.3829421127572619),
        (1.0, 1.0, 0.0),
    ),
)
RADAU_5 = CollocationNodes(
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
# Gauss's methods do not damp what decays within a small part of a step, |R(-inf)| = 1, at any step, so two runs of
# one have the same error there. Radau's methods damp it.
CHECK = make_method("Radau9", 9, RADAU_5, error_order=0)
GAUSS4 = replace(make_method("Gauss4", 4, GAUSS_2, error_order=0), check=CHECK)
GAUSS6 = replace(make_method("Gauss6", 6, GAUSS_3, error_order=0), check=CHECK)
RADAU5 = make_method("Radau5", 5, RADAU_3, error_order=4, sample_fractions=(0.3, 0.75))
RADAU9 = make_method("Radau9", 9, RADAU_5, error_order=6, sample_fractions=(0.125, 0.4, 0.675))


# Scipy methods


def make_scipy_method(name: str, order: int) -> Method:
    """Make a method from a class of `scipy.integrate`."""
    return Method(
        name=f"SciPy-{name}", order=order, nodes=(), stages=(), solution=(), error_order=order, scipy_name=name,
        check=RADAU9,
    )  # fmt: skip


RADAU = make_scipy_method("Radau", 5)  # Radau IIA of three stages: Hairer, Wanner, Solving ODEs II, IV.8
BDF = make_scipy_method("BDF", 5)  # orders 1 to 5: Shampine, Reichelt, SIAM J. Sci. Comput. 18 (1997) 1-22
LSODA = make_scipy_method("LSODA", 12)  # Adams to 12, BDF to 5: Petzold, SIAM J. Sci. Stat. Comput. 4 (1983) 136-148
