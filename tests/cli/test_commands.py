"""The commands as a user types them: what they print, and where."""

from __future__ import annotations

import csv
import itertools
import json
from pathlib import Path
from typing import Any

import pytest

from heuncli.app.cli.entry import enter
from heuncli.base.errors import SpecError
from heuncli.scene.file_format.load import load_with_cases
from tests.shared.command import HANGING, SPEC_TEXTS, Heun


def row(text: str, name: str) -> list[str]:
    """The cells of the table row that begins with a name."""
    return next(line.split() for line in text.splitlines() if line.split()[:1] == [name])


def test_run_prints_tables_and_nothing_else(heun: Heun) -> None:
    done = heun("run", "hanging.yaml")
    assert (done.returncode, done.stderr) == (0, "")
    assert "A bar hangs at rest" in done.stdout
    assert row(done.stdout, "pivot")[-4:] == ["0", "0", "9.81", "9.81"]
    assert row(done.stdout, "total")[1:5] == ["0", "0", "-9.81", "9.81"]


def test_run_of_a_motion_tells_extremes_and_accuracy(heun: Heun) -> None:
    text = heun("run", "swinging.yaml").stdout
    for part in ("motion within", "first", "last", "at [s]", "JOINTS", "ENERGY"):
        assert part in text
    assert "t [s]" in heun("run", "swinging.yaml", "--at", "0.25,0.5").stdout
    every = heun("run", "swinging.yaml", "--all", "--only", "energy").stdout
    assert len(every.partition("ENERGY")[2].splitlines()) == 2 + 11 + 1  # heads, instants, and what is left out


def test_standard_input_and_every_format(heun: Heun) -> None:
    parsed = json.loads(heun("run", "-", "--format", "json", text=HANGING).stdout)
    assert parsed["joints"]["pivot"]["force"] == [[0.0, 0.0, pytest.approx(9.81)]]
    lines = heun("run", "hanging.yaml", "--format", "csv").stdout.splitlines()
    assert list(next(csv.DictReader(lines))) == ["time", "kind", "name", "quantity", "component", "unit", "value"]
    assert "| pivot |" in heun("run", "hanging.yaml", "--format", "markdown").stdout


def test_output_files_are_named_for_what_they_hold(heun: Heun, folder: Path) -> None:
    done = heun("run", "hanging.yaml", "-o", "out.json")
    assert (done.returncode, done.stdout) == (0, "")
    assert json.loads((folder / "out.json").read_text())["title"] == "A bar hangs at rest"
    heun("run", "hanging.yaml", "-o", "out.csv", "--format", "markdown")
    assert (folder / "out.csv").read_text().startswith("## A bar hangs at rest")


@pytest.mark.parametrize(("name", "form"), [
    ("out.JSON", "json"), ("out.md", "markdown"), ("out.csv", "csv"), ("out.txt", "table"), ("out", "table"),
    (".json", "json"), ("a.b.json", "json"),
])  # fmt: skip
def test_the_ending_names_the_format(heun: Heun, folder: Path, name: str, form: str) -> None:
    assert heun("run", "hanging.yaml", "-o", name, "--only", "joints").returncode == 0
    written = (folder / name).read_text()
    starts = {"json": "{", "markdown": "## ", "csv": "time,kind", "table": "heun "}
    assert written.startswith(starts[form])


@pytest.mark.parametrize("name", ["r.xlsx", "r.yaml", "r.csv.gz", "r.", "r.v2"])
@pytest.mark.parametrize("command", ["run", "model", "check"])
def test_an_ending_that_names_no_format_is_refused(heun: Heun, folder: Path, command: str, name: str) -> None:
    done = heun(command, "hanging.yaml", "-o", name)
    assert (done.returncode, done.stdout, (folder / name).exists()) == (2, "", False)
    assert f"-o {name}: unknown file extension .{name.rpartition('.')[2]} [bad-option]" in done.stderr
    assert ".json (json)" in done.stderr and "with --format" in done.stderr
    assert heun(command, "hanging.yaml", "-o", name, "--format", "json").returncode == 0
    json.loads((folder / name).read_text())


@pytest.mark.parametrize(("name", "told"), [
    ("", "expected a file name"), (".", "this is a folder"), ("no/r.json", "there is no folder no"),
])  # fmt: skip
def test_no_room_is_told_before_the_work(heun: Heun, name: str, told: str) -> None:
    done = heun("run", "long.yaml", "-o", name)
    assert (done.returncode, done.stdout) == (5 if name else 2, "")
    assert told in done.stderr


