"""Orders of the torque k that loads and weight exert on the shaft of a cycle: their power divided by the rate of the
angle.

The gas force of a four-stroke engine has half orders. The scene is solved at the cycle's rate, as loads may depend on
it.
"""

from __future__ import annotations

import numpy as np

from heuncli.analyses.balancing.cycle_plan import CyclePlan
from heuncli.analyses.balancing.loaded_scene import CycleNumbers, LoadedScene, make_loaded_scene
from heuncli.analyses.balancing.order_rows import CycleRotation, magnitudes, make_order_rows
from heuncli.analyses.balancing.order_selection import MAX_ORDERS, OrderSelection, bound_higher_orders
from heuncli.analyses.balancing.results import OrderRow
from heuncli.base.errors import SolveError
from heuncli.base.records import record
from heuncli.base.tolerances import ORDERS_SETTLED, SUM_ROUNDING
from heuncli.loads.kinetostatics.energy import rope_power
from heuncli.multibody.mechanism.model import GROUND
from heuncli.multibody.tree.prepare import PreparedScene
from heuncli.results.results import Array
from heuncli.scene.file_format.models import Spec
from heuncli.study.compose.recovery import Recovery


@record
class LoadTorque:
    """Orders of the load torque, its mean [N m] and the error of the mean.

    notes: results that are missing, and why
    """

    rows: tuple[OrderRow, ...] = ()
    mean: float = 0.0
    error: float = 0.0
    notes: tuple[str, ...] = ()


def compute_load_torque(
    spec: Spec, scene: PreparedScene, plan: CyclePlan, requested_orders: tuple[float, ...] | None
) -> LoadTorque:
    """Compute the torque of loads and weight over a cycle; empty if the scene has none, or if loads depend on time.

    requested_orders: orders listed in addition to the significant ones
    """
    mechanism = scene.mechanism
    if not mechanism.loads and not mechanism.gravity.any():
        return LoadTorque()
    time_loads = [load.path for load in mechanism.loads if any(value.time_dependent for value in load.values)]
    if time_loads:
        return LoadTorque(notes=(f"no orders of the loads: {time_loads[0]} depends on t",))
    rate = plan.rate or 1.0
    try:
        powers = compute_load_powers(make_loaded_scene(spec, scene, mechanism, plan, rate))
    except SolveError as error:
        return LoadTorque(notes=(f"no orders of the loads: {error.problems[0].message}",))
    nodes, values = powers.nodes, powers.values[:, :, None] / rate
    total = values.sum(axis=1)
    threshold = ORDERS_SETTLED * float(np.abs(values).max())
    turning = CycleRotation(plan.turns, None, plan.rate)
    rows = make_order_rows(values, nodes, turning, threshold, selection=OrderSelection(requested_orders))
    mean, mean_error = float(nodes.weights @ total[:, 0]), float(magnitudes(nodes.estimate_errors(total).order))
    notes = powers.notes
    last_order = max((row.order for row in rows), default=0.0) if requested_orders is None else 0.0
    if last_order >= MAX_ORDERS:
        order_bound = bound_higher_orders(nodes, total, last_order)
        notes += (
            f"orders of the loads above {last_order:g} are not listed, each at most {order_bound:.2g} N·m: "
            "set --orders",
        )
    return LoadTorque(rows, mean, mean_error, notes)


def compute_load_powers(scene: LoadedScene) -> CycleNumbers:
    """Compute the power of each load, and of the weight, over the cycle (n, loads + 1) [W]."""
    recovery = scene.recover_samples()
    return scene.resolve_numbers(
        sum_load_powers, [sum_load_powers(recovery).shape[1]], [estimate_power_rounding(recovery)]
    )


def estimate_power_rounding(recovery: Recovery) -> float:
    """Estimate the rounding of these powers from the largest power of the loads at the speeds of their points [W]."""
    mechanism, states = recovery.setup.scene.mechanism, recovery.states
    masses = np.array([body.mass for body in mechanism.bodies])
    weights = masses * float(magnitudes(mechanism.gravity))
    largest_power = float((magnitudes(states.v_centre) @ weights).max())
    for load in recovery.loads:
        for end, force, moment in load.action.iter_ends():
            if end.body != GROUND:
                speed, turning = (
                    magnitudes(states.point_velocity(end.body, end.position)),
                    magnitudes(states.omega[:, end.body]),
                )
                largest_power += float((magnitudes(force) * speed + magnitudes(moment) * turning).max())
    return SUM_ROUNDING * largest_power


def sum_load_powers(recovery: Recovery) -> Array:
    """Return the power of each load, and of the weight, at several instants, (n, loads + 1) [W]."""
    mechanism = recovery.setup.scene.mechanism
    masses = np.array([body.mass for body in mechanism.bodies])
    weight = np.einsum("n,tni,i->t", masses, recovery.states.v_centre, mechanism.gravity)
    ropes = [rope_power(recovery.states, own) for own in recovery.couplings if own.coupling.stretched_row is not None]
    return np.stack([*(load.power for load in recovery.loads), *ropes, weight], axis=1)
