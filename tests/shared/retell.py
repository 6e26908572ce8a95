"""A spec told otherwise, as a tree of text and numbers: turned, mirrored, in other units, faster, renamed, reordered.

What a way of telling does not know how to tell raises NotTold. Numbers with units become parameters, so that they may
stand in expressions.
"""

from __future__ import annotations

import copy
import re
from collections.abc import Callable, Iterator, Mapping
from random import Random
from typing import Any, TypeAlias

import numpy as np

from tests.oracle.turns import Array
from tests.shared.retell_elements import NotTold, elements_in_units, turned_bushing, turned_elements

Tree: TypeAlias = Any  # mappings, lists, numbers and words
WITH_UNIT = re.compile(r"\s*[-+]?(\d+\.?\d*|\.\d+)([eE][-+]?\d+)?\s*[A-Za-z°µ%].*\Z")
TIME = re.compile(r"(?<![\w.])t(?![\w.])")
COORDINATE = re.compile(r"(?<![\w.])([A-Za-z]\w*)\.(rate|speed|travel)(?!\w)")
E1 = [0.36, -0.48, 0.8]  # e1 of sections that leave it to the body's axes, which turn


def plain(tree: Tree) -> Tree:
    """The spec with its numbers with units as parameters, and nothing expected of it."""
    tree = copy.deepcopy(tree)
    if not isinstance(tree, dict) or any(not isinstance(tree.get(key, {}), dict) for key in BLOCKS):
        raise NotTold("no scene")
    tree.pop("expect", None)
    parameters = tree.setdefault("parameters", {})
    for block in BLOCKS:
        for box, key in _leaves(tree.get(block, {})):
            word = box[key]
            if isinstance(word, str) and WITH_UNIT.match(word) and "(" not in word and "*" not in word.split(" ")[0]:
                name = f"quantity{len(parameters)}"
                parameters[name] = word
                box[key] = name
    return tree


BLOCKS = (
    "ground", "bodies", "joints", "drives", "forces", "impulses", "stops", "sections", "sensors", "analysis",
    "foundation", "couplings", "rolling", "latches",
)  # fmt: skip


def _leaves(value: Tree) -> Iterator[tuple[Any, Any]]:
    for key in list(value) if isinstance(value, dict) else range(len(value)):
        if isinstance(value[key], dict | list):
            yield from _leaves(value[key])
        else:
            yield value, key


def entries(tree: Tree, block: str) -> Iterator[tuple[str, dict[str, Any]]]:
    """The named entries of a block."""
    for name, entry in (tree.get(block) or {}).items():
        if not isinstance(entry, dict):
            raise NotTold(f"{block}.{name}")
        yield name, entry


def times(factor: float, value: Any) -> Any:
    """A number or expression, many times."""
    if isinstance(value, str):
        return value if factor == 1.0 else f"({factor!r})*({value})"
    if isinstance(value, bool) or not isinstance(value, int | float):
        raise NotTold(f"{value!r} is no number")
    return factor * value


def plus(parts: list[Any]) -> Any:
    """A sum of numbers and expressions."""
    if all(not isinstance(part, str) for part in parts):
        return sum(parts)
    return " + ".join(f"({part})" if isinstance(part, str) else repr(float(part)) for part in parts)


def combined(Q: Array, v: Any) -> list[Any]:
    """Q v."""
    if not isinstance(v, list) or len(v) != 3:
        raise NotTold(f"{v!r} is no vector")
    rows = [[times(float(q), c) for q, c in zip(row, v, strict=True) if q != 0.0] for row in Q]
    return [plus(row) for row in rows]


def conjugated(Q: Array, M: Any) -> list[list[Any]]:
    """Q M Qᵀ."""
    if not isinstance(M, list) or len(M) != 3:
        raise NotTold("no matrix")
    left = [combined(Q, [M[i][j] for i in range(3)]) for j in range(3)]  # columns of Q M
    return [combined(Q, [left[k][i] for k in range(3)]) for i in range(3)]


AXIAL = {"angular_velocity", "couple"}  # keys of vectors that a mirror turns the other way round as well
POLAR_AXES = ("slide", "line")  # joints whose axis is a direction to slide; a pin's is a sense of turning


