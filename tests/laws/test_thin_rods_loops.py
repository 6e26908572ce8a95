"""Closed chains of thin rods: what holds their spin may be any joint of the loop, also one that was cut."""

from __future__ import annotations

from itertools import product

import numpy as np
import pytest
from scipy.integrate import solve_ivp

from heuncli.base.errors import SolveError
from tests.shared.parallelogram import parallelogram
from tests.shared.scenes import near, solved, study

KINDS = list(product(("pin", "ball"), repeat=4))


@pytest.mark.parametrize("kinds", KINDS, ids=["-".join(kinds) for kinds in KINDS])
def test_all_move_alike(kinds: tuple[str, ...]) -> None:
    """In the plane a ball is a pin; the bars turn by (2/3 + 1) theta'' = 2 g sin(theta)."""
    swing = solve_ivp(lambda t, y: [y[1], 1.2 * 9.81 * np.sin(y[0])], (0, 0.5), [0.0, 1.0], rtol=1e-12, atol=1e-12,
                      t_eval=[0.0, 0.25, 0.5], method="DOP853").y  # fmt: skip
    found = study(parallelogram(1.0, 0.5, 3, kinds))
    top = found.results.points["left.top"]["position"]
    near(top, np.stack([np.sin(swing[0]), np.cos(swing[0]), 0 * swing[0]], axis=1), 1.0, 1e-8)
    near(found.results.points["right.top"]["position"] - top, np.tile([1.0, 0.0, 0.0], (3, 1)), 1.0, 1e-8)
    pins = kinds.count("pin")
    assert found.results.model["redundant"] == {4: 3, 3: 1}.get(pins, 0)


PIN = """
heun: 1
ground: {points: {O: [0, 0, 0]}}
bodies: {b: {shapes: [{type: rod, from: [0, 0, 0], to: [0, 0, -1], mass: 1}], points: {o: [0, 0, 0]}}}
joints: {A: {type: pin, from: ground.O, to: b.o, axis: [0, 0, 1]}}
"""


def test_a_spin_with_nothing_behind_is_refused_at_once() -> None:
    """A pin along a thin rod: no acceleration of its angle exists, so none is given, and no run is begun."""
    with pytest.raises(SolveError, match=r"bodies\.b has no inertia about its axis \(0, 0, 1\)"):
        solved(PIN + "analysis: {duration: 1000, samples: 3}")
    driven = solved(PIN + "drives: {m: {joint: A, angle: 3*t}}\nanalysis: {duration: 1, samples: 3}")
    near(driven.joints["A"]["drive"], 0.0, 1.0, 1e-15)
