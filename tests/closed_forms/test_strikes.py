"""Stops that strike and ropes that catch, by hand: instants, impulses, energies, what bears at rest.

A ball from a height h falls t = √(2h/g), strikes at v = √(2gh) with the impulse m(1 + e)v, rises to e²h, and lies still
after t + (2v/g)(e + e² + ...) = t (1 + e)/(1 − e).
"""

from __future__ import annotations

import math

import numpy as np
import pytest
from scipy.optimize import brentq

from heuncli.study.queries.study import Study
from tests.shared.measured import measured
from tests.shared.scenes import near, study

pytestmark = pytest.mark.heavy  # families: the plain kernel has the same bits (tests/package/test_kernels_agree.py)

G = 9.81
INSTANT = 1e-10  # of the run
HEAD = f"heun: 1\ngravity: [0, 0, {-G}]\nground: {{points: {{O: [0, 0, 0]}}}}\n"
SMALL = "center: [0, 0, 0], inertia: [0.1, 0.1, 0.1], points: {c: [0, 0, 0]}"


def strikes(run: Study, *names: str) -> list[float]:
    """Instants of the blows of these contacts, of all if none is named."""
    return [float(b["time"]) for b in run.results.impulses if not names or set(names) & set(b["names"])]


def energy_never_grows(run: Study, at_one: bool = False) -> None:
    """Kinetic + potential − work over the whole run; (at_one) it stays."""
    for b in run.results.impulses:
        assert b["energy_jump"] <= 1e-12 * max(1.0, b["energy_before"]), b["names"]
        if at_one:
            assert abs(b["energy_jump"]) <= 1e-11 * max(1.0, b["energy_before"])


# ---- a ball on the floor
def ball(e: float, duration: float, h: float = 1.0, speed: float = 0.0, mass: float = 2.0, samples: int = 2) -> Study:
    start = f"{{travel: {h!r}, speed: {speed!r}}}"
    return study(
        HEAD
        + f"""
bodies: {{b: {{mass: {mass}, {SMALL}}}}}
joints: {{guide: {{type: slide, from: ground.O, to: b.c, axis: [0, 0, 1], initial: {start}}}}}
stops: {{floor: {{joint: guide, travel: [0, null], restitution: {e!r}}}}}
analysis: {{duration: {duration!r}, samples: {samples}}}
"""
    )


@pytest.mark.parametrize("e", [0.9, 0.5, 0.2])
def test_a_bouncing_ball(e: float) -> None:
    """Instants, impulses and heights of its first bounces; at rest after Zeno's time, and so it says."""
    fall, v = math.sqrt(2 / G), math.sqrt(2 * G)
    zeno = fall * (1 + e) / (1 - e)
    run = ball(e, zeno + 0.5)
    assert run.results.status["code"] == "completed"
    wanted = [fall + 2 * fall * sum(e**k for k in range(1, n + 1)) for n in range(10)]
    found = strikes(run)
    assert len(found) >= 9
    near(found[:8], wanted[:8], zeno, INSTANT)
    for n, block in enumerate(run.results.impulses[:8]):
        assert list(block["names"]) == ["floor"]
        near(block["stops"]["floor"]["force"], 2 * v * e**n * (1 + e), v, 1e-9)
        near(block["foundation"]["force"], (0, 0, -2 * v * e**n * (1 + e)), v, 1e-9)
        near(block["bodies"]["b"]["center_velocity_jump"], (0, 0, v * e**n * (1 + e)), v, 1e-9)
        near(block["energy_jump"], -(1 - e * e) * v * v * e ** (2 * n), v * v, 1e-9)
    tops = [t + v * e ** (n + 1) / G for n, t in enumerate(wanted[:9])]
    at_top = run.resample(np.array(tops))
    near(at_top.coordinates["guide"]["travel"], [e ** (2 * n + 2) for n in range(9)], 1.0, 1e-9)
    assert found[-1] <= zeno * (1 + 1e-9)
    rest = run.resample(np.linspace(zeno * (1 + 1e-6), zeno + 0.5, 11))
    near(rest.coordinates["guide"]["travel"], 0.0, 1.0, 1e-12)
    near(rest.coordinates["guide"]["speed"], 0.0, 1.0, 1e-9)
    near(rest.stops["floor"]["force"], 2 * G, 2 * G, 1e-9)
    near(rest.foundation["force"], (0, 0, -2 * G), 2 * G, 1e-9)
    energy_never_grows(run)


