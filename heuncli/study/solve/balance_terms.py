"""The terms of d'Alembert's balances at each instant: what loads are summed from, and the rounding of the sums."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from functools import cached_property

import numpy as np

from heuncli.base import tolerances
from heuncli.loads.kinetostatics.actions import AppliedLoad
from heuncli.loads.kinetostatics.bodies import BodyStates
from heuncli.loads.kinetostatics.foundation import inertia_rows
from heuncli.motion.integration.evaluator import Recovered
from heuncli.multibody.mechanism.model import RopeLoad
from heuncli.results.results import Array
from heuncli.scene.shapes.by_component import instants_first, largest, rows, squares
from heuncli.study.model.setup import Setup


def rounding_of_loads(several: Recovered, force: Array, moment: Array, size: float) -> tuple[Array, Array]:
    """What rounding makes of forces [N] and moments [N m] at each instant, (c n,); force, moment: their largest terms.

    That of sums of some dozen terms, and beside it what the kernel finds that rounding may make of each multiplier:
    near a singular pose the closures amplify it (kernel/orthogonal.py).
    """
    rows = several.rows
    by_force = (rows["doubt"] * np.abs(rows["f"]).max(axis=2)).max(axis=1, initial=0.0)
    by_moment = (rows["doubt"] * np.abs(rows["m"]).max(axis=2)).max(axis=1, initial=0.0)
    F = tolerances.SUM_ROUNDING * force + by_force + by_moment / size
    return F, tolerances.SUM_ROUNDING * moment + by_moment + size * by_force


class BalanceTerms:
    """The terms of the balances: inertia loads, weights, and the largest of all at each instant (c n,).

    by_component: the inertia loads, force and moment, (b, 3, c n).

    force [N]; moment [N m], those of forces over the reach of the scene among them; rounding: of the loads, relative.
    """

    def __init__(self, setup: Setup, several: Recovered, states: BodyStates, loads: Sequence[AppliedLoad]) -> None:
        mechanism, size = setup.scene.mechanism, setup.scene.layout.size
        ma, spin = self.by_component = inertia_rows(mechanism, states)
        self.weight = np.array([b.mass for b in mechanism.bodies])[:, None] * mechanism.gravity
        of_rows = several.rows["multiplier"][..., None] * several.rows["f"]
        applied = [load.action for load in loads]
        pulls = [several.loads["value"][:, own] for load, own in mechanism.load_rows() if isinstance(load, RopeLoad)]
        # what spins freely is a balance of terms, too: m x_s.. and I sigma. + sigma x I sigma vanish there
        layout, bodies = setup.scene.layout, mechanism.bodies
        turning = np.abs(states.rows_of("alpha")).max(axis=1) + squares(states.rows_of("omega"))
        arms = [b.center - layout.reference[layout.place[i]] for i, b in enumerate(bodies)]
        offset = np.array([[b.mass * float(np.abs(arm).max())] for b, arm in zip(bodies, arms, strict=True)])
        gyration = np.array([[float(np.trace(b.inertia))] for b in bodies])
        joint_force, joint_moment = (rows(several.bodies[name]) for name in ("joint_force", "joint_moment"))
        forces = [
            ma,
            turning * offset,
            joint_force,
            rows(of_rows),
            *(rows(x.force) for x in applied),
            *(x.T for x in pulls),
        ]
        moments = [spin, turning * gyration, joint_moment, *(rows(x.moment) for x in applied)]
        self.force = np.maximum(_at_each(forces), np.abs(self.weight).max(initial=0.0))
        self.moment = np.maximum(_at_each(moments), size * self.force)
        self.rounding = rounding_of_loads(several, self.force, self.moment, size)

    @cached_property
    def ma(self) -> Array:
        """m x_s.. of the bodies, (c n, b, 3) [N]."""
        return instants_first(self.by_component[0])

    @cached_property
    def spin(self) -> Array:
        """I sigma. + sigma x I sigma, (c n, b, 3) [N m]."""
        return instants_first(self.by_component[1])


def _at_each(values: Iterable[Array]) -> Array:
    """The largest of all values at each instant, (c n,); each (..., c n)."""
    return np.asarray(np.max([largest(x) for x in values], axis=0))
