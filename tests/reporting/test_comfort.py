"""A report gives no comfort that another case, a stated error or a check that was not made takes away."""

from __future__ import annotations

import json
import re
from pathlib import Path

import pytest

from heuncli.app.cli.options import SolverRequest
from heuncli.app.commands.report.command import solve_report_cases
from heuncli.app.commands.report.request import ReportRequest
from heuncli.base.records import replace
from heuncli.output.client_report.extremes import find_extremes
from tests.shared.command import Heun
from tests.shared.folders import SPECS
from tests.shared.page_reader import PageReader

BEAM = """\
heun: 1
title: A beam on three supports, of which the middle one slides along the beam or across it
space: planar
parameters: {along: 0, P: 1 kN, strength: 235 MPa}
ground: {points: {A: [0, 0], B: [1, 0], C: [2, 0]}}
bodies:
  beam:
    shapes: [{type: box, center: [1, 0, 0], size: [2, 0.04, 0.02], mass: 10}]
    points: {A: [0, 0], B: [1, 0], C: [2, 0], m: [1.5, 0]}
joints:
  A: {type: pin, from: ground.A, to: beam.A}
  B: {type: line, from: ground.B, to: beam.B, axis: [cos(along), sin(along)]}
  C: {type: line, from: ground.C, to: beam.C, axis: [1, 0]}
forces: {load: {type: force, on: beam.m, vector: [0, -P]}}
sections:
  mid: {body: beam, at: [1.4, 0], normal: [1, 0], properties: {rectangle: {width: 20 mm, height: 40 mm}},
    strength: strength}
cases: {firm: {set: {along: 90 deg}}, CASES}
"""
GUIDED = """\
heun: 1
title: A block that is driven along its guide and pushed across it
ground: {points: {O: [0, 0, 0]}}
bodies: {block: {mass: 1, center: [0, 0, 0], inertia: [1, 1, 1], points: {c: [0, 0, 0]}}}
joints: {guide: {type: slide, from: ground.O, to: block.c, axis: [1, 0, 0]}}
drives: {along: {joint: guide, travel: t**2/2}}
forces: {push: {type: force, on: block.c, vector: [0, 3, 4]}}
"""
SWING = """\
heun: 1
title: A bar swings
gravity: [0, 0, -9.81]
parameters: {strength: 100 kPa}
ground: {points: {O: [0, 0, 0]}}
bodies:
  bar: {shapes: [{type: rod, from: [0, 0, 0], to: [1, 0, 0], mass: 1}], points: {top: [0, 0, 0]}}
joints: {pivot: {type: pin, from: ground.O, to: bar.top, axis: [0, 1, 0]}}
sections:
  mid: {body: bar, at: [0.5, 0, 0], normal: [1, 0, 0], properties: {rectangle: {width: 20 mm, height: 20 mm}},
    strength: strength}
analysis: {duration: 1, samples: 21}
"""


def read_of(heun: Heun, folder: Path, text: str, *words: str) -> PageReader:
    (folder / "own.yaml").write_text(text)
    done = heun("report", "own.yaml", "-o", "-", *words)
    assert done.returncode == 0, done.stderr
    return PageReader(done.stdout)


def test_stress_that_another_case_leaves_open_is_not_told_as_the_largest(heun: Heun, folder: Path) -> None:
    read = read_of(heun, folder, BEAM.replace("CASES", "loose: {set: {P: 3 kN}}"))
    first = read.by_tag["header"][0]
    assert "Largest utilisation among known values: 0.5585 in section mid" in first
    assert ["foundation", "3.000", "kN", "−y", "loose"] in read.rows  # which is not open
    assert "indeterminate: radial loads of A, B" in read.by_tag["li"]
    assert "C: open or unknown in loose, where it may be larger" in read.by_tag["li"]
    head = next(k for k, row in enumerate(read.rows) if row[:1] == ["section"])
    assert read.rows[head + 1][:2] == ["mid", "firm"]
    assert (head + 1, len(read.rows[head]) - 1) not in read.bold
    assert "mid: open or unknown in case loose, where it may be larger" in read.by_tag["li"]


def test_of_many_cases_those_left_out_that_leave_a_number_open_are_named(heun: Heun, folder: Path) -> None:
    firm = ", ".join(f"f{k}: {{set: {{along: 90 deg, P: {k} kN}}}}" for k in range(2, 14))
    read = read_of(heun, folder, BEAM.replace("CASES", f"{firm}, loose: {{set: {{P: 99 kN}}}}"))
    assert any("where it may be larger: loose" in text for text in read.by_tag["li"])


