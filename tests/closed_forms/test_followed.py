"""Motions that their drives determine: nothing is integrated, and every instant is on the branch that leads to it."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

from heuncli.base.errors import SolveError
from heuncli.motion.integration.methods.explicit import DOP853
from heuncli.motion.integration.methods.method import DRIVE_DETERMINED
from heuncli.results.results import Array, Results
from tests.shared.gear_trains import pair
from tests.shared.scenes import solved

CRANK = """\
heun: 1
gravity: [0, -9.81, 0]
parameters: {{r: 1, l: {l}}}
ground: {{points: {{O: [0, 0, 0]}}}}
bodies:
  crank: {{mass: 1, center: [r/2, 0, 0], inertia: [0.1, 0.1, 0.1], points: {{main: [0, 0, 0], pin: [r, 0, 0]}}}}
  rod: {{mass: 1, center: [l/2, 0, 0], inertia: [0.1, 0.1, 0.1], points: {{big: [0, 0, 0], small: [l, 0, 0]}}}}
  slider: {{mass: 1, center: [0, 0, 0], inertia: [0.1, 0.1, 0.1], points: {{pin: [0, 0, 0]}}}}
joints:
  main: {{type: pin, from: ground.O, to: crank.main, axis: [0, 0, 1]}}
  big: {{type: line, from: crank.pin, to: rod.big, axis: [0, 0, 1]}}
  small: {{type: pin, from: rod.small, to: slider.pin, axis: [0, 0, 1]}}
  guide: {{type: slide, from: ground.O, to: slider.pin, axis: [1, 0, 0]}}
drives: {{motor: {drive}}}
analysis: {{{analysis}}}
"""
AS_DRAWN = "  crank: {mass: 1,"
RAISED = "  crank: {near: {orientation: {axis: [0, 0, 1], angle: 50 deg}}, mass: 1,"
FOUR_BAR = """\
heun: 1
ground: {{points: {{O: [0, 0, 0], C: [{g}, 0, 0]}}}}
bodies:
  crank:
    {{mass: 1, center: [0, 0, 0], inertia: [1, 1, 1], points: {{O: [0, 0, 0], A: [{a}, 0, 0]}},
     orientation: {{axis: [0, 0, 1], angle: {start}}}}}
  coupler:
    {{mass: 1, center: [0, 0, 0], inertia: [1, 1, 1], points: {{A: [0, 0, 0], B: [{b}, 0, 0]}}, near: {{{near}}}}}
  rocker: {{mass: 1, center: [0, 0, 0], inertia: [1, 1, 1], points: {{C: [0, 0, 0], B: [{c}, 0, 0]}}, near: {{{over}}}}}
joints:
  O: {{type: pin, from: ground.O, to: crank.O, axis: [0, 0, 1]}}
  A: {{type: pin, from: crank.A, to: coupler.A, axis: [0, 0, 1]}}
  B: {{type: line, from: coupler.B, to: rocker.B, axis: [0, 0, 1]}}
  C: {{type: pin, from: ground.C, to: rocker.C, axis: [0, 0, 1]}}
