"""Changes after which most specs are scenes still: other sizes, joints, loads, starts; to hunt wrong numbers with."""

from __future__ import annotations

from collections.abc import Callable
from random import Random
from typing import Any

from tests.faults.mutate_spec import Mutation, change, drop_entry, is_number
from tests.faults.sources import Tree, spots

DIRECTED = {"pin": "axis", "slide": "axis", "cylinder": "axis", "line": "axis", "plane": "normal"}
KINDS = (*DIRECTED, "ball", "weld", "rod")
NOT_RESIZED = (
    "orientation",
    "inertia",
    "axis",
    "to_axis",
    "normal",
    "heun",
    "samples",
    "count",
    "tolerance",
    "matrix",
)
DIRECTIONS = ([1, 0, 0], [0, 1, 0], [0, 0, 1], [0, 0, -1], [1, 1, 0], [0.6, 0, 0.8], [0.3, -0.5, 0.7], [0, 1, 1e-7])


def resized(random: Random, tree: Tree) -> None:
    """A number half to twice as large, or a little moved; not where it would have to be done to others too."""
    found = [(box, key) for box, key in _free(tree) if is_number(box[key]) and not isinstance(box[key], str)]
    if found:
        box, key = random.choice(found)
        box[key] = (
            box[key] * random.uniform(0.5, 2.0) if random.random() < 0.7 else box[key] + random.uniform(-0.1, 0.1)
        )


def _free(tree: Tree) -> list[tuple[Any, Any]]:
    """Places outside of what belongs together."""
    if not isinstance(tree, dict):
        return []
    inner = [tree[key] for key in tree if key not in ("heun", "expect", "report", "title", "analysis")]
    boxes = [s for value in inner if isinstance(value, dict | list) for s in spots(value)]
    return [(box, key) for box, key in boxes if key not in NOT_RESIZED]


def other_joint(random: Random, tree: Tree) -> None:
    """A joint of another kind between the same points, with a direction of its own."""
    used = str(tree.get("drives", "")) + str(tree.get("stops", "")) + str(tree.get("forces", ""))
    joints = [
        joint for name, joint in (tree.get("joints") or {}).items() if isinstance(joint, dict) and name not in used
    ]
    if joints:
        joint = random.choice(joints)
        for key in ("axis", "normal", "to_axis", "initial", "length", "tension_only", "restitution"):
            joint.pop(key, None)
        joint["type"] = random.choice(KINDS)
        if joint["type"] in DIRECTED:
            joint[DIRECTED[joint["type"]]] = random.choice(DIRECTIONS)


def points(tree: Tree) -> list[str]:
    """Named points of bodies."""
    bodies = tree.get("bodies") or {}
    return [
        f"{name}.{point}"
        for name, body in bodies.items()
        if isinstance(body, dict)
        for point in body.get("points") or ()
    ]


