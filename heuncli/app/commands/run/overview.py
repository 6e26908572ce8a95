"""Solve one scene, or all load cases, and write a short answer in place of the tables: `--summary`, `--hardpoints`."""

from __future__ import annotations

from collections.abc import Mapping

from heuncli.app.api import solve_spec
from heuncli.app.cli.documents import is_rich, render_document, render_rich_document
from heuncli.app.cli.entry import UsageError, select_exit_code
from heuncli.app.cli.output import emit
from heuncli.app.cli.solving import require_cases
from heuncli.app.cli.target import note_si_format
from heuncli.app.commands.run.request import RunRequest
from heuncli.app.commands.run.scene import RunTask, finish, make_query
from heuncli.base.errors import Problem
from heuncli.base.records import replace
from heuncli.output.documents.document import OutputDocument, Sentence
from heuncli.output.tables.page import search_run
from heuncli.output.tables.run_description import make_heading
from heuncli.output.tables.summary_document import (
    Summary,
    make_blocks,
    make_records,
    make_summary_table,
    merge_cases,
    summarise,
)
from heuncli.scene.file_format.models import Spec
from heuncli.scene.file_format.names import ALL_CASES
from heuncli.study.model.setup import attach_locations
from heuncli.study.quantities.labels import make_labels
from heuncli.study.queries.study import Study

NOT_WITH = ("at", "all", "measure", "collective", "by_cause")
NOTHING = "nothing to summarise: nothing is loaded at an instant"


def require_alone(request: RunRequest) -> None:
    """Raise UsageError if another option asks for something else than the short answer."""
    option = "--hardpoints" if request.hardpoints else "--summary"
    others = [*NOT_WITH, *(["only", "summary"] if request.hardpoints else [])]
    other = next((name for name in others if getattr(request, name)), None)
    if other is not None:
        word = f"--{other.replace('_', '-')}"
        raise UsageError(Problem("bad-option", f"{option} and {word} cannot be combined", hint=f"leave out {word}"))


def run_overview(task: RunTask, spec: Spec, cases: Mapping[str, Spec]) -> int:
    """Solve the scene, or every load case, and write summary or hardpoints; returns the exit code."""
    request = task.request
    has_cases = request.case == ALL_CASES
    if has_cases:
        require_cases(cases)
    scenes = cases if has_cases else {"": spec}
    studies: dict[str, Study] = {}
    for name, scene in scenes.items():
        studies[name] = solve_spec(scene, task.options)
    make_document = _make_hardpoints if request.hardpoints else _make_summary
    title = spec.title if has_cases else studies[""].results.title
    document = make_document(task, title, scenes, studies)
    is_coloured = request.summary and is_rich(task.form, request.output)
    emit(
        render_rich_document(document) if is_coloured else render_document(document, task.form, request.output),
        request.output,
    )
    note_si_format(request.units, task.form, request.quiet)
    codes = [
        finish(task, scenes[name], study, f"heun: case {name}" if name else "heun") for name, study in studies.items()
    ]
    return select_exit_code(codes)


def _make_facts(task: RunTask, studies: Mapping[str, Study]) -> list[tuple[str, str]]:
    """Make the lines below the title; of several cases those that all have, and the names of the cases."""
    request = task.request
    headings = [
        make_heading(study.results, request.verbose, brief=not (request.full or request.verbose))
        for study in studies.values()
    ]
    if len(headings) == 1:
        return headings[0]
    shared = [line for line in headings[0] if all(line in heading for heading in headings)]
    return [*shared, ("cases", ", ".join(studies))]


def _make_summary(
    task: RunTask, title: str, scenes: Mapping[str, Spec], studies: Mapping[str, Study]
) -> OutputDocument:
    """Make the document of the greatest loads of all studies."""
    summaries: list[Summary] = []
    for name, study in studies.items():
        with attach_locations(scenes[name]):
            labels = replace(make_labels(scenes[name]), units=task.units)
            summaries.append(summarise(study, search_run(study, labels, make_query(task, study, scenes[name])), name))
    merged = merge_cases(summaries)
    part = Sentence(NOTHING) if merged.is_empty else make_summary_table(merged, full=task.request.full)
    return OutputDocument(
        title, _make_facts(task, studies), [part], lambda: make_blocks(title, merged),
        lambda: make_records(merged),
    )  # fmt: skip


def _make_hardpoints(
    task: RunTask, title: str, scenes: Mapping[str, Spec], studies: Mapping[str, Study]
) -> OutputDocument:
    """Make the document of the loads at all joints and loads, each at its greatest force."""
    from heuncli.output.tables.hardpoints import make_hardpoint_document, make_hardpoints

    axes = task.request.axes or "world"
    runs, labels = [], None
    for name, study in studies.items():
        with attach_locations(scenes[name]):
            labels = replace(make_labels(scenes[name]), units=task.units)
            runs.append(make_hardpoints(study, labels, axes, name))
    assert labels is not None
    return make_hardpoint_document(title, _make_facts(task, studies), runs, labels, axes)
