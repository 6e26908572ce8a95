"""What the decks of Abaqus and CalculiX have in common: nodes, forces at them, a step a case."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

import numpy as np

from heuncli.analyses.load_cases.model import LoadCase
from heuncli.output.fe_decks.naming import DeckNodes, NodeLoad
from heuncli.output.fe_decks.readme import exact, parts_of
from heuncli.results.results import Array

MARK = "**"


def node_lines(nodes: DeckNodes) -> Iterator[str]:
    """The points as nodes."""
    yield "*NODE, NSET=HEUN_POINTS\n"
    for node in nodes.nodes:
        yield f"{node.number}, {', '.join(map(exact, node.at.tolist()))}\n"


def force_lines(loads: Sequence[NodeLoad], units: Sequence[str]) -> Iterator[str]:
    """What acts at the points: freedoms 1 to 3 are forces, 4 to 6 moments."""
    yield "*CLOAD, OP=NEW\n"
    for load in loads:
        yield from parts_of(load, units, MARK)
        yield from freedom_lines(load.node.number, load.force, load.moment)


def freedom_lines(node: int, force: Array, moment: Array) -> Iterator[str]:
    """A force and a moment at a node, a line a freedom."""
    for freedom, value in enumerate([*force.tolist(), *moment.tolist()], start=1):
        if value:
            yield f"{node}, {freedom}, {exact(value)}\n"


def gravity_line(elements: str, linear: Array) -> Iterator[str]:
    """GRAV is a load along its direction: that of g - a."""
    size = float(np.sqrt(linear @ linear))
    if size > 0.0:
        yield f"{elements}, GRAV, {exact(size)}, {_direction(-linear / size)}\n"


def centrifugal_line(elements: str, case: LoadCase) -> Iterator[str]:
    """CENTRIF has the square of the angular velocity, a point of the axis, and its direction; it acts outwards."""
    w = case.field.angular_velocity
    square = float(w @ w)
    if square > 0.0:
        yield f"{elements}, CENTRIF, {exact(square)}, 0.0, 0.0, 0.0, {_direction(w / np.sqrt(square))}\n"


def rotary_line(elements: str, case: LoadCase) -> Iterator[str]:
    """ROTA is the angular acceleration of the body, about a point of its axis and a direction."""
    u = case.field.angular_acceleration
    size = float(np.sqrt(u @ u))
    if size > 0.0:
        yield f"{elements}, ROTA, {exact(size)}, 0.0, 0.0, 0.0, {_direction(u / size)}\n"


def _direction(unit: Array) -> str:
    return ", ".join(map(exact, unit.tolist()))
