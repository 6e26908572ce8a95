"""Check whether loads repeat with the cycle: a law of an angle, or of time, may take more turns than the bodies do."""

from __future__ import annotations

import math
from functools import cached_property

import numpy as np

from heuncli.analyses.balancing.cycle_nodes import PieceNodes
from heuncli.analyses.balancing.followed_run import FollowedRun
from heuncli.base import tolerances
from heuncli.base.records import record
from heuncli.loads.kinetostatics.bodies import make_body_states
from heuncli.loads.kinetostatics.coordinates import evaluate_joint_coordinates
from heuncli.motion.integration.diagnosis.domains import evaluate_coordinates
from heuncli.motion.integration.diagnosis.guide_departures import Moving
from heuncli.motion.integration.evaluator import Evaluation
from heuncli.multibody.mechanism.model import JointLoad, Load
from heuncli.results.results import Array, Block
from heuncli.scene.expressions.programs import Expression

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
