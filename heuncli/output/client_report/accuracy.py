"""The accuracy of the results in words of a reviewer: what was compared, and how far each number can be trusted; the
loads that are indeterminate; and the checks of the spec's expected values, as `heun check` makes them.
"""

from __future__ import annotations

import math
import sys
from collections.abc import Iterator, Sequence

import numpy as np

from heuncli.base.method_rows import find_method
from heuncli.base.named_tuples import NamedTuple
from heuncli.output.client_report.extremes import DASH, format_power
from heuncli.output.client_report.report_data import AS_IT_STANDS, ReportData, ReportedRun
from heuncli.output.documents.document import (
    Facts,
    Fill,
    Listing,
    OutputColumn,
    OutputTable,
    Part,
    Sentence,
    TextCell,
    join_names,
)
from heuncli.output.snapshots.outcomes import Outcome
from heuncli.output.tables.indeterminate import make_sums_table
from heuncli.output.tables.nouns import format_count
from heuncli.output.tables.run_description import make_heading
from heuncli.results.path_words import error_kind_of_path
from heuncli.results.results_schema import XYZ
from heuncli.study.quantities.captions import describe_path, parse_path
from heuncli.study.quantities.digits import OPEN, ReaderStyle, choose_reader_style
from heuncli.study.queries.measure_uncertainty import find_unit
from heuncli.version import VERSION

HOLDS, FAILS = "passed", "FAILED"
HEADS = ("line", "case", "quantity", "unit", "at", "expected", "found", "allowed", "verdict")
NUMBERS = frozenset({"line", "expected", "found", "allowed"})
MAX_NUMBERS = 6  # of a list
INTEGRATED_NOTE = (
    "The motion was integrated over time twice, the second time to a tolerance 30 times finer. The error stated for a "
    "quantity is twice the greatest difference between the two solutions, and not less than the rounding of the "
    "arithmetic."
)
DRIVEN_NOTE = (
    "The drives prescribe the whole motion: each instant is solved separately, so that no error grows over time. The "
    "equations were solved again with values changed in their last digits; the errors stated are the differences, the "
    "rounding of the arithmetic."
)
EQUILIBRIUM_NOTE = (
    "The rest position was searched for twice, the second time ten times finer. The errors stated follow from the "
    "distance between the two positions, and from the rounding of the arithmetic."
)
ONE_INSTANT_NOTE = (
    "The equations were solved at one instant. The errors stated are the rounding of the arithmetic, from solving "
    "again with values changed in their last digits."
)
LIMITS_NOTE = (
    "These are errors of the calculation alone. How well the results describe the machine depends on the data of the "
    "model and on the assumptions on the first page."
)
QUANTITIES = {  # kind of error and unit -> words
    ("motion", "m"): "positions of points", ("reactions", "N"): "forces in joints",
    ("reactions", "N·m"): "moments in joints", ("drives", "N"): "drive forces", ("drives", "N·m"): "drive torques",
    ("foundation", "N"): "forces on the ground", ("foundation", "N·m"): "moments on the ground",
    ("sections", "N"): "forces in sections", ("sections", "N·m"): "moments in sections",
    ("sections", "Pa"): "stresses",
}  # fmt: skip
MAX_CERTAIN_DIGITS = 15
BALANCE = "forces and moments on each body against its mass times acceleration", "of the body's largest load"
ENERGY = "energy at each instant against the work done since the start", "of the largest kinetic energy"
GAP = "distance of the points that a joint holds together, where joints close a loop"
TOLD_ELSEWHERE = ("model", "warning", "accuracy", "moved", "omitted", "split", "status", "horizon")  # of the heading
SOLUTION_HEADS = ("case", "time covered", "output times", "solved by")
CASE_COLUMN = OutputColumn("case", "text")
DIGEST_DIGITS = 12  # of a digest of 64


def make_check_parts(data: ReportData) -> list[Part]:
    """Make the table of checks, one row per expected value."""
    if not data.outcomes:
        return []
    with_cases = any(outcome.case for outcome in data.outcomes)
    heads = [head for head in HEADS if with_cases or head != "case"]
    columns = [OutputColumn(head, "number" if head in NUMBERS else "text") for head in heads]
    rows = [_make_row(data, outcome, with_cases=with_cases) for outcome in data.outcomes]
    failed = [f"{name_check(data, each)}: {each.failure}" for each in data.outcomes if each.failure is not None]
    changed = ", with the command-line options given" if data.options else ""
    return [OutputTable(f"CHECKS  as in heun check{changed}", columns, rows, failed, "page")]


