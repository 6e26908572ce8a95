"""A scene's drawing read back: joints, bodies and arrows stand to a pixel where the JSON of the same run has them."""

from __future__ import annotations

import json
import re
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from heuncli.output.machine_geometry.views import SceneView, parse_view
from heuncli.results.results import Array
from heuncli.scene.file_format.load import load
from tests.gallery.contents import find_spec
from tests.shared.command import Heun
from tests.shared.plotted import PlottedPanel, far_from, key_arrows, panels_of, texts_of, views_of

SPECS = Path(__file__).parents[2] / "specs"
CASES = [  # spec, view, instant; closed loops, planar and spatial ones, redundant ones, ropes
    ("four_bar", "z", 0.0), ("four_bar", "z", 0.25), ("four_bar", "25,40", 0.1), ("spatial_crank", "30,20", 0.0),
    ("spatial_crank", "x", 0.05), ("crane", "-70,35", 1.0), ("double", "y", 0.5), ("governor", "30,20", 0.0),
    ("excavator", "z", 1.0), ("jib", "0,0", 0.5), ("bricard", "10,-60", 0.2), ("engine", "x", 0.003),
    ("overhang", "z", 0.0),
]  # fmt: skip
VALUE = re.compile(r"(.+?) ([\d.]+) (N|kN|MN)(?: / .*)?")
NEWTONS = {"N": 1.0, "kN": 1e3, "MN": 1e6}
JOINT_KEY = re.compile(r"([\d.]+) (N|kN|MN) joint on .*")


def run(heun: Heun, spec: str) -> dict[str, Any]:
    """The results of a spec as its JSON has them."""
    done = heun("run", str(SPECS / f"{spec}.yaml"), "--format", "json", "--only", "motion,joints", "--quiet")
    assert done.returncode == 0, done.stderr
    found: dict[str, Any] = json.loads(done.stdout)
    return found


def drawn(heun: Heun, spec: str, *words: str) -> tuple[PlottedPanel, str]:
    """The view of its scene, and the SVG."""
    done = heun("plot", str(SPECS / f"{spec}.yaml"), "scene", *words, "--quiet", "-o", "scene.svg")
    assert (done.returncode, done.stderr) == (0, ""), done.stderr
    text = Path("scene.svg").read_text()
    (view,) = views_of(text)
    return view, text


def seen_from(spec: str, words: str) -> SceneView:
    """The view of a spec."""
    return parse_view(words, np.array(load(str(SPECS / f"{spec}.yaml")).gravity, dtype=np.float64))


def middle(panel: PlottedPanel, name: str) -> Array:
    """Where the topmost symbol of a name stands."""
    shapes = [points[:-1] for points in panel.lines(name)] or panel.areas(name)
    return np.asarray(shapes[-1].mean(axis=0))


@pytest.mark.parametrize(("spec", "view", "at"), CASES)
@pytest.mark.third
def test_joints_their_forces_and_centres_of_mass(heun: Heun, spec: str, view: str, at: float) -> None:
    results, seen = run(heun, spec), seen_from(spec, view)
    k = int(np.argmin(np.abs(np.array(results["time"]) - at)))
    panel, text = drawn(heun, spec, "--view", view, "--at", repr(results["time"][k]))
    kinds = results_kinds(spec)
    found, placed = [], []
    for name, joint in results["joints"].items():
        place = seen.project(np.array(joint["point"][k], dtype=np.float64))
        if kinds[name] != "rod":
            found.append(middle(panel, f"{name}: {kinds[name]}"))
            placed.append(place)
        for line, tip in zip(panel.lines(f"force: {name}"), panel.areas(f"force: {name}"), strict=True):
            force = seen.project(np.array(joint["force"][k], dtype=np.float64))
            found.append(line[0])
            placed.append(place)
            arrow = key_length(panel, text) * force
            assert np.abs(tip[0] - line[0] - arrow).max() < 0.01 * np.abs(arrow).max() + panel.pixel, name
    for name, body in results["bodies"].items():
        for ring in panel.lines(f"{name}: centre of mass"):
            found.append(ring[:-1].mean(axis=0))
            placed.append(seen.project(np.array(body["center"][k], dtype=np.float64)))
    apart = np.array(found) - np.array(placed)
    assert len(apart) > len(kinds)
    assert np.abs(apart - np.median(apart, axis=0)).max() < 1.5 * panel.pixel


@pytest.mark.parametrize(("spec", "view", "at"), CASES)
@pytest.mark.third
def test_values_at_arrows_are_those_of_the_json(heun: Heun, spec: str, view: str, at: float) -> None:
    results = run(heun, spec)
    k = int(np.argmin(np.abs(np.array(results["time"]) - at)))
    _, text = drawn(heun, spec, "--view", view, "--at", repr(results["time"][k]))
    forces = {
        name.replace("_", " "): float(np.linalg.norm(np.array(joint["force"][k], dtype=np.float64)))
        for name, joint in results["joints"].items()
    }
    largest = max(forces.values())
    written = {}
    for word in texts_of(text):
        match = VALUE.fullmatch(re.sub(r"^\d+  ", "", word))  # a number in a circle stands before its name
        if match and match[1] in forces:
            digits = len(match[2].partition(".")[2])
            assert float(match[2]) == pytest.approx(forces[match[1]] / NEWTONS[match[3]], abs=0.51 * 10.0**-digits)
            written[match[1]] = match[2]
    assert {name for name, force in forces.items() if force >= 0.011 * largest} <= set(written)


def key_length(panel: PlottedPanel, text: str) -> float:
    """How long one newton is drawn [m], by the key."""
    ((match, pixels),) = [
        (m, pixels) for words, pixels in key_arrows(text).items() if (m := JOINT_KEY.fullmatch(words))
    ]
    return pixels * panel.x.step / (float(match[1]) * NEWTONS[match[2]])


