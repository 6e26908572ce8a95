"""Read error codes from the manual's page on codes: a row of its first table, or a section with an example."""

from __future__ import annotations

import re

SECTION = re.compile(r"^### (\S+)\n\n(.*?)(?=^### |\Z)", re.MULTILINE | re.DOTALL)
ROW = re.compile(r"^\| `([a-z0-9-]+)` \| (.*?) \| (.*?) \|$", re.MULTILINE)
LINK = re.compile(r"\[([^\]]*)\]\([^)]*\)")


def parse_codes(page: str) -> dict[str, str]:
    """Return every code with its explanation."""
    rows = {code: f"{says}\n\nRemedy: {cure}\n" for code, says, cure in ROW.findall(page)}
    texts = rows | dict(SECTION.findall(page))
    return {code: f"# {code}\n\n" + LINK.sub(r"\1", text) for code, text in texts.items()}