def test_what_the_results_are_made_from_stays(heun: Heun, folder: Path) -> None:
    """The spec of any command, and the table beside it that bears its name."""
    table = "tables: {g: {file: hanging.csv, x: 1, y: 2}}\n"
    (folder / "hanging.yaml").write_text(HANGING + table)
    (folder / "hanging.csv").write_text("x,y\n0,0\n1,1\n")
    for command in ("run", "model", "check"):
        for name, words in (("hanging.yaml", "the spec itself"), ("hanging.csv", "a table of the spec")):
            done = heun(command, "hanging.yaml", "-o", name, "--format", "json")
            assert (done.returncode, done.stdout) == (2, "")
            assert words in done.stderr
    assert (folder / "hanging.csv").read_text().startswith("x,y")
    assert (folder / "hanging.yaml").read_text().startswith("heun")


def test_no_reduce_gives_the_same_numbers(heun: Heun) -> None:
    """In full, or in the plane in which the scene stays."""
    words = ("run", "swinging.yaml", "--format", "json", "--only", "joints")
    full, plain = (json.loads(heun(*words, *more).stdout)["joints"] for more in (("--no-reduce",), ()))
    assert full.keys() == plain.keys()
    for name in full:
        assert plain[name]["force"] == [pytest.approx(row, rel=1e-7, abs=1e-7) for row in full[name]["force"]]


def test_only_what_is_asked_for_is_in_the_output(heun: Heun) -> None:
    parsed = json.loads(heun("run", "hanging.yaml", "--only", "joints", "--format", "json").stdout)
    assert "joints" in parsed
    assert not {"foundation", "bodies", "energy"} & parsed.keys()
    asked = SPEC_TEXTS["swinging"] + "report: [motion, energy]\n"
    text = heun("run", "-", text=asked).stdout
    assert "MOTION" in text
    assert "JOINTS" not in text
    assert "MOTION" not in heun("run", "swinging.yaml").stdout


def test_a_report_of_what_the_scene_has_not_says_so(heun: Heun) -> None:
    done = heun("run", "swinging.yaml", "--only", "sections")
    assert done.returncode == 0
    assert "nothing to show for sections: the model has none" in done.stdout


def test_instants_of_an_export(heun: Heun) -> None:
    parsed = json.loads(heun("run", "swinging.yaml", "--format", "json", "--at", "0.25,0.75").stdout)
    assert parsed["time"] == [0.25, 0.75]


def test_measure_and_set(heun: Heun) -> None:
    done = heun("run", "hanging.yaml", "--measure", "joints.pivot.force.z", "--set", "m=2")
    assert float(done.stdout) == pytest.approx(19.62)
    peak = heun("run", "swinging.yaml", "--measure", "max joints.pivot.force").stdout
    sample = heun("run", "swinging.yaml", "--measure", "at 0.33 joints.pivot.force").stdout
    assert float(peak) >= float(sample)


def test_extremes_on_the_page_are_those_measured(heun: Heun) -> None:
    shown = row(heun("run", "swinging.yaml", "--only", "joints").stdout, "|F|")
    measured = [heun("run", "swinging.yaml", "--measure", f"{how} joints.pivot.force").stdout for how in ("min", "max")]
    assert [float(shown[4]), float(shown[6])] == pytest.approx([float(text) for text in measured], rel=1e-5)


def test_what_is_expected_at_an_instant_that_was_set_away_stops_no_run(heun: Heun, folder: Path) -> None:
    """`run` and `model` use no expectations; `check` and `validate` judge the spec as it stands."""
    (folder / "set.yaml").write_text(SPEC_TEXTS["swinging"] + "expect: [{of: energy.kinetic, at: 0.7, is: 0}]\n")
    assert heun("run", "set.yaml", "--set", "analysis.duration=0.5").returncode == 0
    assert heun("model", "set.yaml", "--set", "analysis.duration=0.5").returncode == 0
    (folder / "set.yaml").write_text(SPEC_TEXTS["swinging"] + "expect: [{of: energy.kinetic, at: 0.75, is: 0}]\n")
    for command in ("check", "validate"):
        done = heun(command, "set.yaml")
        assert (done.returncode, done.stdout) == (2, "")
        assert "[expect-instants]" in done.stderr


