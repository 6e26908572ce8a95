"""Loads that begin, end or bend at a place: no step passes over it, however short the span and long the step.

Against the energy at each place and the passage by quadrature (tests/shared/one_freedom), or the motion's own formula.
"""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np
import pytest
from scipy.interpolate import CubicSpline, PchipInterpolator

from heuncli.results.results import Array
from heuncli.study.queries.measure import find_peak
from tests.shared.one_freedom import Law, One, Passage, around, follows, moved, passes
from tests.shared.scenes import near, solved, study

pytestmark = pytest.mark.heavy  # families: the plain kernel has the same bits (tests/package/test_kernels_agree.py)

TRACK = "duration: 5, samples: 2"
FINE = "duration: 5, samples: 101"


def track(load: str, analysis: str = TRACK, tables: str = "") -> One:
    """600 kg at 12 m/s."""
    return One(600.0, {"load": load}, 0.0, 12.0, analysis, tables=tables)


def window(low: float, high: float, value: float) -> Law:
    return lambda x: np.where((x > low) & (x < high), value, 0.0)


@pytest.mark.parametrize("analysis", [TRACK, FINE, "duration: 500, samples: 2", "times: [0, 1.7, 1.75, 1.8, 30]"])
@pytest.mark.parametrize("brake", [
    "-4000 if 20 < guide.travel < 22 else 0",
    "-4000 if guide.travel > 20 and guide.travel < 22 else 0",
    "0 if guide.travel < 20 or guide.travel > 22 else -4000",
    "-4000*(step(guide.travel - 20) - step(guide.travel - 22))",
    "-4000*step(guide.travel - 20)*step(22 - guide.travel)",
    "-4000 if abs(guide.travel - 21) < 1 else 0",
    "-2000*(sign(guide.travel - 20) + sign(22 - guide.travel))",
    "-4000 if not (min(guide.travel - 20, 22 - guide.travel) < 0) else 0",
    "(0 if guide.travel > 22 else -4000) if guide.travel > 20 else 0",
])  # fmt: skip
def test_a_brake_on_two_metres_of_track(brake: str, analysis: str) -> None:
    """12 m/s less 8 kJ: the root of 144 - 2 * 4000 * 2/600, 10.83205 m/s."""
    found = passes(track(brake, analysis), window(20, 22, -4000.0), [20, 22, 7000])
    near(found.u[-1], math.sqrt(144 - 80 / 3), 12.0, 1e-10)
    near(found.run.results.energy["work"][-1], -8000.0, 43200.0, 1e-10)


@pytest.mark.parametrize("start", [-40.0, 1.0, 2.0, 4.0, 6.0, 8.0, 19.9999])
def test_a_brake_from_wherever(start: float) -> None:
    """Steps fall otherwise, the speed is the same."""
    found = moved(track("-4000 if 20 < guide.travel < 22 else 0", "duration: 500, samples: 2")._replace(start=start))
    near(found.u[-1], math.sqrt(144 - 80 / 3), 12.0, 1e-10)
    before, within = (20 - start) / 12, (12 - math.sqrt(144 - 80 / 3)) / (4000 / 600)
    x = 22 + (500 - before - within) * math.sqrt(144 - 80 / 3)
    assert abs(found.x[-1] - x) <= found.error


@pytest.mark.parametrize("width", [1.0, 1e-2, 1e-4, 1e-6, 1e-8])
def test_a_brake_however_short(width: float) -> None:
    """The same work on less and less track."""
    low, high = 20.0, 20.0 + width
    force = -8000.0 / width
    found = moved(track(f"{force!r} if guide.travel > {low!r} and guide.travel < {high!r} else 0"))
    work = force * (high - low)  # of the numbers as they are written
    digits = 1e-8 + 2 * math.ulp(high) / width  # both edges are met to rounding
    near(found.u[-1], math.sqrt(144 + work / 300), 12.0, digits)
    near(found.run.results.energy["work"][-1], work, 43200.0, digits)
    after = 5.0 - 20 / 12 - width / 11.4
    assert abs(found.x[-1] - high - after * found.u[-1]) <= found.error + width


