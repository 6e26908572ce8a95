"""What the manual's page on the format says of each key: unit, default, meaning, by its chapter. Impure: reads it."""

from __future__ import annotations

import re
from collections.abc import Iterator
from pathlib import Path

from heuncli.base.named_tuples import NamedTuple

PAGE = Path(__file__).parents[2] / "manual" / "format.md"
HEADING = re.compile(r"^#+ (.+)$", re.MULTILINE)
LINK = re.compile(r"\[([^\]]*)\]\([^)]*\)")


class KeyRow(NamedTuple):
    """A row of a chapter: the keys, the types that have them (none: all), unit, default and meaning."""

    keys: tuple[str, ...]
    of: tuple[str, ...]
    unit: str
    default: str
    meaning: str

    @property
    def description(self) -> str:
        """All of it in a line."""
        parts = [plain(self.meaning)]
        parts += [f"[{plain(self.unit)}]"] if self.unit else []
        parts += [f"default: {plain(self.default)}"] if self.default not in ("", "required", "none") else []
        return "; ".join(part for part in parts if part)


def rows_by_chapter() -> dict[str, list[KeyRow]]:
    """The rows of the tables of keys, by the headings above them."""
    text = PAGE.read_text(encoding="utf-8")
    _, *parts = HEADING.split(text)
    return {heading: [*_rows(body)] for heading, body in zip(parts[::2], parts[1::2], strict=True)}


def _rows(body: str) -> Iterator[KeyRow]:
    """The rows of the first table of keys."""
    heads: list[str] = []
    for line in body.splitlines():
        cells = [cell.strip().replace("\\|", "|") for cell in re.split(r"(?<!\\)\|", line)[1:-1]]
        if cells[:1] == ["key"]:
            heads = cells
        elif heads and not cells:
            return
        elif heads and not set(line) <= set("|-"):
            row = dict(zip(heads, cells, strict=True))
            of = () if row.get("of", "all") == "all" else words(row["of"])
            yield KeyRow(words(row["key"]), of, row.get("unit", ""), row.get("default", ""), row.get("meaning", ""))


def words(cell: str) -> tuple[str, ...]:
    """What stands as code in a cell."""
    return tuple(re.findall(r"`([^`]*)`", cell))


def plain(cell: str) -> str:
    """A cell without marks of the manual."""
    return LINK.sub(r"\1", cell).replace("`", "")
