"""Rates in loops: held ones fixed, the rest least in Σσ², then in Σv²; accelerations must exist for them."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

from heuncli.base.errors import SolveError
from heuncli.base.records import replace
from heuncli.multibody.assembly.assemble import assemble
from heuncli.multibody.mechanism.model import Assembly, Mechanism
from tests.shared.drafted_loops import four_bar, random_loop, slider_crank
from tests.shared.drafted_mechanisms import (
    X,
    Y,
    Z,
    after,
    body,
    centre,
    gaps,
    in_time,
    joint,
    largest_gap,
    largest_rate_gap,
    scene,
    turned,
)


def flat(crank: float | None, rocker: float | None) -> Mechanism:
    """The parallelogram of manual/theory.md, "Singular poses", flat: A(0,0) B(1,0) C(3,0) D(2,0)."""
    s = four_bar(1.0, 2.0, 1.0, 2.0)
    rates = {"A": crank, "D": rocker}
    return replace(s, joints=tuple(replace(j, rate=rates.get(j.name)) for j in s.joints))


@pytest.mark.parametrize(("crank", "rocker"), [(1.0, 1.0), (1.0, -3.0), (0.0, 0.0)])
def test_a_flat_parallelogram_moves_on_in_two_ways(crank: float, rocker: float) -> None:
    a = assemble(flat(crank, rocker))
    assert a.angular_velocity[[0, 2], 2] == pytest.approx([crank, rocker], abs=1e-14)


def test_a_flat_parallelogram_cannot_move_otherwise() -> None:
    with pytest.raises(SolveError, match=r"loop at joint . is in a singular position .*singular-pose"):
        assemble(flat(1.0, 2.0))


def test_a_singular_pose_asks_for_one_more_rate() -> None:
    with pytest.raises(SolveError, match=r"singular-pose\]\n  hint: give the rate of one more joint"):
        assemble(flat(1.0, None))


def test_bars_upright_move_alike() -> None:
    """manual/references.md, "Windows", N = 2: one bar's rate tells all."""
    bodies = [body(f"bar{i}", center=(i, 0.5, 0)) for i in range(3)] + [
        body(f"link{i}", center=(i + 0.5, 1, 0)) for i in range(2)
    ]
    joints = [
        joint(f"g{i}", "pin", "ground", (i, 0, 0), f"bar{i}", (i, 0, 0), rate=-1.0 if i == 0 else None)
        for i in range(3)
    ]
    for i in range(2):
        joints.append(joint(f"l{i}", "pin", f"bar{i}", (i, 1, 0), f"link{i}", (i, 1, 0)))
        joints.append(joint(f"r{i}", "pin", f"link{i}", (i + 1, 1, 0), f"bar{i + 1}", (i + 1, 1, 0)))
    s = scene(bodies, joints)
    a = assemble(s)
    assert a.angular_velocity[:, 2] == pytest.approx([-1, -1, -1, 0, 0], abs=1e-14)
    assert a.velocity[3] == pytest.approx([1, 0, 0], abs=1e-14)


@pytest.mark.parametrize("seed", range(10))
@pytest.mark.third
def test_rates_of_random_loops_are_the_least(seed: int) -> None:
    """One body's rates held: no other rates that fit have less Σσ², nor less Σv² with the same σ."""
    s = random_loop(seed, 0.0, ("ball", "pin", "universal", "cylinder"), 9)
    spin, speed = np.random.default_rng(seed).normal(size=(2, 3))
    held = body(
        "b4", near_position=s.bodies[4].near_position, near_rotation=s.bodies[4].near_rotation,
        angular_velocity=spin, velocity=speed,
    )  # fmt: skip
    s = replace(s, bodies=(*s.bodies[:4], held, *s.bodies[5:]))
    rest = replace(s, bodies=tuple(replace(b, velocity=None, angular_velocity=None) for b in s.bodies))
    J = joint_rows(rest, assemble(rest))
    free = np.repeat(np.arange(9) != 4, 6)
    possible = J[:, ~free] @ np.concatenate([spin, speed])
    lack = possible - J[:, free] @ np.linalg.lstsq(J[:, free], possible, rcond=1e-6)[0]
    if np.linalg.norm(lack) > 1e-5:
        with pytest.raises(SolveError, match="rates-do-not-fit"):
            assemble(s)
        return
    a = assemble(s)
    assert np.all(a.angular_velocity[4] == spin)
    assert np.all(a.velocity[4] == speed)
    fastest = float(np.max(np.abs(a.angular_velocity)))
    assert largest_rate_gap(s, a, 1e-5 / (1.0 + fastest)) < 1e-7
    _, S, V = np.linalg.svd(J[:, free])
    null = V[np.sum(S > 1e-6 * S[0]) :]
    V0 = np.concatenate([[a.angular_velocity[i], velocity(s, a, i)] for i in range(9)]).ravel()[free]
    turns = (np.arange(54) % 6 < 3)[free]
    assert null[:, turns] @ V0[turns] == pytest.approx(0.0, abs=1e-6 * (1 + fastest))  # no slope of Σσ²
    _, S, V = np.linalg.svd(null[:, turns].T)
    still = V[np.sum(S > 1e-6) :] @ null
    assert still[:, ~turns] @ V0[~turns] == pytest.approx(0.0, abs=1e-6 * (1 + fastest))


def velocity(s: Mechanism, a: Assembly, i: int) -> Any:
    """Velocity of the centre of mass."""
    return a.velocity[i] + np.cross(a.angular_velocity[i], a.rotation[i] @ s.bodies[i].center)


