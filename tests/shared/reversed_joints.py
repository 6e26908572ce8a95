"""A spec whose joints have their axes reversed and their ends exchanged, with every sign that hangs on it.

The machine is the same: each coordinate has its sign or the opposite one. What nothing tells in the other way stays.
"""

from __future__ import annotations

import copy
import re
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from typing import Any, TypeAlias

import numpy as np

from tests.oracle.turns import Array
from tests.shared.retell import entries, in_expressions, times

Tree: TypeAlias = Any
ALONG = ("pin", "slide", "cylinder", "curve")  # whose coordinate has a sense
EITHER_END = ("pin", "slide", "cylinder", "ball", "weld", "rod", "universal", "cv")
OF_COORDINATES = ("angle", "rate", "travel", "speed")
OTHER_SIDE = {"left": "right", "right": "left"}
QUANTITY = re.compile(r"(?<![\w.])([A-Za-z]\w*)\.(angle|rate|travel|speed)(?!\w)")
OWN = re.compile(r"(?<![\w.])(angle|rate|speed)(?![\w.])")


@dataclass
class Reversal:
    """A scene with joints reversed: signs of the coordinates by joints; joints whose ends are exchanged.

    axes: signs of what is along a joint's axis, which need not have a coordinate. as_ratio: couplings that become a
    ratio; exchanged: those whose members are.
    """

    tree: Tree
    signs: dict[str, float] = field(default_factory=dict)
    axes: dict[str, float] = field(default_factory=dict)
    exchanged_ends: set[str] = field(default_factory=set)
    as_ratio: set[str] = field(default_factory=set)
    exchanged: set[str] = field(default_factory=set)

    def sign(self, joint: str) -> float:
        """Of a joint's coordinate; also of `joint.travel` and the like."""
        return self.signs.get(str(joint).partition(".")[0], 1.0)


def reversed_scene(
    tree: Tree, rng: np.random.Generator, attitudes: Mapping[str, Array], share: float = 0.6
) -> Reversal:
    """A scene told otherwise; attitudes (3, 3) of the bodies at its start; share: of joints that are reversed."""
    told = Reversal(copy.deepcopy(tree))
    tree = told.tree
    kept_ends = joints_with_fixed_ends(tree)
    with_sense = (*ALONG, "ball") if tree.get("space") == "planar" else ALONG
    turned: dict[str, float] = {}
    for name, joint in entries(tree, "joints"):
        turned[name] = -1.0 if rng.random() < share and name not in as_written(tree) else 1.0
        if turned[name] < 0.0:
            reverse_axis(tree, name, joint)
        told.signs[name] = turned[name] if joint["type"] in with_sense else 1.0
        if joint["type"] in EITHER_END and name not in kept_ends and rng.random() < share:
            exchange_ends(joint, attitudes, planar=tree.get("space") == "planar")
            told.exchanged_ends.add(name)
            told.signs[name] *= -1.0 if joint["type"] in with_sense else 1.0
    told.axes = {name: sign * (-1.0 if name in told.exchanged_ends else 1.0) for name, sign in turned.items()}
    in_expressions(tree, lambda word: QUANTITY.sub(lambda found: signed(told.sign(found[1]), found[0]), word))
    for block in ("drives", "stops", "latches"):
        for _, entry in entries(tree, block):
            reverse_values(entry, told.sign(entry.get("joint", "")))
    for name, joint in entries(tree, "joints"):
        reverse_values(joint.get("initial", {}), told.signs[name])
    for _, load in entries(tree, "forces"):
        reverse_load(tree, load, told.sign(load.get("joint", "")))
    for name, entry in entries(tree, "couplings"):
        COUPLINGS[entry["type"]](told, name, entry, rng, turned)
    for _, entry in entries(tree, "rolling"):
        if "axis" in entry and rng.random() < share:
            entry["axis"] = opposite(entry["axis"])
    return told


def opposite(vector: list[Any]) -> list[Any]:
    """A direction, the other way."""
    return [times(-1.0, x) for x in vector]


def signed(sign: float, word: str) -> str:
    """An expression, or its opposite."""
    return word if sign > 0.0 else f"(-{word})"


# Joints


def joints_with_fixed_ends(tree: Tree) -> set[str]:
    """Joints at whose `to` end, or `from` end, something stands that the other end does not have."""
    kept = {word for _, entry in entries(tree, "couplings") if entry["type"] == "cam" for word in entry["of"]}
    in_joints = [load for _, load in entries(tree, "forces") if "joint" in load]
    kept |= {load["joint"] for load in in_joints if {"rotor", "length"} & set(load)}
    kept |= {str(sensor["of"]).partition(".")[2] for _, sensor in entries(tree, "sensors")}
    return kept | as_written(tree) | {name for name, joint in entries(tree, "joints") if "stiffness" in joint}


def as_written(tree: Tree) -> set[str]:
    """Joints with bearings along their axis; universals with a spring about that of `from`: the other has none."""
    paired = {name for name, joint in entries(tree, "joints") if "bearings" in joint}
    sprung = {load["joint"] for _, load in entries(tree, "forces") if load["type"] == "turn_spring"}
    return paired | {name for name in sprung if tree["joints"][name]["type"] == "universal"}