def test_strength_within_the_stated_error_is_no_comfort(heun: Heun, folder: Path) -> None:
    """A bar swings, integrated coarsely; its strength lies within what the run may err, then beyond that."""
    coarse = ("--tolerance", "1e-4")
    first = read_of(heun, folder, SWING, *coarse).by_tag["header"][0]
    assert "Largest utilisation: " in first and "is added" not in first
    request = ReportRequest(spec=str(folder / "own.yaml"), solver=SolverRequest(tolerance=1e-4), quiet=True)
    ends = find_extremes(solve_report_cases(request).runs[0], "sections.mid.stress.utilisation")
    assert ends is not None
    asked = ("--measure", "max sections.mid.stress.utilisation")
    largest = json.loads(heun("run", "own.yaml", *coarse, *asked, "--format", "json").stdout)["value"]
    error = ends.error
    for share, told in ((0.3, True), (3.0, False)):
        strength = f"strength={100 * (largest + share * error)!r} kPa"
        own = read_of(heun, folder, SWING, *coarse, "--set", strength).by_tag["header"][0]
        assert ("Strength exceeded if the stated error is added: mid." in own) == told, own


def test_extremes_of_samples_alone_are_told_first(heun: Heun, folder: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    said = "extremes cover 21 output times only"
    assert said not in read_of(heun, folder, SWING).by_tag["header"][0]
    monkeypatch.setattr("heuncli.study.queries.study.MOST_SEARCHED", 0)
    assert said in read_of(heun, folder, SWING).by_tag["header"][0]


@pytest.mark.long
def test_few_samples_of_many_turns_hide_no_load(heun: Heun, folder: Path) -> None:
    """Seven cycles of an engine, told at eight instants: more than a million numbers to look at."""
    text = (SPECS / "engine.yaml").read_text().partition("\nexpect")[0]
    text = re.sub("(?m)^analysis:.*", "analysis: {duration: 7*cycle, samples: 8}", text)
    (folder / "engine.csv").write_bytes((SPECS / "engine.csv").read_bytes())
    rows = read_of(heun, folder, text).rows
    measured = json.loads(heun("run", "own.yaml", "--measure", "max joints.wrist.force", "--format", "json").stdout)
    assert f"{measured['value'] / 1e3:.2f}" in {row[1] for row in rows if row[0] == "joint wrist" and len(row) > 1}


def test_checks_of_other_cases_are_not_taken_for_none(heun: Heun, folder: Path) -> None:
    text = BEAM.replace("CASES", "loose: {set: {P: 3 kN}}")
    text += "expect: [{of: foundation.force.y, case: firm, below: 0}]\n"
    read = read_of(heun, folder, text, "--case", "loose")
    assert "No result was checked. Not checked (not requested): firm." in read.by_tag["header"][0]
    assert "Checks" not in " ".join(read.by_tag["h2"])


@pytest.mark.parametrize("case", ["loose", "firm,loose"])
def test_checks_that_were_not_asked_for_are_told(heun: Heun, folder: Path, case: str) -> None:
    text = BEAM.replace("CASES", "loose: {set: {P: 3 kN}}") + "expect: [{of: foundation.force.y, below: 0}]\n"
    first = read_of(heun, folder, text, "--case", case).by_tag["header"][0]
    left = "base model, firm." if case == "loose" else "base model."
    assert f"passed. Not checked (not requested): {left}" in first
    assert "Not checked" not in read_of(heun, folder, text).by_tag["header"][0]


def test_the_one_scalar_beside_a_force_hides_no_other(heun: Heun, folder: Path) -> None:
    """A guide with a drive carries 5 N across its axis."""
    read = read_of(heun, folder, GUIDED)
    assert ["|F|", "N", "5.000"] in read.rows
    assert ["drive", "N", "1.000"] in read.rows
    assert "radial" not in {row[0] for row in read.rows}  # nothing twice


def test_what_is_nothing_at_some_instants_and_open_at_others_keeps_its_line(heun: Heun, folder: Path) -> None:
    """A rod that is held beside its weld: the moment My of that is 0 where it is known, and open in other poses."""
    text = (SPECS / "skew_rod.yaml").read_text().partition("\nexpect")[0].replace(
        "\nsections:", "  beside: {type: rod, from: ground.right, to: rod.tip}\n\nsections:"
    ) + "\ngravity: [3, 0, -9.81]\nanalysis: {duration: 0.2, samples: 5}\n"  # fmt: skip
    read = read_of(heun, folder, text)
    hub = next(k for k, row in enumerate(read.rows) if row[0].startswith("hub weld"))
    assert "My*" in [row[0] for row in read.rows[hub : hub + 3]]


def test_what_is_open_at_any_instant_is_told_though_no_even_one_sees_it(folder: Path) -> None:
    """Where the run says that a component is open, no extreme of it is whole, nor of a stress that it makes."""
    (folder / "own.yaml").write_text(SWING)
    run = solve_report_cases(ReportRequest(spec=str(folder / "own.yaml"), quiet=True)).runs[0]
    paths = ("joints.pivot.force.x", "joints.pivot.force", "sections.mid.stress.mises", "joints.pivot.force.z")
    assert all(ends is not None and ends.is_known for ends in (find_extremes(run, path) for path in paths))
    opened = run.snapshot.model_copy(update={"open": ["joints.pivot.force.x", "sections.mid.N"]})
    found = [find_extremes(replace(run, snapshot=opened), path) for path in paths]
    assert [ends is not None and ends.is_known for ends in found] == [False, False, False, True]
    assert [ends is not None and ends.is_partly_open for ends in found] == [True, True, True, False]
