"""Sentences on what the couplings change of a start that was chosen for the user."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from heuncli import tolerances
from heuncli.assembly.start_choices import StartChoice, chosen
from heuncli.mechanism.model import Assembly
from heuncli.results import Array
from heuncli.shapes.rotations import cross_rows, to_vector
from heuncli.tree.prepare import PreparedScene

HOW = "then, to meet the couplings"


def told(scene: PreparedScene, start: Assembly) -> tuple[str, ...]:
    """One sentence a body that another start than that of its joints was found for."""
    return chosen(_changed(scene, start))


def _changed(scene: PreparedScene, start: Assembly) -> Iterator[StartChoice]:
    size, before = scene.layout.size, scene.start
    arms = np.array([b.center for b in scene.mechanism.bodies])
    v0, v1 = (_centres(at, arms) for at in (before, start))
    scale = float(np.max(np.abs(v1)) + size * np.max(np.abs(start.angular_velocity)))
    for i, body in enumerate(scene.mechanism.bodies):
        turn = np.degrees(to_vector(start.rotation[i] @ before.rotation[i].T))
        rows = (
            ("position", start.position[i], start.position[i] - before.position[i], size),
            ("orientation", turn, turn, 1.0),
            ("velocity", v1[i], v1[i] - v0[i], scale),
            ("angular velocity", start.angular_velocity[i], start.angular_velocity[i] - before.angular_velocity[i],
             scale / size),
        )  # fmt: skip
        for what, value, change, unit in rows:
            if np.max(np.abs(change)) > tolerances.OPEN_GAP * unit:
                yield StartChoice(body.name, what, HOW, "", value, unit)


def _centres(at: Assembly, arms: Array) -> Array:
    """Velocities of the centres."""
    return at.velocity + cross_rows(at.angular_velocity, np.einsum("nij,nj->ni", at.rotation, arms))
