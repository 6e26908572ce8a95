"""A body whose point runs along a path: beads on wires with known motions and forces, and what paths refuse."""

from __future__ import annotations

import itertools
import math
import re
from collections.abc import Callable
from functools import cache
from typing import Any

import numpy as np
import pytest

from heuncli.base.errors import SolveError, SpecError
from heuncli.results.results import Array
from heuncli.scene.expressions.curves import interpolate_points
from heuncli.scene.expressions.paths import find_cusp, make_path, make_roller_path
from heuncli.scene.expressions.roller_path import find_max_curvature
from tests.shared.cams import table
from tests.shared.scenes import near, solved

PARABOLA = (
    "{x: [-2, -1, 0, 1, 2], y: [-2, -1, 0, 1, 2], interpolation: cubic}",
    "{x: [-2, -1, 0, 1, 2], y: [2, 0.5, 0, 0.5, 2], interpolation: cubic}",
)


def bead(
    x: str, y: str, z: str, start: str, times: str, from_: str = "ground.O", more: str = "", head: str = ""
) -> str:
    """A bead of 2 kg on a wire; x, y, z: tables, or numbers."""
    tables = {name: entry for name, entry in (("tx", x), ("ty", y), ("tz", z)) if entry.startswith("{")}
    keys = ", ".join(
        f"{a}: {t if e.startswith('{') else e}" for a, t, e in zip("xyz", ("tx", "ty", "tz"), (x, y, z), strict=True)
    )
    lines = "\n".join(f"  {name}: {entry}" for name, entry in tables.items())
    return f"""
heun: 1
{head}
gravity: [0, 0, -9.81]
tables:
{lines}
ground: {{points: {{O: [0, 0, 0]}}}}
bodies:
  bead: {{mass: 2, center: [0, 0, 0], inertia: [0.1, 0.1, 0.1], points: {{P: [0, 0, 0]}}}}
{more}
joints:
  wire: {{type: curve, from: {from_}, to: bead.P, {keys}, initial: {{{start}}}}}
{MORE_JOINTS.get(from_, "")}
analysis: {{times: {times}, tolerance: 1e-11}}
"""


MORE_JOINTS = {
    "arm.O": "  hub: {type: pin, from: ground.O, to: arm.O, axis: [0, 0, 1], initial: {angle: 0.3, rate: 4}}"
}


def test_a_bead_on_a_parabola() -> None:
    """z = x^2/2 is a cubic table exactly. Let go at x = 1: the force is m (g cos + v^2 / r), v^2 = 2 g (z0 - z)."""
    results = solved(bead(*PARABOLA[:1], "0", PARABOLA[1], "travel: 1", "[0, 0.2, 0.4, 0.7, 1.1]"))
    x = results.coordinates["wire"]["travel"]
    steep = 1.0 / np.sqrt(1.0 + x * x)
    wanted = 2.0 * (9.81 * steep + 9.81 * (1.0 - x * x) * steep**3)
    force = results.joints["wire"]["force"]
    near(np.sqrt(np.sum(force * force, axis=1)), wanted, 40.0, 1e-9)
    near(force[:, 0] / force[:, 2], -x, 2.0, 1e-9)
    speed = results.coordinates["wire"]["speed"]
    near(speed**2 * (1.0 + x * x), 9.81 * (1.0 - x * x), 10.0, 1e-9)
    near(results.bodies["bead"]["position"], np.stack([x, 0.0 * x, 0.5 * x * x], axis=1), 1.0, 1e-12)


def test_the_number_of_the_theory() -> None:
    """manual/theory.md, number 14: a bead of 1 kg that was let go at x = 1, where it passes x = .4."""
    speed = math.sqrt(9.81 * (1.0 - 0.4**2) / (1.0 + 0.4**2))
    text = bead(*PARABOLA[:1], "0", PARABOLA[1], f"travel: 0.4, speed: {-speed}", "[0, 0.01]")
    force = solved(text.replace("mass: 2", "mass: 1")).joints["wire"]["force"][0]
    assert math.sqrt(force @ force) == pytest.approx(15.704062651007572, rel=1e-9)


def cycloid(s: Array) -> tuple[Array, Array]:
    """x and z over the way along a cycloid from its lowest place, r = 1: s = 4 sin(angle/2)."""
    half = np.arcsin(s / 4.0)
    return 2.0 * half + np.sin(2.0 * half), 1.0 - np.cos(2.0 * half)


