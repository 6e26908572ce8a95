"""Redundant supports by hand: manual/theory.md, "Redundancy", a table on four legs, a crankshaft on five bearings."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

from tests.oracle.published import beam, four_bar, held
from tests.oracle.transforms import units_changed
from tests.shared.open_components import open_forces, sums, told_by_sums
from tests.shared.redundant_supports import SQUARE, door, table
from tests.shared.scenes import moving, near, solved

ROUNDING = 1e-12


# ---- a door on two ball hinges


def test_door() -> None:
    """Rank 5 of 6: across the hinges all is certain, along them only the sum."""
    found = solved(door())
    model = found.model
    assert (model["freedoms"], model["redundant"], model["grubler"]) == (1, 1, 0)
    # 5 kg whose centre, 0.4 m out, is held in its circle; the couple of the weight about the middle of the hinges
    pull, lift = 5 * 0.4 * 2.3**2, 5 * 9.81
    top, bottom = (found.joints[n]["force"][0] for n in ("top", "bottom"))
    near(top[:2] + bottom[:2], (-pull, 0), pull, ROUNDING)
    near(top[0] * 0.9 - bottom[0] * 0.7, -lift * 0.4, lift, ROUNDING)
    for name in ("top", "bottom"):
        assert open_forces(found, name) == {"z"}
        assert np.isnan(found.joints[name]["force"][0, 2])
        support = found.foundation["supports"][name]["force"][0]
        near(support[:2], -found.joints[name]["force"][0, :2], lift, ROUNDING)
        assert np.isnan(support[2])
        near(found.joints[name]["moment"][0], 0.0, 1.0, ROUNDING)
    near(found.foundation["force"][0], (pull, 0, -lift), lift, ROUNDING)
    assert sums(found) == [({"joints.top.force.z": 1.0, "joints.bottom.force.z": 1.0}, pytest.approx(49.05, rel=1e-14))]


def test_door_split_by_least_norm_and_by_stiffness() -> None:
    even = solved(door(), least_norm=True)
    for name in ("top", "bottom"):
        assert even.joints[name]["force"][0, 2] == pytest.approx(24.525, rel=1e-13)
        assert even.joints[name]["open"] == [] and even.joints[name]["chosen"] == ["force.z"]
    assert "least norm" in even.model["split"]
    scene = door()
    for name, k in (("top", 3e8), ("bottom", 1e8)):
        scene["joints"][name]["stiffness"] = k
    found = solved(scene)
    assert found.joints["top"]["force"][0, 2] == pytest.approx(49.05 * 0.75, rel=1e-13)
    assert found.joints["bottom"]["force"][0, 2] == pytest.approx(49.05 * 0.25, rel=1e-13)
    assert "stiffness" in found.model["split"]
    assert found.certain_sums == []


# ---- a support told twice
@pytest.mark.parametrize(
    ("again", "twice", "is_open"),
    [
        ({"type": "plane", "normal": [1, 2, 2]}, 1, "xyz"),
        ({"type": "plane", "normal": [3, 0, 4]}, 1, "xz"),
        ({"type": "line", "axis": [0, 4, 3]}, 2, "xyz"),
        ({"type": "ball"}, 3, "xyz"),
    ],
)
def test_a_point_held_twice(again: dict[str, Any], twice: int, is_open: str) -> None:
    """Every row of the closure is told by the tree: none of them moves anything."""
    turned = {"orientation": {"axis": [1, 2, 3], "angle": 0.7}, "angular_velocity": [0.3, -1.0, 2.0]}
    scene = held({"top": [0.1, 0.2, 0.4]}, {"type": "ball"}, turned)
    once = solved(scene).joints["top"]["force"]
    scene["joints"]["again"] = {**scene["joints"]["top"], **again}
    found, split = solved(scene), solved(scene, least_norm=True)
    assert (found.model["freedoms"], found.model["redundant"]) == (3, twice)
    assert open_forces(found, "top") == open_forces(found, "again") == set(is_open)
    assert len(sums(found)) == 2 * len(is_open) - twice
    for c in is_open:
        assert told_by_sums(found, {"joints.top.force." + c: 1.0, "joints.again.force." + c: 1.0})
    near(split.joints["top"]["force"] + split.joints["again"]["force"], once, 49.05, ROUNDING)


# ---- a body on three balls, and on three planes in a row
def test_three_balls() -> None:
    """Not in line: only what is normal to their plane is certain, by the levers."""
    points = {"a": [0, 0, 0], "b": [1, 0, 0], "c": [0.3, 0.8, 0]}
    found = solved(held(points, {"type": "ball"}, {"center": [0.4, 0.2, 0]}))
    assert (found.model["freedoms"], found.model["redundant"]) == (0, 3)
    c = 0.2 / 0.8
    b = 0.4 - 0.3 * c
    for name, share in (("a", 1 - b - c), ("b", b), ("c", c)):
        assert open_forces(found, name) == {"x", "y"}
        near(found.joints[name]["force"][0, 2], share * 49.05, 49.05, ROUNDING)
    for c in "xy":
        assert told_by_sums(found, {f"joints.{n}.force.{c}": 1.0 for n in "abc"})
    assert not told_by_sums(found, {"joints.a.force.x": 1.0, "joints.b.force.x": 1.0})
    near([v for t, v in sums(found)], 0.0, 49.05, ROUNDING)


@pytest.mark.parametrize(
    ("stiffness", "split"),
    [
        (None, (3.714285714286, 3.428571428571, 2.857142857143)),
        ((1e6, 2e6, 1e6), (2.631578947368, 5.052631578947, 2.315789473684)),
    ],
)
def test_beam_on_three_supports(stiffness: tuple[float, ...] | None, split: tuple[float, ...]) -> None:
    scene = beam()
    if stiffness is not None:
        for name, k in zip("abc", stiffness, strict=True):
            scene["joints"][name]["stiffness"] = k
    found = solved(scene, least_norm=stiffness is None)
    near([found.joints[n]["force"][0, 2] for n in "abc"], split, 1.0, 6e-13)
    bare = solved(beam())
    for name in "abc":
        assert open_forces(bare, name) == {"z"}
    near(bare.foundation["force"][0], (0, 0, -10), 10.0, ROUNDING)
    # levers: two sums that tell the reactions but for one
    values = dict(zip(("a", "b", "c"), split, strict=True))
    assert len(sums(bare)) == 2
    for terms, value in sums(bare):
        near(sum(k * values[n.split(".")[1]] for n, k in terms.items()), value, 10.0, 6e-12)


def test_a_split_is_told_in_its_units() -> None:
    """Least norm divides moments by a length of the scene: in millimetres the same split."""
    scene = four_bar(1.0, 0.0, 1.0, (1, 2, 1, 2), (0.7, 0.0, 0.7))
    first = solved(scene, least_norm=True)
    second = solved(units_changed(scene, length=1e3), least_norm=True)
    for name, block in first.joints.items():
        near(second.joints[name]["force"], 1e3 * block["force"], 1e4, ROUNDING)
        near(second.joints[name]["moment"], 1e6 * block["moment"], 1e7, ROUNDING)


# ---- four parallel hinges
def test_four_hinges() -> None:
    """20 rows of rank 17: in the plane certain, across it nothing."""
    found = solved(four_bar(1.0, 0.0, 1.0, (1, 2, 1, 2), (0.7, 0.0, 0.7)))
    assert (found.model["freedoms"], found.model["redundant"], found.model["grubler"]) == (1, 3, -2)
    for name in "ABCD":
        assert {n for n in found.joints[name]["open"] if "." in n} == {"force.z", "moment.x", "moment.y"}
        assert not np.isnan(found.joints[name]["force"][0, :2]).any()
        assert found.joints[name]["moment"][0, 2] == 0.0
        assert not np.isnan(found.joints[name]["radial"]).any() and np.isnan(found.joints[name]["axial"]).all()


# ---- a blade on two balls, carried round by an arm
LINE = np.array([0.0, 0.3, 0.4])


def blade(second: dict[str, Any]) -> dict[str, Any]:
    points = {"p": [1, 0, 0], "q": (LINE + np.eye(3)[0]).tolist()}
    bodies = {
        "arm": {"mass": 1.0, "center": [0.5, 0, 0], "inertia": [0.1, 0.1, 0.1], "points": {"O": [0, 0, 0], **points},
                "angular_velocity": [0, 1, 1]},
        "blade": {"mass": 2.0, "center": [1.2, 0.1, 0.3], "inertia": [0.1, 0.2, 0.15], "points": points}}  # fmt: skip
    joints = {"O": {"type": "pin", "axis": [0, 1, 1], "from": {"body": "ground", "at": [0, 0, 0]}, "to": "arm.O"},
              "p": {"type": "ball", "from": "arm.p", "to": "blade.p"},
              "q": {**second, "from": "arm.q", "to": "blade.q"}}  # fmt: skip
    return {"gravity": [0, 0, -9.81], "bodies": bodies, "joints": joints}


def test_a_line_that_turns() -> None:
    """Along it all is open, across it certain: in directions that turn, with the values of a determinate one."""
    times = np.linspace(0.0, 1.0, 9)
    seconds = ({"type": "ball"}, {"type": "line", "axis": LINE.tolist()})
    found, once = (solved(moving(blade(second), times, 1e-10)) for second in seconds)
    assert (found.model["redundant"], once.model["redundant"]) == (1, 0)
    steady, turning = found.certain_sums[:3], found.certain_sums[3:]
    assert [s["terms"] for s in steady] == [{f"joints.{n}.force.{c}": 1.0 for n in "pq"} for c in "xyz"]
    assert [list(s["terms"]) for s in turning] == [["joints.p.force.x", f"joints.p.force.{c}"] for c in "yz"]
    d = found.bodies["arm"]["rotation"] @ LINE / 0.5
    for s, i in zip(turning, (1, 2), strict=True):
        c = np.stack(list(s["terms"].values()), axis=1)
        near(np.sum(c * d[:, [0, i]], axis=1), 0.0, 1.0, 1e-9)
        near(np.linalg.norm(c, axis=1), 1.0, 1.0, 1e-12)
        assert np.all(np.sum(c[1:] * c[:-1], axis=1) > 0.0)
        near(s["value"], np.sum(c * once.joints["p"]["force"][:, [0, i]], axis=1), 20.0, 1e-8)
        assert np.ptp(c[:, 1]) > 0.1


def test_a_line_that_could_turn() -> None:
    """At one instant: factors of that instant, as numbers, though they would not hold in the next pose."""
    found = solved(blade({"type": "ball"}))
    assert [s["terms"] for s in found.certain_sums[:2]] == [{f"joints.{n}.force.{c}": 1.0 for n in "pq"} for c in "yz"]
    (across,) = found.certain_sums[2:]
    assert list(across["terms"]) == ["joints.p.force.y", "joints.p.force.z"]  # its line has no part along x there
    near(list(across["terms"].values()), [0.8, -0.6], 1.0, 1e-12)


# ---- a table on four legs


def test_table_on_four_legs() -> None:
    """One diagonal may carry more, the other less: all open, but neighbours' sums; three legs are determinate."""
    found = solved(table(SQUARE))
    assert all(open_forces(found, leg) == {"z"} for leg in SQUARE)
    assert found.model["redundant"] == 1
    weight = 49.05 + 20.0
    about_x = 49.05 * 0.05 + 20.0 * -0.2  # Σ y F
    about_y = 49.05 * 0.1 + 20.0 * 0.3  # Σ x F
    side = {"AB": (weight - about_x / 0.4) / 2, "CD": (weight + about_x / 0.4) / 2, "AD": (weight - about_y / 0.6) / 2,
            "BC": (weight + about_y / 0.6) / 2}  # fmt: skip
    listed = {"".join(sorted(n.split(".")[1] for n in terms)): (terms, value) for terms, value in sums(found)}
    assert len(listed) == 3
    for name, (terms, value) in listed.items():
        one, other = terms.values()
        if name in side:
            assert one == other == 1.0
            near(value, side[name], weight, ROUNDING)
        else:  # a diagonal: A - C = (AB) - (BC), B - D = (AB) - (AD)
            assert one == -other and name in ("AC", "BD")
            near(value, side["AB"] - side["BC" if name == "AC" else "AD"], weight, ROUNDING)
    three = solved(table({k: v for k, v in SQUARE.items() if k != "D"}))
    assert all(block["open"] == [] for block in three.joints.values())
    near(sum(b["force"][0, 2] for b in three.joints.values()), weight, weight, ROUNDING)


