"""`heun explain`: the pages of the manual, as they stand in the package."""

from __future__ import annotations

import ast
import os
import re
import subprocess
import sys
from pathlib import Path

import pytest

from heuncli.app.commands.explain import pages
from heuncli.app.commands.explain.pages import MEANINGS, PAGES, find_section, parse_codes, read_sections
from heuncli.results.path_words import NAMES, find_node
from heuncli.results.results_schema import ROWS, Quantity
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
    assert [line.split()[0] for line in done.stdout.split("\n\n")[1].splitlines()] == [
        "SECTION", "WORD", "CODE", "PATH", "NUMBER",
    ]  # fmt: skip
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
    ("word", "begins", "also"),
    [
        ("stops", "## Stops\n", "format top level"),
        ("Stop", "## Stops\n", "format top level"),
        ("friction", "### friction\n", "accuracy smoothed friction"),
        ("hollow", "term     hollow shaft", "format properties"),
        ("hardpoint", "term     hardpoint", ""),
        ("bore", "term     bearing pressure, bore pressure", ""),
        ("rope", "## Rope\n", "format joints"),
        ("side", "## Sections\n", ""),
        ("force", "### force\n", "format forces"),
        ("spring", "### spring\n", "format turn_spring"),
        ("axes", "## Sensors\n", "commands heun run"),
        ("rpm", "### Units\n", "format expressions"),
        ("RK4", "## The list\n", ""),
        ("redundant supports", "# Open reactions\n", ""),
    ],
)
def test_a_word_shows_the_section_that_treats_it(heun: Heun, word: str, begins: str, also: str) -> None:
    done = heun("explain", word)
    assert (done.returncode, done.stderr) == (0, "")
    assert done.stdout.startswith(begins)
    assert "\nThis is from: heun explain " in done.stdout
    assert f'  heun explain "{also}"\n' in done.stdout if also else True


@pytest.mark.parametrize("word", ["stops", "friction", "hollow"])
def test_what_see_also_says_can_be_typed(heun: Heun, word: str) -> None:
    lines = heun("explain", word).stdout.partition("See also:\n")[2].splitlines()
    for line in lines:
        topic = line.removeprefix("  heun explain ").strip('"')
        assert heun("explain", topic).returncode == 0, topic


def test_the_term_of_an_engineer_is_translated(heun: Heun) -> None:
    told = heun("explain", "hardpoint").stdout.splitlines()
    assert told[0].startswith("term     hardpoint") and told[1].startswith("in heun  a named point: `points`")
    assert "## Bodies" in told


def test_a_word_of_the_results_shows_its_path(heun: Heun) -> None:
    assert heun("explain", "tilting").stdout.startswith("joints.JOINT.tilting\nmeaning   ")


@pytest.mark.parametrize("topic", ["format stops", "format#stops", "format Stops", "format sto"])
def test_a_section_is_shown_alone(heun: Heun, topic: str) -> None:
    done = heun("explain", topic)
    assert (done.returncode, done.stderr) == (0, "")
    assert done.stdout.startswith("## Stops\n") and "\n## " not in done.stdout
    assert done.stdout in TEXTS["format"]


@pytest.mark.parametrize("page", PAGES)
def test_each_section_is_found_by_its_request(page: str) -> None:
    for section in read_sections(page)[1:]:
        topic = section.request.removeprefix("heun explain ").strip('"')
        found = find_section(*topic.split(" ", 1))
        assert found is not None and found.heading == section.heading


@pytest.mark.parametrize(
    ("topic", "wrong", "hint"),
    [
        ("formt", 'there is no manual page "formt"', "did you mean: heun explain format?"),
        ("xyzzy", 'there is no manual page "xyzzy"', "heun explain lists the pages"),
        ("ladder", 'there is no manual page "ladder"', "The word occurs in: heun explain "),
        ("format stopps", 'the manual page "format" has no section "stopps"', 'heun explain "format stops"?'),
        ("methods xyzzy", 'the manual page "methods" has no section "xyzzy"', "its sections: auto, the list"),
    ],
)
def test_an_unknown_topic_is_reported(heun: Heun, topic: str, wrong: str, hint: str) -> None:
    done = heun("explain", topic)
    assert (done.returncode, done.stdout) == (2, "")
    assert f"heun: {wrong} [bad-option]\n  hint: " in done.stderr
    assert hint in done.stderr