def reverse_axis(tree: Tree, name: str, joint: dict[str, Any]) -> None:
    """The axis the other way round, and of a path its travel."""
    if joint["type"] == "curve":
        for key in "xyz":
            if isinstance(joint.get(key), str) and joint[key] in tree.get("tables", {}):
                joint[key] = reversed_table(tree, joint[key], f"{name}_{key}", 1.0)
        if "normal" in joint or "radius" in joint or joint.get("one_sided"):
            joint["normal"] = opposite(joint.get("normal", [0, 0, 1]))
        return
    if tree.get("space") == "planar" and joint["type"] in ("pin", "ball") and "axis" not in joint:
        joint["type"], joint["axis"] = "pin", [0, 0, 1]
    for key in ("axis", "to_axis", "normal"):
        if key in joint:
            joint[key] = opposite(joint[key])


def exchange_ends(joint: dict[str, Any], attitudes: Mapping[str, Array], *, planar: bool) -> None:
    """`from` becomes `to`, with directions in the axes of the new one."""
    a, b = joint["from"], joint["to"]
    joint["from"], joint["to"] = b, a
    if joint["type"] == "slide" and "to_axis" not in joint:
        Ra, Rb = (attitudes.get(owner(end), np.eye(3)) for end in (a, b))
        joint["axis"] = (Rb.T @ Ra @ np.array(joint["axis"], dtype=float)).tolist()
        if planar:
            joint["axis"][2] = 0.0
    elif "to_axis" in joint:
        joint["axis"], joint["to_axis"] = joint["to_axis"], joint["axis"]


def owner(end: Any) -> str:
    """The body of an end."""
    return str(end["body"] if isinstance(end, dict) else end.partition(".")[0])


def reversed_table(tree: Tree, name: str, new: str, y: float) -> str:
    """A table over the opposite of its argument, its values times y; its name."""
    table = copy.deepcopy(tree["tables"][name])
    table["x"] = [times(-1.0, x) for x in reversed(table["x"])]
    table["y"] = [times(y, value) for value in reversed(table["y"])]
    tree["tables"][f"{new}_back"] = table
    return f"{new}_back"


# What is told of their coordinates


def reverse_values(entry: dict[str, Any], sign: float) -> None:
    """Values and limits of a coordinate."""
    if sign > 0.0:
        return
    for key in OF_COORDINATES:
        if isinstance(entry.get(key), list):
            entry[key] = [None if x is None else times(-1.0, x) for x in reversed(entry[key])]
        elif key in entry:
            entry[key] = times(-1.0, entry[key])


def reverse_load(tree: Tree, load: dict[str, Any], sign: float) -> None:
    """A load in a joint, by its own sign, and laws by their own coordinates."""
    if sign > 0.0:
        return
    kind = load["type"]
    if kind == "torque":
        load["value"] = times(-1.0, load["value"])
    elif kind == "motor":
        if "curve" in load and load["curve"] in tree.get("tables", {}):
            load["curve"] = reversed_table(tree, load["curve"], f"{load['curve']}_motor", -1.0)
        elif "curve" in load:
            load["curve"] = own_law_reversed(load["curve"])
        else:
            load["curve"] = f"-(({load.pop('stall')})*(1 + rate/({load.pop('idle')})))"
    elif kind == "turn_spring" and "angle" in load:
        load["angle"] = times(-1.0, load["angle"])
    if kind in ("turn_spring", "damper"):
        for key in ("torque", "force"):
            if key in load:
                load[key] = own_law_reversed(load[key])


def own_law_reversed(law: Any) -> str:
    """A law by the own coordinate of what has it."""
    return f"-({OWN.sub(lambda found: f'(-{found[0]})', str(law))})"


# Couplings


def ratio(told: Reversal, name: str, entry: Tree, rng: np.random.Generator, _: Mapping[str, float]) -> None:
    entry["factors"] = [times(told.sign(word), f) for word, f in zip(entry["of"], entry["factors"], strict=True)]
    order = rng.permutation(len(entry["of"]))
    entry["of"], entry["factors"] = ([entry[key][k] for k in order] for key in ("of", "factors"))


def gear(told: Reversal, name: str, entry: Tree, rng: np.random.Generator, _: Mapping[str, float]) -> None:
    one, other = entry["of"]
    if "ratio" in entry:
        entry["ratio"] = times(told.sign(one) * told.sign(other), entry["ratio"])
    if rng.random() < 0.5:
        told.exchanged.add(name)
        entry["of"] = [other, one]
        if "teeth" in entry:
            entry["teeth"] = entry["teeth"][::-1]
        if "ratio" in entry:
            entry["ratio"] = f"1/({entry['ratio']})"
        if entry.get("helix") and is_external(told.tree, entry):
            entry["helix"] = times(-1.0, entry["helix"])


