"""Wheels that lift or slip, are struck, start where they do not stand, or share a load: by hand."""

from __future__ import annotations

import numpy as np
import pytest

from heuncli.analyses.lagrange.freed_scene import make_instant
from heuncli.base.errors import SolveError
from heuncli.results.results import Results
from heuncli.scene.file_format.load import load
from tests.shared.scenes import near, solved

G = 9.81

CART = """
heun: 1
space: planar
gravity: [0, -9.81, 0]
ground: {points: {O: [0, 0, 0]}}
bodies:
  frame: {mass: 10, center: [0, 0.5, 0], inertia: 1, points: {r: [-0.5, 0, 0], f: [0.5, 0, 0]}, position: [0, 0.1, 0],
          velocity: [5, 0, 0]}
  rear: {mass: 1, center: [0, 0, 0], inertia: 0.005, points: {c: [0, 0, 0]}}
  front: {mass: 1, center: [0, 0, 0], inertia: 0.005, points: {c: [0, 0, 0]}}
joints:
  axle_r: {type: pin, from: frame.r, to: rear.c, axis: [0, 0, 1]}
  axle_f: {type: pin, from: frame.f, to: front.c, axis: [0, 0, 1]}
forces: {brake: {type: torque, joint: axle_f, value: "30*t"}}
rolling:
  rear_tyre: {wheel: rear.c, radius: 0.1, on: ground.O, normal: [0, 1, 0]}
  front_tyre: {wheel: front.c, radius: 0.1, on: ground.O, normal: [0, 1, 0], friction: 0.8}
analysis: {duration: 1, samples: 3}
"""


LIFTS = "the wheel rear_tyre lifts off: its plane would have to pull it"


def slowed(torque: float) -> tuple[float, float, float]:
    """By a brake on the front axle: what the rear and the front wheel bear, and the front one's friction [N].

    (M + 2 J / R^2) a = torque / R; moments about the contacts, wheels and all slowed by a.
    """
    a = torque / 0.1 / (12 + 2 * 0.005 / 0.01)
    moved = 10 * 0.6 * a + 2 * 0.1 * a + 2 * 0.005 * a / 0.1  # to the front, at a wheel base of 1 m
    return 6 * G - moved, 6 * G + moved, torque / 0.1 - 1.0 * 0.005 / 0.01 * a


def test_a_cart_that_tips_ends_the_run_with_its_reason() -> None:
    """The brake grows until the rear wheel bears nothing; the front one has slipped before."""
    r = solved(CART)
    per = (6 * G - slowed(1.0)[0]) / 1.0
    lifts = 6 * G / per / 30
    assert r.status["code"] == "stopped"
    assert "rear_tyre lifts" in r.status["message"]
    assert r.time[-1] == pytest.approx(lifts, abs=1e-7)
    assert r.events["rear_tyre_lifts"]["time"] == pytest.approx([lifts], abs=1e-7)
    # friction F = k T reaches 0.8 (6 G + per T)
    k = slowed(1.0)[2]
    slips = 0.8 * 6 * G / (k - 0.8 * per) / 30
    assert r.events["front_tyre_slips"]["time"] == pytest.approx([slips], abs=1e-7)
    assert any("front_tyre slips" in warning for warning in r.warnings)
    own = r.couplings["front_tyre"]
    rear, front, friction = slowed(30 * float(r.time[1]))
    near(own["normal"][1], front, 100.0)
    near(own["friction"][1], friction, 100.0)
    near(own["grip"][1], 0.8 * front - friction, 100.0)
    near(r.couplings["rear_tyre"]["normal"][1], rear, 100.0)


def test_a_wheel_that_lifts_from_the_start_on_ends_the_run_there() -> None:
    """As a rope that would have to push does: 15 N m lift the rear wheel, until they would let go of it."""
    r = solved(CART.replace('"30*t"', '"15 - 30*t"'))
    assert r.status == {"code": "stopped", "message": f"at the start {LIFTS}"}
    assert f"stopped before the end: at the start {LIFTS}" in r.warnings
    assert r.time.tolist() == [0.0]
    assert r.events["rear_tyre_lifts"]["begins"]
    near(r.couplings["rear_tyre"]["normal"][0], slowed(15)[0], 100.0)


