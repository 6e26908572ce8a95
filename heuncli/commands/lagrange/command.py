"""`heun lagrange`: Lagrange's equations in numbers."""

from __future__ import annotations

from heuncli.cli import alarm
from heuncli.cli.guard import require_other_file
from heuncli.cli.output import emit
from heuncli.cli.solving import overrides, warn
from heuncli.cli.target import format_of
from heuncli.commands.lagrange import page
from heuncli.commands.lagrange.over import over
from heuncli.commands.lagrange.request import LagrangeRequest
from heuncli.commands.lagrange.study import Asked, lagrange
from heuncli.report.export import dump
from heuncli.spec.load import load
from heuncli.spec.models import Spec

FORMATS = ("table", "json", "csv")
ENDINGS = {".json": "json", ".csv": "csv", ".txt": "table", "": "table"}


def main(request: LagrangeRequest) -> int:
    """Run the command; returns the exit code."""
    require_other_file(request.output, [request.spec])
    form = format_of(request.format, request.output, ENDINGS, FORMATS)
    asked = Asked(
        at=request.at,
        coordinates=words(request.coordinates),
        seen=tuple(word.strip() for word in request.seen),
        christoffel=request.christoffel,
        time_limit=alarm.remaining(),
    )
    spec = load(request.spec, overrides=overrides(request.set), checking=False)
    require_other_file(request.output, [request.spec])
    emit(written(spec, request, asked, form), request.output)
    warn(spec, None, request.quiet)
    return 0


def written(spec: Spec, request: LagrangeRequest, asked: Asked, form: str) -> str:
    """What is asked for, in one of the formats."""
    if request.over is not None:
        course = over(spec, request.over)
        if form == "json":
            return dump(page.course_block(course))
        return page.course_csv(course) if form == "csv" else page.write_course(course)
    found = lagrange(spec, asked)
    if form == "json":
        return dump(page.block(found))
    return page.to_csv(found) if form == "csv" else page.write(found)


def words(given: str | None) -> tuple[str, ...]:
    """Names with commas between them."""
    return tuple(word.strip() for word in given.split(",")) if given else ()
