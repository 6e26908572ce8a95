"""Ropes that stretch against formulas: two weights, a load that falls into its rope, a tackle, a winch, the limit."""

from __future__ import annotations

import numpy as np
import pytest

from heuncli.base.errors import SpecError
from heuncli.results.results import Results
from heuncli.scene.file_format.load import load
from tests.shared.scenes import solved

G = 9.81


def two_weights(rope: str, analysis: str, speed: float = 0.0) -> str:
    """3 kg and 2 kg on slides, over a sheave that turns free of the rope."""
    return f"""
heun: 1
space: planar
gravity: [0, -{G}, 0]
ground: {{points: {{O: [0, 5], A: [-0.3, 0], B: [0.3, 0]}}}}
bodies:
  a: {{mass: 3, center: [0, 0], inertia: 0.1, points: {{top: [0, 0]}}}}
  b: {{mass: 2, center: [0, 0], inertia: 0.1, points: {{top: [0, 0]}}}}
joints:
  ga: {{type: slide, from: ground.A, to: a.top, axis: [0, 1], initial: {{speed: {speed}}}}}
  gb: {{type: slide, from: ground.B, to: b.top, axis: [0, 1]}}
couplings:
  rope: {{type: rope, through: [a.top, {{sheave: ground.O, radius: 0.3}}, b.top], {rope}}}
analysis: {analysis}
"""


@pytest.mark.parametrize("damping", [0.0, 12.0])
def test_two_weights(damping: float) -> None:
    """x'' + mu (c x' + k x) = 2 g, mu = 1/m1 + 1/m2: the rope swings about the pull 2 g / mu of one that keeps.

    What damping takes is told as work; the foundation has the pull of both strands.
    """
    k, mu = 800.0, 1 / 3 + 1 / 2
    results = solved(two_weights(f"stiffness: {k}, damping: {damping}", "{duration: 1, samples: 41}"))
    s = np.roots([1.0, mu * damping, mu * k])
    C = np.linalg.solve([[1, 1], s], [-2 * G / (mu * k), 0.0])
    t = results.time
    x = 2 * G / (mu * k) + np.real(C[0] * np.exp(s[0] * t) + C[1] * np.exp(s[1] * t))
    v = np.real(C[0] * s[0] * np.exp(s[0] * t) + C[1] * s[1] * np.exp(s[1] * t))
    T = k * x + damping * v
    told = results.couplings["rope"]
    assert told["tension"] == pytest.approx(T, abs=1e-7 * T.max())
    assert told["on"]["ground"]["force"][:, 1] == pytest.approx(-2 * T, abs=1e-7 * T.max())
    assert results.foundation["elements"]["rope"]["force"][:, 1] == pytest.approx(-2 * T, abs=1e-7 * T.max())
    fallen = results.bodies["a"]["center"][:, 1]
    kept = 0.5 * k * x**2 + G * (3 * fallen + 2 * results.bodies["b"]["center"][:, 1])
    assert results.energy["potential"] == pytest.approx(kept, abs=1e-8 * np.abs(kept).max())
    total = results.energy["kinetic"] + results.energy["potential"] - results.energy["work"]
    assert total == pytest.approx(np.full(41, total[0]), abs=1e-9 * results.energy["kinetic"].max())
    assert (results.energy["work"][-1] < -0.1) == (damping > 0.0)


