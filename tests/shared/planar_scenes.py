"""Random scenes with `space: planar`, as text: every joint kind, load and drive that a plane has, at any height."""

from __future__ import annotations

from typing import Any

import numpy as np

from tests.oracle.values import to_yaml

TREE = ("pin", "slide", "line", "plane", "weld", "pin", "pin", "free")
CUT = ("rod", "pin", "line", "rope", "slide", "rod")


class Flat:
    """A scene under way: bodies in the world's xy plane, each hung on an earlier one."""

    def __init__(self, seed: int) -> None:
        self.rng = np.random.default_rng(seed)
        self.places: dict[str, tuple[Any, float]] = {"ground": (np.zeros(2), 0.0)}
        self.bodies: dict[str, Any] = {}
        self.joints: dict[str, Any] = {}
        self.kinds: dict[str, str] = {}
        self.starts: dict[str, float] = {}

    def at(self, body: str, place: Any, height: float) -> dict[str, Any]:
        """An end of a joint: the body's point at a place in the world."""
        origin, angle = self.places[body]
        c, s = np.cos(angle), np.sin(angle)
        x, y = place - origin
        return {"body": body, "at": [float(c * x + s * y), float(c * y - s * x), height]}

    def along(self, body: str, direction: Any) -> list[float]:
        """A direction in the body's axes."""
        angle = self.places[body][1]
        c, s = np.cos(angle), np.sin(angle)
        return [float(c * direction[0] + s * direction[1]), float(c * direction[1] - s * direction[0]), 0.0]

    def body(self, k: int) -> str:
        """A body somewhere, with its mass anywhere in it."""
        name, rng = f"b{k}", self.rng
        self.places[name] = rng.uniform(-1.0, 1.0, 2) + np.array([k, 0.0]), float(rng.uniform(-3.0, 3.0))
        self.bodies[name] = {
            "mass": float(rng.uniform(0.5, 3.0)),
            "center": [*rng.uniform(-0.3, 0.3, 2).tolist(), float(rng.uniform(-0.2, 0.2))],
            "inertia": float(rng.uniform(0.05, 0.4)),
            "points": {"p": [*rng.uniform(-0.5, 0.5, 2).tolist(), float(rng.uniform(-0.3, 0.3))]},
            "position": [*self.places[name][0].tolist(), 0.0],
            "orientation": {"axis": [0, 0, 1], "angle": self.places[name][1]},
        }
        return name

    def join(self, name: str, kind: str, a: str, b: str) -> None:
        """A joint that fits where its two bodies stand."""
        rng = self.rng
        place, shift, angle = rng.uniform(-1.0, 2.0, 2), rng.uniform(0.2, 0.8), rng.uniform(-3.0, 3.0)
        direction = np.array([np.cos(angle), np.sin(angle)])
        across = np.array([-direction[1], direction[0]])
        low, high = rng.uniform(-0.4, 0.4, 2)
        away = kind in ("slide", "line", "plane", "rod", "rope")
        there = place + (shift * (across if kind == "plane" else direction) if away else 0.0)
        joint: dict[str, Any] = {"type": "rod" if kind == "rope" else kind, "from": self.at(a, place, float(low))}
        joint["to"] = self.at(b, there, float(high if kind in ("rod", "rope") else low))
        if kind in ("slide", "line"):
            joint["axis"] = self.along(a, direction)
        if kind == "slide":
            joint["to_axis"] = self.along(b, direction)
        if kind == "plane":
            joint["normal"] = self.along(a, direction)
        if kind == "rope":
            joint |= {"tension_only": True, "restitution": 0.3, "length": 0.05 + float(np.hypot(shift, high - low))}
        self.joints[name], self.kinds[name] = joint, kind
        self.starts[name] = {"slide": float(shift), "rod": float(np.hypot(shift, high - low))}.get(kind, 0.0)

    def driven(self, joint: str) -> dict[str, Any]:
        """A coordinate's course in time, from where it starts at rest."""
        start, key = self.starts[joint], {"pin": "angle", "slide": "travel", "rod": "length"}[self.kinds[joint]]
        course = {key: f"{start!r} + 0.1*(1 - cos(3*t))"}
        return {**course, "zero": "assembled"} if key == "angle" else course


