"""What stands in a report is what `heun run` and `heun check` find: numbers, governing cases, verdicts."""

from __future__ import annotations

import json
import math
import re
from pathlib import Path
from typing import Any

import pytest

from heuncli.study.quantities.captions import describe_path
from heuncli.study.quantities.labels import Labels
from tests.shared.command import Heun
from tests.shared.page_reader import PageReader

SPECS = Path(__file__).parents[2] / "specs"
COMPONENTS = {"F": "force", "M": "moment", "|F|": "force", "|M|": "moment"}


FACTORS = {"": 1.0, "N": 1.0, "kN": 1e-3, "MN": 1e-6, "N·m": 1.0, "kN·m": 1e-3, "MN·m": 1e-6}
DASH = "–"


def path_of(group: str, label: str) -> str:
    """The path of a line of a table of loads of joints, or of the foundation."""
    quantity = COMPONENTS.get(label, label)
    if len(label) == 2 and label[0] in COMPONENTS and label[1] in "xyz":
        quantity = f"{COMPONENTS[label[0]]}.{label[1]}"
    name = group.split()[0]
    return f"foundation.{quantity}" if name == "total" else f"joints.{name}.{quantity}"


def close(text: str, number: float) -> bool:
    """Whether a number is written so, rounded to the digits that are written."""
    digits = len(text.partition(".")[2])
    return abs(float(text.replace("−", "-")) - number) <= 0.5000001 * 10.0**-digits


def lines_of_loads(read: PageReader, heads: list[str], names: set[str]) -> dict[str, tuple[list[str], list[bool]]]:
    """By path the cells of the tables with these heads, unit first, and which are bold."""
    found: dict[str, tuple[list[str], list[bool]]] = {}
    group, is_inside = "", False
    for k, row in enumerate(read.rows):
        if row[:2] == ["", ""]:
            is_inside = row == heads
        elif is_inside and len(row) == 1:
            group = row[0]
        elif is_inside and len(row) == len(heads):
            alone, _, label = row[0].rpartition(", ")
            first = (alone or group).split()[0]
            if first in names and row[1] in FACTORS:
                found[path_of(first, label)] = row[1:], [(k, i) in read.bold for i in range(1, len(row))]
    return found


@pytest.mark.heavy
def test_extremes_of_a_motion_are_those_of_run(heun: Heun) -> None:
    spec = str(SPECS / "engine.yaml")
    read = PageReader(heun("report", spec, "-o", "-").stdout)
    names = {"main", "big", "wrist", "bore", "total"}
    found = lines_of_loads(read, ["", "", "min", "at t [s]", "max", "at t [s]"], names)
    assert len(found) > 10
    asked = [f"{how} {path}" for path in [*found][::3] for how in ("min", "max")]
    words = [word for one in asked for word in ("--measure", one)]
    measured = json.loads(heun("run", spec, "--format", "json", *words, "-q").stdout)
    for one, told in zip(asked, measured, strict=True):
        unit, low, low_at, high, high_at = found[one.split()[1]][0]
        text, at = (low or high, low_at) if one.startswith("min") else (high, high_at)
        value = told["value"] * FACTORS[unit]
        if text == DASH:
            others = [abs(float(cell.replace("−", "-"))) for cell in (low, high) if cell not in ("", DASH)]
            assert abs(value) < 1e-2 * max(others), one
            continue
        assert close(text, value), one
        assert not at or close(at, told["at"]), one


def test_governing_cases_are_those_of_the_envelope(heun: Heun) -> None:
    spec = str(SPECS / "axle_loads.yaml")
    told = json.loads(heun("run", spec, "--case", "all", "--format", "json").stdout)
    cases = [*told["cases"]]
    read = PageReader(heun("report", spec, "-o", "-").stdout)
    lines = lines_of_loads(read, ["", "", *cases], {"front", "rear"})
    assert len(lines) >= 4
    for path, ((unit, *texts), (_, *bold)) in lines.items():
        envelope = told["envelope"][path]
        largest = max(abs(envelope["min"]["value"]), abs(envelope["max"]["value"]))
        for case, text in zip(cases, texts, strict=True):
            value = number_at(told["cases"][case], path)
            assert abs(value) < 2e-3 * largest if text == DASH else close(text, value * FACTORS[unit]), (path, case)
        signed = path.endswith((".x", ".y", ".z", ".axial"))
        governing = {envelope["max"]["case"], *([envelope["min"]["case"]] if signed else [])}
        assert {case for case, is_bold in zip(cases, bold, strict=True) if is_bold} == governing, path


