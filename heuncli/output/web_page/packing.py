"""Pack the numbers of a page: each column as whole steps of its largest number, all columns in one deflated block.

A column of 32-bit differences is small where the motion is smooth: differences of neighbouring instants are taken until
they no longer shrink, and their four bytes are stored in four planes, of which the upper ones are almost empty. The
steps are far finer than the digits that a page shows. A constant column is one number; indeterminate values (nan) are
kept by storing the column as floating-point numbers.
"""

from __future__ import annotations

import base64
import json
import math
import struct
import zlib
from typing import Any

import numpy as np

from heuncli.base.records import record
from heuncli.results.results import Array, Indices

NUMBER_STEPS = 2**22  # steps of a column's largest number: its rounding is 1.2e-7 of it
POINT_STEPS = 2**20  # steps of the range of what is drawn: far less than a pixel
MAX_STEPS = 2**27  # steps of a coordinate, so that differences fit into 32 bits
MAX_ORDER = 3  # of the differences that are tried
FLOAT32, FLOAT64 = "f4", "f8"


@record
class PackedColumn:
    """The bytes of a column, and what a reader must know of them.

    lag: distance of the numbers of which the differences are taken; order: how often these are taken
    step: value of one step; 0 for floating-point numbers, of as many bytes as `order` tells then
    """

    bytes: bytes
    count: int
    lag: int
    order: int
    step: float


Packed = PackedColumn | float  # a float: all numbers are equal to it


def pack_values(values: Array, lag: int = 1, largest: float = 0.0) -> Packed:
    """Pack an array, flattened; nan, which stands for an indeterminate value, is kept.

    lag: how many numbers of the flattened array belong to one instant
    largest: the largest magnitude of the family of the numbers; 0: of the numbers themselves
    """
    flat = np.ascontiguousarray(values, dtype="<f8").ravel()
    first = float(flat[0]) if flat.size else 0.0
    if math.isfinite(first) and bool((flat == first).all()):
        return first + 0.0
    if not np.isfinite(flat).all():
        return _pack_floats(flat, FLOAT32)
    return _pack_steps(flat, lag, max(largest, float(np.abs(flat).max())) / NUMBER_STEPS)


def pack_exact(values: Array) -> PackedColumn:
    """Pack an array with all its digits."""
    return _pack_floats(np.ascontiguousarray(values, dtype="<f8").ravel(), FLOAT64)


def pack_points(values: Array, lag: int = 3) -> PackedColumn:
    """Pack points or attitudes that are drawn."""
    flat = np.ascontiguousarray(values, dtype="<f8").ravel()
    largest = float(np.abs(flat).max(initial=0.0))
    span = float(np.ptp(flat.reshape(-1, lag), axis=0).max()) if flat.size else 0.0
    return _pack_steps(flat, lag, max(span / POINT_STEPS, largest / MAX_STEPS) or 1.0)


def _pack_steps(flat: Array, lag: int, step: float) -> PackedColumn:
    whole = np.rint(flat / step).astype(np.intp)
    differences: list[Indices] = [whole]
    for _ in range(MAX_ORDER):
        differences.append(_take_differences(differences[-1], lag))
    order = int(np.argmin([np.abs(each).sum() for each in differences]))
    folded = (differences[order] << 1) ^ (differences[order] >> 63)  # 0, -1, 1, -2, ... as 0, 1, 2, 3, ...
    planes = folded.astype("<u4").view(np.uint8).reshape(-1, 4).T
    return PackedColumn(planes.tobytes(), flat.size, lag, order, step)


def _pack_floats(flat: Array, form: str) -> PackedColumn:
    size = int(form[1])
    planes = flat.astype(f"<{form}").view(np.uint8).reshape(-1, size).T
    return PackedColumn(planes.tobytes(), flat.size, 1, size, 0.0)


def _take_differences(whole: Indices, lag: int) -> Indices:
    differences = whole.copy()
    differences[lag:] -= whole[:-lag]
    return differences


def encode_data(data: Any) -> str:
    """Encode the data of a page as base64 of a deflated block: length of the JSON, the JSON, the bytes of the columns.

    A column stands in the JSON as {"packed": [offset, count, lag, order, step]}. Raises ValueError if the data hold nan
    or infinity.
    """
    blocks: list[bytes] = []
    size = 0

    def place(packed: PackedColumn) -> dict[str, list[float]]:
        nonlocal size
        blocks.append(packed.bytes)
        size += len(packed.bytes)
        return {"packed": [size - len(packed.bytes), packed.count, packed.lag, packed.order, packed.step]}

    text = json.dumps(data, allow_nan=False, separators=(",", ":"), default=place).encode()
    whole = struct.pack("<I", len(text)) + text + b"".join(blocks)
    return base64.b64encode(zlib.compress(whole, 9)).decode("ascii")
