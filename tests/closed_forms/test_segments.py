"""Motions in segments: each is its law, scaled and shifted; cams and drives follow it exactly, jumps included."""

from __future__ import annotations

import math
from itertools import pairwise
from random import Random
from typing import Any

import numpy as np
import pytest

from heuncli.base.errors import SpecError
from heuncli.scene.expressions.discontinuities import find_discontinuities
from heuncli.scene.expressions.grammar import compile_expression
from heuncli.scene.expressions.motion_laws import LAWS
from heuncli.scene.expressions.motion_segments import SEGMENT_LAWS, LawSegment, MotionRows, make_rows
from heuncli.scene.expressions.paths import make_lift_path
from heuncli.scene.expressions.programs import Expression
from heuncli.scene.expressions.scope import Scope
from heuncli.scene.file_format.load import load
from tests.shared.measured import measured
from tests.shared.scenes import near, solved, study

PI = math.pi
SCOPE = Scope(in_time=True)
# Norton, Cam Design and Manufacturing Handbook, tables of peak factors; VDI 2143: velocity and acceleration
PEAKS = {
    "cycloid": (2.000, 6.283), "modsine": (1.760, 5.528), "modtrap": (2.000, 4.888), "poly345": (1.875, 5.774),
    "poly4567": (2.188, 7.513), "harmonic": (1.571, 4.935), "parabola": (2.000, 4.000), "linear": (1.000, 0.000),
    "trapezoid": (1.500, 4.500),
}  # fmt: skip


def evaluate(motion: MotionRows, x: float) -> tuple[float, float, float]:
    """Value and two derivatives at x."""
    row = [row for row in motion.rows if row.begin <= x][-1]
    return row.evaluate(x)


def law(name: str, **changes: Any) -> MotionRows:
    """One segment of a law."""
    return make_rows([LawSegment(0.0, 1.0, 0.0, 1.0, name)._replace(**changes)])


def drive(joint: str, entry: str) -> Expression:
    """The value of a drive of a body on a joint."""
    text = f"""
heun: 1
parameters: {{D: 30 mm, T: 200 ms}}
ground: {{points: {{O: [0, 0, 0]}}}}
bodies: {{b: {{mass: 1, center: [0, 0, 0], inertia: [1, 1, 1], points: {{o: [0, 0, 0]}}}}}}
joints: {{j: {{type: {joint}, from: ground.O, to: b.o, axis: [1, 0, 0]}}}}
drives: {{d: {{joint: j, {entry}}}}}
analysis: {{duration: 1}}
"""
    return load("scene.yaml", text).drives["d"].value


@pytest.mark.parametrize("name", LAWS)
def test_a_segment_is_the_function_of_its_law(name: str) -> None:
    """The polynomials and sines into which a law is taken apart, against the law as a function of expressions."""
    expression = compile_expression(f"0.02 - 0.05*{name}((t - 0.3)/0.7)", SCOPE)
    motion = make_rows([LawSegment(0.3, 1.0, 0.02, -0.05, name)])
    for t in np.linspace(0.3001, 0.9999, 173):
        for found, wanted, size in zip(evaluate(motion, t), expression.derivatives(t), (0.05, 0.2, 1.0), strict=True):
            assert found == pytest.approx(wanted, abs=1e-13 * size)


@pytest.mark.parametrize("name", SEGMENT_LAWS)
def test_peak_factors_of_the_literature(name: str) -> None:
    """Velocity and acceleration of a rise of 1 in a time of 1; the books give three digits behind the point."""
    samples = np.array(make_lift_path(law(name), 0.0).evaluate(np.linspace(0.0, 1.0, 20001)))[:, :, 0]
    velocity, acceleration = np.abs(samples[1:]).max(axis=1)
    assert (velocity, acceleration) == pytest.approx(PEAKS[name], abs=6e-4)
    assert samples[0, [0, -1]] == pytest.approx([0.0, 1.0], abs=1e-14)
    assert np.trapezoid(samples[1], dx=1.0 / 20000) == pytest.approx(1.0, abs=1e-8)
    for (a, b), row in zip(pairwise(law(name).knots), law(name).rows, strict=True):  # v and s by integrals of a and v
        nodes, weights = np.polynomial.legendre.leggauss(20)
        inner = np.array([row.evaluate(a + 0.5 * (b - a) * (1.0 + x)) for x in nodes])
        change = np.subtract(row.evaluate(b), row.evaluate(a))[:2]
        assert 0.5 * (b - a) * weights @ inner[:, 1:] == pytest.approx(change, abs=1e-13)


