"""When conditions change: against closed forms, to the run's own error of the instants, and to 1e-12 of the run."""

from __future__ import annotations

import math
from random import Random
from typing import Any

import numpy as np
import pytest
from scipy.special import ellipk, ellipkinc

from heuncli.base.errors import SolveError
from heuncli.motion.integration.check.changes import ConditionChanges, make_changes
from heuncli.motion.integration.conditions import Conditions, evaluate_coordinates
from heuncli.results.results import Array
from heuncli.scene.file_format.load import load
from heuncli.study.model.options import Options
from heuncli.study.queries.study import Study
from heuncli.study.workflow import solve
from tests.shared.scenes import near

G = 9.81
BLOCK = "bodies: {block: {mass: 2, center: [0, 0, 0], inertia: [1, 1, 1], points: {c: [0, 0, 0]}}}\n"
FALL = (
    "heun: 1\ngravity: [0, 0, -9.81]\nground: {points: {O: [0, 0, 0]}}\n" + BLOCK
    + "joints: {guide: {type: slide, from: ground.O, to: block.c, axis: [0, 0, -1], initial: {travel: 0, speed: 0}}}\n"
)  # fmt: skip
PENDULUM = """\
heun: 1
gravity: [0, 0, -9.81]
ground: {points: {O: [0, 0, 0]}}
bodies: {bob: {mass: 1, center: [0, 0, -1], inertia: [0, 0, 0], points: {top: [0, 0, 0]}}}
joints: {pin: {type: pin, from: ground.O, to: bob.top, axis: [0, 1, 0], initial: {angle: 60 deg, rate: 0}}}
"""
LADDER = """\
heun: 1
parameters: {L: 2, tilt: 20 deg}
gravity: [0, 0, -9.81]
ground: {points: {O: [0, 0, 0]}}
bodies:
  ladder:
    shapes: [{type: rod, from: [0, 0, "-L/2"], to: [0, 0, "L/2"], mass: 10}]
    points: {foot: [0, 0, "-L/2"], head: [0, 0, "L/2"]}
    near: {position: ["L/2*sin(tilt)", 0, "L/2*cos(tilt)"]}
    orientation: {axis: [0, 1, 0], angle: -tilt}
joints:
  floor: {type: plane, from: ground.O, to: ladder.foot, normal: [0, 0, 1]}
  wall: {type: plane, from: ground.O, to: ladder.head, normal: [1, 0, 0]}
"""


def run(scene: str, analysis: str, more: str = "", **options: Any) -> Study:
    return solve(load("x.yaml", text=f"{scene}analysis: {{{analysis}}}\n{more}"), Options(**options))


def met(found: ConditionChanges, times: Array, up: bool) -> None:
    """The instants, alternately up and down, within their error and to 1e-12 of the run."""
    assert len(found.times) == len(times)
    assert found.values.tolist() == [up == (k % 2 == 0) for k in range(len(times))]
    off = np.abs(found.times - times)
    assert (off <= found.error + 4 * math.ulp(float(times[-1]))).all()
    assert off.max() <= 1e-11 * float(times[-1])


@pytest.mark.parametrize("reduce", [True, False])
@pytest.mark.parametrize("limit", [0.001, 0.2, 10.0, 19.0])
def test_a_fall_past_a_height(limit: float, reduce: bool) -> None:
    """t = √(2 h/g); the run ends there, and what it tells is of there."""
    study = run(FALL, f'duration: 2, samples: 5, until: "guide.travel > {limit!r}"', reduce=reduce)
    t = math.sqrt(2.0 * limit / G)
    met(study.changes["until"], np.array([t]), up=True)
    results = study.results
    assert results.time[-1] == study.changes["until"].times[0]
    assert len(results.time) == 1 + sum(x < t for x in (0.0, 0.5, 1.0, 1.5, 2.0))
    near(results.coordinates["guide"]["travel"][-1], limit, limit, 1e-13)
    near(results.energy["kinetic"][-1], 2.0 * G * limit, 2.0 * G * limit, 1e-13)
    assert results.status["message"] == f"end condition guide.travel > {limit!r} met at t = {t:.6g} s"