def test_without_restitution_it_lies_at_once() -> None:
    run = ball(0.0, 1.0)
    near(strikes(run), [math.sqrt(2 / G)], 1.0, INSTANT)
    after = run.resample(np.array([math.sqrt(2 / G) + 1e-6, 0.7, 1.0]))
    near(after.coordinates["guide"]["travel"], 0.0, 1.0, 1e-12)
    near(after.stops["floor"]["force"], 2 * G, 2 * G, 1e-12)
    before = run.resample(np.array([0.0, 0.3]))
    near(before.stops["floor"]["force"], 0.0, 1.0, 0.0)


def test_with_all_of_it_it_never_rests() -> None:
    """Ten seconds, 11 bounces to the same height."""
    run = ball(1.0, 10.0)
    fall = math.sqrt(2 / G)
    wanted = [fall * (1 + 2 * k) for k in range(20) if fall * (1 + 2 * k) <= 10.0]
    near(strikes(run), wanted, 10.0, INSTANT)
    tops = run.resample(np.array([2 * fall * k for k in range(1, 11)]))
    near(tops.coordinates["guide"]["travel"], 1.0, 1.0, 1e-9)
    energy_never_grows(run, at_one=True)
    assert measured(run, "min coordinates.guide.travel")["value"] == pytest.approx(0.0, abs=1e-12)
    assert measured(run, "max coordinates.guide.speed")["value"] == pytest.approx(math.sqrt(2 * G), rel=1e-9)
    assert measured(run, "min coordinates.guide.speed")["value"] == pytest.approx(-math.sqrt(2 * G), rel=1e-9)


def test_just_before_and_at_a_strike() -> None:
    """One double before it the ball comes; at it, it goes."""
    run = ball(0.5, 0.6)
    (t,) = strikes(run)
    found = run.resample(np.array([math.nextafter(t, 0.0), t])).coordinates["guide"]["speed"]
    near(found, (-math.sqrt(2 * G), 0.5 * math.sqrt(2 * G)), 5.0, 1e-9)


@pytest.mark.parametrize("samples", [2, 7, 1001])
def test_samples_do_not_change_a_bounce(samples: int) -> None:
    one, other = ball(0.7, 2.0), ball(0.7, 2.0, samples=samples)
    assert strikes(one) == strikes(other)
    assert one.results.coordinates["guide"]["travel"][-1] == other.results.coordinates["guide"]["travel"][-1]


@pytest.mark.parametrize("h", [1e-3, 1.0, 1e3])
def test_of_any_size(h: float) -> None:
    e = 0.6
    fall = math.sqrt(2 * h / G)
    run = ball(e, 3 * fall, h)
    wanted = [t for t in (fall + 2 * fall * sum(e**k for k in range(1, n + 1)) for n in range(30)) if t <= 3 * fall]
    near(strikes(run)[: len(wanted)][:5], wanted[:5], fall, INSTANT)


def test_lying_at_the_start() -> None:
    """As a motion and as an instant: the floor bears the weight; nothing is struck."""
    run = ball(0.5, 1.0, h=0.0)
    assert strikes(run) == []
    near(run.results.stops["floor"]["force"], 2 * G, 2 * G, 1e-12)
    near(run.results.foundation["supports"]["guide"]["force"], np.zeros(3), 1.0, 1e-12)
    near(run.results.foundation["elements"]["floor"]["force"], (0, 0, -2 * G), 2 * G, 1e-12)
    near(run.results.foundation["force"], (0, 0, -2 * G), 2 * G, 1e-12)


def test_thrown_into_the_floor_at_the_start() -> None:
    """Touching and closing at t = 0: struck there."""
    run = ball(0.5, 0.1, h=0.0, speed=-3.0)
    assert strikes(run)[0] == 0.0
    near(run.results.coordinates["guide"]["speed"][0], 1.5, 1.5, 1e-12)
    near(run.results.impulses[0]["stops"]["floor"]["force"], 2 * 4.5, 9.0, 1e-12)


