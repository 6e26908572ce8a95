"""Blows that strike when a condition becomes true: by closed forms, and as runs put together by hand."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
import pytest

from heuncli.base.errors import HeunError, SpecError
from heuncli.results.results import Results
from tests.shared.scenes import near, solved, study

M, L, G, J, START = 2.0, 0.5, 9.81, 0.3, 0.4
KNOCK = "knock: {{on: bob.b, vector: [{}, 0], {}}}"
WHEN = "when: 'hinge.angle < 0'"
EVERY = f"{WHEN}, every: true"


def pendulum(
    impulses: str, analysis: str = "{duration: 5, samples: 51}", start: str = f"angle: {START}", more: str = ""
) -> str:
    return f"""
heun: 1
space: planar
gravity: [0, -{G}]
ground: {{points: {{O: [0, 0]}}}}
bodies:
  bob: {{mass: {M}, center: [0, -{L}], inertia: 0, points: {{O: [0, 0], b: [0, -{L}]}}}}
joints: {{hinge: {{type: pin, from: ground.O, to: bob.O, initial: {{{start}}}}}}}
impulses: {{{impulses}}}
analysis: {analysis}
{more}"""


def blows(found: Results) -> list[tuple[float, tuple[str, ...]]]:
    return [(blow["time"], tuple(blow["names"])) for blow in found.impulses]


def lowest() -> float:
    """The rate at the lowest point, from rest at the start."""
    return math.sqrt(2.0 * G / L * (1.0 - math.cos(START)))


def test_each_push_adds_to_the_angular_momentum() -> None:
    """At the lowest point the rate is what it was behind the push before, and each push adds J/(m L)."""
    found = solved(pendulum(KNOCK.format(-J, EVERY)))
    assert len(found.impulses) == 4
    for n, blow in enumerate(found.impulses):
        rates = lowest() + n * J / (M * L), lowest() + (n + 1) * J / (M * L)
        for key, w in zip(("energy_before", "energy_after"), rates, strict=True):
            near(blow[key], 0.5 * M * L**2 * w**2, 1.0, 1e-9)
        near(blow["bodies"]["bob"]["angular_velocity_jump"], (0, 0, -J / (M * L)), 1.0, 1e-12)
    sum_ = found.energy["kinetic"] + found.energy["potential"] - found.energy["work"]
    near(sum_, sum_[0], 1.0, 1e-9)


def test_the_first_time_alone_unless_every_time() -> None:
    found = solved(pendulum(KNOCK.format(-J, WHEN)))
    assert blows(found) == blows(solved(pendulum(KNOCK.format(-J, EVERY))))[:1]


def test_a_mass_thrown_up_again() -> None:
    """Each time that it falls to 0 at the speed v it leaves with J/m - v: heights alternate."""
    throw = 10.0
    text = f"""
