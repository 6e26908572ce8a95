"""Clouds of mass points against closed forms (manual/theory.md, "Mass properties") and against themselves."""

from __future__ import annotations

import numpy as np
import pytest

from tests.oracle.masses import Plane, cloud, cut, gathered, mass_of, moved, without
from tests.oracle.turns import random_rotation, random_unit

PI = np.pi
ROUND = {"type": "cylinder", "from": [0, 0, 0], "to": [0, 0, 0.8], "radius": 0.3, "inner_radius": 0.1, "density": 2.0}
SHAPES = {
    "rod": {"type": "rod", "from": [0.1, -0.2, 0.3], "to": [1.0, 0.4, -0.2], "line_density": 3.0},
    "tube": {
        "type": "cylinder",
        "from": [0.1, 0, 0.2],
        "to": [0.9, 0.5, -0.3],
        "radius": 0.3,
        "inner_radius": 0.1,
        "density": 2.0,
    },
    "cone": {
        "type": "cone",
        "from": [0.1, 0, 0.2],
        "to": [0.9, 0.5, -0.3],
        "radius": 0.3,
        "to_radius": 0.0,
        "mass": 2.0,
    },
    "frustum": {"type": "cone", "from": [0, 0, 0], "to": [0, 0, 1.0], "radius": 0.1, "to_radius": 0.5, "density": 2.0},
    "box": {
        "type": "box",
        "center": [0.1, 0.2, 0.3],
        "size": [1, 0.5, 0.2],
        "density": 7.0,
        "orientation": {"axis": [1, 2, 3], "angle": 0.7},
    },
    "sphere": {"type": "sphere", "center": [0.1, 0.2, 0.3], "radius": 0.4, "mass": 5.0},
}


def close(a: object, b: object, tolerance: float = 1e-14) -> None:
    np.testing.assert_allclose(np.asarray(a), np.asarray(b), rtol=tolerance, atol=tolerance)


def test_tube() -> None:
    m = mass_of({"shapes": [ROUND]})
    expected = 2.0 * PI * (0.3**2 - 0.1**2) * 0.8
    squares = 0.3**2 + 0.1**2
    across = expected * (squares / 4 + 0.8**2 / 12)
    close(m.mass, expected)
    close(m.center, [0, 0, 0.4])
    close(m.inertia, np.diag([across, across, expected * squares / 2]))


def test_frustum() -> None:
    a, b, length = 0.1, 0.5, 1.0
    m = mass_of({"shapes": [SHAPES["frustum"]]})
    spin = 2 * PI * length / 10 * (a**4 + a**3 * b + a * a * b * b + a * b**3 + b**4)
    base = spin / 2 + 2 * PI * length**3 * (a * a + 3 * a * b + 6 * b * b) / 30
    close(m.mass, 2 * PI * length * (a * a + a * b + b * b) / 3)
    close(m.mass * m.center[2], 2 * PI * length**2 * (a * a + 2 * a * b + 3 * b * b) / 12)
    close(moved(m, np.zeros(3)), np.diag([base, base, spin]))


def test_box() -> None:
    m = mass_of({"shapes": [{"type": "box", "center": [1, 2, 3], "size": [1, 0.5, 0.2], "mass": 6.0}]})
    close(m.center, [1, 2, 3])
    close(m.inertia, np.diag([0.25 + 0.04, 1 + 0.04, 1 + 0.25]) * 6 / 12)


@pytest.mark.parametrize("h", [-0.39, -0.1, 0.0, 0.2, 0.399])
def test_sphere_cut_at_a_height(h: float) -> None:
    R, density = 0.4, 3.0
    body = {"shapes": [{"type": "sphere", "center": [0, 0, 0], "radius": R, "density": density}]}
    m = cut(body, Plane(np.array([0, 0, h]), np.array([0, 0, 1.0])))[1]
    spin = density * PI / 2 * (8 * R**5 / 15 - R**4 * h + 2 * R**2 * h**3 / 3 - h**5 / 5)
    high = density * PI * (2 * R**5 / 15 - R**2 * h**3 / 3 + h**5 / 5)
    close(m.mass, density * PI * (R - h) ** 2 * (2 * R + h) / 3)
    close(m.center, [0, 0, 3 * (R + h) ** 2 / (4 * (2 * R + h))])
    close(moved(m, np.zeros(3)), np.diag([spin / 2 + high, spin / 2 + high, spin]), 1e-13)


