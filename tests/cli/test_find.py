"""`heun find`: what it writes, what it refuses, and its exit codes."""

from __future__ import annotations

import csv
import io
import json
from pathlib import Path
from typing import get_args

import pytest

from heuncli.analyses.variants.measures import MISSING_KINDS, MissingWord
from tests.shared.command import Heun
from tests.shared.variant_scenes import CANTILEVER, PENDULUM, ROOT, TENSION, TWO_BARS

pytestmark = pytest.mark.heavy  # what is told of hundreds of runs is the same with both kernels

FOUND = ("find", "-", "a=5:95deg", f"{TENSION} = 0.03 kN")


def test_a_table_shows_the_crossing_in_the_units_that_were_given(heun: Heun) -> None:
    done = heun(*FOUND, text=PENDULUM)
    lines = done.stdout.splitlines()
    assert done.returncode == 0 and done.stderr == ""
    assert any(line.startswith(f"find  {TENSION} = 0.03 kN, a from 5 to 95 deg") for line in lines)
    head = next(line for line in lines if line.lstrip().startswith("a [deg]"))
    row = lines[lines.index(head) + 1].split()
    assert "measure [kN]" in head
    assert row[0].startswith("42.6527158") and float(row[2]) == pytest.approx(0.03) and row[4] == "rises"
    assert row[5:7] == ["--set", f"a='{row[6].removeprefix(chr(97) + chr(61) + chr(39))}"]


def test_units_of_tables(heun: Heun) -> None:
    done = heun(*FOUND, "--units", "N", text=PENDULUM)
    assert "measure [N]" in done.stdout and " 30.0000" in done.stdout
    done = heun(*FOUND, "--units", "kN", "--format", "json", text=PENDULUM)
    assert json.loads(done.stdout)["value"] == 30.0 and "--units applies to tables only" in done.stderr


def test_csv_holds_all_places(heun: Heun, folder: Path) -> None:
    assert heun(*FOUND, "-o", "found.csv", text=PENDULUM).returncode == 0
    rows = list(csv.DictReader(io.StringIO((folder / "found.csv").read_text())))
    told = json.loads(heun(*FOUND, "--format", "json", text=PENDULUM).stdout)
    (crossing,) = [row for row in rows if row["kind"] == "crossing"]
    assert float(crossing["value"]) == told["crossings"][0]["x"] and crossing["unit"] == "deg"
    assert [float(row["value"]) for row in rows if row["kind"] == "course"] == [each["x"] for each in told["course"]]


def test_nothing_is_found_is_no_error_but_under_strict(heun: Heun) -> None:
    words = ("find", "-", "a=5:95deg", f"{TENSION} > 1 kN")
    done = heun(*words, text=PENDULUM)
    assert done.returncode == 0 and "met nowhere: minimum 0.0197" in done.stdout
    assert heun(*words, "--strict", text=PENDULUM).returncode == 1
    assert heun(*FOUND, "--strict", text=PENDULUM).returncode == 0
    met = heun("find", "-", "a=5:95deg", f"{TENSION} < 1 kN", "--strict", text=PENDULUM)
    assert met.returncode == 0 and met.stdout.count("end of the interval") == 2


def test_parts_that_cannot_be_solved_fail_under_strict(heun: Heun) -> None:
    """Both ends of the interval are left out; what is asked for is met between them, and alone would be no failure."""
    text = PENDULUM.replace("mass: m}", "mass: m if abs(a - 0.8) < 0.5 else -1}")
    done = heun(*FOUND, "--strict", text=text)
    assert done.returncode == 1 and done.stdout.count("[not-positive]") == 2 and "rises" in done.stdout
    assert heun(*FOUND, text=text).returncode == 0


def test_where_nothing_can_be_solved(heun: Heun) -> None:
    done = heun("find", "-", "b=2:3", "joints.C.force = 40 N", "--scan", "4", text=TWO_BARS)
    assert done.returncode == 3 and done.stdout == "" and "none of the 4 variants" in done.stderr
    assert "[does-not-fit]" in done.stderr and "hint: " in done.stderr


def test_open_values_are_told_with_their_word(heun: Heun) -> None:
    text = TWO_BARS.replace("space: planar\n", "")  # pins in space hold each other: what is across the plane is open
    text = text.replace("inertia: 1", "inertia: [1, 1, 1]").replace("type: pin,", "type: pin, axis: [0, 0, 1],")
    done = heun("find", "-", "b=0.6:1.4", "joints.C.force.z = 1 N", text=text)
    assert done.returncode == 3 and "statically indeterminate" in done.stderr and "[open]" in done.stderr


