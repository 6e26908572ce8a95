"""An integrated motion against brute force on absolute coordinates (tests/oracle/motion) by another integrator."""

from __future__ import annotations

import numpy as np
import pytest

from tests.oracle.motion import motion
from tests.oracle.read import model
from tests.shared.scenes import moving, near, solved
from tests.shared.trees import seeds, tree_scene, weighed

TIMES = (0.0, 0.15, 0.4)


@pytest.mark.parametrize("seed", seeds(9))
@pytest.mark.third
def test_motion(seed: int) -> None:
    """Places, attitudes and rates after 0.4 s: the oracle's own tolerance is 1e-13, its gaps are not corrected."""
    scene, state = tree_scene(seed, n_bodies=1 + seed % 3)
    plain = weighed(scene)
    wanted = motion(plain, state, TIMES)
    found = solved(moving(scene, TIMES, 1e-12)).bodies
    for name, m in model(plain).masses.items():
        b = found[name]
        for k, s in enumerate(wanted):
            size = max(1.0, float(np.abs(s[name].position).max()))
            v, w = s[name].speed(m.center), s[name].angular_velocity
            speed = max(1.0, float(np.abs([v, w]).max()))
            near(b["center"][k], s[name].point(m.center), size)
            near(b["rotation"][k], s[name].rotation, 1.0)
            near(b["center_velocity"][k], v, speed)
            near(b["angular_velocity"][k], w, speed)
