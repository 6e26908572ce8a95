"""Decide whether a rest pose is stable: its smallest eigenvalue, and the slowest or growing small motions.

    x'' + C x' + K x = 0,     x ~ e^(s t)

It is stable if no s has a growing part. The motions are those of `heun modes` (linearisation), and the same decision
tells which are indifferent (motion/linearisation/indifference.py).
"""

from __future__ import annotations

import numpy as np

from heuncli.base import tolerances
from heuncli.base.records import record
from heuncli.loads.equilibrium.coordinates import Coordinates
from heuncli.motion.integration.evaluator import Evaluation
from heuncli.motion.linearisation.indifference import Indifference, reduce_indifference
from heuncli.motion.linearisation.linearise import LinearisedEquations
from heuncli.motion.linearisation.oscillations import find_modes, find_stiffnesses, nilpotent_shapes
from heuncli.motion.linearisation.reduced_equations import reduce_equations
from heuncli.multibody.tree.prepare import PreparedScene
from heuncli.results.results import Array, Mask


@record
class NamedMotion:
    """A motion: the names of what moves in it, and by how much relative to the first, in rad or m."""

    names: tuple[str, ...]
    shares: tuple[float, ...]
    units: tuple[str, ...]


@record
class Stability:
    """The stability of a rest pose.

    growth: growth rate of what grows fastest [1/s], 0 where nothing does
    grows: name of what moves in it
    least: smallest eigenvalue stiffness/inertia of what is held, or pushed off [1/s^2]
    slowest: name of what moves in it, "" where nothing does
    frequency: of the slowest small oscillation [Hz], 0 where nothing oscillates
    motions: number of free motions
    indifferent: motions that nothing holds
    flat: motions that nothing holds to first order; bending holds them, or pushes them off
    edge: motions that push what nothing holds when displaced; stiffness may be lost there where forces follow the
    motion
    """

    growth: float
    grows: str
    least: float
    slowest: str
    frequency: float
    motions: int
    indifferent: tuple[NamedMotion, ...]
    flat: tuple[NamedMotion, ...]
    edge: tuple[NamedMotion, ...]


def find_stability(
    scene: PreparedScene,
    coordinates: Coordinates,
    law: LinearisedEquations,
    evaluation: Evaluation,
    indifference: Indifference,
    is_bending: Mask,
) -> Stability:
    """Find the stability of a rest pose; is_bending (g,): which motions without stiffness bending holds, or pushes."""
    system = reduce_equations(scene, law, evaluation)
    indifferent = reduce_indifference(system, indifference)
    modes = [mode for mode in find_modes(system, indifferent) if mode.kind != "free"]
    fastest_growing = max(modes, key=lambda mode: mode.growth, default=None)
    swings = [mode.frequency for mode in modes if mode.frequency > 0.0]
    values, shapes = find_stiffnesses(system, indifferent)
    softest = int(np.argmin(values)) if len(values) else -1
    unstable = fastest_growing is not None and fastest_growing.growth > 0.0
    free_motions, is_massive = indifference.free_motions, moves_mass(coordinates, indifference.free_motions, law)
    return Stability(
        growth=fastest_growing.growth if fastest_growing is not None and unstable else 0.0,
        grows=name_largest(coordinates, fastest_growing.shape) if fastest_growing is not None and unstable else "",
        least=float(values[softest]) if softest >= 0 else 0.0,
        slowest=name_largest(coordinates, system.tangent @ shapes[:, softest]) if softest >= 0 else "",
        frequency=min(swings, default=0.0),
        motions=system.count,
        indifferent=name_motions(coordinates, free_motions[:, is_massive & ~is_bending]),
        flat=name_motions(coordinates, free_motions[:, is_massive & is_bending]),
        edge=name_motions(
            coordinates, system.tangent @ nilpotent_shapes(indifferent)[:, indifferent.right_null.shape[1] :]
        ),
    )


def moves_mass(coordinates: Coordinates, shapes: Array, law: LinearisedEquations) -> Mask:
    """Return which displacements (n, g) move mass; massless spins do not."""
    inertia = np.einsum("ng,nm,mg->g", shapes, law.mass, shapes)
    largest = float(np.linalg.norm(law.tangent.T @ law.mass @ law.tangent))
    size = np.sum((coordinates.weights[:, None] * shapes) ** 2, axis=0)
    return np.asarray(inertia > tolerances.NO_INERTIA * largest * size)


def name_motions(coordinates: Coordinates, shapes: Array) -> tuple[NamedMotion, ...]:
    """Name displacements (n, g), without repetitions."""
    named = {motion.names + motion.shares: motion for motion in (name_motion(coordinates, x) for x in shapes.T)}
    return tuple(named.values())


def name_motion(coordinates: Coordinates, shape: Array) -> NamedMotion:
    """Name the joints and bodies that move in a displacement (n,), the first by 1; for ball joints the largest
    rotation.
    """
    size = np.abs(shape) * coordinates.weights
    parts: dict[str, tuple[float, str]] = {}
    for k in np.flatnonzero(size > tolerances.MOVES * size.max(initial=0.0)).tolist():
        name, turns = coordinates.find_owner(k)
        if name not in parts or abs(shape[k]) > abs(parts[name][0]):
            parts[name] = float(shape[k]), "rad" if turns else "m"
    first = next(iter(parts.values()))[0] if parts else 1.0
    shares = tuple(share / first for share, _ in parts.values())
    return NamedMotion(tuple(parts), shares, tuple(unit for _, unit in parts.values()))


def name_largest(coordinates: Coordinates, shape: Array) -> str:
    """Return the name of what moves most in a small motion."""
    return coordinates.find_owner(int(np.argmax(np.abs(shape) * coordinates.weights)))[0]