def test_held_wheels_are_pulled() -> None:
    """On a rail that holds them on both sides nothing lifts."""
    r = solved(CART.replace("on: ground.O,", "on: ground.O, held: true,"))
    assert r.status["code"] == "completed"
    near(r.couplings["rear_tyre"]["normal"], [slowed(30 * t)[0] for t in r.time], 100.0)
    assert "rear_tyre_lifts" not in r.events


def test_at_one_instant_a_warning_says_so() -> None:
    """A state has no events."""
    r = solved(CART.replace('"30*t"', "15").replace("analysis: {duration: 1, samples: 3}", "analysis: {type: state}"))
    assert [w for w in r.warnings if "rear_tyre would have to be pulled" in w]
    assert [w for w in r.warnings if "front_tyre would need more friction" in w]


def test_a_blow_through_the_wheels() -> None:
    """S on the frame along the road: all of the cart with its wheels' inertia takes it, without slip."""
    blow = CART.replace('"30*t"', "0").replace("velocity: [5, 0, 0]", "velocity: [0, 0, 0]")
    blow = blow.replace("duration: 1, samples: 3", "type: impulse")
    r = solved(blow + "impulses: {kick: {on: frame.r, vector: [-26, 0, 0]}}\n")
    jump = r.impulses[0]["bodies"]["frame"]["center_velocity_jump"]
    near(jump, [-26 / 13, 0, 0], 1.0)
    assert any("in the impulse" in w and "lifts" in w for w in r.warnings)


DISC = """
heun: 1
gravity: [0, 0, -9.81]
ground: {points: {O: [0, 0, 0]}}
bodies:
  disc: {mass: 2, center: [0, 0, 0], inertia: [0.0225, 0.045, 0.0225], points: {c: [0, 0, 0]}, START}
rolling:
  rim: {wheel: disc.c, axis: [0, 1, 0], radius: 0.3, on: ground.O, normal: [0, 0, 1]}
analysis: {duration: 1, samples: 3}
"""


def of_disc(start: str) -> Results:
    """The run of a disc from a start."""
    return solved(DISC.replace("START", start))


def test_a_wheel_without_a_place_is_put_on_its_plane_and_rolls() -> None:
    """What is left out follows: the height, and the speed of what spins; the attitude stays."""
    r = of_disc("angular_velocity: [0, 2, 0]")
    near(r.bodies["disc"]["position"][0], [0, 0, 0.3], 1.0)
    near(r.bodies["disc"]["velocity"][0], [0.6, 0, 0], 1.0)
    near(r.bodies["disc"]["rotation"][0], np.eye(3), 1.0)


@pytest.mark.parametrize(
    ("start", "code"),
    [
        ("position: [0, 0, 0.35]", "does-not-fit"),
        ("position: [0, 0, -0.3]", "does-not-fit"),
        ("orientation: {axis: [1, 0, 0], angle: 90 deg}", "does-not-fit"),
        ("position: [0, 0, 0.3], velocity: [1, 0, 0], angular_velocity: [0, 2, 0]", "rates-do-not-fit"),
        ("position: [0, 0, 0.3], velocity: [0, 1, 0], angular_velocity: [0, 0, 0]", "rates-do-not-fit"),
    ],
)
def test_starts_that_do_not_roll_are_refused(start: str, code: str) -> None:
    """Above the plane, below it, with slip along the track or aside."""
    with pytest.raises(SolveError) as error:
        of_disc(start)
    (problem,) = error.value.problems
    assert (problem.code, problem.entry_path) == (code, "rolling.rim")
    assert problem.hint


