"""Cams whose lifts are known motions: eccentric discs, and the speed at which a tappet jumps off."""

from __future__ import annotations

import math
from pathlib import Path

import numpy as np
import pytest

from heuncli.analyses.balancing.study import balance
from heuncli.base.errors import SolveError
from heuncli.multibody.tree.cam_flanks import make_flank
from heuncli.results.results import Array
from heuncli.scene.file_format.load import load
from heuncli.scene.file_format.models import Spec
from tests.shared.cams import eccentric, lift, table
from tests.shared.folders import ROOT
from tests.shared.scenes import near, solved, study

E, R, ROLLER = 0.01, 0.05, 0.012  # of an eccentric disc: how far its centre is off the axis, its radius; of the roller
VALVE_TRAIN = ROOT / "specs" / "valve_train.yaml"


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
    own = make_flank(scene.layout, scene.mechanism.couplings[0])
    off = own.places - np.array([E, 0.0, 0.0])
    near(np.sqrt(np.sum(off * off, axis=1)), R, R, 1e-6)
    near(own.radius, R, R, 1e-3)


def test_flanks_that_are_cut_away() -> None:
    """Under a face where base + lift + lift'' falls to zero, under a roller where its radius is that of its path."""
    three = lambda x: 0.02 + 0.002 * np.sin(3.0 * x)  # noqa: E731 - 0.02 - 8 * 0.002 > 0
    solved(eccentric(lift(three, 120), "flat, normal: [0, 1, 0]"))
    with pytest.raises(SolveError, match=r"undercut at disc angles .* deg") as told:
        solved(eccentric(lift(lambda x: 0.02 + 0.003 * np.sin(3.0 * x), 120), "flat, normal: [0, 1, 0]"))
    assert told.value.problems[0].code == "cam-undercut"
    solved(eccentric(lift(rolling, 120), "roller, radius: 0.061"))
    with pytest.raises(SolveError, match="undercut"):
        solved(eccentric(lift(rolling, 120), "roller, radius: 0.063"))


NOSE = 0.02, 0.1, 20.0, 0.95  # a lobe that is narrower at its root than at its tip: least and most, steepness, width


def lobe(x: Array) -> Array:
    """How far a roller's centre stands above the axis of a disc with one narrow lobe."""
    low, high, steep, wide = NOSE
    return np.asarray(0.5 * (low + high) + 0.5 * (high - low) * np.tanh(steep * (np.cos(x) - wide)))


def test_a_lobe_narrower_than_its_roller() -> None:
    """It curves nowhere too much, but what the roller touches on one side it cuts away from the other."""
    text = eccentric(lift(lobe, 720), "roller, radius: 0.012")
    with pytest.raises(SolveError, match="touches at another angle"):
        solved(text)
    scene = study(text.replace("0.012", "0.008")).setup.scene
    assert make_flank(scene.layout, scene.mechanism.couplings[0]).radius.min() > 0.004


def test_a_path_that_turns_back_about_the_axis() -> None:
    """A follower beside the axis on a steep lift: n . C < 0 there, and the roller is still outside of its disc."""
    steep = lambda x: 0.03 + 0.0285 * np.sin(x)  # noqa: E731
    text = eccentric(lift(steep, 360), "roller, radius: 0.001").replace("samples: 13", "samples: 61")
    text = text.replace("from: ground.O, to: tappet.P", "from: {body: ground, at: [0.01, 0, 0]}, to: tappet.P")
    results = solved(text)
    cam = results.couplings["cam"]["on"]["tappet"]
    x, y = 0.01, steep(20.0 * results.time)
    slope = 0.0285 * np.cos(20.0 * results.time)
    n = np.stack([x - slope, y, 0.0 * y], axis=1)
    assert (n[:, 0] * x + n[:, 1] * y).min() < 0.0
    n = n / np.sqrt(np.sum(n * n, axis=1))[:, None]
    near(cam["point"], np.stack([x + 0.0 * y, y, 0.0 * y], axis=1) - 0.001 * n, 0.02, 1e-6)