# ---- a mass on a rope
def thrown(e: float, speed: float, duration: float) -> Study:
    """Hung on 2 m of rope, thrown up."""
    return study(
        HEAD
        + f"""
bodies: {{b: {{mass: 3, {SMALL}, position: [0, 0, -2], velocity: [0, 0, {speed!r}]}}}}
joints: {{rope: {{type: rod, from: ground.O, to: b.c, tension_only: true, restitution: {e!r}}}}}
analysis: {{duration: {duration!r}, samples: 2}}
"""
    )


@pytest.mark.parametrize("e", [0.0, 0.3, 1.0])
def test_a_mass_thrown_up_on_a_rope(e: float) -> None:
    """Slack at once; flies 2v/g, caught with m(1 + e)v, flies again; hangs in the end."""
    v, duration = 4.0, 3.0
    run = thrown(e, v, duration)
    found = strikes(run, "rope")
    count = 8 if e else 1
    caught = np.cumsum([2 * v / G * e**k for k in range(count)])
    wanted = caught[caught < duration]
    near(found[: len(wanted)], wanted, duration, INSTANT)
    for k, b in enumerate(run.results.impulses[: len(wanted)]):
        near(b["joints"]["rope"]["tension"], 3 * (1 + e) * v * e**k, 3 * v * e**k, 1e-8)
    mid = run.resample(np.array([v / G]))
    near(mid.bodies["b"]["center"][0, 2], -2 + v * v / (2 * G), 2.0, 1e-9)
    near(mid.joints["rope"]["tension"][0], 0.0, 1.0, 0.0)
    if e < 1:
        near(run.results.joints["rope"]["tension"][-1], 3 * G, 3 * G, 1e-6 if e else 1e-12)
    energy_never_grows(run, at_one=e == 1)


def test_a_throw_caught_aslant() -> None:
    """Along the rope the speed turns round times e, across it stays."""
    run = study(
        HEAD
        + f"""
bodies: {{b: {{mass: 3, {SMALL}, position: [0.5, 0, -0.2], velocity: [2, 1, 3]}}}}
joints: {{rope: {{type: rod, from: ground.O, to: b.c, length: 1.5, tension_only: true, restitution: 0.4}}}}
analysis: {{duration: 2, samples: 2}}
"""
    )
    x0, v0, g = np.array([0.5, 0, -0.2]), np.array([2.0, 1, 3]), np.array([0, 0, -G])

    def place(t: float) -> np.ndarray:
        return np.asarray(x0 + v0 * t + 0.5 * g * t * t)

    at = brentq(lambda t: np.linalg.norm(place(t)) - 1.5, 0.0, 0.6, xtol=1e-15)
    near(strikes(run)[0], at, 2.0, INSTANT)
    x, v = place(at), v0 + g * at
    n = x / np.linalg.norm(x)
    near(run.results.impulses[0]["bodies"]["b"]["center_velocity_jump"], -1.4 * (v @ n) * n, 5.0, 1e-9)
    near(run.results.impulses[0]["joints"]["rope"]["tension"], 3 * 1.4 * (v @ n), 10.0, 1e-9)
    found = run.resample(np.array([math.nextafter(at, 0.0), strikes(run)[0]])).bodies["b"]["center_velocity"]
    near(found[1], v - 1.4 * (v @ n) * n, 5.0, 1e-9)
    energy_never_grows(run)


def test_it_comes_taut_without_a_blow_where_it_swings_in() -> None:
    """A pendulum out of its circle flies and is caught: the rope's length is never exceeded."""
    run = study(
        HEAD
        + f"""
bodies: {{b: {{mass: 2, {SMALL}, position: [0, 0, -1], velocity: [{math.sqrt(3.5 * G)!r}, 0, 0]}}}}
joints: {{rope: {{type: rod, from: ground.O, to: b.c, tension_only: true, restitution: 0.2}}}}
analysis: {{duration: 5, samples: 2}}
"""
    )
    found = run.resample(np.linspace(0, 5, 2001))
    assert np.linalg.norm(found.bodies["b"]["center"], axis=1).max() <= 1 + 1e-9
    assert found.joints["rope"]["tension"].min() >= -1e-9
    assert len(strikes(run)) >= 1
    cos = -(3.5 - 2) / 3  # where it comes slack (test_ropes.py): from there on a parabola, back on the circle
    v = math.sqrt(-G * cos)
    x, w = np.array([math.sqrt(1 - cos**2), -cos]), v * np.array([cos, math.sqrt(1 - cos**2)])
    caught = brentq(lambda t: np.linalg.norm(x + w * t - np.array([0, G / 2 * t * t])) - 1, 0.1, 2, xtol=1e-15)
    tension = found.joints["rope"]["tension"]
    slack = found.time[np.flatnonzero(tension <= 0)[0]]
    assert strikes(run)[0] - slack == pytest.approx(caught, abs=5 / 2000 + 1e-9)
    energy_never_grows(run)


