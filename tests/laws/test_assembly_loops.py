"""Loops and doubly held bodies: fitted together, to the branch nearest the drawing, with the least turns."""

from __future__ import annotations

from itertools import pairwise
from typing import Any

import numpy as np
import pytest

from heuncli.base.records import replace
from heuncli.multibody.assembly.assemble import assemble
from heuncli.multibody.mechanism.loads import GROUND
from heuncli.multibody.mechanism.model import Assembly, Mechanism
from heuncli.scene.shapes.rotations import rotation_from_vector, vector_from_rotation
from tests.shared.assemblies import calls, same_motion
from tests.shared.drafted_loops import four_bar, random_loop, slider_crank
from tests.shared.drafted_mechanisms import (
    X,
    Y,
    Z,
    body,
    centre,
    coordinates,
    in_time,
    joint,
    largest_gap,
    largest_rate_gap,
    point,
    scene,
    turned,
)


def angle(a: Assembly, i: int) -> float:
    """Turn of a body about z."""
    return float(np.arctan2(a.rotation[i][1, 0], a.rotation[i][0, 0]))


@pytest.mark.parametrize("degrees", [*range(0, 360, 15), 90, 180, 270])
def test_a_crank_angle_alone_sets_an_engine(degrees: int) -> None:
    """manual/theory.md, "Closed cases" 12: closed forms; the piston is where the rod turns least from the drawing."""
    phi, r, length, omega = np.radians(degrees), 0.1, 0.3, 100.0
    s = slider_crank(angle=phi, rate=omega)
    a = assemble(s)
    q = np.sqrt(length**2 - (r * np.sin(phi)) ** 2)
    assert a.position[2] == pytest.approx([r * np.cos(phi) + q, 0, 0], abs=1e-15)
    assert angle(a, 1) == pytest.approx(-np.arcsin(r / length * np.sin(phi)), abs=1e-15)
    speed = -r * omega * (np.sin(phi) + r * np.sin(phi) * np.cos(phi) / q)
    assert a.velocity[2] == pytest.approx([speed, 0, 0], abs=1e-12)
    assert a.angular_velocity[1] == pytest.approx([0, 0, -r * omega * np.cos(phi) / q], abs=1e-12)
    assert largest_gap(s, a) < 1e-15
    assert a.gap < 1e-15


def test_the_engine_of_the_theory_sheet() -> None:
    a = assemble(slider_crank(angle=np.radians(60), rate=100.0))
    assert a.position[2][0] == pytest.approx(0.3372281323269014, abs=1e-15)  # manual/theory.md, "Closed cases" 12
    assert a.velocity[2][0] == pytest.approx(-10.1678107607332, abs=1e-12)
    assert a.angular_velocity[1][2] == pytest.approx(-17.40776559556978, abs=1e-12)


def test_near_picks_the_other_side() -> None:
    phi = np.radians(60)
    a = assemble(slider_crank(near=(-0.25, 0, 0), angle=phi))
    assert a.position[2][0] == pytest.approx(0.1 * np.cos(phi) - np.sqrt(0.09 - 0.01 * np.sin(phi) ** 2), abs=1e-15)


def test_a_drive_sets_the_engine_as_an_angle_does() -> None:
    s = slider_crank(drive=("angle", in_time("1 + 2*t")))
    a = assemble(s)
    b = assemble(slider_crank(angle=1.0, rate=2.0))
    assert a.position == pytest.approx(b.position, abs=0)
    assert a.velocity == pytest.approx(b.velocity, abs=0)
    assert angle(assemble(s, t0=0.25), 0) == pytest.approx(1.5, abs=1e-15)


def branches(phi: float, r: float = 1.0, c: float = 3.0, k: float = 2.5, f: float = 3.5) -> Any:
    """Angles of coupler and rocker for a crank angle, in both branches: two circles meet."""
    B, D = r * np.array([np.cos(phi), np.sin(phi)]), np.array([f, 0.0])
    u = D - B
    d = np.hypot(*u)
    along = (c * c - k * k + d * d) / (2 * d)
    found = []
    for side in (1.0, -1.0):
        C = B + along * u / d + side * np.sqrt(c * c - along * along) * np.array([-u[1], u[0]]) / d
        found.append((np.arctan2(*(C - B)[::-1]), np.arctan2(*(C - D)[::-1])))
    return found