BENT: list[tuple[str, Law, list[float]]] = [
    ("-4000*min(max(guide.travel - 20, 0), max(22 - guide.travel, 0))",
     lambda x: -4000 * np.minimum(np.maximum(x - 20, 0), np.maximum(22 - x, 0)), [20, 21, 22]),
    ("-30*abs(abs(guide.travel - 21) - 1)", lambda x: -30 * np.abs(np.abs(x - 21) - 1), [20, 21, 22]),
    ("max(-400, -5*guide.travel**2)", lambda x: np.maximum(-400, -5 * x * x), [math.sqrt(80)]),
    ("-3000*max(0, 1 - (guide.travel - 21)**2)", lambda x: -3000 * np.maximum(0, 1 - (x - 21) ** 2), [20, 22]),
    ("-500*max(0, sin(pi*guide.travel))", lambda x: -500 * np.maximum(0, np.sin(np.pi * x)), list(range(61))),
    ("-400*(1 if sin(pi*guide.travel/2) > 0.5 else (-1 if sin(pi*guide.travel/2) < -0.5 else 0))",
     lambda x: -400 * np.where(np.sin(np.pi * x / 2) > 0.5, 1, np.where(np.sin(np.pi * x / 2) < -0.5, -1, 0)),
     [k + s for k in range(0, 62, 2) for s in (1 / 3, 5 / 3)]),
    ("-(9e6 if guide.travel > 10 else 0) + (9e6 if guide.travel > 10.001 else 0) - 500*step(guide.travel - 10.0011)",
     lambda x: np.where(x > 10, -9e6, 0) + np.where(x > 10.001, 9e6, 0) + np.where(x > 10.0011, -500, 0),
     [10, 10.001, 10.0011]),
    ("hypot(-3*guide.travel, 4) - 50*(guide.travel - 15)*step(guide.travel - 15)",
     lambda x: np.hypot(3 * x, 4) - 50 * np.maximum(x - 15, 0), [0, 0.5, 1, 1.5, 2, 3, 5, 8, 15]),
]  # fmt: skip


@pytest.mark.parametrize("analysis", [TRACK, FINE])
@pytest.mark.parametrize("row", BENT, ids=[row[0] for row in BENT])
def test_loads_that_bend(row: tuple[str, Law, list[float]], analysis: str) -> None:
    """abs, min, max, step, conditions in one another."""
    load, force, marks = row
    passes(track(load, analysis), force, [*marks, 80.0])


def law_of(kind: str, x: Sequence[float], y: Sequence[float], periodic: bool = False) -> Law:
    """The curve through the knots, by SciPy."""
    if kind == "linear":
        return lambda at: np.interp(at, x, y)
    if kind == "pchip" and periodic:
        span, n = x[-1] - x[0], len(x) - 1
        xs = [v + k * span for k in (-1, 0, 1) for v in x[:n]] + [x[-1] + span]
        return PchipInterpolator(xs, [*y[:n]] * 3 + [y[0]])
    if kind == "pchip":
        return PchipInterpolator(x, y)
    return CubicSpline(x, y, bc_type="periodic" if periodic else "not-a-knot")


BUFFER = ([20.0, 20.1, 20.5, 20.52, 22.0, 23.0], [0.0, -5000.0, -1000.0, -9000.0, -2000.0, 0.0])
SMOOTH = ([20.0, 20.1, 20.2, 20.35, 20.5, 20.6], [0.0, -900.0, -5000.0, -4000.0, -9000.0, 0.0])


@pytest.mark.parametrize("kind", ["linear", "pchip", "cubic"])
@pytest.mark.parametrize("analysis", [TRACK, FINE])
def test_a_table_of_places(kind: str, analysis: str) -> None:
    """A damper's force by its knots, held outside: nothing there."""
    x, y = SMOOTH if kind == "cubic" else BUFFER
    curve = law_of(kind, x, y)
    tables = f"tables: {{buffer: {{x: {x}, y: {y}, interpolation: {kind}, outside: hold}}}}"
    passes(
        track("table(buffer, guide.travel)", analysis, tables),
        lambda at: np.where((at > x[0]) & (at < x[-1]), curve(np.clip(at, x[0], x[-1])), 0.0), [*x, 80.0],
    )  # fmt: skip


def turning(law: Law, turn: float = 2 * math.pi) -> Law:
    return lambda angle: law(np.mod(angle, turn))


def knots(x: Sequence[float], count: int) -> list[float]:
    return [v + 2 * math.pi * k for k in range(count) for v in x]