@pytest.mark.parametrize("name", SEGMENT_LAWS)
def test_scaled_reversed_and_negative_segments(name: str) -> None:
    """c times the rise in T of the time: c, c/T, c/T^2 times value, rate, acceleration; backwards in time it falls."""
    random = Random(name)
    c, T, begin, value = random.uniform(-3, 3), random.uniform(0.1, 9), random.uniform(0, 5), random.uniform(-1, 1)
    one, other = law(name), make_rows([LawSegment(begin, begin + T, value, c, name)])
    size = np.array([abs(value) + abs(c), abs(c) / T, abs(c) / T**2]) * 8.0
    for x in [random.uniform(0.001, 0.999) for _ in range(50)]:
        s, v, a = evaluate(one, x)
        found = np.array(evaluate(other, begin + T * x))
        assert (np.abs(found - [value + c * s, c * v / T, c * a / T**2]) <= 1e-12 * size).all()
        assert np.abs(np.array(evaluate(one, 1.0 - x)) - [1.0 - s, v, -a]).max() <= 1e-12  # all are symmetrical


def test_a_drive_follows_its_segments_and_stays() -> None:
    value = drive("slide", "base: 5 mm, segments: [{for: T, rise: D, law: cycloid}, {dwell: 0.1}, "
                           "{to: 0.8, at: -10 mm, law: harmonic}]")  # fmt: skip
    for t in np.linspace(0.0, 1.0, 101):
        x, y = min(t / 0.2, 1.0), min(max((t - 0.3) / 0.5, 0.0), 1.0)
        wanted = 0.005 + 0.03 * (x - math.sin(2 * PI * x) / (2 * PI)) - 0.045 * 0.5 * (1.0 - math.cos(PI * y))
        assert value.value(t) == pytest.approx(wanted, abs=1e-16)
    assert value.derivatives(0.55)[1] == pytest.approx(-0.045 * PI / 2 / 0.5)
    assert value.derivatives(2.0) == pytest.approx((-0.01, 0.0, 0.0), abs=1e-17)


def test_rises_of_a_pin_are_angles() -> None:
    turned = drive("pin", "segments: [{for: 100 ms, rise: 90 deg, law: parabola}]")
    assert turned.derivatives(0.05)[:2] == pytest.approx((PI / 4, PI / 0.1))
    assert drive("cylinder", "segments: [{for: 1, rise: D, law: poly345}]").value(1.0) == pytest.approx(0.03)


def test_a_profile_within_limits_takes_as_long_as_it_needs() -> None:
    """An S-curve down in a sequence is the function of that name, backwards; the segment after it begins at its end."""
    value = drive("slide", "segments: [{dwell: 0.1}, {rise: -D, law: scurve, rate: 200 mm/s, acceleration: 2 m/s^2, "
                           "jerk: 40 m/s^3}, {dwell: 0.05}, {for: 0.1, at: 0, law: trapezoid}]")  # fmt: skip
    text = "-scurve(t - 0.1, 0.03, 0.2, 2, 40)"
    profile = compile_expression(text, SCOPE)
    duration = (
        0.1 + 0.03 / 0.2 + 0.15
    )  # limits reached: rate/acceleration + acceleration/jerk to rise, the same to fall
    end = 0.1 + 0.03 / 0.2 + 0.2 / 2 + 2 / 40
    assert end == pytest.approx(duration)
    for t in np.linspace(0.0, end + 0.05, 77):
        assert value.value(t) == pytest.approx(profile.value(t), abs=1e-15)
    assert value.derivatives(end + 0.05 + 0.04)[1] == pytest.approx(1.5 * 0.03 / 0.1)


