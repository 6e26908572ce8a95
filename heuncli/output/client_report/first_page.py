"""The first page: what the report is about, and a summary. Every reason to doubt the results is stated here."""

from __future__ import annotations

import sys
from collections.abc import Iterator, Sequence

import numpy as np

from heuncli.base.method_rows import find_method
from heuncli.output.client_report.extremes import GreatestOfCases, find_greatest_of_cases, find_uncertain_cases
from heuncli.output.client_report.load_groups import iter_joining_forces
from heuncli.output.client_report.report_data import ReportData
from heuncli.output.documents.document import Facts, Mood, Part, Sentence, join_names
from heuncli.output.tables.extremes_tables import MARK
from heuncli.output.tables.impulse_tables import find_largest_impulses
from heuncli.output.tables.plurals import format_count
from heuncli.version import VERSION


def make_first_page(data: ReportData) -> list[Part]:
    """Make the content below the title."""
    return [Facts(list(_iter_identity(data))), *make_summary(data)]


def _iter_identity(data: ReportData) -> Iterator[tuple[str, str]]:
    """Yield the lines that identify the report: project, author, files with digests, cases, options, versions."""
    imprint = data.imprint
    for label, text in (("project", imprint.project), ("author", imprint.author), ("date", imprint.date)):
        if text:
            yield label, text
    yield "spec", data.spec.path
    yield "SHA-256", data.spec.sha256
    for name, digest in data.digests.items():
        yield f"file {name}", f"SHA-256 {digest}"
    if data.has_cases:
        yield "load cases", ", ".join(_format_case(run.name, run.title) for run in data.runs)
    if data.omitted_cases:
        yield "not reported", f"load cases {', '.join(data.omitted_cases)}"
    for text in data.options:
        yield "option", text
    yield "solved by", _format_versions(data)


def _format_case(name: str, title: str) -> str:
    return f"{name} ({title})" if title and title != name else name


def _format_versions(data: ReportData) -> str:
    """Format the versions of the programs that solved it."""
    kernels = dict.fromkeys(str(run.results.work.get("kernel", "")) for run in data.runs)
    parts = [f"heun {VERSION}", *(f"{kernel} kernel" for kernel in kernels if kernel), f"NumPy {np.__version__}"]
    rows = [find_method(str(run.results.model.get("method", ""))) for run in data.runs]
    if any(row is not None and row.kind == "SciPy" for row in rows):
        parts.append(f"SciPy {sys.modules['scipy'].__version__}")
    return ", ".join(parts)


def make_summary(data: ReportData) -> list[Part]:
    """Make the sentences to be read first: what failed, what is indeterminate, what governs."""
    return [
        *_iter_run_ends(data),
        *_iter_check_results(data),
        *_iter_utilisation(data),
        *_iter_largest_loads(data),
        *_iter_impact_sentences(data),
        *_iter_open(data),
        *_iter_warnings(data),
    ]


def _iter_run_ends(data: ReportData) -> Iterator[Sentence]:
    """Yield a sentence for each run that stopped early, has a horizon, or has extremes at its samples only."""
    for run in data.runs:
        case = f"Case {run.name}: " if run.name else ""
        status = run.results.status
        if status.get("code", "completed") != "completed":
            yield Sentence(f"{case}the run {status['code']}: {status.get('message', '')}", "bad")
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
        names = join_names([outcome.name for outcome in failed])
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
        yield Sentence("No acceptance checks are defined.", "unsure")


def _format_unchecked(data: ReportData) -> str:
    """Format the list of the scenes whose expected values were not checked."""
    return f" Not checked (not requested): {join_names(data.unchecked_scenes)}." if data.unchecked_scenes else ""


def _iter_utilisation(data: ReportData) -> Iterator[Sentence]:
    """Yield the sentence on the section with the largest utilisation, and on those that exceed their strength."""
    paths = {f"sections.{name}.stress.utilisation": name for name in data.runs[0].results.sections}
    qualifier = _format_qualifier(data, list(paths))
    utilisations = [
        spread for path, name in paths.items() if (spread := find_greatest_of_cases(data, path, name)) is not None
    ]
    if not utilisations:
        if qualifier:
            yield Sentence("Utilisation unknown: the section loads are open (indeterminate).", "unsure")
        return
    over_strength = [spread.name for spread in utilisations if spread.high.value > 1.0]
    near_strength = [
        spread.name for spread in utilisations if spread.high.value <= 1.0 < spread.high.value + spread.error
    ]
    largest = max(utilisations, key=_value_of_greatest)
    text = f"Largest utilisation{qualifier}: {largest.format_value()} in section {largest.name}{largest.position_text}."
    text += f" Strength exceeded: {join_names(over_strength)}." if over_strength else ""
    text += f" Strength exceeded if the stated error is added: {join_names(near_strength)}." if near_strength else ""
    is_certain = not (qualifier or near_strength) and all(run.is_searched for run in data.runs)
    yield Sentence(text, "bad" if over_strength else "good" if is_certain else "unsure")


