"""`heun sensitivity`: what it writes, what it refuses, and its exit codes."""

from __future__ import annotations

import csv
import io
import json
from pathlib import Path

import pytest

from tests.shared.command import Heun
from tests.shared.variant_scenes import CANTILEVER, PENDULUM, ROOT, TENSION, TWO_BARS

pytestmark = pytest.mark.heavy  # what is told of hundreds of runs is the same with both kernels

ASKED = ("sensitivity", "-", "--measure", TENSION)


def test_a_table_of_all_parameters_the_largest_first(heun: Heun) -> None:
    done = heun(*ASKED, text=PENDULUM)
    lines = done.stdout.splitlines()
    assert done.returncode == 0 and done.stderr == ""
    start = next(
        i for i, line in enumerate(lines) if line.startswith("DERIVATIVES  of max joints.pivot.force = 28.800")
    )
    names = [line.split()[0] for line in lines[start + 2 : start + 7]]
    assert set(names[:2]) == {"m", "g"} and names[2:] == ["a", "L", "idle"]
    assert "N/kg" in lines[start + 2] + lines[start + 3] and "N/deg" in lines[start + 4]
    assert lines[start + 5].endswith("0 within its error") and lines[start + 6].endswith("no effect")


def test_several_measures_share_their_runs(heun: Heun) -> None:
    one = json.loads(heun(*ASKED, "--format", "json", text=PENDULUM).stdout)
    both = json.loads(heun(*ASKED, "--measure", TENSION, "--format", "json", text=PENDULUM).stdout)
    assert both["runs"] == one["runs"] and both["measures"] == one["measures"] * 2


def test_processes_change_nothing(heun: Heun) -> None:
    words = (*ASKED, "--measure", "final energy.kinetic", "--spread", "a=1deg,L=5mm", "--format", "json")
    one, two = (heun(*words, "--jobs", count, text=PENDULUM) for count in ("1", "2"))
    assert (one.returncode, one.stdout, one.stderr) == (two.returncode, two.stdout, two.stderr)
    refused = heun(*ASKED, "--jobs", "0", text=PENDULUM)
    assert refused.returncode == 2 and "--jobs 0: expected 1 or more" in refused.stderr


def test_parameters_that_follow_from_others_are_not_asked_by_default(heun: Heun) -> None:
    text = PENDULUM.replace("idle: 3 mm", "idle: 2*L")
    told = json.loads(heun(*ASKED, "--format", "json", text=text).stdout)
    assert "idle" not in {each["name"] for each in told["measures"][0]["derivatives"]}
    told = json.loads(heun(*ASKED, "idle", "--format", "json", text=text).stdout)
    assert [(each["name"], each["value"]) for each in told["measures"][0]["derivatives"]] == [("idle", 1.0)]


def test_values_are_those_of_the_case_and_of_set(heun: Heun) -> None:
    text = PENDULUM + "cases: {heavy: {title: heavy, set: {m: 4 kg}}}\n"
    for words, value, unit in ((("--case", "heavy"), 4.0, "kg"), (("--set", "m=500 g"), 500.0, "g")):
        told = json.loads(heun(*ASKED, "m", *words, "--format", "json", text=text).stdout)
        (one,) = told["measures"][0]["derivatives"]
        assert (one["value"], one["unit"]) == (value, unit)
        assert one["derivative_si"] == pytest.approx(28.80041605 / 2.0, rel=1e-6)


def test_units_of_tables(heun: Heun) -> None:
    done = heun(*ASKED, "m", "--units", "kN", text=PENDULUM)
    assert "= 0.0288004" in done.stdout and "kN/kg" in done.stdout


