"""Read a mesh of solids in Abaqus or CalculiX format, and compute the loads of a uniform mass in it.

For a tetrahedron with corners x_i, mass m, in a field a(x) linear in x, the forces
    F_i = -int rho N_i a dV = -m/20 (a_i + sum_j a_j)
at its corners have exactly the force and the moment of the field; other solids are divided into tetrahedra. So the
nodal forces of a whole mesh balance as the body does, if the mesh has the same mass distribution.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence

import numpy as np
from numpy.typing import NDArray

from heuncli.base.errors import Finding
from heuncli.base.named_tuples import NamedTuple
from heuncli.base.records import record
from heuncli.results.results import Array
from heuncli.scene.shapes.inertia import assemble_pseudo_inertia, split_pseudo_inertia
from heuncli.scene.shapes.rotations import cross_rows

TETRAHEDRON = ((0, 1, 2, 3),)
WEDGE = ((0, 1, 2, 3), (1, 4, 2, 3), (2, 4, 5, 3))
HEXAHEDRON = tuple((0, 6, *edge) for edge in ((1, 2), (2, 3), (3, 7), (7, 4), (4, 5), (5, 1)))


class SolidKind(NamedTuple):
    """A kind of element: its number of nodes, the corners first, and the tetrahedra of corners that it is divided
    into.
    """

    nodes: int
    parts: tuple[tuple[int, ...], ...]


KINDS = {
    "C3D4": SolidKind(4, TETRAHEDRON), "C3D10": SolidKind(10, TETRAHEDRON), "C3D6": SolidKind(6, WEDGE),
    "C3D15": SolidKind(15, WEDGE), "C3D8": SolidKind(8, HEXAHEDRON), "C3D20": SolidKind(20, HEXAHEDRON),
}  # fmt: skip
INTEGRATION_SUFFIXES = "RIHMT"  # suffixes of an element type: its integration
SOLIDS_HINT = "only solid elements are accepted: C3D4, C3D10, C3D6, C3D15, C3D8, C3D20"


@record
class SolidMesh:
    """Nodes, their numbers (n,) and positions (n, 3), and tetrahedra (k, 4) by the rows of their corners."""

    numbers: NDArray[np.intp]
    places: Array
    tetrahedra: NDArray[np.intp]

    def compute_volumes(self) -> Array:
        """Return the volumes of the tetrahedra, (k,)."""
        a, b, c, d = (self.places[self.tetrahedra[:, i]] for i in range(4))
        return np.asarray(np.abs(np.sum((b - a) * cross_rows(c - a, d - a), axis=1)) / 6.0)

    def nodal_forces(self, mass: float, u: Array) -> Array:
        """Return the nodal forces (n, 3) of a uniform mass under the angular acceleration u about the origin."""
        V = self.compute_volumes()
        a = np.cross(u, self.places)[self.tetrahedra]
        parts = -(mass / V.sum() * V / 20.0)[:, None, None] * (a + a.sum(axis=1, keepdims=True))
        forces = np.zeros_like(self.places)
        for i in range(4):
            np.add.at(forces, self.tetrahedra[:, i], parts[:, i])
        return forces

    def pseudo_inertia(self, mass: float) -> Array:
        """Return P about the origin of a uniform mass, (4, 4)."""
        V = self.compute_volumes()
        m = mass / V.sum() * V
        x = self.places[self.tetrahedra]
        S = x.sum(axis=1)
        second = np.einsum("k,kia,kib->ab", m, x, x) + np.einsum("k,ka,kb->ab", m, S, S)
        return assemble_pseudo_inertia(np.array(mass), m @ S / 4.0, second / 20.0)

    def center_and_inertia(self, mass: float) -> tuple[Array, Array]:
        """Return centre of mass (3,) and inertia about it (3, 3) of a uniform mass."""
        return split_pseudo_inertia(self.pseudo_inertia(mass))[1:]


def read_mesh(text: str, name: str) -> SolidMesh:
    """Read the mesh from a deck's text; name: of the file. Raises Finding [bad-mesh]."""
    nodes: dict[int, tuple[float, ...]] = {}
    corners: list[tuple[int, ...]] = []
    for keyword, kind, number, words in _iter_records(text, name):
        where = f"{name}:{number}"
        if not words:
            raise Finding("bad-mesh", f"{where}: a node without a number", "give its number, then its coordinates")
        try:
            if keyword == "*NODE":
                x = [float(word) for word in words[1:4]]
                nodes[int(words[0])] = (*x, *[0.0] * (3 - len(x)))
                continue
            node_numbers = [int(word) for word in words]
        except ValueError:
            raise Finding("bad-mesh", f"{where}: '{', '.join(words)[:60]}' are not numbers", SOLIDS_HINT) from None
        assert kind is not None
        if len(node_numbers) != kind.nodes + 1:
            message = f"{where}: an element with {kind.nodes} nodes lists {len(node_numbers) - 1}"
            raise Finding(
                "bad-mesh", message, "give its number, then its nodes; a line that ends with a comma continues"
            )
        corners += [tuple(node_numbers[1 + i] for i in part) for part in kind.parts]
    return _make_mesh(nodes, corners, name)


