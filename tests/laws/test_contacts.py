"""Contacts: complementarity on random problems, energy at strikes, what redundant ropes share, starts of ropes."""

from __future__ import annotations

import itertools
import math

import numpy as np
import pytest

from heuncli.base.errors import SolveError
from heuncli.motion.integration.contacts import restitution
from heuncli.motion.integration.contacts.complementarity import solve_complementarity
from heuncli.motion.integration.contacts.contact_events import find_held_contacts
from heuncli.motion.integration.contacts.impulses import GivenImpulse, schedule_impulses
from heuncli.motion.integration.contacts.restitution import (
    MAX_ELASTIC_ROUNDS,
    ContactImpulses,
    solve_contact_impulses,
)
from heuncli.motion.integration.contacts.sequential_impacts import EndlessImpacts
from heuncli.motion.integration.contacts.touching import TouchingContacts
from heuncli.motion.integration.run.request import MotionTask
from heuncli.motion.integration.trajectory import Trajectory
from heuncli.results.results import Array
from heuncli.scene.file_format.load import load
from heuncli.scene.file_format.models import ImpactModel
from heuncli.study.model.setup import set_up
from tests.shared.scenes import solved

G = 10.0


def motion(text: str, last: float, tolerance: float = 1e-10) -> Trajectory:
    setup = set_up(load("scene.yaml", text))
    assert setup.method is not None
    return setup.runner.run(MotionTask(np.linspace(0.0, last, 11), tolerance, method=setup.method))


# ---- the problem of complementarity
@pytest.mark.parametrize("seed", range(40))
def test_complementarity(seed: int) -> None:
    """z, w >= 0 and one of them 0, for any rank; the work that w takes is the only one there is."""
    rng = np.random.default_rng(seed)
    n, rank = int(rng.integers(1, 7)), int(rng.integers(1, 7))
    W = rng.standard_normal((n, rank)) * 10.0 ** rng.uniform(-3, 3, (n, 1))  # contacts of any unit
    A, q = W @ W.T, W @ rng.standard_normal(rank)  # rates of a motion: then there is an answer
    size = np.sqrt(np.diag(A))
    found = solve_complementarity(A, q, 1e-12 * (size + np.abs(q)))
    w = q + A @ found.z
    assert (found.z >= 0.0).all()
    assert (w >= -1e-9 * (size * np.linalg.norm(found.z * size) + np.abs(q))).all()
    assert np.abs(found.z * w).max() <= 1e-9 * np.abs(found.z * size).max(initial=1.0) * (1.0 + np.abs(q / size).max())
    assert not (found.bears & found.depends).any()


def test_what_cannot_be_held_apart_is_refused() -> None:
    A = np.array([[1.0, -1.0], [-1.0, 1.0]])  # a wedge between two walls that close
    with pytest.raises(SolveError, match="prevent the contacts from penetrating"):
        solve_complementarity(A, np.array([-1.0, -1.0]), np.full(2, 1e-12))


@pytest.mark.parametrize("impacts", ["simultaneous", "sequential"])
@pytest.mark.parametrize("seed", range(40))
def test_energy_never_grows(seed: int, impacts: ImpactModel) -> None:
    """Newton's restitution, any number of contacts, each with its own; what moves apart at once is struck later."""
    rng = np.random.default_rng(100 + seed)
    n, rank = int(rng.integers(1, 6)), int(rng.integers(2, 7))
    W, v = rng.standard_normal((n, rank)), rng.standard_normal(rank)
    none = np.zeros((n, 1, 6))
    e = rng.uniform(0.0, 1.0, n) if seed % 2 else np.full(n, rng.choice([0.0, 0.5, 1.0]))
    touch = TouchingContacts(np.arange(n), none, W @ v, np.full(n, 1e-12), np.full(n, 1e-14), e, np.ones(n))
    try:
        found = solve_contact_impulses(
            touch, W @ W.T, np.ones(n, dtype=bool), np.zeros(n), np.zeros(n, dtype=bool), impacts
        )
    except EndlessImpacts:
        assert (e == 1.0).all() and rank < n  # a cage without play
        return
    after = v + W.T @ found.impulses
    assert (found.impulses >= 0.0).all()
    assert (W @ after >= -1e-9).all()
    assert after @ after <= (v @ v) * (1.0 + 1e-12)
    if (e == 1.0).all() and (impacts == "sequential" or found.count.sum() < MAX_ELASTIC_ROUNDS):
        assert after @ after == pytest.approx(v @ v)


