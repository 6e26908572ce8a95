"""A scene followed along its cycle once, and answered at any place of it: nothing is integrated.

A place x runs from 0 to the cycle's length [rad], in the order of the run: the angle is begin + x, or begin - x where
the run turns backwards. Known of a run are the places at which something jumps or bends: changes of branches, which the
kernel decides by bounds, and what laws do in time.
"""

from __future__ import annotations

import math
from functools import cached_property

import numpy as np

from heuncli.analyses.balancing.nodes import PieceNodes
from heuncli.analyses.balancing.resolved import of_a_cycle
from heuncli.base import tolerances
from heuncli.base.records import record
from heuncli.motion.integration.check.estimate import recovered_at
from heuncli.motion.integration.evaluator import Recovered
from heuncli.motion.integration.methods.followed import FOLLOWED
from heuncli.motion.integration.run.request import MotionTask
from heuncli.motion.integration.run.runner import Runner
from heuncli.motion.integration.segments import discontinuities_of
from heuncli.motion.integration.trajectory import Trajectory
from heuncli.multibody.tree.layout import Layout
from heuncli.results.results import Array
from heuncli.study.search.in_time import close_to

LOCAL = 1e-9  # tolerance of a step that is followed: its instants are solved to rounding whatever it is
SAMPLES = 64  # even angles of a turn
MOST_IN_TIME = 100_000  # instants at which what is given in time is looked at


@record
class FollowedRun:
    """A run of a scene along a cycle of so many turns from an angle [rad] on, at a rate [rad/s]."""

    layout: Layout
    runner: Runner
    begin: float
    rate: float
    turns: int

    @property
    def length(self) -> float:
        """That of the cycle [rad]."""
        return 2.0 * math.pi * self.turns

    @property
    def last(self) -> float:
        """The instant of its end [s]."""
        return self.length / abs(self.rate)

    @cached_property
    def jumps(self) -> tuple[float, ...]:
        """The instants at which what is given in time jumps or bends."""
        return tuple(discontinuities_of(self.layout.mechanism, self.last))

    def trajectory(self, times: Array, also: Array | None = None) -> Trajectory:
        """The run, answered at some instants (n,), ascending; also (m,): further ones at which steps are to end."""
        ends = self.jumps if also is None else tuple(np.unique(np.append(also, self.jumps)).tolist())
        return self.runner.trajectory(MotionTask(times, LOCAL, FOLLOWED, ends))

    @cached_property
    def run(self) -> Trajectory:
        """The run, answered at even places with both ends."""
        count = SAMPLES * self.turns
        return self.trajectory(np.arange(count + 1) / count * self.length / abs(self.rate))

    def recovered(self, x: Array) -> Recovered:
        """The kernel's answers at places (n,), ascending."""
        times = np.minimum(x / abs(self.rate), self.last)
        jumps = sorted({*self.jumps, *self.run.jumps})
        return recovered_at(self.runner, self.run, times, self.runner.resample(self.run, times), jumps)

    @property
    def cycle(self) -> PieceNodes:
        """The cycle without pieces yet."""
        return of_a_cycle(self.begin, self.turns, math.copysign(1.0, self.rate))

    @cached_property
    def breaks(self) -> Array:
        """The places at which something jumps or bends, (n,)."""
        own = np.array(sorted({*self.jumps, *self.run.jumps}))
        return own * abs(self.rate)

    def is_smooth(self) -> bool:
        """Whether nothing is known to jump or bend."""
        return not len(self.breaks)

    def short_steps(self, length: float) -> Array:
        """The places (n,) between which the run took steps that are shorter than that [rad]."""
        ends = self.run.ends * abs(self.rate)
        steps = np.diff(np.append(0.0, ends))
        short = steps < length
        return np.unique(np.concatenate([ends[short], (ends - steps)[short], (ends - 0.5 * steps)[short]]))

    def given_in_time(self) -> Array:
        """The places (n,) at which what is given in time has to be looked at."""
        grid, _ = close_to(self.layout.mechanism, np.array([0.0, self.last]), MOST_IN_TIME)
        return np.asarray(grid[1:-1] * abs(self.rate))

    def looked_at(self, nodes: PieceNodes) -> Array:
        """The places (n,) at which steps end that begin with the pieces and do not end with them.

        A step sees loads at its ends and in its middle; where bounds allow more it is shortened to there.
        """
        ends = self.trajectory(np.array([0.0, self.last]), nodes.begins[1:] / abs(self.rate)).ends * abs(self.rate)
        k = np.clip(np.searchsorted(nodes.begins, ends), 0, len(nodes.begins) - 1)
        known = np.append(nodes.begins, self.length)
        near = np.minimum(np.abs(ends - known[k]), np.abs(ends - known[np.minimum(k + 1, len(known) - 1)]))
        return np.asarray(ends[near > tolerances.SIDE_BY_SIDE * self.length])