def turned(tree: Tree, Q: Array) -> Tree:
    """World and bodies' axes turned by Q: every vector v is Q v, every attitude R is Q R Qᵀ.

    Where det Q is -1 the scene is mirrored: axial vectors v are -Q v, angles and travels stay.
    """
    tree, det = copy.deepcopy(tree), float(np.sign(np.linalg.det(Q)))
    if tree.get("space", "auto") == "planar":
        raise NotTold("planar")

    def turn(box: Any, *keys: str, axial: bool = False) -> None:
        for key in keys:
            way = det * Q if axial or key in AXIAL else Q
            if isinstance(box.get(key), list):
                box[key] = combined(way, box[key])
            elif isinstance(box.get(key), dict) and "vector" in box[key]:
                box[key]["vector"] = combined(way, box[key]["vector"])
            elif isinstance(box.get(key), dict) and "at" in box[key]:
                turn(box[key], "at")

    turn(tree, "gravity")
    for _, body in [("ground", tree.get("ground", {})), *entries(tree, "bodies")]:
        turn(body, "center", "position", "velocity", "angular_velocity")
        turn(body.get("points", {}), *body.get("points", {}))
        _turn_mass(body, Q)
        for pose in (body, body.get("near", {})):
            turn(pose, "position") if pose is not body else None
            if "orientation" in pose:
                pose["orientation"] = turned_attitude(Q, pose["orientation"])
        for shape in body.get("shapes", []):
            turn(shape, "from", "to", "center", "at")
            if shape.get("type") == "box":
                own = shape.get("orientation", {"matrix": np.eye(3).tolist()})
                if "matrix" not in own:
                    raise NotTold("a box that is turned by words")
                shape["orientation"] = {"matrix": (det * Q @ np.array(own["matrix"], dtype=float)).tolist()}
    for _, joint in entries(tree, "joints"):
        if det < 0.0 and joint.get("type") == "cylinder":
            raise NotTold("an axis with two senses")
        turn(joint, "from", "to", "normal")
        turn(joint, "axis", "to_axis", axial=joint.get("type") not in POLAR_AXES)
        if "bearings" in joint and np.linalg.det(Q) < 0.0:
            raise NotTold("places along an axis, in a mirror")
        if isinstance(joint.get("stiffness"), dict) and any(isinstance(s, list) for s in joint["stiffness"].values()):
            raise NotTold("stiffness by direction")
    for block in ("forces", "impulses"):
        for _, load in entries(tree, block):
            turn(load, "from", "to", "on", "vector", "to_vector", "couple", axial=load.get("type") == "couple")
            if load.get("type") == "bushing":
                turned_bushing(load, Q)
    turned_elements(tree, Q, turn)
    for _, cut in entries(tree, "sections"):
        turn(cut, "at", "from", "to", "normal", "first_axis", "reduce_to")
        if "piece" in cut:
            turn(cut["piece"], "center")
            _turn_mass(cut["piece"], Q)
    for _, sensor in entries(tree, "sensors"):
        turn(sensor, "point")
    turn(tree.get("foundation", {}), "about")
    if any(isinstance(what, dict) and str(what.get("of"))[-2:] in COMPONENTS for what in _conditions(tree)):
        raise NotTold("a condition on a component")
    return tree


COMPONENTS = {".x", ".y", ".z", ".0", ".1", ".2"}


def _turn_mass(body: dict[str, Any], Q: Array) -> None:
    inertia = body.get("inertia")
    if inertia is None:
        return
    if "deviation" in body or not isinstance(inertia, list):
        raise NotTold("deviation")
    if not isinstance(inertia[0], list):
        inertia = [[inertia[i] if i == j else 0 for j in range(3)] for i in range(3)]
    body["inertia"] = conjugated(Q, inertia)


def turned_attitude(Q: Array, told: Mapping[str, Any]) -> dict[str, Any]:
    """Q R Qᵀ of an attitude."""
    axial = float(np.sign(np.linalg.det(Q))) * Q
    match dict(told):
        case {"axis": axis, "angle": angle}:
            return {"axis": combined(axial, axis), "angle": angle}
        case {"quaternion": [w, *v]}:
            return {"quaternion": [w, *combined(axial, v)]}
        case {"rodrigues": v}:
            return {"rodrigues": combined(axial, v)}
        case {"matrix": M}:
            return {"matrix": conjugated(Q, M)}
    raise NotTold("Euler's angles")


def with_first_axes(tree: Tree) -> Tree:
    """The spec with e1 of every section stated."""
    tree = copy.deepcopy(tree)
    for _, cut in entries(tree, "sections"):
        cut.setdefault("first_axis", list(E1))
    return tree


