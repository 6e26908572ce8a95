"""Frictions of one freedom stick as one: linkages by their own kinematics, and by an own time stepper."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
import pytest

import heuncli
from heuncli.base.errors import SolveError
from heuncli.motion.integration.contacts.friction_groups import displace_freedoms
from heuncli.results.results import Array
from heuncli.scene.file_format.load import load
from heuncli.study.model.setup import set_up
from tests.oracle.values import to_yaml
from tests.shared.scenes import solved

G = 9.81
CRANK, ROD, ROCKER, BASE = 0.1, 0.4, 0.3, 0.5
LIMITS = {"A": 1.0, "B": 0.5, "C": 0.4, "D": 0.6}  # N m, static


def four_bar_angles(crank: float) -> tuple[float, float]:
    """Angles of rod and rocker, open branch."""
    x, y = BASE - CRANK * np.cos(crank), -CRANK * np.sin(crank)
    d = np.hypot(x, y)
    rod = np.arctan2(y, x) + np.arccos((ROD**2 + d**2 - ROCKER**2) / (2 * ROD * d))
    tip = np.array([CRANK * np.cos(crank) + ROD * np.cos(rod), CRANK * np.sin(crank) + ROD * np.sin(rod)])
    return float(rod), float(np.arctan2(tip[1], tip[0] - BASE))


def four_bar_rates(crank: float) -> dict[str, float]:
    """Rates of the four pins per unit rate of the crank, by differences of the angles."""
    h = 1e-5
    rod, rocker = ((four_bar_angles(crank + h)[i] - four_bar_angles(crank - h)[i]) / (2 * h) for i in (0, 1))
    return {"A": 1.0, "B": rod - 1.0, "C": rocker - rod, "D": rocker}


def four_bar(crank: float, torque: str, axes: dict[str, float], turn: float, **extra: Any) -> dict[str, Any]:
    """A four-bar without weight, friction in all pins; axes: sense of each pin's axis; turn: of the whole about z."""
    rod, rocker = four_bar_angles(crank)
    R = np.array([[np.cos(turn), -np.sin(turn), 0], [np.sin(turn), np.cos(turn), 0], [0, 0, 1]])

    def bar(length: float, point: Array, angle: float, mass: float) -> dict[str, Any]:
        return {
            "mass": mass, "center": [length / 2, 0, 0], "inertia": [1, 1, mass * length**2 / 12],
            "points": {"s": [0, 0, 0], "e": [length, 0, 0]}, "position": (R @ point).tolist(),
            "orientation": {"axis": [0, 0, 1], "angle": angle + turn},
        }  # fmt: skip

    tip = np.array([CRANK * np.cos(crank), CRANK * np.sin(crank), 0])
    ends = {
        "A": ("ground.O", "crank.s"),
        "B": ("crank.e", "rod.s"),
        "C": ("rod.e", "rocker.e"),
        "D": ("ground.G", "rocker.s"),
    }
    kinetic = {"A": 1.0, "B": 0.5, "C": 0.2, "D": 0.3}
    forces: dict[str, Any] = {"m": {"type": "torque", "joint": "A", "value": torque}}
    for name in ends:
        forces[f"f{name}"] = {"type": "friction", "joint": name, "torque": kinetic[name], "static": LIMITS[name]}
    return {
        "ground": {"points": {"O": [0, 0, 0], "G": (R @ [BASE, 0, 0]).tolist()}},
        "bodies": {
            "crank": bar(CRANK, np.zeros(3), crank, 1.0), "rod": bar(ROD, tip, rod, 2.0),
            "rocker": bar(ROCKER, np.array([BASE, 0, 0]), rocker, 1.5),
        },
        "joints": {
            n: {"type": "pin", "from": a, "to": b, "axis": [0, 0, axes.get(n, 1)]} for n, (a, b) in ends.items()
        },
        "forces": forces, "analysis": {"duration": 2, "samples": 201}, **extra,
    }  # fmt: skip


