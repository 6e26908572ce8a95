"""From where machines are seen: orthonormal, right-handed, up against gravity, with words that say so."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from heuncli.base.errors import Finding
from heuncli.output.figures.scenes import make_assembly_figure
from heuncli.output.machine_geometry.views import (
    SceneView,
    format_direction,
    make_view_along,
    make_view_at_angles,
    parse_view,
)
from heuncli.scene.file_format.load import load

SPECS = Path(__file__).parents[2] / "specs"
DOWN = np.array([0.0, 0.0, -9.81])
NONE = np.zeros(3)


def views(seed: int) -> list[SceneView]:
    """Some of every kind."""
    random = np.random.default_rng(seed)
    gravity = random.choice([0.0, 1.0]) * random.normal(size=3)
    angles = random.uniform((-360.0, -90.0), (360.0, 90.0))
    words = [f"{angles[0]},{angles[1]}", "x", "y", "z", "0,90", "180,-90"]
    return [make_view_along(random.normal(size=3), gravity), *(parse_view(word, gravity) for word in words)]


@pytest.mark.parametrize("seed", range(20))
def test_a_view_is_orthonormal_and_right_handed(seed: int) -> None:
    for view in views(seed):
        axes = np.array([view.right_direction, view.up_direction, view.eye_direction])
        assert np.abs(axes @ axes.T - np.eye(3)).max() < 1e-14
        assert np.abs(np.cross(view.right_direction, view.up_direction) - view.eye_direction).max() < 1e-14


@pytest.mark.parametrize("seed", range(20))
def test_distances_across_the_line_of_sight_are_true(seed: int) -> None:
    p, q = np.random.default_rng(seed).normal(size=(2, 3))
    for view in views(seed):
        seen = view.project(p) - view.project(q)
        assert seen @ seen + view.compute_depth(p - q) ** 2 == pytest.approx((p - q) @ (p - q), rel=1e-13)


@pytest.mark.parametrize("gravity", [(0, 0, -9.81), (0, -9.81, 0), (-9.81, 0, 0), (0, 0, 9.81), (1, -9, 2)])
def test_weights_hang_down(gravity: tuple[float, float, float]) -> None:
    g = np.array(gravity, dtype=np.float64)
    for words in ("30,20", "-100,5", "0,0"):
        seen = parse_view(words, g).project(g)
        assert abs(seen[0]) < 1e-14 * np.linalg.norm(g) and seen[1] < 0.0


def test_along_an_axis_the_others_point_to_the_right_and_up() -> None:
    assert [parse_view(axis, DOWN).format_axes() for axis in "xyz"] == [("y", "z"), ("x", "z"), ("x", "y")]
    assert parse_view("z", np.array([0.0, -9.81, 0.0])).format_axes() == ("x", "y")
    assert parse_view("x", np.array([0.0, -9.81, 0.0])).format_axes() == ("z", "y")


def test_azimuth_and_elevation_are_those_of_matlab() -> None:
    assert make_view_at_angles(0.0, 0.0, NONE).format_axes() == ("x", "z")
    assert make_view_at_angles(90.0, 0.0, NONE).format_axes() == ("y", "z")  # the eye went to the right, to +x
    assert make_view_at_angles(0.0, 90.0, NONE).format_axes() == ("x", "y")
    assert format_direction(make_view_at_angles(30.0, 20.0, NONE).right_direction) == "0.87 x + 0.5 y"


@pytest.mark.parametrize(
    ("spec", "words"),
    [("slider_crank", "+z"), ("crane_load", "-y"), ("engine", "+x"), ("double", "azimuth 30"), ("rotor", "azimuth 30"),
     ("six_cylinder", "azimuth 30"), ("crane", "azimuth 30")],
)  # fmt: skip
def test_what_stays_in_a_plane_is_seen_along_its_normal_unless_it_is_long_across(spec: str, words: str) -> None:
    (told,) = make_assembly_figure(load(str(SPECS / f"{spec}.yaml"))).words
    assert f"seen from {words}" in told


@pytest.mark.parametrize("words", ["", "w", "xy", "30", "30,20,10", "nan,0", "1e9,0", "0,91", "inf,0", "x,y"])
def test_what_is_no_view_is_told(words: str) -> None:
    with pytest.raises(Finding) as told:
        parse_view(words, DOWN)
    assert told.value.hint and "azimuth" in str(told.value)