def test_repeated_segments_go_on_from_where_they_came() -> None:
    """An index of 60 deg in 0.1 s and a dwell of 0.2 s, over and over: the branches change at each end of a piece."""
    value = drive("pin", "segments: [{for: 0.1, rise: 60 deg, law: modtrap}, {dwell: 0.2}], repeat: true")
    for t in np.linspace(0.001, 0.297, 75):
        for cycle in (1, 7, 1000):
            later = value.derivatives(t + 0.3 * cycle)
            assert later == pytest.approx(np.add(value.derivatives(t), (cycle * PI / 3, 0.0, 0.0)), rel=1e-11, abs=1e-7)
    ends = [0.1 * x for x in (0.125, 0.375, 0.625, 0.875, 1.0)] + [0.3]
    wanted = sorted(end + 0.3 * cycle for cycle in range(3) for end in ends)
    found = find_discontinuities(value, 0.0, 0.9)
    distinct = [t for before, t in pairwise([-1.0, *found]) if t - before > 1e-12]
    assert distinct == pytest.approx([t for t in wanted if t < 0.9 - 1e-12], abs=1e-15)


# Cams

CAM = """
heun: 1
gravity: [0, {g}, 0]
ground: {{points: {{O: [0, 0, 0]}}}}
bodies:
  disc: {{mass: 1, center: [0, 0, 0], inertia: [1, 1, {J}], points: {{o: [0, 0, 0]}}}}
  follower: {{mass: 2, center: [0, 0, 0], inertia: [1, 1, 1], points: {{o: [0, 0, 0]}}}}
joints:
  shaft: {{type: pin, from: ground.O, to: disc.o, axis: [0, 0, 1], initial: {{angle: {start}, rate: 20}}}}
  guide: {{type: slide, from: ground.O, to: follower.o, axis: [0, 1, 0]}}
{drives}
couplings:
  cam:
    type: cam
    of: [shaft, guide]
    at: follower.o
    contact: point
    base: 50 mm
    {keys}
    segments: [{{to: 90 deg, rise: 20 mm, law: {law}}}, {{dwell: 100 deg}}, {{for: 80 deg, at: 50 mm, law: {law}}},
               {{dwell: 90 deg}}]
analysis: {{duration: {duration}, samples: 101, tolerance: 1e-11}}
"""
DRIVEN = "drives: {motor: {joint: shaft, angle: 20*t}}"
DEFAULTS = {"g": 0, "J": 0.01, "start": 0, "drives": "", "keys": "two_sided: true", "law": "cycloid", "duration": 0.7}


def cam_text(**changes: Any) -> str:
    """The scene of a cam."""
    return CAM.format(**{**DEFAULTS, **changes})


def lift(name: str) -> MotionRows:
    """Its lift."""
    deg = math.radians(1.0)
    rows = [(0.0, 90.0, 0.05, 0.02, name), (90.0, 190.0, 0.07, 0.0, ""), (190.0, 270.0, 0.07, -0.02, name),
            (270.0, 360.0, 0.05, 0.0, "")]  # fmt: skip
    return make_rows([LawSegment(deg * a, deg * b, value, rise, own) for a, b, value, rise, own in rows])