@pytest.mark.parametrize("degrees", range(15, 360, 30))
def test_a_four_bar_in_both_branches(degrees: int) -> None:
    phi = np.radians(degrees)
    for coupler, rocker in branches(phi):
        place = np.array([np.cos(phi), np.sin(phi), 0]) + 0.2 * np.array([1.0, -1.0, 0])
        s = four_bar(angle=phi)
        bodies = (
            s.bodies[0],
            replace(s.bodies[1], near_position=place, near_rotation=turned(Z, np.degrees(coupler) + 12)),
            replace(s.bodies[2], near_rotation=turned(Z, np.degrees(rocker) - 9)),
        )
        a = assemble(replace(s, bodies=bodies))
        assert np.exp(1j * angle(a, 1)) == pytest.approx(np.exp(1j * coupler), abs=1e-14)
        assert np.exp(1j * angle(a, 2)) == pytest.approx(np.exp(1j * rocker), abs=1e-14)


def test_what_stays_free_is_turned_least() -> None:
    """No angle given: of all closed poses the one with least Σθ², found here by looking at every crank angle."""
    a = assemble(four_bar())

    def turns(phi: float) -> float:
        return float(min(phi**2 + c**2 + k**2 for c, k in branches(phi)))

    grid = np.radians(np.linspace(0, 120, 1201))  # the other side mirrors it
    sums = [turns(p) for p in grid]
    k = int(np.argmin(sums))
    left, lowest, right = sums[k - 1 : k + 2]
    best = grid[k] + (grid[1] - grid[0]) * (left - right) / (left - 2 * lowest + right) / 2  # of the parabola
    assert abs(angle(a, 0)) == pytest.approx(best, abs=1e-5)
    assert sum(angle(a, i) ** 2 for i in range(3)) == pytest.approx(lowest, abs=1e-5)


def test_a_start_in_line_is_folded_and_said_so() -> None:
    s = four_bar(1.0, 1.0, 1.02, 3.0)
    a = assemble(s)
    assert largest_gap(s, a) < 1e-15
    assert any("joint C starts with its links in line" in line for line in a.start_choices)
    assert not any("in line" in line for line in assemble(slider_crank(angle=1.0)).start_choices)


def test_moving_alone_closes_a_loop_where_it_can() -> None:
    """Two carriages on crossed guides, a rod between: all shifts, no turn."""
    s = scene(
        [body("east"), body("north"), body("rod", center=(1, 1, 0))],
        [
            joint("x", "slide", "ground", (0, 0, 0), "east", (0, 0, 0), X),
            joint("y", "slide", "ground", (0, 5, 0), "north", (0, 0, 0), Y),
            joint("a", "ball", "east", (0, 0, 0), "rod", (0.5, 0, 0)),
            joint("b", "ball", "north", (0, 0, 0), "rod", (0, 2, 0)),
        ],
    )
    a = assemble(s)
    assert largest_gap(s, a) < 1e-14
    assert np.max(np.abs(a.rotation - np.eye(3))) < 1e-14
    assert point(s, a, "rod", (0.5, 0, 0)) == pytest.approx([0.5, 0, 0], abs=1e-14)


def test_doubly_held_bodies_are_fitted_between() -> None:
    s = scene(
        [
            body("a", center=(0.5, 0, 0)),
            body("b", center=(0.5, 0, 0)),
            body("end", position=(1.0, 1.0, 0.5), rotation=np.eye(3)),
        ],
        [
            joint("ja", "ball", "ground", (0, 0, 0), "a", (0, 0, 0)),
            joint("jb", "ball", "a", (1, 0, 0), "b", (0, 0, 0)),
            joint("jc", "ball", "b", (1, 0, 0), "end", (0, 0, 0)),
        ],
    )
    a = assemble(s)
    assert largest_gap(s, a) < 1e-14
    assert np.all(a.position[2] == [1, 1, 0.5])
    # Of all pairs of closed arms: each turns about the axis that both need, none about itself.
    for i in range(2):
        assert abs(vector_from_rotation(a.rotation[i]) @ (a.rotation[i] @ X)) < 0.2


def test_a_held_position_turns_its_body() -> None:
    """Origin and pin both fixed: only the turn about the origin is left."""
    s = scene([body("bar", position=(0, 0, 0))], [joint("end", "ball", "ground", (0, 2, 0), "bar", (2, 0, 0))])
    a = assemble(s)
    assert a.rotation[0] == pytest.approx(turned(Z, 90), abs=1e-14)


def test_a_held_attitude_may_turn_what_it_hangs_on() -> None:
    """The pin's axis must follow the held body; the post between ground and it turns."""
    R = turned(X, 30)
    s = scene(
        [body("post", center=(0, 0, 1)), body("wheel", rotation=R)],
        [
            joint("foot", "ball", "ground", (0, 0, 0), "post", (0, 0, 0)),
            joint("axle", "pin", "post", (0, 0, 2), "wheel", (0, 0, 0)),
        ],
    )
    a = assemble(s)
    assert np.all(a.rotation[1] == R)
    assert a.rotation[0] @ Z == pytest.approx(R @ Z, abs=1e-14)
    assert a.rotation[0] == pytest.approx(R, abs=1e-14)  # the smallest turn of the axis is all of R here
    assert largest_gap(s, a) < 1e-14


