"""`heun show`: solve a scene, and write a page that shows its motion."""

from __future__ import annotations

from pathlib import PurePath

from heuncli.app.cli import timeout
from heuncli.app.cli.entry import UsageError
from heuncli.app.cli.guard import is_same_file, require_other_file
from heuncli.app.cli.output import emit, save
from heuncli.app.cli.solving import make_solver_options, parse_overrides, print_warnings
from heuncli.app.cli.target import require_writable
from heuncli.app.cli.units import parse_units
from heuncli.app.commands.show.moving_glb import make_glb
from heuncli.app.commands.show.request import ShowRequest
from heuncli.base.errors import LimitError, Problem
from heuncli.base.files import STDOUT
from heuncli.base.records import replace
from heuncli.output.figures.courses import require_claimed
from heuncli.output.tables.page import TABLE_DEFAULT
from heuncli.output.web_page.frames import MAX_PAGE_FRAMES
from heuncli.output.web_page.moving_page import render_moving_page
from heuncli.scene.file_format.load import load
from heuncli.scene.file_format.models import Spec
from heuncli.study.model.setup import attach_locations
from heuncli.study.workflow import solve

ENDINGS = (".html", ".htm")
GLB = ".glb"
MIN_FRAMES, MAX_FRAMES = 2, 5000
MAX_BODIES = 500  # more cannot be moved smoothly in a browser
REPORTS = TABLE_DEFAULT | {"motion"}


def main(request: ShowRequest) -> int:
    """Run the command; returns the exit code."""
    output, glb = _require_output(request), _require_glb(request)
    _require_page(request)
    outputs = [(name, option) for name, option in ((output, "-o"), (glb, "--glb")) if name is not None]
    for name, option in outputs:
        require_other_file(name, [request.spec], option)
    units_shown, frame_count = parse_units(request.units), _parse_frame_count(request.frames)
    spec = load(request.spec, overrides=parse_overrides(request.set), checking=False, case=request.case)
    for name, option in outputs:
        require_other_file(name, [request.spec], option)
    _require_few_bodies(spec)
    options = replace(make_solver_options(request), requested_reports=REPORTS, time_limit=timeout.remaining_time())
    with attach_locations(spec):
        study = solve(spec, options)
        require_claimed(study)
        page = render_moving_page(study, units_shown, frame_count) if output is not None else ""
        moving = make_glb(study) if glb is not None else b""
    print_warnings(spec, study.results, request.quiet, later=study.later_warnings)
    if output is not None:
        emit(page, output)
    if glb is not None:
        save(moving, glb)
    return 0


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
            hint = f"accepted: {', '.join(ENDINGS)}; heun plot draws .svg, .png and .pdf"
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


def _require_page(request: ShowRequest) -> None:
    """Raise UsageError for options of the page if none is written."""
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
