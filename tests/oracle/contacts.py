"""Ropes that catch and stops that strike, on absolute coordinates: which of what touches bears, by trying all choices.

A contact is a coordinate at its limit. `sign` makes its rate an opening one: +1 at a lower limit, −1 at an upper one
and on a rope. What bears is a coordinate whose rate (or acceleration) is prescribed, as a drive does; what does not is
free. Newton's law at a strike:   opening rate after ≥ e · closing rate before, push ≥ 0, one of them with equality;
at rest:                          opening acceleration ≥ 0, push ≥ 0, one of them zero.
"""

from __future__ import annotations

import itertools
from collections.abc import Mapping, Sequence
from typing import Any, NamedTuple

import numpy as np

from tests.oracle.impulses import state_after, struck
from tests.oracle.read import Placed, Scene, State, model
from tests.oracle.rows import assemble, coordinates, velocities
from tests.oracle.solve import Solution, solve
from tests.oracle.turns import Array

TOUCHES = 1e-9  # [m, rad]
WRONG = 1e-9  # of the fastest, or of the largest push: what may fail of an inequality


class Contact(NamedTuple):
    """One side of a stop, or a rope: of which joint's coordinate, at which limit, opening which way."""

    name: str
    joint: str
    quantity: str
    limit: float
    sign: float
    restitution: float


def contacts(scene: Scene) -> list[Contact]:
    """All of a scene, touching or not."""
    found = []
    for name, stop in (scene.get("stops") or {}).items():
        quantity = next(q for q in ("angle", "travel", "length") if q in stop)
        e = float(stop.get("restitution", 0.0))
        for limit, sign in zip(stop[quantity], (1.0, -1.0), strict=True):
            if limit is not None:
                found.append(Contact(name, stop["joint"], quantity, float(limit), sign, e))
    for name, spec in scene["joints"].items():
        if spec.get("tension_only") and spec.get("restitution") is not None:
            found.append(Contact(name, name, "length", float(spec["length"]), -1.0, float(spec["restitution"])))
    return found


def values(scene: Scene, state: State) -> dict[Contact, tuple[float, float]]:
    """Gap and opening rate of every contact."""
    joints = {j.name: j for j in model(with_held(scene, contacts(scene), None)).joints}
    found = {}
    for c in contacts(scene):
        now = coordinates(joints[c.joint], state)
        rate = now["rate"] if c.quantity == "angle" else now["speed"]
        gap = now[c.quantity] - c.limit
        if c.quantity == "angle":
            gap = float(np.arctan2(np.sin(gap), np.cos(gap)))
        found[c] = (c.sign * gap, c.sign * rate)
    return found


def with_held(scene: Scene, held: Sequence[Contact], rates: Mapping[Contact, float] | None, at: float = 0.0) -> Scene:
    """The scene with the coordinates of the contacts that bear driven: the rate after, or (None) standing still."""
    one_sided = {c.joint for c in contacts(scene) if c.quantity == "length"}
    bears = {c.joint for c in held}
    joints = {n: {k: v for k, v in s.items() if k != "length" or n not in one_sided}
              for n, s in scene["joints"].items() if n not in one_sided or n in bears}  # fmt: skip
    drives: dict[str, Any] = dict(scene.get("drives") or {})
    for c in held:
        rate = 0.0 if rates is None else c.sign * rates[c]
        drives[f"held_{c.name}_{c.sign:+.0f}"] = {"joint": c.joint, c.quantity: line(c.limit, rate, at)}
    return {**{k: v for k, v in scene.items() if k != "stops"}, "joints": joints, "drives": drives}


def line(value: float, rate: float, at: float) -> tuple[Any, Any, Any]:
    return (lambda t: value + rate * (t - at)), (lambda t: rate), (lambda t: 0.0)


class Met(NamedTuple):
    """What contacts make of a state: their pushes along the opening direction (N s or N), by name; the answer."""

    pushes: dict[str, float]
    solution: Solution
    after: dict[str, Placed]


def choices(some: Sequence[Contact]) -> list[tuple[Contact, ...]]:
    return [c for n in range(len(some) + 1) for c in itertools.combinations(some, n)]


def strike(scene: Scene, before: State, t: float = 0.0, about: Array | None = None) -> list[Met]:
    """All that Newton's law allows where contacts touch; several only where pushes are not determined."""
    now = {c: v for c, v in values(scene, before).items() if abs(v[0]) <= TOUCHES}
    wanted = {c: max(0.0, -c.restitution * rate) for c, (_, rate) in now.items()}
    read = model(with_held(scene, [], None))
    fastest = max(1.0, float(np.abs(velocities(read, before)).max()))
    found = []
    for held in choices(list(now)):
        jump = struck(with_held(scene, held, wanted, t), before, t, about)
        pushes = {c.name: c.sign * jump.reactions[c.joint].drive for c in held}
        if jump.residual > WRONG or any(p < -WRONG * max(1.0, *map(abs, pushes.values())) for p in pushes.values()):
            continue
        after = state_after(scene, before, jump)
        rates = values(scene, after)
        if all(rates[c][1] >= wanted[c] - WRONG * fastest for c in now):
            found.append(Met(pushes, jump, after))
    return different(found)


def rest(scene: Scene, state: State, t: float = 0.0, about: Array | None = None) -> list[Met]:
    """All that bears where contacts touch and do not open, in accelerations."""
    now = [c for c, v in values(scene, state).items() if abs(v[0]) <= TOUCHES and v[1] <= TOUCHES]
    found = []
    for held in choices(now):
        answer = solve(with_held(scene, held, None), state, t, about)
        pushes = {c.name: c.sign * answer.reactions[c.joint].drive for c in held}
        largest = max([1.0, *map(abs, pushes.values())])
        if answer.residual > WRONG or any(p < -WRONG * largest for p in pushes.values()):
            continue
        if all(opening(scene, state, answer, c, t) >= -WRONG * largest for c in now):
            found.append(Met(pushes, answer, dict(state)))
    return different(found)


def different(found: Sequence[Met]) -> list[Met]:
    """Those whose pushes differ: one that bears nothing may as well be free."""
    kept: list[Met] = []
    for one in found:
        size = WRONG * max([1.0, *map(abs, one.pushes.values())])
        names = [set(one.pushes) | set(other.pushes) for other in kept]
        apart = [max((abs(one.pushes.get(n, 0.0) - other.pushes.get(n, 0.0)) for n in some), default=0.0)
                 for other, some in zip(kept, names, strict=True)]  # fmt: skip
        if all(a > size for a in apart):
            kept.append(one)
    return kept


def opening(scene: Scene, state: State, answer: Solution, c: Contact, t: float) -> float:
    """Opening acceleration of a contact."""
    read = model(with_held(scene, [c], None))
    rows = assemble(read, state, t)
    parts = [(answer.acceleration[b], answer.angular_acceleration[b]) for b in read.names]
    V_dot = np.concatenate([x for pair in parts for x in pair])
    k = next(i for i, row in enumerate(rows.rows) if row.joint == c.joint and row.drive)
    return c.sign * float(rows.J[k] @ V_dot + rows.gamma[k])
