"""The summary at the top of a run, and its hardpoints: the numbers of the measures, and bodies in equilibrium."""

from __future__ import annotations

import csv
import json
import os
import subprocess
import sys
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from heuncli.output.tables.nouns import join_ranges
from heuncli.output.tables.summary_document import MAX_LINES, choose_rows, format_direction
from heuncli.output.tables.summary_rows import SummaryRow
from tests.shared.command import Heun
from tests.shared.folders import ROOT

SPECS = ROOT / "specs"
LEVER = """\
heun: 1
title: A lever without weight
gravity: [0, 0, 0]
ground: {points: {A: [0, 0, 0], D: [2, 3, 0.5], S: [1, -2, 0.3]}}
bodies:
  lever:
    {mass: 2, center: [0.5, 0, 0], inertia: [0.1, 0.1, 0.1],
     points: {a: [0, 0, 0], b: [1, 0.2, 0], c: [2, 0, 0.1], tip: [3, 0.1, 0.2]}}
joints:
  hinge: {type: pin, from: ground.A, to: lever.a, axis: [0, 0, 1]}
  tie: {type: rod, from: lever.c, to: ground.D}
forces:
  push: {type: force, on: lever.tip, vector: [30, -70, 20]}
  strut: {type: spring, from: ground.S, to: lever.b, stiffness: 100, length: 1}
  twist: {type: couple, on: lever, vector: [1, 2, 3]}
analysis: {type: state}
"""


def read_json(heun: Heun, *words: str) -> dict[str, Any]:
    """What a run prints as JSON."""
    return json.loads(heun("run", *words, "--format", "json").stdout)


@pytest.mark.parametrize("name", ["double", "crane", "engine"])
def test_a_row_is_the_measure_of_its_path(heun: Heun, name: str) -> None:
    """To the errors stated; with its instant the same direction."""
    spec = str(SPECS / f"{name}.yaml")
    rows = read_json(heun, spec, "--summary")["summary"]
    assert len(rows) >= 3
    measures = [word for row in rows for word in ("--measure", f"max abs {row['path']}")]
    for row, found in zip(rows, read_json(heun, spec, *measures), strict=True):
        assert abs(row["value"]) == pytest.approx(found["value"], abs=2.0 * row["error"] + 1e-12 * found["value"])
        assert row["direction"] is None or np.linalg.norm(row["direction"]) == pytest.approx(1.0)


def test_a_direction_is_that_of_the_vector_at_the_instant(heun: Heun) -> None:
    spec = str(SPECS / "double.yaml")
    row = read_json(heun, spec, "--summary")["summary"][0]
    vector = [
        float(heun("run", spec, "--measure", f"at {row['time']!r} {row['path']}.{axis}").stdout) for axis in "xyz"
    ]
    assert np.array(row["direction"]) * row["value"] == pytest.approx(vector, abs=1e-9 * row["value"])


def test_the_angle_is_that_of_the_driven_pin(heun: Heun) -> None:
    spec = str(SPECS / "crane.yaml")
    row = read_json(heun, spec, "--summary")["summary"][0]
    measured = heun("run", spec, "--measure", f"at {row['time']!r} coordinates.slew.angle")
    assert row["angle"] == pytest.approx(float(measured.stdout), abs=1e-12)


def test_what_is_indeterminate_has_one_line_a_group(heun: Heun) -> None:
    printed = heun("run", str(SPECS / "planetary.yaml"), "--summary").stdout
    lines = [line.strip() for line in printed.splitlines() if "indeterminate" in line]
    assert lines == [
        "indeterminate: radial loads of input, output, pin1–pin3",
        "indeterminate: tooth forces of sun1–sun3, ring1–ring3 (2 redundant constraints)",
    ]
    assert not [line for line in printed.splitlines() if "moment" in line], "of what is open no lesser load is told"


def test_tables_name_what_is_open_once(heun: Heun) -> None:
    spec = str(SPECS / "planetary.yaml")
    brief, full = (heun("run", spec, *words).stdout.splitlines() for words in ((), ("--full",)))
    assert [line for line in brief if line.startswith("open  ")] == [
        "open  input, output, pin1–pin3: Fx, Fy, |F|, radial",
        "open  sun1–sun3, ring1–ring3: normal, force, radial",
    ]
    assert sum(line.startswith("  open: Fx") for line in full) == 17
    assert len(brief) < len(full) - 30


def test_a_constant_stands_once(heun: Heun) -> None:
    spec = str(SPECS / "planetary.yaml")
    brief, full = (heun("run", spec, *words).stdout.splitlines() for words in ((), ("--full",)))
    assert next(line.split() for line in brief if line.startswith("kinetic  ")) == [
        "kinetic",
        "J",
        "6.35293",
        "constant",
    ]
    assert next(line.split() for line in full if line.startswith("kinetic  ")) == ["kinetic", "J", *["6.35293"] * 4]


