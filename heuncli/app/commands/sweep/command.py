"""`heun sweep`: a scene solved with other values, a row a variant."""

from __future__ import annotations

from collections.abc import Sequence
from functools import partial

from heuncli.analyses.sweep_store.rows import SweepHead, SweptMeasure
from heuncli.analyses.sweep_store.store.store import Store
from heuncli.analyses.variants.asking import CASE, Asker, Recipe, varies_cases
from heuncli.analyses.variants.axes import HINT, AxisError, Drawn, ParameterAxis
from heuncli.analyses.variants.keys import VariantKeys
from heuncli.analyses.variants.plans import Draws, Plan, plan_of
from heuncli.app.cli import jobs, memory
from heuncli.app.cli.entry import UsageError
from heuncli.app.cli.guard import require_other_file, same_file
from heuncli.app.cli.output import say
from heuncli.app.cli.solving import overrides, solver_options, spec_among
from heuncli.app.cli.target import format_of, require_room
from heuncli.app.cli.units import units
from heuncli.app.commands.sweep.checks import problems_of, warnings_of
from heuncli.app.commands.sweep.drawn import drawn
from heuncli.app.commands.sweep.given import GivenAxis, of_word
from heuncli.app.commands.sweep.request import FORMATS, SweepRequest
from heuncli.app.commands.sweep.running import Sweep, run
from heuncli.app.commands.sweep.shards import shard_of
from heuncli.app.commands.sweep.showing import show
from heuncli.app.commands.sweep.table import axes_in
from heuncli.app.commands.sweep.telling.told import Telling, require_tellable
from heuncli.base.errors import Problem, SpecError
from heuncli.base.records import replace
from heuncli.output.snapshots import measure
from heuncli.scene.file_format.names import ALL_CASES
from heuncli.scene.file_format.source import text_in
from heuncli.study.model.memory_estimate import Room
from heuncli.study.quantities.stated import unit_of
from heuncli.version import VERSION

USAGE = "heun sweep SPEC NAME=VALUES --measure WHAT"


def main(request: SweepRequest) -> int:
    """Run the command; returns the exit code."""
    how = telling_of(request)
    if request.show is not None:
        return show(request, how)
    path, words = spec_among(request.words, "sweep", USAGE)
    shard = shard_of(request.shard)
    _require_files(request, path)
    recipe = recipe_of(request, path)
    given = given_by(request, words)
    plan = plan_by(given, request)
    asker = asker_of(recipe, plan)
    measure.known(recipe.measures, asker.spec, [partial(_require_known, given, asker, recipe)])
    plan = with_cases(plan, given, request, asker)
    _require_files(request, path)  # the tables of the spec, too
    for line in warnings_of(given, asker) if not request.quiet else ():
        say(f"warning: {line}")
    keys = VariantKeys(asker.recipe, varies_cases(asker.spec))
    with Store(request.store) as store:
        return run(Sweep(asker, head_of(request, asker, plan), keys, store, shard), request, how)


def telling_of(request: SweepRequest) -> Telling:
    """How the sweep is told. Raises UsageError, SpecError."""
    form = format_of(request.format, request.output, FORMATS)
    how = Telling(form, request.output, units(request.units), request.all)
    require_tellable(how)
    return how


def recipe_of(request: SweepRequest, path: str) -> Recipe:
    """What every variant is made of. Raises UsageError, SpecError."""
    if not request.measure:
        hint = "such as --measure 'max abs joints.main.force'"
        raise UsageError(Problem("bad-option", "sweep: nothing is measured", hint=hint))
    if request.jobs is not None and request.jobs < 1:
        message = f"--jobs {request.jobs}: expected 1 or more"
        raise UsageError(Problem("bad-option", message, hint="such as --jobs 2"))
    if request.jobs is not None and request.dask is not None:
        hint = "leave --jobs out: on a cluster as many work as there are workers"
        raise UsageError(Problem("bad-option", "--jobs and --dask do not go together", hint=hint))
    room, each = memory.room("table")
    own = Room(room / jobs.most(request.jobs), each) if request.dask is None else None
    options = replace(solver_options(request), time_limit=request.time_limit_each, room=own)
    measures = tuple(measure.parse_all(request.measure))
    return Recipe(path, text_in(path), measures, options, overrides(request.set))


