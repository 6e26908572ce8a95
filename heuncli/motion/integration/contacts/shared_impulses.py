"""Which one-sided contacts share the impulse of a blow, so that rigid bodies alone do not say how: found and said.

A contact shares a blow with another one if both bear an impulse and each changes the other's rate of opening. Ropes,
paths and cams without restitution, and wheels, push or pull one way only, too; a blow meets them as held both ways.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence

import numpy as np

from heuncli.base import tolerances
from heuncli.base.records import record, replace
from heuncli.multibody.tree.layout import Layout
from heuncli.results.results import Array, Mask
from heuncli.scene.file_format.models import SIMULTANEOUS, ImpactModel

MOST_NAMES = 6  # that a sentence lists


@record
class SharedImpulse:
    """Contacts that share one blow.

    names: of all of them; held: those of them that the blow meets as held both ways; impacts: how often all others were
    struck in it; settled: those that rest behind infinitely many impacts.
    """

    names: tuple[str, ...]
    held: tuple[str, ...] = ()
    impacts: int = 0
    settled: tuple[str, ...] = ()


@record
class LoadedContact:
    """A one-sided contact that may bear an impulse in a blow.

    row: of the closures; column: of the blow's columns, the one that its own impulse makes, -1: none; is_held: whether
    the blow meets it as held both ways; impacts: how often it was struck; settled: whether it rests behind infinitely
    many impacts.
    """

    name: str
    row: int
    column: int = -1
    is_held: bool = False
    impacts: int = 0
    settled: bool = False


def held_contacts(layout: Layout) -> list[LoadedContact]:
    """One-sided conditions that a blow meets as held both ways: ropes, paths and cams without restitution, wheels."""
    mechanism = layout.mechanism
    found = [
        LoadedContact(mechanism.owner(layout.rows[row["row"]]).partition(".")[2], int(row["row"]), is_held=True)
        for row in layout.tables["contacts"]
        if row["opens"] == 0
    ]
    for owner, coupling in enumerate(mechanism.couplings, len(mechanism.joints)):
        if coupling.given.type == "wheel" and not coupling.given.held:
            found.append(LoadedContact(coupling.name, layout.rows.index(owner), is_held=True))  # its first row touches
    return found


def loaded(contacts: Iterable[LoadedContact], multipliers: Array) -> list[LoadedContact]:
    """Those whose rows bear an impulse; multipliers (n, rows): of the columns of a blow."""
    least = tolerances.NO_FORCE * np.abs(multipliers).max(initial=0.0)
    return [contact for contact in contacts if abs(float(multipliers[:, contact.row].sum())) > least]


def find_shared_impulses(contacts: Sequence[LoadedContact], felt: Mask, multipliers: Array) -> list[SharedImpulse]:
    """The groups of loaded contacts that change each other's rates.

    felt (n, n): whether the impulse of the one changes the rate of the other, as far as both open; multipliers
    (n_c, rows): of the columns of the blow, by which those that are held feel each cause.
    """
    group = list(range(len(contacts)))

    def join(i: int, k: int) -> None:
        old, new = group[i], group[k]
        group[:] = [new if own == old else own for own in group]

    for i, k in zip(*np.nonzero(felt), strict=True):
        join(int(i), int(k))
    held = [i for i, contact in enumerate(contacts) if contact.is_held]
    for number, column in enumerate(multipliers):
        least = tolerances.NO_FORCE * np.abs(column).max(initial=0.0)
        own = [i for i in held if abs(column[contacts[i].row]) > least]
        own += [i for i, contact in enumerate(contacts) if contact.column == number and i not in own]
        for i in own[1:]:
            join(i, own[0])
    parts = ([c for c, own in zip(contacts, group, strict=True) if own == number] for number in dict.fromkeys(group))
    return [shared_impulse(part) for part in parts if len(part) > 1]


def shared_impulse(contacts: Sequence[LoadedContact]) -> SharedImpulse:
    """What is told of contacts that share a blow."""
    return SharedImpulse(
        tuple(dict.fromkeys(contact.name for contact in contacts)),
        tuple(dict.fromkeys(contact.name for contact in contacts if contact.is_held)),
        sum(contact.impacts for contact in contacts),
        tuple(dict.fromkeys(contact.name for contact in contacts if contact.settled)),
    )


def sharing_sentences(blows: Sequence[tuple[float, Sequence[SharedImpulse]]], impacts: ImpactModel) -> list[str]:
    """A sentence for each group of contacts that share blows; blows: their instants and the groups of each."""
    first: dict[tuple[object, ...], tuple[float, SharedImpulse]] = {}
    count: dict[tuple[object, ...], int] = {}
    for time, groups in blows:
        for shared in groups:
            key = replace(shared, impacts=0).names, shared.held, shared.settled
            first.setdefault(key, (time, shared))
            count[key] = count.get(key, 0) + 1
    return [sentence(time, shared, count[key], impacts) for key, (time, shared) in first.items()]


def sentence(time: float, shared: SharedImpulse, count: int, impacts: ImpactModel) -> str:
    """How contacts share a blow, and what is assumed."""
    several = f"{count} blows, the first" if count > 1 else "the blow"
    lead = f"{listed(shared.names)} share {several} at t = {time:.6g} s; how is a model (impacts: {impacts}): "
    struck = [name for name in shared.names if name not in shared.held]
    parts = []
    if struck and impacts == SIMULTANEOUS:
        parts.append("all act at the same time, what is struck takes its own restitution, what rested does not rebound")
    elif struck:
        number = f"{shared.impacts} impacts" if shared.impacts != 1 else "one impact"
        parts.append(
            f"they strike one after another, as over equal tiny gaps, each with its own restitution ({number})"
        )
    if shared.settled:
        parts.append(f"{listed(shared.settled)} {verb(shared.settled, 'rests', 'rest')} behind infinitely many impacts")
    if shared.held:
        parts.append(f"{listed(shared.held)} {verb(shared.held, 'is', 'are')} held both ways, without rebound")
    return lead + "; ".join(parts)


def sharing_warning(blows: Sequence[tuple[float, Sequence[SharedImpulse]]], impacts: ImpactModel) -> list[str]:
    """A sentence where contacts share blows: their numbers hang on a model."""
    own = [(time, groups[0]) for time, groups in blows if groups]
    if not own:
        return []
    time, shared = own[0]
    lead = (
        f"in the blow at t = {time:.6g} s" if len(own) == 1 else f"in {len(own)} blows, the first at t = {time:.6g} s,"
    )
    assumed = f"rigid bodies do not say how, impacts: {impacts} is assumed (heun explain impacts)"
    return [f"{lead} {listed(shared.names)} share the impulse: {assumed}"]


def listed(names: Sequence[str]) -> str:
    """Names as they stand in a sentence, the first of many."""
    if len(names) > MOST_NAMES:
        return f"{', '.join(names[:MOST_NAMES])} and {len(names) - MOST_NAMES} more"
    return " and ".join(filter(None, (", ".join(names[:-1]), names[-1])))


def verb(names: Sequence[str], one: str, several: str) -> str:
    """The form of a verb that fits so many names."""
    return one if len(names) == 1 else several
