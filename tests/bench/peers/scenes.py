"""The benchmark scenes as plain data, so that every program is given the same numbers: read by heun from its own specs.

Three are chains of bars on ball joints; `crank` is a slider-crank of three bodies in the plane, told apart.
"""

from __future__ import annotations

import json
import os
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np

FOLDER = Path(__file__).parents[1] / "scenes"
REFERENCE: dict[str, Any] = json.loads((FOLDER / "reference.json").read_text(encoding="utf-8"))
CHAINS, SCENES = ("double", "chain10", "top"), ("double", "chain10", "crank", "top")
G = 9.81
DRAWN = "HEUN_BENCH_DRAWN"  # the file with the chains as `bars` gives them


class Bar(NamedTuple):
    """A link: mass properties in its own axes from its ball, the next ball, and how it starts (omega: body axes)."""

    name: str
    mass: float
    center: np.ndarray
    inertia: np.ndarray
    end: np.ndarray
    rotation: np.ndarray
    omega: np.ndarray


class Crank(NamedTuple):
    """Slider-crank: uniform thin crank and rod, a piston, free of gravity; angle and rate of the crank at the start."""

    r: float = 0.1
    length: float = 0.3
    masses: tuple[float, float, float] = (1.0, 1.5, 2.0)
    piston_inertia: float = 0.001
    angle: float = float(np.radians(30.0))
    rate: float = 50.0

    @property
    def start(self) -> tuple[float, float]:
        """Angle of the rod (absolute), and its rate."""
        psi = -float(np.arcsin(self.r / self.length * np.sin(self.angle)))
        return psi, -self.r * self.rate * float(np.cos(self.angle)) / (self.length * float(np.cos(psi)))


def bars(name: str) -> list[Bar]:
    """The links of a chain, from the ground outwards; from a file where one is given, for processes without heun."""
    if DRAWN in os.environ:
        drawn = json.loads(Path(os.environ[DRAWN]).read_text(encoding="utf-8"))[name]
        return [Bar(bar[0], bar[1], *(np.array(x) for x in bar[2:])) for bar in drawn]
    from heuncli.scene.file_format.load import load
    from heuncli.study.model.setup import set_up

    scene = set_up(load(str(FOLDER / f"{name}.yaml")), reduce=False).scene
    start = scene.start
    return [
        Bar(
            body.name, body.mass, body.center, body.inertia, body.points.get("end", np.zeros(3)),
            start.rotation[i], start.rotation[i].T @ start.angular_velocity[i],
        )
        for i, body in enumerate(scene.mechanism.bodies)
    ]  # fmt: skip


def draw(path: Path) -> None:
    """Write that file."""
    told = {
        name: [[bar.name, float(bar.mass), *(np.asarray(x).tolist() for x in bar[2:])] for bar in bars(name)]
        for name in CHAINS
    }
    path.write_text(json.dumps(told), encoding="utf-8")


def duration(name: str) -> float:
    """Of the run [s]."""
    return float(REFERENCE[name]["time"])


def error(name: str, centers: dict[str, Any]) -> float:
    """Largest distance of a centre of mass from the reference at the end [m]."""
    wanted = REFERENCE[name]["center"]
    off = [float(np.linalg.norm(np.asarray(centers[body], dtype=float) - wanted[body])) for body in wanted]
    return max(off) if np.all(np.isfinite(off)) else float("inf")


def crank_centers(phi: float, psi: float, x: float | None = None) -> dict[str, Any]:
    """Centres of mass of the slider-crank, from the angles of crank and rod."""
    c = Crank()
    pin = c.r * np.array([np.cos(phi), np.sin(phi), 0.0])
    rod = c.length * np.array([np.cos(psi), np.sin(psi), 0.0])
    return {
        "crank": 0.5 * pin, "rod": pin + 0.5 * rod,
        "piston": pin + rod if x is None else np.array([x, 0.0, 0.0]),
    }  # fmt: skip
