"""Random scenes with what meshes, belts and sums of coordinates, some in closed chains, against the oracle."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
import pytest

from tests.oracle.gears import Teeth, load, pulls, teeth
from tests.oracle.read import State, model, placed, start_state
from tests.oracle.rows import assemble, coordinates, velocities
from tests.oracle.solve import accelerations, acting, scene_length, wrench_map
from tests.oracle.sums import exerted, sums
from tests.oracle.threads import threads
from tests.oracle.turns import Array
from tests.shared import checks
from tests.shared.coupled_scenes import coupled_scene
from tests.shared.geared_scenes import geared
from tests.shared.scenes import near, terms_at
from tests.shared.seeds import spared
from tests.shared.train_scenes import train
from tests.shared.trees import ABOUT, Case, case

ALL = spared(range(15), frozenset({1, 2, 3}))


@pytest.mark.heavy
@pytest.mark.parametrize("seed", ALL)
def test_motion_and_loads_of_what_meshes(seed: int) -> None:
    """Accelerations of all bodies, reactions of joints, and what one member exerts ON the other."""
    as_the_oracle_says(geared(seed))


@pytest.mark.heavy
@pytest.mark.parametrize("seed", range(6))
def test_motion_and_loads_of_belts(seed: int) -> None:
    as_the_oracle_says(geared(seed, ("belt", "aside")[seed % 2]))


@pytest.mark.heavy
@pytest.mark.parametrize(("seed", "form"), [(seed, None if seed < 25 else "belt") for seed in (*range(15, 25), 25, 26)])
def test_in_closed_chains(seed: int, form: str | None) -> None:
    as_the_oracle_says(geared(seed, form, 1 + seed % 2))


@pytest.mark.heavy
@pytest.mark.parametrize("seed", range(2))
@pytest.mark.parametrize("kind", ["ratio", "differential", "threaded"])
def test_sums_of_coordinates(kind: str, seed: int) -> None:
    as_the_oracle_says(case(drawn(kind, seed)))


@pytest.mark.heavy
@pytest.mark.parametrize("kind", ["external", "rack", "screw"])
def test_what_is_coupled_twice(kind: str) -> None:
    """By its element and by a ratio: no law tells which of both carries what."""
    scene = drawn(kind, 5)
    (name,) = scene["couplings"]
    read, of = model(scene), scene["couplings"][name]["of"]
    state, joints = start_state(scene), {j.name: j for j in read.joints}
    speeds = [c.get("rate", c.get("speed")) for c in (coordinates(joints[word], state) for word in of)]
    assert min(map(abs, speeds)) > 1e-3
    scene["couplings"][name].pop("friction", None)  # which nobody could tell then
    scene["couplings"]["again"] = {"type": "ratio", "of": of, "factors": [1.0, -speeds[0] / speeds[1]]}
    c = case(scene)
    as_the_oracle_says(c)
    told = c.found.couplings
    assert all(np.isnan(told[own]["on"][body]["force"]).any() or np.isnan(told[own]["on"][body]["moment"]).any()
               for own in told for body in told[own]["on"])  # fmt: skip


@pytest.mark.heavy
@pytest.mark.parametrize("seed", range(14))
@pytest.mark.third
def test_trains_with_more_meshes_than_hold_them(seed: int) -> None:
    """Planets between suns, a ring and each other, in closed loops of meshes; certain sums against the dense matrix."""
    c = train(seed)
    as_the_oracle_says(c)
    certain_sums_are_certain(c)


@pytest.mark.heavy
def test_trains_hold_much_twice() -> None:
    """So that what is said of them is not said of nothing."""
    found = [train(seed).found for seed in range(14)]
    assert sum(own.model["redundant"] > 1 for own in found) >= 4
    sums = [name for own in found for one in own.certain_sums for name in one["terms"] if name.startswith("couplings.")]
    assert len(sums) >= 10


def certain_sums_are_certain(c: Case) -> None:
    """None of the dense solution's self-stresses has a share in a sum that is told, and its value is the oracle's."""
    for k, state in enumerate(c.states):
        o, t = c.oracle[k], float(c.study.results.time[k])
        size = scene_length(c.read, state)
        found = accelerations(c.read, state, t, acting(c.read, state, t, size), size)
        rows = {row.joint: i for i, row in enumerate(found.rows.rows)}
        ways = {own.name: forward(c, own, state) for own in teeth(c.read)}
        for told in c.found.certain_sums:
            line, weight = np.zeros(len(found.rows.rows)), 0.0
            for path, factor in terms_at(told["terms"], k).items():
                _, name, what, *component = path.split(".")
                weight += abs(factor)
                if name in ways:
                    line[rows[name]] += factor * ways[name]
                    continue
                joint = next(j for j in c.read.joints if j.name == name)
                row = {"force": 0, "moment": 3}[what] + "xyz".index(component[0])
                line += factor * wrench_map(found.rows, joint)[row]
            near(line @ found.self_stress, 0.0, weight * np.abs(found.self_stress).max())
            near(told["value"][k], line @ found.least, weight * c.force[k] * max(o.length, 1.0))


def forward(c: Case, own: Teeth, state: State) -> float:
    """1 where the oracle's direction of a tooth force is that in which the first gear drives on, else -1."""
    joint = next(j for j in c.read.joints if j.name == c.scene["couplings"][own.name]["of"][0])
    at, carrier = placed(state, joint.b.body), placed(state, own.carrier)
    axis = placed(state, joint.a.body).rotation @ joint.axis
    way = np.cross(axis, carrier.point(own.P) - at.point(joint.b.point))
    way = way if own.first == joint.b.body else -way
    return math.copysign(1.0, float(way @ (carrier.rotation @ own.f)))