@pytest.mark.parametrize("start", [0.4, 1.7])
def test_a_cycloid_is_isochronous(start: float) -> None:
    """s = s0 cos(w t), w^2 = g / 4 r, however far it is let go."""
    x, z = (table(lambda s, i=i: cycloid(s)[i], -2.4, 2.4, 80) for i in (0, 1))
    w = math.sqrt(9.81 / 4.0)
    results = solved(bead(x, "0", z, f"travel: {start}", "[0, 0.5, 1, 2.0, 4.0]"))
    near(results.coordinates["wire"]["travel"], start * np.cos(w * results.time), start, 1e-5)


def test_a_helix() -> None:
    """Down a helix of radius r and rise c by a unit of the way: along it the acceleration is g c, m v^2 k across."""
    r, n = 0.5, 2.0
    length = math.hypot(r * n, 0.3)
    x, y = (table(lambda s, f=f: r * f(n * s / length), 0.0, 2.4, 160) for f in (np.cos, np.sin))
    z = table(lambda s: -0.3 * s / length, 0.0, 2.4, 2)
    results = solved(bead(x, y, z, "travel: 0.5", "[0, 0.5, 1.0]"))
    a = 9.81 * 0.3 / length
    s = 0.5 + 0.5 * a * results.time**2
    near(results.coordinates["wire"]["travel"], s, 3.0, 1e-7)
    inward = 2.0 * r * (n / length) ** 2 * (a * results.time) ** 2
    upright = 2.0 * 9.81 * r * n / length
    force = results.joints["wire"]["force"]
    near(np.sqrt(np.sum(force * force, axis=1)), np.hypot(inward, upright), 30.0, 1e-4)


def test_a_closed_ring() -> None:
    """A bead on an upright ring is a pendulum; its travel counts on as it goes round and round."""
    ring = [table(f, 0.0, 2.0 * math.pi, 90, f", period: {2.0 * math.pi}") for f in (np.sin, lambda s: -np.cos(s))]
    results = solved(bead(ring[0], "0", ring[1], "travel: 0, speed: 8", "[0, 0.4, 0.9, 2.3]"))
    s, speed = results.coordinates["wire"]["travel"], results.coordinates["wire"]["speed"]
    assert s[-1] > 4.0 * math.pi
    near(speed**2, 64.0 - 2.0 * 9.81 * (1.0 - np.cos(s)), 64.0, 1e-5)


def test_a_straight_path_is_a_line() -> None:
    """On an arm that turns: the same motion and forces as of a joint `line`, whose point is flung outward."""
    arm = "  arm: {mass: 3, center: [0.2, 0, 0], inertia: [0.1, 0.2, 0.3], points: {O: [0, 0, 0]}}"
    straight = "{x: [0, 1, 2, 3], y: [0, 1, 2, 3], interpolation: cubic}"
    text = bead(straight, "0", "0", "travel: 0.4", "[0, 0.1, 0.25]", "arm.O", arm)
    found = solved(text)
    line = "{type: line, from: arm.O, to: bead.P, axis: [1, 0, 0]}"
    as_line = text.replace(text[text.index("{type: curve") : text.index("}}", text.index("{type: curve")) + 2], line)
    as_line = as_line.replace("points: {P: [0, 0, 0]}}", "points: {P: [0, 0, 0]}, near: {position: [0.4, 0, 0]}}")
    wanted = solved(
        as_line.replace("position: [0.4, 0, 0]", f"position: [{0.4 * math.cos(0.3)}, {0.4 * math.sin(0.3)}, 0]")
    )
    for joint in ("hub", "wire"):
        near(found.joints[joint]["force"], wanted.joints[joint]["force"], 50.0, 1e-8)
    near(found.bodies["bead"]["position"], wanted.bodies["bead"]["position"], 1.0, 1e-9)
    near(found.coordinates["hub"]["rate"], wanted.coordinates["hub"]["rate"], 4.0, 1e-9)


def test_in_the_plane_as_in_space() -> None:
    """A scene declared planar moves by its own kernel."""
    swapped = bead(*PARABOLA, "0", "travel: 1", "[0, 0.3, 0.8]").replace("[0, 0, -9.81]", "[0, -9.81, 0]")
    space, plane = solved(swapped), solved(swapped.replace("heun: 1", "heun: 1\nspace: planar"))
    near(plane.joints["wire"]["force"], space.joints["wire"]["force"], 40.0, 1e-9)
    near(plane.coordinates["wire"]["travel"], space.coordinates["wire"]["travel"], 1.0, 1e-9)
    drive = "drives: {go: {joint: wire, travel: 'cos(3*t)'}}\nanalysis"
    swapped = swapped.replace("analysis", drive)
    space, plane = solved(swapped), solved(swapped.replace("heun: 1", "heun: 1\nspace: planar"))
    for name in ("force", "drive"):
        near(plane.joints["wire"][name], space.joints["wire"][name], 40.0, 1e-9)