def test_what_has_passed_may_not_come_back() -> None:
    """Thrown up at v: at half its summit's height on the way up and down, t = (v ± √(v² − 2 g h))/g."""
    scene = FALL.replace("axis: [0, 0, -1]", "axis: [0, 0, 1]").replace("speed: 0", "speed: 8")
    h = 0.5 * 8.0**2 / (2 * G)
    past = f"guide.travel > {h!r}"
    events = f'half: "{past}", up: "guide.speed > 0", both: "{past} and guide.speed > 0", t: "t > 0.5"'
    study = run(scene, f"duration: 2, samples: 3, events: {{{events}}}")
    turns = np.array([(8 - math.sqrt(64 - 2 * G * h)) / G, (8 + math.sqrt(64 - 2 * G * h)) / G])
    met(study.changes["half"], turns, up=True)
    met(study.changes["up"], np.array([8 / G]), up=False)
    met(study.changes["both"], np.array([turns[0], 8 / G]), up=True)
    assert study.changes["t"].times.tolist() == [0.5]
    assert study.results.time[-1] == 2.0


@pytest.mark.parametrize("condition", ['"pin.angle < 0"', "{of: coordinates.pin.angle, below: 0}"])
def test_a_pendulum_passes_its_bottom(condition: str) -> None:
    """At odd quarters of the period, 4 K(sin² 30°)/√g."""
    study = run(PENDULUM, f"duration: 10, samples: 2, events: {{bottom: {condition}}}")
    quarter = float(ellipk(math.sin(math.pi / 6) ** 2)) / math.sqrt(G)
    times = quarter * np.arange(1, 2 * int(10 / quarter / 2) + 2, 2)
    met(study.changes["bottom"], times[times < 10.0], up=True)


@pytest.mark.parametrize("condition", ['"pin.rate > 0"', "{of: coordinates.pin.rate, above: 0}"])
def test_a_pendulum_turns(condition: str) -> None:
    study = run(PENDULUM, f"duration: 10, samples: 2, events: {{turns: {condition}}}")
    half = 2.0 * float(ellipk(math.sin(math.pi / 6) ** 2)) / math.sqrt(G)
    met(study.changes["turns"], half * np.arange(1, int(10 / half) + 1), up=True)


def test_a_pendulum_at_an_angle_by_the_incomplete_integral() -> None:
    """sin(θ/2) = k sin φ: t = (K − F(φ))/√g from rest at 60°."""
    study = run(PENDULUM, 'duration: 0.5, samples: 2, until: "pin.angle < 30*deg"')
    k = math.sin(math.pi / 6)
    phi = math.asin(math.sin(math.pi / 12) / k)
    met(study.changes["until"], np.array([(ellipk(k * k) - ellipkinc(phi, k * k)) / math.sqrt(G)]), up=True)


def test_the_pull_of_a_pendulum() -> None:
    """m (g cos θ + ω²) is largest, 2 m g, at the bottom; it is 1.25 m g at cos θ = 3/4."""
    study = run(PENDULUM, "duration: 1, samples: 2, events: {pull: {of: joints.pin.force, above: 12.2625},"
                " most: {of: joints.pin.force, above: 19.62}}")  # fmt: skip
    k, m = math.sin(math.pi / 6), math.sin(math.pi / 6) ** 2
    phi = math.asin(math.sin(0.5 * math.acos(0.75)) / k)
    t, quarter = float(ellipk(m) - ellipkinc(phi, m)) / math.sqrt(G), float(ellipk(m)) / math.sqrt(G)
    met(study.changes["pull"], np.array([t, 2 * quarter - t]), up=True)
    assert not len(study.changes["most"].times)  # touched, within the error


