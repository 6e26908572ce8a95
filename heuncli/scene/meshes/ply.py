"""PLY: a head that says what follows, then corners and faces; as text, or binary in either order of bytes.

Of the corners x, y, z are read, of the faces the list of corners; what stands beside them is passed over.
"""

from __future__ import annotations

import numpy as np

from heuncli.base.errors import Finding
from heuncli.base.named_tuples import NamedTuple
from heuncli.results.results import Array
from heuncli.scene.meshes.model import Numbers, Soup
from heuncli.scene.meshes.numbers import SAVE_AGAIN, floats, refused, table
from heuncli.scene.meshes.polygons import fans, require_faces, triangles_of

TYPES = {
    "char": "i1", "int8": "i1", "uchar": "u1", "uint8": "u1", "short": "i2", "int16": "i2", "ushort": "u2",
    "uint16": "u2", "int": "i4", "int32": "i4", "uint": "u4", "uint32": "u4", "float": "f4", "float32": "f4",
    "double": "f8", "float64": "f8",
}  # fmt: skip
ORDERS = {"ascii": "", "binary_little_endian": "<", "binary_big_endian": ">"}
CORNERS_OF = ("vertex_indices", "vertex_index")
LONGEST_HEAD = 65_536  # bytes


class Property(NamedTuple):
    """A property: its type, of a list that of its items, and that of their number before them (else None)."""

    name: str
    kind: str
    counted: str | None


class Element(NamedTuple):
    """So many things of a kind."""

    name: str
    many: int
    properties: list[Property]


class PlyHead(NamedTuple):
    """The order of bytes ("" for text), what follows, and where it begins."""

    order: str
    elements: list[Element]
    begin: int


def read_ply(content: bytes) -> Soup:
    """The triangles of a PLY file. Raises Finding."""
    head = head_of(content)
    body = _Words(content[head.begin :]) if not head.order else _Bytes(content, head)
    corners: Array | None = None
    faces: Numbers | None = None
    for element in head.elements:
        if element.name == "vertex":
            corners = body.corners(element)
        elif element.name == "face":
            faces = body.faces(element)
        elif corners is None or faces is None:
            body.pass_over(element)
        if corners is not None and faces is not None:
            break
    if corners is None or faces is None or not len(faces):
        raise refused("there are no corners and faces in it", "a solid's surface: element vertex, element face")
    if (faces < 0).any() or (faces >= len(corners)).any():
        raise refused(f"a face has a corner that is none of the {len(corners)}", "corners are counted from 0")
    return Soup(corners, faces)


def head_of(content: bytes) -> PlyHead:
    """What the head says. Raises Finding."""
    end = content.find(b"end_header", 0, LONGEST_HEAD)
    line_end = content.find(b"\n", end, end + 16) if end >= 0 else -1
    if line_end < 0:
        raise refused("the head of the PLY file has no end", SAVE_AGAIN)
    order: str | None = None
    elements: list[Element] = []
    for line in content[:end].decode("ascii", "replace").splitlines()[1:]:
        words = line.split()
        try:
            match words:
                case ["format", form, _]:
                    order = ORDERS[form]
                case ["element", name, count]:
                    elements.append(Element(name, int(count), []))
                case ["property", "list", counted, kind, name]:
                    elements[-1].properties.append(Property(name, TYPES[kind], TYPES[counted]))
                case ["property", kind, name]:
                    elements[-1].properties.append(Property(name, TYPES[kind], None))
                case [] | ["comment" | "obj_info", *_]:
                    pass
                case _:
                    raise KeyError
        except (KeyError, ValueError, IndexError):
            raise refused("a line of the PLY head is none", "format, element, property; comments begin so") from None
    if order is None or any(not 0 <= element.many <= len(content) for element in elements):
        raise refused("the head of the PLY file announces more than there is", SAVE_AGAIN)
    return PlyHead(order, elements, line_end + 1)


def places_of(element: Element) -> list[int]:
    """Which of an element's properties x, y, z are. Raises Finding."""
    names = [p.name for p in element.properties]
    if not {"x", "y", "z"} <= set(names) or any(p.counted for p in element.properties):
        raise refused("the corners have no x, y, z alone", "property float x, y, z of element vertex")
    return [names.index(axis) for axis in "xyz"]


def list_of(element: Element) -> int:
    """Which of a face's properties its corners are. Raises Finding."""
    found = [i for i, p in enumerate(element.properties) if p.counted and p.name in CORNERS_OF]
    if len(found) != 1:
        raise refused("the faces have no list of corners", "property list uchar int vertex_indices of element face")
    return found[0]


def broken_off(element: Element) -> Finding:
    """That a file ends too early."""
    return refused(f"it breaks off: its head announces {element.many} of '{element.name}', there are fewer", SAVE_AGAIN)


