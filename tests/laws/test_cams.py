"""Cams on a carriage that moves: what holds whatever the lift, the follower and the contact."""

from __future__ import annotations

import numpy as np
import pytest

from heuncli.response import slope, tangent
from tests.shared.cams import carried_cam
from tests.shared.scenes import near, study

KINDS = [(joint, contact) for joint in ("slide", "pin") for contact in ("roller", "flat", "point")]


@pytest.mark.parametrize(("joint", "contact"), KINDS)
def test_energy_and_momentum_are_kept(joint: str, contact: str) -> None:
    """The force of contact does no work, and what it does to the disc it does to the follower, at one place."""
    results = study(carried_cam(joint, contact)).results
    energy = results.energy["kinetic"] + results.energy["potential"]
    near(energy, energy[0], float(results.energy["kinetic"].max()), 1e-9)
    on = results.couplings["cam"]["on"]
    near(on["f"]["force"], -on["disc"]["force"], float(np.abs(on["f"]["force"]).max()), 1e-12)
    arm = on["f"]["point"] - on["disc"]["point"]
    assert np.abs(arm).max() == 0.0


@pytest.mark.parametrize(("joint", "contact"), KINDS)
def test_the_coordinate_is_the_lift(joint: str, contact: str) -> None:
    """x = L(phi), x' = L' phi', x'' = L' phi'' + L'' phi'^2, by the table's own cubics."""
    own = study(carried_cam(joint, contact))
    path = own.setup.scene.mechanism.couplings[0].rows[0].parts[0].cam.lift
    shaft, follow = (own.results.coordinates[name] for name in ("shaft", "follow"))
    L, first, second = (part[:, 0] for part in path.at(shaft["angle"]))
    x, speed = ("travel", "speed") if joint == "slide" else ("angle", "rate")
    near(follow[x], L, 0.1, 1e-12)
    near(follow[speed], first * shaft["rate"], 1.0, 1e-11)
    near(follow["acceleration"], first * shaft["acceleration"] + second * shaft["rate"] ** 2, 10.0, 1e-10)


@pytest.mark.parametrize(("joint", "contact"), KINDS)
def test_the_force_stands_across_the_flank(joint: str, contact: str) -> None:
    """Of the disc and the follower at the place of contact: no speed against each other along the force."""
    own = study(carried_cam(joint, contact))
    states = own.recovery.states
    f, disc = (next(i for i, b in enumerate(own.setup.scene.mechanism.bodies) if b.name == n) for n in ("f", "disc"))
    on = own.results.couplings["cam"]["on"]["f"]
    passing = states.velocity(f, on["point"]) - states.velocity(disc, on["point"])
    power = np.sum(on["force"] * passing, axis=1)
    near(power, 0.0, float(np.abs(on["force"]).max() * np.abs(passing).max()), 1e-11)


@pytest.mark.parametrize(("joint", "contact"), KINDS)
def test_the_tangent_is_that_of_the_motion(joint: str, contact: str) -> None:
    """d(ydot)/dy along the motion itself, against differences of ydot."""
    runner = study(carried_cam(joint, contact)).setup.runner
    y, space = runner.moving.layout.y0, runner.moving.workspace
    along, _ = slope(space, 0.0, y)
    h = 1e-5 / np.abs(along).max()
    beside = [slope(space, 0.0, y + k * h * along)[0] for k in (-2, -1, 1, 2)]
    wanted = (beside[0] - 8.0 * beside[1] + 8.0 * beside[2] - beside[3]) / (12.0 * h)
    near(tangent(space, 0.0, y) @ along, wanted, float(np.abs(wanted).max()), 1e-7)
