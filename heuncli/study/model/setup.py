"""Set up a spec to be solved: build, cut, assemble and lay out the scene; find the entry at fault where that fails."""

from __future__ import annotations

import re
from collections.abc import Iterator
from contextlib import contextmanager
from functools import cached_property
from typing import TYPE_CHECKING

import numpy as np

from heuncli.base import tolerances
from heuncli.base.errors import Problem, SolveError, SourceLocation
from heuncli.base.method_rows import AUTO
from heuncli.base.records import record, replace
from heuncli.loads.redundancy.count import count_redundancy
from heuncli.motion.integration.integrated_scene import NOT_DETERMINED, find_determined_motion, integrate_reduced
from heuncli.motion.integration.methods.method import DRIVE_DETERMINED, Method, load_method_by_name
from heuncli.motion.integration.run.runner import Runner, make_runner
from heuncli.multibody.coupled_start.prepare_coupled import prepare_coupled
from heuncli.multibody.mechanism.build import build, make_forms
from heuncli.multibody.mechanism.couplings import Coupling
from heuncli.multibody.mechanism.model import Mechanism
from heuncli.multibody.reduction import compose as reduction
from heuncli.multibody.reduction.compose import ReducedScene
from heuncli.multibody.stage_cache import NO_CACHE, Stages
from heuncli.multibody.tree.prepare import PreparedScene
from heuncli.results.results import Array, Block
from heuncli.scene.file_format.couplings import Rope
from heuncli.scene.file_format.models import Spec
from heuncli.study.model.method_choice import choose_first_method, explain_choice
from heuncli.study.model.model_note import (
    add_rest_sentences,
    describe_files,
    describe_members,
    describe_reductions,
    make_model_block,
)
from heuncli.study.model.selection import EVERYTHING, Selection

if TYPE_CHECKING:
    from heuncli.loads.kinetostatics.cuts import Cuts
    from heuncli.loads.kinetostatics.moved_reactions import PlacedSensor
    from heuncli.loads.redundancy.self_stress import CachedStress
    from heuncli.study.model.rest_pose import Rest


@record
class Setup:
    """All that is known of a scene before anything moves.

    spec: the part that is solved
    cuts: of the requested sections; a search puts a Stretch in the place of each series of cuts, for code that needs no
    more of them than PlaceableCuts (loads/kinetostatics/cuts.py)
    method: None if nothing is integrated
    reduction: the smaller scene that is integrated in its place, and why; None if nothing is integrated, or the whole
    scene
    selection: the requested part of the results
    rest: how the rest pose was found, if the analysis asks for one
    is_auto: heun chose the method, and may change it during the run
    step: of a method of fixed step [s]
    self_stress: the self-stresses at the start
    start_warnings: on the pose from which a motion starts, if the analysis asks for one at rest
    """

    spec: Spec
    scene: PreparedScene
    cuts: tuple[Cuts, ...]
    runner: Runner
    method: Method | None
    model: Block
    reduction: ReducedScene | None = None
    selection: Selection = EVERYTHING
    rest: Rest | None = None
    is_auto: bool = False
    step: float | None = None
    self_stress: CachedStress | None = None
    start_warnings: tuple[str, ...] = ()

    @cached_property
    def moment_point(self) -> Array:
        """The point about which the foundation's moment is taken, (3,) [m], world axes."""
        point = self.spec.foundation.about
        return np.array(point if point is not None else (0.0, 0.0, 0.0))

    @cached_property
    def sensors(self) -> tuple[PlacedSensor, ...]:
        """What reads reactions elsewhere."""
        if not self.spec.sensors:
            return ()
        from heuncli.loads.kinetostatics.moved_reactions import make_sensors  # few scenes have them

        return make_sensors(self.spec, self.scene.mechanism)

    @cached_property
    def steady_spin_axes(self) -> dict[int, Array]:
        """The spin axes of bodies whose spin is constant, in body axes, by body."""
        if not self.scene.layout.bodies["ball"].any():
            return {}
        # only bodies on ball joints, or free ones, have them
        from heuncli.multibody.reduction.spins import find_constant_spins

        return {i: spin.axis for i, spin in find_constant_spins(self.scene).items()}


