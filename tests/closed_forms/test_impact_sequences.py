"""Impacts one after another, and what is said of contacts that share a blow: cradles, taut ropes, digits of pi."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
import pytest

from heuncli.study.queries.study import Study
from tests.shared.command import Heun
from tests.shared.folders import ROOT
from tests.shared.scenes import near, study

IMPACTS = ("simultaneous", "sequential")


def balls(
    masses: Sequence[float], start: Sequence[float], e: Sequence[float], impacts: str, more: str = "", gap: float = 0.0
) -> Study:
    """Balls on a line, which touch, or have gaps."""
    names = range(len(masses))
    x = [k * (1.0 + gap) for k in names]
    bodies = "\n".join(
        f"  b{k}: {{mass: {m!r}, center: [0, 0], inertia: 0.01, points: {{o: [0, 0]}}, position: [{x[k]!r}, 0]}}"
        for k, m in enumerate(masses)
    )
    joints = "\n".join(
        f"  g{k}: {{type: slide, from: ground.O, to: b{k}.o, axis: [1, 0], "
        f"initial: {{travel: {x[k]!r}, speed: {v!r}}}}}"
        for k, v in enumerate(start)
    )
    rods = "\n".join(f"  c{k}: {{type: rod, from: b{k}.o, to: b{k + 1}.o}}" for k in range(len(e)))
    stops = "\n".join(f"  s{k}: {{joint: c{k}, length: [1, null], restitution: {x!r}}}" for k, x in enumerate(e))
    return study(
        f"heun: 1\nspace: planar\nground: {{points: {{O: [0, 0]}}}}\nbodies:\n{bodies}\njoints:\n{joints}\n{rods}\n"
        f"stops:\n{stops}\n{more}\nanalysis: {{duration: 0.1, samples: 2, impacts: {impacts}}}\n"
    )


def speeds(run: Study, n: int) -> list[float]:
    """Of the balls in the end."""
    return [float(run.results.bodies[f"b{k}"]["velocity"][-1, 0]) for k in range(n)]


@pytest.mark.parametrize("n", [3, 5])
def test_the_last_ball_leaves(n: int) -> None:
    """Equal masses and restitution 1: all of the impulse runs through the row."""
    run = balls([2.0] * n, [1.0] + [0.0] * (n - 1), [1.0] * (n - 1), "sequential")
    near(speeds(run, n), [0.0] * (n - 1) + [1.0], 1.0, 1e-13)
    (blow,) = run.results.impulses
    near([blow["stops"][f"s{k}"]["force"] for k in range(n - 1)], [2.0] * (n - 1), 2.0, 1e-13)
    near([blow["energy_before"], blow["energy_after"]], [1.0, 1.0], 1.0, 1e-13)
    assert f"({n - 1} impacts)" in run.results.model["contacts"][0]


def test_two_balls_in_two_balls_out() -> None:
    run = balls([1.0] * 4, [1.0, 1.0, 0.0, 0.0], [1.0] * 3, "sequential")
    near(speeds(run, 4), [0.0, 0.0, 1.0, 1.0], 1.0, 1e-13)


@pytest.mark.parametrize("gap", [0.0, 1e-9, 1e-6])
def test_unequal_masses_are_the_limit_of_gaps(gap: float) -> None:
    """1, 2, 3 kg: three impacts by the law of two masses, the last one of the first pair again; then none closes."""
    run = balls([1.0, 2.0, 3.0], [1.0, 0.0, 0.0], [0.5, 0.8], "sequential", gap=gap)
    forth = 1.5 * 1.0 * 2.0 / 3.0  # (1 + e) u m m'/(m + m')
    on = 1.8 * (forth / 2.0) * 6.0 / 5.0
    first, middle = 1.0 - forth, (forth - on) / 2.0
    back = 1.5 * (first - middle) * 2.0 / 3.0
    near(speeds(run, 3), [first - back, middle + back / 2.0, on / 3.0], 1.0, 1e-12)
    if not gap:
        (blow,) = run.results.impulses
        near([blow["stops"]["s0"]["force"], blow["stops"]["s1"]["force"]], [forth + back, on], 1.0, 1e-13)


@pytest.mark.parametrize(("ratio", "digits"), [(1, 3), (100, 31), (10_000, 314)])
def test_impacts_count_the_digits_of_pi(ratio: int, digits: int) -> None:
    """Galperin (2003): a ball between a wall and a mass 100^n times its own is struck with the digits of pi."""
    wall = "  wall: {joint: g0, travel: [0, null], restitution: 1}"
    run = balls([1.0, float(ratio)], [0.0, -1.0], [1.0], "sequential", wall)
    assert f"({digits} impacts)" in run.results.model["contacts"][0]
    (blow,) = run.results.impulses
    near(blow["energy_after"], blow["energy_before"], 0.5 * ratio, 1e-12)


@pytest.mark.parametrize("e", [0.05, 0.3])
def test_infinitely_many_impacts_end(e: float) -> None:
    """A plastic row, nearly: the impacts fall geometrically, and what they leave moves as one."""
    run = balls([1.0, 1.0, 1.0, 1.0], [1.0, 0.0, 0.0, -1.0], [e] * 3, "sequential")
    near(speeds(run, 4)[0], -speeds(run, 4)[3], 1.0, 1e-12)
    assert sum(speeds(run, 4)) == pytest.approx(0.0, abs=1e-12)
    run = balls([1.0, 1.0, 50.0], [0.0, 0.0, -1.0], [e, e], "sequential", "  wall: {joint: g0, travel: [0, null]}")
    assert all(v >= -1e-12 for v in speeds(run, 3))
    settled = [one for one in run.results.model["contacts"] if "infinitely many" in one]
    assert settled and "s0" in settled[0]
    near(speeds(run, 3), [0.0, 0.0, 0.0], 1.0, 1e-11)


ROPES = """
heun: 1
space: planar
ground: {points: {O: [0, 0]}}
bodies:
  b0: {mass: 1, center: [0, 0], inertia: 0.01, points: {o: [0, 0]}, position: [0, 0]}
  b1: {mass: 1, center: [0, 0], inertia: 0.01, points: {o: [0, 0]}, position: [1, 0]}
  b2: {mass: 1, center: [0, 0], inertia: 0.01, points: {o: [0, 0]}, position: [2, 0]}
