"""Write load cases for ANSYS Mechanical APDL: points, forces, and the acceleration of the body as load steps.

    ACEL    the acceleration of the frame: gravity -g in it is +g here; the mass resists with -m ACEL
    OMEGA   [rad/s], DOMEGA [rad/s2]: of the structure, about the global axes through the global origin
The field of the body is a - g + u x x + w x (w x x), so ACEL is a - g, DOMEGA u, OMEGA w, with their own signs.
"""

from __future__ import annotations

from collections.abc import Iterator

from heuncli.analyses.load_cases.model import LoadCase, LoadCases
from heuncli.output.fe_decks.decks import (
    DeckNames,
    DeckNodes,
    NodeLoad,
    format_case_heading,
    format_exact,
    iter_header,
    iter_part_lines,
)
from heuncli.results.results import Array

MARK = "!"
TIE_NOTE = (
    "Each point is a pilot node: give it a massless MASS21 or a contact pair (TARGE170, CONTA174 with "
    "KEYOPT(2)=2), and tie it to the nodes of its bore by RBE3 (spreads the load) or CERIG (keeps the bore rigid)."
)
CARD_NOTES = (
    "ACEL is the acceleration of the frame, a - g at the body's origin: the mesh reacts with -m ACEL, so gravity "
    "along -z is entered as +z. OMEGA [rad/s] and DOMEGA [rad/s2] are those of the body, about axes through 0, 0, 0; "
    "do not add CGLOC, CGOMGA, DCGOMG or inertia relief (IRLF).",
    "Each case is written as a load step (LSWRITE); LSSOLVE,1,N solves them.",
)
FORCE_LABELS = ("FX", "FY", "FZ", "MX", "MY", "MZ")


def write_ansys(cases: LoadCases, names: DeckNames) -> Iterator[str]:
    """Yield the text of the macro, in pieces."""
    nodes = DeckNodes(cases, names)
    yield from iter_header(cases, nodes, MARK, TIE_NOTE, CARD_NOTES)
    yield "/PREP7\n"
    for node in nodes.nodes:
        yield f"N,{node.number},{','.join(map(format_exact, node.place.tolist()))}\n"
    yield "FINISH\n/SOLU\nANTYPE,STATIC\n"
    for k, case in enumerate(cases.cases, start=1):
        yield from _iter_case_lines(cases, case, nodes, k)


def _iter_case_lines(cases: LoadCases, case: LoadCase, nodes: DeckNodes, number: int) -> Iterator[str]:
    """Yield the load step of a case: its forces in place of the former ones, and the acceleration of the body."""
    yield from format_case_heading(case, number, MARK)
    yield f"TIME,{number}\n"
    for node in nodes.nodes:
        yield f"FDELE,{node.number},ALL\n"
    for load in nodes.find_loads(case):
        yield from iter_part_lines(load, cases.units, MARK)
        yield from _iter_force_lines(load)
    field = case.field
    for command, value in (("ACEL", field.linear), ("OMEGA", field.angular_velocity),
                           ("DOMEGA", field.angular_acceleration)):  # fmt: skip
        yield _format_vector_line(command, value)
    yield f"LSWRITE,{number}\n"


def _iter_force_lines(load: NodeLoad) -> Iterator[str]:
    for label, value in zip(FORCE_LABELS, [*load.force.tolist(), *load.moment.tolist()], strict=True):
        if value:
            yield f"F,{load.node.number},{label},{format_exact(value)}\n"


def _format_vector_line(command: str, value: Array) -> str:
    return f"{command},{','.join(map(format_exact, value.tolist()))}\n"
