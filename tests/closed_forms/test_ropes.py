"""Ropes pull: a run stops at the first instant at which one is slack, to 1e-10 of it, and tells no push before.

Against closed forms, and a motion by SciPy where there is none.
"""

from __future__ import annotations

import math
from itertools import pairwise

import numpy as np
import pytest
from scipy.integrate import solve_ivp
from scipy.optimize import brentq
from scipy.special import ellipkinc

from heuncli.errors import SolveError
from heuncli.study.ask.study import Study
from tests.shared.scenes import near, solved, study

pytestmark = pytest.mark.heavy  # families: the plain kernel has the same bits (tests/package/test_kernels_agree.py)

G = 9.81
INSTANT = 1e-10  # of the run
HEAD = f"heun: 1\ngravity: [0, 0, {-G}]\n"
SMALL = "inertia: [0.1, 0.1, 0.1]"


def pulls(run: Study, *ropes: str, largest: float = 0.0, count: int = 1000) -> None:
    """At so many instants, and close to the end, no rope of the run pushes by more than rounding."""
    last = float(run.results.time[-1])
    times = np.unique(np.concatenate([np.linspace(0.0, last, count), last * (1 - np.geomspace(1e-14, 1e-3, 50))]))
    found = run.resample(times)
    for rope in ropes:
        tension = found.joints[rope]["tension"]
        assert tension.min() >= -1e-12 * max(float(tension.max()), largest), (rope, tension.min(), tension.max())


def stops(run: Study, at: float, rope: str, largest: float = 0.0) -> None:
    """The run stopped at this instant by this rope."""
    assert run.results.status["code"] == "stopped", run.results.status
    assert f" {rope} " in run.results.status["message"]
    last = run.spec.analysis.times[-1]
    found = float(run.results.time[-1])
    assert abs(found - at) <= INSTANT * last, f"{found!r} for {at!r}, off by {(found - at) / last:.3g} of the run"
    pulls(run, rope, largest=largest)


def goes_on(run: Study, *ropes: str) -> None:
    """The run came to its end."""
    assert run.results.status["code"] == "completed", run.results.status
    assert run.results.time[-1] == run.spec.analysis.times[-1]
    pulls(run, *ropes)


# ---- a pendulum on a rope --------------------------------------------------------------------------------------


def pendulum(speed: float, duration: float, samples: int = 2, tolerance: float = 1e-9) -> Study:
    """A mass of 2 kg on 1 m of rope, hit at the bottom."""
    return study(
        HEAD
        + f"""
ground: {{points: {{O: [0, 0, 0]}}}}
bodies: {{b: {{mass: 2, center: [0, 0, 0], {SMALL}, points: {{c: [0, 0, 0]}},
  position: [0, 0, -1], velocity: [{speed!r}, 0, 0]}}}}
joints: {{rope: {{type: rod, from: ground.O, to: b.c, tension_only: true}}}}
analysis: {{duration: {duration!r}, samples: {samples}, tolerance: {tolerance!r}}}
"""
    )


def slack_of_pendulum(speed: float) -> float:
    """When the tension m (v²/L + g cos φ) is nothing: at cos φ = -(v0²/(g L) - 2)/3, where v² = -g L cos φ."""
    ratio = speed**2 / G
    cos = -(ratio - 2) / 3
    half = math.acos(cos) / 2
    if ratio > 4:  # it would go round: t = 2/ω0 F(φ/2 | 4 g/(L ω0²))
        return float(2 / speed * ellipkinc(half, 4 / ratio))
    sine = 2 / math.sqrt(ratio) * math.sin(half)  # of β: sin β = k sin φ/2; cos β = v/v0
    beta = math.atan2(sine, math.sqrt(-cos / ratio))
    return float(ellipkinc(beta, ratio / 4) / math.sqrt(G))