def number_at(result: Any, path: str) -> float:
    """The number of a path at the one instant of a result; of a vector its magnitude."""
    value, axis = result, None
    for key in path.split("."):
        if key in "xyz":
            axis = "xyz".index(key)
        else:
            value = value[key]
    value = value[0]
    if isinstance(value, list):
        return float(value[axis]) if axis is not None else math.hypot(*value)
    return float(value)


def test_verdicts_are_those_of_check(heun: Heun) -> None:
    spec = str(SPECS / "axle_loads.yaml")
    told = json.loads(heun("check", spec, "--format", "json").stdout)["cases"]
    read = PageReader(heun("report", spec, "-o", "-").stdout)
    head = next(k for k, row in enumerate(read.rows) if row[-1] == "verdict")
    rows = [row for row in read.rows[head + 1 :] if len(row) == len(read.rows[head])]
    assert [(int(row[0]), row[1], row[2]) for row in rows] == [
        (case["line"], case.get("case", "base model"), describe_path(case["of"], Labels())) for case in told
    ]
    assert [row[-1] == "passed" for row in rows] == [case["passed"] for case in told]


def test_what_fails_is_said_first_and_by_the_exit_code(heun: Heun) -> None:
    done = heun("report", "failing.yaml", "-o", "-")
    assert done.returncode == 1
    read = PageReader(done.stdout)
    assert "1 of 1 check in the spec FAILED: pivot, Fz." in read.by_tag["header"][0]
    assert any(row[-1] == "FAILED" for row in read.rows)


def test_numbers_of_checks_are_those_of_a_reader(heun: Heun, folder: Path) -> None:
    """Noise beside an expected 0 is 0, four digits elsewhere, more where a failure would not be seen."""
    text = (folder / "hanging.yaml").read_text()
    text += "expect:\n  - {of: joints.pivot.force.x, is: 0, abs: 1e-6}\n"
    text += "  - {of: joints.pivot.force.z, is: 9.81}\n  - {of: joints.pivot.force.z, is: 9.81002}\n"
    (folder / "checked.yaml").write_text(text)
    rows = PageReader(heun("report", "checked.yaml", "-o", "-").stdout).rows
    checks = [row[1:] for row in rows if row[-1:] in (["passed"], ["FAILED"])]
    assert checks == [
        ["pivot, Fx", "N", "", "0", "0", "10⁻⁶", "passed"],
        ["pivot, Fz", "N", "", "9.810", "9.810", "10⁻⁴ %", "passed"],
        ["pivot, Fz", "N", "", "9.81002", "9.81000", "10⁻⁴ %", "FAILED"],
    ]  # fmt: skip


def test_expectations_of_the_scene_without_its_cases_are_checked(heun: Heun, folder: Path) -> None:
    text = (folder / "hanging.yaml").read_text()
    text += "cases: {heavy: {set: {m: 2}}}\nexpect:\n  - {of: joints.pivot.force.z, is: 9.81}\n"
    (folder / "cased.yaml").write_text(text)
    assert heun("check", "cased.yaml").returncode == 1
    done = heun("report", "cased.yaml", "-o", "-")
    assert done.returncode == 1
    verdicts = {row[1]: row[-1] for row in PageReader(done.stdout).rows if row[-1] in ("passed", "FAILED")}
    assert verdicts == {"base model": "passed", "heavy": "FAILED"}
    alone = heun("report", "cased.yaml", "-o", "-", "--case", "heavy")
    assert not any("base model" in row for row in PageReader(alone.stdout).rows)


def test_units_and_settings_are_told(heun: Heun) -> None:
    done = heun("report", "hanging.yaml", "-o", "-", "--units", "kN,mm", "--set", "m=2", "--tolerance", "1e-8")
    read = PageReader(done.stdout)
    assert ["option", "--set m=2"] in read.rows and ["option", "--tolerance 1e-08"] in read.rows
    assert ["pivot, Fz", "kN", "0.01962"] in [row[:3] for row in read.rows]


@pytest.mark.heavy
def test_what_lies_beyond_the_horizon_is_no_extreme(heun: Heun) -> None:
    spec = str(SPECS / "double.yaml")
    words = ("--set", "analysis.duration=60", "-q")
    horizon = json.loads(heun("run", spec, *words, "--format", "json", "--only", "joints").stdout)["accuracy"][
        "horizon"
    ]
    read = PageReader(heun("report", spec, "-o", "-", *words).stdout)
    assert f"no results are claimed from t = {horizon:.4g} s on" in read.by_tag["header"][0]
    instants = [float(row[k]) for row in read.rows if len(row) == 6 and row[0] and row[1] in FACTORS
                for k in (3, 5) if re.fullmatch(r"\d[\d.]*", row[k])]  # fmt: skip
    assert len(instants) > 20
    assert max(instants) < horizon < 60.0