def test_a_ladder_leaves_the_wall_at_two_thirds_of_its_height() -> None:
    """Of a smooth ladder, whatever its length and tilt: z = 2/3 of z at the start, where the wall ceases to push."""
    for tilt in ("5 deg", "20 deg", "50 deg"):
        scene = LADDER.replace("20 deg", tilt)
        whole = run(scene, "duration: 3, samples: 31, events: {off: {of: joints.wall.force.x, below: 0}}")
        study = run(scene, "duration: 3, samples: 31, until: {of: joints.wall.force.x, below: 0}")
        z = study.results.bodies["ladder"]["center"][:, 2]
        near(z[-1], z[0] * 2 / 3, float(z[0]), 1e-9)
        t = study.results.time[-1]
        assert abs(whole.changes["off"].times[0] - t) <= whole.changes["off"].error[0]
        assert study.changes["until"].values.tolist() == [True]
        assert (study.results.joints["wall"]["force"][:-1, 0] > 0).all()
        near(study.results.joints["wall"]["force"][-1, 0], 0.0, 98.1, 1e-8)


def test_a_blow_makes_it_true_at_once() -> None:
    more = "impulses: {hit: {on: block.c, vector: [0, 0, -4], time: 0.3}}\n"
    events = 'events: {fast: "guide.speed > 4", hard: {of: coordinates.guide.speed, above: 4}}'
    study = run(FALL, f"duration: 1, samples: 3, {events}", more)
    assert [study.changes[name].times.tolist() for name in ("fast", "hard")] == [[0.3], [0.3]]
    study = run(FALL, 'duration: 1, samples: 3, until: "guide.speed > 4"', more)
    assert study.results.time.tolist() == [0.0, 0.3]
    near(study.results.coordinates["guide"]["speed"][-1], 0.3 * G + 2.0, 1.0, 1e-13)


def test_a_ball_at_each_strike() -> None:
    """What bounces at e: its speed changes sign at each strike and at each summit."""
    scene = FALL.replace("axis: [0, 0, -1]", "axis: [0, 0, 1]").replace("travel: 0", "travel: 1")
    more = "stops: {floor: {joint: guide, travel: [0, null], restitution: 0.5}}\n"
    study = run(scene, 'duration: 1.2, samples: 3, events: {up: "guide.speed > 0"}', more)
    fall = math.sqrt(2 / G)
    times = np.array([fall, fall * 1.5, fall * 2, fall * 2.25, fall * 2.5, fall * 2.625])
    met(study.changes["up"], times[times < 1.2], up=True)


def test_a_followed_machine_ends_where_its_crank_is() -> None:
    """Driven at 100 rad/s: nothing is integrated, and the instants follow."""
    scene = FALL.replace("initial: {travel: 0, speed: 0}", "")
    more = 'drives: {motor: {joint: guide, travel: "0.5 - 0.5*cos(3*t)"}}\n'
    study = run(scene, 'duration: 3, samples: 4, until: "guide.speed < 0", events: {half: "guide.travel > 0.5"}', more)
    assert study.history.followed_duration is not None
    met(study.changes["half"], np.array([math.pi / 6]), up=True)
    assert study.changes["half"].begins is False
    near(study.results.time[-1], math.pi / 3, 3.0, 1e-13)


@pytest.mark.parametrize("condition", [
    "t > 1", "t >= 1", "1 < t", "min(t, 1) >= 1", "t > 1 and guide.travel > 1", "guide.travel > 10 or t > 1",
])  # fmt: skip
def test_a_run_ends_at_an_instant(condition: str) -> None:
    """Whichever branch the edge itself belongs to; what is told there is the fall after 1 s."""
    study = run(FALL, f'duration: 3, samples: 4, until: "{condition}"')
    met(study.changes["until"], np.array([1.0]), up=True)
    near(study.results.time[-1], 1.0, 1.0, 1e-15)
    near(study.results.coordinates["guide"]["travel"][-1], G / 2, G / 2, 1e-13)
    assert study.results.accuracy["horizon"] is None
    assert study.results.accuracy["estimate"]["motion"] < 1e-12


