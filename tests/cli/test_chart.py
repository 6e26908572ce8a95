"""`heun chart`: what it writes and draws, and what it refuses."""

from __future__ import annotations

import csv
import io
import json
import os
import xml.etree.ElementTree as tree
from pathlib import Path
from types import SimpleNamespace
from typing import Any, cast

import pytest

from heuncli.analyses.work_precision.results import COMPLETED, ChartRow, ChartRun
from heuncli.analyses.work_precision.study import ChartRunner, TimedRun
from heuncli.output.drawing import drawing_files
from tests.shared.command import HANGING, SPEC_TEXTS, TURNED, Heun

FEW = ("--methods", "DOP853", "--tolerances", "1e-4,1e-8")


def test_json_keeps_to_the_contract(heun: Heun) -> None:
    done = heun("chart", "swinging.yaml", *FEW, "--format", "json")
    found = json.loads(done.stdout)
    assert done.returncode == 0 and done.stderr == "" and isinstance(found["reference"], str)
    coarse, fine = found["runs"]
    for run in found["runs"]:
        assert {"method", "chart", "seconds", "steps", "evaluations", "error", "status", "at", "front"} <= run.keys()
        assert run["method"] == "DOP853" and run["chart"] == "quaternion" and run["status"] == "completed"
        assert run["error"].keys() == {"motion", "reactions", "sections"} and run["error"]["sections"] is None
        assert run["seconds"] > 0.0 and run["at"] is None and isinstance(run["front"], bool)
    assert (coarse["tolerance"], fine["tolerance"]) == (1e-4, 1e-8) and coarse["steps"] < fine["steps"]
    assert coarse["error"]["motion"] > 100.0 * fine["error"]["motion"] > 0.0 and fine["front"]


@pytest.mark.heavy
def test_csv_and_table_tell_the_same(heun: Heun) -> None:
    rows = list(csv.DictReader(io.StringIO(heun("chart", "swinging.yaml", *FEW, "--format", "csv").stdout)))
    assert [row["tolerance"] for row in rows] == ["0.0001", "1e-08"]
    text = heun("chart", "swinging.yaml", *FEW).stdout
    assert "DOP853  order 8" in text and "processor time" in text and "a DOP853" in text
    assert f"{float(rows[0]['error_motion']):.1e}" in text  # the same bits in every run
    assert max(map(len, text.splitlines())) <= 120


def test_a_picture_is_saved_beside_what_is_written(heun: Heun, folder: Path) -> None:
    done = heun("chart", "swinging.yaml", *FEW, "--save", "chart.svg", "-o", "chart.json")
    assert done.returncode == 0 and done.stdout == ""
    root = tree.fromstring((folder / "chart.svg").read_bytes())
    assert root.tag.endswith("svg") and json.loads((folder / "chart.json").read_text())["runs"]
    assert not list(folder.glob(".chart*"))


def test_a_failed_chart_leaves_no_file(heun: Heun, folder: Path) -> None:
    (folder / "chart.svg").write_text("old")
    done = heun("chart", "wrong.yaml", "--save", "chart.svg", "-o", "chart.json")
    assert done.returncode == 2 and (folder / "chart.svg").read_text() == "old"
    assert not (folder / "chart.json").exists()


@pytest.mark.parametrize(
    ("words", "told"),
    [
        (("--methods", "DOP835"), "did you mean DOP853?"),
        (("--methods", "auto"), "auto is not a single method"),
        (("--tolerances", "1e-4,x"), "expected numbers"),
        (("--tolerances", "2"), "below 1"),
        (("--tolerances", "-1e-4"), "positive"),
        (("--steps", "0"), "positive"),
        (("--steps", "nan"), "positive"),
        (("--methods", "DOP853", "--steps", "0.1"), "none of the methods uses fixed steps"),
        (("--save", "chart.gif"), "accepted file extensions: .svg, .png, .pdf"),
        (("--save", "no/chart.svg"), "there is no folder"),
        (("--save", "swinging.yaml"), "unknown picture format"),
        (("--time-limit", "0"), "expected a positive number"),
        (("-o", "chart.xlsx"), "accepted: .json"),
    ],
)
def test_what_is_refused_before_the_work(heun: Heun, words: tuple[str, ...], told: str) -> None:
    done = heun("chart", "swinging.yaml", *words)
    assert done.returncode in (2, 5) and done.stdout == "" and told in done.stderr
    assert (done.returncode == 5) == ("folder" in told)


def test_one_file_is_not_written_twice(heun: Heun) -> None:
    done = heun("chart", "swinging.yaml", "--save", "a.svg", "-o", "a.svg", "--format", "json")
    assert done.returncode == 2 and "the table is written to this file" in done.stderr


