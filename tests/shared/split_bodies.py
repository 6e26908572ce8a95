"""Scenes whose bodies are two that are welded together: the one hangs as the body did, the other has all else of it."""

from __future__ import annotations

import copy
from typing import Any

import numpy as np

from heuncli.results.results import Array
from tests.oracle.turns import random_rotation

Scene = dict[str, Any]
TURNED = ("pin", "ball", "cylinder")  # joints whose directions are told in either body's axes


def split(scene: Scene, rng: np.random.Generator) -> Scene:
    """A scene that holds its state, with all bodies split that no coupling looks for by the joint they hang on."""
    scene = copy.deepcopy(scene)
    couplings = scene.get("couplings", {}).values()
    bound = {
        owner(p["sheave"]) for c in couplings for p in c.get("through", ()) if isinstance(p, dict) and "sheave" in p
    }
    bound |= {str(c["joint"]).removeprefix("j_") for c in couplings if "joint" in c}
    for name in [*scene["bodies"]]:
        joint = scene["joints"].get(f"j_{name}")
        if joint is not None and name not in bound:
            split_off(scene, rng, name, joint)
    return scene


def split_off(scene: Scene, rng: np.random.Generator, name: str, joint: Scene) -> None:
    """Let a body of its own hang on a joint in place of another, which is welded to it."""
    side = "to" if owner(joint["to"]) == name else "from"
    if side == "from" and joint["type"] == "curve":  # the path is the body's
        return
    body, base, d = scene["bodies"][name], f"base_{name}", rng.uniform(-0.3, 0.3, 3)
    R, Q = np.array(body["orientation"]["matrix"]), random_rotation(rng)
    Q = Q if joint["type"] in TURNED else np.eye(3)
    spin = np.array(body["angular_velocity"])
    scene["bodies"][base] = {
        "mass": 0.5, "center": [0.1, 0, 0], "inertia": [0.01, 0.02, 0.025], "points": {},
        "position": (np.array(body["position"]) + R @ d).tolist(), "orientation": {"matrix": (R @ Q).tolist()},
        "velocity": (np.array(body["velocity"]) + np.cross(spin, R @ d)).tolist(), "angular_velocity": spin.tolist(),
    }  # fmt: skip
    scene["joints"][f"w_{name}"] = {
        "type": "weld",
        "from": {"body": base, "at": [0, 0, 0]},
        "to": {"body": name, "at": d.tolist()},
    }
    joint[side] = {"body": base, "at": (Q.T @ (place(body, joint[side]) - d)).tolist()}
    if joint["type"] in ("pin", "cylinder"):
        joint.setdefault("to_axis", joint["axis"])
    key = {"from": "axis", "to": "to_axis"}[side]
    if key in joint:
        joint[key] = (Q.T @ np.array(joint[key])).tolist()


def owner(end: Any) -> str:
    """The body of an end."""
    return str(end["body"] if isinstance(end, dict) else end.partition(".")[0])


def place(body: Scene, end: Any) -> Array:
    """The point of an end, in its body's axes."""
    return np.array(end["at"] if isinstance(end, dict) else body["points"][end.partition(".")[2]], dtype=float)
