"""Springs, dampers, motors by laws of what they act between; brakes of a size in time: closed forms, refusals."""

from __future__ import annotations

import numpy as np
import pytest

from heuncli.base.errors import SolveError, SpecError
from heuncli.scene.expressions import composition
from heuncli.scene.expressions.grammar import compile_expression
from heuncli.scene.expressions.scope import Scope
from tests.shared.scenes import near, solved

BLOCK = """
heun: 1
parameters: {{k: 40 N/m, far: 0.3}}
tables:
  coil: {{x: [-1, 0, 2], y: [40, 0, -80]}}
  torq: {{x: [-1000, 0, 200, 400], y: [20, 20, 20, 0]}}
  short: {{x: [0, 30], y: [5, 3]}}
ground: {{points: {{O: [0, 0, 0], P: [0, 0, 0.5]}}}}
bodies:
  m: {{mass: 2, center: [0, 0, 0], inertia: [0.1, 0.1, 0.1], points: {{c: [0, 0, 0]}}, position: [0.8, 0, 0]}}
  d: {{mass: 2, center: [0, 0, 0], inertia: [0.1, 0.1, 0.1], points: {{c: [0, 0, 0]}}}}
joints:
  guide: {{type: slide, from: ground.O, to: m.c, axis: [1, 0, 0], initial: {{travel: 0.8, speed: 0.4}}}}
  shaft: {{type: pin, from: ground.P, to: d.c, axis: [0, 0, 1], initial: {{angle: 0.4, rate: 2}}}}
  tube: {{type: cylinder, from: ground.P, to: d.c, axis: [0, 0, 1]}}
forces: {{f: {load}}}
analysis: {analysis}
"""
RUN = "{duration: 1, samples: 11, tolerance: 1e-12}"


def block(load: str, analysis: str = RUN) -> str:
    return BLOCK.format(load=load, analysis=analysis)


@pytest.mark.parametrize(
    ("numbers", "law"),
    [
        ("type: spring, from: ground.O, to: m.c, stiffness: 40, length: 0.3, damping: 3",
         "type: spring, from: ground.O, to: m.c, force: -k*(length - far) - 3*rate"),
        ("type: spring, from: m.c, to: ground.P, stiffness: 40, length: 0.3, damping: 3",
         'type: spring, from: ground.P, to: m.c, force: "table(coil, length - 0.3) - 3*rate"'),
        ("type: turn_spring, joint: shaft, stiffness: 40, angle: 0.1, damping: 3",
         'type: turn_spring, joint: shaft, torque: "table(coil, angle - 0.1) - 3*rate"'),
        ("type: damper, joint: shaft, coefficient: 3", "type: damper, joint: shaft, torque: -3*rate"),
        ("type: damper, joint: guide, coefficient: 3", "type: damper, joint: guide, force: -3*speed"),
        ("type: friction, joint: shaft, torque: 3, speed: 0.1",
         'type: friction, joint: shaft, torque: "3 + 0*t", speed: 0.1'),
    ],
)  # fmt: skip
@pytest.mark.heavy
def test_a_law_says_what_numbers_say(numbers: str, law: str) -> None:
    """The same motion and the same value; what has no potential then is work."""
    wanted, found = solved(block(f"{{{numbers}}}")), solved(block(f"{{{law}}}"))
    for name in ("guide", "shaft"):
        for quantity, values in wanted.coordinates[name].items():
            near(found.coordinates[name][quantity], values, 50.0, 1e-9)
    near(found.forces["f"]["value"], wanted.forces["f"]["value"], 50.0, 1e-9)
    for told in (wanted, found):
        e = told.energy
        near(e["kinetic"] + e["potential"] - e["work"], e["kinetic"][0] + e["potential"][0], 20.0, 1e-10)


def test_a_motor_through_a_gear() -> None:
    """J w' = n (20) up to the knee at 200 rad/s of the motor, then n (40 - n w/10): the exponential approach."""
    n = 50.0
    found = solved(block(f"{{type: motor, joint: shaft, curve: torq, ratio: {n}}}",
                         "{times: [0, 0.0001, 0.0005], tolerance: 1e-12}").replace("rate: 2", "rate: 0"))  # fmt: skip
    w, t = found.coordinates["shaft"]["rate"], found.time
    knee = 0.1 * (200 / n) / (n * 20)
    early = t <= knee
    fall = n * n / 10 / 0.1
    wanted = np.where(early, n * 20 / 0.1 * t, 400 / n - 200 / n * np.exp(-fall * (t - knee)))
    near(w, wanted, 8.0, 1e-9)
    near(found.forces["f"]["power"], found.forces["f"]["value"] * w, 1e4, 1e-12)
    assert early.tolist() == [True, True, False]


