"""A spec set up to be solved: built, cut, assembled, laid out; and the note on the model this makes."""

from __future__ import annotations

from functools import cached_property
from typing import TYPE_CHECKING

import numpy as np

from heuncli.base import tolerances
from heuncli.base.errors import SolveError
from heuncli.base.method_rows import AUTO
from heuncli.base.records import record, replace
from heuncli.loads.redundancy.count import redundancy
from heuncli.motion.integration.determined_motion import NOT_DETERMINED, determined
from heuncli.motion.integration.integrated_scene import smaller
from heuncli.motion.integration.methods.followed import FOLLOWED
from heuncli.motion.integration.methods.method import Method
from heuncli.motion.integration.methods.registry import method_of
from heuncli.motion.integration.run.runner import Runner, ready
from heuncli.multibody.coupled_start.prepared import prepare_coupled
from heuncli.multibody.mechanism.build import build, forms_of
from heuncli.multibody.mechanism.couplings import Coupling
from heuncli.multibody.mechanism.model import Mechanism
from heuncli.multibody.reduction import compose as reduction
from heuncli.multibody.reduction.model import Reduced
from heuncli.multibody.stages import ANEW, Stages
from heuncli.multibody.tree.prepare import PreparedScene
from heuncli.results.results import Array, Block
from heuncli.scene.file_format.couplings import Rope
from heuncli.scene.file_format.models import Spec
from heuncli.study.model.method_choice import first_choice, why
from heuncli.study.model.model_note import attitudes, model_note, reductions, rested
from heuncli.study.model.selection import EVERYTHING, Selection

if TYPE_CHECKING:  # loaded where a scene has sections
    from heuncli.loads.kinetostatics.cuts import Cuts
    from heuncli.loads.redundancy.self_stress import KnownStress
    from heuncli.study.model.rest_pose import Rest


@record
class Setup:
    """All that is known of a scene before anything moves; method is None where nothing is integrated.

    spec: as far as it is solved; asked: what is told of it. cuts: of the sections, as asked; in a search runs of cuts
    as whole stretches stand for them. reduced: what is integrated in the scene's place, and why; None where nothing is,
    or where all is solved in full. rest: how the pose was found, where that is what is asked for. step: that is given
    to a method of fixed step [s].
    auto: the method was left to heun, which may change it on the way. known: the self-stresses at the start.
    """

    spec: Spec
    scene: PreparedScene
    cuts: tuple[Cuts, ...]
    runner: Runner
    method: Method | None
    model: Block
    reduced: Reduced | None = None
    asked: Selection = EVERYTHING
    rest: Rest | None = None
    auto: bool = False
    step: float | None = None
    known: KnownStress | None = None

    @cached_property
    def about(self) -> Array:
        """The point about which the foundation's moment is taken, (3,) [m], world axes."""
        given = self.spec.foundation.about
        return np.array(given if given is not None else (0.0, 0.0, 0.0))

    @cached_property
    def steady(self) -> dict[int, Array]:
        """The axes, in body axes, about which bodies have a spin that nothing changes."""
        if not self.scene.layout.bodies["ball"].any():
            return {}
        from heuncli.multibody.reduction.spins import spins_of  # only what hangs on balls, or on nothing, has such

        return {i: spin.axis for i, spin in spins_of(self.scene).items()}


def set_up(
    spec: Spec,
    method: str | None = None,
    *,
    reduce: bool = True,
    asked: Selection = EVERYTHING,
    looked_for: bool = True,
    stages: Stages = ANEW,
) -> Setup:
    """Build, cut, assemble, lay out; `method` stands for the one in the spec; reduce: a smaller scene may move for it.

    looked_for: a rest pose that is asked for is found.
    asked: what is not asked for, and what nothing asked for depends on, is left out; stages: what of it is not made
    anew. Raises SpecError for a section
    that cannot be cut, SolveError where the scene does not close.
    """
    spec, left_out = asked_part(spec, asked, reduce)
    mechanism, cuts = draw(spec, stages)
    if spec.analysis.type == "rest":
        mechanism = with_slack_ropes(mechanism)
    require_drives(mechanism, spec.analysis.times[0] if spec.analysis.times else 0.0)
    prepared = prepare_coupled(mechanism, spec.analysis.times[0] if spec.analysis.type == "state" else 0.0, stages)
    if any(drive.by_rate for drive in spec.drives.values()):
        from heuncli.multibody.tree.driven_starts import require_lengths  # few scenes have them

        require_lengths(prepared.mechanism, max(spec.analysis.times))
    if not reduce:  # what is declared planar is moved as in space, too
        prepared = replace(prepared, layout=replace(prepared.layout, flat=False))
    scene, runner = ready(prepared, stages)
    if scene.mechanism.rubbing and scene.layout.rows:
        from heuncli.loads.redundancy.rubbing import require_certain_start  # few scenes have such friction

        require_certain_start(scene, runner, spec.analysis.times[0] if spec.analysis.type == "state" else 0.0)
    if spec.analysis.type == "rest":
        return set_up_at_rest(Setup(spec, scene, cuts, runner, None, {}, None, asked), left_out, looked_for)
    asked_method = method or spec.analysis.method
    auto = asked_method.lower() == AUTO
    chosen = method_of(asked_method) if spec.analysis.type == "motion" else None
    reduced, follows = None, NOT_DETERMINED
    if chosen is not None and reduce:
        if auto and scene.mechanism.couplings:  # trains are driven, most of them: then a smaller scene saves nothing
            follows = determined(runner.moving)
        if not follows.is_so:
            reduced, runner = reduced_runner(scene, runner, stages)
            follows = determined(runner.moving)
    told = reductions(left_out, scene, reduced)
    if chosen is not None and auto:
        chosen, told = FOLLOWED if follows.is_so else first_choice(runner.moving.layout, spec), follows.beside(told)
    held_twice = redundancy(scene, runner, stages)
    note = model_note(scene, runner, chosen.name if chosen else "none", held_twice) | told
    if chosen is not None:
        note["reasons"] += attitudes(chosen, runner.moving.layout)
        if auto and not chosen.determined:
            note["reasons"] += why(chosen, runner.moving.layout, spec)
    step = spec.analysis.step if chosen is not None and chosen.fixed else None
    note |= {} if step is None else {"step": step}
    return Setup(spec, scene, cuts, runner, chosen, note, reduced, asked, auto=auto, step=step, known=held_twice.here)


