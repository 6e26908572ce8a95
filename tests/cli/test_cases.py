"""Load cases: a case is what `--set` of the same values is; the envelope is that of separate runs."""

from __future__ import annotations

import csv
import io
import json
from pathlib import Path

import pytest

from heuncli.app.commands.run import cases
from heuncli.base.text_safety import escape
from heuncli.output.documents.as_data import format_line
from heuncli.scene.file_format.load import load
from tests.shared.command import HANGING, Heun

CASES = """\
cases:
  heavy: {title: with its load, set: {m: 3 kg}}
  tilted: {set: {gravity: [0, 6, -8], bodies.bar.center: [0, 0, -0.6]}}
expect:
  - {of: foundation.force.x, is: 0}
  - {of: joints.pivot.force.z, case: heavy, is: 29.43}
  - {of: joints.pivot.force.y, case: tilted, is: -6}
"""
STATE = "analysis: {type: state}\n"


@pytest.fixture
def scene(folder: Path) -> Path:
    (folder / "cases.yaml").write_text(HANGING.replace("type: ball", "type: weld") + STATE + CASES)
    return folder


def test_a_case_is_what_set_of_its_values_is(heun: Heun, scene: Path) -> None:
    case = json.loads(heun("run", "cases.yaml", "--case", "tilted", "--format", "json").stdout)
    words = ("--set", "gravity=[0, 6, -8]", "--set", "bodies.bar.center=[0, 0, -0.6]")
    put = json.loads(heun("run", "cases.yaml", *words, "--format", "json").stdout)
    for block in (case, put):
        del block["work"], block["title"]
    assert case == put


def test_set_goes_on_top_of_a_case(heun: Heun, scene: Path) -> None:
    done = heun("run", "cases.yaml", "--case", "heavy", "--set", "m=5", "--measure", "foundation.force.z")
    assert float(done.stdout) == pytest.approx(-5 * 9.81, rel=1e-14)


def test_the_envelope_is_that_of_separate_runs(heun: Heun, scene: Path) -> None:
    told = json.loads(heun("run", "cases.yaml", "--case", "all", "--format", "json").stdout)
    assert [*told["cases"]] == ["heavy", "tilted"]
    for path in ("joints.pivot.force.z", "joints.pivot.moment.x"):
        name, kind, axis = path.split(".")[1:]
        by_case = {case: one["joints"][name][kind][0]["xyz".index(axis)] for case, one in told["cases"].items()}
        row = told["envelope"][path]
        assert (row["min"]["value"], row["max"]["value"]) == (min(by_case.values()), max(by_case.values()))
        assert row["max"]["case"] == max(by_case, key=lambda case: by_case[case])
        assert row["min"]["case"] == min(by_case, key=lambda case: by_case[case])


def test_all_forms_name_the_case(heun: Heun, scene: Path) -> None:
    table = heun("run", "cases.yaml", "--case", "all").stdout
    assert "(case heavy: with its load)" in table
    assert table.index("(case tilted)") < table.index("ENVELOPE  of all load cases")
    head, *lines = heun("run", "cases.yaml", "--case", "all", "--format", "csv").stdout.splitlines()
    assert head.startswith("case,time,")
    assert {line.split(",")[0] for line in lines} == {"heavy", "tilted"}
    measured = heun("run", "cases.yaml", "--case", "all", "--measure", "foundation.force.z").stdout
    assert [line.split()[0] for line in measured.splitlines()] == ["heavy", "tilted"]


def test_what_is_expected_in_a_case_and_in_all(heun: Heun, scene: Path) -> None:
    assert heun("check", "cases.yaml").stdout == "1 spec, 5 checks passed, 0 failed\n"
    spec = scene / "cases.yaml"
    spec.write_text(spec.read_text().replace("is: 29.43", "is: 29.5"))
    found = json.loads(heun("check", "cases.yaml", "--format", "json").stdout)
    assert [case["case"] for case in found["cases"] if not case["passed"]] == ["heavy"]