def test_a_motor_held_back() -> None:
    """Its limit is that of the motor's own torque, and its control a factor in time."""
    load = '{type: motor, joint: shaft, curve: "30 - rate", ratio: 2, limit: 12, value: "0.5 if t < 0.5 else 1"}'
    found = solved(block(load, "{times: [0, 0.2, 0.5, 1], tolerance: 1e-12}"))
    rate = found.coordinates["shaft"]["rate"]
    control = np.where(found.time < 0.5, 0.5, 1.0)
    near(found.forces["f"]["value"], 2 * control * np.clip(30 - 2 * rate, -12, 12), 24.0, 1e-10)


def test_a_brake_with_a_ramp() -> None:
    """J w' = -T t/t0 until t0, then -T: while the drum turns fast against `speed`."""
    found = solved(block(
        '{type: friction, joint: shaft, torque: "2*min(t/0.2, 1)", speed: 1e-3}',
        "{times: [0, 0.1, 0.2, 0.3], tolerance: 1e-12}",
    ).replace("rate: 2", "rate: 20"))  # fmt: skip
    t = found.time
    wanted = 20 - 20 * np.where(t < 0.2, t**2 / 0.4, t - 0.1)
    near(found.coordinates["shaft"]["rate"], wanted, 20.0, 1e-10)


def test_beyond_its_table() -> None:
    """A motor faster than its curve tells ends the run, as every table does that does not hold its ends."""
    with pytest.raises(SolveError) as refused:
        solved(block("{type: motor, joint: shaft, curve: short, ratio: 10}"))
    (problem,) = refused.value.problems
    assert problem.code == "no-value" and "table short covers x from 0 to 30" in problem.message


MOUNT = "type: bushing, from: ground.O, to: m.c"


@pytest.mark.parametrize(
    ("load", "code"),
    [
        (f"{{{MOUNT}, stiffness: [1, -2, 3]}}", "negative"),
        (f"{{{MOUNT}, stiffness: {{x: 5, y: -2}}}}", "negative"),
        (f"{{{MOUNT}, turning_damping: -1}}", "negative"),
        (f"{{{MOUNT}, stiffness: [1, 2]}}", "wrong-length"),
        (f"{{{MOUNT}, stiffness: {{x: 1, w: 2}}}}", "unknown-key"),
        (f"{{{MOUNT}, stiffness: {{x: nothing}}}}", "unknown-name"),
        (f"{{{MOUNT}, stiffness: 1 N}}", "dimension"),
        (f"{{{MOUNT}, turning: 1 N/m}}", "dimension"),
        (f"{{{MOUNT}}}", "load-form"),
        ("{type: bushing, from: ground.O, to: ground.P, stiffness: 3}", "same-point"),
        (f"{{{MOUNT}, stiffness: 3, orientation: {{axis: [0, 0, 0], angle: 1}}}}", "orientation"),
        (f"{{{MOUNT}, stiffness: 3, stifness: 3}}", "unknown-key"),
        ("{type: spring, from: ground.O, to: m.c}", "missing-key"),
        ("{type: turn_spring, joint: shaft}", "missing-key"),
        ("{type: turn_spring, joint: shaft, torque: -angle, stiffness: 2}", "load-form"),
        ("{type: turn_spring, joint: tube, torque: -angle}", "load-joint"),
        ("{type: damper, joint: guide, torque: -rate}", "load-joint"),
        ("{type: damper, joint: tube, torque: -rate}", "load-joint"),
        ("{type: motor, joint: guide, curve: torq}", "load-joint"),
        ("{type: motor, joint: shaft, curve: torq, ratio: 0}", "motor"),
        ("{type: motor, joint: shaft, curve: torq, limit: -3}", "negative"),
        ("{type: motor, joint: shaft, curve: 30 - speed}", "unknown-name"),
        ("{type: spring, from: ground.O, to: m.c, force: -k*length*length}", "wrong-dimension"),
        ('{type: friction, joint: shaft, torque: "1 - 3*t", speed: 1}', "brake"),
        ("{type: friction, joint: shaft, torque: shaft.angle, speed: 1}", "brake"),
        ("{type: torque, joint: shaft, value: rate}", "unknown-name"),
    ],
)  # fmt: skip
def test_refused(load: str, code: str) -> None:
    with pytest.raises(SpecError) as refused:
        solved(block(load))
    assert code in {problem.code for problem in refused.value.problems}
    assert all(problem.hint for problem in refused.value.problems)


@pytest.mark.parametrize("more", ["preload: [0, 0, 1]", "turning_preload: [1, 0, 0]",
                                  "orientation: {axis: [1, 0, 0], angle: 1}"])  # fmt: skip
