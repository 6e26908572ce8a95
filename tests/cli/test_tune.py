"""`heun tune`: what it writes, how it ends, and what it refuses."""

from __future__ import annotations

import csv
import io
import json
import re
import shlex
from itertools import pairwise
from pathlib import Path
from typing import Any

import pytest

from heuncli.app.cli import jobs
from tests.shared.command import HANGING, Heun

# Two bars that meet over a base: they close where the one from the right is long enough.
GABLE = """\
heun: 1
title: A gable
gravity: [0, 0, -9.81]
parameters: {b: 1.5 m, m: 3 kg}
ground: {points: {A: [0, 0, 0], B: [2, 0, 0]}}
bodies:
  left: {mass: m, center: [0.5, 0, 0], inertia: [0.1, 0.1, 0.1], points: {a: [0, 0, 0], k: [1, 0, 0]},
         near: {orientation: {axis: [0, 1, 0], angle: -45 deg}}}
  right: {mass: 2, center: [b/2, 0, 0], inertia: [0.1, 0.1, 0.1], points: {b: [0, 0, 0], k: [b, 0, 0]},
          near: {orientation: {axis: [0, 1, 0], angle: -135 deg}}}
joints:
  a: {type: pin, from: ground.A, to: left.a, axis: [0, 1, 0]}
  k: {type: line, from: left.k, to: right.k, axis: [0, 1, 0]}
  b: {type: pin, from: ground.B, to: right.b, axis: [0, 1, 0]}
"""
WEIGHT = ("--minimise", "joints.pivot.force.z")