ROUND = f", period: {2.0 * math.pi}"


def across_twice(s: Array) -> Array:
    """sin s cos s."""
    return np.asarray(0.5 * np.sin(2.0 * s))


EIGHT = [table(f, 0.0, 2.0 * math.pi, 240, ROUND) for f in (np.sin, across_twice)]


@cache
def eight_by_splines() -> Callable[..., Array]:
    """SciPy's splines through the same points."""
    from scipy.interpolate import CubicSpline

    around = np.linspace(0.0, 2.0 * math.pi, 241)
    places = np.stack([np.sin(around), 0.0 * around, across_twice(around)], axis=-1)
    places[-1] = places[0]
    found: Callable[..., Array] = CubicSpline(around, places, bc_type="periodic")
    return found


def along_the_eight(s: Array, u: Array, c: float = 0.0) -> tuple[Array, Array, Array]:
    """Of 2 kg at s on x = sin s, z = sin s cos s, by its splines: r', what s'' is with a damper, the wire's force."""
    eight = eight_by_splines()
    r1, bent = eight(s, 1), np.asarray(u * u)[..., None] * eight(s, 2) + np.array([0.0, 0.0, 9.81])
    square = np.sum(r1 * r1, axis=-1)
    along = np.sum(bent * r1, axis=-1) / square
    return r1, -along - 0.5 * c * u, 2.0 * (bent - along[..., None] * r1)


def times_and_speeds(knots: Array, first: float, c: float) -> tuple[Array, Array]:
    """When a bead is at knots of the eight, and how fast: dt/ds = 1/u, du^2/ds = 2 s'', smooth from knot to knot."""
    from scipy.integrate import solve_ivp

    def rate(s: float, y: Array) -> Array:
        u = np.sqrt(y[1])
        return np.array([1.0 / u, 2.0 * along_the_eight(np.array(s), u, c)[1]])

    found = [np.array([0.0, first * first])]
    for one, other in itertools.pairwise(knots.tolist()):
        piece: Any = solve_ivp(rate, (one, other), found[-1], "RK45", rtol=1e-12, atol=1e-13)
        found.append(piece.y[:, -1])
    t, square = np.stack(found, axis=1)
    return t, np.sqrt(square)


@pytest.mark.parametrize("c", [0.0, 0.4])
def test_a_path_that_crosses_itself(c: float) -> None:
    """A bead that goes round an eight and twice through its crossing, against the equation of its way alone.

    At the crossing both branches are at one place: force, direction and travel are those of the branch it came along.
    """
    knots = np.linspace(0.0, 2.0 * math.pi, 241)[100:]
    t, u = times_and_speeds(knots, 6.0, c)
    at = [0, 20, 21, 80, 139, 140]  # the crossing is at 20, and at 140
    load = f"forces: {{drag: {{type: damper, joint: wire, coefficient: {c}}}}}" if c else ""
    start = f"travel: {knots[0]!r}, speed: 6".replace("np.float64(", "").replace(")", "")
    results = solved(bead(EIGHT[0], "0", EIGHT[1], start, str(t[at].tolist()), head=load))
    near(results.coordinates["wire"]["travel"], knots[at], 10.0, 1e-9)
    near(results.coordinates["wire"]["speed"], u[at], 10.0, 1e-9)
    near(results.joints["wire"]["force"], along_the_eight(knots[at], u[at])[2], 150.0, 1e-9)


def test_a_start_where_a_path_meets_itself() -> None:
    """Both branches are another motion: one is held, or driven to, or none is taken."""
    starts = 0.0, math.pi
    held = [bead(EIGHT[0], "0", EIGHT[1], f"travel: {s}, speed: 2", "[0, 0.1]") for s in starts]
    for text, s in zip(held, starts, strict=True):
        force = solved(text).joints["wire"]["force"][0]
        near(force, along_the_eight(np.array(s), np.array(2.0))[2], 20.0, 1e-9)
    driven = held[0].replace(", initial: {travel: 0.0, speed: 2}", "")
    with pytest.raises(SolveError, match=r"at travel 0 and 3\.14159: the branch is not given"):
        solved(driven)
    drive = f"drives: {{go: {{joint: wire, travel: '{math.pi} + 2*t'}}}}\nanalysis"
    results = solved(driven.replace("analysis", drive))
    near(results.coordinates["wire"]["travel"], math.pi + 2.0 * results.time, 4.0, 1e-12)
    s, u = (results.coordinates["wire"][name] for name in ("travel", "speed"))
    r1, falls, across = along_the_eight(s, u)
    near(results.joints["wire"]["force"], across, 30.0, 1e-9)
    near(results.joints["wire"]["drive"], -2.0 * falls * np.sqrt(np.sum(r1 * r1, axis=1)), 30.0, 1e-9)


