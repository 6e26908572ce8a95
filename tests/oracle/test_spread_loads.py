"""Distributed loads and springs about joints' axes against the oracle: motion, reactions, sections, shares by cause.

The oracle takes a distributed load at Gauss's points, parts it at a plane that it crosses, and reads a spring's angle
off the bodies' axes: no third points, no weights of triangles, no counted coordinates.
"""

from __future__ import annotations

from functools import cache
from typing import Any

import numpy as np
import pytest

from tests.oracle.loads import pushes, turned_by
from tests.oracle.masses import Plane, cut
from tests.oracle.read import placed
from tests.oracle.scenes import SPREAD, random_scene
from tests.oracle.turns import unit
from tests.oracle.weld import section
from tests.shared.scenes import instants, near
from tests.shared.trees import Case, case, cut_through, seeds

SEEDS = seeds(12)
JOINTS = ("ball", "pin", "cylinder", "universal", "slide", "weld")


@cache
def spread(seed: int) -> Case:
    """A tree, every third with free bodies, every other one with a loop, and a cut through every body."""
    rng = np.random.default_rng(seed)
    scene, _ = random_scene(
        rng, int(rng.integers(1, 5)), kinds=JOINTS, free=(0.0, 0.0, 0.6)[seed % 3], loops=seed % 2,
        loop_kinds=("pin", "ball", "cylinder", "line"), loads=SPREAD, masses="shapes",
    )  # fmt: skip
    cuts: dict[str, Any] = {}
    for name, body in scene["bodies"].items():
        through = cut_through(body, rng)
        assert through is not None
        cuts[f"one_{name}"] = {"body": name, **through}
    return case({**scene, "sections": cuts})


@pytest.mark.heavy
@pytest.mark.parametrize("seed", SEEDS)
@pytest.mark.third
def test_motion_and_reactions(seed: int) -> None:
    """Accelerations, and all that is certain of the joints' loads."""
    c = spread(seed)
    for k, o in enumerate(c.oracle):
        rates = (*o.acceleration.values(), *o.angular_acceleration.values())
        fastest = max(1.0, *(float(np.abs(a).max()) for a in rates))
        for name, block in c.found.bodies.items():
            near(block["center_acceleration"][k], o.acceleration[name], fastest)
            near(block["angular_acceleration"][k], o.angular_acceleration[name], fastest)
        for name, block in c.found.joints.items():
            told, reaction = np.append(block["force"][k], block["moment"][k]), o.reactions[name]
            sure = np.isfinite(told)
            assert np.array_equal(sure, reaction.unique[:6])
            wanted = np.append(reaction.force, reaction.moment)
            near(told[sure], wanted[sure], c.force[k] * c.length)


@pytest.mark.parametrize("seed", SEEDS)
def test_values_and_powers(seed: int) -> None:
    """The resultant's magnitude, the spring's torque, angle and rate, and what they put into the bodies."""
    c = spread(seed)
    for k, t, state in instants(c.found):
        for name, parts in pushes(c.read, state, t).items():
            if name not in ("f_distributed", "f_turn_spring"):
                continue
            block = c.found.forces[name]
            near(block["power"][k], sum(part.power(state) for part in parts), c.force[k] * c.length)
            if name == "f_distributed":
                near(block["value"][k], np.linalg.norm(sum(part.force for part in parts)), c.force[k])
                continue
            joint = next(j for j in c.read.joints if j.name == c.read.loads[name]["joint"])
            axis = placed(state, joint.a.body).rotation @ joint.axis
            near(block["value"][k], parts[0].couple @ axis, c.force[k] * c.length)
            turns = (block["angle"][k] - turned_by(joint, state)) / (2.0 * np.pi)
            near(turns, np.round(turns), 1.0)


@pytest.mark.parametrize("seed", SEEDS)
def test_a_cut_carries_what_its_weld_would(seed: int) -> None:
    """s' and M' about the cut's point, where the weld's load is certain."""
    c = spread(seed)
    for name, told in c.scene["sections"].items():
        plane = Plane(np.array(told["at"]), unit(told["normal"]), told.get("side"))
        piece = cut(c.scene["bodies"][told["body"]], plane)[1]
        for k, t, state in instants(c.found):
            weld = section(c.plain, state, t, told["body"], told["at"], told["normal"], piece=piece)
            found = c.found.sections[name]
            F, M = np.asarray(found["force"][k]), np.asarray(found["moment"][k])
            sure = np.isfinite(F), np.isfinite(M)
            near(F[sure[0]], weld.force[sure[0]], c.force[k])
            near(M[sure[1]], weld.moment[sure[1]], c.force[k] * c.length)