def shift_of(panel: PlottedPanel, seen: SceneView, results: dict[str, Any], joint: str, kind: str, k: int) -> Array:
    """How far the view's origin is from the world's, by one of its joints."""
    place = seen.project(np.array(results["joints"][joint]["point"][k], dtype=np.float64))
    return np.asarray(middle(panel, f"{joint}: {kind}") - place)


def results_kinds(spec: str) -> dict[str, str]:
    """The kinds of a spec's joints."""
    return {name: joint.kind for name, joint in load(str(SPECS / f"{spec}.yaml")).joints.items()}


def test_a_way_goes_through_the_places_of_its_point(heun: Heun) -> None:
    results = run(heun, "four_bar")
    panel, _ = drawn(heun, "four_bar", "coupler.C", "rocker.center", "--view", "z", "--at", "0")
    shift = shift_of(panel, seen_from("four_bar", "z"), results, "C", "line", 0)
    (way,) = panel.lines("rocker.center")
    centres = np.array(results["bodies"]["rocker"]["center"])[:, :2]
    assert far_from(centres, way - shift) < 1.5 * panel.pixel
    (other,) = panel.lines("coupler.C")
    assert far_from(np.array(results["joints"]["C"]["point"])[:, :2], other - shift) < 1.5 * panel.pixel


def test_chosen_units_are_those_of_the_scale_and_the_arrows(heun: Heun) -> None:
    metres, _ = drawn(heun, "four_bar")
    millimetres, text = drawn(heun, "four_bar", "--units", "mm,N")
    assert metres.x.step == pytest.approx(millimetres.x.step, rel=1e-3)
    words = texts_of(text)
    assert any(re.fullmatch(r"\d+ mm", word) for word in words) and any(" N joint on" in word for word in words)
    _, text = drawn(heun, "four_bar", "--units", "m,kN")
    assert any(re.fullmatch(r"0\.\d+ m", word) for word in texts_of(text))


def test_a_view_has_no_axes_with_numbers_and_no_frame(heun: Heun) -> None:
    _, text = drawn(heun, "crane", "--at", "0")
    assert panels_of(text) == []
    words = texts_of(text)
    assert {"x", "y", "z", "g"} <= set(words) and not any(word.lstrip("-").replace(".", "").isdigit() for word in words)


def test_by_default_the_greatest_joint_force_is_drawn_and_it_is_said(heun: Heun) -> None:
    spec = str(SPECS / "engine.yaml")
    _, text = drawn(heun, "engine")
    peaks = {}
    for name in results_kinds("engine"):
        done = heun("run", spec, "-q", "--measure", f"max joints.{name}.force")
        peaks[name] = float(done.stdout)
    worst = max(peaks, key=lambda name: peaks[name])
    (words,) = [word for word in texts_of(text) if "worst instant" in word]
    said = " ".join(texts_of(text)).partition("greatest joint force, ")[2].split(" ")
    assert words.startswith("t = ") and said[0] == worst
    assert float(said[1]) * NEWTONS[said[2].rstrip(";")] == pytest.approx(peaks[worst], rel=1e-3)
    _, again = drawn(heun, "engine", "--at", "worst")
    _, start = drawn(heun, "engine", "--at", "start")
    assert again == text and "t = 0 s; seen" in start


def test_all_kinds_of_loads_have_arrows(heun: Heun) -> None:
    """Springs, motors, the gas of a piston on both sides, mounts, drives."""
    engine, text = drawn(heun, "engine")
    assert len(engine.lines("force: gas")) == 2 and any(word.startswith("gas ") for word in texts_of(text))
    mounts, _ = drawn(heun, "engine_mounts")
    names = [name for name, force in load(str(SPECS / "engine_mounts.yaml")).forces.items() if force.type == "bushing"]
    assert len(names) > 2 and all(len(mounts.lines(f"force: {name}")) == 1 for name in names)
    drive, _ = drawn(heun, "slider_crank", "--view", "30,20")
    (shaft,), tips = drive.lines("moment: motor"), drive.areas("moment: motor")
    assert len(shaft) == 2 and len(tips) == 1  # its second head has no name of its own


def test_of_many_labels_numbers_are_listed_below(heun: Heun) -> None:
    assert heun("plot", str(find_spec("v_engine")), "scene", "--quiet", "-o", "scene.svg").returncode == 0
    words = texts_of(Path("scene.svg").read_text())
    numbers = [word for word in words if word.isdigit()]
    listed = [word for word in words if re.match(r"\d+  \S", word)]
    assert len(numbers) > 20 and sorted(numbers, key=int) == [word.split("  ")[0] for word in listed]


def test_the_branch_that_was_assembled_is_seen(heun: Heun, folder: Path) -> None:
    text = (SPECS / "four_bar.yaml").read_text()
    other = text.replace("angle: 40 deg", "angle: -40 deg").replace("angle: 90 deg", "angle: -90 deg")
    assert other != text
    places = []
    for number, one in enumerate((text, other.partition("expect:")[0])):
        (folder / f"bar{number}.yaml").write_text(one)
        done = heun("plot", f"bar{number}.yaml", "scene", "--at", "0", "-o", "bar.svg", "--quiet")
        assert done.returncode == 0, done.stderr
        (panel,) = views_of(Path("bar.svg").read_text())
        places.append(middle(panel, "C: line") - middle(panel, "crank: pin"))
    assert places[0] == pytest.approx(places[1] * (1.0, -1.0), abs=3.0 * panel.pixel)
    assert places[0][1] > 0.05
