"""Load cases for CalculiX: as for Abaqus, but that it has no load of angular acceleration.

The field is divided at the centre of mass s: a - g + u x x = (a - g + u x s) + u x (x - s). The first part is GRAV. The
second has no resultant, only the couple -I u about s. As a couple at a node there, spread over all nodes of the mesh by
weights that are their masses, it is the same field again: a distributing coupling makes of a couple the forces
m_i c x (x_i - s) whose moment it is, so that c = -u.
"""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from heuncli.decks.input_deck import MARK, centrifugal_line, force_lines, freedom_lines, gravity_line, node_lines
from heuncli.decks.naming import DeckNames, DeckNodes
from heuncli.decks.readme import heading_of, readme
from heuncli.load_cases.model import LoadCase, LoadCases
from heuncli.results import Array
from heuncli.shapes.rotations import cross

TIE = (
    "Tie each point to the surface of its bore: *COUPLING with *DISTRIBUTING (spreads the load) or *KINEMATIC (keeps "
    "the bore rigid)."
)
CARDS = (
    "GRAV is a load along its direction; CENTRIF has the square of the angular velocity, about an axis through "
    "0, 0, 0, and acts outwards.",
    "Every step with OP=NEW: no load of one is left in the next.",
)
COUPLE = (
    "CalculiX has no load of angular acceleration u. GRAV takes what it does at the center of mass, and the rest, the "
    "couple -I u, stands at the node {node} there. Tie that one to ALL nodes of the mesh by *DISTRIBUTING COUPLING "
    "with their masses as weights (equal ones on an even mesh): then it acts as the field that it is. Tied to a few "
    "nodes alone it balances, but the stresses between are wrong."
)


def written(cases: LoadCases, names: DeckNames) -> Iterator[str]:
    """The deck in pieces."""
    nodes = DeckNodes(cases, names, with_center=_has_couple(cases))
    elements = names.elements
    couple = [] if nodes.center is None else [COUPLE.format(node=nodes.center.number)]
    all_of_it = f"{elements} is the set of all elements of the mesh, with their density."
    yield from readme(cases, nodes, MARK, TIE, (*CARDS, *couple, all_of_it))
    yield from node_lines(nodes)
    for k, case in enumerate(cases.cases, start=1):
        yield from heading_of(case, k, MARK)
        yield "*STEP\n*STATIC\n"
        yield from force_lines(nodes.loads(case), cases.units)
        if nodes.center is not None:
            yield from freedom_lines(nodes.center.number, np.zeros(3), couple_of(cases, case))
        yield "*DLOAD, OP=NEW\n"
        yield from gravity_line(elements, center_field(cases, case))
        yield from centrifugal_line(elements, case)
        yield "*END STEP\n"


def center_field(cases: LoadCases, case: LoadCase) -> Array:
    """a - g + u x s, what GRAV takes; where the couple is none, a - g."""
    if not _has_couple(cases):
        return case.field.linear
    return np.asarray(case.field.linear + cross(case.field.angular_acceleration, cases.body.center))


def couple_of(cases: LoadCases, case: LoadCase) -> Array:
    """-I u about the centre of mass."""
    return np.asarray(-cases.body.inertia @ case.field.angular_acceleration)


def _has_couple(cases: LoadCases) -> bool:
    return any(case.field.angular_acceleration.any() for case in cases.cases)


def notes(cases: LoadCases) -> list[str]:
    """Where the user has to tie a couple to the whole mesh."""
    if not _has_couple(cases):
        return []
    return [
        "CalculiX has no load of angular acceleration: its couple stands at a node of its own, to be tied to all nodes"
    ]