Powers = tuple[int, int, int]  # of mass, length, time
MASS, LENGTH, SPEED, FORCE, MOMENT = (1, 0, 0), (0, 1, 0), (0, 1, -1), (1, 1, -2), (1, 2, -2)
TIME_ITSELF, RATE, NOTHING, INERTIA = (0, 0, 1), (0, 0, -1), (0, 0, 0), (1, 2, 0)
THRUST_DAMPING, TORQUE_DAMPING, PER_LENGTH = (1, 0, -1), (1, 2, -1), (1, 0, -2)
SHAPE = {
    **dict.fromkeys(("from", "to", "center", "at", "size", "radius", "inner_radius", "to_radius"), LENGTH),
    "mass": MASS, "density": (1, -3, 0), "line_density": (1, -1, 0),
}  # fmt: skip
BODY = {
    "mass": MASS, "center": LENGTH, "inertia": INERTIA, "deviation": INERTIA, "position": LENGTH, "velocity": SPEED,
    "angular_velocity": RATE,
}  # fmt: skip
COORDINATES = {"angle": NOTHING, "rate": RATE, "travel": LENGTH, "speed": SPEED, "length": LENGTH}
IMPULSE = {"vector": (1, 1, -1), "couple": (1, 2, -1), "time": TIME_ITSELF}
ANALYSIS = dict.fromkeys(("duration", "times", "step"), TIME_ITSELF)
ENDS = dict.fromkeys(("from", "to", "on", "at", "reduce_to", "wheel", "point", "sheave"), LENGTH)
# of loads along a line, and of those about an axis, which differ where a joint may slide or turn
SLIDING: dict[str, dict[str, Powers]] = {
    "force": {"vector": FORCE}, "couple": {"vector": MOMENT}, "torque": {"value": FORCE}, "actuator": {"value": FORCE},
    "spring": {"stiffness": PER_LENGTH, "damping": THRUST_DAMPING, "length": LENGTH},
    "damper": {"coefficient": THRUST_DAMPING}, "friction": {"force": FORCE, "speed": SPEED, "length": LENGTH},
    "distributed": {"vector": PER_LENGTH, "to_vector": PER_LENGTH, "from": LENGTH, "to": LENGTH},
    "bushing": {
        "stiffness": PER_LENGTH, "damping": THRUST_DAMPING, "preload": FORCE, "turning": MOMENT,
        "turning_damping": TORQUE_DAMPING, "turning_preload": MOMENT, "coupling": FORCE, "coupling_damping": (1, 1, -1),
    },
}  # fmt: skip
TURNING: dict[str, dict[str, Powers]] = SLIDING | {
    "torque": {"value": MOMENT}, "turn_spring": {"stiffness": MOMENT, "damping": TORQUE_DAMPING},
    "damper": {"coefficient": TORQUE_DAMPING, "sliding": THRUST_DAMPING},
    "friction": {"torque": MOMENT, "force": FORCE, "speed": RATE, "radius": LENGTH},
}  # fmt: skip
SLIDES = ("slide", "line", "plane")


def in_units(tree: Tree, mass: float = 1.0, length: float = 1.0, time: float = 1.0) -> Tree:
    """The same in units of which the old ones are so many: a mass of 1 is called `mass`, and so on."""
    tree = copy.deepcopy(tree)

    def tell(box: Any, table: Mapping[str, Powers]) -> None:
        for key, (m, l, t) in table.items():
            if key in box and not (key in ENDS and isinstance(box[key], str)):
                box[key] = _times(mass**m * length**l * time**t, box[key])

    in_expressions(tree, lambda word: _in_old_units(word, length, time))
    tell(tree, {"gravity": (0, 1, -2)})
    for _, body in [("ground", tree.get("ground", {})), *entries(tree, "bodies")]:
        tell(body, BODY)
        tell(body, {"points": LENGTH})
        tell(body.get("near", {}), {"position": LENGTH})
        for shape in body.get("shapes", []):
            tell(shape, SHAPE)
    for _, joint in entries(tree, "joints"):
        if "stiffness" in joint and (mass, length) != (1.0, 1.0):
            raise NotTold("stiffness of a joint")
        tell(joint, {**ENDS, "length": LENGTH})
        tell(joint.get("initial", {}), COORDINATES)
        tell(joint.get("bearings", {}), {"at": LENGTH})
    for block in ("drives", "stops", "latches"):
        for _, entry in entries(tree, block):
            tell(entry, COORDINATES)
    elements_in_units(tree, tell, mass, length, time)
    for _, load in entries(tree, "forces"):
        slides = tree["joints"].get(load.get("joint"), {}).get("type") in SLIDES
        table = (SLIDING if slides else TURNING).get(str(load.get("type")), {})
        tell(load, table)
        tell(load, {key: powers for key, powers in ENDS.items() if key not in table})
    for _, blow in entries(tree, "impulses"):
        tell(blow, {**IMPULSE, "on": LENGTH})
    for _, cut in entries(tree, "sections"):
        cut.pop("strength", None)
        if "properties" in cut and length != 1.0:
            raise NotTold("a cross-section")
        tell(cut, {**ENDS, "modulus": (1, -1, -2)})
        tell(cut.get("piece", {}), BODY)
    for _, sensor in entries(tree, "sensors"):
        tell(sensor, ENDS)
    tell(tree.get("foundation", {}), {"about": LENGTH})
    if any(isinstance(value, dict) and "of" in value for value in _conditions(tree)):
        raise NotTold("a condition on results")
    tell(tree.get("analysis", {}), ANALYSIS)
    return tree