def test_true_at_the_start_ends_nothing() -> None:
    study = run(PENDULUM, 'duration: 3, samples: 2, until: "pin.angle > 0"')
    quarter = float(ellipk(math.sin(math.pi / 6) ** 2)) / math.sqrt(G)
    found = study.changes["until"]
    assert found.begins
    met(found, np.array([quarter, 3 * quarter]), up=False)
    assert study.results.status["message"].endswith("it is true at the start, which does not count")


def test_nothing_is_made_of_noise() -> None:
    """A force that is 0 but for rounding passes no limit of 0, nor does what stays where it is."""
    across = "a: {of: joints.pin.force.y, above: 0}, b: {of: joints.pin.force.y, below: 0}"
    study = run(PENDULUM, f"duration: 2, samples: 2, events: {{{across}, c: {{of: joints.pin.moment, above: 0}}}}")
    assert [len(found.times) for found in study.changes.values()] == [0, 0, 0]


def test_until_stops_before_what_would_fail() -> None:
    """A table ends at 0.5 m: the run does not get there."""
    more = "tables: {k: {x: [0, 0.5], y: [0, 1]}}\n"
    more += 'forces: {push: {type: torque, joint: guide, value: "table(k, guide.travel)"}}\n'
    study = run(FALL, 'duration: 5, samples: 3, until: "guide.travel > 0.49"', more)
    near(study.results.coordinates["guide"]["travel"][-1], 0.49, 1.0, 1e-12)


@pytest.mark.parametrize("still", [
    "pin.angle - pin.angle >= 0", "min(pin.angle, pin.angle) > 2*pin.angle - pin.angle", "guide.travel >= 0",
    "guide.travel <= 0",
])  # fmt: skip
def test_what_rests_at_its_margin_hides_nothing(still: str) -> None:
    """A block lies on its stop, where rounding leaves open on which side of 0 it is; the pendulum beside it passes."""
    scene = PENDULUM.replace("bodies: {bob:", BLOCK.replace("}}}", "}}, bob:").rstrip()).replace(
        "joints: {", "joints: {guide: {type: slide, from: ground.O, to: block.c, axis: [0, 0, 1]}, "
    )  # fmt: skip
    more = "stops: {floor: {joint: guide, travel: [0, null]}}\n"
    events = f'still: "{still}", bottom: "pin.angle < 0"'
    for force in ("", f'forces: {{none: {{type: torque, joint: pin, value: "0 if {still} else 0*t"}}}}\n'):
        study = run(scene, f"duration: 3, samples: 2, events: {{{events}}}", more + force)
        quarter = float(ellipk(math.sin(math.pi / 6) ** 2)) / math.sqrt(G)
        times = quarter * np.arange(1, 7, 2)
        met(study.changes["bottom"], times[times < 3.0], up=True)
        assert not len(study.changes["still"].times)