# ---- what is held and let go
def test_a_stop_is_let_go_when_the_torque_turns() -> None:
    """A wheel held against a stop by -3 cos t N m until cos changes its sign; ω = ∫ from there."""
    run = study(f"""
heun: 1
ground: {{points: {{O: [0, 0, 0]}}}}
bodies: {{w: {{mass: 1, center: [0, 0, 0], inertia: [1, 1, 2], points: {{o: [0, 0, 0]}}}}}}
joints: {{shaft: {{type: pin, from: ground.O, to: w.o, axis: [0, 0, 1], initial: {{angle: 0.5, rate: 0}}}}}}
stops: {{pawl: {{joint: shaft, angle: [0.5, null], restitution: 0.3}}}}
forces: {{motor: {{type: torque, joint: shaft, value: "-3*cos(t)"}}}}
analysis: {{duration: {1.3 * math.pi!r}, samples: 2}}
""")
    assert strikes(run) == []
    t = np.array([0.0, 1.0, 1.5, 1.6, 2.0, 4.0])
    found = run.resample(t)
    held = np.maximum(3 * np.cos(t), 0.0) * (t < math.pi / 2)
    near(found.stops["pawl"]["moment"], held, 3.0, 1e-9)
    near(found.foundation["moment"][:, 2], -held + 3 * np.cos(t), 3.0, 1e-9)
    free = t > math.pi / 2
    near(found.coordinates["shaft"]["rate"], np.where(free, 1.5 * (1 - np.sin(t)), 0.0), 3.0, 1e-9)
    angle = 0.5 + np.where(free, 1.5 * (t - math.pi / 2 + np.cos(t)), 0.0)
    near(found.coordinates["shaft"]["angle"], angle, 3.0, 1e-9)


def test_a_torque_that_jumps_lets_go_at_once() -> None:
    run = study("""
heun: 1
ground: {points: {O: [0, 0, 0]}}
bodies: {w: {mass: 1, center: [0, 0, 0], inertia: [1, 1, 2], points: {o: [0, 0, 0]}}}
joints: {shaft: {type: pin, from: ground.O, to: w.o, axis: [0, 0, 1], initial: {angle: 0, rate: 0}}}
stops: {pawl: {joint: shaft, angle: [0, null], restitution: 0}}
forces: {motor: {type: torque, joint: shaft, value: "-3 if t < 1 else 4"}}
analysis: {times: [0, 0.5, 1, 2, 3]}
""").results
    near(run.coordinates["shaft"]["angle"], (0, 0, 0, 1, 4), 4.0, 1e-10)
    near(run.stops["pawl"]["moment"], (3, 3, 0, 0, 0), 3.0, 1e-12)