def name_check(data: ReportData, outcome: Outcome) -> str:
    """Name what is checked in words: case, quantity, instant."""
    case = f"{outcome.case}: " if outcome.case else ""
    return f"{case}{_describe_subject(data, outcome)} {outcome.when}".strip()


def _describe_subject(data: ReportData, outcome: Outcome) -> str:
    subject = outcome.subject
    return describe_path(subject, data.labels) if parse_path(subject) is not None else subject


def _make_row(data: ReportData, outcome: Outcome, *, with_cases: bool) -> list[TextCell]:
    """Make the cells of one check; a failed verdict is bold."""
    verdict = TextCell(HOLDS if outcome.has_passed else FAILS, not outcome.has_passed)
    case = [TextCell(outcome.case or AS_IT_STANDS)] if with_cases else []
    unit, *numbers = _format_check(data, outcome)
    texts = _describe_subject(data, outcome), unit, outcome.when, *numbers
    return [TextCell(str(outcome.line)), *case, *map(TextCell, texts), verdict]


def _format_check(data: ReportData, outcome: Outcome) -> tuple[str, str, str, str]:
    """Format unit, expected, found and allowed numbers.

    The largest expected number has four digits, and so many more that a failure is seen. What is found below the last
    of them is 0.
    """
    block = outcome.block
    expected, found = _read_numbers(block.get("expected")), _read_numbers(block.get("found"))
    bounds = [(word, float(block[word])) for word in ("above", "below") if block.get(word) is not None]
    tolerance = float(block.get("tolerance") or 0.0)
    scale = max((abs(x) for x in (*expected, *(b for _, b in bounds)) if math.isfinite(x)), default=0.0)
    is_expected_zero = scale == 0.0
    scale = scale or max([tolerance, *(abs(x) for x in found if abs(x) > tolerance)])
    style = choose_reader_style(find_unit(outcome.subject, data.spec), scale, data.units)
    if outcome.failure is not None and found:
        while style.decimals < 9 and _write(style, found) == _write(style, expected or [b for _, b in bounds]):
            style = style._replace(decimals=style.decimals + 1)
    wanted = ", ".join(f"{word} {style.write(bound)}" for word, bound in bounds) or _write(style, expected)
    if is_expected_zero and tolerance:
        found = [0.0 if abs(x) <= tolerance else x for x in found]
    allowed = "" if bounds or not expected else _format_allowed(style, tolerance, 0.0 if is_expected_zero else scale)
    return "" if style.unit == "1" else style.unit, wanted, _write(style, found), allowed


def _read_numbers(value: object) -> list[float]:
    """Return the numbers of an outcome's block; nan stands for an indeterminate one."""
    return [] if value is None else [float(x) for x in np.ravel(np.asarray(value, dtype=np.float64))]


def _write(style: ReaderStyle, values: list[float]) -> str:
    texts = [OPEN if math.isnan(value) else style.write(value) for value in values[:MAX_NUMBERS]]
    if len(values) <= 1:
        return "".join(texts)
    return f"[{', '.join(texts)}{', ...' * (len(values) > len(texts))}]"


def _format_allowed(style: ReaderStyle, tolerance: float, scale: float) -> str:
    """Format the allowed deviation: relative to the expected number, or absolute where 0 is expected."""
    if tolerance <= 0.0:
        return "0"
    return f"{format_power(100.0 * tolerance / scale, 2)} %" if scale else format_power(style.per_si * tolerance, 2)


def make_accuracy_parts(data: ReportData) -> list[Part]:
    """Make the chapter: how errors were found, how far each kind of number is certain, checks, runs and sources."""
    parts: list[Part] = [Sentence(f"{text} {LIMITS_NOTE}") for text in dict.fromkeys(map(_explain_errors, data.runs))]
    parts += [_make_error_table(data), _make_balance_table(data)]
    if notes := _list_notes(data):  # above the tables: below, one line may stand alone on the last page
        parts.append(Facts(notes))
    solved = [[run.case_label, *_describe_solution(run)] for run in data.runs]
    if data.has_cases:
        heads = [OutputColumn(head, "text") for head in SOLUTION_HEADS]
        parts.append(OutputTable("SOLUTION", heads, [list(map(TextCell, row)) for row in solved], (), "page"))
    else:
        heads = [OutputColumn("", "text"), OutputColumn("", "text")]
        rows = [[TextCell(head), TextCell(text)] for head, text in zip(SOLUTION_HEADS[1:], solved[0][1:], strict=True)]
        parts.append(OutputTable("SOLUTION", heads, rows, (), "half"))
    parts.append(_make_provenance_table(data, "page" if data.has_cases else "half"))
    return parts


