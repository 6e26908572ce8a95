"""Sums over the scene: what stands on the ground, mass effects (56), energy and power, system vector."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from tests.oracle.loads import from_outside
from tests.oracle.masses import Mass
from tests.oracle.read import GROUND, Model, Placed, Scene, State, end, model, placed
from tests.oracle.rows import directions
from tests.oracle.solve import Solution
from tests.oracle.turns import Array, cross


class Wrench(NamedTuple):
    """Force [N] and moment [N m]."""

    force: Array
    moment: Array


def supports(scene: Scene, state: State, solution: Solution) -> dict[str, Wrench]:
    """What every joint to the ground exerts ON the ground by its constraint, moment about its `to` point."""
    found = {}
    for j in model(scene).joints:
        if GROUND in (j.a.body, j.b.body):
            r = solution.reactions[j.name]
            sign = -1.0 if j.a.body == GROUND else 1.0
            found[j.name] = Wrench(sign * r.force, sign * r.moment)
    return found


def elements(scene: Scene, state: State, solution: Solution, about: Array) -> dict[str, Wrench]:
    """What all loads but forces and couples, and all drives but rods', put ON the ground, moment about a point."""
    read = model(scene)
    found = {}
    for name, parts in solution.loads.items():
        own = [p for p in parts if p.body == GROUND]
        if own and not from_outside(read, name):
            found[name] = Wrench(np.sum([p.force for p in own], axis=0), np.sum([p.about(about) for p in own], axis=0))
    names = {d["joint"]: name for name, d in (scene.get("drives") or {}).items()}
    for j in read.joints:
        if j.drive is None or j.kind == "rod" or GROUND not in (j.a.body, j.b.body):
            continue
        r = solution.reactions[j.name]
        ((axis, _),) = directions("along", j, state)
        value = (-r.drive if j.a.body == GROUND else r.drive) * axis
        turns = j.drive[0] == "angle"
        found[names[j.name]] = Wrench(np.zeros(3), value) if turns else Wrench(value, cross(r.point - about, value))
    return found


class MassEffect(NamedTuple):
    """(56): Σ m ẍ_s, d/dt Σ m x_s × ẋ_s about a point, d/dt Σ I σ."""

    force: Array
    moment_orbital: Array
    moment_spin: Array


def mass_effect(scene: Scene, state: State, solution: Solution, about: Array) -> MassEffect:
    """The three terms, each on its own."""
    force, orbital, spin = np.zeros(3), np.zeros(3), np.zeros(3)
    for name, m in model(scene).masses.items():
        a, s = solution.acceleration[name], state[name].angular_velocity
        force += m.mass * a
        orbital += cross(state[name].point(m.center) - about, m.mass * a)
        I_world = state[name].rotation @ m.inertia @ state[name].rotation.T
        spin += I_world @ solution.angular_acceleration[name] + cross(s, I_world @ s)
    return MassEffect(force, orbital, spin)


def kinetic_energy(scene: Scene, state: State) -> float:
    """½ Σ m ẋ² + σ·Iσ [J]."""
    return sum(kinetic(m, state[name]) for name, m in model(scene).masses.items())


def kinetic(m: Mass, body: Placed) -> float:
    v, s = body.speed(m.center), body.rotation.T @ body.angular_velocity
    return 0.5 * float(m.mass * v @ v + s @ m.inertia @ s)


def potential_energy(scene: Scene, state: State) -> float:
    """Of gravity from the world's origin, and of springs [J]."""
    read = model(scene)
    total = -sum(m.mass * float(read.gravity @ state[name].point(m.center)) for name, m in read.masses.items())
    for spec in read.loads.values():
        if spec["type"] == "spring":
            a, b = end(scene, spec["from"]), end(scene, spec["to"])
            length = float(np.linalg.norm(placed(state, b.body).point(b.point) - placed(state, a.body).point(a.point)))
            total += 0.5 * float(spec.get("stiffness", 0.0)) * (length - float(spec.get("length", 0.0))) ** 2
    return total


def power(scene: Scene, state: State, solution: Solution, t: float = 0.0) -> float:
    """Of all loads, weight and springs too, and of the drives [W]; the rate of the kinetic energy."""
    total = sum(p.power(state) for parts in solution.loads.values() for p in parts)
    read: Model = model(scene)
    for j in read.joints:
        if j.drive is not None:
            total += solution.reactions[j.name].drive * j.drive[1][1](t)
    return total


def system_vector(scene: Scene, state: State, solution: Solution) -> dict[str, Array]:
    """Heun's B = Σ m ẋ × ẍ of each body: m ẋ_s × ẍ_s + (σ·Iσ)σ + T(σ × σ̇), T = ½ tr(I) − I."""
    found = {}
    for name, m in model(scene).masses.items():
        body = state[name]
        I_world = body.rotation @ m.inertia @ body.rotation.T
        s, s_dot = body.angular_velocity, solution.angular_acceleration[name]
        T = 0.5 * np.trace(I_world) * np.eye(3) - I_world
        found[name] = (
            m.mass * cross(body.speed(m.center), solution.acceleration[name])
            + float(s @ I_world @ s) * s
            + T @ cross(s, s_dot)
        )
    return found
