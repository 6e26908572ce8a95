"""The two sides of `heun diff`: read from a golden file or a result, or solved if the file is a spec. Impure: files."""

from __future__ import annotations

import json
from collections.abc import Mapping, Sequence
from functools import partial
from pathlib import PurePath
from types import MappingProxyType
from typing import Any

from heuncli.app.cli import timeout
from heuncli.app.cli.entry import UsageError, run_contained
from heuncli.app.cli.solving import format_warnings
from heuncli.base.errors import Finding, HeunError, Problem, SourceLocation
from heuncli.base.named_tuples import NamedTuple
from heuncli.output.snapshots.golden_file import RunSnapshot, is_text_cut_off, validate_golden_data
from heuncli.output.snapshots.json_results import find_common_instants, read_instants, read_run_snapshot
from heuncli.output.snapshots.take_snapshot import take_run_snapshot
from heuncli.output.tables.report_selection import find_default_reports
from heuncli.scene.file_format.load import load_with_cases
from heuncli.scene.file_format.reading import STANDARD_INPUT, read_bytes
from heuncli.study.model.options import Options
from heuncli.study.model.selection import Selection
from heuncli.study.workflow import solve

SPECS = frozenset({".yaml", ".yml"})
MAX_BYTES = 512_000_000  # of a golden file or a result
SPEC, GOLDEN, RESULT = "spec", "golden", "result"  # kinds of sides
NO_RESULTS: Mapping[str, Any] = MappingProxyType({})


class NotComparedError(HeunError):
    """A file that cannot be compared."""

    exit_code = 2


class Side(NamedTuple):
    """One side of a comparison.

    path: its file
    kind: spec, golden file or result
    runs: its runs by load case ("" is the scene as it is); empty for a spec that is not solved yet
    results: the JSON of a result, by load case
    digest: the digest of its spec, if known
    holds_courses: whether its runs hold means and the instants of extremes, with their errors
    """

    path: str
    kind: str
    runs: Mapping[str, RunSnapshot]
    results: Mapping[str, Mapping[str, Any]] = NO_RESULTS
    digest: str = ""
    holds_courses: bool = True


def read_side(path: str) -> Side:
    """Read a golden file or a result; a spec is read when it is solved. Raises NotComparedError."""
    if path == STANDARD_INPUT or PurePath(path).suffix in SPECS:
        return Side(path, SPEC, {})
    try:
        data = _parse_json(bytes(read_bytes(path, MAX_BYTES)))
        if "format" in data:
            golden = validate_golden_data(data)
            runs = {"": golden.base, **golden.cases}
            return Side(path, GOLDEN, runs, digest=golden.spec.sha256, holds_courses=golden.has_courses)
        results = data["cases"] if isinstance(data.get("cases"), dict) else {"": data}
        runs = {name: read_run_snapshot(one) for name, one in results.items()}
        return Side(path, RESULT, runs, results, _find_digest(results))
    except Finding as finding:
        place = SourceLocation(path, 1, 1)
        raise NotComparedError(Problem(finding.code, finding.message, place, finding.hint)) from None


def _find_digest(results: Mapping[str, Mapping[str, Any]]) -> str:
    """Return the digest of the spec that the results belong to, or an empty text if they do not name a single one."""
    specs = [one["spec"] for one in results.values() if isinstance(one.get("spec"), dict)]
    digests = {str(spec.get("sha256", "")) for spec in specs}
    return digests.pop() if len(digests) == 1 else ""


def restrict_to_common_instants(old: Side, new: Side) -> tuple[Side, Side, list[str]]:
    """Restrict two results to the instants that both have; returns them and notes about that. Raises UsageError if
    there are none.
    """
    notes: list[str] = []
    sides = [dict(side.runs) for side in (old, new)]
    for name in old.results.keys() & new.results.keys():
        both = old.results[name], new.results[name]
        common = find_common_instants(*both)
        n = [len(read_instants(one)) for one in both]
        if len(common[0]) == n[0] == n[1]:
            continue
        prefix = f"case {name}: " if name else ""
        if not common[0]:
            hint = (
                "run both with the same analysis.samples; heun diff of the two specs compares the full time histories"
            )
            message = f"{prefix}{old.path} and {new.path} have no instant in common and are not compared"
            raise UsageError(Problem("bad-option", message, hint=hint))
        for runs, one, indices in zip(sides, both, common, strict=True):
            runs[name] = read_run_snapshot(one, indices)
        text = f"{prefix}the results have different instants: {len(common[0])} of {n[0]} and {n[1]} are common"
        notes.append(f"{text}, and only these are compared")
    return old._replace(runs=sides[0]), new._replace(runs=sides[1]), notes


def _parse_json(content: bytes) -> dict[str, Any]:
    """Parse the JSON object of a file. Raises Finding [not-a-result]."""
    hint = "a spec ends in .yaml; a golden file or a result is JSON"
    try:
        data = json.loads(content)
    except (ValueError, RecursionError) as error:
        text = content.decode("utf-8", "replace")
        whole = "it is incomplete; " * is_text_cut_off(text, error)
        raise Finding("not-a-result", f"this is not JSON: {whole}{error!s:.100}", hint) from None
    if not isinstance(data, dict):
        raise Finding("not-a-result", "this is JSON, but neither a result nor a golden file", hint)
    return data


def solve_side(side: Side, even_at: Mapping[str, Sequence[float]], limit: float | None) -> tuple[Side, list[str]]:
    """Solve a side that is a spec; returns it with its numbers, and its warnings.

    even_at: instants at equal steps of the other side, by load case
    """
    if side.kind != SPEC:
        return side, []
    work = partial(timeout.run_with_limit, partial(_solve_spec, side.path, even_at), limit, subject=side.path)
    runs, warnings, digest = run_contained(work, ("diff", side.path))
    return side._replace(runs=runs, digest=digest), warnings


def _solve_spec(path: str, even_at: Mapping[str, Sequence[float]]) -> tuple[dict[str, RunSnapshot], list[str], str]:
    """Solve a spec and its cases; returns their snapshots by name, the warnings, and the spec's digest."""
    spec, cases = load_with_cases(path, checking=False)
    runs: dict[str, RunSnapshot] = {}
    warnings: list[str] = []
    for name, one in {"": spec, **cases}.items():
        reports = find_default_reports(one)
        study = solve(one, Options(requested_reports=Selection(reports).reports, time_limit=timeout.remaining_time()))
        runs[name] = take_run_snapshot(study, reports, even_at.get(name, ()))
        place = f"heun: {path}: case {name}" if name else f"heun: {path}"
        warnings += format_warnings(one, study.results, place, study.later_warnings)
    timeout.disarm()
    return runs, warnings, spec.sha256


def require_same_kind(old: Side, new: Side) -> None:
    """Raise UsageError if only one side is a result: its extremes are those of its samples."""
    if (old.kind == RESULT) != (new.kind == RESULT):
        other, result = (old, new) if new.kind == RESULT else (new, old)
        hint = f"use heun run SPEC --format json for both; {result.path} holds samples only"
        message = f"{result.path} is a result, {other.path} a {other.kind}: these cannot be compared"
        raise UsageError(Problem("bad-option", message, hint=hint))