def require_drives(mechanism: Mechanism, t: float) -> None:
    """Raise SolveError for drives that begin with what is too large to be computed with: the assembly squares it."""
    jets = [law.value.derivatives(t) for law in mechanism.laws]
    if any(abs(value) > tolerances.MOST_MAGNITUDE for jet in jets for value in jet):
        from heuncli.motion.integration.diagnosis.domains import large_values  # only on the way to an error

        raise SolveError(*large_values(mechanism, t, {}))


def set_up_at_rest(setup: Setup, left_out: tuple[str, ...], looked_for: bool) -> Setup:
    """The setup with its rest pose as the start, and how it rests; as drawn where that is not looked for."""
    from heuncli.study.model.rest_pose import at_rest  # few scenes ask for it

    scene, runner, rest = setup.scene, setup.runner, None
    if looked_for:
        scene, runner, rest = at_rest(scene, runner)
    held_twice = redundancy(scene, runner)
    note = model_note(scene, runner, "rest", held_twice) | reductions(left_out, scene, None)
    told = rested(note, rest.told if rest else ())
    return replace(setup, scene=scene, runner=runner, rest=rest, model=told, known=held_twice.here)


def with_slack_ropes(mechanism: Mechanism) -> Mechanism:
    """Every rope as one that may go slack: at rest it bears or does not, and ends no run by being pushed.

    So does what a cam presses: it may lie on it or not.
    """
    joints = [replace(j, restitution=0.0) if j.opens and j.restitution is None else j for j in mechanism.joints]
    return replace(mechanism, joints=tuple(joints), couplings=tuple(slackening(own) for own in mechanism.couplings))


def slackening(own: Coupling) -> Coupling:
    """A coupling whose one-sided conditions open and close; of a rope they are yet to be made, as it says itself."""
    rows = [replace(r, restitution=0.0) if r.tension_only and r.restitution is None else r for r in own.rows]
    given = own.given
    if isinstance(given, Rope) and given.tension_only and given.restitution is None:
        given = given._replace(restitution=0.0)
    return replace(own, rows=tuple(rows), given=given)


def asked_part(spec: Spec, asked: Selection, reduce: bool) -> tuple[Spec, tuple[str, ...]]:
    """The spec as far as it is asked for; what of the scene is left out, in a sentence."""
    if asked.is_everything:
        return spec, ()
    from heuncli.study.model.needed_parts import left_out, restricted  # where not all is asked for

    part = restricted(spec, asked, reduce=reduce)
    return part, left_out(spec, part)


def reduced_runner(scene: PreparedScene, runner: Runner, stages: Stages = ANEW) -> tuple[Reduced, Runner]:
    """The smallest scene that moves as this one does, and a runner that integrates it in its place."""
    reduced = reduction.reduce(scene, stages)
    if not reduced.steps:
        return reduced, runner
    _, own = ready(reduced.steps[-1].scene)
    return reduced, Runner(scene.layout, smaller(own, reduced))


def draw(spec: Spec, stages: Stages = ANEW) -> tuple[Mechanism, tuple[Cuts, ...]]:
    """The bodies as they are drawn, and their sections. Raises SpecError with every section that cannot be cut."""
    forms = forms_of(spec, stages)
    mechanism = build(spec, forms, stages)
    if not spec.sections:
        return mechanism, ()
    from heuncli.loads.kinetostatics.cuts import lay_cuts  # with the shapes 9 ms that other scenes do not need

    return mechanism, lay_cuts(mechanism, spec, forms)
