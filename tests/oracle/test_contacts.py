"""Random machines with stops and ropes that catch: laws that hold at every instant, and the oracle at every strike.

No gap is ever negative, nothing pulls where it may only push, no strike gains energy, and what the foundation takes up
is what the bodies lose. At every strike the jump is one that Newton's law allows, what bears at rest is what
complementarity says (tests/oracle/contacts.py tries all choices).
"""

from __future__ import annotations

import math
from functools import cache
from typing import Any

import numpy as np
import pytest

from heuncli.study.queries.study import Study
from tests.oracle.contacts import TOUCHES, Contact, contacts, rest, strike, values
from tests.oracle.read import Placed, model, state_at
from tests.oracle.turns import cross
from tests.shared.scenes import near, study
from tests.shared.seeds import list_daily_seeds
from tests.shared.stopped_trees import stopped_tree
from tests.shared.trees import weighed

pytestmark = pytest.mark.heavy  # families at random: with the compiled kernel, which has the same bits

LOCKED = (2,)  # two stops rock against each other: infinitely many times infinitely many strikes
SEEDS = [s for s in range(24) if s not in LOCKED]
END = 1.0
MOST = 12  # strikes that are looked at of a run
GAP = 1e-9  # of the scene's size


@cache
def plain(seed: int) -> dict[str, Any]:
    """With masses for shapes."""
    return weighed(stopped_tree(seed))


@cache
def run_of(seed: int) -> Study:
    return study({**stopped_tree(seed), "analysis": {"times": [0.0, END], "tolerance": 1e-10}})


@cache
def dense(seed: int) -> tuple[Study, list[dict[str, Placed]]]:
    """The run at many instants, strikes and those just before them among them."""
    run = run_of(seed)
    at = [float(b["time"]) for b in run.results.impulses][:MOST]
    last = float(run.results.time[-1])
    times = np.unique([*np.linspace(0, last, 41), *at, *(max(0.0, math.nextafter(t, 0.0)) for t in at)])
    found = run.resample(times)
    return found, [state_at(found.bodies, k) for k in range(len(times))]


@pytest.mark.parametrize("seed", SEEDS)
@pytest.mark.sixth
def test_no_gap_is_negative(seed: int) -> None:
    """At no instant does a coordinate pass its limit, or a rope its length."""
    run = run_of(seed)
    assert run.results.status["code"] == "completed", run.results.status
    size = run.setup.scene.layout.size
    for state in dense(seed)[1]:
        for c, (gap, _) in values(plain(seed), state).items():
            assert gap >= -GAP * max(1.0, size), (c, gap)


@pytest.mark.parametrize("seed", SEEDS)
@pytest.mark.third
def test_nothing_pulls(seed: int) -> None:
    """Stops push inward, ropes pull; what is free carries nothing."""
    found, states = dense(seed)
    sides: dict[str, list[Contact]] = {}
    for c in contacts(plain(seed)):
        sides.setdefault(c.name, []).append(c)
    for name, own in sides.items():
        if name in found.joints:
            push = found.joints[name]["tension"]
        else:
            (push,) = found.stops[name].values()
        for k, state in enumerate(states):
            now = values(plain(seed), state)
            signs = [c.sign for c in own if abs(now[c][0]) <= 10 * GAP * max(1.0, run_of(seed).setup.scene.layout.size)]
            if name in found.joints:
                assert push[k] >= 0.0 and (signs or push[k] == 0.0), (name, found.time[k], push[k])
            else:
                assert push[k] == 0.0 or any(push[k] * s >= 0 for s in signs), (name, found.time[k], push[k])


@pytest.mark.parametrize("seed", SEEDS)
def test_energy(seed: int) -> None:
    """No strike gains any; kinetic + potential − work stays."""
    run = run_of(seed)
    for b in run.results.impulses:
        assert b["energy_jump"] <= 1e-10 * max(1.0, b["energy_before"]), b["names"]
    e = dense(seed)[0].energy
    total = e["kinetic"] + e["potential"] - e["work"]
    size = max(1.0, float(np.ptp(e["potential"])), float(e["kinetic"].max()))
    near(total, total[0], size, 1e-7)  # what strikes lose is in the work