def drawn(kind: str, seed: int) -> dict[str, Any]:
    """A scene with an element of a kind, without what the oracle does not follow."""
    scene = coupled_scene(seed, (kind,))
    scene["forces"] = {k: v for k, v in scene.get("forces", {}).items() if v["type"] not in ("motor", "bushing")}
    without = ("latches", "impulses", "sections")
    return {k: v for k, v in scene.items() if k not in without} | {"foundation": {"about": ABOUT.tolist()}}


def on_bodies(c: Case, name: str, state: State, multiplier: float) -> dict[str, Array]:
    """What an element exerts ON each body: force and moment about the origin, (6,)."""
    if name in (own := sums(c.read)):
        return exerted(own[name], state, multiplier)
    (of,) = (of for of in teeth(c.read) if of.name == name)
    place, force, moment = load(c.read, of, state, multiplier)
    wrench = np.concatenate([force, moment + np.cross(place, force)])
    found = {of.second: wrench, of.first: -wrench}
    for body, at, pull in pulls(c.read, state).get(name, ()):
        found[body] = found[body] + np.concatenate([pull, np.cross(at, pull)])
    return found


def as_the_oracle_says(c: Case) -> None:
    """Whatever is open is open in both."""
    checks.same_accelerations(c)
    checks.same_reactions(c)
    checks.same_foundation(c)
    for k, state in enumerate(c.states):
        t = float(c.study.results.time[k])
        size = scene_length(c.read, state)
        loads = acting(c.read, state, t, size)
        found = accelerations(c.read, state, t, loads, size)
        for name in c.scene["couplings"]:
            (row,) = (i for i, row in enumerate(found.rows.rows) if row.joint == name)
            is_open = bool(np.abs(found.self_stress[row]).max(initial=0.0) > 1e-9)
            wanted = on_bodies(c, name, state, found.least[row])
            for push in loads[name] if name in threads(c.read) else ():
                wanted[push.body] = wanted[push.body] + np.concatenate([push.force, push.about(np.zeros(3))])
            on = c.found.couplings[name]["on"]
            assert {*on} == {*wanted}
            for body, told in on.items():
                F, M = told["force"][k], told["moment"][k]
                assert np.isnan([F, M]).any() == is_open
                if not is_open:
                    near(F, wanted[body][:3], c.force[k])
                    near(M + np.cross(told["point"][k], F), wanted[body][3:], c.force[k] * c.length)


@pytest.mark.parametrize("seed", ALL)
def test_meshes_neither_slip_nor_take_power(seed: int) -> None:
    """All rows' rates vanish on the way, the counted coordinates among them; the energies add up."""
    c = geared(seed)
    for state in c.states:
        rows = assemble(c.read, state, 0.0)
        near(rows.J @ velocities(c.read, state), np.zeros(len(rows.J)), 10.0, 1e-10)
    accuracy = c.study.results.accuracy
    assert accuracy["energy_drift"] <= 1e-8
    assert accuracy["balance_residual"] <= 1e-10
