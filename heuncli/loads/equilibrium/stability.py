"""Whether a rest pose is stable: the least eigenvalue, and what the slowest or growing small motions are.

    x'' + C x' + K x = 0,     x ~ e^(s t)
Stable is what no s leaves with a growing part. The motions are those that `heun modes` tells (linearisation), and what
nothing holds is so by the same decision (motion/linearisation/indifference.py).
"""

from __future__ import annotations

import numpy as np

from heuncli.base import tolerances
from heuncli.base.records import record
from heuncli.loads.equilibrium.coordinates import Coordinates
from heuncli.motion.integration.evaluator import Recovered
from heuncli.motion.linearisation.indifference import Indifference, loose
from heuncli.motion.linearisation.linearise import Linearised
from heuncli.motion.linearisation.oscillations import oscillations, sooner_or_later, stiffnesses
from heuncli.motion.linearisation.reduced_equations import reduced
from heuncli.multibody.tree.prepare import PreparedScene
from heuncli.results.results import Array, Mask


@record
class Motion:
    """A motion: what moves in it, by name, and by how much against the first, in rad or m."""

    names: tuple[str, ...]
    shares: tuple[float, ...]
    units: tuple[str, ...]


@record
class Stability:
    """Growth [1/s] of what grows fastest, 0 where nothing does; what moves in it, by name.

    least: the least eigenvalue of stiffness over inertia of what is held, or pushed off [1/s^2]; slowest: what moves in
    it, "" where nothing does; frequency: of the slowest small oscillation [Hz], 0 where nothing swings.
    motions: how many there are, free of closures; indifferent: those that nothing holds; flat: those that it is so to
    first order alone, what bends holds them, or pushes them off; edge: those that, moved aside, push what nothing
    holds: stiffness may lose them where forces follow what they move.
    """

    growth: float
    grows: str
    least: float
    slowest: str
    frequency: float
    motions: int
    indifferent: tuple[Motion, ...]
    flat: tuple[Motion, ...]
    edge: tuple[Motion, ...]


def stability(
    scene: PreparedScene, coordinates: Coordinates, law: Linearised, at: Recovered, what: Indifference, bends: Mask
) -> Stability:
    """Of a rest pose; bends (g,): which of the motions that no stiffness holds are held, or pushed, by what bends."""
    system = reduced(scene, law, at)
    nothing = loose(system, what)
    modes = [mode for mode in oscillations(system, nothing) if mode.kind != "free"]
    grown = max(modes, key=lambda mode: mode.growth, default=None)
    swings = [mode.frequency for mode in modes if mode.frequency > 0.0]
    values, shapes = stiffnesses(system, nothing)
    least = int(np.argmin(values)) if len(values) else -1
    unstable = grown is not None and grown.growth > 0.0
    own, massive = what.free, with_inertia(coordinates, what.free, law)
    return Stability(
        growth=grown.growth if grown is not None and unstable else 0.0,
        grows=moves(coordinates, grown.shape) if grown is not None and unstable else "",
        least=float(values[least]) if least >= 0 else 0.0,
        slowest=moves(coordinates, system.tangent @ shapes[:, least]) if least >= 0 else "",
        frequency=min(swings, default=0.0),
        motions=system.count,
        indifferent=motions(coordinates, own[:, massive & ~bends]),
        flat=motions(coordinates, own[:, massive & bends]),
        edge=motions(coordinates, system.tangent @ sooner_or_later(nothing)[:, nothing.right.shape[1] :]),
    )


def with_inertia(coordinates: Coordinates, shapes: Array, law: Linearised) -> Mask:
    """Which displacements (n, g) move mass: spins that nothing determines are none."""
    inertia = np.einsum("ng,nm,mg->g", shapes, law.mass, shapes)
    largest = float(np.linalg.norm(law.tangent.T @ law.mass @ law.tangent))
    size = np.sum((coordinates.weights[:, None] * shapes) ** 2, axis=0)
    return np.asarray(inertia > tolerances.NO_INERTIA * largest * size)


def motions(coordinates: Coordinates, shapes: Array) -> tuple[Motion, ...]:
    """Displacements (n, g) by name: each once."""
    found = {motion.names + motion.shares: motion for motion in (motion_of(coordinates, x) for x in shapes.T)}
    return tuple(found.values())


def motion_of(coordinates: Coordinates, shape: Array) -> Motion:
    """A displacement (n,) by the joints and bodies that move in it, the first by 1; of balls the largest turn."""
    size = np.abs(shape) * coordinates.weights
    parts: dict[str, tuple[float, str]] = {}
    for k in np.flatnonzero(size > tolerances.MOVES * size.max(initial=0.0)).tolist():
        name, turns = coordinates.owner(k)
        if name not in parts or abs(shape[k]) > abs(parts[name][0]):
            parts[name] = float(shape[k]), "rad" if turns else "m"
    first = next(iter(parts.values()))[0] if parts else 1.0
    shares = tuple(share / first for share, _ in parts.values())
    return Motion(tuple(parts), shares, tuple(unit for _, unit in parts.values()))


def moves(coordinates: Coordinates, shape: Array) -> str:
    """What moves most in a small motion, by name."""
    return coordinates.owner(int(np.argmax(np.abs(shape) * coordinates.weights)))[0]
