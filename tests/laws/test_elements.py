"""Machine elements of every kind on carriers that move anyhow: told otherwise they say the same, every body balances.

Scenes are those of shared/coupled_scenes.py; what is told otherwise is a row of tests/faults/laws.py, of which
`python -m tests.faults --kind laws` makes more.
"""

from __future__ import annotations

from functools import cache
from random import Random
from typing import Any

import numpy as np
import pytest

from heuncli.base.errors import SolveError
from heuncli.results.results import Array, Results
from heuncli.study.queries.study import Study
from tests.faults import laws, sources
from tests.oracle.loads import pushes
from tests.oracle.read import Model, model, placed, state_at
from tests.oracle.values import to_yaml
from tests.shared import retell
from tests.shared.coupled_scenes import ELEMENTS, coupled_scene
from tests.shared.gear_trains import pair
from tests.shared.scenes import near, solved, study
from tests.shared.trees import weighed

WAYS = ("turned", "in units", "reordered", "from the other side")


@cache
def run(kind: str, seed: int) -> tuple[dict[str, Any], Study]:
    """A scene with an element of a kind, and its run."""
    scene = {k: v for k, v in coupled_scene(seed, (kind,)).items() if k != "latches"}
    scene["forces"] = {k: v for k, v in scene.get("forces", {}).items() if v["type"] != "motor"}
    return scene, study(scene)


def kinds() -> list[Any]:
    return [pytest.param(kind, marks=pytest.mark.heavy) for kind in ELEMENTS]


@pytest.mark.parametrize("kind", kinds())
@pytest.mark.third
def test_told_otherwise(kind: str) -> None:
    """The world turned, other units, another order, members exchanged; everything faster, and nothing left out."""
    seed = list(ELEMENTS).index(kind)
    tree = retell.plain(sources.parsed(to_yaml(run(kind, seed)[0])))
    first = laws.solved(tree)
    for way in WAYS[seed % 2 :: 2]:
        try:
            twins = laws.LAWS[way](Random(seed), tree, first)
        except retell.NotTold:
            continue
        one = first if twins.first is tree else laws.solved(twins.first)
        assert not laws.compared(twins, one), way


# Every body by itself


def wrench(force: Array, moment: Array, place: Array, about: Array) -> Array:
    """A force at a place and a moment as force and moment about another place, (6,)."""
    return np.concatenate([force, moment + np.cross(place - about, force)])


def told_on(found: Results, read: Model, body: str, k: int, about: Array) -> Array:
    """What joints and elements are told to exert ON a body, (6,)."""
    total = np.zeros(6)
    for joint in read.joints:
        own = found.joints[joint.name]
        sign = (joint.b.body == body) - (joint.a.body == body)
        total += sign * wrench(own["force"][k], own["moment"][k], own["point"][k], about)
    for own in found.couplings.values():
        if body in own["on"]:
            on = own["on"][body]
            total += wrench(on["force"][k], on["moment"][k], on["point"][k], about)
    return total


@pytest.mark.parametrize("kind", kinds())
@pytest.mark.third
def test_every_body_balances(kind: str) -> None:
    """d'Alembert body by body, from what joints and elements are told to exert."""
    scene, told = run(kind, 100 + list(ELEMENTS).index(kind))
    every_body_balances(scene, told.results)


def every_body_balances(scene: dict[str, Any], found: Results) -> None:
    read = model(weighed(scene))
    for k, t in enumerate(found.time):
        state = state_at(found.bodies, k)
        loads = [  # a belt's pretension is told with what it exerts
            push for of, parts in pushes(read, state, float(t)).items() if of not in found.couplings for push in parts
        ]
        for name, m in read.masses.items():
            c, s = state[name].point(m.center), found.bodies[name]["angular_velocity"][k]
            total = told_on(found, read, name, k, c)
            for push in loads:
                if push.body == name:
                    total += wrench(push.force, push.couple, push.place, c)
            inertia = state[name].rotation @ m.inertia @ state[name].rotation.T
            turning = inertia @ found.bodies[name]["angular_acceleration"][k] + np.cross(s, inertia @ s)
            wanted = np.concatenate([m.mass * found.bodies[name]["center_acceleration"][k], turning])
            size = max([1.0, *(float(np.abs(np.nan_to_num(j["force"][k])).max()) for j in found.joints.values())])
            if not np.isnan(total).any():
                near(total, wanted, 10.0 * size, 1e-9)


