"""Write load cases for CalculiX: as for Abaqus, except that it has no load of angular acceleration u.

GRAV takes a - g, CENTRIF w. The effect of u, -m u x x of every piece, is written as forces at the nodes of the mesh,
which must be given (`--mesh`); solid_mesh.py makes their sums exact.
"""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from heuncli.analyses.load_cases.model import LoadCase, LoadCases
from heuncli.analyses.load_cases.solid_mesh import SolidMesh
from heuncli.output.fe_decks.input_deck import (
    MARK,
    centrifugal_line,
    force_lines,
    freedom_lines,
    gravity_line,
    node_lines,
)
from heuncli.output.fe_decks.naming import DeckNames, DeckNodes
from heuncli.output.fe_decks.readme import case_heading, format_vector, readme

TIE_NOTE = (
    "Tie each point to the surface of its bore: *COUPLING with *DISTRIBUTING (spreads the load) or *KINEMATIC (keeps "
    "the bore rigid)."
)
CARD_NOTES = (
    "GRAV acts along its direction, g - a at the body's origin; CENTRIF takes the square of the angular velocity about "
    "an axis through 0, 0, 0 and acts outwards.",
    "Every step uses OP=NEW: no load carries over to the next.",
)
NODAL_NOTE = (
    "CalculiX has no angular acceleration load: it is given as forces at the nodes of the supplied mesh, with uniform "
    "density. Scaled to the body's mass, that mesh has its center of mass at {center} and about it Ixx Iyy Izz "
    "{inertia}: where these differ from the body's, the cases do not balance."
)
MESH_TOLERANCE = 1e-2  # of mass times radius of gyration, or its square: the error due to the facets of a mesh
MESH_DIFFERS_NOTE = "the cases are out of balance by as much"


def written(cases: LoadCases, names: DeckNames) -> Iterator[str]:
    """Yield the text of the deck, in pieces."""
    nodes, elements = DeckNodes(cases, names), names.elements
    nodal_notes = [] if names.mesh is None or not needs_mesh(cases) else [_format_nodal_note(cases, names.mesh)]
    elements_note = f"{elements} is the set of all elements of the mesh, with their density."
    yield from readme(cases, nodes, MARK, TIE_NOTE, (*CARD_NOTES, *nodal_notes, elements_note))
    yield from node_lines(nodes)
    for k, case in enumerate(cases.cases, start=1):
        yield from case_heading(case, k, MARK)
        yield "*STEP\n*STATIC\n"
        yield from force_lines(nodes.find_loads(case), cases.units)
        if names.mesh is not None:
            yield from _nodal_lines(cases, case, names.mesh)
        yield "*DLOAD, OP=NEW\n"
        yield from gravity_line(elements, case.field.linear)
        yield from centrifugal_line(elements, case)
        yield "*END STEP\n"


def _nodal_lines(cases: LoadCases, case: LoadCase, mesh: SolidMesh) -> Iterator[str]:
    u = case.field.angular_acceleration
    if not u.any():
        return
    yield f"{MARK} angular acceleration, at the nodes of the mesh\n"
    for node, force in zip(mesh.numbers.tolist(), mesh.nodal_forces(cases.body.mass, u), strict=True):
        yield from freedom_lines(node, force, np.zeros(3))


def _format_nodal_note(cases: LoadCases, mesh: SolidMesh) -> str:
    center, inertia = mesh.center_and_inertia(cases.body.mass)
    return NODAL_NOTE.format(center=format_vector(center), inertia=format_vector(np.diag(inertia)))


def needs_mesh(cases: LoadCases) -> bool:
    """Return whether some case has an angular acceleration."""
    return any(case.field.angular_acceleration.any() for case in cases.cases)


def notes(cases: LoadCases, names: DeckNames) -> list[str]:
    """Warn if the mesh is of a different body than the loads."""
    if names.mesh is None or not needs_mesh(cases):
        return []
    body, mesh_inertia = cases.body, names.mesh.pseudo_inertia(cases.body.mass)
    r = float(np.sqrt(np.trace(body.pseudo_inertia[:3, :3]) / body.mass))
    deviation = (
        np.abs(mesh_inertia - body.pseudo_inertia)
        / body.mass
        / np.array([r, r, r, 1.0])
        / np.array([[r], [r], [r], [1.0]])
    )
    return (
        [f"the mesh's mass properties differ from the body's by {deviation.max():.2g}: {MESH_DIFFERS_NOTE}"]
        if deviation.max() > MESH_TOLERANCE
        else []
    )
