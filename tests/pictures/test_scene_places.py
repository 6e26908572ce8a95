"""A scene's drawing read back: joints, bodies and arrows stand to a pixel where the JSON of the same run has them."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from heuncli.output.machine_geometry.views import SceneView, parse_view
from heuncli.results.results import Array
from heuncli.scene.file_format.load import load
from tests.shared.command import Heun
from tests.shared.plotted import PlottedPanel, far_from, panels_of, texts_of

SPECS = Path(__file__).parents[2] / "specs"
CASES = [  # spec, view, instant; closed loops, planar and spatial ones, redundant ones, ropes
    ("four_bar", "z", 0.0), ("four_bar", "z", 0.25), ("four_bar", "25,40", 0.1), ("spatial_crank", "30,20", 0.0),
    ("spatial_crank", "x", 0.05), ("crane", "-70,35", 1.0), ("double", "y", 0.5), ("governor", "30,20", 0.0),
    ("excavator", "z", 1.0), ("jib", "0,0", 0.5), ("bricard", "10,-60", 0.2), ("engine", "x", 0.003),
    ("overhang", "z", 0.0),
]  # fmt: skip


def run(heun: Heun, spec: str) -> dict[str, Any]:
    """The results of a spec as its JSON has them."""
    done = heun("run", str(SPECS / f"{spec}.yaml"), "--format", "json", "--only", "motion,joints", "--quiet")
    assert done.returncode == 0, done.stderr
    found: dict[str, Any] = json.loads(done.stdout)
    return found


def drawn(heun: Heun, spec: str, *words: str) -> tuple[PlottedPanel, list[str]]:
    """The panel of its scene, and all that is written."""
    done = heun("plot", str(SPECS / f"{spec}.yaml"), "scene", *words, "--quiet", "-o", "scene.svg")
    assert (done.returncode, done.stderr) == (0, ""), done.stderr
    text = Path("scene.svg").read_text()
    (panel,) = panels_of(text, equal=True)
    return panel, texts_of(text)


def seen_from(spec: str, words: str) -> SceneView:
    """The view of a spec."""
    return parse_view(words, np.array(load(str(SPECS / f"{spec}.yaml")).gravity, dtype=np.float64))


def middle(panel: PlottedPanel, name: str) -> Array:
    """Where the topmost symbol of a name stands."""
    shapes = [points[:-1] for points in panel.lines(name)] or panel.areas(name)
    return np.asarray(shapes[-1].mean(axis=0))


@pytest.mark.parametrize(("spec", "view", "at"), CASES)
def test_joints_their_forces_and_centres_of_mass(heun: Heun, spec: str, view: str, at: float) -> None:
    results, seen = run(heun, spec), seen_from(spec, view)
    k = int(np.argmin(np.abs(np.array(results["time"]) - at)))
    panel, words = drawn(heun, spec, "--view", view, "--at", repr(results["time"][k]))
    kinds = results_kinds(spec)
    checked = 0
    for name, joint in results["joints"].items():
        place = seen.project(np.array(joint["point"][k], dtype=np.float64))
        if kinds[name] != "rod":
            assert np.abs(middle(panel, f"{name}: {kinds[name]}") - place).max() < 1.5 * panel.pixel, name
            checked += 1
        for line, tip in zip(panel.lines(f"force: {name}"), panel.areas(f"force: {name}"), strict=True):
            force = seen.project(np.array(joint["force"][k], dtype=np.float64))
            assert np.abs(line[0] - place).max() < 1.5 * panel.pixel
            # the key tells how long an arrow is: its words stand at the key's tip
            scale = key_length(panel, words) if force.any() else 0.0
            assert np.abs(tip[0] - place - scale * force).max() < 0.01 * np.abs(scale * force).max() + panel.pixel, name
            checked += 1
    for name, body in results["bodies"].items():
        centre = seen.project(np.array(body["center"][k], dtype=np.float64))
        for ring in panel.lines(f"{name}: centre of mass"):
            assert np.abs(ring[:-1].mean(axis=0) - centre).max() < 1.5 * panel.pixel, name
            checked += 1
    assert checked > len(kinds)


def key_length(panel: PlottedPanel, words: list[str]) -> float:
    """How long one newton is drawn, by the key."""
    (text,) = (word for word in words if word.endswith(': joint reactions, "from" on "to"'))
    (line,), (tip,) = panel.lines(text), panel.areas(text)
    return float(tip[0, 0] - line[0, 0]) / float(text.partition(" N:")[0])


def results_kinds(spec: str) -> dict[str, str]:
    """The kinds of a spec's joints."""
    return {name: joint.kind for name, joint in load(str(SPECS / f"{spec}.yaml")).joints.items()}


def test_a_way_goes_through_the_places_of_its_point(heun: Heun) -> None:
    results = run(heun, "four_bar")
    panel, _ = drawn(heun, "four_bar", "coupler.C", "rocker.center", "--view", "z")
    (way,) = panel.lines("rocker.center")
    centres = np.array(results["bodies"]["rocker"]["center"])[:, :2]
    assert far_from(centres, way) < 1.5 * panel.pixel
    (other,) = panel.lines("coupler.C")
    assert far_from(np.array(results["joints"]["C"]["point"])[:, :2], other) < 1.5 * panel.pixel


def test_units_of_the_axes(heun: Heun) -> None:
    metres, _ = drawn(heun, "four_bar")
    millimetres, words = drawn(heun, "four_bar", "--units", "mm,kN")
    assert middle(millimetres, "C: line") == pytest.approx(1e3 * middle(metres, "C: line"), abs=1.5 * millimetres.pixel)
    assert "x [mm]" in words and "y [mm]" in words and any(" kN: joint reactions" in word for word in words)


def test_one_unit_is_as_long_on_both_axes(heun: Heun) -> None:
    panel, _ = drawn(heun, "crane", "--view", "x")
    assert panel.x.step == pytest.approx(-panel.y.step, rel=2e-3)


def test_the_branch_that_was_assembled_is_seen(heun: Heun, folder: Path) -> None:
    text = (SPECS / "four_bar.yaml").read_text()
    other = text.replace("angle: 40 deg", "angle: -40 deg").replace("angle: 90 deg", "angle: -90 deg")
    assert other != text
    places = []
    for number, one in enumerate((text, other.partition("expect:")[0])):
        (folder / f"bar{number}.yaml").write_text(one)
        done = heun("plot", f"bar{number}.yaml", "scene", "-o", "bar.svg", "--quiet")
        assert done.returncode == 0, done.stderr
        (panel,) = panels_of(Path("bar.svg").read_text(), equal=True)
        places.append(middle(panel, "C: line"))
    assert places[0] == pytest.approx(places[1] * (1.0, -1.0), abs=2.0 * panel.pixel)
    assert places[0][1] > 0.05
