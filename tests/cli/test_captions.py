"""`--title` and `--label`: texts for readers on the command line, on every command that shows a name."""

from __future__ import annotations

import json
from pathlib import Path

import pytest

from heuncli.app.cli.entry import enter

SPEC = """heun: 1
title: Pendulum
gravity: [0, 0, -9.81]
parameters: {m: {value: 2 kg, label: Bob}}
ground: {points: {O: {at: [0, 0, 0], label: Hook}}}
bodies: {rod: {label: Swinging rod, mass: m, center: [0.5, 0, 0], inertia: [0.01, 0.1, 0.1], points: {top: [0, 0, 0]}}}
joints: {main_pin: {type: pin, from: ground.O, to: rod.top, axis: [0, 1, 0]}}
analysis: {duration: 0.5, samples: 3}
cases: {long_run: {title: long, set: {analysis.duration: 0.6}}, heavy: {label: Heavy bob, set: {m: 3 kg}}}
"""
EVIL = "A|B <b>bold</b> & **c**"


@pytest.fixture
def spec(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> str:
    (tmp_path / "pendulum.yaml").write_text(SPEC)
    monkeypatch.chdir(tmp_path)
    return "pendulum.yaml"


def test_tables_are_headed_by_labels(spec: str, capsys: pytest.CaptureFixture[str]) -> None:
    assert enter(["run", spec, "--label", "joints.main_pin=Upper bearing", "--title", "Bench 7"]) == 0
    text = capsys.readouterr().out
    assert "Bench 7" in text
    assert "Pendulum" not in text
    assert "\nUpper bearing (main_pin)  pin, ground.O → rod.top\n" in text


def test_tables_of_one_instant_have_labels(spec: str, capsys: pytest.CaptureFixture[str]) -> None:
    assert enter(["run", spec, "--at", "first", "--label", "joints.main_pin=Upper bearing"]) == 0
    text = capsys.readouterr().out
    assert "\nUpper bearing (main_pin)  pin, ground.O → rod.top  " in text


def test_a_case_has_the_title_and_its_own(spec: str, capsys: pytest.CaptureFixture[str]) -> None:
    assert enter(["run", spec, "--case", "all", "--title", "Bench 7"]) == 0
    text = capsys.readouterr().out
    assert "Bench 7 (case long_run: long)" in text
    assert "Bench 7 (case heavy: Heavy bob)" in text


def test_json_has_the_labels(spec: str, capsys: pytest.CaptureFixture[str]) -> None:
    words = ["--label", "bodies.rod.points.top=Eye", "--label", "joints.main_pin.radial=Bearing load"]
    assert enter(["run", spec, "--format", "json", *words]) == 0
    assert json.loads(capsys.readouterr().out)["labels"] == {
        "parameters.m": "Bob", "points.ground.O": "Hook", "bodies.rod": "Swinging rod", "points.rod.top": "Eye",
        "joints.main_pin.radial": "Bearing load", "cases.heavy": "Heavy bob",
    }  # fmt: skip


@pytest.mark.parametrize(
    ("words", "message", "hint"),
    [
        (
            ["--label", "joints.main_pni=X"],
            "--label joints.main_pni: nothing in the spec has this name",
            "did you mean joints.main_pin",
        ),
        (
            ["--label", "main_pin=X"],
            "--label main_pin: nothing in the spec has this name",
            "did you mean joints.main_pin?",
        ),
        (["--label", "rod.top=X"], "--label rod.top: nothing in the spec has this name", "did you mean points.rod.top"),
        (["--label", "joints.main_pin"], "expected PATH=TEXT", "for example"),
        (["--label", "joints.main_pin="], "--label joints.main_pin: the text is empty", ""),
        (["--label", "bodies.rod=a\x1bb"], "--label bodies.rod: the text has a line break", ""),
        (["--title", "x" * 81], "--title: 81 characters; at most 80", ""),
    ],
)
@pytest.mark.parametrize(
    "command",
    [["run"], ["plot"], ["show", "-o", "x.html"], ["report", "-o", "x.html"], ["export", "loads", "--at", "first"]],
    ids=lambda command: command[0],
)
def test_what_is_wrong(
    command: list[str], words: list[str], message: str, hint: str, spec: str, capsys: pytest.CaptureFixture[str]
) -> None:
    target = {"plot": [spec, "scene"], "export": ["loads", spec]}.get(command[0], [spec])
    options = command[1:] if command[0] != "export" else command[2:]
    assert enter([command[0], *target, *options, *words]) == 2
    out, complaints = capsys.readouterr()
    assert out == ""
    assert message in complaints
    assert hint in complaints
    assert "Traceback" not in complaints


def test_all_that_is_wrong_is_told_at_once(spec: str, capsys: pytest.CaptureFixture[str]) -> None:
    assert enter(["run", spec, "--label", "joints.x=X", "--label", "bodies.y=Y", "--label", "z"]) == 2
    complaints = capsys.readouterr().err
    assert [name in complaints for name in ("--label joints.x", "--label bodies.y", "--label z")] == [True] * 3


@pytest.mark.parametrize("form", ["table", "markdown"])
def test_markup_is_not_interpreted(form: str, spec: str, capsys: pytest.CaptureFixture[str]) -> None:
    assert enter(["run", spec, "--format", form, "--label", f"joints.main_pin={EVIL}", "--title", EVIL]) == 0
    text = capsys.readouterr().out
    assert (EVIL in text) == (form == "table")
    if form == "markdown":
        assert text.count(r"A\|B \<b>bold\</b> \& \*\*c\*\*") == text.count("bold") == 3


@pytest.mark.heavy
def test_pictures_and_pages_take_them(spec: str, tmp_path: Path) -> None:
    words = ["--title", EVIL, "--label", f"joints.main_pin={EVIL}"]
    assert enter(["plot", spec, "joints.main_pin.force", "-o", "a.svg", *words]) == 0
    assert enter(["plot", spec, "scene", "-o", "b.svg", *words]) == 0
    assert enter(["show", spec, "-o", "c.html", *words]) == 0
    assert enter(["report", spec, "-o", "d.html", *words]) == 0
    for name in ("a.svg", "b.svg", "c.html", "d.html"):
        text = (tmp_path / name).read_text()
        assert "A|B" in text
        assert "<b>bold" not in text
    assert enter(["export", "loads", spec, "--at", "first", "-o", "e.json", *words]) == 0
    assert json.loads((tmp_path / "e.json").read_text())["title"] == EVIL
