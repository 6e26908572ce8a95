"""Random scenes with cams of every kind against the independent solution on absolute coordinates."""

from __future__ import annotations

import numpy as np
import pytest

from tests.oracle.cams import cams, leaves, touch
from tests.oracle.loads import pushes
from tests.oracle.rows import assemble, velocities
from tests.oracle.solve import accelerations, scene_length
from tests.shared import checks
from tests.shared.cam_scenes import cammed
from tests.shared.scenes import near
from tests.shared.seeds import spared

ALL = spared(range(12), frozenset({0, 4}))


@pytest.mark.parametrize("seed", ALL)
@pytest.mark.third
def test_motion_and_loads_of_what_a_cam_moves(seed: int) -> None:
    """Accelerations of all bodies, reactions of joints, and what the disc exerts ON its follower, and where."""
    c = cammed(seed)
    checks.same_accelerations(c)
    checks.same_reactions(c)
    (own,) = cams(c.read)
    for k, state in enumerate(c.states):
        t = float(c.study.results.time[k])
        found = accelerations(c.read, state, t, pushes(c.read, state, t), scene_length(c.read, state))
        assert not found.self_stress.shape[1]
        (multiplier,) = (x for row, x in zip(found.rows.rows, found.least, strict=True) if row.joint == own.name)
        place, direction = touch(own, state)
        block = c.found.couplings["cam"]
        for body, sign in (("follower", 1.0), ("disc", -1.0)):
            near(block["on"][body]["point"][k], place, c.length)
            near(block["on"][body]["force"][k], sign * multiplier * direction, c.force[k])
            near(block["on"][body]["moment"][k], np.zeros(3), c.force[k] * c.length)
        near(block["contact"][k], multiplier * np.sign(leaves(own, state)), c.force[k])


@pytest.mark.heavy
@pytest.mark.parametrize("seed", ALL)
def test_a_follower_neither_leaves_its_cam_nor_takes_power(seed: int) -> None:
    """All rows' rates vanish on the way, the coordinate is the lift; the energies add up."""
    c = cammed(seed)
    (own,) = cams(c.read)
    coordinates = c.found.coordinates
    angle = coordinates["j_disc"]["angle"]
    name = "angle" if own.follower.kind == "pin" else "travel"
    near(coordinates["j_follower"][name], own.lift(angle - own.phase), 1.0, 1e-11)
    for state in c.states:
        rows = assemble(c.read, state, 0.0)
        near(rows.J @ velocities(c.read, state), np.zeros(len(rows.J)), 10.0, 1e-10)
    accuracy = c.study.results.accuracy
    assert accuracy["energy_drift"] <= 1e-8
    assert accuracy["balance_residual"] <= 1e-10
