"""What of the results is asked for: whole reports, or single entries of them.

An entry is named by the keys under which it stands in the results: ("joints", "elbow"), ("foundation", "supports",
"pivot").
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from typing import Any

from heuncli.base.records import record
from heuncli.results.results import CertainSum
from heuncli.results.results_schema import REPORT_OF, REPORTS, SHARES, leading_key, names_shares, report_of
from heuncli.scene.file_format.models import ResultCondition, Spec, WatchedCondition

EntryKeys = tuple[str, ...]
WRENCH = ("about", "force", "moment")
PARTS = ("axis", "mass_effect")  # of the foundation, that are asked for by name
ALL_OF_IT = frozenset({"foundation", "sections"})  # of all bodies, of all sections


@record
class Selection:
    """Reports that are asked for, those with entries as far as these go.

    An entry of another report is not told; what it stands on is solved all the same. axes: of joint loads (joint_axes).
    """

    reports: frozenset[str] = frozenset(REPORTS)
    entries: frozenset[EntryKeys] = frozenset()
    axes: str = "world"

    @property
    def is_everything(self) -> bool:
        """Whether all bodies are solved for it, and all sections."""
        return self.reports >= ALL_OF_IT and not self.entries

    def whole(self, report: str) -> bool:
        """Whether all of a report is asked for."""
        return report in self.reports and report not in self.partial

    @property
    def partial(self) -> set[str]:
        """The reports of which single entries are asked for."""
        return {REPORT_OF[entry[0]] for entry in self.entries}

    def of(self, block: str) -> set[str]:
        """The names of a block's entries that are asked for."""
        return {entry[1] for entry in self.entries if entry[0] == block}

    def with_all(self, other: Selection) -> Selection:
        """What either of the two asks for."""
        whole = {report for one in (self, other) for report in one.reports if one.whole(report)}
        entries = frozenset(entry for entry in self.entries | other.entries if REPORT_OF[entry[0]] not in whole)
        return Selection(self.reports | other.reports, entries)


EVERYTHING = Selection()


def asked_by(paths: Iterable[str], spec: Spec) -> Selection:
    """What some paths into the results need; everything where the first word of one does not say."""
    known = entries_of(spec)
    reports, whole, entries = set[str](), set[str](), set[EntryKeys]()
    for path in paths:
        words = path.split(".")
        report = report_of(words[0])
        if report is None:
            return EVERYTHING
        entry, rest = entry_at(words, known)
        reports |= {report, SHARES} if names_shares(words) else {report}
        if entry is None:
            whole.add(report)
        else:
            entries |= {entry, *(share_of(rest, spec) if names_shares(words) else ())}
    return Selection(frozenset(reports), frozenset(entry for entry in entries if REPORT_OF[entry[0]] not in whole))


def needed_by(conditions: Iterable[WatchedCondition], spec: Spec) -> Selection:
    """What conditions on numbers of the results need."""
    return asked_by([condition.of for condition in conditions if isinstance(condition, ResultCondition)], spec)


def share_of(words: Sequence[str], spec: Spec) -> set[EntryKeys]:
    """The force whose share a path names: it is needed, though none of the parts that it does not reach feels it."""
    cause = words[words.index(SHARES) + 1 :][:1] if SHARES in words else []
    return {("forces", name) for name in cause if name in spec.forces}


def entry_at(words: Sequence[str], known: Mapping[EntryKeys, Mapping[str, Any]]) -> tuple[EntryKeys | None, list[str]]:
    """The entry of the results to which the first words of a path lead, and the words behind it."""
    for block, names in known.items():
        if tuple(words[: len(block)]) == block:
            name, rest = leading_key(names, words[len(block) :])
            if name is not None:
                return (*block, name), rest
    return None, list(words)


def entries_of(spec: Spec) -> dict[EntryKeys, dict[str, Any]]:
    """What can be asked for by its name, by the block in which it stands: of each name what it stands on in the spec.

    That is a joint, a force, ..., or the name of a body; nothing where it stands on the scene as a whole.
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
        for name, entry in entries.items():  # of one name the later ones have their block before it, on the ground
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


def chosen(shown: Mapping[str, Any], asked: Selection) -> dict[str, Any]:
    """The blocks of the results as far as they are asked for."""
    if not asked.entries:
        return dict(shown)
    found: dict[str, Any] = {}
    for block, value in shown.items():
        if REPORT_OF[block] not in asked.partial:
            found[block] = value
        elif own := picked(value, [entry[1:] for entry in asked.entries if entry[0] == block]):
            beside = WRENCH if "axis" in own else WRENCH[:1]  # an axis is as well known as the wrench that it is of
            found[block] = {key: value[key] for key in beside if key in value} | own if block == "foundation" else own
    return found


def picked(block: Mapping[str, Any], entries: Sequence[EntryKeys]) -> dict[str, Any]:
    """What stands in a block under some keys."""
    found: dict[str, Any] = {}
    for key, value in block.items():
        behind = [entry[1:] for entry in entries if entry[0] == key]
        if () in behind:
            found[key] = value
        elif behind and (own := picked(value, behind)):
            found[key] = own
    return found


def sums_among(sums: Sequence[CertainSum], asked: Selection) -> list[CertainSum]:
    """The certain sums that a joint has a part in that is asked for."""
    if "joints" not in asked.partial:
        return list(sums)
    begins = tuple(f"{'.'.join(entry)}." for entry in asked.entries)
    return [one for one in sums if any(term.startswith(begins) for term in one["terms"])]
