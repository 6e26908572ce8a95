"""Claims that are checked: what comments, docstrings and the manual cite exists, and every equation has code and tests.

Sources are read as text, so that a claim about a file that nobody runs is checked, too.
"""

from __future__ import annotations

import ast
import re
from collections.abc import Iterator
from functools import cache
from pathlib import Path
from typing import NamedTuple

import pytest

from heuncli.cli.options import fields_of
from heuncli.cli.registry import command_of
from heuncli.results_schema import quantity
from tests.shared.folders import ROOT

PACKAGE, TESTS, MANUAL = ROOT / "heuncli", ROOT / "tests", ROOT / "heuncli" / "manual"
SOURCES = sorted([*PACKAGE.rglob("*.py"), *TESTS.rglob("*.py")])
PAGES = sorted(MANUAL.glob("*.md"))
READMES = [ROOT / "README.md", *sorted(TESTS.rglob("README.md"))]

NUMBER = re.compile(r"\((1[6-9]|[2-5]\d|6[01])\)")  # of an equation of the paper
COMMENT = re.compile(r"(?:^|\s)#:?\s+(.*)$")
WORD = re.compile(r"[\w./-]+")
SECTION = re.compile(r'manual/(\w+)\.md(?:, "([^"]+)")?')
STANDS_FOR = re.compile(r"\b(?!README)[A-Z]+\.(?:py|md)$")
CASE = re.compile(r'"Closed cases" (\d+(?:, \d+)*)')

NOT_YET: frozenset[int] = frozenset()  # equations that no result has: a row leaves this set when its code comes
IDENTITIES = frozenset({19, *range(22, 29), 41})


class Text(NamedTuple):
    """A docstring or a block of comments as one line; where it begins."""

    path: Path
    line: int
    text: str

    @property
    def place(self) -> str:
        return f"{self.path.relative_to(ROOT)}:{self.line}"


@cache
def tree(path: Path) -> ast.Module:
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


@cache
def names() -> frozenset[str]:
    """Of all sources: one may be cited by its name alone."""
    return frozenset(path.name for path in SOURCES)


@cache
def folders() -> frozenset[str]:
    """Names with which a path of the project begins."""
    inner = {path.relative_to(base).parts[0] for base in (PACKAGE, TESTS) for path in base.glob("*/*.*")}
    return frozenset({"heuncli", "tests", "specs", *inner})


def there(cited: str, beside: Path) -> bool:
    """Whether a cited path exists, from the project's, the package's or the tests' folder, or from the text's own.

    A module may be cited without its ending; a header of the kernel is made from its module. PAGE.md stands for any.
    """
    if STANDS_FOR.search(cited):
        return True
    name = cited.removesuffix(".pxd")
    if cited in names() or f"{name}.py" in names():
        return True
    bases = [ROOT, PACKAGE, TESTS, PACKAGE / "kernel", beside.parent, beside.parents[1]]
    return any((base / cited).exists() or (base / f"{name}.py").exists() for base in bases)


def files(text: Text) -> Iterator[str]:
    """The words of a text that are files or folders of the project."""
    for word in WORD.findall(text.text):
        cited = word.strip("./-")
        if cited.endswith((".py", ".md", ".pxd")) or ("/" in cited and cited.split("/")[0] in folders()):
            yield cited


def test_every_file_cited_is_there() -> None:
    missing = [f"{text.place}: {cited}" for text in texts() for cited in files(text) if not there(cited, text.path)]
    assert not missing, "\n".join(missing)


@cache
def sections(page: str) -> frozenset[str]:
    """The titles on a page of the manual."""
    lines = (MANUAL / f"{page}.md").read_text(encoding="utf-8").splitlines()
    return frozenset(line.lstrip("# ") for line in lines if line.startswith("#"))


def test_every_section_of_the_manual_cited_is_there() -> None:
    missing = []
    for text in texts():
        for page, section in SECTION.findall(text.text):
            known = page.isupper() or (MANUAL / f"{page}.md").exists()
            if not known or (section and section not in sections(page)):
                missing.append(f'{text.place}: manual/{page}.md, "{section}"')
    assert not missing, "\n".join(missing)


def test_every_closed_case_cited_is_there() -> None:
    known = set(re.findall(r"^(\d+)\. \*\*", page_section("theory", "Closed cases"), re.MULTILINE))
    cited = {(text.place, n) for text in texts() for found in CASE.findall(text.text) for n in found.split(", ")}
    assert len(cited) > 20 and not {(place, n) for place, n in cited if n not in known}


def page_section(page: str, title: str) -> str:
    """The text below a title, up to the next."""
    text = (MANUAL / f"{page}.md").read_text(encoding="utf-8")
    return text.split(f"\n## {title}\n", 1)[1].split("\n## ", 1)[0]


@pytest.mark.parametrize("page", [*PAGES, *READMES], ids=lambda page: str(page.relative_to(ROOT)))
def test_what_a_page_of_the_manual_cites_is_there(page: Path) -> None:
    """Files of the project; links between pages are looked at in tests/manual."""
    cited = re.findall(r"\b(?:heuncli|tests|specs)/[\w./-]*\w", page.read_text(encoding="utf-8"))
    assert not [path for path in cited if not (ROOT / path).exists()]


NO_JOINT = frozenset({"15.704062651007572"})  # the bead on a parabola: a curve is no joint yet


