"""Friction of threads: on each flank mu times what presses square to it, against the way that it slides.

    N: the multiplier of the thread's row, along its axis; the flank's own pressure is N / cos(lambda)
    against the sliding  mu |N| cos(lambda) r / cos(lambda) about, and mu |N| sin(lambda) / cos(lambda) along the axis
Each thread carries N = N_0 + sum of a_k |N_k|, linear on every branch of the signs: all branches are tried, and one has
to answer with its own signs.
"""

from __future__ import annotations

import itertools
import math
from collections.abc import Callable, Mapping
from typing import Any

import numpy as np

from tests.oracle.gears import parts
from tests.oracle.loads import Push
from tests.oracle.read import Model, State, placed
from tests.oracle.turns import Array, cross

Multipliers = Callable[[Mapping[str, list[Push]]], Mapping[str, float]]


def threads(read: Model) -> dict[str, Mapping[str, Any]]:
    """The screws that rub, by name."""
    couplings = read.scene.get("couplings") or {}
    return {name: given for name, given in couplings.items() if given["type"] == "screw" and "friction" in given}


def unit_rub(read: Model, state: State, given: Mapping[str, Any]) -> list[Push]:
    """What rubs where N is 1 N: ON both bodies of the thread."""
    joints = {j.name: j for j in read.joints}
    of = [joints[name] for name in given["of"]]
    if len(of) == 1:
        screw, nut, held = of[0].b.body, of[0].a.body, of[0]
        point, direction = held.b.point, placed(state, held.a.body).rotation @ held.axis
    else:
        _, one, other = parts(read, of[0], of[1])
        turn = of[0] if one.turns else of[1]
        screw, nut = (one.body, other.body) if one.turns else (other.body, one.body)
        point = turn.b.point if turn.b.body == screw else turn.a.point
        direction = placed(state, turn.a.body).rotation @ turn.axis
    S, N, rubs = placed(state, screw), placed(state, nut), given["friction"]
    P = S.point(point)
    turning = float(direction @ (S.angular_velocity - N.angular_velocity))
    sliding = float(direction @ (S.speed(point) - N.velocity - cross(N.angular_velocity, P - N.position)))
    slope = abs(given["lead"]) / (math.tau * rubs["radius"])
    mu = rubs["coefficient"] / math.cos(rubs.get("flank_angle", 0.0)) * math.tanh(abs(turning) / rubs["speed"])
    force = -mu * slope * math.copysign(1.0, sliding) * direction
    couple = -mu * rubs["radius"] * math.copysign(1.0, turning) * direction
    return [Push(screw, P, force, couple), Push(nut, P, -force, -couple)]


def rubbing(read: Model, state: State, multipliers: Multipliers) -> dict[str, list[Push]]:
    """What rubs in all threads, by their names; multipliers: of the rows of couplings under what rubs."""
    names = list(threads(read))
    if not names:
        return {}
    units = {name: unit_rub(read, state, given) for name, given in threads(read).items()}

    def carried(loads: Mapping[str, list[Push]]) -> Array:
        found = multipliers(loads)
        return np.array([found[name] for name in names])

    at_rest = carried({})
    A = np.array([carried({name: units[name]}) - at_rest for name in names]).T
    found = []
    for signs in itertools.product((1.0, -1.0), repeat=len(names)):
        N = np.linalg.solve(np.eye(len(names)) - A * signs, at_rest)
        if (N * signs >= 0.0).all():
            found.append(np.abs(N))
    assert all(np.allclose(N, found[0]) for N in found), "several answers"
    return {name: scaled(units[name], float(N)) for name, N in zip(names, found[0], strict=True)}


def scaled(pushes: list[Push], factor: float) -> list[Push]:
    """Pushes so many times."""
    return [Push(one.body, one.place, factor * one.force, factor * one.couple) for one in pushes]
