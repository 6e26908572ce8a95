"""Certain sums in plain words."""

from __future__ import annotations

from typing import Any

import numpy as np

from heuncli.loads.redundancy.determinate_sums import find_factors
from heuncli.output.tables.indeterminate import make_sums_table
from heuncli.study.quantities.digits import StatedErrors
from tests.shared.fakes import pendulum

T = np.linspace(0.0, 2.0, 5)


def told(*sums: dict[str, Any]) -> tuple[str, ...]:
    table = make_sums_table(pendulum(T, certain_sums=list(sums)), StatedErrors({("reactions", "N"): 1e-9}, {}))
    assert table is not None
    return table.notes


def test_a_steady_sum() -> None:
    terms = {"joints.top.force.z": 1, "joints.bottom.force.z": 1}
    assert told({"terms": terms, "value": 49.05 + 0.0 * T}) == (
        "joints.top Fz + joints.bottom Fz = 49.05 N; distribution indeterminate",
    )


def test_two_that_are_equal() -> None:
    terms = {"joints.P0.force.x": 1, "joints.P5.force.x": -1}
    assert told({"terms": terms, "value": 0.0 * T}) == ("joints.P0 Fx = joints.P5 Fx; magnitude indeterminate",)


def test_one_that_varies_with_factors() -> None:
    terms = {"joints.a.force.x": -1, "sections.cut.N": 2, "joints.c.force.y": -0.5}
    assert told({"terms": terms, "value": 10.0 + T}) == (
        "−joints.a Fx + 2·sections.cut N − 0.5·joints.c Fy"
        " = 10.0 N first, 12.0 N last, 10.0 to 12.0 N over the output times; distribution indeterminate",
    )


def test_one_whose_factors_turn() -> None:
    terms = {"joints.a.force.x": np.cos(T + 0.5), "joints.a.force.y": -np.sin(T + 0.5)}
    assert told({"terms": terms, "value": 10.0 + 0.0 * T}) == (
        "0.8776(t)·joints.a Fx − 0.4794(t)·joints.a Fy = 10.0 N; distribution indeterminate",
        "(t): factor varies with position, shown for the first instant; all values: --format json",
    )


def test_moments_and_long_sums_are_left_to_json() -> None:
    long = {f"joints.j{i}.force.x": 1 for i in range(7)}
    moment = {"joints.a.moment.x": 1, "joints.b.moment.x": 1}
    assert told({"terms": long, "value": T}, {"terms": moment, "value": T}) == (
        "2 more in --format json (moments, or more than 6 terms)",
    )


def test_none() -> None:
    assert make_sums_table(pendulum(T), StatedErrors({}, {})) is None


def test_a_factor_that_rounding_made_is_zero() -> None:
    """Of c = a cos(t) + b sin(t), seen in self-stresses that are turned at random, what vanishes at 0 and at 90 deg."""
    rng = np.random.default_rng(3)
    angles = np.concatenate([[0.0, np.pi / 2], np.linspace(0.1, 1.4, 30)])
    wide, seen = np.array([cos_sin(angle) for angle in angles]), rng.standard_normal((2, 3))
    rows = np.stack([np.broadcast_to(seen[0], (32, 3)), np.broadcast_to(seen[1], (32, 3)), wide @ seen], axis=1)
    c = find_factors(rows)
    assert c is not None
    assert (c[:2] == 0.0).sum(axis=1).tolist() == [1, 1] and (c[2:] != 0.0).all()
    assert np.abs(c - np.column_stack([wide, -np.ones(32)]) / np.sqrt(2.0)).max() < 1e-14


def cos_sin(angle: float) -> tuple[float, float]:
    """Both at once; of a right angle the cosine is none, which np.cos does not say."""
    return float(np.cos(angle)) if angle != np.pi / 2 else 0.0, float(np.sin(angle))
