"""Sections in bodies of closed chains against the weld oracle: the body sawn in two, welded, and the weld's load read.

What is open there too: a cut through a body between two redundant joints carries the self-stress.
"""

from __future__ import annotations

from functools import cache

import numpy as np
import pytest

from tests.oracle.weld import SAW, Section, section
from tests.shared.loops import DRIVEN, QUICK, SEEDS, loop_scene
from tests.shared.scenes import instants, near
from tests.shared.seeds import spared
from tests.shared.trees import Case, case, cut_through

THESE = spared([s for s in [*SEEDS[:24], *DRIVEN[:8]] if s // 2 % 2], QUICK)  # those with shapes


@cache
def sawn(seed: int) -> Case:
    """A closed chain with an oblique cut through every body, its bodies' masses told by shapes."""
    scene, _ = loop_scene(seed)
    rng = np.random.default_rng(seed)
    cuts = {f"cut_{name}": cut_through(body, rng) for name, body in scene["bodies"].items()}
    return case({**scene, "sections": {n: {"body": n[4:], **c} for n, c in cuts.items() if c is not None}})


@cache
def welds(seed: int) -> dict[tuple[int, str], Section]:
    """The oracle's answer for every instant and cut."""
    c = sawn(seed)
    return {(k, name): section(c.scene, state, t, cut["body"], cut["at"], cut["normal"])
            for k, t, state in instants(c.study.results) for name, cut in c.scene["sections"].items()}  # fmt: skip


@pytest.mark.heavy
@pytest.mark.parametrize("seed", THESE)
@pytest.mark.third
def test_cut_bodies(seed: int) -> None:
    c = sawn(seed)
    assert c.study.results.sections
    for k, _, _ in instants(c.study.results):
        for name, block in c.study.results.sections.items():
            there = welds(seed)[k, name]
            F, M = there.unique[:3], there.unique[3:]
            near(block["point"][k], there.point, c.length)
            near(block["normal"][k], there.normal, 1.0)
            assert (~np.isnan(block["force"][k])).tolist() == F.tolist()
            assert (~np.isnan(block["moment"][k])).tolist() == M.tolist()
            near(np.where(F, block["force"][k], 0.0), np.where(F, there.force, 0.0), c.force[k])
            near(np.where(M, block["moment"][k], 0.0), np.where(M, there.moment, 0.0), c.force[k] * c.length)


@pytest.mark.heavy
@pytest.mark.parametrize("seed", THESE)
@pytest.mark.third
def test_components_of_a_cut(seed: int) -> None:
    """N, Q1, Q2, T, M1, M2 in the cut's own axes: numbers where the self-stress has no part along that axis."""
    c = sawn(seed)
    for k, _, state in instants(c.study.results):
        for name, block in c.study.results.sections.items():
            cut, there = c.scene["sections"][name], welds(seed)[k, name]
            n = there.normal
            first = state[cut["body"]].rotation @ np.array(cut["first_axis"])
            e1 = first - (first @ n) * n
            e1 = e1 / np.linalg.norm(e1)
            e2 = np.cross(n, e1)
            near(block["first_axis"][k], e1, 1.0)
            parts = {"N": ("force", n), "Q1": ("force", e1), "Q2": ("force", e2),
                     "T": ("moment", n), "M1": ("moment", e1), "M2": ("moment", e2)}  # fmt: skip
            for part, (what, axis) in parts.items():
                value, certain = there.solution.along(SAW, **{what: axis})
                assert np.isnan(block[part][k]) == (not certain), f"{name}.{part}"
                if certain:
                    near(block[part][k], value, c.force[k] * c.length)
                else:
                    assert part in block["open"]
