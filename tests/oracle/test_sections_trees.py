"""Sections against the weld oracle (tests/oracle/weld.py): a body sawn in two and welded, and the weld's load read.

Trees of every joint and free bodies, bodies by shapes, oblique planes, three instants of a motion.
"""

from __future__ import annotations

from functools import cache
from typing import Any

import numpy as np
import pytest

from tests.oracle.masses import Mass, Plane, cut
from tests.oracle.read import end
from tests.oracle.turns import Array, random_unit, unit
from tests.oracle.weld import section
from tests.shared.scenes import instants, near
from tests.shared.trees import Case, case, cut_through, seeds, tree_scene

SEEDS = seeds(15)


@cache
def sawn(seed: int) -> Case:
    """A tree, every third with free bodies, with a cut and the same cut turned round through every body."""
    scene, _ = tree_scene(seed, masses="shapes", free=(0.0, 0.0, 0.6)[seed % 3])
    rng = np.random.default_rng(seed)
    cuts: dict[str, Any] = {}
    for name, body in scene["bodies"].items():
        through = cut_through(body, rng)
        assert through is not None
        cuts[f"one_{name}"] = {"body": name, **through}
        cuts[f"two_{name}"] = {"body": name, **through, "normal": [-x for x in through["normal"]]}
    return case({**scene, "sections": cuts})


def pieces_of(scene: dict[str, Any]) -> dict[str, Mass]:
    """What each cut separates, by the oracle's own quadrature; of the cuts turned round the sum tells enough."""
    found = {}
    for name, c in scene["sections"].items():
        if not name.startswith("two_"):
            plane = Plane(np.array(c["at"]), unit(c["normal"]), c.get("side"))
            found[name] = cut(scene["bodies"][c["body"]], plane)[1]
    return found


def sizes(c: Case, k: int) -> tuple[float, float]:
    """Force and moment that deviations are measured in."""
    return c.force[k], c.force[k] * c.length


@pytest.mark.heavy
@pytest.mark.parametrize("seed", SEEDS)
@pytest.mark.third
def test_a_cut_carries_what_its_weld_would(seed: int) -> None:
    """s' and M' about the cut's point, its place and frame, and the six resultants in that frame."""
    c = sawn(seed)
    pieces = pieces_of(c.scene)
    for k, t, state in instants(c.study.results):
        F, M = sizes(c, k)
        for name, piece in pieces.items():
            told = c.scene["sections"][name]
            found = {key: value[k] for key, value in c.study.results.sections[name].items() if key != "open"}
            weld = section(c.plain, state, t, told["body"], told["at"], told["normal"], piece=piece)
            near(found["point"], weld.point, c.length)
            near(found["normal"], weld.normal, 1.0)
            near(found["force"], weld.force, F)
            near(found["moment"], weld.moment, M)
            e1 = state[told["body"]].rotation @ np.array(told["first_axis"])
            e1 = e1 - (e1 @ weld.normal) * weld.normal
            e1 = e1 / np.linalg.norm(e1)
            e2 = np.cross(weld.normal, e1)
            near(found["first_axis"], e1, 1.0)
            near([found["N"], found["Q1"], found["Q2"]], [weld.force @ a for a in (weld.normal, e1, e2)], F)
            near([found["T"], found["M1"], found["M2"]], [weld.moment @ a for a in (weld.normal, e1, e2)], M)


@pytest.mark.heavy
@pytest.mark.parametrize("seed", SEEDS)
@pytest.mark.third
def test_both_sides_add_to_nothing(seed: int) -> None:
    c = sawn(seed)
    found = c.study.results.sections
    for name in c.read.names:
        for k in range(len(c.force)):
            F, M = sizes(c, k)
            near(found[f"one_{name}"]["force"][k], -found[f"two_{name}"]["force"][k], F)
            near(found[f"one_{name}"]["moment"][k], -found[f"two_{name}"]["moment"][k], M)


@pytest.mark.heavy
@pytest.mark.parametrize("side", ["before", "beyond"])
@pytest.mark.parametrize("seed", seeds(6))
@pytest.mark.third
def test_what_lies_in_the_plane_goes_to_its_side(seed: int, side: str) -> None:
    """A cut through the very place of a joint or load; the oracle puts it on the side asked for."""
    scene, _ = tree_scene(seed, masses="shapes", kinds=("ball", "pin", "weld", "universal"))
    rng = np.random.default_rng(seed)
    cuts = {}
    for name in scene["bodies"]:
        at = place_on(scene, name)
        if at is not None:
            cuts[f"cut_{name}"] = {"body": name, "at": at.tolist(), "normal": random_unit(rng).tolist(), "side": side}
    for told in cuts.values():  # a box about the place makes sure that the plane meets the body
        box = {"type": "box", "center": told["at"], "size": [0.3, 0.2, 0.25], "density": 20.0}
        scene["bodies"][told["body"]]["shapes"].append(box)
    c = case(still(scene, cuts))
    pieces = pieces_of(c.scene)
    for k, t, state in instants(c.study.results):
        F, M = sizes(c, k)
        for name, told in cuts.items():
            found = c.study.results.sections[name]
            weld = section(c.plain, state, t, told["body"], told["at"], told["normal"], side, pieces[name])
            near(found["force"][k], weld.force, F)
            near(found["moment"][k], weld.moment, M)


def still(scene: dict[str, Any], cuts: dict[str, Any]) -> dict[str, Any]:
    """The scene with its bodies' velocities left out: it starts at rest."""
    given = scene["bodies"].items()
    bodies = {name: {k: v for k, v in body.items() if not k.endswith("velocity")} for name, body in given}
    return {**scene, "bodies": bodies, "sections": cuts}


def place_on(scene: dict[str, Any], body: str) -> Array | None:
    """Where some joint or load sits on a body."""
    for entry in (*scene["joints"].values(), *scene.get("forces", {}).values()):
        for key in ("from", "to", "on"):
            if key in entry and (place := end(scene, entry[key])).body == body:
                return place.point
    return None


@pytest.mark.parametrize("seed", seeds(8))
def test_a_body_without_shapes_gives_its_piece(seed: int) -> None:
    """Any piece that leaves a possible rest; the plane only tells what else stands on it."""
    scene, _ = tree_scene(seed, masses="given")
    rng = np.random.default_rng(seed)
    cuts, pieces = {}, {}
    for name, body in scene["bodies"].items():
        share = float(rng.uniform(0.2, 0.6))
        inertia = 0.3 * share * np.array(body["inertia"])
        piece = Mass(share * body["mass"], np.array(body["center"]) + 0.02 * rng.standard_normal(3), inertia)
        at, normal = rng.uniform(-0.3, 0.3, 3), random_unit(rng)
        given = {"mass": piece.mass, "center": piece.center.tolist(), "inertia": inertia.tolist()}
        pieces[f"cut_{name}"] = piece
        cuts[f"cut_{name}"] = {"body": name, "at": at.tolist(), "normal": normal.tolist(), "piece": given}
    c = case({**scene, "sections": cuts})
    for k, t, state in instants(c.study.results):
        F, M = sizes(c, k)
        for name, told in cuts.items():
            found = c.study.results.sections[name]
            weld = section(c.plain, state, t, told["body"], told["at"], told["normal"], piece=pieces[name])
            near(found["force"][k], weld.force, F)
            near(found["moment"][k], weld.moment, M)