@pytest.mark.parametrize(("head", "message"), [
    ("forces: {f: {type: damper, joint: wire, force: '-3*rate'}}", "with a law in its rate acts in a pin or slide"),
    ("forces: {f: {type: friction, joint: wire, coefficient: 0.3, speed: 0.01}}", "with a coefficient acts in a pin"),
    ("forces: {f: {type: torque, joint: wire, value: 3}}", "type: torque acts about a pin or along a slide"),
    ("couplings: {c: {type: ratio, of: [wire, wire], factors: [1, 2]}}", "the travel of a curve cannot be coupled"),
])  # fmt: skip
def test_what_does_not_act_along_a_path(head: str, message: str) -> None:
    """Told with a hint: its direction is not that of an axis."""
    with pytest.raises(SpecError, match=message):
        solved(bead(EIGHT[0], "0", EIGHT[1], "travel: 0.3", "[0, 1]", head=head))


WAVY = [table(lambda s: s, -1.0, 7.0, 160), table(lambda s: 0.3 * np.cos(s), -1.0, 7.0, 160)]
ROUNDED = (2.0 * math.pi / 240) ** 2 / 12.0
ABOVE, BELOW = "[0, -1, 0]", "[0, 2, 0]"  # where these point to the eye, the track goes on to the right, or to the left


def beside_the_waves(s: Array, R: float) -> tuple[Array, Array, Array, Array]:
    """Of a roller above z = .3 cos x, by splines: its centre, |p'|, the path's normal up, its curvature toward that."""
    from scipy.interpolate import CubicSpline

    x = np.linspace(-1.0, 7.0, 161)
    waves = CubicSpline(x, 0.3 * np.cos(x))  # heun's cubic is not-a-knot, too
    slope, bend = waves(s, 1), waves(s, 2)
    size = np.sqrt(1.0 + slope * slope)
    normal = np.stack([-slope, 0.0 * s, 0.0 * s + 1.0], axis=-1) / size[:, None]
    curved = bend / size**3
    return np.stack([s, 0.0 * s, waves(s)], axis=-1) + R * normal, (1.0 - R * curved) * size, normal, curved


@pytest.mark.parametrize(("R", "normal"), [(0.5, ABOVE), (-0.5, BELOW)])
def test_a_roller_beside_a_wavy_track(R: float, normal: str) -> None:
    """Its speed is that of its height, and dt = |p'| ds / v; its centre's path curves with k / (1 - k R)."""
    knots = np.linspace(-1.0, 7.0, 161)[30:141]
    first = beside_the_waves(knots[:1], R)
    nodes, weights = np.polynomial.legendre.leggauss(8)
    half = 0.5 * np.diff(knots)
    inner = (0.5 * (knots[1:] + knots[:-1]) + half * nodes[:, None]).ravel()

    def speed(s: Array) -> Array:
        return np.sqrt(25.0 - 2.0 * 9.81 * (beside_the_waves(s, R)[0] - first[0])[:, 2])

    rates = (beside_the_waves(inner, R)[1] / speed(inner)).reshape(8, -1)
    t = np.append(0.0, np.cumsum(half * (weights @ rates)))
    at = [0, 23, 61, 110]
    start = f"travel: {float(knots[0])}, speed: {5.0 / float(first[1][0])!r}"
    text = bead(WAVY[0], "0", WAVY[1], start, str(t[at].tolist()))
    results = solved(text.replace("initial", f"radius: 0.5, normal: {normal}, initial"))
    centre, size, up, curved = beside_the_waves(knots[at], R)
    v = speed(knots[at])
    near(results.coordinates["wire"]["travel"], knots[at], 7.0, 1e-9)
    near(results.coordinates["wire"]["speed"] * size, v, 5.0, 1e-9)
    near(results.bodies["bead"]["position"], centre, 7.0, 1e-9)
    near(results.joints["wire"]["contact_point"], centre - R * up, 7.0, 1e-9)
    carried = 2.0 * (v * v * curved / (1.0 - curved * R) + 9.81 * up[:, 2])
    near(results.joints["wire"]["force"], carried[:, None] * up, 50.0, 1e-8)