OVERLOADED = """\
heun: 1
title: A cantilever
gravity: [0, 0, -9.81]
ground: {points: {wall: [0, 0, 0]}}
bodies:
  beam:
    shapes: [{type: cylinder, from: [0, 0, 0], to: [1, 0, 0], radius: 0.01, density: 7850}]
    points: {root: [0, 0, 0], tip: [1, 0, 0]}
joints: {wall: {type: weld, from: ground.wall, to: beam.root}}
forces: {load: {type: force, on: beam.tip, vector: [0, 0, -F]}}
parameters: {F: 100}
sections:
  along: {body: beam, from: root, to: tip, count: 5, properties: {circle: {radius: 0.01}}, strength: S}
cases: {light: {set: {}}, heavy: {set: {F: 400}}}
"""


@pytest.mark.parametrize(("strength", "words"), [("100 MPa", "Strength exceeded: along."), ("900 MPa", "")])
def test_a_section_beyond_its_strength_is_said_first(heun: Heun, folder: Path, strength: str, words: str) -> None:
    (folder / "beam.yaml").write_text(OVERLOADED.replace("strength: S", f"strength: {strength}"))
    told = heun("run", "beam.yaml", "--case", "heavy", "--measure", "max sections.along.stress.utilisation", "-q")
    read = PageReader(heun("report", "beam.yaml", "-o", "-").stdout)
    (row,) = [row for row in read.rows if row[0] == "along" and row[1] == "heavy"]
    assert close(row[-1], float(told.stdout.split()[-1]))
    assert row[2] == "0 beyond"
    assert row[-2] == strength.split()[0]
    first = " ".join(read.by_tag["header"][0].split())
    assert f"in section along, just beyond s = 0 m, in case heavy. {words}".strip() in first
    assert ("Strength exceeded" in first) == bool(words)


def test_open_loads_are_said_first(heun: Heun) -> None:
    read = PageReader(heun("report", str(SPECS / "table.yaml"), "-o", "-").stdout)
    assert "Indeterminate: 8 load components (open)" in read.by_tag["header"][0]
    assert ["A, Fz, |F|, axial", "", "open"] in read.rows
    assert "indeterminate: axial loads of A, B, C, D (1 redundant constraint)" in read.by_tag["li"]  # in the summary
    assert "joints.A Fz + joints.B Fz = 123.1 N; distribution indeterminate" in read.by_tag["li"]
    split = PageReader(heun("report", str(SPECS / "table.yaml"), "-o", "-", "--least-norm").stdout)
    assert "other distributions are equally possible" in split.by_tag["header"][0]
    assert any(text.startswith("indeterminate, one distribution chosen: A Fz, B Fz") for text in split.by_tag["li"])


def test_of_many_sections_those_are_drawn_that_govern(heun: Heun, folder: Path) -> None:
    run = "{body: beam, from: [0.0N, 0, 0], to: tip, count: 2}"
    many = "".join(f"  s{n:02}: {run.replace('N', f'{n:02}')}\n" for n in range(14))
    (folder / "many.yaml").write_text(f"{OVERLOADED.partition('sections:')[0]}sections:\n{many}")
    read = PageReader(heun("report", "many.yaml", "-o", "-").stdout)
    drawn = [text for text in read.by_tag["figcaption"] if text.startswith("Section ")]
    assert [text.split()[1] for text in drawn] == [f"s{n:02};" for n in range(12)]  # the nearer to the wall the more
    assert "2 further sections are not shown" in " ".join(read.by_tag["p"])


def test_of_many_cases_those_are_told_that_govern(heun: Heun, folder: Path) -> None:
    cases = "".join(f"  c{n}: {{set: {{F: {100 + n}}}}}\n" for n in range(13))
    (folder / "many.yaml").write_text(f"{OVERLOADED.partition('sections:')[0]}cases:\n{cases}")
    read = PageReader(heun("report", "many.yaml", "-o", "-").stdout)
    head = read.rows.index(["", "", "min", "case", "max", "case"])
    rows = [row for row in read.rows[head + 1 :] if len(row) == 6 and row[:2] != ["", ""]][:3]
    assert {cell for row in rows for cell in (row[3], row[5])} <= {"c0", "c12", ""}
    assert {"c0", "c12"} <= {cell for row in rows for cell in row}
    assert any(note.startswith("least and greatest value of 13 load cases") for note in read.by_tag["li"])
