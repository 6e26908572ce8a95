"""Motions that start at rest under the loads at t = 0, or steady: closed forms, and what settles stays."""

from __future__ import annotations

import math

import numpy as np
import pytest
from scipy.optimize import brentq

from heuncli.base.errors import SolveError, SpecError
from heuncli.results.results import Results
from tests.shared.folders import ROOT
from tests.shared.scenes import near, solved
from tests.shared.settled_scenes import BALL, BAR, HEAD, POINTS, G, tree, triangle

pytestmark = pytest.mark.heavy  # the plain kernel has the same bits
REST = "analysis: {type: rest}"


def started(text: str, kind: str = "rest", duration: float = 0.5) -> Results:
    """A scene at rest, as a motion that starts there."""
    assert REST in text
    analysis = f"analysis: {{duration: {duration!r}, samples: 6, start: {kind}, tolerance: 1e-10}}"
    return solved(text.replace(REST, analysis).partition("expect:")[0])


def require_same_pose(text: str, motion: Results, within: float) -> None:
    """At all its instants the motion is where the rest pose is."""
    rest = solved(text.partition("expect:")[0])
    for name, block in rest.bodies.items():
        for key in ("position", "rotation"):
            for value in motion.bodies[name][key]:
                near(value, block[key][0], 1.0, within)


@pytest.mark.parametrize("k", [200.0, 2e4])
@pytest.mark.parametrize("duration", [1.0, 2.0])
def test_a_force_that_grows_from_a_preload(k: float, duration: float) -> None:
    """m u'' + k u = 20 sin 3t about z0 = (10 - m g) / k: u = A (sin 3t - 3/w sin wt), A = 20/(k - 9 m)."""
    forces = (
        "sp: {type: spring, from: ground.T, to: b.c, stiffness: " + repr(k) + ", length: 1}, "
        "push: {type: force, on: b.c, vector: [0, 0, 10 + 20*sin(3*t)]}"
    )
    ground = "ground: {points: {O: [0, 0, 0], T: [0, 0, 1]}}\n"
    joint = "joints: {s: {type: slide, axis: [0, 0, 1], from: ground.O, to: b.c}}"
    results = started(f"{HEAD}{ground}bodies: {{b: {{{BALL}}}}}\n{joint}\nforces: {{{forces}}}\n", duration=duration)
    m, w = 2.0, math.sqrt(k / 2.0)
    t = results.time
    u = 20.0 / (k - 9.0 * m) * (np.sin(3.0 * t) - 3.0 / w * np.sin(w * t))
    near(results.coordinates["s"]["travel"], (10.0 - m * G) / k + u, 1.0, 1e-9)
    assert any("at rest under the loads at t = 0; stable" in text for text in results.model["started"])


@pytest.mark.parametrize("seed", range(6))
@pytest.mark.third
def test_what_rests_stays(seed: int) -> None:
    text = tree(np.random.default_rng(seed))
    require_same_pose(text, started(text), 1e-8)


def test_loops_that_rest_stay() -> None:
    text = triangle(np.random.default_rng(7))[0]
    require_same_pose(text, started(text), 1e-8)


@pytest.mark.parametrize("drawn", [0.0, 1.2])
def test_a_pin_keeps_the_zero_of_the_drawing(drawn: float) -> None:
    """Counted from the drawn pose: k (angle - 0.3) = -m g l sin(angle + drawn), at the start and later."""
    pose = f"orientation: {{axis: [0, 1, 0], angle: {drawn!r}}}"
    pin = "p: {type: pin, axis: [0, 1, 0], to_axis: [0, 1, 0], from: ground.O, to: bar.top}"
    spring = "forces: {k: {type: turn_spring, joint: p, stiffness: 20, angle: 0.3}}"
    text = f"{HEAD}{POINTS}bodies: {{bar: {{{BAR}, {pose}}}}}\njoints: {{{pin}}}\n{spring}\n"
    angle = brentq(lambda x: 20.0 * (x - 0.3) + 0.5 * G * math.sin(x + drawn), -2.0, 2.0, xtol=1e-14)
    near(started(text).coordinates["p"]["angle"], angle, 1.0, 1e-10)