def test_a_shaken_table_throws_its_block() -> None:
    """A sin ωt shakes a block off where A ω² sin ωt = g; it flies, lands (e = 0), and is thrown again."""
    A, w = 0.05, 20.0
    run = study(
        HEAD
        + f"""
bodies: {{table: {{mass: 10, {SMALL}}}, b: {{mass: 2, {SMALL}}}}}
joints:
  shaker: {{type: slide, from: ground.O, to: table.c, axis: [0, 0, 1]}}
  on: {{type: slide, from: table.c, to: b.c, axis: [0, 0, 1]}}
drives: {{shake: {{joint: shaker, travel: "{A}*sin({w}*t)"}}}}
stops: {{lie: {{joint: on, travel: [0, null], restitution: 0}}}}
analysis: {{duration: 0.5, samples: 2}}
"""
    )
    off = math.asin(G / (A * w * w)) / w
    z0, v0 = A * math.sin(w * off), A * w * math.cos(w * off)

    def above(t: float) -> float:
        return z0 + v0 * (t - off) - G / 2 * (t - off) ** 2 - A * math.sin(w * t)

    land = brentq(above, off + 0.05, off + 0.3, xtol=1e-15)
    near(strikes(run)[0], land, 0.5, 1e-9)
    speed = v0 - G * (land - off) - A * w * math.cos(w * land)
    near(run.results.impulses[0]["stops"]["lie"]["force"], -2 * speed, 2.0, 1e-8)
    near(run.results.impulses[0]["joints"]["shaker"]["drive"], -2 * speed, 2.0, 1e-8)
    t = np.array([0.2 * off, off * (1 - 1e-6), off * (1 + 1e-6), (off + land) / 2])
    found = run.resample(t)
    push = np.where(t < off, 2 * (G - A * w * w * np.sin(w * t)), 0.0)
    near(found.stops["lie"]["force"], push, 2 * G, 1e-9)
    near(found.coordinates["on"]["travel"][3], above(float(t[3])), 0.1, 1e-9)


# ---- several
def test_two_at_one_instant() -> None:
    """Two blocks fall from the same height, each on its own floor: each with its own impulse."""
    run = study(
        HEAD
        + f"""
bodies: {{a: {{mass: 2, {SMALL}}}, b: {{mass: 5, {SMALL}}}}}
joints:
  one: {{type: slide, from: ground.O, to: a.c, axis: [0, 0, 1], initial: {{travel: 1}}}}
  two: {{type: slide, from: {{body: ground, at: [1, 0, 0]}}, to: b.c, axis: [0, 0, 1], initial: {{travel: 1}}}}
stops:
  p: {{joint: one, travel: [0, null], restitution: 0.5}}
  q: {{joint: two, travel: [0, null], restitution: 0.25}}
analysis: {{duration: 0.6, samples: 2}}
"""
    )
    v = math.sqrt(2 * G)
    first = run.results.impulses[0]
    near(strikes(run)[0], v / G, 1.0, INSTANT)
    near([first["bodies"][b]["center_velocity_jump"][2] for b in "ab"],
         [1.5 * v, 1.25 * v] if len(first["names"]) == 2 else [1.5 * v, 0.0], v, 1e-9)  # fmt: skip
    assert strikes(run, "p")[0] == pytest.approx(strikes(run, "q")[0], abs=1e-12)


CRADLE = """
heun: 1
gravity: [0, 0, -9.81]
ground: {{points: {{{anchors}}}}}
bodies:
{bodies}
joints:
{joints}
stops:
{stops}
analysis: {{duration: {duration}, samples: 2, tolerance: 1e-11}}
"""


def cradle(n: int, gap: float, speed: float, duration: float, e: float = 1.0, d: float = 0.1) -> Study:
    """Balls of 1 kg on ropes of 1 m, `gap` between them, the first one pushed towards the others."""
    at = [k * (d + gap) for k in range(n)]
    point = "mass: 1, center: [0, 0, 0], inertia: [0, 0, 0], points: {c: [0, 0, 0]}"
    bodies = "\n".join(f"  b{k}: {{{point}, position: [{x!r}, 0, -1], velocity: [{speed if k == 0 else 0.0}, 0, 0]}}"
                       for k, x in enumerate(at))  # fmt: skip
    joints = "\n".join(f"  rope{k}: {{type: rod, from: ground.A{k}, to: b{k}.c, tension_only: true}}" for k in range(n))
    joints += "".join(f"\n  gap{k}: {{type: rod, from: b{k - 1}.c, to: b{k}.c}}" for k in range(1, n))
    stops = "\n".join(f"  hit{k}: {{joint: gap{k}, length: [{d!r}, null], restitution: {e!r}}}" for k in range(1, n))
    anchors = ", ".join(f"A{k}: [{x!r}, 0, 0]" for k, x in enumerate(at))
    return study(CRADLE.format(anchors=anchors, bodies=bodies, joints=joints, stops=stops, duration=duration))


