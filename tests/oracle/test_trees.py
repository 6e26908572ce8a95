"""Random trees against the independent solution on absolute coordinates (tests/oracle), to 1e-9 of the scene's scale.

The oracle takes the pose and the rates of each instant from the run and works out the rest by itself.
"""

from __future__ import annotations

import numpy as np
import pytest

from tests.oracle.rows import coordinates
from tests.oracle.totals import elements, kinetic_energy, mass_effect, potential_energy, supports, system_vector
from tests.oracle.turns import cross
from tests.shared.scenes import near
from tests.shared.trees import ABOUT, SEEDS, TIMES, tree

INSTANTS = list(enumerate(TIMES))


@pytest.mark.parametrize("seed", SEEDS)
@pytest.mark.third
def test_accelerations(seed: int) -> None:
    c = tree(seed)
    found = c.study.results.bodies
    for k, _ in INSTANTS:
        o = c.oracle[k]
        rates = (*o.acceleration.values(), *o.angular_acceleration.values())
        fastest = max(1.0, *(float(np.abs(a).max()) for a in rates))
        for name in c.read.names:
            near(found[name]["center_acceleration"][k], o.acceleration[name], fastest)
            near(found[name]["angular_acceleration"][k], o.angular_acceleration[name], fastest)


@pytest.mark.parametrize("seed", SEEDS)
def test_reactions(seed: int) -> None:
    c = tree(seed)
    for name, block in c.study.results.joints.items():
        assert block["open"] == []
        for k, _ in INSTANTS:
            r = c.oracle[k].reactions[name]
            near(block["point"][k], r.point, c.length)
            near(block["force"][k], r.force, c.force[k])
            near(block["moment"][k], r.moment, c.force[k] * c.length)


@pytest.mark.parametrize("seed", SEEDS)
def test_parts_of_a_reaction(seed: int) -> None:
    """axial along the axis, radial and tilting across it; a rod's tension pulls its ends together."""
    c = tree(seed)
    for j in c.read.joints:
        block = c.study.results.joints[j.name]
        for k, _ in INSTANTS:
            r = c.oracle[k].reactions[j.name]
            R = np.eye(3) if j.a.body == "ground" else c.states[k][j.a.body].rotation
            n = R @ j.axis
            if j.kind in ("pin", "slide", "cylinder", "line", "plane"):
                near(block["axial"][k], r.force @ n, c.force[k])
                near(block["radial"][k], np.linalg.norm(r.force - (r.force @ n) * n), c.force[k])
                near(block["tilting"][k], np.linalg.norm(r.moment - (r.moment @ n) * n), c.force[k] * c.length)
            if j.kind == "rod":
                foot = j.a.point if j.a.body == "ground" else c.states[k][j.a.body].point(j.a.point)
                away = r.point - foot
                near(block["tension"][k], -(r.force @ away) / np.linalg.norm(away), c.force[k])


@pytest.mark.parametrize("seed", SEEDS)
def test_foundation_with_its_supports_and_elements(seed: int) -> None:
    c = tree(seed)
    found = c.study.results.foundation
    assert np.array_equal(found["about"], ABOUT)
    for k, _ in INSTANTS:
        o, state, F = c.oracle[k], c.states[k], c.force[k]
        near(found["force"][k], o.foundation_force, F)
        near(found["moment"][k], o.foundation_moment, F * c.length)
        held = supports(c.plain, state, o)
        assert set(held) == set(found.get("supports", {}))
        for name, w in held.items():
            near(found["supports"][name]["force"][k], w.force, F)
            near(found["supports"][name]["moment"][k], w.moment, F * c.length)
        standing = elements(c.plain, state, o, ABOUT)
        assert set(standing) == set(found.get("elements", {}))
        for name, w in standing.items():
            own = found["elements"][name]
            near(own["force"][k], w.force, F)
            near(own["moment"][k] + cross(own["point"][k] - ABOUT, own["force"][k]), w.moment, F * c.length)


