"""Sample the mass effects of a cycle at nodes that resolve it, and summarise them: means, magnitudes, residuals."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from types import MappingProxyType

import numpy as np

from heuncli.analyses.balancing.cycle import MAX_SAMPLES, Cycle, FollowedScene, MassEffects, compute_mass_effects
from heuncli.analyses.balancing.cycle_nodes import TAIL_FRACTION, CycleNodes, Interpolant
from heuncli.analyses.balancing.followed_run import SAMPLES_PER_TURN
from heuncli.analyses.balancing.order_selection import OrderSelection
from heuncli.analyses.balancing.orders import (
    CycleRotation,
    compute_rounding,
    format_remaining_orders,
    magnitudes,
    make_all_rows,
)
from heuncli.analyses.balancing.piece_resolver import CycleResolver, make_scales
from heuncli.analyses.balancing.results import BalanceOptions, BalanceResults, OrderRow, Residual
from heuncli.analyses.balancing.series import compute_relative_tail
from heuncli.base import tolerances
from heuncli.base.records import replace
from heuncli.results.results import Array
from heuncli.scene.file_format.models import Spec
from heuncli.study.search.extremes import search_extremes

SHORT_STEP_FRACTION = 0.25  # of the distance of nodes: shorter steps of the run indicate a kink
FIRST_SAMPLES = 8  # angles for the size of the terms
MIN_REDUCTION = 2.0  # factor by which doubling the samples must lower the highest orders, else they are rounding


def sample_cycle(followed_scene: FollowedScene, reference_point: Array) -> tuple[Cycle, bool]:
    """Return the cycle at nodes that resolve it, and whether they do: equally spaced if it is smooth, else on
    pieces.
    """
    cycle = sample_evenly(followed_scene, reference_point) if followed_scene.followed_run.is_smooth() else None
    return (cycle, True) if cycle is not None else sample_on_pieces(followed_scene, reference_point)


def sample_evenly(followed_scene: FollowedScene, reference_point: Array) -> Cycle | None:
    """Return the cycle at enough angles that the highest orders are rounding; None if it is not smooth enough for
    that.
    """
    count, previous_tail = SAMPLES_PER_TURN * followed_scene.turns, math.inf
    while True:
        cycle = followed_scene.evaluate_cycle(followed_scene.make_even_nodes(count))
        effects = compute_mass_effects(cycle, reference_point)
        kinds = {"force": effects.force, "moment": effects.moment, "torque": effects.half_slope}
        largest_tail = max(
            compute_relative_tail(values, TAIL_FRACTION, effects.terms[name]) for name, values in kinds.items()
        )
        is_rounding = largest_tail < tolerances.CANCELS and largest_tail * MIN_REDUCTION > previous_tail
        if largest_tail <= tolerances.ORDERS_SETTLED or is_rounding:
            return cycle if is_resolved(followed_scene, cycle, reference_point) else None
        if count >= MAX_SAMPLES * followed_scene.turns:
            return None
        count, previous_tail = 2 * count, largest_tail


def is_resolved(followed_scene: FollowedScene, cycle: Cycle, reference_point: Array) -> bool:
    """Return whether the interpolant resolves the cycle where the run took short steps, and where laws in time require
    it.
    """
    run, n = followed_scene.followed_run, len(cycle.angles)
    x = np.union1d(run.find_short_steps(SHORT_STEP_FRACTION * run.length / n), run.find_time_law_places())
    if not len(x):
        return True
    exact = join_columns(compute_mass_effects(replace(cycle, states=followed_scene.compute_states(x)), reference_point))
    effects = compute_mass_effects(cycle, reference_point)
    columns = join_columns(effects)
    places = x if followed_scene.rate > 0.0 else run.length - x
    deviations = np.abs(cycle.nodes.interpolate(columns)(places) - exact)
    return bool(
        (
            deviations <= tolerances.CANCELS * make_scales(count_columns(columns), estimate_rounding(effects))(columns)
        ).all()
    )


def sample_on_pieces(followed_scene: FollowedScene, reference_point: Array) -> tuple[Cycle, bool]:
    """Return the cycle at the nodes of pieces between its breaks, and whether they resolve it."""
    run = followed_scene.followed_run

    def sample(x: Array) -> Array:
        """Compute the mass effects at places of the cycle."""
        cycle = Cycle(
            followed_scene.scene.mechanism,
            run.cycle,
            followed_scene.compute_states(x),
            followed_scene.scene.layout.size,
        )
        return join_columns(compute_mass_effects(cycle, reference_point))

    first_effects = compute_mass_effects(
        followed_scene.evaluate_cycle(followed_scene.make_even_nodes(FIRST_SAMPLES)), reference_point
    )
    resolver = CycleResolver(
        sample, run.cycle, make_scales(count_columns(join_columns(first_effects)), estimate_rounding(first_effects))
    )
    resolver.resolve(run.breaks)
    resolver.probe(
        np.union1d(
            run.find_short_steps(SHORT_STEP_FRACTION * run.length / SAMPLES_PER_TURN), run.find_time_law_places()
        )
    )
    resolved = resolver.collect_numbers()
    return followed_scene.evaluate_cycle(resolved.nodes), resolved.is_resolved


def join_columns(effects: MassEffects) -> Array:
    """Return force, both moments and torque of all bodies at unit rate, (n, columns)."""
    arrays = (effects.force, effects.orbital, effects.spin, effects.half_slope)
    return np.concatenate([x.reshape(len(x), -1) for x in arrays], axis=1)


def count_columns(columns: Array) -> list[int]:
    """Return the numbers of these columns that belong to force, moment and torque."""
    bodies = columns.shape[1] // 10
    return [3 * bodies, 6 * bodies, bodies]


def estimate_rounding(effects: MassEffects) -> list[float]:
    """Return the rounding level of force, moment and torque at unit rate."""
    return [tolerances.SUM_ROUNDING * effects.terms[name] for name in ("force", "moment", "torque")]


MAXIMUM_ONLY = (1.0,)


def compute_residuals(
    kinds: Mapping[str, Array], nodes: CycleNodes, thresholds: Mapping[str, float], noise: Mapping[str, float]
) -> dict[str, Residual]:
    """Return rms and peak of each kind's sum over the bodies, for values (n, bodies, c).

    thresholds: sums below are rounding, or within the error
    noise: errors of the values in addition to those at the nodes
    """
    sums = {name: values.sum(axis=1) for name, values in kinds.items()}
    residuals = compute_vector_magnitudes(sums, nodes)
    for name, values in kinds.items():
        largest = float(np.sqrt(np.sum(sums[name] ** 2, axis=1)).max())
        terms = float(np.sqrt(np.sum(values**2, axis=2)).sum(axis=1).max())
        if largest <= max(tolerances.CANCELS * terms, thresholds[name]):
            residuals[name] = Residual(0.0, 0.0, float(nodes.begin), max(largest, thresholds[name]))
        else:
            residuals[name] = replace(residuals[name], error=residuals[name].error + noise[name])
    return residuals


def compute_vector_magnitudes(kinds: Mapping[str, Array], nodes: CycleNodes) -> dict[str, Residual]:
    """Return rms and peak of the magnitudes of vectors (n, c) of several kinds."""
    values = np.concatenate([*kinds.values()], axis=1)
    interpolant, ends = nodes.interpolate(values), np.cumsum([vectors.shape[1] for vectors in kinds.values()])
    value_errors = nodes.estimate_errors(values).value
    slices = [slice(end - vectors.shape[1], end) for vectors, end in zip(kinds.values(), ends, strict=True)]
    errors = np.array([math.sqrt(float(np.sum(value_errors[part] ** 2))) for part in slices])

    def compute_squares(x: Array) -> Array:
        """Return the squared magnitude of each vector at places."""
        squared = interpolant(x) ** 2
        return np.stack([squared[:, part].sum(axis=1) for part in slices], axis=1)

    means = [float(nodes.weights @ np.sum(vectors**2, axis=1)) for vectors in kinds.values()]
    peaks = find_peaks(compute_squares, nodes, errors)
    return {
        name: Residual(math.sqrt(mean), peak, at, error)
        for name, mean, (peak, at), error in zip(kinds, means, peaks, errors.tolist(), strict=True)
    }


def compute_square_root_magnitudes(kinds: Mapping[str, Array], nodes: CycleNodes) -> dict[str, Residual]:
    """Return rms and peak of magnitudes whose squares are the values (n,); errors refer to the magnitudes."""
    values = np.stack([*kinds.values()], axis=1)
    value_errors, largest = nodes.estimate_errors(values).value, values.max(axis=0, initial=0.0)
    roots = np.sqrt(np.maximum(largest, value_errors))
    # error of the root from the error of the square
    errors = np.divide(value_errors, roots, out=np.zeros_like(value_errors), where=roots > 0.0)
    means = np.maximum(nodes.weights @ values, 0.0).tolist()
    peaks = find_peaks(nodes.interpolate(values), nodes, errors)
    return {
        name: Residual(math.sqrt(mean), peak, at, error)
        for name, mean, (peak, at), error in zip(kinds, means, peaks, errors.tolist(), strict=True)
    }


def find_peaks(squares: Interpolant, nodes: CycleNodes, errors: Array) -> list[tuple[float, float]]:
    """Return the peak of each magnitude from its squares, (n, m), and the angle of the peak; the first such angle for a
    constant one.
    """
    grid = nodes.grid
    grid_squares = squares(grid)

    def sample(x: Array) -> Array:
        """Return the squares at places; those of the grid are known."""
        return grid_squares if x is grid else squares(x)  # the search begins with the grid

    extremes = search_extremes(
        sample, grid, errors=errors, is_squared=np.ones(len(errors), dtype=bool), sides=MAXIMUM_ONLY
    )
    peaks = []
    for k, error in enumerate(errors.tolist()):
        peak = math.sqrt(max(float(extremes.high[k]), 0.0))
        equal_places = np.flatnonzero(np.sqrt(np.maximum(grid_squares[:, k], 0.0)) >= peak - error)
        peaks.append(
            (peak, nodes.compute_angle(float(grid[equal_places[0]] if len(equal_places) else extremes.high_at[k])))
        )
    return peaks


NO_NOISE: Mapping[str, float] = MappingProxyType({})
MOST_ROWS = 12


def make_results(
    spec: Spec,
    coordinate: str,
    rotation: CycleRotation,
    effects: MassEffects,
    reference_point: Array,
    options: BalanceOptions,
    noise: Mapping[str, float] = NO_NOISE,
) -> BalanceResults:
    """Return the results by orders of a coordinate at the cycle's rate.

    noise: errors of the quantities in addition to those at the nodes
    """
    scale, nodes = rotation.scale, effects.nodes
    thresholds = {name: max(x, noise.get(name, 0.0)) for name, x in compute_rounding(effects, scale).items()}
    selections = {name: OrderSelection(options.orders, noise.get(name, 0.0)) for name in thresholds}
    orders = make_all_rows(effects, rotation, thresholds, selections)
    summaries = {name: format_remaining_orders(rows, endless=nodes.last_order is None) for name, rows in orders.items()}
    if options.orders is not None:
        orders = {
            name: tuple(row for row in rows if is_requested(row.order, options.orders)) for name, rows in orders.items()
        }
    values = {
        "force": -scale * effects.force, "moment": -scale * effects.moment,
        "moment_orbital": -scale * effects.orbital, "moment_spin": -scale * effects.spin,
        "torque": scale * effects.half_slope[:, :, None],
    }  # fmt: skip
    sums = {name: total.sum(axis=1) for name, total in values.items()}
    kinds = {name: name.partition("_")[0] for name in values}
    errors = {name: nodes.estimate_errors(total) for name, total in sums.items()}
    extra_errors = {name: noise.get(kind, 0.0) for name, kind in kinds.items()}
    return BalanceResults(
        title=spec.title,
        spec={"path": spec.path, "sha256": spec.sha256},
        coordinate=coordinate,
        turns=rotation.turns,
        rate=rotation.rate,
        samples=len(effects.angles),
        is_resolved=True,
        reference_point=reference_point,
        place=options.place,
        axis=rotation.axis,
        effects=effects,
        orders=orders,
        summaries=summaries,
        mean={name: np.einsum("n,nc->c", nodes.weights, total) for name, total in sums.items()},
        mean_error={name: float(magnitudes(total.order)) + extra_errors[name] for name, total in errors.items()},
        residual=compute_residuals(
            values, nodes, {name: thresholds[kind] for name, kind in kinds.items()}, extra_errors
        ),
        shown_orders=select_shown_orders(orders) if options.orders is None else options.orders,
        are_orders_requested=options.orders is not None,
    )


def is_requested(order: float, orders: Sequence[float]) -> bool:
    """Return whether an order is among the requested ones."""
    return any(abs(order - one) < tolerances.SAME_VALUE for one in orders)


def select_shown_orders(orders: dict[str, tuple[OrderRow, ...]]) -> tuple[float, ...]:
    """Return the orders that a table shows: up to the last that is not small relative to the largest of its
    quantity.
    """
    last, shares = 0.0, dict[float, float]()
    for rows in orders.values():
        largest = max((row.size for row in rows), default=0.0)
        last = max([last, *(row.order for row in rows if row.size > tolerances.LISTED_ORDER * largest)])
        for row in rows:
            shares[row.order] = max(shares.get(row.order, 0.0), row.size / largest if largest > 0.0 else 0.0)
    nonzero = {row.order for rows in orders.values() for row in rows if row.size > 0.0}
    candidates = [order for order in sorted(shares) if order <= last and (order == round(order) or order in nonzero)]
    return select_largest([(order, shares[order]) for order in candidates], MOST_ROWS)


def select_largest(sizes: Sequence[tuple[float, float]], count: int) -> tuple[float, ...]:
    """Return the `count` largest orders, ascending; of equal ones the first."""
    chosen = sorted(sizes, key=lambda item: (-item[1], item[0]))[:count] if len(sizes) > count else sizes
    return tuple(sorted(order for order, _ in chosen))
