"""Follow a scene along its cycle once, evaluate it at any place, and check whether its loads repeat with the cycle.

A place x runs from 0 to the cycle's length [rad] in the order of the run: the angle is begin + x, or begin - x if the
run turns backwards. The run knows the places of jumps and kinks: changes of branches, which the kernel finds by bounds,
and discontinuities of laws in time.
"""

from __future__ import annotations

import math
from functools import cached_property

import numpy as np

from heuncli.analyses.balancing.cycle_nodes import PieceNodes
from heuncli.analyses.balancing.piece_resolver import make_empty_nodes
from heuncli.base import tolerances
from heuncli.base.records import record
from heuncli.loads.kinetostatics.bodies import make_body_states
from heuncli.loads.kinetostatics.coordinates import evaluate_joint_coordinates
from heuncli.motion.integration.check.estimate import evaluate_run
from heuncli.motion.integration.diagnosis.domains import evaluate_coordinates
from heuncli.motion.integration.diagnosis.guide_departures import Moving
from heuncli.motion.integration.evaluator import Evaluation
from heuncli.motion.integration.integrated_scene import find_discontinuities
from heuncli.motion.integration.methods.method import DRIVE_DETERMINED
from heuncli.motion.integration.run.request import MotionTask
from heuncli.motion.integration.run.runner import Runner
from heuncli.motion.integration.trajectory import Trajectory
from heuncli.multibody.mechanism.loads import JointLoad, Load
from heuncli.multibody.tree.layout import Layout
from heuncli.results.results import Array, Block
from heuncli.scene.expressions.programs import Expression
from heuncli.study.search.law_instants import refine_for_time_laws

STEP_TOLERANCE = 1e-9  # step tolerance; without effect, as every instant is solved to rounding
SAMPLES_PER_TURN = 64  # even angles of a turn
MAX_TIME_SAMPLES = 100_000  # instants at which functions of time are sampled


@record
class FollowedRun:
    """A run of a scene over a number of turns from an angle [rad] on, at a constant rate [rad/s]."""

    layout: Layout
    runner: Runner
    begin: float
    rate: float
    turns: int

    @property
    def length(self) -> float:
        """Length of the cycle [rad]."""
        return 2.0 * math.pi * self.turns

    @property
    def end_time(self) -> float:
        """Time at the end of the run [s]."""
        return self.length / abs(self.rate)

    @cached_property
    def jumps(self) -> tuple[float, ...]:
        """Times of the jumps and kinks of functions of time."""
        return tuple(find_discontinuities(self.layout.mechanism, self.end_time))

    def compute_trajectory(self, times: Array, step_ends: Array | None = None) -> Trajectory:
        """Return the run, evaluated at ascending times (n,).

        step_ends (m,): further times at which steps must end
        """
        ends = self.jumps if step_ends is None else tuple(np.unique(np.append(step_ends, self.jumps)).tolist())
        return self.runner.run(MotionTask(times, STEP_TOLERANCE, DRIVE_DETERMINED, ends))

    @cached_property
    def run(self) -> Trajectory:
        """The run, evaluated at equally spaced places including both ends."""
        count = SAMPLES_PER_TURN * self.turns
        return self.compute_trajectory(np.arange(count + 1) / count * self.length / abs(self.rate))

    def recover(self, x: Array) -> Evaluation:
        """Return the kernel's results at ascending places (n,)."""
        times = np.minimum(x / abs(self.rate), self.end_time)
        jumps = sorted({*self.jumps, *self.run.jumps})
        return evaluate_run(self.runner, self.run, times, self.runner.resample(self.run, times), jumps)

    @property
    def cycle(self) -> PieceNodes:
        """The cycle, not yet divided into pieces."""
        return make_empty_nodes(self.begin, self.turns, math.copysign(1.0, self.rate))

    @cached_property
    def breaks(self) -> Array:
        """Places of jumps and kinks, (n,)."""
        times = np.array(sorted({*self.jumps, *self.run.jumps}))
        return times * abs(self.rate)

    def is_smooth(self) -> bool:
        """Return whether no jump or kink is known."""
        return not len(self.breaks)

    def find_short_steps(self, length: float) -> Array:
        """Return the ends and middles (n,) of steps shorter than `length` [rad]."""
        ends = self.run.ends * abs(self.rate)
        steps = np.diff(np.append(0.0, ends))
        short = steps < length
        return np.unique(np.concatenate([ends[short], (ends - steps)[short], (ends - 0.5 * steps)[short]]))

    def find_time_law_places(self) -> Array:
        """Return the places (n,) at which functions of time need a closer look."""
        grid, _ = refine_for_time_laws(self.layout.mechanism, np.array([0.0, self.end_time]), MAX_TIME_SAMPLES)
        return np.asarray(grid[1:-1] * abs(self.rate))

    def find_extra_step_ends(self, nodes: PieceNodes) -> Array:
        """Return the ends (n,) of steps that begin with the pieces but do not end with them.

        A step evaluates loads at its ends and in its middle; the kernel shortens it where bounds allow for more.
        """
        ends = self.compute_trajectory(np.array([0.0, self.end_time]), nodes.begins[1:] / abs(self.rate)).ends * abs(
            self.rate
        )
        k = np.clip(np.searchsorted(nodes.begins, ends), 0, len(nodes.begins) - 1)
        known = np.append(nodes.begins, self.length)
        distance = np.minimum(np.abs(ends - known[k]), np.abs(ends - known[np.minimum(k + 1, len(known) - 1)]))
        return np.asarray(ends[distance > tolerances.SIDE_BY_SIDE * self.length])


