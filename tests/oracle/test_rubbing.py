"""Friction by what a joint carries, in random scenes, against the dense solution on absolute coordinates.

The oracle is told the friction that heun found, as friction of a given size. What it then finds that the joints carry
has to press by that much: the law is met, by equations that share no line with heun's.
"""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

from heuncli.base.errors import SolveError
from heuncli.results.results import Results
from tests.oracle.checks import size_of
from tests.oracle.read import Model, State, model, placed
from tests.oracle.solve import Solution, solve
from tests.oracle.turns import cross, unit
from tests.shared.rubbing import rubbing_scene, rubs_of
from tests.shared.scenes import near, solved

REFUSED = {"friction-jams", "friction-not-unique", "friction-open"}
CASES = [("tree", 0, 0, 24), ("driven tree", 0, 1, 12), ("loop", 1, 0, 14), ("driven loops", 2, 1, 14)]


def pressing(read: Model, state: State, found: Solution, spec: dict[str, Any]) -> float:
    """What presses in a load's joint, by the oracle's reaction."""
    joint = next(j for j in read.joints if j.name == spec["joint"])
    carried = found.reactions[joint.name]
    if "radius" in spec:
        return float(np.linalg.norm(carried.force))
    n = unit(placed(state, joint.a.body).rotation @ joint.axis)
    F = carried.force - (carried.force @ n) * n
    if "length" not in spec:
        return float(np.linalg.norm(F))
    tilt = cross(n, carried.moment) / spec["length"]
    return float(np.linalg.norm(F / 2 - tilt) + np.linalg.norm(F / 2 + tilt))


def given(scene: dict[str, Any], found: Results) -> dict[str, Any]:
    """The scene with torques and forces in place of the friction that was found."""
    torques = {
        name: {"type": "torque", "joint": spec["joint"], "value": float(found.forces[name]["value"][0])}
        for name, spec in rubs_of(scene).items()
    }
    return {**scene, "forces": scene["forces"] | torques}


@pytest.mark.heavy
@pytest.mark.parametrize(("kind", "loops", "drives", "count"), CASES, ids=[case[0] for case in CASES])
@pytest.mark.third
def test_what_presses_is_what_rubs(kind: str, loops: int, drives: int, count: int) -> None:
    told = 0
    for seed in range(count):
        scene, state = rubbing_scene(seed, loops, drives)
        try:
            found = solved(scene)
        except SolveError as error:
            assert {problem.code for problem in error.problems} <= REFUSED, (seed, error)
            continue
        told += 1
        read = model(given(scene, found))
        o = solve(read, state)
        size = size_of(o)
        for name, spec in rubs_of(scene).items():
            block = found.forces[name]
            rate = float(block["rate"][0])
            wanted = -spec["coefficient"] * spec.get("radius", 1.0) * np.tanh(rate / spec["speed"])
            near(block["value"][0], wanted * pressing(read, state, o, spec), size)
            near(block["power"][0], block["value"][0] * rate, size * max(1.0, abs(rate)))
        for name, block in found.joints.items():
            if not block["open"]:
                near(block["force"][0], o.reactions[name].force, size)
        fastest = max(1.0, *(float(np.abs(a).max()) for a in o.acceleration.values()))
        for name, a in o.acceleration.items():
            near(found.bodies[name]["center_acceleration"][0], a, fastest)
    assert told >= count // 2
