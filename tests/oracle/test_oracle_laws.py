"""The oracle on random scenes of all joints and loads: rows against finite differences, balances, energy."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from tests.oracle import transforms
from tests.oracle.checks import SEEDS, T, close, size_of, some_scene
from tests.oracle.masses import cloud
from tests.oracle.motion import motion
from tests.oracle.read import GROUND, Placed, State, model
from tests.oracle.rows import assemble, gaps, rates, velocities
from tests.oracle.scenes import ALL_KINDS, misfit, random_scene
from tests.oracle.solve import solve
from tests.oracle.totals import elements, kinetic_energy, mass_effect, potential_energy, power, supports, system_vector
from tests.oracle.turns import Array, about, cross, unit


@pytest.mark.parametrize("seed", SEEDS)
def test_scenes_fit(seed: int) -> None:
    scene, state = some_scene(seed)
    assert misfit(scene, state) < 1e-13
    found = solve(scene, state)
    assert found.residual < 1e-12 and found.unbalanced == 0.0


def test_nothing_is_shared_with_the_program() -> None:
    """The oracle and its own tests; the other tests here hold the program against it.

    What others have published, which is nobody's calculation here, is read as the program reads it; which kinds of
    loads are drawn, and from which ranges, stands in the program's rows.
    """
    folder = Path(__file__).parent
    allowed = {
        "from tests.shared.published import printed_values",
        "from heuncli.base.joint_kinds import kinds_accepting_load",
        "from heuncli.base.load_kinds import LOAD_KINDS",
    }
    for file in {*folder.glob("*.py")} - {*folder.glob("test_*.py")} | {*folder.glob("test_oracle_*.py")}:
        for line in file.read_text(encoding="utf-8").splitlines():
            if line not in allowed:
                assert not line.lstrip().startswith(("import heuncli", "from heuncli", "from tests.shared"))


def pushed(state: State, a: Array, h: float) -> dict[str, Placed]:
    """Where a state is after h at acceleration a of origins and turning, to second order."""
    moved = {}
    for k, (name, s) in enumerate(state.items()):
        v, w = a[6 * k : 6 * k + 3], a[6 * k + 3 : 6 * k + 6]
        turn = h * s.angular_velocity + h**2 / 2 * w
        angle = float(np.linalg.norm(turn))
        moved[name] = Placed(
            s.position + h * s.velocity + h**2 / 2 * v,
            about(turn / angle, angle) @ s.rotation,
            s.velocity + h * v,
            s.angular_velocity + h * w,
        )
    return moved


@pytest.mark.parametrize("kind", ALL_KINDS)
def test_rows_against_finite_differences(kind: str) -> None:
    """J V is the rate of the gaps, J V̇ + γ that of the rates, along any motion that fits at the start."""
    for seed in range(4):
        scene, state = random_scene(np.random.default_rng(seed), 3, kinds=(kind,), loads=(), free=0.0, drives=seed % 2)
        read = model(scene)
        a = np.random.default_rng(seed).standard_normal(6 * len(read.names))
        rows = assemble(read, state, T)
        V_dot = a.copy()  # of the centres
        for k, name in enumerate(read.names):
            s, r = state[name], state[name].rotation @ read.masses[name].center
            spin = s.angular_velocity
            V_dot[6 * k : 6 * k + 3] += cross(a[6 * k + 3 : 6 * k + 6], r) + cross(spin, cross(spin, r))
        h = 1e-4
        ahead, behind = pushed(state, a, h), pushed(state, a, -h)
        opening = [(g(read, ahead, h), g(read, behind, -h)) for g in (gaps, rates)]
        slopes = [np.concatenate([(x[j.name] - y[j.name]) / (2 * h) for j in read.joints]) for x, y in opening]
        np.testing.assert_allclose(slopes[0], rows.J @ velocities(read, state) - rows.rate, rtol=0, atol=1e-6)
        np.testing.assert_allclose(slopes[1], rows.J @ V_dot + rows.gamma - rows.acceleration, rtol=0, atol=1e-5)


@pytest.mark.parametrize("seed", SEEDS)
def test_every_body_balances(seed: int) -> None:
    """d'Alembert, body by body, from the printed reactions and drives alone."""
    scene, state = some_scene(seed)
    read, found = model(scene), solve(scene, state)
    for name, m in read.masses.items():
        c, s = state[name].point(m.center), state[name].angular_velocity
        force, moment = np.zeros(3), np.zeros(3)
        for push in (p for parts in found.loads.values() for p in parts if p.body == name):
            force, moment = force + push.force, moment + push.about(c)
        for j in read.joints:
            r = found.reactions[j.name]
            F, M = r.force, r.moment
            if j.drive is not None and j.kind != "rod":
                axis = (np.eye(3) if j.a.body == GROUND else state[j.a.body].rotation) @ j.axis
                F, M = (F, M + r.drive * axis) if j.drive[0] == "angle" else (F + r.drive * axis, M)
            for body, sign in ((j.b.body, 1.0), (j.a.body, -1.0)):
                if body == name:
                    force, moment = force + sign * F, moment + sign * (cross(r.point - c, F) + M)
        I_world = state[name].rotation @ m.inertia @ state[name].rotation.T
        close(force, m.mass * found.acceleration[name], size_of(found))
        close(moment, I_world @ found.angular_acceleration[name] + cross(s, I_world @ s), size_of(found))