@pytest.mark.parametrize("seed", [3, 19, 86, 90, 165, 177])  # where the work of restitution 1 is above 0 by rounding
def test_each_contact_takes_its_own_restitution(seed: int) -> None:
    """Beside others, and beside a machine that it does not feel; no restitution adds energy."""
    rng = np.random.default_rng(seed)
    n = int(rng.integers(2, 4))
    W, rate, e = rng.standard_normal((n, n)), -rng.uniform(0.0, 1.0, n), rng.choice([0.0, 1.0, 0.5], n)
    alone = struck(W @ W.T, rate, e)
    bearing = alone.impulses > 0.0
    assert alone.rate[bearing] == pytest.approx(-(e * rate)[bearing], rel=1e-14)
    A = np.eye(n + 1)
    A[:n, :n] = W @ W.T
    for ball, bears in ((0.0, 10.0), (0.7, 17.0)):
        beside = struck(A, np.append(rate, -10.0), np.append(e, ball))
        assert beside.impulses == pytest.approx([*alone.impulses, bears], rel=1e-14)


def struck(A: Array, rate: Array, e: Array) -> ContactImpulses:
    """Contacts that close."""
    n = len(rate)
    touch = TouchingContacts(
        np.arange(n), np.zeros((n, 1, 6)), rate, np.full(n, 1e-12), np.full(n, 1e-14), e, np.ones(n)
    )
    return solve_contact_impulses(touch, A, np.ones(n, dtype=bool), np.zeros(n), np.zeros(n, dtype=bool))


def test_rounds_that_do_not_end_are_refused(monkeypatch: pytest.MonkeyPatch) -> None:
    """What still closes after the last round is no solution."""
    monkeypatch.setattr(restitution, "MAX_ROUNDS", 0)
    with pytest.raises(EndlessImpacts):
        struck(np.eye(1), np.array([-1.0]), np.ones(1))
    assert struck(np.eye(1), np.array([0.0]), np.ones(1)).rate == 0.0


def test_two_jumps_of_one_drive_merge_into_one() -> None:
    """From the rate before the first to that after the second; others keep theirs."""
    first = GivenImpulse(0.1, 0.2, (0,), {3: (1.0, 2.0)})
    merged = first.merge(GivenImpulse(0.15, 0.3, (), {3: (2.0, 5.0), 4: (0.0, 1.0)}))
    assert (merged.before_time, merged.after_time, merged.numbers) == (0.1, 0.3, (0,))
    assert merged.drives == {3: (1.0, 5.0), 4: (0.0, 1.0)}


def test_impulses_after_the_end_are_not_given() -> None:
    """A run is scheduled up to its end, that of a shorter one too."""
    text = BALL.format(at=1, speed=0, floor=0, e=0.5)
    text += "impulses: {a: {on: ball.p, vector: [0, 0, 1], time: 1}, b: {on: ball.p, vector: [0, 0, 1], time: 2}}\n"
    mechanism = set_up(load("scene.yaml", text)).runner.layout.mechanism
    assert [given.numbers for given in schedule_impulses(mechanism, 1.0)] == [(0,)]
    assert [given.numbers for given in schedule_impulses(mechanism, 2.0)] == [(0,), (1,)]


def test_an_early_instant_does_not_blur_rates() -> None:
    """What opens slowly opens at any instant of a pose: the instant is not the length of a run."""
    text = BALL.format(at=0, speed=1e-9, floor=0, e=0.5).replace("[0, 0, -10]", "[0, 0, -1e-7]")
    runner = set_up(load("scene.yaml", text)).runner
    for t in (0.0, 1e-9, 1.0):
        assert find_held_contacts(runner, t, runner.layout.y0).tolist() == [0.0]


# ---- a ball on a floor
BALL = """
heun: 1
gravity: [0, 0, -10]
ground: {{points: {{O: [0, 0, 0]}}}}
bodies: {{ball: {{mass: 2, center: [0, 0, 0], inertia: [1, 1, 1], points: {{p: [0, 0, 0]}}}}}}
joints:
  guide: {{type: slide, from: ground.O, to: ball.p, axis: [0, 0, 1], initial: {{travel: {at}, speed: {speed}}}}}
stops: {{floor: {{joint: guide, travel: [{floor}, null], restitution: {e}}}}}
analysis: {{duration: 6, samples: 11}}
"""


