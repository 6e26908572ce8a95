"""`heun sweep`: a scene solved with other values, a row a variant."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

from heuncli.cli import measure
from heuncli.cli.entry import UsageError
from heuncli.cli.guard import require_other_file
from heuncli.cli.output import emit, say
from heuncli.cli.solving import overrides, positive, tolerance
from heuncli.cli.target import format_of
from heuncli.commands.sweep.request import FORMATS, SweepRequest
from heuncli.commands.sweep.rows import SweepHead, SweptMeasure, SweptRow
from heuncli.commands.sweep.told import FORMS
from heuncli.errors import Problem
from heuncli.spec.source import text_in
from heuncli.study.model.options import Options
from heuncli.variants.asking import CASE, Asker, Recipe, varies_cases
from heuncli.variants.axes import HINT, Drawn, ParameterAxis, axis_of
from heuncli.variants.plans import Plan, plan_of
from heuncli.variants.stated import unit_of
from heuncli.version import VERSION

ENDINGS = {".json": "json", ".csv": "csv", ".txt": "table", "": "table"}


def main(request: SweepRequest) -> int:
    """Run the command; returns the exit code."""
    path, words = spec_and_axes(request.words)
    require_other_file(request.output, [path])
    form = format_of(request.format, request.output, ENDINGS, FORMATS)
    recipe = recipe_of(request, path)
    asker = Asker(recipe)
    measure.check(recipe.measures, asker.spec)
    plan = _plan(request, words, asker)
    head = head_of(request, asker, plan)
    rows = on_cluster(request, asker, plan) if request.dask is not None else list(answered(asker, plan))
    emit(FORMS[form](head, rows), request.output)
    return 1 if request.strict and any(row.answer.code for row in rows) else 0


def spec_and_axes(words: Sequence[str]) -> tuple[str, list[str]]:
    """The spec's file, and what is varied. Raises UsageError."""
    files = [word for word in words if "=" not in word]
    if len(files) != 1:
        found = f"{len(files)} files: {', '.join(files)}" if files else "no spec is named"
        raise UsageError(Problem("bad-option", f"sweep: {found}", hint="heun sweep SPEC NAME=VALUES --measure WHAT"))
    return files[0], [word for word in words if "=" in word]


def recipe_of(request: SweepRequest, path: str) -> Recipe:
    """What every variant is made of. Raises UsageError, SpecError."""
    if not request.measure:
        hint = "such as --measure 'max abs joints.main.force'"
        raise UsageError(Problem("bad-option", "sweep: nothing is measured", hint=hint))
    options = Options(
        tolerance=tolerance(request.tolerance),
        method=request.method,
        step=positive("--step", request.step),
        least_norm=request.least_norm,
        reduce=not request.no_reduce,
    )
    measures = tuple(measure.parse_all(request.measure))
    return Recipe(path, text_in(path), measures, options, overrides(request.set))


def _plan(request: SweepRequest, words: Sequence[str], asker: Asker) -> Plan:
    """The variants. Raises AxisError."""
    if not words:
        raise UsageError(Problem("bad-option", "sweep: nothing is varied", hint=HINT))
    axes = [axis_of(word) for word in words]
    own = [axis for axis in axes if not isinstance(axis, Drawn)]
    if varies_cases(asker.spec):
        own = [_cases(axis, asker) if axis.name == CASE else axis for axis in own]
    return plan_of(own, together=request.zip)


def _cases(axis: ParameterAxis, asker: Asker) -> ParameterAxis:
    """The load cases that are named, or all of them."""
    return ParameterAxis(CASE, tuple(asker.spec.cases)) if list(axis.texts) == ["all"] else axis


def head_of(request: SweepRequest, asker: Asker, plan: Plan) -> SweepHead:
    """What the sweep is of."""
    spec = asker.spec
    texts = zip(request.measure, asker.recipe.measures, strict=True)
    measures = tuple(SweptMeasure(text, unit_of(asked.path, spec)) for text, asked in texts)
    return SweepHead(spec.title, spec.path, spec.sha256, VERSION, plan, measures)


def answered(asker: Asker, plan: Plan) -> Iterator[SweptRow]:
    """The rows, one after the other."""
    for number in plan.numbers():
        values = plan.values(number)
        yield SweptRow(number, values, asker.answer(values))


def on_cluster(request: SweepRequest, asker: Asker, plan: Plan) -> list[SweptRow]:
    """The rows, in order, of variants that a Dask cluster solves."""
    from heuncli.commands.sweep.cluster import answers_of

    assert request.dask is not None
    tell = (lambda line: None) if request.quiet else (lambda line: say(f"heun: {line}"))
    found = answers_of(asker.recipe, plan, plan.numbers(), request.dask, plan.size, tell)
    return [SweptRow(number, plan.values(number), answer) for number, answer in sorted(found)]
