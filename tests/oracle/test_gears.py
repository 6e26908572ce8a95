"""Random scenes with gears, racks, cones and threads against the independent solution on absolute coordinates."""

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

ALL = spared(range(15), frozenset({1, 2, 3}))


@pytest.mark.parametrize("seed", ALL)
def test_motion_and_loads_of_what_meshes(seed: int) -> None:
    """Accelerations of all bodies, reactions of joints, and what one member exerts ON the other."""
    c = geared(seed)
    checks.same_accelerations(c)
    checks.same_reactions(c)
    (own,) = teeth(c.read)
    for k, state in enumerate(c.states):
        t = float(c.study.results.time[k])
        found = accelerations(c.read, state, t, pushes(c.read, state, t), scene_length(c.read, state))
        assert not found.self_stress.shape[1]
        (multiplier,) = (x for row, x in zip(found.rows.rows, found.least, strict=True) if row.joint == own.name)
        place, force, moment = load(c.read, own, state, multiplier)
        for body, sign in ((own.second, 1.0), (own.first, -1.0)):
            told = c.found.couplings["mesh"]["on"][body]
            near(told["point"][k], place, c.length)
            near(told["force"][k], sign * force, c.force[k])
            near(told["moment"][k], sign * moment, c.force[k] * c.length)


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