def test_csv(heun: Heun, folder: Path) -> None:
    assert heun(*ASKED, "--spread", "m=1g,a=1deg", "-o", "told.csv", text=PENDULUM).returncode == 0
    rows = list(csv.DictReader(io.StringIO((folder / "told.csv").read_text())))
    assert [row["kind"] for row in rows] == ["derivative", "derivative", "worst", "root_sum_square"]
    told = json.loads(heun(*ASKED, "--spread", "m=1g,a=1deg", "--format", "json", text=PENDULUM).stdout)
    assert float(rows[2]["contribution"]) == told["measures"][0]["spread"]["worst"]


def test_refused_derivatives_fail_under_strict(heun: Heun) -> None:
    words = ("sensitivity", "-", "at_once", "--measure", "joints.root.force.z")
    done = heun(*words, text=CANTILEVER)
    assert done.returncode == 0 and "[not-smooth]" in done.stdout and "jump of" in done.stdout
    assert heun(*words, "--strict", text=CANTILEVER).returncode == 1
    assert heun("explain", "not-smooth").returncode == heun("explain", "no-error").returncode == 0


def test_a_spread_too_large_for_the_sum_is_told(heun: Heun) -> None:
    done = heun("sensitivity", "-", "--measure", "joints.C.force", "--spread", "b=0.15,p=0.15", text=TWO_BARS)
    assert "b is not linear over its spread: " in done.stdout and "searched inside the spreads" in done.stdout
    assert "found by changing several parameters together" in done.stdout
    small = heun("sensitivity", "-", "--measure", "joints.C.force", "--spread", "b=1e-4,p=1e-4", text=TWO_BARS).stdout
    assert "searched" not in small and "too large" not in small


def test_a_scene_that_cannot_be_solved_is_its_own_error(heun: Heun) -> None:
    done = heun("sensitivity", "-", "b", "--measure", "joints.C.force", "--set", "b=3", text=TWO_BARS)
    assert done.returncode == 3 and "[does-not-fit]" in done.stderr and done.stdout == ""


@pytest.mark.parametrize(
    ("words", "code", "said"),
    [
        ((), "bad-option", "no --measure is given"),
        (("mm", "--measure", TENSION), "bad-option", "no number there"),
        (("joints.pivot.type", "--measure", TENSION), "bad-option", "not a number"),
        (("m=3", "--measure", TENSION), "bad-option", "expected a parameter"),
        (("--measure", "max joints.pivt.force"), "unknown-path", "did you mean"),
        (("--measure", TENSION, "--spread", "L=0.1"), "bad-option", "L is given in mm"),
        (("--measure", TENSION, "--spread", "L=1kg"), "bad-option", "a mass, but L is given in mm"),
        (("--measure", TENSION, "--spread", "L=-1mm"), "bad-option", "a positive number"),
        (("--measure", TENSION, "--spread", "L=1mm,L=2mm"), "bad-option", "two spreads"),
        (("--measure", TENSION, "--spread", "L"), "bad-option", "expected NAME=VALUE"),
    ],
)
def test_refused_before_anything_is_solved(heun: Heun, words: tuple[str, ...], code: str, said: str) -> None:
    done = heun("sensitivity", "-", *words, text=PENDULUM)
    assert done.returncode == 2 and done.stdout == ""
    assert f"[{code}]" in done.stderr and said in done.stderr and "hint: " in done.stderr


def test_no_spec(heun: Heun) -> None:
    assert heun("sensitivity", "--measure", TENSION).returncode == 2


def test_open_measures_are_told(heun: Heun) -> None:
    text = (
        TWO_BARS.replace("space: planar\n", "")
        .replace("inertia: 1", "inertia: [1, 1, 1]")
        .replace("type: pin,", "type: pin, axis: [0, 0, 1],")
    )
    done = heun("sensitivity", "-", "b", "--measure", "joints.C.force.z", text=text)
    assert done.returncode == 0 and "[open]" in done.stdout


def test_moments_have_theirs(heun: Heun) -> None:
    assert "N·m/kN" in heun("sensitivity", "-", "F", "--measure", ROOT, text=CANTILEVER).stdout