@pytest.mark.parametrize("n", [2, 3, 5])
def test_a_cradle_with_gaps_passes_one_ball_on(n: int) -> None:
    """One after the other; the last one rises as high as the first one would, the others hardly move."""
    gap, speed = 1e-3, 1.0
    run = cradle(n, gap, speed, 0.6)
    assert strikes(run)[: n - 1] == sorted(strikes(run)[: n - 1])
    assert [list(b["names"]) for b in run.results.impulses[: n - 1]] == [[f"hit{k}"] for k in range(1, n)]
    rises = run.resample(np.linspace(0, 0.6, 601)).bodies
    top = speed**2 / (2 * G)
    assert float(rises[f"b{n - 1}"]["center"][:, 2].max()) + 1 == pytest.approx(top, rel=0.02)
    for k in range(n - 1):
        assert float(rises[f"b{k}"]["center"][:, 2].max()) + 1 < 0.05 * top
    energy_never_grows(run, at_one=True)
    e = run.resample(np.linspace(0, 0.6, 61)).energy
    near(e["kinetic"] + e["potential"], e["kinetic"][0] + e["potential"][0], 0.5, 1e-9)


@pytest.mark.parametrize("e", [1.0, 0.5, 0.0])
@pytest.mark.parametrize("n", [2, 3, 4])
def test_a_cradle_that_touches(n: int, e: float) -> None:
    """Newton's law for all at once: v − (1 + e)v(n − 1)/n, and (1 + e)v/n for all others."""
    run = cradle(n, 0.0, 1.0, 0.05, e)
    first = run.results.impulses[0]
    assert first["time"] == 0.0
    jumps = [first["bodies"][f"b{k}"]["center_velocity_jump"][0] for k in range(n)]
    near(jumps, [-(1 + e) * (n - 1) / n, *[(1 + e) / n] * (n - 1)], 1.0, 1e-9)
    pushes = [first["stops"][f"hit{k}"]["force"] for k in range(1, n)]
    near(pushes, [(1 + e) * (n - k) / n for k in range(1, n)], 1.0, 1e-9)
    energy_never_grows(run, at_one=e == 1.0)


def test_a_door_against_its_stop() -> None:
    """Swung shut at 2 rad/s: the couple of its stop, and what its hinge takes of it."""
    text = """
heun: 1
ground: {{points: {{O: [0, 0, 0]}}}}
bodies:
  door: {{shapes: [{{type: rod, from: [0, 0, 0], to: [0.9, 0, 0], mass: 12}}], points: {{o: [0, 0, 0]}}}}
joints: {{hinge: {{type: pin, from: ground.O, to: door.o, axis: [0, 0, 1], initial: {{angle: 1, rate: -2}}}}}}
stops: {{frame: {{joint: hinge, angle: [0, null], restitution: 0.4}}}}
analysis: {{duration: 1, samples: 2}}
"""
    run = study(text.format())
    near(strikes(run)[0], 0.5, 1.0, INSTANT)
    J = 12 * 0.81 / 3
    block = run.results.impulses[0]
    near(block["stops"]["frame"]["moment"], J * 2.8, 10.0, 1e-10)
    near(block["joints"]["hinge"]["force"], (0, 12 * 0.45 * 2.8, 0), 15.0, 1e-9)
    near(run.results.coordinates["hinge"]["rate"][-1], 0.8, 1.0, 1e-10)
    near(run.results.coordinates["hinge"]["angle"][-1], 0.4, 1.0, 1e-10)


def test_between_two_stops() -> None:
    """To and fro without loss: instants by counting."""
    run = study(f"""
heun: 1
ground: {{points: {{O: [0, 0, 0]}}}}
bodies: {{b: {{mass: 2, {SMALL}}}}}
joints: {{guide: {{type: slide, from: ground.O, to: b.c, axis: [1, 0, 0], initial: {{travel: 0.1, speed: 3}}}}}}
stops: {{walls: {{joint: guide, travel: [0, 0.4], restitution: 1}}}}
analysis: {{duration: 5, samples: 2}}
""")
    wanted = [0.1 + 0.4 / 3 * k for k in range(100) if 0.1 + 0.4 / 3 * k <= 5]
    near(strikes(run), wanted, 5.0, INSTANT)
    forces = [float(b["stops"]["walls"]["force"]) for b in run.results.impulses]
    near(forces, [-12.0 if k % 2 == 0 else 12.0 for k in range(len(forces))], 12.0, 1e-10)


