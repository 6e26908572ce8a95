"""Which small motions no stiffness holds: the null space of K, told from what rounding of all its terms makes of it.

    K x = 0,   K = -T' M da/dq T          of displacements T x, at rest in the frame of what goes on
Rest poses, their stability and small oscillations all take this one decision. How well K is known is seen in scenes
and poses that rounding does not tell from this one (rounded_scenes.py), each brought to where it rests itself: what
cancels in K, between loads or inside a law, differs there by the rounding of its terms, entry by entry. K is eliminated
from its largest entry down, in all these scenes alike, as long as an entry is more than they differ by: so what is soft
is compared with the terms of soft motions, and not with those of stiff ones beside it.
"""

from __future__ import annotations

import numpy as np

from heuncli.base import tolerances
from heuncli.base.records import record, replace
from heuncli.motion.linearisation.displacements import displaced
from heuncli.motion.linearisation.linearise import Linearised, linearised
from heuncli.motion.linearisation.reduced_equations import (
    ReducedEquations,
    complement,
    frames,
    idle_spins,
    rates_of_balls,
)
from heuncli.motion.linearisation.rounded_scenes import rounded_scene, rounded_state
from heuncli.multibody.tree.layout import Layout, places_of_rates
from heuncli.multibody.tree.prepare import PreparedScene
from heuncli.results.results import Array, Indices

SCENES = 4  # moved by rounding: that all of them hide a term is unlikely
FARTHEST = 1.0  # rad, or of the size: a pose that rounding moves farther is known no better than that


@record
class Eliminated:
    """A matrix (f, f) by its entries that are more than rounding: their rows and columns, in pairs; the null spaces.

    right, left (f, g): K right = 0 = left' K but for rounding, which is at most `unsure` (g, g) on them, `known` (f, f)
    on all.
    """

    K: Array
    rows: Indices
    columns: Indices
    right: Array
    left: Array
    unsure: Array
    known: Array

    def answer(self, forces: Array) -> Array:
        """x of K x = forces (f, m) where forces are none on `left`, (f, m); none along what is indifferent."""
        x = np.zeros((len(self.K), forces.shape[1]))
        if len(self.rows):
            x[self.columns] = np.linalg.solve(self.K[np.ix_(self.rows, self.columns)], forces[self.rows])
        return x


@record
class Indifference:
    """What nothing holds: free (n, g), a basis of displacements, with few of the tree's freedoms in each.

    T (n, f): displacements that the closures admit, each with a coordinate of its own; found: K on them, eliminated.
    reach: how far rounding moves the pose, along what is held softly [rad, or of the size].
    """

    T: Array
    found: Eliminated
    reach: float

    @property
    def free(self) -> Array:
        """(n, g)"""
        return np.asarray(self.T @ self.found.right)


@record
class Loose:
    """What no stiffness holds, in coordinates x: K right = 0 = left' K, bases orthonormal (f, g).

    unsure: the largest stiffness [1/s^2] that rounding may hide in it; held (f, f): what a force is answered by.
    to (m, f): x by displacements with a coordinate each, on which the stiffness is K (m, m), and rounding of it no more
    than known (m, m): what is soft keeps its digits there.
    """

    right: Array
    left: Array
    unsure: float
    held: Array
    to: Array
    K: Array
    known: Array

    def between(self, X: Array) -> Array:
        """The stiffness of motions (f, k) among each other, (k, k) [1/s^2]."""
        own = self.to @ X
        return np.asarray(own.T @ self.K @ own)

    def hidden(self, X: Array) -> Array:
        """What rounding makes of the stiffness of motions (f, k), (k,) [1/s^2]."""
        size = np.abs(self.to @ X)
        return np.asarray(np.sum(size * (self.known @ size), axis=0))