def joint_rows(s: Mechanism, a: Assembly) -> Any:
    """Differences of all gaps along (σ, v of the centre) of every body, (rows, 6 n)."""
    n, h = len(s.bodies), 1e-6
    columns = []
    for i in range(n):
        for k in range(6):
            w, v = np.zeros((n, 3)), np.zeros((n, 3))
            (w if k < 3 else v)[i, k % 3] = 1.0
            v[i] -= np.cross(w[i], centre(s, a, i) - a.position[i])
            m = Assembly(a.position, a.rotation, v, w, (), 0.0)
            columns.append((signed(s, after(s, m, h)) - signed(s, after(s, m, -h))) / (2 * h))
    return np.array(columns).T


def signed(s: Mechanism, a: Assembly) -> Any:
    found = []
    for j in s.joints:
        xa, Ra = (np.zeros(3), np.eye(3)) if j.a < 0 else (a.position[j.a], a.rotation[j.a])
        xb, Rb = (np.zeros(3), np.eye(3)) if j.b < 0 else (a.position[j.b], a.rotation[j.b])
        D = Ra.T @ (xb + Rb @ j.q - xa) - j.p
        n = Ra.T @ Rb @ j.to_axis
        found.append(np.cross(j.axis, D) if j.kind == "cylinder" else D)
        if j.kind in ("pin", "cylinder"):
            found.append(np.cross(j.axis, n))
        if j.kind == "universal":
            found.append(np.array([j.axis @ n]))
    return np.concatenate(found)


def test_drives_give_their_rates() -> None:
    """A winch shortens a rope at 0.3 m/s; a table is driven along a guide; the fitted bodies follow."""
    s = scene(
        [body("jib", center=(1, 0, 0)), body("table", center=(0, 0, 1))],
        [
            joint("heel", "pin", "ground", (0, 0, 0), "jib", (0, 0, 0), Y),
            joint("rope", "rod", "ground", (0, 0, 3), "jib", (2, 0, 0), drive=("length", in_time("3 - 0.3*t"))),
            joint(
                "bed",
                "slide",
                "ground",
                (0, 0, 0),
                "table",
                (0, 0, 0),
                X,
                drive=("travel", in_time("0.2 + 0.5*sin(2*t)")),
            ),
        ],
    )
    a = assemble(s)
    assert largest_rate_gap_but_rods(s, a) < 1e-8
    lengths = [
        np.linalg.norm(np.array([0, 0, 3]) - b.position[0] - b.rotation[0] @ [2, 0, 0])
        for b in (a, after(s, a, 1e-5), after(s, a, -1e-5))
    ]
    assert lengths[0] == pytest.approx(3.0, abs=1e-14)
    assert (lengths[1] - lengths[2]) / 2e-5 == pytest.approx(-0.3, abs=1e-9)
    assert a.position[1] == pytest.approx([0.2, 0, 0], abs=1e-15)
    assert a.velocity[1] == pytest.approx([1.0, 0, 0], abs=1e-15)


def largest_rate_gap_but_rods(s: Mechanism, a: Assembly) -> float:
    joints = tuple(j for j in s.joints if j.kind != "rod")
    return largest_rate_gap(replace(s, joints=joints), a)


def test_a_held_rate_in_the_middle_moves_what_it_hangs_on() -> None:
    """The wheel's held spin about x cannot come from its pin about z: the post must turn along."""
    s = scene(
        [body("post", center=(0, 0, 1)), body("wheel", angular_velocity=(2.0, 0, 5.0))],
        [
            joint("foot", "ball", "ground", (0, 0, 0), "post", (0, 0, 0)),
            joint("axle", "pin", "post", (0, 0, 2), "wheel", (0, 0, 0)),
        ],
    )
    a = assemble(s)
    assert a.angular_velocity == pytest.approx(np.array([[2, 0, 0], [2, 0, 5]]), abs=1e-14)
    assert a.velocity[1] == pytest.approx([0, -4, 0], abs=1e-14)


def test_a_held_velocity_turns_its_arm() -> None:
    """The arm's end is told to move along y: the least angular velocity is about z, none about the arm."""
    s = scene(
        [body("arm", center=(1, 0, 0), near_rotation=turned(Z, 0)), body("bob", velocity=(0, 3, 0))],
        [
            joint("foot", "ball", "ground", (0, 0, 0), "arm", (0, 0, 0)),
            joint("end", "ball", "arm", (2, 0, 0), "bob", (0, 0, 0)),
        ],
    )
    a = assemble(s)
    assert a.angular_velocity == pytest.approx(np.array([[0, 0, 1.5], [0, 0, 0]]), abs=1e-14)


def test_a_resting_loop_rests() -> None:
    a = assemble(slider_crank(angle=1.0))
    assert np.all(a.velocity == 0.0)
    assert np.all(a.angular_velocity == 0.0)


def test_at_a_dead_centre_the_crank_may_turn_but_not_the_piston() -> None:
    a = assemble(slider_crank(angle=0.0, rate=2.0))
    assert a.velocity[2] == pytest.approx([0, 0, 0], abs=1e-15)
    with pytest.raises(SolveError, match=r"joint \w+ \(\w+\): .* incompatible .* 1 m/s.*rates-do-not-fit"):
        assemble(moving_piston(0.0))
    b = assemble(moving_piston(np.radians(90)))
    assert b.angular_velocity[0] == pytest.approx([0, 0, -10.0], abs=1e-12)


def moving_piston(phi: float) -> Mechanism:
    s = slider_crank(angle=phi)
    piston = body("piston", velocity=(1.0, 0, 0))
    return replace(s, bodies=(*s.bodies[:2], piston))


def test_assembled_poses_are_closed_before_rates_are_sought() -> None:
    s = slider_crank(angle=0.3, rate=1.0)
    a = assemble(s)
    assert largest_gap(s, a) < 1e-15
    assert max(abs(g) for j in s.joints for g in gaps(s, after(s, a, 1e-4), j)) < 1e-7
