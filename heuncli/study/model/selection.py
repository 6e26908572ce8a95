"""Select a part of the results, whole reports or single entries of them; find the parts of a scene that it depends on.

An entry is named by its keys in the results: ("joints", "elbow"), ("foundation", "supports", "pivot").

Bodies connected by joints and forces make a part; the ground connects nothing. A part influences no other, unless a
force or drive is given in coordinates of the other's joints: then it needs the other, which does not need it. Parts
that no requested result depends on are left out before anything is assembled, and so are sections that are not
requested.
"""

from __future__ import annotations

from collections.abc import Collection, Iterable, Iterator, Mapping, Sequence
from typing import Any

from heuncli.base.records import fields, record
from heuncli.base.spelling import list_some
from heuncli.results.path_words import names_shares, split_leading_key
from heuncli.results.results import DeterminateSum
from heuncli.results.results_schema import EVENTS, IMPULSES, REPORT_OF, REPORTS, SHARES, find_report
from heuncli.scene.expressions.programs import Expression, is_load_name, is_point_name
from heuncli.scene.file_format.models import Condition, End, ResultCondition, Spec, WatchedCondition

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
        """Return whether all of a report is requested."""
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
        ("joints",): dict(spec.joints), ("sensors",): dict(spec.sensors), ("stops",): dict(stops),
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


Ends = Mapping[str, Mapping[str, set[str]]]
# blocks whose entries refer to bodies
BODY_BLOCKS = ("joints", "drives", "forces", "impulses", "stops", "latches", "couplings", "sensors")
# reports that concern some bodies only, and their blocks; other reports concern all bodies
BLOCKS_OF_REPORT = {
    "joints": (("joints",), ("sensors",), ("stops",), ("couplings",)),
    "sections": (("sections",),),
    "forces": (("forces",),),
    "points": (("points",),),
}


def find_bodies(item: Any, spec: Spec) -> set[str]:
    """Return the bodies that an entry of a spec names: itself, by its ends, or by its joint; without the ground."""
    if isinstance(item, str):
        return {item}
    if isinstance(item, End):
        return {item.body} & spec.bodies.keys()
    if type(item) is tuple:  # several of one name
        return set().union(*(find_bodies(one, spec) for one in item))
    found: set[str] = set()
    for name, value in iter_named_fields(item):
        if isinstance(value, End):
            found.add(value.body)
        elif name in ("body", "a", "b"):
            found.add(value)
        elif name in ("joint", "section"):
            found |= find_bodies(getattr(spec, f"{name}s")[value], spec) if value is not None else set()
        elif name in ("ends", "through"):  # couplings name several points
            found |= {body for one in value for body in find_bodies(one, spec)}
    for joint in getattr(item, "joints", ()):  # couplings name joints
        found |= find_bodies(spec.joints[joint], spec)
    return found & spec.bodies.keys()


def iter_named_fields(item: Any) -> Iterator[tuple[str, Any]]:
    """Yield the fields of a part of a spec, which is a named tuple or a record."""
    return zip(item._fields, item, strict=True) if hasattr(item, "_fields") else iter(fields(item).items())


def iter_expressions(item: Any) -> Iterator[Expression]:
    """Yield the time laws of a force or drive, of a rope's length, of a bushing, and the conditions of an impulse or
    latch.
    """
    if isinstance(item, Expression):
        yield item
    elif type(item) is tuple:
        for member in item:
            yield from iter_expressions(member)
    elif hasattr(item, "_fields") or hasattr(item, "__record_fields__"):
        for _, value in iter_named_fields(item):
            yield from iter_expressions(value)


def find_followed_bodies(item: Any, spec: Spec) -> set[str]:
    """Return the bodies whose coordinates and points the values of a force, drive or impulse depend on."""
    uses = {name for expression in iter_expressions(item) for name, _ in expression.uses}
    return set().union(*(find_bodies_of_name(name, spec) for name in uses))


def find_bodies_of_name(name: str, spec: Spec) -> set[str]:
    """Return the bodies of a joint or point named in a value, or of the load whose line or travel it names."""
    if is_point_name(name):
        return {name.split(".")[1]} & spec.bodies.keys()
    if is_load_name(name):
        return find_bodies(spec.forces[name.split(".")[1]], spec)
    return find_bodies(spec.joints[name], spec)


