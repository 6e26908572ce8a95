"""`heun sweep`: what is refused before anything runs, tables of variants, warnings, exit codes, what terminals show."""

from __future__ import annotations

import csv
import io
import os
import pty
import re
import subprocess
import sys
import time
from pathlib import Path

import pytest

from heuncli.analyses.variants.evaluation import VariantEvaluator
from heuncli.analyses.variants.parameters import Values
from heuncli.app.cli import variant_workers
from heuncli.base import process
from tests.shared.command import Done, Heun
from tests.shared.shell import ENVIRONMENT

SCENE = """\
heun: 1
title: A bar hangs
gravity: [0, 0, -9.81]
parameters: {m: 2 kg, L: 500 mm, n: 60 rpm, idle: 1, twice: 2*L}
ground: {points: {O: [0, 0, 0]}}
bodies:
  bar: {mass: m, center: [0, 0, -L/2], inertia: [0.08, 0.08, 0.001], points: {top: [0, 0, 0], end: [0, 0, -twice]}}
joints:
  pivot: {type: pin, axis: [1, 0, 0], from: ground.O, to: bar.top, initial: {rate: n}}
analysis: {duration: 0.2, samples: 3, events: {low: "pivot.angle > 0.5"}}
cases:
  calm: {set: {n: 0}}
  storm: {set: {n: 200 rpm}}
"""
FORCE = ("--measure", "max joints.pivot.force")


@pytest.fixture
def scene(folder: Path) -> Path:
    """A folder with a spec that has parameters with units, and load cases."""
    (folder / "scene.yaml").write_text(SCENE)
    return folder


def sweep(heun: Heun, *words: str) -> Done:
    """A sweep of the spec by one measure, as CSV."""
    return heun("sweep", "scene.yaml", *words, *FORCE, "--format", "csv")


def rows(done: Done) -> list[dict[str, str]]:
    """The rows of a sweep as CSV."""
    assert done.returncode == 0, done.stderr
    return list(csv.DictReader(io.StringIO(done.stdout)))


REFUSED = {
    "nn=1,2": "nn=1,2: there is no parameter 'nn' to set [no-such-key]\n  hint: did you mean n?",
    "m=1:2/3 qq": "m=1:2/3 qq: 'qq' is not a unit [bad-option]",
    "m=1:2/3m": "m=1:2/3m: at scene.yaml:7:15: bodies.bar.mass: m is a length (1.0 m), expected a mass",
    "m=1kg,2mm": "m=1kg,2mm: at scene.yaml:7:15: bodies.bar.mass: m is a length (2mm), expected a mass",
    "m=1,2*k": "m=1,2*k: 'k' is not a parameter [unknown-name]",
    "n=1,[1": "n=1,[1: ",
    "case=calm,strom": "case=calm,strom: there is no load case 'strom' [unknown-case]\n  hint: did you mean storm?",
    "bodies.rod.mass=1,2": "bodies.rod.mass=1,2: there is no body 'rod' to set [no-such-key]",
    "joints.pivot.type=pin,swivel": "joints.pivot.type=pin,swivel: 'swivel' is not a joint type; known: ",
    "m=3 m=4": "m: is varied twice [bad-option]",
    "m=3 parameters.m=4": "parameters.m=4: parameters.m is varied twice [bad-option]",
    "m=3 --set m=1": "m=3: m is varied, and set by --set [bad-option]",
    "m=3 --shard 3/2": "--shard 3/2: expected K/N, the K-th part of N [bad-option]",
    "m=3 --jobs 0": "--jobs 0: expected 1 or more [bad-option]",
    "m=3 --variants no.csv": "no.csv:1:1: file not found [unreadable]",
    "": "sweep: no parameter to vary is given [bad-option]",
    "m=1:3": "m=1:3: an interval needs its number of values [bad-option]",
    "m=1,2 L=1,2,3 --zip": "--zip: the axes have different numbers of values: m 2, L 3 [bad-option]",
    "m=3 --show scene.yaml": "--show and scene.yaml m=3 cannot be combined [bad-option]",
}


@pytest.mark.parametrize("words", REFUSED)
def test_what_is_refused_before_anything_runs(
    heun: Heun, scene: Path, monkeypatch: pytest.MonkeyPatch, words: str
) -> None:
    monkeypatch.setattr(variant_workers, "solve_batch", None)
    given = [words] if " qq" in words else words.split()
    done = sweep(heun, *given)
    assert (done.returncode, done.stdout) == (2, "")
    assert REFUSED[words] in done.stderr, done.stderr
    assert "hint: " in done.stderr