GAS = ([0.0, 87.0, 88.0, 90.0, 92.0, 300.0, 360.0], [0.0, 0.0, 40.0, 60.0, 0.0, 0.0, 0.0])  # within 5 degrees
WAVE = ([0.0, 60.0, 80.0, 87.0, 88.0, 89.0, 90.0, 91.0, 92.0, 100.0, 120.0, 200.0, 300.0, 360.0],
        [0.0, 0.0, 0.0, 0.0, 0.0, 40.0, 60.0, 20.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0])  # fmt: skip


@pytest.mark.parametrize("kind", ["linear", "pchip", "cubic"])
@pytest.mark.parametrize("analysis", ["duration: 3, samples: 2", "duration: 3, samples: 77"])
def test_gas_for_five_degrees_of_a_turn(kind: str, analysis: str) -> None:
    """A flywheel's energy is the gas's work, turn by turn, at every angle."""
    degrees, y = WAVE if kind == "cubic" else GAS
    x = [math.radians(d) for d in degrees]
    tables = f"tables: {{gas: {{x: {degrees}, y: {y}, x_unit: deg, period: 360 deg, interpolation: {kind}}}}}"
    scene = One(0.5, {"gas": "table(gas, shaft.angle)"}, 0.0, 20.0, analysis, True, tables)
    found = passes(scene, turning(law_of(kind, x, y, True)), knots(x, 25))
    assert found.x[-1] > 2 * math.pi * 9


@pytest.mark.parametrize("deg", [15.0, 1.0, 1e-2])
@pytest.mark.parametrize("samples", [2, 50])
def test_a_punch_once_a_turn(deg: float, samples: int) -> None:
    """The same work is taken within some degrees about each full turn, where a cosine passes its edge."""
    half = math.radians(deg) / 2
    torque, edge = -5.0 / (2 * half), math.cos(half)
    half = math.acos(edge)  # of the edge as it is written: a cosine near 1 has lost digits
    scene = One(0.5, {"punch": f"{torque!r} if cos(shaft.angle) > {edge!r} else 0"}, 1.0, 20.0,
                f"duration: 4, samples: {samples}", True)  # fmt: skip
    marks = [2 * math.pi * k + s * half for k in range(1, 20) for s in (-1, 1)]

    def punch(angle: Array) -> Array:
        return np.where(np.abs(np.mod(angle + math.pi, 2 * math.pi) - math.pi) < half, torque, 0.0)

    digits = 1e-8 + 1e-16 / half**2  # a cosine near 1 has its digits at 1, its edge what these leave
    found = passes(scene, punch, marks, digits)
    turns = math.floor(found.x[-1] / (2 * math.pi))
    near(found.u[-1], math.sqrt(400 - 4 * 5.0 * (half * -torque / 2.5) * turns), 20.0, digits)


@pytest.mark.parametrize("width", [0.05, 0.0005, 5e-6])
@pytest.mark.parametrize("force", [-30.0, 500.0])
def test_a_bell_of_force_at_a_place(width: float, force: float) -> None:
    """F exp(-((x - 0.5)/w)²): the work is F w times the root of pi."""
    force *= 0.0005 / width
    scene = One(0.01, {"bell": f"{force!r}*exp(-((guide.travel - 0.5)/{width!r})**2)"}, 0.0, 3.0,
                "duration: 0.6, samples: 2")  # fmt: skip
    found = passes(scene, lambda x: force * np.exp(-(((x - 0.5) / width) ** 2)), [*around(0.5, width), 30.0])
    near(found.u[-1], math.sqrt(9 + 200 * force * width * math.sqrt(math.pi)), 3.0, 1e-8)


def test_bells_of_torque_on_every_turn() -> None:
    """Smooth and narrow in the angle, again and again: each gives its work."""
    load = "exp(-((1 - cos(shaft.angle))/1e-4))*40"

    def law(angle: Array) -> Array:
        return np.asarray(40 * np.exp(-(1 - np.cos(angle)) / 1e-4))

    marks = [2 * math.pi * k + m for k in range(1, 12) for m in around(0.0, math.sqrt(2e-4))]
    found = passes(One(0.5, {"bell": load}, 1.0, 20.0, "duration: 3, samples: 2", True), law, marks)
    assert found.u[-1] > 20.1


