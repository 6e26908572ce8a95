"""Random scenes with wheels and balls against the independent solution on absolute coordinates."""

from __future__ import annotations

import numpy as np
import pytest

from tests.oracle.loads import pushes
from tests.oracle.read import model, moved_on, placed
from tests.oracle.rows import assemble, velocities
from tests.oracle.solve import accelerations, scene_length
from tests.oracle.wheels import contact, height, loads, wheels
from tests.shared import checks
from tests.shared.rolling_scenes import rolling, rolling_scene
from tests.shared.scenes import near
from tests.shared.seeds import spared

ALL = spared(range(12), frozenset({0, 1, 4}))


@pytest.mark.parametrize("seed", ALL)
def test_motion_and_loads_of_what_rolls(seed: int) -> None:
    """Accelerations of all bodies, reactions of joints, the foundation, and what the plane exerts ON the wheel."""
    c = rolling(seed)
    checks.same_accelerations(c)
    checks.same_reactions(c)
    (wheel,) = wheels(c.scene)
    for k, state in enumerate(c.states):
        t = float(c.study.results.time[k])
        found = accelerations(c.read, state, t, pushes(c.read, state, t), scene_length(c.read, state))
        assert not found.self_stress.shape[1]
        force = loads(c.read, state, found.least, [row.joint for row in found.rows.rows])["rim"]
        block = c.found.couplings["rim"]
        near(block["on"]["wheel"]["force"][k], force, c.force[k])
        near(block["on"]["wheel"]["point"][k], contact(wheel, state), c.length)
        near(block["on"]["wheel"]["moment"][k], np.zeros(3), c.force[k] * c.length)
        n = placed(state, wheel.a.body).rotation @ wheel.normal
        near(block["normal"][k], n @ force, c.force[k])
        near(block["friction"][k], np.linalg.norm(force - (n @ force) * n), c.force[k])


@pytest.mark.parametrize("seed", ALL)
def test_what_rolls_stays_on_its_plane_and_does_not_slip(seed: int) -> None:
    """The pose closes to rounding; all rows' rates vanish; rolling takes no power, so that the energies add up."""
    c = rolling(seed)
    (wheel,) = wheels(c.scene)
    for state in c.states:
        near(height(wheel, state), 0.0, c.length, 1e-12)
        rows = assemble(c.read, state, 0.0)
        near(rows.J @ velocities(c.read, state), np.zeros(len(rows.J)), 10.0, 1e-11)
    accuracy = c.study.results.accuracy
    assert accuracy["energy_drift"] <= 1e-8
    assert accuracy["balance_residual"] <= 1e-10


@pytest.mark.parametrize("seed", range(6))
def test_the_oracle_rows_change_as_their_gammas_say(seed: int) -> None:
    """d/dt (J V) = γ while no velocity changes: by differences of the oracle's own rows."""
    scene, state = rolling_scene(seed)
    read = model(scene)
    V, h = velocities(read, state), 1e-6
    moved = [moved_on(read, state, s * h) for s in (1.0, -1.0)]
    slope = (assemble(read, moved[0], 0.0).J - assemble(read, moved[1], 0.0).J) @ V / (2 * h)
    own = np.array([row.joint == "rim" for row in assemble(read, state, 0.0).rows])
    near(slope[own], assemble(read, state, 0.0).gamma[own], 10.0, 1e-7)
