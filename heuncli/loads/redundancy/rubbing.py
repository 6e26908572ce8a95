"""Friction by what a joint carries, where redundant joints leave that open: refused, for nobody can tell it."""

from __future__ import annotations

import numpy as np

from heuncli.base.errors import SolveError
from heuncli.loads.kinetostatics.bodies import BodyStates, body_states
from heuncli.loads.kinetostatics.reactions import constrained_part
from heuncli.loads.redundancy.self_stress import SelfStress, self_stress
from heuncli.motion.integration.run.runner import Runner
from heuncli.multibody.mechanism.model import JointLoad, ThreadLoad
from heuncli.multibody.tree.layout import Layout
from heuncli.multibody.tree.prepare import PreparedScene
from heuncli.results.results import Array, Mask


def require_certain(layout: Layout, stress: SelfStress | None, states: BodyStates, times: Array) -> None:
    """Raise SolveError where a self-stress has a share in what presses, whether a stiffness splits it or not."""
    if stress is None or not stress.count.any():
        return
    rubbing = layout.mechanism.rubbing
    is_open = [open_in(layout, load, stress, states) for load in rubbing]
    at = np.flatnonzero(np.any(is_open, axis=0))
    if len(at):
        from heuncli.motion.integration.diagnosis.jamming import rubs_openly  # only on the way to an error

        loads = [load for load, mask in zip(rubbing, is_open, strict=True) if mask[at[0]]]
        raise SolveError(rubs_openly(layout.mechanism, loads, float(times[at[0]])))


def require_certain_start(scene: PreparedScene, runner: Runner, t: float) -> None:
    """Raise SolveError for what is open so at the start."""
    at = runner.recovered(np.array([t]), scene.layout.y0[None, :])
    states = body_states(scene.layout, at)
    require_certain(scene.layout, self_stress(runner, at, states), states, at.times)


def open_in(layout: Layout, load: JointLoad | ThreadLoad, stress: SelfStress, states: BodyStates) -> Mask:
    """Whether what presses is open, (n_t,): of a joint its force, of two ends what tilts it, of a thread its own."""
    mechanism = layout.mechanism
    if isinstance(load, ThreadLoad):
        row = layout.rows.index(len(mechanism.joints) + load.coupling)
        return np.asarray(stress.reaches(stress.multipliers[:, [row]]).any(axis=1))
    shares = np.moveaxis(stress.shares[load.joint], 2, 0)
    force, moment = constrained_part(mechanism.joints[load.joint], states, shares[..., :3], shares[..., 3:])
    found = stress.reaches(np.moveaxis(force, 0, 2)).any(axis=-1)
    if load.presses == "ends":
        found = found | stress.reaches(np.moveaxis(moment, 0, 2), stress.length).any(axis=-1)
    return np.asarray(found)
