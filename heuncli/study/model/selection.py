"""Select a part of the results: whole reports, or single entries of them.

An entry is named by its keys in the results: ("joints", "elbow"), ("foundation", "supports", "pivot").
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from typing import Any

from heuncli.base.records import record
from heuncli.results.path_words import names_shares, split_leading_key
from heuncli.results.results import DeterminateSum
from heuncli.results.results_schema import REPORT_OF, REPORTS, SHARES, find_report
from heuncli.scene.file_format.models import ResultCondition, Spec, WatchedCondition

EntryKeys = tuple[str, ...]
WRENCH = ("about", "force", "moment")
PARTS = ("axis", "mass_effect")  # parts of the foundation that can be requested by name
ALL_OF_IT = frozenset({"foundation", "sections"})  # these reports need all bodies, and all sections


@record
class Selection:
    """The requested reports; a report with entries is limited to these.

    Entries of other reports are not shown, but everything they depend on is solved. axes: of joint loads (joint_axes).
    """

    reports: frozenset[str] = frozenset(REPORTS)
    entries: frozenset[EntryKeys] = frozenset()
    axes: str = "world"

    @property
    def is_everything(self) -> bool:
        """Whether it needs all bodies and all sections solved."""
        return self.reports >= ALL_OF_IT and not self.entries

    def has_whole(self, report: str) -> bool:
        """Whether all of a report is requested."""
        return report in self.reports and report not in self.partial

    @property
    def partial(self) -> set[str]:
        """The reports of which only single entries are requested."""
        return {REPORT_OF[entry[0]] for entry in self.entries}

    def names_in(self, block: str) -> set[str]:
        """Return the names of a block's entries that are requested."""
        return {entry[1] for entry in self.entries if entry[0] == block}

    def union(self, other: Selection) -> Selection:
        """Return the selection of everything that either of the two selects."""
        whole = {report for one in (self, other) for report in one.reports if one.has_whole(report)}
        entries = frozenset(entry for entry in self.entries | other.entries if REPORT_OF[entry[0]] not in whole)
        return Selection(self.reports | other.reports, entries)


EVERYTHING = Selection()


def select_paths(paths: Iterable[str], spec: Spec) -> Selection:
    """Return the selection that some paths into the results need; EVERYTHING where the first word of a path does not
    say.
    """
    entries_by_block = list_entries(spec)
    reports, whole, entries = set[str](), set[str](), set[EntryKeys]()
    for path in paths:
        words = path.split(".")
        report = find_report(words[0])
        if report is None:
            return EVERYTHING
        entry, remaining = split_entry(words, entries_by_block)
        reports |= {report, SHARES} if names_shares(words) else {report}
        if entry is None:
            whole.add(report)
        else:
            entries |= {entry, *(find_cause_entries(remaining, spec) if names_shares(words) else ())}
    return Selection(frozenset(reports), frozenset(entry for entry in entries if REPORT_OF[entry[0]] not in whole))


def select_for_conditions(conditions: Iterable[WatchedCondition], spec: Spec) -> Selection:
    """Return the selection that conditions on results need."""
    return select_paths([condition.of for condition in conditions if isinstance(condition, ResultCondition)], spec)


def find_cause_entries(words: Sequence[str], spec: Spec) -> set[EntryKeys]:
    """Return the force whose share a path names: it must be solved, even if no requested part feels it."""
    cause = words[words.index(SHARES) + 1 :][:1] if SHARES in words else []
    return {("forces", name) for name in cause if name in spec.forces}


def split_entry(
    words: Sequence[str], entries_by_block: Mapping[EntryKeys, Mapping[str, Any]]
) -> tuple[EntryKeys | None, list[str]]:
    """Split the words of a path into the keys of an entry of the results, None if there is none, and the remaining
    words.
    """
    for block, names in entries_by_block.items():
        if tuple(words[: len(block)]) == block:
            name, remaining = split_leading_key(names, words[len(block) :])
            if name is not None:
                return (*block, name), remaining
    return None, list(words)


def list_entries(spec: Spec) -> dict[EntryKeys, dict[str, Any]]:
    """Return everything that can be requested by name, by block: for each name the entry of the spec it depends on.

    That is a joint, a force, ..., or the name of a body; None where it depends on the scene as a whole.
    """
    bodies = {name: name for name in spec.bodies}
    points = {f"{name}.{point}": name for name, body in spec.bodies.items() for point in body.points}
    stops = {**spec.stops, **spec.latches}
    elements: dict[str, Any] = {}
    for block, entries in {
        "forces": spec.forces,
        "stops": stops,
        "drives": spec.drives,
        "couplings": spec.couplings,
    }.items():
        for name, entry in entries.items():  # later entries of the same name carry their block's name in the foundation
            if name in elements:
                elements |= {f"{block}.{name}": entry, name: (elements[name], entry)}
            else:
                elements[name] = entry
    return {
        ("bodies",): bodies, ("points",): dict(points), ("coordinates",): dict(spec.joints),
        ("foundation",): dict.fromkeys(PARTS),
        ("foundation", "supports"): dict(spec.joints), ("foundation", "elements"): elements,
        ("joints",): dict(spec.joints), ("stops",): dict(stops),
        ("couplings",): dict(spec.couplings), ("sections",): dict(spec.sections),
        ("forces",): dict(spec.forces), ("system_vector", "bodies"): bodies,
    }  # fmt: skip


def select_blocks(blocks: Mapping[str, Any], selection: Selection) -> dict[str, Any]:
    """Return the selected part of the results' blocks."""
    if not selection.entries:
        return dict(blocks)
    selected: dict[str, Any] = {}
    for block, value in blocks.items():
        if REPORT_OF[block] not in selection.partial:
            selected[block] = value
        elif entries := pick_entries(value, [entry[1:] for entry in selection.entries if entry[0] == block]):
            # the error of an axis depends on that of its wrench
            shared_keys = WRENCH if "axis" in entries else WRENCH[:1]
            selected[block] = (
                {key: value[key] for key in shared_keys if key in value} | entries if block == "foundation" else entries
            )
    return selected


def pick_entries(block: Mapping[str, Any], entries: Sequence[EntryKeys]) -> dict[str, Any]:
    """Return the part of a block under some keys."""
    selected: dict[str, Any] = {}
    for key, value in block.items():
        remaining = [entry[1:] for entry in entries if entry[0] == key]
        if () in remaining:
            selected[key] = value
        elif remaining and (part := pick_entries(value, remaining)):
            selected[key] = part
    return selected


def select_sums(sums: Sequence[DeterminateSum], selection: Selection) -> list[DeterminateSum]:
    """Return the determinate sums that a requested joint has a part in."""
    if "joints" not in selection.partial:
        return list(sums)
    begins = tuple(f"{'.'.join(entry)}." for entry in selection.entries)
    return [one for one in sums if any(term.startswith(begins) for term in one["terms"])]
