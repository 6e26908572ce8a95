"""The terms of d'Alembert's balances at each instant: what loads are summed from, and the rounding of the sums."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from functools import cached_property

import numpy as np

from heuncli.base import tolerances
from heuncli.loads.kinetostatics.actions import AppliedLoad
from heuncli.loads.kinetostatics.bodies import BodyStates
from heuncli.loads.kinetostatics.foundation import inertia_rows
from heuncli.motion.integration.evaluator import Evaluation
from heuncli.multibody.mechanism.model import RopeLoad
from heuncli.results.results import Array
from heuncli.scene.shapes.rotations import instants_first, instants_last, largest_magnitude, squared_lengths
from heuncli.study.model.setup import Setup


def estimate_load_rounding(recovered: Evaluation, force: Array, moment: Array, size: float) -> tuple[Array, Array]:
    """Estimate the rounding of forces [N] and moments [N m] at each instant, (c n,); force, moment: their largest
    terms.

    It is that of sums of some dozen terms, plus the kernel's estimate of the rounding of each multiplier: near a
    singular pose the closures amplify it (kernel/orthogonal.py).
    """
    rows = recovered.rows
    by_force = (rows["doubt"] * np.abs(rows["f"]).max(axis=2)).max(axis=1, initial=0.0)
    by_moment = (rows["doubt"] * np.abs(rows["m"]).max(axis=2)).max(axis=1, initial=0.0)
    F = tolerances.SUM_ROUNDING * force + by_force + by_moment / size
    return F, tolerances.SUM_ROUNDING * moment + by_moment + size * by_force


class BalanceTerms:
    """The terms of the balances: inertia loads, weights, and the largest of all at each instant (c n,).

    by_component: the inertia loads, force and moment, (b, 3, c n)
    force: [N]
    moment: [N m], including that of forces with the reach of the scene as arm
    rounding: of the loads, absolute
    """

    def __init__(self, setup: Setup, recovered: Evaluation, states: BodyStates, loads: Sequence[AppliedLoad]) -> None:
        mechanism, size = setup.scene.mechanism, setup.scene.layout.size
        ma, spin = self.by_component = inertia_rows(mechanism, states)
        self.weight = np.array([b.mass for b in mechanism.bodies])[:, None] * mechanism.gravity
        row_forces = recovered.rows["multiplier"][..., None] * recovered.rows["f"]
        applied = [load.action for load in loads]
        pulls = [
            recovered.loads["value"][:, own] for load, own in mechanism.iter_load_rows() if isinstance(load, RopeLoad)
        ]
        # a free spin is a balance of terms, too: m x_s.. and I sigma. + sigma x I sigma vanish there
        layout, bodies = setup.scene.layout, mechanism.bodies
        angular_motion = np.abs(states.component_rows("alpha")).max(axis=1) + squared_lengths(
            states.component_rows("omega")
        )
        arms = [b.center - layout.reference[layout.place[i]] for i, b in enumerate(bodies)]
        offset = np.array([[b.mass * float(np.abs(arm).max())] for b, arm in zip(bodies, arms, strict=True)])
        gyration = np.array([[float(np.trace(b.inertia))] for b in bodies])
        joint_force, joint_moment = (instants_last(recovered.bodies[name]) for name in ("joint_force", "joint_moment"))
        forces = [
            ma,
            angular_motion * offset,
            joint_force,
            instants_last(row_forces),
            *(instants_last(x.force) for x in applied),
            *(x.T for x in pulls),
        ]
        moments = [spin, angular_motion * gyration, joint_moment, *(instants_last(x.moment) for x in applied)]
        self.force = np.maximum(_largest_at_each_instant(forces), np.abs(self.weight).max(initial=0.0))
        self.moment = np.maximum(_largest_at_each_instant(moments), size * self.force)
        self.rounding = estimate_load_rounding(recovered, self.force, self.moment, size)

    @cached_property
    def ma(self) -> Array:
        """m x_s.. of the bodies, (c n, b, 3) [N]."""
        return instants_first(self.by_component[0])

    @cached_property
    def spin(self) -> Array:
        """I sigma. + sigma x I sigma, (c n, b, 3) [N m]."""
        return instants_first(self.by_component[1])


def _largest_at_each_instant(values: Iterable[Array]) -> Array:
    """The largest of all values at each instant, (c n,); each (..., c n)."""
    return np.asarray(np.max([largest_magnitude(x) for x in values], axis=0))