def _explain_errors(run: ReportedRun) -> str:
    """Return the note on how the stated errors of a run were found."""
    if run.study.has_one_instant:
        return EQUILIBRIUM_NOTE if "rest" in run.results.model else ONE_INSTANT_NOTE
    return INTEGRATED_NOTE if run.study.history.followed_duration is None else DRIVEN_NOTE


class _KindError(NamedTuple):
    """The largest error of a kind of numbers, the largest of these numbers (0: unknown), SI, and the case."""

    error: float
    largest: float
    case: str


def _make_error_table(data: ReportData) -> OutputTable:
    """Make the table of errors by kind of number, each the largest of all cases."""
    rows = []
    for (kind, unit), found in sorted(_find_errors(data).items(), key=lambda item: list(QUANTITIES).index(item[0])):
        style = choose_reader_style(unit, found.largest, data.units)
        if unit == "Pa" and not data.units.is_chosen(unit):
            shown, per_si = data.units.find(unit)
            style = style._replace(
                unit=shown, per_si=per_si, decimals=max(0, style.decimals + round(math.log10(style.per_si / per_si)))
            )
        if not found.largest:
            shown, per_si = data.units.find(unit) if data.units.is_chosen(unit) else ("mm", 1e3)
            style = style._replace(unit=shown, per_si=per_si)
        largest = style.write(found.largest) if found.largest else DASH
        texts = [QUANTITIES[kind, unit], largest, format_power(style.per_si * found.error), style.unit]
        texts += [_count_certain_digits(found), *([found.case] if data.has_cases else [])]
        rows.append(list(map(TextCell, texts)))
    heads = [OutputColumn("quantity", "text"), OutputColumn("greatest value"), OutputColumn("error")]
    heads += [OutputColumn("unit", "text"), OutputColumn("certain digits")]
    return OutputTable(
        "ERRORS  of each kind of number; certain digits: of its greatest value (tables show four)",
        [*heads, *([CASE_COLUMN] if data.has_cases else [])], rows, (), "page",
    )  # fmt: skip


def _count_certain_digits(number: _KindError) -> str:
    """Return how many digits of the largest number its error leaves."""
    if not (number.largest and math.isfinite(number.error)):
        return DASH
    if not number.error:
        return str(MAX_CERTAIN_DIGITS)
    return str(min(MAX_CERTAIN_DIGITS, max(0, math.floor(math.log10(number.largest / number.error)))))


def _find_errors(data: ReportData) -> dict[tuple[str, str], _KindError]:
    """Find the largest error of each kind and unit of numbers over all cases, and the largest number."""
    errors: dict[tuple[str, str], _KindError] = {}
    for run in data.runs:
        motion = "motion", "m"
        own = {motion: _KindError(run.page.stated_errors.error_of(*motion), 0.0, run.case_label)}
        for path, number in run.snapshot.numbers.items():
            block, *name, quantity = [word for word in path.split(".") if word not in XYZ]
            key = error_kind_of_path(block, ".".join(name), quantity), number.unit
            if key not in QUANTITIES or key == motion:
                continue
            sizes = [abs(value) for value in number.values.values() if isinstance(value, float)]
            before = own.get(key, _KindError(0.0, 0.0, run.case_label))
            own[key] = before._replace(error=max(before.error, number.error), largest=max([before.largest, *sizes]))
        for key, found in own.items():
            other = errors.get(key, found)
            worst = max(found, other, key=lambda each: each.error)
            errors[key] = worst._replace(largest=max(found.largest, other.largest))
    return {key: found for key, found in errors.items() if found.largest > found.error or key[0] == "motion"}


def _make_balance_table(data: ReportData) -> OutputTable:
    """Make the table of what was compared to check the solution, each with its largest deviation of all cases."""
    length, per_si = data.units.find("m") if data.units.is_chosen("m") else ("mm", 1e3)
    compared = (
        ("balance_residual", *BALANCE, 1.0),
        ("constraint_gap", GAP, length, per_si),
        ("energy_drift", *ENERGY, 1.0),
    )
    rows = []
    for key, words, reference, factor in compared:
        values = [
            (run.results.accuracy.get(key), run) for run in data.runs if key != "energy_drift" or _is_integrated(run)
        ]
        known = [(float(value), run) for value, run in values if value is not None and math.isfinite(value)]  # type: ignore[arg-type]
        if not known or (key == "constraint_gap" and not any(value for value, _ in known)):
            continue
        value, run = max(known, key=lambda pair: pair[0])
        texts = [words, format_power(factor * value), reference, *([run.case_label] if data.has_cases else [])]
        rows.append(list(map(TextCell, texts)))
    heads = [OutputColumn("compared, at all output times", "text"), OutputColumn("largest deviation")]
    heads += [OutputColumn("", "text"), *([CASE_COLUMN] if data.has_cases else [])]
    return OutputTable("BALANCES  which the results must satisfy", heads if rows else [], rows, (), "page")