@pytest.mark.parametrize(("e", "floor"), [(0.5, 0.0), (0.2, 0.0), (0.7, -3.0)])
def test_a_ball_comes_to_rest(e: float, floor: float) -> None:
    """After infinitely many strikes in a finite time: t (1 + 2e / (1 - e)), told to the rounding of its height."""
    run = motion(BALL.format(at=floor + 1.0, speed=0, floor=floor, e=e), 6.0)
    first = math.sqrt(2.0 / G)
    for k, blow in enumerate(run.impulse_events[:8]):
        assert blow.time == pytest.approx(first * (1.0 + 2.0 * sum(e**i for i in range(1, k + 1))), rel=1e-12)
        assert blow.kinetic[1] == pytest.approx(20.0 * e ** (2 * k + 2), rel=1e-9)
    assert run.impulse_events[-1].time == pytest.approx(first * (1.0 + 2.0 * e / (1.0 - e)), abs=1e-5)
    assert run.holding[-1].tolist() == [1.0]
    assert run.states[-1][:2].tolist() == pytest.approx([floor, 0.0], abs=1e-13)
    assert any("comes to rest" in note for note in run.notes)
    count = math.log(1e14) / (2.0 * math.log(1.0 / e))  # heights from 1 to the rounding of places
    assert len(run.impulse_events) == pytest.approx(count, abs=4)


@pytest.mark.parametrize("speed", [0.0, 1.0, -1.0])
def test_a_start_at_the_limit(speed: float) -> None:
    """It rests there, leaves it, or strikes at once."""
    run = motion(BALL.format(at=0, speed=speed, floor=0, e=0.5), 6.0)
    if speed == 0.0:
        assert not run.impulse_events and run.holding[0].tolist() == [1.0]
    else:
        assert run.impulse_events[0].time == (0.0 if speed < 0.0 else pytest.approx(0.2, rel=1e-12))
        assert run.impulse_events[0].kinetic == (pytest.approx(1.0), pytest.approx(0.25))


def test_a_plastic_strike_rests_and_is_let_go() -> None:
    """A floor on which a ball stays until a force lifts it: 3 t = 2 g at 20/3 s."""
    text = BALL.format(at=1, speed=0, floor=0, e=0).replace("analysis: {duration: 6", "analysis: {duration: 9")
    run = motion(text + 'forces: {lift: {type: torque, joint: guide, value: "3*t"}}\n', 9.0)
    changes = run.segments.ends[:-1]
    assert len(run.impulse_events) == 1 and run.impulse_events[0].kinetic[1] == pytest.approx(0.0, abs=1e-25)
    assert changes[-1] == pytest.approx(20.0 / 3.0, rel=1e-9)
    t = 9.0 - 20.0 / 3.0
    assert run.states[-1][0] == pytest.approx(3.0 * t**3 / 12.0, rel=1e-8)  # 2 z'' = 3 t - 20
    assert run.find_holding(np.array([0.1, 3.0, 8.0])).ravel().tolist() == [0.0, 1.0, 0.0]


# ---- four ropes carry a plate
PLATE = """
heun: 1
gravity: [0, 0, -10]
ground: {{points: {{A: [1, 1, 2], B: [-1, 1, 2], C: [-1, -1, 2], D: [1, -1, 2]}}}}
bodies:
  plate:
    {{mass: 4, center: [0.2, 0.1, 0], inertia: [1, 1, 2], position: [0, 0, {at}],
     points: {{a: [1, 1, 0], b: [-1, 1, 0], c: [-1, -1, 0], d: [1, -1, 0]}}}}
joints:
  a: {{type: rod, from: ground.A, to: plate.a, length: 2, tension_only: true, restitution: 0}}
  b: {{type: rod, from: ground.B, to: plate.b, length: 2, tension_only: true, restitution: 0}}
  c: {{type: rod, from: ground.C, to: plate.c, length: 2, tension_only: true, restitution: 0}}
  d: {{type: rod, from: ground.D, to: plate.d, length: 2, tension_only: true, restitution: 0}}
analysis: {{duration: 1, samples: 5}}
"""


