"""Compare runs with a reference, at the instants up to which the reference is valid: points, reactions and sections.

Reactions and sections are those of `accuracy.estimate` (study/solve/load_errors.py), relative to the reference's
largest. Indeterminate components of joints are left out, and all sections if one of them is indeterminate.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np

from heuncli.analyses.work_precision.results import Errors
from heuncli.base.records import record, replace
from heuncli.loads.kinetostatics.reactions import JointLoads
from heuncli.motion.integration.check.estimate import evaluate_run, evaluate_together
from heuncli.motion.integration.check.run_comparison import (
    find_angle_difference,
    find_point_distance,
    is_between_impulses,
    replace_nan_errors,
)
from heuncli.motion.integration.check.runs import Runs
from heuncli.motion.integration.trajectory import Trajectory
from heuncli.results.results import Array, Mask
from heuncli.study.compose.blocks import make_blocks
from heuncli.study.compose.recovery import recover
from heuncli.study.model.selection import Selection
from heuncli.study.model.setup import Setup
from heuncli.study.solve.error_estimates import DIFFERENCE_ONLY, BalanceTerms, Weights
from heuncli.study.solve.load_errors import LoadErrors, Quantity

LOAD_SELECTION = Selection(frozenset({"joints", "sections"}))
# by joint: which components of its force and moment are always determinate
DeterminateComponents = Mapping[str, tuple[Mask, Mask]]


class DeterminateLoadErrors(LoadErrors):
    """The differences of loads, without the indeterminate components of joints."""

    def __init__(self, setup: Setup, determinate: DeterminateComponents, weights: Weights) -> None:
        super().__init__(setup, weights=weights)
        self.determinate = determinate

    def add_values(
        self, name: tuple[str, str], values: Array, rounding: Array, terms: Array, more: Array | None = None
    ) -> None:
        """Use the reference's terms only: with those of a diverged run its own loads would count as rounding."""
        super().add_values(name, values, rounding, np.repeat(terms[0::2], 2), more)

    def add_joints(self, joints: Sequence[JointLoads], coupled: Sequence[Quantity], terms: BalanceTerms) -> None:
        """Add the determinate components of the joints, and the couplings if nothing is indeterminate."""
        selected = []
        for load in joints:
            force, moment = self.determinate[load.joint.name]
            selected.append(replace(load, force=load.force * force, moment=load.moment * moment))
        all_determinate = all(bool(np.all(whole)) for pair in self.determinate.values() for whole in pair)
        super().add_joints(selected, coupled if all_determinate else (), terms)


@record
class ReferenceComparison:
    """A reference solution and the runs compared with it.

    runs: runs by the reference's method
    times (n,): the instants that are compared
    determinate: the components of joints that are compared
    has_sections: whether there are sections and none is indeterminate
    """

    runs: Runs
    setup: Setup
    reference: Trajectory
    times: Array
    determinate: DeterminateComponents
    has_sections: bool

    def compute_differences(self, other: Trajectory, weights: Weights = DIFFERENCE_ONLY) -> Errors:
        """Return the largest differences of another run from the reference, by kind; None where a kind cannot be
        compared.
        """
        n = len(self.times)
        states = (self.reference.states[:n], other.states[:n])
        is_compared = ~is_between_impulses((self.reference, other), self.times)
        load_errors = DeterminateLoadErrors(self.setup, self.determinate, weights)
        layout, largest_distance, largest_turn, largest_angle = self.setup.scene.layout, 0.0, 0.0, 1.0
        with np.errstate(all="ignore"):  # a diverged run may have any values
            for part, bodies_pair in evaluate_together(self.runs, self.reference, self.times, states):
                distances = find_point_distance(self.runs.motion_points, bodies_pair.bodies, 2, layout.size)
                turns, angles = find_angle_difference(layout, bodies_pair, 2)
                largest_distance = max(largest_distance, _find_largest(distances))
                largest_turn = max(largest_turn, _find_largest(turns))
                largest_angle = max(largest_angle, float(angles.max(initial=1.0)))
                mask = is_compared[part]
                if mask.any():
                    compared = bodies_pair if mask.all() else bodies_pair.select(np.repeat(mask, 2))
                    load_errors.add(compared, *np.ones((2, int(mask.sum())), dtype=bool))
            motion = max(largest_distance, largest_turn / largest_angle)
            return {"motion": motion, **self.estimate_load_differences(load_errors)}

    def estimate_load_differences(self, load_errors: LoadErrors) -> Errors:
        """Return the collected differences of loads, relative to the largest."""
        estimate = load_errors.estimate()
        reactions = estimate["reactions"] if any(f.any() or m.any() for f, m in self.determinate.values()) else None
        return {"reactions": reactions, "sections": estimate.get("sections") if self.has_sections else None}


def _find_largest(values: Array) -> float:
    """Return the largest error; nan counts as unknown."""
    return float(replace_nan_errors(values).max(initial=0.0))


def make_comparison(runs: Runs, setup: Setup, reference: Trajectory, count: int) -> ReferenceComparison:
    """Return the comparison of runs with a reference, at the first `count` of its instants."""
    setup = replace(setup, selection=LOAD_SELECTION)
    times, states = reference.times[:count], reference.states[:count]
    result_blocks: dict[str, Any] = {}
    if setup.scene.layout.rows:  # in a tree everything is determinate
        recovered = evaluate_run(runs.runner, reference, times, states, runs.jumps)
        result_blocks = make_blocks(recover(setup, recovered, False), LOAD_SELECTION.reports)
    names = [joint.name for joint in setup.scene.mechanism.joints]
    joints = {name: result_blocks.get("joints", {}).get(name) for name in names}
    determinate = {name: _find_determinate(block) for name, block in joints.items()}
    sections = result_blocks.get("sections", {}).values()
    is_indeterminate = any(np.isnan(block[key]).any() for block in sections for key in ("force", "moment"))
    return ReferenceComparison(runs, setup, reference, times, determinate, bool(setup.cuts) and not is_indeterminate)


def _find_determinate(block: Mapping[str, Any] | None) -> tuple[Mask, Mask]:
    """Return which components of a joint's force and moment are determinate at all instants."""
    if block is None:
        return np.ones(3, dtype=bool), np.ones(3, dtype=bool)
    force, moment = (~np.isnan(block[key]).any(axis=0) for key in ("force", "moment"))
    return force, moment