def flat_scene(seed: int, times: tuple[float, ...] = (0.0, 0.15, 0.3)) -> str:
    """A scene declared planar: a tree of bodies, loops where freedoms are left for them, loads, drives, stops."""
    scene = Flat(seed)
    rng, n = scene.rng, int(scene.rng.integers(3, 6))
    for k in range(n):
        kind = TREE[0] if k == 0 else TREE[int(rng.integers(len(TREE)))]
        body = scene.body(k)
        if kind != "free":
            on = ["ground", *scene.bodies][int(rng.integers(0, k + 1))]
            scene.join(f"j{k}", kind, *((on, body) if rng.random() < 0.7 else (body, on)))
    freedoms = 3 * n - sum({"pin": 2, "slide": 2, "line": 1, "plane": 1, "weld": 3}[k] for k in scene.kinds.values())
    for k in range(3):
        kind = CUT[int(rng.integers(len(CUT)))]
        taken = {"rod": 1, "pin": 2, "line": 1, "rope": 0, "slide": 2}[kind]
        if freedoms - taken < 2:
            break
        ends = rng.choice(["ground", *scene.bodies], 2, replace=False).tolist()
        scene.join(f"c{k}", kind, *ends)
        freedoms -= taken
    forces, more = loads(scene), {}
    tree = [name for name in scene.joints if name[0] == "j"]
    moving = [name for name in tree if scene.kinds[name] in ("pin", "slide")]
    if freedoms > 2 and len(moving) > 1 and rng.random() < 0.5:
        more["drives"] = {"motor": {"joint": moving[-1], **scene.driven(moving[-1])}}
    elif scene.kinds.get("c0") == "rod":
        more["drives"] = {"jack": {"joint": "c0", **scene.driven("c0")}}
    if rng.random() < 0.5:
        key = "angle" if scene.kinds["j0"] == "pin" else "travel"
        more["stops"] = {"buffer": {"joint": "j0", key: [-30.0, 30.0], "restitution": 0.4}}
    analysis = {"times": list(times), "tolerance": 1e-9}
    plane = {"space": "planar", "gravity": [1.0, -9.81, 0.0]}
    return to_yaml(
        {**plane, "bodies": scene.bodies, "joints": scene.joints, "forces": forces, **more, "analysis": analysis}
    )


def loads(scene: Flat) -> dict[str, Any]:
    """One of each kind of load that has a place in the scene."""
    names = list(scene.bodies)
    a, b = names[0], names[-1]
    found: dict[str, Any] = {
        "push": {"type": "force", "on": f"{b}.p", "vector": ["3*cos(2*t)", 1.0, 0.0]},
        "carried": {"type": "force", "on": f"{a}.p", "vector": [1.0, -2.0, 0.0], "frame": "body"},
        "twist": {"type": "couple", "on": a, "vector": [0.0, 0.0, "0.5*t"]},
        "spring": {
            "type": "spring", "from": f"{a}.p", "to": f"{b}.p", "stiffness": 20.0, "length": 0.5, "damping": 0.3,
        },
        "ram": {"type": "actuator", "from": f"{b}.p", "to": f"{a}.p", "value": "2*sin(4*t)"},
    }  # fmt: skip
    for name, kind in scene.kinds.items():
        if kind in ("pin", "slide"):
            key = "torque" if kind == "pin" else "force"
            found[f"drag_{name}"] = {"type": "damper", "joint": name, "coefficient": 0.2}
            found[f"rub_{name}"] = {"type": "friction", "joint": name, key: 0.3, "speed": 0.1}
            found[f"motor_{name}"] = {"type": "torque", "joint": name, "value": "sin(t)"}
    return found
