"""Closed loops as drafts that are still to be assembled: an engine, four-bars in either branch, random loops."""

from __future__ import annotations

from typing import Any

import numpy as np

from heuncli.multibody.mechanism.model import Mechanism
from heuncli.scene.shapes.rotations import rotation_from_vector
from tests.shared.drafted_mechanisms import (
    X,
    body,
    joint,
    scene,
)


def slider_crank(near: Any = None, rotation: Any = None, **given: Any) -> Mechanism:
    """Everything drawn at the origin, along x: crank 0.1, rod 0.3."""
    return scene(
        [
            body("crank", center=(0.05, 0, 0), rotation=rotation),
            body("rod", center=(0.15, 0, 0)),
            body("piston", near_position=near),
        ],
        [
            joint("main", "pin", "ground", (0, 0, 0), "crank", (0, 0, 0), **given),
            joint("crankpin", "pin", "crank", (0.1, 0, 0), "rod", (0, 0, 0)),
            joint("wrist", "pin", "rod", (0.3, 0, 0), "piston", (0, 0, 0)),
            joint("guide", "slide", "ground", (0, 0, 0), "piston", (0, 0, 0), X),
        ],
    )


def four_bar(
    crank: float = 1.0, coupler: float = 3.0, rocker: float = 2.5, frame: float = 3.5, **given: Any
) -> Mechanism:
    """All links drawn along x."""
    near = given.pop("near", None)
    return scene(
        [
            body("crank", center=(crank / 2, 0, 0)),
            body("coupler", center=(coupler / 2, 0, 0), near_position=near),
            body("rocker", center=(rocker / 2, 0, 0)),
        ],
        [
            joint("A", "pin", "ground", (0, 0, 0), "crank", (0, 0, 0), **given),
            joint("B", "pin", "crank", (crank, 0, 0), "coupler", (0, 0, 0)),
            joint("C", "pin", "coupler", (coupler, 0, 0), "rocker", (rocker, 0, 0)),
            joint("D", "pin", "ground", (frame, 0, 0), "rocker", (0, 0, 0)),
        ],
    )


KINDS = ("ball", "pin", "universal", "cylinder", "line", "plane", "rod")


def random_loop(seed: int, noise: float, kinds: tuple[str, ...] = KINDS, count: int = 5) -> Mechanism:
    """A loop through the ground that does close, its bodies drawn near there."""
    rng = np.random.default_rng(seed)

    def unit() -> Any:
        a = rng.normal(size=3)
        return a / np.linalg.norm(a)

    R = [rotation_from_vector(a) for a in rng.normal(size=(count, 3))]
    x = 2.0 * rng.normal(size=(count, 3))
    off = noise * rng.normal(size=(count, 2, 3))
    bodies = [
        body(
            f"b{i}",
            center=0.3 * rng.normal(size=3),
            near_position=x[i] + off[i, 0],
            near_rotation=rotation_from_vector(off[i, 1]) @ R[i],
        )
        for i in range(count)
    ]
    names = ["ground", *(f"b{i}" for i in range(count)), "ground"]
    poses = {f"b{i}": (x[i], R[i]) for i in range(count)} | {"ground": (np.zeros(3), np.eye(3))}
    joints = []
    for k in range(count + 1):
        (xa, Ra), (xb, Rb) = poses[names[k]], poses[names[k + 1]]
        kind, n, p, given = str(rng.choice(kinds)), unit(), rng.normal(size=3), {}
        P = xa + Ra @ p
        Q = {
            "cylinder": P + rng.normal() * (Ra @ n),
            "line": P + rng.normal() * (Ra @ n),
            "plane": P + Ra @ np.cross(n, unit()),
            "rod": P + 0.5 * unit() + unit(),
        }.get(kind, P)
        if kind in ("pin", "cylinder"):
            given["to_axis"] = Rb.T @ Ra @ n
        if kind == "universal":
            given["to_axis"] = Rb.T @ Ra @ np.cross(n, unit())
        if kind == "rod":
            given["length"] = float(np.linalg.norm(Q - P))
        joints.append(joint(f"j{k}", kind, names[k], p, names[k + 1], Rb.T @ (Q - xb), n, **given))
    return scene(bodies, joints)