def find_all_bodies(spec: Spec) -> Ends:
    """Return the bodies of every named entry, by block and name."""
    items: dict[str, Mapping[str, Any]] = {block: getattr(spec, block) for block in BODY_BLOCKS}
    return {block: {name: find_bodies(item, spec) for name, item in own.items()} for block, own in items.items()}


def find_needed_bodies(spec: Spec, selection: Selection) -> set[str]:
    """Return the bodies that the requested results depend on: their parts, and those that these follow."""
    requested = find_requested_bodies(spec, selection)
    if requested is None:
        return set(spec.bodies)
    neighbours: dict[str, set[str]] = {name: set() for name in spec.bodies}
    add_groups(neighbours, (find_bodies(joint, spec) for joint in spec.joints.values()))
    found = find_reachable(requested, neighbours)
    if len(found) < len(neighbours):  # seldom; all other entries, and what they follow, take much longer
        for block, bodies_by_name in find_all_bodies(spec).items():
            add_groups(neighbours, bodies_by_name.values())
            for name, bodies in bodies_by_name.items():
                others = find_followed_bodies(getattr(spec, block)[name], spec)
                for body in bodies:
                    neighbours[body] |= others
        found = find_reachable(requested, neighbours)
    return found or set(spec.bodies)


def add_groups(neighbours: Mapping[str, set[str]], groups: Iterable[set[str]]) -> None:
    """Make all bodies of a group neighbours, for none of them is solved without the others."""
    for group in groups:
        for body in group:
            neighbours[body] |= group


def find_reachable(start: Collection[str], neighbours: Mapping[str, set[str]]) -> set[str]:
    """Return all that can be reached from some names by way of neighbours, these names included."""
    found, pending = set(start), list(start)
    while pending:
        new = neighbours[pending.pop()] - found
        found |= new
        pending += new
    return found


def find_requested_bodies(spec: Spec, selection: Selection) -> set[str] | None:
    """Return the bodies that the requested results name; None if these are about all bodies."""
    whole = [report for report in selection.reports - {SHARES, EVENTS} if selection.has_whole(report)]
    if any(report not in BLOCKS_OF_REPORT for report in whole):
        return None
    known = list_entries(spec)
    items = [item for report in whole for block in BLOCKS_OF_REPORT[report] for item in known[block].values()]
    items += [known[entry[:-1]][entry[-1]] for entry in selection.entries]
    if None in items:
        return None
    watched = [c.value for c in spec.analysis.conditions if isinstance(c, Condition)]
    names = {name for value in watched for name, _ in value.uses}
    return set().union(
        *(find_bodies(item, spec) for item in items), *(find_bodies_of_name(name, spec) for name in names)
    )


def restrict_spec(spec: Spec, selection: Selection, *, reduce: bool = True) -> Spec:
    """Return the spec without sections that are not requested and, if `reduce`, without parts that nothing depends
    on.
    """
    needed_bodies = find_needed_bodies(spec, selection) if reduce else set(spec.bodies)
    cut = (
        set(spec.sections)
        if selection.has_whole("sections") or IMPULSES in selection.reports
        else selection.names_in("sections")
    )
    is_read = selection.names_in("sensors").__contains__ if "joints" in selection.partial else spec.sensors.__contains__
    if "joints" in selection.reports:
        cut |= {own.section for name, own in spec.sensors.items() if own.section is not None and is_read(name)}
    readable = {name: own for name, own in spec.sensors.items() if own.section is None or own.section in cut}
    if len(needed_bodies) == len(spec.bodies):
        if len(cut) == len(spec.sections):
            return spec
        return spec._replace(sections=select_items(spec.sections, cut), sensors=readable)
    spec = spec._replace(sensors=readable)
    entries: dict[str, Any] = {
        "bodies": select_items(spec.bodies, needed_bodies),
        "sections": select_items(spec.sections, cut),
    }
    for block, bodies_by_name in find_all_bodies(spec).items():
        entries[block] = select_items(
            getattr(spec, block), {name for name, bodies in bodies_by_name.items() if bodies <= needed_bodies}
        )
    return spec._replace(**entries)


def select_items(items: Mapping[str, Any], names: Collection[str]) -> dict[str, Any]:
    """Return the items with some names, in their order."""
    return {name: item for name, item in items.items() if name in names}


def describe_left_out(whole: Spec, part: Spec) -> tuple[str, ...]:
    """Say in a sentence which bodies of a scene are not solved."""
    names = [name for name in whole.bodies if name not in part.bodies]
    if not names:
        return ()
    return (f"left out, because no requested result depends on it: {list_some(names)}",)
