"""Read PLY: a header that describes the contents, then corners and faces; as text, or binary in either byte order.

Of the corners x, y, z are read, of the faces the list of corners; other properties are skipped.
"""

from __future__ import annotations

import numpy as np

from heuncli.base.errors import Finding
from heuncli.base.named_tuples import NamedTuple
from heuncli.results.results import Array
from heuncli.scene.meshes.formats import (
    SAVE_AGAIN_HINT,
    mesh_file_finding,
    parse_floats,
    parse_rows,
    require_faces,
    triangulate,
    triangulate_words,
)
from heuncli.scene.meshes.model import IndexArray, TriangleSoup

NUMBER_TYPES = {
    "char": "i1", "int8": "i1", "uchar": "u1", "uint8": "u1", "short": "i2", "int16": "i2", "ushort": "u2",
    "uint16": "u2", "int": "i4", "int32": "i4", "uint": "u4", "uint32": "u4", "float": "f4", "float32": "f4",
    "double": "f8", "float64": "f8",
}  # fmt: skip
BYTE_ORDERS = {"ascii": "", "binary_little_endian": "<", "binary_big_endian": ">"}
CORNER_LIST_NAMES = ("vertex_indices", "vertex_index")
MAX_HEADER_SIZE = 65_536  # bytes


class PlyProperty(NamedTuple):
    """A property: its name and type; for a list the type of its items, and that of its length (otherwise None)."""

    name: str
    kind: str
    length_kind: str | None


class PlyElement(NamedTuple):
    """A number of items of one kind, with their properties."""

    name: str
    item_count: int
    properties: list[PlyProperty]


class PlyHeader(NamedTuple):
    """order: the byte order, "" for text
    elements: what follows
    begin: where the contents begin
    """

    order: str
    elements: list[PlyElement]
    begin: int


def read_ply(content: bytes) -> TriangleSoup:
    """Read the triangles of a PLY file. Raises Finding."""
    header = parse_header(content)
    body = _TextBody(content[header.begin :]) if not header.order else _BinaryBody(content, header)
    corners: Array | None = None
    faces: IndexArray | None = None
    for element in header.elements:
        if element.name == "vertex":
            corners = body.read_corners(element)
        elif element.name == "face":
            faces = body.read_faces(element)
        elif corners is None or faces is None:
            body.skip(element)
        if corners is not None and faces is not None:
            break
    if corners is None or faces is None or not len(faces):
        raise mesh_file_finding(
            "the file has no vertices and faces", "give the surface of a solid: element vertex, element face"
        )
    if (faces < 0).any() or (faces >= len(corners)).any():
        raise mesh_file_finding(
            f"a face uses a vertex outside the {len(corners)} of the file", "vertices are numbered from 0"
        )
    return TriangleSoup(corners, faces)


def parse_header(content: bytes) -> PlyHeader:
    """Parse the header. Raises Finding."""
    end = content.find(b"end_header", 0, MAX_HEADER_SIZE)
    line_end = content.find(b"\n", end, end + 16) if end >= 0 else -1
    if line_end < 0:
        raise mesh_file_finding("the PLY header has no end_header", SAVE_AGAIN_HINT)
    order: str | None = None
    elements: list[PlyElement] = []
    for line in content[:end].decode("ascii", "replace").splitlines()[1:]:
        words = line.split()
        try:
            match words:
                case ["format", form, _]:
                    order = BYTE_ORDERS[form]
                case ["element", name, count]:
                    elements.append(PlyElement(name, int(count), []))
                case ["property", "list", length_kind, kind, name]:
                    elements[-1].properties.append(PlyProperty(name, NUMBER_TYPES[kind], NUMBER_TYPES[length_kind]))
                case ["property", kind, name]:
                    elements[-1].properties.append(PlyProperty(name, NUMBER_TYPES[kind], None))
                case [] | ["comment" | "obj_info", *_]:
                    pass
                case _:
                    raise KeyError
        except (KeyError, ValueError, IndexError):
            raise mesh_file_finding(
                "the PLY header has an invalid line", "lines begin with format, element, property or comment"
            ) from None
    if order is None or any(not 0 <= element.item_count <= len(content) for element in elements):
        raise mesh_file_finding("the PLY header declares more elements than the file has", SAVE_AGAIN_HINT)
    return PlyHeader(order, elements, line_end + 1)


def find_coordinates(element: PlyElement) -> list[int]:
    """Find which properties of the corners are x, y, z. Raises Finding."""
    names = [p.name for p in element.properties]
    if not {"x", "y", "z"} <= set(names) or any(p.length_kind for p in element.properties):
        raise mesh_file_finding(
            "the vertices do not have plain x, y, z coordinates", "give property float x, y, z in element vertex"
        )
    return [names.index(axis) for axis in "xyz"]


def find_corner_list(element: PlyElement) -> int:
    """Find which property of the faces is the list of corners. Raises Finding."""
    found = [i for i, p in enumerate(element.properties) if p.length_kind and p.name in CORNER_LIST_NAMES]
    if len(found) != 1:
        raise mesh_file_finding(
            "the faces do not have one list of vertices", "give property list uchar int vertex_indices in element face"
        )
    return found[0]


def truncated_finding(element: PlyElement) -> Finding:
    """Make the error for a file that ends too early."""
    return mesh_file_finding(
        f"the file is truncated: its header declares {element.item_count} of '{element.name}', it has fewer",
        SAVE_AGAIN_HINT,
    )


