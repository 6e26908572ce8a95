"""How far explicit methods are stable, from their tableaus."""

from __future__ import annotations

import numpy as np
import pytest

from heuncli.base.method_rows import METHODS
from heuncli.motion.integration.methods.method import Method, load_method_by_name

WATCHED = [m for m in (load_method_by_name(row.name) for row in METHODS if row.kind == "explicit") if m.stable]


def growth(method: Method, x: float) -> float:
    """|R(-x)|: by what factor a step of x/lambda multiplies exp(-lambda t)."""
    K: list[float] = []
    for row in ((), *method.stages):
        K.append(-x * (1.0 + sum(c * K[stage] for stage, c in row)))
    return abs(1.0 + sum(c * K[stage] for stage, c in method.solution))


@pytest.mark.parametrize("method", WATCHED, ids=lambda m: m.name)
def test_boundary_of_stability(method: Method) -> None:
    """Up to `stable` everything that decays decays, and just beyond it does not; two digits are told."""
    inside = np.linspace(0.01, 0.998 * method.stable, 200)
    assert max(growth(method, float(x)) for x in inside) < 1.0
    assert growth(method, 1.005 * method.stable) > 1.0


def test_every_adaptive_explicit_method_is_watched() -> None:
    explicit = [row.name for row in METHODS if row.kind == "explicit" and row.steps == "adaptive"]
    assert {m.name for m in WATCHED} >= {name for name in explicit if load_method_by_name(name).attitude == 0}
