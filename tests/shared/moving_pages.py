"""Pages of `heun show` read back without a browser: their data, what is packed in them, their elements."""

from __future__ import annotations

import base64
import json
import math
import struct
import zlib
from html.parser import HTMLParser
from typing import Any

import numpy as np

from heuncli.results.results import Array

Packed = float | tuple[float, ...]


def unpacked(packed: Packed, count: int) -> Array:
    """The numbers of a column, (count,)."""
    return np.array(packed) if isinstance(packed, tuple) else np.full(count, float(packed))


def places(packed: tuple[float, ...]) -> Array:
    """The numbers of a column of places."""
    return np.array(packed)


def unpack(columns: bytes, form: list[float]) -> tuple[float, ...]:
    """The numbers of a column by its form: offset, count, lag, order, step, across, instants; see packing.py."""
    offset, count, lag, order = (int(part) for part in form[:4])
    if form[4] == 0:
        return tuple(read_planes(columns, offset, count, f"<f{order}").astype(np.float64).tolist())
    across, instants = int(form[5]), int(form[6])
    folded = read_planes(columns, offset, count, "<u4").astype(np.int64)
    whole = np.where(folded % 2, -(folded + 1) // 2, folded // 2).reshape(-1, lag)
    for _ in range(across):
        whole = np.cumsum(whole, axis=1)
    n = len(whole)
    times = list(range(n)) if instants < 0 else read_planes(columns, instants, n, "<f8").tolist()
    for m in range(1, n):
        predicted = np.zeros(lag)
        for k, weight in enumerate(weights_at(times, m, min(order, m))):
            predicted += weight * whole[m - 1 - k]
        whole[m] += np.floor(predicted + 0.5).astype(np.int64)
    return tuple((whole.ravel() * form[4]).tolist())


def read_planes(columns: bytes, offset: int, count: int, form: str) -> Array:
    """Numbers whose bytes stand in planes."""
    size = int(form[2])
    planes = np.frombuffer(columns, np.uint8, count * size, offset).reshape(size, count)
    return np.frombuffer(np.ascontiguousarray(planes.T).tobytes(), form)


def weights_at(times: list[float], m: int, order: int) -> list[float]:
    """The weights of Lagrange's polynomial through the numbers before one, the last first."""
    for size in range(order, 0, -1):
        weights = [1.0] * size
        for j in range(size):
            for k in range(size):
                if k != j:
                    below = times[m - 1 - j] - times[m - 1 - k]
                    weights[j] *= (times[m] - times[m - 1 - k]) / below if below else math.inf
        if sum(map(abs, weights)) <= 64.0:
            return weights
    return []


def no_constant(name: str) -> float:
    """Refuses NaN and Infinity, which are no JSON."""
    raise AssertionError(f"{name} in the data of a page")


class PageElements(HTMLParser):
    """The elements of a page: tag and attributes of each, and the text of title, style and scripts."""

    def __init__(self, page: str) -> None:
        super().__init__()
        self.found: list[tuple[str, dict[str, str | None]]] = []
        self.texts: list[tuple[str, str]] = []
        self.feed(page)
        self.close()

    def handle_starttag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        self.found.append((tag, dict(attrs)))
        if tag in ("title", "style", "script"):
            self.texts.append((tag, ""))

    def handle_data(self, data: str) -> None:
        if self.found and self.found[-1][0] in ("title", "style", "script"):
            tag, text = self.texts[-1]
            self.texts[-1] = tag, text + data

    def handle_endtag(self, tag: str) -> None:
        self.found.append((f"/{tag}", {}))

    def text(self, tag: str) -> list[str]:
        """The texts of the elements of a tag."""
        return [text for name, text in self.texts if name == tag]


def decoded(held: str) -> dict[str, Any]:
    """The data of a page from the text of its data block."""
    whole = zlib.decompress(base64.b64decode(held, validate=True))
    (length,) = struct.unpack("<I", whole[:4])
    columns = whole[4 + length :]

    def hook(found: dict[str, Any]) -> Any:
        return unpack(columns, found["packed"]) if list(found) == ["packed"] else found

    data: dict[str, Any] = json.loads(whole[4 : 4 + length], parse_constant=no_constant, object_hook=hook)
    return data


def data_of(page: str) -> dict[str, Any]:
    """The data of a page as a browser reads them."""
    return decoded(PageElements(page).text("script")[0])
