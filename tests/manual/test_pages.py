"""The manual is whole: its list of pages, its links, and the names of all keys, units, functions and commands."""

from __future__ import annotations

import re
import signal

import pytest

from heuncli.app.cli.entry import EXIT_CODE_PRIORITY, INTERRUPTED
from heuncli.app.cli.registry import COMMANDS
from heuncli.app.commands.explain.pages import PAGES
from heuncli.base.files import ReaderGoneError
from heuncli.base.units import UNITS
from heuncli.scene.expressions.scope import ARITY, CONSTANTS
from heuncli.scene.file_format import format as document
from heuncli.scene.file_format.entries import Entry, keys_of
from tests.shared.manual import FENCED, README, ROOT, TEXTS, anchor, file_of, headings, tables_below

LINK = re.compile(r"\]\(([^()\s]+)\)")
LONGEST = 160  # lines of the README; what is longer belongs to a page


def test_every_page_is_listed() -> None:
    assert {README, *PAGES} == TEXTS.keys()


@pytest.mark.parametrize("name", PAGES)
def test_a_page_begins_with_its_title_and_what_it_is_about(name: str) -> None:
    title, empty, about, below, *_ = TEXTS[name].splitlines()
    assert re.fullmatch(r"# \S.*", title)
    assert (empty, below) == ("", "")
    assert re.fullmatch(r"\S.{10,110}\.", about)


def test_the_readme_is_short() -> None:
    assert len(TEXTS[README].splitlines()) <= LONGEST


@pytest.mark.parametrize("name", TEXTS)
def test_links_lead_somewhere(name: str) -> None:
    for target in LINK.findall(FENCED.sub("", TEXTS[name])):
        path, _, place = target.partition("#")
        file = (file_of(name).parent / path).resolve() if path else file_of(name)
        assert file.exists(), target
        if place:
            page = next(page for page in TEXTS if file_of(page) == file)
            assert place in map(anchor, headings(page)), target


@pytest.mark.parametrize("name", TEXTS)
def test_a_heading_stands_once_in_a_page(name: str) -> None:
    places = [anchor(heading) for heading in headings(name)]
    assert len(set(places)) == len(places)


@pytest.mark.parametrize("name", TEXTS)
def test_the_specs_that_are_named_exist(name: str) -> None:
    for spec in re.findall(r"\bspecs/[\w/]+\.\w+", TEXTS[name]):
        assert (ROOT / spec).exists(), spec


def keys() -> set[str]:
    models = [m for m in vars(document).values() if isinstance(m, type) and issubclass(m, Entry)]
    return {key for model in models for key in keys_of(model)}


def test_every_key_unit_function_and_command_is_named() -> None:
    text = " ".join(TEXTS.values())
    named = set(re.findall(r"[A-Za-z_]\w*", " ".join(re.findall(r"`([^`\n]+)`", text))))
    assert sorted(keys() - named) == []
    assert sorted(UNITS.keys() - named) == []
    assert sorted((ARITY.keys() | CONSTANTS.keys()) - named) == []
    assert all(f"heun {command.name}" in text for command in COMMANDS)


def test_the_exit_codes_are_listed() -> None:
    ended = {128 + signal.SIGHUP, 128 + signal.SIGTERM}
    (table,) = tables_below(TEXTS["commands"], "Exit codes")
    told = {int(code) for row in table.splitlines()[2:] for code in re.findall(r"\d+", row.split("|")[1])}
    assert told == {0, *EXIT_CODE_PRIORITY, INTERRUPTED, ReaderGoneError.exit_code} | ended


def test_the_index_names_the_headings_that_it_leads_to() -> None:
    links = re.findall(r"\[([^]]*)\]\(\w+\.md#([\w-]+)\)", TEXTS["index"])
    assert [text for text, place in links if anchor(text) != place] == []