@pytest.mark.parametrize("ratio", [2 + 1e-6, 2.1, 2.5, 3.0, 3.7, 4.5, 4.9, 5 - 1e-3, 5 - 1e-6])
@pytest.mark.parametrize("samples", [2, 31])
def test_a_pendulum_falls_out_of_its_circle(ratio: float, samples: int) -> None:
    speed = math.sqrt(ratio * G)
    # where the tension goes through nothing at a small slope, the instant needs more digits of the motion
    tolerance = 1e-9 if 2.01 < ratio < 4.99 else 1e-13
    stops(pendulum(speed, 6.0, samples, tolerance), slack_of_pendulum(speed), "rope", 2 * G * (ratio + 1))


@pytest.mark.parametrize("ratio", [0.1, 1.9, 2 - 1e-6, 5 + 1e-6, 5.1, 30.0])
def test_a_pendulum_stays_on_its_circle(ratio: float) -> None:
    """It swings to less than level, or goes round: the rope never pulls less than nothing, but hardly more."""
    run = pendulum(math.sqrt(ratio * G), 6.0)
    goes_on(run, "rope")
    found = run.resample(np.linspace(0, 6, 2001))
    height = found.bodies["b"]["center"][:, 2]  # m v²/L + m g cos φ
    wanted = 2 * (ratio * G - 2 * G * (1 + height) - G * height)
    near(found.joints["rope"]["tension"], wanted, 2 * G * (ratio + 1), 1e-7)


@pytest.mark.parametrize(("ratio", "last"), [(1.99, 30.0), (4.0, 30.0), (5.01, 30.0)])
def test_no_push_at_ten_thousand_instants(ratio: float, last: float) -> None:
    pulls(pendulum(math.sqrt(ratio * G), last), "rope", count=10_000)


# ---- a support that jerks --------------------------------------------------------------------------------------


def hoist(jerk: str, duration: float = 3.0, samples: int = 2) -> Study:
    """Two tonnes under a driven trolley, 5 m of rope; the drive moves it up and down."""
    return study(
        HEAD
        + f"""
ground: {{points: {{O: [0, 0, 0]}}}}
bodies:
  drum: {{mass: 50, center: [0, 0, 0], {SMALL}, points: {{c: [0, 0, 0]}}}}
  load: {{mass: 2000, center: [0, 0, -5], {SMALL}, points: {{c: [0, 0, -5]}}}}
joints:
  guide: {{type: slide, from: ground.O, to: drum.c, axis: [0, 0, 1]}}
  rope: {{type: rod, from: drum.c, to: load.c, tension_only: true}}
drives: {{winch: {{joint: guide, travel: "{jerk}"}}}}
analysis: {{duration: {duration!r}, samples: {samples}}}
"""
    )


def bell(ratio: float, width: float) -> tuple[float, str]:
    """A drive a exp(-((t - 1.1)/w)²) whose largest acceleration downward, 2 a/w², is so many times g."""
    a = ratio * G * width**2 / 2
    return a, f"{a!r}*exp(-((t - 1.1)/{width!r})**2)"


@pytest.mark.parametrize("width", [0.3, 1e-2, 1e-4])
@pytest.mark.parametrize("ratio", [1.5, 1.01, 1 + 1e-6])
@pytest.mark.parametrize("samples", [2, 31])
def test_a_jerk_lets_the_load_float(ratio: float, width: float, samples: int) -> None:
    """Slack at first where a/w² (2 - 4 u²) exp(-u²) is g; it would pull again soon, within a step."""
    a, jerk = bell(ratio, width)
    u = brentq(lambda u: a / width**2 * (2 - 4 * u * u) * math.exp(-u * u) - G, -math.sqrt(0.5), 0.0, xtol=1e-17)
    stops(hoist(jerk, 3.0, samples), 1.1 + u * width, "rope", 2000 * G)


@pytest.mark.parametrize("width", [0.3, 1e-2, 1e-4])
@pytest.mark.parametrize("ratio", [0.5, 0.99, 1 - 1e-6])
def test_a_jerk_hardly_lets_it_float(ratio: float, width: float) -> None:
    run = hoist(bell(ratio, width)[1])
    goes_on(run, "rope")
    tension = run.resample(np.array([1.0, 1.1, 2.0])).joints["rope"]["tension"][1]
    near(tension, 2000 * G * (1 - ratio), 2000 * G, 1e-9)