@pytest.mark.parametrize("sigma", [0.1, 0.005, 1e-4, 1e-6])
def test_a_bell_of_torque_in_time(sigma: float) -> None:
    """A wheel at rest for two seconds but for one blow: its impulse is the integral."""
    found = moved(One(0.5, {"blow": f"3*exp(-((t - 1.234)/{sigma!r})**2/2)"}, analysis="duration: 2, samples: 2",
                      turns=True))  # fmt: skip
    impulse = 3 * sigma * math.sqrt(2 * math.pi)
    near(found.u[-1], impulse / 0.5, impulse / 0.5, 1e-8)
    assert abs(found.x[-1] - 0.766 * impulse / 0.5) <= found.error


def test_a_drive_with_a_narrow_pulse() -> None:
    """φ = t + a exp(-((t - 1)/w)²): φ'' is from -2 a/w² to 4 a/w² exp(-3/2), the torque that times I."""
    run = study("""
heun: 1
ground: {points: {O: [0, 0, 0]}}
bodies: {disc: {mass: 1, center: [0, 0, 0], inertia: [2, 2, 2], points: {o: [0, 0, 0]}}}
joints: {shaft: {type: pin, from: ground.O, to: disc.o, axis: [0, 0, 1]}}
drives: {motor: {joint: shaft, angle: "t + 1e-5*exp(-((t - 1)/0.001)**2)"}}
analysis: {duration: 2, samples: 21}
""")
    for path, inertia in (("coordinates.shaft.acceleration", 1.0), ("joints.shaft.drive", 2.0)):
        (low, at, *_), (high, there, *_) = find_peak(run, path, "min"), find_peak(run, path, "max")
        near(low, -20.0 * inertia, 20.0 * inertia, 1e-6)
        near(high, 40.0 * math.exp(-1.5) * inertia, 20.0 * inertia, 1e-6)
        near(at, 1.0, 1e-3, 1e-3)
        near(abs(there - 1.0), 1e-3 * math.sqrt(1.5), 1e-3, 1e-3)
    low, *_ = find_peak(run, "coordinates.shaft.rate", "min")
    near(low, 1.0 - 1e-2 * math.sqrt(2) * math.exp(-0.5), 1.0, 1e-7)


# ---- there and back --------------------------------------------------------------------------------------------


def bounces(times: Array, k: float, c: float, m: float, g: float, height: float) -> tuple[Array, Array]:
    """A fall onto a spring and damper that act below 0 alone, again and again; the place and the speed."""
    omega, decay = math.sqrt(k / m - (c / (2 * m)) ** 2), c / (2 * m)
    xs, us = np.empty_like(times), np.empty_like(times)
    t, x, u = 0.0, height, 0.0
    while t <= times[-1]:
        down = (u + math.sqrt(u * u + 2 * g * x)) / g  # until it comes down to 0
        here = (times >= t) & (times <= t + down)
        s = times[here] - t
        xs[here], us[here] = x + u * s - g * s * s / 2, u - g * s
        t, u, x = t + down, u - g * down, 0.0
        rest = -m * g / k

        def contact(s: Array | float, u: float = u, rest: float = rest) -> tuple[Array, Array]:
            a, b = -rest, (u - decay * rest) / omega
            s = np.asarray(s)
            fall, cos, sin = np.exp(-decay * s), np.cos(omega * s), np.sin(omega * s)
            return (
                rest + fall * (a * cos + b * sin),
                fall * ((b * omega - decay * a) * cos - (a * omega + decay * b) * sin),
            )

        low, high = 0.25 * math.pi / omega, 2.0 * math.pi / omega
        while high - low > 1e-17 + 2e-16 * high and low < 0.5 * (low + high) < high:
            middle = 0.5 * (low + high)
            low, high = (middle, high) if contact(middle)[0] < 0 else (low, middle)
        here = (times > t) & (times <= t + low)
        xs[here], us[here] = contact(times[here] - t)
        t, u = t + low, float(contact(low)[1])
    return xs, us


@pytest.mark.parametrize(("k", "c"), [(2e3, 0.0), (2e3, 4.0), (5e5, 0.0), (5e5, 30.0), (1e8, 0.0)])
@pytest.mark.parametrize("samples", [2, 201])
def test_a_fall_onto_a_spring(k: float, c: float, samples: int) -> None:
    """Free flight is a parabola, contact a sine that dies away, from touch to touch."""
    damping = f" - {c!r}*guide.speed" if c else ""
    scene = One(2.0, {"spring": f"-{k!r}*guide.travel{damping} if guide.travel < 0 else 0"}, 1.0, 0.0,
                f"duration: 4, samples: {samples}", gravity=9.81)  # fmt: skip
    found = moved(scene)
    follows(found, *bounces(found.time, k, c, 2.0, 9.81, 1.0), math.sqrt(k / 2.0))
    if not c:  # the expression is no `spring`: its work is told
        e = found.run.results.energy
        total = e["kinetic"] + e["potential"] - e["work"]
        near(total, total[0], 2 * 9.81, 1e-9)