@pytest.mark.parametrize("crank", [0.4, 1.2, 2.9])
@pytest.mark.parametrize(
    ("sign", "axes", "turn", "space"),
    [
        (1, {}, 0.0, "planar"),
        (-1, {}, 0.7, "planar"),
        (1, {"B": -1, "D": -1}, 0.0, "planar"),
        (1, {"C": -1}, 2.0, "auto"),
    ],
)
@pytest.mark.third
def test_a_four_bar_starts_where_the_torque_is_the_sum_of_its_limits(
    crank: float, sign: int, axes: dict[str, float], turn: float, space: str
) -> None:
    """It starts at M = sum |rate_i| limit_i; until then each friction is open, and the sum and its reserve are not."""
    rates = four_bar_rates(crank)
    limit = sum(abs(rates[name]) * LIMITS[name] for name in rates)
    r = solved(to_yaml(four_bar(crank, f"{sign * limit}*t", axes, turn, space=space)))
    sticks = r.time < 0.999
    for name, rate in rates.items():
        assert np.isnan(r.forces[f"f{name}"]["value"][sticks]).all()
        assert r.forces[f"f{name}"]["open"] == ["value"]
        left = limit * (1 - r.time[sticks]) / abs(rate)
        assert r.forces[f"f{name}"]["reserve"][sticks] == pytest.approx(left, rel=1e-7, abs=1e-7)
        assert r.coordinates[name]["rate"][sticks] == pytest.approx(np.zeros(sticks.sum()), abs=1e-20)
        signed = sign * axes.get(name, 1) * np.sign(rate)
        moving = r.coordinates[name]["rate"][(r.time > 1.01) & (r.time < 1.1)]
        assert (signed * moving > 0.0).all()
    own = next(s for s in r.certain_sums if "forces.fA.value" in s["terms"])
    assert own["value"][sticks] == pytest.approx(-sign * limit * r.time[sticks], abs=1e-9)
    for name, rate in rates.items():
        factors = np.asarray(own["terms"][f"forces.f{name}.value"])[sticks]
        assert factors == pytest.approx(np.full(sticks.sum(), rate * axes.get(name, 1)), rel=1e-8)
    assert "force.x" in r.joints["B"]["open"]
    assert np.isnan(r.foundation["elements"]["fA"]["moment"][sticks, 2]).all()
    assert np.isfinite(r.foundation["moment"]).all()
    friction = sum(r.forces[f"f{name}"]["power"] for name in rates)
    assert (friction <= 0.0).all()


SLIDER_CRANK = """
heun: 1
space: planar
gravity: [0, -9.81, 0]
parameters: {{r: 0.1, l: 0.3, th: {start}}}
ground: {{points: {{O: [0, 0, 0]}}}}
bodies:
  crank: {{mass: 1, center: [0, 0, 0], inertia: [1, 1, 0.05], points: {{o: [0, 0, 0], p: [r, 0, 0]}}}}
  rod: {{mass: 1, center: ["l/2", 0, 0], inertia: [1, 1, 0.01], points: {{p: [0, 0, 0], q: [l, 0, 0]}},
        near: {{position: ["r*cos(th)", "r*sin(th)", 0]}}}}
  slider: {{mass: 1, center: [0, 0, 0], inertia: [1, 1, 1], points: {{q: [0, 0, 0]}}, near: {{position: [0.35, 0, 0]}}}}
joints:
  A: {{type: pin, from: ground.O, to: crank.o, axis: [0, 0, 1], initial: {{angle: th, rate: {rate}}}}}
  B: {{type: pin, from: crank.p, to: rod.p, axis: [0, 0, 1]}}
  C: {{type: pin, from: rod.q, to: slider.q, axis: [0, 0, 1]}}
  S: {{type: slide, from: ground.O, to: slider.q, axis: [1, 0, 0]}}
forces:
  fA: {{type: friction, joint: A, torque: {A}}}
  fB: {{type: friction, joint: B, torque: {B}}}
  fC: {{type: friction, joint: C, torque: {C}}}
  fS: {{type: friction, joint: S, force: {S}}}
analysis: {{duration: 3, samples: 31}}
"""


