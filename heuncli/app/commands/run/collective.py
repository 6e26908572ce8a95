"""`heun run --collective PATHS`: count the load collectives of a motion, in place of its loads."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from functools import partial
from typing import Any

from heuncli.app.cli.entry import UsageError
from heuncli.app.cli.solving import collect_results
from heuncli.app.commands.run.request import RunRequest
from heuncli.base.errors import Problem
from heuncli.base.named_tuples import NamedTuple
from heuncli.output.documents.as_data import FORMAT
from heuncli.output.documents.document import OutputDocument
from heuncli.output.tables.collective_tables import (
    CLOSED,
    count_collectives,
    make_option_problem,
    make_records,
    make_tables,
    to_json_block,
)
from heuncli.output.tables.measure import require_known_paths
from heuncli.results.results import Results
from heuncli.results.results_paths import find_values
from heuncli.scene.file_format.models import Spec
from heuncli.study.load_collectives import DEFAULT_BINS, Collective, Counting
from heuncli.study.quantities.table_units import Units
from heuncli.study.queries.measure import MeasureRequest, NotOneNumber
from heuncli.study.queries.study import Study

OPTION = "--collective"
OPTIONS = {"slopes": "slope"}  # option of a field of Counting, if named differently
EXCLUDED_OPTIONS = ("measure", "only", "at", "all", "by_cause")  # options that ask for other results


class CollectiveTask(NamedTuple):
    """The paths to count, and how cycles are counted."""

    paths: Sequence[str]
    counting: Counting


def parse_task(request: RunRequest) -> CollectiveTask:
    """Parse the options of collectives. Raises UsageError with every problem."""
    others = [name for name in EXCLUDED_OPTIONS if getattr(request, name)]
    calls: tuple[Callable[[], Any], ...] = (
        partial(require_alone, others),
        partial(parse_paths, request.collective or ""),
        partial(parse_counting, request),
    )
    _, paths, counting = collect_results(calls)
    return CollectiveTask(paths, counting)


def require_collective(request: RunRequest) -> None:
    """Raise UsageError for an option of collectives without --collective."""
    for name in ("slope", "cycles", "bins", "repeat"):
        if getattr(request, name) is not None:
            raise make_option_error(f"--{name} applies to load spectra", f"add {OPTION} joints.NAME.force")


def require_alone(others: Sequence[str]) -> None:
    """Raise UsageError for options that ask for other results."""
    if others:
        words = ", ".join(f"--{name.replace('_', '-')}" for name in others)
        raise make_option_error(
            f"{OPTION} prints load spectra only and cannot be combined with {words}",
            f"leave out {words}, or run twice",
        )


def parse_paths(words: str) -> list[str]:
    """Split the paths, each once. Raises UsageError."""
    paths = [word.strip() for word in words.split(",")]
    if not all(paths):
        raise make_option_error(
            f"{OPTION} '{words}': expected result paths separated by commas",
            f"for example {OPTION} joints.NAME.force.x",
        )
    return list(dict.fromkeys(paths))


def parse_counting(request: RunRequest) -> Counting:
    """Parse how cycles are counted. Raises UsageError with every invalid option."""
    is_closed = request.repeat == CLOSED
    counting = Counting(
        slopes=() if request.slope is None else tuple(dict.fromkeys(map(parse_number, request.slope.split(",")))),
        cycles=request.cycles,
        bins=DEFAULT_BINS if request.bins is None else request.bins,
        repeat=1 if is_closed or request.repeat is None else parse_whole(request.repeat),
        is_endless=is_closed,
    )
    if invalid := counting.find_invalid_options():
        options = [(one, OPTIONS.get(one.name, one.name)) for one in invalid]
        raise UsageError(
            *(make_option_problem(one, f"--{option}", getattr(request, option)) for one, option in options)
        )
    return counting


def parse_number(word: str) -> float:
    """Parse a number; nan if the word is none."""
    try:
        return float(word)
    except ValueError:
        return math.nan


def parse_whole(word: str) -> int:
    """Parse a whole number, also as 1e6; 0 if the word is none."""
    number = parse_number(word)
    return int(number) if math.isfinite(number) and number == int(number) else 0


def make_option_error(message: str, hint: str) -> UsageError:
    """Make the error of an option that does not fit --collective."""
    return UsageError(Problem("bad-option", message, hint=hint))


def require_paths(task: CollectiveTask, spec: Spec) -> None:
    """Require that the paths exist, as far as that is known before the run. Raises SpecError [unknown-path]."""
    require_known_paths([MeasureRequest("abs", path) for path in task.paths], spec, OPTION)


def make_collectives_document(task: CollectiveTask, study: Study, units: Units) -> OutputDocument:
    """Count the collectives of a study, and make their document. Raises UsageError."""
    try:
        collect_results([partial(find_values, study.results, path) for path in task.paths])
        collectives = count_collectives(study, task.paths, task.counting)
    except NotOneNumber as error:
        raise UsageError(
            *(problem._replace(message=f"{OPTION}: {problem.message}") for problem in error.problems)
        ) from None
    has_impulses = bool(study.history.impulses)
    tables = [table for one in collectives for table in make_tables(one, units, has_impacts=has_impulses)]
    return OutputDocument(
        study.results.title, parts=tables, make_block=partial(make_block, study.results, collectives),
        make_records=partial(make_records, collectives),
    )  # fmt: skip


def make_block(results: Results, collectives: Sequence[Collective]) -> dict[str, Any]:
    """Make the JSON of collectives."""
    head = {"heun": FORMAT, "title": results.title, "spec": results.spec, "version": results.version}
    axes = {"axes": results.model["axes"]} if "axes" in results.model else {}
    blocks = {one.history.path: to_json_block(one) for one in collectives}
    return head | axes | {"status": results.status, "collectives": blocks}
