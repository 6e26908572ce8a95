"""Latches on one cart and one panel: when they catch, at what, what they bear, and when they let go."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
import pytest

from heuncli.base.errors import SolveError
from heuncli.results.results import Results
from tests.shared.scenes import near, solved

CART = """
heun: 1
ground: {points: {O: [0, 0, 0]}}
bodies:
  cart: {mass: 2, center: [0, 0, 0], inertia: [0.01, 0.01, 0.01], points: {o: [0, 0, 0]}}
joints:
  rail: {type: slide, from: ground.O, to: cart.o, axis: [1, 0, 0], initial: {travel: 0, speed: 1}}
"""


def cart(more: str, times: str = "[0, 0.1, 0.3, 0.5, 0.7]") -> Results:
    """A cart of 2 kg that starts with 1 m/s."""
    return solved(f"{CART}{more}\nanalysis: {{times: {times}}}\n")


def travel(found: Results) -> Any:
    return found.coordinates["rail"]["travel"]


def event(found: Results, name: str) -> tuple[bool, list[float], list[bool]]:
    own = found.events[name]
    return bool(own["begins"]), own["time"].tolist(), list(own["to"])


def test_it_catches_at_the_first_touch_whatever_the_restitution() -> None:
    """At 0.2 s, with all of the kinetic energy 1 J lost and the momentum 2 N s taken; the stop bears nothing."""
    found = cart("stops: {end: {joint: rail, travel: [null, 0.2], restitution: 0.5}}\nlatches: {click: {stop: end}}")
    (blow,) = found.impulses
    assert blow["names"] == ["click"]
    near(blow["time"], 0.2, 1.0, 1e-12)
    near(blow["energy_jump"], -1.0, 1.0, 1e-12)
    near([blow["stops"]["click"]["force"], blow["stops"]["end"]["force"]], [-2.0, 0.0], 1.0, 1e-12)
    near(blow["foundation"]["force"], [2.0, 0.0, 0.0], 1.0, 1e-12)
    near(travel(found), [0.0, 0.1, 0.2, 0.2, 0.2], 1.0, 1e-12)
    assert event(found, "click")[2] == [True]


def test_it_bears_in_both_senses() -> None:
    """Pushed on, the stop alone would bear; pulled back, it would let go."""
    more = "stops: {end: {joint: rail, travel: [null, 0.2]}}\nlatches: {click: {stop: end}}\n"
    found = cart(more + 'forces: {push: {type: torque, joint: rail, value: "3 if t < 0.4 else -5"}}')
    near(found.stops["click"]["force"], [0.0, 0.0, -3.0, 5.0, 5.0], 1.0, 1e-12)
    near(found.stops["end"]["force"], np.zeros(5), 1.0, 0.0)
    near(travel(found)[2:], [0.2, 0.2, 0.2], 1.0, 1e-12)


@pytest.mark.parametrize("limit", ["lower", "upper"])
def test_it_catches_at_the_limit_that_is_meant(limit: str) -> None:
    """Between limits without loss: at 0.2 after 0.2 s, or at -0.1 after 0.5 s."""
    stop = "stops: {end: {joint: rail, travel: [-0.1, 0.2], restitution: 1}}\n"
    found = cart(f"{stop}latches: {{click: {{stop: end, limit: {limit}}}}}", "[0, 1]")
    t, at = {"upper": (0.2, 0.2), "lower": (0.5, -0.1)}[limit]
    near(event(found, "click")[1], [t], 1.0, 1e-12)
    near(travel(found)[-1], at, 1.0, 1e-12)


def test_what_rests_at_its_stop_is_caught_without_a_blow() -> None:
    """From 0.3 s the latch bears what the stop did, and from 0.5 s the stop again."""
    more = "forces: {push: {type: torque, joint: rail, value: 3}}\nstops: {end: {joint: rail, travel: [null, 0.1]}}\n"
    found = cart(more + "latches: {click: {stop: end, when: t > 0.3, release: t > 0.5}}", "[0, 0.2, 0.4, 0.6]")
    assert [blow["names"] for blow in found.impulses] == [["end"]]
    near(found.stops["click"]["force"], [0.0, 0.0, -3.0, 0.0], 1.0, 1e-12)
    near(found.stops["end"]["force"], [0.0, -3.0, 0.0, -3.0], 1.0, 1e-12)
    near(event(found, "click")[1], [0.3, 0.5], 1.0, 1e-12)


def test_a_condition_that_is_the_limit_itself_is_true_at_the_touch() -> None:
    stop = "stops: {end: {joint: rail, travel: [null, 0.2], restitution: 1}}\n"
    found = cart(stop + "latches: {click: {stop: end, when: rail.travel >= 0.2}}")
    near(event(found, "click")[1], [0.2], 1.0, 1e-12)


def test_what_is_drawn_back_at_the_touch_does_not_catch() -> None:
    stop = "stops: {end: {joint: rail, travel: [null, 0.2], restitution: 0.5}}\n"
    found = cart(stop + "latches: {click: {stop: end, release: rail.travel >= 0.2, every: true}}")
    assert event(found, "click") == (False, [], [])
    near(travel(found), [0.0, 0.1, 0.15, 0.05, -0.05], 1.0, 1e-12)


def test_what_leaves_as_the_condition_becomes_true_is_not_caught() -> None:
    """Thrown back at 0.2 s: then its speed is below 0.5, but it is on its way."""
    stop = "stops: {end: {joint: rail, travel: [null, 0.2], restitution: 1}}\n"
    found = cart(stop + "latches: {click: {stop: end, when: rail.speed < 0.5}}")
    assert event(found, "click") == (False, [], [])
    near(travel(found)[-1], -0.3, 1.0, 1e-12)


def test_it_holds_where_the_coordinate_is() -> None:
    """Caught at 0.3 m after 0.3 s, let go at rest after 0.5 s, then pushed."""
    found = cart(
        'forces: {push: {type: torque, joint: rail, value: "4 if t > 0.4 else 0"}}\n'
        "latches: {brake: {joint: rail, when: t > 0.3, release: t > 0.5}}"
    )
    near(travel(found), [0.0, 0.1, 0.3, 0.3, 0.3 + 0.5 * 2.0 * 0.2**2], 1.0, 1e-11)
    (blow,) = found.impulses
    near([blow["energy_jump"], blow["stops"]["brake"]["force"]], [-1.0, -2.0], 1.0, 1e-12)


def test_without_a_condition_it_holds_from_the_start() -> None:
    """A given speed is lost there; it goes on from rest."""
    found = cart(
        "latches: {pin: {joint: rail, release: t > 0.3}}\nforces: {push: {type: torque, joint: rail, value: 4}}"
    )
    assert event(found, "pin")[0] is True
    near(found.impulses[0]["time"], 0.0, 1.0, 0.0)
    near(travel(found), [0.0, 0.0, 0.0, 0.5 * 2.0 * 0.2**2, 0.5 * 2.0 * 0.4**2], 1.0, 1e-11)


def test_it_catches_what_comes_through_its_value_from_either_side() -> None:
    """x = sin(4 t)/4: at 0.125 on the way back, as the latch is not out before."""
    more = "forces: {spring: {type: torque, joint: rail, value: -32*rail.travel}}\n"
    found = cart(more + "latches: {notch: {joint: rail, travel: 0.125, when: t > 0.2}}", "[0, 1]")
    near(event(found, "notch")[1], [math.radians(150) / 4], 1.0, 1e-9)
    near(travel(found)[-1], 0.125, 1.0, 1e-12)
    near(found.stops["notch"]["force"][-1], 32 * 0.125, 1.0, 1e-9)


@pytest.mark.parametrize(("every", "times"), [("false", [0.1, 0.15]), ("true", [0.1, 0.15, 0.2, 0.25])])
def test_every(every: str, times: list[float]) -> None:
    """Held at the instants 0.1 to 0.15 s; and 0.2 to 0.25 s if it catches again."""
    when = "(0.1 < t and t < 0.12) or (0.2 < t and t < 0.22)"
    release = "(0.15 < t and t < 0.17) or 0.25 < t"
    more = "forces: {push: {type: torque, joint: rail, value: 4}}\n"
    latch = f'{{joint: rail, when: "{when}", release: "{release}", every: {every}}}'
    found = cart(f"{more}latches: {{brake: {latch}}}", "[0, 0.4]")
    near(event(found, "brake")[1], times, 1.0, 1e-12)


def test_a_condition_that_is_never_true_changes_nothing() -> None:
    found = cart("latches: {brake: {joint: rail, when: rail.travel > 5, release: t > 0.5}}")
    assert event(found, "brake") == (False, [], [])
    assert not found.impulses
    near(travel(found), [0.0, 0.1, 0.3, 0.5, 0.7], 1.0, 1e-12)


def test_one_latch_catches_as_the_other_lets_go() -> None:
    """Both are out from the start; the cart never moves, and the load goes over."""
    found = cart(
        "forces: {push: {type: torque, joint: rail, value: 4}}\n"
        "latches: {first: {joint: rail, release: t > 0.4}, second: {joint: rail, when: t > 0.2}}",
    )
    near(found.stops["first"]["force"], [-4.0, -4.0, -4.0, 0.0, 0.0], 1.0, 1e-12)
    near(found.stops["second"]["force"], [0.0, 0.0, 0.0, -4.0, -4.0], 1.0, 1e-12)
    near(travel(found), np.zeros(5), 1.0, 1e-12)


def test_what_a_drive_moves_on_is_not_caught() -> None:
    """The second slide is driven along by the first, through a rod between carts that run in one line."""
    scene = """
