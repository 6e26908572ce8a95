"""Rods without axial inertia on balls: the spin is undetermined but harmless, a moment is refused.

manual/theory.md, "Thin rods".
"""

from __future__ import annotations

import re
from typing import Any

import numpy as np
import pytest

from heuncli.base.errors import SolveError
from tests.oracle.masses import mass_of
from tests.oracle.read import directed
from tests.oracle.transforms import entry
from tests.oracle.turns import Array, attitude, unit
from tests.shared.scenes import moving, near, solved
from tests.shared.thin_rods import thin_rods

TIMES = (0.0, 0.1, 0.3)
SEEDS = range(10)


def axis_of(body: dict[str, Any]) -> Array:
    """The rod's axis, body axes."""
    rod = body["shapes"][0]
    return unit(np.array(rod["to"]) - np.array(rod["from"]))


def with_axial(scene: dict[str, Any], ratio: float) -> dict[str, Any]:
    """The rods as bodies of given mass properties with some axial inertia, and without spin about the axis."""
    bodies = {}
    for name, body in scene["bodies"].items():
        m, n, R = mass_of(body), axis_of(body), attitude(body["orientation"])
        rest = {k: v for k, v in body.items() if k != "shapes"}
        lent = ratio * float(np.trace(m.inertia)) / 2 * np.outer(n, n)
        spin = directed(body["angular_velocity"], R)
        axial = R @ n * float(spin @ (R @ n))
        foot = R @ np.array(body["shapes"][0]["from"])  # the origin lies beside the axis and had its share of the spin
        velocity = directed(body["velocity"], R) + np.cross(axial, foot)
        new = {"angular_velocity": (spin - axial).tolist(), "velocity": velocity.tolist()}
        bodies[name] = {**rest, **entry(m._replace(inertia=m.inertia + lent)), **new}
    return {**scene, "bodies": bodies}


@pytest.mark.heavy
@pytest.mark.parametrize("ratio", [1e-3, 1e-6, 1e-9])
@pytest.mark.parametrize("seed", SEEDS)
@pytest.mark.third
def test_any_axial_inertia_gives_the_same(seed: int, ratio: float) -> None:
    """Centres, reactions and foundation do not know the axial inertia, be it nothing or 1e-3 of the transverse one.

    The smaller ones at the start only, where their condition 1/ratio costs nothing: a motion turns rounding into spin.
    """
    scene, _ = thin_rods(seed)
    pair = [moving(s, TIMES, 1e-12) if ratio >= 1e-3 else s for s in (scene, with_axial(scene, ratio))]
    thin, thick = (solved(s) for s in pair)
    F = max(1.0, *(float(np.abs(j["force"]).max()) for j in thin.joints.values()))
    tolerance = 1e-9
    for name, body in thin.bodies.items():
        for key in ("center", "center_velocity", "center_acceleration"):
            near(thick.bodies[name][key], body[key], max(1.0, float(np.abs(body[key]).max())), tolerance)
    for name, joint in thin.joints.items():
        near(thick.joints[name]["force"], joint["force"], F, tolerance)
        near(joint["moment"], 0.0, F, 1e-13)
    near(thick.foundation["force"], thin.foundation["force"], F, tolerance)
    near(thick.foundation["moment"], thin.foundation["moment"], F, tolerance)


@pytest.mark.parametrize("seed", SEEDS)
def test_spin_is_harmless(seed: int) -> None:
    """Whatever spin about its axis a rod starts with, it counts as none."""
    scene, state = thin_rods(seed)
    bodies = {}
    for k, (name, body) in enumerate(scene["bodies"].items()):
        R = state[name].rotation
        more = (7.0 + k) * R @ axis_of(body)
        foot = R @ np.array(body["shapes"][0]["from"])
        velocity = directed(body["velocity"], R) - np.cross(more, foot)
        spin = directed(body["angular_velocity"], R) + more
        bodies[name] = {**body, "angular_velocity": spin.tolist(), "velocity": velocity.tolist()}
    still, spun = (solved(moving(s, TIMES, 1e-12)) for s in (scene, {**scene, "bodies": bodies}))
    F = max(1.0, *(float(np.abs(j["force"]).max()) for j in still.joints.values()))
    for name, body in still.bodies.items():
        near(spun.bodies[name]["center"], body["center"], max(1.0, float(np.abs(body["center"]).max())))
        along = np.einsum("tij,j->ti", spun.bodies[name]["rotation"], axis_of(scene["bodies"][name]))
        rate = float(np.abs(spun.bodies[name]["angular_velocity"]).max())
        near(np.sum(along * spun.bodies[name]["angular_velocity"], axis=1), 0.0, max(1.0, rate))
    for name, joint in still.joints.items():
        near(spun.joints[name]["force"], joint["force"], F)
    assert any("spin about its own axis is undetermined but harmless" in r for r in still.model["reasons"])