def _format_qualifier(data: ReportData, paths: Sequence[str]) -> str:
    """Format the qualifier of a maximum whose candidates include an indeterminate or unknown number; else empty."""
    return " among known values" if any(find_uncertain_cases(data, path) for path in paths) else ""


def _value_of_greatest(spread: GreatestOfCases) -> float:
    return spread.high.value


def _iter_largest_loads(data: ReportData) -> Iterator[Sentence]:
    """Yield the sentences on the largest joint force, the largest force between bodies if that is larger, and the
    foundation.
    """
    foundation_force = find_greatest_of_cases(data, "foundation.force", "the foundation")
    paths = dict(iter_joining_forces(data))
    joints = [path for path in paths if path.startswith("joints.") and path.endswith(".force")]
    largest_so_far: GreatestOfCases | None = None
    for load_name, some_paths in (("joint force", joints), ("force between bodies", list(paths))):
        candidates = [
            spread
            for path in some_paths
            if (spread := find_greatest_of_cases(data, path, paths[path], by_magnitude=True)) is not None
        ]
        largest = max(candidates, key=_value_of_greatest, default=None)
        if largest is not None and (
            largest_so_far is None or largest.high.value > largest_so_far.high.value + largest_so_far.error
        ):
            largest_so_far, qualifier = largest, _format_qualifier(data, some_paths)
            yield Sentence(
                f"Largest {load_name}{qualifier}: {largest.format_value()} in {largest.name}{largest.position_text}."
            )
            yield from _iter_friction_notes(data, largest)
    if foundation_force is not None:
        qualifier = _format_qualifier(data, ["foundation.force"])
        yield Sentence(
            f"Largest force on the foundation{qualifier}: "
            f"{foundation_force.format_value()}{foundation_force.position_text}."
        )


def _iter_friction_notes(data: ReportData, largest: GreatestOfCases) -> Iterator[Sentence]:
    """Yield a sentence if smoothed friction has not reached its full value at the instant of a maximum."""
    run = next((run for run in data.runs if run.name == largest.high.case), None)
    if run is not None and largest.instant and largest.high.time in run.uncertain_instants.instants:
        yield Sentence(f"There, {run.uncertain_instants.note.removeprefix(f'{MARK} ')}.", "unsure")


def _iter_impact_sentences(data: ReportData) -> Iterator[Sentence]:
    """Yield the number of impacts before the horizon, and their largest impulse, for each case."""
    for run in data.runs:
        horizon = run.results.horizon
        impacts = [impact for impact in run.results.impulses if horizon is None or float(impact["time"]) < horizon]
        if not impacts:
            continue
        unit, size = data.units.find("N·s")
        largest = size * max(find_largest_impulses(impact, data.labels)[0] for impact in impacts)
        text = (
            f"{format_count(len(impacts), 'impulse')}; largest impulse at a joint, on the ground or of "
            "all bodies together:"
        )
        yield Sentence(f"{f'Case {run.name}: ' if run.name else ''}{text} {largest:.6g} {unit}.")


def _iter_open(data: ReportData) -> Iterator[Sentence]:
    """Yield the sentences on the load components that are indeterminate."""
    paths = list(dict.fromkeys(path for run in data.runs for path in run.snapshot.open))
    if paths:
        text = (
            f"Indeterminate: {format_count(len(paths), 'load component')} (open). The constraints are redundant, so "
            "the distribution depends on stiffness"
        )
        yield Sentence(f"{text} ({join_names(paths)}).", "unsure")
    splits = dict.fromkeys(run.results.model["split"] for run in data.runs if run.results.model.get("split"))
    for split in splits:
        yield Sentence(
            f"Distribution of indeterminate reactions: {split}; other distributions are equally possible.", "unsure"
        )


def _iter_warnings(data: ReportData) -> Iterator[Sentence]:
    """Yield every warning, with its case."""
    for problem in data.spec.warnings:
        yield Sentence(f"Warning: {problem.message}", "unsure")
    spec_messages = {problem.message for problem in data.spec.warnings}
    case_names: dict[str, list[str]] = {}
    for run in data.runs:
        for text in (*run.results.warnings, *run.study.later_warnings):
            if text not in spec_messages:
                case_names.setdefault(text, []).append(run.name)
    for text, names in case_names.items():
        case = f" (case {join_names(names)})" if any(names) else ""
        yield Sentence(f"Warning: {text}{case}", "unsure")
