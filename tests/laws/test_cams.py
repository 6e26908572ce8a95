"""Cams on a carriage that moves: what holds whatever the lift, the follower and the contact."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

from heuncli.multibody.coupled_start.freedoms import Freedoms
from heuncli.multibody.response import slope, tangent
from tests.oracle.tellings import TELLINGS
from tests.shared.cam_scenes import cam_scene
from tests.shared.cams import carried_cam
from tests.shared.retellings import same_results
from tests.shared.scenes import moving, near, solved, study
from tests.shared.trees import TIMES

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
    L, first, second = (part[:, 0] for part in path.evaluate(shaft["angle"]))
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
    passing = states.point_velocity(f, on["point"]) - states.point_velocity(disc, on["point"])
    power = np.sum(on["force"] * passing, axis=1)
    near(power, 0.0, float(np.abs(on["force"]).max() * np.abs(passing).max()), 1e-11)


@pytest.mark.parametrize(("joint", "contact"), KINDS)
def test_the_tangent_is_that_of_the_motion(joint: str, contact: str) -> None:
    """d(ydot)/dy along the motion itself, against differences of ydot."""
    runner = study(carried_cam(joint, contact)).setup.runner
    y, space = runner.integrated_scene.layout.y0, runner.integrated_scene.workspace
    along, _ = slope(space, 0.0, y)
    h = 1e-5 / np.abs(along).max()
    beside = [slope(space, 0.0, y + k * h * along)[0] for k in (-2, -1, 1, 2)]
    wanted = (beside[0] - 8.0 * beside[1] + 8.0 * beside[2] - beside[3]) / (12.0 * h)
    near(tangent(space, 0.0, y) @ along, wanted, float(np.abs(wanted).max()), 1e-7)


def bare(seed: int) -> dict[str, Any]:
    """A random scene with a cam, its loads left out."""
    return {key: value for key, value in cam_scene(seed).items() if key != "forces"}


@pytest.mark.heavy
@pytest.mark.parametrize("way", ["turned", "mirrored", "inches, pounds", "faster", "renamed", "other origins"])
@pytest.mark.parametrize("seed", range(6))
@pytest.mark.third
def test_a_cam_told_otherwise(seed: int, way: str) -> None:
    """A random scene with each kind of cam: all numbers are those of the other telling, contact and angle, too."""
    scene = bare(seed)
    told = TELLINGS[way](scene, np.random.default_rng(seed))
    one, two = (solved(moving(s, np.array(TIMES) * t, 1e-12)) for s, t in ((scene, 1.0), (told.scene, told.time)))
    same_results(told, one, two, 1e-9)
    size = max(1.0, float(np.abs(one.couplings["cam"]["contact"]).max()))
    near(two.couplings["cam"]["contact"] / told.force, one.couplings["cam"]["contact"], size)
    near(two.couplings["cam"]["pressure_angle"], one.couplings["cam"]["pressure_angle"], 1.0, 1e-8)


@pytest.mark.heavy
@pytest.mark.parametrize("seed", range(6))
def test_a_groove_is_told_from_either_side(seed: int) -> None:
    """The follower's axis turned round, and the lift with it: the same motion and force, the contact's sign turns."""
    scene = bare(seed)
    run = solved(moving(scene, TIMES, 1e-12))
    joint, table = scene["joints"]["j_follower"], scene["tables"]["lift"]
    other = {key: [-x for x in joint[key]] for key in ("axis", "to_axis") if key in joint}
    scene["joints"]["j_follower"] = joint | other
    scene["tables"]["lift"] = table | {"y": [-y for y in table["y"]]}
    turned = solved(moving(scene, TIMES, 1e-12))
    one, two = run.couplings["cam"], turned.couplings["cam"]
    size = max(1.0, float(np.abs(one["contact"]).max()))
    near(two["contact"], -one["contact"], size)
    near(two["on"]["follower"]["force"], one["on"]["follower"]["force"], size)
    near(two["on"]["follower"]["point"], one["on"]["follower"]["point"], 1.0)


@pytest.mark.parametrize(("joint", "contact"), KINDS)
def test_newton_of_a_follower(joint: str, contact: str) -> None:
    """Its joint and the cam make all of its acceleration, and of its turning about its centre of mass."""
    own = study(carried_cam(joint, contact))
    found, body = own.results, own.setup.scene.mechanism.bodies
    f = next(b for b in body if b.name == "f")
    cam, guide, moved = found.couplings["cam"]["on"]["f"], found.joints["follow"], found.bodies["f"]
    force = cam["force"] + guide["force"] + f.mass * np.array([1.0, -9.81, 2.0])
    near(force, f.mass * moved["center_acceleration"], float(np.abs(cam["force"]).max()))
    arms = [(x["point"] - moved["center"], x["force"]) for x in (cam, guide)]
    moment = guide["moment"] + cam["moment"] + sum(np.cross(arm, push) for arm, push in arms)
    given = np.array([[0.004, 0, 0.001], [0, 0.003, 0], [0.001, 0, 0.005]])
    R, spin, faster = moved["rotation"], moved["angular_velocity"], moved["angular_acceleration"]
    J = R @ given @ np.swapaxes(R, 1, 2)
    apply = lambda x: np.einsum("nij,nj->ni", J, x)  # noqa: E731
    near(apply(faster) + np.cross(spin, apply(spin)), moment, float(np.abs(guide["moment"]).max()))


def test_a_follower_on_the_axis_of_its_disc() -> None:
    """No force across the flank moves it there, and no kernel divides by that: gap and rate are told all the same.

    Starts pass such poses on their way; a run cannot come to one, for its flank is refused.
    """
    text = carried_cam("slide", "roller").replace("axis: [0.1, 1, 0]", "axis: [0, 1, 0]")
    text = text.replace("P: [0.01, 0, 0]", "P: [0, 0, 0]").replace("C: [0.01, 0.1, 0]", "C: [0, 0.1, 0]")
    scene = study(text.replace("center: [0.1, 0.02, 0.03]", "center: [0, 0, 0]")).setup.scene
    layout = scene.layout
    place = {layout.mechanism.joints[f.joint].name: (f.q, f.u) for f in layout.freedoms if f.joint >= 0}
    y = np.zeros(len(layout.y0))
    y[0], y[place["shaft"][0]], y[place["shaft"][1]], y[place["follow"][0]] = 1.0, 0.3, 9.0, -0.1
    told = Freedoms(layout, 0.0, ()).measure(y)
    lift, slope_there, _ = scene.mechanism.couplings[0].rows[0].parts[0].cam.lift.evaluate(0.3)
    near(told.gaps, [-0.1 - lift[0]], 0.1, 1e-12)
    near(told.rates, [-9.0 * slope_there[0]], 1.0, 1e-12)