def test_all_that_is_wrong_is_told_at_once(heun: Heun, scene: Path) -> None:
    done = sweep(heun, "nn=1,2", "m=1mm", "L=-1,1", "case=no")
    assert done.returncode == 2
    lines = [line for line in done.stderr.splitlines() if not line.startswith("  hint")]
    assert [line.split("=")[0] for line in lines] == ["heun: nn", "heun: m", "heun: case"]


def test_what_hangs_on_the_size_of_a_value_is_a_row(heun: Heun, scene: Path) -> None:
    done = sweep(heun, "m=-1,0,1,1e99kg")
    assert [row["code"] for row in rows(done)] == ["not-positive", "not-positive", "", "magnitude"]
    assert done.stderr == "heun: 3 of 4 variants could not be solved: 2 not-positive, 1 magnitude\n"
    assert sweep(heun, "m=-1,1", "--strict").returncode == 1
    assert sweep(heun, "m=-1,1", "--quiet").stderr == ""


def test_what_is_wrong_with_all_of_them_is_the_error_of_the_spec(heun: Heun, scene: Path) -> None:
    done = sweep(heun, "m=-1,-2")
    assert (done.returncode, done.stdout) == (2, "")
    assert "bodies.bar.mass: mass must be greater than 0, but is -1 [not-positive]" in done.stderr


@pytest.mark.parametrize("measure", ["joints.pivot.force", "max nothing", "max joints.pivot.forse", "max analysis"])
def test_a_measure_that_is_no_number_is_refused_once(heun: Heun, scene: Path, measure: str) -> None:
    done = heun("sweep", "scene.yaml", "m=-1,1:2/50", "--measure", measure)
    done = heun("sweep", "scene.yaml", "m=1:2/50", "--measure", measure)
    assert (done.returncode, done.stdout) == (2, "")
    assert done.stderr.count("[") <= 3 and "--measure" in done.stderr


def test_what_does_not_happen_in_a_variant_is_no_error_of_it(heun: Heun, scene: Path) -> None:
    words = ("sweep", "scene.yaml", "n=0,60rpm", *FORCE, "--measure", "first events.low.time", "--format", "csv")
    first, second = rows(heun(*words))
    assert first["first events.low.time [s]"] == "" and first["code"] == ""
    assert first["max joints.pivot.force [N]"] != ""
    assert "does not happen in this run" in first["reason"]
    assert float(second["first events.low.time [s]"]) >= 0.0
    done = heun("sweep", "scene.yaml", "n=0,1rpm", "--measure", "first events.low.time")
    assert done.stderr == "warning: heun: first events.low.time: no variant has it\n"


@pytest.mark.heavy
def test_warnings_of_axes_and_of_variants(heun: Heun, scene: Path) -> None:
    done = sweep(heun, "n=1:5/4", "idle=1,2", "L=1m")
    assert done.returncode == 0
    assert done.stderr.splitlines() == [
        "warning: n=1:5/4: 1 is taken to be in rad/s; the file gives it in rpm [set-in-si]",
        "  hint: with the unit: n=1:5/4rpm",
        "warning: idle=1,2: idle has no effect",
    ]
    unsound = SCENE.replace("[0.08, 0.08, 0.001]", "[0.0801, 0.08, 0.00005]")
    (scene / "scene.yaml").write_text(unsound)
    done = sweep(heun, "m=1:5/4")
    warnings = [line for line in done.stderr.splitlines() if line.startswith("warning: heun: ")]
    assert len(warnings) == 1 and warnings[0].endswith("(all variants)")
    assert sweep(heun, "m=1:5/4", "--quiet").stderr == ""


TABLE = """\
# n as the shop gives it
n [rpm],"m/g",L

60,2000,"500 mm"
"120",2.5 kg,n*0.05
60,-1,0.5
"""


@pytest.mark.heavy
def test_a_table_of_variants(heun: Heun, scene: Path) -> None:
    (scene / "table.csv").write_text(TABLE)
    done = sweep(heun, "--variants", "table.csv")
    one, two, three = rows(done)
    assert [row["code"] for row in (one, two, three)] == ["", "", "not-positive"]
    alone = rows(sweep(heun, "n=60rpm", "m=2000g", "L=500mm"))[0]
    assert one["max joints.pivot.force [N]"] == alone["max joints.pivot.force [N]"]
    assert (one["n [rpm]"], two["n [rpm]"]) == ("60.0", "120.0")
    assert two["m"] == "2.5 kg" and two["L"] == "n*0.05"