@pytest.mark.parametrize("contact", ["flat, normal: [0, 1, 0]", f"roller, radius: {ROLLER}", "point"])
def test_a_lift_that_grows_toward_the_disc(contact: str) -> None:
    """The same cam told against the axis is refused where it presses alone; in a groove it is the same."""
    sense = eccentric(lift(lambda x: -rolling(x), 72), contact, more="two_sided: false")
    with pytest.raises(SolveError, match="is positive toward its disc") as told:
        solved(sense.replace("axis: [0, 1, 0]", "axis: [0, -1, 0]"))
    assert told.value.problems[0].code == "cam-sense"
    solved(eccentric(lift(rolling, 72), contact, more="two_sided: false"))
    groove = sense.replace("axis: [0, 1, 0]", "axis: [0, -1, 0]").replace("two_sided: false", "two_sided: true")
    solved(groove)


def test_a_follower_that_passes_the_axis() -> None:
    """Beside the axis it moves along the flank: no force moves it."""
    with pytest.raises(SolveError, match="cannot move the follower") as told:
        solved(eccentric(lift(lambda x: 0.003 + 0.02 * np.sin(x), 72), "point"))
    assert told.value.problems[0].code == "cam-sense"


def part_of_a_turn(motor: str, more: str = "", contact: str = "flat, normal: [0, 1, 0]") -> str:
    """An eccentric disc that has a flank from -40 to 40 deg, turned by a drive."""
    rise = table(flat, -math.radians(40.0), math.radians(40.0), 80)
    text = eccentric(rise, contact, more="two_sided: true" + more)
    return text.replace("angle: 20.0*t", motor)


def test_a_disc_that_swings() -> None:
    """Over a part of a turn it is the eccentric disc."""
    results = solved(part_of_a_turn("angle: 0.6*sin(20*t)"))
    phi = results.coordinates["shaft"]
    y = -E * np.sin(phi["angle"]) * phi["rate"] ** 2 + E * np.cos(phi["angle"]) * phi["acceleration"]
    near(results.couplings["cam"]["contact"], 0.5 * (9.81 + y), 5.0, 2e-3)
    near(results.coordinates["guide"]["travel"], flat(phi["angle"]), R, 1e-7)


@pytest.mark.parametrize("end", [40.0, -40.0])
@pytest.mark.parametrize("driven", [True, False])
def test_a_disc_that_turns_off_its_lift(end: float, driven: bool) -> None:
    """At that instant, to either side; one that stands off it at the start does not begin."""
    rate = math.copysign(3.0, end)
    text = part_of_a_turn(f"angle: {rate}*t")
    if not driven:
        free = text[: text.index("drives:")] + text[text.index("couplings:") :]
        text = free.replace("axis: [0, 0, 1]}", f"axis: [0, 0, 1], initial: {{angle: 0, rate: {10 * rate}}}}}")
    with pytest.raises(SolveError, match=r"shaft\.angle from -40 to 40 deg") as told:
        solved(text.replace("duration: 0.3", "duration: 1.0"))
    (problem,) = told.value.problems
    assert problem.code == "path-ends"
    assert f"until: shaft.angle {'>' if end > 0 else '<'} {end:g} deg" in problem.hint
    if driven:
        assert f"t = {math.radians(40.0) / 3.0:.6g}"[:10] in problem.message
        until = f"until: shaft.angle {'>' if end > 0 else '<'} {0.9 * end} deg"
        results = solved(text.replace("analysis: {", f"analysis: {{{until}, "))
        assert results.time[-1] == pytest.approx(math.radians(36.0) / 3.0, rel=1e-9)
        with pytest.raises(SolveError, match=r"is at shaft\.angle = 57\.29"):
            solved(text.replace(f"angle: {rate}*t", "angle: 1.0 + 0.1*t"))


def test_the_phase_of_a_lift() -> None:
    """What the table says at an angle happens later by the phase: the run is that of the disc turned back."""
    plain = solved(part_of_a_turn("angle: 0.6*sin(20*t)"))
    later = solved(part_of_a_turn("angle: 1.0 + 0.6*sin(20*t)", ", phase: 1.0"))
    near(later.couplings["cam"]["contact"], plain.couplings["cam"]["contact"], 5.0, 1e-9)
    near(later.coordinates["guide"]["travel"], plain.coordinates["guide"]["travel"], R, 1e-12)
    whole = solved(eccentric(lift(flat, 72), "flat, normal: [0, 1, 0]", more="two_sided: true, phase: 90 deg"))
    near(whole.coordinates["guide"]["travel"], flat(20.0 * whole.time - 0.5 * math.pi), R, 1e-7)