def test_what_holds_behind_the_last_instant_is_told_there() -> None:
    """A ball lands and stays, where the floor begins to bear; a load that jumps where a run ends.

    An event with the condition that ends the run is at its end, and so is one that means the same in other words.
    """
    scene = FALL.replace("axis: [0, 0, -1]", "axis: [0, 0, 1]").replace("travel: 0", "travel: 1")
    more = "stops: {floor: {joint: guide, travel: [0, null], restitution: 0}}\n"
    bears = "{of: stops.floor.force, above: 1}"
    study = run(scene, f"duration: 3, samples: 7, until: {bears}, events: {{bear: {bears}}}", more)
    met(study.changes["until"], np.array([math.sqrt(2 / G)]), up=True)
    assert study.changes["bear"].times.tolist() == study.changes["until"].times.tolist() == [study.results.time[-1]]
    near(study.results.stops["floor"]["force"], [0.0, 2 * G], 2 * G, 1e-12)
    near(study.results.coordinates["guide"]["acceleration"][-1], 0.0, G, 1e-12)
    more = 'forces: {push: {type: torque, joint: guide, value: "7 if guide.travel > 0.5 else 0"}}\n'
    at_half = ('"guide.travel > 0.5"', "{of: coordinates.guide.travel, above: 0.5}")
    for until in (*at_half, "{of: forces.push.value, above: 1}"):
        study = run(FALL, f'duration: 3, samples: 3, until: {until}, events: {{e: "guide.travel > 0.5"}}', more)
        met(study.changes["e"], np.array([math.sqrt(1 / G)]), up=True)
        near(study.results.coordinates["guide"]["acceleration"], [G, G + 3.5], G, 1e-12)


LOCK = """\
heun: 1
ground: {points: {O: [0, 0, 0]}}
bodies:
  bar: {mass: 1, center: [0.5, 0, 0], inertia: [0.01, 0.1, 0.1], points: {o: [0, 0, 0], tip: [1, 0, 0]}}
  block: {mass: 1, center: [0, 0, 0], inertia: [1, 1, 1], points: {c: [0, 0, 0]}}
joints:
  pin: {type: pin, from: ground.O, to: bar.o, axis: [0, -1, 0], initial: {angle: 60 deg}}
  guide: {type: slide, from: ground.O, to: block.c, axis: [1, 0, 0]}
  link: {type: rod, from: bar.tip, to: block.c, length: 1}
drives: {motor: {joint: guide, travel: "1 + t"}}
"""


def test_a_result_ends_a_run_before_what_would_fail() -> None:
    """Two rods of 1 m are drawn straight at 1 s, cos angle = (1 + t)/2; and a table that ends at 0.5 m."""
    angle = "of: coordinates.pin.angle, below"
    events = f"until: {{{angle}: 0.5}}, events: {{same: {{{angle}: 0.5}}, later: {{{angle}: 0.4}}}}"
    study = run(LOCK, f"duration: 3, samples: 7, {events}")
    for name, count in (("until", 1), ("same", 1), ("later", 0)):
        assert len(study.changes[name].times) == count
        if count:
            met(study.changes[name], np.array([2 * math.cos(0.5) - 1]), up=True)
    assert len(study.results.time) == 3
    with pytest.raises(SolveError, match="closure-lost"):
        run(LOCK, f"duration: 3, samples: 7, until: {{{angle}: -0.5}}")
    more = "tables: {k: {x: [0, 0.5], y: [0, 1]}}\n"
    more += 'forces: {push: {type: torque, joint: guide, value: "table(k, guide.travel)"}}\n'
    study = run(FALL, "duration: 5, samples: 3, until: {of: coordinates.guide.travel, above: 0.499}", more)
    near(study.results.coordinates["guide"]["travel"][-1], 0.499, 1.0, 1e-12)


def test_the_largest_moment_along_a_beam_passes_its_limit() -> None:
    """A swung bar's largest N is at its root, the joint's force along it; what a condition needs is not told."""
    bar = "{shapes: [{type: cylinder, from: [0, 0, 0], to: [0, 0, -1], radius: 0.01, mass: 1}]"
    bodies = f"bodies: {{bob: {bar}, points: {{top: [0, 0, 0], end: [0, 0, -1]}}}}}}\n"
    scene = PENDULUM[: PENDULUM.index("bodies")] + bodies + PENDULUM[PENDULUM.index("joints") :]
    more = "sections: {bar: {body: bob, from: top, to: end, count: 3}}\n"
    events = "n: {of: sections.bar.N, above: 15}, j: {of: joints.pin.force, above: 15.0000001}"
    study = run(scene, f"duration: 2, samples: 2, events: {{{events}}}", more, requested_reports=frozenset({"joints"}))
    n, j = study.changes["n"], study.changes["j"]
    assert len(n.times) == len(j.times) > 2
    assert study.results.sections == {}


