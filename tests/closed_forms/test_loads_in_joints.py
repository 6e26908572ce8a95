"""Thrust, dampers, friction and tables in the joints they suit, by closed forms (random scenes: tests/oracle)."""

from __future__ import annotations

import numpy as np
import pytest

from heuncli.base.errors import SpecError
from heuncli.results.results import Results
from tests.shared.scenes import near, solved

TIMES = np.linspace(0.0, 0.9, 10)
MOVED = 2e-10  # at a tolerance of 1e-11
BODY = "{mass: 2, center: [0, 0, 0], inertia: [0.3, 0.3, 0.3], points: {P: [0, 0, 0]}, "


def run(joint: str, start: str, force: str, more: str = "", body: str = BODY) -> Results:
    """One body, a ball's inertia, on a joint to the ground, with a load; no gravity."""
    times = ", ".join(repr(float(t)) for t in TIMES)
    return solved(f"heun: 1\nground: {{points: {{O: [0, 0, 0]}}}}\nbodies: {{b: {body}{start}}}}}\n{more}"
                  f"joints: {{j: {{{joint}, from: ground.O, to: b.P}}}}\nforces: {{f: {{{force}, joint: j}}}}\n"
                  f"analysis: {{times: [{times}], tolerance: 1e-11}}\n")  # fmt: skip


def powers(found: Results) -> None:
    """The force block's power is what the energy loses."""
    total = found.energy["kinetic"] + found.energy["potential"] - found.energy["work"]
    near(total, total[0], float(found.energy["kinetic"].max()), 1e-9)


@pytest.mark.parametrize(("joint", "keys", "rate", "I"), [
    ("type: pin, axis: [0, 0, 1]", "coefficient: 0.6", "angular_velocity: [0, 0, 3]", 0.3),
    ("type: cylinder, axis: [0, 0, 1]", "coefficient: 0.6", "angular_velocity: [0, 0, 3]", 0.3),
    ("type: slide, axis: [0, 0, 1]", "coefficient: 0.6", "velocity: [0, 0, 3]", 2.0),
    ("type: cylinder, axis: [0, 0, 1]", "coefficient: 9, sliding: 0.6", "velocity: [0, 0, 3]", 2.0),
    ("type: cylinder, axis: [0, 0, 1]", "sliding: 0.6", "velocity: [0, 0, 3]", 2.0),
    ("type: line, axis: [0, 0, 1]", "coefficient: 0.6", "velocity: [0, 0, 3]", 2.0),
    ("type: plane, normal: [1, 0, 0]", "coefficient: 0.6", "velocity: [0, 1.8, 2.4]", 2.0),
    ("type: ball", "coefficient: 0.6", "angular_velocity: [1, 2, 2]", 0.3),
], ids=["pin", "cylinder turning", "slide", "cylinder both", "cylinder sliding", "line", "plane", "ball"])  # fmt: skip
def test_dampers(joint: str, keys: str, rate: str, I: float) -> None:
    """The rate of 3 dies as exp(−c t / I)."""
    found = run(joint, rate, f"type: damper, {keys}")
    b = found.bodies["b"]
    turns = "angular" in rate
    speed = np.linalg.norm(b["angular_velocity"] if turns else b["velocity"], axis=1)
    near(speed, 3 * np.exp(-0.6 / I * TIMES), 3.0, MOVED)
    near(found.forces["f"]["power"], -0.6 * speed**2, 6.0, MOVED)
    powers(found)


def test_damper_of_a_universal() -> None:
    """It resists the relative turning in both of its freedoms, and the couple on the ground is the opposite."""
    cross = "type: universal, axis: [1, 0, 0], to_axis: [0, 1, 0]"
    found = run(cross, "angular_velocity: [1, 2, 0]", "type: damper, coefficient: 0.6")
    spin, moment = found.bodies["b"]["angular_velocity"], found.foundation["elements"]["f"]["moment"]
    near(moment, 0.6 * spin, 2.0, 1e-14)
    near(found.forces["f"]["power"], -0.6 * np.sum(spin**2, axis=1), 3.0, 1e-14)
    powers(found)


@pytest.mark.parametrize(("joint", "key", "start", "I"), [
    ("type: pin, axis: [0, 0, 1]", "torque", "angular_velocity: [0, 0, 3]", 0.3),
    ("type: slide, axis: [0, 0, 1]", "force", "velocity: [0, 0, 3]", 2.0),
    ("type: cylinder, axis: [0, 0, 1]", "force", "velocity: [0, 0, 3]", 2.0),
    ("type: cylinder, axis: [0, 0, 1]", "torque", "angular_velocity: [0, 0, 3]", 0.3),
], ids=["pin", "slide", "cylinder sliding", "cylinder turning"])  # fmt: skip
def test_friction(joint: str, key: str, start: str, I: float) -> None:
    """F tanh(v/s): sinh(v/s) = sinh(v0/s) exp(−F t / (I s)), from sliding into creeping."""
    F, s = 2.5 * I, 0.3
    found = run(joint, start, f"type: friction, {key}: {F}, speed: {s}")
    speed = found.bodies["b"]["angular_velocity" if "angular" in start else "velocity"][:, 2]
    wanted = s * np.arcsinh(np.sinh(3 / s) * np.exp(-F * TIMES / (I * s)))
    near(speed, wanted, 3.0, MOVED)
    near(found.forces["f"]["power"], -F * np.tanh(wanted / s) * wanted, 3 * F, MOVED * 10)
    powers(found)