ROD = """
heun: 1
gravity: [0, 0, -9.81]
ground: {points: {O: [0, 0, 0]}}
bodies:
  rod:
    shapes: [{type: rod, from: [0, 0, 0], to: [1, 0, 0], mass: 2}]
    points: {root: [0, 0, 0], tip: [1, 0, 0], beside: [0.5, 0.1, 0]}
joints:
  pivot: {type: ball, from: ground.O, to: rod.root}
"""


@pytest.mark.parametrize("load", [
    "forces: {twist: {type: couple, on: rod.tip, vector: [0.3, 0, 0], frame: body}}",
    "forces: {push: {type: force, on: rod.beside, vector: [0, 0, 1]}}",
], ids=["couple", "force beside the axis"])  # fmt: skip
def test_a_moment_about_the_axis_is_refused(load: str) -> None:
    """Nothing could answer it: no acceleration exists. Body and axis are named."""
    with pytest.raises(SolveError) as refusal:
        solved(ROD + load)
    (problem,) = refusal.value.problems
    assert problem.code == "no-inertia"
    assert "rod" in problem.message and "1, 0, 0)" in problem.message


def test_a_damper_on_the_ball_leaves_the_spin_at_nothing() -> None:
    """It resists the spin too, of which there is none: the same as with some axial inertia and no spin."""
    drag = "forces: {drag: {type: damper, joint: pivot, coefficient: 0.1}}\n"
    drag += "analysis: {times: [0, 0.1], tolerance: 1e-12}"
    thin = ROD.replace("points: {root", "angular_velocity: [0, 1, 0.5]\n    points: {root")
    shapes = "shapes: [{type: rod, from: [0, 0, 0], to: [1, 0, 0], mass: 2}]"
    thick = thin.replace(shapes, "mass: 2\n    center: [0.5, 0, 0]\n    inertia: [0.01, 1/6, 1/6]")
    found, other = solved(thin + drag), solved(thick + drag)
    near(found.points["rod.tip"]["position"], other.points["rod.tip"]["position"], 1.0, 1e-11)
    near(found.joints["pivot"]["force"], other.joints["pivot"]["force"], 20.0, 1e-11)


def test_a_moment_across_the_axis_is_not() -> None:
    """The same couple across the axis turns the rod: m g L/2 less 0.3 N m about y, over m L²/3."""
    found = solved(ROD + "forces: {twist: {type: couple, on: rod.tip, vector: [0, 0.3, 0], frame: body}}")
    near(found.bodies["rod"]["angular_acceleration"][0], [0.0, (2 * 9.81 * 0.5 + 0.3) / (2 / 3), 0.0], 10.0, 1e-14)


@pytest.mark.heavy
@pytest.mark.parametrize("cables", [1, 2])
def test_rounding_is_no_moment(cables: int) -> None:
    """Thin bars hung on cables in no particular direction, slack in part: what rounding puts on the axis is nothing."""
    rng, up = np.random.default_rng(7), np.array([0.0, 0.0, 3.0])
    for _ in range(20):
        a, b, gravity = rng.uniform(-2, 2, (3, 3))
        points = f"points: {{p: {a.tolist()}, q: {b.tolist()}}}"
        held = "  j0: {type: rod, from: {body: ground, at: [0, 0, 0]}, to: bar.p}\n"
        if cables == 2:
            held += f"  j1: {{type: rod, from: {{body: ground, at: {(b + up).tolist()}}}, to: bar.q}}\n"
        found = solved(f"""
heun: 1
gravity: {gravity.tolist()}
bodies: {{bar: {{shapes: [{{type: rod, from: {a.tolist()}, to: {b.tolist()}, mass: 1}}], {points}}}}}
joints:
{held}analysis: {{duration: 0.1, samples: 3}}
""")
        axis = np.einsum("tij,j->ti", found.bodies["bar"]["rotation"], (b - a) / np.linalg.norm(b - a))
        near(np.sum(axis * found.bodies["bar"]["angular_velocity"], axis=1), 0.0, 1.0, 1e-9)


ASIDE = """
heun: 1
gravity: [0, 0, -9.81]
ground: {{points: {{O: [0, 0, 0]}}}}
bodies:
  b: {{shapes: [{{type: point, at: {at}, mass: 1}}], points: {{p: [0, 0, 0]}}}}
joints:
  J: {{type: plane, normal: {normal}, from: ground.O, to: b.p}}
forces: {{f: {{type: force, on: b.p, vector: [-4.2, 6.04, -18.97]}}}}
"""
SIDEWAYS = [
    ([0.3, 0.3, 0.3], [-0.58, 0.37, -0.07]),
    *((a.tolist(), n.tolist()) for a, n in np.random.default_rng(5).uniform(-1, 1, (6, 2, 3))),
]


