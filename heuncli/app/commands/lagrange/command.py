"""`heun lagrange`: Lagrange's equations in numbers."""

from __future__ import annotations

from heuncli.analyses.lagrange.over import over
from heuncli.analyses.lagrange.study import LagrangeQuestion, lagrange
from heuncli.app.cli import alarm
from heuncli.app.cli.guard import require_other_file
from heuncli.app.cli.output import emit
from heuncli.app.cli.solving import overrides, warn
from heuncli.app.cli.target import format_of
from heuncli.app.cli.units import say_what_stays, units
from heuncli.app.commands.lagrange import course_page, forms, page
from heuncli.app.commands.lagrange.options import places, range_of, require_instant, require_together, words
from heuncli.app.commands.lagrange.request import LagrangeRequest
from heuncli.output.tables.export import dump
from heuncli.scene.file_format.load import load
from heuncli.scene.file_format.models import Spec
from heuncli.study.quantities.table_units import Units

FORMATS = ("table", "json", "csv", "m")


def main(request: LagrangeRequest) -> int:
    """Run the command; returns the exit code."""
    require_other_file(request.output, [request.spec])
    form = format_of(request.format, request.output, FORMATS)
    require_together(request, form)
    shown = units(request.units)
    asked = LagrangeQuestion(
        at=request.at,
        coordinates=words(request.coordinates),
        seen=places(request.seen),
        christoffel=request.christoffel,
        state_space=request.state_space,
        inputs=words(request.inputs),
        outputs=words(request.outputs),
        time_limit=alarm.remaining(),
    )
    spec = load(request.spec, overrides=overrides(request.set), checking=False, case=request.case)
    require_other_file(request.output, [request.spec])
    require_instant(request.at, spec)
    emit(written(spec, request, asked, form, shown), request.output)
    say_what_stays(request.units, form, request.quiet)
    warn(spec, None, request.quiet)
    return 0


def written(spec: Spec, request: LagrangeRequest, asked: LagrangeQuestion, form: str, shown: Units) -> str:
    """What is asked for, in one of the formats; tables in the units shown."""
    if request.over is not None:
        course = over(spec, range_of(request.over, spec))
        if form == "json":
            return dump(course_page.block(course))
        return course_page.to_csv(course) if form == "csv" else course_page.write(course, shown)
    found = lagrange(spec, asked)
    if form == "m" and found.state_space is not None:
        return forms.to_m(found.state_space)
    if form == "json":
        return dump(forms.block(found, words(request.only)))
    return forms.to_csv(found) if form == "csv" else page.write(found, words(request.only), shown)
