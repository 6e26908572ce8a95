"""Choose the labels of a machine: one for a place, and numbers in circles in place of words if there are many."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from itertools import count, product

import numpy as np

from heuncli.output.drawing.figure import PlaceLabel

MAX_LABELS = 20  # with more of them, numbers stand for the words
SEPARATOR = " / "  # between the names of one place
SAME_PLACE = 0.004  # of the figure's side: closer places are one


def choose_labels(
    loads: Sequence[PlaceLabel], names: Sequence[PlaceLabel], side: float
) -> tuple[list[PlaceLabel], tuple[tuple[str, str], ...]]:
    """Return the labels, and what the numbers stand for if there are any.

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