def is_external(tree: Tree, entry: Tree) -> bool:
    """Whether two wheels that mesh at a point lie on either side of it: their hands differ. A rack has its wheel's."""
    joints = [tree["joints"][word] for word in entry["of"]]
    if any(joint["type"] == "slide" for joint in joints):
        return False
    P, arms = np.array(entry["at"]["at"], dtype=float), []
    for joint in joints:
        A, n = on_body(tree, joint, entry["at"]["body"])
        arms.append((P - A) - (P - A) @ n / (n @ n) * n)
    return bool(arms[0] @ arms[1] < 0.0)


def on_body(tree: Tree, joint: Tree, body: str) -> tuple[Array, Array]:
    """A joint's point and axis on one of its bodies, in its axes."""
    end, key = ("from", "axis") if owner(joint["from"]) == body else ("to", "to_axis")
    at = joint[end]["at"] if isinstance(joint[end], dict) else place(tree, joint[end])
    return np.array(at, dtype=float), np.array(joint.get(key, joint.get("axis", [0, 0, 1])), dtype=float)


def place(tree: Tree, end: str) -> Any:
    """Where a named point stands in its body."""
    body, point = end.split(".")
    return (tree["ground"] if body == "ground" else tree["bodies"][body])["points"][point]


def screw(told: Reversal, name: str, entry: Tree, rng: np.random.Generator, _: Mapping[str, float]) -> None:
    if len(entry["of"]) == 2:
        entry["lead"] = times(told.sign(entry["of"][0]) * told.sign(entry["of"][1]), entry["lead"])
        if rng.random() < 0.5:
            entry["of"] = entry["of"][::-1]


def belt(told: Reversal, name: str, entry: Tree, rng: np.random.Generator, _: Mapping[str, float]) -> None:
    joints = [told.tree["joints"][word] for word in entry["of"]]
    (carrier, *_) = {*map(owner, ends(joints[0]))} & {*map(owner, ends(joints[1]))}
    (A, n), (B, _) = (on_body(told.tree, joint, carrier) for joint in joints)
    in_one_plane = told.tree.get("space") == "planar" or abs((B - A) @ n) < 1e-12  # else it runs in the first one's
    if in_one_plane and rng.random() < 0.5:
        told.exchanged.add(name)
        entry["of"], entry["radii"] = entry["of"][::-1], entry["radii"][::-1]


def differential(told: Reversal, name: str, entry: Tree, rng: np.random.Generator, _: Mapping[str, float]) -> None:
    signs = [told.sign(word) for word in entry["of"]]
    r = entry.get("ratio", -1)
    if len(set(signs)) > 1:
        told.as_ratio.add(name)
        factors = [times(s, f) for s, f in zip(signs, (1, f"-({r})", f"({r}) - 1"), strict=True)]
        told.tree["couplings"][name] = {"type": "ratio", "of": entry["of"], "factors": factors}
    elif rng.random() < 0.5:
        told.exchanged.add(name)
        one, other, carrier = entry["of"]
        entry |= {"of": [other, one, carrier], "ratio": f"1/({r})"}


def cam(told: Reversal, name: str, entry: Tree, rng: np.random.Generator, _: Mapping[str, float]) -> None:
    shaft, follower = (told.sign(word) for word in entry["of"])
    if shaft > 0.0 and follower > 0.0:
        return
    table = told.tree["tables"][entry["lift"]]
    if shaft > 0.0:
        told.tree["tables"][f"{name}_fall"] = {**table, "y": [times(-1.0, y) for y in table["y"]]}
        entry["lift"] = f"{name}_fall"
        return
    entry["lift"] = reversed_table(told.tree, entry["lift"], name, follower)
    if "phase" in entry:
        entry["phase"] = times(-1.0, entry["phase"])


def rope(told: Reversal, name: str, entry: Tree, rng: np.random.Generator, turned: Mapping[str, float]) -> None:
    """Its sheaves' axes the other way round, or those of their pins; listed from the other end."""
    planar = told.tree.get("space") == "planar"
    for stop in entry["through"]:
        if not isinstance(stop, dict) or "sheave" not in stop:
            continue
        sense = 1.0
        if "axis" in stop and rng.random() < 0.5:
            stop["axis"], sense = opposite(stop["axis"]), -1.0
        elif "axis" not in stop and not planar:
            body = owner(stop["sheave"])
            pins = [n for n, j in entries(told.tree, "joints") if j["type"] == "pin" and body in map(owner, ends(j))]
            sense = turned[pins[0]]
        if sense < 0.0 and stop.get("side") in OTHER_SIDE:
            stop["side"] = OTHER_SIDE[stop["side"]]
    if rng.random() < 0.5:
        told.exchanged.add(name)
        entry["through"] = entry["through"][::-1]
        for stop in entry["through"]:
            if isinstance(stop, dict) and stop.get("side") in OTHER_SIDE:
                stop["side"] = OTHER_SIDE[stop["side"]]


def ends(joint: Tree) -> tuple[Any, Any]:
    """Both ends of a joint."""
    return joint["from"], joint["to"]


COUPLINGS: dict[str, Callable[..., None]] = {
    "ratio": ratio, "gear": gear, "screw": screw, "belt": belt, "differential": differential, "cam": cam, "rope": rope,
}  # fmt: skip
