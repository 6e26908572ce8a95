"""`heun export loads`: read, solve, and write the load cases of a body."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

from heuncli.analyses.load_cases import unit_systems
from heuncli.analyses.load_cases.gathered import gathered, needed_for
from heuncli.analyses.load_cases.model import LoadCases
from heuncli.analyses.load_cases.unit_systems import in_units
from heuncli.app.cli import alarm, memory
from heuncli.app.cli.entry import UsageError
from heuncli.app.cli.guard import require_other_file
from heuncli.app.cli.output import emit, say
from heuncli.app.cli.solving import choice, overrides, solver_options, warn
from heuncli.app.cli.target import require_room
from heuncli.app.commands.exporting.request import FORMATS, WHAT, ExportRequest
from heuncli.base.errors import Finding, Problem
from heuncli.base.files import STDOUT
from heuncli.base.nearest import did_you_mean, listed
from heuncli.base.records import replace
from heuncli.output.fe_decks.naming import DeckNames, DeckNodes, unfit_set
from heuncli.output.fe_decks.registry import DECKS
from heuncli.output.tables.plurals import count
from heuncli.scene.file_format.load import load
from heuncli.scene.file_format.models import Spec
from heuncli.scene.file_format.names import ALL_CASES
from heuncli.study.ask.asked_instants import AskedInstant, measures, parse
from heuncli.study.ask.asked_values import positive
from heuncli.study.ask.study import Study
from heuncli.study.model.error_places import placed
from heuncli.study.model.memory_estimate import Room
from heuncli.study.model.selection import asked_by
from heuncli.study.workflow import solve

if TYPE_CHECKING:
    from heuncli.analyses.load_cases.solid_mesh import SolidMesh
    from heuncli.study.ask.measure import MeasureRequest

ENDINGS = {".csv": "csv", ".json": "json", ".bdf": "nastran", ".dat": "nastran", ".nas": "nastran", ".mac": "ansys"}
BOTH = ".inp"  # of two programs
FIRST_NODE, LAST_NODE = 1001, 99_000_000
SET_OF_ALL = "BODY"


def main(request: ExportRequest) -> int:
    """Run the command; returns the exit code."""
    choice("heun export", request.what, WHAT)
    require_other_file(request.output, [request.spec])
    form = form_of(request)
    system = _units(request.units)
    over = positive("--blow-over", request.blow_over)
    names = _deck_names(request)
    asked = parse(request.at) if request.at is not None else []
    _require_one_case(request.case)
    spec = load(request.spec, overrides=overrides(request.set), checking=False, case=request.case)
    require_other_file(request.output, [request.spec])
    body = _body(request.body, spec)
    asked = asked or _of_a_state(spec)
    study = _solved(request, spec, body, asked)
    with placed(spec):
        cases = gathered(study, body, asked)
    if over is not None:
        cases = cases.taken_over(over)
    _require_writable(form, cases)
    written = in_units(cases, system)
    names = names._replace(mesh=_mesh(request, form, written, names))
    emit(DECKS[form].written(written, names), request.output)
    if not request.quiet:
        _say_sums(written, form, names)
    warn(spec, study.results, request.quiet, later=study.later_warnings)
    return 0


def _require_one_case(case: str | None) -> None:
    if case == ALL_CASES:
        message = "--case all: a deck is of one load case of the spec"
        raise UsageError(Problem("bad-option", message, hint="--case NAME, and a file for each"))


def form_of(request: ExportRequest) -> str:
    """The form that is asked for, before any work. Raises UsageError, OutputError."""
    output = request.output
    if output is not None and output != STDOUT:
        require_room(output)
    if request.format is not None:
        return choice("--format", request.format, FORMATS)
    if output is None or output == STDOUT:
        return FORMATS[0]
    ending = output[output.rfind(".") :].lower() if "." in output.rpartition("/")[2] else ""
    if ending in ENDINGS:
        return ENDINGS[ending]
    if ending == BOTH:
        message = f"-o {output}: CalculiX and Abaqus read .inp, and not all the same cards"
        raise UsageError(Problem("bad-option", message, hint="--format calculix or --format abaqus"))
    known = ", ".join(f"{end} ({form})" for end, form in ENDINGS.items())
    hint = f"known endings: {known}; with --format {'|'.join(FORMATS)} any name will do"
    raise UsageError(Problem("bad-option", f"-o {output}: no deck is known by that ending", hint=hint))


def _units(words: str | None) -> unit_systems.UnitSystem:
    if words is None:
        return unit_systems.SI
    try:
        return unit_systems.asked(words)
    except Finding as finding:
        raise UsageError(Problem("bad-option", f"--units {words}: {finding.message}", hint=finding.hint)) from None


def _deck_names(request: ExportRequest) -> DeckNames:
    first, elements = request.first_node or FIRST_NODE, request.elements or SET_OF_ALL
    if not 1 <= first <= LAST_NODE or request.first_node == 0:
        message = f"--first-node {request.first_node}: expected a whole number from 1 to {LAST_NODE}"
        raise UsageError(Problem("bad-option", message, hint=f"such as --first-node {FIRST_NODE}"))
    wrong = unfit_set(elements)
    if wrong:
        raise UsageError(Problem("bad-option", f"--elements {elements}: {wrong}", hint="such as --elements ROD_ALL"))
    return DeckNames(first, elements)


def _body(name: str | None, spec: Spec) -> str:
    """The body that is asked for, or the only one. Raises UsageError."""
    if name is None and len(spec.bodies) == 1:
        return next(iter(spec.bodies))
    if name is not None and name in spec.bodies:
        return name
    said = "which body is not said" if name is None else f"--body {name}: there is no such body"
    hint = f"--body NAME, of {listed(spec.bodies)}" if name is None else did_you_mean(name, spec.bodies, "bodies")
    raise UsageError(Problem("bad-option", said, hint=hint))


def _of_a_state(spec: Spec) -> list[AskedInstant]:
    """What is taken where nothing is asked for: the one instant. Raises UsageError where there are several."""
    if spec.analysis.type == "impulse":
        return parse("impulse:0")
    if spec.analysis.type in ("state", "rest"):
        return parse("first")
    hint = "such as --at peak:joints.NAME.force,last; a case each"
    raise UsageError(Problem("bad-option", "--at: when the loads are taken is not said", hint=hint))


def _solved(request: ExportRequest, spec: Spec, body: str, asked: Sequence[AskedInstant]) -> Study:
    """The scene solved as far as the cases need it."""
    several: list[MeasureRequest] = measures(asked)
    if several:
        from heuncli.output.snapshots.measure import check  # where extremes are asked for

        check(several, spec, "--at")
    ends = {name: {joint.a, joint.b} for name, joint in spec.joints.items()}
    blows = any(one.kind == "impulse" for one in asked)
    what = needed_for(body, [name for name, own in ends.items() if body in own], blows)
    what = what.with_all(asked_by([one.path for one in several], spec)) if several else what
    own = replace(solver_options(request), wanted=what.reports, entries=what.entries,
                  time_limit=alarm.remaining(), room=Room(*memory.room("table")))  # fmt: skip
    with placed(spec):
        return solve(spec, own)


def _require_writable(form: str, cases: LoadCases) -> None:
    """Raise UsageError for a blow in a deck, which knows forces."""
    struck = [case.name for case in cases.cases if case.struck]
    if struck and DECKS[form].static:
        message = f"--at {struck[0]}: a blow is told in {cases.units[0]} s, and a deck for {form} knows forces"
        hint = "--blow-over SECONDS gives the mean loads of so long a time; or --format csv"
        raise UsageError(Problem("bad-option", message, hint=hint))


def _mesh(request: ExportRequest, form: str, cases: LoadCases, names: DeckNames) -> SolidMesh | None:
    """The mesh that was given, of a deck that needs one. Raises UsageError, SpecError."""
    if request.mesh is None:
        if form == "calculix" and any(case.field.angular_acceleration.any() for case in cases.cases):
            message = "CalculiX has no load of angular acceleration, which some of the cases have"
            hint = "--mesh FILE, the mesh of the body in these units: its nodes then take it; other decks have a card"
            raise UsageError(Problem("bad-option", message, hint=hint))
        return None
    if form != "calculix":
        message = f"--mesh {request.mesh}: {form} needs none, for it has cards for all of the inertia"
        raise UsageError(Problem("bad-option", message, hint="leave it out"))
    from heuncli.analyses.load_cases.solid_mesh import read_mesh  # of few decks

    try:
        mesh = read_mesh(_text(request.mesh), request.mesh)
    except Finding as finding:
        raise UsageError(Problem(finding.code, f"--mesh {finding.message}", hint=finding.hint)) from None
    taken = {node.number for node in DeckNodes(cases, names).nodes} & set(mesh.numbers.tolist())
    if taken:
        message = f"--first-node {names.first_node}: the mesh has a node {min(taken)} of its own"
        raise UsageError(Problem("bad-option", message, hint=f"such as --first-node {int(mesh.numbers.max()) + 1}"))
    return mesh


def _text(name: str) -> str:
    """The text of a file. Raises UsageError."""
    from pathlib import Path  # of few decks

    try:
        return Path(name).read_text(encoding="latin-1")  # numbers and names of elements; comments may be anything
    except (OSError, ValueError) as reason:
        why = getattr(reason, "strerror", None) or str(reason)
        raise UsageError(Problem("bad-mesh", f"--mesh {name}: {why}", hint="a file that can be read")) from None


def _say_sums(cases: LoadCases, form: str, names: DeckNames) -> None:
    """The sums of each case, and what a deck cannot say by itself, on standard error."""
    for case in cases.cases:
        sums = cases.body.balance(case)
        largest = f"{sums.largest_force:.4g} {cases.units[0]}{' s' * case.struck}"
        what = f"{count(len(case.actions), 'load')} and inertia, the largest {largest}"
        left = f"sums of forces and moments {sums.relative:.1e} of the largest"
        say(f"heun: {case.name}: t = {case.time:.6g} s, {what}, {left}")
    for note in DECKS[form].notes(cases, names):
        say(f"heun: {note}")
