"""The accuracy of the results: stated errors, residuals, horizons; and the loads that are indeterminate."""

from __future__ import annotations

import sys
from collections.abc import Iterator

import numpy as np

from heuncli.base.method_rows import find_method
from heuncli.output.client_report.report_data import ReportData, ReportedRun
from heuncli.output.documents.document import Facts, Listing, OutputColumn, OutputTable, Part, Sentence, TextCell
from heuncli.output.tables.certain_sums import make_sums_table
from heuncli.output.tables.heading import make_heading
from heuncli.results.path_words import error_kind_of_path
from heuncli.results.results_schema import XYZ
from heuncli.study.quantities.digits import format_error
from heuncli.version import VERSION

INTEGRATED_NOTE = (
    "Every motion is integrated a second time with 1/30 of the tolerance. The stated errors are twice the largest "
    "difference between the two solutions up to that time, and at least the rounding error, one for each kind of "
    "quantity. They cover the numerical solution, not how well the model represents the machine."
)
DRIVEN_NOTE = (
    "Motion fully prescribed: solved at each instant, nothing integrated. The stated errors are rounding errors, found "
    "by solving again with perturbed values. They cover the numerical solution, not how well the model represents the "
    "machine."
)
EQUILIBRIUM_NOTE = (
    "Nothing is integrated: the rest position is searched for, then again ten times finer. The stated errors are those "
    "of the position, from the difference between the two finest searches, and of rounding. They cover the numerical "
    "solution, not how well the model represents the machine."
)
ONE_INSTANT_NOTE = (
    "Nothing is integrated: the equations are solved at one instant, and the stated errors are rounding errors. They "
    "cover the numerical solution, not how well the model represents the machine."
)
KIND_LABELS = {"reactions": "joints", "drives": "drives", "foundation": "foundation", "sections": "sections"}
MOTION = ("positions of points", "m")
LOADS = ("N", "N·m")
CASE_COLUMN = OutputColumn("case", "text")
DIGEST_DIGITS = 12  # of a digest of 64


def make_trust_parts(data: ReportData) -> list[Part]:
    """Make the notes on each run, and the table of stated errors."""
    parts: list[Part] = [Sentence(text) for text in dict.fromkeys(map(_explain_errors, data.runs))]
    if data.has_cases:
        rows = [[TextCell(run.case_label), TextCell("; ".join(text for _, text in _list_run_facts(run)))]
                for run in data.runs]  # fmt: skip
        columns = [OutputColumn("case", "text"), OutputColumn("run and accuracy", "text")]
        parts.append(OutputTable("RUNS", columns, rows, (), "page"))
    else:
        parts.append(Facts(_list_run_facts(data.runs[0])))
    return [*parts, _make_error_table(data), _make_provenance_table(data)]


def _list_run_facts(run: ReportedRun) -> list[tuple[str, str]]:
    """Return what is known of a run and its accuracy, without the model and warnings, which stand elsewhere."""
    return [line for line in make_heading(run.results) if line[0] not in ("model", "warning")]


def _make_provenance_table(data: ReportData) -> OutputTable:
    """Make the table of files, options and versions."""
    rows = [[TextCell(label), TextCell(text)] for label, text in _iter_provenance(data)]
    return OutputTable("SOURCES", [OutputColumn("", "text"), OutputColumn("", "text")], rows, (), "half")


def _iter_provenance(data: ReportData) -> Iterator[tuple[str, str]]:
    """Yield the files with their digests, the options and the versions."""
    yield "spec", f"{data.file_name}, SHA-256 {data.spec.sha256[:DIGEST_DIGITS]}"
    for name, digest in data.digests.items():
        yield "file", f"{name}, SHA-256 {digest[:DIGEST_DIGITS]}"
    for text in data.options:
        yield "option", text
    yield "solved by", _format_versions(data)


def _format_versions(data: ReportData) -> str:
    """Format the versions of the programs that solved it."""
    kernels = dict.fromkeys(str(run.results.work.get("kernel", "")) for run in data.runs)
    parts = [f"heun {VERSION}", *(f"{kernel} kernel" for kernel in kernels if kernel), f"NumPy {np.__version__}"]
    rows = [find_method(str(run.results.model.get("method", ""))) for run in data.runs]
    if any(row is not None and row.kind == "SciPy" for row in rows):
        parts.append(f"SciPy {sys.modules['scipy'].__version__}")
    return ", ".join(parts)


def _explain_errors(run: ReportedRun) -> str:
    """Return the note on how the stated errors of a run were found."""
    if run.study.has_one_instant:
        return EQUILIBRIUM_NOTE if "rest" in run.results.model else ONE_INSTANT_NOTE
    return INTEGRATED_NOTE if run.study.history.followed_duration is None else DRIVEN_NOTE


def _make_error_table(data: ReportData) -> OutputTable:
    """Make the table of the stated errors by kind, each the largest of all cases."""
    errors: dict[tuple[str, str], tuple[float, str]] = {}
    for run in data.runs:
        case_errors = {MOTION: run.page.certain.error_of("motion", "m")} | _find_load_errors(run)
        for key, error in case_errors.items():
            errors[key] = max(errors.get(key, (0.0, run.name)), (error, run.name))
    rows = []
    for (kind, unit), (error, case) in errors.items():
        unit_text, size = data.units.find(unit)
        rows.append(
            [
                TextCell(kind),
                TextCell(unit_text),
                TextCell(format_error(error * size)),
                *([TextCell(case)] if data.has_cases else []),
            ]
        )
    heads = [OutputColumn("quantity", "text"), OutputColumn("unit", "text"), OutputColumn("±")]
    return OutputTable(
        "STATED ERRORS  for each kind of quantity",
        [*heads, *([CASE_COLUMN] if data.has_cases else [])],
        rows,
        (),
        "half",
    )


def _find_load_errors(run: ReportedRun) -> dict[tuple[str, str], float]:
    """Find the largest stated error of a case for each kind and unit of loads."""
    errors: dict[tuple[str, str], float] = {}
    for path, number in run.snapshot.numbers.items():
        block, *name, quantity = [word for word in path.split(".") if word not in XYZ]
        kind = KIND_LABELS.get(error_kind_of_path(block, ".".join(name), quantity))
        if kind is not None and number.unit in LOADS:
            errors[kind, number.unit] = max(errors.get((kind, number.unit), 0.0), number.error)
    return errors


def make_open_parts(data: ReportData) -> list[Part]:
    """Make the list of the indeterminate components, and of the sums that are determinate."""
    parts: list[Part] = []
    for run in data.runs:
        if run.snapshot.open:
            parts.append(Listing(f"Open (indeterminate) components{_format_case(run)}", run.snapshot.open))
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
    table = make_sums_table(run.page.results, run.page.certain, run.page.last_instant)
    if table is not None:
        yield Listing(f"Determinate sums of indeterminate reactions{_format_case(run)}", table.notes)


def _format_case(run: ReportedRun) -> str:
    return f" in case {run.case_label}" if run.name else ""