def test_a_face_that_turns_with_its_disc() -> None:
    """A swinging face on a lift of one radian for each: the flank has no place that touches it."""
    rise = table(lambda x: 1.05 * x, -0.3, 0.3, 6)
    text = eccentric(rise, "flat, normal: [0, 1, 0]")
    pin = (
        "{type: pin, from: {body: ground, at: [-0.3, 0.05, 0]}, to: {body: tappet, at: [-0.3, 0, 0]}, axis: [0, 0, 1]}"
    )
    text = text.replace("{type: slide, from: ground.O, to: tappet.P, axis: [0, 1, 0]}", pin)
    with pytest.raises(SolveError, match="rotates as fast as its disc"):
        solved(text)
    solved(text.replace(rise, table(lambda x: -0.05 * x, -0.3, 0.3, 6)).replace("20.0*t", "0.2*sin(20*t)"))


SWINGING = """
heun: 1
gravity: [0, 0, 0]
tables: {lift: RISE}
bodies:
  frame: {mass: 2, center: [0, 0, 0], inertia: [0.1, 0.1, 0.2], position: [1, 2, 0],
    points: {O: [0, 0, 0], P: [-0.3, 0.1, 0]}}
  disc: {mass: 2, center: [0.02, 0, 0], inertia: [0.01, 0.01, 0.02], points: {O: [0, 0, 0]}}
  lever: {mass: 1, center: [0.1, 0, 0], inertia: [0.01, 0.01, 0.02], points: {P: [0, 0, 0], roll: [0.3, 0, 0]}}
joints:
  shaft: {type: pin, from: frame.O, to: disc.O, axis: [0, 0, 1], to_axis: [0, 0, 1]}
  pivot: {type: pin, from: frame.P, to: lever.P, axis: [0, 0, 1], to_axis: [0, 0, 1]}
couplings:
  cam: {type: cam, of: [shaft, pivot], lift: lift, at: lever.roll, contact: point, two_sided: true}
analysis: {type: state}
"""


def test_a_lever_that_counts_from_where_it_is_drawn_starts_on_its_cam() -> None:
    """What the cam turns the lever by is counted, and does not move the frame, which stands where it is held."""
    start = solved(SWINGING.replace("RISE", table(lambda x: 0.1 + 0.05 * np.cos(x), 0.0, 2.0 * math.pi, 24)))
    shaft, pivot = (float(start.coordinates[name]["angle"][0]) for name in ("shaft", "pivot"))
    assert pivot == pytest.approx(0.1 + 0.05 * math.cos(shaft), abs=1e-5)
    near(start.bodies["frame"]["position"][0], [1.0, 2.0, 0.0], 1.0, 1e-14)


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


def test_the_cycle_of_a_cam_that_presses() -> None:
    """It is that of a follower guided on both sides, and says so; one that strikes has none; an open lift says why."""

    def read(text: str) -> Spec:
        return load("scene.yaml", text)

    text = eccentric(lift(flat, 72), "flat, normal: [0, 1, 0]", more="two_sided: false")
    pressed, guided = (balance(read(t)) for t in (text, text.replace("two_sided: false", "two_sided: true")))
    assert any("the follower of cam cam is assumed to stay" in note for note in pressed.notes)
    assert not guided.notes
    for kind, rows in guided.orders.items():
        near([row.amplitude for row in pressed.orders[kind]], [row.amplitude for row in rows], 1.0, 1e-12)
    first = next(row for row in pressed.orders["force"] if row.order == 1.0)
    near(first.amplitude, [0.0, 0.5 * E * 400.0, 0.0], 2.0, 1e-6)
    with pytest.raises(SolveError, match=r"couplings\.cam may open and close"):
        balance(read(text.replace("two_sided: false", "restitution: 0.5")))
    with pytest.raises(SolveError, match=r"it stops at 40°: .* rotates past its lift curve"):
        balance(read(part_of_a_turn("angle: 20*t")))