drives: {{motor: {{joint: O, angle: "{drive}"}}}}
analysis: {{{analysis}}}
"""


def crank(l: float, drive: str, analysis: str) -> str:
    return CRANK.format(l=l, drive=drive, analysis=analysis)


def slider_at(angle: Array, l: float) -> Array:
    return np.asarray(np.cos(angle) + np.sqrt(l * l - np.sin(angle) ** 2))


@pytest.mark.parametrize("times", [np.linspace(0.0, 40.0, 81), np.arange(40.0), np.array([0.0, 39.37])])
def test_a_slider_crank_over_many_turns(times: Array) -> None:
    """A turn a second; samples within turns, a whole turn apart, and far apart: each on its branch, to rounding."""
    text = crank(3.0, '{joint: main, angle: "2*pi*t + 0.3"}', f"times: {times.tolist()}")
    found = solved(text)
    angle = 2.0 * np.pi * times + 0.3
    assert found.model["method"] == DRIVE_DETERMINED.name
    assert np.abs(found.coordinates["guide"]["travel"] - slider_at(angle, 3.0)).max() < 2e-14
    rod = -np.arcsin(np.sin(angle) / 3.0)
    assert np.abs(np.sin(found.coordinates["small"]["angle"]) - np.sin(-rod)).max() < 2e-14
    assert found.accuracy["estimate"]["motion"] < 1e-12
    assert found.accuracy["energy_drift"] < 1e-12


@pytest.mark.parametrize("l", [1.1, 1.001, 1.00001])
def test_a_rod_hardly_longer_than_the_crank(l: float) -> None:
    """The slider comes back just beside the shaft, where another branch lies as near: it is not taken."""
    times = np.linspace(0.0, 3.0, 7)
    found = solved(crank(l, '{joint: main, angle: "2*pi*t"}', f"times: {times.tolist()}"))
    assert found.model["method"] == DRIVE_DETERMINED.name
    near = np.sqrt(2.0 * (l - 1.0))  # of the quarter turns: how near, and rounding over it
    assert np.abs(found.coordinates["guide"]["travel"] - slider_at(2.0 * np.pi * times, l)).max() < 1e-14 / near


def four_bar(start: str, drive: str, analysis: str, up: bool, lengths: tuple[float, ...] = (1.0, 4.0, 3.0, 3.5)) -> str:
    a, b, c, g = lengths
    side = 1 if up else -1
    return FOUR_BAR.format(
        a=a, b=b, c=c, g=g, start=start, drive=drive, analysis=analysis,
        near=f"orientation: {{axis: [0, 0, 1], angle: {side * 45} deg}}",
        over=f"orientation: {{axis: [0, 0, 1], angle: {side * 90} deg}}",
    )  # fmt: skip


def side_of(found: Results) -> Array:
    """On which side of the coupler the rocker's pin lies, seen from the crank's: the branch's sign."""
    A, B, C = (found.points[name]["position"] for name in ("crank.A", "coupler.B", "rocker.C"))
    return np.sign(np.cross(B - A, C - A)[:, 2])


@pytest.mark.parametrize("up", [True, False])
def test_a_four_bar_stays_on_its_branch(up: bool) -> None:
    """Both ways to close it, over turns with samples a turn and a bit apart."""
    text = four_bar("0 deg", "2*pi*t", "duration: 22, samples: 21", up).replace(
        "analysis:", "report: [points, motion, joints]\nanalysis:"
    )
    found = solved(text)
    assert found.model["method"] == DRIVE_DETERMINED.name
    assert len(set(side_of(found).tolist())) == 1
    B, C = found.points["coupler.B"]["position"], found.points["rocker.C"]["position"]
    assert np.abs(np.linalg.norm(B - C, axis=1) - 3.0).max() < 1e-14 * 7.0  # gaps are closed so far, of the size


def test_a_turn_between_two_samples_is_counted() -> None:
    """A drag link whose crank makes a turn within a thousandth of the run: what it drives turns as far."""
    lengths = (3.0, 2.5, 2.5, 1.0)
    turn = "2*pi*t + pi*(1 + tanh((t - 0.5)/1e-3))"
    text = four_bar("0 deg", turn, "times: [0, 0.4, 0.6, 1]", True, lengths)
    found = solved(text)
    assert found.model["method"] == DRIVE_DETERMINED.name
    plain = solved(four_bar("0 deg", "2*pi*t", "times: [0, 0.4, 0.6, 1]", True, lengths))
    more = found.coordinates["C"]["angle"] - plain.coordinates["C"]["angle"]
    assert np.abs(more - [0.0, 0.0, 2.0 * np.pi, 2.0 * np.pi]).max() < 1e-12


