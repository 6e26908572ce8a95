"""`heun explain`: the pages of the manual, as they stand in the package."""

from __future__ import annotations

import ast
import os
import re
import subprocess
import sys
from pathlib import Path

import pytest

from heuncli.app.commands.explain.codes import parse_codes
from heuncli.app.commands.explain.command import PAGES
from heuncli.results.results_schema import NAMES, ROWS, Quantity
from tests.shared.command import Heun
from tests.shared.folders import ROOT
from tests.shared.manual import TEXTS

GIVERS = ("Problem", "Finding", "SpecError", "rule", "report", "problem")
CALLED = rf"\b({'|'.join(GIVERS)})\(\s*[\"']"  # with a word first
SOURCES = "".join(path.read_text() for path in sorted((ROOT / "heuncli").rglob("*.py")))


@pytest.mark.parametrize("topic", PAGES)
def test_a_page_is_printed_as_it_is_written(heun: Heun, topic: str) -> None:
    done = heun("explain", topic)
    assert (done.returncode, done.stdout, done.stderr) == (0, TEXTS[topic], "")


def test_without_a_topic_the_pages_are_listed(heun: Heun) -> None:
    done = heun("explain")
    assert (done.returncode, done.stderr) == (0, "")
    assert [line.split()[0] for line in done.stdout.split("\n\n")[0].splitlines()] == list(PAGES)
    assert [line.split()[0] for line in done.stdout.split("\n\n")[1].splitlines()] == ["CODE", "PATH", "NUMBER"]
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
        ("axes", "see heun explain signs (Joints) and heun explain commands (heun run, heun plot"),
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
    assert f"explain {topic}: there is no such manual page [bad-option]" in done.stderr
    assert told in done.stderr


def test_a_word_too_many_is_bad_usage(heun: Heun) -> None:
    assert heun("explain", "signs", "open").returncode == 2


def codes_in_the_text() -> set[str]:
    """Every code that the text of the package gives to an error or a warning."""
    found: set[str] = set()
    for path in (ROOT / "heuncli").rglob("*.py"):
        text = path.read_text()
        for node in ast.walk(ast.parse(text)) if re.search(CALLED, text) else ():
            if isinstance(node, ast.Call) and node.args:
                name = getattr(node.func, "id", getattr(node.func, "attr", ""))
                first = node.args[0]
                if name in GIVERS and isinstance(first, ast.Constant) and re.fullmatch(r"[a-z0-9-]+", str(first.value)):
                    found.add(str(first.value))
    return found


@pytest.mark.heavy
def test_every_code_is_explained(heun: Heun) -> None:
    """None is left out, and none is told of that is given nowhere."""
    codes = parse_codes(TEXTS["codes"])
    given = codes_in_the_text()
    assert {"bad-option", "not-golden", "unknown-case", "no-rest-pose", "time-limit", "bug"} <= given | codes.keys()
    assert given - codes.keys() == set()
    quoted = set(re.findall(r"[\"']([a-z0-9-]+)(?=[\"'])", SOURCES))
    assert codes.keys() - quoted == set(), "no such code any more"


def test_a_code_is_told_with_its_example_and_cure(heun: Heun) -> None:
    told = heun("explain", "unknown-joint").stdout
    assert told.startswith("# unknown-joint\n\nA torque in a joint that there is not.\n")
    assert "- pivott\n+ pivot\n" in told
    assert heun("explain", "[unknown-joint]").stdout == told
    done = heun("explain", "unknown-jiont")
    assert (done.returncode, "did you mean unknown-joint?" in done.stderr) == (2, True)


@pytest.mark.parametrize(
    "row", [row for row in ROWS if row.path.split(".")[0] not in ("model", "work")], ids=lambda row: row.path
)
def test_every_path_of_the_results_is_explained(heun: Heun, row: Quantity) -> None:
    path = ".".join(
        "0" if word == "NUMBER" else "a.b" if word == "POINT" else "abc" if word in NAMES else word
        for word in row.path.split(".")
    )
    if "." not in path:
        return
    told = heun("explain", path)
    assert told.returncode == 0
    assert told.stdout.startswith(f"{path}\nmeaning  ")
    assert all(unit in told.stdout for unit in row.units if unit != "1")


def test_a_path_that_leads_nowhere(heun: Heun) -> None:
    done = heun("explain", "joints.main.titling")
    assert (done.returncode, "heun explain joints.NAME lists" in done.stderr) == (2, True)
    assert "tilting" in heun("explain", "joints.main").stdout


def test_a_terminal_gets_pages_and_where_errors_are_explained(folder: Path) -> None:
    """A pipe gets the text as it is; a terminal a pager, and a line behind its errors."""
    env = {**os.environ, "PAGER": "sed s/^/paged:/", "TERM": "dumb"}
    assert "paged:" in on_a_terminal(["explain", "signs"], folder, env)
    assert "paged:" not in on_a_terminal(["explain", "signs", "--no-pager"], folder, env)
    assert "for details: heun explain unknown-key" in on_a_terminal(["run", "wrong.yaml"], folder, env).replace(
        "\r", ""
    )
    piped = subprocess.run(
        [sys.executable, "-m", "heuncli", "run", "wrong.yaml"], cwd=folder, capture_output=True, text=True
    )
    assert "for details" not in piped.stderr


def on_a_terminal(words: list[str], folder: Path, env: dict[str, str]) -> str:
    """What a command writes to a terminal of 24 lines."""
    pty = pytest.importorskip("pty")
    parent, child = pty.openpty()
    process = subprocess.Popen(
        [sys.executable, "-m", "heuncli", *words], cwd=folder, env=env, stdin=child, stdout=child, stderr=child
    )
    os.close(child)
    told = b""
    while True:
        try:
            part = os.read(parent, 65536)
        except OSError:  # the other side is closed
            break
        if not part:
            break
        told += part
    process.wait()
    os.close(parent)
    return told.decode()