class _Words:
    """The body of a file that is text, read from the front. Impure: remembers how far."""

    def __init__(self, body: bytes) -> None:
        self.lines, self.at = [line for line in body.splitlines() if line.strip()], 0

    def taken(self, element: Element) -> list[bytes]:
        """The lines of an element, one a thing."""
        lines = self.lines[self.at : self.at + element.many]
        if len(lines) < element.many:
            raise broken_off(element)
        self.at += element.many
        return lines

    def pass_over(self, element: Element) -> None:
        """Read on behind an element."""
        self.taken(element)

    def corners(self, element: Element) -> Array:
        """Coordinates (n, 3)."""
        places, lines = places_of(element), self.taken(element)
        together = table(lines, np.float64)
        if together is not None and together.shape[1] >= len(element.properties):
            return np.ascontiguousarray(together[:, places])
        rows = [line.split() for line in lines]
        if any(len(row) < len(element.properties) for row in rows):
            raise broken_off(element)
        return np.stack([floats([row[k] for row in rows], "corner") for k in places], axis=-1)

    def faces(self, element: Element) -> Numbers:
        """Triangles (m, 3)."""
        if any(p.counted for p in element.properties[: list_of(element)]):
            raise refused("the faces have another list before that of their corners", SAVE_AGAIN)
        first, lines = list_of(element), self.taken(element)
        together = table(lines, np.int64)
        if together is not None and first == 0 and (together[:, 0] == together.shape[1] - 1).all():
            faces = together[:, 1:].astype(np.intp)
            require_faces(np.array(faces.shape[1:]))
            return triangles_of(faces)
        rows = [line.split() for line in lines]
        try:
            own = [row[first + 1 : first + 1 + int(row[first])] for row in rows]
            if any(len(one) != int(row[first]) for one, row in zip(own, rows, strict=True)):
                raise broken_off(element)
        except (ValueError, IndexError):
            raise broken_off(element) from None
        return fans(own) if own else np.empty((0, 3), np.intp)


class _Bytes:
    """The body of a binary file, read from the front. Impure: remembers how far."""

    def __init__(self, content: bytes, head: PlyHead) -> None:
        self.content, self.at, self.order = content, head.begin, head.order

    def rows(self, element: Element, lengths: int | None = None) -> np.ndarray:
        """An element as rows of fixed size; lengths: of its lists."""
        fields: list[tuple[str, str] | tuple[str, str, int]] = []
        for i, p in enumerate(element.properties):
            if p.counted is None:
                fields.append((str(i), self.order + p.kind))
            else:
                fields += [(f"n{i}", self.order + p.counted), (str(i), self.order + p.kind, lengths or 0)]
        row = np.dtype(fields)
        if self.at + row.itemsize * element.many > len(self.content):
            raise broken_off(element)
        return np.frombuffer(self.content, row, element.many, self.at)

    def pass_over(self, element: Element) -> None:
        """Read on behind an element."""
        if any(p.counted for p in element.properties):
            raise refused(f"lists of '{element.name}' stand before the faces", SAVE_AGAIN)
        self.at += self.rows(element).nbytes

    def corners(self, element: Element) -> Array:
        """Coordinates (n, 3)."""
        places, rows = places_of(element), self.rows(element)
        self.at += rows.nbytes
        return np.stack([rows[str(k)].astype(np.float64) for k in places], axis=-1)

    def faces(self, element: Element) -> Numbers:
        """Triangles (m, 3): at once where all faces have three corners, else one face after the other."""
        k = list_of(element)
        if sum(p.counted is not None for p in element.properties) > 1:
            raise refused("the faces have lists beside that of their corners", SAVE_AGAIN)
        try:
            rows = self.rows(element, 3)
        except Finding:
            return self._one_by_one(element, k)
        if (rows[f"n{k}"] != 3).any():
            return self._one_by_one(element, k)
        return np.asarray(rows[str(k)].astype(np.intp).reshape(-1, 3))

    def _one_by_one(self, element: Element, k: int) -> Numbers:
        """Of faces with more corners than three."""
        sizes = [np.dtype(p.kind).itemsize for p in element.properties]
        before, after = sum(sizes[:k]), sum(sizes[k + 1 :])
        own = element.properties[k]
        number, item = np.dtype(self.order + str(own.counted)), np.dtype(self.order + own.kind)
        at, found = self.at, []
        for _ in range(element.many):
            at += before
            if at + number.itemsize > len(self.content):
                raise broken_off(element)
            count = int(np.frombuffer(self.content, number, 1, at)[0])
            at += number.itemsize
            require_faces(np.array([count]))
            if at + count * item.itemsize + after > len(self.content):
                raise broken_off(element)
            face = np.frombuffer(self.content, item, count, at).astype(np.intp)
            found.append(triangles_of(face[None]))
            at += count * item.itemsize + after
        return np.concatenate(found) if found else np.empty((0, 3), np.intp)
