"""A moving machine as glTF 2.0 in one binary file, which viewers and programs for drawing in space read.

A file of two chunks: JSON, which says what there is, and the numbers that it points at, float32. A body is a node that
is shifted and turned as the body is; its points are nodes on it, its shapes a mesh, a body without shapes its lines.
Between two instants a reader goes straight on and turns the shortest way, so instants should be close. In glTF y points
up, lengths are metres, and time begins at 0: the node above all others turns the machine's up onto y.
"""

from __future__ import annotations

import json
import struct
from collections.abc import Mapping
from itertools import pairwise
from typing import Any

import numpy as np

from heuncli.output.drawing.pens import pen
from heuncli.output.machine_geometry.machine import BodyLook, Machine
from heuncli.output.machine_geometry.poses import Poses
from heuncli.output.machine_geometry.solids import Surface
from heuncli.results.results import Array
from heuncli.scene.file_format.names import GROUND
from heuncli.scene.shapes.rotations import to_quaternion, turn_onto

FLOAT, WHOLE = 5126, 5125  # glTF's numbers of types: float32, uint32
POINTS, LINES, TRIANGLES = 0, 1, 4  # and of what corners are joined to
KINDS = {1: "SCALAR", 3: "VEC3", 4: "VEC4"}
Y = np.array([0.0, 1.0, 0.0])

Node = dict[str, Any]


def binary(machine: Machine, poses: Poses, up: Array) -> bytes:
    """The file: the machine in its poses, (3,) the unit direction that is up in the world."""
    file = _Binary()
    kept = _instants(poses.times)
    times = file.numbers((poses.times[kept] - poses.times[0])[:, None], ends=True) if len(kept) > 1 else None
    bodies = [_body(file, k, body, poses, kept, times) for k, body in enumerate(machine.bodies)]
    ground = file.node(GROUND, children=_points(file, GROUND, machine.grounded))
    world = file.node(machine.title, children=[ground, *bodies], rotation=_xyzw(to_quaternion(turn_onto(up, Y))))
    return file.written(world, float(poses.times[0]))


def triangles(surface: Surface) -> Array:
    """The faces of a surface, which are convex, as triangles (n, 3) of corners, counter-clockwise from outside."""
    fans = [(face[0], b, c) for face in surface.faces for b, c in pairwise(face[1:])]
    return np.array(fans, dtype=np.uint32)


def _instants(times: Array) -> Array:
    """The instants that differ as float32, by their numbers: on both sides of a jump a body stands in one place."""
    single = (times - times[0]).astype(np.float32)
    return np.asarray(np.flatnonzero(np.diff(single, prepend=-1.0) > 0.0))


def _body(file: _Binary, number: int, body: BodyLook, poses: Poses, kept: Array, times: int | None) -> int:
    """The node of a body, moved over the times; times: the number of their accessor, None where nothing moves."""
    places, turns = poses.places[body.name][kept], _xyzw(_continued(poses.turns[body.name][kept]))
    children = _points(file, body.name, body.points)
    node = file.node(body.name, children=children, translation=places[0], rotation=turns[0])
    if body.surfaces or any(len(line) for line in body.strokes):
        file.nodes[node]["mesh"] = _mesh(file, number, body)
    if times is not None:
        file.move(node, times, "translation", file.numbers(places))
        file.move(node, times, "rotation", file.numbers(turns))
    return node


def _mesh(file: _Binary, number: int, body: BodyLook) -> int:
    """The mesh of a body: a part a shape or line, in the body's colour."""
    colour = bytes.fromhex(pen(number).colour.lstrip("#"))
    linear = [_linear(part / 255.0) for part in colour]
    file.materials.append({"pbrMetallicRoughness": {"baseColorFactor": [*linear, 1.0], "metallicFactor": 0.0}})
    material, parts = len(file.materials) - 1, []
    for surface in body.surfaces:
        corners, faces = file.numbers(surface.corners, ends=True), file.numbers(triangles(surface).reshape(-1, 1))
        parts.append({"attributes": {"POSITION": corners}, "indices": faces, "mode": TRIANGLES, "material": material})
    for line in body.strokes:
        pairs, mode = (np.repeat(line, 2, axis=0)[1:-1], LINES) if len(line) > 1 else (line, POINTS)
        corners = file.numbers(pairs, ends=True)
        parts.append({"attributes": {"POSITION": corners}, "mode": mode, "material": material})
    file.meshes.append({"name": body.name, "primitives": parts})
    return len(file.meshes) - 1