def indifference(
    scene: PreparedScene, t: float, holding: Array, law: Linearised, *, rests: bool = True
) -> Indifference:
    """Of a scene about a state; law: its linear equations there. rests: the state is as good as rounding lets it be, so
    that what is as soft as rounding moves the pose along it is not told from nothing."""
    layout = scene.layout
    weights = weights_of(layout)
    tangent, drift = with_inertia(scene, law)
    T, pivots = echelon(tangent, weights)
    if not T.shape[1]:
        return Indifference(T, eliminated(np.zeros((0, 0)), np.zeros((0, 0, 0))), 0.0)
    K, _ = stiffness(layout, law, T, drift)
    scenes = [replace(scene, layout=rounded_scene(layout, number)) for number in range(SCENES)]
    states = [rounded_state(layout, law.state, number) for number in range(SCENES)]
    beside, pushes = moved(scenes, t, states, holding, weights, pivots)
    first, reach = eliminated(K, beside - K), 0.0
    if rests and len(first.rows):
        ways = [T @ first.answer(push[:, None])[:, 0] for push in pushes]
        reach = max(float(np.abs(way * weights).max()) for way in ways)
        states = [displaced(layout, state, bounded(way, weights)) for state, way in zip(states, ways, strict=True)]
        beside, _ = moved(scenes, t, states, holding, weights, pivots)
        first = eliminated(K, beside - K)
    return Indifference(T, first, reach)


def loose(system: ReducedEquations, of: Indifference) -> Loose:
    """The same of reduced equations, whose motions are some of those displacements: idle spins are none."""
    back = system.tangent.T @ system.mass
    right, left = (orthonormal(back @ of.T @ basis) for basis in (of.found.right, of.found.left))
    to: Array = np.linalg.lstsq(of.T, system.tangent, rcond=None)[0].astype(float)  # x by those displacements
    forces: Array = np.linalg.lstsq(to, np.eye(len(to)), rcond=None)[0].astype(float)
    held = back @ of.T @ of.found.answer(forces.T)
    basis = np.linalg.lstsq(back @ of.T @ of.found.right, right, rcond=None)[0] if right.shape[1] else np.zeros((0, 0))
    unsure = np.abs(basis).T @ of.found.unsure @ np.abs(basis) if basis.size else np.zeros((0, 0))
    return Loose(right, left, float(np.abs(unsure).max(initial=0.0)), held, to, of.found.K, of.found.known)


def orthonormal(columns: Array) -> Array:
    """An orthonormal basis of what independent columns span, however different their sizes."""
    return np.asarray(np.linalg.qr(columns / np.sqrt(np.sum(columns**2, axis=0)))[0])


def moved(
    scenes: list[PreparedScene], t: float, states: list[Array], holding: Array, weights: Array, pivots: Indices
) -> tuple[Array, Array]:
    """K of scenes, (s, f, f), and what pushes there, (s, f)."""
    f = len(pivots)
    K, pushes = np.full((len(scenes), f, f), np.nan), np.zeros((len(scenes), f))
    for k, (scene, state) in enumerate(zip(scenes, states, strict=True)):
        law = linearised(scene.layout, t, state, holding)
        if not np.isfinite(law.by_place).all():
            continue
        tangent, drift = with_inertia(scene, law)
        if tangent.shape[1] == f:
            K[k], pushes[k] = stiffness(scene.layout, law, on_pivots(tangent, weights, pivots), drift)
    return K, pushes


def bounded(way: Array, weights: Array) -> Array:
    """A displacement (n,), but not farther than anything is looked for."""
    size = float(np.abs(way * weights).max(initial=0.0))
    if not np.isfinite(size):
        return np.zeros(len(way))
    return way * min(1.0, FARTHEST / size) if size > 0.0 else way


def with_inertia(scene: PreparedScene, law: Linearised) -> tuple[Array, Array]:
    """The displacements of the law that move mass, (n, f), and what any ask of rates, (n, n)."""
    idle = idle_spins(scene, law)
    drift = law.drift @ np.linalg.pinv(law.tangent)
    for spin in idle:
        drift = drift - np.outer(law.tangent @ spin.along, spin.gained(law, np.eye(len(drift))))
    return law.tangent @ complement(np.array([spin.along for spin in idle]), law.tangent.shape[1]), drift


def weights_of(layout: Layout) -> Array:
    """Of the undriven freedoms: 1 of turns, 1 / size of shifts, (n,)."""
    place = places_of_rates(layout)
    return np.asarray(layout.weights[place[place >= 0]])


