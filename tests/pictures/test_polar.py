"""Polar diagrams, read back from the drawing: a rotor's is a circle, an engine's goes through its JSON's numbers."""

from __future__ import annotations

import json
import re
from pathlib import Path

import numpy as np
import pytest

from heuncli.output.drawing.figure import Spot
from heuncli.output.drawing.style import FAINT, find_pen
from heuncli.output.figures.polar import thin_marks
from tests.shared.command import Heun
from tests.shared.folders import ROOT
from tests.shared.plotted import SVG, PlottedPanel, far_from, polar_panel_of, texts_of

SPECS = Path(__file__).parents[2] / "specs"
ROTOR, ENGINE = str(SPECS / "rotor.yaml"), str(SPECS / "engine.yaml")
SHAFT, DISC, m, e, g, n = 7850 * np.pi * 0.015**2 * 0.6, 12.0, 0.02, 0.04, 9.81, 3000 * np.pi / 30
WEIGHT, UNBALANCE = (SHAFT + DISC) * g / 2, 2 / 3 * m * e * n**2  # on the right bearing
CRANK = """\
heun: 1
title: A crank that is turned
ground: {points: {O: [0, 0, 0]}}
bodies:
  crank: {mass: 2, center: [0.1, 0, 0], inertia: [0.01, 0.01, 0.01], points: {o: [0, 0, 0]}}
joints:
  main: {type: pin, from: ground.O, to: crank.o, axis: [0, 0, 1]}
drives: {motor: {joint: main, angle: LAW}}
analysis: {duration: 3, samples: 301}
"""


def drawn(heun: Heun, *words: str) -> tuple[PlottedPanel, str]:
    """The panel of what `heun plot` draws, and all that is written."""
    done = heun("plot", *words, "-o", "drawn.svg")
    assert (done.returncode, done.stderr) == (0, ""), done.stderr
    text = Path("drawn.svg").read_text()
    assert not re.search(r"\b(nan|inf)\b", text)
    return polar_panel_of(text), "\n".join(texts_of(text))


def test_a_rotors_is_a_circle_about_its_weight(heun: Heun) -> None:
    panel, _ = drawn(heun, ROTOR, "polar", "joints.right")
    (curve,) = panel.lines("joints.right.force")
    radii = np.hypot(curve[:, 0], curve[:, 1] - WEIGHT - 2 / 3 * m * g)
    assert np.abs(radii - UNBALANCE).max() < panel.pixel
    assert np.ptp(np.arctan2(curve[:, 1] - WEIGHT, curve[:, 0])) > 6.0


def test_in_the_rotors_axes_it_is_the_weight_that_turns(heun: Heun) -> None:
    panel, words = drawn(heun, ROTOR, "polar", "joints.right", "--axes", "to")
    (curve,) = panel.lines("joints.right.force")
    radii = np.hypot(curve[:, 0], curve[:, 1] - UNBALANCE)
    assert np.abs(radii - WEIGHT - 2 / 3 * m * g).max() < panel.pixel
    assert "in the axes of rotor" in words


def test_the_curve_goes_through_the_numbers_of_the_json(heun: Heun) -> None:
    panel, words = drawn(heun, ENGINE, "polar", "joints.main")
    (curve,) = panel.lines("joints.main.force")
    found = json.loads(heun("run", ENGINE, "--format", "json").stdout)
    force = np.array(found["joints"]["main"]["force"])
    assert far_from(force[:, 1:] / 1e3, curve) < panel.pixel
    peak = json.loads(heun("run", ENGINE, "--measure", "max joints.main.radial", "--format", "json").stdout)
    largest = re.search(r"largest ([\d.]+) kN at ([\d.]+)°.* at t = ([\d.]+) s, .*angle = ([\d.]+)°", words)
    assert largest is not None
    value, towards, at, angle = map(float, largest.groups())
    assert value == pytest.approx(peak["value"] / 1e3, abs=5.1e-3) and at == pytest.approx(peak["at"], rel=1e-4)
    (spot,) = panel.spots(filled=True)
    assert np.hypot(*spot) == pytest.approx(value, abs=panel.pixel)
    assert np.degrees(np.arctan2(spot[1], spot[0])) == pytest.approx(towards, abs=0.5)
    turned = np.degrees(np.interp(at, found["time"], found["coordinates"]["main"]["angle"]))
    assert angle == pytest.approx(turned, abs=0.1)


def test_units_are_those_asked_for(heun: Heun) -> None:
    panel, words = drawn(heun, ROTOR, "polar", "joints.right", "--units", "kN")
    (curve,) = panel.lines("joints.right.force")
    assert curve[:, 1].max() == pytest.approx(1e-3 * (WEIGHT + UNBALANCE + 2 / 3 * m * g), abs=panel.pixel)
    assert "0.05 kN" in words.split("\n")