def test_a_golden_file_holds_all_cases(heun: Heun, scene: Path) -> None:
    heun("check", "cases.yaml", "--golden", "g", "--update", "--force")
    assert [*json.loads((scene / "g" / "cases.json").read_text())["cases"]] == ["heavy", "tilted"]
    spec = scene / "cases.yaml"
    text = spec.read_text()
    spec.write_text(text.replace("m: 3 kg", "m: 3.001 kg").replace("29.43", "29.43981"))
    done = heun("check", "cases.yaml", "--golden", "g")
    assert done.returncode == 1
    assert "heavy: joints.pivot.force.z" in done.stdout
    assert "tilted: " not in done.stdout
    spec.write_text(text.replace("  tilted:", "  other:").replace("case: tilted", "case: other"))
    told = heun("check", "cases.yaml", "--golden", "g").stdout
    assert "tilted: the case" in told
    assert "other: the case" in told


@pytest.mark.parametrize(
    ("change", "place", "told"),
    [
        (("m: 3 kg", "n: 3 kg"), "cases.heavy.set.n", "there is no parameter 'n' to set [no-such-key]"),
        (("bodies.bar.c", "bodies.bat.c"), "set.bodies.bat.center", "did you mean bar?"),
        (("case: heavy", "case: haevy"), "expect.1.case", "there is no load case 'haevy' [unknown-case]"),
        (("m: 3 kg", "m: -3 kg"), "bodies.bar.mass", "in case heavy: mass must be greater than 0"),
        (("m: 3 kg", "m: 3 m"), "bodies.bar.mass", "in case heavy: "),
        (("m: 3 kg", "cases.tilted.set.m: 2"), "cases.heavy.set", "in a load case [no-such-key]"),
        (("  heavy:", "  all:"), "cases.all", "[reserved-name]"),
        (("  heavy: {title: with its load, set: {m: 3 kg}}", "  heavy: 3"), "cases.heavy", "[wrong-kind]"),
    ],
)
def test_what_is_wrong_in_a_case_is_told_at_its_place(
    heun: Heun, scene: Path, change: tuple[str, str], place: str, told: str
) -> None:
    spec = scene / "cases.yaml"
    spec.write_text(spec.read_text().replace(*change))
    done = heun("validate", "cases.yaml")
    assert done.returncode == 2
    assert place in done.stderr
    assert told in done.stderr


def test_an_unknown_case_is_told_with_the_nearest_name(heun: Heun, scene: Path) -> None:
    for command in ("run", "model", "probe", "modes", "lagrange"):
        done = heun(command, "cases.yaml", "--case", "heavyy")
        assert done.returncode == 2, command
        assert "did you mean heavy?" in done.stderr
    assert heun("run", "hanging.yaml", "--case", "all").returncode == 2


def test_without_a_case_a_scene_is_as_it_stands(scene: Path) -> None:
    spec = load(str(scene / "cases.yaml"))
    assert (spec.case, dict(spec.cases)) == (None, {"heavy": "with its load", "tilted": ""})
    assert [item.of for item in spec.expect] == ["foundation.force.x"]


def test_no_case_governs_rounding_or_what_is_alike(heun: Heun, folder: Path) -> None:
    """The weight on a slanting pin: its moments are rounding; the sideways force is that of one case, or alike."""
    cases = "cases:\n  one: {set: {m: 1 kg}}\n  same: {set: {m: 1.0 kg}}\n  heavy: {set: {m: 3 kg}}\n"
    (folder / "cases.yaml").write_text(HANGING.replace("type: ball", "type: weld") + STATE + cases)
    envelope = json.loads(heun("run", "cases.yaml", "--case", "all", "--format", "json").stdout)["envelope"]
    low, high = (envelope["joints.pivot.force.z"][word] for word in ("min", "max"))
    assert (high["case"], "alike" in high) == ("heavy", False)
    assert {low["case"], *low["alike"]} == {"one", "same"}
    assert envelope["joints.pivot.force.x"]["max"]["case"] is None
    table = heun("run", "cases.yaml", "--case", "all").stdout.partition("ENVELOPE")[2]
    assert "joints.pivot.force.x" not in table
    assert "one, same" in table


def test_a_cell_with_a_line_break_stays_one_cell() -> None:
    text = format_line(["of", "text"]) + format_line(["x", 'two\u2028 "lines"']) + '"a\nb",1\n'
    rows = list(csv.reader(io.StringIO("".join(cases._iter_csv({"one": text, "two": text})))))
    assert [row[0] for row in rows] == ["case", "one", "one", "two", "two"]
    assert rows[2][1:] == [escape("a\nb"), "1"]