def test_how_four_ropes_share_is_open() -> None:
    """Three would do: what each carries is not known, the sums are; in the blow that catches the plate, too."""
    found = solved(PLATE.format(at=0))
    assert all(found.joints[name]["open"] for name in "abcd")
    sums = [s for s in found.certain_sums if set(s["terms"]) == {"joints.a.force.z", "joints.b.force.z"}]
    assert sums and np.allclose(sums[0]["value"], 40.0 * (0.5 + 0.05), rtol=1e-12)
    fallen = solved(PLATE.format(at=1))
    (blow,) = fallen.impulses
    assert blow["time"] == pytest.approx(math.sqrt(2.0 / G), rel=1e-12)
    assert blow["energy_jump"] == pytest.approx(-40.0)
    assert all(np.isnan(blow["joints"][name]["force"][2]) for name in "abcd")


# ---- starts of ropes
ROPE = """
heun: 1
gravity: [0, 0, -10]
ground: {points: {O: [0, 0, 0]}}
bodies: {b: {mass: 2, center: [0, 0, 0], inertia: [1, 1, 1], points: {c: [0, 0, 0]}, BODY}}
joints: {rope: {type: rod, from: ground.O, to: b.c, ROPE, tension_only: true, restitution: 0.5}}
analysis: {duration: 1, samples: 5}
"""


@pytest.mark.parametrize(("body", "rope", "closed", "blows"), [
    ("position: [0, 0, -0.5]", "length: 1", 0.0, 0),  # slack
    ("position: [0, 0, -1]", "length: 1", 1.0, 0),  # taut
    ("near: {position: [0, 0, -3]}", "length: 1", 1.0, 0),  # drawn too far off: it is pulled in
    ("position: [0, 0, -1]", "length: null", 1.0, 0),  # as drawn
    ("position: [0, 0, -1], velocity: [0, 0, -2]", "length: 1", 0.0, 1),  # struck at once
    ("position: [0, 0, -1], velocity: [0, 0, 2]", "length: 1", 0.0, 0),  # thrown up
    ("position: [0, 0, 1]", "length: 1", 0.0, 0),  # it falls from above
])  # fmt: skip
def test_starts_of_ropes(body: str, rope: str, closed: float, blows: int) -> None:
    rope = rope.replace(", length: null", "").replace("length: null, ", "")
    text = ROPE.replace("BODY", body).replace("ROPE, ", "" if "null" in rope else f"{rope}, ")
    run = motion(text, 0.1)
    assert run.holding[0].tolist() == [closed]
    assert len(run.impulse_events) == blows
    if blows:
        assert run.impulse_events[0].time == 0.0 and run.impulse_events[0].kinetic == (
            pytest.approx(4.0),
            pytest.approx(1.0),
        )


@pytest.mark.heavy
def test_replays_know_what_was_closed() -> None:
    """Other instants of a run with strikes, to the last bit what a run that was asked for them gives."""
    text = BALL.format(at=1, speed=0, floor=0, e=0.5)
    setup = set_up(load("scene.yaml", text))
    assert setup.method is not None
    run = setup.runner.run(MotionTask(np.linspace(0.0, 3.0, 4), 1e-9, method=setup.method))
    times = np.unique(np.concatenate([np.linspace(0.0, 3.0, 40), run.ends[:-1]]))
    other = setup.runner.run(MotionTask(times, 1e-9, method=setup.method))
    assert np.array_equal(setup.runner.resample(run, times), other.states)


def test_a_gate_between_two_limits() -> None:
    """It swings from one to the other, at half the rate each time."""
    run = motion(
        """
heun: 1
gravity: [0, 0, 0]
ground: {points: {O: [0, 0, 0]}}
bodies: {arm: {mass: 2, center: [0.5, 0, 0], inertia: [0.1, 0.2, 0.3], points: {c: [0, 0, 0]}}}
joints: {hinge: {type: pin, from: ground.O, to: arm.c, axis: [0, 0, 1], initial: {angle: 0.1, rate: 3}}}
stops: {gate: {joint: hinge, angle: [0, 1], restitution: 0.5}}
analysis: {duration: 6, samples: 31}
""",
        6.0,
    )
    times = [blow.time for blow in run.impulse_events]
    assert {name for blow in run.impulse_events for name in blow.names} == {"gate"}
    assert times == pytest.approx(list(itertools.accumulate([0.3, 2 / 3, 4 / 3, 8 / 3])), rel=1e-10)