@pytest.mark.parametrize("factor", [0.999999, 1.000001])
def test_a_hoist_that_trembles(factor: float) -> None:
    """a sin(50 t): the rope is nearly slack again and again, or slack in the first quarter of a period."""
    a = factor * G / 2500
    run = hoist(f"{a!r}*sin(50*t)")
    if factor < 1:
        goes_on(run, "rope")
    else:
        stops(run, math.asin(1 / factor) / 50, "rope", 2000 * G)


# ---- two ropes, two bodies -------------------------------------------------------------------------------------


def between_two(push: str, duration: float = 3.0) -> Study:
    """A kilogram at rest on two ropes, 1 m down and 0.5 m from either; pushed across, the one behind gets slack."""
    return study(
        HEAD
        + f"""
ground: {{points: {{A: [-0.5, 0, 0], B: [0.5, 0, 0]}}}}
bodies: {{b: {{mass: 1, center: [0, 0, -1], {SMALL}, points: {{c: [0, 0, -1]}}}}}}
joints:
  left: {{type: rod, from: ground.A, to: b.c, tension_only: true}}
  right: {{type: rod, from: ground.B, to: b.c, tension_only: true}}
forces: {{push: {{type: force, on: b.c, vector: ["{push}", 0, 0]}}}}
analysis: {{duration: {duration!r}, samples: 7}}
"""
    )


MOST = G / 2  # what may push across: the weight by the ropes' slope


@pytest.mark.parametrize(("push", "at", "rope"), [
    ("3*t", MOST / 3, "right"),
    ("-3*t", MOST / 3, "left"),
    ("0 if t < 1.25 else 9", 1.25, "right"),
    (f"{2 * MOST!r}*exp(-((t - 2)/0.01)**2)", 2 - 0.01 * math.sqrt(math.log(2)), "right"),
    (f"{2 * MOST!r}*exp(-((t - 2)/1e-5)**2)", 2 - 1e-5 * math.sqrt(math.log(2)), "right"),
    (f"{-1.000001 * MOST!r}*exp(-((t - 2)/1e-3)**2)", 2 - 1e-3 * math.sqrt(math.log(1.000001)), "left"),
    (f"{1.5 * MOST!r}*sin(t)", math.asin(1 / 1.5), "right"),
])  # fmt: skip
def test_two_ropes(push: str, at: float, rope: str) -> None:
    run = between_two(push)
    stops(run, at, rope, G)
    pulls(run, "left", "right", largest=G)


@pytest.mark.parametrize("push", ["0", f"{0.999999 * MOST!r}", f"{0.999999 * MOST!r}*exp(-((t - 2)/1e-4)**2)",
                                  f"{-0.999999 * MOST!r}*sin(40*t)"])  # fmt: skip
def test_two_ropes_hold(push: str) -> None:
    goes_on(between_two(push), "left", "right")


def towed(force: str, more: str = "", duration: float = 3.0, samples: int = 4) -> Study:
    """A tug of 3 kg tows a sledge of 1 kg along a line: the rope takes a quarter of its push."""
    return study(f"""
heun: 1
ground: {{points: {{O: [0, 0, 0]}}}}
bodies:
  sledge: {{mass: 1, center: [0, 0, 0], {SMALL}, points: {{c: [0, 0, 0]}}}}
  tug: {{mass: 3, center: [2, 0, 0], {SMALL}, points: {{c: [2, 0, 0]}}}}
joints:
  behind: {{type: slide, from: ground.O, to: sledge.c, axis: [1, 0, 0]}}
  ahead: {{type: slide, from: ground.O, to: tug.c, axis: [1, 0, 0], initial: {{speed: 1}}}}
  rope: {{type: rod, from: sledge.c, to: tug.c, tension_only: true}}
forces:
  push: {{type: torque, joint: ahead, value: "{force}"}}
{more}
analysis: {{duration: {duration!r}, samples: {samples}}}
""")