@pytest.mark.parametrize("seed", SEEDS)
def test_supports_and_elements_make_the_foundation(seed: int) -> None:
    scene, state = some_scene(seed)
    about = np.array([0.3, -0.2, 0.5])
    found = solve(scene, state, about=about)
    force, moment = np.zeros(3), np.zeros(3)
    for name, w in supports(scene, state, found).items():
        force, moment = force + w.force, moment + w.moment + cross(found.reactions[name].point - about, w.force)
    for w in elements(scene, state, found, about).values():
        force, moment = force + w.force, moment + w.moment
    close(force, found.foundation_force, size_of(found))
    close(moment, found.foundation_moment, size_of(found))


@pytest.mark.parametrize("seed", range(6))
def test_power_is_the_rate_of_energy(seed: int) -> None:
    """And the mass effects are the rates of momentum, by finite differences of the motion."""
    scene, state = some_scene(seed, n_bodies=2)
    h = 1e-4
    states = motion(scene, state, [0.0, h, 2 * h, 3 * h, 4 * h])
    found = solve(scene, states[2], 2 * h)
    energies = [kinetic_energy(scene, s) for s in states]
    slope = (energies[0] - 8 * energies[1] + 8 * energies[3] - energies[4]) / (12 * h)
    assert slope == pytest.approx(power(scene, states[2], found, 2 * h), abs=1e-8 * max(1.0, energies[2]))
    momenta = np.array([momentum(scene, s) for s in states])
    slope = (momenta[0] - 8 * momenta[1] + 8 * momenta[3] - momenta[4]) / (12 * h)
    effect = mass_effect(scene, states[2], found, np.zeros(3))
    rate = np.concatenate([effect.force, effect.moment_orbital + effect.moment_spin])
    np.testing.assert_allclose(slope, rate, rtol=1e-8, atol=1e-7)


def momentum(scene: dict, state: State) -> Array:
    """Σ m ẋ and Σ m x × ẋ about the origin, (6,)."""
    total = np.zeros(6)
    for name, m in model(scene).masses.items():
        s = state[name]
        v = m.mass * s.speed(m.center)
        spin = s.rotation @ m.inertia @ s.rotation.T @ s.angular_velocity
        total += np.concatenate([v, cross(s.point(m.center), v) + spin])
    return total


@pytest.mark.heavy
def test_energy_holds_without_losses() -> None:
    scene, state = some_scene(4, loads=("spring",), drives=0, loops=1)
    scene["forces"]["f_spring"]["damping"] = 0.0
    states = motion(scene, state, np.linspace(0, 0.5, 3))
    energy = [kinetic_energy(scene, s) + potential_energy(scene, s) for s in states]
    np.testing.assert_allclose(energy, energy[0], rtol=0, atol=1e-11 * max(1.0, abs(energy[0])))
    assert misfit(scene, states[-1]) < 1e-11