def given_by(request: SweepRequest, words: Sequence[str]) -> list[GivenAxis]:
    """What is varied: the columns of a table, then the words. Raises UsageError, SpecError."""
    if not words and request.variants is None:
        raise UsageError(Problem("bad-option", "sweep: nothing is varied", hint=f"{HINT}; or --variants FILE"))
    columns = axes_in(request.variants) if request.variants is not None else ()
    axes: list[GivenAxis] = []
    problems: list[Problem] = []
    for word in words:
        try:
            axes.append(of_word(word))
        except AxisError as error:
            problems += error.problems
    if problems:
        raise UsageError(*problems)
    return [*columns, *axes]


def plan_by(given: Sequence[GivenAxis], request: SweepRequest) -> Plan:
    """The variants, without the load cases where all are varied: which there are the spec tells. Raises AxisError."""
    draws = drawn([one.axis for one in given if isinstance(one.axis, Drawn)], request)
    return plan_among([one for one in given if not is_every_case(one)], request, draws)


def plan_among(given: Sequence[GivenAxis], request: SweepRequest, draws: Draws | None) -> Plan:
    """The plan of some axes and columns, and of what is drawn. Raises AxisError."""
    columns = [one.axis for one in given if one.column is not None and isinstance(one.axis, ParameterAxis)]
    axes = [one.axis for one in given if one.column is None and not isinstance(one.axis, Drawn)]
    return plan_of(axes, together=request.zip, draws=draws, columns=columns)


def is_every_case(one: GivenAxis) -> bool:
    """Whether an axis is the word `case=all`."""
    return one.name == CASE and one.column is None and [*one.texts] == [ALL_CASES]


def asker_of(recipe: Recipe, plan: Plan) -> Asker:
    """What answers the variants, of a spec that need not be sound without their values. Raises SpecError."""
    try:
        return Asker(recipe)
    except SpecError as error:
        for number in (0, plan.size - 1):
            values = {name: text for name, text in plan.values(number).items() if name != CASE}
            try:
                return Asker(recipe._replace(overrides={**recipe.overrides, **values}))
            except SpecError:
                continue
        raise error


def _require_known(given: Sequence[GivenAxis], asker: Asker, recipe: Recipe) -> None:
    """Raise SpecError where names or units of what is varied are wrong."""
    if problems := problems_of(given, asker, recipe.overrides):
        raise SpecError(*problems)


def with_cases(plan: Plan, given: Sequence[GivenAxis], request: SweepRequest, asker: Asker) -> Plan:
    """The plan with `case=all` as every load case. Raises AxisError."""
    if not any(map(is_every_case, given)):
        return plan
    every = ParameterAxis(CASE, tuple(asker.spec.cases)) if varies_cases(asker.spec) else None
    spelt = [one._replace(axis=every) if every is not None and is_every_case(one) else one for one in given]
    return plan_among(spelt, request, plan.draws)


def head_of(request: SweepRequest, asker: Asker, plan: Plan) -> SweepHead:
    """What the sweep is of."""
    spec = asker.spec
    texts = zip(request.measure, asker.recipe.measures, strict=True)
    measures = tuple(SweptMeasure(text, unit_of(asked.path, spec)) for text, asked in texts)
    return SweepHead(spec.title, spec.path, spec.sha256, VERSION, plan, measures)


def _require_files(request: SweepRequest, path: str) -> None:
    """What is written is nothing that is read. Raises UsageError, OutputError."""
    require_other_file(request.output, [path])
    if request.store is None:
        return
    require_room(request.store, "--store")
    require_other_file(request.store, [path], "--store")
    if request.output is not None and same_file(request.store, request.output):
        raise UsageError(Problem("bad-option", "--store and -o name the same file", hint="name another file"))