class _TextBody:
    """The body of a text file, read from the front. Impure: remembers its position."""

    def __init__(self, body: bytes) -> None:
        self.lines, self.position = [line for line in body.splitlines() if line.strip()], 0

    def take_lines(self, element: PlyElement) -> list[bytes]:
        """Read the lines of an element, one for each item."""
        lines = self.lines[self.position : self.position + element.item_count]
        if len(lines) < element.item_count:
            raise truncated_finding(element)
        self.position += element.item_count
        return lines

    def skip(self, element: PlyElement) -> None:
        """Skip an element."""
        self.take_lines(element)

    def read_corners(self, element: PlyElement) -> Array:
        """Read the coordinates (n, 3)."""
        places, lines = find_coordinates(element), self.take_lines(element)
        rows_at_once = parse_rows(lines, np.float64)
        if rows_at_once is not None and rows_at_once.shape[1] >= len(element.properties):
            return np.ascontiguousarray(rows_at_once[:, places])
        rows = [line.split() for line in lines]
        if any(len(row) < len(element.properties) for row in rows):
            raise truncated_finding(element)
        return np.stack([parse_floats([row[k] for row in rows], "vertex") for k in places], axis=-1)

    def read_faces(self, element: PlyElement) -> IndexArray:
        """Read the triangles (m, 3)."""
        if any(p.length_kind for p in element.properties[: find_corner_list(element)]):
            raise mesh_file_finding("the faces have another list before their vertex list", SAVE_AGAIN_HINT)
        first, lines = find_corner_list(element), self.take_lines(element)
        rows_at_once = parse_rows(lines, np.int64)
        if rows_at_once is not None and first == 0 and (rows_at_once[:, 0] == rows_at_once.shape[1] - 1).all():
            faces = rows_at_once[:, 1:].astype(np.intp)
            require_faces(np.array(faces.shape[1:]))
            return triangulate(faces)
        rows = [line.split() for line in lines]
        try:
            corner_words = [row[first + 1 : first + 1 + int(row[first])] for row in rows]
            if any(len(one) != int(row[first]) for one, row in zip(corner_words, rows, strict=True)):
                raise truncated_finding(element)
        except (ValueError, IndexError):
            raise truncated_finding(element) from None
        return triangulate_words(corner_words) if corner_words else np.empty((0, 3), np.intp)


class _BinaryBody:
    """The body of a binary file, read from the front. Impure: remembers its position."""

    def __init__(self, content: bytes, head: PlyHeader) -> None:
        self.content, self.position, self.order = content, head.begin, head.order

    def view_rows(self, element: PlyElement, list_length: int | None = None) -> np.ndarray:
        """View an element as rows of fixed size; list_length: that of its lists."""
        fields: list[tuple[str, str] | tuple[str, str, int]] = []
        for i, p in enumerate(element.properties):
            if p.length_kind is None:
                fields.append((str(i), self.order + p.kind))
            else:
                fields += [(f"n{i}", self.order + p.length_kind), (str(i), self.order + p.kind, list_length or 0)]
        row = np.dtype(fields)
        if self.position + row.itemsize * element.item_count > len(self.content):
            raise truncated_finding(element)
        return np.frombuffer(self.content, row, element.item_count, self.position)

    def skip(self, element: PlyElement) -> None:
        """Skip an element."""
        if any(p.length_kind for p in element.properties):
            raise mesh_file_finding(f"lists of '{element.name}' precede the faces", SAVE_AGAIN_HINT)
        self.position += self.view_rows(element).nbytes

    def read_corners(self, element: PlyElement) -> Array:
        """Read the coordinates (n, 3)."""
        places, rows = find_coordinates(element), self.view_rows(element)
        self.position += rows.nbytes
        return np.stack([rows[str(k)].astype(np.float64) for k in places], axis=-1)

    def read_faces(self, element: PlyElement) -> IndexArray:
        """Read the triangles (m, 3): at once if all faces have three corners, else face by face."""
        k = find_corner_list(element)
        if sum(p.length_kind is not None for p in element.properties) > 1:
            raise mesh_file_finding("the faces have lists other than their vertex list", SAVE_AGAIN_HINT)
        try:
            rows = self.view_rows(element, 3)
        except Finding:
            return self._read_faces_one_by_one(element, k)
        if (rows[f"n{k}"] != 3).any():
            return self._read_faces_one_by_one(element, k)
        return np.asarray(rows[str(k)].astype(np.intp).reshape(-1, 3))

    def _read_faces_one_by_one(self, element: PlyElement, k: int) -> IndexArray:
        """Read faces of which some have more than three corners."""
        sizes = [np.dtype(p.kind).itemsize for p in element.properties]
        size_before, size_after = sum(sizes[:k]), sum(sizes[k + 1 :])
        corner_list = element.properties[k]
        length_type, item_type = (
            np.dtype(self.order + str(corner_list.length_kind)),
            np.dtype(self.order + corner_list.kind),
        )
        position, found = self.position, []
        for _ in range(element.item_count):
            position += size_before
            if position + length_type.itemsize > len(self.content):
                raise truncated_finding(element)
            count = int(np.frombuffer(self.content, length_type, 1, position)[0])
            position += length_type.itemsize
            require_faces(np.array([count]))
            if position + count * item_type.itemsize + size_after > len(self.content):
                raise truncated_finding(element)
            face = np.frombuffer(self.content, item_type, count, position).astype(np.intp)
            found.append(triangulate(face[None]))
            position += count * item_type.itemsize + size_after
        return np.concatenate(found) if found else np.empty((0, 3), np.intp)
