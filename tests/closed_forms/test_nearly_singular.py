"""Machines near to a rank of less: the forces that geometry gives there, to the digits it has, or a word about it."""

from __future__ import annotations

import numpy as np
import pytest

from heuncli.base.errors import SolveError
from heuncli.base.tolerances import EPS
from tests.shared.scenes import near, solved
from tests.shared.three_rods import three_rods


@pytest.mark.parametrize("off", [1e-2, 1e-4, 1e-5, 1e-6, 1e-7, 1e-8, 2e-9])
@pytest.mark.parametrize("mass", [1.0, 1e-6, 1e6])
def test_three_rods_nearly_through_one_point(off: float, mass: float) -> None:
    """r3 = 1 / off, whatever the mass, to a rounding over `off`; nearly singular, it is told.

    The estimate is that of a pose closed to a rounding, which may be off by as much over `off`.
    """
    found = solved(three_rods(off, mass))
    pull = 1.0 / off
    near(abs(found.joints["r3"]["tension"][0]), pull, pull, 8.0 * EPS / off)
    near(abs(found.joints["r2"]["tension"][0]), pull, pull, 8.0 * EPS / off)
    assert found.model["freedoms"] == 0
    assert EPS / off < found.accuracy["estimate"]["reactions"] < 100.0 * EPS / off**2
    assert any("nearly singular" in w for w in found.warnings) == (off <= 1e-6)


@pytest.mark.parametrize("off", [1e-10, 1e-11, 1e-12, 1e-13])
def test_dependent_to_typed_digits(off: float) -> None:
    """Nearer than nine digits the rods count as meeting: what they carry is open, and that is told."""
    found = solved(three_rods(off, load="{type: force, on: disc.b, vector: [0, 1, 0]}"))
    assert np.isnan(found.joints["r3"]["tension"]).all()
    assert any("singular position" in w for w in found.warnings)


@pytest.mark.parametrize("off", [1e-10, 1e-11, 1e-12, 1e-13, 0.0])
@pytest.mark.parametrize("analysis", ["", "analysis: {duration: 0.1, samples: 3}"])
def test_what_cannot_be_held_is_refused(off: float, analysis: str) -> None:
    """A couple turns the disc out of the pose that is taken as singular, where the rods do not let it."""
    with pytest.raises(SolveError, match="no finite force resists it"):
        solved(three_rods(off, analysis=analysis))


def door(apart: float) -> str:
    """A door on two hinges whose axes lie `apart`, which turns."""
    return f"""
heun: 1
ground: {{points: {{A: [0, 0, 0], B: [{apart!r}, 0, 1]}}}}
bodies:
  door:
    mass: 5
    center: [0.4, 0, 0.5]
    inertia: [0.5, 0.8, 0.3]
    points: {{a: [0, 0, 0], b: [{apart!r}, 0, 1]}}
    angular_velocity: [0, 0, 1]
joints:
  bottom: {{type: pin, from: ground.A, to: door.a, axis: [0, 0, 1]}}
  top: {{type: pin, from: ground.B, to: door.b, axis: [0, 0, 1]}}
analysis: {{duration: 1, samples: 5}}
"""


@pytest.mark.parametrize("apart", [0.0, 3e-12, 1e-11, 1e-10])
def test_hinges_hardly_apart_keep_their_rate(apart: float) -> None:
    """The door turns on, its hinges open by as much as they are apart, and that they are is told."""
    found = solved(door(apart))
    near(found.bodies["door"]["angular_velocity"][:, 2], 1.0, 1.0, 10.0 * apart + 1e-12)
    assert found.accuracy["constraint_gap"] <= 2.0 * apart + 1e-15
    assert any("depend on others only to within" in w for w in found.warnings) == (apart > 0.0)


@pytest.mark.parametrize("apart", [1e-9, 1e-8, 1e-6, 1e-3])
def test_hinges_apart_do_not_turn(apart: float) -> None:
    """A rate that is held there contradicts them."""
    with pytest.raises(SolveError, match="start velocities"):
        solved(door(apart))


def test_a_scene_everywhere_near_to_a_singular_pose_passes_through_none() -> None:
    found = solved(three_rods(1e-7, analysis="analysis: {duration: 0.1, samples: 3}"))
    assert not any("two motions are possible" in w for w in found.warnings)