PLANAR, DRIVEN = "heun: 1\nspace: planar", "drives: {go: {joint: wire, travel: 'sin(3*t)'}}\n"


@pytest.mark.parametrize(("normal", "radius", "drive", "head"), [
    ("[0, 0, 1]", 0.7, "", "heun: 1"), ("[0, 0, 1]", 0.7, DRIVEN, PLANAR),
    ("[0, 0, -3]", 1.3, "", PLANAR), ("[0, 0, -3]", 1.3, DRIVEN, "heun: 1"),
])  # fmt: skip
@pytest.mark.third
def test_a_roller_beside_a_circle(normal: str, radius: float, drive: str, head: str) -> None:
    """Within or outside of a ring it runs on a ring, in the plane and in space, on an arm that turns, and driven."""
    ring = [table(f, 0.0, 2.0 * math.pi, 240, ROUND) for f in (np.cos, np.sin)]
    arm = "  arm: {mass: 3, center: [0.2, 0, 0], inertia: [0.1, 0.2, 0.3], points: {O: [0.1, 0, 0]}}"
    plain = bead(*ring, "0", "travel: 0, speed: 3", "[0, 0.2, 0.5, 1.1]", "arm.O", arm).replace(
        "[0, 0, -9.81]", "[0, 0, 0]"
    )
    other = [table(lambda s, f=f: radius * f(s), 0.0, 2.0 * math.pi, 240, ROUND) for f in (np.cos, np.sin)]
    text = plain.replace("heun: 1", head).replace("analysis", drive + "analysis")
    found = solved(text.replace("initial: {travel", f"radius: 0.3, normal: {normal}, initial: {{travel"))
    wanted = text
    for one, new in zip(ring, other, strict=True):
        wanted = wanted.replace(one, new)
    as_ring = solved(wanted)
    for name in ("wire", "hub"):  # a spline's curvature is off by h^2/12, of both
        near(found.joints[name]["force"], as_ring.joints[name]["force"], 130.0, 2.0 * ROUNDED)
    near(found.coordinates["wire"]["travel"], as_ring.coordinates["wire"]["travel"], 3.3, 2.0 * ROUNDED)
    away = found.joints["wire"]["contact_point"] - found.joints["hub"]["point"]
    s = found.coordinates["wire"]["travel"] + found.coordinates["hub"]["angle"]
    near(away, np.stack([np.cos(s), np.sin(s), 0.0 * s], axis=-1), 1.0, 1e-8)


@pytest.mark.parametrize(("keys", "message"), [
    ("radius: 3.4, normal: [0, -1, 0]", "the path has a radius of 3.333 m at travel 0, but the roller has 3.4 m"),
    ("radius: 3.3, normal: [0, -1, 0]", None),
    ("radius: 30, normal: [0, 1, 0]", None),
    ("radius: 0.2", "a roller on a path needs its 'normal'"),
    ("normal: [0, 1, 0]", "'normal' without 'radius'"),
    ("radius: 0.2, normal: [0, 1, 0.01]", "in a plane perpendicular to its normal"),
    ("radius: 0.2, normal: [0, 0, 0]", "which has no direction"),
    ("radius: 0, normal: [0, 1, 0]", "radius must be greater than 0"),
])  # fmt: skip
def test_what_no_roller_follows(keys: str, message: str | None) -> None:
    """z = .15 x^2 curves with 1 / .3 m where it is lowest, toward what is above."""
    bowl = [table(f, -2.0, 2.0, 8) for f in (lambda s: s, lambda s: 0.15 * s * s)]
    text = bead(bowl[0], "0", bowl[1], "travel: 0.5", "[0, 0.01]").replace("initial", f"{keys}, initial")
    if message is None:
        solved(text)
        return
    with pytest.raises(SpecError, match=re.escape(message)):
        solved(text)


