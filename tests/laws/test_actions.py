"""The list of actions: each enters its bodies at their own points, all together end in the ground; rows do no work."""

from __future__ import annotations

from functools import cache

import numpy as np
import pytest

from heuncli.base.joint_kinds import JOINTS
from heuncli.loads.kinetostatics.actions import list_joint_actions
from heuncli.loads.kinetostatics.foundation import find_inertia_loads
from heuncli.multibody.mechanism.loads import GROUND
from heuncli.study.compose.recovery import Recovery, recover
from heuncli.study.solve.history import resample
from tests.oracle.turns import Array, cross
from tests.shared import doubles
from tests.shared.loops import loop
from tests.shared.scenes import solved
from tests.shared.seeds import spared
from tests.shared.trees import TIMES, Case, tree

SCENES = [
    *((tree, seed) for seed in range(13)), *((loop, seed) for seed in range(12)),
    *((loop, seed) for seed in range(1000, 1008)),
]  # fmt: skip
CASES = spared(SCENES, {(tree, 0), (tree, 1), (loop, 1), (loop, 2), (loop, 1000)})


@cache
def recovery(make: object, seed: int) -> tuple[Case, Recovery]:
    """A random scene with all that is recovered at its instants."""
    c: Case = make(seed)  # type: ignore[operator]
    study = c.study
    return c, recover(study.setup, resample(study.setup.runner, study.history, np.array(TIMES)), least_norm=False)


@pytest.mark.parametrize("of", CASES)
@pytest.mark.third
def test_actions_enter_at_the_points_of_their_bodies(of: tuple[object, int]) -> None:
    """Where a lever lies between, as in a rod, the force runs along it."""
    c, r = recovery(*of)
    seen = 0
    for action in [*r.applied_actions, *list_joint_actions(r.joints)]:
        for end, force, _ in action.iter_ends():
            if end.point is None or (action.from_end is None and not action.force.any()):
                continue  # it moves over the body, or is a couple, which may enter anywhere
            seen += 1
            lever = end.position - r.states.point_position(end.body, end.point)
            off = cross_all(lever, force) if end.is_offset else lever * c.force[0]
            assert np.abs(off).max() <= 1e-9 * max(c.force) * c.length
    assert seen


@pytest.mark.parametrize("of", CASES)
@pytest.mark.third
def test_the_power_of_what_acts_in_a_joint_is_its_value_times_its_rate(of: tuple[object, int]) -> None:
    """In balls and planes, too, where the rate has no axis: it is how fast they turn, or slide, at all."""
    c, _ = recovery(*of)
    for name, load in c.scene["forces"].items():
        if "joint" in load and c.scene["joints"][load["joint"]]["type"] != "cylinder":  # which may do both
            told = c.found.forces[name]
            assert told["value"] * told["rate"] == pytest.approx(told["power"], rel=1e-12, abs=1e-12)


def test_what_resists_nothing_tells_how_fast_its_joint_turns() -> None:
    """A ball's rate is how fast it turns about whatever axis."""
    scene = {
        "ground": {"points": {"O": [0.0, 0.0, 0.0]}},
        "bodies": {"disc": {"mass": 1.0, "center": [0, 0, 0], "inertia": [1.0, 1.0, 1.5], "points": {"o": [0, 0, 0]},
                            "angular_velocity": [1.0, 2.0, 2.0]}},
        "joints": {"ball": {"type": "ball", "from": "ground.O", "to": "disc.o"}},
        "forces": {"none": {"type": "damper", "joint": "ball", "coefficient": 0}},
    }  # fmt: skip
    told = solved(scene).forces["none"]
    assert told["rate"] == pytest.approx([3.0]) and told["value"].tolist() == [0.0]


@pytest.mark.parametrize("of", CASES)
@pytest.mark.third
def test_what_comes_from_outside_ends_in_the_ground(of: tuple[object, int]) -> None:
    """Supports, drives and loads between ground and body carry what acts from outside, less the inertia."""
    c, r = recovery(*of)
    mechanism = r.setup.scene.mechanism
    ma, spin = find_inertia_loads(mechanism, r.states)
    net = np.array([b.mass for b in mechanism.bodies])[:, None] * mechanism.gravity - ma
    force, moment = net.sum(axis=1), (np.cross(r.states.centre, net) - spin).sum(axis=1)
    for action in [*r.applied_actions, *list_joint_actions(r.joints)]:
        if action.from_end is None:
            force = force + action.force
            moment = moment + cross_all(action.to_end.position, action.force) + action.moment
        elif (on_ground := action.ground_load()) is not None:
            F, M, position = on_ground
            force, moment = force - F, moment - M - cross_all(position, F)
    for k in range(len(TIMES)):
        assert np.abs(force[k]).max() <= 1e-9 * c.force[k]
        assert np.abs(moment[k]).max() <= 1e-9 * c.force[k] * c.length


@pytest.mark.parametrize("seed", spared(doubles.SEEDS[:36], doubles.QUICK))
@pytest.mark.third
def test_closure_rows_do_no_work(seed: int) -> None:
    """A row's wrench does no power on the relative motion that its joint leaves free; a driven rod's moves its end."""
    c, r = recovery(doubles.redundant, seed)
    layout, states = r.setup.scene.layout, r.states
    force, moment = r.solutions.rows["f"], r.solutions.rows["m"]
    assert len(layout.rows)
    speed = max(np.abs(states.v).max() + np.abs(states.omega).max() * c.length, 1e-6)  # of some that stand still
    for row, k in enumerate(layout.rows):
        joint = layout.mechanism.joints[k]
        Q = states.point_position(joint.b, joint.q)
        turning = spin(r, joint.b) - spin(r, joint.a)
        slip = states.point_velocity(joint.b, Q) - states.point_velocity(joint.a, Q)
        if JOINTS[joint.kind].keeps_distance:
            slip = states.point_velocity(joint.b, Q) - states.point_velocity(
                joint.a, states.point_position(joint.a, joint.p)
            )
        power = np.sum(force[:, row] * slip + moment[:, row] * turning, axis=1)
        assert np.abs(force[:, row]).max() + np.abs(moment[:, row]).max() >= 0.5
        assert np.abs(power).max() <= 1e-8 * speed


def spin(r: Recovery, body: int) -> Array:
    """Angular velocity of a body, or of the ground, (n_t, 3)."""
    return r.states.omega[:, body] if body != GROUND else np.zeros((len(TIMES), 3))


def cross_all(a: Array, b: Array) -> Array:
    """Products instant by instant, written apart from what is tested."""
    return np.array([cross(x, y) for x, y in zip(a, b, strict=True)])