@pytest.mark.parametrize("name", [*LAWS, "parabola", "harmonic"])
def test_a_free_disc_moves_its_follower_by_the_law(name: str) -> None:
    """x = L, x' = L' w, x'' = L' w' + L'' w^2 at every instant, and the energy is kept over the ends of the pieces."""
    results = solved(cam_text(law=name))
    shaft, guide, rows = results.coordinates["shaft"], results.coordinates["guide"], lift(name)
    angles = np.asarray(shaft["angle"])
    L, slope, bend = np.array([evaluate(rows, phi % (2 * PI)) for phi in angles]).T
    near(guide["travel"], L, 0.05, 1e-13)
    near(guide["speed"], slope * shaft["rate"], 1.0, 1e-12)
    near(guide["acceleration"], slope * shaft["acceleration"] + bend * np.square(shaft["rate"]), 30.0, 1e-11)
    energy = 0.5 * 0.01 * np.square(shaft["rate"]) + 0.5 * 2.0 * np.square(guide["speed"])
    near(energy, 2.0, 2.0, 1e-9)
    assert np.ptp(shaft["rate"]) > 0.5
    path = make_lift_path(rows, 2 * PI)  # the same in NumPy, as the flank is made of it
    near(np.array(path.evaluate_with_third(angles))[:3, :, 0], [L, slope, bend], 0.5, 1e-13)


def test_extremes_see_both_sides_of_a_jump() -> None:
    """A parabolic rise: 4 h (w/B)^2 up to its middle, the same downwards from there on."""
    scene = study(cam_text(law="parabola", drives=DRIVEN, duration=0.1))
    wanted = 4.0 * 0.02 * (20.0 / (PI / 2)) ** 2
    for reducer, value in (("max", wanted), ("min", -wanted)):
        assert measured(scene, f"{reducer} coordinates.guide.acceleration")["value"] == pytest.approx(value, rel=1e-12)


def test_a_follower_leaves_in_the_middle_of_a_parabola() -> None:
    """There the cam slows down faster than gravity: the follower flies, and lands on the dwell when a body would."""
    scene = cam_text(law="parabola", drives=DRIVEN, g=-9.81, keys="restitution: 0", duration=0.2)
    results = solved(scene)
    leaves, speed = (PI / 4) / 20.0, 2.0 * 0.02 * 20.0 / (PI / 2)
    lands = leaves + (speed + math.sqrt(speed**2 - 9.81 * 0.02)) / 9.81
    (impulse,) = [x for x in results.impulses if abs(x["bodies"]["follower"]["center_velocity_jump"][1]) > 1e-6]
    assert impulse["time"] == pytest.approx(lands, rel=1e-10)
    assert impulse["bodies"]["follower"]["center_velocity_jump"][1] == pytest.approx(
        9.81 * (lands - leaves) - speed, rel=1e-9
    )


def test_bounces_before_an_end_of_a_piece_are_no_chatter() -> None:
    """More bounces than a flurry of events may have, all in steps that would reach the same end of a piece."""
    results = solved(cam_text(law="parabola", drives=DRIVEN, g=-11, keys="restitution: 0.6", duration=0.3))
    assert len(results.impulses) > 16
    near(results.coordinates["guide"]["travel"][-1], evaluate(lift("parabola"), 6.0)[0], 0.05, 1e-12)


def test_a_lift_begins_at_the_phase() -> None:
    late = solved(cam_text(drives=DRIVEN, keys="two_sided: true\n    phase: 30 deg"))
    wanted = [evaluate(lift("cycloid"), (20.0 * t - PI / 6) % (2 * PI))[0] for t in late.time]
    near(late.coordinates["guide"]["travel"], wanted, 0.05, 1e-13)