@pytest.mark.parametrize("kind", kinds())
@pytest.mark.third
def test_elements_exert_nothing_on_the_whole_and_give_no_power(kind: str) -> None:
    found = run(kind, 100 + list(ELEMENTS).index(kind))[1].results
    nothing_and_no_power(found)


def nothing_and_no_power(found: Results) -> None:
    for k in range(len(found.time)):
        state = state_at(found.bodies, k)
        for own in found.couplings.values():
            total, power, size = np.zeros(6), 0.0, 1.0
            for body, on in own["on"].items():
                force, moment, place = on["force"][k], on["moment"][k], on["point"][k]
                total += wrench(force, moment, place, np.zeros(3))
                B = placed(state, body)
                speed = B.velocity + np.cross(B.angular_velocity, place - B.position)
                power += float(force @ speed + moment @ B.angular_velocity)
                size += float(np.linalg.norm(force) + np.linalg.norm(moment))
            if not np.isnan(total).any():
                near(total, 0.0, 10.0 * size, 1e-10)
                near(power, min(power, 0.0) if "efficiency" in own else 0.0, 10.0 * size, 1e-9)  # what rubs takes it


RAIL = """\
heun: 1
gravity: [0, 0, -10]
tables:
  x: {x: [-2, -1, 0, 1, 2], y: [-2, -1, 0, 1, 2], interpolation: cubic}
  z: {x: [-2, -1, 0, 1, 2], y: [2, 0.5, 0, 0.5, 2], interpolation: cubic}
ground: {points: {O: [0, 0, 0]}}
bodies:
  runner: {mass: 2, center: [0, 0, 0.1], inertia: [0.1, 0.1, 0.1], points: {P: [0, 0, 0]}}
  rail: {mass: 1, center: [0, 0, 0], inertia: [0.1, 0.1, 0.1], points: {P: [0, 0, 0]}}
joints:
  hold: {type: HELD, from: ground.O, to: runner.P}
  wire: {type: curve, from: rail.P, to: RUNNER, x: x, z: z, initial: {travel: 1, speed: 0.5}}
analysis: {times: [0, 0.1, 0.2], tolerance: 1e-11}
"""


def rail(held: str, runner: str = "runner.P") -> str:
    """A rail that falls over what runs along it and is held; the runner stands first."""
    return RAIL.replace("HELD", held).replace("RUNNER", runner)


@pytest.mark.parametrize("held", ["ball", "pin, axis: [0, 1, 0]", "weld"])
def test_a_path_that_its_runner_alone_holds(held: str) -> None:
    """Its curve is not cut, whichever of its bodies is held or stands first."""
    found = solved(rail(held))
    every_body_balances(sources.parsed(rail(held)), found)
    energy = found.energy["kinetic"] + found.energy["potential"]
    near(energy, energy[0], 10.0, 1e-9)
    assert found.coordinates["wire"]["travel"][-1] != found.coordinates["wire"]["travel"][0]


def test_a_path_over_a_point_of_the_ground() -> None:
    """The rail falls along it: the curve closes a loop, and its travel is found from the pose; driven it is refused."""
    found = solved(rail("ball", "ground.O"))
    every_body_balances(sources.parsed(rail("ball", "ground.O")), found)
    energy = found.energy["kinetic"] + found.energy["potential"]
    near(energy, energy[0], 10.0, 1e-9)
    assert found.coordinates["wire"]["travel"][0] == pytest.approx(1.0, abs=1e-12)
    drive = "drives: {go: {joint: wire, travel: '1 + 0.5*t'}}\nanalysis"
    with pytest.raises(SolveError) as error:
        solved(rail("ball", "ground.O").replace("analysis", drive))
    (problem,) = error.value.problems
    assert problem.code == "path-unheld"
    assert problem.hint


def test_a_bushing_at_half_a_turn_is_told_whatever_fails_there() -> None:
    """Where rows of couplings are held as well, they are not what is lost."""
    turning = {"type": "bushing", "from": "ground.A", "to": "wheel.c", "turning": 5.0}
    scene = {**pair(ratio=-2.0), "analysis": {"duration": 2.0, "samples": 3}}
    scene["forces"] = {**scene["forces"], "mount": turning}
    with pytest.raises(SolveError) as error:
        solved(scene)
    assert [problem.code for problem in error.value.problems] == ["bushing-turned"]
