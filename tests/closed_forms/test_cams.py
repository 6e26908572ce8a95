"""Cams whose lifts are known motions: eccentric discs, and the speed at which a tappet jumps off."""

from __future__ import annotations

import math
from pathlib import Path

import numpy as np
import pytest

from heuncli.errors import SolveError
from heuncli.results import Array
from heuncli.tree.cam_flanks import flank_of
from tests.shared.cams import lift
from tests.shared.folders import ROOT
from tests.shared.scenes import near, solved, study

E, R, ROLLER = 0.01, 0.05, 0.012  # of an eccentric disc: how far its centre is off the axis, its radius; of the roller
VALVE_TRAIN = ROOT / "specs" / "valve_train.yaml"


def eccentric(rise: str, contact: str, rate: float = 20.0, more: str = "two_sided: true") -> str:
    """A tappet of 0.5 kg that a disc lifts along y, turning about z at a constant rate from its lowest place."""
    return f"""
heun: 1
gravity: [0, -9.81, 0]
tables: {{lift: {rise}}}
ground: {{points: {{O: [0, 0, 0]}}}}
bodies:
  disc: {{mass: 2, center: [0, 0, 0], inertia: [0.01, 0.01, 0.02], points: {{O: [0, 0, 0]}}}}
  tappet: {{mass: 0.5, center: [0, 0.1, 0], inertia: [1e-3, 1e-3, 1e-3], points: {{P: [0, 0, 0]}}}}
joints:
  shaft: {{type: pin, from: ground.O, to: disc.O, axis: [0, 0, 1]}}
  guide: {{type: slide, from: ground.O, to: tappet.P, axis: [0, 1, 0]}}
drives: {{motor: {{joint: shaft, angle: {rate}*t}}}}
couplings:
  cam: {{type: cam, of: [shaft, guide], lift: lift, at: tappet.P, contact: {contact}, {more}}}
analysis: {{duration: {6.0 / rate}, samples: 13}}
"""


def flat(x: Array) -> Array:
    """How far a flat face stands above the axis of an eccentric disc whose centre begins on x: a crank in a slot."""
    return np.asarray(R + E * np.sin(x))


def rolling(x: Array) -> Array:
    """How far a roller's centre stands above it: the slider of a crank E with a rod R + ROLLER."""
    return np.asarray(E * np.sin(x) + np.sqrt((R + ROLLER) ** 2 - (E * np.cos(x)) ** 2))


def test_a_flat_face_is_a_crank_in_a_slot() -> None:
    """N = m (g - e w^2 sin), at a distance e cos beside the axis, upright."""
    results = solved(eccentric(lift(flat, 360), "flat, normal: [0, 1, 0]"))
    phi, cam = 20.0 * results.time, results.couplings["cam"]
    near(cam["contact"], 0.5 * (9.81 - E * 400.0 * np.sin(phi)), 5.0, 2e-4)
    place = np.stack([-E * np.cos(phi) * -1.0, flat(phi), 0.0 * phi], axis=1)
    near(cam["on"]["tappet"]["point"], place, 0.05, 1e-5)
    near(cam["pressure_angle"], 0.0, 1.0, 1e-15)


def test_a_roller_is_a_slider_crank() -> None:
    """The force goes from the disc's centre to the roller's: its slope is that of the rod of the slider-crank."""
    results = solved(eccentric(lift(rolling, 360), f"roller, radius: {ROLLER}"))
    phi, cam = 20.0 * results.time, results.couplings["cam"]
    slope = np.arcsin(E * np.cos(phi) / (R + ROLLER))
    near(cam["pressure_angle"], np.abs(slope), 1.0, 1e-6)
    acceleration = results.coordinates["guide"]["acceleration"]
    near(cam["contact"] * np.cos(slope), 0.5 * (9.81 + acceleration), 5.0, 1e-7)
    centre = np.stack([E * np.cos(phi), E * np.sin(phi), 0.0 * phi], axis=1)
    off = cam["on"]["tappet"]["point"] - centre
    near(np.sqrt(np.sum(off * off, axis=1)), R, R, 1e-5)
    near(cam["on"]["tappet"]["force"][:, 0], -cam["contact"] * np.sin(slope), 5.0, 1e-5)


@pytest.mark.parametrize(
    ("rise", "contact"), [(flat, "flat, normal: [0, 1, 0]"), (rolling, f"roller, radius: {ROLLER}")]
)
def test_the_flank_of_an_eccentric_disc_is_a_circle(rise: type, contact: str) -> None:
    """All of its places are R from its centre, and it curves so."""
    scene = study(eccentric(lift(rise, 180), contact)).setup.scene
    own = flank_of(scene.layout, scene.mechanism.couplings[0])
    off = own.places - np.array([E, 0.0, 0.0])
    near(np.sqrt(np.sum(off * off, axis=1)), R, R, 1e-6)
    near(own.radius, R, R, 1e-3)


