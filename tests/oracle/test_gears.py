"""Random scenes with what meshes, belts and sums of coordinates, some in closed chains, against the oracle."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

from tests.oracle.gears import load, pulls, teeth
from tests.oracle.loads import pushes
from tests.oracle.read import State, model, start_state
from tests.oracle.rows import assemble, coordinates, velocities
from tests.oracle.solve import accelerations, acting, scene_length
from tests.oracle.sums import exerted, sums
from tests.oracle.threads import threads
from tests.oracle.turns import Array
from tests.shared import checks
from tests.shared.coupled_scenes import coupled_scene
from tests.shared.geared_scenes import geared
from tests.shared.scenes import near
from tests.shared.seeds import spared
from tests.shared.trees import ABOUT, Case, case

ALL = spared(range(15), frozenset({1, 2, 3}))


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