heun: 1
ground: {points: {O: [0, 0, 0]}}
bodies:
  a: {mass: 1, center: [0, 0, 0], inertia: [1, 1, 1], points: {o: [0, 0, 0]}}
  b: {mass: 1, center: [0, 0, 0], inertia: [1, 1, 1], points: {o: [0, 0, 0]}, position: [1, 0, 0]}
joints:
  front: {type: slide, from: ground.O, to: a.o, axis: [1, 0, 0]}
  rear: {type: slide, from: ground.O, to: b.o, axis: [1, 0, 0]}
  bar: {type: rod, from: a.o, to: b.o}
drives: {motor: {joint: front, travel: 2*t}}
latches: {brake: {joint: rear, when: t > 0.2}}
analysis: {duration: 1}
"""
    with pytest.raises(SolveError) as caught:
        solved(scene)
    assert [p.code for p in caught.value.problems] == ["latch-contradicts"]


def test_at_rest_it_holds_what_it_holds_at_the_start() -> None:
    """A rest pose: with a latch from the start a spring stays stretched; with one that is not out it does not."""
    spring = "forces: {spring: {type: torque, joint: rail, value: 3-6*rail.travel}}\n"
    for when, at, load in (("", 0.0, -3.0), ("when: rail.travel > 9", 0.5, 0.0)):
        latch = f"latches: {{pin: {{joint: rail, {when}}}}}\n"
        found = solved(f"{CART.replace('speed: 1', 'speed: 0')}{spring}{latch}analysis: {{type: rest}}\n")
        near(travel(found)[0], at, 1.0, 1e-9)
        near(found.stops["pin"]["force"][0], load, 1.0, 1e-8)


@pytest.mark.parametrize("held", ["hinge", "wheel"])
def test_a_motor_stalls_against_what_is_held(held: str) -> None:
    """Its curve begins at rest, where rounding of the held speed must not leave it; also through a gear of -2.

    Both bodies hang together on one axis with no load from outside: caught, they are at rest.
    """
    found = solved(f"""