def test_a_page_is_found_in_any_case(heun: Heun) -> None:
    assert heun("explain", "Modes").stdout == TEXTS["modes"]


def test_a_code_that_is_also_a_word_leads_to_its_sections(heun: Heun) -> None:
    told = heun("explain", "motor").stdout
    assert told.startswith("# motor\n") and '  heun explain "format motor"\n' in told
    assert told.startswith(heun("explain", "[motor]").stdout)


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
    assert told.startswith("# unknown-joint\n\nThere is no joint of this name.\n")
    assert "joint: pivott, value: 3}\n    + motor: {type: torque, joint: pivot, value: 3}\n" in told
    assert heun("explain", "[unknown-joint]").stdout == told
    done = heun("explain", "unknown-jiont")
    assert (done.returncode, "did you mean: heun explain unknown-joint?" in done.stderr) == (2, True)


@pytest.mark.parametrize(
    "row", [row for row in ROWS if row.path.split(".")[0] not in ("model", "work")], ids=lambda row: row.path
)
@pytest.mark.third
def test_every_path_of_the_results_is_explained(heun: Heun, row: Quantity) -> None:
    path = ".".join(
        "0" if word == "NUMBER" else "a.b" if word == "POINT" else "abc" if word in NAMES else word
        for word in row.path.split(".")
    )
    if "." not in path:
        return
    told = heun("explain", path)
    assert told.returncode == 0
    assert told.stdout.startswith(f"{path}\nmeaning   ")
    assert all(unit in told.stdout for unit in row.units if unit != "1")


@pytest.mark.parametrize(
    ("path", "hint"),
    [
        ("joints.main.titling", "did you mean heun explain joints.main.tilting?"),
        ("energy.kin", "energy has kinetic, potential, work"),
        ("foundation.total", "foundation has about, force, moment, axis"),
        ("joints.main.tilting.x", "the path ends before: heun explain joints.main.tilting"),
    ],
)
def test_a_path_that_leads_nowhere(heun: Heun, path: str, hint: str) -> None:
    done = heun("explain", path)
    assert (done.returncode, done.stdout) == (2, "")
    assert f"explain {path}: there is no such result [unknown-path]" in done.stderr and hint in done.stderr


def test_a_block_lists_its_quantities(heun: Heun) -> None:
    assert "tilting" in heun("explain", "joints.main").stdout


def test_quantities_of_one_row_have_their_own_meanings(heun: Heun) -> None:
    assert set(MEANINGS) <= {row.path for row in ROWS}
    assert "moment perpendicular to the joint axis" in heun("explain", "joints.main.tilting").stdout
    assert "force along the joint's axis" in heun("explain", "joints.main.axial").stdout
    assert "bending moment about e2" in heun("explain", "sections.boom.M2@0.28").stdout


@pytest.mark.heavy
def test_a_terminal_gets_pages_and_where_errors_are_explained(folder: Path) -> None:
    """A pipe gets the text as it is; a terminal a pager, and a line behind its errors."""
    env = {**os.environ, "PAGER": "sed s/^/paged:/", "TERM": "dumb"}
    assert "paged:" in on_a_terminal(["explain", "signs"], folder, env)
    assert "paged:" not in on_a_terminal(["explain", "signs", "--no-pager"], folder, env)
    assert on_a_terminal(["explain", "signs"], folder, env).startswith("paged:Sections of this page; heun explain ")
    told = on_a_terminal(["run", "wrong.yaml"], folder, env).replace("\r", "")
    assert "for details: heun explain unknown-key" in told
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


def test_only_the_unit_1_is_none(monkeypatch: pytest.MonkeyPatch) -> None:
    row = next(node for node in find_node(("joints", "JOINT")).values() if isinstance(node, Quantity))  # type: ignore[union-attr]
    told = dict(pages._describe_quantity("joints.j.x", ["joints", "j", "x"], row._replace(units=("1", "1/s"))))
    assert told["unit"].startswith("none or 1/s")
