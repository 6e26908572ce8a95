"""Find determinate sums of indeterminate components: few, readable, and valid in neighbouring poses too.

A sum is determinate if the shares of every self-stress in it cancel. Forces and moments are treated separately
(together only where nothing else is determinate). First pairs, components whose shares are proportional; then each
further one in terms of those named before it. What constant factors leave is expressed by factors that turn with the
pose (turning_sums.py).
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np

from heuncli.base import tolerances
from heuncli.loads.redundancy.turning_sums import ComponentShares, find_turning_sums
from heuncli.results.results import Array, DeterminateSum

PARALLEL_COSINE = 0.999  # cosine of two rows: below it they are not proportional, which saves the difference


def find_determinate_sums(
    poses: ComponentShares, requested_shares: ComponentShares, values: Mapping[str, Array], length: float
) -> list[DeterminateSum]:
    """Find sums over indeterminate components; turning factors are arrays (n_t,), numbers at a single instant.

    poses: shares where the sums must hold
    requested_shares: the same at the requested instants
    values: (n_t,), of any one solution
    length: divisor of moments where they are added to forces [m]
    """
    force = [name for name in poses if is_force(name)]
    moment = [name for name in poses if not is_force(name)]
    constant_sums, turning_sums_found = list[dict[str, float]](), list[dict[str, Array]]()
    for names in (force, moment):
        constant, remaining = find_relations({name: poses[name].ravel() for name in names})
        constant_sums += constant
        turning_sums_found += find_turning_sums({name: poses[name] for name in remaining}, requested_shares)
    if not constant_sums and not turning_sums_found:
        constant_sums, remaining = find_relations({name: poses[name].ravel() for name in (*force, *moment)})
        unit = {name: 1.0 if is_force(name) else length for name in remaining}
        scaled = [{name: part[name] / unit[name] for name in remaining} for part in (poses, requested_shares)]
        turning_sums_found = [
            {name: c / unit[name] for name, c in terms.items()} for terms in find_turning_sums(*scaled)
        ]
    sums: list[Mapping[str, float | Array]] = [*constant_sums, *turning_sums_found]
    if all(len(value) == 1 for value in values.values()):
        sums = [{name: float(np.asarray(c).item()) for name, c in terms.items()} for terms in sums]
    return [
        {"terms": terms, "value": sum((c * values[name] for name, c in terms.items()), np.zeros(1))} for terms in sums
    ]


def is_force(name: str) -> bool:
    """Return whether a component is of a force, and not of a moment: `joints.a.force.x`, `couplings.mesh.force`."""
    return "moment" not in name.split(".")[2:3]


def find_relations(rows: Mapping[str, Array]) -> tuple[list[dict[str, float]], list[str]]:
    """Return the combinations of rows (K,) that vanish, as {name: factor}, and the names of those that are left free.

    Pairs first, then echelon form; the earliest names are left free.
    """
    scale = {name: float(np.sqrt(row @ row)) for name, row in rows.items()}
    names = [name for name in rows if scale[name] > 0.0]  # indeterminate only at other instants
    if not names:
        return [], []
    stacked = reduce_columns(np.stack([rows[name] / scale[name] for name in names]))
    cosines = stacked @ stacked.T
    sums: list[dict[str, float]] = []
    heads: list[int] = []
    for i, name in enumerate(names):
        candidates = np.array(heads, dtype=int)[np.abs(cosines[i, heads]) > PARALLEL_COSINE].tolist()
        distances = (np.linalg.norm(stacked[i] - cosines[i, h] * stacked[h]) for h in candidates)
        head = next((h for h, d in zip(candidates, distances, strict=True) if d <= tolerances.DEPENDENT_SHARES), None)
        if head is None:
            heads.append(i)
        else:
            sums.append(
                tidy_factors({names[head]: -float(cosines[i, head]) * scale[name] / scale[names[head]], name: 1.0})
            )
    further_sums, free = reduce_to_echelon([names[h] for h in heads], stacked[heads], scale)
    return sums + further_sums, free


def reduce_columns(rows: Array) -> Array:
    """Return rows (n, K) in orthonormal axes that span them, (n, at most n): the same lengths and angles, fewer
    numbers.
    """
    rows = rows[:, rows.any(axis=0)]  # most self-stresses of a large mechanism reach few of its joints
    n, K = rows.shape
    return rows if K <= n else np.asarray(np.linalg.qr(rows.T, mode="r")).T


def reduce_to_echelon(
    names: Sequence[str], rows: Array, scale: Mapping[str, float]
) -> tuple[list[dict[str, float]], list[str]]:
    """Express each row (of unit length) that depends on those before it by an independent set of them; also return that
    set.
    """
    sums: list[dict[str, float]] = []
    free: list[int] = []
    Q = np.zeros_like(rows)  # orthonormal, of the free rows
    for i, name in enumerate(names):
        basis = Q[: len(free)]
        residual = rows[i] - basis.T @ (basis @ rows[i])
        residual = residual - basis.T @ (basis @ residual)
        size = float(np.sqrt(residual @ residual))
        if size > tolerances.DEPENDENT_SHARES:
            Q[len(free)] = residual / size
            free.append(i)
            continue
        c = np.linalg.solve(basis @ rows[free].T, basis @ rows[i])
        others = {names[f]: -float(x) * scale[name] / scale[names[f]] for f, x in zip(free, c, strict=True)}
        small = tolerances.ABSENT_FACTOR * max(abs(x) * scale[n] for n, x in others.items())
        sums.append(tidy_factors({n: x for n, x in others.items() if abs(x) * scale[n] > small} | {name: 1.0}))
    return sums, [names[f] for f in free]


def tidy_factors(terms: dict[str, float]) -> dict[str, float]:
    """Make the first term positive, and factors close to whole numbers whole."""
    first = next(iter(terms.values()))
    sign = 1.0 if first > 0.0 else -1.0
    smallest = min(abs(x) for x in terms.values())
    scaled = {name: sign * x / (abs(first) if abs(first) >= smallest else 1.0) for name, x in terms.items()}
    whole_numbers = {
        name: x for name, x in scaled.items() if abs(x - round(x)) <= tolerances.WHOLE_FACTOR and round(x) != 0
    }
    return scaled | {name: float(round(x)) for name, x in whole_numbers.items()}
