"""Ropes over sheaves as they run at an instant, and marks: stops, latches, the ground under wheels and ropes' ends."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from heuncli.output.drawing.figure import PlaceLabel, Strokes, Symbol
from heuncli.output.figures.machine_items import APPLIED, ARM, THIN, Stood, on_paper
from heuncli.output.machine_geometry.ropes import lines_of
from heuncli.results.results import Array

SEEN = 0.2  # of a mark's direction that is seen: what shows less of it has no side in the picture


def ropes(stood: Stood, k: int, *, thin: bool = False) -> Iterator[Strokes]:
    """All ropes at an instant; thin: one that is not the first."""
    for rope in stood.machine.ropes:
        for line in lines_of(rope, stood.poses, k):
            flat = stood.size * stood.view.flat(line)
            yield Strokes(np.stack([flat[:-1], flat[1:]], axis=1), APPLIED, THIN if thin else ARM)


def marks(stood: Stood, k: int) -> Iterator[Symbol]:
    """The marks whose sides are seen."""
    for mark in stood.machine.marks:
        places, ways = mark.stands(stood.poses)
        along = stood.view.flat(ways[k])
        if float(np.hypot(*along)) > SEEN * float(np.linalg.norm(ways[k])):
            place = stood.size * stood.view.flat(places[k])
            yield Symbol(*on_paper(place), mark.symbol, on_paper(along), None, mark.told)


def reach(stood: Stood) -> Iterator[Array]:
    """Where marks stand at all instants, (n, 2) each."""
    for mark in stood.machine.marks:
        yield stood.size * stood.view.flat(mark.stands(stood.poses)[0])


def names(stood: Stood, k: int) -> Iterator[PlaceLabel]:
    """The names of stops and latches."""
    for mark in stood.machine.marks if stood.are_named else ():
        if mark.name:
            x, y = on_paper(stood.size * stood.view.flat(mark.stands(stood.poses)[0][k]))
            yield PlaceLabel(x, y, mark.name, mark.name)
