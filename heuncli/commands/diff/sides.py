"""The two sides of a comparison: what a path holds, and the numbers of it. Impure: reads files, solves specs."""

from __future__ import annotations

import json
from collections.abc import Mapping, Sequence
from functools import partial
from pathlib import PurePath
from typing import Any

from heuncli.cli import alarm
from heuncli.cli.entry import UsageError, contained
from heuncli.cli.solving import warning_lines
from heuncli.errors import Finding, HeunError, Problem, SourceLocation
from heuncli.named_tuples import NamedTuple
from heuncli.spec.load import load_with_cases
from heuncli.spec.reading import STANDARD_INPUT, read_bytes
from heuncli.study.model.options import Options
from heuncli.study.model.selection import Selection
from heuncli.study.workflow import solve
from heuncli.telling.keep import keep
from heuncli.telling.kept import KeptRun, of_data, text_ends_early
from heuncli.telling.sampled import run_of
from heuncli.telling.selection import told_by_default

SPECS = frozenset({".yaml", ".yml"})
MOST_BYTES = 512_000_000
SPEC, GOLDEN, RESULT = "spec", "golden", "result"


class NotComparedError(HeunError):
    """A file that cannot be compared."""

    exit_code = 2


class Side(NamedTuple):
    """One side: its path, what it is, and its runs by load case ("": the scene as it stands); of a spec none yet."""

    path: str
    kind: str
    runs: Mapping[str, KeptRun]


def side_of(path: str) -> Side:
    """What stands at a path; a spec is not read. Raises NotComparedError."""
    if path == STANDARD_INPUT or PurePath(path).suffix in SPECS:
        return Side(path, SPEC, {})
    try:
        data = _decoded(bytes(read_bytes(path, MOST_BYTES)))
        if "format" in data:
            kept = of_data(data)
            return Side(path, GOLDEN, {"": kept.base, **kept.cases})
        if isinstance(data.get("cases"), dict):
            return Side(path, RESULT, {name: run_of(one) for name, one in data["cases"].items()})
        return Side(path, RESULT, {"": run_of(data)})
    except Finding as finding:
        place = SourceLocation(path, 1, 1)
        raise NotComparedError(Problem(finding.code, finding.message, place, finding.hint)) from None


def _decoded(content: bytes) -> dict[str, Any]:
    """The JSON object of a file. Raises Finding [not-a-result]."""
    hint = "a spec ends in .yaml; a golden file or a result is JSON"
    try:
        data = json.loads(content)
    except (ValueError, RecursionError) as error:
        text = content.decode("utf-8", "replace")
        whole = "it ends before it is complete; " * text_ends_early(text, error)
        raise Finding("not-a-result", f"this is no JSON: {whole}{error!s:.100}", hint) from None
    if not isinstance(data, dict):
        raise Finding("not-a-result", "this is JSON, but no result and no golden file", hint)
    return data


def solved(side: Side, even_at: Mapping[str, Sequence[float]], limit: float | None) -> tuple[Side, list[str]]:
    """A side with its numbers, and the warnings of a spec; even_at: the even instants of the other side by case."""
    if side.kind != SPEC:
        return side, []
    work = partial(alarm.limited, partial(_solved, side.path, even_at), limit, subject=side.path)
    runs, said = contained(work, ("diff", side.path))
    return side._replace(runs=runs), said


def _solved(path: str, even_at: Mapping[str, Sequence[float]]) -> tuple[dict[str, KeptRun], list[str]]:
    spec, cases = load_with_cases(path, checking=False)
    runs: dict[str, KeptRun] = {}
    said: list[str] = []
    for name, one in {"": spec, **cases}.items():
        wanted = told_by_default(one)
        study = solve(one, Options(wanted=Selection(wanted).reports, time_limit=alarm.remaining()))
        runs[name] = keep(study, wanted, even_at.get(name, ()))
        place = f"heun: {path}: case {name}" if name else f"heun: {path}"
        said += warning_lines(one, study.results, place, study.later_warnings)
    alarm.disarm()
    return runs, said


def require_alike(before: Side, after: Side) -> None:
    """Raise UsageError where one side is a result, whose extremes are those of its samples, and the other is not."""
    if (before.kind == RESULT) != (after.kind == RESULT):
        other, of = (before, after) if after.kind == RESULT else (after, before)
        hint = f"heun run SPEC --format json of both; {of.path} holds samples, without what lies between them"
        message = f"{of.path} is a result, {other.path} a {other.kind}: these are not compared"
        raise UsageError(Problem("bad-option", message, hint=hint))