heun: 1
ground: {{points: {{O: [0, 0, 0]}}}}
bodies:
  arm: {{mass: 1, center: [0.1, 0, 0], inertia: [0.1, 0.1, 0.2], points: {{o: [0, 0, 0], p: [0.3, 0.1, 0]}}}}
  flap: {{mass: 1, center: [0, 0.1, 0], inertia: [0.3, 0.3, 0.5], points: {{o: [0, 0, 0]}}}}
  rotor: {{mass: 1, center: [0.3, 0.1, 0], inertia: [0.1, 0.1, 0.1], points: {{o: [0.3, 0.1, 0]}}}}
joints:
  base: {{type: pin, from: ground.O, to: arm.o, axis: [0, 0, 1]}}
  hinge: {{type: pin, from: arm.o, to: flap.o, axis: [0, 0, 1]}}
  wheel: {{type: pin, from: arm.p, to: rotor.o, axis: [0, 0, 1]}}
couplings: {{gear: {{type: ratio, of: [wheel, hinge], factors: [1, -2]}}}}
tables: {{curve: {{x: [0, 20, 60], y: [35, 34, 10]}}}}
forces: {{motor: {{type: motor, joint: hinge, curve: curve}}}}
latches: {{click: {{joint: {held}, angle: 0.5}}}}
analysis: {{duration: 1, samples: 3}}
""")
    near(found.coordinates["base"]["rate"][1:], [0.0, 0.0], 1.0, 1e-9)
    near(found.stops["click"]["moment"][1:], np.full(2, -35.0 if held == "hinge" else -17.5), 35.0, 1e-9)