@pytest.fixture(autouse=True)
def gable(folder: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """The scene; variants are solved in this process, where no number of others is asked for: forking it is costly."""
    (folder / "gable.yaml").write_text(GABLE)
    monkeypatch.setattr(jobs, "count_processors", lambda: 1)


def found_by(heun: Heun, *words: str, code: int = 0) -> dict[str, Any]:
    done = heun("tune", *words, "--format", "json")
    assert done.returncode == code, done.stderr
    found: dict[str, Any] = json.loads(done.stdout)
    return found


@pytest.mark.heavy
def test_the_table_and_the_line_that_can_be_pasted(heun: Heun) -> None:
    """The line gives the numbers of the best variant, to the bit."""
    words = ["b=1.05:1.9m", "--minimise", "joints.k.force", "--subject-to", "joints.a.force > 0.02 kN"]
    done = heun("tune", "gable.yaml", *words)
    assert done.returncode == 0 and done.stderr == ""
    assert (
        "tune  minimise joints.k.force, by b\n      converged: two restarts improved the goal by no more than"
        in done.stdout
    )
    for said in ("\nVARIABLES ", "\nb [m] ", "\nMOVES ", "\nMEASURES ", "\njoints.k.force [N] ", "> 20"):
        assert said in done.stdout
    *_, title, line = done.stdout.splitlines()
    assert title == "Command that reproduces these numbers exactly:" and line.startswith("heun run gable.yaml --set ")
    told = found_by(heun, "gable.yaml", *words)
    assert told["command"] == line
    _, *again = shlex.split(line)
    force, kept_to = heun(*again).stdout.splitlines()
    assert float(force) == told["goal"]["best"]["value"]
    assert float(kept_to) == told["constraints"][0]["best"]["value"] > 20.0
    assert [f"{name}={text}" for name, text in told["set"].items()] == again[3:4]


def test_json(heun: Heun) -> None:
    told = found_by(heun, "hanging.yaml", "m=2:0.5kg", *WEIGHT, "--seed", "3")
    assert (told["ended"], told["converged"], told["feasible"]) == ("converged", True, True)
    goal, (m,) = told["goal"], told["variables"]
    assert (goal["measure"], goal["unit"], goal["kind"]) == ("joints.pivot.force.z", "N", "minimise")
    assert goal["before"]["value"] == pytest.approx(9.81) and goal["best"]["value"] == pytest.approx(4.905)
    assert goal["best"]["error"] >= 0.0 and goal["gain"] <= goal["floor"]
    assert (m["low"], m["high"], m["before"], m["value"], m["active"]) == (0.5, 2.0, 1.0, 0.5, "low")
    assert m["moves"]["hundredth"][0] == {"by": 0.0, "until": "bound"}
    assert m["moves"]["hundredth"][1]["by"] == pytest.approx(0.005, rel=0.25)
    assert told["set"] == {"m": "0.5 kg"} and told["seed"] == 3 and told["allowed"] == 400
    history = told["history"]
    assert len(history) == told["evaluations"] <= 400 and [row["number"] for row in history] == [
        *range(1, len(history) + 1)
    ]
    assert history[-1]["best"] == goal["best"]["value"]
    for before, after in pairwise(history):
        assert after["best"] == min(before["best"], after["goal"])


@pytest.mark.heavy
@pytest.mark.long
def test_the_history_as_a_file(heun: Heun, folder: Path) -> None:
    words = ["gable.yaml", "b=0.5:1.9m", "--maximise", "joints.k.force", "--history", "tried.csv"]
    told = found_by(heun, *words, "--subject-to", "joints.k.force<50", "--evaluations", "60")
    rows = list(csv.reader(io.StringIO((folder / "tried.csv").read_text())))
    heads = ["number", "phase", "b [m]", "joints.k.force [N]", "error", "at [s]", "joints.k.force [N]", "best so far"]
    assert rows[0] == [*heads, "code"] and len(rows) == 61
    for row, one in zip(rows[1:], told["history"], strict=True):
        assert (int(row[0]), row[1], f"{row[2]} m") == (one["number"], one["phase"], one["set"]["b"])
        assert (float(row[3]) if row[3] else None) == one["goal"] and row[8] == one.get("code", "")
        assert (float(row[7]) if row[7] else None) == one["best"]


@pytest.mark.heavy
@pytest.mark.long
def test_half_of_the_box_does_not_close(heun: Heun) -> None:
    """Counted by its code; the best lies in the other half."""
    told = found_by(heun, "gable.yaml", "b=0.8:1.8m", "--minimise", "joints.k.force", "--evaluations", "200")
    assert told["converged"] and told["variables"][0]["value"] > 1.0
    (code,) = told["unsolved"]
    assert told["unsolved"][code] > 3
    done = heun("tune", "gable.yaml", "b=0.2:1.8m", "--minimise", "joints.k.force", "--evaluations", "9")
    assert re.search(rf"9 variants, of which \d could not be solved: {code} \d\n", done.stdout)


@pytest.mark.heavy
def test_nothing_can_be_solved(heun: Heun) -> None:
    done = heun("tune", "gable.yaml", "b=0.2:0.9m", "--minimise", "joints.k.force", "--evaluations", "3")
    assert done.returncode == 3 and done.stdout == ""
    assert "none of 3 variants could be solved; 3 of them for this reason: joint k" in done.stderr
    assert "hint: " in done.stderr


def test_negative_masses_are_variants_that_cannot_be_solved(heun: Heun) -> None:
    told = found_by(heun, "hanging.yaml", "m=-1:1kg", "--maximise", "joints.pivot.force.z")
    assert told["goal"]["best"]["value"] == pytest.approx(9.81) and told["unsolved"]["not-positive"] > 3


@pytest.mark.heavy
def test_the_budget_is_kept_and_said(heun: Heun) -> None:
    words = ("tune", "gable.yaml", "b=1.05:1.9m", "m=1:4kg", "--minimise", "joints.k.force", "--evaluations", "20")
    done = heun(*words)
    assert done.returncode == 0
    assert "not converged: all 20 evaluations are used up; this is the best so far; --evaluations 40" in done.stdout
    assert "MOVES" not in done.stdout
    done = heun(*words, "--strict")
    assert done.returncode == 1 and "not converged" in done.stdout


@pytest.mark.heavy
def test_nothing_feasible_is_said(heun: Heun) -> None:
    words = ["tune", "hanging.yaml", "m=1:2kg", *WEIGHT, "--subject-to", "joints.pivot.force.z < 9 N"]
    words += ["--subject-to", "joints.pivot.force.z > 1 N"]
    done = heun(*words)
    assert done.returncode == 0 and "no values meet all limits" in done.stdout
    assert "closest limit: joints.pivot.force.z < 9 N, exceeded by 0.81 N" in done.stdout
    assert "not met" in done.stdout
    assert heun(*words, "--strict").returncode == 1
    told = found_by(heun, *words[1:])
    assert not told["feasible"] and told["variables"][0]["value"] == 1.0
    first, second = told["constraints"]
    assert not first["met"] and first["left"] == pytest.approx(-0.81)
    assert second["met"] and second["left"] == pytest.approx(8.81)


@pytest.mark.heavy
def test_what_is_asked_of_a_constraint_that_is_just_met(heun: Heun) -> None:
    """At its limit < is not met and <= is."""
    told = found_by(heun, "hanging.yaml", "m=1:2kg", "--maximise", "joints.pivot.force.z",
                    "--subject-to", "joints.pivot.force.z <= 14.715 N")  # fmt: skip
    (kept_to,) = told["constraints"]
    assert kept_to["met"] and kept_to["active"] and told["goal"]["best"]["value"] == pytest.approx(14.715, abs=1e-4)


@pytest.mark.heavy
def test_units_of_the_table(heun: Heun) -> None:
    words = ["hanging.yaml", "m=1:2kg", *WEIGHT, "--subject-to", "joints.pivot.force.z > 12 N", "--units", "kN"]
    words += ["--evaluations", "16"]
    done = heun("tune", *words)
    assert "joints.pivot.force.z [kN]" in done.stdout and "> 0.012" in done.stdout and done.stderr == ""
    done = heun("tune", *words, "--format", "json")
    assert json.loads(done.stdout)["goal"]["unit"] == "N" and "json stays in SI" in done.stderr


@pytest.mark.heavy
@pytest.mark.long
def test_what_is_set_for_all_variants(heun: Heun, folder: Path) -> None:
    """Load case, overrides and tolerance hold in all of them, and stand in the line that is told."""
    cases = HANGING.replace("-9.81]", "-g]").replace("{m: 1.0}", "{m: 1.0, g: 10}")
    (folder / "cases.yaml").write_text(cases + "cases: {heavy: {set: {g: 20}}}\n")
    for extra, weight in (([], 10.0), (["--case", "heavy"], 20.0), (["--set", "g=30"], 30.0)):
        told = found_by(heun, "cases.yaml", "m=1:2kg", *WEIGHT, *extra, "--tolerance", "1e-8")
        assert told["goal"]["best"]["value"] == pytest.approx(weight)
        assert float(heun(*shlex.split(told["command"])[1:]).stdout) == told["goal"]["best"]["value"]
        assert "--tolerance 1e-08" in told["command"]


def test_the_spec_from_standard_input_and_the_result_to_a_file(heun: Heun, folder: Path) -> None:
    done = heun("tune", "-", "m=1:2kg", *WEIGHT, "-o", "best.json", text=HANGING)
    assert done.returncode == 0 and done.stdout == ""
    assert json.loads((folder / "best.json").read_text())["set"] == {"m": "1.0 kg"}


@pytest.mark.heavy
def test_several_processes_give_the_same(heun: Heun) -> None:
    words = ["gable.yaml", "b=0.9:1.9m", "m=1:4kg", "--minimise", "joints.k.force", "--evaluations", "24"]
    found = found_by(heun, *words)
    assert found["unsolved"] and found == found_by(heun, *words, "--jobs", "3")


@pytest.mark.heavy
def test_the_time_limit_tells_the_best_so_far(heun: Heun) -> None:
    """A tenth of a second a variant: hundreds, which it takes to converge, are far off on any machine."""
    words = ["m=1:2kg", "gravity.2=-11:-9", "--minimise", "max joints.pivot.force.z"]
    done = heun("tune", "swinging.yaml", *words, "--set", "analysis.duration=300", "--time-limit", "4")
    assert done.returncode == 4 and "not converged: the time limit is reached; this is the best so far" in done.stdout


@pytest.mark.heavy
def test_a_time_limit_before_anything_is_solved(heun: Heun) -> None:
    done = heun("tune", "long.yaml", "m=1:2kg", *WEIGHT, "--time-limit", "0.3")
    assert done.returncode == 4 and done.stdout == "" and "[time-limit]" in done.stderr


@pytest.mark.parametrize(
    ("words", "said"),
    [
        (["hanging.yaml", "m=1:2kg"], "no goal is given"),
        (["hanging.yaml", "m=1:2kg", *WEIGHT, "--maximise", "joints.pivot.force.z"], "both --minimise and --maximise"),
        (["m=1:2kg", *WEIGHT], "no spec is given"),
        (["hanging.yaml", "other.yaml", "m=1:2kg", *WEIGHT], "2 files"),
        (["hanging.yaml", *WEIGHT], "no parameter to vary is given"),
        (["hanging.yaml", "m=1:2kg", "m=2:3kg", *WEIGHT], "is varied twice"),
        (["hanging.yaml", "m=1:1kg", *WEIGHT], "both ends are the same"),
        (["hanging.yaml", "m=1kg", *WEIGHT], "expected NAME=a:b"),
        (["hanging.yaml", "q=1:2kg", *WEIGHT], "'q'"),
        (["hanging.yaml", "m=1:2mm", *WEIGHT], "[wrong-dimension]"),
        (["hanging.yaml", "m=1:2kg", "--minimise", "joints.pivot.force.q"], "[unknown-path]"),
        (["hanging.yaml", "m=1:2kg", "--minimise", "largest joints.pivot.force.z"], "expected [max | min"),
        (["swinging.yaml", "m=1:2kg", *WEIGHT], "use max, min"),
        (["hanging.yaml", "m=1:2kg", *WEIGHT, "--subject-to", "joints.pivot.force.z = 3"], "has < or >"),
        (["hanging.yaml", "m=1:2kg", *WEIGHT, "--subject-to", "joints.pivot.force.z < 3 mm"], "'3 mm' is a length"),
        (["hanging.yaml", "m=1:2kg", *WEIGHT, "--subject-to", "joints.pivot.force.z"], "expected MEASURE"),
        (["hanging.yaml", "m=1:2kg", *WEIGHT, "--subject-to", "joints.pivit.force.z < 3"], "[unknown-path]"),
        (["hanging.yaml", "m=1:2kg", *WEIGHT, "--evaluations", "0"], "expected 1 to"),
        (["hanging.yaml", "m=1:2kg", *WEIGHT, "--precision", "0"], "expected more than 0"),
        (["hanging.yaml", "m=1:2kg", *WEIGHT, "--seed", "-1"], "expected 0 or more"),
        (["hanging.yaml", "m=1:2kg", *WEIGHT, "--jobs", "0"], "expected 1 or more"),
        (["hanging.yaml", "m=1:2kg", *WEIGHT, "--format", "csv"], "expected table, json"),
        (["hanging.yaml", "m=1:2kg", *WEIGHT, "-o", "hanging.yaml", "--format", "json"], "the spec itself"),
        (["hanging.yaml", "m=1:2kg", *WEIGHT, "--history", "hanging.yaml"], "the spec itself"),
        (["hanging.yaml", "m=1:2kg", *WEIGHT, "-o", "a.json", "--history", "a.json"], "result is written to this"),
        (["wrong.yaml", "m=1:2kg", *WEIGHT], "[unknown-joint-type]"),
    ],
)  # fmt: skip
def test_refused(heun: Heun, words: list[str], said: str) -> None:
    """Before anything is searched, with a hint."""
    done = heun("tune", *words)
    assert done.returncode == 2 and done.stdout == ""
    assert said in done.stderr and "hint: " in done.stderr


def test_a_spec_is_not_written_over(heun: Heun, folder: Path) -> None:
    before = (folder / "hanging.yaml").read_text()
    heun("tune", "hanging.yaml", "m=1:2kg", *WEIGHT, "--history", "hanging.yaml")
    assert (folder / "hanging.yaml").read_text() == before


JUMPING = """\
heun: 1
title: A goal under a limit that jumps
parameters: {{x: 0.2}}
ground: {{points: {{O: [0, 0, 0]}}}}
bodies:
  a: {{mass: 1, center: [0, 0, 0], inertia: [1, 1, 1], points: {{o: [0, 0, 0]}}}}
joints:
  w: {{type: weld, from: ground.O, to: a.o}}
forces:
  f: {{type: force, on: a.o, vector: ["-(x-0.9)**2", "{law}", 0]}}
analysis: {{type: state}}
"""


@pytest.mark.heavy
@pytest.mark.parametrize(
    ("law", "place"),
    [
        ("1 if x < 0.437 else 3", 0.437),
        pytest.param("x if x < 0.6 else 2+x", 0.6, marks=pytest.mark.long),
        pytest.param("tanh(1e4*(x-0.437))+2", None, marks=pytest.mark.long),
        ("2+sign(x-0.437)*sqrt(abs(x-0.437))", None),
        pytest.param("4*x", None, marks=pytest.mark.long),
    ],
)
def test_a_limit_that_jumps_is_told(heun: Heun, folder: Path, law: str, place: float | None) -> None:
    """Steep and vertical laws that pass their limit do not jump."""
    (folder / "jumping.yaml").write_text(JUMPING.format(law=law))
    words = ["jumping.yaml", "x=0:1", "--minimise", "joints.w.force.x", "--subject-to", "joints.w.force.y >= -2"]
    found = found_by(heun, *words)
    (x,) = found["variables"]
    up = x["moves"]["hundredth"][1]
    assert up.get("jumps") == ("joints.w.force.y" if place is not None else None)
    assert ("beside a jump: joints.w.force.y jumps where x goes up" in heun("tune", *words).stdout) == (
        place is not None
    )
    if place is not None:
        assert x["value"] == pytest.approx(place, abs=1e-4)
        assert up["until"] == "joints.w.force.y"