@pytest.mark.parametrize("swapped", [False, True])
def test_a_strike_on_what_rests(swapped: bool) -> None:
    """A block falls on one that lies on the floor: it rebounds with e v, the other lies, the floor takes all of it.

    Also told the other way round: the upper one's slide from it to the lower one.
    """
    ends = "from: b.c, to: a.c" if swapped else "from: a.c, to: b.c"
    limits, start = ("[null, 0]", -0.5) if swapped else ("[0, null]", 0.5)
    run = study(
        HEAD
        + f"""
bodies: {{a: {{mass: 3, {SMALL}}}, b: {{mass: 2, {SMALL}}}}}
joints:
  low: {{type: slide, from: ground.O, to: a.c, axis: [0, 0, 1], initial: {{travel: 0}}}}
  on: {{type: slide, {ends}, axis: [0, 0, 1], initial: {{travel: {start}}}}}
stops:
  floor: {{joint: low, travel: [0, null], restitution: 0.7}}
  top: {{joint: on, travel: {limits}, restitution: 0.4}}
analysis: {{duration: 1.6, samples: 2}}
"""
    )
    v = math.sqrt(G)
    near(strikes(run)[0], 1 / v, 1.6, INSTANT)
    for n in range(5):
        block = run.results.impulses[n]
        near(block["bodies"]["b"]["center_velocity_jump"][2], 1.4 * v * 0.4**n, v, 1e-9)
        near(block["bodies"]["a"]["center_velocity_jump"], np.zeros(3), v, 1e-12)
        near(block["foundation"]["force"][2], -2 * 1.4 * v * 0.4**n, 2 * v, 1e-9)
        near(block["energy_jump"], -(1 - 0.16) * v * v * 0.16**n, v * v, 1e-9)
    near(run.results.bodies["b"]["center"][-1], np.zeros(3), 1.0, 1e-9)
    near(run.results.stops["floor"]["force"][-1], 5 * G, 5 * G, 1e-9)
    near(run.results.stops["top"]["force"][-1], -2 * G if swapped else 2 * G, 5 * G, 1e-9)


# ---- given blows on what rests
def hit_on_the_floor(impulse: float, analysis: str = "duration: 1.5, samples: 2", time: float = 0.5) -> Study:
    return study(
        HEAD
        + f"""
bodies: {{b: {{mass: 2, {SMALL}}}}}
joints: {{guide: {{type: slide, from: ground.O, to: b.c, axis: [0, 0, 1], initial: {{travel: 0}}}}}}
stops: {{floor: {{joint: guide, travel: [0, null], restitution: 0.5}}}}
impulses: {{hammer: {{on: b.c, vector: [0, 0, {impulse}], time: {time}}}}}
analysis: {{{analysis}}}
"""
    )


@pytest.mark.parametrize("analysis", ["duration: 1.5, samples: 2", "type: impulse"])
def test_a_hammer_presses_what_lies(analysis: str) -> None:
    """What rests is not struck: the floor takes the blow, nothing moves."""
    run = hit_on_the_floor(-3.0, analysis, 0.0 if "type" in analysis else 0.5)
    (block,) = run.results.impulses
    near(block["bodies"]["b"]["center_velocity_jump"], np.zeros(3), 1.0, 1e-12)
    near(block["stops"]["floor"]["force"], 3.0, 3.0, 1e-12)
    near(block["foundation"]["force"], (0, 0, -3), 3.0, 1e-12)
    near(block["energy_jump"], 0.0, 1.0, 1e-12)


def test_a_hammer_lifts_what_lies() -> None:
    """It flies, and is struck when it is back."""
    run = hit_on_the_floor(3.0)
    first, second = run.results.impulses[:2]
    near(first["bodies"]["b"]["center_velocity_jump"], (0, 0, 1.5), 1.0, 1e-12)
    near(first["foundation"]["force"], np.zeros(3), 1.0, 1e-12)
    near(second["time"], 0.5 + 3.0 / G, 1.5, INSTANT)
    near(second["stops"]["floor"]["force"], 2 * 1.5 * 1.5, 4.5, 1e-9)


