"""Read the manual's page on the format: unit, default and meaning of each key, by chapter. Impure: reads the page."""

from __future__ import annotations

import re
from collections.abc import Iterator
from pathlib import Path

from heuncli.base.named_tuples import NamedTuple

PAGE = Path(__file__).parents[2] / "manual" / "format.md"
HEADING = re.compile(r"^#+ (.+)$", re.MULTILINE)
LINK = re.compile(r"\[([^\]]*)\]\([^)]*\)")


class KeyRow(NamedTuple):
    """A row of a chapter's table: the keys, the types that have them (empty: all), unit, default and meaning."""

    keys: tuple[str, ...]
    types: tuple[str, ...]
    unit: str
    default: str
    meaning: str

    @property
    def description(self) -> str:
        """Meaning, unit and default in one line."""
        parts = [strip_markup(self.meaning)]
        parts += [f"[{strip_markup(self.unit)}]"] if self.unit else []
        parts += [f"default: {strip_markup(self.default)}"] if self.default not in ("", "required", "none") else []
        return "; ".join(part for part in parts if part)


def read_rows_by_chapter() -> dict[str, list[KeyRow]]:
    """Read the rows of the key tables, by the heading above each table."""
    text = PAGE.read_text(encoding="utf-8")
    _, *parts = HEADING.split(text)
    return {heading: [*_iter_rows(body)] for heading, body in zip(parts[::2], parts[1::2], strict=True)}


def _iter_rows(body: str) -> Iterator[KeyRow]:
    """Yield the rows of the first key table."""
    heads: list[str] = []
    for line in body.splitlines():
        cells = [cell.strip().replace("\\|", "|") for cell in re.split(r"(?<!\\)\|", line)[1:-1]]
        if cells[:1] == ["key"]:
            heads = cells
        elif heads and not cells:
            return
        elif heads and not set(line) <= set("|-"):
            row = dict(zip(heads, cells, strict=True))
            types = () if row.get("of", "all") == "all" else find_code_words(row["of"])
            yield KeyRow(
                find_code_words(row["key"]), types, row.get("unit", ""), row.get("default", ""), row.get("meaning", "")
            )


def find_code_words(cell: str) -> tuple[str, ...]:
    """Return the words in a cell that are marked as code."""
    return tuple(re.findall(r"`([^`]*)`", cell))


def strip_markup(cell: str) -> str:
    """Return a cell without markup."""
    return LINK.sub(r"\1", cell).replace("`", "")
