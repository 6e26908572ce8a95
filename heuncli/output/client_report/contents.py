"""Put the report together: its first page, its chapters, their order, and the function that makes each one.

The first page says what the report is about, summarises it, and states every reason to doubt the results.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping

import numpy as np

from heuncli.output.client_report.accuracy import make_accuracy_parts, make_check_parts, make_open_parts, name_check
from heuncli.output.client_report.diagrams import make_history_parts, make_polar_parts
from heuncli.output.client_report.extremes import (
    GreatestOfCases,
    describe_place,
    find_greatest_of_cases,
    find_uncertain_cases,
)
from heuncli.output.client_report.loads import make_load_parts
from heuncli.output.client_report.machine import make_drawing_parts, make_model_parts
from heuncli.output.client_report.report_data import CHAPTER_NAMES, ON_REQUEST, ReportData, ReportedRun
from heuncli.output.client_report.sections import make_section_parts
from heuncli.output.client_report.summary_table import make_summary_table
from heuncli.output.documents.as_html import Sheet
from heuncli.output.documents.document import (
    Brand,
    Chapter,
    Facts,
    Mood,
    OutputDocument,
    Part,
    Sentence,
    Verbatim,
    has_content,
    join_names,
)
from heuncli.output.tables.event_tables import (
    ImpactReport,
    find_largest_impulses,
    make_events_table,
    make_impulse_tables,
)
from heuncli.output.tables.nouns import format_count
from heuncli.study.quantities.captions import describe_object, describe_path, describe_sentence
from heuncli.study.quantities.digits import choose_reader_style

ASSUMPTIONS = (
    "Bodies are rigid. Joints are ideal, without clearance, compliance or friction unless the model states otherwise; "
    "rods are massless. Only gravity and the loads stated in the model act. Numerical errors are below the digits "
    "shown, unless a ± follows; they do not say how well the model represents the machine."
)
NO_CHECKS = "No acceptance checks are defined."
MAX_SPEC_LINES = 2000  # of a spec that is printed
CHAPTERS: Mapping[str, tuple[str, Callable[[ReportData], list[Part]]]] = {
    "machine": ("The machine", lambda data: make_drawing_parts(data, is_first_page=False)),
    "loads": ("Loads", make_load_parts),
    "sections": ("Sections", make_section_parts),
    "histories": ("Time histories", make_history_parts),
    "polar": ("Load directions", make_polar_parts),
    "events": ("Impulses and events", lambda data: make_event_parts(data)),
    "checks": ("Checks", make_check_parts),
    "open": ("Indeterminate loads", make_open_parts),
    "model": ("The model", make_model_parts),
    "accuracy": ("Accuracy of the results", make_accuracy_parts),
    "spec": ("Spec", lambda data: make_spec_parts(data)),
}


def make_first_page(data: ReportData) -> list[Part]:
    """Make the content of the first page: title block, machine, verdicts, summary, assumptions, warnings."""
    summary = make_summary_table(data)
    return [
        Facts(list(_iter_identity(data)), is_block=True),
        Facts(list(_iter_cases(data))),
        *make_drawing_parts(data),
        *make_verdicts(data),
        *([summary] if summary is not None else []),
        Sentence(ASSUMPTIONS),
        *_iter_warnings(data),
    ]


def _iter_identity(data: ReportData) -> Iterator[tuple[str, str]]:
    """Yield the entries of the title block."""
    imprint = data.imprint
    for label in ("part", "revision", "author", "date"):
        if text := getattr(imprint, label):
            yield label, text
    yield "model", data.file_name


def _iter_cases(data: ReportData) -> Iterator[tuple[str, str]]:
    """Yield the load cases of the report, and those left out."""
    if data.has_cases:
        yield "load cases", ", ".join(_format_case(run.name, run.title) for run in data.runs)
    if data.omitted_cases:
        yield "not reported", f"load cases {', '.join(data.omitted_cases)}"


def _format_case(name: str, title: str) -> str:
    return f"{name} ({title})" if title and title != name else name


def make_verdicts(data: ReportData) -> list[Part]:
    """Make the sentences to be read first: what failed, what is indeterminate, how far sections are used."""
    return [
        *_iter_run_ends(data),
        *_iter_check_results(data),
        *_iter_utilisation(data),
        *_iter_impact_sentences(data),
        *_iter_open(data),
    ]


def _iter_run_ends(data: ReportData) -> Iterator[Sentence]:
    """Yield a sentence for each run that stopped early, has a horizon, or has extremes at its samples only."""
    for run in data.runs:
        case = f"Case {run.case_label}: " if run.name else ""
        status = run.results.status
        if status.get("code", "completed") != "completed":
            message = describe_sentence(status.get("message", ""), data.labels)
            yield Sentence(f"{case}the run {status['code']}: {message}", "bad")
        if (horizon := run.results.horizon) is not None:
            text = f"{case}no results are claimed from t = {horizon:.4g} s on: the error may exceed 1e-3"
            yield Sentence(f"{text}. Extremes cover the time before.", "unsure")
        if not run.is_searched:
            instants = format_count(len(run.page.results.time), "output time")
            yield Sentence(f"{case}extremes cover {instants} only; loads may be larger between them.", "unsure")


def _iter_check_results(data: ReportData) -> Iterator[Sentence]:
    """Yield the sentence on how many expected values hold."""
    failed = [outcome for outcome in data.outcomes if not outcome.has_passed]
    if failed:
        names = join_names([name_check(data, outcome) for outcome in failed])
        total = len(data.outcomes)
        text = f"{len(failed)} of {format_count(total, 'check')} in the spec FAILED: {names}."
        yield Sentence(text + _format_unchecked(data), "bad")
    elif data.outcomes:
        text = "all passed" if len(data.outcomes) > 1 else "passed"
        mood: Mood = "unsure" if data.unchecked_scenes else "good"
        yield Sentence(
            f"{format_count(len(data.outcomes), 'check')} in the spec: {text}.{_format_unchecked(data)}", mood
        )
    elif data.unchecked_scenes:
        yield Sentence(f"No result was checked.{_format_unchecked(data)}", "unsure")
    else:
        yield Sentence(NO_CHECKS)


def _format_unchecked(data: ReportData) -> str:
    """Format the list of the scenes whose expected values were not checked."""
    return f" Not checked (not requested): {join_names(data.unchecked_scenes)}." if data.unchecked_scenes else ""


def _iter_utilisation(data: ReportData) -> Iterator[Sentence]:
    """Yield the sentence on the section with the largest utilisation, and on those that exceed their strength."""
    names = {f"sections.{name}.stress.utilisation": name for name in data.runs[0].results.sections}
    is_uncertain = any(find_uncertain_cases(data, path) for path in names)
    found = [
        greatest for path, name in names.items() if (greatest := find_greatest_of_cases(data, path, name)) is not None
    ]
    if not found:
        if is_uncertain:
            yield Sentence("Utilisation unknown: the section loads are open (indeterminate).", "unsure")
        return
    words = {each.name: describe_object("sections", each.name, data.labels) for each in found}
    over_strength = [words[each.name] for each in found if each.value > 1.0]
    near_strength = [words[each.name] for each in found if each.value <= 1.0 < each.value + each.ends.error]
    largest = max(found, key=lambda each: each.value)
    qualifier = " among known values" if is_uncertain else ""
    text = f"Largest utilisation{qualifier}: {largest.text} in section {words[largest.name]}"
    text += f"{_format_position(data, largest)}."
    text += f" Strength exceeded: {join_names(over_strength)}." if over_strength else ""
    text += f" Strength exceeded if the stated error is added: {join_names(near_strength)}." if near_strength else ""
    is_certain = not (qualifier or near_strength) and all(run.is_searched for run in data.runs)
    yield Sentence(text, "bad" if over_strength else "good" if is_certain else "unsure")


def _format_position(data: ReportData, greatest: GreatestOfCases) -> str:
    """Format the place, instant and case of a number, as the end of a sentence."""
    place = describe_place(greatest.extreme.place, data.units)
    parts = [place] if place else []
    parts += [f"at t = {greatest.instant} s"] if greatest.instant else []
    parts += [f"in case {greatest.run.name}"] if greatest.run.name else []
    return "".join(f", {part}" for part in parts)


def _iter_impact_sentences(data: ReportData) -> Iterator[Sentence]:
    """Yield the number of impacts before the horizon, and their largest impulse, for each case."""
    for run in data.runs:
        horizon = run.results.horizon
        impacts = [impact for impact in run.results.impulses if horizon is None or float(impact["time"]) < horizon]
        if not impacts:
            continue
        largest = max(find_largest_impulses(impact, data.labels)[0] for impact in impacts)
        style = choose_reader_style("N·s", largest, data.units)
        text = (
            f"{format_count(len(impacts), 'impulse')}; largest impulse at a joint, on the ground or of "
            "all bodies together:"
        )
        yield Sentence(f"{f'Case {run.case_label}: ' if run.name else ''}{text} {style.write(largest)} {style.unit}.")


def _iter_open(data: ReportData) -> Iterator[Sentence]:
    """Yield the sentences on the load components that are indeterminate, by the objects that have them."""
    paths = list(dict.fromkeys(path for run in data.runs for path in run.snapshot.open))
    if paths:
        objects = dict.fromkeys(describe_path(path, data.labels).partition(", ")[0] for path in paths)
        text = (
            f"Indeterminate: {format_count(len(paths), 'load component')} (open). The constraints are redundant, so "
            "the distribution depends on stiffness"
        )
        yield Sentence(f"{text} ({join_names(list(objects))}).", "unsure")
    splits = dict.fromkeys(run.results.model["split"] for run in data.runs if run.results.model.get("split"))
    for split in splits:
        yield Sentence(
            f"Distribution of indeterminate reactions: {split}; other distributions are equally possible.", "unsure"
        )


def _iter_warnings(data: ReportData) -> Iterator[Sentence]:
    """Yield every warning, with its case."""
    for problem in data.spec.warnings:
        yield Sentence(f"Warning: {describe_sentence(problem.message, data.labels)}", "unsure")
    spec_messages = {problem.message for problem in data.spec.warnings}
    case_names: dict[str, list[str]] = {}
    for run in data.runs:
        for text in (*run.results.warnings, *run.study.later_warnings):
            if text not in spec_messages:
                case_names.setdefault(text, []).append(run.case_label if run.name else "")
    for text, names in case_names.items():
        is_in_all = len(set(names)) == len(data.runs) > 1
        case = " (all cases)" if is_in_all else f" (case {join_names(names)})" if any(names) else ""
        yield Sentence(f"Warning: {describe_sentence(text, data.labels)}{case}", "unsure")


def make_report(data: ReportData) -> OutputDocument:
    """Make the report without the chapters that have no content. Raises the errors of the solver."""
    names = data.chapters or [name for name in CHAPTER_NAMES if name not in ON_REQUEST]
    makers = [(name, *CHAPTERS[name]) for name in names]
    chapters = [Chapter(name, title, list(filter(has_content, make_parts(data)))) for name, title, make_parts in makers]
    imprint = data.imprint
    parts = [
        Brand(imprint.company, imprint.logo, imprint.project),
        *make_first_page(data),
        *(chapter for chapter in chapters if chapter.parts),
    ]
    return OutputDocument(data.spec.title or "untitled", parts=parts, level=1)


def make_sheet(data: ReportData, paper: str, *, is_landscape: bool) -> Sheet:
    """Make the paper, with title, revision and date at the head of its pages."""
    imprint = data.imprint
    revision = f"revision {imprint.revision}" if imprint.revision else ""
    right = ", ".join(filter(None, (revision, imprint.date)))
    left = ", ".join(filter(None, (imprint.part, data.spec.title or "untitled")))
    foot = ", ".join(filter(None, (imprint.company, imprint.project)))
    return Sheet("letter" if paper == "letter" else "a4", is_landscape, left, right, foot)


def make_spec_parts(data: ReportData) -> list[Part]:
    """Make the printout of the spec file."""
    lines = data.text.removeprefix("\ufeff").splitlines()
    parts: list[Part] = [
        Sentence(f"{data.file_name}, SHA-256 {data.spec.sha256}"),
        Verbatim("\n".join(lines[:MAX_SPEC_LINES]), is_numbered=True),
    ]
    if len(lines) > MAX_SPEC_LINES:
        parts.append(Sentence(f"... and {len(lines) - MAX_SPEC_LINES} more lines, not printed", "unsure"))
    return parts


def make_event_parts(data: ReportData) -> list[Part]:
    """Make the tables of impacts and events of each case."""
    parts: list[Part] = []
    for run in data.runs:
        tables = _make_run_parts(run)
        if tables and data.has_cases:
            parts.append(Sentence(f"Case {run.case_label}:"))
        parts += tables
    return parts


def _make_run_parts(run: ReportedRun) -> list[Part]:
    page, results = run.page, run.results
    has_events = any(np.size(event["time"]) for event in results.events.values())
    tables = [make_events_table(results)] if has_events else []
    if results.impulses:
        tables += make_impulse_tables(
            ImpactReport(
                page.results, page.labels, page.stated_errors, page.magnitudes, page.impact_extremes, page.details
            )
        )
    return list(tables)
