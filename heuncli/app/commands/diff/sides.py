"""The two sides of a comparison: what a path holds, and the numbers of it. Impure: reads files, solves specs."""

from __future__ import annotations

import json
from collections.abc import Mapping, Sequence
from functools import partial
from pathlib import PurePath
from types import MappingProxyType
from typing import Any

from heuncli.app.cli import alarm
from heuncli.app.cli.entry import UsageError, contained
from heuncli.app.cli.solving import warning_lines
from heuncli.base.errors import Finding, HeunError, Problem, SourceLocation
from heuncli.base.named_tuples import NamedTuple
from heuncli.output.snapshots.keep import keep
from heuncli.output.snapshots.kept import KeptRun, of_data, text_ends_early
from heuncli.output.snapshots.sampled import common_instants, instants_of, run_of
from heuncli.output.snapshots.selection import told_by_default
from heuncli.scene.file_format.load import load_with_cases
from heuncli.scene.file_format.reading import STANDARD_INPUT, read_bytes
from heuncli.study.model.options import Options
from heuncli.study.model.selection import Selection
from heuncli.study.workflow import solve

SPECS = frozenset({".yaml", ".yml"})
MOST_BYTES = 512_000_000
SPEC, GOLDEN, RESULT = "spec", "golden", "result"


NONE: Mapping[str, Any] = MappingProxyType({})


class NotComparedError(HeunError):
    """A file that cannot be compared."""

    exit_code = 2


class Side(NamedTuple):
    """One side: its path, what it is, and its runs by load case ("": the scene as it stands); of a spec none yet.

    results: of a result what stands in the file, by load case; digest: of its spec, where that is known; holds_courses:
    whether its runs hold means and instants of extremes with their errors.
    """

    path: str
    kind: str
    runs: Mapping[str, KeptRun]
    results: Mapping[str, Mapping[str, Any]] = NONE
    digest: str = ""
    holds_courses: bool = True


def side_of(path: str) -> Side:
    """What stands at a path; a spec is not read. Raises NotComparedError."""
    if path == STANDARD_INPUT or PurePath(path).suffix in SPECS:
        return Side(path, SPEC, {})
    try:
        data = _decoded(bytes(read_bytes(path, MOST_BYTES)))
        if "format" in data:
            kept = of_data(data)
            runs = {"": kept.base, **kept.cases}
            return Side(path, GOLDEN, runs, digest=kept.spec.sha256, holds_courses=kept.holds_courses)
        results = data["cases"] if isinstance(data.get("cases"), dict) else {"": data}
        runs = {name: run_of(one) for name, one in results.items()}
        return Side(path, RESULT, runs, results, _digest_in(results))
    except Finding as finding:
        place = SourceLocation(path, 1, 1)
        raise NotComparedError(Problem(finding.code, finding.message, place, finding.hint)) from None


def _digest_in(results: Mapping[str, Mapping[str, Any]]) -> str:
    """The digest of the spec that results are of; empty where they do not name one."""
    specs = [one["spec"] for one in results.values() if isinstance(one.get("spec"), dict)]
    found = {str(spec.get("sha256", "")) for spec in specs}
    return found.pop() if len(found) == 1 else ""


def at_common_instants(before: Side, after: Side) -> tuple[Side, Side, list[str]]:
    """Two results at the instants that both have, and what to say of that. Raises UsageError where there are none."""
    notes: list[str] = []
    sides = [dict(side.runs) for side in (before, after)]
    for name in before.results.keys() & after.results.keys():
        both = before.results[name], after.results[name]
        which = common_instants(*both)
        n = [len(instants_of(one)) for one in both]
        if len(which[0]) == n[0] == n[1]:
            continue
        of = f"case {name}: " if name else ""
        if not which[0]:
            hint = "run both with the same analysis.samples; heun diff of the two specs compares the whole courses"
            message = f"{of}{before.path} and {after.path} have no instant in common: these are not compared"
            raise UsageError(Problem("bad-option", message, hint=hint))
        for runs, one, own in zip(sides, both, which, strict=True):
            runs[name] = run_of(one, own)
        text = f"{of}the results are of other instants: of {n[0]} and {n[1]} instants {len(which[0])} are the same"
        notes.append(f"{text}, and only these are compared")
    return before._replace(runs=sides[0]), after._replace(runs=sides[1]), notes


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
    runs, said, digest = contained(work, ("diff", side.path))
    return side._replace(runs=runs, digest=digest), said


def _solved(path: str, even_at: Mapping[str, Sequence[float]]) -> tuple[dict[str, KeptRun], list[str], str]:
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
    return runs, said, spec.sha256


def require_alike(before: Side, after: Side) -> None:
    """Raise UsageError where one side is a result, whose extremes are those of its samples, and the other is not."""
    if (before.kind == RESULT) != (after.kind == RESULT):
        other, of = (before, after) if after.kind == RESULT else (after, before)
        hint = f"heun run SPEC --format json of both; {of.path} holds samples, without what lies between them"
        message = f"{of.path} is a result, {other.path} a {other.kind}: these are not compared"
        raise UsageError(Problem("bad-option", message, hint=hint))
