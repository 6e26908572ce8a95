"""Headings of columns, with a unit behind the name or without: n [rpm], L/mm, case."""

from __future__ import annotations

import re

HEAD = re.compile(r"(?P<name>[^\[\]/]*?)\s*(?:\[(?P<in>[^\[\]]*)\]|/(?P<over>.*))?\Z", re.DOTALL)


def heading(text: str) -> tuple[str, str]:
    """The name and the unit of a column; empty where there is none."""
    parts = HEAD.match(text)
    if parts is None:
        return "", ""
    return parts["name"].strip(), (parts["in"] or parts["over"] or "").strip()
