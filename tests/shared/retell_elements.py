"""Machine elements told otherwise: turned, in other units, from the other side; a part of retell."""

from __future__ import annotations

import copy
import re
from collections.abc import Callable
from random import Random
from typing import Any, TypeAlias

import numpy as np

from tests.oracle.turns import Array

Tree: TypeAlias = Any  # mappings, lists, numbers and words
Tell = Callable[[Any, dict[str, tuple[int, int, int]]], None]
LENGTH, SPEED, FORCE, MOMENT, RATE = (0, 1, 0), (0, 1, -1), (1, 1, -2), (1, 2, -2), (0, 0, -1)
COUPLING = {"at": LENGTH, "lead": LENGTH, "radii": LENGTH, "radius": LENGTH, "pretension": FORCE, "length": LENGTH,
    "tension": FORCE,
}  # fmt: skip
# laws of what a load acts between, by its own names: key, what they stand for, what it is
OWN_LAWS = {
    "motor": ("curve", {"rate": RATE}, MOMENT), "spring": ("force", {"length": LENGTH, "rate": SPEED}, FORCE),
}  # fmt: skip
OWN = re.compile(r"(?<![\w.])(rate|length)(?![\w.])")


class NotTold(Exception):
    """This spec is not told in this way."""


def turned_bushing(load: dict[str, Any], Q: Array) -> None:
    """Its axes, which are its own whatever those of the bodies are."""
    for key in ("orientation", "to_orientation"):
        if key in load or key == "orientation":
            own = load.get(key, {"matrix": np.eye(3).tolist()})
            if "matrix" not in own:
                raise NotTold("a bushing turned by words")
            load[key] = {"matrix": (Q @ np.array(own["matrix"], dtype=float)).tolist()}


def turned_elements(tree: Tree, Q: Array, turn: Callable[..., None]) -> None:
    """Couplings, wheels and paths, turned by Q."""
    if np.linalg.det(Q) < 0.0 and (tree.get("couplings") or tree.get("rolling")):
        raise NotTold("elements in a mirror")
    for entry in (tree.get("couplings") or {}).values():
        turn(entry, "at", "normal", "axis", "to_axis")
        for place in entry.get("through", ()):
            if isinstance(place, dict):
                turn(place, "point", "sheave", "axis", "at")
    for entry in (tree.get("rolling") or {}).values():
        turn(entry, "wheel", "on", "axis", "normal")
    for name, joint in (tree.get("joints") or {}).items():
        if joint.get("type") == "curve":
            turned_path(tree, name, joint, Q)


def turned_path(tree: Tree, name: str, joint: dict[str, Any], Q: Array) -> None:
    """The tables of a path through all three coordinates at the same places: splines are linear in their values."""
    tables = [tree.get("tables", {}).get(joint.get(axis)) for axis in "xyz"]
    if not all(isinstance(table, dict) and table.get("x") == tables[0]["x"] and "y" in table for table in tables):
        raise NotTold("a path of other tables")
    way = Q @ np.array([table["y"] for table in tables], dtype=float)
    if "normal" in joint and np.linalg.det(Q) < 0.0:  # the left side is the right one in a mirror
        joint["normal"] = [-x for x in joint["normal"]]
    for axis, table, y in zip("xyz", tables, way, strict=True):
        own = f"{name}_{axis}_turned"
        tree["tables"][own] = {**table, "y": y.tolist()}
        joint[axis] = own