class CrankStepper:
    """An own time stepper of the slider-crank in its crank angle, by Moreau's midpoint rule with all frictions."""

    def __init__(self, limits: dict[str, float]) -> None:
        self.limits = limits

    def rates(self, p: float) -> tuple[float, float, float]:
        """The rod's angle, and the rates of rod and slider per rate of the crank."""
        rod = -math.asin(math.sin(p) / 3)
        turn = -math.cos(p) / (3 * math.cos(rod))
        return rod, turn, -0.1 * math.sin(p) - 0.3 * math.sin(rod) * turn

    def inertia(self, p: float) -> float:
        rod, turn, slide = self.rates(p)
        x = -0.1 * math.sin(p) - 0.15 * math.sin(rod) * turn
        y = 0.1 * math.cos(p) + 0.15 * math.cos(rod) * turn
        return 0.05 + 0.01 * turn**2 + x**2 + y**2 + slide**2

    def height(self, p: float) -> float:
        return 0.1 * math.sin(p) + 0.15 * math.sin(self.rates(p)[0])

    def limit(self, p: float) -> float:
        _, turn, slide = self.rates(p)
        c = self.limits
        return c["A"] + c["B"] * abs(turn - 1) + c["C"] * abs(turn) + c["S"] * abs(slide)

    def run(self, p: float, v: float, steps: int) -> Array:
        h, found, d = 3.0 / steps, [p], 1e-5
        for _ in range(steps):
            m = p + 0.5 * h * v
            slope = (self.inertia(m + d) - self.inertia(m - d)) / (2 * d)
            weight = G * (self.height(m + d) - self.height(m - d)) / (2 * d)
            w = v - h * (0.5 * slope * v * v + weight) / self.inertia(m)
            most = h * self.limit(m) / self.inertia(m)
            v = 0.0 if abs(w) <= most else w - math.copysign(most, w)
            p = m + 0.5 * h * v
            found.append(p)
        return np.array(found)[:: steps // 30]


@pytest.mark.parametrize("seed", range(6))
@pytest.mark.third
def test_slider_cranks_with_friction_everywhere_swing_and_stop_as_by_time_stepping(seed: int) -> None:
    """Random limits and starts; some stop and stay, some turn back: the stepper errs by a part of its step."""
    rng = np.random.default_rng(seed)
    limits = {name: float(x) for name, x in zip("ABCS", rng.uniform(0.01, 0.12, 4) * [1, 1, 1, 5], strict=True)}
    start, rate = float(rng.uniform(-3, 3)), float(rng.uniform(-8, 8))
    r = solved(SLIDER_CRANK.format(start=start, rate=rate, **limits))
    stepper = CrankStepper(limits)
    coarse, fine = (stepper.run(start, rate, steps) for steps in (6000, 60000))
    error = np.abs(fine - coarse).max()  # ten times that of the fine one, and not smooth in the step
    assert error < 0.02
    assert r.coordinates["A"]["angle"] == pytest.approx(fine, abs=0.5 * error)
    energy = r.energy["kinetic"] + r.energy["potential"] - r.energy["work"]
    assert energy == pytest.approx(np.full(31, energy[0]), abs=1e-8)
    assert all((r.forces[name]["power"] <= 0.0).all() for name in ("fA", "fB", "fC", "fS"))


PENDULUM = """
heun: 1
gravity: [0, -9.81, 0]
ground: {points: {pivot: [0, 0, 0]}}
bodies: {bob: {mass: 2, center: [1, 0, 0], inertia: [0, 0, 0], points: {top: [0, 0, 0]}}}
joints: {pivot: {type: pin, from: ground.pivot, to: bob.top, axis: [0, 0, 1]}}
forces:
  brake: {type: friction, joint: pivot, torque: 20 - 10*t}
  seal: {type: friction, joint: pivot, torque: 5}
analysis: {duration: 1, samples: 101}
"""


def test_a_brake_that_is_eased_lets_go_where_it_and_the_seal_are_too_weak() -> None:
    """2 g = 20 - 10 t + 5."""
    r = solved(PENDULUM)
    start = (25 - 2 * G) / 10
    held = r.time < start
    assert not r.coordinates["pivot"]["rate"][held].any()
    left = 25 - 10 * r.time[held] - 2 * G
    assert r.forces["brake"]["reserve"][held] == pytest.approx(left, abs=1e-10)
    assert r.forces["seal"]["reserve"][held] == pytest.approx(left, abs=1e-10)
    t = r.time[~held & (r.time < start + 0.1)] - start
    # 2 phi'' = 2 g - 25 + 10 t, while cos phi is near 1
    assert -r.coordinates["pivot"]["angle"][~held][: len(t)] == pytest.approx(10 * t**3 / 12, rel=1e-4, abs=1e-12)


def test_a_rest_position_tells_how_far_the_frictions_of_a_joint_are_from_slipping() -> None:
    r = solved(PENDULUM.replace("20 - 10*t", "18").replace("duration: 1, samples: 101", "type: rest"))
    assert r.forces["brake"]["reserve"][0] == pytest.approx(23 - 2 * G, rel=1e-9)
    assert np.isnan(r.forces["seal"]["value"][0])
    assert r.joints["pivot"]["force"][0] == pytest.approx([0, 2 * G, 0], rel=1e-12)


def test_two_frictions_of_a_slide_tell_their_sum_in_newtons() -> None:
    """The block on the slope that both hold, m g sin th, and what is left of 4 + 9 N."""
    r = solved("""
heun: 1
gravity: [0, 0, -10]
ground: {points: {O: [0, 0, 0]}}
bodies: {block: {mass: 2, center: [0, 0, 0], inertia: [1, 1, 1], points: {c: [0, 0, 0]}}}
joints: {guide: {type: slide, from: ground.O, to: block.c, axis: [0.8, 0, -0.6]}}
forces: {gib: {type: friction, joint: guide, force: 4}, seal: {type: friction, joint: guide, force: 9}}
analysis: {duration: 1, samples: 3}
""")
    assert r.certain_sums[0]["unit"] == "N"
    assert r.certain_sums[0]["terms"] == {"forces.gib.value": 1.0, "forces.seal.value": pytest.approx(1.0)}
    assert r.certain_sums[0]["value"] == pytest.approx([-12.0] * 3)
    assert r.forces["seal"]["reserve"] == pytest.approx([1.0] * 3)


def refused(text: str, **options: Any) -> str:
    with pytest.raises(SolveError) as caught:
        solved(text, **options)
    return caught.value.problems[0].code


def test_what_depends_on_the_shares_is_refused() -> None:
    with pytest.raises(SolveError) as caught:
        heuncli.solve(text=PENDULUM, by_cause=True)
    assert caught.value.problems[0].code == "friction-indeterminate"
    assert refused(PENDULUM.replace("[0, 0, 1]}", "[0, 0, 1], stiffness: 1e6}")) == "friction-indeterminate"


def test_a_coefficient_beside_another_friction_of_the_freedom_is_refused() -> None:
    """What it can hold depends on how both share."""
    text = PENDULUM.replace("torque: 5", "coefficient: 0.5, radius: 0.1")
    assert refused(text) == "friction-indeterminate"


def test_frictions_that_a_drive_will_part_are_refused() -> None:
    """Crank and rocker stand still together until the rocker's bearing is moved: then they cannot both."""
    scene = four_bar(1.2, "0", {}, 0.0)
    scene["bodies"]["foot"] = {"mass": 1, "center": [0, 0, 0], "inertia": [1, 1, 1], "points": {"o": [0, 0, 0]}}
    scene["bodies"]["foot"]["position"] = [BASE, 0, 0]
    scene["joints"]["D"]["from"] = "foot.o"
    scene["joints"]["way"] = {"type": "slide", "from": "ground.G", "to": "foot.o", "axis": [1, 0, 0]}
    scene["drives"] = {"shift": {"joint": "way", "travel": "0.05*max(t - 1, 0)**2"}}
    assert refused(to_yaml(scene)) == "friction-indeterminate"


def test_two_freedoms_with_more_frictions_are_refused() -> None:
    """A five-bar at rest: its five frictions hold two freedoms."""
    text = """
heun: 1
space: planar
ground: {points: {O: [0, 0, 0], G: [1, 0, 0]}}
bodies:
  a: {mass: 1, center: [0.2, 0.2, 0], inertia: [1, 1, 1], points: {s: [0, 0, 0], e: [0.1, 0.5, 0]}}
  b: {mass: 1, center: [0.3, 0.7, 0], inertia: [1, 1, 1], points: {s: [0.1, 0.5, 0], e: [0.5, 0.9, 0]}}
  c: {mass: 1, center: [0.7, 0.7, 0], inertia: [1, 1, 1], points: {s: [0.5, 0.9, 0], e: [0.9, 0.5, 0]}}
  d: {mass: 1, center: [0.9, 0.2, 0], inertia: [1, 1, 1], points: {s: [0.9, 0.5, 0], e: [1, 0, 0]}}
joints:
  A: {type: pin, from: ground.O, to: a.s, axis: [0, 0, 1]}
  B: {type: pin, from: a.e, to: b.s, axis: [0, 0, 1]}
  C: {type: pin, from: b.e, to: c.s, axis: [0, 0, 1]}
  D: {type: pin, from: c.e, to: d.s, axis: [0, 0, 1]}
  E: {type: pin, from: d.e, to: ground.G, axis: [0, 0, 1]}
forces:
  push: {type: torque, joint: A, value: 0.1}
  A: {type: friction, joint: A, torque: 1}
  B: {type: friction, joint: B, torque: 1}
  C: {type: friction, joint: C, torque: 1}
  D: {type: friction, joint: D, torque: 1}
  E: {type: friction, joint: E, torque: 1}
"""
    assert refused(text) == "friction-indeterminate"


def test_a_transmission_that_a_ball_changes_is_refused() -> None:
    """Two cranks joined by a rod; one rides on a plate on a ball, towards which the rod points just now.

    There the plate's turns change nothing, so that the frictions seem to stick as one; turned, the rod would turn it.
    """
    bar = {"mass": 1, "center": [0, 0.5, 0], "inertia": [1, 1, 1], "points": {"s": [0, 0, 0], "e": [0, 1, 0]}}
    points = {"o": [0, 0, 0], "c": [1, 0, 0]}
    scene = {
        "gravity": [0, 0, 0],
        "ground": {"points": {"O": [0, 0, 0], "A": [4, 2, 0]}},
        "bodies": {
            "plate": {"mass": 5, "center": [0, 0, 0], "inertia": [2, 2, 2], "points": points},
            "near": {**bar, "position": [1, 0, 0]},
            "far": {**bar, "points": {"s": [0, 0, 0], "e": [-1, 1, 0]}, "position": [4, 2, 0]},
        },
        "joints": {
            "ball": {"type": "ball", "from": "ground.O", "to": "plate.o"},
            "C": {"type": "pin", "from": "plate.c", "to": "near.s", "axis": [0, 0, 1]},
            "A": {"type": "pin", "from": "ground.A", "to": "far.s", "axis": [0, 0, 1]},
            "rod": {"type": "rod", "from": "far.e", "to": "near.e"},
        },
        "forces": {f"f{n}": {"type": "friction", "joint": n, "torque": 1.0, "static": 2.0} for n in ("A", "C")},
        "analysis": {"duration": 0.1, "samples": 3},
    }
    setup = set_up(load("scene.yaml", to_yaml({**scene, "forces": {}})))
    layout = setup.runner.layout
    place = int(layout.bodies["attitude_at"][layout.bodies["ball"] == 1][0])
    attitudes = displace_freedoms(layout, layout.y0)[:, place : place + 4]
    assert np.linalg.norm(attitudes, axis=1) == pytest.approx(1.0)
    assert (np.linalg.norm(attitudes - layout.y0[place : place + 4], axis=1) > 1e-5).all()
    with pytest.raises(SolveError, match="how they share what holds the machine is indeterminate"):
        solved(to_yaml(scene))
