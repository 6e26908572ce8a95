"""Gears by hand: reflected inertias, tooth forces and their parts, racks, cones, planetary trains against Willis."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
import pytest

from tests.shared.gear_trains import STATE, pair, pin, planetary, wheel
from tests.shared.scenes import near, solved

ROUNDING = 1e-12


@pytest.mark.parametrize(
    ("mesh", "ratio", "arm"),
    [
        ({"teeth": [20, 60]}, -3.0, 0.1),
        ({"ratio": -3}, -3.0, 0.1),
        ({"at": "ground.P"}, -3.0, 0.1),
        ({"teeth": [20, 60], "internal": True}, 3.0, -0.2),
        ({"ratio": 3}, 3.0, -0.2),
    ],
)
def test_wheels_turn_by_their_ratio_and_bear_their_tooth_force(mesh: dict[str, Any], ratio: float, arm: float) -> None:
    """The motor turns its own inertia and a ninth of the wheel's; the tooth force is the rest, at the pitch point."""
    scene = pair(pressure_angle="25 deg", helix="15 deg", **mesh)
    scene["ground"]["points"]["P"] = [0.1, 0, 0]
    found = solved(scene)
    turned = 5 / (0.02 + 0.2 / 9)
    near(found.coordinates["w"]["rate"], 10 / ratio, 10, ROUNDING)
    near(found.coordinates["p"]["acceleration"], turned, turned, ROUNDING)
    mesh_told = found.couplings["mesh"]
    force = (5 - 0.02 * turned) / abs(arm)
    near(mesh_told["force"], force, force, ROUNDING)
    radial, axial = force * math.tan(math.radians(25)) / math.cos(math.radians(15)), force * math.tan(math.radians(15))
    near(mesh_told["radial"], radial, force, ROUNDING)
    near(mesh_told["axial"], axial, force, ROUNDING)
    near(mesh_told["normal"], math.hypot(force, radial, axial), force, ROUNDING)
    on = mesh_told["on"]["wheel"]
    near(on["point"][0], (arm, 0, 0), 0.4, ROUNDING)
    # forward is y on the right of the pinion's axis; teeth that lean with a right-handed helix push towards -z
    forward = math.copysign(1.0, arm)
    near(on["force"][0], (math.copysign(radial, arm), forward * force, -axial), force, ROUNDING)
    near(found.joints["w"]["force"][0], -on["force"][0], force, ROUNDING)
    near(found.joints["p"]["force"][0], on["force"][0], force, ROUNDING)
    near(found.foundation["force"][0], 0.0, force, ROUNDING)


def test_flanks_push_apart_whichever_of_them_carries() -> None:
    scene = pair(teeth=[20, 60])
    forward = solved(scene).couplings["mesh"]["on"]["wheel"]["force"][0]
    scene["forces"]["motor"]["value"] = -5
    back = solved(scene).couplings["mesh"]["on"]["wheel"]["force"][0]
    near(back, forward * (1, -1, 1), 30.0, ROUNDING)
    assert forward[0] > 9.0


def test_order_of_the_gears_and_direction_of_the_joints_change_names_alone() -> None:
    """The ratio is that of the coordinates as they are written; teeth know by themselves which way wheels turn."""
    plain = solved(pair(teeth=[20, 60], helix="15 deg"))
    swapped = pair(teeth=[60, 20], of=["w", "p"], helix="-15 deg")
    swapped["joints"]["w"] = pin("wheel.c", "ground.B", (0, 0, -1))
    told = solved(swapped)
    near(
        told.couplings["mesh"]["on"]["wheel"]["force"], plain.couplings["mesh"]["on"]["wheel"]["force"], 30.0, ROUNDING
    )
    near(told.foundation["supports"]["w"]["force"], plain.foundation["supports"]["w"]["force"], 30.0, ROUNDING)
    near(told.bodies["wheel"]["angular_velocity"], plain.bodies["wheel"]["angular_velocity"], 10, ROUNDING)