@pytest.mark.parametrize("name", SHAPES)
def test_two_parts_make_the_whole_whatever_the_plane(name: str) -> None:
    rng = np.random.default_rng(1)
    body = {"shapes": [SHAPES[name]]}
    whole = mass_of(body)
    for _ in range(20):
        plane = Plane(whole.center + 0.2 * rng.standard_normal(3), random_unit(rng))
        remainder, piece = cut(body, plane)
        close(remainder.mass + piece.mass, whole.mass)
        close(remainder.mass * remainder.center + piece.mass * piece.center, whole.mass * whole.center)
        close(moved(remainder, whole.center) + moved(piece, whole.center), whole.inertia)
        if piece.mass < 0.999 * whole.mass:
            left = without(whole, piece)
            close(left.center, remainder.center, 1e-11)
            close(left.inertia, remainder.inertia, 1e-11)


@pytest.mark.parametrize("name", ["tube", "cone", "frustum", "box", "sphere"])
def test_oblique_piece_against_sampling(name: str) -> None:
    """Low-discrepancy points in a cube around the solid, to the sampling's error."""
    from scipy.stats import qmc

    shape = SHAPES[name]
    rng = np.random.default_rng(7)
    X, w = cloud(shape)
    middle = (w @ X) / w.sum()
    plane = Plane(middle + 0.03 * rng.standard_normal(3), random_unit(rng))
    x = middle - 0.75 + 1.5 * qmc.Sobol(3, seed=3).random_base2(19)
    inside = {"box": in_box, "sphere": in_sphere}.get(name, in_round)(shape, x)
    piece = gathered([cloud(shape, plane)])
    whole = mass_of({"shapes": [shape]})
    beyond = inside & ((x - plane.at) @ plane.normal > 0)
    noise = 1.0 / np.sqrt(inside.sum())
    assert beyond.sum() / inside.sum() == pytest.approx(piece.mass / whole.mass, abs=noise)
    np.testing.assert_allclose(x[beyond].mean(axis=0), piece.center, rtol=0, atol=0.5 * noise)
    A = x[beyond] - piece.center
    T = piece.mass * (A.T @ A) / len(A)
    sampled, size = np.trace(T) * np.eye(3) - T, np.linalg.norm(piece.inertia)
    np.testing.assert_allclose(sampled, piece.inertia, rtol=0, atol=2 * noise * size)


def in_round(shape: dict, x: np.ndarray) -> np.ndarray:
    a, b = np.array(shape["from"]), np.array(shape["to"])
    length = np.linalg.norm(b - a)
    z = (x - a) @ (b - a) / length
    r = np.linalg.norm(x - a - z[:, None] * (b - a) / length, axis=1)
    rim = shape["radius"] + z / length * (shape.get("to_radius", shape["radius"]) - shape["radius"])
    return (z > 0) & (z < length) & (r < rim) & (r > shape.get("inner_radius", 0.0))


def in_box(shape: dict, x: np.ndarray) -> np.ndarray:
    from tests.oracle.turns import attitude

    local = (x - np.array(shape["center"])) @ attitude(shape["orientation"])
    return np.all(np.abs(local) < np.array(shape["size"]) / 2, axis=1)


def in_sphere(shape: dict, x: np.ndarray) -> np.ndarray:
    return np.linalg.norm(x - np.array(shape["center"]), axis=1) < shape["radius"]


def test_a_turned_body_has_turned_inertia() -> None:
    rng = np.random.default_rng(5)
    Q = random_rotation(rng)
    shape = SHAPES["tube"]
    turned = {**shape, "from": (Q @ shape["from"]).tolist(), "to": (Q @ shape["to"]).tolist()}
    close(mass_of({"shapes": [turned]}).inertia, Q @ mass_of({"shapes": [shape]}).inertia @ Q.T)


def test_deviation_is_minus_the_tensor_element() -> None:
    m = mass_of({"mass": 1.0, "inertia": [1, 2, 2.5], "deviation": [0.1, 0.2, 0.3]})
    close(m.inertia, [[1, -0.3, -0.2], [-0.3, 2, -0.1], [-0.2, -0.1, 2.5]])


def test_a_point_in_the_plane_needs_a_side() -> None:
    body = {"shapes": [{"type": "point", "at": [0, 0, 1], "mass": 2.0}, SHAPES["frustum"]]}
    plane = Plane(np.array([0, 0, 1.0]), np.array([0, 0, 1.0]))
    with pytest.raises(ValueError, match="side"):
        cut(body, plane)
    assert cut(body, plane._replace(side="before"))[1].mass == pytest.approx(2.0, rel=1e-14)
    assert cut(body, plane._replace(side="beyond"))[1].mass == 0.0
