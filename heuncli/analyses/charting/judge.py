"""How far a run is from a reference, at the instants up to which that one is judged: points, reactions, sections.

Reactions and sections are those of `accuracy.estimate` (study/solve/load_errors.py), relative to the reference's
largest. What is open tells nothing: open components of joints are left out, and all sections where one of them is open.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np

from heuncli.analyses.charting.results import Errors
from heuncli.base.records import record, replace
from heuncli.loads.kinetostatics.reactions import JointLoads
from heuncli.motion.integration.check.distance import angles_apart, known, points_apart
from heuncli.motion.integration.check.estimate import recovered_at, recovered_together
from heuncli.motion.integration.check.runs import Runs
from heuncli.motion.integration.check.shared_blows import between_strikes
from heuncli.motion.integration.trajectory import Trajectory
from heuncli.results.results import Array, Mask
from heuncli.study.compose.blocks import blocks
from heuncli.study.compose.recovery import recover
from heuncli.study.model.selection import Selection
from heuncli.study.model.setup import Setup
from heuncli.study.solve.balance_terms import BalanceTerms
from heuncli.study.solve.error_extents import APART, Weights
from heuncli.study.solve.load_errors import LoadErrors, Quantity

OF_LOADS = Selection(frozenset({"joints", "sections"}))
Certain = Mapping[str, tuple[Mask, Mask]]  # by joint: which components of its force and moment are never open


class CertainLoadErrors(LoadErrors):
    """The differences of loads, without the components of joints that are open."""

    def __init__(self, setup: Setup, certain: Certain, weights: Weights) -> None:
        super().__init__(setup, weights=weights)
        self.certain = certain

    def take(
        self, name: tuple[str, str], values: Array, rounding: Array, terms: Array, more: Array | None = None
    ) -> None:
        """Terms are the reference's: beside those of a run that is lost its own loads would count as rounding."""
        super().take(name, values, rounding, np.repeat(terms[0::2], 2), more)

    def add_joints(self, joints: Sequence[JointLoads], coupled: Sequence[Quantity], terms: BalanceTerms) -> None:
        """Those of the joints of which something is certain; of couplings where nothing is open."""
        kept = []
        for load in joints:
            force, moment = self.certain[load.joint.name]
            kept.append(replace(load, force=load.force * force, moment=load.moment * moment))
        everything = all(bool(np.all(whole)) for pair in self.certain.values() for whole in pair)
        super().add_joints(kept, coupled if everything else (), terms)


@record
class Judge:
    """A reference with what is compared with it.

    runs: of the reference's method; times (n,): the instants that are judged; certain: components of joints;
    sections: whether there are some, none of them open.
    """

    runs: Runs
    setup: Setup
    reference: Trajectory
    times: Array
    certain: Certain
    sections: bool

    def apart(self, other: Trajectory, weights: Weights = APART) -> Errors:
        """How far another run is from the reference, at most, by kind; None where nothing is told of a kind."""
        n = len(self.times)
        states = (self.reference.states[:n], other.states[:n])
        kept = ~between_strikes((self.reference, other), self.times)
        kinds = CertainLoadErrors(self.setup, self.certain, weights)
        layout, places, angles, largest = self.setup.scene.layout, 0.0, 0.0, 1.0
        with np.errstate(all="ignore"):  # what a method has lost may be anywhere
            for part, several in recovered_together(self.runs, self.reference, self.times, states):
                far = points_apart(self.runs.marks, several.bodies, 2, layout.size)
                turned, angle = angles_apart(layout, several, 2)
                places, angles = max(places, _most(far)), max(angles, _most(turned))
                largest = max(largest, float(angle.max(initial=1.0)))
                own = kept[part]
                if own.any():
                    told = several if own.all() else several.at(np.repeat(own, 2))
                    kinds.add(told, *np.ones((2, int(own.sum())), dtype=bool))
            return {"motion": max(places, angles / largest), **self.loads(kinds)}

    def loads(self, kinds: LoadErrors) -> Errors:
        """The differences of loads that are collected, relative to the largest."""
        found = kinds.estimate()
        reactions = found["reactions"] if any(f.any() or m.any() for f, m in self.certain.values()) else None
        return {"reactions": reactions, "sections": found.get("sections") if self.sections else None}


def _most(values: Array) -> float:
    return float(known(values).max(initial=0.0))


def judge_of(runs: Runs, setup: Setup, reference: Trajectory, count: int) -> Judge:
    """The judge of runs by a reference, at the first `count` of its instants."""
    setup = replace(setup, asked=OF_LOADS)
    times, states = reference.times[:count], reference.states[:count]
    shown: dict[str, Any] = {}
    if setup.scene.layout.rows:  # nothing is open of a tree
        recovered = recovered_at(runs.runner, reference, times, states, runs.jumps)
        shown = blocks(recover(setup, recovered, False), OF_LOADS.reports)
    names = [joint.name for joint in setup.scene.mechanism.joints]
    joints = {name: shown.get("joints", {}).get(name) for name in names}
    certain = {name: _certain(block) for name, block in joints.items()}
    sections = shown.get("sections", {}).values()
    is_open = any(np.isnan(block[key]).any() for block in sections for key in ("force", "moment"))
    return Judge(runs, setup, reference, times, certain, bool(setup.cuts) and not is_open)


def _certain(block: Mapping[str, Any] | None) -> tuple[Mask, Mask]:
    """Which components of a joint's force and moment are numbers at all instants."""
    if block is None:
        return np.ones(3, dtype=bool), np.ones(3, dtype=bool)
    force, moment = (~np.isnan(block[key]).any(axis=0) for key in ("force", "moment"))
    return force, moment
