"""The files of a page: small, all of them packed with the package, their scripts one whole that the policy lets run."""

from __future__ import annotations

import base64
import hashlib
import re
import tomllib
from fnmatch import fnmatch
from pathlib import Path

import pytest

from heuncli.output.web_page import moving_page
from heuncli.output.web_page.moving_page import (
    EXPORT,
    FOLDER,
    IMPORT,
    assemble_page,
    bundle_scripts,
    make_security_policy,
    read_page_file,
    sort_scripts,
)
from tests.shared.folders import ROOT
from tests.shared.moving_pages import PageElements

SCRIPTS = sorted(path.stem for path in FOLDER.glob("*.js") if path.stem != "types")  # which holds comments alone
MOST_BYTES = 150_000
MOST_LINES, WIDTH = 300, 120


def digest(text: str) -> str:
    """As a policy tells it."""
    return "'sha256-" + base64.b64encode(hashlib.sha256(text.encode()).digest()).decode() + "'"


def test_a_page_without_data_is_small() -> None:
    assert len(assemble_page("", {}).encode()) <= MOST_BYTES


def test_wheels_carry_all_of_its_files() -> None:
    project = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))
    packed = project["tool"]["setuptools"]["package-data"]["heuncli"]
    files = [path for path in FOLDER.iterdir() if path.is_file() and path.suffix != ".py"]
    assert len(files) > 10
    assert not [
        path.name for path in files if not any(fnmatch(f"output/web_page/{path.name}", form) for form in packed)
    ]


def test_every_script_is_used_once_and_after_what_it_needs() -> None:
    orders = [sort_scripts(main) for main in moving_page.TEMPLATES]
    assert sorted(set().union(*orders)) == SCRIPTS
    for main, order in zip(moving_page.TEMPLATES, orders, strict=True):
        assert order[-1] == main and len(set(order)) == len(order)
        for place, name in enumerate(order):
            needed = {found[2] for found in IMPORT.finditer(read_page_file(f"{name}.js"))}
            assert needed <= set(order[:place])


def test_the_page_is_without_what_draws_films() -> None:
    assert {"gif", "film"} & set(sort_scripts()) == set()


@pytest.mark.parametrize("name", SCRIPTS)
def test_a_script_imports_what_is_exported(name: str) -> None:
    text = read_page_file(f"{name}.js")
    for found in IMPORT.finditer(text):
        exported = {other[2] for other in EXPORT.finditer(read_page_file(f"{found[2]}.js"))}
        wanted = set(re.findall(r"\w+", found[1]))
        assert wanted <= exported, found[2]
        body = IMPORT.sub("", text)
        assert not [word for word in wanted if not re.search(rf"\b{word}\b", body)], "imported and not used"


@pytest.mark.parametrize("name", SCRIPTS)
def test_a_script_tells_what_it_is_and_fetches_and_interprets_nothing(name: str) -> None:
    text = read_page_file(f"{name}.js")
    lines = text.splitlines()
    assert lines[0].startswith("/** @file ") and len(lines) <= MOST_LINES and max(map(len, lines)) <= WIDTH
    forbidden = ("innerHTML", "outerHTML", "insertAdjacentHTML", "document.write", "eval(", "fetch(", "http", "await ",
                 "XMLHttpRequest", "localStorage", "console.", "</")  # fmt: skip
    assert not [word for word in forbidden if word in text]


def test_the_policy_lets_run_what_stands_in_the_page_and_nothing_else() -> None:
    page = assemble_page("a title", {"a": 1})
    elements = PageElements(page)
    (style,), scripts = elements.text("style"), elements.text("script")
    assert len(scripts) == 2 and scripts[1] == bundle_scripts()
    said = next(found["content"] for tag, found in elements.found if found.get("http-equiv"))
    assert said == make_security_policy() and said is not None
    rules = dict(rule.strip().split(" ", 1) for rule in said.split(";"))
    assert rules["default-src"] == "'none'"
    assert rules["script-src"] == digest(scripts[1]) and rules["style-src"] == digest(style)


def test_no_element_loads_anything() -> None:
    elements = PageElements(assemble_page("", {})).found
    assert not [tag for tag, given in elements if "src" in given or any(key.startswith("on") for key in given)]
    assert [given["href"] for _, given in elements if "href" in given] == ["data:,", "#about"]


def test_every_control_has_a_name() -> None:
    """A button its text or aria-label; an input or select its label around it; all else that is worked aria-label."""
    page = read_page_file("machine.html")
    for tag, given in re.findall(r"<(input|select)\b([^>]*)>", page):
        name = re.search(r'id="([\w-]+)"', given)
        assert name is not None, given
        assert re.search(rf'<label[^>]*>(?:(?!</label>).)*id="{name[1]}"', page, re.DOTALL), f"{tag} {name[1]}"
    for given, text in re.findall(r"<button\b([^>]*)>([^<]*)</button>", page):
        assert "aria-label" in given or text.strip()
        assert 'type="button"' in given
    for given in re.findall(r"<canvas\b([^>]*)>", page):
        assert "aria-label=" in given and "role=" in given


def test_the_ids_that_scripts_look_for_are_there() -> None:
    there = re.findall(r'\bid="([\w-]+)"', read_page_file("machine.html"))
    assert len(there) == len(set(there))
    asked = {
        found
        for name in sort_scripts()
        for found in re.findall(r'\bfindElement\("([\w-]+)"\)', read_page_file(f"{name}.js"))
    }
    assert asked and asked <= set(there)


def test_the_folder_holds_nothing_else() -> None:
    known = {".py", ".js", ".css", ".html"}
    assert {path.suffix for path in Path(FOLDER).iterdir() if path.is_file()} == known
