"""Random chains of bodies without inertia about their own axes, as the oracle's dicts."""

from __future__ import annotations

from typing import Any

import numpy as np

from tests.oracle.read import Placed
from tests.oracle.scenes import random_scene


def thin_rods(seed: int) -> tuple[dict[str, Any], dict[str, Placed]]:
    """Several rods on balls at and near their axes' points, all forces on the axes."""
    rng = np.random.default_rng(seed)
    loads = ("force", "spring", "actuator")
    return random_scene(rng, int(rng.integers(2, 6)), kinds=("ball",), masses="thin", loads=loads)
