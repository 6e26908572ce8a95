"""Joints with a stiffness of 0 in some directions: they carry nothing there that another joint holds, and no more."""

from __future__ import annotations

import math
import re

import numpy as np
import pytest

from heuncli.scene.file_format.load import load
from heuncli.study.workflow import describe
from tests.shared.scenes import near, solved

G, OMEGA, KICK = 9.81, 100.0, 3.0
# a rotor of mass m, its centre out of the axis by e and a from the driven bearing, b from the other
M, E, A, B, J = 20.0, 0.01, 0.2, 0.5, 0.3
SHAFT = f"""
heun: 1
gravity: [0, 0, -{G}]
ground: {{points: {{P: [0, 0, 0], Q: [{B}, 0, 0]}}}}
bodies:
  rotor: {{mass: {M}, center: [{A}, {E}, 0], inertia: [{J}, 0.2, 0.2], points: {{p: [0, 0, 0], q: [{B}, 0, 0]}},
          piece: {{mass: 12, center: [0.25, 0, 0], inertia: [0.1, 0.1, 0.1]}}}}
joints:
  fixed: {{type: pin, from: ground.P, to: rotor.p, axis: [1, 0, 0], stiffness: {{moment: 0}}}}
  loose: {{type: line, from: ground.Q, to: rotor.q, axis: [1, 0, 0]}}
"""
DRIVEN = SHAFT + f"drives: {{motor: {{joint: fixed, rate: {OMEGA}}}}}\n"


def test_the_driven_shaft_in_two_bearings() -> None:
    """Unbalance and weight go to the bearings by their levers, and none of it as a moment; nothing is chosen."""
    times = np.linspace(0.0, 0.05, 6)
    found = solved(DRIVEN + f"analysis: {{times: {times.tolist()}}}\n")
    assert "split" not in found.model
    assert (found.model["redundant"], found.model["given_way"]) == (2, 2)
    phi = OMEGA * times
    carried = np.stack([0 * phi, -M * E * OMEGA**2 * np.cos(phi), -M * E * OMEGA**2 * np.sin(phi) + M * G], axis=1)
    size = M * E * OMEGA**2
    near(found.joints["fixed"]["force"], carried * (1 - A / B), size, 1e-14)
    near(found.joints["loose"]["force"], carried * (A / B), size, 1e-14)
    near(found.joints["fixed"]["moment"], 0.0, size, 1e-15)
    near(found.joints["fixed"]["drive"], M * G * E * np.cos(phi), size, 1e-14)
    for block in found.joints.values():
        assert block["open"] == []
        assert "chosen" not in block


def test_shares_blows_and_sections() -> None:
    """Of a kick at the rotor and a jump of the rate the bearings take their parts, and a cut what its part leaves."""
    text = (
        DRIVEN.replace(f"rate: {OMEGA}", "rate: '0 if t < 0.01 else 2'")
        + f"""
impulses: {{kick: {{on: rotor.q, vector: [0, {KICK}, 0], time: 0}}}}
sections: {{cut: {{body: rotor, at: [0.3, 0, 0], normal: [1, 0, 0], first_axis: [0, 1, 0]}}}}
analysis: {{times: [0, 0.005]}}
"""
    )
    wanted = frozenset({"joints", "sections", "impulses", "shares"})
    found = solved(text.replace("time: 0}", "time: 0.002}"), requested_reports=wanted)
    kick = found.impulses[0]["joints"]
    near(kick["loose"]["force"], [0, -KICK, 0], 1.0, 1e-14)
    near(kick["fixed"]["force"], 0.0, 1.0, 1e-14)
    near(kick["fixed"]["moment"], 0.0, 1.0, 1e-15)
    for name, lever in (("fixed", 1 - A / B), ("loose", A / B)):
        shares = found.joints[name]["shares"]
        near(shares["gravity"]["force"], [[0, 0, M * G * lever]] * 2, 100.0, 1e-14)
        near(sum(s["force"] for s in shares.values()), found.joints[name]["force"], 100.0, 1e-14)
        near(sum(s["moment"] for s in shares.values()), 0.0, 100.0, 1e-15)
    # at rest the cut at 0.3 carries what the bearing beyond it, 0.2 away, lifts, less the piece's weight
    near(found.sections["cut"]["force"], [[0, 0, M * G * A / B - 12 * G]] * 2, 100.0, 1e-13)
    bending = -(0.2 * M * G * A / B)  # about y; the piece's centre is told from the body's origin: 0.25, behind the cut
    near(found.sections["cut"]["moment"][:, 1], [bending + (0.25 - 0.3) * 12 * G] * 2, 100.0, 1e-13)
    near(found.joints["fixed"]["drive"], M * G * E, 100.0, 1e-14)
    jump = solved(text.replace("time: 0}", "time: 0.002}").replace("[0, 0.005]", "[0, 0.02]")).impulses[1]
    near(jump["joints"]["fixed"]["drive"], (J + M * E**2) * 2, 1.0, 1e-14)
    near(jump["joints"]["fixed"]["moment"], 0.0, 1.0, 1e-15)


