"""The parts that decks of Abaqus and CalculiX have in common: nodes, forces at them, inertia loads."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

import numpy as np

from heuncli.analyses.load_cases.model import LoadCase
from heuncli.output.fe_decks.naming import DeckNodes, NodeLoad
from heuncli.output.fe_decks.readme import exact, part_lines
from heuncli.results.results import Array

MARK = "**"


def node_lines(nodes: DeckNodes) -> Iterator[str]:
    """Yield the points as nodes."""
    yield "*NODE, NSET=HEUN_POINTS\n"
    for node in nodes.nodes:
        yield f"{node.number}, {', '.join(map(exact, node.place.tolist()))}\n"


def force_lines(loads: Sequence[NodeLoad], units: Sequence[str]) -> Iterator[str]:
    """Yield the loads at the points: degrees of freedom 1 to 3 are forces, 4 to 6 moments."""
    yield "*CLOAD, OP=NEW\n"
    for load in loads:
        yield from part_lines(load, units, MARK)
        yield from freedom_lines(load.node.number, load.force, load.moment)


def freedom_lines(node: int, force: Array, moment: Array) -> Iterator[str]:
    """Yield a force and a moment at a node, one line for each degree of freedom."""
    for freedom, value in enumerate([*force.tolist(), *moment.tolist()], start=1):
        if value:
            yield f"{node}, {freedom}, {exact(value)}\n"


def gravity_line(elements: str, linear: Array) -> Iterator[str]:
    """Yield the GRAV load, along the direction of g - a."""
    size = float(np.sqrt(linear @ linear))
    if size > 0.0:
        yield f"{elements}, GRAV, {exact(size)}, {_format_direction(-linear / size)}\n"


def centrifugal_line(elements: str, case: LoadCase) -> Iterator[str]:
    """Yield the CENTRIF load: the square of the angular velocity, a point of the axis, and its direction; it acts
    outwards.
    """
    w = case.field.angular_velocity
    square = float(w @ w)
    if square > 0.0:
        yield f"{elements}, CENTRIF, {exact(square)}, 0.0, 0.0, 0.0, {_format_direction(w / np.sqrt(square))}\n"


def rotary_line(elements: str, case: LoadCase) -> Iterator[str]:
    """Yield the ROTA load: the angular acceleration of the body, a point of its axis, and its direction."""
    u = case.field.angular_acceleration
    size = float(np.sqrt(u @ u))
    if size > 0.0:
        yield f"{elements}, ROTA, {exact(size)}, 0.0, 0.0, 0.0, {_format_direction(u / size)}\n"


def _format_direction(unit: Array) -> str:
    return ", ".join(map(exact, unit.tolist()))
