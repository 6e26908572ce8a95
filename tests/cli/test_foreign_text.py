"""What others wrote never steers a terminal, forges a line, or becomes another name on its way out."""

from __future__ import annotations

import io
import json
import os
import sys
from pathlib import Path

import pytest

from heuncli.app.cli.entry import enter
from heuncli.app.cli.output import encode_text
from heuncli.base.spelling import wrap_text
from heuncli.base.text_safety import escape, escape_all
from tests.shared.command import HANGING, Heun

EVIL = "a\nheun: fine \x1b[31m\x07\x08\r\x9b31m\x7f\u202e\u2066\u200b\u2028\U000e0041b"
COMMANDS = ("run", "model", "validate", "check", "modes", "probe")


def quoted(text: str) -> str:
    """As YAML holds it between double quotes, which are those of JSON, but for pairs."""
    return json.dumps(text).replace("\\udb40\\udc41", "\\U000e0041")


def unseen(text: str) -> str:
    """What must not stand in an output, but for the ends of its lines."""
    return "".join(letter for letter in text if letter != "\n" and escape(letter) != letter)


@pytest.mark.parametrize("letter", list(EVIL[1:2] + "\x1b\x00\n\udcff\ufeff\U000e0041"))
def test_what_is_unseen_is_escaped_as_json_does(letter: str) -> None:
    assert json.loads(f'"{escape_all(letter)}"') == letter


def test_what_is_seen_stays() -> None:
    assert escape("é ü ω·N·m → – ° 漢 \u00a0 C:\\x 😀") == "é ü ω·N·m → – ° 漢 \u00a0 C:\\x 😀"


@pytest.mark.parametrize("form", [*((name,) for name in COMMANDS), ("run", "--format", "json"),
                                  ("run", "--format", "markdown"), ("run", "--format", "csv"),
                                  ("model", "--format", "json"), ("check", "--format", "json")])  # fmt: skip
def test_a_title_forges_nothing(form: tuple[str, ...], folder: Path, heun: Heun) -> None:
    (folder / "evil.yaml").write_text(HANGING.replace("A bar hangs at rest", quoted(EVIL)))
    done = heun(form[0], "evil.yaml", *form[1:])
    assert (done.returncode, done.stderr) == (0, "")
    assert unseen(done.stdout) == ""
    assert not any(line.startswith("heun: fine") for line in done.stdout.splitlines())
    if form == ("run", "--format", "json"):
        assert json.loads(done.stdout)["title"] == EVIL


@pytest.mark.parametrize(
    "text",
    [
        HANGING.replace("pivot:", f"{quoted(EVIL)}:"),
        HANGING.replace("m: 1.0", f"m: {quoted('1 ' + EVIL)}"),
        HANGING.replace("bar.top", quoted("bar." + EVIL)),
        HANGING.replace("title:", f"{quoted(EVIL)}:"),
        HANGING + f"tables: {{a: {{file: {quoted(EVIL)}}}}}\n",
        HANGING + f"expect: [{{of: {quoted(EVIL)}, is: 1}}]\n",
    ],
    ids=["name", "unit", "reference", "key", "file", "path"],
)
@pytest.mark.parametrize("command", ["validate", "check"])
def test_an_error_is_one_line_and_a_hint(command: str, text: str, folder: Path, heun: Heun) -> None:
    (folder / "evil.yaml").write_text(text)
    done = heun(command, "evil.yaml")
    assert done.returncode == 2
    assert unseen(done.stderr) == ""
    assert all(line.startswith(("evil.yaml:", "  hint: ")) for line in done.stderr.splitlines())


@pytest.mark.parametrize(
    "words",
    [
        ("run", "hanging.yaml", "--set", f"m={EVIL}"),
        ("run", "hanging.yaml", "--set", f"{EVIL}=1"),
        ("run", "hanging.yaml", "--set", "title=a\udcff"),
        ("run", "hanging.yaml", "--measure", EVIL),
        ("run", "hanging.yaml", "--only", EVIL),
        ("run", "hanging.yaml", "--units", EVIL),
        ("run", "hanging.yaml", "--method", EVIL),
        ("run", "hanging.yaml", EVIL),
        ("run", "hanging.yaml", f"--{EVIL}"),
        ("run", f"{EVIL}\udcff.yaml"),
        ("run", "hanging.yaml", "-o", f"{EVIL}\udcff.yaml"),
        (EVIL,),
    ],
    ids=lambda words: words[-2] if len(words) > 3 else words[0][:5],
)
def test_words_of_the_command_line_forge_nothing(words: tuple[str, ...], heun: Heun) -> None:
    done = heun(*words)
    assert (done.returncode, done.stdout) == (2, "")
    assert unseen(done.stderr) == ""
    assert not any(line.startswith("heun: fine") for line in done.stderr.splitlines())


@pytest.mark.parametrize("command", COMMANDS)
def test_a_file_whose_name_is_not_text(command: str, folder: Path, heun: Heun) -> None:
    name = os.fsdecode(b"x\xff\n\x1b.yaml")
    (folder / name).write_text(HANGING)
    done = heun(command, name)
    assert (done.returncode, done.stderr, unseen(done.stdout)) == (0, "", "")
    (folder / name).write_text(HANGING.replace("ball", "bal") + "expect: [{of: a, is: 1}]\n")
    done = heun(command, name)
    assert done.returncode == 2 and done.stderr.startswith("x\\udcff\\n\\u001b.yaml:9:")


def test_the_path_in_json_leads_back_to_the_file(folder: Path, heun: Heun) -> None:
    name = os.fsdecode(b"x\xff.yaml")
    (folder / name).write_text(HANGING)
    assert heun("run", name, "-o", "out.json").returncode == 0
    assert json.loads((folder / "out.json").read_bytes())["spec"]["path"] == name


@pytest.mark.parametrize("form", ["json", "csv", "table", "markdown"])
@pytest.mark.parametrize("encoding", ["ascii", "latin-1", "cp1252"])
def test_two_names_stay_two_whatever_the_locale(
    form: str, encoding: str, folder: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """On a standard output that is not UTF-8 both were `?`."""
    text = HANGING.replace("bar", "é") + "  ü: {type: ball, from: ground.O, to: é.top}\n"
    (folder / "two.yaml").write_text(text, "utf-8")
    raw = io.BytesIO()
    monkeypatch.setattr(sys, "stdout", io.TextIOWrapper(raw, encoding=encoding))
    assert enter(["run", str(folder / "two.yaml"), "--format", form, "--only", "joints"]) == 0
    text = raw.getvalue().decode("utf-8")
    assert "ü" in text and "?" not in text
    if form == "json":
        assert set(json.loads(text)["joints"]) == {"pivot", "ü"}


def test_a_terminal_that_lacks_a_letter_shows_its_number() -> None:
    assert encode_text("é → ü 😀", "latin-1") == b"\xe9 \\u2192 \xfc \\ud83d\\ude00"


@pytest.mark.parametrize("width", [-5, 0, 1, 3, 10, 1000])
def test_words_are_wrapped_at_any_width(width: int) -> None:
    lines = wrap_text("  what from exerts on to (drive apart), in world axes", width)
    assert " ".join(" ".join(lines).split()) == "what from exerts on to (drive apart), in world axes"


def test_a_traceback_that_was_asked_for_steers_nothing(heun: Heun, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("HEUN_DEBUG", "1")
    done = heun("run", EVIL.replace("\n", ""))
    assert "Traceback" in done.stderr and unseen(done.stderr) == ""
