"""Coordinates that tell a motion hardly, states that rest to rounding, and turns that are nearly half a turn."""

from __future__ import annotations

import numpy as np

from heuncli.analyses.lagrange.coordinates import require_independent
from heuncli.analyses.lagrange.state_space import drop_rounding
from heuncli.base.errors import SolveError
from heuncli.loads.kinetostatics.coordinates import find_rodrigues_vectors
from tests.honesty.boundaries.part import Part, Row


def told(x: float) -> str:
    """Two motions of which the second coordinate sees an x-th part."""
    rates = {"a.angle": np.array([1.0, 0.0]), "b.angle": np.array([0.0, 1.0 / x]), "c.angle": np.array([0.0, 1.0])}
    try:
        require_independent(["a.angle", "b.angle"], np.array([rates["a.angle"], rates["b.angle"]]), 2, rates)
    except SolveError as error:
        assert "b.angle cannot describe" in str(error) and "c.angle moves" in str(error)
        return "refused"
    return "told"


def rests(x: float) -> str:
    """An acceleration of x rad/s^2 in a scene of a metre."""
    return "moves" if drop_rounding(np.array([x]), 1.0).any() else "rests"


def vector(x: float) -> str:
    """A turn whose quaternion has the scalar part x."""
    return "none" if np.isnan(find_rodrigues_vectors(np.array([x, 0.0, 0.0, 1.0]))).all() else "told"


PART = Part(
    headings=("coordinates of Lagrange's equations",),
    rows=(
        Row("COORDINATE_RATIO", told, "told", "refused"),
        Row("NO_OFFSET", rests, "rests", "moves"),
        Row("HALF_TURN", vector, "none", "told"),
    ),
)
