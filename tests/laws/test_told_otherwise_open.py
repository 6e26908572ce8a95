"""What is open is a matter of the scene alone: however the world is turned, measured, numbered, or the chain closed."""

from __future__ import annotations

from functools import cache

import numpy as np
import pytest

from heuncli.results import Results
from tests.oracle import transforms
from tests.oracle.read import state_at
from tests.oracle.solve import solve
from tests.oracle.turns import random_rotation
from tests.shared.doubles import SEEDS, redundant_scene
from tests.shared.openness import open_parts, sums, told_by_sums
from tests.shared.scenes import near, solved, study

THESE = SEEDS[::6]
SCALARS = ("axial", "radial", "tilting", "tension", "drive")


@cache
def first(seed: int) -> Results:
    return solved(redundant_scene(seed)[1])


def same_sums(one: Results, other: Results, joints: dict[str, str] | None = None) -> None:
    """Each tells what the other tells."""
    back = {new: old for old, new in (joints or {}).items()}
    for a, b, names in ((one, other, joints or {}), (other, one, back)):
        for terms, _ in sums(a):
            parts = [(n.split("."), factor) for n, factor in terms.items()]
            assert told_by_sums(b, {".".join([p[0], names.get(p[1], p[1]), *p[2:]]): factor for p, factor in parts})


@pytest.mark.parametrize("mirror", [False, True], ids=["turned", "mirrored"])
@pytest.mark.parametrize("seed", THESE)
def test_world_turned(seed: int, mirror: bool) -> None:
    """World components are open by the oracle's self-stresses in the new directions; those along joints' axes stay."""
    scene, before = redundant_scene(seed)[1], first(seed)
    Q = random_rotation(np.random.default_rng(seed)) @ np.diag([1, 1, -1.0 if mirror else 1.0])
    found = solved(transforms.turned(scene, Q))
    plain = solve(scene, state_at(before.bodies, 0))
    assert found.model["redundant"] == before.model["redundant"]
    for name, block in found.joints.items():
        for part in ("force", "moment"):
            wanted = [not plain.along(name, **{part: Q.T[:, i]})[1] for i in range(3)]
            assert np.isnan(block[part][0]).tolist() == wanted, name
        for part in SCALARS:
            same = np.isnan(before.joints[name].get(part, [0.0])[0])
            assert np.isnan(block.get(part, [0.0])[0]) == same, (name, part)


@pytest.mark.parametrize("seed", THESE)
def test_other_units(seed: int) -> None:
    """Millimetres, tonnes, milliseconds: the same is open, the same sums are certain, terms and all."""
    scene, before = redundant_scene(seed)[1], first(seed)
    found = solved(transforms.units_changed(scene, 1e3, 1e-3, 1e3))
    assert found.model["redundant"] == before.model["redundant"]
    assert open_parts(found) == open_parts(before)
    load = float(np.abs(before.foundation["force"]).max())
    for (terms, value), (others, other) in zip(sums(before), sums(found), strict=True):
        assert terms.keys() == others.keys()
        unit = 1e-3 * 1e3 / 1e3**2 * (1.0 if ".force." in next(iter(terms)) else 1e3)
        most = max(map(abs, terms.values()))
        near(list(others.values()), list(terms.values()), most, 1e-9)
        near(other, value * unit, most * load * unit)


@pytest.mark.parametrize("seed", THESE)
def test_renumbered(seed: int) -> None:
    """Bodies and joints in other order, under other names."""
    scene, before = redundant_scene(seed)[1], first(seed)
    other, _, joints = transforms.renamed(scene, np.random.default_rng(seed))
    found = solved(other)
    assert found.model["redundant"] == before.model["redundant"]
    assert open_parts(found) == {joints[name]: parts for name, parts in open_parts(before).items()}
    same_sums(before, found, joints)


def test_closed_elsewhere() -> None:
    """Joints told in reverse close chains at others: counted, so that the test of it tests something."""
    elsewhere = 0
    for seed in THESE:
        scene, before = redundant_scene(seed)[1], first(seed)
        run = study({**scene, "joints": dict(reversed(scene["joints"].items()))})
        scenes = [s.setup.scene for s in (study(scene), run)]
        cuts = [{s.mechanism.joints[k].name for k in s.layout.spanning.cut} for s in scenes]
        elsewhere += cuts[0] != cuts[1]
        assert open_parts(run.results) == open_parts(before)
        same_sums(before, run.results)
    assert elsewhere >= 5
