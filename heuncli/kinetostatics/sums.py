"""Sums of open components that are certain: few, readable, and true in neighbouring poses too.

A sum is certain if the shares of every self-stress in it cancel. Forces and moments apart (together only where nothing
else is certain): first pairs, components whose shares are proportional; then each further one by those named before it.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np

from heuncli.results import Array, Block

SAME = 1e-7  # of a row's length: what is left of it when it is told by others


def certain_sums(rows: Mapping[str, Array], values: Mapping[str, Array]) -> list[Block]:
    """Sums over open components. rows: name -> its shares, (K,); values: name -> (n_t,), of any one solution."""
    force = {name: r for name, r in rows.items() if ".force." in name}
    moment = {name: r for name, r in rows.items() if ".moment." in name}
    found = relations(force) + relations(moment)
    if not found:
        found = relations(dict(rows))
    return [
        {"terms": terms, "value": sum((c * values[name] for name, c in terms.items()), np.zeros(1))} for terms in found
    ]


def relations(rows: Mapping[str, Array]) -> list[dict[str, float]]:
    """Combinations of rows that vanish, as {name: factor}: pairs, then echelon form, the earliest names left free."""
    names = list(rows)
    if not names:
        return []
    scale = {name: float(np.sqrt(rows[name] @ rows[name])) for name in names}
    names = [name for name in names if scale[name] > 0.0]  # open only where no sum is read from
    if not names:
        return []
    stacked = np.stack([rows[name] / scale[name] for name in names])
    same = stacked @ stacked.T
    found: list[dict[str, float]] = []
    heads: list[int] = []
    for i, name in enumerate(names):
        head = next(
            (
                h
                for h in heads
                if abs(same[i, h]) > 0.999 and np.linalg.norm(stacked[i] - same[i, h] * stacked[h]) <= SAME
            ),
            None,
        )
        if head is None:
            heads.append(i)
        else:
            found.append(tidy({names[head]: -float(same[i, head]) * scale[name] / scale[names[head]], name: 1.0}))
    return found + echelon([names[h] for h in heads], stacked[heads], scale)


def echelon(names: Sequence[str], rows: Array, scale: Mapping[str, float]) -> list[dict[str, float]]:
    """Each row (of unit length) that the ones named before it can tell, told by an independent set of those."""
    found: list[dict[str, float]] = []
    free: list[int] = []
    basis = np.zeros((0, rows.shape[1]))  # orthonormal, of the free rows
    for i, name in enumerate(names):
        rest = rows[i] - basis.T @ (basis @ rows[i])
        rest = rest - basis.T @ (basis @ rest)
        size = float(np.sqrt(rest @ rest))
        if size > SAME:
            basis = np.vstack([basis, rest / size])
            free.append(i)
            continue
        c = np.linalg.solve(basis @ rows[free].T, basis @ rows[i])
        told = {names[f]: -float(x) * scale[name] / scale[names[f]] for f, x in zip(free, c, strict=True)}
        small = 1e-9 * max(abs(x) * scale[n] for n, x in told.items())
        found.append(tidy({n: x for n, x in told.items() if abs(x) * scale[n] > small} | {name: 1.0}))
    return found


def tidy(terms: dict[str, float]) -> dict[str, float]:
    """First term positive, whole numbers whole."""
    first = next(iter(terms.values()))
    sign = 1.0 if first > 0.0 else -1.0
    smallest = min(abs(x) for x in terms.values())
    scaled = {name: sign * x / (abs(first) if abs(first) >= smallest else 1.0) for name, x in terms.items()}
    return {name: float(round(x)) if abs(x - round(x)) <= 1e-9 and round(x) != 0 else x for name, x in scaled.items()}