def test_a_missing_extra_is_told_before_the_work(heun: Heun, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(drawing_files.importlib.util, "find_spec", lambda name: None)
    monkeypatch.setattr(drawing_files, "CONVERTERS", ())
    done = heun("chart", "long.yaml", "--save", "chart.png")
    assert done.returncode == 2 and "[missing-extra]" in done.stderr and 'pip install "heuncli[plot]"' in done.stderr


@pytest.mark.parametrize("kind", ["{type: state}", "{type: rest}"])
def test_where_nothing_is_integrated_there_is_nothing_to_chart(heun: Heun, folder: Path, kind: str) -> None:
    (folder / "still.yaml").write_text(HANGING + f"analysis: {kind}\n")
    done = heun("chart", "still.yaml")
    assert done.returncode == 2 and "[nothing-to-chart]" in done.stderr and "analysis: {duration" in done.stderr


def test_a_blow_alone_is_one_instant(heun: Heun, folder: Path) -> None:
    (folder / "blow.yaml").write_text(HANGING + "impulses: {h: {on: bar.top, vector: [1, 0, 0]}}\n")
    done = heun("chart", "blow.yaml")
    assert done.returncode == 2 and "an impulse is one instant" in done.stderr


def test_what_cannot_move_is_refused(heun: Heun, folder: Path) -> None:
    (folder / "fixed.yaml").write_text(SPEC_TEXTS["swinging"].replace("type: ball", "type: weld"))
    done = heun("chart", "fixed.yaml")
    assert done.returncode == 3 and "the joints leave 0 degrees of freedom" in done.stderr and done.stdout == ""


@pytest.mark.heavy
def test_what_is_driven_is_followed_and_integrated_beside(heun: Heun, folder: Path) -> None:
    drawn = SPEC_TEXTS["swinging"].replace("type: ball", "type: pin, axis: [0, 1, 0]")
    driven = drawn.replace(", orientation: {axis: [1, 0, 0], angle: 60 deg}", "")
    (folder / "driven.yaml").write_text(driven + "drives: {motor: {joint: pivot, angle: 't**2'}}\n")
    few = ("--tolerances", "1e-6", "--steps", "0.1", "--format", "json")
    found = json.loads(heun("chart", "driven.yaml", *few).stdout)
    assert found["runs"][0]["method"] == "followed" and found["runs"][0]["tolerance"] is None
    assert any("solves each instant" in note for note in found["notes"])
    assert any(run["method"] == "DOP853" and run["status"] == "completed" for run in found["runs"])


@pytest.mark.heavy
def test_a_run_that_fails_is_that_error(heun: Heun, folder: Path) -> None:
    """No reference, no chart: what `heun run` would say."""
    (folder / "pole.yaml").write_text(
        TURNED + "forces: {f: {type: couple, on: bar.top, vector: [1/(0.5 - t), 0, 0]}}\n"
        "analysis: {duration: 1, samples: 11}\n"
    )
    run, chart = heun("run", "pole.yaml"), heun("chart", "pole.yaml")
    assert run.returncode == chart.returncode == 3 and chart.stdout == ""


def test_beyond_the_time_limit_rows_are_told_not_run(heun: Heun, monkeypatch: pytest.MonkeyPatch) -> None:
    from heuncli.analyses.work_precision.plan import MotionProblem

    monkeypatch.setattr(MotionProblem, "late", True)
    found = json.loads(heun("chart", "swinging.yaml", *FEW, "--time-limit", "60", "--format", "json").stdout)
    assert {run["status"] for run in found["runs"]} == {"not run"} and len(found["runs"]) == 2
    assert all(run["code"] == "time-limit" and run["seconds"] is None for run in found["runs"])


def test_without_time_for_a_reference_there_is_none(heun: Heun) -> None:
    done = heun("chart", "long.yaml", "--time-limit", "0.01")
    assert done.returncode == 4 and done.stdout == "" and "[time-limit]" in done.stderr


def test_no_bar_shows_where_nobody_looks(heun: Heun) -> None:
    assert heun("chart", "swinging.yaml", *FEW).stderr == ""


@pytest.mark.skipif(os.name != "posix", reason="a device without a whole")
def test_a_full_disk_is_exit_5(heun: Heun) -> None:
    done = heun("chart", "swinging.yaml", *FEW, "-o", "/dev/full", "--format", "json")
    assert done.returncode == 5 and done.stdout == ""


def test_no_run_is_timed_again_beyond_the_limit(monkeypatch: pytest.MonkeyPatch) -> None:
    """The limit passes with the second run of a round of four."""
    again: list[int] = []
    motion = SimpleNamespace(late=False)

    def run() -> float:
        again.append(1)
        motion.late = len(again) == 2
        return 0.01

    runs = ChartRunner(cast(Any, motion), cast(Any, SimpleNamespace(seconds=1.0)), lambda done, of, what: None)
    rows = [ChartRow("RK4", "quaternion", True, 1e-3)] * 4
    monkeypatch.setattr(runs, "run_row", lambda row: TimedRun(ChartRun(row, COMPLETED, 0.01), run, [0.01]))
    assert len(runs.run_all(rows)) == 4 and len(again) == 2