def test_flanks_that_are_cut_away() -> None:
    """Under a face where base + lift + lift'' falls to zero, under a roller where its radius is that of its path."""
    three = lambda x: 0.02 + 0.002 * np.sin(3.0 * x)  # noqa: E731 - 0.02 - 8 * 0.002 > 0
    solved(eccentric(lift(three, 120), "flat, normal: [0, 1, 0]"))
    with pytest.raises(SolveError, match=r"cut away at angles .* deg") as told:
        solved(eccentric(lift(lambda x: 0.02 + 0.003 * np.sin(3.0 * x), 120), "flat, normal: [0, 1, 0]"))
    assert told.value.problems[0].code == "cam-undercut"
    solved(eccentric(lift(rolling, 120), "roller, radius: 0.061"))
    with pytest.raises(SolveError, match="cut away"):
        solved(eccentric(lift(rolling, 120), "roller, radius: 0.063"))


def test_a_tappet_without_spring_lifts_off() -> None:
    """Where e w^2 sin = g: the run ends there, and says why."""
    rate = 40.0
    results = solved(eccentric(lift(flat, 360), "flat, normal: [0, 1, 0]", rate, "two_sided: false"))
    assert results.time[-1] == pytest.approx(math.asin(9.81 / (E * rate**2)) / rate, rel=1e-4)
    assert results.status["code"] == "stopped"
    assert "contact lost" in results.status["message"]


@pytest.mark.parametrize(("faster", "code"), [(0.995, "completed"), (1.005, "stopped")])
def test_the_jump_speed_of_a_valve_train(faster: float, code: str) -> None:
    """w = sqrt((F0 + k h + m g) / (m h)), as specs/valve_train.yaml works it out."""
    jump = math.sqrt((100.0 + 20e3 * 0.008 + 0.15 * 9.81) / (0.15 * 0.008))
    text = Path(VALVE_TRAIN).read_text(encoding="utf-8").replace("4000 rpm", f"{faster * jump} rad/s")
    text = text[: text.index("\nexpect:")] + "\n"
    assert solved(text).status["code"] == code


def test_a_cam_declared_planar() -> None:
    """The same in a scene of the plane."""
    space = solved(eccentric(lift(rolling, 36), f"roller, radius: {ROLLER}"))
    plane = solved(
        eccentric(lift(rolling, 36), f"roller, radius: {ROLLER}").replace("heun: 1", "heun: 1\nspace: planar")
    )
    near(plane.couplings["cam"]["contact"], space.couplings["cam"]["contact"], 10.0, 1e-9)
    near(plane.joints["shaft"]["force"], space.joints["shaft"]["force"], 10.0, 1e-9)


def test_a_tappet_that_flies_falls_back() -> None:
    """Let go 0.1 m above a disc that stands, it strikes with sqrt(2 g h) and rises to e^2 h; the loss is the work."""
    h, e = 0.1, 0.5
    text = eccentric(lift(flat, 36), "flat, normal: [0, 1, 0]", 1.0, f"restitution: {e}")
    text = text.replace("motor: {joint: shaft, angle: 1.0*t}", "motor: {joint: shaft, angle: 0}")
    text = text.replace("axis: [0, 1, 0]}", f"axis: [0, 1, 0], initial: {{travel: {R + h}}}}}")
    fall, top = math.sqrt(2.0 * h / 9.81), math.sqrt(2.0 * h / 9.81) * (1.0 + e)
    text = text[: text.index("analysis:")] + f"analysis: {{times: [0, {fall * 0.5}, {top}]}}\n"
    results = solved(text)
    near(results.coordinates["guide"]["travel"], [R + h, R + h * 0.75, R + h * e * e], R, 1e-9)
    energy = results.energy["kinetic"] + results.energy["potential"]
    near(energy - results.energy["work"], energy[0], 0.5 * 9.81 * h, 1e-9)
    near(energy[2] - energy[0], 0.5 * 9.81 * h * (e * e - 1.0), 0.5 * 9.81 * h, 1e-9)
    near(results.couplings["cam"]["contact"], 0.0, 1.0, 1e-12)


def test_a_strike_turns_the_disc_back() -> None:
    """A disc that turns freely: the impulse stands beside its axis, and energy and work of the strike add up."""
    text = eccentric(lift(flat, 72), "flat, normal: [0, 1, 0]", 40.0, "restitution: 0.3")
    text = text[: text.index("drives:")] + text[text.index("couplings:") :]
    text = text.replace("axis: [0, 0, 1]}", "axis: [0, 0, 1], initial: {angle: 0.3, rate: 60}}")
    results = solved(text)
    total = results.energy["kinetic"] + results.energy["potential"] - results.energy["work"]
    near(total, total[0], float(results.energy["kinetic"].max()), 1e-8)
    assert results.energy["work"][-1] < -0.01
