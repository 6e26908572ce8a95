"""Random trees whose joints are latched and released one over the other: the oracle drives what is held, and stands.

A catch is the blow of a drive whose rate jumps to zero; while it holds, a latch exerts what such a drive does.
"""

from __future__ import annotations

import math
from functools import cache
from typing import Any

import numpy as np
import pytest

from heuncli.results.results import Results
from tests.oracle.impulses import state_after, struck
from tests.oracle.read import Placed, model, state_at
from tests.oracle.rows import coordinates
from tests.oracle.solve import Solution, solve
from tests.oracle.totals import kinetic_energy
from tests.shared.scenes import near, solved
from tests.shared.stopped_trees import STOPPED
from tests.shared.trees import tree_scene, weighed

pytestmark = pytest.mark.heavy  # families at random: with the compiled kernel, which has the same bits

SEEDS = range(12)
END = 0.8
CLOSE = 1e-7


@cache
def latched_tree(seed: int) -> dict[str, Any]:
    """A tree in motion: every pin and slide caught at an instant, most let go at another one; nothing else holds it."""
    found, _ = tree_scene(seed, kinds=("pin", "slide", "pin", "ball"), n_bodies=2 + seed % 3, free=0.0,
                          loads=("force", "spring", "torque"), in_time=False)  # fmt: skip
    rng = np.random.default_rng(90_000 + seed)
    latches: dict[str, Any] = {}
    for joint in model(found).joints:
        if joint.kind in STOPPED:
            begin, end = rng.uniform(0.05, 0.5), rng.uniform(0.5, 1.0)
            latches[f"hold_{joint.name}"] = {"joint": joint.name, "when": f"t > {begin!r}", "release": f"t > {end!r}"}
    return {**found, "latches": latches}


def begin_of(latch: dict[str, Any]) -> float:
    return float(latch["when"].removeprefix("t > "))


def end_of(latch: dict[str, Any]) -> float:
    return float(latch["release"].removeprefix("t > "))


@cache
def run_of(seed: int) -> tuple[Results, list[dict[str, Placed]]]:
    """At instants between, and just before and at each catch."""
    scene = latched_tree(seed)
    at = sorted(map(begin_of, scene["latches"].values()))
    times = np.unique([*np.linspace(0.0, END, 9), *at, *(math.nextafter(t, 0.0) for t in at), *(t + 1e-3 for t in at)])
    found = solved({**scene, "analysis": {"times": times.tolist(), "tolerance": 1e-11}})
    return found, [state_at(found.bodies, k) for k in range(len(times))]


def held_by(seed: int, t: float, *, behind: bool) -> list[str]:
    """The joints that are held at an instant, or just behind it."""
    held = []
    for latch in latched_tree(seed)["latches"].values():
        begin, end = begin_of(latch), end_of(latch)
        if begin < t < end or (behind and t == begin):
            held.append(latch["joint"])
    return held


def standing(seed: int, joints: list[str], state: dict[str, Placed]) -> dict[str, Any]:
    """The tree with coordinates that stand where they are, as drives that are given them."""
    scene = {k: v for k, v in weighed(latched_tree(seed)).items() if k != "latches"}
    kinds = {joint.name: joint for joint in model(scene).joints}
    drives = {}
    for name in joints:
        quantity = STOPPED[kinds[name].kind]
        place = float(coordinates(kinds[name], state)[quantity])
        drives[f"stand_{name}"] = {"joint": name, quantity: (lambda t, q=place: q, lambda t: 0.0, lambda t: 0.0)}
    return {**scene, "drives": drives}


def size_of(found: Solution) -> float:
    return max([1.0, *(abs(r.drive) for r in found.reactions.values()),
                *(float(np.abs(r.force).max()) for r in found.reactions.values())])  # fmt: skip