def test_alone_it_holds() -> None:
    """Where nothing else holds it takes the moment after all, and the model says so."""
    alone = re.sub(r"\n  loose.*", "", DRIVEN)
    found = solved(alone)
    near(found.joints["fixed"]["moment"][0], [0, -A * M * G, -A * M * E * OMEGA**2], 1e3, 1e-14)
    assert found.model["redundant"] == 0


def test_a_direction() -> None:
    """Two hinges of a door: one gives way upwards, along its own z, the other carries the weight; nothing is open."""
    door = f"""
heun: 1
gravity: [0, 0, -{G}]
ground: {{points: {{low: [0, 0, 0], high: [0, 0, 2]}}}}
bodies:
  door: {{mass: 10, center: [0.4, 0, 1], inertia: [1, 1, 1], points: {{low: [0, 0, 0], high: [0, 0, 2]}}}}
joints:
  low: {{type: ball, from: ground.low, to: door.low}}
  high: {{type: ball, from: ground.high, to: door.high, stiffness: {{force: [STIFF, STIFF, 0]}}}}
"""
    for stiff in ("1e8", "3"):  # what is not shared is not decided by the size of another stiffness
        found = solved(door.replace("STIFF", stiff))
        near(found.joints["low"]["force"], [[10 * G * 0.2, 0, 10 * G]], 100.0, 1e-14)
        near(found.joints["high"]["force"], [[-10 * G * 0.2, 0, 0]], 100.0, 1e-14)
        assert found.joints["high"]["open"] == []
        assert "split" not in found.model


def test_two_that_give_way_leave_open_what_only_they_hold() -> None:
    """Both bearings of a pin-pin shaft give way along it: one of them has to hold the thrust, and none is chosen."""
    text = SHAFT.replace("gravity: [0, 0", "gravity: [3, 0").replace("loose: {type: line", "loose: {type: pin")
    text = text.replace("stiffness: {moment: 0}", "stiffness: {force: [0, 1, 1], moment: 0}")
    along = "to: rotor.q, axis: [1, 0, 0]"
    text = text.replace(along, f"{along}, stiffness: {{force: [0, 5, 7], moment: 0}}")
    found = solved(text)
    assert found.joints["fixed"]["open"] == found.joints["loose"]["open"] == ["force.x", "axial"]
    assert [s["terms"] for s in found.certain_sums] == [{"joints.fixed.force.x": 1.0, "joints.loose.force.x": 1.0}]
    near(found.certain_sums[0]["value"][0], -3 * M, 100.0, 1e-14)
    near(found.joints["loose"]["moment"], 0.0, 100.0, 1e-15)
    one = solved(text.replace("force: [0, 5, 7]", "force: [2, 5, 7]"))  # then the other one holds
    near(one.joints["loose"]["force"][0, 0], -3 * M, 100.0, 1e-14)
    assert one.joints["fixed"]["open"] == []


@pytest.mark.parametrize("kind", ["line", "pin"])
def test_the_model_proposes_it(kind: str) -> None:
    """A driven pin beside a line, or beside another pin, as they are mostly drawn first."""
    text = DRIVEN.replace(", stiffness: {moment: 0}", "").replace("type: line", f"type: {kind}")
    note = describe(load("shaft.yaml", text))["notes"][-1]
    more = "" if kind == "line" else " and loose of type line"
    assert note.startswith(f"statically determinate with stiffness: {{moment: 0}} on fixed{more}:")
    done = DRIVEN if kind == "line" else DRIVEN.replace("type: pin, from: ground.Q", "type: line, from: ground.Q")
    notes = describe(load("shaft.yaml", done))["notes"]
    assert notes[-1] == "fixed transmits no moment in its directions of zero stiffness"
    assert math.isclose(solved(done).joints["loose"]["force"][0, 2], M * G * A / B)
