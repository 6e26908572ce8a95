"""Search laws in the cycle's own angle for events between the nodes that no node has sampled.

Such a law is a function of the angle alone, so bounds over stretches of the angle also cover what was not sampled (as
for functions of time, study/search/law_instants.py). Stretches where bounds allow more than the polynomial through the
nodes shows are halved; in the middle of each the law is compared with the polynomial.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator

import numpy as np

from heuncli.analyses.balancing.cycle_nodes import PieceNodes
from heuncli.base import tolerances
from heuncli.base.named_tuples import NamedTuple
from heuncli.base.records import replace
from heuncli.results.results import Array
from heuncli.scene.expressions.composition import JUMPS
from heuncli.scene.expressions.programs import CONST, HOLD, KNOT, TABLE, VAR, Expression

# places in a stretch, as fractions of its length, at which the polynomial is evaluated
SAMPLE_FRACTIONS = np.array([0.0, 0.25, 0.5, 0.75, 1.0])
# of the largest excess of any stretch: stretches with less are halved later; and of the excess of the stretch itself:
# a place that deviates by less is not yet the place that the bounds allow
DEFERRED_SHARE = 1e-2
MAX_STRETCHES = 60_000


class LawDeviations(NamedTuple):
    """Places (n,) where laws deviate from the polynomials through their nodes, and the laws that bounds could not
    decide.
    """

    places: Array
    undecided_laws: tuple[str, ...]


def iter_angle_laws(values: Iterable[Expression], joint: str, rate: float) -> Iterator[Expression]:
    """Yield the laws that depend only on a joint's angle, or on its angle and rate, as functions of the angle."""
    for value in values:
        variables = value.uses
        if (
            variables
            and not value.time_dependent
            and all(use in ((joint, "angle"), (joint, "rate")) for use in variables)
        ):
            yield to_angle_law(value, rate)


def to_angle_law(value: Expression, rate: float) -> Expression:
    """Convert a law of a joint's angle, and of its constant rate, into one whose time argument is the angle; held
    branches are released.
    """
    rate_indices, constant = [1 + k for k, use in enumerate(value.uses) if use[1] == "rate"], len(value.constants)
    pairs = list(zip(value.code[::2], value.code[1::2], strict=True))
    is_data = [False] * (len(pairs) + 1)
    for i, (op, _) in enumerate(pairs):
        is_data[i + 1] = not is_data[i] and op in (TABLE, KNOT)
    holds = [op == HOLD and not data for (op, _), data in zip(pairs, is_data, strict=False)]
    new_indices = [i - sum(holds[:i]) for i in range(len(pairs) + 1)]  # where each instruction comes to stand
    code: list[int] = []
    for i, (op, k) in enumerate(pairs):
        if holds[i]:
            continue
        if not is_data[i] and op == VAR:
            op, k = (CONST, constant) if k in rate_indices else (VAR, 0)
        elif not is_data[i] and op in JUMPS:
            k = new_indices[i + 1 + k] - new_indices[i + 1]
        code += [op, k]
    law: Expression = replace(
        value, uses=(), time_dependent=True, code=tuple(code), constants=(*value.constants, rate), held_branches=()
    )
    return law


def find_deviations(laws: Iterable[Expression], nodes: PieceNodes) -> LawDeviations:
    """Find the places where laws deviate from their polynomials."""
    all_places, undecided = [np.zeros(0)], []
    for law in laws:
        places, decided = find_law_deviations(law, nodes)
        all_places.append(places)
        if not decided:
            undecided.append(law.source.strip())
    return LawDeviations(np.unique(np.concatenate(all_places)), tuple(undecided))


def find_law_deviations(law: Expression, nodes: PieceNodes) -> tuple[Array, bool]:
    """Return the places (n,) where a law deviates from its polynomial, and whether bounds exclude others."""
    values = np.array(law.sample(nodes.angles.tolist()))
    if not np.isfinite(values).all():
        return np.zeros(0), True  # refused when the scene is solved
    coefficients = nodes.compute_coefficients(values)
    margin = tolerances.BESIDE_BREAK * nodes.length
    a, b = nodes.begins + margin, nodes.ends - margin
    a, b = a[b > a], b[b > a]
    excesses = compute_excess(law, nodes, coefficients, a, b)
    size, places, stretch_count = float(np.ptp(values)), [np.zeros(0)], 0
    while len(a):
        # stretches with the largest excess come first: their deviations set the scale of the others
        is_current = ~(excesses <= DEFERRED_SHARE * excesses.max()) | ~np.isfinite(excesses)
        stretch_count += int(is_current.sum())
        if stretch_count > MAX_STRETCHES:
            return np.concatenate(places), False
        middle = 0.5 * (a[is_current] + b[is_current])
        deviations = np.abs(
            np.array(law.sample(compute_angles(nodes, middle).tolist())) - nodes.evaluate(coefficients, middle)[:, 0]
        )
        size = max(size, float(deviations.max(initial=0.0)))
        is_deviating = (deviations > tolerances.LAW_FOLLOWED * size) & (
            deviations > DEFERRED_SHARE * excesses[is_current]
        )
        places.append(middle[is_deviating])
        left, right = a[is_current][~is_deviating], b[is_current][~is_deviating]
        wide = right - left > tolerances.SIDE_BY_SIDE * nodes.length
        left, middle, right = left[wide], middle[~is_deviating][wide], right[wide]
        new_a, new_b = np.concatenate([left, middle]), np.concatenate([middle, right])
        new_excesses = compute_excess(law, nodes, coefficients, new_a, new_b)
        a, b = np.concatenate([a[~is_current], new_a]), np.concatenate([b[~is_current], new_b])
        excesses = np.concatenate([excesses[~is_current], new_excesses])
        counts = ~(excesses <= tolerances.LAW_FOLLOWED * size) if size > 0.0 else excesses > 0.0
        a, b, excesses = a[counts], b[counts], excesses[counts]
    return np.concatenate(places), True


def compute_excess(law: Expression, nodes: PieceNodes, coefficients: Array, a: Array, b: Array) -> Array:
    """Return by how much a law may exceed the range that its polynomial shows on stretches, (n,)."""
    if not len(a):
        return np.zeros(0)
    lowest, highest = compute_bounds(law, nodes, a, b)
    places = a[:, None] + (b - a)[:, None] * SAMPLE_FRACTIONS
    samples = nodes.evaluate(coefficients, places.ravel()).reshape(places.shape)
    found = np.maximum(highest - samples.max(axis=1), samples.min(axis=1) - lowest)
    return np.asarray(np.where(np.isnan(found), np.inf, found))


def compute_angles(nodes: PieceNodes, x: Array) -> Array:
    """Return the angles of places (n,)."""
    return np.asarray(nodes.begin + (x if nodes.direction > 0.0 else nodes.length - x))


def compute_bounds(law: Expression, nodes: PieceNodes, a: Array, b: Array) -> tuple[Array, Array]:
    """Return lower and upper bounds of a law over stretches of places, (n,) each; not finite where there are none."""
    first_angles, second_angles = compute_angles(nodes, a), compute_angles(nodes, b)
    low, high = np.minimum(first_angles, second_angles), np.maximum(first_angles, second_angles)
    lowest, highest = law.bounds(low.tolist(), high.tolist())
    return np.array(lowest), np.array(highest)
