"""Laws that any run must keep, from what it prints: balance of every body, momentum, power, sums, central axis."""

from __future__ import annotations

import json

import numpy as np
import pytest

from heuncli.output.tables.export import to_json
from heuncli.results.results import Results
from tests.oracle.loads import pushes
from tests.oracle.read import GROUND, state_at
from tests.oracle.turns import Array, cross
from tests.shared.scenes import near
from tests.shared.trees import ABOUT, SEEDS, SOME, TIMES, Case, tree

# Differences over ±H, ±2H, ±3H: (45 (f1 − f-1) − 9 (f2 − f-2) + (f3 − f-3)) / 60 H
STENCIL = {1: 45.0, 2: -9.0, 3: 1.0}
H = 2e-4  # [s]: truncation (H w)^6 and rounding of the run over H stay below SLOPE for all rates of these scenes
SLOPE = 1e-8
SLOPES = (
    ("position", "velocity"), ("velocity", "acceleration"), ("center", "center_velocity"),
    ("center_velocity", "center_acceleration"), ("angular_velocity", "angular_acceleration"),
)  # fmt: skip


@pytest.mark.parametrize("seed", SEEDS)
@pytest.mark.third
def test_every_body_balances(seed: int) -> None:
    """d'Alembert from the JSON alone: what `from` exerts on `to`, the opposite on `from`, and the applied loads."""
    c = tree(seed)
    printed = json.loads(to_json(c.study.results))
    for k, t in enumerate(TIMES):
        loads = pushes(c.read, c.states[k], t)
        for name, m in c.read.masses.items():
            body = {key: np.array(value[k]) for key, value in printed["bodies"][name].items()}
            x, w = body["center"], body["angular_velocity"]
            force, moment = np.zeros(3), np.zeros(3)
            for push in (p for parts in loads.values() for p in parts if p.body == name):
                force, moment = force + push.force, moment + push.about(x)
            for j in c.read.joints:
                F, M, P = (np.array(printed["joints"][j.name][key][k]) for key in ("force", "moment", "point"))
                for owner, sign in ((j.b.body, 1.0), (j.a.body, -1.0)):
                    if owner == name:
                        force, moment = force + sign * F, moment + sign * (cross(P - x, F) + M)
            I_world = body["rotation"] @ m.inertia @ body["rotation"].T
            near(force, m.mass * body["center_acceleration"], c.force[k])
            rate = I_world @ body["angular_acceleration"] + cross(w, I_world @ w)
            near(moment, rate, c.force[k] * c.length)


@pytest.mark.parametrize("seed", SEEDS)
def test_supports_and_elements_make_the_foundation(seed: int) -> None:
    c = tree(seed)
    found = c.study.results.foundation
    for k in range(len(TIMES)):
        force, moment = np.zeros(3), np.zeros(3)
        for name, w in found.get("supports", {}).items():
            P = c.study.results.joints[name]["point"][k]
            force = force + w["force"][k]
            moment = moment + w["moment"][k] + cross(P - ABOUT, w["force"][k])
        for w in found.get("elements", {}).values():
            force = force + w["force"][k]
            moment = moment + w["moment"][k] + cross(w["point"][k] - ABOUT, w["force"][k])
        near(force, found["force"][k], c.force[k])
        near(moment, found["moment"][k], c.force[k] * c.length)


@pytest.mark.parametrize("seed", SEEDS)
def test_central_axis(seed: int) -> None:
    """On the axis the moment is the pitch times the force; its point is the one nearest `about`."""
    c = tree(seed)
    found = c.study.results.foundation
    for k in range(len(TIMES)):
        s, M = found["force"][k], found["moment"][k]
        p, n, pitch = (found["axis"][key][k] for key in ("point", "direction", "pitch"))
        if np.linalg.norm(s) < 1e-9 * c.force[k]:  # a free system without outer forces has no axis
            continue
        lever = max(c.length, float(np.linalg.norm(p - ABOUT)))
        near(n, s / np.linalg.norm(s), 1.0)
        near((p - ABOUT) @ n, 0.0, lever)
        near(M - cross(p - ABOUT, s), pitch * s, c.force[k] * lever)


