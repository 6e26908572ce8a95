"""Attitudes as quaternions: the rotation matrices', in every joint, and without jumps."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from heuncli.scene.file_format.load import load
from heuncli.study.model.options import Options
from heuncli.study.workflow import solve
from tests.shared.scenes import solved

SPECS = sorted((Path(__file__).parents[2] / "specs").glob("*.yaml"))
MOTION = Options(requested_reports=frozenset({"motion"}))


def rotation(q: np.ndarray) -> np.ndarray:
    """R = 1 + 2 w hat(v) + 2 hat(v)^2 of unit quaternions (n, 4)."""
    w, x, y, z = q.T
    O = np.zeros_like(w)
    hat = np.array([[O, -z, y], [z, O, -x], [-y, x, O]]).transpose(2, 0, 1)
    return np.eye(3) + 2.0 * w[:, None, None] * hat + 2.0 * hat @ hat


def cayley(kappa: np.ndarray, R: np.ndarray) -> np.ndarray:
    """R (1 - hat(kappa)) - (1 + hat(kappa)) over 1 + |kappa|, where there is a kappa; (n, 3, 3)."""
    told = np.isfinite(kappa).all(axis=1)
    x, y, z = kappa[told].T
    O = np.zeros_like(x)
    hat = np.array([[O, -z, y], [z, O, -x], [-y, x, O]]).transpose(2, 0, 1)
    return (R[told] @ (np.eye(3) - hat) - (np.eye(3) + hat)) / (1.0 + np.abs(kappa[told]).max(axis=1))[:, None, None]


def test_rodrigues_numbers_as_typed() -> None:
    """They are those that an orientation is given by, and at half a turn there are none."""
    body = "{mass: 1, center: [0, 0, 0], inertia: [1, 2, 3], orientation: {rodrigues: [0.3, -0.7, 2.5]}}"
    turned = "{mass: 1, center: [0, 0, 0], inertia: [1, 2, 3], orientation: {axis: [1, 2, 2], angle: 180 deg}}"
    found = solved(f"heun: 1\nbodies: {{given: {body}, turned: {turned}}}\n").bodies
    np.testing.assert_allclose(found["given"]["rodrigues"], [[0.3, -0.7, 2.5]], rtol=0, atol=1e-14)
    assert np.isnan(found["turned"]["rodrigues"]).all()


@pytest.mark.heavy
@pytest.mark.parametrize("path", SPECS, ids=lambda path: path.stem)
@pytest.mark.third
def test_they_are_the_rotations_and_go_on(path: Path) -> None:
    study = solve(load(str(path)), MOTION)
    results = study.resample(study.search_times) if len(study.results.time) > 1 else study.results
    for body in results.bodies.values():
        q = body["quaternion"]
        np.testing.assert_allclose(np.sum(q * q, axis=1), 1.0, rtol=1e-15)
        np.testing.assert_allclose(rotation(q), body["rotation"], atol=1e-13)
        np.testing.assert_allclose(cayley(body["rodrigues"], body["rotation"]), 0.0, atol=1e-12)
        assert np.all(np.sum(q[1:] * q[:-1], axis=1) > 0.5)  # less than 120 degrees between two instants
    first = [body["quaternion"][0, 0] for body in study.results.bodies.values()]
    assert min(first) >= -1e-12


ROTOR = """
heun: 1
bodies:
  rotor: {{mass: 1, center: [0, 0, 0], inertia: [1, 1, 2], {start}}}
joints: {{{joint}}}
{drives}
analysis: {{times: [{times}]}}
"""


def turned(tmp_path: Path, times: str, *, start: str = "", joint: str = "", drives: str = "") -> np.ndarray:
    spec = tmp_path / "rotor.yaml"
    spec.write_text(ROTOR.format(start=start, joint=joint, drives=drives, times=times))
    found = solve(load(str(spec)), MOTION).results.bodies["rotor"]["quaternion"]
    assert isinstance(found, np.ndarray)
    return found


PIN = "shaft: {type: pin, from: {body: ground, at: [0, 0, 0]}, to: {body: rotor, at: [0, 0, 0]}, axis: [0, 0, 1]}"
HINGED = {"joint": PIN, "drives": 'drives: {motor: {joint: shaft, angle: "6*t"}}'}
FREE = {"start": "angular_velocity: [0, 0, 6]"}


@pytest.mark.parametrize("how", [HINGED, FREE], ids=["driven on a pin", "free"])
def test_a_rotor_turns_through_720_degrees(tmp_path: Path, how: dict[str, str]) -> None:
    """cos 3t, sin 3t: at one asked instant as among many, however far apart."""
    t = np.array([0.0, 0.9, 1.1, 2.0, 2.1])
    expected = np.stack([np.cos(3.0 * t), 0.0 * t, 0.0 * t, np.sin(3.0 * t)], axis=1)
    np.testing.assert_allclose(turned(tmp_path, ", ".join(map(str, t)), **how), expected, atol=1e-8)
    np.testing.assert_allclose(turned(tmp_path, "0, 2.1", **how), expected[[0, -1]], atol=1e-8)


def test_half_a_turn_at_the_start_is_positive(tmp_path: Path) -> None:
    start = "orientation: {axis: [0, 0, -1], angle: 180 deg}"
    np.testing.assert_allclose(turned(tmp_path, "0, 1", start=start)[:1], [[0.0, 0.0, 0.0, 1.0]], atol=1e-15)
    start = "orientation: {axis: [0, 0, 1], angle: 300 deg}"
    half = np.deg2rad(30.0)
    expected = [[np.cos(half), 0.0, 0.0, -np.sin(half)]]
    np.testing.assert_allclose(turned(tmp_path, "0, 1", start=start)[:1], expected, atol=1e-15)
