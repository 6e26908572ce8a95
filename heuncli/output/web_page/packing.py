"""Pack the numbers of a page: each column as whole steps of its largest number, all columns in one deflated block.

A column over the instants is smooth, so each number is predicted by the polynomial through the numbers before it, and
what is kept is the difference. The instants are not equidistant, and the polynomial knows them: it is computed in the
same order of operations here and in data.js, so that both get the same bits. The loads along a bar are smooth over its
cuts as well: there, differences of neighbouring cuts are taken. The four bytes of the differences are stored in four
planes, of which the upper ones are almost empty; equal columns are stored once, as those of load cases may be. The
steps are far finer than the digits that a page shows. A constant column is one number; indeterminate values (nan) are
kept by storing the column as floating-point numbers.
"""

from __future__ import annotations

import base64
import json
import math
import struct
import zlib
from collections.abc import Sequence
from functools import lru_cache
from typing import Any

import numpy as np

from heuncli.base.records import record
from heuncli.results.results import Array, Indices

NUMBER_STEPS = 2**22  # steps of a column's largest number: its rounding is 1.2e-7 of it
POINT_STEPS = 2**20  # steps of the range of what is drawn: far less than a pixel
MAX_STEPS = 2**27  # steps of a coordinate, so that differences fit into 32 bits
MAX_ORDER = 5  # numbers through which a polynomial is drawn
MAX_GAIN = 64.0  # sum of its weights: above, as just after a jump, a polynomial of fewer numbers is taken
MAX_ACROSS = 4  # how often differences of neighbouring cuts are taken
MIN_CUTS = 5  # numbers of an instant from which these are tried
MAX_TRIAL_INSTANTS = 160  # of a column, on which orders are compared
FLOAT32, FLOAT64 = 4, 8  # bytes


@record
class PackedColumn:
    """The numbers of a column, as whole steps or as they are.

    numbers (count,): in the order of the instants
    lag: how many of them belong to one instant
    step: value of one step; 0 for floating-point numbers, of `size` bytes
    """

    numbers: Array | Indices
    lag: int
    step: float
    size: int = 4


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
        return PackedColumn(flat, 1, 0.0, FLOAT32)
    return _pack_steps(flat, lag, max(largest, float(np.abs(flat).max())) / NUMBER_STEPS)


def pack_exact(values: Array) -> PackedColumn:
    """Pack an array with all its digits."""
    return PackedColumn(np.ascontiguousarray(values, dtype="<f8").ravel(), 1, 0.0, FLOAT64)


def pack_points(values: Array, lag: int = 3) -> PackedColumn:
    """Pack points or attitudes that are drawn."""
    flat = np.ascontiguousarray(values, dtype="<f8").ravel()
    largest = float(np.abs(flat).max(initial=0.0))
    span = float(np.ptp(flat.reshape(-1, lag), axis=0).max()) if flat.size else 0.0
    return _pack_steps(flat, lag, max(span / POINT_STEPS, largest / MAX_STEPS) or 1.0)


def _pack_steps(flat: Array, lag: int, step: float) -> PackedColumn:
    return PackedColumn(np.rint(flat / step).astype(np.intp), lag, step)


def encode_data(data: Any) -> str:
    """Encode the data of a page as base64 of a deflated block: length of the JSON, the JSON, the bytes of the columns.

    data: of a run, whose instants stand under `time`, or the list of these under `runs`. A column of steps stands in
    the JSON as {"packed": [offset, count, lag, order, step, across, offset of the instants]}, the last -1 if it does
    not run over them; one of floating-point numbers as [offset, count, 1, bytes of each, 0]. Raises ValueError if the
    data hold nan or infinity.
    """
    columns = _ColumnBlock()
    runs = data.get("runs") if isinstance(data, dict) else None
    texts = [columns.write_json(each) for each in ([data] if runs is None else runs)]
    text = (texts[0] if runs is None else f'{{"runs":[{",".join(texts)}]}}').encode()
    whole = struct.pack("<I", len(text)) + text + b"".join(columns.found)
    return base64.b64encode(zlib.compress(whole, 9)).decode("ascii")


