"""A binary glTF file read by its standard (Khronos, glTF 2.0, sections 3.6, 3.11 and 4), apart from what wrote it."""

from __future__ import annotations

import json
import struct
from typing import Any

import numpy as np

from heuncli.results.results import Array

TYPES = {5123: "<u2", 5125: "<u4", 5126: "<f4"}
WIDTHS = {"SCALAR": 1, "VEC3": 3, "VEC4": 4}


class Glb:
    """A file taken apart; head: its JSON, data: its numbers."""

    def __init__(self, content: bytes) -> None:
        mark, version, length = struct.unpack_from("<4sII", content)
        assert (mark, version, length) == (b"glTF", 2, len(content))
        chunks, at = [], 12
        while at < length:
            size, kind = struct.unpack_from("<I4s", content, at)
            assert size % 4 == 0 and at + 8 + size <= length
            chunks.append((kind, content[at + 8 : at + 8 + size]))
            at += 8 + size
        assert [kind for kind, _ in chunks] == [b"JSON", b"BIN\0"][: len(chunks)]
        self.head: dict[str, Any] = json.loads(chunks[0][1].decode())
        self.data = chunks[1][1] if len(chunks) > 1 else b""

    def numbers(self, accessor: int) -> Array:
        """The rows that an accessor points at, (n, width); its ends, where told, are theirs."""
        told = self.head["accessors"][accessor]
        view, width = self.head["bufferViews"][told["bufferView"]], WIDTHS[told["type"]]
        assert view["byteOffset"] % 4 == 0 and view["byteOffset"] + view["byteLength"] <= len(self.data)
        found = np.frombuffer(self.data, TYPES[told["componentType"]], told["count"] * width, view["byteOffset"])
        rows = found.reshape(-1, width)
        assert rows.nbytes == view["byteLength"]
        for end, of_rows in (("min", np.min), ("max", np.max)):
            assert end not in told or told[end] == of_rows(rows, axis=0).tolist()
        return rows

    def node(self, name: str) -> dict[str, Any]:
        """The one node of a name."""
        (found,) = [node for node in self.head["nodes"] if node["name"] == name]
        return found

    def courses(self, name: str) -> dict[str, tuple[Array, Array]]:
        """How a node moves: by what is moved (translation, rotation) the times (n,) and values (n, 3 or 4)."""
        at = self.head["nodes"].index(self.node(name))
        found = {}
        for moves in self.head.get("animations", ()):
            for channel in (c for c in moves["channels"] if c["target"]["node"] == at):
                sampler = moves["samplers"][channel["sampler"]]
                assert sampler["interpolation"] == "LINEAR"
                times = self.numbers(sampler["input"])[:, 0]
                found[channel["target"]["path"]] = times, self.numbers(sampler["output"])
        return found