@pytest.mark.parametrize(("force", "at"), [
    ("8*cos(t)", math.pi / 2),
    ("8 if t < 1.3 else -1e-6", 1.3),
    # from 2 m on at 1 m/s by 2 m/s²: t + t² = 0.5 at the edge
    ("8 if ahead.travel < 2.5 else -1", (math.sqrt(3) - 1) / 2),
    ("8 - 9*step(ahead.travel - 2.5)*step(2.500001 - ahead.travel)", (math.sqrt(3) - 1) / 2),
    ("8 - 1e-3/1e-7*min(max(ahead.travel - 2.5, 0), 1e-4)", None),
    ("8 - 16*exp(-((t - 2.2)/1e-4)**2)", 2.2 - 1e-4 * math.sqrt(math.log(2))),
])  # fmt: skip
def test_a_rope_between_two_bodies(force: str, at: float | None) -> None:
    """Slack as soon as the tug is not pushed on, by whatever event."""
    run = towed(force)
    if at is None:
        goes_on(run, "rope")  # 7 N behind the edge
    else:
        stops(run, at, "rope", 2.0)


def test_a_bell_of_force_at_a_place_lets_the_rope_go() -> None:
    """8 - 16 exp(-((x - 2.5)/w)²): slack half a bell before its middle, in the place; the time by the speed there."""
    width = 1e-3
    run = towed(f"8 - 16*exp(-((ahead.travel - 2.5)/{width!r})**2)")
    place = 2.5 - width * math.sqrt(math.log(2))

    def speed(x: float) -> float:  # 2 u²: the work over 4 kg; of the bell by its integral
        bell = 16 * width * math.sqrt(math.pi) / 2 * math.erfc((2.5 - x) / width)
        return math.sqrt(1 + (8 * (x - 2) - bell) / 2)

    nodes, weights = np.polynomial.legendre.leggauss(40)
    at = 0.0
    for low, high in pairwise((2.0, 2.5 - 7 * width, 2.5 - 3 * width, place)):
        half = 0.5 * (high - low)
        at += sum(half * w / speed(low + half * (1 + x)) for x, w in zip(nodes.tolist(), weights.tolist(), strict=True))
    stops(run, at, "rope", 2.0)


def test_a_rope_without_load() -> None:
    """Nothing pulls, nothing pushes: the run goes on, and the rope carries nothing."""
    run = towed("0")
    goes_on(run, "rope") if run.results.status["code"] == "completed" else pytest.fail(str(run.results.status))
    near(run.results.joints["rope"]["tension"], 0.0, 1.0, 1e-14)


def test_slack_from_the_start() -> None:
    run = towed("-4*t - 1")
    assert run.results.status["code"] == "stopped"
    assert run.results.time.tolist() == [0.0]


def whirl(a: float, b: float, va: float, vb: float, duration: float) -> Study:
    """A bar on a pin, and a mass on a rope at its end; angles from below about -y, their rates."""

    def turn(angle: float) -> str:
        return f"orientation: {{axis: [0, 1, 0], angle: {-angle!r}}}"

    x, z = math.sin(a) + 0.8 * math.sin(b), -math.cos(a) - 0.8 * math.cos(b)
    vx = math.cos(a) * va + 0.8 * math.cos(b) * vb
    vz = math.sin(a) * va + 0.8 * math.sin(b) * vb
    return study(
        HEAD
        + f"""
ground: {{points: {{O: [0, 0, 0]}}}}
bodies:
  bar: {{mass: 1.5, center: [0, 0, -0.5], inertia: [0.125, 0.125, 0.01], {turn(a)},
    points: {{top: [0, 0, 0], end: [0, 0, -1]}}}}
  ball: {{mass: 0.6, center: [0, 0, 0], {SMALL}, points: {{c: [0, 0, 0]}}, position: [{x!r}, 0, {z!r}],
    velocity: [{vx!r}, 0, {vz!r}]}}
joints:
  pivot: {{type: pin, from: ground.O, to: bar.top, axis: [0, -1, 0], initial: {{rate: {va!r}}}}}
  rope: {{type: rod, from: bar.end, to: ball.c, tension_only: true}}
analysis: {{duration: {duration!r}, samples: 21, tolerance: 1e-11}}
"""
    )