def test_the_heading_is_three_lines_unless_all_is_asked_for(heun: Heun) -> None:
    spec = str(SPECS / "double.yaml")
    brief, full = (heun("run", spec, *words).stdout.partition("\n\n")[0] for words in ((), ("--full",)))
    assert [line.split()[0] for line in brief.splitlines()] == ["heun", "model", "accuracy"]
    assert "force balance error" in full
    assert "DOP853" in full


def test_the_summary_is_a_dozen_lines_and_the_largest_of_each_kind() -> None:
    rows = [
        SummaryRow(kind, f"{kind}{i}", f"joints.{kind}{i}.force", "", "N", 1.0, 0.0, share=share)
        for kind, shares in (("joint", np.linspace(0.5, 1.0, 30)), ("coupling", [0.01, 0.02]), ("load", [0.3]))
        for i, share in enumerate(shares)
    ]
    chosen = choose_rows(rows, MAX_LINES)
    assert len(chosen) == MAX_LINES
    assert [row.name for row in chosen if row.kind != "joint"] == ["coupling1", "load0"]
    assert [row.share for row in chosen[:10]] == sorted((row.share for row in rows), reverse=True)[:10]


def test_things_alike_have_one_line_and_are_all_there_in_full(heun: Heun) -> None:
    spec = str(ROOT / "tests" / "gallery" / "scenes" / "v_engine.yaml")
    brief, full = (heun("run", spec, "--summary", *words).stdout for words in ((), ("--full",)))
    rows = read_json(heun, spec, "--summary")["summary"]
    kinds = ("joint", "drive", "load", "foundation", "section")
    assert sum(line.startswith(kinds) for line in full.splitlines()) == len(rows) == 21
    lines = [line for line in brief.splitlines() if line.startswith(kinds)]
    assert [line[:21].split()[-1] for line in lines[:5]] == [
        "small1–small4",
        "big1–big4",
        "rear",
        "main",
        "bore1–bore4",
    ]
    assert "further" not in brief


def test_further_rows_are_counted(heun: Heun, folder: Path) -> None:
    """A row for the foundation, one for each of 15 feet with loads of their own."""
    feet = "".join(f"  f{n}: {{type: force, on: plate.p{n}, vector: [0, 0, {n}]}}\n" for n in range(1, 16))
    points = ", ".join(f"p{n}: [{n}, 0, 0]" for n in range(1, 16))
    text = f"""heun: 1
ground: {{points: {{A: [0, 0, 0]}}}}
bodies: {{plate: {{mass: 1, center: [0, 0, 0], inertia: [1, 1, 1], points: {{a: [0, 0, 0], {points}}}}}}}
joints: {{foot: {{type: weld, from: ground.A, to: plate.a}}}}
forces:
{feet}"""
    (folder / "feet.yaml").write_text(text)
    rows = len(read_json(heun, "feet.yaml", "--summary")["summary"])
    assert rows == 17
    assert f"and {rows - MAX_LINES} further: --full" in heun("run", "feet.yaml", "--summary").stdout


def test_a_scene_that_is_struck_alone_has_its_impulses(heun: Heun) -> None:
    """Each row is the largest of the impulse's own block, along a bar that of the whole length."""
    spec = str(SPECS / "struck_chain.yaml")
    rows = {row["path"]: row for row in read_json(heun, spec, "--summary")["summary"]}
    block = read_json(heun, spec)["impulses"][0]
    for name in ("foot", "knee", "hand"):
        row = rows[f"impulses.0.joints.{name}.force"]
        assert row["value"] == pytest.approx(np.linalg.norm(block["joints"][name]["force"]))
        assert np.array(row["direction"]) * row["value"] == pytest.approx(block["joints"][name]["force"], abs=1e-12)
        assert row["unit"] == "N·s"
    row = rows["impulses.0.sections.struck.M2"]
    assert abs(row["value"]) >= np.abs(block["sections"]["struck"]["M2"]).max() - 1e-12


def test_cases_give_the_rows_that_govern(heun: Heun) -> None:
    spec = str(SPECS / "axle_loads.yaml")
    rows = read_json(heun, spec, "--summary", "--case", "all")["summary"]
    for row in rows:
        values = [
            abs(own["value"])
            for case in ("standing", "braking", "starting", "loaded")
            for own in read_json(heun, spec, "--summary", "--case", case)["summary"]
            if own["path"] == row["path"]
        ]
        assert abs(row["value"]) >= max(values)
    assert {row["case"] for row in rows} == {"starting", "loaded"}


def test_csv_has_the_rows_of_the_json(heun: Heun) -> None:
    for option, key in (("--summary", "summary"), ("--hardpoints", "hardpoints")):
        rows = read_json(heun, str(SPECS / "crane.yaml"), option)[key]
        lines = list(
            csv.DictReader(heun("run", str(SPECS / "crane.yaml"), option, "--format", "csv").stdout.splitlines())
        )
        assert len(lines) == len(rows) > 4
        number = "value" if key == "summary" else "Fx"
        assert [float(line[number]) for line in lines] == [row[number] for row in rows]


@pytest.fixture
def lever(folder: Path) -> str:
    (folder / "lever.yaml").write_text(LEVER)
    return "lever.yaml"


