"""Every worked example says what to look at, runs, meets what it expects, and says the same in every format.

What the examples expect comes from closed forms and independent solutions, so these are tests of the physics, too.
"""

from __future__ import annotations

import csv
import io
import json
import re
from functools import cache
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from heuncli.app.cli.entry import enter
from heuncli.output.tables.export import collect_blocks, to_csv, to_json
from heuncli.results.results_paths import find_values
from heuncli.scene.file_format.load import load
from heuncli.study.model.options import Options
from heuncli.study.quantities.channels import iter_channels
from heuncli.study.quantities.labels import make_labels
from heuncli.study.queries.expectations import compare
from heuncli.study.queries.study import Study
from heuncli.study.workflow import solve

FOLDER = Path(__file__).parents[2] / "specs"
HEAVY = ("cardan", "crane", "engine", "friction", "jib", "ladder", "spatial_crank")  # too long for the plain kernel
NAMES = [
    pytest.param(path.stem, marks=[pytest.mark.heavy] if path.stem in HEAVY else [])
    for path in sorted(FOLDER.glob("*.yaml"))
]
WARNED = {
    "flat_four_bar": [
        "singular positions",
        "extremes exclude the numerically uncertain samples near singular positions, "
        "first t = 0.708288 s, last t = 1.21535 s",
    ],
    "cradle": ["in the impact"],
}
EVERYTHING = frozenset({"motion", "points", "foundation", "joints", "sections", "forces", "energy", "impulses"})
each = pytest.mark.parametrize("name", NAMES)


def path_of(name: str) -> str:
    return str(FOLDER / f"{name}.yaml")


@cache
def study_of(name: str) -> Study:
    spec = load(path_of(name))
    return solve(spec, Options(requested_reports=EVERYTHING | ({"shares", "events"} & set(spec.report.results or ()))))


@each
def test_it_says_what_to_look_at(name: str) -> None:
    """A question, its answer, the command that shows it, and what it was checked against."""
    comment = [line for line in Path(path_of(name)).read_text().splitlines() if line.startswith("#")]
    heads = [line[2:].split()[0] for line in comment[1:] if line.startswith("# ") and line[2:3] != " "]
    assert {"Question", "Answer", "Look", "Checked"} <= set(heads)
    assert heads.index("Question") < heads.index("Answer") < heads.index("Look") < heads.index("Checked")
    look = next(line for line in comment if line.startswith("# Look at   "))
    assert re.match(rf"# Look at   heun \w+ specs/{name}\.yaml( |$)", look)
    assert load(path_of(name)).warnings == ()


@each
@pytest.mark.third
def test_it_is_as_it_expects(name: str) -> None:
    study = study_of(name)
    cases = [compare(study, item) for item in study.spec.expect]
    assert cases
    assert [f"{case.path} {case.when}: {case.failure}" for case in cases if not case.is_met] == []


@each
def test_it_is_as_accurate_as_asked(name: str) -> None:
    study = study_of(name)
    accuracy = study.results.accuracy
    assert accuracy["estimate"]["motion"] <= study.spec.analysis.tolerance
    assert accuracy["balance_residual"] < 1e-10
    assert accuracy["energy_drift"] < 1e-6
    assert accuracy["horizon"] is None


@each
@pytest.mark.sixth
def test_its_tables_print(name: str, capsys: pytest.CaptureFixture[str]) -> None:
    assert enter(["run", path_of(name)]) == 0
    printed = capsys.readouterr()
    told = printed.err.splitlines()
    assert [line.partition(" at t")[0] for line in told] == [f"warning: heun: {w}" for w in WARNED.get(name, [])]
    assert study_of(name).spec.title in printed.out
    assert "accuracy" in printed.out
    words = printed.out.split()
    assert not {"nan", "inf", "-inf", "-0", "None"} & set(words)
    assert enter(["model", path_of(name)]) == 0
    assert "DOF" in capsys.readouterr().out