@pytest.mark.parametrize(("load", "periods"), [
    ("-8*sign(shaft.angle)", 3), ("-8*sign(shaft.angle)", 25),
    ("8 - 16*step(shaft.angle)", 25), ("-8 if shaft.angle > 0 else 8", 25),
    ("-8*abs(shaft.angle)/(shaft.angle if shaft.angle != 0 else 1)", 3),
])  # fmt: skip
def test_a_spring_of_constant_torque(load: str, periods: int) -> None:
    """-8 sign(angle): parabolas between passages at the rate of the start, for ever."""
    scene = One(0.7, {"spring": load}, 0.0, 3.0, f"duration: {periods * 4 * 3 * 0.7 / 8!r}, samples: 211", True)
    found = moved(scene)
    half = 2 * 3 * 0.7 / 8
    n = np.floor(found.time / half)
    s, side = found.time - n * half, 1 - 2 * (n % 2)
    x, u = side * (3 * s - 8 / 0.7 * s * s / 2), side * (3 - 8 / 0.7 * s)
    u[-1] = u[-1] if abs(found.u[-1] - u[-1]) < 3 else -u[-1]
    follows(found, x, u)
    assert found.error < 1e-8


def test_two_blocks_pass_the_same_edges_at_once() -> None:
    """Equal blocks side by side: each switch is that of both, at one instant."""
    load = "-4000 if 20 < {}.travel < 22 else 900*step({}.travel - 25)"
    found = solved(f"""
heun: 1
ground: {{points: {{O: [0, 0, 0], P: [0, 3, 0]}}}}
bodies:
  a: {{mass: 600, center: [0, 0, 0], inertia: [1, 1, 1], points: {{o: [0, 0, 0]}}}}
  b: {{mass: 600, center: [0, 3, 0], inertia: [1, 1, 1], points: {{o: [0, 3, 0]}}}}
joints:
  ga: {{type: slide, from: ground.O, to: a.o, axis: [1, 0, 0], initial: {{travel: 0, speed: 12}}}}
  gb: {{type: slide, from: ground.P, to: b.o, axis: [1, 0, 0], initial: {{travel: 0, speed: 12}}}}
forces:
  fa: {{type: torque, joint: ga, value: "{load.format("ga", "ga")}"}}
  fb: {{type: torque, joint: gb, value: "{load.format("gb", "gb")}"}}
analysis: {{duration: 5, samples: 11}}
""")
    one = One(600.0, {}, 0.0, 12.0)
    law: Law = lambda x: np.where((x > 20) & (x < 22), -4000.0, np.where(x > 25, 900.0, 0.0))  # noqa: E731
    passage = Passage(one, law, [20, 22, 25, 90])
    for name in ("ga", "gb"):
        x, u = found.coordinates[name]["travel"], found.coordinates[name]["speed"]
        near(u, passage.rate(x), 12.0, 1e-9)
        near(passage.time(x), found.time, 5.0, 1e-9)
    assert np.array_equal(found.coordinates["ga"]["travel"], found.coordinates["gb"]["travel"])


def test_two_edges_at_one_place() -> None:
    """A jump and a bend together, and a third edge hardly behind them."""
    load = "-1000*step(guide.travel - 20) - 300*abs(guide.travel - 20) - (500 if guide.travel > 20*(1 + 1e-15) else 0)"
    law: Law = lambda x: np.where(x > 20, -1500.0, 0.0) - 300 * np.abs(x - 20)  # noqa: E731
    passes(One(600.0, {"load": load}, 19.0, 12.0, "duration: 0.5, samples: 9"), law, [20, 30])


# ---- touched, not crossed --------------------------------------------------------------------------------------