SWUNG = "p: {type: pin, axis: [0, 1, 0], from: ground.O, to: bar.top, initial: {angle: SIGN}}"
ROPE = "joints: {r: {type: rod, tension_only: true, from: ground.A, to: bar.end, length: LENGTH, restitution: 0.5}}"
CONTACTS = {
    "stop": "stops: {s: {joint: p, angle: [0.2, 1.5]}}",
    "rope": ROPE.replace("LENGTH", "1.3"),
    "slack rope": ROPE.replace("LENGTH", "1.5"),
}


@pytest.mark.parametrize("name", CONTACTS)
def test_what_bears_goes_on_bearing(name: str) -> None:
    """A bar that hangs against a stop at 0.2 rad, on a rope of 1.3 m, or free with a rope that hangs slack."""
    more = CONTACTS[name]
    swung = SWUNG.replace("SIGN", "1" if name == "stop" else "-1")
    joints = f"joints: {{{swung}}}\n{more}" if name == "stop" else more.replace("{r:", f"{{{swung}, r:")
    text = f"{HEAD}{POINTS}bodies: {{bar: {{{BAR}}}}}\n{joints}\n"
    results = started(text)
    require_same_pose(text, results, 1e-10)
    angle = float(results.coordinates["p"]["angle"][0])
    assert (abs(angle) > 0.1) == (name != "slack rope")


@pytest.mark.parametrize("space", ["", "space: planar\n"])
def test_a_declared_plane_and_a_coupling(space: str) -> None:
    """Two bars, one at -2 times the angle of the other, with a spring: a train at rest stays at rest."""
    across = "[0, 0, 1]" if space else "[0, 1, 0]"
    bar = "mass: 1, center: [0.5, 0, 0], inertia: [0, 0.08, 0.08], points: {top: [0, 0, 0]}"
    pins = ", ".join(
        f"p{k}: {{type: pin, axis: {across}, from: ground.{end}, to: b{k}.top, initial: {{angle: {angle}}}}}"
        for k, end, angle in ((1, "O", "0.1"), (2, "A", "-0.2"))
    )
    text = (
        f"{HEAD}{space}{POINTS}bodies: {{b1: {{{bar}}}, b2: {{{bar}}}}}\njoints: {{{pins}}}\n"
        "couplings: {g: {type: ratio, of: [p1, p2], factors: [2, 1]}}\n"
        "forces: {k: {type: turn_spring, joint: p1, stiffness: 30}}\n"
    )
    text = text.replace("gravity: [0, 0, -9.81]", "gravity: [0, -9.81, 0]") if space else text
    require_same_pose(text, started(text), 1e-9)


GOVERNOR = (ROOT / "specs" / "governor.yaml").read_text()
RELEASED = GOVERNOR.replace('drives:\n  motor: {joint: bearing, angle: "w*t"}\n', "").replace(
    "to: spindle.head, axis: [0, 0, 1]}\n  guide", "to: spindle.head, axis: [0, 0, 1], initial: {rate: w}}\n  guide"
)


@pytest.mark.parametrize("text", [GOVERNOR, RELEASED], ids=["driven", "released"])
def test_a_governor_that_runs_steadily_stays_so(text: str) -> None:
    """Travel -2 (m + M) g / (m w^2); released, it keeps its spin, for nothing brakes it."""
    assert text.count("initial: {rate: w}") == (text is RELEASED)
    results = started(text, "steady", 1.0)
    near(results.coordinates["guide"]["travel"], -2.0 * 6.0 * G / 400.0, 1.0, 1e-9)
    near(results.coordinates["bearing"]["rate"], 20.0, 20.0, 1e-9)