def test_a_spent_budget_is_told(heun: Heun) -> None:
    done = heun("find", "-", "a=5:95deg", f"{TENSION} = 30 N", "--evaluations", "8", text=PENDULUM)
    assert done.returncode == 0 and "stopped after 8 variants" in done.stdout


def test_a_finer_scan(heun: Heun) -> None:
    told = json.loads(heun(*FOUND, "--scan", "25", "--format", "json", text=PENDULUM).stdout)
    assert told["scan"] == 25 and told["spacing"] < 6.0 and len(told["course"]) >= 25


def test_a_load_case_and_set_values(heun: Heun) -> None:
    text = PENDULUM + "cases: {heavy: {title: heavy, set: {m: 4 kg}}}\n"
    one = json.loads(heun(*FOUND, "--set", "m=4 kg", "--format", "json", text=text).stdout)
    other = json.loads(heun(*FOUND, "--case", "heavy", "--format", "json", text=text).stdout)
    assert one["course"] == other["course"] and one["crossings"] == []  # it weighs more than 30 N at rest


def test_the_value_may_be_an_expression(heun: Heun) -> None:
    told = json.loads(heun("find", "-", "a=5:95deg", f"{TENSION} = 2*m*g", "--format", "json", text=PENDULUM).stdout)
    assert told["value"] == 2.0 * 2.0 * 9.81
    done = heun("find", "-", "m=1:5kg", f"{TENSION} = 2*m*g", text=PENDULUM)
    assert done.returncode == 2 and "depends on what is varied" in done.stderr


@pytest.mark.parametrize(
    ("unknown", "condition", "code", "said"),
    [
        ("a=5:95deg", f"{TENSION} = 30 mm", "dimension", "a length, expected a force"),
        ("a=5:95deg", f"{TENSION}", "bad-option", "expected MEASURE"),
        ("a=5:95deg", f"{TENSION} =", "bad-option", "no value after the '='"),
        ("a=5:95deg", "= 3 N", "bad-option", "no measure before the '='"),
        ("a=5:95deg", "max joints.pivt.force = 3 N", "unknown-path", "did you mean"),
        ("a=5:5deg", f"{TENSION} = 30 N", "bad-option", "both ends are the same"),
        ("a=5deg", f"{TENSION} = 30 N", "bad-option", "an interval"),
        ("b=5:95deg", f"{TENSION} = 30 N", "no-such-key", "there is no parameter 'b'"),
        ("a=5:95mm", f"{TENSION} = 30 N", "wrong-dimension", "a is a length"),
    ],
)
def test_refused_before_anything_is_solved(heun: Heun, unknown: str, condition: str, code: str, said: str) -> None:
    done = heun("find", "-", unknown, condition, text=PENDULUM)
    assert done.returncode == 2 and done.stdout == ""
    assert f"[{code}]" in done.stderr and said in done.stderr and "hint: " in done.stderr


@pytest.mark.parametrize(("option", "value"), [("--scan", "3"), ("--evaluations", "5"), ("--tolerance", "2")])
def test_options_that_cannot_be(heun: Heun, option: str, value: str) -> None:
    done = heun(*FOUND, option, value, text=PENDULUM)
    assert done.returncode == 2 and "[bad-option]" in done.stderr


def test_components_have_their_unit(heun: Heun) -> None:
    done = heun("find", "-", "F=10:900N", f"{ROOT} = -0.03 kNm", text=CANTILEVER)
    assert done.returncode == 0 and "measure [kNm]" in done.stdout and "falls" in done.stdout


def test_the_spec_is_not_written_over(heun: Heun, folder: Path) -> None:
    (folder / "pendulum.yaml").write_text(PENDULUM)
    done = heun("find", "pendulum.yaml", *FOUND[2:], "--format", "json", "-o", "pendulum.yaml")
    assert done.returncode == 2 and (folder / "pendulum.yaml").read_text() == PENDULUM


def test_a_time_limit(heun: Heun) -> None:
    long = PENDULUM.replace("duration: 1.2", "duration: 4000")
    done = heun("find", "-", *FOUND[2:], "--time-limit", "0.5", text=long)
    assert done.returncode == 4 and "[time-limit]" in done.stderr and done.stdout == ""


def test_each_word_for_what_is_not_known_has_its_reason() -> None:
    assert MISSING_KINDS.keys() == {word for word in get_args(MissingWord) if word}
