"""Bodies that are no mass beside the others: what they stand between carries the same as without them."""

from __future__ import annotations

import numpy as np
import pytest

from tests.shared.scenes import near, study

POINT = "mass: 1e-20, center: [0, 0, 0], inertia: [0, 0, 0], points: {o: [0, 0, 0]}"
CRANK = "mass: 1, center: [0, 0, 0.5], inertia: [0.1, 0.1, 0.01], points: {o: [0, 0, 0], e: [0, 0, 1]}"
LINK = "mass: 1e-14, center: [1, 0, 0], inertia: [0, 0, 0], points: {o: [0, 0, 0], e: [2, 0, 0]}"


def four_bar(coupler: str, joints: str) -> str:
    return f"""
heun: 1
gravity: [0, 0, -9.81]
ground: {{points: {{O: [0, 0, 0], P: [2, 0, 0]}}}}
bodies:
  a: {{{CRANK}}}
  b: {{{CRANK}}}
{coupler}joints:
  p: {{type: pin, from: ground.O, to: a.o, axis: [0, 1, 0], initial: {{angle: 0, rate: 1}}}}
  q: {{type: pin, from: ground.P, to: b.o, axis: [0, 1, 0]}}
{joints}analysis: {{duration: 0.5, samples: 6}}
"""


@pytest.mark.heavy
def test_a_link_on_two_balls_is_a_rod() -> None:
    """Its spin is idle: neither joint is kept for its sake, whatever it weighs."""
    balls = "  u: {type: ball, from: a.e, to: c.o}\n  v: {type: ball, from: c.e, to: b.e}\n"
    link = study(four_bar(f"  c: {{{LINK}}}\n", balls)).results
    rod = study(four_bar("", "  u: {type: rod, from: a.e, to: b.e}\n")).results
    for joint in ("p", "q"):
        near(link.joints[joint]["force"], rod.joints[joint]["force"], 10.0, 1e-7)
    near(link.coordinates["p"]["angle"], rod.coordinates["p"]["angle"], 1.0, 1e-8)


def stacked(seed: int, mass: str) -> str:
    """Two stacks of pins, one with a slide, on bodies that are welded to each other: the weld makes most conditions."""
    rng = np.random.default_rng(seed)

    def vector() -> str:
        return str(rng.normal(size=3).round(3).tolist())

    carriers = "".join(f"  c{k}: {{{POINT.replace('1e-20', mass)}}}\n" for k in range(1, 6))
    body = "mass: 1, center: {}, inertia: [2, 2.5, 3], points: {{o: [0, 0, 0], e: [{}, 0, 1]}}"
    ways = [("ground.O", "c1"), ("c1.o", "c2"), ("c2.o", "a"), ("ground.P", "c3"), ("c3.o", "c4"), ("c4.o", "c5"),
            ("c5.o", "b")]  # fmt: skip
    joints = "".join(
        f"  j{k}: {{type: {'slide' if k == 4 else 'pin'}, from: {start}, to: {end}.o, axis: {vector()}}}\n"
        for k, (start, end) in enumerate(ways)
    )
    return f"""
heun: 1
gravity: [0, 0, -9.81]
ground: {{points: {{O: [0, 0, 0], P: [2, 0, 0]}}}}
bodies:
{carriers}  a: {{{body.format(vector(), 1)}}}
  b: {{{body.format(vector(), -1)}}}
joints:
{joints}  weld: {{type: weld, from: a.e, to: b.e}}
"""


@pytest.mark.parametrize("mass", ["1e-20", "0"])
@pytest.mark.parametrize("seed", range(2))
def test_joints_of_a_carrier_are_kept(seed: int, mass: str) -> None:
    """The weld is cut in their place; the loads are those of carriers that are heavier, yet next to nothing."""
    light, known = (study(stacked(seed, one)) for one in (mass, "1e-10"))
    names = [joint.name for joint in light.setup.scene.mechanism.joints]
    assert [names[k] for k in light.setup.scene.layout.spanning.cut] == ["weld"]
    for name in ("weld", "j0", "j3"):
        for key in ("force", "moment"):
            near(light.results.joints[name][key], known.results.joints[name][key], 10.0, 1e-8)