def test_a_drive_that_accelerates_finds_its_pose_at_rest_first() -> None:
    """A carriage with a pendulum, driven by x = 2 t^2: it hangs at t = 0, and starts as x'' demands: -a/(l g) g."""
    text = (
        f"{HEAD}{POINTS}bodies: {{cart: {{{BALL}}}, bar: {{mass: 1, center: [0, 0, -0.5], inertia: [0, 0, 0], "
        "points: {top: [0, 0, 0]}}}\n"
        "joints: {s: {type: slide, axis: [1, 0, 0], from: ground.O, to: cart.c}, "
        "p: {type: pin, axis: [0, 1, 0], from: cart.c, to: bar.top, initial: {angle: 1}}}\n"
        "drives: {x: {joint: s, travel: 2*t^2}}\n"
    ).replace("^", "**")
    results = started(text)
    near(results.coordinates["p"]["angle"][0], 0.0, 1.0, 1e-12)
    near(results.coordinates["p"]["acceleration"][0], 4.0 / 0.5, 8.0, 1e-10)


def test_what_moves_cannot_start_at_rest() -> None:
    with pytest.raises(SolveError, match="motor moves at t = 0") as refused:
        started(GOVERNOR)
    assert "start: steady" in (refused.value.problems[0].hint or "")
    with pytest.raises(SpecError, match="start: rest takes no initial rate"):
        started(RELEASED)
    with pytest.raises(SpecError, match="start: rest is for motions"):
        solved(GOVERNOR.replace("{type: rest}", "{type: state, start: rest}"))


CYLINDER = f"{HEAD}{POINTS}bodies: {{b: {{{BALL}}}}}\njoints: {{c: {{type: cylinder, axis: [0, 0, 1], "
GIVEN = "from: ground.O, to: b.c, initial: {%s}}}\n"
TRAVEL = "drives: {d: {joint: c, travel: %s*t}}\n"


@pytest.mark.parametrize(
    ("kind", "initial", "drive", "refused"),
    [
        ("steady", "rate: 2, speed: 0.5", "", "this one has a rate and a speed"),
        ("steady", "rate: 2", TRAVEL % 3, "this one has the speed of its drive and a rate"),
        ("rest", "rate: 2", TRAVEL % "t", "start: rest takes no initial rate"),
        ("rest", "speed: 2", "", "start: rest takes no initial speed"),
    ],
)
def test_a_rate_that_would_be_lost_is_refused(kind: str, initial: str, drive: str, refused: str) -> None:
    """A cylinder turns and slides: what a start cannot hold of its two rates is told by its place."""
    with pytest.raises(SpecError, match=refused):
        started(CYLINDER + GIVEN % initial + drive, kind)


@pytest.mark.parametrize(
    ("initial", "drive", "turned", "moved"),
    [("rate: 2", "", 1.0, 0.0), ("speed: 3", "", 0.0, 1.5), ("speed: 3", TRAVEL % 3, 0.0, 1.5)],
)
def test_a_steady_cylinder_goes_on_at_its_rate(initial: str, drive: str, turned: float, moved: float) -> None:
    head = CYLINDER.replace("gravity: [0, 0, -9.81]", "gravity: [0, 0, 0]")
    results = started(head + GIVEN % initial + drive, "steady")
    near(results.coordinates["c"]["angle"][-1], turned, 1.0, 1e-12)
    near(results.coordinates["c"]["travel"][-1], moved, 1.0, 1e-12)


def test_what_nothing_holds_has_no_such_start() -> None:
    joint = "joints: {s: {type: slide, axis: [0, 0, 1], from: ground.O, to: b.c}}"
    with pytest.raises(SolveError) as refused:
        started(f"{HEAD}{POINTS}bodies: {{b: {{{BALL}}}}}\n{joint}\n")
    assert refused.value.problems[0].code == "no-rest-pose"


def test_an_unstable_start_is_warned_of() -> None:
    pin = f"p: {{type: pin, axis: [0, 1, 0], from: ground.O, to: bar.top, initial: {{angle: {math.pi!r}}}}}"
    results = started(f"{HEAD}{POINTS}bodies: {{bar: {{{BAR}}}}}\njoints: {{{pin}}}\n")
    assert any("unstable" in warning for warning in results.warnings)
