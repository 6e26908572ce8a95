"""Refuse load-dependent joint friction where redundant joints leave the load indeterminate."""

from __future__ import annotations

import numpy as np

from heuncli.base.errors import SolveError
from heuncli.loads.kinetostatics.bodies import BodyStates, make_body_states
from heuncli.loads.kinetostatics.reactions import remove_free_components
from heuncli.loads.redundancy.self_stress import SelfStress, find_self_stress
from heuncli.motion.integration.run.runner import Runner
from heuncli.multibody.mechanism.model import JointLoad, ThreadLoad
from heuncli.multibody.tree.layout import Layout
from heuncli.multibody.tree.prepare import PreparedScene
from heuncli.results.results import Array, Mask


def require_determinate_friction(layout: Layout, stress: SelfStress | None, states: BodyStates, times: Array) -> None:
    """Raise SolveError where a self-stress has a share in the load that causes friction, even if a stiffness splits
    it.
    """
    if stress is None or not stress.count.any():
        return
    friction_loads = layout.mechanism.joint_friction
    is_open = [is_pressure_indeterminate(layout, load, stress, states) for load in friction_loads]
    instants = np.flatnonzero(np.any(is_open, axis=0))
    if len(instants):
        # only on the way to an error
        from heuncli.motion.integration.diagnosis.ambiguous_laws import indeterminate_friction_problem

        loads = [load for load, mask in zip(friction_loads, is_open, strict=True) if mask[instants[0]]]
        raise SolveError(indeterminate_friction_problem(layout.mechanism, loads, float(times[instants[0]])))


def require_determinate_friction_at_start(scene: PreparedScene, runner: Runner, t: float) -> None:
    """Raise SolveError for indeterminate friction at the start."""
    evaluation = runner.evaluate(np.array([t]), scene.layout.y0[None, :])
    states = make_body_states(scene.layout, evaluation)
    require_determinate_friction(scene.layout, find_self_stress(runner, evaluation, states), states, evaluation.times)


def is_pressure_indeterminate(
    layout: Layout, load: JointLoad | ThreadLoad, stress: SelfStress, states: BodyStates
) -> Mask:
    """Return whether the pressure is indeterminate, (n_t,): a joint's force, with two ends its tilting moment, a
    thread's force.
    """
    mechanism = layout.mechanism
    if isinstance(load, ThreadLoad):
        row = layout.rows.index(len(mechanism.joints) + load.coupling)
        return np.asarray(stress.has_share(stress.multipliers[:, [row]]).any(axis=1))
    shares = np.moveaxis(stress.shares[load.joint], 2, 0)
    force, moment = remove_free_components(mechanism.joints[load.joint], states, shares[..., :3], shares[..., 3:])
    result = stress.has_share(np.moveaxis(force, 0, 2)).any(axis=-1)
    if load.presses == "ends":
        result = result | stress.has_share(np.moveaxis(moment, 0, 2), stress.length).any(axis=-1)
    return np.asarray(result)