@pytest.mark.parametrize("drive", [
    '{joint: main, angle: "0.5 + 3*t + sin(5*t)"}', '{joint: guide, travel: "3.4 + 0.5*sin(2*t)"}',
])  # fmt: skip
def test_the_same_as_integrated(drive: str) -> None:
    """Positions, reactions, drive, energy and work, to the digits of the integrated run."""
    text = crank(3.0, drive, "duration: 2, samples: 41")
    if "guide" in drive:
        text = text.replace(AS_DRAWN, RAISED)
    one, other = solved(text), solved(text, reduce=False)
    assert one.model["method"] == DRIVE_DETERMINED.name and other.model["method"] == DOP853.name
    for name, block in other.joints.items():
        for quantity in ("force", "moment"):
            size = max(np.abs(x["force"]).max() for x in other.joints.values())
            assert np.abs(one.joints[name][quantity] - block[quantity]).max() < 1e-8 * size
    for name, values in other.energy.items():
        assert np.abs(one.energy[name] - values).max() < 1e-8 * other.energy["kinetic"].max(), name
    assert one.work["evaluations"] < other.work["evaluations"]


def test_a_truss_under_a_load_in_time() -> None:
    """Nothing can move: at each instant the load of that instant, and no steps to get there."""
    text = """\
heun: 1
ground: {points: {A: [0, 0, 0], B: [2, 0, 0]}}
bodies:
  left: {mass: 1, center: [0.5, 0.5, 0], inertia: [1, 1, 1], points: {A: [0, 0, 0], top: [1, 1, 0]}}
  right:
    {mass: 1, center: [-0.5, 0.5, 0], inertia: [1, 1, 1], points: {B: [0, 0, 0], top: [-1, 1, 0]}, position: [2, 0, 0]}
joints:
  A: {type: pin, from: ground.A, to: left.A, axis: [0, 0, 1]}
  top: {type: line, from: left.top, to: right.top, axis: [0, 0, 1]}
  B: {type: pin, from: ground.B, to: right.B, axis: [0, 0, 1]}
forces: {load: {type: force, on: left.top, vector: [0, "-10*sin(3*t)", 0]}}
analysis: {duration: 2, samples: 9}
"""
    found = solved(text)
    assert found.model["method"] == DRIVE_DETERMINED.name
    load = 10.0 * np.sin(3.0 * found.time)
    assert np.abs(found.joints["A"]["force"] - np.outer(load, [0.5, 0.5, 0.0])).max() < 1e-13
    assert found.accuracy["energy_drift"] == 0.0


def test_a_dwell_takes_no_steps() -> None:
    """Half a turn, a rest of ninety-eight seconds, half a turn."""
    angle = "pi*min(t, 1) + pi*max(t - 99, 0)"
    rest = solved(crank(3.0, f'{{joint: main, angle: "{angle}"}}', "duration: 100, samples: 5"))
    turn = solved(crank(3.0, '{joint: main, angle: "pi*t"}', "duration: 2, samples: 5"))
    assert rest.model["method"] == DRIVE_DETERMINED.name
    assert rest.work["steps"] <= turn.work["steps"] + 4


@pytest.mark.parametrize(("b", "method"), [(3.0, DOP853), (3.001, DRIVE_DETERMINED)])
def test_a_singular_pose_is_not_followed_through(b: float, method: object) -> None:
    """A parallelogram folds flat twice a turn, where its branches meet: what moves decides there, and it is told."""
    text = four_bar("60 deg", "pi/3 + 2*pi*t", "duration: 1, samples: 5", True, (1.0, b, 1.0, 3.0))
    text = text.replace("angle: 45 deg", "angle: 0 deg").replace("angle: 90 deg", "angle: 60 deg")
    if b != 3.0:  # a kite's coupler is too long to lie flat: the crank only rocks
        text = text.replace("2*pi*t", "sin(t)")
    found = solved(text)
    assert found.model["method"] == method.name  # type: ignore[attr-defined]
    told = " ".join(found.model.get("not_reduced", ()))
    assert ("singular position" in told) == (method is DOP853)