@pytest.mark.parametrize(
    ("segments", "place", "words"),
    [
        ("{to: 1, rise: 1 mm, law: cycliod}", "segments.0.law", "did you mean cycloid"),
        ("{to: 1, rise: 1 mm, law: cycloid}, {to: 0.9, rise: 1 mm, law: cycloid}", "segments.1.to", "begins at 1 s"),
        ("{for: -1, rise: 1 mm, law: cycloid}", "segments.0.for", "takes no time"),
        ("{dwell: 0}", "segments.0.dwell", "takes no time"),
        ("{for: 1, law: cycloid}", "segments.0", "'rise' is missing"),
        ("{for: 1, rise: 1 mm}", "segments.0", "'law' is missing"),
        ("{for: 1, to: 1, rise: 1 mm, law: cycloid}", "segments.0", "to and for"),
        ("{rise: 1 mm, law: cycloid}", "segments.0", "no end"),
        ("{dwell: 1, rise: 1 mm}", "segments.0.rise", "given for a dwell"),
        ("{for: 1, rise: 1 deg, law: cycloid}", "segments.0.rise", "expected a length"),
        ("{rise: 1 mm, law: scurve, rate: 1, acceleration: 1}", "segments.0", "scurve has no jerk"),
        ("{rise: 1 mm, law: trapezoid, rate: 1 m/s^2, acceleration: 1}", "segments.0.rate", "expected a velocity"),
        ("{rise: 1 mm, law: trapezoid, rate: 0, acceleration: 1}", "segments.0.rate", "greater than 0"),
        ("{for: 1, rise: 1 mm, law: trapezoid, rate: 1, acceleration: 1}", "segments.0.for", "the limits decide"),
        ("{for: 1, rise: 1 mm, law: cycloid, jerk: 1}", "segments.0.jerk", "takes no jerk"),
        ("", "segments", "0 segments"),
    ],
)
def test_what_is_refused_of_a_drive(segments: str, place: str, words: str) -> None:
    with pytest.raises(SpecError) as caught:
        drive("slide", f"segments: [{segments}]")
    (problem,) = caught.value.problems
    assert (problem.code, f" drives.d.{place}: " in str(caught.value)) == ("segments", True)
    assert words in f"{problem.message} {problem.hint}"


@pytest.mark.parametrize(
    ("segments", "words"),
    [
        ("{to: 90 deg, rise: 9 mm, law: cycloid}, {for: 90 deg, at: 50 mm, law: cycloid}", "180 deg are missing"),
        ("{to: 90 deg, rise: 9 mm, law: cycloid}, {for: 280 deg, at: 50 mm, law: cycloid}", "10 deg too many"),
        ("{to: 90 deg, rise: 9 mm, law: cycloid}, {for: 270 deg, rise: -8 mm, law: cycloid}", "has changed by 0.001"),
        ("{to: 90 deg, rise: 9 mm, law: linear}, {for: 270 deg, rise: -9 mm, law: cycloid}", "jumps by 0.00572958 per"),
        ("{to: 90 deg, rise: 9 mm, law: scurve}, {dwell: 270 deg}", "for drives alone"),
    ],
)
def test_what_is_refused_of_a_cam(segments: str, words: str) -> None:
    scene = cam_text()
    begin = scene.index("    segments:")
    with pytest.raises(SpecError) as caught:
        load("scene.yaml", f"{scene[:begin]}    segments: [{segments}]\n{scene[scene.index('analysis') :]}")
    (problem,) = caught.value.problems
    assert problem.code == "segments"
    assert words in problem.message


@pytest.mark.parametrize(("key", "entry"), [
    ("rise", "segments: [{to: 1 s, rise: 0.1*t, law: cycloid}]"),
    ("at", "segments: [{to: 1 s, at: j.travel, law: cycloid}]"),
    ("rate", "segments: [{rise: 0.1, law: trapezoid, rate: 1+t, acceleration: 1}]"),
    ("to", "segments: [{to: 1+t, rise: 0.1, law: cycloid}]"),
    ("base", "segments: [{to: 1 s, rise: 0.1, law: cycloid}], base: t"),
])  # fmt: skip
def test_a_function_is_no_number_of_a_segment(key: str, entry: str) -> None:
    with pytest.raises(SpecError) as caught:
        drive("slide", entry)
    (problem,) = caught.value.problems
    assert problem.code == "not-in-time"
    assert problem.location is not None and problem.location.path.endswith(key)
    if key in ("rise", "at"):
        scene = cam_text(law="cycloid")
        begin = scene.index("    segments:")
        one = entry.replace("1 s", "1 rev")
        with pytest.raises(SpecError, match="not-in-time"):
            load("scene.yaml", f"{scene[:begin]}    {one}\n{scene[scene.index('analysis') :]}")
