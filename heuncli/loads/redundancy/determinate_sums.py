"""Find determinate sums of indeterminate components: few, readable, and valid in neighbouring poses too.

A sum is determinate if the shares of every self-stress in it cancel. Forces and moments are treated separately
(together only where nothing else is determinate). First pairs, components whose shares are proportional; then each
further one in terms of those named before it. What constant factors leave is expressed by factors that turn with the
pose.

Two ball joints on one body leave the load along the line between them indeterminate. Perpendicular to it each load is
determinate, in directions that turn with the body: sum of c_i(t) F_i. At every instant c is such that all self-stresses
of that instant cancel, of unit length (so for one joint's force it is the component in a direction), and continuous in
sign.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np

from heuncli.base import tolerances
from heuncli.results.results import Array, DeterminateSum

# Turning sums

BLOCK_ROWS = 32  # rows orthogonalised to the earlier rows in one product
MAX_TERMS = 24  # longer sums are unreadable and slow to find
SIGN_THRESHOLD = 0.1  # of unit length: the first factor that large is positive at the start

ComponentShares = Mapping[str, Array]  # components' shares of every self-stress, (poses, k)


def find_turning_sums(poses: ComponentShares, requested_shares: ComponentShares) -> list[dict[str, Array]]:
    """Find for each component that depends on a few before it in all poses the factors at the requested instants,
    (n_t,) each.
    """
    sums: list[dict[str, Array]] = []
    for names in find_dependent_components(poses):
        if (
            len(names) <= MAX_TERMS
            and (c := find_factors(np.stack([requested_shares[n] for n in names], axis=1))) is not None
        ):
            sums.append({name: factor for name, factor in zip(names, c.T, strict=True) if factor.any()})
    return sums


def find_dependent_components(poses: ComponentShares) -> list[list[str]]:
    """Find the components that depend on earlier ones in every pose; return each after the independent ones that it
    depends on.

    A component that is independent in one pose counts as independent: elsewhere its dependence is a coincidence.
    """
    names = list(poses)
    if not names:
        return []
    rows = np.stack([poses[n] for n in names], axis=1)
    rows = rows[:, :, rows.any(axis=(0, 1))]  # the self-stresses that reach some of them
    rows = rows / np.sqrt(np.sum(rows * rows, axis=2)).max(axis=0)[None, :, None]
    Q = np.zeros_like(rows)  # orthonormal in each pose, zero where a free row depends on others there
    is_generic = np.ones(len(rows), dtype=bool)  # poses in which all the free ones are independent
    free: list[int] = []
    dependent: list[int] = []
    for i in range(len(names)):
        if len(free) == rows.shape[2]:  # they span all there is
            dependent += range(i, len(names))
            break
        if i % BLOCK_ROWS == 0:
            before = len(free)
            reduced_rows = remove_projection(rows[:, i : i + BLOCK_ROWS], Q[:, :before])
        residual = remove_projection(reduced_rows[:, i % BLOCK_ROWS, None], Q[:, before : len(free)])
        size = np.sqrt(np.einsum("tik,tik->t", residual, residual))
        # where a component vanishes, as of a crank on an axis, that is rounding
        is_independent = size > tolerances.DEPENDENT_SHARES
        if (is_generic & is_independent).any():
            is_generic &= is_independent
            Q[:, len(free)] = residual[:, 0] * (is_independent / np.where(is_independent, size, 1.0))[:, None]
            free.append(i)
        else:
            dependent.append(i)
    if not dependent:
        return []
    basis = Q[is_generic][:, : len(free)]
    c = np.linalg.solve(
        basis @ rows[is_generic][:, free].transpose(0, 2, 1), basis @ rows[is_generic][:, dependent].transpose(0, 2, 1)
    )
    is_used = (np.abs(c) > tolerances.ABSENT_FACTOR * np.maximum(np.abs(c).max(axis=1, keepdims=True), 1.0)).any(axis=0)
    return [[*(names[f] for f in np.array(free)[is_used[:, k]]), names[i]] for k, i in enumerate(dependent)]


def remove_projection(rows: Array, basis: Array) -> Array:
    """Return the part of rows (poses, n, k) perpendicular to an orthonormal basis (poses, m, k); removed twice, for
    rounding.
    """
    for _ in range(2):
        rows = rows - (rows @ basis.transpose(0, 2, 1)) @ basis
    return rows


def find_factors(rows: Array) -> Array | None:
    """Return unit vectors c (n_t, n) with c . rows = 0 for rows (n_t, n, k), the last of which depends on the others.

    The factors are continuous, and the first large one is positive at the start. Where the other rows are dependent
    too, c is close to that of the nearest instant where they are not. None where there is no c at some instant.
    """
    size = np.sqrt(np.sum(rows * rows, axis=2)).max(axis=0)
    R = np.asarray(np.linalg.qr((rows / size[None, :, None]).transpose(0, 2, 1), mode="r"))
    n = rows.shape[1]
    if R.shape[1] < n:
        R = np.pad(R, ((0, 0), (0, n - R.shape[1]), (0, 0)))
    diagonal = np.abs(np.diagonal(R, axis1=1, axis2=2))
    row_scale = np.maximum(np.abs(R).max(axis=(1, 2)), 1.0)  # of rows that vanish at an instant only rounding is left
    is_generic = (diagonal[:, :-1] > tolerances.DEPENDENT_SHARES * row_scale[:, None]).all(axis=1)
    if not is_generic.any() or (diagonal[is_generic, -1] > tolerances.DEPENDENT_SHARES * row_scale[is_generic]).any():
        return None
    c = np.ones((len(rows), n))
    c[is_generic, :-1] = solve_triangular(R[is_generic, :-1, :-1], -R[is_generic, :-1, -1], rows.shape[2])
    for t in np.flatnonzero(~is_generic):
        U, sigma, _ = np.linalg.svd(R[t].T)
        N = U[:, sigma <= tolerances.DEPENDENT_SHARES * row_scale[t]]
        if not N.shape[1]:
            return None
        generic_instants = np.flatnonzero(is_generic)
        nearest_factors = c[generic_instants[np.argmin(np.abs(generic_instants - t))]]
        c[t] = N @ (N.T @ nearest_factors)
    c = c / size
    unit: Array = c / np.sqrt(np.sum(c * c, axis=1))[:, None]
    unit *= np.sign(unit[0, np.argmax(np.abs(unit[0]) > SIGN_THRESHOLD)])
    return unit


def solve_triangular(T: Array, r: Array, k: int) -> Array:
    """Return solutions x (n_t, n) of triangular T x = r, from factors of k rows; zero where x may be rounding alone.

    Householder's factors are those of columns perturbed by at most k (n + 1) u of their lengths, here 1 at most. So the
    error of x is at most that, times |T^-1|, times 1 + sum |x|.
    """
    inverse = np.linalg.inv(T)
    x = (inverse @ r[:, :, None])[:, :, 0]
    u = 0.5 * np.finfo(np.float64).eps
    errors = k * (T.shape[1] + 1) * u * np.abs(inverse).sum(axis=2) * (1.0 + np.abs(x).sum(axis=1, keepdims=True))
    return np.where(np.abs(x) > errors, x, 0.0)


# Determinate sums

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