@pytest.mark.parametrize("way", ["", "-"])
def test_of_a_motion_that_comes_back_the_last_turn(heun: Heun, folder: Path, way: str) -> None:
    (folder / "even.yaml").write_text(CRANK.replace("LAW", f'"{way}2*pi*t"'))
    panel, words = drawn(heun, "even.yaml", "polar", "joints.main")
    assert "the last revolution of Main, angle, t = 2 to 3 s" in words
    assert {"0°", "90°", "180°", "270°"} <= set(words.split("\n")) and "360°" not in words.split("\n")
    marks, centripetal = panel.spots(filled=False), 2 * 0.1 * (2 * np.pi) ** 2
    assert np.abs(np.hypot(*marks.T) - centripetal).max() < panel.pixel
    assert "Main, force: 7.896 N at all times" in words  # no place of it is the largest
    assert np.abs(np.degrees(np.arctan2(*marks.T[::-1])) % 30.0 - 15.0).min() > 14.5  # of the twelve each at its angle


def test_a_small_vector_beside_a_large_one_has_to_come_back_too(heun: Heun, folder: Path) -> None:
    """A moment of thousandths that grows, beside a force of tens that turns evenly."""
    growing = "forces: {twist: {type: couple, on: crank, vector: [0.001*t, 0, 0]}}\n"
    (folder / "growing.yaml").write_text(CRANK.replace("LAW", '"2*pi*t"') + growing)
    _, words = drawn(heun, "growing.yaml", "polar", "joints.main", "joints.main.moment")
    assert "the whole run, t = 0 to 3 s" in words


def test_rounding_is_a_point(heun: Heun) -> None:
    """Of what is less than its error the axes reach as far as that."""
    panel, words = drawn(heun, str(ROOT / "specs" / "cardan.yaml"), "polar", "foundation", "--view", "x")
    (curve,) = panel.lines("foundation.force")
    assert "Foundation, force: ? N at all times" in words
    assert np.hypot(*curve.T).max() < 0.5 * panel.pixel * (panel.right - panel.left)
    assert panel.x.values(np.array([panel.left]))[0] < 0.0 < panel.x.values(np.array([panel.right]))[0]


def test_across_a_slanted_axis(heun: Heun, folder: Path) -> None:
    text = CRANK.replace("axis: [0, 0, 1]", "axis: [0, 1, 2]").replace("LAW", '"10*t"')
    (folder / "slanted.yaml").write_text(text)
    panel, words = drawn(heun, "slanted.yaml", "polar", "foundation")
    (curve,) = panel.lines("foundation.force")
    assert np.abs(np.hypot(*curve.T) - 2 * 0.1 * 10**2).max() < panel.pixel
    assert "directions 1 and 2 are (1, 0, 0) and (0, 0.8944, -0.4472)" in words and "normal to the plane" not in words


def test_where_little_turns_instants_are_marked(heun: Heun, folder: Path) -> None:
    (folder / "little.yaml").write_text(CRANK.replace("LAW", '"0.1*t**2 + 0.2"'))
    panel, words = drawn(heun, "little.yaml", "polar", "foundation")
    assert {"2.0 s", "2.5 s"} <= set(words.split("\n"))
    assert not any("°" in (e.text or "") for e in panel.root.iter(f"{SVG}text") if e.get("fill") == find_pen(0).colour)
    assert len(panel.spots(filled=False)) >= 5


def test_of_one_that_does_not_the_whole_run(heun: Heun, folder: Path) -> None:
    (folder / "faster.yaml").write_text(CRANK.replace("LAW", '"2*pi*t**2/3"'))
    panel, words = drawn(heun, "faster.yaml", "polar", "foundation")
    assert "the whole run, t = 0 to 3 s" in words
    (curve,) = panel.lines("foundation.force")
    rate, gain = 4 * np.pi, 4 * np.pi / 3
    assert np.hypot(*curve.T).max() == pytest.approx(2 * 0.1 * np.hypot(rate**2, gain), abs=panel.pixel)


def test_a_curve_is_broken_where_a_blow_strikes(heun: Heun) -> None:
    panel, _ = drawn(heun, str(SPECS / "hammered_four_bar.yaml"), "polar", "foundation")
    before, after = panel.lines("foundation.force")
    assert np.hypot(*(after[0] - before[-1])) > 20.0


REFUSED = [
    ((ROTOR, "polar", "joints.left.drive"), "not a vector over time"),
    ((ROTOR, "polar", "coordinates.left.angle"), "not a vector over time"),
    ((ROTOR, "polar", "joints.left.force.y"), "not a vector over time"),
    ((ROTOR, "polar"), "no vector is given"),
    ((ROTOR, "polar", "joints.wrong"), "is not a result"),
    ((ROTOR, "polar", "joints.left", "--view", "20,30"), "--view 20,30"),
    ((ROTOR, "polar", "joints.left", "--axes", "body"), "--axes body"),
    ((str(SPECS / "door.yaml"), "polar", "foundation"), "there is only one instant"),
    ((str(SPECS / "double.yaml"), "polar", "joints.elbow"), "it does not stay in a plane"),
]


