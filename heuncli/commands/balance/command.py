"""`heun balance`: mass effects over a cycle, by orders; what lowers them."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

from heuncli.cli.entry import UsageError
from heuncli.cli.files import STDOUT
from heuncli.cli.guard import require_other_file, same_file
from heuncli.cli.options import FORMATS
from heuncli.cli.output import emit, save
from heuncli.cli.solving import overrides, warn
from heuncli.cli.target import format_of, require_room
from heuncli.commands.balance import page as report
from heuncli.commands.balance.options import options
from heuncli.commands.balance.request import BalanceRequest
from heuncli.commands.balance.results import BalanceResults
from heuncli.commands.balance.study import balance
from heuncli.errors import Problem
from heuncli.report.export import dump
from heuncli.spec.load import load

PICTURES = {".svg": "svg", ".png": "png", ".pdf": "pdf"}


def main(request: BalanceRequest) -> int:
    """Run the command; returns the exit code."""
    require_other_file(request.output, [request.spec])
    form = format_of(request.format, request.output, FORMATS)
    drawn = picture_format(request)
    spec = load(request.spec, overrides=overrides(request.set), checking=False, case=request.case)
    require_other_file(request.output, [request.spec])
    if request.save is not None:
        require_other_file(request.save, [request.spec], "--save")
    found = balance(spec, options(request, spec))
    if drawn is not None and request.save is not None:
        save(drawn(found), request.save)
    if form == "json":
        text = dump(report.block(found))
    else:
        text = report.to_csv(found) if form == "csv" else report.write(found)
    emit(text, request.output)
    warn(spec, None, request.quiet)
    return 0


def picture_format(request: BalanceRequest) -> Callable[[BalanceResults], bytes] | None:
    """How the picture is drawn that is to be saved, by the end of its name."""
    if request.save is None:
        return None
    form = PICTURES.get(Path(request.save).suffix.lower())
    if form is None:
        hint = f"known endings: {', '.join(PICTURES)}"
        raise UsageError(Problem("bad-option", f"--save {request.save}: no picture is known by that ending", hint=hint))
    require_room(request.save, "--save")
    if same_file("/dev/stdout" if request.output in (None, STDOUT) else request.output, request.save):
        message = f"--save {request.save}: that is where the table goes"
        raise UsageError(Problem("bad-option", message, hint="name another file"))
    if form != "svg":
        from heuncli.drawing.matplotlib_file import require_plot

        require_plot(f"--save {request.save}")
    return lambda found: drawing(found, form)


def drawing(found: BalanceResults, form: str) -> bytes:
    """The picture as a file."""
    from heuncli.commands.balance.picture import picture

    if form == "svg":
        from heuncli.drawing.picture import svg

        return svg(picture(found)).encode()
    from heuncli.drawing.matplotlib_file import rendered

    return rendered(picture(found), form)