def test_falls_into_its_rope() -> None:
    """Slack by h: caught at t = sqrt(2 h/g) it pulls m g (1 + sqrt(1 + 2 k h/(m g))) at most, and is slack again."""
    k, m, h = 5e3, 2.0, 0.2
    text = f"""
heun: 1
space: planar
gravity: [0, -{G}]
ground: {{points: {{A: [0, 0], P: [0.1, 0.5]}}}}
bodies: {{b: {{mass: {m}, center: [0, 0], inertia: 1, position: [0.2, -1], points: {{top: [0, 0]}}}}}}
joints: {{guide: {{type: slide, from: ground.Q, to: b.top, axis: [0, 1]}}}}
couplings:
  rope:
    {{type: rope, through: [ground.A, {{sheave: ground.P, radius: 0.1, side: over}}, b.top], stiffness: {k},
     length: "0.5 + 0.1*pi + 1.5 + {h}", tension_only: true}}
analysis: {{duration: 0.6, samples: 241}}
""".replace("P: [0.1, 0.5]", "P: [0.1, 0.5], Q: [0.2, -1]")
    results = solved(text)
    t, w = results.time - np.sqrt(2 * h / G), np.sqrt(k / m)
    u, rest = np.sqrt(2 * G * h), m * G / k
    x = rest * (1 - np.cos(w * t)) + u / w * np.sin(w * t)
    held = 2 * (np.pi - np.arctan(u / (w * rest))) / w  # until x is 0 again
    T = np.where((t > 0.0) & (t < held), k * x, 0.0)
    assert results.couplings["rope"]["tension"] == pytest.approx(T, abs=1e-6 * T.max())
    assert results.couplings["rope"]["tension"].max() == pytest.approx(
        m * G * (1 + np.sqrt(1 + 2 * k * h / (m * G))), rel=1e-2
    )
    total = results.energy["kinetic"] + results.energy["potential"]
    assert total == pytest.approx(np.full(241, total[0]), abs=1e-8 * results.energy["kinetic"].max())


def test_damping_pulls_nothing_while_the_rope_is_slack() -> None:
    """Nor does it push where the ends come together faster than the rope does."""
    results = solved(
        two_weights("stiffness: 500, damping: 60, tension_only: true", "{duration: 0.5, samples: 201}", 4.0)
    )
    T = results.couplings["rope"]["tension"]
    y = results.bodies["a"]["center"][:, 1] + results.bodies["b"]["center"][:, 1]
    slack = y > 1e-9
    assert slack.any() and not T[slack].any()
    assert T.min() == 0.0 and T.max() > 0.0
    assert np.any(~slack & (T == 0.0))
    total = results.energy["kinetic"] + results.energy["potential"] - results.energy["work"]
    assert total == pytest.approx(np.full(201, total[0]), abs=1e-8 * results.energy["kinetic"].max())
    assert np.all(np.diff(results.energy["work"]) <= 1e-9)


def test_a_tackle_is_as_stiff_as_its_falls_squared() -> None:
    """Four falls and the hand's own: w^2 = k (4^2/M + 1/m)."""
    text = """
heun: 1
space: planar
gravity: [0, -9.81]
ground: {points: {A: [-0.15, 6], O1: [0.3, 6], O2: [0.9, 6], G: [0.3, 1], H: [1.05, 2]}}
bodies:
  block: {mass: 200, center: [0, 0], inertia: 20, points: {one: [-0.3, 0], two: [0.3, 0], mid: [0, 0]}}
  hand: {mass: 50, center: [0, 0], inertia: 1, points: {top: [0, 0]}}
joints:
  slide: {type: slide, from: ground.G, to: block.mid, axis: [0, 1]}
  guide: {type: slide, from: ground.H, to: hand.top, axis: [0, 1]}
couplings:
  tackle:
    type: rope
    stiffness: 2e5
    through:
      - ground.A
      - {sheave: block.one, radius: 0.15, side: under}
      - {sheave: ground.O1, radius: 0.15, side: over}
      - {sheave: block.two, radius: 0.15, side: under}
      - {sheave: ground.O2, radius: 0.15, side: over}
      - hand.top
analysis: {type: rest}
"""
    results = solved(text)
    assert results.couplings["tackle"]["tension"][0] == pytest.approx(50 * G, rel=1e-9)
    assert results.couplings["tackle"]["on"]["block"]["force"][0, 1] == pytest.approx(200 * G, rel=1e-9)


def winch(rope: str, analysis: str) -> str:
    """A load under a rope that is drawn in."""
    return f"""
heun: 1
space: planar
gravity: [0, -{G}]
ground: {{points: {{A: [0, 0], Q: [0, -10]}}}}
bodies: {{b: {{mass: 50, center: [0, 0], inertia: 1, points: {{top: [0, 0]}}}}}}
joints: {{guide: {{type: slide, from: ground.Q, to: b.top, axis: [0, 1], initial: {{travel: 0, speed: 0.5}}}}}}
couplings: {{rope: {{type: rope, through: [ground.A, b.top], {rope}}}}}
analysis: {analysis}
"""


