"""Joint loads in the axes of a body: the same vectors, and what is open told anew in these directions."""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np
import pytest

from heuncli.app.cli.entry import enter
from heuncli.results.results import Array, Block, Results
from heuncli.scene.file_format.load import load
from heuncli.study.model.options import Options
from heuncli.study.quantities.labels import make_labels
from heuncli.study.queries.study import Study
from heuncli.study.workflow import solve
from tests.shared.folders import SPECS

SOLVED = ("double", "engine", "spatial_crank", "skew_rod", "hammered_four_bar", "crankshaft_stiff")
WANTED = frozenset({"joints", "motion", "foundation", "shares", "impulses"})


def solved(path: Path | str, axes: str) -> Study:
    return solve(load(str(path)), Options(requested_reports=WANTED, axes=axes))


def attitude(results: Results, end: str) -> Array:
    body = end.partition(".")[0]
    return np.eye(3)[None] if body == "ground" else np.asarray(results.bodies[body]["rotation"])


def same(told: Block, world: Block, R: Array) -> None:
    for name in ("force", "moment"):
        if name in world:
            expected = np.einsum("tji,tj->ti", R, np.atleast_2d(world[name]))
            known = np.isfinite(np.atleast_2d(told[name]))
            scale = np.nanmax(np.abs(world[name]), initial=0.0) + 1e-300
            agree = np.abs(np.atleast_2d(told[name]) - expected) <= 1e-12 * scale
            assert np.all(agree | ~known | ~np.isfinite(expected)), name


@pytest.mark.heavy
@pytest.mark.parametrize("axes", ["from", "to"])
@pytest.mark.parametrize("name", SOLVED)
@pytest.mark.third
def test_the_vectors_are_the_same(name: str, axes: str) -> None:
    world, told = (solved(SPECS / f"{name}.yaml", which).results for which in ("world", axes))
    labels = make_labels(load(str(SPECS / f"{name}.yaml")))
    assert told.model["axes"] == axes
    assert "axes" not in world.model
    for joint, block in world.joints.items():
        end = labels.joints[joint].first_end if axes == "from" else labels.joints[joint].second_end
        R = attitude(world, end)
        same(told.joints[joint], block, R)
        for cause, share in block["shares"].items():
            same(told.joints[joint]["shares"][cause], share, R)
        for number in ("axial", "radial", "tilting", "drive", "tension", "point"):
            assert np.array_equal(told.joints[joint].get(number, 0.0), block.get(number, 0.0), equal_nan=True)
        for mine, its in zip(told.impulses, world.impulses, strict=True):
            k = int(np.searchsorted(world.time, mine["time"]))
            same(mine["joints"][joint], its["joints"][joint], R[k : k + 1] if len(R) > 1 else R)
    for support, block in world.foundation["supports"].items():
        assert np.array_equal(told.foundation["supports"][support]["force"], block["force"], equal_nan=True)


LEANING = """
heun: 1
gravity: [0, 0, -10]
ground: {points: {low: [0, 0, 0], high: [1, 0, 1]}}
bodies:
  door: {mass: 2, center: [0, 0.5, 0.7], inertia: [1, 1, 1], points: {low: [0, 0, 0], high: [0, 0, "sqrt(2)"]},
    position: [0, 0, 0], orientation: {axis: [0, 1, 0], angle: 45 deg}}
joints:
  top: {type: ball, from: ground.high, to: door.high}
  bottom: {type: ball, from: ground.low, to: door.low}
analysis: {type: state}
"""


def test_what_is_open_along_a_leaning_axis_is_so_in_the_axes_of_the_body_alone(tmp_path: Path) -> None:
    """Two balls on a line at 45 degrees: in world axes x and z are open, in the door's z alone, along the line."""
    spec = tmp_path / "leaning.yaml"
    spec.write_text(LEANING)
    world, told = (solved(spec, axes).results for axes in ("from", "to"))
    for joint in ("top", "bottom"):
        assert {"force.x", "force.z"} <= set(world.joints[joint]["open"])
        assert told.joints[joint]["open"] == ["force.z"]
        assert np.isnan(told.joints[joint]["force"]).tolist() == [[False, False, True]]
    across = sum(told.joints[joint]["force"][0, 0] for joint in ("top", "bottom"))
    a = told.bodies["door"]["center_acceleration"][0]
    e = told.bodies["door"]["rotation"][0][:, 0]
    assert across == pytest.approx(2.0 * float(e @ (a + np.array([0.0, 0.0, 10.0]))), rel=1e-12)


ROTOR = """
heun: 1
parameters: {n: 3, e: 0.1}
gravity: [0, 0, -10]
ground: {points: {O: [0, 0, 0]}}
bodies: {rotor: {mass: 2, center: [0, e, 0], inertia: [1, 1, 1], points: {O: [0, 0, 0]}}}
joints: {shaft: {type: pin, from: ground.O, to: rotor.O, axis: [1, 0, 0]}}
drives: {motor: {joint: shaft, angle: "n*t"}}
analysis: {duration: 4, samples: 5}
"""


def measured(path: Path, what: str, capsys: pytest.CaptureFixture[str], *words: str) -> float:
    assert enter(["run", str(path), "--measure", what, *words]) == 0
    return float(capsys.readouterr().out)


@pytest.mark.heavy
def test_an_unbalance_stands_still_in_the_axes_of_the_rotor(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    """F' = -m e n^2 e_y + m g e_z (t): the weight turns, its extremes lie between the samples."""
    spec = tmp_path / "rotor.yaml"
    spec.write_text(ROTOR)
    unbalance, weight = 2.0 * 0.1 * 9.0, 20.0
    for how, expected in (("max", weight), ("min", -weight)):
        turned = [measured(spec, f"{how} joints.shaft.force.{axis}", capsys, "--axes", "to") for axis in "yz"]
        assert turned == pytest.approx([expected - unbalance, expected], rel=1e-9)
    assert measured(spec, "max joints.shaft.force.z", capsys) == pytest.approx(weight + unbalance, rel=1e-9)
    assert measured(spec, "max joints.shaft.force.z", capsys, "--axes", "from") == pytest.approx(weight + unbalance)


def test_a_measure_in_json_says_so(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    spec = tmp_path / "rotor.yaml"
    spec.write_text(ROTOR)
    words = ["--measure", "first joints.shaft.force.y", "--format", "json"]
    assert enter(["run", str(spec), *words, "--axes", "to"]) == 0
    assert json.loads(capsys.readouterr().out)["axes"] == "to"
    assert enter(["run", str(spec), *words]) == 0
    assert "axes" not in json.loads(capsys.readouterr().out)


@pytest.mark.parametrize(("words", "heading"), [
    (["--axes", "to"], 'axes of the "to" body,'), (["--axes", "world"], "world axes, moment about"),
])  # fmt: skip
def test_the_heading_says_so(words: list[str], heading: str, capsys: pytest.CaptureFixture[str]) -> None:
    assert enter(["run", str(SPECS / "double.yaml"), "--only", "joints", *words]) == 0
    assert heading in capsys.readouterr().out


def test_other_axes_are_refused(capsys: pytest.CaptureFixture[str]) -> None:
    assert enter(["run", str(SPECS / "double.yaml"), "--axes", "body"]) == 2
    assert "--axes body: expected world, from, to" in capsys.readouterr().err
