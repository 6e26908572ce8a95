"""Sentences on what the couplings change in a start that heun has chosen."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from heuncli.base import tolerances
from heuncli.multibody.assembly.start_choices import StartChoice, format_choices
from heuncli.multibody.coupled_start.body_release import ReleasedBodies
from heuncli.multibody.coupled_start.fit import CoupledFit
from heuncli.multibody.mechanism.model import Assembly
from heuncli.multibody.tree.prepare import PreparedScene
from heuncli.results.results import Array
from heuncli.scene.shapes.rotations import cross_rows, vector_from_rotation

COUPLING_ORIGIN = "adjusted to satisfy the couplings"


def format_coupling_changes(scene: PreparedScene, start: Assembly) -> tuple[str, ...]:
    """Return one sentence for each body whose start the couplings have changed."""
    return format_choices(_iter_changes(scene, start))


def format_unprescribed_motions(
    scene: PreparedScene, fit: CoupledFit, state: Array, released_bodies: ReleasedBodies
) -> tuple[str, ...]:
    """Return sentences on bodies that are set in motion though no rate is given for them; state: with the fitted rates.

    Such a body carries the coupled ones, which cannot satisfy their couplings without it; or it could have stayed
    unchanged if another one had moved. fit: before the rates are fitted.
    """
    before, after = fit.measure_present()[1], fit.start_at(state)
    arms = np.array([b.center for b in scene.mechanism.bodies])
    v0, v1 = (_centre_velocities(assembly, arms) for assembly in (before, after))
    spins, speeds = after.angular_velocity - before.angular_velocity, v1 - v0
    scale = float(np.max(np.abs(v1)) + scene.layout.size * np.max(np.abs(after.angular_velocity)))
    size = np.maximum(np.abs(speeds).max(axis=1), scene.layout.size * np.abs(spins).max(axis=1))
    moving = [i for i in fit.bodies if size[i] > tolerances.OPEN_GAP * scale]
    hangs = scene.layout.spanning.links
    carriers = {hangs[k].body for k in released_bodies.places - released_bodies.first}
    carried = {hangs[k].body for k in released_bodies.find_carried()} - carriers
    names: dict[bool, list[str]] = {True: [], False: []}
    for i in moving:
        if i in carriers or (i not in carried and fit.could_stay(i)):
            names[i in carriers].append(
                _format_motion(scene.mechanism.bodies[i].name, spins[i], speeds[i], scale, scene)
            )
    return tuple(
        f"the couplings set in motion {', '.join(names[is_carrier])}: {reason}"
        for is_carrier, reason in REASONS.items()
        if names[is_carrier]
    )


REASONS = {
    False: "other rates also satisfy them, these are the smallest; give rates to choose",
    True: "the coupled bodies mounted on it cannot satisfy them alone",
}


def _format_motion(name: str, spin: Array, speed: Array, scale: float, scene: PreparedScene) -> str:
    """Format a body's name and how fast it is set in motion."""
    turn, shift = float(np.sqrt(spin @ spin)), float(np.sqrt(speed @ speed))
    parts = [f"{turn:.4g} rad/s"] if turn * scene.layout.size > tolerances.OPEN_GAP * scale else []
    parts += [f"{shift:.4g} m/s"] if shift > tolerances.OPEN_GAP * scale else []
    return f"{name} ({', '.join(parts)})"


def _iter_changes(scene: PreparedScene, start: Assembly) -> Iterator[StartChoice]:
    size, before = scene.layout.size, scene.start
    arms = np.array([b.center for b in scene.mechanism.bodies])
    v0, v1 = (_centre_velocities(assembly, arms) for assembly in (before, start))
    scale = float(np.max(np.abs(v1)) + size * np.max(np.abs(start.angular_velocity)))
    for i, body in enumerate(scene.mechanism.bodies):
        turn = np.degrees(vector_from_rotation(start.rotation[i] @ before.rotation[i].T))
        rows = (
            ("position", start.position[i], start.position[i] - before.position[i], size),
            ("orientation", turn, turn, 1.0),
            ("velocity", v1[i], v1[i] - v0[i], scale),
            ("angular velocity", start.angular_velocity[i], start.angular_velocity[i] - before.angular_velocity[i],
             scale / size),
        )  # fmt: skip
        for what, value, change, unit in rows:
            if np.max(np.abs(change)) > tolerances.OPEN_GAP * unit:
                yield StartChoice(body.name, what, COUPLING_ORIGIN, "", value, unit)


def _centre_velocities(assembly: Assembly, arms: Array) -> Array:
    """Velocities of the centres of mass."""
    return assembly.velocity + cross_rows(assembly.angular_velocity, np.einsum("nij,nj->ni", assembly.rotation, arms))