@pytest.mark.parametrize(
    ("words", "told"),
    [
        ([], "Usage"),
        (["run"], "Missing argument"),
        (["run", "nosuch.yaml"], "nosuch.yaml"),
        (["run", "wrong.yaml"], "wrong.yaml:9:"),
        (["run", "hanging.yaml", "--format", "xml"], "expected table, json, csv, markdown"),
        (["run", "hanging.yaml", "--only", "joins"], "known: motion"),
        (["run", "hanging.yaml", "--set", "m"], "NAME=VALUE"),
        (["run", "hanging.yaml", "--at", "1"], "there is one instant"),
        (["run", "swinging.yaml", "--at", "1.5"], "the run goes from 0 to 1 s"),
        (["run", "swinging.yaml", "--at", "soon"], "expected a number, first, last"),
        (["run", "hanging.yaml", "--tolerance", "-1"], "between 1e-14 and 0.1"),
        (["run", "hanging.yaml", "--measure", "joints.pivt.force.z"], "'pivt' is not a result [unknown-path]"),
        (["run", "hanging.yaml", "--method", "rk5"], "'rk5' is not an integration method [unknown-method]"),
        (["run", "hanging.yaml", "-o", "hanging.yaml"], "the spec itself"),
        (["validate", "hanging.yaml", "wrong.yaml"], "wrong.yaml:9:"),
        (["model", "hanging.yaml", "--format", "csv"], "expected text, json"),
        (["check", "nosuch.yaml"], "nosuch.yaml"),
        (["check", "hanging.yaml", "--jobs", "0"], "expected 1 or more"),
        (["check", "hanging.yaml", "-k", "nosuch"], "none of 1 specs"),
        (["check", "hanging.yaml", "--update"], "--update without --golden"),
        (["plot", "hanging.yaml"], "no quantity or kind of plot is given"),
    ],
)
def test_bad_usage_and_bad_specs_leave_with_2(heun: Heun, words: list[str], told: str) -> None:
    done = heun(*words)
    assert done.returncode == 2
    assert told in done.stderr + done.stdout
    assert "Traceback" not in done.stderr
    assert done.stdout == "" or words == []


