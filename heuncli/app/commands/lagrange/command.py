"""`heun lagrange`: compute Lagrange's equations in numbers."""

from __future__ import annotations

from heuncli.analyses.lagrange.inertia_curve import find_inertia_curve
from heuncli.analyses.lagrange.study import LagrangeOptions, solve_lagrange
from heuncli.app.cli import timeout
from heuncli.app.cli.documents import emit_document
from heuncli.app.cli.guard import require_other_file
from heuncli.app.cli.output import emit
from heuncli.app.cli.solving import parse_overrides, print_warnings
from heuncli.app.cli.target import choose_format, note_si_format, parse_units
from heuncli.app.commands.lagrange import course_page, forms, page
from heuncli.app.commands.lagrange.options import (
    parse_names,
    parse_places,
    parse_range,
    require_instant,
    require_together,
)
from heuncli.app.commands.lagrange.request import LagrangeRequest
from heuncli.scene.file_format.load import load
from heuncli.scene.file_format.models import Spec
from heuncli.study.quantities.table_units import Units

FORMATS = ("table", "json", "csv", "m")


def main(request: LagrangeRequest) -> int:
    """Run the command; returns the exit code."""
    require_other_file(request.output, [request.spec])
    form = choose_format(request.format, request.output, FORMATS)
    require_together(request, form)
    units_shown = parse_units(request.units)
    question = LagrangeOptions(
        at=request.at,
        coordinates=parse_names(request.coordinates),
        seen=parse_places(request.seen),
        christoffel=request.christoffel,
        state_space=request.state_space,
        inputs=parse_names(request.inputs),
        outputs=parse_names(request.outputs),
        time_limit=timeout.remaining_time(),
    )
    spec = load(request.spec, overrides=parse_overrides(request.set), checking=False, case=request.case)
    require_other_file(request.output, [request.spec])
    require_instant(request.at, spec)
    write_result(spec, request, question, form, units_shown)
    note_si_format(request.units, form, request.quiet)
    print_warnings(spec, None, request.quiet)
    return 0


def write_result(spec: Spec, request: LagrangeRequest, question: LagrangeOptions, form: str, units: Units) -> None:
    """Compute the requested result, and write it in a format; tables in the given units."""
    if request.over is not None:
        course = find_inertia_curve(spec, parse_range(request.over, spec))
        emit_document(course_page.make_document(course, units), form, request.output)
        return
    results = solve_lagrange(spec, question)
    if form == "m" and results.state_space is not None:
        emit(forms.to_m(results.state_space), request.output)
    else:
        emit_document(page.make_document(results, parse_names(request.only), units), form, request.output)
