"""Texts of the project that tests read: docstrings and comments of all sources, sections of the manual."""

from __future__ import annotations

import ast
import re
from collections.abc import Iterator
from functools import cache
from pathlib import Path
from typing import NamedTuple

from tests.shared.folders import ROOT

PACKAGE, TESTS, MANUAL = ROOT / "heuncli", ROOT / "tests", ROOT / "heuncli" / "manual"
SOURCES = sorted([*PACKAGE.rglob("*.py"), *TESTS.rglob("*.py")])
COMMENT = re.compile(r"(?:^|\s)#:?\s+(.*)$")


class Text(NamedTuple):
    """A docstring or a block of comments as one line; where it begins."""

    path: Path
    line: int
    text: str

    @property
    def place(self) -> str:
        return f"{self.path.relative_to(ROOT)}:{self.line}"


def tree(path: Path) -> ast.Module:
    """Not kept: a thousand trees would be searched for garbage again and again."""
    return ast.parse(path.read_text(encoding="utf-8"))


Scope = ast.Module | ast.ClassDef | ast.FunctionDef


def scopes(node: ast.AST) -> Iterator[Scope]:
    """A module with its classes and functions, whatever they stand in; expressions are not looked into."""
    if isinstance(node, Scope):
        yield node
    for part in ("body", "orelse", "handlers", "finalbody"):
        for inner in getattr(node, part, ()) if isinstance(getattr(node, part, ()), list) else ():
            yield from scopes(inner)


def docstrings(path: Path) -> Iterator[Text]:
    for node in scopes(tree(path)):
        text = ast.get_docstring(node)
        if text:
            yield Text(path, getattr(node, "lineno", 1), " ".join(text.split()))


def comments(path: Path) -> Iterator[Text]:
    """Comments on lines that follow each other are one; what stands behind # in a string is read along."""
    block: list[tuple[int, str]] = []
    for line, text in enumerate(path.read_text(encoding="utf-8").splitlines(), start=1):
        found = COMMENT.search(text)
        if found is None:
            continue
        if block and line != block[-1][0] + 1:
            yield Text(path, block[0][0], " ".join(part for _, part in block))
            block = []
        block.append((line, found[1]))
    if block:
        yield Text(path, block[0][0], " ".join(part for _, part in block))


@cache
def texts() -> tuple[Text, ...]:
    """All docstrings and comments."""
    return tuple(text for path in SOURCES for part in (docstrings, comments) for text in part(path))


def page_section(page: str, title: str) -> str:
    """The text below a title, up to the next."""
    text = (MANUAL / f"{page}.md").read_text(encoding="utf-8")
    return text.split(f"\n## {title}\n", 1)[1].split("\n## ", 1)[0]


@cache
def equations() -> dict[str, list[list[str]]]:
    """The rows of the page on equations, (equation, says, seen, code, tests) each, by their headings."""
    text = (MANUAL / "equations.md").read_text(encoding="utf-8")
    headings = re.findall(r"^## (.*)$", text, re.MULTILINE)
    return {heading: cells(page_section("equations", heading)) for heading in headings}


def cells(section: str) -> list[list[str]]:
    """The rows of a section's last table, without its head; a bar within a cell is written \\|."""
    rows = [line.strip()[1:-1] for line in section.splitlines() if line.startswith("|")]
    return [[cell.strip() for cell in re.split(r"(?<!\\)\|", row)] for row in rows[2:]]
