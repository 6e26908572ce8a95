"""Pages of `heun show` read back without a browser: their data, what is packed in them, their elements."""

from __future__ import annotations

import base64
import json
from html.parser import HTMLParser
from typing import Any

import numpy as np

from heuncli.results.results import Array


def unpacked(packed: str | float, count: int) -> Array:
    """The numbers of a packed array, (count,): float64, least significant byte first."""
    if isinstance(packed, str):
        return np.frombuffer(base64.b64decode(packed, validate=True), dtype="<f8").copy()
    return np.full(count, float(packed))


def places(packed: str) -> Array:
    """The numbers of an array of places: float32."""
    return np.frombuffer(base64.b64decode(packed, validate=True), dtype="<f4").astype(np.float64)


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


def data_of(page: str) -> dict[str, Any]:
    """The data of a page as a browser reads them."""
    elements = PageElements(page)
    found: dict[str, Any] = json.loads(elements.text("script")[0], parse_constant=no_constant)
    return found