joints:
  g0: {type: slide, from: ground.O, to: b0.o, axis: [1, 0]}
  g1: {type: slide, from: ground.O, to: b1.o, axis: [1, 0]}
  g2: {type: slide, from: ground.O, to: b2.o, axis: [1, 0]}
couplings:
  r0: {type: rope, through: [b0.o, b1.o], tension_only: true, restitution: 1}
  r1: {type: rope, through: [b1.o, b2.o], tension_only: true, restitution: 1}
impulses: {h: {on: b2.o, vector: [1, 0]}}
analysis: {type: impulse, impacts: IMPACTS}
"""


@pytest.mark.parametrize(("impacts", "wanted"), [("simultaneous", [1 / 3] * 3), ("sequential", [1.0, 0.0, 0.0])])
def test_taut_ropes_are_struck(impacts: str, wanted: list[float]) -> None:
    """Also of the only instant of an impulse the line `contacts` says how they share it."""
    found = study(ROPES.replace("IMPACTS", impacts)).results
    near([found.bodies[f"b{k}"]["velocity"][0, 0] for k in range(3)], wanted, 1.0, 1e-13)
    near(found.impulses[0]["energy_after"], 0.5 * sum(v * v for v in wanted), 1.0, 1e-13)
    (told,) = found.model["contacts"]
    assert "r0 and r1 share the impulse" in told and f"impacts: {impacts}" in told
    assert len(found.warnings) == 1 and f"impacts: {impacts}" in found.warnings[0]
    assert found.model["impacts"] == impacts


def test_a_hammer_on_what_lies_rebounds_in_a_sequence() -> None:
    """As with a tiny gap: 2 kg, struck with 3 N s into a floor of restitution 0.5."""
    for impacts, speed in (("simultaneous", 0.0), ("sequential", 0.75)):
        found = study(f"""
heun: 1
gravity: [0, 0, -10]
ground: {{points: {{O: [0, 0, 0]}}}}
bodies: {{b: {{mass: 2, center: [0, 0, 0], inertia: [1, 1, 1], points: {{c: [0, 0, 0]}}}}}}
joints: {{guide: {{type: slide, from: ground.O, to: b.c, axis: [0, 0, 1]}}}}
stops: {{floor: {{joint: guide, travel: [0, null], restitution: 0.5}}}}
impulses: {{hammer: {{on: b.c, vector: [0, 0, -3]}}}}
analysis: {{type: impulse, impacts: {impacts}}}
""").results
        near(found.bodies["b"]["velocity"][0, 2], speed, 1.0, 1e-13)
        assert not found.warnings and "contacts" not in found.model  # one contact alone


POSTS = """
heun: 1
space: planar
gravity: [0, -10]
ground: {points: {A: [-1, 0], B: [1, 0], C: [0, 0]}}
bodies:
  bar: {mass: 3, center: [0, 0], inertia: 1, points: {a: [-1, 0], b: [1, 0], c: [0, 0]}, position: [0, 1],
        velocity: [0, -2]}
