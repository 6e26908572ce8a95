"""Whether a surface crosses itself: on either side of what rounding does, and against separating planes."""

from __future__ import annotations

import math
from collections import Counter

import numpy as np
import pytest

from heuncli.base.errors import Finding
from heuncli.results.results import Array
from heuncli.scene.meshes.reading import read_closed_mesh
from tests.shared import triangles as t
from tests.shared.solids import rotation

UNIT = t.box()
DIGITS = 2.0**-21  # of the largest coordinate, here 2: eight steps of a float32


def verdict(*solids: Array) -> str:
    """ok, or the code with which these solids in one file are refused."""
    try:
        mesh = read_closed_mesh(t.obj(np.concatenate(solids)).encode(), "a.obj")
    except Finding as finding:
        return f"{finding.code}, touches" if "touches" in finding.message else finding.code
    assert mesh.shells == len(solids)
    return "ok"


def spindle(middle: object, ring: Array, height: float) -> Array:
    """Two pyramids on one base, a ring (n, 2) about z."""
    base = np.column_stack([ring, np.zeros(len(ring))])
    following = np.roll(base, -1, axis=0)
    up, down = (np.broadcast_to([0.0, 0.0, z], base.shape) for z in (height, -height))
    parts = [np.stack(three, axis=1) for three in ((base, following, up), (following, base, down))]
    return np.asarray(np.concatenate(parts) + np.array(middle, dtype=float))


def circle(n: int, radius: float) -> Array:
    a = 0.1 + 2.0 * np.pi * np.arange(n) / n
    return radius * np.column_stack([np.cos(a), np.sin(a)])


ROOF = t.prism(np.array([(0.0, 0.0), (-0.5, -0.7), (0.5, -0.7)]), [(0, 1, 2)], 2.0) - np.array([1.0, 0.0, 0.0])
UPSIDE = ROOF[:, :, [1, 0, 2]] * np.array([1.0, 1.0, -1.0])  # across it, its ridge below
TIP = t.tetrahedron(np.array([[0.4, 0.3, 1.0], [0.3, 0.2, 2.0], [0.6, 0.25, 2.0], [0.4, 0.6, 2.0]]))
NEAR = {  # one solid, and one above it that comes down; how deep in digits of the file it is found
    "ridge on ridge": (ROOF, UPSIDE, 3),
    "face on face": (UNIT, t.box([0.25, 0.25, 1.0], [0.75, 0.75, 2.0]), 3),
    "face on face at a rim": (UNIT, t.box([0.5, 0.25, 1.0], [1.5, 0.75, 2.0]), 3),
    "ring on face": (UNIT, spindle([0.7, 0.3, 1.2], circle(4, 0.2), 0.2), 3),
    "needle on face": (UNIT, TIP, 6),
}


@pytest.mark.parametrize("name", NEAR)
def test_what_touches_and_what_is_deeper_than_rounding(name: str) -> None:
    one, other, found = NEAR[name]
    near = DIGITS * max(float(np.abs(one).max()), float(np.abs(other).max()))
    for depth in (-1e3, -2.0, -0.5, 0.0, 0.5, 0.86):  # 4 sqrt(3)/8 of it: corners rounded twice
        assert verdict(one, other - [0.0, 0.0, depth * near]) == "ok", depth
    for depth in (found, 10.0, 1e3):
        assert verdict(one, other - [0.0, 0.0, depth * near]) == "mesh-crosses-itself", depth


@pytest.mark.parametrize("n", [3, 4, 12])
@pytest.mark.parametrize("middle", [(0.7, 0.3), (0.5, 0.5)])
def test_what_goes_through_a_face_with_its_corners_in_it(n: int, middle: tuple[float, float]) -> None:
    """No corner of it is near the face's rim, and none of its triangles lies on both sides of the face."""
    assert verdict(UNIT, spindle([*middle, 1.0], circle(n, 0.2), 0.2)) == "mesh-crosses-itself"