@pytest.mark.parametrize(("words", "why"), REFUSED)
def test_what_has_no_polar_diagram_is_told(heun: Heun, folder: Path, words: tuple[str, ...], why: str) -> None:
    done = heun("plot", *words, "-o", "drawn.svg")
    assert done.returncode in (2, 3) and why in done.stderr and "hint: " in done.stderr
    assert done.stdout == "" and not (folder / "drawn.svg").exists()


def test_what_stands_across_the_plane_is_said(heun: Heun) -> None:
    double = str(SPECS / "double.yaml")
    panel, words = drawn(heun, double, "polar", "joints.elbow", "--view", "x")
    force = np.array(json.loads(heun("run", double, "--format", "json").stdout)["joints"]["elbow"]["force"])
    assert far_from(force[:, 1:], panel.lines("joints.elbow.force")[0]) < panel.pixel
    across = re.search(r"normal to the plane up to ([\d.]+) N", words)
    assert across is not None and float(across[1]) == pytest.approx(np.abs(force[:, 0]).max(), rel=0.02)


def test_it_is_the_same_every_time_and_in_letters(heun: Heun) -> None:
    for name in ("one.svg", "two.svg"):
        assert heun("plot", ROTOR, "polar", "joints.right", "-o", name).returncode == 0
    assert Path("one.svg").read_bytes() == Path("two.svg").read_bytes()
    lines = heun("plot", ROTOR, "polar", "joints.right", "--width", "60").stdout.splitlines()
    assert max(map(len, lines)) <= 60 and any("128.0 N" in line for line in lines)
    assert any("90°" in line for line in lines)


def test_hostile_words_are_shown_and_do_nothing(heun: Heun, folder: Path) -> None:
    title = '</text><script>alert(1)</script> & "it" \'\u202egnp.exe'
    text = CRANK.replace("A crank that is turned", json.dumps(title)).replace("LAW", '"2*pi*t"')
    (folder / "a<b>&.yaml").write_text(text)
    done = heun("plot", "a<b>&.yaml", "polar", "joints.main", "-o", "drawn.svg")
    assert done.returncode == 0
    text = (folder / "drawn.svg").read_text()
    assert "<script" not in text and "\u202e" not in text
    assert any("<script>alert(1)</script>" in each for each in texts_of(text))


def test_what_is_open_across_the_plane_hides_nothing_in_it(heun: Heun, folder: Path) -> None:
    """Pins of a flat linkage in space: along their axes forces are open, across these they are certain."""
    done = heun("plot", str(SPECS / "flat_four_bar.yaml"), "polar", "joints.A", "-o", "drawn.svg")
    assert done.returncode == 0
    words = " ".join(texts_of(Path("drawn.svg").read_text()))
    assert "A, force: largest" in words
    assert "normal component open or unknown, not drawn" in " ".join(words.split())


def test_panels_over_one_angle_share_their_grid(heun: Heun, folder: Path) -> None:
    words = ("joints.crank.force", "coordinates.crank.rate", "--x", "coordinates.crank.angle", "--units", "deg")
    assert heun("plot", str(SPECS / "four_bar.yaml"), *words, "-o", "x.svg").returncode == 0
    grid_line = r'points="([0-9.]+),([0-9.]+) \1,([0-9.]+)"[^>]*stroke="' + FAINT + '"'
    upright = re.findall(grid_line, Path("x.svg").read_text())
    grids: dict[str, list[str]] = {}
    for x, top, _ in upright:
        grids.setdefault(top, []).append(x)
    assert len(grids) == 2
    assert len({tuple(grid) for grid in grids.values()}) == 1


def test_marks_that_would_cover_each_other_are_thinned() -> None:
    """Of a cluster the labelled ones stay; one place has one label; what fires stays with its name."""
    marks = [
        Spot(0.0, 0.0, "0°"),
        Spot(0.0, 0.0, "720°"),
        Spot(0.1, 0.0),
        Spot(0.5, 0.0, "90°"),
        Spot(3.0, 0.0, "180°"),
    ]
    firing = Spot(0.05, 0.0, "gas fires, 5°", 1, "diamond", is_filled=True)
    shown = {(spot.x, spot.text) for spot in thin_marks([*marks, firing], mark_space=0.04, label_space=1.0)}
    assert shown == {(0.0, "0°, 720°"), (0.1, ""), (0.5, ""), (3.0, "180°"), (0.05, "gas fires, 5°")}


def test_bodies_are_named_as_a_reader_names_them(heun: Heun, folder: Path) -> None:
    turned = CRANK.replace("crank", "upper_arm").replace("LAW", "6.283185307179586*t")
    (folder / "arm.yaml").write_text(turned)
    assert "reaction of ground on upper arm" in drawn(heun, "arm.yaml", "polar", "joints.main")[1]
