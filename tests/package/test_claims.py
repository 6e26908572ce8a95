"""Claims that are checked: what comments, docstrings and the manual cite exists.

Read as text: nothing is imported, so that a claim about a file that nobody runs is checked, too.
"""

from __future__ import annotations

import ast
import re
from collections.abc import Iterator
from functools import cache
from pathlib import Path

import pytest

from tests.shared.cited_texts import MANUAL, PACKAGE, SOURCES, TESTS, Text, cells, page_section, scopes, texts, tree
from tests.shared.folders import ROOT

pytestmark = pytest.mark.heavy  # texts alone, which are those of both kernels

PAGES = sorted(MANUAL.glob("*.md"))
READMES = [ROOT / "README.md", *sorted(TESTS.rglob("README.md"))]

WORD = re.compile(r"[\w./-]+")
SECTION = re.compile(r'manual/(\w+)\.md(?:, "([^"]+)")?')
STANDS_FOR = re.compile(r"\b(?!README)[A-Z]+\.(?:py|md)$")
CASE = re.compile(r'"Closed cases" (\d+(?:, \d+)*)')


@cache
def names() -> frozenset[str]:
    """Of all sources: one may be cited by its name alone."""
    return frozenset(path.name for path in SOURCES)


@cache
def folders() -> frozenset[str]:
    """Names with which a path of the project begins."""
    inner = {path.relative_to(base).parts[0] for base in (PACKAGE, TESTS) for path in base.glob("*/*.*")}
    return frozenset({"heuncli", "tests", "specs", *inner})


@cache
def there(cited: str, beside: Path) -> bool:
    """Whether a cited path exists, from the project's, the package's or the tests' folder, or from the text's own.

    A module may be cited without its ending; a header of the kernel is made from its module. PAGE.md stands for any.
    """
    if STANDS_FOR.search(cited):
        return True
    name = cited.removesuffix(".pxd")
    if cited == "compiled.pxd":  # which the build makes of all modules
        return True
    if cited in names() or f"{name}.py" in names():
        return True
    bases = [ROOT, PACKAGE, TESTS, PACKAGE / "kernel", beside, beside.parent]
    return any((base / cited).exists() or (base / f"{name}.py").exists() for base in bases)


def files(text: Text) -> Iterator[str]:
    """The words of a text that are files or folders of the project."""
    for word in WORD.findall(text.text):
        cited = word.strip("./-")
        if cited.endswith((".py", ".md", ".pxd")) or ("/" in cited and cited.split("/")[0] in folders()):
            yield cited


def test_every_file_cited_is_there() -> None:
    missing = [
        f"{text.place}: {cited}" for text in texts() for cited in files(text) if not there(cited, text.path.parent)
    ]
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


# Errata


def test_the_errata_of_the_manual_are_those_tried() -> None:
    """Rows that tell by how much the printed form is off, word for word; the others are slips of letters."""
    tried = set(re.findall(r'^@erratum\("(.*)"\)$', (TESTS / "laws/test_errata.py").read_text(), re.MULTILINE))
    rows = cells(page_section("theory", "Errata"))
    assert {where for where, _, _, off in rows if re.fullmatch(r"[\d.]+", off)} == tried
    assert len(rows) > len(tried)


# Sizes

MOST_LINES, MOST_LINES_OF_A_FILE = 60, 600


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
    assert not {path for path, size in sizes.items() if size > MOST_LINES_OF_A_FILE}