def test_a_winch_keeps_what_a_length_of_rope_is_worth() -> None:
    """T = EA (S/l0 - 1) of a length l0(t), EA = k l0(0); the winch works, and the energy balances."""
    text = winch('stiffness: 2e4, length: "9.8 - 0.5*t"', "{duration: 10, samples: 101}")
    results = solved(text)
    S, l0 = -results.bodies["b"]["center"][:, 1], 9.8 - 0.5 * results.time
    T = 2e4 * 9.8 * (S / l0 - 1.0)
    assert results.couplings["rope"]["tension"] == pytest.approx(T, abs=1e-8 * T.max())
    energy = results.energy
    kept = 0.5 * 2e4 * 9.8 / l0 * (S - l0) ** 2 - 50 * G * S
    assert energy["potential"] == pytest.approx(kept, abs=1e-8 * np.abs(kept).max())
    total = energy["kinetic"] + energy["potential"] - energy["work"]
    assert total == pytest.approx(np.full(101, total[0]), abs=1e-9 * np.abs(energy["work"]).max())
    assert energy["work"][-1] > 50 * G * 4.5


@pytest.mark.parametrize("one_sided", ["", ", tension_only: true"])
def test_damping_in_a_rope_that_is_drawn_in(one_sided: str) -> None:
    """T = EA e + c l0(0) e', e = S/l0 - 1, also past the instant at which the winch is stopped."""
    law = "9.8 - 0.5*min(t, 2)"
    rope = f'stiffness: 2e4, damping: 400, length: "{law}"{one_sided}'
    results = solved(winch(rope, "{duration: 3, samples: 61}"))
    t = results.time
    S, v = -results.bodies["b"]["center"][:, 1], -results.bodies["b"]["center_velocity"][:, 1]
    l0, drawn = 9.8 - 0.5 * np.minimum(t, 2.0), np.where(t < 2.0, -0.5, 0.0)
    T = 2e4 * 9.8 * (S / l0 - 1.0) + 400 * 9.8 * (v - S * drawn / l0) / l0
    T = np.where(S > l0, np.maximum(T, 0.0), 0.0) if one_sided else T
    assert results.couplings["rope"]["tension"] == pytest.approx(T, abs=1e-8 * T.max())
    assert T[-1] == pytest.approx(50 * G, rel=0.05)
    total = results.energy["kinetic"] + results.energy["potential"] - results.energy["work"]
    assert total == pytest.approx(np.full(61, total[0]), abs=1e-8 * np.abs(results.energy["work"]).max())


def test_stiffer_and_stiffer_it_comes_to_one_that_keeps_its_length() -> None:
    """A block that swings on its rope: what the poses differ by falls as 1/k, begun at the stretch that bears it."""

    def ended(rope: str) -> Results:
        return solved(f"""
heun: 1
space: planar
gravity: [0, -{G}]
ground: {{points: {{A: [-0.4, 2], O: [0.6, 2], W: [1.3, 0.5]}}}}
bodies:
  block: {{mass: 4, center: [0, 0], inertia: 0.1, position: [0, 0.5], velocity: [0.3, 0], points: {{hub: [0, 0]}}}}
  weight: {{mass: 2, center: [0, 0], inertia: 0.1, points: {{top: [0, 0]}}}}
joints: {{guide: {{type: slide, from: ground.W, to: weight.top, axis: [0, 1]}}}}
couplings:
  rope:
    {{type: rope, through: [ground.A, {{sheave: block.hub, radius: 0.2, side: under}},
     {{sheave: ground.O, radius: 0.2, side: over}}, weight.top]{rope}}}
analysis: {{duration: 0.6, samples: 7}}
""")

    kept = ended("").bodies["block"]["center"]
    off = [np.abs(ended(f", stiffness: {k}, damping: {c}").bodies["block"]["center"] - kept).max()
           for k, c in ((1e4, 100), (1e5, 300))]  # fmt: skip
    assert off[1] < 2e-3
    assert 5.0 < off[0] / off[1] < 20.0