def test_system_vector_is_the_sum_of_areas() -> None:
    """B = Σ m ẋ × ẍ, here by the mass points of the shapes."""
    scene, state = some_scene(3)
    found = solve(scene, state)
    for name, body in scene["bodies"].items():
        s, m = state[name], model(scene).masses[name]
        B = np.zeros(3)
        for shape in body["shapes"]:
            X, w = cloud(shape)
            A = (X - m.center) @ s.rotation.T
            spin, spin_rate = s.angular_velocity, found.angular_acceleration[name]
            v = s.speed(m.center) + np.cross(spin, A)
            a = found.acceleration[name] + np.cross(spin_rate, A) + np.cross(spin, np.cross(spin, A))
            B += w @ np.cross(v, a)
        close(system_vector(scene, state, found)[name], B, float(np.linalg.norm(B)))


def test_a_self_stress_changes_nothing_certain() -> None:
    """Adding a redundant weld leaves the motion and every certain number as they were."""
    scene, state = some_scene(4, loops=0)
    found = solve(scene, state)
    name, spec = next((n, j) for n, j in scene["joints"].items() if "ground" not in (j["from"], j["to"]))
    doubled = {**scene, "joints": {**scene["joints"], "twin": spec}}
    other = solve(doubled, state)
    assert other.rank == found.rank and other.rows > found.rows
    for body, a in found.acceleration.items():
        close(other.acceleration[body], a, size_of(found))
    assert not other.reactions[name].unique[:6].all()
    pair = {f"joints.{n}.force.x": 1.0 for n in (name, "twin")}
    value, certain = other.sum(pair)
    assert certain and value == pytest.approx(found.reactions[name].force[0], abs=1e-11 * size_of(found))


@pytest.mark.parametrize("seed", range(4))
def test_thin_rods_spin_as_they_like(seed: int) -> None:
    """Rods without axial inertia on balls; any small axial inertia and no axial spin gives the same.

    manual/theory.md, "Thin rods".
    """
    scene, state = some_scene(seed, kinds=("ball",), masses="thin", loops=0, drives=0)
    found = solve(scene, state)
    assert found.loose.shape[1] == len(scene["bodies"]) and found.unbalanced < 1e-13
    bodies, other = {}, {}
    for name, body in scene["bodies"].items():
        rod = body["shapes"][0]
        m, along = model(scene).masses[name], unit(np.array(rod["to"]) - np.array(rod["from"]))
        bodies[name] = {**body, **transforms.entry(m._replace(inertia=m.inertia + 1e-3 * np.outer(along, along)))}
        del bodies[name]["shapes"]
        s, axis = state[name], state[name].rotation @ along
        spin = s.angular_velocity - (s.angular_velocity @ axis) * axis
        beside = on_axis(s, rod, s.angular_velocity - spin)
        other[name] = s._replace(angular_velocity=spin, velocity=s.velocity + beside)
    thick = solve({**scene, "bodies": bodies}, other)
    for name, a in found.acceleration.items():
        close(thick.acceleration[name], a, size_of(found))
    for name, reaction in found.reactions.items():
        close(thick.reactions[name].force, reaction.force, size_of(found))


def on_axis(s: Placed, rod: dict, spin: Array) -> Array:
    """What a turning about the rod's own axis gives its body's origin, which lies beside the axis."""
    return cross(spin, s.rotation @ np.array(rod["from"]))


@pytest.mark.heavy
def test_an_angle_is_read_as_it_was_turned() -> None:
    """coordinates: the drive of a random scene starts at its own value, whichever axes the bodies have."""
    for seed in range(6):
        scene, state = random_scene(np.random.default_rng(seed), 3, kinds=("pin", "slide", "cylinder", "rod"), drives=3)
        assert misfit(scene, state) < 1e-13
        ahead = motion(scene, state, [0.0, 0.2])[-1]
        assert max(np.abs(g).max() for g in gaps(scene, ahead, 0.2).values()) < 1e-11