RANDOM = """\
heun: 1
gravity: [0, 0, -9.81]
ground: {points: {O: [0, 0, 0]}}
bodies:
  a: {mass: 1, center: [0, 0, -0.5], inertia: [0.1, 0.1, 0.01], points: {top: [0, 0, 0], end: [0, 0, -1]}}
  b: {mass: 0.5, center: [0, 0, -0.3], inertia: [0.02, 0.02, 0.01], points: {top: [0, 0, 0]}}
joints:
  p: {type: pin, from: ground.O, to: a.top, axis: [0, 1, 0], initial: {angle: 1.2, rate: 0.3}}
  q: {type: pin, from: a.end, to: b.top, axis: [0, 1, 0], initial: {angle: -0.7, rate: 1}}
"""


def random_condition(random: Random, deep: int = 0) -> str:
    kind = random.random()
    if deep < 2 and kind < 0.4:
        word = "and" if kind < 0.2 else "or"
        return f"({random_condition(random, deep + 1)} {word} {random_condition(random, deep + 1)})"
    if deep < 2 and kind < 0.5:
        return f"(not {random_condition(random, deep + 1)})"
    return f"{random_term(random)} {random.choice(['<', '>'])} {random_term(random)}"


def random_term(random: Random) -> str:
    one, other = (f"{random.choice(['p.angle', 'q.angle', 'p.rate', 'q.rate', 't'])}" for _ in "12")
    scale, shift = random.uniform(-2, 2), random.uniform(-1, 1)
    return random.choice([f"{scale!r}*{one}*{other}", f"sin({one} + {scale!r}*{other})", f"abs({one} + {shift!r})"])


@pytest.mark.heavy
@pytest.mark.parametrize("seed", range(5))
@pytest.mark.third
def test_conditions_at_random_against_dense_samples(seed: int) -> None:
    """Between the instants told every condition is, as its coordinates say, what the last change made it."""
    random = Random(seed)
    texts = [random_condition(random) for _ in range(4)]
    events = ", ".join(f'e{k}: "{text}"' for k, text in enumerate(texts))
    study = run(RANDOM, f"duration: 3, samples: 2, events: {{{events}}}")
    runner, trajectory = study.setup.runner, study.history.checked_run.run  # type: ignore[union-attr]
    times = np.linspace(0, 3, 3001)[1:-1]
    conditions = Conditions(runner.layout)
    coordinates = evaluate_coordinates(runner, times, runner.resample(trajectory, times))
    for k in range(len(texts)):
        found = study.changes[f"e{k}"]
        own = np.array([
            conditions.evaluate_free(k, t, 0.0, there) for t, there in zip(times.tolist(), coordinates, strict=True)
        ])  # fmt: skip
        states = np.concatenate([[found.begins], found.values])
        assert (states[np.searchsorted(found.times, times)] == (own > 0.5)).all(), texts[k]
        assert (found.error < 1e-6).all()


@pytest.mark.parametrize(("width", "times"), [(1e-14, []), (1e-9, [0.5, 0.5 + 1e-9])])
def test_what_is_undone_within_rounding_is_no_change(width: float, times: list[float]) -> None:
    """An impulse that comes as its condition becomes true, and turns the motion back, leaves it true for no time."""
    begins = np.array([0.0, 0.5, 0.5 + width, 1.0])
    changes = make_changes("c", begins, np.array([False, True, False, False]))
    assert changes.times.tolist() == times and not changes.begins


def test_what_lasts_keeps_its_first_instant() -> None:
    changes = make_changes("c", np.array([0.0, 0.5, 0.5 + 1e-14, 1.0]), np.array([False, False, True, True]))
    assert changes.times.tolist() == [0.5] and changes.values.tolist() == [True]
