"""`heun explain`: the pages of the manual, as they stand in the package."""

from __future__ import annotations

from pathlib import Path

import pytest

from heuncli.commands.explain.command import PAGES
from tests.shared.command import Heun
from tests.shared.manual import TEXTS


@pytest.mark.parametrize("topic", PAGES)
def test_a_page_is_printed_as_it_is_written(heun: Heun, topic: str) -> None:
    done = heun("explain", topic)
    assert (done.returncode, done.stdout, done.stderr) == (0, TEXTS[topic], "")


def test_without_a_topic_the_pages_are_listed(heun: Heun) -> None:
    done = heun("explain")
    assert (done.returncode, done.stderr) == (0, "")
    assert [line.split()[0] for line in done.stdout.splitlines()] == list(PAGES)
    assert max(map(len, done.stdout.splitlines())) <= 120


@pytest.mark.parametrize("number", ["31", "(31)"])
def test_a_number_leads_to_its_equation(heun: Heun, number: str) -> None:
    told = heun("explain", number).stdout.splitlines()
    assert told[0].split(maxsplit=1) == ["equation", "(31), (32)"]
    assert [line.split()[0] for line in told] == ["equation", "says", "seen", "code", "tests"]
    assert "`heun lagrange`: `momenta`" in told[2]


def test_a_number_of_no_equation(heun: Heun) -> None:
    done = heun("explain", "62")
    assert done.returncode == 2 and "(16) to (61)" in done.stderr


def test_a_page_goes_into_a_file(heun: Heun, tmp_path: Path) -> None:
    done = heun("explain", "signs", "-o", str(tmp_path / "signs.md"))
    assert (done.returncode, done.stdout) == (0, "")
    assert (tmp_path / "signs.md").read_text(encoding="utf-8") == TEXTS["signs"]


@pytest.mark.parametrize(
    ("topic", "told"),
    [
        ("side", "see heun explain format (Sections)"),
        ("rope", "see heun explain howto (Rope) and heun explain format (Joints)"),
        ("spring", "see heun explain format (turn_spring, spring)"),
        ("axes", "see heun explain signs (Joints) and heun explain commands (heun run)"),
        ("tilting", "see heun explain results (Paths)"),
        ("rpm", "see heun explain format (Units, Expressions)"),
        ("RK4", "see heun explain methods (The list)"),
        ("formt", "did you mean format?"),
        ("Modes", "did you mean modes?"),
        ("xyzzy", "known topics: commands, format"),
    ],
)
def test_an_unknown_topic_is_told(heun: Heun, topic: str, told: str) -> None:
    done = heun("explain", topic)
    assert (done.returncode, done.stdout) == (2, "")
    assert f"explain {topic}: no page of the manual is called that [bad-option]" in done.stderr
    assert told in done.stderr


def test_a_word_too_many_is_bad_usage(heun: Heun) -> None:
    assert heun("explain", "signs", "open").returncode == 2
