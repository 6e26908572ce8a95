"""`heun plot SPEC PATH...`: what the results say, read back from the picture; marks, gaps, horizons."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from heuncli.output.figures.courses import NumberCourse
from heuncli.output.figures.curves import N_INTERVALS, PanelCourse, choose_number_style, find_visible_points
from heuncli.output.figures.histories import _make_y_axis
from heuncli.results.results import Array
from heuncli.study.quantities.digits import ReaderStyle
from heuncli.study.quantities.table_units import read_display_units
from heuncli.study.queries.measure import Peak
from tests.shared.command import Heun
from tests.shared.drawn_panels import DrawnPanel, edges, heights, read
from tests.shared.folders import ROOT
from tests.shared.plotted import panels_of, texts_of

TURNING = """\
heun: 1
title: A wheel with a weight, driven
gravity: [0, 0, -9.81]
ground: {points: {O: [0, 0, 0]}}
bodies:
  wheel: {mass: 2, center: [0.1, 0, 0], inertia: [0.01, 0.02, 0.02], points: {hub: [0, 0, 0], rim: [0.3, 0, 0]}}
joints: {shaft: {type: pin, from: ground.O, to: wheel.hub, axis: [0, 1, 0]}}
drives: {motor: {joint: shaft, angle: 2*pi*t}}
analysis: {duration: 2, samples: 41}
"""


def spec(name: str) -> str:
    return str(ROOT / "specs" / f"{name}.yaml")


def drawn(heun: Heun, folder: Path, *words: str) -> list[DrawnPanel]:
    """The panels of a picture, in newtons and metres if nothing else is said."""
    words = words if "--units" in words else (*words, "--units", "N,m")
    done = heun("plot", *words, "-o", "picture.svg", "--quiet")
    assert (done.returncode, done.stdout, done.stderr) == (0, "", "")
    return read((folder / "picture.svg").read_text())


def notes(folder: Path) -> list[str]:
    """What is written in the last picture."""
    return texts_of((folder / "picture.svg").read_text())


def results(heun: Heun, *words: str) -> dict[str, Any]:
    found: dict[str, Any] = json.loads(heun("run", *words, "--format", "json", "--quiet").stdout)
    return found


def at_path(found: dict[str, Any], path: str) -> Array:
    """The numbers at a path, of a vector the magnitude."""
    node: Any = found
    for word in path.split("."):
        node = np.array(node)[:, "xyz".index(word)] if word in "xyz" else node[word]
    values = np.array(node, dtype=np.float64)
    return values if values.ndim == 1 else np.linalg.norm(values, axis=1)


SHOWN = [
    ("engine", ("joints.main.force", "joints.wrist.force", "coordinates.main.rate")),
    ("rotor", ("joints.left.force", "joints.right.force.y", "joints.right.force.z")),
    ("double", ("joints.pivot.force", "bodies.lower.center.x", "energy.kinetic", "energy.potential")),
    ("ladder", ("joints.wall.force", "joints.floor.force.z")),
]


@pytest.mark.parametrize(("name", "paths"), SHOWN)
@pytest.mark.third
def test_curves_are_the_results_to_a_pixel(heun: Heun, folder: Path, name: str, paths: tuple[str, ...]) -> None:
    panels = drawn(heun, folder, spec(name), *paths)
    found = results(heun, spec(name))
    times = np.array(found["time"])
    for path in paths:
        (panel,) = [panel for panel in panels if path in panel.curves]
        curve = panel.curve(path)
        assert curve[0, 0] == pytest.approx(times[0], abs=panel.across)
        assert curve[-1, 0] == pytest.approx(times[-1], abs=panel.across)
        assert np.abs(heights(curve, times) - at_path(found, path)).max() <= panel.pixel, path


def test_a_number_over_another_one_is_a_pixel_off_at_most(heun: Heun, folder: Path) -> None:
    words = (spec("engine"), "joints.wrist.force")
    (panel,) = drawn(heun, folder, *words, "--x", "coordinates.main.angle", "--units", "deg,kN")
    found = results(heun, spec("engine"))
    angle, force = np.degrees(at_path(found, "coordinates.main.angle")), at_path(found, words[1]) / 1e3
    assert panel.label == "force [kN]"
    assert np.abs(heights(panel.curve(words[1]), angle) - force).max() <= panel.pixel
    assert any("24.57 kN at 370.2°" in text for text in panel.texts())


def test_extremes_are_those_of_measures_and_stand_on_their_curves(heun: Heun, folder: Path) -> None:
    for path, how in (("joints.wrist.force", "max"), ("joints.wrist.force.z", "max"), ("joints.wrist.force.z", "min")):
        (panel,) = drawn(heun, folder, spec("engine"), path)
        told = json.loads(heun("run", spec("engine"), "--measure", f"{how} {path}", "--format", "json").stdout)
        off = np.abs(panel.marks - (told["at"], told["value"])) / (panel.across, panel.pixel)
        assert off.max(axis=1).min() <= 0.5
        shown = f"{told['value']:.0f} N at {told['at']:.4g} s".replace("-", "−")
        assert shown in panel.texts()


def test_paths_of_one_unit_share_a_panel(heun: Heun, folder: Path) -> None:
    panels = drawn(heun, folder, spec("double"), "energy.kinetic", "joints.pivot.force", "energy.potential")
    assert [panel.label for panel in panels] == ["energy [J]", "force [N]"]
    assert panels[0].curves.keys() == {"energy.kinetic", "energy.potential"}


def test_blows_and_events_stand_where_they_happen(heun: Heun, folder: Path) -> None:
    found = results(heun, spec("drill"))
    (panel,) = drawn(heun, folder, spec("drill"), "bodies.drill.position.z")
    for name, event in found["events"].items():
        for at in event["time"]:
            (mark,) = panel.curves[f"{name} at {at:.4g} s"]
            assert mark[:, 0] == pytest.approx(at, abs=panel.across)
    blows = [blow["time"] for blow in results(heun, spec("bouncing_ball"))["impulses"]]
    ball = drawn(heun, folder, spec("bouncing_ball"), "bodies.ball.velocity.z", "bodies.ball.center.z")[0]
    marks = [marks[0][0, 0] for name, marks in ball.curves.items() if name.startswith("floor at")]
    assert all(np.abs(np.array(marks) - at).min() <= 3.0 * ball.across for at in blows)
    (curve,) = ball.curves["bodies.ball.velocity.z"]
    jump = np.flatnonzero(np.abs(curve[:, 0] - blows[0]) <= ball.across)
    assert np.ptp(curve[jump, 1]) == pytest.approx((1.0 + 0.7) * 4.42944, abs=2.0 * ball.pixel)


def test_nothing_is_drawn_beyond_the_horizon(heun: Heun, folder: Path) -> None:
    words = (spec("double"), "--set", "analysis.duration=10", "--method", "RK4", "--step", "0.02")
    horizon = results(heun, *words)["accuracy"]["horizon"]
    path = "joints.elbow.force.x"
    (panel,) = drawn(heun, folder, *words, path)
    assert 0.0 < horizon < 9.0
    curve, band = panel.curve(path), panel.areas[f"stated error of {path}"]
    assert max(curve[:, 0].max(), band[:, 0].max()) <= horizon + panel.across
    assert any("no results claimed" in text for text in panel.texts())
    blank = panel.areas["past the horizon: no results claimed"]
    assert blank[:, 0].min() == pytest.approx(horizon, abs=panel.across)
    assert blank[:, 0].max() == pytest.approx(10.0, abs=panel.across)
    assert band[:, 1].min() < curve[:, 1].min() and curve[:, 1].max() < band[:, 1].max()


def test_of_two_runs_the_longer_one_is_drawn_to_its_end(heun: Heun, folder: Path) -> None:
    (folder / "turning.yaml").write_text(TURNING)
    (folder / "short.yaml").write_text(TURNING.replace("duration: 2", "duration: 1"))
    (panel,) = drawn(heun, folder, "short.yaml", "turning.yaml", "joints.shaft.force")
    ends = {name: lines[0][-1, 0] for name, lines in panel.curves.items()}
    assert ends["short: joints.shaft.force"] == pytest.approx(1.0, abs=panel.across)
    assert ends["turning: joints.shaft.force"] == pytest.approx(2.0, abs=panel.across)
    assert not panel.areas


def test_what_is_open_is_not_drawn_and_told(heun: Heun, folder: Path) -> None:
    panels = drawn(heun, folder, spec("flat_four_bar"), "joints.A.force.x", "joints.A.force.z", "joints.A.moment.x")
    assert panels[0].curves.keys() == {"joints.A.force.x"}
    assert any("open" in text for text in panels[1].texts()) and not panels[1].curves
    text = (folder / "picture.svg").read_text()
    assert "open, not drawn: A, Fz; A, Mx" in text


def test_what_is_constant_is_told_once(heun: Heun, folder: Path) -> None:
    (folder / "turning.yaml").write_text(TURNING)
    (panel,) = drawn(heun, folder, "turning.yaml", "coordinates.shaft.rate")
    assert panel.texts() == ["6.283 rad/s at all times"] and len(panel.marks) == 1


def test_of_one_instant_each_case_is_a_bar(heun: Heun, folder: Path) -> None:
    (panel,) = drawn(heun, folder, spec("axle_loads"), "joints.front.force", "--case", "all")
    (plotted,) = panels_of((folder / "picture.svg").read_text())
    tops = np.array([bar[:, 1].max() for bar in plotted.areas("joints.front.force")])
    cases = [
        case["joints"]["front"]["force"][0]
        for case in results(heun, spec("axle_loads"), "--case", "all")["cases"].values()
    ]
    for value in np.linalg.norm(np.array(cases), axis=1):
        assert np.abs(tops - value).min() <= panel.pixel and len(tops) == len(cases)
        assert f"{value:.0f}" in panel.texts()


SPRING = """\
heun: 1
title: A mass let go on a stiff spring, hundreds of times up and down
gravity: [0, 0, -9.81]
ground: {points: {O: [0, 0, 0]}}
bodies: {m: {mass: 1, center: [0, 0, 0], inertia: [1, 1, 1], points: {p: [0, 0, 0]}, position: [0, 0, -1]}}
joints: {guide: {type: slide, from: ground.O, to: m.p, axis: [0, 0, 1]}}
forces: {spring: {type: spring, from: ground.O, to: m.p, stiffness: 40000, length: 1}}
analysis: {duration: 15, samples: 16}
"""


def test_of_many_turns_none_is_lost(heun: Heun, folder: Path) -> None:
    (folder / "spring.yaml").write_text(SPRING)
    (panel,) = drawn(heun, folder, "spring.yaml", "coordinates.guide.travel")
    low, high = edges(panel.areas["range of coordinates.guide.travel"], np.linspace(0.0, 15.0, 301))
    assert np.abs(high + 1.0).max() <= panel.pixel  # 200/2π periods a second
    assert np.abs(low + 1.0 + 2.0 * 9.81 / 40000.0).max() <= panel.pixel
    assert not panel.curves.get("coordinates.guide.travel") and any("60 periods" in text for text in notes(folder))


@pytest.mark.parametrize("count", [100, 6001, 50_000, 123_457])
def test_of_each_stretch_the_least_and_the_greatest_are_kept(count: int) -> None:
    random = np.random.default_rng(count)
    values = random.normal(size=count)
    values[random.choice(count, 3)] = np.nan
    kept = find_visible_points(values)
    assert len(kept) <= min(count, 4 * N_INTERVALS + 1) and {0, count - 1} <= set(kept.tolist())
    width = -(-count // N_INTERVALS)
    for begin in range(0, count, 40 * width):
        part, seen = values[begin : begin + 40 * width], kept[(kept >= begin) & (kept < begin + 40 * width)]
        assert np.nanmax(part) == np.nanmax(values[seen]) and np.nanmin(part) == np.nanmin(values[seen])
        assert np.isnan(part).any() == np.isnan(values[seen]).any()


def test_the_same_bytes_every_time(heun: Heun, folder: Path) -> None:
    found = []
    for name in ("a.svg", "b.svg"):
        heun("plot", spec("engine"), "joints.main.force", "--x", "coordinates.main.angle", "-o", name)
        found.append((folder / name).read_bytes())
    assert found[0] == found[1]


def test_what_happens_at_one_instant_is_all_named(heun: Heun, folder: Path) -> None:
    """Two blows at one instant in two runs: the mark has the names of both."""
    for name in ("push", "pull"):
        blow = f"impulses: {{{name}: {{on: wheel.rim, vector: [0, 0, 1], time: 0.5}}}}\n"
        (folder / f"{name}.yaml").write_text(TURNING.replace("drives: {motor: {joint: shaft, angle: 2*pi*t}}\n", blow))
    (panel,) = drawn(heun, folder, "push.yaml", "pull.yaml", "energy.kinetic")
    assert "push, pull at 0.5 s" in panel.curves


def test_the_whole_of_a_number_without_unit_is_told(heun: Heun, folder: Path) -> None:
    """The place of an extreme over such a number keeps all its digits: 0.501 is not 0.50."""
    (folder / "wheel.yaml").write_text(TURNING)
    (panel,) = drawn(heun, folder, "wheel.yaml", "joints.shaft.force", "--x", "bodies.wheel.rotation.0.0")
    for _, _, text in panel.words:
        place = float(text.partition(" at ")[2].replace("−", "-"))
        assert min(abs(place - x) for x, _ in panel.marks) <= 2.0 * panel.across


def test_what_is_less_than_its_error_stays_in_its_panel() -> None:
    """A number of 3 known to 5, or a band wider than what it is of, is not drawn over the panels beside it."""
    for value, error in ((3.0, 5.0), (30.0, 29.0)):
        course = NumberCourse("p", "N", np.array([0.0, 1.0]), np.full(2, value), error, *2 * (Peak(value, 0.0),))
        of = PanelCourse("p", 0, None, course.times, course)  # type: ignore[arg-type]
        scaling = _make_y_axis("force", ReaderStyle("N", 1.0, 0), [of], [])
        assert scaling.low <= value - error and value + error <= scaling.high


@pytest.mark.parametrize(
    ("unit", "largest", "given", "shown"),
    [
        ("N·m", 865.881, "N,mm", "865.9 N·m"), ("N·m", 8.65881, "N,mm", "8659 N·mm"), ("N", 12510.0, "N,mm", "12510 N"),
        ("N", 125100.0, "N,mm", "125100 N"), ("N", 19.2, "kN", "0.01920 kN"), ("N", 0.0, "kN", "0 kN"),
        ("rad/s", 1e6, "rpm", "9549297 rpm"), ("N", 1e18, "MN", "1000000000000 MN"),
    ],
)  # fmt: skip
def test_a_product_of_units_that_makes_numbers_long_gives_way(
    unit: str, largest: float, given: str, shown: str
) -> None:
    """A unit that was asked for stays."""
    style = choose_number_style(unit, largest, read_display_units("--units", given))
    assert f"{style.write(largest)} {style.unit}" == shown
