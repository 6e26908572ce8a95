"""Redundant supports and singular poses: the numbers of manual/theory.md, "Redundancy"."""

from __future__ import annotations

import numpy as np
import pytest

from tests.oracle.published import beam, four_bar, held
from tests.oracle.read import model, start_state
from tests.oracle.rows import assemble
from tests.oracle.solve import solve


def test_door_on_two_balls() -> None:
    s = held(
        {"top": [-0.4, 0, 0.9], "bottom": [-0.4, 0, -0.7]},
        {"type": "ball"},
        {"position": [0.4, 0, 0], "velocity": [0, 0.4 * 2.3, 0], "angular_velocity": [0, 0, 2.3]},
    )
    found = solve(s, start_state(s))
    assert (found.rank, found.rows, found.freedoms, found.grubler) == (5, 6, 1, 0)
    for name in ("top", "bottom"):
        assert found.reactions[name].unique[:3].tolist() == [True, True, False]
        assert found.reactions[name].force[2] == pytest.approx(24.525, rel=1e-13)
    value, certain = found.sum({"joints.top.force.z": 1, "joints.bottom.force.z": 1})
    assert certain and value == pytest.approx(49.05, rel=1e-14)
    assert not found.sum({"joints.top.force.z": 1, "joints.bottom.force.z": -1})[1]
    share = np.concatenate([found.reactions[n].share[:3, 0] for n in ("top", "bottom")])
    np.testing.assert_allclose(share / share[2], [0, 0, 1, 0, 0, -1], rtol=0, atol=1e-14)


def test_three_balls() -> None:
    s = held({"a": [0, 0, 0], "b": [1, 0, 0], "c": [0.3, 0.8, 0]}, {"type": "ball"})
    found = solve(s, start_state(s))
    assert (found.rank, found.rows) == (6, 9)
    for reaction in found.reactions.values():
        assert reaction.unique[:3].tolist() == [False, False, True]


def test_four_parallel_hinges() -> None:
    s = four_bar(1.0, 0.0, 1.0, (1, 2, 1, 2), (0.7, 0.0, 0.7))
    found = solve(s, start_state(s))
    assert (found.rank, found.rows, found.freedoms, found.grubler) == (17, 20, 1, -2)
    for reaction in found.reactions.values():
        assert reaction.unique[:3].tolist() == [True, True, False]
        assert not reaction.unique[3:5].any()


@pytest.mark.parametrize(("rates", "residual"), [((1, 1), 0.0), ((1, -3), 0.0), ((1, 2), 2.5)])
def test_flat_parallelogram(rates: tuple[float, float], residual: float) -> None:
    """In line, (φ̇ − ψ̇)(3φ̇ + ψ̇) = 0 must hold: rates that pass at first order may still have no acceleration."""
    s = four_bar(0.0, 0.0, 0.0, (1, 2, 1, 2), (rates[0], (rates[1] - rates[0]) / 2, rates[1]))
    found = solve(s, start_state(s))
    assert (found.rank, found.freedoms) == (16, 2)
    assert (found.residual > 0.1) == (residual > 0.0)
    rows = assemble(model(s), start_state(s), 0.0)
    V_dot = np.concatenate([[*found.acceleration[b], *found.angular_acceleration[b]] for b in s["bodies"]])
    assert np.abs(rows.J @ V_dot + rows.gamma).sum() == pytest.approx(residual, abs=1e-13)  # how far C misses itself
    for reaction in found.reactions.values():
        assert reaction.unique[:2].tolist() == [False, True]


@pytest.mark.parametrize(
    ("stiffness", "split"),
    [
        (None, (3.714285714286, 3.428571428571, 2.857142857143)),
        ((1.0, 2.0, 1.0), (2.631578947368, 5.052631578947, 2.315789473684)),
    ],
)
def test_beam_on_three_supports(stiffness: tuple[float, ...] | None, split: tuple[float, ...]) -> None:
    s = beam()
    weights = None if stiffness is None else dict(zip("abc", ((k, 1.0) for k in stiffness), strict=True))
    found = solve(s, start_state(s), stiffness=weights)
    np.testing.assert_allclose([found.reactions[j].force[2] for j in "abc"], split, rtol=0, atol=6e-13)
    assert not any(found.reactions[j].unique[2] for j in "abc")
    assert found.sum({f"joints.{j}.force.z": 1 for j in "abc"})[1]


def test_a_moment_about_a_thin_rod_is_told() -> None:
    """manual/theory.md, "Thin rods": a couple about the axis of a rod without inertia there has no acceleration."""
    rod = {"shapes": [{"type": "rod", "from": [0, 0, 0], "to": [1, 0, 0], "mass": 1.0}], "points": {"root": [0, 0, 0]}}
    s = {
        "ground": {"points": {"O": [0, 0, 0]}},
        "bodies": {"rod": rod},
        "joints": {"root": {"type": "ball", "from": "ground.O", "to": "rod.root"}},
        "forces": {"twist": {"type": "couple", "on": "rod", "vector": [1.0, 0, 0]}},
    }
    assert solve(s, start_state(s)).unbalanced > 0.1
    s["forces"]["twist"]["vector"] = [0.0, 1.0, 0]
    assert solve(s, start_state(s)).unbalanced < 1e-14
