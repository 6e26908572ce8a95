"""The labels of a machine: names of joints, loads, bodies and stops; one for a place, or numbers if there are many."""

from __future__ import annotations

from collections.abc import Collection, Iterator, Sequence
from itertools import count, product

import numpy as np

from heuncli.base.joint_kinds import TYPES
from heuncli.output.drawing.axes import format_short
from heuncli.output.drawing.figure import PlaceLabel
from heuncli.output.figures.posed_machine import LOAD_PEN, TIME_DIGITS, PosedMachine, to_pair
from heuncli.study.quantities.captions import describe_object
from heuncli.study.quantities.labels import Labels

MAX_LABELS = 20  # with more of them, numbers stand for the words
SEPARATOR = " / "  # between the names of one place
SAME_PLACE = 0.004  # of the figure's side: closer places are one
LATER_PEN = 7  # of the labels of later instants


def choose_labels(
    loads: Sequence[PlaceLabel], names: Sequence[PlaceLabel], side: float
) -> tuple[list[PlaceLabel], tuple[tuple[str, str], ...]]:
    """Return the labels, and a legend (number, text) if numbers stand for the texts.

    loads: names with values, at the tips of arrows
    names: what else has a name; those at one place share a label
    side: the larger side of the figure, in its unit
    """
    merged = _merge_places(names, SAME_PLACE * side)
    labels = [*loads, *merged]
    if len(labels) <= MAX_LABELS:
        return labels, ()
    numbered = [label._replace(number=str(k)) for k, label in enumerate(labels, 1)]
    return numbered, tuple((label.number, label.text) for label in numbered)


def _merge_places(labels: Sequence[PlaceLabel], tolerance: float) -> list[PlaceLabel]:
    """Merge the labels at one place: their words are listed, the pen and the short form are those of the first."""
    merged: list[PlaceLabel] = []
    for label in labels:
        near = (k for k, own in enumerate(merged) if np.hypot(own.x - label.x, own.y - label.y) <= tolerance)
        k = next(near, None)
        if k is None:
            merged.append(label)
        elif label.text not in merged[k].text.split(SEPARATOR):
            merged[k] = merged[k]._replace(text=f"{merged[k].text}{SEPARATOR}{label.text}")
    return merged


def iter_letters(first: str) -> Iterator[str]:
    """Yield names without end from the first letter of the alphabet on, capital or small."""
    alphabet = [chr(ord(first) + k) for k in range(26)]
    for length in count(1):
        yield from ("".join(word) for word in product(alphabet, repeat=length))


def make_machine_labels(
    posed_machine: PosedMachine, k: int, labels: Labels, labelled: Collection[str]
) -> Iterator[PlaceLabel]:
    """Yield the labels of joints, springs and actuators, and bodies; short forms are numbers, small letters and
    capitals.

    labelled: the words of loads that have a label
    """
    if not posed_machine.has_names:
        return
    for number, joint in enumerate(posed_machine.machine.joints, 1):
        ends = posed_machine.project(joint.b, joint.q, k), posed_machine.project(joint.a, joint.p, k)
        place = 0.5 * (ends[0] + ends[1]) if TYPES[joint.kind].keeps_distance else ends[0]
        text = describe_object("joints", joint.name, labels)
        if text not in labelled:
            yield PlaceLabel(*to_pair(place), text, str(number))
    for letter, line in zip(iter_letters("a"), posed_machine.machine.lines, strict=False):
        ends = posed_machine.project(line.a, line.p, k), posed_machine.project(line.b, line.q, k)
        text = describe_object("forces", line.name, labels)
        if text not in labelled and line.name not in posed_machine.guided_actuators:
            yield PlaceLabel(*to_pair(0.5 * (ends[0] + ends[1])), text, letter, LOAD_PEN)
    for letter, body in zip(iter_letters("A"), posed_machine.machine.bodies, strict=False):
        place = posed_machine.project(body.name, posed_machine.centers[body.name], k)
        text = describe_object("bodies", body.name, labels)
        yield PlaceLabel(*to_pair(place), text, letter, posed_machine.pens[body.name])


def make_mark_labels(posed_machine: PosedMachine, k: int) -> Iterator[PlaceLabel]:
    """Yield the labels of stops and latches."""
    for mark in posed_machine.machine.marks if posed_machine.has_names else ():
        if mark.name:
            x, y = to_pair(posed_machine.per_si * posed_machine.view.project(mark.locate(posed_machine.poses)[0][k]))
            yield PlaceLabel(x, y, mark.name, mark.name)


def label_instants(posed_machine: PosedMachine) -> Iterator[PlaceLabel]:
    """Label the instants at the body that has moved most since the first."""
    if len(posed_machine.poses.times) < 2:
        return
    places_of_body = {
        body.name: np.array(
            [
                posed_machine.project(body.name, posed_machine.centers[body.name], k)
                for k in range(len(posed_machine.poses.times))
            ]
        )
        for body in posed_machine.machine.bodies
    }
    most_moved = max(
        places_of_body, key=lambda name: (float(np.abs(places_of_body[name] - places_of_body[name][0]).max()), name)
    )
    times = posed_machine.poses.times.tolist()
    for k, (t, (x, y)) in enumerate(zip(times, places_of_body[most_moved].tolist(), strict=True)):
        text = f"{format_short(t, TIME_DIGITS)} s"
        yield PlaceLabel(x, y, text, text, LATER_PEN, is_ghost=k > 0)
