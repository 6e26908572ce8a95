"""Write a moving machine as glTF 2.0 in one binary file, for viewers and 3D programs.

The file has two chunks: JSON, which describes the objects, and the numbers that it refers to, float32. A body is a node
with the body's translation and rotation; its points are child nodes, its shapes a mesh; a body without shapes has
lines. Between two instants a reader interpolates linearly and turns the shortest way, so instants should be close. In
glTF y points up, lengths are in metres, and time begins at 0: the root node turns the machine's up direction onto y.
"""

from __future__ import annotations

import json
import struct
from collections.abc import Mapping
from itertools import pairwise
from typing import Any

import numpy as np

from heuncli.output.drawing.style import find_pen
from heuncli.output.machine_geometry.machine import BodyGeometry, Machine
from heuncli.output.machine_geometry.poses import Poses
from heuncli.output.machine_geometry.solids import Surface
from heuncli.results.results import Array
from heuncli.scene.file_format.names import GROUND
from heuncli.scene.shapes.rotations import quaternion_from_matrix, rotation_between

FLOAT32, UINT32 = 5126, 5125  # glTF's codes of component types
POINTS, LINES, TRIANGLES = 0, 1, 4  # glTF's codes of primitive types
TYPE_BY_WIDTH = {1: "SCALAR", 3: "VEC3", 4: "VEC4"}
Y = np.array([0.0, 1.0, 0.0])

Node = dict[str, Any]


def encode_gltf(machine: Machine, poses: Poses, up_direction: Array) -> bytes:
    """Encode the machine in its poses as a glTF file.

    up_direction: unit vector (3,), world axes
    """
    file = _GltfBuilder()
    instants = _select_instants(poses.times)
    times = (
        file.add_numbers((poses.times[instants] - poses.times[0])[:, None], with_bounds=True)
        if len(instants) > 1
        else None
    )
    bodies = [_add_body(file, k, body, poses, instants, times) for k, body in enumerate(machine.bodies)]
    ground = file.add_node(GROUND, children=_add_points(file, GROUND, machine.ground_points))
    world = file.add_node(
        machine.title,
        children=[ground, *bodies],
        rotation=_to_xyzw(quaternion_from_matrix(rotation_between(up_direction, Y))),
    )
    return file.to_bytes(world, float(poses.times[0]))


def triangulate(surface: Surface) -> Array:
    """Split the convex faces of a surface into triangles (n, 3) of corner numbers, counter-clockwise from outside."""
    fans = [(face[0], b, c) for face in surface.faces for b, c in pairwise(face[1:])]
    return np.array(fans, dtype=np.uint32)


def _select_instants(times: Array) -> Array:
    """Select the numbers of the instants that differ as float32; so one pose is kept of the two sides of a jump."""
    single = (times - times[0]).astype(np.float32)
    return np.asarray(np.flatnonzero(np.diff(single, prepend=-1.0) > 0.0))


def _add_body(
    file: _GltfBuilder, number: int, body: BodyGeometry, poses: Poses, instants: Array, times: int | None
) -> int:
    """Add the node of a body, animated over the times.

    times: the accessor number of the times, or None if nothing moves
    """
    positions, rotations = (
        poses.positions[body.name][instants],
        _to_xyzw(_make_continuous(poses.quaternions[body.name][instants])),
    )
    children = _add_points(file, body.name, body.points)
    node = file.add_node(body.name, children=children, translation=positions[0], rotation=rotations[0])
    if body.surfaces or any(len(line) for line in body.strokes):
        file.nodes[node]["mesh"] = _add_mesh(file, number, body)
    if times is not None:
        file.add_motion(node, times, "translation", file.add_numbers(positions))
        file.add_motion(node, times, "rotation", file.add_numbers(rotations))
    return node


def _add_mesh(file: _GltfBuilder, number: int, body: BodyGeometry) -> int:
    """Add the mesh of a body: one primitive for each surface and line, in the body's colour."""
    colour = bytes.fromhex(find_pen(number).colour.lstrip("#"))
    linear = [_to_linear_light(part / 255.0) for part in colour]
    file.materials.append({"pbrMetallicRoughness": {"baseColorFactor": [*linear, 1.0], "metallicFactor": 0.0}})
    material, parts = len(file.materials) - 1, []
    for surface in body.surfaces:
        corners, faces = (
            file.add_numbers(surface.corners, with_bounds=True),
            file.add_numbers(triangulate(surface).reshape(-1, 1)),
        )
        parts.append({"attributes": {"POSITION": corners}, "indices": faces, "mode": TRIANGLES, "material": material})
    for line in body.strokes:
        pairs, mode = (np.repeat(line, 2, axis=0)[1:-1], LINES) if len(line) > 1 else (line, POINTS)
        corners = file.add_numbers(pairs, with_bounds=True)
        parts.append({"attributes": {"POSITION": corners}, "mode": mode, "material": material})
    file.meshes.append({"name": body.name, "primitives": parts})
    return len(file.meshes) - 1