def test_table_with_equal_legs() -> None:
    """Equal stiffness and least norm are the same here: the legs keep in a plane, F = a + b x + c y."""
    scene = table(SQUARE)
    for leg in SQUARE:
        scene["joints"][leg]["stiffness"] = 5e6
    for found in (solved(scene), solved(table(SQUARE), least_norm=True)):
        F = {leg: found.joints[leg]["force"][0, 2] for leg in SQUARE}
        near(F["A"] + F["C"], F["B"] + F["D"], 69.05, ROUNDING)
        near(sum(F.values()), 69.05, 69.05, ROUNDING)


# ---- a crankshaft on five bearings
BEARINGS = (0.0, 0.1, 0.2, 0.3, 0.4)


TIGHT, NARROW = ("pin", "cylinder"), ("ball", "line")  # bearings that hold against tilting too, or across alone


def crankshaft(kinds: tuple[str, str], stiffness: tuple[float, ...] | None = None) -> dict[str, Any]:
    """A shaft along z with two throws, turning evenly in five bearings, the first also along it; and pushed."""
    points = {f"m{k}": [0, 0, z] for k, z in enumerate(BEARINGS)}
    shapes = [{"type": "cylinder", "from": [0, 0, 0], "to": [0, 0, 0.4], "radius": 0.03, "mass": 9.0},
              {"type": "point", "at": [0.05, 0, 0.05], "mass": 2.0},
              {"type": "point", "at": [-0.05, 0, 0.25], "mass": 2.0}]  # fmt: skip
    joints: dict[str, Any] = {}
    for k in range(5):
        axis = {} if (kinds[0], k) == ("ball", 0) else {"axis": [0, 0, 1]}
        joints[f"m{k}"] = {"type": kinds[min(k, 1)], "from": f"ground.m{k}", "to": f"shaft.m{k}", **axis}
    if stiffness is not None:
        for k, value in enumerate(stiffness):
            joints[f"m{k}"]["stiffness"] = {"force": value}
    body = {"shapes": shapes, "points": {**points, "push": [0, 0, 0.05]}, "angular_velocity": [0, 0, 100.0]}
    return {
        "gravity": [0, -9.81, 0],
        "ground": {"points": points},
        "bodies": {"shaft": body},
        "joints": joints,
        "forces": {"gas": {"type": "force", "on": "shaft.push", "vector": [0, -1000.0, 0]}},
    }