def first_slack(a: float, b: float, va: float, vb: float, duration: float) -> float | None:
    """The same by Lagrange's equations in the two angles; the rope's pull by Newton's law for the ball."""
    m, M, r, inertia = 0.6, 1.5, 0.8, 0.125 + 1.5 * 0.25

    def rates(_: float, y: np.ndarray) -> np.ndarray:
        a, b, va, vb = y
        c, s = math.cos(a - b), math.sin(a - b)
        mass = np.array([[inertia + m, m * r * c], [m * r * c, m * r * r]])
        right = [-m * r * s * vb**2 - (M * 0.5 + m) * G * math.sin(a), m * r * s * va**2 - m * G * r * math.sin(b)]
        return np.array([va, vb, *np.linalg.solve(mass, right)])

    def tension(t: float, y: np.ndarray) -> float:
        a, b, va, vb = y
        wa = rates(t, y)[2]
        # the end's acceleration and gravity along the rope, towards the bar, and what turns the ball
        along = wa * math.sin(a - b) + va**2 * math.cos(a - b)
        return float(m * (r * vb**2 + along + G * math.cos(b)))

    tension.terminal = True  # type: ignore[attr-defined]
    start, digits = [a, b, va, vb], {"rtol": 1e-13, "atol": 1e-14}
    found = solve_ivp(rates, (0, duration), start, "DOP853", max_step=0.01, events=tension, **digits)
    return float(found.t_events[0][0]) if len(found.t_events[0]) else None


@pytest.mark.parametrize(
    "start", [(0.3, 0.2, 2.0, 5.0), (1.2, 0.7, 0.0, 0.0), (0.0, 0.0, 6.0, -2.0), (-0.5, 0.4, 3.0, 7.5)]
)
def test_a_ball_on_a_bar(start: tuple[float, float, float, float]) -> None:
    run, at = whirl(*start, 4.0), first_slack(*start, 4.0)
    if at is None:
        goes_on(run, "rope")
    else:
        stops(run, at, "rope", 10.0)


STRUCK = """
heun: 1
gravity: [0, 0, -9.81]
ground: {points: {O: [0, 0, 0]}}
bodies: {b: {mass: 2, center: [0, 0, -1], inertia: [0.1, 0.1, 0.1], points: {c: [0, 0, -1]}}}
joints: {j: {type: rod, from: ground.O, to: b.c, tension_only: true}}
"""


def test_a_rope_takes_a_blow_that_pulls_it_and_none_that_would_push() -> None:
    """Struck downwards it holds all of it; struck upwards the run ends before the blow, or does not begin."""
    down = "impulses: {blow: {on: b.c, vector: [0, 0, -3], time: TIME}}\n"
    up, run = down.replace("-3", "3"), "analysis: {duration: 0.5, samples: 6}\n"
    (blow,) = solved(STRUCK + down.replace("TIME", "0.1") + run).impulses
    near(blow["joints"]["j"]["tension"], 3.0, 3.0, 1e-14)
    near(blow["bodies"]["b"]["center_velocity_jump"], np.zeros(3), 1.0, 1e-14)
    found = solved(STRUCK + up.replace("TIME", "0.1") + run)
    assert found.status["code"] == "stopped"
    assert found.impulses == []
    near(found.time[-1], 0.1, 0.1, 1e-15)
    near(found.joints["j"]["tension"][-1], 2 * 9.81, 9.81, 1e-12)
    for text in (STRUCK + up.replace("TIME", "0") + run, STRUCK + up.replace("TIME", "0")):
        with pytest.raises(SolveError, match="the rod j would have to push"):
            solved(text)