def test_friction_opposes_either_way() -> None:
    forth = run("type: slide, axis: [0, 0, 1]", "velocity: [0, 0, 3]", "type: friction, force: 4, speed: 0.2")
    back = run("type: slide, axis: [0, 0, 1]", "velocity: [0, 0, -3]", "type: friction, force: 4, speed: 0.2")
    near(forth.bodies["b"]["position"], -back.bodies["b"]["position"], 3.0, 1e-14)


def test_thrust() -> None:
    """A `torque` on a slide pushes along its axis, on `to`; the opposite stands on the ground."""
    found = run("type: slide, axis: [0, 0, 2]", "velocity: [0, 0, 0]", "type: torque, value: 3*cos(2*t)")
    near(found.coordinates["j"]["travel"], 1.5 * (1 - np.cos(2 * TIMES)) / 4, 1.0, MOVED)
    near(found.forces["f"]["value"], 3 * np.cos(2 * TIMES), 3.0, 1e-14)
    near(found.forces["f"]["power"], 3 * np.cos(2 * TIMES) * found.coordinates["j"]["speed"], 3.0, 1e-14)
    near(found.foundation["elements"]["f"]["force"], np.outer(-3 * np.cos(2 * TIMES), [0, 0, 1]), 3.0, 1e-14)
    near(found.joints["j"]["force"], 0.0, 3.0, 1e-14)
    powers(found)


@pytest.mark.parametrize("joint", ["ball", "weld", "universal", "rod", "line", "plane"])
def test_no_torque_where_no_axis_turns_or_slides(joint: str) -> None:
    """Only pins and slides have the one axis a torque needs; the refusal names the joint."""
    keys = {"universal": ", axis: [1, 0, 0], to_axis: [0, 1, 0]", "line": ", axis: [1, 0, 0]",
            "plane": ", normal: [1, 0, 0]", "rod": ", length: 1"}.get(joint, "")  # fmt: skip
    with pytest.raises(SpecError) as raised:
        run(f"type: {joint}{keys}", "velocity: [0, 0, 0]", "type: torque, value: 1")
    assert raised.value.problems[0].code == "load-joint"


# ---- tables
GAS = "tables: {gas: {x: [0, 90, 360, 720], y: [1, 5, 3, 1], x_unit: deg, y_unit: bar, period: 720 deg}}\n"


def test_a_table_over_two_turns() -> None:
    """Against the angle with a period of 720 deg, in bar and degrees, counted over five turns forth and back."""
    pin = "type: pin, axis: [0, 0, 1]"
    forth = run(pin, "angular_velocity: [0, 0, 35]", "type: torque, value: 'table(gas, j.angle)*1e-9'", GAS)
    angle = forth.coordinates["j"]["angle"]
    assert angle[-1] > 31.4
    wanted = np.interp(np.degrees(angle) % 720, [0, 90, 360, 720], [1e5, 5e5, 3e5, 1e5]) * 1e-9
    near(forth.forces["f"]["value"], wanted, 5e-4, 1e-9)
    back = run(pin, "angular_velocity: [0, 0, -35]", "type: torque, value: 'table(gas, j.angle)*1e-9'", GAS)
    angle = back.coordinates["j"]["angle"]
    wanted = np.interp(np.degrees(angle) % 720, [0, 90, 360, 720], [1e5, 5e5, 3e5, 1e5]) * 1e-9
    near(back.forces["f"]["value"], wanted, 5e-4, 1e-9)


def test_tables_against_travel_and_time() -> None:
    """A spring with a kinked characteristic, held outside its range, and a pulse in time; both with units."""
    slide = "type: slide, axis: [0, 0, 1]"
    spring = "tables: {bump: {x: [-50, 0, 100], y: [2, 0, -8], x_unit: mm, y_unit: kN, outside: hold}}\n"
    found = run(slide, "velocity: [0, 0, 3]", "type: torque, value: 'table(bump, j.travel)*1e-2'", spring)
    wanted = np.interp(found.coordinates["j"]["travel"], [-0.05, 0, 0.1], [20.0, 0, -80.0])
    assert found.coordinates["j"]["travel"].max() > 0.1
    near(found.forces["f"]["value"], wanted, 80.0, 1e-12)
    pulse = "tables: {pulse: {x: [0, 200, 300, 1000], y: [0, 4, 1, 1], x_unit: ms, y_unit: N}}\n"
    found = run(slide, "velocity: [0, 0, 0]", "type: torque, value: 'table(pulse, t)'", pulse)
    near(found.forces["f"]["value"], np.interp(TIMES, [0, 0.2, 0.3, 1], [0, 4, 1, 1]), 4.0, 1e-12)
    impulse = np.array([np.trapezoid(*pulsed(t)) for t in TIMES])
    near(found.coordinates["j"]["speed"], impulse / 2.0, 1.0, 1e-12)  # pieces of parabolas: the method is exact on them


def pulsed(t: float) -> tuple[np.ndarray, np.ndarray]:
    """The pulse's knots up to t: what a trapezoid rule needs for its exact impulse."""
    x = np.array([k for k in (0.0, 0.2, 0.3) if k < t] + [t])
    return np.interp(x, [0, 0.2, 0.3, 1], [0, 4, 1, 1]), x