def test_a_loop_may_turn_what_it_hangs_on() -> None:
    """A four-bar on a base that hangs on a ball: the coupler's held attitude tilts them all."""
    R = turned(Y, 20) @ turned(Z, 8)
    s = four_bar(2.0, 3.5, 2.0, 3.5)
    joints = [replace(j, a=3 if j.a == GROUND else j.a) for j in s.joints]
    base = body("base", center=(1, 0, -1))
    foot = scene([base], [joint("foot", "ball", "ground", (0, 0, -2), "base", (0, 0, -2))]).joints[0]
    up = [replace(b, near_rotation=turned(Z, 70)) for b in s.bodies]
    bodies = (up[0], replace(up[1], rotation=R), up[2], base)
    t = replace(s, bodies=bodies, joints=(*joints, replace(foot, b=3)))
    a = assemble(t)
    assert largest_gap(t, a) < 1e-13
    assert np.all(a.rotation[1] == R)
    assert a.rotation[3] @ Z == pytest.approx(R @ Z, abs=1e-13)


def test_a_loop_whose_bodies_may_not_turn_turns_what_it_hangs_on() -> None:
    R = turned((1, 2, 0), 35)
    s = scene(
        [body("base", center=(0, 0, 1)), body("plate", rotation=R)],
        [
            joint("foot", "ball", "ground", (0, 0, 0), "base", (0, 0, 0)),
            joint("east", "ball", "base", (1, 0, 2), "plate", (1, 0, 0)),
            joint("west", "ball", "base", (-1, 0, 2), "plate", (-1, 0, 0)),
        ],
    )
    a = assemble(s)
    assert largest_gap(s, a) < 1e-14
    assert np.all(a.rotation[1] == R)
    turn = vector_from_rotation(a.rotation[0])
    assert a.rotation[0] @ X == pytest.approx(R @ X, abs=1e-14)
    assert turn @ X == pytest.approx(0.0, abs=1e-14)  # the smallest turn of one direction onto another


def test_a_loop_on_a_tilted_base_is_the_loop_tilted() -> None:
    """The wheel's held attitude tilts the base; the open four-bar on it is fitted from there, as it is on the flat."""
    R = turned((1, 1, 0), 40)

    def on_base(wheel: Any) -> Assembly:
        s = four_bar(2.0, 3.5, 2.2, 3.3)
        up = tuple(replace(b, near_rotation=turned(Z, angle)) for b, angle in zip(s.bodies, (80, 5, 65), strict=True))
        rest = scene(
            [body("base", center=(1, 0, -1)), body("wheel", rotation=wheel)],
            [
                joint("foot", "ball", "ground", (0, 0, 0), "base", (0, 0, 0)),
                joint("axle", "pin", "base", (0, 0, -2), "wheel", (0, 0, 0)),
            ],
        )
        carried = [replace(j, a=j.a + 2 if j.a != GROUND else 0, b=j.b + 2) for j in s.joints]
        return assemble(replace(s, bodies=(*rest.bodies, *up), joints=(*rest.joints, *carried)))

    flat, tilted = on_base(np.eye(3)), on_base(R)
    assert tilted.rotation[0] == pytest.approx(R, abs=1e-13)
    assert tilted.rotation[2:] == pytest.approx(R @ flat.rotation[2:], abs=1e-11)


def test_near_is_met_where_it_can_be() -> None:
    """A five-bar has two freedoms: the first knee is put where near says, and what follows turns least."""
    place = np.array([np.cos(1.2), np.sin(1.2), 0.0])
    links = [("a", 1.0), ("b", 2.0), ("c", 2.0), ("d", 1.0)]
    bodies = [body(n, center=(r / 2, 0, 0), near_position=place if n == "b" else None) for n, r in links]
    joints = [joint("A", "pin", "ground", (0, 0, 0), "a", (0, 0, 0))]
    for (n, r), (m, _) in pairwise(links):
        joints.append(joint(n + m, "pin", n, (r, 0, 0), m, (0, 0, 0)))
    joints.append(joint("E", "pin", "d", (1, 0, 0), "ground", (2.5, 0, 0)))
    s = scene(bodies, joints)
    a = assemble(s)
    assert a.position[1] == pytest.approx(place, abs=1e-12)
    assert largest_gap(s, a) < 1e-14


def test_what_hangs_on_a_loop_follows_it() -> None:
    s = slider_crank(angle=1.0, rate=3.0)
    bob = body("bob", center=(0, 0, -1))
    hook = scene([bob, body("rod")], [joint("hook", "ball", "rod", (0.15, 0, 0), "bob", (0, 0, 0))]).joints[0]
    t = replace(s, bodies=(*s.bodies, bob), joints=(*s.joints, replace(hook, a=1, b=3)))
    a = assemble(t)
    assert point(t, a, "bob", (0, 0, 0)) == pytest.approx(point(t, a, "rod", (0.15, 0, 0)), abs=1e-15)
    assert largest_gap(t, a) < 1e-14
    assert largest_rate_gap(t, a) < 1e-8