def test_rack_and_pinion() -> None:
    """A rack of 2 kg falls, and turns a pinion as heavy as 8 kg where their teeth meet."""
    guide = {"type": "slide", "from": "ground.B", "to": "rack.c", "axis": [0, 0, 1], "initial": {"speed": 1}}
    scene = {
        "gravity": [0, 0, -9.81],
        "ground": {"points": {"A": [0, 0, 0], "B": [0.05, 0, 0], "P": [0.05, 0.03, 0]}},
        "bodies": {"pinion": wheel(0.02, across=0.02), "rack": wheel(0.1, (0.05, 0, 0), 2.0)},
        "joints": {"p": pin("ground.A", "pinion.c", (0, 1, 0)), "r": guide},
        "couplings": {"mesh": {"type": "gear", "of": ["p", "r"], "at": "ground.P"}},
        "analysis": STATE,
    }  # fmt: skip
    found = solved(scene)
    near(found.coordinates["p"]["rate"], -20, 20, ROUNDING)
    near(found.coordinates["r"]["acceleration"], -9.81 / 5, 9.81, ROUNDING)
    lift = 2 * 9.81 * 4 / 5
    near(
        found.couplings["mesh"]["on"]["rack"]["force"][0], (lift * math.tan(math.radians(20)), 0, lift), lift, ROUNDING
    )
    near(found.couplings["mesh"]["on"]["rack"]["point"][0], (0.05, 0.03, 0), 0.05, ROUNDING)
    scene["couplings"]["mesh"] = {"type": "gear", "of": ["r", "p"], "ratio": -0.05}
    told = solved(scene)
    near(
        told.couplings["mesh"]["on"]["rack"]["force"][0],
        found.couplings["mesh"]["on"]["rack"]["force"][0],
        lift,
        ROUNDING,
    )


def test_bevel_gears() -> None:
    """Of two cones the tooth force pushes each along its own axis, too, by the angle of the other."""
    scene = pair(teeth=[20, 40])
    scene["ground"]["points"] = {"A": [0.1, 0, 0], "B": [0, 0, 0.05]}
    pinion = {"mass": 1, "center": [0.1, 0, 0], "inertia": [0.02, 0.02, 0.02], "points": {"c": [0.1, 0, 0]}}
    scene["bodies"] = {"pinion": pinion, "wheel": wheel(0.2, (0, 0, 0.05), 2.0)}
    scene["joints"] = {
        "p": pin("ground.A", "pinion.c", (1, 0, 0)),
        "w": pin("ground.B", "wheel.c", initial={"rate": 2}),
    }
    found = solved(scene)
    near(abs(found.coordinates["p"]["rate"]), 4, 4, ROUNDING)
    turned = 5 / (0.02 + 0.2 / 4)
    force = (5 - 0.02 * turned) / 0.05
    near(found.couplings["mesh"]["force"], force, force, ROUNDING)
    on = found.couplings["mesh"]["on"]["pinion"]
    near(on["point"][0], (0.1, 0, 0.05), 0.1, ROUNDING)
    cone = math.atan2(0.05, 0.1)
    radial = force * math.tan(math.radians(20))
    near(abs(on["force"][0]), (radial * math.sin(cone), force, radial * math.cos(cone)), force, ROUNDING)
    assert on["force"][0][0] > 0.0 > on["force"][0][2]  # out of the cone, and towards its own axis


@pytest.mark.parametrize("sun_on", ["ground", "arm"])
def test_planetary_train_by_willis(sun_on: str) -> None:
    """The sun turns 1 + 60/20 = 4 times for each turn of the arm; what housing and shafts get adds up to nothing."""
    scene = planetary(sun_on=sun_on)
    found = solved(scene)
    near(found.bodies["sun"]["angular_velocity"][0], (0, 0, 8), 8, ROUNDING)
    near(found.bodies["planet0"]["angular_velocity"][0], (0, 0, -4), 8, ROUNDING)
    # kinetic energy as a function of the arm's rate: sun, planet on its circle and about itself, arm
    reduced = 0.02 * 16 + 0.06 + 0.004 * 4 + 0.5 * 0.01
    turned = (4 * 1 - 3) / reduced
    near(found.coordinates["a"]["acceleration"], turned, turned, ROUNDING)
    sun = (1 - 0.02 * 4 * turned) / 0.05
    near(np.abs(found.couplings["sp0"]["force"]), sun, sun, ROUNDING)
    ring = sun + 0.004 / 0.05 * -2 * turned
    near(np.abs(found.couplings["pr0"]["force"]), ring, sun, ROUNDING)
    near(found.couplings["pr0"]["on"]["ground"]["force"][0][1], -ring, sun, ROUNDING)