def elements_in_units(tree: Tree, tell: Tell, mass: float, length: float, time: float) -> None:
    """Couplings, wheels, paths, loads with laws of their own."""
    joints = tree.get("joints") or {}
    for entry in (tree.get("couplings") or {}).values():
        tell(entry, COUPLING)
        tell(entry.get("friction", {}), {"radius": LENGTH, "speed": RATE})
        for place in entry.get("through", ()):
            if isinstance(place, dict):
                tell(place, {"point": LENGTH, "sheave": LENGTH, "radius": LENGTH, "at": LENGTH})
        if entry.get("type") == "ratio":
            kinds = [joints.get(word, {}).get("type") for word in entry["of"]]
            if not {*kinds} <= {"pin", "slide"} or "is" in entry:
                raise NotTold("a ratio of other coordinates")
            if "slide" in kinds:  # then the sum is a length, and its load a force
                both = zip(entry["factors"], kinds, strict=True)
                entry["factors"] = [f if kind == "slide" else f * length for f, kind in both]
        if entry.get("type") == "cam" and joints.get(entry["of"][1], {}).get("type") == "slide":
            table_in_units(tree, entry["lift"], 1.0, length)
    for entry in (tree.get("rolling") or {}).values():
        tell(entry, {"wheel": LENGTH, "on": LENGTH, "radius": LENGTH})
    paths = [joint for joint in joints.values() if joint.get("type") == "curve"]
    for joint in paths:
        tell(joint, {"radius": LENGTH})
    for table in dict.fromkeys(joint.get(axis) for joint in paths for axis in "xyz"):  # several may share one
        table_in_units(tree, table, length, length)
    for load in (tree.get("forces") or {}).values():
        if load.get("type") == "motor":
            tell(load, {"limit": MOMENT})
        own_law_in_units(load, mass, length, time)


def own_law_in_units(load: dict[str, Any], mass: float, length: float, time: float) -> None:
    """The law of a motor by its rate, of a spring by its length and rate."""
    key, names, is_a = OWN_LAWS.get(str(load.get("type")), ("", {}, FORCE))
    if key not in load:
        return

    def factor(powers: tuple[int, int, int]) -> float:
        m, l, t = powers
        return mass**m * length**l * time**t

    told = OWN.sub(lambda found: f"({found[0]}/{factor(names[found[0]])!r})", str(load[key]))
    load[key] = f"({told})*{factor(is_a)!r}"


def table_in_units(tree: Tree, name: Any, x: float, y: float) -> None:
    """A table of numbers, both of its columns many times."""
    table = (tree.get("tables") or {}).get(name)
    if not isinstance(table, dict) or "file" in table or {"x_unit", "y_unit"} & set(table):
        raise NotTold("a table")
    table["x"], table["y"] = ([c * v for v in table[key]] for key, c in (("x", x), ("y", y)))


def from_the_other_side(tree: Tree, random: Random) -> tuple[Tree, str]:
    """A coupling whose members change places, and its name."""
    tree = copy.deepcopy(tree)
    able = [(n, e) for n, e in (tree.get("couplings") or {}).items() if e.get("type") in SIDES]
    if not able:
        raise NotTold("no coupling that may be")
    name, entry = random.choice(able)
    SIDES[entry["type"]](entry)
    return tree, name


def _reversed(*keys: str) -> Callable[[dict[str, Any]], None]:
    def change(entry: dict[str, Any]) -> None:
        for key in keys:
            if key in entry:
                entry[key] = entry[key][::-1]

    return change


def _gear(entry: dict[str, Any]) -> None:
    _reversed("of", "teeth")(entry)
    if "ratio" in entry:
        entry["ratio"] = f"1/({entry['ratio']})"
    if entry.get("helix"):
        raise NotTold("a helix")


def _differential(entry: dict[str, Any]) -> None:
    one, other, carrier = entry["of"]
    entry["of"], entry["ratio"] = [other, one, carrier], f"1/({entry.get('ratio', -1)})"


def _rope(entry: dict[str, Any]) -> None:
    entry["through"] = entry["through"][::-1]
    if any(isinstance(place, dict) and place.get("side") in ("left", "right") for place in entry["through"]):
        raise NotTold("a side by the way that it runs")


SIDES: dict[str, Callable[[dict[str, Any]], None]] = {
    "gear": _gear, "belt": _reversed("of", "radii"), "ratio": _reversed("of", "factors"),
    "differential": _differential, "rope": _rope,
}  # fmt: skip