@pytest.mark.parametrize("kinds", [TIGHT, NARROW])
def test_five_bearings(kinds: tuple[str, str]) -> None:
    """No single bearing across the shaft is certain, only sums; along it, and the motion, all is."""
    found = solved(crankshaft(kinds))
    assert found.model["redundant"] == (16 if kinds == TIGHT else 6)
    for k in range(5):
        block = found.joints[f"m{k}"]
        assert open_forces(found, f"m{k}") == {"x", "y"}
        assert ({"moment.x", "moment.y", "tilting"} <= set(block["open"])) == (kinds == TIGHT)
        near(block["force"][0, 2], 0.0, 1000.0, ROUNDING)
    near(found.foundation["force"][0, :2], (0, -(13 * 9.81 + 1000.0)), 1000.0, ROUNDING)
    for c in "xy":
        assert told_by_sums(found, {f"joints.m{k}.force.{c}": 1.0 for k in range(5)})
    assert not any(".moment." in n and ".force." in n for t, _ in sums(found) for n in t)


def across() -> tuple[np.ndarray, np.ndarray]:
    """What the bearings carry together, force and first moment along the shaft: in x, in y (weight, push)."""
    spun = 2.0 * 0.05 * 100.0**2 * np.array([0.0, 0.05 - 0.25])
    return -spun, np.array([13 * 9.81 + 1000.0, (9 * 0.2 + 2 * 0.05 + 2 * 0.25) * 9.81 + 1000.0 * 0.05])