def test_beyond_the_reach_is_an_error_as_before() -> None:
    """The slider is driven farther than crank and rod are long."""
    text = crank(3.0, '{joint: guide, travel: "3.5 + t"}', "duration: 1, samples: 5")
    text = text.replace(AS_DRAWN, RAISED)
    with pytest.raises(SolveError) as raised:
        solved(text)
    (problem,) = raised.value.problems
    assert problem.code == "closure-lost" and "0.5" in problem.message


def driven_pair(drive: str, **analysis: Any) -> dict[str, Any]:
    """A pinion, turned as told, and a wheel that it turns back, a third as far."""
    scene = pair(teeth=[20, 60])
    scene["joints"]["p"].pop("initial")
    del scene["forces"]
    return scene | {"drives": {"motor": {"joint": "p", "angle": drive}}, "analysis": analysis}


def test_gears_at_a_constant_rate_take_one_step() -> None:
    """What they hold is the same in every pose: no turn of theirs needs a step."""
    found = solved(driven_pair("200*pi*t", duration=1, samples=7))
    assert found.model["method"] == DRIVE_DETERMINED.name and found.work["steps"] == 1
    assert np.abs(found.coordinates["w"]["angle"] + 200.0 * np.pi * found.time / 3.0).max() < 1e-12


@pytest.mark.parametrize("rate", [2.0, 60.0])
def test_a_gear_that_swings_passes_angles_when_it_should(rate: float) -> None:
    """The drive's law alone keeps steps short: where the wheel passes, its closure tells."""
    at = np.pi + np.arcsin(0.3)
    ends = solved(driven_pair(f"sin({rate}*t)", duration=5, until="w.angle > 0.1"))
    assert ends.model["method"] == DRIVE_DETERMINED.name
    assert abs(ends.events["until"]["time"][0] * rate - at) < 1e-10
    assert ends.work["steps"] < 30
    found = solved(driven_pair(f"sin({rate}*t)", duration=5, samples=41))
    assert np.abs(found.coordinates["w"]["angle"] + np.sin(rate * found.time) / 3.0).max() < 1e-14
    assert np.abs(found.coordinates["w"]["rate"] + rate * np.cos(rate * found.time) / 3.0).max() < 1e-13 * rate


@pytest.mark.parametrize("up", [True, False])
def test_a_four_bar_behind_a_gear_stays_on_its_branch(up: bool) -> None:
    """Its crank turns by a pair of gears, ten turns of the motor for each of its own: as where it is driven itself."""
    text = four_bar("0 deg", "2*pi*t", "duration: 3, samples: 4", up)
    motor = "  motor: {mass: 1, center: [0, 0, 0], inertia: [1, 1, 1], points: {M: [0, 0, 0]}}\n"
    geared = text.replace("bodies:\n", f"bodies:\n{motor}").replace("points: {O:", "points: {M: [0, -2, 0], O:", 1)
    geared = geared.replace(
        "  O: {type: pin", "  M: {type: pin, from: ground.M, to: motor.M, axis: [0, 0, 1]}\n  O: {type: pin"
    )
    geared = geared.replace('{joint: O, angle: "2*pi*t"}', '{joint: M, angle: "-20*pi*t"}')
    geared += "couplings: {gears: {type: gear, of: [M, O], ratio: -10}}\n"
    one, other = solved(text), solved(geared)
    assert other.model["method"] == DRIVE_DETERMINED.name
    for name in ("A", "B", "C"):
        for quantity, values in one.coordinates.get(name, {}).items():
            size = max(1.0, float(np.abs(values).max()))
            assert np.abs(other.coordinates[name][quantity] - values).max() < 1e-11 * size
    assert other.work["steps"] < 2 * one.work["steps"]  # all rows together keep less of the least one