TURN = 2.0 * math.pi


@record
class NextCycle:
    """A run of one cycle, from which laws are evaluated one cycle later; nodes: those that resolve its loads."""

    run: FollowedRun
    nodes: PieceNodes

    @cached_property
    def evaluation(self) -> Evaluation:
        """The kernel's results at the nodes."""
        return self.run.recover(self.nodes.places)

    @cached_property
    def joint_coordinates(self) -> Block:
        """The coordinates of the joints at the nodes."""
        return evaluate_joint_coordinates(
            self.run.layout, self.evaluation, make_body_states(self.run.layout, self.evaluation)
        )

    @cached_property
    def other_coordinates(self) -> list[Moving]:
        """The other coordinates that laws may use, at the nodes."""
        return [evaluate_coordinates(self.run.layout, self.evaluation, k) for k in range(len(self.nodes.places))]

    @cached_property
    def turn_angles(self) -> dict[str, float]:
        """The angle [rad] by which each joint turns in a cycle: whole turns, as the bodies return to their poses."""
        layout, ends = self.run.layout, self.run.recover(np.array([0.0, self.run.length]))
        end_coordinates = evaluate_joint_coordinates(layout, ends, make_body_states(layout, ends))
        return {
            name: TURN * round(float(joint_ends["angle"][1] - joint_ends["angle"][0]) / TURN)
            for name, joint_ends in end_coordinates.items()
            if "angle" in joint_ends
        }

    def get_coordinate(self, name: str, quantity: str) -> Array:
        """Return a coordinate at the nodes, (n,)."""
        joint_values = self.joint_coordinates.get(name, {})
        return (
            np.asarray(joint_values[quantity])
            if quantity in joint_values
            else np.array([at[name, quantity][0] for at in self.other_coordinates])
        )

    def is_periodic(self, load: Load) -> bool:
        """Return whether a load is the same one cycle later."""
        joint = self.run.layout.mechanism.joints[load.joint].name if isinstance(load, JointLoad) else ""
        if load.row.has_potential and self.turn_angles.get(joint, 0.0):
            return False
        return all(self.is_law_periodic(value) for value in load.values)

    def is_law_periodic(self, value: Expression) -> bool:
        """Return whether a law repeats its values, in the mean: a node may be within rounding of a jump.

        A law without a value one cycle later, such as a table of one turn, counts as periodic.
        """
        if not value.uses and not value.time_dependent:
            return True
        arguments = (
            np.array([self.get_coordinate(*use) for use in value.uses])
            .reshape(len(value.uses), len(self.nodes.places))
            .T
        )
        increments = np.array(
            [self.turn_angles.get(name, 0.0) if what == "angle" else 0.0 for name, what in value.uses]
        )
        times = self.nodes.places / abs(self.run.rate)
        first_values = np.array([value.value(t, at) for t, at in zip(times.tolist(), arguments.tolist(), strict=True)])
        later = zip((times + self.run.end_time).tolist(), (arguments + increments).tolist(), strict=True)
        later_values = np.array([value.value(t, at) for t, at in later])
        differences, size = np.abs(later_values - first_values), np.maximum(np.abs(first_values), np.abs(later_values))
        is_known, threshold = (
            np.isfinite(differences),
            tolerances.SUM_ROUNDING * max(map(abs, value.constants), default=0.0),
        )
        weights = self.nodes.weights[is_known]
        return bool(
            weights @ differences[is_known] <= tolerances.SAME_VALUE * float(weights @ size[is_known]) + threshold
        )


def describe_nonperiodic_loads(run: FollowedRun, nodes: PieceNodes) -> tuple[str, ...]:
    """Return a note for each load that differs after the cycle; nodes: those that resolve the loads.

    The bodies have returned by then, and so have loads that depend only on their poses; a load that counts turns may
    differ.
    """
    next_cycle = NextCycle(run, nodes)
    cycle, hint = ("one revolution", "; try --turns 2") if run.turns == 1 else ("two revolutions", "")
    return tuple(
        f"{load.path} does not repeat after {cycle}; its orders assume that it starts again there{hint}"
        for load in run.layout.mechanism.loads
        if not next_cycle.is_periodic(load)
    )
