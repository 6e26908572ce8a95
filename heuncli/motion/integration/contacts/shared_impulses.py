"""Find and describe the unilateral contacts that share an impulse, so that rigid bodies alone do not determine how.

A contact shares an impulse with another one if both bear an impulse and each changes the other's rate of opening.
Ropes, paths and cams without restitution, and wheels, push or pull one way only, too; an impulse meets them as if held
both ways.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence

import numpy as np

from heuncli.base import tolerances
from heuncli.base.records import record
from heuncli.base.spelling import choose_verb_form, join_names
from heuncli.multibody.tree.layout import Layout
from heuncli.results.results import Array, Mask
from heuncli.scene.file_format.models import SIMULTANEOUS, ImpactModel


@record
class SharedImpulse:
    """Contacts that share one impulse.

    names: names of all of them
    bilateral_names: those of them that the impulse meets as held both ways
    impacts: how often all others were struck in it
    resting_names: those that rest after infinitely many impacts
    """

    names: tuple[str, ...]
    bilateral_names: tuple[str, ...] = ()
    impacts: int = 0
    resting_names: tuple[str, ...] = ()


@record
class LoadedContact:
    """A unilateral contact that may bear an impulse.

    row: its closure row
    column: the column that its own impulse makes, -1 if none
    is_held: whether the impulse meets it as held both ways
    impacts: how often it was struck
    comes_to_rest: whether it rests after infinitely many impacts
    """

    name: str
    row: int
    column: int = -1
    is_held: bool = False
    impacts: int = 0
    comes_to_rest: bool = False


def list_bilateral_contacts(layout: Layout) -> list[LoadedContact]:
    """Return the unilateral contacts that an impulse meets as held both ways: ropes, paths, cams without restitution,
    wheels.
    """
    mechanism = layout.mechanism
    contacts = [
        LoadedContact(mechanism.owner_path(layout.rows[row["row"]]).partition(".")[2], int(row["row"]), is_held=True)
        for row in layout.tables["contacts"]
        if row["mode_index"] == 0
    ]
    for owner, coupling in enumerate(mechanism.couplings, len(mechanism.joints)):
        if coupling.entry.type == "wheel" and not coupling.entry.held:
            # its first row touches
            contacts.append(LoadedContact(coupling.name, layout.rows.index(owner), is_held=True))
    return contacts


def select_loaded(contacts: Iterable[LoadedContact], multipliers: Array) -> list[LoadedContact]:
    """Select the contacts whose rows bear an impulse; multipliers (n, rows): of the columns of the impulse."""
    least = tolerances.NO_FORCE * np.abs(multipliers).max(initial=0.0)
    return [contact for contact in contacts if abs(float(multipliers[:, contact.row].sum())) > least]


def find_shared_impulses(
    contacts: Sequence[LoadedContact], is_coupled: Mask, multipliers: Array
) -> list[SharedImpulse]:
    """Find the groups of loaded contacts that change each other's rates.

    is_coupled (n, n): whether the impulse of one changes the rate of the other, as far as both can open
    multipliers (n_c, rows): of the columns of the impulse, which show the causes that act on held contacts
    """
    group_numbers = list(range(len(contacts)))

    def join_groups(i: int, k: int) -> None:
        old, new = group_numbers[i], group_numbers[k]
        group_numbers[:] = [new if group_number == old else group_number for group_number in group_numbers]

    for i, k in zip(*np.nonzero(is_coupled), strict=True):
        join_groups(int(i), int(k))
    held_indices = [i for i, contact in enumerate(contacts) if contact.is_held]
    for number, column in enumerate(multipliers):
        least = tolerances.NO_FORCE * np.abs(column).max(initial=0.0)
        loaded_indices = [i for i in held_indices if abs(column[contacts[i].row]) > least]
        loaded_indices += [
            i for i, contact in enumerate(contacts) if contact.column == number and i not in loaded_indices
        ]
        for i in loaded_indices[1:]:
            join_groups(i, loaded_indices[0])
    parts = (
        [c for c, group_number in zip(contacts, group_numbers, strict=True) if group_number == number]
        for number in dict.fromkeys(group_numbers)
    )
    return [make_shared_impulse(part) for part in parts if len(part) > 1]


def make_shared_impulse(contacts: Sequence[LoadedContact]) -> SharedImpulse:
    """Collect what is reported of contacts that share an impulse."""
    return SharedImpulse(
        tuple(dict.fromkeys(contact.name for contact in contacts)),
        tuple(dict.fromkeys(contact.name for contact in contacts if contact.is_held)),
        sum(contact.impacts for contact in contacts),
        tuple(dict.fromkeys(contact.name for contact in contacts if contact.comes_to_rest)),
    )


def format_sharing(impulses: Sequence[tuple[float, Sequence[SharedImpulse]]], impacts: ImpactModel) -> list[str]:
    """Format a sentence for each group of contacts that share impulses; impulses: their instants and the groups of
    each.
    """
    first: dict[tuple[object, ...], tuple[float, SharedImpulse]] = {}
    count: dict[tuple[object, ...], int] = {}
    for time, groups in impulses:
        for shared in groups:
            key = shared.names, shared.bilateral_names, shared.resting_names
            first.setdefault(key, (time, shared))
            count[key] = count.get(key, 0) + 1
    return [format_sharing_sentence(time, shared, count[key], impacts) for key, (time, shared) in first.items()]


def format_sharing_sentence(time: float, shared_group: SharedImpulse, count: int, impacts: ImpactModel) -> str:
    """Say how contacts share an impulse, and what is assumed."""
    several = f"{count} impulses, the first" if count > 1 else "the impulse"
    lead = (
        f"{join_names(shared_group.names)} share {several} at t = {time:.6g} s; "
        f"the split is a model assumption (impacts: {impacts}): "
    )
    struck_names = [name for name in shared_group.names if name not in shared_group.bilateral_names]
    parts = []
    if struck_names and impacts == SIMULTANEOUS:
        parts.append(
            "all act at the same time, impacting contacts each use their own restitution, resting ones do not rebound"
        )
    elif struck_names:
        number = f"{shared_group.impacts} impacts" if shared_group.impacts != 1 else "one impact"
        parts.append(
            f"they impact one after another, as across equal small gaps, each with its own restitution ({number})"
        )
    if shared_group.resting_names:
        parts.append(
            f"{join_names(shared_group.resting_names)} "
            f"{choose_verb_form(shared_group.resting_names, 'comes', 'come')} to rest after infinitely many impacts"
        )
    if shared_group.bilateral_names:
        parts.append(
            f"{join_names(shared_group.bilateral_names)} "
            f"{choose_verb_form(shared_group.bilateral_names, 'acts', 'act')} in both directions, without rebound"
        )
    return lead + "; ".join(parts)


def format_sharing_warning(
    impulses: Sequence[tuple[float, Sequence[SharedImpulse]]], impacts: ImpactModel
) -> list[str]:
    """Warn where contacts share impulses, because their values depend on a model."""
    shared_events = [(time, groups[0]) for time, groups in impulses if groups]
    if not shared_events:
        return []
    time, first_group = shared_events[0]
    lead = (
        f"in the impact at t = {time:.6g} s,"
        if len(shared_events) == 1
        else f"in {len(shared_events)} impacts, the first at t = {time:.6g} s,"
    )
    assumed = f"rigid bodies do not determine the split, impacts: {impacts} is assumed (heun explain impacts)"
    return [f"{lead} {join_names(first_group.names)} share the impulse: {assumed}"]