def test_the_digits_of_closed_cases_are_compared() -> None:
    """Every long number there stands in a test, or in what a spec expects."""
    told = set(re.findall(r"\d*\.\d{8,}", page_section("theory", "Closed cases")))
    read = "".join(path.read_text(encoding="utf-8") for path in [*TESTS.rglob("*.py"), *ROOT.glob("specs/*.yaml")])
    assert len(told) > 80 and {n for n in told if n.lstrip("0") not in read} <= NO_JOINT


# Equations


class Row(NamedTuple):
    """A row of the index: its numbers, how it is seen, what stands in place of code, functions and tests."""

    numbers: tuple[int, ...]
    seen: str
    instead: str
    code: tuple[tuple[Path, str], ...]
    tests: tuple[tuple[Path, str], ...]


def cells(section: str) -> list[list[str]]:
    """The rows of a section's last table, without its head; a bar within a cell is written \\|."""
    rows = [line.strip()[1:-1] for line in section.splitlines() if line.startswith("|")]
    return [[cell.strip() for cell in re.split(r"(?<!\\)\|", row)] for row in rows[2:]]


def named(cell: str, base: Path) -> tuple[tuple[Path, str], ...]:
    """What is cited as `path: name`."""
    return tuple((base / path, name) for path, name in re.findall(r"`([\w./]+): (\w+)`", cell))


@cache
def index() -> tuple[Row, ...]:
    rows = []
    for equation, _, seen, code, tests in cells(page_section("equations", "Index of equations")):
        numbers = tuple(int(n) for n in NUMBER.findall(equation))
        rows.append(Row(numbers, seen, "" if "`" in code else code, named(code, PACKAGE), named(tests, TESTS)))
    return tuple(rows)


@cache
def functions(path: Path) -> frozenset[str]:
    return frozenset(node.name for node in scopes(tree(path)) if isinstance(node, ast.FunctionDef))


def test_every_number_of_the_paper_has_one_row() -> None:
    assert sorted(n for row in index() for n in row.numbers) == list(range(16, 62))


@pytest.mark.parametrize("row", index(), ids=lambda row: "-".join(map(str, row.numbers)))
def test_an_equation_names_a_function_and_a_test(row: Row) -> None:
    if row.instead:
        assert set(row.numbers) <= {"not yet": NOT_YET, "identity": IDENTITIES}[row.instead]
    else:
        assert row.code and not set(row.numbers) & (NOT_YET | IDENTITIES)
    assert row.tests and all(name.startswith("test_") for _, name in row.tests)
    for path, name in (*row.code, *row.tests):
        assert path.exists() and name in functions(path), f"{path.relative_to(ROOT)}: {name}"


@pytest.mark.parametrize("row", index(), ids=lambda row: "-".join(map(str, row.numbers)))
def test_an_equation_is_seen_where_the_index_says(row: Row) -> None:
    """By paths into the results, which the schema has, and by commands with options that there are."""
    places = re.findall(r"`([^`]+)`", row.seen)
    if not places:
        assert row.seen == {"identity": "in the others", "not yet": "not yet"}[row.instead]
    for place in places:
        program, *words = place.split()
        if program == "heun":
            command = command_of(words[0])
            assert command is not None, place
            assert {*words[1:]} <= {word for field in fields_of(command.request) for word in field.option.words}, place
        else:
            found = quantity(place.split("."))
            assert found is not None and found.path == place, place


def test_every_number_cited_in_the_code_leads_there() -> None:
    """A function or module that says which equation it is stands in that equation's row."""
    places = {n: {path for path, _ in row.code} for row in index() for n in row.numbers}
    strays = {
        f"{text.place}: ({n})"
        for text in texts() if PACKAGE in text.path.parents
        for n in NUMBER.findall(text.text) if text.path not in places[int(n)]
    }  # fmt: skip
    assert not strays


def test_the_errata_of_the_manual_are_those_tried() -> None:
    """Rows that tell by how much the printed form is off, word for word; the others are slips of letters."""
    tried = set(re.findall(r'^@erratum\("(.*)"\)$', (TESTS / "laws/test_errata.py").read_text(), re.MULTILINE))
    rows = cells(page_section("theory", "Errata"))
    assert {where for where, _, _, off in rows if re.fullmatch(r"[\d.]+", off)} == tried
    assert len(rows) > len(tried)


# Sizes

MOST_LINES, MOST_LINES_OF_A_FILE = 60, 600
# Files that may be longer, with the reason.
LONG_FILES = {
    "heuncli/kernel/enclosure.py": "calls across compiled modules are not inlined: to be parted when that is measured",
}


def test_functions_fit_on_a_screen() -> None:
    long = {
        f"{path.relative_to(ROOT)}: {node.name}"
        for path in PACKAGE.rglob("*.py")
        for node in scopes(tree(path))
        if isinstance(node, ast.FunctionDef) and (node.end_lineno or 0) - node.lineno >= MOST_LINES
    }
    assert not long


def test_files_are_read_in_one_sitting() -> None:
    sizes = {str(path.relative_to(ROOT)): len(path.read_text().splitlines()) for path in PACKAGE.rglob("*.py")}
    assert {path for path, size in sizes.items() if size > MOST_LINES_OF_A_FILE} == set(LONG_FILES)