def _add_points(file: _GltfBuilder, body: str, points: Mapping[str, Array]) -> list[int]:
    """Add a node for each named point of a body, to which other objects can be attached."""
    return [file.add_node(f"{body}.{name}", translation=point) for name, point in points.items()]


def _to_linear_light(shade: float) -> float:
    """Convert an sRGB colour component (IEC 61966-2-1) to linear light, as glTF needs it."""
    return round(shade / 12.92 if shade <= 0.04045 else ((shade + 0.055) / 1.055) ** 2.4, 6)


def _make_continuous(quaternions: Array) -> Array:
    """Remove jumps of sign from quaternions (n, 4): each becomes the one of q and -q that is nearer to its
    predecessor.
    """
    signs = np.where(np.sum(quaternions[1:] * quaternions[:-1], axis=1) < 0.0, -1.0, 1.0)
    return np.asarray(quaternions * np.cumprod(np.concatenate([[1.0], signs]))[:, None])


def _to_xyzw(quaternion: Array) -> Array:
    """Reorder quaternions (..., 4) from w, x, y, z to glTF's order x, y, z, w."""
    return np.roll(quaternion, -1, axis=-1)


class _GltfBuilder:
    """Builds a glTF file. Mutable: it grows. Nodes, meshes, materials and accessors are referred to by their
    numbers.
    """

    def __init__(self) -> None:
        self.nodes: list[Node] = []
        self.meshes: list[dict[str, Any]] = []
        self.materials: list[dict[str, Any]] = []
        self.accessors: list[dict[str, Any]] = []
        self.views: list[dict[str, int]] = []
        self.samplers: list[dict[str, Any]] = []
        self.channels: list[dict[str, Any]] = []
        self.bytes = bytearray()

    def add_numbers(self, values: Array, with_bounds: bool = False) -> int:
        """Add an accessor to rows of values (n, width) and return its number.

        with_bounds: whether the accessor states the minimum and maximum of each column
        """
        is_integer = values.dtype.kind == "u"
        array = values.astype("<u4" if is_integer else "<f4")
        kind = {
            "componentType": UINT32 if is_integer else FLOAT32,
            "count": len(array),
            "type": TYPE_BY_WIDTH[array.shape[1]],
        }
        if with_bounds:
            kind |= {"min": array.min(axis=0).tolist(), "max": array.max(axis=0).tolist()}
        self.views.append({"buffer": 0, "byteOffset": len(self.bytes), "byteLength": array.nbytes})
        self.bytes += array.tobytes()
        self.accessors.append({"bufferView": len(self.views) - 1, **kind})
        return len(self.accessors) - 1

    def add_node(self, name: str, children: list[int] | None = None, **pose: Array) -> int:
        """Add a node, whose children were added before, and return its number."""
        child_entry = {"children": children} if children else {}  # glTF knows no empty lists
        self.nodes.append({"name": name, **child_entry, **{key: part.tolist() for key, part in pose.items()}})
        return len(self.nodes) - 1

    def add_motion(self, node: int, times: int, path: str, values: int) -> None:
        """Add the motion of a node over time.

        times, values: numbers of accessors
        """
        self.channels.append({"sampler": len(self.samplers), "target": {"node": node, "path": path}})
        self.samplers.append({"input": times, "interpolation": "LINEAR", "output": values})

    def to_bytes(self, root: int, start: float) -> bytes:
        """Write all of it as one file.

        start: the time of the run at which the file's time is 0
        """
        animations = [{"name": self.nodes[root]["name"], "channels": self.channels, "samplers": self.samplers}]
        lists = {
            "nodes": self.nodes, "meshes": self.meshes, "materials": self.materials, "accessors": self.accessors,
            "bufferViews": self.views, "animations": animations if self.channels else [],
            "buffers": [{"byteLength": len(self.bytes)}] if self.bytes else [],
        }  # fmt: skip
        header = {"asset": {"version": "2.0", "generator": "heun"}, "extras": {"start": start}}
        scenes = {"scene": 0, "scenes": [{"nodes": [root]}]}
        text = json.dumps(
            {**header, **scenes, **{key: entries for key, entries in lists.items() if entries}}, allow_nan=False
        )
        return _join_chunks((b"JSON", text.encode().ljust(-(-len(text) // 4) * 4)), (b"BIN\0", bytes(self.bytes)))


def _join_chunks(*chunks: tuple[bytes, bytes]) -> bytes:
    """Join the chunks, each a multiple of 4 bytes long, to a binary file: magic number, version, length, chunks."""
    parts = b"".join(struct.pack("<I4s", len(data), kind) + data for kind, data in chunks if data)
    return struct.pack("<4sII", b"glTF", 2, 12 + len(parts)) + parts