joints:
  a: {type: rod, from: ground.A, to: bar.a}
  b: {type: rod, from: ground.B, to: bar.b}
stops:
  left: {joint: a, length: [1, null], restitution: 0.5}
  right: {joint: b, length: [1, null], restitution: 0.5}
analysis: {duration: 0.01, samples: 2, impacts: IMPACTS}
"""


@pytest.mark.parametrize("impacts", IMPACTS)
def test_a_bar_falls_flat_on_two_posts(impacts: str) -> None:
    """Both at the same time in either model; it rises without turning."""
    found = study(POSTS.replace("IMPACTS", impacts)).results
    blow = found.impulses[0]
    near(blow["bodies"]["bar"]["center_velocity_jump"], [0.0, 3.0, 0.0], 3.0, 1e-13)
    near(blow["bodies"]["bar"]["angular_velocity_jump"], [0.0, 0.0, 0.0], 3.0, 1e-13)
    near([blow["stops"][name]["force"] for name in ("left", "right")], [4.5, 4.5], 4.5, 1e-13)
    assert "left and right share the impulse" in found.model["contacts"][0]


MIDDLE = POSTS.replace("stops:", "  c: {type: rod, from: ground.C, to: bar.c}\nstops:").replace(
    "analysis:", "  middle: {joint: c, length: [1, null], restitution: 0.5}\nanalysis:"
)


def test_what_a_third_post_bears_is_open_where_it_is_struck_at_once() -> None:
    for impacts in IMPACTS:
        blow = study(MIDDLE.replace("IMPACTS", impacts)).results.impulses[0]
        assert all(np.isnan(blow["stops"][name]["force"]) for name in ("left", "right", "middle"))
        near(blow["bodies"]["bar"]["center_velocity_jump"], [0.0, 3.0, 0.0], 3.0, 1e-13)


def test_posts_that_are_struck_in_turn_leave_nothing_open() -> None:
    """Turning, it comes to the right post first, then to others: three impulses, all of them known."""
    turning = MIDDLE.replace("velocity: [0, -2]}", "velocity: [0, -2], angular_velocity: [0, 0, -0.5]}")
    blow = study(turning.replace("IMPACTS", "sequential")).results.impulses[0]
    forces = [blow["stops"].get(name, {}).get("force", 0.0) for name in ("left", "middle", "right")]
    assert all(np.isfinite(forces)) and forces[2] > 0.0
    near(sum(forces), 3.0 * blow["bodies"]["bar"]["center_velocity_jump"][1], 9.0, 1e-12)
    near(forces[2] - forces[0], blow["bodies"]["bar"]["angular_velocity_jump"][2], 9.0, 1e-12)


def test_what_does_not_load_each_other_is_no_matter_of_a_model() -> None:
    """Two balls, each on its own floor, at one instant: said, and not warned of."""
    found = study("""
heun: 1
gravity: [0, 0, -10]
ground: {points: {O: [0, 0, 0], P: [1, 0, 0]}}
bodies:
  a: {mass: 2, center: [0, 0, 0], inertia: [1, 1, 1], points: {c: [0, 0, 0]}}
  b: {mass: 5, center: [0, 0, 0], inertia: [1, 1, 1], points: {c: [0, 0, 0]}}
joints:
  one: {type: slide, from: ground.O, to: a.c, axis: [0, 0, 1], initial: {speed: -1}}
  two: {type: slide, from: ground.P, to: b.c, axis: [0, 0, 1], initial: {speed: -1}}
stops:
  p: {joint: one, travel: [0, null], restitution: 0.5}
  q: {joint: two, travel: [0, null], restitution: 0.25}
