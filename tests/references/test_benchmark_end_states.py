"""The benchmark scenes against end states in quadruple precision (end_states.json names the source)."""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np
import pytest

from tests.shared.bars import BENCHMARKS
from tests.shared.scenes import near, solved

END_STATES = json.loads((Path(__file__).parent / "end_states.json").read_text(encoding="utf-8"))


@pytest.mark.parametrize("name", ["double", "top", pytest.param("chain10", marks=pytest.mark.heavy)])
def test_end_state(name: str) -> None:
    """Centres to 1e-11 m at tolerance 1e-12; attitudes and rates alike, relative to their size."""
    end = END_STATES[name]
    found = solved(BENCHMARKS[name](f"{{times: [{end['time']}], tolerance: 1e-12}}")).bodies
    for body, center in end["center"].items():
        near(found[body]["center"][-1], center, 1.0, 1e-11)
        R = np.array(end["rotation"][body]).reshape(3, 3)
        near(found[body]["rotation"][-1], R, 1.0, 1e-10)
        spin = np.array(end["angular_velocity_body"][body])
        near(found[body]["rotation"][-1].T @ found[body]["angular_velocity"][-1], spin, 1.0 + np.abs(spin).max(), 1e-10)