TURNING = ("ball", "pin", "universal")  # elsewhere a long shift may save a small turn, and the polish may stop short


@pytest.mark.parametrize("noise", [0.0, 0.1, 0.3])
@pytest.mark.parametrize("seed", range(20))
@pytest.mark.third
def test_random_loops_close(seed: int, noise: float) -> None:
    s = random_loop(seed, noise)
    a = assemble(s)
    assert largest_gap(s, a) < 1e-12
    assert largest_rate_gap(s, a) < 1e-8
    if noise == 0.0:
        assert a.position == pytest.approx(np.array([b.near_position for b in s.bodies]), abs=1e-13)


@pytest.mark.parametrize("seed", range(8))
@pytest.mark.third
def test_the_order_of_the_file_does_not_matter_in_loops(seed: int) -> None:
    s = random_loop(seed, 0.1, TURNING)
    rng = np.random.default_rng(seed)
    order = rng.permutation(len(s.bodies))
    new = {int(old): i for i, old in enumerate(order)} | {GROUND: GROUND}
    joints = [replace(j, a=new[j.a], b=new[j.b]) for j in s.joints]
    t = replace(
        s, bodies=tuple(s.bodies[i] for i in order), joints=tuple(joints[i] for i in rng.permutation(len(joints)))
    )
    same_motion(s, assemble(s), t, assemble(t), 1e-9)


@pytest.mark.parametrize("seed", range(8))
@pytest.mark.third
def test_turning_the_world_turns_the_loop(seed: int) -> None:
    Q = rotation_from_vector(np.random.default_rng(seed).normal(size=3))
    s = random_loop(seed, 0.1, TURNING)
    turn: Any = Q.__matmul__
    bodies = tuple(
        replace(b, near_position=turn(b.near_position), near_rotation=turn(b.near_rotation)) for b in s.bodies
    )
    joints = tuple(
        replace(
            j,
            p=Q @ j.p if j.a == GROUND else j.p,
            axis=Q @ j.axis if j.a == GROUND else j.axis,
            q=Q @ j.q if j.b == GROUND else j.q,
            to_axis=Q @ j.to_axis if j.b == GROUND else j.to_axis,
        )
        for j in s.joints
    )
    a, b = assemble(s), assemble(replace(s, bodies=bodies, joints=joints))
    assert b.position == pytest.approx(a.position @ Q.T, abs=1e-9)
    assert b.rotation == pytest.approx(Q @ a.rotation, abs=1e-9)


@pytest.mark.parametrize("seed", range(8))
def test_neither_origins_nor_the_unit_of_length_matter(seed: int) -> None:
    s = random_loop(seed, 0.1, TURNING)
    s = replace(s, bodies=tuple(replace(b, near_position=None) for b in s.bodies))
    shift = np.random.default_rng(seed).normal(size=(len(s.bodies), 3))
    bodies = tuple(replace(b, center=1e3 * (b.center - o)) for b, o in zip(s.bodies, shift, strict=True))
    joints = tuple(
        replace(
            j,
            p=1e3 * (j.p - (0 if j.a == GROUND else shift[j.a])),
            q=1e3 * (j.q - (0 if j.b == GROUND else shift[j.b])),
        )
        for j in s.joints
    )
    t = replace(s, bodies=bodies, joints=joints)
    a, b = assemble(s), assemble(t)
    assert b.rotation == pytest.approx(a.rotation, abs=1e-9)
    for i in range(len(s.bodies)):
        assert centre(t, b, i) == pytest.approx(1e3 * centre(s, a, i), abs=1e-6)


def test_the_work_is_linear_in_the_loops() -> None:
    """Ten times as many engines side by side."""

    def engines(count: int) -> Mechanism:
        s = slider_crank(angle=1.0, rate=2.0)
        bodies = [replace(b, name=f"{b.name}{i}") for i in range(count) for b in s.bodies]
        joints = [
            replace(j, name=f"{j.name}{i}", a=j.a if j.a == GROUND else j.a + 3 * i, b=j.b + 3 * i)
            for i in range(count)
            for j in s.joints
        ]
        return replace(s, bodies=tuple(bodies), joints=tuple(joints))

    assert calls(engines(40)) < 10.5 * calls(engines(4))


def test_pins_of_one_loop_keep_their_angles() -> None:
    s = slider_crank(angle=np.radians(75))
    a = assemble(s)
    assert coordinates(s, a, s.joints[0])["angle"] == pytest.approx(np.radians(75), abs=1e-15)
