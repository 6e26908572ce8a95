"""`heun show`: read, solve, write the page."""

from __future__ import annotations

from pathlib import PurePath

from heuncli.app.cli import alarm
from heuncli.app.cli.entry import UsageError
from heuncli.app.cli.guard import require_other_file, same_file
from heuncli.app.cli.output import emit, save
from heuncli.app.cli.solving import overrides, solver_options, warn
from heuncli.app.cli.target import require_room
from heuncli.app.cli.units import units
from heuncli.app.commands.show.moving_glb import moving_glb
from heuncli.app.commands.show.request import ShowRequest
from heuncli.base.errors import LimitError, Problem
from heuncli.base.files import STDOUT
from heuncli.base.records import replace
from heuncli.output.figures.courses import require_claimed
from heuncli.output.tables.page import TABLE_DEFAULT
from heuncli.output.web_page.frames import MOST
from heuncli.output.web_page.moving_page import moving_page
from heuncli.scene.file_format.load import load
from heuncli.scene.file_format.models import Spec
from heuncli.study.model.error_places import placed
from heuncli.study.workflow import solve

ENDINGS = (".html", ".htm")
GLB = ".glb"
LEAST_FRAMES, MOST_FRAMES = 2, 5000
MOST_BODIES = 500  # of a page: more cannot be turned and moved smoothly in a browser
REPORTS = TABLE_DEFAULT | {"motion"}


def main(request: ShowRequest) -> int:
    """Run the command; returns the exit code."""
    output, glb = _output(request), _glb(request)
    _require_page(request)
    outputs = [(name, option) for name, option in ((output, "-o"), (glb, "--glb")) if name is not None]
    for name, option in outputs:
        require_other_file(name, [request.spec], option)
    shown, most = units(request.units), _most(request.frames)
    spec = load(request.spec, overrides=overrides(request.set), checking=False, case=request.case)
    for name, option in outputs:
        require_other_file(name, [request.spec], option)
    _require_few(spec)
    options = replace(solver_options(request), wanted=REPORTS, time_limit=alarm.remaining())
    with placed(spec):
        study = solve(spec, options)
        require_claimed(study)
        page = moving_page(study, shown, most) if output is not None else ""
        moving = moving_glb(study) if glb is not None else b""
    warn(spec, study.results, request.quiet, later=study.later_warnings)
    if output is not None:
        emit(page, output)
    if glb is not None:
        save(moving, glb)
    return 0


def _output(request: ShowRequest) -> str | None:
    """Where the page goes, if one is wanted. Raises UsageError, OutputError."""
    name = request.output
    if name is None:
        if request.glb is None:
            message = "where the page goes is not said"
            raise UsageError(Problem("bad-option", message, hint="-o machine.html; -o - for standard output"))
        return None
    if name != STDOUT:
        if name and PurePath(name).suffix.lower() not in ENDINGS:
            hint = f"known endings: {', '.join(ENDINGS)}; heun plot draws .svg, .png and .pdf"
            raise UsageError(Problem("bad-option", f"-o {name}: no page is known by that ending", hint=hint))
        require_room(name)
    return name


def _glb(request: ShowRequest) -> str | None:
    """Where the moving bodies go, if they are wanted. Raises UsageError, OutputError."""
    name = request.glb
    if name is None:
        return None
    if PurePath(name).suffix.lower() != GLB:
        message = f"--glb {name}: no glTF in one file is known by that ending"
        raise UsageError(Problem("bad-option", message, hint=f"known ending: {GLB}"))
    require_room(name, "--glb")
    if same_file("/dev/stdout" if request.output == STDOUT else request.output, name):
        raise UsageError(Problem("bad-option", f"--glb {name}: that is where the page goes", hint="name another file"))
    return name


def _require_page(request: ShowRequest) -> None:
    """Raise UsageError for options of the page where none is written."""
    given = [("--frames", request.frames), ("--units", request.units)]
    idle = [option for option, value in given if value is not None] if request.output is None else []
    if idle:
        message = f"{', '.join(idle)}: of the page, and none is written; a file of moving bodies is in SI"
        raise UsageError(Problem("bad-option", message, hint="leave it out, or say where the page goes: -o x.html"))


def _most(frames: int | None) -> int:
    """How many frames the page may hold. Raises UsageError."""
    if frames is None:
        return MOST
    if not LEAST_FRAMES <= frames <= MOST_FRAMES:
        message = f"--frames {frames}: expected {LEAST_FRAMES} to {MOST_FRAMES}"
        raise UsageError(Problem("bad-option", message, hint=f"default: {MOST}"))
    return frames


def _require_few(spec: Spec) -> None:
    """No more bodies than a page bears. Raises LimitError."""
    if len(spec.bodies) > MOST_BODIES:
        message = f"the scene has {len(spec.bodies):,} bodies; a page shows at most {MOST_BODIES}"
        raise LimitError(Problem("output-size", message, hint="heun run tells the loads of any number of bodies"))