@pytest.mark.parametrize("seed", SEEDS)
@pytest.mark.third
def test_catches_are_the_blows_of_drives_that_stop(seed: int) -> None:
    """Jumps of all bodies, the latch's impulse, those of the joints, and what energy is lost: ½ ΔV·M ΔV."""
    found, states = run_of(seed)
    assert len(found.impulses) == len(latched_tree(seed)["latches"])
    for blow in found.impulses:
        t = begin_of(latched_tree(seed)["latches"][blow["names"][0]])
        near(blow["time"], t, END, 1e-15)
        k = int(np.searchsorted(found.time, t))
        scene = standing(seed, held_by(seed, t, behind=True), states[k - 1])
        jump = struck(scene, states[k - 1], t)
        size = max(1.0, size_of(jump))
        for name, dv in jump.acceleration.items():
            near(blow["bodies"][name]["center_velocity_jump"], dv, size, CLOSE)
            near(blow["bodies"][name]["angular_velocity_jump"], jump.angular_acceleration[name], size, CLOSE)
        for name in blow["names"]:
            (impulse,) = blow["stops"][name].values()
            near(impulse, jump.reactions[latched_tree(seed)["latches"][name]["joint"]].drive, size, CLOSE)
        for name, joint in blow["joints"].items():
            near(joint["force"], jump.reactions[name].force, size, CLOSE)
        after = state_after(scene, states[k - 1], jump)
        lost = {name: s._replace(velocity=after[name].velocity - s.velocity,
                                 angular_velocity=after[name].angular_velocity - s.angular_velocity)
                for name, s in states[k - 1].items()}  # fmt: skip
        near(-blow["energy_jump"], kinetic_energy(scene, lost), max(1.0, blow["energy_before"]), CLOSE)


@pytest.mark.parametrize("seed", SEEDS)
@pytest.mark.third
def test_what_latches_exert_is_what_standing_drives_do(seed: int) -> None:
    """Accelerations, the loads of joints and of latches at every instant; nothing of those that are open."""
    found, states = run_of(seed)
    released = {*map(end_of, latched_tree(seed)["latches"].values())}
    for k, t in enumerate(found.time.tolist()):
        if t in released:
            continue
        held = held_by(seed, t, behind=True)
        answer = solve(standing(seed, held, states[k]), states[k], t)
        size = max(size_of(answer), *(float(np.abs(a).max()) for a in answer.acceleration.values()))
        for name, a in answer.acceleration.items():
            near(found.bodies[name]["center_acceleration"][k], a, size, CLOSE)
        for name, reaction in answer.reactions.items():
            near(found.joints[name]["force"][k], reaction.force, size, CLOSE)
            near(found.joints[name]["moment"][k], reaction.moment, size, CLOSE)
        for name, latch in latched_tree(seed)["latches"].items():
            (exerted,) = found.stops[name].values()
            wanted = answer.reactions[latch["joint"]].drive if latch["joint"] in held else 0.0
            near(exerted[k], wanted, size, CLOSE)


@pytest.mark.parametrize("seed", SEEDS)
def test_energy_and_where_they_hold(seed: int) -> None:
    """Kinetic + potential − work stays; what is held stays where it was caught, to rounding."""
    found, states = run_of(seed)
    total = found.energy["kinetic"] + found.energy["potential"] - found.energy["work"]
    near(
        total, total[0], max(1.0, float(found.energy["kinetic"].max()), float(np.ptp(found.energy["potential"]))), 1e-8
    )
    joints = {joint.name: joint for joint in model(weighed(latched_tree(seed))).joints}
    for name, latch in latched_tree(seed)["latches"].items():
        joint, event = joints[latch["joint"]], found.events[name]
        assert event["to"][:1] == [True]
        near(event["time"][0], begin_of(latch), END, 1e-14)
        held = [k for k, t in enumerate(found.time.tolist()) if latch["joint"] in held_by(seed, t, behind=True)]
        places = np.array([coordinates(joint, states[k])[STOPPED[joint.kind]] for k in held])
        near(np.sin(places - places[0]), 0.0, 1.0, 1e-12)