@pytest.mark.parametrize(
    ("rope", "code"),
    [
        ("stiffness: 0", "rope-bounds"),
        ("stiffness: -1", "rope-bounds"),
        ("damping: 3", "rope-bounds"),
        ("stiffness: 100, damping: -3", "rope-bounds"),
        ("stiffness: 100, tension_only: true, restitution: 0", "rope-bounds"),
        ('stiffness: 100, length: "10 - 2*t"', "drive-length"),
    ],
)
def test_refused(rope: str, code: str) -> None:
    """Each with its code, before anything is solved."""
    with pytest.raises(SpecError) as error:
        solved(winch(rope, "{duration: 8, samples: 3}"))
    assert {problem.code for problem in error.value.problems} == {code}


def test_a_blow_passes_a_rope_by_and_each_cause_has_its_share() -> None:
    """A weight on a jib's rope is struck: it alone is moved; the rope is a cause, whose pulls add up with others."""
    text = f"""
heun: 1
space: planar
gravity: [0, -{G}]
ground: {{points: {{O: [0, 0], P: [0, 0.1]}}}}
bodies:
  jib: {{shapes: [{{type: rod, from: [0, 0], to: [2, 0], mass: 3}}], points: {{root: [0, 0], tip: [2, 0]}}}}
  weight: {{mass: 5, center: [0, 0], inertia: 1, position: [2.1, -1], points: {{top: [0, 0]}}}}
joints: {{root: {{type: weld, from: ground.O, to: jib.root}}}}
couplings:
  rope: {{type: rope, through: [ground.P, {{sheave: jib.tip, radius: 0.1, side: over}}, weight.top], stiffness: 3e3}}
sections: {{middle: {{body: jib, at: [1, 0, 0], normal: [1, 0, 0]}}}}
impulses: {{kick: {{on: weight.top, vector: [0, 5], time: 0.1}}}}
analysis: {{duration: 0.2, samples: 5}}
"""
    results = solved(
        text, requested_reports=frozenset({"motion", "foundation", "joints", "sections", "shares", "impulses"})
    )
    (struck,) = results.impulses
    assert struck["bodies"]["weight"]["center_velocity_jump"] == pytest.approx([0.0, 1.0, 0.0], abs=1e-12)
    assert struck["couplings"]["rope"]["tension"] == 0.0
    T, section = results.couplings["rope"]["tension"], results.sections["middle"]
    for whole in (results.joints["root"], section, results.foundation):
        parts = sum(own["force"] for own in whole["shares"].values())
        assert parts == pytest.approx(whole["force"], abs=1e-9)
    assert section["shares"]["rope"]["direct_force"][:, 0] == pytest.approx(-T, abs=1e-9)
    assert T.max() > 5 * G


@pytest.mark.parametrize("analysis", ["{type: state}", "{duration: 1, samples: 2}", "{duration: 1, samples: 9}"])
def test_what_a_rope_does_to_the_ground_is_its_own_share(analysis: str) -> None:
    """Of one instant or of many, force and moment of each cause: its strand on the ground has no cause but itself."""
    results = solved(
        winch("stiffness: 2e4, damping: 300, length: 9.8", analysis),
        requested_reports=frozenset({"foundation", "shares"}),
    )
    element = results.foundation["elements"]["rope"]
    for name in ("force", "moment"):
        parts = {cause: own[name] for cause, own in element["shares"].items()}
        assert {values.shape for values in parts.values()} == {results.foundation[name].shape}
        assert parts["rope"] == pytest.approx(element[name], abs=1e-9)
        assert not any(values.any() for cause, values in parts.items() if cause != "rope")
        whole = sum(own[name] for own in results.foundation["shares"].values())
        assert whole == pytest.approx(results.foundation[name], abs=1e-9)