def set_up(
    spec: Spec, method: str | None = None, *, reduce: bool = True, selection: Selection = EVERYTHING,
    find_rest: bool = True, stages: Stages = NO_CACHE,
) -> Setup:  # fmt: skip
    """Build, cut, assemble and lay out a scene.

    method: overrides that of the spec
    reduce: whether a smaller scene may be integrated in its place
    selection: sections and parts that it does not need are left out
    find_rest: whether to search for the rest pose that the analysis asks for
    stages: the cache of set-up stages

    Raises SpecError for a section that cannot be cut, SolveError where the scene does not close.
    """
    spec, left_out = select_part(spec, selection, reduce)
    mechanism, cuts = build_with_cuts(spec, stages)
    if spec.analysis.type == "rest":
        mechanism = with_slack_ropes(mechanism)
    start_time = spec.analysis.times[0] if spec.analysis.type == "state" else 0.0
    scene, runner = prepare_scene(spec, mechanism, start_time, reduce, stages)
    start_warnings: tuple[str, ...] = ()
    if spec.analysis.start is not None and find_rest:
        scene, runner, start_warnings = start_settled(scene, spec, stages)
        reduce = False  # a smaller scene is derived from the start as drawn
    if scene.mechanism.joint_friction and scene.layout.rows:
        from heuncli.loads.redundancy import indeterminate_components  # few scenes have such friction

        indeterminate_components.require_determinate_friction_at_start(scene, runner, start_time)
    if spec.analysis.type == "rest":
        return set_up_at_rest(Setup(spec, scene, cuts, runner, None, {}, None, selection), left_out, find_rest)
    method_name = method or spec.analysis.method
    auto = method_name.lower() == AUTO
    chosen = load_method_by_name(method_name) if spec.analysis.type == "motion" else None
    reduced, follows = None, NOT_DETERMINED
    if chosen is not None and reduce:
        if auto and scene.mechanism.couplings:  # most gear trains are driven; then a smaller scene saves nothing
            follows = find_determined_motion(runner.integrated_scene)
        if not follows.is_determined:
            reduced, runner = reduce_scene(scene, runner, stages)
            follows = find_determined_motion(runner.integrated_scene)
    reductions_block = describe_reductions(left_out, scene, reduced)
    if chosen is not None and auto:
        layout = runner.integrated_scene.layout
        chosen = DRIVE_DETERMINED if follows.is_determined else choose_first_method(layout, spec)
        reductions_block = follows.add_to_block(reductions_block)
    redundancies = count_redundancy(scene, runner, stages)
    note = make_model_block(scene, runner, chosen.name if chosen else "none", redundancies) | reductions_block
    note["notes"] += describe_files(spec)
    if chosen is not None:
        note["reasons"] += explain_choice(chosen, runner.integrated_scene.layout, spec, is_auto=auto)
    step = spec.analysis.step if chosen is not None and chosen.has_fixed_step else None
    note |= {} if step is None else {"step": step}
    note |= describe_members(cuts)
    return Setup(
        spec, scene, cuts, runner, chosen, note, reduced, selection,
        is_auto=auto, step=step, self_stress=redundancies.start_stress, start_warnings=start_warnings,
    )  # fmt: skip


def prepare_scene(
    spec: Spec, mechanism: Mechanism, start_time: float, reduce: bool, stages: Stages
) -> tuple[PreparedScene, Runner]:
    """Assemble and lay out the scene as it is drawn, and make its runner.

    reduce: whether a scene declared planar is moved in its plane
    """
    require_drives(mechanism, spec.analysis.times[0] if spec.analysis.times else 0.0)
    prepared = prepare_coupled(mechanism, start_time, stages)
    if any(drive.by_rate for drive in spec.drives.values()):
        from heuncli.multibody.tree.starts import require_lengths  # few scenes have them

        require_lengths(prepared.mechanism, max(spec.analysis.times))
    if not reduce:
        prepared = replace(prepared, layout=replace(prepared.layout, flat=False))
    return make_runner(prepared, stages)


def start_settled(scene: PreparedScene, spec: Spec, stages: Stages) -> tuple[PreparedScene, Runner, tuple[str, ...]]:
    """Return the scene with its start at rest, or steady, a runner that begins there, and warnings."""
    from heuncli.study.model.settled_start import settle_start  # few scenes need it

    assert spec.analysis.start is not None
    scene, sentences, warnings = settle_start(scene, spec.analysis.start, stages)
    motions = (*scene.start.start_motions, *sentences)
    scene = replace(scene, start=replace(scene.start, start_motions=motions))
    return scene, Runner(scene.layout), warnings


def require_drives(mechanism: Mechanism, t: float) -> None:
    """Raise SolveError for drives whose first values are too large to compute with, because the assembly squares
    them.
    """
    jets = [law.value.derivatives(t) for law in mechanism.laws]
    if any(abs(value) > tolerances.MOST_MAGNITUDE for jet in jets for value in jet):
        from heuncli.motion.integration.diagnosis.domains import find_large_values  # only on the way to an error

        raise SolveError(*find_large_values(mechanism, t, {}))