heun: 1
gravity: [0, 0, -{G}]
ground: {{points: {{O: [0, 0, 0]}}}}
bodies: {{ball: {{mass: 2, center: [0, 0, 0], inertia: [1, 1, 1], points: {{c: [0, 0, 0]}}}}}}
joints: {{guide: {{type: slide, axis: [0, 0, 1], from: ground.O, to: ball.c, initial: {{travel: 1}}}}}}
impulses: {{kick: {{on: ball.c, vector: [0, 0, {2 * throw}], when: guide.travel < 0, every: true}}}}
analysis: {{duration: 6, events: {{below: guide.travel < 0}}}}
"""
    found = solved(text)
    v = math.sqrt(2.0 * G)
    t = v / G
    assert len(found.impulses) == 6
    for blow in found.impulses:
        near(blow["time"], t, 1.0, 1e-12)
        v = throw - v
        near(blow["energy_after"], v**2, 30.0, 1e-12)
        t += 2.0 * v / G
    assert not len(found.events["below"]["time"])  # what a blow takes back at the same instant is no change


def test_the_same_run_put_together_by_hand() -> None:
    """Runs that end where the condition becomes true, each begun anew with the rate behind the blow."""
    whole = solved(pendulum(KNOCK.format(-J, EVERY), "{duration: 5, samples: 51, tolerance: 1e-11}"))
    t, angle, rate, times = 0.0, START, 0.0, []
    while True:
        text = pendulum(
            "",
            f"{{duration: {5.0 - t!r}, until: hinge.angle < 0, tolerance: 1e-11}}",
            f"angle: {angle!r}, rate: {rate!r}",
        )
        part = solved(text.replace("impulses: {}", ""))
        t += float(part.time[-1])
        angle, rate = (float(part.coordinates["hinge"][key][-1]) for key in ("angle", "rate"))
        if "end condition" not in part.status["message"] or "did not become" in part.status["message"]:
            break
        times.append(t)
        angle, rate = -abs(angle), rate - J / (M * L)
    near([blow["time"] for blow in whole.impulses], times, 1.0, 1e-9)
    near([whole.coordinates["hinge"]["angle"][-1], whole.coordinates["hinge"]["rate"][-1]], (angle, rate), 1.0, 1e-8)


def test_the_same_blows_at_their_instants() -> None:
    """Given at the instants that were found, they make the same motion, at all instants and in between."""
    found = study(pendulum(KNOCK.format(-J, EVERY)))
    given = ", ".join(
        f"k{i}: {{on: bob.b, vector: [{-J}, 0], time: {t!r}}}" for i, (t, _) in enumerate(blows(found.results))
    )
    other = study(pendulum(given))
    times = np.sort(np.append(np.linspace(0.0, 5.0, 37), [t for t, _ in blows(found.results)]))
    for key in ("angle", "rate"):
        near(
            found.resample(times).coordinates["hinge"][key], other.resample(times).coordinates["hinge"][key], 1.0, 1e-8
        )


@pytest.mark.parametrize(
    ("start", "first"),
    [
        (f"angle: -{START}", 1),  # true at the start: at the second passage from the right
        ("angle: 0, rate: -1", 0),  # becomes true at the start itself, which is the same
        ("angle: 0, rate: 1", 0),
    ],
)
def test_what_is_true_at_the_start_strikes_nothing(start: str, first: int) -> None:
    found = solved(pendulum(KNOCK.format(-J, EVERY), start=start, more=""))
    assert found.accuracy["horizon"] is None
    assert all(blow["time"] > 0.5 for blow in found.impulses) and len(found.impulses) >= 3


def test_a_blow_that_does_not_strike_is_told() -> None:
    found = solved(pendulum(KNOCK.format(-J, "when: hinge.angle < -2")))
    assert not found.impulses
    assert found.model["contacts"] == ["knock did not act: hinge.angle < -2 did not become true"]
    found = solved(pendulum(KNOCK.format(-J, "when: hinge.angle < 1")))
    assert "is true at the start, which does not trigger it" in found.model["contacts"][0]


def test_several_at_one_instant_act_together() -> None:
    two = f"{KNOCK.format(-J, WHEN)}, other: {{on: bob.b, vector: [{-2 * J}, 0], when: 2*hinge.angle < 0}}"
    (blow,) = solved(pendulum(two)).impulses
    assert blow["names"] == ["knock", "other"]
    near(blow["energy_after"], 0.5 * M * L**2 * (lowest() + 3 * J / (M * L)) ** 2, 1.0, 1e-9)


def test_one_blow_may_make_the_condition_of_another_true() -> None:
    """The first pushes it beyond a rate; the second, which waits for that, strikes behind it at the same instant."""
    limit = lowest() + 0.5 * J / (M * L)
    other = f"other: {{on: bob.b, vector: [{-2 * J}, 0], when: 'hinge.rate < {-limit!r}'}}"
    first, second = solved(pendulum(f"{KNOCK.format(-J, WHEN)}, {other}")).impulses
    assert (first["names"], second["names"]) == (["knock"], ["other"])
    assert first["time"] == second["time"]
    near(first["energy_after"], second["energy_before"], 1.0, 1e-12)


def test_blows_without_end_are_an_error() -> None:
    two = (
        KNOCK.format(-J, "when: hinge.rate > 0, every: true")
        + ", "
        + KNOCK.format(J, "when: hinge.rate < 0, every: true").replace("knock", "back")
    )
    with pytest.raises(HeunError) as caught:
        solved(pendulum(two))
    (problem,) = caught.value.problems
    assert problem.code == "endless-blows" and "impulses.knock and impulses.back" in problem.message


def test_it_strikes_before_the_motion_ends_there() -> None:
    """`until` at the same instant: the blow is told, and the last values are those behind it."""
    found = solved(pendulum(KNOCK.format(-J, WHEN), "{duration: 5, until: hinge.angle < 0}"))
    (blow,) = found.impulses
    assert found.time[-1] == blow["time"]
    near(found.coordinates["hinge"]["rate"][-1], -(lowest() + J / (M * L)), 1.0, 1e-9)
    assert found.accuracy["estimate"]["reactions"] < 1e-6
    assert found.events["until"]["error"][0] < 1e-9


def test_a_condition_in_time_is_met_to_the_bit() -> None:
    found, given = (solved(pendulum(KNOCK.format(-J, at))) for at in ("when: t >= 0.75", "time: 0.75"))
    assert found.impulses[0]["time"] == 0.75
    for key in ("angle", "rate"):
        assert np.array_equal(found.coordinates["hinge"][key], given.coordinates["hinge"][key])


def test_beside_a_stop() -> None:
    """Struck where it passes the lowest point, and thrown back by a stop with e = 1: the rate grows by each push."""
    stop = "stops: {wall: {joint: hinge, angle: [-0.3, null], restitution: 1}}"
    found = solved(pendulum(KNOCK.format(-J, EVERY), more=stop))
    names = [blow["names"] for blow in found.impulses]
    assert names[:6] == [["knock"], ["wall"]] * 3
    pushes = [blow for blow in found.impulses if blow["names"] == ["knock"]]
    for n, blow in enumerate(pushes):
        near(blow["energy_after"], 0.5 * M * L**2 * (lowest() + (n + 1) * J / (M * L)) ** 2, 1.0, 1e-8)


@pytest.mark.parametrize(
    ("impulse", "analysis", "code"),
    [
        ("when: hinge.angle < 0, time: 1", "{duration: 5}", "impulse-when"),
        ("every: true", "{duration: 5}", "impulse-when"),
        ("when: hinge.angle < 0", "{type: impulse}", "impulse-when"),
        ("when: {of: energy.kinetic, above: 1}", "{duration: 5}", "condition"),
        ("when: hinge.angle", "{duration: 5}", "condition"),
        ("when: hinge.angel < 0", "{duration: 5}", None),
        ("when: hinge.angle < 0", "{duration: 5, method: SciPy-LSODA}", "method-scene"),
    ],
)
def test_refused(impulse: str, analysis: str, code: Any) -> None:
    with pytest.raises(SpecError) as caught:
        solved(pendulum(KNOCK.format(-J, impulse), analysis))
    (problem,) = caught.value.problems[:1]
    assert code in (None, problem.code)
    assert problem.location is not None and problem.location.path.startswith("impulses.knock")