def test_what_stands_beside_with_flush_tops_at_an_edge_or_a_corner() -> None:
    for low, high in (
        ([1, 0.25, 0.25], [2, 0.75, 1]), ([1, 1, 0.25], [2, 2, 0.75]),
        ([1, 0.5, 1], [2, 1.5, 2]), ([1, 1, 1], [2, 2, 2]),
    ):  # fmt: skip
        assert verdict(UNIT, t.box(low, high)) == "ok", low
    assert verdict(UNIT, t.box([1, 1, 0], [2, 2, 1])) == "mesh-crosses-itself, touches"


def directions(solid: Array) -> tuple[Array, Array]:
    """Normals and edges of a convex solid."""
    edges = (np.roll(solid, -1, axis=1) - solid).reshape(-1, 3)
    return np.cross(solid[:, 1] - solid[:, 0], solid[:, 2] - solid[:, 0]), edges


def are_apart(a: Array, b: Array) -> bool:
    """Whether a plane along a face of either, or along an edge of each, has convex solids on either side."""
    (na, ea), (nb, eb) = directions(a), directions(b)
    for n in np.concatenate([na, nb, np.cross(ea[:, None], eb).reshape(-1, 3)]):
        one, other = a @ n, b @ n
        if n.any() and (one.max() <= other.min() or other.max() <= one.min()):
            return True
    return False


def solid(rng: np.random.Generator) -> Array:
    """A tetrahedron, box or spindle with its corners on a grid of few places."""
    while True:
        places = rng.integers(0, 5, (4, 3)).astype(float)
        low, high = places[:2].min(axis=0), places[:2].max(axis=0)
        match int(rng.integers(3)):
            case 0 if abs(np.linalg.det(places[1:] - places[0])) > 0.5:
                return t.tetrahedron(places)
            case 1 if (high > low).all():
                return t.box(low, high)
            case 2:
                square = np.array([(1, 0), (0, 1), (-1, 0), (0, -1)]) * float(rng.integers(1, 3))
                return np.asarray(np.roll(spindle(np.zeros(3), square, 1.0), int(rng.integers(3)), axis=2) + places[0])


@pytest.mark.parametrize("seed", range(3))
def test_two_solids_on_a_grid_are_refused_where_they_share_space(seed: int) -> None:
    """Corners, edges and faces lie in each other everywhere; also turned and rounded to float32."""
    rng = np.random.default_rng(seed)
    told: Counter[tuple[bool, str]] = Counter()
    for k in range(30):
        one, other = solid(rng), solid(rng)
        turn = rotation(rng) if k % 2 else np.eye(3)
        found = verdict(*((part @ turn.T + 0.1 * k).astype(np.float32).astype(float) for part in (one, other)))
        told[are_apart(one, other), found] += 1
    assert told[True, "ok"] > 6 and told[False, "mesh-crosses-itself"] > 6
    assert not told[False, "ok"] and not told[True, "mesh-crosses-itself"], told


@pytest.mark.parametrize("seed", range(3))
def test_slivers_that_rounding_turns_over_are_no_crossing(seed: int) -> None:
    rng = np.random.default_rng(seed)
    for k in range(12):
        along = np.sort(rng.uniform(0.0, 1.0, 6))
        off = 10.0 ** rng.uniform(-9.0, -5.0) * np.abs(rng.normal(size=6))
        outline = np.array([(0, 0), *zip(along, -off, strict=True), (1, 0), (1, 1), (0, 1)])
        cap = [(0, i, i + 1) for i in range(1, len(outline) - 1)]
        body = t.prism(outline, cap, 1.0) @ rotation(rng).T + rng.normal(size=3) * (k % 3)
        assert math.isclose(read_closed_mesh(t.binary_stl(body), "a.stl").volume, 1.0, rel_tol=1e-4)


def test_triangles_narrower_than_the_digits_are_refused() -> None:
    """Far off, a tube of so fine facets is none of which a crossing is seen; near its origin it is read."""
    tube = t.cylinder(300, 0.5, 1.0, 0.3)
    assert verdict(tube) == "ok" == verdict(tube + 100.0)
    assert verdict(tube + 1e5) == "mesh-file"
