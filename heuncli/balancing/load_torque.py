"""What loads and weight put on the shaft of a cycle by orders: the torque k, their power by the rate of the angle.

A four-stroke's gas has half orders. It is solved at the cycle's rate, as loads may hang on it.
"""

from __future__ import annotations

import numpy as np

from heuncli.balancing.choice import CyclePlan
from heuncli.balancing.cost import LoadedCycle, loaded
from heuncli.balancing.results import OrderRow
from heuncli.balancing.rows import CycleTurning, order_rows
from heuncli.errors import SolveError
from heuncli.kinetostatics.energy import power_of_rope
from heuncli.mechanism.model import Mechanism, path_of_load
from heuncli.records import record
from heuncli.results import Array
from heuncli.spec.models import Spec
from heuncli.tolerances import ORDERS_SETTLED
from heuncli.tree.prepare import PreparedScene

SAMPLES = 720  # of a turn: halves of a degree; of laws with kinks orders err by what lies beyond
HIGHEST = 24.0  # order that is told; of laws with kinks there is no last one


@record
class LoadTorque:
    """The orders of what loads put on the shaft, and their mean [N m]; note: why there are none, else empty."""

    rows: tuple[OrderRow, ...] = ()
    mean: float = 0.0
    note: str = ""


def load_torque(spec: Spec, scene: PreparedScene, plan: CyclePlan) -> LoadTorque:
    """The torque of loads and weight over a cycle; none of a scene that has none, or whose loads depend on the time."""
    mechanism = scene.mechanism
    if not mechanism.loads and not mechanism.gravity.any():
        return LoadTorque()
    told = [path_of_load(load) for load in mechanism.loads if any(value.time_dependent for value in load.values)]
    if told:
        return LoadTorque(note=f"orders of the loads are not told: {told[0]} depends on t")
    rate = plan.rate or 1.0
    try:
        cycle = loaded(spec, scene, mechanism, plan, rate, SAMPLES * plan.turns)
        values = torques(cycle, mechanism) / rate
    except SolveError as error:
        return LoadTorque(note=f"orders of the loads are not told: {error.problems[0].message}")
    if rate < 0.0:
        values = values[(-np.arange(len(values))) % len(values)]
    least = ORDERS_SETTLED * float(np.abs(values).max())
    rows = order_rows(values[:, :, None], cycle.angles, CycleTurning(plan.turns, None, plan.rate), least)
    return LoadTorque(tuple(row for row in rows if row.order <= HIGHEST), float(values.sum(axis=1).mean()))


def torques(cycle: LoadedCycle, mechanism: Mechanism) -> Array:
    """The power of each load, and of the weight, (n, loads + 1) [W]."""
    masses = np.array([body.mass for body in mechanism.bodies])
    weight = np.einsum("n,tni,i->t", masses, cycle.states.v_centre, mechanism.gravity)
    recovery = cycle.recovery
    ropes = [power_of_rope(cycle.states, own) for own in recovery.couplings if own.coupling.stretched is not None]
    return np.stack([*(load.power for load in recovery.loads), *ropes, weight], axis=1)
