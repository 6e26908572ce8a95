"""`heun sweep`: solve a scene with other values, one row per variant.

What an axis such as n=1000:6000/51rpm passes through, from the command line to a cell:

    AxisArgument      axes.py                            the word, or the column of a table, and what it varies
    ParameterAxis     analyses/variants/parameters.py    the parameter, its values and their unit
    Plan              analyses/variants/plans.py         all axes; gives each variant its number and its values
    VariantResult     analyses/variants/measures.py      the measures of a variant (evaluation.py), as they are stored
    SweptRow          analyses/sweep_rows.py             number, values and result, read back in order
    NumberCell        tables.py                          in display units; or a line of CSV, JSON, Parquet (as_*.py)
"""

from __future__ import annotations

from collections.abc import Sequence
from functools import partial

from heuncli.analyses.sweep_rows import SweepHead
from heuncli.analyses.sweep_store import Store
from heuncli.analyses.variants.evaluation import Recipe, VariantEvaluator, varies_cases
from heuncli.analyses.variants.keys import VariantKeys
from heuncli.analyses.variants.measures import MeasureLabel
from heuncli.analyses.variants.parameters import CASE, HINT, AxisError, ParameterAxis, RandomVariable
from heuncli.analyses.variants.plans import (
    SAMPLES_HINT,
    Draws,
    Plan,
    make_axes_plan,
    make_draws,
    make_imbalance_warning,
)
from heuncli.app.cli import jobs
from heuncli.app.cli.entry import UsageError
from heuncli.app.cli.output import print_stderr
from heuncli.app.cli.solving import make_solver_options, parse_overrides, split_spec_and_assignments
from heuncli.app.cli.target import choose_format, is_same_file, parse_units, require_other_file, require_writable
from heuncli.app.cli.variant_workers import require_job_count
from heuncli.app.commands.sweep.axes import AxisArgument, find_problems, find_warnings, parse_axis, parse_shard
from heuncli.app.commands.sweep.request import FORMATS, SweepRequest
from heuncli.app.commands.sweep.running import SweepTask, run_sweep, show_stored
from heuncli.app.commands.sweep.variants_table import read_axes
from heuncli.app.commands.sweep.writer import SweepOutput, require_writable_form
from heuncli.base.errors import Problem, SpecError
from heuncli.base.process import result_memory
from heuncli.base.records import replace
from heuncli.output.tables import measure
from heuncli.scene.file_format.source import read_text
from heuncli.study.model.memory import MemoryBudget
from heuncli.study.queries.measure_uncertainty import find_unit
from heuncli.version import VERSION

USAGE = "heun sweep SPEC NAME=VALUES --measure WHAT"
RANDOM_HINT = "for example d=normal(100,0.1)mm, r=uniform(20,60)mm, lhs(a,b) or sobol(a,b)"


def main(request: SweepRequest) -> int:
    """Run the command; returns the exit code."""
    output = parse_output_options(request)
    if request.show is not None:
        return show_stored(request, output)
    path, words = split_spec_and_assignments(request.words, "sweep", USAGE)
    shard = parse_shard(request.shard)
    _require_files(request, path)
    recipe = make_recipe(request, path)
    axes = parse_axes(request, words)
    plan = make_plan(axes, request)
    evaluator = make_evaluator(recipe, plan)
    measure.check_with_others(recipe.measures, evaluator.spec, [partial(_require_known, axes, evaluator, recipe)])
    plan = expand_cases(plan, axes, request, evaluator)
    _require_files(request, path)  # the tables of the spec, too
    for line in find_warnings(axes, evaluator) if not request.quiet else ():
        print_stderr(f"warning: {line}")
    keys = VariantKeys(evaluator.recipe, varies_cases(evaluator.spec))
    with Store(request.store) as store:
        return run_sweep(SweepTask(evaluator, make_head(request, evaluator, plan), keys, store, shard), request, output)


def parse_output_options(request: SweepRequest) -> SweepOutput:
    """Parse how the sweep is written. Raises UsageError, SpecError."""
    form = choose_format(request.format, request.output, FORMATS)
    output = SweepOutput(form, request.output, parse_units(request.units), request.all)
    require_writable_form(output)
    return output


def make_recipe(request: SweepRequest, path: str) -> Recipe:
    """Make the recipe of all variants. Raises UsageError, SpecError."""
    if not request.measure:
        hint = "for example --measure 'max abs joints.main.force'"
        raise UsageError(Problem("bad-option", "sweep: no --measure is given", hint=hint))
    require_job_count(request.jobs)
    if request.jobs is not None and request.dask is not None:
        hint = "leave out --jobs: a cluster uses all its workers"
        raise UsageError(Problem("bad-option", "--jobs and --dask cannot be combined", hint=hint))
    available, bytes_each = result_memory("table")
    room_per_job = MemoryBudget(available / jobs.max_jobs(request.jobs), bytes_each) if request.dask is None else None
    options = replace(
        make_solver_options(request.solver), time_limit=request.time_limit_each, memory_budget=room_per_job
    )
    measures = tuple(measure.parse_measures(request.measure))
    return Recipe(path, read_text(path), measures, options, parse_overrides(request.set))