@pytest.mark.parametrize("seed", SEEDS)
def test_mass_effects_energy_and_system_vector(seed: int) -> None:
    c = tree(seed)
    found = c.study.results
    effects = found.foundation["mass_effect"]
    for k, _ in INSTANTS:
        o, state, F = c.oracle[k], c.states[k], c.force[k]
        effect = mass_effect(c.plain, state, o, ABOUT)
        near(effects["force"][k], effect.force, F)
        near(effects["moment_orbital"][k], effect.moment_orbital, F * c.length)
        near(effects["moment_spin"][k], effect.moment_spin, F * c.length)
        kinetic, potential = kinetic_energy(c.plain, state), potential_energy(c.plain, state)
        near(found.energy["kinetic"][k], kinetic, max(kinetic, 1e-3))
        near(found.energy["potential"][k], potential, max(abs(potential), F * c.length))
        vectors = system_vector(c.plain, state, o)
        size = max(1e-3, *(float(np.abs(B).max()) for B in vectors.values()))
        for name, B in vectors.items():
            near(found.system_vector["bodies"][name][k], B, size)
        near(found.system_vector["total"][k], sum(vectors.values()), size * len(vectors))
        for name, m in c.read.masses.items():  # its parts: 2E σ, and G, which is across σ where T is a number
            body, told = state[name], found.system_vector
            orbital = m.mass * np.cross(body.speed(m.center), o.acceleration[name])
            spin = body.rotation @ m.inertia @ body.rotation.T @ body.angular_velocity
            along = float(spin @ body.angular_velocity) * body.angular_velocity
            near(told["energy_part"][name][k], along, size)
            near(told["deviation_part"][name][k], vectors[name] - orbital - along, size)


@pytest.mark.parametrize("seed", SEEDS)
def test_coordinates(seed: int) -> None:
    """Angles modulo a turn, the accelerations from the oracle's own."""
    c = tree(seed)
    for j in c.read.joints:
        block = c.study.results.coordinates.get(j.name, {})
        assert set(block) == {
            "pin": {"angle", "rate", "acceleration"}, "slide": {"travel", "speed", "acceleration"},
            "cylinder": {"angle", "rate", "angular_acceleration", "travel", "speed", "acceleration"},
        }.get(j.kind, set())  # fmt: skip
        for k, _ in INSTANTS if block else []:
            o = c.oracle[k]
            for what, value in coordinates(j, c.states[k]).items():
                apart = np.sin((block[what][k] - value) / 2) if what == "angle" else block[what][k] - value
                near(apart, 0.0, c.length)
            if j.kind != "slide":
                R = np.eye(3) if j.a.body == "ground" else c.states[k][j.a.body].rotation
                spins = [np.zeros(3) if e.body == "ground" else o.angular_acceleration[e.body] for e in (j.a, j.b)]
                which = "acceleration" if j.kind == "pin" else "angular_acceleration"
                near(block[which][k], (spins[1] - spins[0]) @ (R @ j.axis), max(1.0, float(np.abs(spins).max())))


@pytest.mark.parametrize("seed", SEEDS)
def test_points_move_with_their_bodies(seed: int) -> None:
    c = tree(seed)
    for name, block in c.study.results.points.items():
        body, _, point = name.partition(".")
        p = np.array(c.scene["bodies"][body]["points"][point])
        for k, _ in INSTANTS:
            s, o, m = c.states[k][body], c.oracle[k], c.read.masses[body]
            near(block["position"][k], s.point(p), c.length)
            near(block["velocity"][k], s.speed(p), max(1.0, float(np.abs(s.velocity).max())))
            arm = s.rotation @ (p - m.center)
            w, u = s.angular_velocity, o.angular_acceleration[body]
            a = o.acceleration[body] + cross(u, arm) + cross(w, cross(w, arm))
            near(block["acceleration"][k], a, max(1.0, float(np.abs(a).max()), float(np.abs(u).max())))


@pytest.mark.parametrize("seed", SEEDS)
def test_the_run_vouches_for_itself(seed: int) -> None:
    """The accuracy block: gaps at rounding, balance at rounding, energy within the tolerance asked (1e-11)."""
    found = tree(seed).study.results.accuracy
    assert found["constraint_gap"] <= 1e-13 * tree(seed).length
    assert found["balance_residual"] <= 1e-10
    assert found["energy_drift"] <= 1e-9
    assert found["horizon"] is None
