"""The rows of every joint kind (manual/theory.md, "Joints as rows") against differences: gaps, rates, accelerations."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

from heuncli.multibody.assembly.conditions import JointCondition, joint_conditions
from heuncli.multibody.assembly.rows import Rows, acceleration_rows, pose_rows, rate_residuals, rate_rows
from heuncli.scene.shapes.rotations import rotation_from_vector
from tests.shared.drafted_mechanisms import body, in_time, joint, scene

KINDS = ("ball", "pin", "universal", "cv", "weld", "slide", "cylinder", "line", "plane", "rod")
GIVEN = {"pin": {"angle": 0.7}, "slide": {"travel": 0.3}, "cylinder": {"angle": -0.4, "travel": 0.2}}


def demand(kind: str, t: float = 0.0, **given: Any) -> JointCondition:
    if kind == "rod":
        given["length"] = 1.3
    if kind == "universal":
        given["to_axis"] = (0.2, 1.0, -0.4)
    s = scene(
        [body("a"), body("b")],
        [joint("j", kind, "a", (0.3, -0.2, 0.5), "b", (-0.4, 0.1, 0.2), (0.3, 0.5, -0.8), **given)],
    )
    return joint_conditions(s, t)[0]


def moved(x: Any, R: Any, v: Any, w: Any, dt: float) -> tuple[Any, Any]:
    return x + dt * v, np.array([rotation_from_vector(dt * wi) @ Ri for wi, Ri in zip(w, R, strict=True)])


def lacking(row: Rows) -> Any:
    return np.concatenate([row.hold, row.turn])


@pytest.mark.parametrize("given", [False, True])
@pytest.mark.parametrize("kind", KINDS)
def test_gaps_change_as_the_rows_say_however_large_they_are(kind: str, given: bool) -> None:
    rng = np.random.default_rng(3)
    d = demand(kind, **(GIVEN.get(kind, {}) if given else {}))
    for _ in range(5):
        x, v, w = rng.normal(size=(3, 3, 3))
        R = np.array([rotation_from_vector(a) for a in rng.normal(size=(3, 3))])
        row = pose_rows(d, x, R, x)  # pivots: the origins
        h = 1e-6
        gaps = [lacking(pose_rows(d, *pose, pose[0])) for pose in (moved(x, R, v, w, h), moved(x, R, v, w, -h))]
        zero = Rows(row.F, row.T, np.zeros(len(row.F)), np.zeros(len(row.T)), row.r_a, row.r_b)
        speed = -np.concatenate(rate_residuals(d, zero, v, w))
        assert (gaps[1] - gaps[0]) / (2 * h) == pytest.approx(speed, abs=2e-8)


def closed(d: JointCondition, rng: np.random.Generator) -> tuple[Any, Any]:
    """A random pose in which the joint is closed, found by a few Newton steps on its own rows."""
    x = rng.normal(size=(3, 3))
    R = np.array([rotation_from_vector(a) for a in rng.normal(size=(3, 3))])
    for _ in range(40):
        row = pose_rows(d, x, R, x)
        R[1] = rotation_from_vector(np.clip(np.linalg.pinv(row.T) @ row.turn, -0.3, 0.3)) @ R[1] if len(row.T) else R[1]
        x[1] += row.F.T @ pose_rows(d, x, R, x).hold
    assert np.max(np.abs(lacking(pose_rows(d, x, R, x))), initial=0.0) < 1e-14
    return x, R


DRIVES = {
    "pin": ("angle", "0.7 + 0.5*t + 0.3*t**2"),
    "slide": ("travel", "0.3 - 0.4*t + 0.6*t**2"),
    "cylinder": ("travel", "0.2 + 0.9*t - 0.2*t**2"),
    "rod": ("length", "1.3 - 0.8*t + 0.5*t**2"),
}


@pytest.mark.parametrize(("kind", "driven"), [*((k, False) for k in KINDS if k != "cv"), *((k, True) for k in DRIVES)])
def test_accelerations_are_the_second_derivative_of_closed_gaps(kind: str, driven: bool) -> None:
    """Along rates that fit, moved on with accelerations a, the gap grows as (F a_u + T a_σ − right side) dt²/2."""
    rng = np.random.default_rng(5)
    given = {"drive": (DRIVES[kind][0], in_time(DRIVES[kind][1]))} if driven else {}
    d = demand(kind, **given)
    for _ in range(5):
        x, R = closed(d, rng)
        v, w, a, b = rng.normal(size=(4, 3, 3))
        row = rate_rows(d, x, R, x)
        if len(row.T):
            w[1] += np.linalg.pinv(row.T) @ rate_residuals(d, row, v, w)[1]
        v[1] += row.F.T @ rate_residuals(d, row, v, w)[0]
        assert np.max(np.abs(np.concatenate(rate_residuals(d, row, v, w)))) < 1e-14
        asked = acceleration_rows(d, row, x, R, v, w)
        grown = -np.concatenate(rate_residuals(d, asked, a, b))
        h = 1e-4
        gaps = []
        for t in (h, 0.0, -h):
            pose = onward(x, R, v, w, a, b, t)
            gaps.append(-lacking(pose_rows(demand(kind, t, **given), *pose, pose[0])))
        assert (gaps[0] - gaps[2]) / (2 * h) == pytest.approx(np.zeros(len(grown)), abs=1e-7)
        assert (gaps[0] - 2 * gaps[1] + gaps[2]) / h**2 == pytest.approx(grown, abs=2e-6)


def test_shafts_that_turn_alike_have_no_gap_and_accelerate_as_their_rates_grow() -> None:
    """Any pose is in mesh: so the acceleration rows against differences of what the rates lack."""
    rng = np.random.default_rng(6)
    d = demand("cv", to_axis=(0.2, 1.0, -0.4))
    for _ in range(5):
        x, R = closed(d, rng)
        v, w, a, b = rng.normal(size=(4, 3, 3))
        row = rate_rows(d, x, R, x)
        w[1] += np.linalg.pinv(row.T) @ rate_residuals(d, row, v, w)[1]
        grown = -rate_residuals(d, acceleration_rows(d, row, x, R, v, w), a, b)[1]
        lacks = []
        for t in (1e-5, -1e-5):
            moved_on = onward(x, R, v, w, a, b, t)
            lacks.append(rate_residuals(d, rate_rows(d, *moved_on, moved_on[0]), v + a * t, w + b * t)[1])
        assert (lacks[1] - lacks[0]) / 2e-5 == pytest.approx(grown, abs=1e-8)


def onward(x: Any, R: Any, v: Any, w: Any, a: Any, b: Any, t: float) -> tuple[Any, Any]:
    """Poses after t, for constant accelerations a, b: R' = hat(w + b t) R solved to t³."""
    turns = w * t + b * t * t / 2 + np.cross(b, w) * t**3 / 12
    return x + v * t + a * t * t / 2, np.array(
        [rotation_from_vector(turn) @ Ri for turn, Ri in zip(turns, R, strict=True)]
    )