def load_added(random: Random, tree: Tree) -> None:
    """One more load on some point, between two, or in a joint."""
    ends = points(tree)
    ground = [f"ground.{name}" for name in (tree.get("ground") or {}).get("points") or ()]
    if not ends:
        return
    vector = [random.uniform(-20, 20), random.choice((0, "5*sin(7*t)", "step(t - 0.1)*4")), random.uniform(-20, 20)]
    pair = {"from": random.choice(ends + ground), "to": random.choice(ends)}
    joints = [(n, j.get("type")) for n, j in (tree.get("joints") or {}).items() if isinstance(j, dict)]
    loads: list[dict[str, Any]] = [
        {"type": "force", "on": random.choice(ends), "vector": vector, "frame": random.choice(("world", "body"))},
        {"type": "couple", "on": random.choice(ends), "vector": vector, "frame": random.choice(("world", "body"))},
        {
            "type": "spring",
            **pair,
            "stiffness": random.uniform(1, 500),
            "length": random.choice((0.5, 0)),
            "damping": 1,
        },
        {
            "type": "bushing",
            **pair,
            "stiffness": [random.uniform(1, 500), 20, "3"],
            "turning": random.choice((5, [1, 2, 3])),
            "damping": 1,
            "preload": random.choice(([0, 0, 0], [1, 2, 3])),
        },
        {"type": "spring", **pair, "force": random.choice(("-20*(length - 0.5) - rate", "5/(1 + length)"))},
        {"type": "actuator", **pair, "value": random.choice((3, "2*cos(5*t)", "-4 if t > 0.2 else 4"))},
    ]
    for name, kind in joints:
        if kind in ("ball", "pin", "universal", "slide", "line", "plane"):
            loads.append({"type": "damper", "joint": name, "coefficient": random.uniform(0.01, 5)})
        if kind == "pin":
            loads.append({"type": "torque", "joint": name, "value": f"-3*{name}.angle"})
            loads.append({"type": "friction", "joint": name, "torque": random.choice((0.2, "t")), "speed": 0.05})
            loads.append(
                {"type": "motor", "joint": name, "curve": "3 - rate", "ratio": random.choice((1, -4)), "limit": 2}
            )
            loads.append({"type": "turn_spring", "joint": name, "stiffness": 20, "angle": 0.3, "damping": 0.1})
        if kind == "slide":
            loads.append({"type": "torque", "joint": name, "value": f"3 - {name}.speed"})
    forces = tree.get("forces")
    forces = tree["forces"] = forces if isinstance(forces, dict) else {}
    forces[f"more{len(forces)}"] = random.choice(loads)


def gravity(random: Random, tree: Tree) -> None:
    if tree.get("space") != "planar":
        tree["gravity"] = [random.choice((0, 3.0, -9.81)), random.choice((0, -9.81)), random.choice((0, -9.81))]


def moving(random: Random, tree: Tree) -> None:
    """A state becomes a motion, a motion another one."""
    analysis = tree.get("analysis")
    if not isinstance(analysis, dict) or analysis.get("type") in (None, "state", "motion"):
        tree["analysis"] = {"duration": random.choice((0.05, 0.2, 0.4)), "samples": 5}


def weight(random: Random, tree: Tree) -> None:
    """A mass and its inertia many times as large, or none of it about an axis."""
    bodies = [
        b for b in (tree.get("bodies") or {}).values() if isinstance(b, dict) and isinstance(b.get("inertia"), list)
    ]
    if bodies:
        body = random.choice(bodies)
        if random.random() < 0.5:
            body["inertia"] = random.choice(([0, 0, 0], [0, 1, 1], [1, 1, 0], [0.1, 0.1, 0.1]))
        else:
            change(
                random,
                body,
                lambda old: old * random.choice((1e-3, 30.0)),
                lambda v: v is body.get("mass") and not isinstance(v, str),
            )


def loop_closed(random: Random, tree: Tree) -> None:
    """One more bar or joint between two bodies, so that they are held more than once."""
    ends = points(tree) + [f"ground.{name}" for name in (tree.get("ground") or {}).get("points") or ()]
    joints = tree.get("joints")
    if len(ends) > 1 and isinstance(joints, dict):
        one, other = random.sample(ends, 2)
        kind = random.choice(("rod", "rod", "plane", "line", "ball"))
        joints[f"more{len(joints)}"] = {"type": kind, "from": one, "to": other} | (
            {DIRECTED[kind]: random.choice(DIRECTIONS)} if kind in DIRECTED else {}
        )


MUTATIONS: tuple[Mutation, ...] = (
    resized, resized, resized, other_joint, other_joint, load_added, load_added, load_added, gravity, moving, weight,
    loop_closed, drop_entry,
)  # fmt: skip
OF_HELD = (load_added, gravity, weight)  # of scenes whose state is held altogether


def changed(random: Random, tree: Tree, mutations: tuple[Callable[[Random, Tree], None], ...] = MUTATIONS) -> Tree:
    """The tree changed up to three times."""
    for _ in range(random.choice((0, 1, 1, 2, 2, 3))):
        random.choice(mutations)(random, tree)
    return tree