analysis: {duration: 0.01, samples: 2}
""").results
    assert found.impulses[0]["names"] == ["p", "q"] and not found.warnings
    assert found.model["contacts"] == ["at t = 0 s p and q impact at the same time, and do not load each other"]


def test_both_sides_are_struck_without_a_word_on_energy() -> None:
    """Restitution 1 at both: each takes its own."""
    run = balls([1.0] * 3, [1.0, 0.0, -1.0], [1.0, 1.0], "simultaneous")
    near(speeds(run, 3), [-1.0, 0.0, 1.0], 1.0, 1e-13)
    (told,) = run.results.model["contacts"]
    assert "energy" not in told and "s0 and s1 share the impulse" in told


def test_ropes_without_restitution_and_latches_are_said_too() -> None:
    """What a blow meets as held both ways shares it as well; two ropes on two masses, one impulse."""
    held = ROPES.replace(", restitution: 1", "")
    found = study(held.replace("IMPACTS", "simultaneous")).results
    assert "r0 and r1 act in both directions" in found.model["contacts"][0] and found.warnings
    latched = study("""
heun: 1
space: planar
ground: {points: {O: [0, 0]}}
bodies:
  b0: {mass: 1, center: [0, 0], inertia: 0.01, points: {o: [0, 0]}}
  b1: {mass: 1, center: [0, 0], inertia: 0.01, points: {o: [0, 0]}, position: [1, 0]}
joints:
  g0: {type: slide, from: ground.O, to: b0.o, axis: [1, 0], initial: {travel: 0, speed: 1}}
  g1: {type: slide, from: ground.O, to: b1.o, axis: [1, 0], initial: {travel: 1, speed: 0}}
  c: {type: rod, from: b0.o, to: b1.o}
stops: {s: {joint: c, length: [1, null], restitution: 0}}
latches: {brake: {joint: g0, when: t > 0.01}}
impulses: {h: {on: b1.o, vector: [-3, 0], time: 0.01}}
analysis: {duration: 0.02, samples: 2}
""").results
    assert any("s" in one and "brake" in one and "share" in one for one in latched.model["contacts"])


def test_strict_fails_where_a_blow_is_shared(heun: Heun) -> None:
    cradle = str(ROOT / "specs" / "cradle.yaml")
    assert heun("run", cradle, "--only", "impulses").returncode == 0
    done = heun("run", cradle, "--only", "impulses", "--strict", "--set", "analysis.impacts=simultaneous")
    assert done.returncode != 0 and "share the impulse" in done.stderr


SEESAW = """
heun: 1
space: planar
gravity: [0, -10]
ground: {points: {O: [0, 0], gl: [-1, -10], gr: [1, -10], ge: [1.5, 0.95]}}
bodies:
  carrier: {mass: 0.5, center: [0, 0], inertia: 0, points: {c: [0, 0]}}
  beam: {mass: 2, center: [0, 0], inertia: 0.6, points: {c: [0, 0], l: [-1, 0], r: [1, 0], e: [1.5, 0]}}
  ball: {mass: 0.7, center: [0, 0], inertia: 0, points: {c: [0, 0]}}
joints:
  lift: {type: slide, from: ground.O, to: carrier.c, axis: [0, 1]}
  tilt: {type: pin, from: carrier.c, to: beam.c}
  fall: {type: slide, from: ground.ge, to: ball.c, axis: [0, 1], initial: {travel: 0.05}}
  L: {type: rod, from: ground.gl, to: beam.l}
  R: {type: rod, from: ground.gr, to: beam.r}
  B: {type: rod, from: beam.e, to: ball.c}
stops:
  left: {joint: L, length: [10, null], restitution: 0}
  right: {joint: R, length: [10, null], restitution: 0}
  top: {joint: B, length: [0.9, null], restitution: 0.3}
analysis: {duration: 0.4, samples: 3}
"""


def test_a_negative_impulse_is_a_load_during_an_unseen_flight() -> None:
    """A ball comes to rest on the overhang of a beam, whose far end lifts each time, at last for less than is seen.

    Its support then pulls by as much as it would have borne during that flight: (25 N 1 m - 7 N 0.5 m) / 2 m = 10.75 N
    at rest, for less than 1e-6 s. The run says so.
    """
    run = study(SEESAW)
    impulses = [(float(blow["time"]), blow["stops"]["left"]["force"]) for blow in run.results.impulses]
    negative = [(time, force) for time, force in impulses if force < 0.0]
    assert negative and all(force > -10.75 * 1e-6 for _, force in negative)
    notes = run.results.model["contacts"]
    for time, _ in negative:
        assert any(f"t = {time:.6g} s the impulse of left is negative" in note for note in notes), notes
    assert sum("is negative" in note for note in notes) == len(negative)
