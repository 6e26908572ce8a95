"""The parts of a scene on which it depends what is asked for.

Bodies that joints and forces connect make a part; the ground connects nothing. No part feels another, unless a force or
drive of it is given in coordinates of the other's joints: then it needs the other, which does not need it. A part on
which nothing depends that is asked for is left out before anything is assembled, and so are sections that nobody asks
for.
"""

from __future__ import annotations

from collections.abc import Collection, Iterator, Mapping
from typing import Any

from heuncli.base.records import fields
from heuncli.results.results_schema import BLOWS, EVENTS, SHARES
from heuncli.scene.expressions.programs import Expression, is_of_load, is_of_point
from heuncli.scene.file_format.models import Condition, End, Spec
from heuncli.study.model.counts_and_lists import some
from heuncli.study.model.selection import Selection, entries_of

Ends = Mapping[str, Mapping[str, set[str]]]
# blocks of what stands on bodies
STANDING = ("joints", "drives", "forces", "impulses", "stops", "latches", "couplings")
# reports that are of some bodies alone, and the blocks of what they tell; the others are of all
OF_SOME = {"joints": (("joints",), ("stops",), ("couplings",)), "sections": (("sections",),), "forces": (("forces",),),
    "points": (("points",),)}  # fmt: skip


def bodies_of(item: Any, spec: Spec) -> set[str]:
    """The bodies that something in a spec names: itself, by its ends, or by its joint; not the ground."""
    if isinstance(item, str):
        return {item}
    if isinstance(item, End):
        return {item.body} & spec.bodies.keys()
    if type(item) is tuple:  # several of one name
        return set().union(*(bodies_of(one, spec) for one in item))
    found: set[str] = set()
    for name, value in named_fields(item):
        if isinstance(value, End):
            found.add(value.body)
        elif name in ("body", "a", "b"):
            found.add(value)
        elif name == "joint":
            found |= bodies_of(spec.joints[value], spec)
        elif name in ("ends", "through"):  # of couplings
            found |= {body for one in value for body in bodies_of(one, spec)}
    for joint in getattr(item, "joints", ()):  # of couplings
        found |= bodies_of(spec.joints[joint], spec)
    return found & spec.bodies.keys()


def named_fields(item: Any) -> Iterator[tuple[str, Any]]:
    """The fields of a part of a spec: a named tuple, or a record."""
    return zip(item._fields, item, strict=True) if hasattr(item, "_fields") else iter(fields(item).items())


def expressions_in(item: Any) -> Iterator[Expression]:
    """The values in time of a force or drive, of a rope's length, of a bushing; the conditions of a blow or latch."""
    if isinstance(item, Expression):
        yield item
    elif type(item) is tuple:
        for member in item:
            yield from expressions_in(member)
    elif hasattr(item, "_fields") or hasattr(item, "__record_fields__"):
        for _, value in named_fields(item):
            yield from expressions_in(value)


def followed(item: Any, spec: Spec) -> set[str]:
    """The bodies in whose coordinates and points values of a force, a drive or a blow are given."""
    uses = {name for expression in expressions_in(item) for name, _ in expression.uses}
    return set().union(*(read_at(name, spec) for name in uses))


def read_at(name: str, spec: Spec) -> set[str]:
    """The bodies of a joint or point that values name, or of the load whose own line or shift they name."""
    if is_of_point(name):
        return {name.split(".")[1]} & spec.bodies.keys()
    if is_of_load(name):
        return bodies_of(spec.forces[name.split(".")[1]], spec)
    return bodies_of(spec.joints[name], spec)


def ends_of(spec: Spec) -> Ends:
    """The bodies that everything with a name stands on, by block and name."""
    items: dict[str, Mapping[str, Any]] = {block: getattr(spec, block) for block in STANDING}
    return {block: {name: bodies_of(item, spec) for name, item in own.items()} for block, own in items.items()}


def needed(spec: Spec, asked: Selection, ends: Ends) -> set[str]:
    """The bodies on which it depends what is asked for: their parts, and those that these follow."""
    begun = roots(spec, asked)
    if begun is None:
        return set(spec.bodies)
    moved: list[set[str]] = []  # sets of bodies of which none is solved without the others
    beside: dict[str, set[str]] = {name: set() for name in spec.bodies}
    for block in STANDING:
        items: Mapping[str, Any] = getattr(spec, block)
        moved += ends[block].values()
        for name, item in items.items():
            others = followed(item, spec)
            for body in ends[block][name]:
                beside[body] |= others
    for group in moved:
        for body in group:
            beside[body] |= group
    found, ahead = set(begun), list(begun)
    while ahead:
        new = beside[ahead.pop()] - found
        found |= new
        ahead += new
    return found or set(spec.bodies)


def roots(spec: Spec, asked: Selection) -> set[str] | None:
    """The bodies that are named by what is asked for; None where it is about all bodies."""
    whole = [report for report in asked.reports - {SHARES, EVENTS} if asked.whole(report)]
    if any(report not in OF_SOME for report in whole):
        return None
    known = entries_of(spec)
    items = [item for report in whole for block in OF_SOME[report] for item in known[block].values()]
    items += [known[entry[:-1]][entry[-1]] for entry in asked.entries]
    if None in items:
        return None
    watched = [c.value for c in spec.analysis.conditions if isinstance(c, Condition)]
    read = {name for value in watched for name, _ in value.uses}
    return set().union(*(bodies_of(item, spec) for item in items), *(read_at(name, spec) for name in read))


def restricted(spec: Spec, asked: Selection, *, reduce: bool = True) -> Spec:
    """The spec as far as it is asked for: without other sections, and if reduced without parts nothing depends on."""
    ends = ends_of(spec) if reduce else {}
    kept = needed(spec, asked, ends) if reduce else set(spec.bodies)
    cut = set(spec.sections) if asked.whole("sections") or BLOWS in asked.reports else asked.of("sections")
    if len(kept) == len(spec.bodies):
        return spec if len(cut) == len(spec.sections) else spec._replace(sections=only(spec.sections, cut))
    held: dict[str, Any] = {"bodies": only(spec.bodies, kept), "sections": only(spec.sections, cut)}
    for block, standing in ends.items():
        held[block] = only(getattr(spec, block), {name for name, on in standing.items() if on <= kept})
    return spec._replace(**held)


def only(items: Mapping[str, Any], names: Collection[str]) -> dict[str, Any]:
    """The items of some names, in their order."""
    return {name: item for name, item in items.items() if name in names}


def left_out(whole: Spec, part: Spec) -> tuple[str, ...]:
    """What of a scene is not solved, in a sentence."""
    names = [name for name in whole.bodies if name not in part.bodies]
    if not names:
        return ()
    return (f"left out, because nothing that is asked for depends on it: {some(names)}",)
