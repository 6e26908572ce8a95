"""A scene with its loads, followed at the cycle's rate: what its numbers are at any place of the cycle."""

from __future__ import annotations

from collections.abc import Callable, Sequence

import numpy as np

from heuncli.balancing.choice import CyclePlan
from heuncli.balancing.cycle import driven_mechanism, require_determined, still
from heuncli.balancing.followed import FollowedRun
from heuncli.balancing.nodes import PieceNodes
from heuncli.balancing.recurring import unlike
from heuncli.balancing.resolved import CycleResolver, scales_of
from heuncli.balancing.unseen import laws_of_angle, suspects
from heuncli.expressions.programs import Expression
from heuncli.integration.methods.followed import FOLLOWED
from heuncli.integration.run.runner import ready
from heuncli.mechanism.model import Mechanism
from heuncli.named_tuples import NamedTuple
from heuncli.records import record
from heuncli.redundancy.count import redundancy
from heuncli.results import Array
from heuncli.spec.models import Spec
from heuncli.study.compose.recovery import Recovery
from heuncli.study.model.model_note import model_note
from heuncli.study.model.setup import Setup, reduced_runner
from heuncli.tree.prepare import PreparedScene, arranged

SHORT = 1e-2  # of a turn: steps of less are taken where a load flares up
FEW = 8
MOST_ROUNDS = 24  # of looks for what was not seen; each finds one in every piece


class CycleNumbers(NamedTuple):
    """Numbers over a cycle, (n, columns), at the nodes of its pieces; notes: what is not known to have been seen."""

    nodes: PieceNodes
    values: Array
    notes: tuple[str, ...]
    settled: bool


@record
class LoadedScene:
    """A scene with its loads; joint: whose angle the cycle is counted in."""

    setup: Setup
    followed: FollowedRun
    joint: str

    def at(self, x: Array) -> Recovery:
        """It at places of the cycle (n,), ascending."""
        return Recovery(self.setup, self.followed.recovered(x), False)

    def at_first(self) -> Recovery:
        """It at a few even places, by which it is told how many numbers there are, and what their terms are."""
        return self.at(self.followed.length * np.arange(FEW) / FEW)

    def numbers(
        self, columns: Callable[[Recovery], Array], parts: Sequence[int], rounding: Sequence[float]
    ) -> CycleNumbers:
        """Columns over the cycle, on as many pieces as tell them.

        parts: so many side by side that are of one kind; rounding: of each kind what of its numbers is that.
        """
        run, mechanism = self.followed, self.setup.scene.mechanism
        resolver = CycleResolver(lambda x: columns(self.at(x)), run.cycle, scales_of(parts, rounding))
        resolver.resolve(run.breaks)
        found = resolver.probed(np.union1d(run.short_steps(SHORT * run.length / run.turns), run.given_in_time()))
        values = [value for load in mechanism.loads for value in load.values]
        laws = list(laws_of_angle(values, self.joint, run.rate))
        others = has_others(values, self.joint)
        undecided: tuple[str, ...] = ()
        for _ in range(MOST_ROUNDS):
            places, undecided = suspects(laws, found.nodes)
            if others:
                places = np.union1d(places, run.looked_at(found.nodes))
            count = len(found.nodes.begins)
            found = resolver.probed(places)
            if len(found.nodes.begins) == count:
                break
        else:
            undecided += ("the loads",)
        notes = [f"bounds do not tell what {law} does between the angles that were looked at" for law in undecided]
        if run.run.undecided:
            steps = "one step" if run.run.undecided == 1 else f"{run.run.undecided} steps"
            notes.append(f"in {steps} bounds could not decide what loads do: shorter events may be missing")
        if not found.settled:
            notes.append("loads vary too much to be followed to their digits: what is told errs by as much as it says")
        settled = found.settled and not notes
        notes += unlike(run, found.nodes)
        return CycleNumbers(found.nodes, found.values, tuple(dict.fromkeys(notes)), settled)


def has_others(values: Sequence[Expression], joint: str) -> bool:
    """Whether laws hang on other coordinates than a joint's."""
    return any(name != joint for value in values for name, _ in value.uses)


def loaded(spec: Spec, scene: PreparedScene, mechanism: Mechanism, plan: CyclePlan, rate: float) -> LoadedScene:
    """A mechanism in the scene's place, with its loads, along the cycle."""
    driven = arranged(driven_mechanism(mechanism, plan, rate, loaded=True), still(scene))
    own, runner = ready(driven)
    reduced, runner = reduced_runner(own, runner)
    require_determined(runner, plan)
    note = model_note(own, runner, FOLLOWED.name, redundancy(own, runner))
    setup = Setup(spec, own, (), runner, FOLLOWED, note, reduced)
    return LoadedScene(setup, FollowedRun(own.layout, runner, plan.begin, rate, plan.turns), plan.joint)