HOIST = """\
heun: 1
gravity: [0, 0, -9.81]
ground: {points: {O: [0, 0, 0], drum: [1, 0, 3], top: [0.2, 0, 3]}}
bodies: {load: {mass: 10, center: [0, 0, 0], inertia: [1, 1, 1], points: {hook: [0, 0, 0]}}}
joints: {guide: {type: slide, from: ground.O, to: load.hook, axis: [0, 0, 1]}}
couplings:
  rope:
    type: rope
    through: [load.hook, {sheave: ground.top, radius: 0.2, axis: [0, 1, 0], side: over}, ground.drum]
    tension: 120 + 10*t
analysis: {duration: 1, samples: 3}
"""
SWING = """\
heun: 1
gravity: [0.3, 0, -9.81]
ground: {points: {O: [0, 0, 0], P: [0.4, 0.3, -0.2]}}
bodies:
  bob:
    mass: 2
    center: [0, 0, -0.5]
    inertia: [0.1, 0.08, 0.05]
    points: {top: [0, 0, 0], hook: [0.1, 0, -0.6]}
    angular_velocity: [1, 2, 0.5]
joints: {pivot: {type: ball, from: ground.O, to: bob.top}}
PULL
analysis: {duration: 1, samples: 5, tolerance: 1e-11}
"""


def test_a_weight_on_a_rope_of_given_tension() -> None:
    """m v' = T(t) - m g; the work is the integral of T v."""
    results = solved(HOIST)
    v = (12.0 - 9.81) + 0.5
    z = 0.5 * (12.0 - 9.81) + 1.0 / 6.0
    assert results.coordinates["guide"]["speed"][-1] == pytest.approx(v, rel=1e-12)
    assert results.couplings["rope"]["tension"] == pytest.approx([120.0, 125.0, 130.0], rel=1e-14)
    assert results.couplings["rope"]["on"]["load"]["force"][-1] == pytest.approx([0.0, 0.0, 130.0], rel=1e-12)
    assert results.energy["work"][-1] == pytest.approx(5.0 * v * v + 98.1 * z, rel=1e-12)
    assert not results.energy["potential"][0]


@pytest.mark.parametrize("kind", ["motion", "rest", "state"])
def test_it_pulls_as_an_actuator_between_the_same_points(kind: str) -> None:
    rope = "couplings: {pull: {type: rope, through: [ground.P, bob.hook], tension: 15}}"
    actuator = "forces: {pull: {type: actuator, from: ground.P, to: bob.hook, value: -15}}"
    text = SWING
    if kind != "motion":
        text = text.replace("{duration: 1, samples: 5, tolerance: 1e-11}", f"{{type: {kind}}}")
        text = text.replace("    angular_velocity: [1, 2, 0.5]\n", "")
    mine, its = (solved(text.replace("PULL", pull)) for pull in (rope, actuator))
    for name in ("force", "point"):
        assert mine.joints["pivot"][name] == pytest.approx(its.joints["pivot"][name], rel=1e-7, abs=1e-7)
    assert mine.bodies["bob"]["rotation"] == pytest.approx(its.bodies["bob"]["rotation"], rel=1e-7, abs=1e-7)
    assert mine.energy["work"] == pytest.approx(its.energy["work"], rel=1e-8, abs=1e-8)


def test_its_tension_may_follow_a_coordinate() -> None:
    """T = m g + k travel is an unstable spring: the travel grows as cosh."""
    text = HOIST.replace("120 + 10*t", "98.1 + 40*guide.travel")
    text = text.replace("axis: [0, 0, 1]", "axis: [0, 0, 1], initial: {travel: 0.1}", 1)
    assert solved(text).coordinates["guide"]["travel"][-1] == pytest.approx(0.1 * np.cosh(2.0), rel=1e-9)


@pytest.mark.parametrize("more", ["length: 3", "stiffness: 1e5", "tension_only: true", "damping: 3"])
def test_a_length_of_its_own_is_refused(more: str) -> None:
    with pytest.raises(SpecError) as refused:
        load("hoist.yaml", HOIST.replace("tension: 120 + 10*t", f"tension: 120\n    {more}"))
    assert any(p.code == "rope-bounds" and "whose length is free" in p.message for p in refused.value.problems)