@pytest.mark.parametrize("seed", SEEDS)
def test_momentum(seed: int) -> None:
    """What the foundation takes up the bodies lose, in both kinds of momentum."""
    found, states = dense(seed)
    for b in run_of(seed).results.impulses[:MOST]:
        state = states[int(np.searchsorted(found.time, b["time"]))]
        force, moment = np.zeros(3), np.zeros(3)
        size = 1.0
        for name, m in model(plain(seed)).masses.items():
            dv, dw = (b["bodies"][name][w] for w in ("center_velocity_jump", "angular_velocity_jump"))
            I_world = state[name].rotation @ m.inertia @ state[name].rotation.T
            force -= m.mass * dv
            moment -= cross(state[name].point(m.center), m.mass * dv) + I_world @ dw
            size = max(size, float(np.abs(m.mass * dv).max()), float(np.abs(I_world @ dw).max()))
        near(b["foundation"]["force"], force, size)
        near(b["foundation"]["moment"], moment, 3 * size)


@pytest.mark.parametrize("seed", SEEDS)
def test_strikes_are_those_of_the_oracle(seed: int) -> None:
    """From the state just before: jumps and impulses are one that Newton's law allows."""
    found, states = dense(seed)
    for b in run_of(seed).results.impulses[:MOST]:
        k = int(np.searchsorted(found.time, b["time"]))
        if k == 0:
            continue
        touching = [rate for gap, rate in values(plain(seed), states[k - 1]).values() if abs(gap) <= TOUCHES]
        if max(touching) > 1e-12:  # what just opens is met only if others throw it back: one after the other
            continue
        allowed = strike(plain(seed), states[k - 1], float(b["time"]))
        assert allowed, (b["time"], b["names"])
        apart = []
        for met in allowed:
            size = max(1.0, *(float(np.abs(v).max()) for v in met.solution.acceleration.values()))
            off = max(float(np.abs(b["bodies"][n]["center_velocity_jump"] - v).max())
                      for n, v in met.solution.acceleration.items())  # fmt: skip
            apart.append(off / size)
        assert min(apart) <= 1e-7, (b["time"], b["names"], apart)


@pytest.mark.parametrize("seed", SEEDS)
@pytest.mark.third
def test_what_bears_is_that_of_the_oracle(seed: int) -> None:
    """Accelerations at instants between strikes, what rests on stops among them."""
    found, states = dense(seed)
    struck = {float(b["time"]) for b in run_of(seed).results.impulses}
    some = [k for k, t in enumerate(found.time.tolist()) if t not in struck and k + 1 < len(states)]
    for k in some[:: max(1, len(some) // 25)]:
        if math.nextafter(float(found.time[k]), 1e9) in struck:
            continue
        allowed = rest(plain(seed), states[k], float(found.time[k]))
        assert allowed, found.time[k]
        apart = []
        for met in allowed:
            size = max(1.0, *(float(np.abs(v).max()) for v in met.solution.acceleration.values()))
            off = max(float(np.abs(found.bodies[n]["center_acceleration"][k] - v).max())
                      for n, v in met.solution.acceleration.items())  # fmt: skip
            apart.append(off / size)
        assert min(apart) <= 1e-7, (found.time[k], apart, [m.pushes for m in allowed])


@pytest.mark.long
def test_the_family_is_what_it_should_be() -> None:
    """Most are struck, some rest, several have ropes."""
    runs = [run_of(seed).results for seed in list_daily_seeds(SEEDS)]
    assert sum(bool(r.impulses) for r in runs) >= 9
    assert sum(any(np.abs(next(iter(b.values()))[-1]) > 0 for b in r.stops.values()) for r in runs if r.stops) >= 2
    ropes = [n for r in runs for b in r.impulses for n in b["names"] if n.startswith("rope")]
    assert len(ropes) >= 3
