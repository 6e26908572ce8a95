"""`heun show`: solve a scene, and write a page that shows its motion, or a picture or film of it.

A page is drawn by Chromium or Chrome, a video is made of its frames by ffmpeg. The programs get a temporary folder and
no network. They are found on PATH when they are needed. Impure: runs programs.
"""

from __future__ import annotations

import base64
import binascii
import math
import re
import tempfile
from pathlib import Path, PurePath
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
from heuncli.app.cli.target import is_same_file, parse_units, require_other_file, require_writable
from heuncli.base import tolerances
from heuncli.base.errors import LimitError, OutputError, Problem
from heuncli.base.files import STDOUT
from heuncli.base.named_tuples import NamedTuple
from heuncli.base.process import BROWSERS, find_program, list_browser_options, run_program
from heuncli.base.records import replace
from heuncli.output.figures.courses import choose_instants, require_claimed
from heuncli.output.machine_geometry.gltf import encode_gltf
from heuncli.output.machine_geometry.poses import compute_poses, find_up_direction
from heuncli.output.tables.page import TABLE_DEFAULT
from heuncli.output.web_page.frames import MAX_PAGE_FRAMES
from heuncli.output.web_page.geometry import make_page_machine
from heuncli.output.web_page.moving_page import Film, render_film_page, render_moving_page
from heuncli.scene.file_format.load import load, load_with_cases
from heuncli.scene.file_format.models import Spec
from heuncli.scene.file_format.names import ALL_CASES
from heuncli.study.model.setup import attach_locations
from heuncli.study.queries.study import Study
from heuncli.study.search.columns import find_largest_turns
from heuncli.study.workflow import solve

MAX_SECONDS = 300.0  # of a program, unless --time-limit leaves less
DRAW_BUDGET = 600_000  # ms of the browser's own time until it must have drawn all pictures
DRAWING_OPTIONS = (  # of the browser
    "--force-color-profile=srgb", f"--virtual-time-budget={DRAW_BUDGET}", "--blink-settings=preferredColorScheme=1",
)  # fmt: skip
ENCODER_OPTIONS = ("-y", "-loglevel", "error", "-i", "%05d.png", "-pix_fmt", "yuv420p", "-movflags", "+faststart")
HINT = "install Chromium or Chrome, and have it on PATH; or write -o machine.html, which needs no program"
ENCODER_HINT = "install ffmpeg, and have it on PATH; or write -o machine.gif, which needs Chromium or Chrome alone"
DRAWN = re.compile(rb'<pre id="film">([A-Za-z0-9+/= ]+)</pre>')


class FilmFormat(NamedTuple):
    """A kind of file: what the page draws for it, pictures a second, and whether a video program makes it of them.

    width, height: [pixels]
    scale: pixels of the picture for each of these
    """

    kind: str
    rate: float
    is_encoded: bool
    width: int = 1000
    height: int = 700
    scale: int = 1


FORMATS = {
    ".png": FilmFormat("png", 1.0, is_encoded=False, scale=2),
    ".gif": FilmFormat("gif", 20.0, is_encoded=False, width=800, height=560),
    ".mp4": FilmFormat("frames", 25.0, is_encoded=True),
}


class FilmPrograms(NamedTuple):
    """The paths of the browser and, for a video, of ffmpeg."""

    browser: str
    encoder: str = ""


def find_format(output: str | None) -> FilmFormat | None:
    """Return the format of a picture or film by the file's ending, None of a page."""
    return FORMATS.get(PurePath(output or "").suffix.lower())


def find_programs(form: FilmFormat) -> FilmPrograms:
    """Find the programs that a format needs. Raises OutputError."""
    browser = find_program(BROWSERS)
    if browser is None:
        raise OutputError(Problem("no-film-program", "no Chromium or Chrome was found on PATH", hint=HINT))
    encoder = find_program(("ffmpeg",)) if form.is_encoded else ""
    if encoder is None:
        raise OutputError(Problem("no-film-program", "no ffmpeg was found on PATH", hint=ENCODER_HINT))
    return FilmPrograms(browser, encoder)


def make_film(form: FilmFormat, instant: float | None) -> Film:
    """Make what the page is told to draw."""
    return Film(form.kind, form.width, form.height, form.rate, instant)  # type: ignore[arg-type]


def draw_film(page: str, form: FilmFormat, programs: FilmPrograms, ending: str) -> bytes:
    """Draw the pictures of a page, and make the file of them. Raises OutputError."""
    with tempfile.TemporaryDirectory(prefix="heun-", ignore_cleanup_errors=True) as name:
        folder = Path(name)
        pictures = _draw_pictures(page, form, programs.browser, folder)
        if not form.is_encoded:
            return pictures[0]
        for number, picture in enumerate(pictures):
            (folder / f"{number:05d}.png").write_bytes(picture)
        target = folder / f"film{ending}"
        words = [programs.encoder, "-framerate", f"{form.rate:g}", *ENCODER_OPTIONS, str(target)]
        _, message = run_program(words, name, timeout.limit_seconds(MAX_SECONDS))
        if not target.is_file() or not target.stat().st_size:
            raise OutputError(
                Problem("no-film-program", f"{programs.encoder} has written no video: {message}", hint=ENCODER_HINT)
            )
        return target.read_bytes()