def test_refused_in_a_plane(more: str) -> None:
    """What would push or turn out of a plane that was declared."""
    text = """
heun: 1
space: planar
ground: {points: {O: [0, 0, 0]}}
bodies: {m: {mass: 2, center: [0, 0, 0], inertia: 0.1, points: {c: [0, 0, 0]}}}
forces: {f: {type: bushing, from: ground.O, to: m.c, stiffness: [1, 2, 3], turning: 3%s}}
"""
    solved(text % ", orientation: {axis: [0, 0, 1], angle: 1}, preload: [1, 2, 0]")
    with pytest.raises(SpecError, match="in a planar model"):
        solved(text % f", {more}")


def test_a_parameter_of_the_same_name() -> None:
    """It would be a guess which of the two is meant."""
    text = block("{type: spring, from: ground.O, to: m.c, force: -k*length}").replace("far: 0.3", "length: 0.3")
    with pytest.raises(SpecError, match="'length' is both a parameter"):
        solved(text)


@pytest.mark.parametrize("text", [
    "own.rate if own.rate > 3 else 2*own.rate*j.angle", "min(own.rate, 4)*t", "table(c, own.rate) + own.rate**2",
    "(1 if j.angle > own.rate else 2) if own.rate < 1 else sign(own.rate)",
])  # fmt: skip
def test_a_coordinate_told_otherwise(text: str) -> None:
    """f(factor x), times g, within a limit: as the values are, on every branch."""
    from heuncli.scene.expressions.curves import interpolate_points

    tables = {
        "c": interpolate_points(
            "c", np.array([-20.0, 0.0, 2.0, 20.0]), np.array([1.0, 2.0, 5.0, 1.0]), "linear", None, None
        )
    }
    scope = Scope(joints={"own": "pin", "j": "pin"}, tables=tables, in_time=True)
    f = compile_expression(text, scope)
    g = compile_expression("3 + j.angle*abs(t - 1)", scope)
    scaled = composition.scale_coordinate(f, ("own", "rate"), 2.5)
    limited = composition.limit_magnitude(composition.multiply_expressions(g, scaled), 7.0)
    for t in (0.5, 1.5):
        for rate in (-1.3, 0.3, 2.0, 5.0):
            for angle in (-2.0, 0.7, 1.4):
                at = {("own", "rate"): 2.5 * rate, ("j", "angle"): angle}
                wanted = f.value(t, [at[use] for use in f.uses])
                own = {("own", "rate"): rate, ("j", "angle"): angle}
                assert scaled.value(t, [own[use] for use in scaled.uses]) == wanted
                whole = (3 + angle * abs(t - 1)) * wanted
                found = limited.value(t, [own[use] for use in limited.uses])
                assert found == pytest.approx(min(max(whole, -7.0), 7.0), rel=1e-15)
    assert (
        composition.multiply_expressions(compile_expression("2", scope), compile_expression("3", scope)).constant == 6.0
    )


PULSE = """
heun: 1
ground: {{points: {{O: [0, 0, 0]}}}}
tables: {{spike: {{x: [-90, 0.5, 0.50005, 0.5001, 90], y: [0, 0, 400, 0, 0]}},
          twist: {{x: [-4, 0.5, 0.50005, 0.5001, 4], y: [0, 0, 400, 0, 0]}}}}
bodies:
  m: {{mass: 2, center: [0, 0, 0], inertia: [0.1, 0.2, 0.3], points: {{c: [0, 0, 0]}}, position: [0.1, {aside}, 0],
       velocity: [3, 0, 0], angular_velocity: [0, 0, 2]}}
forces: {{f: {{{load}}}}}
analysis: {{times: [0, 0.9], tolerance: 1e-10}}
"""
WORK = 400 * 0.5e-4  # of the triangle


@pytest.mark.heavy
@pytest.mark.parametrize(
    ("load", "work", "aside"),
    [
        ('type: spring, from: ground.O, to: m.c, force: "table(spike, length)"', WORK, 0.0),
        ('type: spring, from: m.c, to: ground.O, force: "400 if 0.5 < length < 0.5001 else 0"', 2 * WORK, 0.0),
        ('type: spring, from: ground.O, to: m.c, force: "table(spike, length)"', WORK, 0.2),
        ("type: bushing, from: ground.O, to: m.c, stiffness: {x: spike}", -WORK, 0.2),
        ("type: bushing, from: ground.O, to: m.c, turning: {z: twist}", -WORK, 0.0),
        ("type: bushing, from: m.c, to: ground.O, turning: {z: twist}, to_orientation: {axis: [0, 0, 1], angle: 1.7}",
         WORK, 0.0),
    ],
)  # fmt: skip
def test_what_acts_for_a_moment_is_not_stepped_over(load: str, work: float, aside: float) -> None:
    """A spike a ten-thousandth wide, passed in a hundredth of a step: the work that it does, and no more."""
    found = solved(PULSE.format(load=load, aside=aside))
    near(found.energy["kinetic"], found.energy["kinetic"][0] + np.array([0.0, work]), 9.0, 1e-8)