@pytest.mark.parametrize("more", ["", "analysis: {duration: 0.1, samples: 3}\n"], ids=["state", "motion"])
@pytest.mark.parametrize(("at", "normal"), SIDEWAYS, ids=range(len(SIDEWAYS)))
def test_a_point_mass_held_aside_is_refused(at: list[float], normal: list[float], more: str) -> None:
    """A massless lever with its load and its guide on one end and its mass on the other: the lever would fly round.

    Of its two slides and three turns one combination moves no mass. Whatever the directions, it is that which is told,
    and not what rounding leaves of its inertia.
    """
    with pytest.raises(
        SolveError, match=r"a degree of freedom has no inertia: bodies\.b has no inertia about its axis"
    ):
        solved(ASIDE.format(at=at, normal=normal) + more)


def two_rods(joint: str, seed: int, more: str = "", along: float = 0.0, top: str = "ball") -> str:
    """Two rods of 1 m in a row, near to random attitudes; along: inertia about their axes."""
    rng = np.random.default_rng(seed)
    bodies = []
    for name in ("up", "lo"):
        n, x = rng.standard_normal((2, 3))
        z = n / np.linalg.norm(n)
        x = np.cross(z, x)
        x /= np.linalg.norm(x)
        R = np.stack([x, np.cross(z, x), z], axis=1).tolist()
        bodies.append(f"""
  {name}:
    mass: {rng.uniform(0.5, 2.0)!r}
    center: [0, 0, -0.5]
    inertia: [0.08, 0.08, {along!r}]
    points: {{a: [0, 0, 0], b: [0, 0, -1]}}
    near: {{orientation: {{matrix: {R}}}}}""")
    return f"""
heun: 1
gravity: [0, 0, -9.81]
ground: {{points: {{O: [0, 0, 0]}}}}
bodies:{"".join(bodies)}
joints:
  p: {{type: {top}, from: ground.O, to: up.a}}
  q: {{type: {joint}, from: up.b, to: lo.a}}
{more}
"""


UNIVERSAL = "universal, axis: [1, 0, 0], to_axis: [0, 1, 0]"
AWAY = "universal, axis: [1, 0, 0], to_axis: [0, 0.6, 0.8]"
PUSH = "forces: {f: {type: force, on: lo.b, vector: [3, -1, 2]}}"


@pytest.mark.parametrize("joint", [UNIVERSAL, AWAY], ids=["crossed", "slanting"])
@pytest.mark.parametrize("seed", range(6))
@pytest.mark.third
def test_a_universal_between_thin_rods_is_a_ball(joint: str, seed: int) -> None:
    """What it holds of one spin the other one gives way to: it carries no couple, and the rods move as on a ball."""
    run = f"{PUSH}\nanalysis: {{duration: 0.5, samples: 5}}"
    near(np.nan_to_num(solved(two_rods(joint, seed, PUSH)).joints["q"]["moment"]), 0.0, 1.0, 1e-12)
    found = solved(two_rods(joint, seed, run))
    text = two_rods("ball", seed, run)
    for body in found.bodies.values():  # the assembly has turned them until the universal's axes are square
        start = f"orientation: {{matrix: {body['rotation'][0].tolist()}}}"
        text = re.sub(r"near: \{orientation: .*\}", start, text, count=1)
    ball = solved(text)
    for name in ("up", "lo"):
        near(found.bodies[name]["center"], ball.bodies[name]["center"], 1.0, 1e-8)
    for name in ("p", "q"):
        near(found.joints[name]["force"], ball.joints[name]["force"], 30.0, 1e-7)
    near(found.joints["q"]["moment"], 0.0, 30.0, 1e-9)


def test_it_is_the_limit_of_rods_with_some_inertia() -> None:
    """The less inertia about their axes, in proportion the nearer."""
    run = f"{PUSH}\nanalysis: {{duration: 0.3, samples: 3}}"
    thin = solved(two_rods(UNIVERSAL, 1, run)).bodies["lo"]["center"]
    off = [
        float(np.abs(solved(two_rods(UNIVERSAL, 1, run, along)).bodies["lo"]["center"] - thin).max())
        for along in (1e-4, 1e-6)
    ]
    assert off[0] < 1e-2 and off[1] < 0.02 * off[0] + 1e-8


@pytest.mark.parametrize("load", [
    "{type: couple, on: lo, vector: [0, 0, 0.3], frame: body}",
    "{type: couple, on: up, vector: [0, 0, 0.3], frame: body}",
    "{type: force, on: {body: lo, at: [0.1, 0, -0.5]}, vector: [0, 1, 0], frame: body}",
])  # fmt: skip
def test_what_turns_both_spins_is_refused(load: str) -> None:
    """Nothing answers it."""
    with pytest.raises(SolveError, match=r"bodies\.up has no inertia about its axis"):
        solved(two_rods(UNIVERSAL, 1, f"forces: {{c: {load}}}"))


def test_a_spin_that_is_told_has_to_be_known() -> None:
    """A pin along the rod in place of the ball: its angle is a number that nothing determines."""
    with pytest.raises(SolveError, match="a degree of freedom has no inertia"):
        solved(two_rods(UNIVERSAL, 1, top="pin, axis: [0, 0, 1]"))