def test_the_bounds_of_a_roller_beside_a_path() -> None:
    """How far and how fast its centre gets is never more than is told, nor much less; the tightest place is found."""
    s = np.linspace(0.0, 6.0, 11)
    path = make_path(
        [interpolate_points("t", s.tolist(), f(s).tolist(), "cubic", None, None) for f in (np.array, np.cos)] + [0.2]
    )
    close = np.linspace(0.0, 6.0, 20001)
    for normal in ((0.0, 0.0, 2.0), (0.0, 0.0, -1.0)):
        roller = make_roller_path(path, 0.4, normal)
        for found, most in zip(roller.evaluate(close), roller.bounds, strict=True):
            assert np.sqrt(np.sum(found * found, axis=1)).max() * 1.5 <= most * 1.5 <= 6.0 * np.abs(found).max()
        _, slope, bend, _ = roller.evaluate_track(close)
        shares = 0.4 * (np.cross(slope, bend) @ roller.normal) / np.sum(slope * slope, axis=1) ** 1.5
        where, share = find_max_curvature(roller)
        assert shares.max() <= share + 1e-12 <= shares.max() + 1e-6
        assert where == pytest.approx(close[np.argmax(shares)], abs=1e-3)


@pytest.mark.parametrize(("down", "end"), [(1, "> 3"), (-1, "< 0")])
@pytest.mark.parametrize("head", ["", "latches: {hold: {joint: hub, when: t > 0.1}}"])
def test_the_end_of_a_path(down: int, end: str, head: str) -> None:
    """A run that comes there is told so, with what the path covers; not that conditions beside it cannot be held."""
    ramp = table(lambda s: -down * s, 0.0, 3.0, 3)
    arm = "  arm: {mass: 3, center: [0.2, 0, 0], inertia: [0.1, 0.2, 0.3], points: {O: [0, 0, 0]}}"
    with pytest.raises(SolveError, match="leaves its path, which covers travel from 0 to 3 m") as told:
        solved(bead("0.1", "0", ramp, "travel: 1", "[0, 2]", "arm.O", arm, head))
    (problem,) = told.value.problems
    assert problem.code == "path-ends" and problem.hint
    assert problem.hint.endswith(f"until: wire.travel {end}")


@pytest.mark.parametrize(("x", "z", "start", "message"), [
    ("0", "1", "travel: 0", "a path needs at least one table"),
    ("{x: [0, 1, 2], y: [0, 1, 2], interpolation: linear}", "0", "travel: 0", "so it is not smooth"),
    ("{x: [0, 1, 2, 3], y: [0, 1, 2, 3], interpolation: cubic}", "0", "travel: 4", "travel 4 is outside the path"),
    ("{x: [-1, 0, 1], y: [1, 0, 1], interpolation: cubic}", "0", "travel: 0.5", "no direction at travel 0"),
    ("{x: [0, 1, 2, 3], y: [0, 1, 2, 3], interpolation: cubic}", "{x: [5, 6, 7], y: [0, 1, 2], interpolation: cubic}",
     "travel: 1", "no travel in common"),
    ("{x: [0, 1, 2, 3], y: [0, 1, 0.5, 1], interpolation: cubic, period: 3}", "0", "travel: 1", "must be equal"),
    ("nothing", "0", "travel: 1", "expected the name of a table"),
])  # fmt: skip
def test_what_is_no_path(x: str, z: str, start: str, message: str) -> None:
    """Told with its place, before anything is solved."""
    text = bead(x, "0", z, start, "[0, 1]") if x.startswith("{") or z.startswith("{") else None
    text = text or bead("{x: [0, 1], y: [0, 1]}", x, z, start, "[0, 1]").replace("x: tx, ", "")
    with pytest.raises(SpecError, match=message):
        solved(text)


SHAPES: tuple[Callable[[Array], Array], ...] = (np.cos, np.sin, lambda s: 0.2 * s)


def test_the_nearest_place() -> None:
    """Of points beside a helix, about its axis and beyond its ends; and of one between two turns that lie close."""
    s = np.linspace(0.0, 12.0, 241)
    path = make_path([interpolate_points("t", s.tolist(), f(s).tolist(), "cubic", None, None) for f in SHAPES])
    at = np.array([0.3, 3.0, 7.123, 11.9])
    r, slope, _ = path.evaluate(at)
    across = np.cross(slope, [0.3, -0.2, 1.0])
    near(path.find_nearest(r + 0.05 * across), at, 12.0, 1e-9)
    near(path.find_nearest(r), at, 12.0, 1e-12)
    near(path.find_nearest(np.array([[3.0, 0.0, -9.0]])), 0.0, 12.0, 1e-12)
    assert find_cusp(path) is None
    bound = path.bounds
    close = np.linspace(0.0, 12.0, 5000)
    for found, most in zip(path.evaluate(close), bound, strict=True):
        assert np.sqrt(np.sum(found * found, axis=1)).max() <= most * (1.0 + 1e-14)
