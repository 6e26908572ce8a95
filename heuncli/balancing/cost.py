"""What counterweights cost: the scene really solved at the cycle's rate, with its loads, before and after.

Of force and moment on the foundation, of the drive, and of every joint (across its axis, if it has one) the root of the
mean square over the cycle and the largest. What redundant joints leave open is told as open (None).
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence

import numpy as np

from heuncli.balancing.choice import CyclePlan
from heuncli.balancing.cycle import LOCAL, driven_mechanism, require_determined, still
from heuncli.balancing.results import OverCycle
from heuncli.integration.methods.followed import FOLLOWED
from heuncli.integration.run.request import MotionTask
from heuncli.integration.run.runner import ready
from heuncli.kinetostatics.bodies import BodyStates
from heuncli.kinetostatics.foundation import inertia_loads
from heuncli.mechanism.model import Mechanism
from heuncli.records import record
from heuncli.redundancy.count import redundancy
from heuncli.results import Array
from heuncli.shapes.rotations import cross_rows
from heuncli.spec.models import Spec
from heuncli.study.compose.blocks import blocks
from heuncli.study.compose.recovery import Recovery
from heuncli.study.model.model_note import model_note
from heuncli.study.model.setup import Setup, reduced_runner
from heuncli.tree.prepare import PreparedScene, arranged


@record
class LoadedCycle:
    """A scene solved with its loads at equal angles (n,) [rad] over the cycle, the last one left out."""

    setup: Setup
    recovery: Recovery
    angles: Array

    @property
    def states(self) -> BodyStates:
        """Where the bodies are, and how they move."""
        return self.recovery.states


def loaded(
    spec: Spec, scene: PreparedScene, mechanism: Mechanism, plan: CyclePlan, rate: float, count: int
) -> LoadedCycle:
    """A mechanism in the scene's place, with its loads, at equal angles of a cycle."""
    driven = arranged(driven_mechanism(mechanism, plan, rate, loaded=True), still(scene))
    own, runner = ready(driven)
    reduced, runner = reduced_runner(own, runner)
    require_determined(runner, plan)
    angles = np.arange(count) / count * 2.0 * math.pi * plan.turns
    times = angles / abs(rate)
    run = runner.trajectory(MotionTask(times, LOCAL, FOLLOWED, ()))
    recovered = runner.recovered(times, run.states)
    note = model_note(own, runner, FOLLOWED.name, redundancy(own, runner))
    setup = Setup(spec, own, (), runner, FOLLOWED, note, reduced)
    return LoadedCycle(setup, Recovery(setup, recovered, False), plan.begin + angles)


def loads_of(cycle: LoadedCycle, plan: CyclePlan, about: Array) -> dict[str, OverCycle]:
    """Force, moment, drive and joints by their names, over the cycle."""
    mechanism, states = cycle.setup.scene.mechanism, cycle.states
    ma, spin = inertia_loads(mechanism, states)
    moment = -(cross_rows(states.centre - about, ma) + spin).sum(axis=1)
    if mechanism.planar:
        moment = moment * np.array([0.0, 0.0, 1.0])
    found = {"force": spread(-ma.sum(axis=1)), "moment": spread(moment)}
    joints: Mapping[str, Mapping[str, Array]] = blocks(cycle.recovery, frozenset({"joints"}))["joints"]
    found["drive"] = spread(joints[plan.joint]["drive"][:, None])
    for name, own in joints.items():
        values = own["radial"][:, None] if "radial" in own else own["force"]
        found[f"joints.{name}"] = spread(values)
    return found


def spread(values: Array) -> OverCycle:
    """Root of the mean square and largest magnitude of vectors (n, c); None where some of it is open."""
    sizes = np.sqrt(np.sum(values**2, axis=1))
    if np.isnan(sizes).any():
        return OverCycle(None, None)
    return OverCycle(float(np.sqrt(np.mean(sizes**2))), float(sizes.max()))


def cost(
    spec: Spec, scene: PreparedScene, heavier: Mechanism, plan: CyclePlan, about: Array, count: int
) -> tuple[dict[str, OverCycle], dict[str, OverCycle]]:
    """The loads before and after; heavier: with the weights."""
    rate = plan.rate or 1.0
    two: Sequence[Mechanism] = (scene.mechanism, heavier)
    before, after = (loads_of(loaded(spec, scene, own, plan, rate, count), plan, about) for own in two)
    return before, after