@pytest.mark.heavy
@pytest.mark.parametrize("mark", [";", "\t"])
def test_tables_of_other_programs(heun: Heun, scene: Path, mark: str) -> None:
    comma = "," if mark == ";" else "."
    lines = [("case", "m [kg]"), ("calm", f"1{comma}5"), ("storm", f"2{comma}5"), ("calm", "2")]
    (scene / "table.csv").write_bytes("\r\n".join(mark.join(line) for line in lines).encode("utf-8-sig"))
    found = rows(sweep(heun, "--variants", "table.csv"))
    assert [(row["case"], row["m [kg]"]) for row in found] == [("calm", "1.5"), ("storm", "2.5"), ("calm", "2.0")]
    assert found == [
        {**rows(sweep(heun, f"case={case}", f"m={m}kg"))[0], "number": str(k)}
        for k, (case, m) in enumerate((("calm", 1.5), ("storm", 2.5), ("calm", 2.0)))
    ]


@pytest.mark.heavy
def test_a_table_and_axes(heun: Heun, scene: Path) -> None:
    """Each row of the table with each value of the axis; with --zip one by one."""
    (scene / "table.csv").write_text("n [rpm],m\n60,1\n120,2\n")
    found = rows(sweep(heun, "--variants", "table.csv", "L=400,500,600mm"))
    assert [(row["n [rpm]"], row["m"], row["L [mm]"]) for row in found] == [
        (n, m, L) for n, m in (("60.0", "1.0"), ("120.0", "2.0")) for L in ("400.0", "500.0", "600.0")
    ]
    zipped = rows(sweep(heun, "--variants", "table.csv", "L=400,600mm", "--zip"))
    assert [row["max joints.pivot.force [N]"] for row in zipped] == [
        found[k]["max joints.pivot.force [N]"] for k in (0, 5)
    ]


WRONG_TABLES = {
    "n,m,n\n1,2,3\n": "table.csv:1:5: there are two columns 'n' [variants-table]",
    "n [rmp]\n1\n": "table.csv:1:1: 'rmp' is not a unit [unknown-unit]",
    "n,q\n1,2\n": "table.csv:1:3: q: there is no parameter 'q' to set [no-such-key]",
    "n,m\n1,2\n3\n": "table.csv:3:1: the row has 1 cells, the first row 2 [variants-table]",
    "n,m\n1,\n": "table.csv:2:3: an empty cell in the column 'm' [variants-table]",
    'n,m\n1,"2\n': "table.csv:2:1: a quote that is not closed in its cell [variants-table]",
    "n,m\n1,2\n3,4 mm\n": "table.csv:3:3: m: at scene.yaml:7:15: bodies.bar.mass: m is a length (4 mm), expected a",
    "n,case\n1,calm\n1,clam\n": "table.csv:3:3: case: there is no load case 'clam' [unknown-case]",
    "1,2\n3,4\n": "table.csv:1:1: '1' is not the name of a parameter [variants-table]",
    "n,m\n": "table.csv:1:1: there is no variant below the header [variants-table]",
    "# nothing\n": "table.csv:1:1: the table holds no rows [variants-table]",
}


@pytest.mark.parametrize("text", WRONG_TABLES)
def test_what_is_wrong_with_a_table_has_its_place(heun: Heun, scene: Path, text: str) -> None:
    (scene / "table.csv").write_text(text)
    done = sweep(heun, "--variants", "table.csv")
    assert (done.returncode, done.stdout) == (2, "")
    assert done.stderr.startswith(WRONG_TABLES[text]), done.stderr
    assert "hint: " in done.stderr


