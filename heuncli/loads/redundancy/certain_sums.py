"""Sums of open components that are certain: few, readable, and true in neighbouring poses too.

A sum is certain if the shares of every self-stress in it cancel. Forces and moments apart (together only where nothing
else is certain): first pairs, components whose shares are proportional; then each further one by those named before it.
What constant factors leave is expressed by factors that turn with the pose (turning_sums.py).
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np

from heuncli.base import tolerances
from heuncli.loads.redundancy.turning_sums import Shares, turning_sums
from heuncli.results.results import Array, CertainSum

WORTH_A_LOOK = 0.999  # cosine of two rows: below it they are not proportional, which saves the difference


def certain_sums(poses: Shares, asked: Shares, values: Mapping[str, Array], length: float) -> list[CertainSum]:
    """Sums over open components; factors that turn are arrays (n_t,), at one instant alone numbers.

    poses: shares where the sums must hold; asked: the same at the asked instants; values: (n_t,), of any one solution.
    length: what divides moments where they stand beside forces [m].
    """
    force = [name for name in poses if is_force(name)]
    moment = [name for name in poses if not is_force(name)]
    steady, turning = list[dict[str, float]](), list[dict[str, Array]]()
    for names in (force, moment):
        constant, left = relations({name: poses[name].ravel() for name in names})
        steady += constant
        turning += turning_sums({name: poses[name] for name in left}, asked)
    if not steady and not turning:
        steady, left = relations({name: poses[name].ravel() for name in (*force, *moment)})
        unit = {name: 1.0 if is_force(name) else length for name in left}
        scaled = [{name: part[name] / unit[name] for name in left} for part in (poses, asked)]
        turning = [{name: c / unit[name] for name, c in terms.items()} for terms in turning_sums(*scaled)]
    found: list[Mapping[str, float | Array]] = [*steady, *turning]
    if all(len(value) == 1 for value in values.values()):
        found = [{name: float(np.asarray(c).item()) for name, c in terms.items()} for terms in found]
    return [
        {"terms": terms, "value": sum((c * values[name] for name, c in terms.items()), np.zeros(1))} for terms in found
    ]


def is_force(name: str) -> bool:
    """Whether a component is of a force, and not of a moment: `joints.a.force.x`, `couplings.mesh.force`."""
    return "moment" not in name.split(".")[2:3]


def relations(rows: Mapping[str, Array]) -> tuple[list[dict[str, float]], list[str]]:
    """Combinations of rows (K,) that vanish, as {name: factor}, and the names of those that are left free.

    Pairs, then echelon form, the earliest names left free.
    """
    scale = {name: float(np.sqrt(row @ row)) for name, row in rows.items()}
    names = [name for name in rows if scale[name] > 0.0]  # open only where no sum is read from
    if not names:
        return [], []
    stacked = in_few_axes(np.stack([rows[name] / scale[name] for name in names]))
    same = stacked @ stacked.T
    found: list[dict[str, float]] = []
    heads: list[int] = []
    for i, name in enumerate(names):
        alike = np.array(heads, dtype=int)[np.abs(same[i, heads]) > WORTH_A_LOOK].tolist()
        apart = (np.linalg.norm(stacked[i] - same[i, h] * stacked[h]) for h in alike)
        head = next((h for h, d in zip(alike, apart, strict=True) if d <= tolerances.DEPENDENT_SHARES), None)
        if head is None:
            heads.append(i)
        else:
            found.append(tidy({names[head]: -float(same[i, head]) * scale[name] / scale[names[head]], name: 1.0}))
    more, free = echelon([names[h] for h in heads], stacked[heads], scale)
    return found + more, free


def in_few_axes(rows: Array) -> Array:
    """Rows (n, K) in orthonormal axes that span them, (n, at most n): the same lengths and angles, fewer numbers."""
    rows = rows[:, rows.any(axis=0)]  # most self-stresses of a large mechanism reach few of its joints
    n, K = rows.shape
    return rows if K <= n else np.asarray(np.linalg.qr(rows.T, mode="r")).T


def echelon(names: Sequence[str], rows: Array, scale: Mapping[str, float]) -> tuple[list[dict[str, float]], list[str]]:
    """Each row (of unit length) that depends on those before it, by an independent set of them; and that set."""
    sums: list[dict[str, float]] = []
    free: list[int] = []
    Q = np.zeros_like(rows)  # orthonormal, of the free rows
    for i, name in enumerate(names):
        basis = Q[: len(free)]
        rest = rows[i] - basis.T @ (basis @ rows[i])
        rest = rest - basis.T @ (basis @ rest)
        size = float(np.sqrt(rest @ rest))
        if size > tolerances.DEPENDENT_SHARES:
            Q[len(free)] = rest / size
            free.append(i)
            continue
        c = np.linalg.solve(basis @ rows[free].T, basis @ rows[i])
        others = {names[f]: -float(x) * scale[name] / scale[names[f]] for f, x in zip(free, c, strict=True)}
        small = tolerances.ABSENT_FACTOR * max(abs(x) * scale[n] for n, x in others.items())
        sums.append(tidy({n: x for n, x in others.items() if abs(x) * scale[n] > small} | {name: 1.0}))
    return sums, [names[f] for f in free]


def tidy(terms: dict[str, float]) -> dict[str, float]:
    """First term positive, whole numbers whole."""
    first = next(iter(terms.values()))
    sign = 1.0 if first > 0.0 else -1.0
    smallest = min(abs(x) for x in terms.values())
    scaled = {name: sign * x / (abs(first) if abs(first) >= smallest else 1.0) for name, x in terms.items()}
    near = {name: x for name, x in scaled.items() if abs(x - round(x)) <= tolerances.WHOLE_FACTOR and round(x) != 0}
    return scaled | {name: float(round(x)) for name, x in near.items()}