def test_a_traceback_only_for_those_who_ask(heun: Heun, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("HEUN_DEBUG", "1")
    done = heun("run", "nosuch.yaml")
    assert done.returncode == 2
    assert SpecError.__name__ in done.stderr
    assert "Traceback" in done.stderr


def test_validate_tells_all_errors_of_all_files_at_once(heun: Heun) -> None:
    done = heun("validate", "wrong.yaml", "hanging.yaml", "unbound.yaml")
    assert (done.returncode, done.stdout) == (2, "")
    lines = done.stderr.splitlines()
    assert any(line.startswith("wrong.yaml:7:") and "mas" in line and line.endswith("]") for line in lines)
    assert any(line.startswith("wrong.yaml:9:") and "bal" in line for line in lines)
    assert any(line.startswith("unbound.yaml:9:") and "tip" in line for line in lines)


def test_validate_says_so_briefly_when_all_is_well(heun: Heun) -> None:
    done = heun("validate", "hanging.yaml", "swinging.yaml")
    assert done == (0, "hanging.yaml: valid (1 body, 1 joint)\nswinging.yaml: valid (1 body, 1 joint)\n", "")
    assert heun("validate", "hanging.yaml", "--quiet") == (0, "", "")


def test_model_is_a_note_or_json(heun: Heun) -> None:
    done = heun("model", "hanging.yaml")
    assert done.returncode == 0
    assert done.stdout.startswith("A bar hangs at rest\n")
    assert row(done.stdout, "DOF")[1] == "3"
    assert json.loads(heun("model", "hanging.yaml", "--format", "json").stdout)["freedoms"] == 3


def test_check_of_what_holds_and_what_does_not(heun: Heun) -> None:
    assert heun("check", "expecting.yaml").stdout == "1 spec, 1 check passed, 0 failed\n"
    done = heun("check", "failing.yaml", "expecting.yaml", "hanging.yaml")
    assert done.returncode == 1
    assert row(done.stdout, "failing.yaml:11")[1] == "joints.pivot.force.z"
    assert "off by 0.11" in done.stdout
    assert "3 specs, 1 check passed, 1 failed, 1 spec has no checks" in done.stdout
    parsed = json.loads(heun("check", "failing.yaml", "--format", "json").stdout)
    assert (parsed["passed"], parsed["failed"]) == (0, 1)
    assert parsed["cases"][0]["found"] == pytest.approx(9.81)


def test_check_tells_what_could_not_be_solved_and_goes_on(heun: Heun) -> None:
    done = heun("check", "wrong.yaml", "failing.yaml", "expecting.yaml")
    assert done.returncode == 2
    assert "wrong.yaml:9:" in done.stderr
    assert "3 specs, 1 check passed, 1 failed, 1 spec not solved" in done.stdout
    assert heun("check", "held.yaml", "failing.yaml").returncode == 3


@pytest.mark.parametrize(("spec", "code"), [("wrong", 2), ("held", 3)])
def test_check_prints_nothing_where_nothing_was_solved(heun: Heun, folder: Path, spec: str, code: int) -> None:
    for form in ("table", "json"):
        done = heun("check", f"{spec}.yaml", "--format", form, "-o", "out")
        assert (done.returncode, (folder / "out").exists()) == (code, False)
        done = heun("check", f"{spec}.yaml", "unbound.yaml", "--format", form)
        assert (done.returncode, done.stdout) == (2, "")
        assert f"{spec}.yaml:" in done.stderr
        assert json.loads(heun("check", f"{spec}.yaml", "hanging.yaml", "--format", "json").stdout)["failed"] == 1


def test_check_of_folders_passes_by_what_is_broken_on_purpose(heun: Heun, folder: Path) -> None:
    (folder / "specs" / "broken").mkdir(parents=True)
    (folder / "specs" / ".hidden").mkdir()
    for name, place in {"expecting": "", "wrong": "broken", "failing": ".hidden"}.items():
        (folder / f"{name}.yaml").rename(folder / "specs" / place / f"{name}.yaml")
    done = heun("check", "specs")
    assert done == (0, f"1 spec, 1 check passed, 0 failed, {Path('specs/broken')} skipped\n", "")
    assert heun("check", "specs/broken").returncode == 2
    assert heun("check", "specs/.hidden").returncode == 1


def test_a_table_outside_the_folder_is_named_by_model_and_fails_under_strict(heun: Heun, folder: Path) -> None:
    (folder / "data.csv").write_text("0,1\n1,2\n")
    (folder / "below").mkdir()
    (folder / "below" / "spec.yaml").write_text(SPEC_TEXTS["hanging"] + "tables: {f: {file: ../data.csv}}\n")
    told = "tables.f.file: reads a file outside the spec's folder: ../data.csv [outside-folder]"
    for words, code in ((["model"], 0), (["run"], 0), (["run", "--strict"], 1)):
        done = heun(words[0], "below/spec.yaml", *words[1:])
        assert done.returncode == code
        assert told in done.stderr


def test_strict_fails_on_warnings_but_prints(heun: Heun) -> None:
    done = heun("run", "unsound.yaml", "--strict")
    assert done.returncode == 1
    assert "warning" in done.stderr
    assert "JOINTS" in done.stdout
    assert heun("run", "hanging.yaml", "--strict").returncode == 0
    assert heun("run", "unsound.yaml").returncode == 0
    assert heun("run", "unsound.yaml", "--quiet").stderr == ""


def test_a_time_limit_is_4(heun: Heun) -> None:
    done = heun("run", "long.yaml", "--time-limit", "0.2")
    assert (done.returncode, done.stdout) == (4, "")


@pytest.mark.parametrize("spec", ["hanging", "swinging", "long"])
def test_a_limit_that_nothing_can_keep(heun: Heun, spec: str) -> None:
    """Also a run that would be over before anybody looks at the clock again."""
    done = heun("run", f"{spec}.yaml", "--time-limit", "0.000001")
    assert (done.returncode, done.stdout) == (4, "")
    assert "[time-limit]" in done.stderr
    assert "hint" in done.stderr


def test_a_limit_is_kept_to_the_end_of_a_run(heun: Heun, monkeypatch: pytest.MonkeyPatch) -> None:
    """The whole of this run is one look at the clock to the next."""
    monkeypatch.setattr("heuncli.motion.integration.run.runner.time.monotonic", map(float, itertools.count()).__next__)
    done = heun("run", "swinging.yaml", "--time-limit", "1.5")
    assert done.returncode == 4
    assert "reached at t = 1 s of 1 s" in done.stderr


def test_a_scene_that_cannot_be_solved_is_3(heun: Heun) -> None:
    done = heun("run", "held.yaml")
    assert (done.returncode, done.stdout) == (3, "")
    assert "pivot" in done.stderr


@pytest.mark.parametrize(
    ("trouble", "code", "told"),
    [
        (ZeroDivisionError("float"), 70, "this is a bug in heun: ZeroDivisionError: float at "),
        (MemoryError(), 4, "not enough memory"),
        (KeyboardInterrupt(), 130, "heun: interrupted"),
    ],
)
def test_no_trouble_reaches_a_user_as_a_traceback(
    heun: Heun, monkeypatch: pytest.MonkeyPatch, trouble: BaseException, code: int, told: str
) -> None:
    def fail(*_: object, **__: object) -> None:
        raise trouble

    monkeypatch.setattr("heuncli.app.commands.run.command.read", fail)
    monkeypatch.delenv("HEUN_DEBUG", raising=False)
    done = heun("run", "hanging.yaml")
    assert (done.returncode, done.stdout) == (code, "")
    assert told in done.stderr
    assert "Traceback" not in done.stderr


@pytest.mark.parametrize(
    ("trouble", "code", "told"),
    [
        (ZeroDivisionError("float"), 70, "this is a bug in heun: ZeroDivisionError: float at test_commands.py:"),
        (RecursionError("too deep"), 70, "this is a bug in heun: RecursionError: too deep at "),
        (MemoryError(), 4, "not enough memory"),
    ],
)
@pytest.mark.parametrize("command", ["check", "validate"])
def test_what_goes_wrong_in_one_file_is_told_of_it_alone(
    heun: Heun, monkeypatch: pytest.MonkeyPatch, command: str, trouble: Exception, code: int, told: str
) -> None:
    def fail_once(path: str, **words: Any) -> Any:
        if path == "swinging.yaml":
            raise trouble
        return load_with_cases(path, **words)

    module = {"check": "check.checking"}.get(command, command)
    monkeypatch.setattr(f"heuncli.app.commands.{module}.load_with_cases", fail_once)
    monkeypatch.delenv("HEUN_DEBUG", raising=False)
    done = heun(command, "expecting.yaml", "swinging.yaml", "failing.yaml", "wrong.yaml")
    assert done.returncode == (code if code == 70 else 2)
    assert f"heun: swinging.yaml: {told}" in done.stderr and "wrong.yaml:" in done.stderr
    if command == "check":
        assert "4 specs, 1 check passed, 1 failed, 2 specs not solved" in done.stdout
        found = json.loads(heun(command, "expecting.yaml", "swinging.yaml", "--format", "json").stdout)
        assert [(case["passed"], case.get("exit")) for case in found["cases"]] == [(True, None), (False, code)]
        assert told in found["cases"][1]["message"]


def test_validate_cuts_the_sections(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    """Every section that cannot be cut, with its place, in one go with other files' errors."""
    box = "{shapes: [{type: box, center: [1, 0, 0], size: [2, 0.1, 0.1], mass: 1}], points: {a: [0, 0, 0]}}"
    lines = [
        "heun: 1", f"bodies: {{a: {box}}}", "joints: {w: {type: weld, from: {body: ground, at: [0, 0, 0]}, to: a.a}}",
        "sections:", "  c: {body: a, at: a, normal: [1, 0, 0]}", "  d: {body: a, at: [5, 0, 0], normal: [1, 0, 0]}",
    ]  # fmt: skip
    path = tmp_path / "cut.yaml"
    path.write_text("\n".join([*lines, "analysis: {type: state}", ""]))
    assert enter(["validate", str(path)]) == 2
    out, err = capsys.readouterr()
    assert out == ""
    assert f"{path}:5:3: sections.c: joint w lies in the plane of the cut [needs-side]" in err
    assert f"{path}:6:3: sections.d: the plane does not intersect the body a [misses-body]" in err


def test_a_rope_that_would_push_is_told_in_a_state(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    path = tmp_path / "rope.yaml"
    path.write_text("""
heun: 1
gravity: [0, 0, -9.81]
bodies: {b: {mass: 1, center: [0, 0, 1], inertia: [0.1, 0.1, 0.1], points: {o: [0, 0, 1]}}}
joints: {A: {type: rod, from: {body: ground, at: [0, 0, 0]}, to: b.o, tension_only: true}}
analysis: {type: state}
""")
    assert enter(["run", str(path)]) == 0
    assert "warning: heun: the rod A would have to push" in capsys.readouterr().err
    path.write_text(path.read_text().replace("[0, 0, -9.81]", "[0, 0, 9.81]"))
    assert enter(["run", str(path)]) == 0
    assert capsys.readouterr().err == ""