def set_up_at_rest(setup: Setup, left_out: tuple[str, ...], find_rest: bool) -> Setup:
    """Return the setup with its rest pose as the start and sentences on it; with the drawn pose unless `find_rest`."""
    from heuncli.study.model.rest_pose import start_at_rest  # few scenes need it

    scene, runner, rest = setup.scene, setup.runner, None
    if find_rest:
        scene, runner, rest = start_at_rest(scene, runner)
    redundancies = count_redundancy(scene, runner)
    note = make_model_block(scene, runner, "rest", redundancies) | describe_reductions(left_out, scene, None)
    note["notes"] += describe_files(setup.spec)
    note |= describe_members(setup.cuts)
    model = add_rest_sentences(note, rest.sentences if rest else ())
    return replace(setup, scene=scene, runner=runner, rest=rest, model=model, self_stress=redundancies.start_stress)


def with_slack_ropes(mechanism: Mechanism) -> Mechanism:
    """Return the mechanism with ropes that may go slack: at rest a rope bears or does not, and pushing it ends no run.

    Cams likewise may touch or lift off.
    """
    joints = [replace(j, restitution=0.0) if j.can_open and j.restitution is None else j for j in mechanism.joints]
    return replace(mechanism, joints=tuple(joints), couplings=tuple(with_slack(own) for own in mechanism.couplings))


def with_slack(coupling: Coupling) -> Coupling:
    """Return a coupling whose unilateral conditions open and close.

    A rope's conditions are made later, so its own entry is changed, too.
    """
    rows = [replace(r, restitution=0.0) if r.tension_only and r.restitution is None else r for r in coupling.rows]
    spec_coupling = coupling.entry
    if isinstance(spec_coupling, Rope) and spec_coupling.tension_only and spec_coupling.restitution is None:
        spec_coupling = spec_coupling._replace(restitution=0.0)
    return replace(coupling, rows=tuple(rows), entry=spec_coupling)


def select_part(spec: Spec, selection: Selection, reduce: bool) -> tuple[Spec, tuple[str, ...]]:
    """Return the requested part of the spec, and a sentence on what is left out."""
    if selection.is_everything:
        return spec, ()
    from heuncli.study.model.selection import describe_left_out, restrict_spec  # only if not everything is requested

    part = restrict_spec(spec, selection, reduce=reduce)
    return part, describe_left_out(spec, part)


def reduce_scene(scene: PreparedScene, runner: Runner, stages: Stages = NO_CACHE) -> tuple[ReducedScene, Runner]:
    """Return the smallest scene that moves like this one, and a runner that integrates it in its place."""
    reduced = reduction.reduce(scene, stages)
    if not reduced.steps:
        return reduced, runner
    _, small_runner = make_runner(reduced.steps[-1].scene)
    return reduced, Runner(scene.layout, integrate_reduced(small_runner, reduced))


def build_with_cuts(spec: Spec, stages: Stages = NO_CACHE) -> tuple[Mechanism, tuple[Cuts, ...]]:
    """Build the bodies as drawn, and their sections. Raises SpecError with every section that cannot be cut."""
    forms = make_forms(spec, stages)
    mechanism = build(spec, forms, stages)
    if not spec.sections:
        return mechanism, ()
    from heuncli.loads.kinetostatics.cut_planes import make_cuts  # with the shapes 9 ms that other scenes do not need

    cuts = make_cuts(mechanism, spec, forms)
    if any(section.beam_theory for section in spec.sections.values()):
        from heuncli.loads.kinetostatics.deflection import add_beams  # few scenes ask for it

        cuts = add_beams(cuts, mechanism, spec)
    return mechanism, cuts


# Problems of packages that know no paths of a spec set no entry_path: then the first entry that the text names.
ENTRY_PATH = re.compile(r"\b(?:joints|bodies|drives|forces|stops|impulses|couplings|rolling|sections|analysis)\.\w+")
# problems with impulses give the bare name of an entry
IMPULSE_BLOCKS = ("impulses", "stops", "latches", "joints", "drives", "couplings", "rolling")
BLOCK_BY_CODE = {"contacts-undecided": "stops"}  # for problems that name no entry
FALLBACK = "analysis"  # the location of problems without any other


@contextmanager
def attach_locations(spec: Spec) -> Iterator[None]:
    """Add to every problem of a SolveError raised within the context its location in the spec."""
    try:
        yield
    except SolveError as error:
        error.replace_problems(*(problem._replace(location=find_location(problem, spec)) for problem in error.problems))
        raise


def find_location(problem: Problem, spec: Spec) -> SourceLocation:
    """Return the location of the entry that a problem is about, or of the first that its text names, or of the
    analysis.
    """
    if problem.location is not None:
        return problem.location
    candidates = (
        problem.entry_path,
        *(f"{block}.{problem.entry_path}" for block in IMPULSE_BLOCKS),
        BLOCK_BY_CODE.get(problem.code, ""),
    )
    paths = (*candidates, *ENTRY_PATH.findall(f"{problem.message} {problem.hint}"), FALLBACK)
    return spec.location(next((path for path in paths if path in spec.locations), "bodies"))