def _iter_records(text: str, name: str) -> Iterator[tuple[str, SolidKind | None, int, list[str]]]:
    """Yield the data of *NODE and *ELEMENT, with elements joined across lines: keyword, kind, line, words."""
    keyword, kind, first_line, collected = "", None, 0, list[str]()
    for number, line in enumerate(text.splitlines(), start=1):
        if line.startswith("**") or not line.strip():
            continue
        if line.startswith("*"):
            if collected:  # its last line ends with a comma
                yield keyword, kind, first_line, collected
            words = [word.strip().upper() for word in line.split(",")]
            keyword, kind, collected = words[0], None, []
            if keyword == "*INCLUDE":
                raise Finding("bad-mesh", f"{name}:{number}: *INCLUDE is not followed", "give the included file")
            if keyword in ("*NODE", "*ELEMENT") and any(word.partition("=")[0].strip() == "INPUT" for word in words):
                message = f"{name}:{number}: {keyword} with INPUT is not followed"
                raise Finding("bad-mesh", message, "give the mesh in one file")
            if keyword == "*ELEMENT":
                kind = _parse_kind(words, f"{name}:{number}")
            continue
        if keyword not in ("*NODE", "*ELEMENT"):
            continue
        first_line = first_line if collected else number
        collected += [word.strip() for word in line.split(",") if word.strip()]
        if keyword == "*NODE" or not line.rstrip().endswith(","):
            yield keyword, kind, first_line, collected
            collected = []
    if collected:
        yield keyword, kind, first_line, collected


def _parse_kind(words: Sequence[str], where: str) -> SolidKind:
    """Return the kind of the elements below a line. Raises Finding [bad-mesh]."""
    type_name = next((word.partition("=")[2].strip() for word in words if word.partition("=")[0].strip() == "TYPE"), "")
    kind = KINDS.get(type_name.rstrip(INTEGRATION_SUFFIXES) if type_name not in KINDS else type_name)
    if kind is None:
        raise Finding("bad-mesh", f"{where}: elements of type {type_name or 'none'} have no known mass", SOLIDS_HINT)
    return kind


def _make_mesh(nodes: dict[int, tuple[float, ...]], corners: Sequence[tuple[int, ...]], name: str) -> SolidMesh:
    """Make the mesh of the nodes that its elements use. Raises Finding."""
    if not corners:
        raise Finding(
            "bad-mesh", f"{name}: there are no elements", "give *NODE and *ELEMENT, as in the mesh of the deck"
        )
    used = sorted({number for one in corners for number in one})
    missing = next((number for number in used if number not in nodes), None)
    if missing is not None:
        raise Finding("bad-mesh", f"{name}: node {missing} of an element is missing", "give it under *NODE")
    row = {number: i for i, number in enumerate(used)}
    tetrahedra = np.array([[row[number] for number in one] for one in corners], dtype=np.intp)
    mesh = SolidMesh(np.array(used, dtype=np.intp), np.array([nodes[number] for number in used]), tetrahedra)
    if not (np.isfinite(mesh.places).all() and mesh.compute_volumes().sum() > 0.0):
        raise Finding("bad-mesh", f"{name}: the elements have no volume", "check the node numbers")
    return mesh