class _ColumnBlock:
    """The bytes of all columns, each stored once. Mutable: it grows."""

    def __init__(self) -> None:
        self.found: dict[bytes, int] = {}  # offsets
        self.size = 0

    def write_json(self, run: Any) -> str:
        """Write the JSON of a run, and store its columns."""
        time = run.get("time") if isinstance(run, dict) else None
        instants = np.asarray(time.numbers, dtype=np.float64) if isinstance(time, PackedColumn) else np.zeros(0)

        def place(column: PackedColumn) -> dict[str, list[float]]:
            if column.step == 0.0:
                planes = _split_planes(column.numbers.astype(f"<f{column.size}"), column.size)
                return {"packed": [self.store(planes), column.numbers.size, 1, column.size, 0]}
            count = column.numbers.size // column.lag
            is_course = count == len(instants)
            order, across, planes = _encode_steps(column, instants if is_course else np.arange(float(count)))
            at = self.store(_split_planes(instants, FLOAT64)) if is_course else -1
            return {"packed": [self.store(planes), column.numbers.size, column.lag, order, column.step, across, at]}

        return json.dumps(run, allow_nan=False, separators=(",", ":"), default=place)

    def store(self, planes: bytes) -> int:
        """Store the bytes of a column; returns their offset."""
        if planes not in self.found:
            self.found[planes] = self.size
            self.size += len(planes)
        return self.found[planes]


def _split_planes(values: Array | Indices, size: int) -> bytes:
    return values.view(np.uint8).reshape(-1, size).T.tobytes()


def _encode_steps(column: PackedColumn, instants: Array) -> tuple[int, int, bytes]:
    """Encode a column of steps; returns the order of the polynomial, how often differences across the cuts are taken,
    and the bytes of what is left.
    """
    whole: Indices = column.numbers.astype(np.intp, copy=False).reshape(-1, column.lag)
    count = len(whole)
    weights = compute_weights(tuple(instants.tolist()))
    begin = max(0, (count - MAX_TRIAL_INSTANTS) // 2)
    trial = slice(begin, begin + MAX_TRIAL_INSTANTS)
    largest_across = MAX_ACROSS if column.lag >= MIN_CUTS else 0
    costs = {}
    for order, each in enumerate(weights):
        left = _predict_steps(whole[trial], each[trial])
        for across in range(largest_across + 1):
            costs[order, across] = float(np.log2(1.0 + np.abs(left[order:])).sum())
            left = np.diff(left, axis=1, prepend=0)
    for order, across in (min(costs, key=costs.__getitem__), (0, 0)):
        left = _predict_steps(whole, weights[order])
        for _ in range(across):
            left = np.diff(left, axis=1, prepend=0)
        if np.abs(left).max(initial=0) < 2**31:
            break
    folded = (left << 1) ^ (left >> 63)  # 0, -1, 1, -2, ... as 0, 1, 2, 3, ...
    return order, across, _split_planes(folded.astype("<u4").ravel(), 4)


@lru_cache(maxsize=16)
def compute_weights(instants: Sequence[float]) -> list[Array]:
    """Compute the weights (n, order) by which the numbers before an instant, the last first, predict the one there.

    They are those of Lagrange's polynomial. Where there are not enough numbers, or where it would magnify their
    rounding too much, those of the next lower order stand.
    """
    times = np.array(instants, dtype=np.float64)
    count = len(times)
    found = [np.zeros((count, 0))]
    for order in range(1, min(MAX_ORDER, count - 1) + 1):
        own = np.concatenate([found[-1], np.zeros((count, 1))], axis=1)
        now = times[order:]
        before = [times[order - 1 - k : count - 1 - k] for k in range(order)]
        weights = np.ones((len(now), order))
        with np.errstate(divide="ignore", invalid="ignore", over="ignore"):
            for j, k in ((j, k) for j in range(order) for k in range(order) if k != j):
                weights[:, j] *= (now - before[k]) / (before[j] - before[k])
            gain = np.zeros(len(now))
            for j in range(order):
                gain = gain + np.abs(weights[:, j])
        is_steady = gain <= MAX_GAIN
        own[order:][is_steady] = weights[is_steady]
        found.append(own)
    return found


def _predict_steps(whole: Indices, weights: Array) -> Indices:
    """Return what the prediction of each number (n, lag) from those before it leaves."""
    predicted = np.zeros(whole.shape)
    for k in range(weights.shape[1]):
        predicted[k + 1 :] += weights[k + 1 :, k, None] * whole[: len(whole) - k - 1]
    return whole - np.floor(predicted + 0.5).astype(np.intp)
