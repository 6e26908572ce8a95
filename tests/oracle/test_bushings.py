"""Bushings against the oracle: motion, reactions, sections, what they exert and how they are strained.

The oracle takes the rotation vector from SciPy, and the moment from the derivative of the exponential map, for which it
solves three equations: no quaternions, no series, no inverse written down.
"""

from __future__ import annotations

from functools import cache
from typing import Any

import numpy as np
import pytest

from heuncli.base.errors import SolveError
from tests.oracle.loads import BLOCKS, elastic, pushes, strain
from tests.oracle.masses import Plane, cut
from tests.oracle.scenes import ELASTIC, random_scene
from tests.oracle.turns import unit
from tests.oracle.weld import section
from tests.shared.scenes import instants, near
from tests.shared.trees import Case, case, cut_through, seeds

SEEDS = seeds(12)
JOINTS = ("ball", "pin", "cylinder", "universal", "slide", "weld")


def couple_all_directions(seed: int) -> dict[str, list[list[float]]]:
    """Stiffness and damping of a bushing by random positive definite 6 x 6."""
    keys: dict[str, list[list[float]]] = {}
    rng = np.random.default_rng(seed)
    for size, blocks in ((1.0, BLOCKS[0]), (0.2, BLOCKS[1])):
        factor = rng.normal(size=(6, 6))
        whole = size * factor @ factor.T
        for key, block in zip(blocks, (whole[:3, :3], whole[3:, 3:], whole[:3, 3:]), strict=True):
            keys[key] = block.tolist()
    return keys


@cache
def elastic_scene(seed: int) -> Case:
    """A tree with bushings between its bodies, every third with free bodies, every other one with a loop, cross
    stiffness in its bushing, and cuts.
    """
    rng = np.random.default_rng(seed)
    while True:
        scene, _ = random_scene(
            rng, int(rng.integers(1, 5)), kinds=JOINTS, free=(0.0, 0.0, 0.6)[seed % 3], loops=seed % 2,
            loop_kinds=("pin", "ball", "cylinder", "line"), loads=ELASTIC, masses="shapes",
        )  # fmt: skip
        if seed % 2:
            scene["forces"]["f_bushing"] |= couple_all_directions(seed)
        cuts: dict[str, Any] = {}
        for name, body in scene["bodies"].items():
            through = cut_through(body, rng)
            assert through is not None
            cuts[f"one_{name}"] = {"body": name, **through}
        try:
            return case({**scene, "sections": cuts})
        except SolveError as error:  # a body that turns over in its bushing
            assert error.problems[0].code == "bushing-turned", error


@pytest.mark.heavy
@pytest.mark.parametrize("seed", SEEDS)
@pytest.mark.third
def test_motion_and_reactions(seed: int) -> None:
    """Accelerations, and all that is certain of the joints' loads."""
    c = elastic_scene(seed)
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
            near(told[sure], np.append(reaction.force, reaction.moment)[sure], c.force[k] * c.length)


@pytest.mark.parametrize("seed", SEEDS)
def test_what_it_exerts(seed: int) -> None:
    """Shift and turn, force and moment in its own axes, its power."""
    c = elastic_scene(seed)
    spec = c.read.loads["f_bushing"]
    for k, t, state in instants(c.found):
        block = c.found.forces["f_bushing"]
        d, phi = strain(c.read, state, spec)
        F, M = elastic(c.read, state, spec)
        near(block["shift"][k], d, c.length)
        near(block["turn"][k], phi, 1.0)
        near(block["force"][k], F, c.force[k])
        near(block["moment"][k], M, c.force[k] * c.length)
        near(block["value"][k], np.linalg.norm(F), c.force[k])
        power = sum(part.power(state) for part in pushes(c.read, state, t)["f_bushing"])
        near(block["power"][k], power, c.force[k] * c.length * 10)


@pytest.mark.parametrize("seed", SEEDS)
def test_a_cut_carries_what_its_weld_would(seed: int) -> None:
    """s' and M' about the cut's point, where the weld's load is certain."""
    c = elastic_scene(seed)
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
