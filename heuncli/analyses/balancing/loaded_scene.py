"""A scene with its loads, followed at the cycle's rate: its results at any place of the cycle."""

from __future__ import annotations

from collections.abc import Callable, Sequence

import numpy as np

from heuncli.analyses.balancing.cycle import drop_rates, make_driven_mechanism, require_determined
from heuncli.analyses.balancing.cycle_nodes import PieceNodes
from heuncli.analyses.balancing.cycle_plan import CyclePlan
from heuncli.analyses.balancing.followed_run import FollowedRun
from heuncli.analyses.balancing.law_search import find_deviations, iter_angle_laws
from heuncli.analyses.balancing.periodicity import describe_nonperiodic_loads
from heuncli.analyses.balancing.piece_resolver import CycleResolver, make_scales
from heuncli.base.named_tuples import NamedTuple
from heuncli.base.records import record
from heuncli.loads.redundancy.count import count_redundancy
from heuncli.motion.integration.methods.method import DRIVE_DETERMINED
from heuncli.motion.integration.run.runner import make_runner
from heuncli.multibody.mechanism.model import Mechanism
from heuncli.multibody.tree.prepare import PreparedScene, lay_out_scene
from heuncli.results.results import Array
from heuncli.scene.expressions.programs import Expression
from heuncli.scene.file_format.models import Spec
from heuncli.study.compose.recovery import Recovery
from heuncli.study.model.model_note import make_model_block
from heuncli.study.model.setup import Setup, reduce_scene

SHORT_STEP = 1e-2  # of a turn: shorter steps occur only where a load changes quickly
FIRST_SAMPLES = 8
MAX_SEARCHES = 24  # searches for missed events; each finds at most one per piece


class CycleNumbers(NamedTuple):
    """Numbers over a cycle, (n, columns), at the nodes of its pieces.

    notes: events that may have been missed
    is_resolved: whether the nodes resolve the numbers everywhere
    """

    nodes: PieceNodes
    values: Array
    notes: tuple[str, ...]
    is_resolved: bool


@record
class LoadedScene:
    """A scene with its loads.

    joint: the joint whose angle counts the cycle
    """

    setup: Setup
    followed_run: FollowedRun
    joint: str

    def recover(self, x: Array) -> Recovery:
        """Recover the results at ascending places of the cycle (n,)."""
        return Recovery(self.setup, self.followed_run.recover(x), False)

    def recover_samples(self) -> Recovery:
        """Recover the results at a few equally spaced places, to learn how many numbers there are and how large."""
        return self.recover(self.followed_run.length * np.arange(FIRST_SAMPLES) / FIRST_SAMPLES)

    def resolve_numbers(
        self, compute_columns: Callable[[Recovery], Array], group_sizes: Sequence[int], rounding: Sequence[float]
    ) -> CycleNumbers:
        """Compute columns over the cycle, on as many pieces as are needed to resolve them.

        group_sizes: numbers of adjacent columns that are of one kind
        rounding: rounding level of each kind
        """
        run, mechanism = self.followed_run, self.setup.scene.mechanism
        resolver = CycleResolver(
            lambda x: compute_columns(self.recover(x)), run.cycle, make_scales(group_sizes, rounding)
        )
        resolver.resolve(run.breaks)
        resolved = resolver.probe(
            np.union1d(run.find_short_steps(SHORT_STEP * run.length / run.turns), run.find_time_law_places())
        )
        values = [value for load in mechanism.loads for value in load.values]
        laws = list(iter_angle_laws(values, self.joint, run.rate))
        has_other_laws = depends_on_other_joints(values, self.joint)
        undecided: tuple[str, ...] = ()
        for _ in range(MAX_SEARCHES):
            places, undecided = find_deviations(laws, resolved.nodes)
            if has_other_laws:
                places = np.union1d(places, run.find_extra_step_ends(resolved.nodes))
            count = len(resolved.nodes.begins)
            resolved = resolver.probe(places)
            if len(resolved.nodes.begins) == count:
                break
        else:
            undecided += ("the loads",)
        notes = [f"{law_source}: no bounds found between the sampled angles" for law_source in undecided]
        if run.run.uncertain_count:
            steps = "one step" if run.run.uncertain_count == 1 else f"{run.run.uncertain_count} steps"
            notes.append(f"no bounds on the loads found in {steps}: short events may be missing")
        if not resolved.is_resolved:
            notes.append("loads vary too much for full accuracy: results are as uncertain as their stated errors")
        settled = resolved.is_resolved and not notes
        notes += describe_nonperiodic_loads(run, resolved.nodes)
        return CycleNumbers(resolved.nodes, resolved.values, tuple(dict.fromkeys(notes)), settled)


def depends_on_other_joints(values: Sequence[Expression], joint: str) -> bool:
    """Return whether laws depend on coordinates other than this joint's."""
    return any(name != joint for value in values for name, _ in value.uses)


def make_loaded_scene(
    spec: Spec, scene: PreparedScene, mechanism: Mechanism, plan: CyclePlan, rate: float
) -> LoadedScene:
    """Return a mechanism in the place of the scene's own, with its loads, followed along the cycle."""
    driven = lay_out_scene(make_driven_mechanism(mechanism, plan, rate, with_loads=True), drop_rates(scene))
    prepared, runner = make_runner(driven)
    reduced, runner = reduce_scene(prepared, runner)
    require_determined(runner, plan)
    note = make_model_block(prepared, runner, DRIVE_DETERMINED.name, count_redundancy(prepared, runner))
    setup = Setup(spec, prepared, (), runner, DRIVE_DETERMINED, note, reduced)
    return LoadedScene(setup, FollowedRun(prepared.layout, runner, plan.begin, rate, plan.turns), plan.joint)
