"""Select the reports of a spec: those requested by name or by single entries, or the default ones.

option: the option that requested them, as messages name it
measures: the option that prints single numbers
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from typing import Any

from heuncli.base.errors import Problem, UsageError
from heuncli.base.named_tuples import NamedTuple
from heuncli.base.spelling import find_similar, list_words, suggest
from heuncli.output.tables.page import TABLE_DEFAULT
from heuncli.results.path_words import find_quantity
from heuncli.results.results_schema import IMPULSES, REPORT_OF, REPORTS, ROWS, SHARES, add_shared_reports
from heuncli.scene.file_format.models import Spec
from heuncli.study.model.options import require_choice
from heuncli.study.model.selection import EntryKeys, Selection, list_entries, split_entry


class ReportChoice(NamedTuple):
    """What is requested: whole reports, and the paths of single entries."""

    reports: frozenset[str]
    paths: tuple[str, ...]
    option: str = "--only"
    measures: str = "--measure"


def find_default_reports(spec: Spec) -> frozenset[str]:
    """Return the spec's `report`, or by default all but motion and points; of impacts at time 0 only the impacts."""
    if spec.report.results is not None:
        return frozenset(spec.report.results)
    return frozenset({IMPULSES}) if spec.analysis.type == "impulse" else TABLE_DEFAULT


def parse_choice(words: Iterable[str], option: str = "--only", measures: str = "--measure") -> ReportChoice:
    """Parse the names of reports and the paths of single entries. Raises UsageError for a word that can be neither."""
    names = [REPORT_OF.get(word.strip(), word.strip()) for word in words]
    paths = tuple(name for name in names if name not in (*REPORTS, SHARES))
    for name in paths:
        if not all(part.isidentifier() or part.isdecimal() for part in name.split(".")):
            require_choice(option, name, (*REPORTS, SHARES))
    return ReportChoice(frozenset(names) - frozenset(paths), paths, option, measures)


def select_reports(
    request: ReportChoice | None, spec: Spec, default: frozenset[str], *, by_cause: bool = False
) -> Selection:
    """Select what is requested; default: the reports without a request.

    Raises UsageError for entries that the scene does not have.
    """
    reports, entries = default, frozenset[EntryKeys]()
    if request is not None:
        reports = request.reports
        requested_entries = [_find_entry(path, spec, request) for path in request.paths]
        entries = frozenset(entry for entry in requested_entries if REPORT_OF[entry[0]] not in reports)
        reports = reports | {REPORT_OF[entry[0]] for entry in requested_entries}
    return Selection(add_shared_reports(reports | {SHARES} if by_cause else reports), entries)


def _find_entry(path: str, spec: Spec, request: ReportChoice) -> EntryKeys:
    """Return the entry that a path names."""
    words = path.split(".")
    entries = list_entries(spec)
    entry, rest = split_entry(words, entries)
    if entry is not None and not rest:
        return entry
    names = [
        ".".join((*block, name))
        for block, entry_names in entries.items()
        if block[0] == words[0]
        for name in entry_names
    ]
    _require_similar(path, words, names, request)
    message = f"{request.option} {path}: not an entry of the results"
    if entry is not None:
        hint = f"use {'.'.join(entry)}; {request.measures} prints single numbers"
    elif find_quantity(words) is not None and REPORT_OF.get(words[0]):
        hint = f"use {words[0]}; {request.measures} prints single numbers"
    elif words[0] not in REPORT_OF:
        known = ", ".join((*REPORTS, SHARES))
        message = f"{request.option} {path}: unknown report; known: {known}, or entries such as joints.NAME"
        hint = _make_hint(path, entries, request.option)
    else:
        hint = suggest(path, names, "entries") if names else f"the model has no {words[0]}"
    raise UsageError(Problem("bad-option", message, hint=hint))


def _require_similar(path: str, words: Sequence[str], names: Sequence[str], request: ReportChoice) -> None:
    """Raise UsageError with the list of a block's entries if a path names none of them, and resembles none.

    The name alone is compared: all entries of a block begin alike.
    """
    block, *last = words
    known = [name.split(".", 1)[1] for name in names]
    if not last or not known or find_quantity(words) is not None or words[:-1] == ["foundation", "axis"]:
        return
    below = [name for name in names if name.startswith(f"{path}.")]
    if below or (find_similar(".".join(last), known) is None and not set(".".join(words[1:]).split(".")) & set(known)):
        message = f"{request.option} {path}: not an entry of the results"
        hint = f"{request.option} {block} shows all of it; entries: {list_words(below or names)}"
        raise UsageError(Problem("bad-option", message, hint=hint))


def _make_hint(path: str, entries: Mapping[EntryKeys, Mapping[str, Any]], option: str) -> str:
    """Return a hint on a path that begins with no block of results."""
    from heuncli.results.path_hints import find_similar_path  # only for an error message

    block, _, name = path.partition(".")
    near = find_similar(block, [first for first, *_ in entries])
    if near is not None and name.split(".")[0] in entries.get((near,), {}):
        return f"did you mean {near}.{name.split('.')[0]}?"
    similar = find_similar(path, (*REPORTS, SHARES))
    if "." not in path and not similar:
        rows = (row.path.split(".") for row in ROWS)
        report = next((REPORT_OF[words[0]] for words in rows if path in words[2:] and words[0] in REPORT_OF), None)
        if report is not None:
            return f"{path} is part of {report}: {option} {report}"
    elif "." not in path:
        return f"did you mean {similar}?"
    entry = find_similar_path(path, lambda words: split_entry(words, entries)[0] is not None)
    if entry is not None:
        return f"did you mean {'.'.join(split_entry(entry.split('.'), entries)[0] or ())}?"
    return f"did you mean {similar}?" if similar else f"for example {option} foundation,joints.NAME"