def _times(factor: float, value: Any) -> Any:
    """Numbers and expressions many times, also in vectors, limits, named places and {body, at}."""
    if isinstance(value, dict):
        return {k: v if k in ("body", "frame") else _times(factor, v) for k, v in value.items()}
    if isinstance(value, list):
        return [_times(factor, v) for v in value]
    return value if value is None else times(factor, value)


def _in_old_units(word: str, length: float, time: float) -> str:
    """An expression whose time and coordinates are told in new units."""
    of = {"rate": 1.0 / time, "speed": length / time, "travel": length}

    def coordinate(found: re.Match[str]) -> str:
        factor = of[found[2]]
        return found[0] if factor == 1.0 else f"({found[0]}/{factor!r})"

    word = word if time == 1.0 else TIME.sub(f"(t/{time!r})", word)
    return COORDINATE.sub(coordinate, word)


def faster(tree: Tree, c: float) -> Tree:
    """Everything c times as fast, and loads c² times as large: Heun's k -> c² k with σ -> c σ."""
    return in_units(tree, time=1.0 / c)


def later(tree: Tree, by: float, state: Mapping[str, Mapping[str, Any]]) -> Tree:
    """What follows from the state at an instant `by`, as a spec of its own that starts there.

    state: position, quaternion, velocity and angular velocity of every body at that instant.
    """
    tree = copy.deepcopy(tree)
    if any(tree.get(block) for block in ("impulses", "stops", "latches")) or any(True for _ in _conditions(tree)):
        raise NotTold("what depends on the past")
    for _, joint in entries(tree, "joints"):
        if (
            joint.get("tension_only")
            or joint.get("one_sided")
            or ("to_axis" in joint and joint.get("type") not in ("universal", "cv"))
        ):
            raise NotTold("what depends on the start")
        joint.pop("initial", None)
    for _, drive in entries(tree, "drives"):
        if {"zero", "rate", "speed"} & set(drive):
            raise NotTold("what depends on the start")
    in_expressions(tree, lambda word: TIME.sub(f"(t + {by!r})", word))
    for name, body in entries(tree, "bodies"):
        now = state[name]
        body.pop("near", None)
        body["orientation"] = {"quaternion": now["quaternion"]}
        for key in ("position", "velocity", "angular_velocity"):
            body[key] = now[key]
    analysis = tree["analysis"]
    if "times" in analysis:
        analysis["times"] = [t - by for t in analysis["times"] if t >= by]
    return tree


def _conditions(tree: Tree) -> Iterator[Any]:
    analysis = tree.get("analysis") or {}
    if "until" in analysis:
        yield analysis["until"]
    yield from (analysis.get("events") or {}).values()


def in_expressions(tree: Tree, change: Callable[[str], str]) -> None:
    """Rewrite every text that may be an expression in time."""
    for block, keys in IN_TIME.items():
        boxes = [tree.get(block, {})] if block == "analysis" else [entry for _, entry in entries(tree, block)]
        for box in boxes:
            for key in keys & set(box):
                box[key] = _rewritten(box[key], change)


IN_TIME = {
    "drives": {"angle", "travel", "length", "rate", "speed"},
    "forces": {"vector", "to_vector", "value", "stiffness", "damping", "coefficient", "torque", "force"},
    "impulses": {"when"},
    "latches": {"when", "release"},
    "analysis": {"until", "events"},
}  # fmt: skip


def _rewritten(value: Any, change: Callable[[str], str]) -> Any:
    if isinstance(value, list):
        return [_rewritten(v, change) for v in value]
    if isinstance(value, dict):
        return {key: _rewritten(v, change) if key != "of" else v for key, v in value.items()}
    return change(value) if isinstance(value, str) else value