@each
@pytest.mark.sixth
def test_its_json_says_the_same(name: str) -> None:
    results = study_of(name).results
    parsed = json.loads(to_json(results))
    assert list(parsed) == ["heun", *collect_blocks(results)]
    same(parsed, collect_blocks(results), name)


def same(read: Any, written: Any, where: str) -> None:
    """What was read back is what was written, to the last bit; null for nan."""
    if isinstance(written, dict):
        assert list(read)[-len(written) :] == list(written), where
        for key, part in written.items():
            same(read[key], part, f"{where}.{key}")
    elif isinstance(written, (np.ndarray, float)):
        numbers = np.array(read, dtype=float)
        assert np.array_equal(numbers, np.asarray(written), equal_nan=True), where
    elif isinstance(written, (list, tuple)):
        assert len(read) == len(written), where
        for number, (one, other) in enumerate(zip(read, written, strict=True)):
            same(one, other, f"{where}.{number}")
    else:
        assert read == written, where


@each
@pytest.mark.sixth
def test_its_csv_says_the_same(name: str) -> None:
    study = study_of(name)
    rows = list(csv.DictReader(io.StringIO(to_csv(study.results, make_labels(study.spec)))))
    assert {row["unit"] for row in rows if row["kind"] == "joints" and row["quantity"] == "force"} <= {"N"}
    found: dict[str, list[float]] = {joint: [] for joint in study.results.joints}
    for row in rows:
        if row["kind"] == "joints" and row["quantity"] == "force" and not row.get("cause"):
            found[row["name"]].append(float(row["value"] or "nan"))
    for joint, part in study.results.joints.items():
        read = np.array(found[joint]).reshape(3, -1).T
        assert np.array_equal(read, part["force"], equal_nan=True)


@each
@pytest.mark.sixth
def test_every_result_may_be_expected(name: str) -> None:
    """When a spec is read every path into the results is known, with the shape and the dimension that are found."""
    results = study_of(name).results
    items: list[dict[str, Any]] = []
    for series in iter_channels(results, make_labels(study_of(name).spec)):
        if series.quantity == "side":  # words
            continue
        found = find_values(results, series.path)
        shape = found.values.shape[1:] if found.is_timed else found.values.shape
        at = {"at": float(results.time[0])} if found.is_timed else {}
        items.append({"of": series.path, "is": np.zeros(shape).tolist(), **at})
        unit = "" if series.unit == "1" else f" {series.unit}"
        component = "".join(f".{part}" for part in series.components[-1:] if part)
        items.append({"of": series.path + component, "is": f"0{unit}", **at})
    text = Path(path_of(name)).read_text().partition("\nexpect:")[0]
    assert len(load(path_of(name), text=f"{text}\nexpect: {json.dumps(items)}\n").expect) == len(items) > 0


def test_an_expectation_that_fails_is_told(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    text = Path(path_of("chimney")).read_text().replace("is: m*g*L*sin(tilt)/27", "is: m*g*L*sin(tilt)/26")
    wrong = tmp_path / "wrong.yaml"
    wrong.write_text(text)
    assert enter(["check", str(wrong)]) == 1
    printed = capsys.readouterr().out
    assert "sections.shaft.M2" in printed
    assert "1 spec, 7 checks passed, 1 failed" in printed


def test_expectations_follow_the_parameters(capsys: pytest.CaptureFixture[str]) -> None:
    spec = load(path_of("chimney"), overrides={"tilt": "60 deg", "L": "20"})
    study = solve(spec)
    assert all(compare(study, item).is_met for item in spec.expect)
    assert spec.expect[0].is_ == pytest.approx(1000 * 9.81 * 20 * np.sin(np.pi / 3) / 27, rel=1e-15)


@pytest.mark.parametrize("change", ["--method=rk4", "--set=analysis.method=rk4", "--set=analysis.step=0.01"])
def test_what_cannot_be_had_is_not_taken_silently(change: str, capsys: pytest.CaptureFixture[str]) -> None:
    assert enter(["run", path_of("double"), *change.split("=", 1)]) == 2
    assert capsys.readouterr().out == ""
