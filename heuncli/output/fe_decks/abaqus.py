"""Write load cases for Abaqus: a static step each, with forces at points and the inertia of all elements.

GRAV    a load along its direction: g - a at the body's origin
CENTRIF the square of w [rad2/s2], outwards; ROTA u [rad/s2]: both of the body,
        d'Alembert's forces (Theory Guide 6.1.1)
"""

from __future__ import annotations

from collections.abc import Iterator

from heuncli.analyses.load_cases.model import LoadCases
from heuncli.output.fe_decks.input_deck import (
    MARK,
    centrifugal_line,
    force_lines,
    gravity_line,
    node_lines,
    rotary_line,
)
from heuncli.output.fe_decks.naming import DeckNames, DeckNodes, step_name
from heuncli.output.fe_decks.readme import case_heading, readme

TIE_NOTE = (
    "Tie each point to the surface of its bore: *COUPLING with *DISTRIBUTING (spreads the load) or *KINEMATIC (keeps "
    "the bore rigid); for beams *MPC with BEAM."
)
CARD_NOTES = (
    "GRAV acts along its direction, g - a at the body's origin. CENTRIF takes the square of the angular velocity, ROTA "
    "the angular acceleration of the body about axes through 0, 0, 0: both apply the d'Alembert forces.",
    "Every step is linear (NLGEOM=NO) with OP=NEW: no load carries over to the next.",
)


def written(cases: LoadCases, names: DeckNames) -> Iterator[str]:
    """Yield the text of the deck, in pieces."""
    nodes, elements = DeckNodes(cases, names), names.elements
    elements_note = f"{elements} is the set of all elements of the mesh, with their density."
    yield from readme(cases, nodes, MARK, TIE_NOTE, (*CARD_NOTES, elements_note))
    yield from node_lines(nodes)
    for k, case in enumerate(cases.cases, start=1):
        yield from case_heading(case, k, MARK)
        yield f"*STEP, NAME={step_name(k, case)}, NLGEOM=NO\n*STATIC\n"
        yield from force_lines(nodes.find_loads(case), cases.units)
        yield "*DLOAD, OP=NEW\n"
        yield from gravity_line(elements, case.field.linear)
        yield from centrifugal_line(elements, case)
        yield from rotary_line(elements, case)
        yield "*END STEP\n"
