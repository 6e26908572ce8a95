"""Which reports are told of a spec: those that somebody asks for, by name or by single entries, else by default.

option: what asked, as it is called in messages; measures: what gives single numbers there.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from typing import Any

from heuncli.base.errors import Problem, UsageError
from heuncli.base.named_tuples import NamedTuple
from heuncli.base.nearest import did_you_mean, nearest
from heuncli.output.tables.page import TABLE_DEFAULT
from heuncli.results.results_schema import BLOWS, REPORT_OF, REPORTS, ROWS, SHARES, quantity, with_shared
from heuncli.scene.file_format.models import Spec
from heuncli.study.ask.asked_values import choice
from heuncli.study.model.selection import EntryKeys, Selection, entries_of, entry_at


class Only(NamedTuple):
    """What alone is asked for: whole reports, and the paths of single entries."""

    reports: frozenset[str]
    paths: tuple[str, ...]
    option: str = "--only"
    measures: str = "--measure"


def told_by_default(spec: Spec) -> frozenset[str]:
    """Those of the spec's `report`; else all but motion and points, and of blows at time 0 alone the blows."""
    if spec.report is not None:
        return frozenset(spec.report)
    return frozenset({BLOWS}) if spec.analysis.type == "impulse" else TABLE_DEFAULT


def only(words: Iterable[str], option: str = "--only", measures: str = "--measure") -> Only:
    """The reports, and the paths of single entries, that some words name; what is no report may be such an entry.

    Raises UsageError for what can be neither.
    """
    names = [REPORT_OF.get(word.strip(), word.strip()) for word in words]
    paths = tuple(name for name in names if name not in (*REPORTS, SHARES))
    for name in paths:
        if not all(part.isidentifier() or part.isdecimal() for part in name.split(".")):
            choice(option, name, (*REPORTS, SHARES))
    return Only(frozenset(names) - frozenset(paths), paths, option, measures)


def selected(asked: Only | None, spec: Spec, default: frozenset[str], *, by_cause: bool = False) -> Selection:
    """What is asked for; default: the reports where nothing is. Raises UsageError for what the scene does not have."""
    wanted, entries = default, frozenset[EntryKeys]()
    if asked is not None:
        wanted = asked.reports
        single = [_entry(path, spec, asked) for path in asked.paths]
        entries = frozenset(entry for entry in single if REPORT_OF[entry[0]] not in wanted)
        wanted = wanted | {REPORT_OF[entry[0]] for entry in single}
    return Selection(with_shared(wanted | {SHARES} if by_cause else wanted), entries)


def _entry(path: str, spec: Spec, asked: Only) -> EntryKeys:
    """The entry that a path names."""
    words = path.split(".")
    known = entries_of(spec)
    entry, rest = entry_at(words, known)
    if entry is not None and not rest:
        return entry
    names = [".".join((*block, name)) for block, own in known.items() if block[0] == words[0] for name in own]
    message = f"{asked.option} {path}: not an entry of the results"
    if entry is not None:
        hint = f"say {'.'.join(entry)}; {asked.measures} prints single numbers"
    elif quantity(words) is not None and REPORT_OF.get(words[0]):
        hint = f"say {words[0]}; {asked.measures} prints single numbers"
    elif words[0] not in REPORT_OF:
        message = f"{asked.option} {path}: known: {', '.join((*REPORTS, SHARES))}, or entries of them, as joints.NAME"
        hint = _meant(path, known, asked.option)
    else:
        hint = did_you_mean(path, names, "entries") if names else f"the scene has no {words[0]}"
    raise UsageError(Problem("bad-option", message, hint=hint))


def _meant(path: str, known: Mapping[EntryKeys, Mapping[str, Any]], option: str) -> str:
    """What may be meant by a path that begins with no block."""
    from heuncli.results.path_hints import meant  # only on the way to an error

    near = nearest(path, (*REPORTS, SHARES))
    if "." not in path and not near:
        rows = (row.path.split(".") for row in ROWS)
        told = next((REPORT_OF[words[0]] for words in rows if path in words[2:] and words[0] in REPORT_OF), None)
        if told is not None:
            return f"{path} is told in {told}: {option} {told}"
    elif "." not in path:
        return f"did you mean {near}?"
    entry = meant(path, lambda words: entry_at(words, known)[0] is not None)
    if entry is not None:
        return f"did you mean {'.'.join(entry_at(entry.split('.'), known)[0] or ())}?"
    return f"did you mean {near}?" if near else f"such as {option} foundation,joints.NAME"
