"""Load cases of bodies that couplings load: all that a coupling exerts is there under its name."""

from __future__ import annotations

import numpy as np

import heuncli
from tests.shared.folders import SPECS


def test_a_belt_s_strands_and_its_pretension() -> None:
    """What the strands exert ON the fan: their pull along both, as the belt's tension tells it, and its moment."""
    found = heuncli.solve(SPECS / "belt_drive.yaml", at=[0.6])
    (case,) = found.load_cases("fan", at="last").cases
    own = [action for action in case.actions if action.name == "belt"]
    assert {action.kind for action in own} == {"coupling"}
    tight, slack = (float(found[f"couplings.belt.{name}"].values[-1]) for name in ("tight", "slack"))
    sine = (0.1 - 0.04) / 0.6
    rotation = np.array(found["bodies.fan.rotation"].values[-1])
    force = rotation @ sum(np.array(action.force) for action in own)
    moment = sum(np.array(a.moment) + np.cross(a.at, a.force) for a in own)
    pull = [-(tight + slack) * np.sqrt(1.0 - sine**2), (slack - tight) * sine, 0.0]
    np.testing.assert_allclose(force, pull, rtol=0, atol=1e-9 * tight)
    np.testing.assert_allclose(moment, [0.0, 0.0, 0.1 * (tight - slack)], rtol=0, atol=1e-9 * tight)