def momenta(c: Case, results: Results) -> Array:
    """Σ m ẋ and Σ m x × ẋ + I σ about ABOUT at every instant, (n, 6)."""
    total = np.zeros((len(results.time), 6))
    for name, m in c.read.masses.items():
        b = results.bodies[name]
        p = m.mass * b["center_velocity"]
        spin = np.einsum("tij,jk,tlk,tl->ti", b["rotation"], m.inertia, b["rotation"], b["angular_velocity"])
        total += np.concatenate([p, np.cross(b["center"] - ABOUT, p) + spin], axis=1)
    return total


def slope(values: Array) -> Array:
    """Rate at the middle of seven values a step H apart."""
    middle = len(values) // 2
    parts = [weight * (values[middle + i] - values[middle - i]) for i, weight in STENCIL.items()]
    return sum(parts) / (60.0 * H)


def around(c: Case, t: float) -> Results:
    """The run at seven instants about t."""
    return c.study.resample(t + H * np.arange(-3.0, 4.0))


@pytest.mark.parametrize("seed", SOME)
@pytest.mark.third
def test_foundation_is_the_outer_loads_less_the_rate_of_momentum(seed: int) -> None:
    """(55), its mass effects (56) by differences of the motion."""
    c = tree(seed)
    t = 0.2
    seven = around(c, t)
    rate = slope(momenta(c, seven))
    effect = seven.foundation["mass_effect"]
    F = max(c.force)
    near(effect["force"][3], rate[:3], F, SLOPE)
    near(effect["moment_orbital"][3] + effect["moment_spin"][3], rate[3:], F * c.length, SLOPE)
    state = state_at(seven.bodies, 3)
    k_total, M_k = np.zeros(3), np.zeros(3)
    for name, parts in pushes(c.read, state, t).items():
        if name == "gravity" or c.read.loads[name]["type"] in ("force", "couple"):
            for push in (p for p in parts if p.body != GROUND):
                k_total, M_k = k_total + push.force, M_k + push.about(ABOUT)
    near(seven.foundation["force"][3], k_total - rate[:3], F, SLOPE)
    near(seven.foundation["moment"][3], M_k - rate[3:], F * c.length, SLOPE)


@pytest.mark.parametrize("seed", SOME)
def test_power_is_the_rate_of_energy(seed: int) -> None:
    """d(kinetic)/dt = the powers of all loads and of the weight; work: of all loads but weight and springs."""
    c = tree(seed)
    t = 0.2
    seven = around(c, t)
    state = state_at(seven.bodies, 3)
    loads = pushes(c.read, state, t)
    powers = {name: sum(p.power(state) for p in parts) for name, parts in loads.items()}
    size = max(1.0, *(abs(p) for p in powers.values()), float(np.abs(seven.energy["kinetic"]).max()))
    near(slope(seven.energy["kinetic"]), sum(powers.values()), size, SLOPE)
    conservative = ("gravity", "f_spring")
    lost = 0.0
    for name, block in seven.forces.items():
        near(block["power"][3], powers[name], size)
        if c.read.loads[name]["type"] == "spring":  # a spring's damping is work, its stiffness is not
            lost = c.read.loads[name]["damping"] * block["rate"][3] ** 2
    near(slope(seven.energy["work"]), sum(p for n, p in powers.items() if n not in conservative) - lost, size, SLOPE)
    total = seven.energy["kinetic"] + seven.energy["potential"] - seven.energy["work"]
    near(total, total[0], size)


@pytest.mark.parametrize("seed", SOME)
def test_rates_are_the_slopes_of_coordinates(seed: int) -> None:
    """Rates and accelerations of joints and points by differences of the run."""
    c = tree(seed)
    seven = around(c, 0.2)
    chain = {"angle": "rate", "rate": "acceleration", "travel": "speed", "speed": "acceleration"}
    for block in seven.coordinates.values():
        for low, high in chain.items():
            if low in block:
                own = "angular_acceleration" if low == "rate" and "angular_acceleration" in block else high
                near(slope(block[low]), block[own][3], max(1.0, float(np.abs(block[own]).max())), SLOPE)
    for block in (*seven.points.values(), *seven.bodies.values()):
        for low, high in SLOPES:
            if low in block and high in block:
                near(slope(block[low]), block[high][3], max(1.0, float(np.abs(block[high]).max())), SLOPE)