@pytest.mark.parametrize("above", [-1e-3, -1e-6, -1e-9, -1e-12, 0.0, 1e-9, 1e-6, 1e-3])
@pytest.mark.parametrize("samples", [2, 41])
def test_the_top_of_a_throw_at_an_edge(above: float, samples: int) -> None:
    """Thrown up to 0.25 m; beyond an edge so much lower than the top 100 N push down, for as long as it is there."""
    edge, g, m, push = 0.25 - above, 8.0, 1.0, 100.0
    scene = One(m, {"lid": f"-{push!r} if guide.travel > {edge!r} else 0"}, 0.0, 2.0,
                f"duration: 0.6, samples: {samples}", gravity=g)  # fmt: skip
    found = moved(scene)
    t = found.time
    if above <= 0.0:
        x, u = 2 * t - g * t * t / 2, 2 - g * t
    else:
        v = math.sqrt(2 * g * (0.25 - edge))  # at the edge, up and down
        up, there = (2 - v) / g, 2 * v / (g + push)
        s, late = t - up, t - up - there
        x = np.where(s < 0, 2 * t - g * t * t / 2, np.where(
            late < 0, edge + v * s - (g + push) * s * s / 2, edge - v * late - g * late * late / 2))  # fmt: skip
        u = np.where(s < 0, 2 - g * t, np.where(late < 0, v - (g + push) * s, -v - g * late))
    if above == 0.0:  # rounding decides whether it is beyond, for as long as 16 digits of the place are: 1e-8 s
        found = found._replace(error=found.error + 2e-8 * push)
    follows(found, x, u)


def test_touched_from_the_other_side() -> None:
    """A margin that comes down to zero and rises again: the push goes on as if there were no edge."""
    for below in (1e-9, 1e-6):
        scene = One(1.0, {"push": f"3 if (guide.travel - 1)**2 > -{below!r} else 1000"}, 0.0, 1.0,
                    "duration: 2, samples: 9")  # fmt: skip
        found = moved(scene)
        follows(found, found.time + 1.5 * found.time**2, 1 + 3 * found.time)


# ---- what is told of loads ---------------------------------------------------------------------------------------


def test_loads_are_told_beside_events() -> None:
    """A stop whose damper grips at the touch: its torque jumps there, at an instant that is known to rounding only.

    The torque before and after is known all the same, and so is its largest value, that of the touch.
    """
    rate, I, c = -2.0, 0.7, 20.0
    scene = One(I, {"stop": f"-{c!r}*shaft.rate*step(-shaft.angle)"}, 1.0, rate, "duration: 1.5, samples: 16", True)
    found = moved(scene)
    t = np.maximum(found.time - 0.5, 0.0)
    u = rate * np.exp(-c / I * t)
    follows(found, np.where(found.time < 0.5, 1 + rate * found.time, rate * I / c * -np.expm1(-c / I * t)), u, c / I)
    torque = found.run.results.forces["stop"]["value"]
    at = found.time > 0.51
    near(torque[at], -c * u[at], 40.0, 1e-8)
    near(torque[found.time < 0.49], 0.0, 40.0, 1e-15)
    assert found.run.results.accuracy["estimate"]["foundation"] < 1e-7
    high, there, *_ = find_peak(found.run, "forces.stop.value", "max")
    near(high, 40.0, 40.0, 1e-8)
    near(there, 0.5, 1.5, 1e-9)


def test_the_brake_of_a_car_that_is_sawn() -> None:
    """What the brake takes goes through a section of the car; told to its digits though it jumps at two places."""
    run = study("""
heun: 1
ground: {points: {O: [0, 0, 0]}}
bodies:
  car:
    shapes: [{type: rod, from: [-2, 0, 0], to: [2, 0, 0], mass: 600}]
    points: {o: [0, 0, 0], front: [2, 0, 0]}
joints: {rail: {type: slide, from: ground.O, to: car.o, axis: [1, 0, 0], initial: {travel: 0, speed: 12}}}
forces: {brake: {type: force, on: car.front, vector: ["-4000 if 20 < rail.travel < 22 else 0", 0, 0]}}
sections: {middle: {body: car, at: [1, 0, 0], normal: [1, 0, 0]}}
analysis: {times: [0, 1.7, 1.8, 3]}
""")
    estimate = run.results.accuracy["estimate"]
    assert estimate["sections"] < 1e-7
    near(run.results.sections["middle"]["N"], [0.0, -3000.0, -3000.0, 0.0], 3000.0, 1e-9)
    low, at, *_ = find_peak(run, "sections.middle.N", "min")
    near(low, -3000.0, 3000.0, 1e-9)
    assert 20 / 12 - 1e-9 <= at <= 20 / 12 + 0.18
