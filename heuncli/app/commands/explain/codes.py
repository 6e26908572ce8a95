"""What the manual's page on codes says of one: a row of its first table, or a section with an example."""

from __future__ import annotations

import re

SECTION = re.compile(r"^### (\S+)\n\n(.*?)(?=^### |\Z)", re.MULTILINE | re.DOTALL)
ROW = re.compile(r"^\| `([a-z0-9-]+)` \| (.*?) \| (.*?) \|$", re.MULTILINE)
LINK = re.compile(r"\[([^\]]*)\]\([^)]*\)")


def codes_of(page: str) -> dict[str, str]:
    """Every code with what is said of it."""
    rows = {code: f"{says}\n\nCure: {cure}\n" for code, says, cure in ROW.findall(page)}
    told = rows | dict(SECTION.findall(page))
    return {code: f"# {code}\n\n" + LINK.sub(r"\1", text) for code, text in told.items()}
