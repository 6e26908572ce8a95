"""Draw ropes over sheaves at an instant, and marks: stops, latches, the ground under wheels and rope ends."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from heuncli.output.drawing.figure import PlaceLabel, Strokes, Symbol
from heuncli.output.drawing.style import ARM_WIDTH, OUTLINE_WIDTH
from heuncli.output.figures.machine_items import LOAD_PEN, PosedMachine, to_pair
from heuncli.output.machine_geometry.ropes import iter_rope_lines
from heuncli.results.results import Array

MIN_SEEN = 0.2  # visible share of a mark's direction; with less it is not drawn


def draw_ropes(posed_machine: PosedMachine, k: int, *, thin: bool = False) -> Iterator[Strokes]:
    """Draw all ropes at an instant; thin: for a later instant."""
    for rope in posed_machine.machine.ropes:
        for line in iter_rope_lines(rope, posed_machine.poses, k):
            flat = posed_machine.size * posed_machine.view.project(line)
            yield Strokes(
                np.stack([flat[:-1], flat[1:]], axis=1),
                LOAD_PEN,
                OUTLINE_WIDTH if thin else ARM_WIDTH,
                is_ghost=thin,
            )


def draw_marks(posed_machine: PosedMachine, k: int) -> Iterator[Symbol]:
    """Draw the marks whose direction is visible."""
    for mark in posed_machine.machine.marks:
        places, directions = mark.locate(posed_machine.poses)
        seen_direction = posed_machine.view.project(directions[k])
        if float(np.hypot(*seen_direction)) > MIN_SEEN * float(np.linalg.norm(directions[k])):
            place = posed_machine.size * posed_machine.view.project(places[k])
            yield Symbol(*to_pair(place), mark.symbol, to_pair(seen_direction), None, mark.description)


def iter_mark_places(posed_machine: PosedMachine) -> Iterator[Array]:
    """Yield the places of marks at all instants, (n, 2) each."""
    for mark in posed_machine.machine.marks:
        yield posed_machine.size * posed_machine.view.project(mark.locate(posed_machine.poses)[0])


def make_labels(posed_machine: PosedMachine, k: int) -> Iterator[PlaceLabel]:
    """Yield the labels of stops and latches."""
    for mark in posed_machine.machine.marks if posed_machine.has_names else ():
        if mark.name:
            x, y = to_pair(posed_machine.size * posed_machine.view.project(mark.locate(posed_machine.poses)[0][k]))
            yield PlaceLabel(x, y, mark.name, mark.name)
