"""Load cases for CalculiX: as for Abaqus, but that it has no load of angular acceleration u.

GRAV takes a - g, CENTRIF w. What u does, -m u x x of every piece, stands as forces at the nodes of the mesh, which has
to be given (`--mesh`): solid_mesh.py has their sums exactly.
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
from heuncli.output.fe_decks.readme import heading_of, readme, vector

TIE = (
    "Tie each point to the surface of its bore: *COUPLING with *DISTRIBUTING (spreads the load) or *KINEMATIC (keeps "
    "the bore rigid)."
)
CARDS = (
    "GRAV is a load along its direction, g - a at the body's origin; CENTRIF has the square of the angular velocity, "
    "about an axis through 0, 0, 0, and acts outwards.",
    "Every step with OP=NEW: no load of one is left in the next.",
)
NODAL = (
    "CalculiX has no load of angular acceleration: what it does stands as forces at the nodes of the mesh that was "
    "given, of even density. Of the body's mass, that mesh has its center of mass at {center} and about it Ixx Iyy Izz "
    "{inertia}: where these are not the body's, the cases do not balance."
)
ALIKE = 1e-2  # of mass times radius of gyration, or its square: what the facets of a mesh cut off
UNLIKE = "the cases do not balance on it by as much"


def written(cases: LoadCases, names: DeckNames) -> Iterator[str]:
    """The deck in pieces."""
    nodes, elements = DeckNodes(cases, names), names.elements
    nodal = [] if names.mesh is None or not needs_mesh(cases) else [_of_mesh(cases, names.mesh)]
    all_of_it = f"{elements} is the set of all elements of the mesh, with their density."
    yield from readme(cases, nodes, MARK, TIE, (*CARDS, *nodal, all_of_it))
    yield from node_lines(nodes)
    for k, case in enumerate(cases.cases, start=1):
        yield from heading_of(case, k, MARK)
        yield "*STEP\n*STATIC\n"
        yield from force_lines(nodes.loads(case), cases.units)
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


def _of_mesh(cases: LoadCases, mesh: SolidMesh) -> str:
    center, inertia = mesh.center_and_inertia(cases.body.mass)
    return NODAL.format(center=vector(center), inertia=vector(np.diag(inertia)))


def needs_mesh(cases: LoadCases) -> bool:
    """Whether some case has an angular acceleration."""
    return any(case.field.angular_acceleration.any() for case in cases.cases)


def notes(cases: LoadCases, names: DeckNames) -> list[str]:
    """Where the mesh is another body than the one whose loads these are."""
    if names.mesh is None or not needs_mesh(cases):
        return []
    body, mesh = cases.body, names.mesh.pseudo_inertia(cases.body.mass)
    r = float(np.sqrt(np.trace(body.pseudo_inertia[:3, :3]) / body.mass))
    off = np.abs(mesh - body.pseudo_inertia) / body.mass / np.array([r, r, r, 1.0]) / np.array([[r], [r], [r], [1.0]])
    return [f"the mesh's masses lie off the body's by {off.max():.2g}: {UNLIKE}"] if off.max() > ALIKE else []
