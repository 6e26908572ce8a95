"""Random scenes with what meshes, and belts, some in closed chains, against the oracle on absolute coordinates."""

from __future__ import annotations

import numpy as np
import pytest

from tests.oracle.gears import load, teeth
from tests.oracle.loads import pushes
from tests.oracle.rows import assemble, velocities
from tests.oracle.solve import accelerations, scene_length
from tests.shared import checks
from tests.shared.geared_scenes import geared
from tests.shared.scenes import near
from tests.shared.seeds import spared
from tests.shared.trees import Case

ALL = spared(range(15), frozenset({1, 2, 3}))


@pytest.mark.parametrize("seed", ALL)
def test_motion_and_loads_of_what_meshes(seed: int) -> None:
    """Accelerations of all bodies, reactions of joints, and what one member exerts ON the other."""
    as_the_oracle_says(geared(seed))


@pytest.mark.heavy
@pytest.mark.parametrize("seed", range(6))
def test_motion_and_loads_of_belts(seed: int) -> None:
    as_the_oracle_says(geared(seed, ("belt", "aside")[seed % 2]))


@pytest.mark.heavy
@pytest.mark.parametrize(("seed", "form"), [(seed, None if seed < 25 else "belt") for seed in (*range(15, 25), 25, 26)])
def test_in_closed_chains(seed: int, form: str | None) -> None:
    as_the_oracle_says(geared(seed, form, 1 + seed % 2))


def as_the_oracle_says(c: Case) -> None:
    """Whatever is open is open in both."""
    checks.same_accelerations(c)
    checks.same_reactions(c)
    checks.same_foundation(c)
    (own,) = teeth(c.read)
    for k, state in enumerate(c.states):
        t = float(c.study.results.time[k])
        found = accelerations(c.read, state, t, pushes(c.read, state, t), scene_length(c.read, state))
        (row,) = (i for i, row in enumerate(found.rows.rows) if row.joint == own.name)
        is_open = bool(np.abs(found.self_stress[row]).max(initial=0.0) > 1e-9)
        place, force, moment = load(c.read, own, state, found.least[row])
        for body, sign in ((own.second, 1.0), (own.first, -1.0)):
            told = c.found.couplings["mesh"]["on"][body]
            assert np.isnan(told["force"][k]).any() == is_open
            if not is_open:
                F, at = told["force"][k], told["point"][k]
                near(F, sign * force, c.force[k])
                near(told["moment"][k] + np.cross(at - place, F), sign * moment, c.force[k] * c.length)


@pytest.mark.parametrize("seed", ALL)
def test_meshes_neither_slip_nor_take_power(seed: int) -> None:
    """All rows' rates vanish on the way, the counted coordinates among them; the energies add up."""
    c = geared(seed)
    for state in c.states:
        rows = assemble(c.read, state, 0.0)
        near(rows.J @ velocities(c.read, state), np.zeros(len(rows.J)), 10.0, 1e-10)
    accuracy = c.study.results.accuracy
    assert accuracy["energy_drift"] <= 1e-8
    assert accuracy["balance_residual"] <= 1e-10