def test_five_bearings_on_springs() -> None:
    """A rigid shaft on five springs across: F_k = k_k (d + θ z_k), by the two balances."""
    k, z = np.array([2e8, 1e8, 1e8, 1e8, 2e8]), np.array(BEARINGS)
    found = solved(crankshaft(NARROW, tuple(k.tolist())))
    S = np.array([[k.sum(), k @ z], [k @ z, k @ (z * z)]])
    for c, load in enumerate(across()):
        d, theta = np.linalg.solve(S, load)
        near([found.joints[f"m{n}"]["force"][0, c] for n in range(5)], k * (d + theta * z), 1000.0, 1e-11)
    assert "stiffness" in found.model["split"]
    assert all(block["open"] == [] for block in found.joints.values())


def test_five_bearings_rigid_against_tilting() -> None:
    """Stiffness in force alone: what does not tilt keeps the shaft level, forces go by stiffness, couples stay open."""
    k = np.array([2e8, 1e8, 1e8, 1e8, 2e8])
    found = solved(crankshaft(TIGHT, tuple(k.tolist())))
    for c, load in enumerate(across()):
        near([found.joints[f"m{n}"]["force"][0, c] for n in range(5)], k * load[0] / k.sum(), 1000.0, 1e-11)
    for name in found.joints:
        assert open_forces(found, name) == set()
        assert {"moment.x", "moment.y"} <= set(found.joints[name]["open"])
    assert told_by_sums(found, {f"joints.m{n}.moment.x": 1.0 for n in range(5)})


