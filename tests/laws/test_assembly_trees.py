"""Trees: bodies placed outward from what is held, each turned as little as its joint asks."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

from heuncli.base.errors import SolveError
from heuncli.base.records import replace
from heuncli.multibody.assembly.assemble import assemble
from heuncli.multibody.mechanism.loads import GROUND
from heuncli.multibody.mechanism.model import Directed, Mechanism
from heuncli.scene.shapes.rotations import rotation_from_vector, vector_from_rotation
from tests.shared.assemblies import calls, same_motion
from tests.shared.drafted_mechanisms import (
    X,
    Y,
    Z,
    after,
    body,
    coordinates,
    joint,
    largest_gap,
    largest_rate_gap,
    point,
    scene,
    turned,
)

KINDS = ("ball", "pin", "universal", "weld", "slide", "cylinder", "line", "plane", "rod")


def random_tree(seed: int, kinds: tuple[str, ...] = KINDS, count: int = 12, grounded: bool = True) -> Mechanism:
    """Bodies on random earlier ones through random joints, `from` and `to` either way; some values held."""
    rng = np.random.default_rng(seed)

    def unit() -> Any:
        a = rng.normal(size=3)
        return a / np.linalg.norm(a)

    bodies = [
        body(
            f"b{i}",
            center=rng.normal(size=3),
            mass=float(rng.uniform(1, 2)),
            near_position=None,
            near_rotation=rotation_from_vector(rng.normal(size=3)) if rng.random() < 0.5 else None,
            rotation=rotation_from_vector(rng.normal(size=3)) if i == 0 else None,
            angular_velocity=rng.normal(size=3) if i == 0 else None,
        )
        for i in range(count)
    ]
    joints = []
    for i in range(count):
        before = int(rng.integers(0, i)) if i and rng.random() < 0.8 else None
        if before is None and not grounded and i:
            before = 0
        if before is None and not grounded:
            continue
        kind = str(rng.choice(kinds)) if i else "ball"  # the first holds its attitude: a ball lets it
        given: dict[str, Any] = {}
        if rng.random() < 0.5 and kind in ("pin", "cylinder", "universal"):
            given["to_axis"] = unit()
        if kind in ("pin", "cylinder") and rng.random() < 0.5:
            given["rate"] = float(rng.normal())
            if "to_axis" not in given:
                given["angle"] = float(rng.uniform(-3, 3))
        if kind in ("slide", "cylinder") and rng.random() < 0.5:
            given |= {"travel": float(rng.normal()), "speed": float(rng.normal())}
        if kind == "rod" and rng.random() < 0.7:
            given["length"] = float(rng.uniform(0.5, 1.5))
        ends = [("ground" if before is None else f"b{before}", rng.normal(size=3)), (f"b{i}", rng.normal(size=3))]
        (a, p), (b, q) = ends if rng.random() < 0.5 else ends[::-1]
        joints.append(joint(f"j{i}", kind, a, p, b, q, unit(), **given))
    return scene(bodies, joints)


@pytest.mark.parametrize("seed", range(12))
def test_random_trees_close_and_move_as_asked(seed: int) -> None:
    s = random_tree(seed)
    a = assemble(s)
    assert largest_gap(s, a) < 1e-13 * 20
    assert a.gap < 1e-12
    assert largest_rate_gap(s, a) < 1e-8
    later, earlier = after(s, a, 1e-5), after(s, a, -1e-5)
    for j in s.joints:
        c = coordinates(s, a, j)
        if j.angle is not None:
            assert c["angle"] == pytest.approx(j.angle, abs=1e-12)
        if j.travel is not None:
            assert c["travel"] == pytest.approx(j.travel, abs=1e-12)
        if j.speed is not None:
            change = coordinates(s, later, j)["travel"] - coordinates(s, earlier, j)["travel"]
            assert change / 2e-5 == pytest.approx(j.speed, abs=1e-8)
        if j.rate is not None:
            Ra = np.eye(3) if j.a == GROUND else a.rotation[j.a]
            w = np.zeros((2, 3)) + [np.zeros(3) if i == GROUND else a.angular_velocity[i] for i in (j.a, j.b)]
            assert w[1] - w[0] == pytest.approx(j.rate * (Ra @ j.axis), abs=1e-12)
    assert a.rotation[0] == pytest.approx(s.bodies[0].rotation, abs=0)


@pytest.mark.parametrize("grounded", [True, False])
@pytest.mark.parametrize("seed", range(5))
def test_the_order_of_the_file_does_not_matter(seed: int, grounded: bool) -> None:
    s = random_tree(seed, grounded=grounded)
    rng = np.random.default_rng(seed)
    order = rng.permutation(len(s.bodies))
    place = {int(old): new for new, old in enumerate(order)} | {GROUND: GROUND}
    joints = [replace(j, a=place[j.a], b=place[j.b]) for j in s.joints]
    t = replace(
        s, bodies=tuple(s.bodies[i] for i in order), joints=tuple(joints[i] for i in rng.permutation(len(joints)))
    )
    same_motion(s, assemble(s), t, assemble(t), 0.0)


@pytest.mark.parametrize("seed", range(5))
def test_moving_a_body_origin_changes_nothing(seed: int) -> None:
    s = random_tree(seed, kinds=("ball", "pin", "universal", "weld"))
    rng = np.random.default_rng(seed)
    shifts = rng.normal(size=(len(s.bodies), 3))
    bodies = tuple(replace(b, center=b.center - o) for b, o in zip(s.bodies, shifts, strict=True))
    joints = tuple(
        replace(j, p=j.p - (0 if j.a == GROUND else shifts[j.a]), q=j.q - (0 if j.b == GROUND else shifts[j.b]))
        for j in s.joints
    )
    t = replace(s, bodies=bodies, joints=joints)
    same_motion(s, assemble(s), t, assemble(t))


@pytest.mark.parametrize("seed", range(5))
def test_turning_the_world_turns_the_result(seed: int) -> None:
    Q = rotation_from_vector(np.random.default_rng(seed).normal(size=3))
    s = random_tree(seed, kinds=("ball", "pin", "universal", "line", "plane", "rod", "cylinder"))
    # Held angles and `agreeing axes` refer to the world's axes at joints to the ground: say them with to_axis instead.
    s = replace(s, joints=tuple(replace(j, angle=None, to_axis_given=True) for j in s.joints))
    bodies = []
    for b in s.bodies:
        near = np.eye(3) if b.near_rotation is None else b.near_rotation
        rotation = None if b.rotation is None else Q @ b.rotation
        spin = b.angular_velocity and Directed(Q @ b.angular_velocity.vector, False)
        bodies.append(replace(b, rotation=rotation, near_rotation=Q @ near, angular_velocity=spin))
    turned_joints = [
        replace(
            j,
            p=Q @ j.p if j.a == GROUND else j.p,
            q=Q @ j.q if j.b == GROUND else j.q,
            axis=Q @ j.axis if j.a == GROUND else j.axis,
            to_axis=Q @ j.to_axis if j.b == GROUND else j.to_axis,
        )
        for j in s.joints
    ]
    one, other = assemble(s), assemble(replace(s, bodies=tuple(bodies), joints=tuple(turned_joints)))
    assert other.position == pytest.approx(one.position @ Q.T, abs=1e-12)
    assert other.rotation == pytest.approx(Q @ one.rotation, abs=1e-12)
    assert other.velocity == pytest.approx(one.velocity @ Q.T, abs=1e-12)
    assert other.angular_velocity == pytest.approx(one.angular_velocity @ Q.T, abs=1e-12)


def test_a_scene_drawn_in_world_coordinates_needs_no_poses() -> None:
    s = scene(
        [body("mast", center=(0, 0, 1)), body("jib", center=(1, 0, 2)), body("load", center=(2, 0, 1))],
        [
            joint("foot", "pin", "ground", (0, 0, 0), "mast", (0, 0, 0)),
            joint("heel", "pin", "mast", (0, 0, 2), "jib", (0, 0, 2), Y),
            joint("hook", "ball", "jib", (2, 0, 2), "load", (2, 0, 2)),
        ],
    )
    a = assemble(s)
    assert np.all(a.position == 0.0)
    assert np.all(a.rotation == np.eye(3))
    assert np.all(a.velocity == 0.0)


def test_bodies_move_before_they_turn() -> None:
    s = scene(
        [
            body("upper", rotation=turned(X, 60), angular_velocity=Directed(np.array([0.3, -0.2, 1.0]), True)),
            body("lower"),
        ],
        [
            joint("pivot", "ball", "ground", (0, 0, 0), "upper", (0, 0, 0)),
            joint("elbow", "ball", "upper", (0, 0, -1), "lower", (0, 0, 0)),
        ],
    )
    a = assemble(s)
    R = turned(X, 60)
    assert a.rotation[1] == pytest.approx(np.eye(3), abs=0)
    assert a.position[1] == pytest.approx(R @ -Z, abs=1e-15)
    assert a.velocity[1] == pytest.approx(np.cross(R @ [0.3, -0.2, 1.0], R @ -Z), abs=1e-15)
    assert np.all(a.angular_velocity[1] == 0.0)
    assert any(line.startswith("lower: position (0, 0.866025, -0.5) m") and "elbow" in line for line in a.start_choices)
    assert any("lower: orientation of the world frame (default)" in line for line in a.start_choices)


def test_a_pin_turns_a_body_by_the_least() -> None:
    s = scene(
        [body("a", near_rotation=turned((1, 2, 3), 50))], [joint("j", "pin", "ground", (0, 0, 0), "a", (1, 0, 0))]
    )
    a = assemble(s)
    axis = turned((1, 2, 3), 50) @ Z
    turn = vector_from_rotation(a.rotation[0] @ turned((1, 2, 3), 50).T)
    assert np.linalg.norm(turn) == pytest.approx(np.arccos(axis @ Z), abs=1e-14)


def test_opposite_axes_are_half_a_turn_about_a_world_axis() -> None:
    s = scene([body("a")], [joint("j", "pin", "ground", (0, 0, 0), "a", (0, 0, 0), Z, to_axis=-Z)])
    assert assemble(s).rotation[0] == pytest.approx(np.diag([1.0, -1.0, -1.0]), abs=1e-15)


@pytest.mark.parametrize("off", [0.0, 1e-12, 1e-8, 1e-5, 1e-2])
def test_nearly_opposite_axes_are_turned_exactly(off: float) -> None:
    to_axis = np.array([off, 0.3 * off, -1.0])
    s = scene([body("a")], [joint("j", "pin", "ground", (0, 0, 0), "a", (0, 0, 0), Z, to_axis=to_axis)])
    R = assemble(s).rotation[0]
    assert R @ (to_axis / np.linalg.norm(to_axis)) == pytest.approx(Z, abs=1e-14)
    assert pytest.approx(np.eye(3), abs=1e-14) == R @ R.T


def test_initial_angle_and_rate_of_a_pin() -> None:
    s = scene(
        [body("arm", center=(1, 0, 0)), body("hand", center=(1, 0, 0))],
        [
            joint("shoulder", "pin", "ground", (1, 2, 3), "arm", (0, 0, 0), Y, angle=0.5, rate=2.0),
            joint("wrist", "pin", "arm", (2, 0, 0), "hand", (0, 0, 0), X, angle=-0.7, rate=-3.0),
        ],
    )
    a = assemble(s)
    R0 = turned(Y, np.degrees(0.5))
    assert a.rotation[0] == pytest.approx(R0, abs=1e-15)
    assert a.rotation[1] == pytest.approx(R0 @ turned(X, np.degrees(-0.7)), abs=1e-15)
    assert a.angular_velocity[1] == pytest.approx(2.0 * Y - 3.0 * R0[:, 0], abs=1e-15)


def test_the_angle_counts_from_from_to_to() -> None:
    """Swapped ends: the same angle now turns `ground` against the arm, the other way."""
    s = scene([body("arm")], [joint("j", "pin", "arm", (0, 0, 0), "ground", (0, 0, 0), Z, angle=0.5, rate=2.0)])
    a = assemble(s)
    assert a.rotation[0] == pytest.approx(turned(Z, -np.degrees(0.5)), abs=1e-15)
    assert a.angular_velocity[0] == pytest.approx(-2.0 * Z, abs=1e-15)


def test_a_body_without_rates_follows_only_as_its_joint_demands() -> None:
    s = scene(
        [body("drum", angular_velocity=(1, 2, 3)), body("door", center=(0.5, 0, 0)), body("bob")],
        [
            joint("centre", "ball", "ground", (0, 0, 0), "drum", (0, 0, 0)),
            joint("hinge", "pin", "drum", (1, 0, 0), "door", (0, 0, 0), Z),
            joint("string", "ball", "door", (1, 0, 0), "bob", (0, 0, 0)),
        ],
    )
    a = assemble(s)
    assert a.angular_velocity[1] == pytest.approx([1, 2, 0], abs=1e-15)
    assert a.angular_velocity[2] == pytest.approx([0, 0, 0], abs=0)
    assert largest_rate_gap(s, a) < 1e-8  # dt² σ³ of the difference


def test_a_held_attitude_in_the_middle_stays() -> None:
    R = turned((1, 1, 0), 40)
    s = scene(
        [body("a"), body("b", rotation=R), body("c")],
        [
            joint("ja", "pin", "ground", (0, 0, 0), "a", (0, 0, 0), Z),
            joint("jb", "ball", "a", (1, 0, 0), "b", (0, 0, 0)),
            joint("jc", "pin", "b", (1, 0, 0), "c", (0, 0, 0), X),
        ],
    )
    a = assemble(s)
    assert np.all(a.rotation[1] == R)
    assert a.rotation[2] @ X == pytest.approx(R @ X, abs=1e-15)
    assert largest_gap(s, a) < 1e-14


def test_bodies_are_placed_from_a_held_position_outward() -> None:
    s = scene(
        [body("a"), body("b", position=(5, 0, 0)), body("c")],
        [joint("ab", "ball", "a", (1, 0, 0), "b", (0, 0, 0)), joint("bc", "ball", "b", (1, 0, 0), "c", (0, 0, 0))],
    )
    a = assemble(s)
    assert a.position == pytest.approx(np.array([[4, 0, 0], [5, 0, 0], [6, 0, 0]]), abs=0)


def test_free_bodies_stay_as_drawn_and_move_as_given() -> None:
    s = scene(
        [body("a", center=(1, 0, 0), angular_velocity=(0, 0, 2)), body("b", position=(1, 2, 3), velocity=(4, 5, 6))], []
    )
    a = assemble(s)
    assert a.position == pytest.approx(np.array([[0, 0, 0], [1, 2, 3]]), abs=0)
    assert a.velocity == pytest.approx(np.array([[0, -2, 0], [4, 5, 6]]), abs=0)  # a's centre of mass rests


def test_a_velocity_in_body_axes_turns_with_the_body() -> None:
    R = turned(Z, 90)
    a = assemble(scene([body("a", rotation=R, velocity=Directed(np.array([1.0, 0, 0]), True))], []))
    assert a.velocity[0] == pytest.approx([0, 1, 0], abs=1e-15)


def test_several_trees_and_a_free_pair() -> None:
    s = scene(
        [body("a"), body("b"), body("c", rotation=turned(Z, 90)), body("d")],
        [
            joint("ja", "pin", "ground", (1, 0, 0), "a", (0, 0, 0)),
            joint("jb", "ball", "ground", (2, 0, 0), "b", (0, 0, 0)),
            joint("cd", "ball", "d", (0, 0, 0), "c", (1, 0, 0)),
        ],
    )
    a = assemble(s)
    assert a.position == pytest.approx(np.array([[1, 0, 0], [2, 0, 0], [0, 0, 0], [0, 1, 0]]), abs=1e-15)


def test_a_free_tree_stays_where_its_first_from_is_drawn() -> None:
    """Not the name tells, nor the mass, but that nothing leads to it; among such the heaviest, then the name."""
    s = scene(
        [body("a", mass=9.0), body("z"), body("p"), body("q", mass=2.0), body("r")],
        [
            joint("j", "ball", "z", (1, 0, 0), "a", (0, 0, 0)),
            joint("k", "ball", "p", (1, 0, 0), "r", (0, 0, 0)),
            joint("l", "ball", "q", (1, 0, 0), "r", (0, 0, 0)),
        ],
    )
    a = assemble(s)
    assert a.position == pytest.approx(np.array([[1, 0, 0], [0, 0, 0], [0, 0, 0], [0, 0, 0], [1, 0, 0]]), abs=0)
    held = replace(s, bodies=(replace(s.bodies[0], rotation=np.eye(3)), *s.bodies[1:]))
    assert assemble(held).position[:2] == pytest.approx(np.array([[0, 0, 0], [-1, 0, 0]]), abs=0)


def test_near_is_only_the_start_in_a_tree() -> None:
    """Moving alone closes the joint: the arm is not turned toward where the hand was drawn."""
    s = scene(
        [body("arm", center=(0.5, 0, 0)), body("hand", near_position=(0, 1, 0), near_rotation=turned(Z, 30))],
        [
            joint("shoulder", "pin", "ground", (0, 0, 0), "arm", (0, 0, 0)),
            joint("wrist", "pin", "arm", (1, 0, 0), "hand", (0, 0, 0)),
        ],
    )
    a = assemble(s)
    assert np.all(a.rotation[0] == np.eye(3))
    assert a.position[1] == pytest.approx([1, 0, 0], abs=1e-15)
    assert a.rotation[1] == pytest.approx(turned(Z, 30), abs=1e-15)


def test_along_a_guide_a_body_stays_where_it_is_drawn() -> None:
    s = scene(
        [body("sledge", center=(2, 1, 0)), body("bead", center=(0.3, 0, 0)), body("puck", center=(0, 0, 4))],
        [
            joint("guide", "slide", "ground", (0, 0, 0), "sledge", (2, 1, 0), X),
            joint("wire", "line", "ground", (0, 5, 0), "bead", (0.3, 0, 0), X),
            joint("table", "plane", "ground", (0, 0, 1), "puck", (0, 0, 4), Z),
        ],
    )
    a = assemble(s)
    assert point(s, a, "sledge", (2, 1, 0)) == pytest.approx([2, 0, 0], abs=1e-15)
    assert point(s, a, "bead", (0.3, 0, 0)) == pytest.approx([0.3, 5, 0], abs=1e-15)
    assert point(s, a, "puck", (0, 0, 4)) == pytest.approx([0, 0, 1], abs=1e-15)


def test_a_rod_pulls_its_body_the_shortest_way() -> None:
    s = scene(
        [body("bob", near_rotation=turned(Y, 20))],
        [joint("rod", "rod", "ground", (0, 0, 0), "bob", (0, 3, 4), length=1.0)],
    )
    a = assemble(s)
    end = turned(Y, 20) @ [0, 3, 4]
    assert point(s, a, "bob", (0, 3, 4)) == pytest.approx(end / 5.0, abs=1e-15)


def test_a_rod_without_length_keeps_the_length_it_has() -> None:
    s = scene([body("bob", velocity=None)], [joint("rod", "rod", "ground", (0, 0, 0), "bob", (0, 3, 4))])
    assert np.all(assemble(s).position == 0.0)
    with pytest.raises(SolveError, match=r"rod .*velocities of ground and bob .* m/s .*rates-do-not-fit"):
        assemble(
            scene(
                [body("bob", velocity=(0, 1, 0), angular_velocity=(0, 0, 0))],
                [joint("rod", "rod", "ground", (0, 0, 0), "bob", (0, 3, 4))],
            )
        )


@pytest.mark.parametrize("kind", ["slide", "weld"])
def test_given_attitudes_are_kept_by_slide_and_weld(kind: str) -> None:
    Ra, Rb = turned((1, 2, 0), 30), turned((0, 1, 1), 70)
    s = scene(
        [body("a", rotation=Ra), body("b", rotation=Rb, center=(1, 0, 0))],
        [
            joint("foot", "ball", "ground", (0, 0, 0), "a", (0, 0, 0)),
            joint("j", kind, "a", (1, 0, 0), "b", (0, 0, 0), X),
        ],
    )
    a = assemble(s)
    assert np.all(a.rotation == np.array([Ra, Rb]))
    left_out = scene(
        [body("a", rotation=Ra), body("b", near_rotation=Rb)], [joint("j", kind, "a", (1, 0, 0), "b", (0, 0, 0), X)]
    )
    assert assemble(left_out).rotation[1] == pytest.approx(Ra, abs=1e-15)


@pytest.mark.parametrize("kind", ["ball", "pin"])
def test_the_work_is_linear_in_the_bodies(kind: str) -> None:
    """A chain that moves, of ten times as many bodies."""

    def chain(n: int) -> Mechanism:
        ends = [("ground", (0, 0, 0))] + [(f"b{i}", (0, 0, -1)) for i in range(n - 1)]
        joints = [joint(f"j{i}", kind, *ends[i], f"b{i}", (0, 0, 0), X if i % 2 else Y) for i in range(n)]
        bodies = [body(f"b{i}", center=(0, 0, -0.5)) for i in range(n)]
        return scene([replace(bodies[0], angular_velocity=Directed(Y, False)), *bodies[1:]], joints)

    assert calls(chain(1000)) < 10.5 * calls(chain(100))