def test_a_bug_in_one_variant_stops_no_other(heun: Heun, scene: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    answer = VariantEvaluator.answer

    def failing(self: VariantEvaluator, values: Values) -> object:
        return answer(self, values) if values["m"] != (2.0, "kg") else 1 / 0

    monkeypatch.setattr(VariantEvaluator, "answer", failing)
    done = sweep(heun, "m=1,2,3kg")
    assert done.returncode == 70
    found = list(csv.DictReader(io.StringIO(done.stdout)))
    assert [row["code"] for row in found] == ["", "bug", ""]
    assert "this is a bug in heun: ZeroDivisionError" in found[1]["reason"]


@pytest.mark.heavy
def test_a_terminal_shows_the_rate_and_what_is_left(scene: Path) -> None:
    """Until it is done; nothing of it stays."""
    control, terminal = pty.openpty()
    long = SCENE.replace("duration: 0.2", "duration: 60")
    (scene / "scene.yaml").write_text(long)
    command = [sys.executable, "-m", "heuncli", "sweep", "scene.yaml", "m=1:2/4000", *FORCE, "--jobs", "1"]
    environment = {**ENVIRONMENT, "TERM": "xterm", "COLUMNS": "100"}
    with subprocess.Popen(command, cwd=scene, stdout=-1, stderr=terminal, env=environment) as process:
        os.close(terminal)
        shown, until = b"", time.monotonic() + 60.0
        while b" left" not in shown and time.monotonic() < until:
            shown += os.read(control, 4096)
        process.kill()
    os.close(control)
    assert re.search(rb"\d+ of 4000 variants, \S+ per second, .*\d+ (s|min) left", shown), shown


def test_a_variant_that_would_not_fit_into_memory_is_refused_alone(
    heun: Heun, scene: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(process, "_iter_remaining_memory", lambda: iter([2e6]))
    done = sweep(heun, "analysis.samples=3,100001", "--jobs", "1")
    assert [row["code"] for row in rows(done)] == ["", "too-much-memory"]


@pytest.mark.heavy
def test_standard_input_is_a_spec_and_a_table(heun: Heun, scene: Path) -> None:
    words = ("m=1,2kg", *FORCE, "--format", "csv")
    assert heun("sweep", "-", *words, text=SCENE) == heun("sweep", "scene.yaml", *words)
    table = heun("sweep", "scene.yaml", "--variants", "-", *FORCE, "--format", "csv", text="m [kg]\n1\n2\n")
    assert table == heun("sweep", "scene.yaml", *words)


def test_all_load_cases_are_zipped_like_the_list_of_them(heun: Heun, folder: Path) -> None:
    """As many values as the spec has cases; another count is refused, and so it is combined without --zip."""
    text = (folder / "hanging.yaml").read_text() + "cases: {a: {set: {m: 2}}, b: {set: {m: 3}}, c: {set: {m: 4}}}\n"
    (folder / "cases.yaml").write_text(text)
    measure = ("--measure", "joints.pivot.force.z", "--format", "csv")
    tilt = "gravity=[0, 0, -1],[0, 0, -2],[0, 0, -3]"
    one, other = (heun("sweep", "cases.yaml", f"case={of}", tilt, "--zip", *measure) for of in ("all", "a,b,c"))
    assert one.returncode == 0 and one.stdout == other.stdout and len(one.stdout.splitlines()) == 4
    first = heun("sweep", "cases.yaml", tilt, "case=all", "--zip", *measure)
    assert first.returncode == 0 and len(first.stdout.splitlines()) == 4
    wrong = heun("sweep", "cases.yaml", "case=all", "gravity=[0, 0, -1],[0, 0, -2]", "--zip", *measure)
    assert wrong.returncode == 2 and "case 3, gravity 2 [bad-option]" in wrong.stderr


def test_a_matrix_shows_the_extremes_in_each_load_case(heun: Heun, folder: Path) -> None:
    """A mass that hangs on a pin loads it with its weight; the cases alone are no matrix, because the rows are it."""
    text = (folder / "hanging.yaml").read_text() + "cases: {a: {set: {m: 2}}, b: {set: {m: 3}}}\n"
    (folder / "cases.yaml").write_text(text)
    tilt, measure = "gravity=[0, 0, -1],[0, 0, -2],[0, 0, -3]", ("--measure", "joints.pivot.force.z")
    for words, a, b in (
        (("case=all", tilt), ("2", "6"), ("3", "9")),
        ((tilt, "case=b,a"), ("2", "6"), ("3", "9")),
        (("case=a,b,a", tilt, "--zip"), ("2", "6"), ("6", "6")),
    ):
        shown = heun("sweep", "cases.yaml", *words, *measure).stdout.partition("CASES ")[2].splitlines()
        names = shown[1].split()[1:]
        found = [dict(zip(names, line.split()[-2:], strict=True)) for line in shown[2:4]]
        assert [{name: float(text) for name, text in line.items()} for line in found] == [
            {"a": float(a[k]), "b": float(b[k])} for k in (0, 1)
        ]
    assert "CASES" not in heun("sweep", "cases.yaml", "case=all", *measure).stdout
