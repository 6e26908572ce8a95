"""How a disturbance of a motion grows: runs beside it, 1e-8 away, set back whenever they have grown.

    G(t) = largest |P Phi(t, 0) s| of all disturbances |s| = 1 of the start
Phi takes a small disturbance of the start to one at t; P keeps its turns and shifts, the rates left out. Disturbances
are counted by scaled numbers: turns, shifts by the scene's size, rates by the largest rate of the run. Piece by piece
one shadow runs in each of k directions Q, which span all that the closed chains admit, D is what the piece makes of
them, and D = Q' R gives the next ones and Phi = Q' R_m ... R_1 (G. Benettin et al., Meccanica 15 (1980), 9-30). Of more
directions than K a few at random are taken: sqrt(N / k) |Phi Q|, in the mean of its square that of all N.
"""

from __future__ import annotations

import math
from collections.abc import Iterator
from itertools import pairwise

import numpy as np

from heuncli.base import tolerances
from heuncli.base.records import record
from heuncli.loads.equilibrium.coordinates import coordinates_of
from heuncli.motion.integration.contacts.blows import schedule, strike
from heuncli.motion.integration.evaluator import Evaluator
from heuncli.motion.integration.integrated_scene import itself
from heuncli.motion.integration.methods.method import Method
from heuncli.motion.integration.run.kernel_loop import MORE, REACHED, KernelLoop, Start
from heuncli.motion.integration.run.runner import Runner
from heuncli.motion.integration.segments import just_before
from heuncli.motion.integration.trajectory import Trajectory
from heuncli.multibody.response import jacobian
from heuncli.multibody.tree.layout import Layout
from heuncli.results.results import Array
from heuncli.scene.shapes.rotations import quaternion_product

AWAY = 1e-8  # of a radian, or of the size: root of EPS, where the square of a disturbance is as much as its rounding
STIFF_LOCAL = 1e-12  # local tolerance of implicit steps: 1e-4 of AWAY; below, stages of large rates are rounding
K = 24  # directions; a few more than grow by themselves
PIECE = 16  # steps of the run: some growth times of most motions, and few enough that what grows fast is set back
BESIDE = (0, -1, 1, -2, 2)  # steps about one, the nearest first, among which a long one is
FEWEST = 100  # pieces of a run, so that its growth is seen between
FARTHEST = 1e4  # times AWAY: squares are then 1e-4 of the disturbance; a piece in which one grows more is halved
CHUNK = 256  # steps at a time, for which there is room
MOST_CHUNKS = 400  # of a piece


@record
class Growth:
    """How disturbances have grown: at instants (m,) of the run ln G and the steps to there; stopped: why no further."""

    times: Array
    logarithm: Array
    steps: Array
    stopped: str | None = None


class Piece:
    """The part of a run between two instants, without blows: begin, end, and the last instant before it."""

    def __init__(self, begin: float, before_end: float, end: float) -> None:
        self.begin, self.before_end, self.end = begin, before_end, end

    def halves(self) -> tuple[Piece, Piece]:
        """Its two halves."""
        middle = 0.5 * (self.begin + self.end)
        return Piece(self.begin, just_before(middle), middle), Piece(middle, self.before_end, self.end)


def pieces_of(run: Trajectory) -> Iterator[Piece]:
    """The pieces of a run: some of its steps each, none across a discontinuity in time."""
    last = float(run.times[-1])
    for segment in run.segments:
        end = min(segment.end, last)
        ends = np.concatenate([[segment.begin], run.ends[(run.ends > segment.begin) & (run.ends < end)], [end]])
        marks = [segment.begin, *within_steps(ends, marks_of(ends, last / FEWEST)).tolist(), end]
        for begin, until in pairwise(marks):
            if until > begin:
                yield Piece(begin, min(segment.before_end, just_before(until)), until)


def marks_of(ends: Array, longest: float) -> Array:
    """Instants that part a segment, of the steps between `ends`, into pieces of few steps that are not too long."""
    coarse = np.unique(np.append(ends[::PIECE], ends[-1]))
    counts = np.ceil(np.diff(coarse) / longest * (1.0 - tolerances.SAME_INSTANT)).astype(int)
    parts = [np.linspace(*ab, n, endpoint=False) for ab, n in zip(pairwise(coarse), np.maximum(counts, 1), strict=True)]
    return np.concatenate([*parts, np.zeros(0)])[1:]