def stiffness(layout: Layout, law: Linearised, T: Array, drift: Array) -> tuple[Array, Array]:
    """K on displacements T (n, f), and what pushes along them, (f,); drift (n, n): what displacements ask of rates.

    Seen from the frames of what goes on, as in reduced_equations.py: what stays there asks for the rates `stays`.
    """
    spin, frame = frames(layout, law)
    P, change = T.T @ law.mass, law.by_place @ T
    if drift.any() or (spin != frame).any():
        S = drift @ T
        stays = S - T @ (np.linalg.pinv(T) @ (S + (spin - frame) @ T))
        change = change + (law.by_rate - frame) @ stays
    K = -P @ change
    return K, P @ (law.accelerations - frame @ rates_of_balls(layout, law))


def echelon(tangent: Array, weights: Array) -> tuple[Array, Indices]:
    """The same displacements (n, f), each with a coordinate in which the others have no part; which, (f,)."""
    left = tangent * weights[:, None]
    pivots: list[int] = []
    for _ in range(tangent.shape[1]):
        sizes = np.sum(left**2, axis=1)
        k = int(np.argmax(sizes))
        pivots.append(k)
        across = left[k] / np.sqrt(sizes[k])
        left = left - np.outer(left @ across, across)
    chosen = np.array(pivots, dtype=int)
    return on_pivots(tangent, weights, chosen), chosen


def on_pivots(tangent: Array, weights: Array, pivots: Indices) -> Array:
    """The same displacements by the coordinates named; what is rounding of a coordinate's part is none."""
    T = tangent * weights[:, None]
    if len(pivots):
        T = np.linalg.solve(T[pivots].T, T.T).T.astype(float)
        T = np.where(np.abs(T) > tolerances.EIGENVALUE, T, 0.0)
        T[pivots] = np.eye(len(pivots))
    return np.asarray(T / weights[:, None])


def eliminated(K: Array, changes: Array) -> Eliminated:
    """A matrix (f, f) with what others that rounding does not tell from it differ from it by, (s, f, f)."""
    f = len(K)
    changes = changes[np.isfinite(changes).all(axis=(1, 2))] if f else changes
    if f and not len(changes):
        changes = np.full((1, f, f), tolerances.EIGENVALUE * f * np.abs(K).max())
    known = tolerances.HELD * np.abs(changes).max(axis=0, initial=0.0)
    S, others = K.copy(), K + changes
    rows, columns = list(range(f)), list(range(f))
    right, left = np.eye(f), np.eye(f)
    taken: list[tuple[int, int]] = []
    while rows:
        unsure = tolerances.HELD * np.abs(others - S).max(axis=0, initial=0.0)
        seen = np.where(np.abs(S) > unsure, np.abs(S), 0.0)
        i, j = np.unravel_index(int(np.argmax(seen)), seen.shape)
        if seen[i, j] == 0.0:
            break
        taken.append((rows.pop(int(i)), columns.pop(int(j))))
        right = without(right, int(j), S[i] / S[i, j])
        left = without(left, int(i), S[:, j] / S[i, j])
        S, others = schur(S[None], int(i), int(j))[0], schur(others, int(i), int(j))
    unsure = tolerances.HELD * np.abs(others - S).max(axis=0, initial=0.0)
    pairs = np.array(taken, dtype=int).reshape(-1, 2)
    return Eliminated(K, pairs[:, 0], pairs[:, 1], right, left, unsure, known)


def without(basis: Array, k: int, shares: Array) -> Array:
    """A basis without its column k, of which the others take their shares."""
    return np.asarray(np.delete(basis - np.outer(basis[:, k], shares), k, axis=1))


def schur(matrices: Array, i: int, j: int) -> Array:
    """Matrices (s, f, f) after one step of elimination by the entry i, j."""
    pivot = matrices[:, i, j][:, None, None]
    left = matrices - matrices[:, :, j][:, :, None] * (matrices[:, i, :][:, None, :] / pivot)
    return np.asarray(np.delete(np.delete(left, i, axis=1), j, axis=2))
