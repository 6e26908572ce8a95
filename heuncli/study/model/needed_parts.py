"""Find the parts of a scene that the requested results depend on.

Bodies connected by joints and forces make a part; the ground connects nothing. A part influences no other, unless a
force or drive is given in coordinates of the other's joints: then it needs the other, which does not need it. Parts
that no requested result depends on are left out before anything is assembled, and so are sections that are not
requested.
"""

from __future__ import annotations

from collections.abc import Collection, Iterable, Iterator, Mapping
from typing import Any

from heuncli.base.records import fields
from heuncli.base.spelling import list_some
from heuncli.results.results_schema import EVENTS, IMPULSES, SHARES
from heuncli.scene.expressions.programs import Expression, is_load_name, is_point_name
from heuncli.scene.file_format.models import Condition, End, Spec
from heuncli.study.model.selection import Selection, list_entries

Ends = Mapping[str, Mapping[str, set[str]]]
# blocks whose entries refer to bodies
BODY_BLOCKS = ("joints", "drives", "forces", "impulses", "stops", "latches", "couplings")
# reports that concern some bodies only, and their blocks; other reports concern all bodies
BLOCKS_OF_REPORT = {
    "joints": (("joints",), ("stops",), ("couplings",)),
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
        elif name == "joint":
            found |= find_bodies(spec.joints[value], spec)
        elif name in ("ends", "through"):  # of couplings
            found |= {body for one in value for body in find_bodies(one, spec)}
    for joint in getattr(item, "joints", ()):  # of couplings
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
    if len(needed_bodies) == len(spec.bodies):
        return spec if len(cut) == len(spec.sections) else spec._replace(sections=select_items(spec.sections, cut))
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