def _draw_pictures(page: str, form: FilmFormat, browser: str, folder: Path) -> list[bytes]:
    """Let the browser draw, and read the pictures from the document that it prints."""
    source = folder / "film.html"
    source.write_text(page, encoding="utf-8")
    words = [
        browser, *(option.format(folder=folder) for option in list_browser_options()), *DRAWING_OPTIONS,
        f"--force-device-scale-factor={form.scale}", f"--window-size={form.width + 100},{form.height + 100}",
        "--dump-dom", source.as_uri(),
    ]  # fmt: skip
    printed, message = run_program(words, str(folder), timeout.limit_seconds(MAX_SECONDS))
    found = DRAWN.search(printed)
    try:
        pictures = [base64.b64decode(word, validate=True) for word in found[1].split()] if found else []
    except binascii.Error:
        pictures = []
    if not pictures:
        text = f"{browser} has drawn nothing{f': {message}' if message else ''}"
        raise OutputError(Problem("no-film-program", text, hint=HINT))
    return pictures


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


PAGE_ENDINGS = (".html", ".htm")
ENDINGS = (*PAGE_ENDINGS, *FORMATS)
GLB = ".glb"
MIN_FRAMES, MAX_FRAMES = 2, 5000
MAX_BODIES = 500  # more cannot be moved smoothly in a browser
REPORTS = TABLE_DEFAULT | {"motion"}


def main(request: ShowRequest) -> int:
    """Run the command; returns the exit code."""
    output, glb = _require_output(request), _require_glb(request)
    form, instant = find_format(output), _parse_instant(request)
    _require_page(request, form)
    outputs = [(name, option) for name, option in ((output, "-o"), (glb, "--glb")) if name is not None]
    for name, option in outputs:
        require_other_file(name, [request.spec], option)
    programs = None if form is None else find_programs(form)
    units_shown, frame_count = parse_units(request.units), _parse_frame_count(request.frames)
    specs = apply_captions_to_cases(_load_cases(request), request.captions)
    for name, option in outputs:
        require_other_file(name, [request.spec], option)
    studies = {case: _solve_case(spec, request) for case, spec in specs.items()}
    case, study = next(iter(studies.items()))
    moving = make_glb(study) if glb is not None else b""
    if output is not None and form is not None and programs is not None:
        page = render_film_page(study, units_shown, make_film(form, instant), case)
        film = draw_film(page, form, programs, PurePath(output).suffix.lower())
    elif output is not None:
        page = render_moving_page(studies, units_shown, frame_count)
    for name, solved in studies.items():
        print_warnings(specs[name], solved.results, request.quiet, later=solved.later_warnings)
    if output is not None and form is not None:
        save(film, output)
    elif output is not None:
        emit(page, output)
    if glb is not None:
        save(moving, glb)
    return 0


def _load_cases(request: ShowRequest) -> dict[str, Spec]:
    """Load the spec in the requested case, or in all, by the names of the cases; "" is the spec as it is."""
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


def _parse_instant(request: ShowRequest) -> float | None:
    """Return the instant of the picture [s]; None: of the greatest load. Raises UsageError."""
    if request.at is not None and find_format(request.output) is not FORMATS[".png"]:
        message = "--at: only for a picture, -o x.png"
        raise UsageError(Problem("bad-option", message, hint="leave it out; a page shows all instants"))
    return request.at


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
    if is_same_file("/dev/stdout" if request.output == STDOUT else request.output, name):
        raise UsageError(
            Problem("bad-option", f"--glb {name}: the page is written to this file", hint="name another file")
        )
    return name


def _require_page(request: ShowRequest, form: FilmFormat | None) -> None:
    """Raise UsageError for options of the page if none is written, and for all cases where one is drawn."""
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


WARNING = "--glb: a body rotates up to {:.0f}° between two instants; the animation between them is not accurate"


def make_glb(study: Study) -> bytes:
    """Make the glTF file of a solved motion; adds a warning to the study if its instants are too far apart."""
    times = choose_instants(study)
    if not study.has_one_instant and len(times) > 1:
        turned = float(find_largest_turns(study.setup, study.history, times).max(initial=0.0))
        if turned > tolerances.MAX_INTERPOLATED_TURN:
            study.later_warnings[WARNING.format(math.degrees(turned))] = None
    poses = compute_poses(study, times)
    return encode_gltf(make_page_machine(study.spec, study.setup.scene), poses, find_up_direction(study.spec, poses))
