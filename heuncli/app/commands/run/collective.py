"""`heun run --collective PATHS`: the load collectives of a motion in place of its loads."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from functools import partial
from typing import Any

from heuncli.app.cli.entry import UsageError
from heuncli.app.cli.solving import all_or_errors
from heuncli.app.cli.units import TABLES
from heuncli.app.commands.run.request import RunRequest
from heuncli.base.errors import Problem
from heuncli.base.named_tuples import NamedTuple
from heuncli.output.snapshots.collectives import collectives, said
from heuncli.output.snapshots.measure import check
from heuncli.output.tables.collective_tables import CLOSED, block, csv_lines, tables
from heuncli.output.tables.export import FORMAT, dump
from heuncli.output.tables.text_table import TextTable
from heuncli.results.results_paths import find
from heuncli.scene.file_format.models import Spec
from heuncli.study.ask.measure import MeasureRequest, NotOneNumber
from heuncli.study.ask.study import Study
from heuncli.study.load_cycles.counted import BINS, Counting
from heuncli.study.quantities.table_units import Units

OPTION = "--collective"
OPTIONS = {"slopes": "slope"}  # what is called otherwise in Counting
ALONE = ("measure", "only", "at", "all", "by_cause")  # options of what else a run tells


class CollectiveTask(NamedTuple):
    """Of which paths, and how they are counted."""

    paths: Sequence[str]
    counting: Counting


def parse(request: RunRequest) -> CollectiveTask:
    """What is asked for. Raises UsageError with all that is wrong."""
    others = [name for name in ALONE if getattr(request, name)]
    calls: tuple[Callable[[], Any], ...] = (
        partial(require_alone, others), partial(paths_of, request.collective or ""), partial(counting_of, request),
    )  # fmt: skip
    _, paths, counting = all_or_errors(calls)
    return CollectiveTask(paths, counting)


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


def counting_of(request: RunRequest) -> Counting:
    """How cycles are counted. Raises UsageError with all options that tell no such way."""
    closed = request.repeat == CLOSED
    asked = Counting(
        slopes=() if request.slope is None else tuple(dict.fromkeys(map(number_in, request.slope.split(",")))),
        cycles=request.cycles,
        bins=BINS if request.bins is None else request.bins,
        repeat=1 if closed or request.repeat is None else whole_in(request.repeat),
        closed=closed,
    )
    if unfit := asked.unfit():
        options = [(one, OPTIONS.get(one.name, one.name)) for one in unfit]
        raise UsageError(*(said(one, f"--{option}", getattr(request, option)) for one, option in options))
    return asked


def number_in(word: str) -> float:
    """The number that a word is; nan where it is none."""
    try:
        return float(word)
    except ValueError:
        return math.nan


def whole_in(word: str) -> int:
    """The whole number that a word is, as 1e6; 0 where it is none."""
    number = number_in(word)
    return int(number) if math.isfinite(number) and number == int(number) else 0


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
    struck = bool(study.history.blows)
    return [table for one in found for table in tables(one, units, struck=struck)]
