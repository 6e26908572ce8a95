"""`heun export`: solve a scene, and write the load cases of a body; or write the scene as URDF or MJCF."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING, Annotated

from heuncli.analyses.load_cases import unit_systems
from heuncli.analyses.load_cases.assembly import assemble_load_cases, select_results
from heuncli.analyses.load_cases.model import LoadCases
from heuncli.analyses.load_cases.unit_systems import convert_load_cases
from heuncli.app.cli import timeout
from heuncli.app.cli.entry import UsageError
from heuncli.app.cli.options import CASE, QUIET, SET, SPEC, TIME_LIMIT, CaptionRequest, Option, SolverRequest
from heuncli.app.cli.output import emit, print_stderr
from heuncli.app.cli.solving import apply_captions, load_spec, make_solver_options, print_warnings, require_choice
from heuncli.app.cli.target import find_ending, require_other_file, require_writable
from heuncli.base.errors import Finding, Problem
from heuncli.base.files import STDOUT
from heuncli.base.named_tuples import NamedTuple
from heuncli.base.process import result_memory
from heuncli.base.records import replace
from heuncli.base.spelling import list_words, suggest
from heuncli.output.fe_decks.decks import DECKS, DeckNames, DeckNodes, explain_invalid_set
from heuncli.output.tables.nouns import format_count
from heuncli.scene.file_format.models import Spec
from heuncli.scene.file_format.names import ALL_CASES
from heuncli.study.model.memory import MemoryBudget
from heuncli.study.model.options import require_positive
from heuncli.study.model.selection import select_paths
from heuncli.study.model.setup import attach_locations
from heuncli.study.queries.at_option import InstantRequest, make_extreme_requests, parse
from heuncli.study.queries.study import Study
from heuncli.study.workflow import solve

if TYPE_CHECKING:
    from heuncli.analyses.load_cases.solid_mesh import SolidMesh
    from heuncli.study.queries.measure import MeasureRequest

LOADS = "loads"
WHAT = (LOADS, "urdf", "mjcf")  # loads, and the formats of scenes
FORMATS = ("csv", "json", "ansys", "nastran", "calculix", "abaqus")


class ExportRequest(NamedTuple):
    """The options and arguments of `heun export`."""

    what: Annotated[str, Option((), "What to export: loads of a body, or the scene as urdf or mjcf.", "|".join(WHAT))]
    spec: Annotated[str, SPEC]
    body: Annotated[
        str | None, Option(("--body",), "Body to export. Default: the only one.", "NAME", completes="body")
    ] = None
    at: Annotated[
        str | None,
        Option(
            ("--at",),
            "Instants, one load case each: a time, first, last, peak:PATH (largest magnitude), max:PATH, min:PATH, "
            "impulse:NAME or impulse:NUMBER. Default: the instant of a state, rest or impulse analysis.",
            "WHEN,...",
        ),
    ] = None
    format: Annotated[
        str | None,
        Option(("--format",), "Output format. Default: from the extension of -o FILE, else csv.", "|".join(FORMATS)),
    ] = None
    output: Annotated[
        str | None,
        Option(("--output", "-o"), "Output file, written atomically: .csv, .json, .bdf, .mac, .inp.", "FILE"),
    ] = None
    units: Annotated[
        str | None,
        Option(
            ("--units",), "Consistent units of force, length and mass, such as N,mm,t. Default: N,m,kg.", "UNIT,..."
        ),
    ] = None
    first_node: Annotated[
        int | None, Option(("--first-node",), "Number of the first node of a deck. Default: 1001.", "NUMBER")
    ] = None
    elements: Annotated[
        str | None,
        Option(
            ("--elements",),
            "Name of the element set in your mesh that holds the whole body, for decks. Default: BODY.",
            "NAME",
        ),
    ] = None
    mesh: Annotated[
        str | None,
        Option(
            ("--mesh",),
            "Solid mesh of the body for CalculiX; its nodes carry the inertia load of the angular acceleration.",
            "FILE",
        ),
    ] = None
    blow_over: Annotated[
        float | None,
        Option(("--blow-over",), "Convert impulses to mean loads over this duration; required for decks.", "SECONDS"),
    ] = None
    case: Annotated[str | None, CASE] = None
    set: Annotated[tuple[str, ...], SET] = ()
    captions: CaptionRequest = CaptionRequest()
    solver: SolverRequest = SolverRequest()
    time_limit: Annotated[float | None, TIME_LIMIT] = None
    quiet: Annotated[bool, QUIET] = False


ENDINGS = {".csv": "csv", ".json": "json", ".bdf": "nastran", ".dat": "nastran", ".nas": "nastran", ".mac": "ansys"}
AMBIGUOUS_ENDING = ".inp"  # the ending of both CalculiX and Abaqus
FIRST_NODE, LAST_NODE = 1001, 99_000_000
DEFAULT_SET = "BODY"


def main(request: ExportRequest) -> int:
    """Run the command; returns the exit code."""
    if require_choice("export", request.what, WHAT) != LOADS:
        return export_scene(request)
    require_other_file(request.output, [request.spec])
    form = choose_form(request)
    system = _parse_units(request.units)
    impulse_time = require_positive("--blow-over", request.blow_over)
    names = _parse_deck_names(request)
    instants = parse(request.at) if request.at is not None else []
    _require_one_case(request.case)
    spec = load_spec(request)
    spec = apply_captions(spec, request.captions)
    require_other_file(request.output, [request.spec])
    body = _select_body(request.body, spec)
    instants = instants or _choose_instant(spec)
    study = _solve_scene(request, spec, body, instants)
    with attach_locations(spec):
        cases = assemble_load_cases(study, body, instants)
    if impulse_time is not None:
        cases = cases.average_impulses(impulse_time)
    _require_writable(form, cases)
    written = convert_load_cases(cases, system)
    names = names._replace(mesh=_read_mesh(request, form, written, names))
    emit(DECKS[form].iter_text(written, names), request.output)
    if not request.quiet:
        _print_sums(written, form, names)
    print_warnings(spec, study.results, request.quiet, later=study.later_warnings)
    return 0


def export_scene(request: ExportRequest) -> int:
    """Write the scene, as it is assembled, in a format of robot programs; returns the exit code."""
    from importlib import import_module

    from heuncli.study.model.setup import set_up  # of few exports

    for name in ("body", "at", "format", "units", "first_node", "elements", "mesh", "blow_over"):
        if getattr(request, name) is not None:
            option = f"--{name.replace('_', '-')}"
            message = f"{option}: it is an option of heun export loads"
            raise UsageError(Problem("bad-option", message, hint=f"leave it out; {request.what} is in m, kg and rad"))
    require_other_file(request.output, [request.spec])
    if request.output is not None and request.output != STDOUT:
        require_writable(request.output)
    _require_one_case(request.case, f"a file of {request.what.upper()}")
    spec = load_spec(request)
    spec = apply_captions(spec, request.captions)
    require_other_file(request.output, [request.spec])
    with attach_locations(spec):
        scene = set_up(spec, reduce=False, find_rest=False).scene
    made = getattr(import_module(f"heuncli.output.{request.what}"), f"write_{request.what}")(spec, scene)
    emit([made.text], request.output)
    for note in () if request.quiet else made.notes:
        print_stderr(f"heun: {note}")
    return 0


def _require_one_case(case: str | None, file: str = "a deck") -> None:
    """Raise UsageError if all load cases are requested: a file holds one."""
    if case == ALL_CASES:
        message = f"--case all: {file} holds one load case of the spec"
        raise UsageError(Problem("bad-option", message, hint="use --case NAME, with one file each"))


def choose_form(request: ExportRequest) -> str:
    """Return the format of the deck, before any work. Raises UsageError, OutputError."""
    output = request.output
    if output is not None and output != STDOUT:
        require_writable(output)
    if request.format is not None:
        return require_choice("--format", request.format, FORMATS)
    if output is None or output == STDOUT:
        return FORMATS[0]
    ending = find_ending(output)
    if ending in ENDINGS:
        return ENDINGS[ending]
    if ending == AMBIGUOUS_ENDING:
        message = f"-o {output}: CalculiX and Abaqus both read .inp, but with different cards"
        raise UsageError(Problem("bad-option", message, hint="use --format calculix or --format abaqus"))
    known = ", ".join(f"{end} ({form})" for end, form in ENDINGS.items())
    hint = f"accepted: {known}; with --format {'|'.join(FORMATS)} any name is accepted"
    raise UsageError(Problem("bad-option", f"-o {output}: unknown file extension", hint=hint))


def _parse_units(words: str | None) -> unit_systems.UnitSystem:
    """Parse the consistent units of --units; SI by default. Raises UsageError."""
    if words is None:
        return unit_systems.SI
    try:
        return unit_systems.parse_units(words)
    except Finding as finding:
        raise UsageError(Problem("bad-option", f"--units {words}: {finding.message}", hint=finding.hint)) from None


def _parse_deck_names(request: ExportRequest) -> DeckNames:
    """Parse the first node and the element set of a deck. Raises UsageError."""
    first, elements = request.first_node or FIRST_NODE, request.elements or DEFAULT_SET
    if not 1 <= first <= LAST_NODE or request.first_node == 0:
        message = f"--first-node {request.first_node}: expected a whole number from 1 to {LAST_NODE}"
        raise UsageError(Problem("bad-option", message, hint=f"for example --first-node {FIRST_NODE}"))
    wrong = explain_invalid_set(elements)
    if wrong:
        raise UsageError(
            Problem("bad-option", f"--elements {elements}: {wrong}", hint="for example --elements ROD_ALL")
        )
    return DeckNames(first, elements)


def _select_body(name: str | None, spec: Spec) -> str:
    """Return the requested body, or the only one. Raises UsageError."""
    if name is None and len(spec.bodies) == 1:
        return next(iter(spec.bodies))
    if name is not None and name in spec.bodies:
        return name
    message = "no body is given" if name is None else f"--body {name}: there is no such body"
    hint = f"--body NAME, one of {list_words(spec.bodies)}" if name is None else suggest(name, spec.bodies, "bodies")
    raise UsageError(Problem("bad-option", message, hint=hint))


def _choose_instant(spec: Spec) -> list[InstantRequest]:
    """Return the instant of a scene that has only one. Raises UsageError if there are several."""
    if spec.analysis.type == "impulse":
        return parse("impulse:0")
    if spec.analysis.type in ("state", "rest"):
        return parse("first")
    hint = "for example --at peak:joints.NAME.force,last; one load case each"
    raise UsageError(Problem("bad-option", "--at: no instants are given", hint=hint))


def _solve_scene(request: ExportRequest, spec: Spec, body: str, instants: Sequence[InstantRequest]) -> Study:
    """Solve the scene as far as the load cases need it."""
    path_measures: list[MeasureRequest] = make_extreme_requests(instants)
    if path_measures:
        from heuncli.output.tables.measure import require_known_paths  # only needed for extremes

        require_known_paths(path_measures, spec, "--at")
    ends = {name: {joint.a, joint.b} for name, joint in spec.joints.items()}
    has_impulse = any(one.kind == "impulse" for one in instants)
    what = select_results(body, [name for name, options in ends.items() if body in options], has_impulse)
    what = what.union(select_paths([one.path for one in path_measures], spec)) if path_measures else what
    options = replace(
        make_solver_options(request.solver),
        requested_reports=what.reports,
        entries=what.entries,
        time_limit=timeout.remaining_time(),
        memory_budget=MemoryBudget(*result_memory("table")),
    )
    with attach_locations(spec):
        return solve(spec, options)


def _require_writable(form: str, cases: LoadCases) -> None:
    """Raise UsageError for an impulse in a deck, which can only hold forces."""
    impulse_cases = [case.name for case in cases.cases if case.is_impulse]
    if impulse_cases and DECKS[form].is_static:
        message = f"--at {impulse_cases[0]}: impulses are in {cases.units[0]} s, but a deck for {form} takes forces"
        hint = "--blow-over SECONDS gives the mean loads over this duration; or use --format csv"
        raise UsageError(Problem("bad-option", message, hint=hint))


def _read_mesh(request: ExportRequest, form: str, cases: LoadCases, names: DeckNames) -> SolidMesh | None:
    """Read the given mesh, for a deck that needs one. Raises UsageError, SpecError."""
    if request.mesh is None:
        if form == "calculix" and any(case.field.angular_acceleration.any() for case in cases.cases):
            message = "CalculiX has no angular acceleration load, which some load cases need"
            hint = "give --mesh FILE, the body mesh in these units, to load its nodes instead; other decks have a card"
            raise UsageError(Problem("bad-option", message, hint=hint))
        return None
    if form != "calculix":
        message = f"--mesh {request.mesh}: {form} needs no mesh: it has cards for all inertia loads"
        raise UsageError(Problem("bad-option", message, hint="leave it out"))
    from heuncli.analyses.load_cases.solid_mesh import read_mesh  # of few decks

    try:
        mesh = read_mesh(_read_text(request.mesh), request.mesh)
    except Finding as finding:
        raise UsageError(Problem(finding.code, f"--mesh {finding.message}", hint=finding.hint)) from None
    common_numbers = {node.number for node in DeckNodes(cases, names).nodes} & set(mesh.numbers.tolist())
    if common_numbers:
        message = f"--first-node {names.first_node}: the mesh already has a node {min(common_numbers)}"
        raise UsageError(Problem("bad-option", message, hint=f"for example --first-node {int(mesh.numbers.max()) + 1}"))
    return mesh


def _read_text(name: str) -> str:
    """Read the mesh file of --mesh. Raises UsageError."""
    from pathlib import Path  # of few decks

    try:
        return Path(name).read_text(encoding="latin-1")  # only comments may contain non-ASCII bytes
    except (OSError, ValueError) as reason:
        why = getattr(reason, "strerror", None) or str(reason)
        raise UsageError(Problem("bad-mesh", f"--mesh {name}: {why}", hint="give a readable file")) from None


def _print_sums(cases: LoadCases, form: str, names: DeckNames) -> None:
    """Print the load balance of each case to standard error, and remarks that a deck cannot contain."""
    for case in cases.cases:
        sums = cases.body.balance(case)
        largest = f"{sums.largest_force:.4g} {cases.units[0]}{' s' * case.is_impulse}"
        what = f"{format_count(len(case.actions), 'load')} and inertia, largest {largest}"
        remainder = f"force and moment sums balance to {sums.relative:.1e} of the largest"
        print_stderr(f"heun: {case.name}: t = {case.time:.6g} s, {what}, {remainder}")
    for note in DECKS[form].list_notes(cases, names):
        print_stderr(f"heun: {note}")