def _points(file: _Binary, body: str, points: Mapping[str, Array]) -> list[int]:
    """A node for each named point of a body, for what is to be hung on it."""
    return [file.node(f"{body}.{name}", translation=point) for name, point in points.items()]


def _linear(shade: float) -> float:
    """A share of a colour as glTF has it, in proportion to the light: that of sRGB (IEC 61966-2-1) undone."""
    return round(shade / 12.92 if shade <= 0.04045 else ((shade + 0.055) / 1.055) ** 2.4, 6)


def _continued(turns: Array) -> Array:
    """Quaternions (n, 4) without jumps of sign: each the nearer of q and -q to the one before."""
    along = np.where(np.sum(turns[1:] * turns[:-1], axis=1) < 0.0, -1.0, 1.0)
    return np.asarray(turns * np.cumprod(np.concatenate([[1.0], along]))[:, None])


def _xyzw(quaternion: Array) -> Array:
    """Quaternions in glTF's order, (..., 4)."""
    return np.roll(quaternion, -1, axis=-1)


class _Binary:
    """What a file has so far; impure: it grows. Of nodes, meshes, materials and accessors others know the numbers."""

    def __init__(self) -> None:
        self.nodes: list[Node] = []
        self.meshes: list[dict[str, Any]] = []
        self.materials: list[dict[str, Any]] = []
        self.accessors: list[dict[str, Any]] = []
        self.views: list[dict[str, int]] = []
        self.samplers: list[dict[str, Any]] = []
        self.channels: list[dict[str, Any]] = []
        self.bytes = bytearray()

    def numbers(self, values: Array, ends: bool = False) -> int:
        """The number of an accessor to rows of values (n, width); ends: with the least and greatest of each column."""
        whole = values.dtype.kind == "u"
        kept = values.astype("<u4" if whole else "<f4")
        kind = {"componentType": WHOLE if whole else FLOAT, "count": len(kept), "type": KINDS[kept.shape[1]]}
        if ends:
            kind |= {"min": kept.min(axis=0).tolist(), "max": kept.max(axis=0).tolist()}
        self.views.append({"buffer": 0, "byteOffset": len(self.bytes), "byteLength": kept.nbytes})
        self.bytes += kept.tobytes()
        self.accessors.append({"bufferView": len(self.views) - 1, **kind})
        return len(self.accessors) - 1

    def node(self, name: str, children: list[int] | None = None, **pose: Array) -> int:
        """The number of a node, whose children are there."""
        inner = {"children": children} if children else {}  # glTF knows no empty lists
        self.nodes.append({"name": name, **inner, **{key: part.tolist() for key, part in pose.items()}})
        return len(self.nodes) - 1

    def move(self, node: int, times: int, path: str, values: int) -> None:
        """A node is shifted or turned over time; times, values: the numbers of accessors."""
        self.channels.append({"sampler": len(self.samplers), "target": {"node": node, "path": path}})
        self.samplers.append({"input": times, "interpolation": "LINEAR", "output": values})

    def written(self, root: int, start: float) -> bytes:
        """All of it in one file; start: the time of the run at which that of the file is 0."""
        moves = [{"name": self.nodes[root]["name"], "channels": self.channels, "samplers": self.samplers}]
        lists = {
            "nodes": self.nodes, "meshes": self.meshes, "materials": self.materials, "accessors": self.accessors,
            "bufferViews": self.views, "animations": moves if self.channels else [],
            "buffers": [{"byteLength": len(self.bytes)}] if self.bytes else [],
        }  # fmt: skip
        head = {"asset": {"version": "2.0", "generator": "heun"}, "extras": {"start": start}}
        scenes = {"scene": 0, "scenes": [{"nodes": [root]}]}
        text = json.dumps({**head, **scenes, **{key: found for key, found in lists.items() if found}}, allow_nan=False)
        return _chunked((b"JSON", text.encode().ljust(-(-len(text) // 4) * 4)), (b"BIN\0", bytes(self.bytes)))


def _chunked(*chunks: tuple[bytes, bytes]) -> bytes:
    """The frame of a binary file: its mark, version and length, then the chunks, each a multiple of 4 bytes long."""
    parts = b"".join(struct.pack("<I4s", len(data), kind) + data for kind, data in chunks if data)
    return struct.pack("<4sII", b"glTF", 2, 12 + len(parts)) + parts
