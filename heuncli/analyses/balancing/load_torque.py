"""What loads and weight put on the shaft of a cycle by orders: the torque k, their power by the rate of the angle.

A four-stroke's gas has half orders. It is solved at the cycle's rate, as loads may hang on it.
"""

from __future__ import annotations

import numpy as np

from heuncli.analyses.balancing.choice import CyclePlan
from heuncli.analyses.balancing.loaded import CycleNumbers, LoadedScene, loaded
from heuncli.analyses.balancing.results import OrderRow
from heuncli.analyses.balancing.rows import CycleTurning, lengths, order_rows
from heuncli.analyses.balancing.wanted import MOST_ORDERS, WantedOrders, left_beyond
from heuncli.base.errors import SolveError
from heuncli.base.records import record
from heuncli.base.tolerances import ORDERS_SETTLED, SUM_ROUNDING
from heuncli.loads.kinetostatics.energy import power_of_rope
from heuncli.multibody.mechanism.model import GROUND, path_of_load
from heuncli.multibody.tree.prepare import PreparedScene
from heuncli.results.results import Array
from heuncli.scene.file_format.models import Spec
from heuncli.study.compose.recovery import Recovery


@record
class LoadTorque:
    """The orders of what loads put on the shaft, their mean [N m] and its error; notes: what is not told, and why."""

    rows: tuple[OrderRow, ...] = ()
    mean: float = 0.0
    error: float = 0.0
    notes: tuple[str, ...] = ()


def load_torque(spec: Spec, scene: PreparedScene, plan: CyclePlan, asked: tuple[float, ...] | None) -> LoadTorque:
    """The torque of loads and weight over a cycle; none of a scene that has none, or whose loads depend on the time.

    asked: orders that are asked for, beside those that count.
    """
    mechanism = scene.mechanism
    if not mechanism.loads and not mechanism.gravity.any():
        return LoadTorque()
    told = [path_of_load(load) for load in mechanism.loads if any(value.time_dependent for value in load.values)]
    if told:
        return LoadTorque(notes=(f"orders of the loads are not told: {told[0]} depends on t",))
    rate = plan.rate or 1.0
    try:
        found = torques_of(loaded(spec, scene, mechanism, plan, rate))
    except SolveError as error:
        return LoadTorque(notes=(f"orders of the loads are not told: {error.problems[0].message}",))
    nodes, values = found.nodes, found.values[:, :, None] / rate
    whole = values.sum(axis=1)
    least = ORDERS_SETTLED * float(np.abs(values).max())
    turning = CycleTurning(plan.turns, None, plan.rate)
    rows = order_rows(values, nodes, turning, least, wanted=WantedOrders(asked))
    mean, off = float(nodes.weights @ whole[:, 0]), float(lengths(nodes.errors(whole).order))
    notes = found.notes
    last = max((row.order for row in rows), default=0.0) if asked is None else 0.0
    if last >= MOST_ORDERS:
        most = left_beyond(nodes, whole, last)
        notes += (f"orders of the loads beyond {last:g} are not listed, each of {most:.2g} N·m at most: --orders",)
    return LoadTorque(rows, mean, off, notes)


def torques_of(scene: LoadedScene) -> CycleNumbers:
    """The power of each load, and of the weight, over the cycle (n, loads + 1) [W]."""
    first = scene.at_first()
    return scene.numbers(torques, [torques(first).shape[1]], [rounding_in(first)])


def rounding_in(recovery: Recovery) -> float:
    """What of these powers is rounding: of what loads could do at most at the speeds of their points [W]."""
    mechanism, states = recovery.setup.scene.mechanism, recovery.states
    masses = np.array([body.mass for body in mechanism.bodies])
    weights = masses * float(lengths(mechanism.gravity))
    most = float((lengths(states.v_centre) @ weights).max())
    for load in recovery.loads:
        for end, force, moment in load.action.on_bodies():
            if end.body != GROUND:
                speed, turning = lengths(states.velocity(end.body, end.position)), lengths(states.omega[:, end.body])
                most += float((lengths(force) * speed + lengths(moment) * turning).max())
    return SUM_ROUNDING * most


def torques(recovery: Recovery) -> Array:
    """The power of each load, and of the weight, at some instants, (n, loads + 1) [W]."""
    mechanism = recovery.setup.scene.mechanism
    masses = np.array([body.mass for body in mechanism.bodies])
    weight = np.einsum("n,tni,i->t", masses, recovery.states.v_centre, mechanism.gravity)
    ropes = [power_of_rope(recovery.states, own) for own in recovery.couplings if own.coupling.stretched is not None]
    return np.stack([*(load.power for load in recovery.loads), *ropes, weight], axis=1)