def parse_axes(request: SweepRequest, words: Sequence[str]) -> list[AxisArgument]:
    """Parse the axes: the columns of the table, then the words. Raises UsageError, SpecError."""
    if not words and request.variants is None:
        raise UsageError(
            Problem("bad-option", "sweep: no parameter to vary is given", hint=f"{HINT}; or --variants FILE")
        )
    columns = read_axes(request.variants) if request.variants is not None else ()
    axes: list[AxisArgument] = []
    problems: list[Problem] = []
    for word in words:
        try:
            axes.append(parse_axis(word))
        except AxisError as error:
            problems += error.problems
    if problems:
        raise UsageError(*problems)
    return [*columns, *axes]


def make_plan(axes: Sequence[AxisArgument], request: SweepRequest) -> Plan:
    """Make the plan of the variants, still without the load cases of `case=all`, which only the spec knows. Raises
    AxisError.
    """
    draws = draw_samples([axis.parameter for axis in axes if isinstance(axis.parameter, RandomVariable)], request)
    return combine_axes([axis for axis in axes if not axis.is_all_cases], request, draws)


def combine_axes(axes: Sequence[AxisArgument], request: SweepRequest, draws: Draws | None) -> Plan:
    """Make the plan of axes, columns and random draws. Raises AxisError."""
    words = [axis.parameter for axis in axes if axis.column is None and not isinstance(axis.parameter, RandomVariable)]
    columns = [axis.parameter for axis in axes if axis.column is not None and isinstance(axis.parameter, ParameterAxis)]
    return make_axes_plan(words, together=request.zip, draws=draws, columns=columns)


def make_evaluator(recipe: Recipe, plan: Plan) -> VariantEvaluator:
    """Make the variant evaluator; the base spec may be invalid if the variants make it valid. Raises SpecError."""
    try:
        return VariantEvaluator(recipe)
    except SpecError as error:
        for number in (0, plan.size - 1):
            values = {name: text for name, text in plan.find_values(number).items() if name != CASE}
            try:
                return VariantEvaluator(recipe._replace(overrides={**recipe.overrides, **values}))
            except SpecError:
                continue
        raise error


def _require_known(axes: Sequence[AxisArgument], evaluator: VariantEvaluator, recipe: Recipe) -> None:
    """Raise SpecError for wrong names or units of the axes."""
    if problems := find_problems(axes, evaluator, recipe.overrides):
        raise SpecError(*problems)


def expand_cases(plan: Plan, axes: Sequence[AxisArgument], request: SweepRequest, evaluator: VariantEvaluator) -> Plan:
    """Return the plan with `case=all` replaced by every load case. Raises AxisError."""
    if not any(axis.is_all_cases for axis in axes):
        return plan
    cases = ParameterAxis(CASE, tuple(evaluator.spec.cases)) if varies_cases(evaluator.spec) else None
    expanded = [axis._replace(parameter=cases) if cases is not None and axis.is_all_cases else axis for axis in axes]
    return combine_axes(expanded, request, plan.draws)


def make_head(request: SweepRequest, evaluator: VariantEvaluator, plan: Plan) -> SweepHead:
    """Make the head of the sweep: spec, plan and measures."""
    spec = evaluator.spec
    texts = zip(request.measure, evaluator.recipe.measures, strict=True)
    measures = tuple(MeasureLabel(text, find_unit(request_.path, spec)) for text, request_ in texts)
    return SweepHead(spec.title, spec.path, spec.sha256, VERSION, plan, measures)


def _require_files(request: SweepRequest, path: str) -> None:
    """Require that no output overwrites an input. Raises UsageError, OutputError."""
    require_other_file(request.output, [path])
    if request.store is None:
        return
    require_writable(request.store, "--store")
    require_other_file(request.store, [path], "--store")
    if request.output is not None and is_same_file(request.store, request.output):
        raise UsageError(Problem("bad-option", "--store and -o name the same file", hint="name another file"))


def draw_samples(laws: Sequence[RandomVariable], request: SweepRequest) -> Draws | None:
    """Draw the values of the random parameters; None if there are none. Raises UsageError, AxisError."""
    if not laws:
        options = {"--samples": request.samples is not None, "--seed": request.seed is not None}
        for option, is_given in (options | {"--indices": request.indices}).items():
            if is_given:
                raise UsageError(Problem("bad-option", f"{option}: no parameter is random", hint=RANDOM_HINT))
        return None
    if request.samples is None:
        message = f"{', '.join(law.name for law in laws)}: the number of samples is missing"
        raise UsageError(Problem("bad-option", message, hint=SAMPLES_HINT))
    draws = make_draws(laws, request.samples, request.seed or 0, indices=request.indices)
    imbalance = make_imbalance_warning(laws, request.samples)
    if imbalance and not request.quiet:
        print_stderr(f"warning: {imbalance}")
    if request.indices and not request.quiet:
        d = len(laws)
        print_stderr(
            f"heun: Sobol indices of {d} parameters: {request.samples:,} x ({d} + 2) = {len(draws.values):,} variants"
        )
    return draws
