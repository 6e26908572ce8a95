"""A blow on absolute coordinates: the jump of all velocities, and the impulses in all joints.

    M ΔV = H + JᵀΛ,   J (V⁻ + ΔV) = given rate after it,   V = (v of the centre, σ)

What acts in no time has no part in it: weight, springs, velocity terms (manual/theory.md, "Blows"). The answer has the
shape of an instant's: jumps for accelerations, impulses for forces, with the same verdicts on what is unique. An
impulse of a scene is {on: body.point, vector, frame, time} or {body or on, couple, frame, time}; a drive whose rate
jumps at the instant is a blow, too.
"""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np

from tests.oracle.loads import gathered, pushes
from tests.oracle.masses import Mass
from tests.oracle.read import Placed, Scene, State, model
from tests.oracle.rows import assemble, velocities
from tests.oracle.solve import Solution, answer, inertia, moved, scene_length
from tests.oracle.totals import kinetic_energy
from tests.oracle.turns import Array, cross, unit
from tests.oracle.weld import PIECE, SAW, Section, saw


def struck(scene: Scene, before: State, t: float = 0.0, about: Array | None = None, length: float | None = None
           ) -> Solution:  # fmt: skip
    """The jump at an instant from the state just before it."""
    read = model(scene)
    blow = replace(read, loads=hits(scene, t), gravity=np.zeros(3))
    still = at_rest(before)
    loads, size = pushes(blow, still, t), scene_length(read, before)
    rows = assemble(read, before, t)
    M, _ = inertia(read, still)
    V = velocities(read, before)
    terms = np.abs(rows.rate) + np.abs(rows.J) @ np.abs(V)
    found = moved(rows, rows.rate - rows.J @ V, M, gathered(blow, still, loads), size, terms)
    return answer(blow, still, found, loads, size, about, length=length)


def hits(scene: Scene, t: float) -> dict[str, dict[str, Any]]:
    """The impulses of an instant as loads are written."""
    found = {}
    for name, spec in (scene.get("impulses") or {}).items():
        if spec.get("time", 0.0) == t:
            couple = "couple" in spec
            place = {"on": spec.get("on", spec.get("body")), "vector": spec["couple" if couple else "vector"]}
            found[name] = {"type": "couple" if couple else "force", "frame": spec.get("frame", "world"), **place}
    return found


def at_rest(state: State) -> dict[str, Placed]:
    """The same poses without velocities."""
    return {name: s._replace(velocity=np.zeros(3), angular_velocity=np.zeros(3)) for name, s in state.items()}


def state_after(scene: Scene, before: State, jump: Solution) -> dict[str, Placed]:
    """The state just after a blow."""
    after = {}
    for name, m in model(scene).masses.items():
        s = before[name]
        turn = jump.angular_acceleration[name]
        shift = jump.acceleration[name] - cross(turn, s.rotation @ m.center)
        after[name] = s._replace(velocity=s.velocity + shift, angular_velocity=s.angular_velocity + turn)
    return after


def energy_jump(scene: Scene, before: State, jump: Solution) -> float:
    """Of the kinetic energy [J]."""
    return kinetic_energy(scene, state_after(scene, before, jump)) - kinetic_energy(scene, before)


def work_of_blow(scene: Scene, before: State, jump: Solution, t: float = 0.0) -> float:
    """½ H·(V⁺ + V⁻), of the impulses and of the drives [J]: what the energy jumps by (ideal joints do no work)."""
    after = state_after(scene, before, jump)
    total = sum(p.power(before) + p.power(after) for parts in jump.loads.values() for p in parts) / 2
    read = model(scene)
    rows = assemble(read, before, t)
    speeds = rows.J @ velocities(read, before), rows.J @ velocities(read, after)
    for k, row in enumerate(rows.rows):
        if row.drive:
            total += jump.reactions[row.joint].drive * float(speeds[0][k] + speeds[1][k]) / 2
    return total


def struck_section(scene: Scene, before: State, t: float, body: str, point: str | Array, normal: Array,
                   side: str | None = None, piece: Mass | None = None) -> Section:  # fmt: skip
    """The impulse in a cut, by sawing the body in two and welding it together (tests/oracle/weld.py)."""
    sawn = saw(scene, before, body, point, normal, side, piece)
    jump = struck(sawn, {**before, body + PIECE: before[body]}, t)
    weld = jump.reactions[SAW]
    return Section(weld.point, before[body].rotation @ unit(normal), weld.force, weld.moment, weld.unique[:6], jump)