def reordered(tree: Tree, random: Random) -> Tree:
    """The entries of all blocks, and the shapes of bodies, in another order."""
    tree = copy.deepcopy(tree)
    for block in (
        "parameters",
        "bodies",
        "joints",
        "drives",
        "forces",
        "impulses",
        "stops",
        "sections",
        "sensors",
        "tables",
        "couplings",
        "rolling",
        "latches",
    ):
        if isinstance(tree.get(block), dict):
            tree[block] = _shuffled(random, tree[block])
    for _, body in entries(tree, "bodies"):
        if isinstance(body.get("shapes"), list):
            random.shuffle(body["shapes"])
        if isinstance(body.get("points"), dict):
            body["points"] = _shuffled(random, body["points"])
    return _shuffled(random, tree)


def _shuffled(random: Random, box: dict[str, Any]) -> dict[str, Any]:
    keys = list(box)
    random.shuffle(keys)
    return {key: box[key] for key in keys}


NAMED_BLOCKS = ("bodies", "joints", "drives", "forces", "impulses", "stops", "sections")


def renamed(tree: Tree, random: Random) -> tuple[Tree, dict[str, str]]:
    """The entries under other names and in another order, and the new names by the old."""
    names = [name for block in NAMED_BLOCKS for name, _ in entries(tree, block)]
    if len(set(names)) < len(names) or {"tables", "sensors"} & set(tree):
        raise NotTold("one name for two")
    new = dict(zip(names, (f"{random.choice('aZkx')}n{k}" for k in random.sample(range(900), len(names))), strict=True))
    words = re.compile(r"(?<![\w.])(?:" + "|".join(map(re.escape, names)) + r")(?![\w])|(?<=\.)(?:"
                       + "|".join(map(re.escape, names)) + r")(?=\.)")  # fmt: skip

    def told(key: str, value: Any) -> Any:
        if isinstance(value, dict):
            return {k: told(k, v) for k, v in value.items()}
        if isinstance(value, list):
            return [told(key, v) for v in value]
        return words.sub(lambda found: new[found[0]], value) if isinstance(value, str) and key not in WORDS else value

    other = {key: told(key, value) for key, value in copy.deepcopy(tree).items()}
    for block in NAMED_BLOCKS:
        if block in other:
            other[block] = {new[name]: entry for name, entry in other[block].items()}
    return reordered(other, random), new


WORDS = frozenset({"type", "frame", "title", "side", "space"})  # keys whose words name nothing of the scene


def turn_of(random: Random) -> Array:
    """A turn: a quarter or two about the axes, or any."""
    from tests.oracle.turns import random_rotation

    if random.random() < 0.3:
        return np.array(
            random.choice(([[0, -1, 0], [1, 0, 0], [0, 0, 1]], [[0, 0, 1], [1, 0, 0], [0, 1, 0]])), dtype=float
        )
    return random_rotation(np.random.default_rng(random.randrange(2**32)))


def in_halves(tree: Tree, random: Random) -> Tree:
    """One body as two of half its mass, welded together."""
    tree = copy.deepcopy(tree)
    cut = {entry.get("body") for _, entry in entries(tree, "sections")}
    whole = [
        (name, body) for name, body in entries(tree, "bodies") if {"mass", "shapes"} & set(body) and name not in cut
    ]
    if not whole:
        raise NotTold("all bodies are cut")
    name, body = random.choice(whole)
    for box in (body, *body.get("shapes", [])):
        for key in HALVED & set(box):
            box[key] = _halved(box[key])
    at = copy.deepcopy(body.get("center", [0, 0, 0]))
    own = {key: copy.deepcopy(body[key]) for key in OF_MASS & set(body)}
    tree["bodies"]["half"] = {**own, "points": {"c": at}}
    for key in {"near", "position", "orientation"} & set(body):
        tree["bodies"]["half"][key] = copy.deepcopy(body[key])
    tree.setdefault("joints", {})["seam"] = {"type": "weld", "from": {"body": name, "at": at}, "to": "half.c"}
    return tree


HALVED = {"mass", "inertia", "deviation", "density", "line_density"}
OF_MASS = {"mass", "center", "inertia", "deviation", "shapes"}


def _halved(value: Any) -> Any:
    return [_halved(v) for v in value] if isinstance(value, list) else times(0.5, value)


def from_the_other_end(tree: Tree, random: Random) -> tuple[Tree, str]:
    """A joint whose ends change places, and its name."""
    tree = copy.deepcopy(tree)
    planar = tree.get("space", "auto") == "planar"
    named = {entry.get("joint") for _, entry in entries(tree, "couplings")}
    ends = [
        (n, j)
        for n, j in entries(tree, "joints")
        if n not in named
        if j.get("type") in ("rod", "weld") or (j.get("type") == "ball" and not planar)
    ]
    if not ends:
        raise NotTold("no joint that may be")
    name, joint = random.choice(ends)
    joint["from"], joint["to"] = joint["to"], joint["from"]
    return tree, name