def test_three_planets_share_openly() -> None:
    """Which planet carries how much is open; each mesh of it is not, once one is told; symmetry is least norm's."""
    found = solved(planetary(3))
    assert found.model["redundant"] == 2
    for name in ("sp0", "sp1", "sp2", "pr0"):
        assert np.isnan(found.couplings[name]["force"]).all() and "force" in found.couplings[name]["open"]
    assert np.isnan(found.joints["p0"]["force"][0, :2]).all()
    reduced = 0.02 * 16 + 0.06 + 3 * (0.004 * 4 + 0.5 * 0.01)
    turned = 1 / reduced
    near(found.coordinates["a"]["acceleration"], turned, turned, ROUNDING)
    whole = (1 - 0.02 * 4 * turned) / 0.05
    sums = [own for own in found.certain_sums if set(own["terms"]) == {f"couplings.sp{i}.force" for i in range(3)}]
    assert len(sums) == 1
    near(sums[0]["value"], whole, whole, 1e-9)
    even = solved(planetary(3), least_norm=True)
    sun, ring = whole / 3, whole / 3 - 0.004 / 0.05 * 2 * turned
    for i in range(3):
        near(even.couplings[f"sp{i}"]["force"], sun, whole, 1e-9)
        out = np.array([math.cos(i * math.tau / 3), math.sin(i * math.tau / 3), 0.0])
        pull = even.joints[f"p{i}"]["force"][0]
        # towards the centre: the planet's circle at 2 rad/s, and the sun's push beyond the ring's
        inward = 0.5 * 0.1 * 4 + (sun - ring) * math.tan(math.radians(20))
        near(-pull @ out, inward, whole, 1e-9)


@pytest.mark.parametrize(
    ("change", "code"),
    [
        ({"teeth": [0, 60]}, "gear-ratio"),
        ({"ratio": 0}, "gear-ratio"),
        ({"ratio": -3, "teeth": [20, 60]}, "gear-ratio"),
        ({"of": ["p", "p"], "teeth": [20, 60]}, "coupled-joint"),
        ({"of": ["p"], "teeth": [20, 60]}, "coupling-count"),
        ({}, "gear-axes"),
        ({"ratio": 1}, "gear-axes"),
        ({"ratio": -3, "at": "ground.B"}, "gear-axes"),
        ({"ratio": -3, "at": "pinion.c"}, "gear-axes"),
        ({"ratio": -3, "internal": True}, "gear-axes"),
        ({"teeth": [20, 60], "pressure_angle": "-5 deg"}, "gear-ratio"),
    ],
)
def test_what_no_gears_are_is_refused(change: dict[str, Any], code: str) -> None:
    from heuncli.base.errors import SpecError

    with pytest.raises(SpecError) as refused:
        solved(pair(**change))
    assert {problem.code for problem in refused.value.problems} == {code}
    assert all(problem.hint and problem.location for problem in refused.value.problems)


def test_gears_whose_axes_do_not_fit_are_refused() -> None:
    from heuncli.base.errors import SpecError

    for axis, code in (((0, 1, 1), "gear-axes"), ((1, 0, 0), "gear-axes")):
        scene = pair(ratio=-3)
        scene["joints"]["w"]["axis"] = list(axis)
        if axis[0] == 0:
            scene["ground"]["points"]["B"] = [0.4, 0, 0.1]
        with pytest.raises(SpecError) as refused:
            solved(scene)
        assert {problem.code for problem in refused.value.problems} == {code}
    scene = pair(ratio=-3)
    scene["joints"]["w"] = pin("ground.A", "pinion.c")
    with pytest.raises(SpecError) as refused:
        solved(scene)
    assert {problem.code for problem in refused.value.problems} >= {"gear-carrier"}


def test_rates_that_gears_do_not_have_are_refused() -> None:
    from heuncli.base.errors import SolveError

    scene = pair(teeth=[20, 60])
    scene["joints"]["w"]["initial"] = {"rate": 1}
    with pytest.raises(SolveError) as refused:
        solved(scene)
    (problem,) = refused.value.problems
    assert problem.code == "rates-do-not-fit" and "mesh" in problem.message and problem.entry_path == "couplings.mesh"
