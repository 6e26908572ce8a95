"""Random scenes with ropes that keep their length, or stretch, against the independent solution."""

from __future__ import annotations

import numpy as np
import pytest

from tests.oracle.loads import pushes
from tests.oracle.ropes import exerted, length, ropes, runs, strands, tension
from tests.oracle.rows import assemble, velocities
from tests.oracle.solve import accelerations, scene_length
from tests.oracle.turns import cross
from tests.shared import checks
from tests.shared.rope_scenes import roped
from tests.shared.scenes import near
from tests.shared.seeds import spared

ALL = spared(range(15), frozenset({0, 2, 3}))
READ = 1e-8  # of gammas by differences


@pytest.mark.parametrize("seed", ALL)
@pytest.mark.third
def test_motion_and_loads_of_what_a_rope_pulls(seed: int) -> None:
    """Accelerations of all bodies, reactions of joints, the foundation; and the tension, ON every body."""
    c = roped(seed)
    checks.same_accelerations(c, READ)
    checks.same_reactions(c, READ)
    checks.same_foundation(c, READ)
    stays = ropes(c.read)["rope"]
    for k, state in enumerate(c.states):
        if "stiffness" in c.scene["couplings"]["rope"]:
            tensions = [tension(c.read, "rope", state)]
        else:
            t = float(c.study.results.time[k])
            found = accelerations(c.read, state, t, pushes(c.read, state, t), scene_length(c.read, state))
            assert not found.self_stress.shape[1]
            own = zip(found.rows.rows, found.least, strict=True)
            tensions = [-float(x) for row, x in own if row.joint == "rope"]
        block, way = c.found.couplings["rope"], strands(stays, state)
        near(block["tension"][k], tensions[0], c.force[k], READ)
        if len(tensions) > 1:
            near(block["last_tension"][k], tensions[1], c.force[k], READ)
        parts = [x for run, T in zip(runs(stays), tensions, strict=True) for x in exerted(way[run], T)]
        for body, on in block["on"].items():
            acting = [(P, F) for name, P, F in parts if name == body]
            near(on["force"][k], sum(F for _, F in acting), c.force[k], READ)
            moment = sum(cross(P - on["point"][k], F) for P, F in acting)
            near(on["moment"][k], moment, c.force[k] * c.length, READ)


@pytest.mark.parametrize("seed", ALL)
def test_a_rope_keeps_its_length_or_the_work_done_on_it(seed: int) -> None:
    """All rows' rates vanish on the way; the energies add up."""
    c = roped(seed)
    stays = ropes(c.read)["rope"]
    for state in c.states:
        rows = assemble(c.read, state, 0.0)
        near(rows.J @ velocities(c.read, state), np.zeros(len(rows.J)), 10.0, 1e-10)
    given = c.scene["couplings"]["rope"]
    if "stiffness" not in given and not any(own.holds for own in stays):
        near([length(stays, state) for state in c.states], length(stays, c.states[0]), c.length, 1e-10)
    accuracy = c.study.results.accuracy
    assert accuracy["energy_drift"] <= 1e-8
    assert accuracy["balance_residual"] <= 1e-10
