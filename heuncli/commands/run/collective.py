"""`heun run --collective PATHS`: the load collectives of a motion in place of its loads."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from functools import partial

from heuncli.cli.entry import UsageError
from heuncli.cli.solving import all_or_errors
from heuncli.cli.units import TABLES
from heuncli.collectives.counted import BINS, LEAST_SLOPE, MOST_BINS, Counting
from heuncli.commands.run.request import RunRequest
from heuncli.errors import Problem
from heuncli.named_tuples import NamedTuple
from heuncli.report.collective_tables import CLOSED, block, csv_lines, tables
from heuncli.report.export import FORMAT, dump
from heuncli.report.table_units import Units
from heuncli.report.text_table import TextTable
from heuncli.results_paths import find
from heuncli.spec.models import Spec
from heuncli.study.ask.measure import MeasureRequest, NotOneNumber
from heuncli.study.ask.study import Study
from heuncli.telling.collectives import collectives
from heuncli.telling.measure import check

OPTION = "--collective"
MOST_REPEATS = 10**12
ALONE = ("measure", "only", "at", "all", "by_cause")  # options of what else a run tells


class CollectiveTask(NamedTuple):
    """Of which paths, and how they are counted."""

    paths: Sequence[str]
    counting: Counting


def parse(request: RunRequest) -> CollectiveTask:
    """What is asked for. Raises UsageError with all that is wrong."""
    others = [name for name in ALONE if getattr(request, name)]
    calls: tuple[Callable[[], object], ...] = (
        partial(require_alone, others), partial(paths_of, request.collective or ""), partial(slopes_of, request.slope),
        partial(cycles_of, request.cycles), partial(bins_of, request.bins), partial(repeat_of, request.repeat),
    )  # fmt: skip
    all_or_errors(calls)
    repeat, closed = repeat_of(request.repeat)
    counting = Counting(slopes_of(request.slope), cycles_of(request.cycles), bins_of(request.bins), repeat, closed)
    return CollectiveTask(paths_of(request.collective or ""), counting)


def require_collective(request: RunRequest) -> None:
    """Raise UsageError for an option of collectives where none is asked for."""
    for name in ("slope", "cycles", "bins", "repeat"):
        if getattr(request, name) is not None:
            raise wrong(f"--{name} is of load collectives", f"add {OPTION} joints.NAME.force")


def require_alone(others: Sequence[str]) -> None:
    """Raise UsageError for options of what else a run tells."""
    if others:
        words = ", ".join(f"--{name.replace('_', '-')}" for name in others)
        raise wrong(
            f"{OPTION} prints collectives and nothing else: not with {words}", f"leave {words} out, or run twice"
        )


def paths_of(words: str) -> list[str]:
    """The paths, each once."""
    paths = [word.strip() for word in words.split(",")]
    if not all(paths):
        raise wrong(
            f"{OPTION} '{words}': expected paths into the results, with commas between",
            f"such as {OPTION} joints.NAME.force.x",
        )
    return list(dict.fromkeys(paths))


def slopes_of(words: str | None) -> tuple[float, ...]:
    """The slopes of Wöhler lines."""
    if words is None:
        return ()
    try:
        slopes = [float(word) for word in words.split(",")]
    except ValueError:
        slopes = [math.nan]
    if not all(LEAST_SLOPE <= slope <= 100.0 for slope in slopes):
        raise wrong(f"--slope {words}: expected slopes m of N R^m = constant, from 1 to 100", "such as --slope 3,5")
    return tuple(dict.fromkeys(slopes))


def cycles_of(cycles: float | None) -> float | None:
    """Of how many cycles equivalent ranges are."""
    if cycles is not None and not (math.isfinite(cycles) and cycles > 0.0):
        raise wrong(f"--cycles {cycles:g}: expected of how many cycles equivalent ranges are", "such as --cycles 1e6")
    return cycles


def bins_of(bins: int | None) -> int:
    """How many classes."""
    if bins is not None and not 1 <= bins <= MOST_BINS:
        raise wrong(f"--bins {bins}: expected 1 to {MOST_BINS} classes of ranges and means", f"the default is {BINS}")
    return BINS if bins is None else bins


def repeat_of(words: str | None) -> tuple[int, bool]:
    """How often the motion is told; whether it is repeated for ever, and one time counted."""
    if words is None:
        return 1, False
    if words == CLOSED:
        return 1, True
    try:
        times = float(words)
    except ValueError:
        times = math.nan
    if not (1.0 <= times <= MOST_REPEATS and times == int(times)):
        message = f"--repeat {words}: expected how often the motion is run through, or {CLOSED}"
        raise wrong(message, f"--repeat 1000; or --repeat {CLOSED}: for ever, of which one time is counted")
    return int(times), False


def wrong(message: str, hint: str) -> UsageError:
    """What is wrong with an option."""
    return UsageError(Problem("bad-option", message, hint=hint))


def require_paths(asked: CollectiveTask, spec: Spec) -> None:
    """Whether the paths lead anywhere, as far as that is seen before the run. Raises SpecError [unknown-path]."""
    check([MeasureRequest("abs", path) for path in asked.paths], spec, OPTION)


def told(asked: CollectiveTask, study: Study, form: str, units: Units) -> str | list[TextTable]:
    """The collectives of a study: as text, or as tables. Raises UsageError."""
    try:
        all_or_errors([partial(find, study.results, path) for path in asked.paths])
        found = collectives(study, asked.paths, asked.counting)
    except NotOneNumber as error:
        raise UsageError(*(own._replace(message=f"{OPTION}: {own.message}") for own in error.problems)) from None
    results = study.results
    if form == "json":
        head = {"heun": FORMAT, "title": results.title, "spec": results.spec, "version": results.version}
        if "axes" in results.model:
            head["axes"] = results.model["axes"]
        return dump(head | {"status": results.status, "collectives": {one.history.path: block(one) for one in found}})
    if form not in TABLES:
        return "".join(csv_lines(found))
    struck = bool(results.impulses)
    return [table for one in found for table in tables(one, units, struck=struck)]
