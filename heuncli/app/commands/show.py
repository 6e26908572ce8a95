"""`heun show`: solve a scene, and write its motion as a page, a picture, a film, or as glTF."""

from __future__ import annotations

import math
from pathlib import PurePath
from typing import Annotated

from heuncli.app.cli import timeout
from heuncli.app.cli.entry import UsageError
from heuncli.app.cli.options import CASE, QUIET, SET, SPEC, TIME_LIMIT, CaptionRequest, Option, SolverRequest
from heuncli.app.cli.output import emit, save
from heuncli.app.cli.solving import (
    apply_captions_to_cases,
    make_solver_options,
    parse_overrides,
    print_warnings,
    require_cases,
)
from heuncli.app.cli.target import is_output, parse_units, require_other_file, require_writable
from heuncli.app.films import FILM_FORMATS, FilmFormat, FilmPrograms, draw_film, find_format, find_programs, make_film
from heuncli.base import tolerances
from heuncli.base.errors import LimitError, Problem
from heuncli.base.files import STDOUT
from heuncli.base.named_tuples import NamedTuple
from heuncli.base.records import replace
from heuncli.output.figures.courses import choose_instants, require_claimed
from heuncli.output.machine_geometry.gltf import encode_gltf
from heuncli.output.machine_geometry.poses import compute_poses, find_up_direction
from heuncli.output.tables.page import TABLE_DEFAULT
from heuncli.output.web_page.frames import MAX_PAGE_FRAMES
from heuncli.output.web_page.geometry import make_page_machine
from heuncli.output.web_page.moving_page import render_film_page, render_moving_page
from heuncli.scene.file_format.load import load, load_with_cases
from heuncli.scene.file_format.models import Spec
from heuncli.scene.file_format.names import ALL_CASES
from heuncli.study.model.setup import attach_locations
from heuncli.study.queries.study import Study
from heuncli.study.search.columns import find_largest_turns
from heuncli.study.workflow import solve


class ShowRequest(NamedTuple):
    """The options and arguments of `heun show`."""

    spec: Annotated[str, SPEC]
    output: Annotated[
        str | None,
        Option(
            ("--output", "-o"),
            "Output file: page x.html, or x.png, x.gif, x.mp4 made by programs on PATH; - is standard output.",
            "FILE",
        ),
    ] = None
    glb: Annotated[str | None, Option(("--glb",), "Also write the moving bodies as animated glTF: x.glb.", "FILE")] = (
        None
    )
    frames: Annotated[
        int | None, Option(("--frames",), "Maximum number of instants on the page. Default: 600.", "NUMBER")
    ] = None
    at: Annotated[
        float | None, Option(("--at",), "Instant of x.png [s]. Default: when the joint forces are greatest.", "T")
    ] = None
    units: Annotated[str | None, Option(("--units",), "Units of the page, such as kN,mm,deg,rpm.", "UNIT,...")] = None
    set: Annotated[tuple[str, ...], SET] = ()
    captions: CaptionRequest = CaptionRequest()
    case: Annotated[str | None, CASE] = None
    solver: SolverRequest = SolverRequest()
    time_limit: Annotated[float | None, TIME_LIMIT] = None
    quiet: Annotated[bool, QUIET] = False


class ShowTarget(NamedTuple):
    """The files that are written, and how a picture or film is made.

    output: file of the page, the picture or the film; None if none is requested
    glb: file of the moving bodies as glTF; None if none is requested
    film_format: format of the picture or film; None for a page
    programs: the programs that make the picture or film
    """

    output: str | None
    glb: str | None
    film_format: FilmFormat | None = None
    programs: FilmPrograms | None = None


PAGE_ENDINGS = (".html", ".htm")
ENDINGS = (*PAGE_ENDINGS, *FILM_FORMATS)
GLB = ".glb"
MIN_FRAMES, MAX_FRAMES = 2, 5000
MAX_BODIES = 500  # more cannot be moved smoothly in a browser
REPORTS = TABLE_DEFAULT | {"motion"}


def main(request: ShowRequest) -> int:
    """Run the command; returns the exit code."""
    target = _require_target(request)
    units, frame_count = parse_units(request.units), _parse_frame_count(request.frames)
    specs = apply_captions_to_cases(_load_cases(request), request.captions)
    _require_other_files(target, request.spec)  # than the spec's data files, which are known now
    studies = {case: _solve_case(spec, request) for case, spec in specs.items()}
    case, study = next(iter(studies.items()))
    moving_bodies = make_glb(study) if target.glb is not None else b""
    page, film = "", b""
    if target.film_format is not None:
        film = _draw_film(target, render_film_page(study, units, make_film(target.film_format, request.at), case))
    elif target.output is not None:
        page = render_moving_page(studies, units, frame_count)
    for name, solved in studies.items():
        print_warnings(specs[name], solved.results, request.quiet, later=solved.later_warnings)
    if target.output is not None and target.film_format is not None:
        save(film, target.output)
    elif target.output is not None:
        emit(page, target.output)
    if target.glb is not None:
        save(moving_bodies, target.glb)
    return 0


def _require_target(request: ShowRequest) -> ShowTarget:
    """Return the files to write. Raises UsageError for options that do not fit, OutputError if one cannot be written or
    a program is missing.
    """
    target = ShowTarget(_require_output(request), _require_glb(request))
    form = find_format(target.output)
    _require_fitting_options(request, form)
    _require_other_files(target, request.spec)
    return target._replace(film_format=form, programs=None if form is None else find_programs(form))