def within_steps(ends: Array, marks: Array) -> Array:
    """The marks moved into the middle half of a step that is no short one, beside each.

    Steps end where loads jump with a coordinate. There a disturbance counts by its sign, as it has crossed or not yet,
    and what it grows to in the two pieces beside would not be the product.
    """
    lengths = np.diff(ends)
    enough = np.minimum(lengths, np.median(lengths))
    near = np.clip(np.searchsorted(ends[1:], marks)[:, None] + np.array(BESIDE), 0, len(lengths) - 1)
    k = near[np.arange(len(marks)), np.argmax(enough[near], axis=1)]
    quarter = 0.25 * lengths[k]
    return np.asarray(np.maximum.accumulate(np.clip(marks, ends[k] + quarter, ends[k + 1] - quarter)))


class ShadowScale:
    """Small disturbances of states as scaled numbers, displacements first, and back."""

    def __init__(self, layout: Layout, rate: float) -> None:
        self.layout, self.coordinates = layout, coordinates_of(layout)
        weights = self.coordinates.weights
        self.n = len(weights)
        self.by = np.concatenate([weights, weights / rate])
        freedoms = layout.tables["freedoms"]
        self.q_at = freedoms["q_at"][self.coordinates.freedoms]
        self.attitudes = layout.bodies["attitude_at"][self.coordinates.balls]

    def moved(self, state: Array, by: Array) -> Array:
        """States beside one, (k, n_state), by scaled disturbances (k, 2 n)."""
        found = self.coordinates.displaced(np.repeat(state[None], len(by), axis=0), by[:, : self.n] / self.by[: self.n])
        found[:, self.coordinates.rates] += by[:, self.n :] / self.by[self.n :]
        return found

    def apart(self, state: Array, others: Array) -> Array:
        """The scaled disturbances (k, 2 n) that lead from one state to others close by."""
        found = np.zeros((len(others), 2 * self.n))
        found[:, self.coordinates.numbers] = others[:, self.q_at] - state[self.q_at]
        for at, first in zip(self.attitudes.tolist(), self.coordinates.turns.tolist(), strict=True):
            back = state[at : at + 4] * np.array([1.0, -1.0, -1.0, -1.0])
            turn = quaternion_product(others[:, at : at + 4], back[None])
            found[:, first : first + 3] = 2.0 * turn[:, 1:] * np.sign(turn[:, :1])
        found[:, self.n :] = others[:, self.coordinates.rates] - state[self.coordinates.rates]
        return np.asarray(found * self.by)