def test_a_blow_at_the_instant_of_a_strike() -> None:
    """Given for the instant at which the ball comes: both together, the ball is met by e v once."""
    fall, v = math.sqrt(2 / G), math.sqrt(2 * G)
    for dt in (-1e-9, 0.0, 1e-9):
        run = study(
            HEAD
            + f"""
bodies: {{b: {{mass: 2, {SMALL}}}}}
joints: {{guide: {{type: slide, from: ground.O, to: b.c, axis: [0, 0, 1], initial: {{travel: 1}}}}}}
stops: {{floor: {{joint: guide, travel: [0, null], restitution: 0.5}}}}
impulses: {{hammer: {{on: b.c, vector: [0, 0, -3], time: {fall + dt!r}}}}}
analysis: {{times: [0, {fall + 1e-3!r}], tolerance: 1e-12}}
"""
        )
        total = sum(b["bodies"]["b"]["center_velocity_jump"][2] for b in run.results.impulses)
        # before it comes faster; at it the floor bears both; behind it is slowed, or struck anew
        allowed = [0.5 * (v + 1.5), 0.5 * v, 0.5 * v - 1.5, 0.5 * abs(0.5 * v - 1.5)]
        assert any(abs(total - v - a) < 1e-6 for a in allowed), (dt, total - v, allowed)
        for b in run.results.impulses:
            assert float(b.get("stops", {}).get("floor", {}).get("force", 0.0)) >= 0.0
        assert run.results.coordinates["guide"]["travel"][-1] >= -1e-12


# ---- a series of cuts in what is struck
def test_a_cut_in_a_ball_that_strikes() -> None:
    """A bar falls end on: N at a cut is the momentum of what is above it, which is pressed."""
    run = study(
        HEAD
        + """
bodies: {b: {shapes: [{type: rod, from: [0, 0, 0], to: [0, 0, 1], mass: 2}], points: {c: [0, 0, 0], d: [0, 0, 1]}}}
joints: {guide: {type: slide, from: ground.O, to: b.c, axis: [0, 0, 1], initial: {travel: 0.5}}}
stops: {floor: {joint: guide, travel: [0, null], restitution: 0.2}}
sections: {run: {body: b, from: c, to: d, count: 5}}
analysis: {duration: 1.0, samples: 2}
"""
    )
    v = math.sqrt(G)
    block = run.results.impulses[0]
    s = np.asarray(block["sections"]["run"]["s"], dtype=float)
    near(block["sections"]["run"]["N"], -2 * (1 - s) * 1.2 * v, 2 * v, 1e-9)
    near(run.results.sections["run"]["N"][-1], -2 * (1 - s) * G, 2 * G, 1e-6)


def test_a_blow_on_an_arch_that_cannot_move() -> None:
    """Three pins hold two bars; the supports bear the blow between them, and its energies are rounding of nothing."""
    found = study("""
heun: 1
ground: {points: {A: [0, 0, 0], C: [1.37, 0.13, 0]}}
bodies:
  a: {shapes: [{type: rod, from: [0, 0, 0], to: [0.613, 0.711, 0], mass: 1.3}],
      points: {l: [0, 0, 0], r: [0.613, 0.711, 0]}}
  b: {shapes: [{type: rod, from: [0.613, 0.711, 0], to: [1.37, 0.13, 0], mass: 0.7}],
      points: {l: [0.613, 0.711, 0], r: [1.37, 0.13, 0], m: [1, 0.41397226948, 0]}}
joints:
  A: {type: pin, from: ground.A, to: a.l, axis: [0, 0, 1]}
  B: {type: pin, from: a.r, to: b.l, axis: [0, 0, 1]}
  C: {type: pin, from: ground.C, to: b.r, axis: [0, 0, 1]}
stops: {s: {joint: A, angle: [-0.1, 0.1], restitution: 0.5}}
impulses: {h: {on: b.m, vector: [0.317, -1.913, 0], time: 0.1}}
analysis: {times: [0, 0.1, 0.2]}
""").results
    force = found.impulses[0]["foundation"]["force"]
    near(force, [0.317, -1.913, 0.0], 2.0, 1e-14)
    # bar a has the line through its pins: its support bears along that line alone
    along = found.impulses[0]["foundation"]["supports"]["A"]["force"][:2]
    near(along[0] * 0.711 - along[1] * 0.613, 0.0, 2.0, 1e-13)
    assert found.accuracy["energy_drift"] == 0.0