@pytest.mark.parametrize("axes", ["world", "lever"])
def test_a_body_without_weight_is_in_equilibrium_by_its_rows_alone(heun: Heun, lever: str, axes: str) -> None:
    force, moment = np.zeros(3), np.zeros(3)
    rows = read_json(heun, lever, "--hardpoints", "--axes", axes)["hardpoints"]
    assert [row["point"] for row in rows] == ["hinge", "tie", "push", "strut", "strut", "twist"]
    for row in rows:
        place, pull, turn = (np.array([row[f"{word}{axis}"] for axis in "xyz"]) for word in ("", "F", "M"))
        is_load = row["point"] in ("push", "strut", "twist")  # of these each end has its own row
        on_lever = row["on"].startswith("lever")
        sign = 1.0 if on_lever else 0.0 if is_load else -1.0
        force += sign * pull
        moment += sign * (turn + np.cross(place, pull))
    assert force == pytest.approx(np.zeros(3), abs=1e-11)
    assert moment == pytest.approx(np.zeros(3), abs=1e-11)


def test_a_hardpoint_has_the_force_of_the_measure(heun: Heun) -> None:
    spec = str(SPECS / "double.yaml")
    row = read_json(heun, spec, "--hardpoints")["hardpoints"][1]
    measured = read_json(heun, spec, "--measure", "max abs joints.elbow.force")
    assert np.linalg.norm([row[f"F{axis}"] for axis in "xyz"]) == pytest.approx(measured["value"], rel=1e-9)
    place = [
        float(heun("run", spec, "--measure", f"at {row['time']!r} joints.elbow.point.{axis}").stdout) for axis in "xyz"
    ]
    assert [row[axis] for axis in "xyz"] == pytest.approx(place, abs=1e-12)


def test_units_and_cases_of_hardpoints(heun: Heun) -> None:
    printed = heun("run", str(SPECS / "axle_loads.yaml"), "--hardpoints", "--units", "kN,mm", "--case", "all").stdout
    assert "Fx [kN]" in printed
    assert "x [mm]" in printed
    assert "Mx [kN·mm]" in printed
    assert sum("braking" in line for line in printed.splitlines()) >= 2
    assert max(map(len, printed.splitlines())) <= 120


@pytest.mark.parametrize(
    "words",
    [("--summary", "--at", "0"), ("--summary", "--measure", "final energy.kinetic"), ("--hardpoints", "--summary"),
     ("--hardpoints", "--only", "joints"), ("--summary", "--by-cause"), ("--hardpoints", "--axes", "nobody")],
)  # fmt: skip
def test_what_does_not_go_together_is_refused(heun: Heun, words: tuple[str, ...]) -> None:
    done = heun("run", str(SPECS / "double.yaml"), *words)
    assert done.returncode == 2
    assert "bad-option" in done.stderr


def test_ranges_and_directions_in_words() -> None:
    assert join_ranges(["a", "pin1", "pin2", "pin3", "pin5", "b1", "b2"]) == ["a", "pin1–pin3", "pin5", "b1", "b2"]
    assert join_ranges(["p09", "p10", "p11"]) == ["p09", "p10", "p11"]
    assert format_direction((0.0, -1.0, 0.001)) == "−y"
    assert format_direction((0.6, -0.8, 0.001)) == "(0.60, −0.80, 0)"


ON_A_TERMINAL = """\
import os, sys
from heuncli.app.cli import terminal
terminal.is_terminal = lambda: True
from heuncli.app.cli.entry import enter
code = enter(["run", sys.argv[1], "--summary"])
print("rich" in sys.modules)
sys.exit(code)
"""


@pytest.mark.parametrize(("columns", "no_color", "is_set"), [("80", "", True), ("60", "", True), ("80", "1", False)])
def test_rich_sets_the_summary_on_a_terminal_alone(columns: str, no_color: str, is_set: bool) -> None:
    settings = os.environ | {"COLUMNS": columns, "TERM": "xterm", "NO_COLOR": no_color, "PYTHONPATH": str(ROOT)}
    line = [sys.executable, "-c", ON_A_TERMINAL, str(SPECS / "planetary.yaml")]
    done = subprocess.run(line, capture_output=True, text=True, check=True, stdin=subprocess.DEVNULL, env=settings)
    *shown, loaded = done.stdout.splitlines()
    assert loaded == str(is_set)
    assert ("\x1b[33mindeterminate" in done.stdout) == is_set
    if is_set:
        import re

        plain = [re.sub(r"\x1b\[[\d;]*m", "", text) for text in shown]
        assert max(len(text.rstrip()) for text in plain) <= int(columns)
        assert "148.5" in "\n".join(plain)


def test_a_pipe_never_loads_rich() -> None:
    line = [sys.executable, "-c", ON_A_TERMINAL.replace("lambda: True", "lambda: False"), str(SPECS / "double.yaml")]
    done = subprocess.run(line, capture_output=True, text=True, check=True, stdin=subprocess.DEVNULL)
    assert done.stdout.splitlines()[-1] == "False"
    assert "\x1b" not in done.stdout