TWO_MOTORS = """
heun: 1
space: planar
gravity: [0, -9.81, 0]
ground: {points: {A: [0, 0, 0], D: [0.8, 0, 0]}}
bodies:
  left: {shapes: [{type: rod, from: [0, 0, 0], to: [0.3, 0, 0], mass: 1}], points: {a: [0, 0, 0], b: [0.3, 0, 0]}}
  right:
    shapes: [{type: rod, from: [0, 0, 0], to: [0.3, 0, 0], mass: 1}]
    points: {a: [0, 0, 0], b: [0.3, 0, 0]}
    near: {orientation: {axis: [0, 0, 1], angle: 60 deg}}
  coupler: {shapes: [{type: rod, from: [0, 0, 0], to: [0.8, 0, 0], mass: 2}], points: {l: [0, 0, 0], r: [0.8, 0, 0]}}
joints:
  A: {type: pin, from: ground.A, to: left.a}
  B: {type: pin, from: left.b, to: coupler.l}
  C: {type: pin, from: right.b, to: coupler.r}
  D: {type: pin, from: ground.D, to: right.a}
drives:
  one: {joint: A, angle: "60*deg + t"}
  two: {joint: D, angle: "60*deg + t"}
"""


def test_what_two_motors_share_is_open_on_the_ground_too() -> None:
    """Both cranks of a parallelogram are driven: the motors' torques are open, as drives and as elements; no pin's."""
    found = solved(TWO_MOTORS)
    elements = found.foundation["elements"]
    for joint, drive in (("A", "one"), ("D", "two")):
        assert np.isnan(found.joints[joint]["drive"]).all()
        assert np.isnan(elements[drive]["moment"][:, 2]).all()
        assert (elements[drive]["force"] == 0.0).all()
        assert (found.foundation["supports"][joint]["moment"] == 0.0).all()
        assert np.isnan(found.foundation["supports"][joint]["force"][:, 0]).all()
    weight, spinning = -9.81 * (0.075 + 0.875 + 2.0 * 0.55), 0.36 * np.sqrt(0.75)
    near(found.foundation["moment"][0, 2], weight + spinning, 20.0, 1e-12)
    assert not [term for one in found.certain_sums for term in one["terms"] if ".moment." in term]