FOUR = """
heun: 1
gravity: [0, 0, -9.81]
ground: {points: {O: [0, 0, 0]}}
bodies:
  cart: {mass: 20, center: [0.1, 0, 0.3], inertia: [1, 2, 2], position: [0, 0, 0.1], velocity: [1, 0, 0],
         points: {fl: [0.5, 0.3, 0], fr: [0.5, -0.3, 0], rl: [-0.5, 0.3, 0], rr: [-0.5, -0.3, 0]}}
  fl: WHEEL
  fr: WHEEL
  rl: WHEEL
  rr: WHEEL
joints:
  jfl: {type: pin, from: cart.fl, to: fl.c, axis: [0, 1, 0]}
  jfr: {type: pin, from: cart.fr, to: fr.c, axis: [0, 1, 0]}
  jrl: {type: pin, from: cart.rl, to: rl.c, axis: [0, 1, 0]}
  jrr: {type: pin, from: cart.rr, to: rr.c, axis: [0, 1, 0]}
rolling:
  wfl: {wheel: fl.c, axis: [0, 1, 0], radius: 0.1, on: ground.O, normal: [0, 0, 1]}
  wfr: {wheel: fr.c, axis: [0, 1, 0], radius: 0.1, on: ground.O, normal: [0, 0, 1]}
  wrl: {wheel: rl.c, axis: [0, 1, 0], radius: 0.1, on: ground.O, normal: [0, 0, 1]}
  wrr: {wheel: rr.c, axis: [0, 1, 0], radius: 0.1, on: ground.O, normal: [0, 0, 1]}
analysis: {duration: 1, samples: 3}
""".replace("WHEEL", "{mass: 1, center: [0, 0, 0], inertia: [0.003, 0.005, 0.003], points: {c: [0, 0, 0]}}")


def test_of_four_wheels_only_sums_are_certain() -> None:
    """What each bears is open, and ends no run; the front two together bear by the lever of the weight."""
    r = solved(FOUR)
    assert r.status["code"] == "completed"
    for name in ("wfl", "wfr", "wrl", "wrr"):
        own = r.couplings[name]
        assert np.isnan(own["normal"]).all()
        assert np.isnan(own["aside"]).all()
        near(own["along"], np.zeros(3), 100.0)
        assert {"normal", "aside", "friction", "force"} <= set(own["open"])
    terms = [(own["terms"], own["value"]) for own in r.certain_sums]
    front = next(value for t, value in terms if set(t) == {"joints.jfl.force.z", "joints.jfr.force.z"})
    near(front, -20 * G * 0.6, 100.0)
    wheel = next(t for t, _ in terms if "couplings.wfl.normal" in t)
    assert set(wheel) == {"joints.jfl.force.z", "couplings.wfl.normal"}


BALL = """
heun: 1
gravity: [0, 0, -9.81]
ground: {points: {O: [0, 0, 0]}}
bodies:
  ball: {mass: 3, center: [0, 0, 0], inertia: [0.1, 0.1, 0.1], points: {c: [0, 0, 0]}, position: [0, 0, 0.2]}
rolling:
  one: {wheel: ball.c, shape: sphere, radius: 0.2, on: ground.O, normal: [0, 0, 1]}
  two: {wheel: ball.c, shape: sphere, radius: 0.2, on: ground.O, normal: [0, 0, 1]}
analysis: {type: state}
"""


@pytest.mark.parametrize("least_norm", [False, True])
def test_two_contacts_of_one_ball_bear_it_together_where_there_is_no_joint(least_norm: bool) -> None:
    """What each bears is open, however it is asked for: nothing is weighed between contacts."""
    r = solved(BALL, least_norm=least_norm)
    near(r.foundation["force"], [[0.0, 0.0, -3 * G]], 100.0)
    for name in ("one", "two"):
        assert np.isnan(r.couplings[name]["normal"]).all()
    terms = [(set(own["terms"]), own["value"]) for own in r.certain_sums]
    near(next(value for t, value in terms if t == {"couplings.one.normal", "couplings.two.normal"}), 3 * G, 100.0)


def test_no_rest_pose_that_a_wheel_rolls_to() -> None:
    """An eccentric disc would roll to where its centre of mass is lowest: where that is hangs on the way."""
    text = DISC.replace("START", "").replace("center: [0, 0, 0]", "center: [0.05, 0, 0]").replace(", }", "}")
    with pytest.raises(SolveError, match="no-rest-pose"):
        solved(text.replace("duration: 1, samples: 3", "type: rest"))
    r = solved(text.replace("[0.05, 0, 0]", "[0, 0, -0.05]").replace("duration: 1, samples: 3", "type: rest"))
    near(r.couplings["rim"]["normal"], [2 * G], 20.0)


def test_no_lagrange_of_speeds_that_no_coordinates_have() -> None:
    """In space; in the plane a wheel's coordinate is its turn."""
    with pytest.raises(SolveError, match="no-coordinate"):
        make_instant(load("disc.yaml", DISC.replace("START", "velocity: [0.6, 0, 0]")), None, None)
    assert make_instant(load("cart.yaml", CART), None, None).linear_equations is not None