def _is_integrated(run: ReportedRun) -> bool:
    return not run.study.has_one_instant and run.study.history.followed_duration is None


def _describe_solution(run: ReportedRun) -> list[str]:
    """Describe the time that a run covers, its output times, and how it was solved."""
    times, work = run.results.time, run.results.work
    if run.study.has_one_instant:
        method = "search for the rest position" if "rest" in run.results.model else "the equations at this instant"
        return [f"t = {times[0]:.6g} s", "1", method]
    searched = "; extremes are searched between them, too" if run.is_searched else ""
    covered = [f"{times[0]:.6g} to {times[-1]:.6g} s", f"{len(times)}{searched}"]
    if not _is_integrated(run):
        return [*covered, "the equations at each instant"]
    row = find_method(str(run.results.model.get("method", "")))
    name = str(run.results.model.get("method", "")) if row is None else f"{row.name}, {row.kind}, order {row.order}"
    return [*covered, f"{name}, {format_count(int(work.get('steps', 0)), 'step')}"]


def _list_notes(data: ReportData) -> list[tuple[str, str]]:
    """List what else is to be known of the runs: how they start, rest, meet, and end; each with its cases."""
    cases: dict[tuple[str, str], list[str]] = {}
    for run in data.runs:
        moved: Sequence[str] = run.results.model.get("moved", ())
        lines = [("start", f"adjusted to close the joints: {join_names(list(moved))}")] if moved else []
        label = ""
        for own, text in make_heading(run.results, brief=True):
            label = own or label
            if label not in TOLD_ELSEWHERE:
                lines.append((label, text))
        for line in lines:
            cases.setdefault(line, []).append(run.case_label)
    return [
        (label, f"{text} ({join_names(names)})" if len(names) < len(data.runs) else text)
        for (label, text), names in cases.items()
    ]


def _make_provenance_table(data: ReportData, fill: Fill) -> OutputTable:
    """Make the table of files, options and versions."""
    rows = [[TextCell(label), TextCell(text)] for label, text in _iter_provenance(data)]
    return OutputTable("SOURCES", [OutputColumn("", "text"), OutputColumn("", "text")], rows, (), fill)


def _iter_provenance(data: ReportData) -> Iterator[tuple[str, str]]:
    """Yield the files with their digests, the options and the versions."""
    yield "model", f"{data.file_name}, SHA-256 {data.spec.sha256[:DIGEST_DIGITS]}"
    for name, digest in data.digests.items():
        yield "file", f"{name}, SHA-256 {digest[:DIGEST_DIGITS]}"
    for text in data.options:
        yield "option", text
    yield "solved by", _format_versions(data)


def _format_versions(data: ReportData) -> str:
    """Format the versions of the programs that solved it."""
    parts = [f"heun {VERSION}", f"NumPy {np.__version__}"]
    rows = [find_method(str(run.results.model.get("method", ""))) for run in data.runs]
    if any(row is not None and row.kind == "SciPy" for row in rows):
        parts.append(f"SciPy {sys.modules['scipy'].__version__}")
    return ", ".join(parts)


def make_open_parts(data: ReportData) -> list[Part]:
    """Make the list of the indeterminate components, and of the sums that are determinate."""
    parts: list[Part] = []
    for run in data.runs:
        if run.snapshot.open:
            parts.append(Listing(f"Indeterminate components{_format_case(run)}", run.snapshot.open))
        parts += _iter_sums(data, run)
    if not parts:
        return []
    splits = dict.fromkeys(run.results.model["split"] for run in data.runs if run.results.model.get("split"))
    return [
        *parts,
        *(
            Sentence(
                f"Distribution of indeterminate reactions: {words}; other distributions are equally possible.", "unsure"
            )
            for words in splits
        ),
    ]


def _iter_sums(data: ReportData, run: ReportedRun) -> Iterator[Part]:
    table = make_sums_table(run.page.results, run.page.stated_errors, run.page.last_instant)
    if table is not None:
        yield Listing(f"Determinate sums of indeterminate reactions{_format_case(run)}", table.notes)


def _format_case(run: ReportedRun) -> str:
    return f" in case {run.case_label}" if run.name else ""
