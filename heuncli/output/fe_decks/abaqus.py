"""Write load cases for Abaqus and CalculiX: a static step each, with forces at points and the inertia of all elements.

    GRAV    a load along its direction: g - a at the body's origin
    CENTRIF the square of w [rad2/s2], outwards; ROTA u [rad/s2]: both of the body,
            d'Alembert's forces (Theory Guide 6.1.1)

CalculiX has no load of angular acceleration u. Its effect, -m u x x of every piece, is written as forces at the nodes
of the mesh, which must be given (`--mesh`); solid_mesh.py makes their sums exact.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence

import numpy as np

from heuncli.analyses.load_cases.model import LoadCase, LoadCases
from heuncli.analyses.load_cases.solid_mesh import SolidMesh
from heuncli.output.fe_decks.decks import (
    DeckNames,
    DeckNodes,
    NodeLoad,
    format_case_heading,
    format_exact,
    format_vector,
    iter_header,
    iter_part_lines,
    make_step_name,
)
from heuncli.results.results import Array

ABAQUS_TIE_NOTE = (
    "Tie each point to the surface of its bore: *COUPLING with *DISTRIBUTING (spreads the load) or *KINEMATIC (keeps "
    "the bore rigid); for beams *MPC with BEAM."
)
ABAQUS_CARD_NOTES = (
    "GRAV acts along its direction, g - a at the body's origin. CENTRIF takes the square of the angular velocity, ROTA "
    "the angular acceleration of the body about axes through 0, 0, 0: both apply the d'Alembert forces.",
    "Every step is linear (NLGEOM=NO) with OP=NEW: no load carries over to the next.",
)
CALCULIX_TIE_NOTE = (
    "Tie each point to the surface of its bore: *COUPLING with *DISTRIBUTING (spreads the load) or *KINEMATIC (keeps "
    "the bore rigid)."
)
CALCULIX_CARD_NOTES = (
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
MARK = "**"


def write_abaqus(cases: LoadCases, names: DeckNames) -> Iterator[str]:
    """Yield the text of the deck, in pieces."""
    nodes, elements = DeckNodes(cases, names), names.elements
    elements_note = f"{elements} is the set of all elements of the mesh, with their density."
    yield from iter_header(cases, nodes, MARK, ABAQUS_TIE_NOTE, (*ABAQUS_CARD_NOTES, elements_note))
    yield from _iter_node_lines(nodes)
    for k, case in enumerate(cases.cases, start=1):
        yield from format_case_heading(case, k, MARK)
        yield f"*STEP, NAME={make_step_name(k, case)}, NLGEOM=NO\n*STATIC\n"
        yield from _iter_force_lines(nodes.find_loads(case), cases.units)
        yield "*DLOAD, OP=NEW\n"
        yield from _iter_gravity_line(elements, case.field.linear)
        yield from _iter_centrifugal_line(elements, case)
        yield from _iter_rotary_line(elements, case)
        yield "*END STEP\n"


def write_calculix(cases: LoadCases, names: DeckNames) -> Iterator[str]:
    """Yield the text of the deck, in pieces."""
    nodes, elements = DeckNodes(cases, names), names.elements
    nodal_notes = (
        [] if names.mesh is None or not _has_angular_acceleration(cases) else [_format_nodal_note(cases, names.mesh)]
    )
    elements_note = f"{elements} is the set of all elements of the mesh, with their density."
    yield from iter_header(cases, nodes, MARK, CALCULIX_TIE_NOTE, (*CALCULIX_CARD_NOTES, *nodal_notes, elements_note))
    yield from _iter_node_lines(nodes)
    for k, case in enumerate(cases.cases, start=1):
        yield from format_case_heading(case, k, MARK)
        yield "*STEP\n*STATIC\n"
        yield from _iter_force_lines(nodes.find_loads(case), cases.units)
        if names.mesh is not None:
            yield from _iter_nodal_lines(cases, case, names.mesh)
        yield "*DLOAD, OP=NEW\n"
        yield from _iter_gravity_line(elements, case.field.linear)
        yield from _iter_centrifugal_line(elements, case)
        yield "*END STEP\n"


def _iter_nodal_lines(cases: LoadCases, case: LoadCase, mesh: SolidMesh) -> Iterator[str]:
    """Yield the forces of the angular acceleration at the nodes of the mesh."""
    u = case.field.angular_acceleration
    if not u.any():
        return
    yield f"{MARK} angular acceleration, at the nodes of the mesh\n"
    for node, force in zip(mesh.numbers.tolist(), mesh.nodal_forces(cases.body.mass, u), strict=True):
        yield from _iter_freedom_lines(node, force, np.zeros(3))


def _format_nodal_note(cases: LoadCases, mesh: SolidMesh) -> str:
    center, inertia = mesh.center_and_inertia(cases.body.mass)
    return NODAL_NOTE.format(center=format_vector(center), inertia=format_vector(np.diag(inertia)))


def _has_angular_acceleration(cases: LoadCases) -> bool:
    """Return whether some case has an angular acceleration."""
    return any(case.field.angular_acceleration.any() for case in cases.cases)


def list_calculix_notes(cases: LoadCases, names: DeckNames) -> list[str]:
    """Return a warning if the mesh is of a different body than the loads: its mass properties differ by more than 1 %.

    They are compared as pseudo-inertias (4, 4), in parts of the body's mass and radius of gyration r.
    """
    if names.mesh is None or not _has_angular_acceleration(cases) or cases.body.mass == 0.0:
        return []
    body, mesh_inertia = cases.body, names.mesh.pseudo_inertia(cases.body.mass)
    r = float(np.sqrt(np.trace(body.pseudo_inertia[:3, :3]) / body.mass))
    lengths = np.array([r, r, r, 1.0])
    deviation = (np.abs(mesh_inertia - body.pseudo_inertia) / body.mass / lengths / lengths[:, None]).max()
    if deviation <= MESH_TOLERANCE:
        return []
    return [f"the mesh's mass properties differ from the body's by {deviation:.2g}: {MESH_DIFFERS_NOTE}"]


def _iter_node_lines(nodes: DeckNodes) -> Iterator[str]:
    """Yield the points as nodes."""
    yield "*NODE, NSET=HEUN_POINTS\n"
    for node in nodes.nodes:
        yield f"{node.number}, {', '.join(map(format_exact, node.place.tolist()))}\n"


def _iter_force_lines(loads: Sequence[NodeLoad], units: Sequence[str]) -> Iterator[str]:
    """Yield the loads at the points: degrees of freedom 1 to 3 are forces, 4 to 6 moments."""
    yield "*CLOAD, OP=NEW\n"
    for load in loads:
        yield from iter_part_lines(load, units, MARK)
        yield from _iter_freedom_lines(load.node.number, load.force, load.moment)


def _iter_freedom_lines(node: int, force: Array, moment: Array) -> Iterator[str]:
    """Yield a force and a moment at a node, one line for each degree of freedom."""
    for freedom, value in enumerate([*force.tolist(), *moment.tolist()], start=1):
        if value:
            yield f"{node}, {freedom}, {format_exact(value)}\n"


def _iter_gravity_line(elements: str, linear: Array) -> Iterator[str]:
    """Yield the GRAV load, along the direction of g - a."""
    size = float(np.sqrt(linear @ linear))
    if size > 0.0:
        yield f"{elements}, GRAV, {format_exact(size)}, {_format_direction(-linear / size)}\n"


def _iter_centrifugal_line(elements: str, case: LoadCase) -> Iterator[str]:
    """Yield the CENTRIF load, outwards: the square of the angular velocity, a point of the axis, and its direction."""
    w = case.field.angular_velocity
    square = float(w @ w)
    if square > 0.0:
        yield f"{elements}, CENTRIF, {format_exact(square)}, 0.0, 0.0, 0.0, {_format_direction(w / np.sqrt(square))}\n"


def _iter_rotary_line(elements: str, case: LoadCase) -> Iterator[str]:
    """Yield the ROTA load: the angular acceleration of the body, a point of its axis, and its direction."""
    u = case.field.angular_acceleration
    size = float(np.sqrt(u @ u))
    if size > 0.0:
        yield f"{elements}, ROTA, {format_exact(size)}, 0.0, 0.0, 0.0, {_format_direction(u / size)}\n"


def _format_direction(unit: Array) -> str:
    return ", ".join(map(format_exact, unit.tolist()))