def _require_other_files(target: ShowTarget, spec: str) -> None:
    """Raise UsageError if the output would overwrite the spec or a file read so far."""
    for name, option in ((target.output, "-o"), (target.glb, "--glb")):
        if name is not None:
            require_other_file(name, [spec], option)


def _draw_film(target: ShowTarget, page: str) -> bytes:
    """Draw the picture or film of a page. Raises OutputError."""
    assert target.output is not None and target.film_format is not None and target.programs is not None
    return draw_film(page, target.film_format, target.programs, PurePath(target.output).suffix.lower())


def _load_cases(request: ShowRequest) -> dict[str, Spec]:
    """Load the spec in the requested case, or in all cases; returns them by name, "" is the spec as it is."""
    settings = parse_overrides(request.set)
    if request.case == ALL_CASES:
        specs = load_with_cases(request.spec, settings, checking=False)[1]
        require_cases(specs)
    else:
        specs = {request.case or "": load(request.spec, overrides=settings, checking=False, case=request.case)}
    _require_few_bodies(next(iter(specs.values())))
    return specs


def _solve_case(spec: Spec, request: ShowRequest) -> Study:
    """Solve a spec for motion and loads."""
    options = replace(
        make_solver_options(request.solver), requested_reports=REPORTS, time_limit=timeout.remaining_time()
    )
    with attach_locations(spec):
        study = solve(spec, options)
        require_claimed(study)
    return study


def _require_output(request: ShowRequest) -> str | None:
    """Return the file of the page, or None if none is requested. Raises UsageError, OutputError."""
    name = request.output
    if name is None:
        if request.glb is None:
            message = "no output file is given"
            raise UsageError(Problem("bad-option", message, hint="-o machine.html; -o - for standard output"))
        return None
    if name != STDOUT:
        if name and PurePath(name).suffix.lower() not in ENDINGS:
            hint = f"accepted: {', '.join(ENDINGS)}; heun plot draws .svg and .pdf"
            raise UsageError(Problem("bad-option", f"-o {name}: unknown file extension", hint=hint))
        require_writable(name)
    return name


def _require_glb(request: ShowRequest) -> str | None:
    """Return the file of the moving bodies, or None if none is requested. Raises UsageError, OutputError."""
    name = request.glb
    if name is None:
        return None
    if PurePath(name).suffix.lower() != GLB:
        message = f"--glb {name}: unknown file extension"
        raise UsageError(Problem("bad-option", message, hint=f"accepted: {GLB}"))
    require_writable(name, "--glb")
    if request.output is not None and is_output(name, request.output):
        raise UsageError(
            Problem("bad-option", f"--glb {name}: the page is written to this file", hint="name another file")
        )
    return name


def _require_fitting_options(request: ShowRequest, form: FilmFormat | None) -> None:
    """Raise UsageError for options of a picture or a page if none is written, and for all cases where one is drawn."""
    if request.at is not None and form is not FILM_FORMATS[".png"]:
        message = "--at: only for a picture, -o x.png"
        raise UsageError(Problem("bad-option", message, hint="leave it out; a page shows all instants"))
    if request.case == ALL_CASES and (form is not None or request.glb is not None):
        message = "--case all: a page shows all load cases; a picture, a film or a glTF file shows one"
        raise UsageError(Problem("bad-option", message, hint="name one of the cases"))
    if form is not None and request.frames is not None:
        raise UsageError(Problem("bad-option", "--frames: only for the page", hint="leave it out"))
    page_options = [("--frames", request.frames), ("--units", request.units)]
    unused = [option for option, value in page_options if value is not None] if request.output is None else []
    if unused:
        message = f"{', '.join(unused)}: only for the page, and none is written; the glTF file is in SI"
        raise UsageError(Problem("bad-option", message, hint="leave it out, or give the page: -o x.html"))


def _parse_frame_count(frames: int | None) -> int:
    """Return the largest number of frames of the page. Raises UsageError."""
    if frames is None:
        return MAX_PAGE_FRAMES
    if not MIN_FRAMES <= frames <= MAX_FRAMES:
        message = f"--frames {frames}: expected {MIN_FRAMES} to {MAX_FRAMES}"
        raise UsageError(Problem("bad-option", message, hint=f"default: {MAX_PAGE_FRAMES}"))
    return frames


def _require_few_bodies(spec: Spec) -> None:
    """Raise LimitError if there are more bodies than a page can show."""
    if len(spec.bodies) > MAX_BODIES:
        message = f"the model has {len(spec.bodies):,} bodies; a page shows at most {MAX_BODIES}"
        raise LimitError(Problem("output-size", message, hint="heun run reports the loads of any number of bodies"))


FAST_TURN = "--glb: a body rotates up to {:.0f}° between two instants; the animation between them is not accurate"


def make_glb(study: Study) -> bytes:
    """Make the glTF file of a solved motion; adds a warning to the study if its instants are too far apart."""
    times = choose_instants(study)
    if not study.has_one_instant and len(times) > 1:
        turned = float(find_largest_turns(study.setup, study.history, times).max(initial=0.0))
        if turned > tolerances.MAX_INTERPOLATED_TURN:
            study.later_warnings[FAST_TURN.format(math.degrees(turned))] = None
    poses = compute_poses(study, times)
    return encode_gltf(make_page_machine(study.spec, study.setup.scene), poses, find_up_direction(study.spec, poses))
