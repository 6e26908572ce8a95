"""Random trees and closed chains with constant-velocity joints against the independent solution."""

from __future__ import annotations

import numpy as np
import pytest

from tests.oracle.rows import gaps, rates
from tests.shared import checks
from tests.shared.loops import loop_scene
from tests.shared.scenes import near
from tests.shared.trees import ABOUT, Case, case, tree_scene

KINDS = ("cv", "cv", "pin", "slide", "universal", "ball")


def as_the_oracle_says(c: Case) -> None:
    """Accelerations, reactions, what is open of them, and both shafts' turns on the way."""
    assert any(j.kind == "cv" for j in c.read.joints)
    checks.same_accelerations(c)
    checks.same_reactions(c)
    checks.same_parts(c)
    checks.same_foundation(c)
    checks.free_directions_carry_nothing(c)
    for state in c.states:
        for opened in (*gaps(c.read, state).values(), *rates(c.read, state).values()):
            near(opened, np.zeros(len(opened)), 10.0 * c.length, 1e-9)


@pytest.mark.parametrize("seed", [8, *(pytest.param(s, marks=pytest.mark.heavy) for s in (3, 6))])
def test_trees(seed: int) -> None:
    """Seeds in which some joint is one."""
    scene, _ = tree_scene(seed, kinds=KINDS)
    as_the_oracle_says(case({**scene, "foundation": {"about": ABOUT.tolist()}}))


@pytest.mark.heavy
@pytest.mark.parametrize("seed", [0, 2, 3, 5])
def test_closed_chains(seed: int) -> None:
    """Of joints that seldom hold anything twice, and of cv joints, which may."""
    scene, _ = loop_scene(seed, kinds=KINDS, loop_kinds=("ball", "line", "cv") if seed % 2 else ("cv",))
    as_the_oracle_says(case({**scene, "foundation": {"about": ABOUT.tolist()}}))