class Shadows:
    """Runs beside the run of a scene, done with what is integrated in its place, or (whole) with the scene itself."""

    def __init__(self, runner: Runner, run: Trajectory, method: Method, *, whole: bool = False) -> None:
        self.runner, self.run, self.method = runner, run, method
        self.moving = itself(Evaluator(runner.layout)) if whole else runner.moving
        self.layout, self.workspace = self.moving.layout, self.moving.workspace
        self.rate = largest_rate(runner, run)
        self.scale = ShadowScale(self.layout, self.rate)
        self.beside = Runner(self.layout) if self.layout.rows else None
        self.blows = schedule(runner.layout.mechanism, float(run.times[-1]))

    def settled(self, t: float, states: Array) -> Array:
        """States on the closed chains."""
        if self.beside is None:
            return states
        return self.beside.recovered(np.full(len(states), t), states).states

    def forward(self, piece: Piece, state: Array) -> tuple[Array, int] | None:
        """The state that one at the beginning of a piece comes to at its end, and the steps; None if it does not."""
        start = Start(state, STIFF_LOCAL if self.method.implicit else tolerances.LEAST_TOLERANCE, self.rate)
        run = KernelLoop(self.layout, self.workspace, self.method, np.array([piece.end]), CHUNK, start)
        run.loop.begin(piece.begin, piece.before_end, piece.end)
        for _ in range(MOST_CHUNKS):
            code = run.loop.advance(CHUNK, False, False)
            if code != MORE:
                return (np.array(run.loop.state()), run.loop.steps) if code == REACHED else None
        return None

    def behind_blows(self, t: float, states: Array) -> Array:
        """States behind the blows that are given at an instant."""
        moving = self.moving
        for given in (one for one in self.blows if one.before <= t <= one.after):
            for k, state in enumerate(states):
                jump = strike(self.runner, given, moving.state(t, state), t)
                if jump is not None:
                    states[k] = moving.restrict(t, jump.after)
        return states

    def passed(self, piece: Piece, base: Array, Q: Array) -> tuple[Array, int] | None:
        """What a piece makes of disturbances Q (2 n, k) of its begin, and its steps; None where one comes to no end."""
        states = self.settled(piece.begin, np.vstack([base, self.scale.moved(base, AWAY * Q.T)]))
        start = self.behind_blows(piece.begin, states)
        ends = []
        for state in start:
            found = self.forward(piece, state)
            if found is None:
                return None
            ends.append(found)
        reached = np.array([state for state, _ in ends])
        return self.scale.apart(reached[0], reached[1:]).T / AWAY, ends[0][1]

    def directions(self) -> Array:
        """All disturbances of the start that the closed chains admit, orthonormal (2 n, N)."""
        n, scale = self.scale.n, self.scale
        T = np.eye(n)
        if self.layout.rows:
            start = self.settled(0.0, self.run_states(np.zeros(1)))
            J = jacobian(self.workspace, self.layout, np.zeros(1), start)
            rows = J.block(np.arange(len(self.layout.rows)), scale.coordinates.answers)[0] / scale.by[:n]
            _, s, V = np.linalg.svd(rows)
            T = V[int(np.sum(s > tolerances.RANK * s.max(initial=0.0))) :].T
        return np.block([[T, np.zeros_like(T)], [np.zeros_like(T), T]])

    def run_states(self, times: Array) -> Array:
        """The states of what is integrated at instants of the run."""
        states = self.runner.resample(self.run, times)
        return np.array([self.moving.restrict(t, y) for t, y in zip(times.tolist(), states, strict=True)])

    def growth(self, Q: Array | None = None) -> Growth:
        """How disturbances grow along the run: all, or those in the directions Q (2 n, N) of the start."""
        Q, factor = some_of(self.directions() if Q is None else Q)
        n, C, log = self.scale.n, np.eye(Q.shape[1]), 0.0
        found, steps = [(0.0, 0.0, 0.0)], 0
        todo = self.pieces()[::-1] if Q.shape[1] else []
        while todo:
            piece, base = todo.pop()
            made = self.passed(piece, base, Q)
            if made is None:
                return growth_of(found, f"a run beside it does not come to t = {piece.end:.6g} s")
            D, done = made
            if np.abs(D).max() > FARTHEST and piece.before_end - piece.begin > AWAY * piece.end:
                first, second = piece.halves()
                todo += [(second, self.run_states(np.array([second.begin]))[0]), (first, base)]
                continue
            Q, R = np.linalg.qr(D)
            C, steps = R @ C, steps + done
            size = float(np.abs(C).max())
            if size == 0.0:
                return growth_of(found, f"a disturbance dies out to nothing by t = {piece.end:.6g} s")
            C, log = C / size, log + math.log(size)
            G = factor * float(np.linalg.norm(Q[:n] @ C, 2))
            found.append((piece.end, log + math.log(max(G, tolerances.EPS)), float(steps)))
        return growth_of(found, None)

    def pieces(self) -> list[tuple[Piece, Array]]:
        """The pieces of the run, and the states at which they begin."""
        pieces = list(pieces_of(self.run))
        states = self.run_states(np.array([piece.begin for piece in pieces]))
        return list(zip(pieces, states, strict=True))


def growth_of(found: list[tuple[float, float, float]], stopped: str | None) -> Growth:
    """The growth from its rows, (instant, ln G, steps) each."""
    times, logarithm, steps = np.array(found).T
    return Growth(times, logarithm, steps, stopped)


def some_of(Q: Array) -> tuple[Array, float]:
    """At most K directions at random of all, which stand for the others by a factor."""
    N = Q.shape[1]
    if N <= K:
        return Q, 1.0
    chosen, _ = np.linalg.qr(np.random.default_rng(1901).standard_normal((N, K)))
    return Q @ chosen, math.sqrt(N / K)


def largest_rate(runner: Runner, run: Trajectory) -> float:
    """The fastest of the undriven rates over a run, turns by [rad/s], shifts by the scene's size [1/s].

    No less than what gravity makes of a fall through the scene's size, and one turn in the run's time.
    """
    layout = runner.layout
    own = coordinates_of(layout)
    rates = np.abs(run.states[:, own.rates] * own.weights)
    g = float(np.sqrt(np.sum(layout.mechanism.gravity**2)))
    return max(float(rates.max(initial=0.0)), math.sqrt(g / layout.size), 1.0 / float(run.times[-1]))
