"""Growth of disturbances of a motion: runs 1e-8 away from it, rescaled whenever they have grown.
    G(t) = largest |P Phi(t, 0) s| of all disturbances |s| = 1 of the start
Phi maps a small disturbance of the start to one at t; P keeps its rotations and displacements, not the rates.
Disturbances are scaled: displacements by the scene's size, rates by the largest rate of the run. In each piece of the
run one disturbed run starts in each of k directions Q, which span all that the closed chains admit; D is their image at
the end of the piece, and D = Q' R gives the next directions and Phi = Q' R_m ... R_1 (G. Benettin et al., Meccanica 15
(1980), 9-30). Of more than K directions a few random ones are used: sqrt(N / k) |Phi Q|, whose mean square is that of
all N.
"""

from __future__ import annotations

import math
from collections.abc import Iterator
from itertools import pairwise

import numpy as np

from heuncli.base import tolerances
from heuncli.base.linear_algebra import compute_null_space
from heuncli.base.named_tuples import NamedTuple
from heuncli.base.records import record
from heuncli.loads.equilibrium.coordinates import make_coordinates
from heuncli.motion.integration.contacts.impulses import schedule_impulses, solve_impulse
from heuncli.motion.integration.evaluator import Evaluator
from heuncli.motion.integration.integrated_scene import integrate_itself, just_before
from heuncli.motion.integration.methods.method import Method
from heuncli.motion.integration.run.kernel_loop import MORE, REACHED, KernelLoop, LoopStart
from heuncli.motion.integration.run.runner import Runner
from heuncli.motion.integration.trajectory import Trajectory
from heuncli.multibody.response import jacobian
from heuncli.multibody.tree.layout import Layout
from heuncli.results.results import Array
from heuncli.scene.shapes.rotations import quaternion_product

DISTURBANCE = 1e-8  # rad, or parts of the size: root of EPS, where the square of a disturbance equals its rounding
# local tolerance of implicit steps: 1e-4 of DISTURBANCE; below, stages of large rates are rounding
IMPLICIT_TOLERANCE = 1e-12
MAX_DIRECTIONS = 24  # a few more than usually grow
# steps of the run: several growth times of most motions, but few enough to rescale fast growth in time
STEPS_PER_PIECE = 16
STEP_OFFSETS = (0, -1, 1, -2, 2)  # offsets of nearby steps, the nearest first, among which a long one is chosen
MIN_PIECES = 100  # least number of pieces of a run, to resolve its growth
MAX_GROWTH = 1e4  # times DISTURBANCE: squares are then 1e-4 of it; a piece with more growth is halved
STEPS_PER_CHUNK = 256  # steps for which memory is allocated at a time
MAX_CHUNKS = 400  # of a piece
SEED = 1901  # of the random directions: the same in every run


class GrowthSample(NamedTuple):
    """The growth at an instant of the run [s]: ln G, and the number of steps up to there."""

    time: float
    logarithm: float
    steps: float


@record
class DisturbanceGrowth:
    """The growth of disturbances: ln G and the number of steps at instants (m,) of the run.

    stop_reason: why the growth is not known further on, or None
    """

    times: Array
    logarithm: Array
    steps: Array
    stop_reason: str | None = None


class RunPiece(NamedTuple):
    """A part of a run between two instants [s], without impulses.

    before_end: the last instant before the end
    """

    begin: float
    before_end: float
    end: float

    def split(self) -> tuple[RunPiece, RunPiece]:
        """Return its two halves."""
        middle = 0.5 * (self.begin + self.end)
        return RunPiece(self.begin, just_before(middle), middle), RunPiece(middle, self.before_end, self.end)


def iter_pieces(run: Trajectory) -> Iterator[RunPiece]:
    """Yield the pieces of a run: several steps each, none across a discontinuity in time."""
    last = float(run.times[-1])
    for segment in run.segments:
        end = min(segment.end, last)
        ends = np.concatenate([[segment.begin], run.ends[(run.ends > segment.begin) & (run.ends < end)], [end]])
        marks = [segment.begin, *move_into_steps(ends, make_marks(ends, last / MIN_PIECES)).tolist(), end]
        for begin, piece_end in pairwise(marks):
            if piece_end > begin:
                yield RunPiece(begin, min(segment.before_end, just_before(piece_end)), piece_end)


def make_marks(ends: Array, longest: float) -> Array:
    """Return instants that divide a segment, whose steps end at `ends`, into pieces of few steps and limited length."""
    coarse = np.unique(np.append(ends[::STEPS_PER_PIECE], ends[-1]))
    counts = np.ceil(np.diff(coarse) / longest * (1.0 - tolerances.SAME_INSTANT)).astype(int)
    parts = [np.linspace(*ab, n, endpoint=False) for ab, n in zip(pairwise(coarse), np.maximum(counts, 1), strict=True)]
    return np.concatenate([*parts, np.zeros(0)])[1:]


def move_into_steps(ends: Array, marks: Array) -> Array:
    """Move marks into the middle half of a nearby step that is not short.

    Steps end where loads jump with a coordinate. There the effect of a disturbance depends on its sign, as it has
    crossed the jump or not, and the growth would not be the product of the growths of the two adjacent pieces.
    """
    lengths = np.diff(ends)
    capped_lengths = np.minimum(lengths, np.median(lengths))
    candidates = np.clip(np.searchsorted(ends[1:], marks)[:, None] + np.array(STEP_OFFSETS), 0, len(lengths) - 1)
    k = candidates[np.arange(len(marks)), np.argmax(capped_lengths[candidates], axis=1)]
    quarter = 0.25 * lengths[k]
    return np.asarray(np.maximum.accumulate(np.clip(marks, ends[k] + quarter, ends[k + 1] - quarter)))


class DisturbanceScale:
    """Converts small disturbances of states to scaled numbers, n displacements first, then n rates, and back."""

    def __init__(self, layout: Layout, rate: float) -> None:
        """rate [1/s]: rate that counts as 1"""
        self.layout, self.coordinates = layout, make_coordinates(layout)
        weights = self.coordinates.weights
        self.n = len(weights)
        self.weights = np.concatenate([weights, weights / rate])
        freedoms = layout.tables["freedoms"]
        self.q_at = freedoms["q_at"][self.coordinates.freedoms]
        self.attitudes = layout.bodies["attitude_at"][self.coordinates.balls]

    def disturb_state(self, state: Array, disturbances: Array) -> Array:
        """Return the states (k, n_state) that differ from one by scaled disturbances (k, 2 n)."""
        disturbed = self.coordinates.displace(
            np.repeat(state[None], len(disturbances), axis=0), disturbances[:, : self.n] / self.weights[: self.n]
        )
        disturbed[:, self.coordinates.rates] += disturbances[:, self.n :] / self.weights[self.n :]
        return disturbed

    def measure_disturbances(self, state: Array, others: Array) -> Array:
        """Return the scaled disturbances (k, 2 n) that lead from one state to others close by."""
        differences = np.zeros((len(others), 2 * self.n))
        differences[:, self.coordinates.numbers] = others[:, self.q_at] - state[self.q_at]
        for attitude_index, first in zip(self.attitudes.tolist(), self.coordinates.turns.tolist(), strict=True):
            inverse_attitude = state[attitude_index : attitude_index + 4] * np.array([1.0, -1.0, -1.0, -1.0])
            turn = quaternion_product(others[:, attitude_index : attitude_index + 4], inverse_attitude[None])
            differences[:, first : first + 3] = 2.0 * turn[:, 1:] * np.sign(turn[:, :1])
        differences[:, self.n :] = others[:, self.coordinates.rates] - state[self.coordinates.rates]
        return np.asarray(differences * self.weights)


class DisturbedRuns:
    """Disturbed runs close to the run of a scene, with the reduced scene that is integrated, or (whole) with the scene
    itself.
    """

    def __init__(self, runner: Runner, run: Trajectory, method: Method, *, whole: bool = False) -> None:
        self.runner, self.run, self.method = runner, run, method
        self.moving = integrate_itself(Evaluator(runner.layout)) if whole else runner.integrated_scene
        self.layout, self.workspace = self.moving.layout, self.moving.workspace
        self.rate = find_largest_rate(runner, run)
        self.scale = DisturbanceScale(self.layout, self.rate)
        self.projection_runner = Runner(self.layout) if self.layout.rows else None
        self.impulses = schedule_impulses(runner.layout.mechanism, float(run.times[-1]))

    def project_states(self, t: float, states: Array) -> Array:
        """Project states onto the closed chains."""
        if self.projection_runner is None:
            return states
        return self.projection_runner.evaluate(np.full(len(states), t), states).states

    def integrate_piece(self, piece: RunPiece, state: Array) -> tuple[Array, int] | None:
        """Integrate a state over a piece and return the final state and the steps; None if the end is not reached."""
        start = LoopStart(state, IMPLICIT_TOLERANCE if self.method.implicit else tolerances.LEAST_TOLERANCE, self.rate)
        run = KernelLoop(self.layout, self.workspace, self.method, np.array([piece.end]), STEPS_PER_CHUNK, start)
        run.loop.begin(piece.begin, piece.before_end, piece.end)
        for _ in range(MAX_CHUNKS):
            code = run.loop.advance(STEPS_PER_CHUNK, False, False)
            if code != MORE:
                return (np.array(run.loop.state()), run.loop.steps) if code == REACHED else None
        return None

    def apply_impulses(self, t: float, states: Array) -> Array:
        """Return the states after the impulses at an instant."""
        moving = self.moving
        for impulse in (impulse for impulse in self.impulses if impulse.before_time <= t <= impulse.after_time):
            for k, state in enumerate(states):
                jump = solve_impulse(self.runner, impulse, moving.embed_state(t, state), t)
                if jump is not None:
                    states[k] = moving.restrict(t, jump.after_state)
        return states

    def propagate_disturbances(self, piece: RunPiece, base: Array, Q: Array) -> tuple[Array, int] | None:
        """Propagate disturbances Q (2 n, k) over a piece and return them with the steps; None if a run does not reach
        its end.
        """
        states = self.project_states(piece.begin, np.vstack([base, self.scale.disturb_state(base, DISTURBANCE * Q.T)]))
        start = self.apply_impulses(piece.begin, states)
        results = []
        for state in start:
            result = self.integrate_piece(piece, state)
            if result is None:
                return None
            results.append(result)
        reached = np.array([state for state, _ in results])
        return self.scale.measure_disturbances(reached[0], reached[1:]).T / DISTURBANCE, results[0][1]

    def find_directions(self) -> Array:
        """Return all disturbances of the start that the closed chains admit, orthonormal (2 n, N)."""
        n, scale = self.scale.n, self.scale
        T = np.eye(n)
        if self.layout.rows:
            start = self.project_states(0.0, self.compute_run_states(np.zeros(1)))
            J = jacobian(self.workspace, self.layout, np.zeros(1), start)
            rows = J.block(np.arange(len(self.layout.rows)), scale.coordinates.result_indices)[0] / scale.weights[:n]
            T = compute_null_space(rows, min_scale=0.0)
        return np.block([[T, np.zeros_like(T)], [np.zeros_like(T), T]])

    def compute_run_states(self, times: Array) -> Array:
        """Return the states of the integrated scene at instants of the run."""
        states = self.runner.resample(self.run, times)
        return np.array([self.moving.restrict(t, y) for t, y in zip(times.tolist(), states, strict=True)])

    def compute_growth(self, Q: Array | None = None) -> DisturbanceGrowth:
        """Compute the growth of disturbances along the run: of all, or of those in the directions Q (2 n, N) of the
        start.
        """
        Q, factor = sample_directions(self.find_directions() if Q is None else Q)
        n = self.scale.n
        # the product R_m ... R_1, divided by e^log so that its largest number is 1
        C, log = np.eye(Q.shape[1]), 0.0
        samples, steps = [GrowthSample(0.0, 0.0, 0.0)], 0
        remaining = self.list_pieces()[::-1] if Q.shape[1] else []
        while remaining:
            piece, base = remaining.pop()
            propagated = self.propagate_disturbances(piece, base, Q)
            if propagated is None:
                return make_growth(samples, f"a neighbouring run does not reach t = {piece.end:.6g} s")
            D, piece_steps = propagated
            if np.abs(D).max() > MAX_GROWTH and piece.before_end - piece.begin > DISTURBANCE * piece.end:
                first, second = piece.split()
                remaining += [(second, self.compute_run_states(np.array([second.begin]))[0]), (first, base)]
                continue
            Q, R = np.linalg.qr(D)
            C, steps = R @ C, steps + piece_steps
            size = float(np.abs(C).max())
            if size == 0.0:
                return make_growth(samples, f"a disturbance dies out by t = {piece.end:.6g} s")
            C, log = C / size, log + math.log(size)
            G = factor * float(np.linalg.norm(Q[:n] @ C, 2))
            samples.append(GrowthSample(piece.end, log + math.log(max(G, tolerances.EPS)), float(steps)))
        return make_growth(samples, None)

    def list_pieces(self) -> list[tuple[RunPiece, Array]]:
        """Return the pieces of the run, and the states at which they begin."""
        pieces = list(iter_pieces(self.run))
        states = self.compute_run_states(np.array([piece.begin for piece in pieces]))
        return list(zip(pieces, states, strict=True))


def make_growth(samples: list[GrowthSample], stop_reason: str | None) -> DisturbanceGrowth:
    """Return the growth from its samples."""
    times, logarithm, steps = np.array(samples).T
    return DisturbanceGrowth(times, logarithm, steps, stop_reason)


def sample_directions(Q: Array) -> tuple[Array, float]:
    """Return at most MAX_DIRECTIONS random directions, and the factor by which they represent all."""
    N = Q.shape[1]
    if N <= MAX_DIRECTIONS:
        return Q, 1.0
    random_basis, _ = np.linalg.qr(np.random.default_rng(SEED).standard_normal((N, MAX_DIRECTIONS)))
    return Q @ random_basis, math.sqrt(N / MAX_DIRECTIONS)


def find_largest_rate(runner: Runner, run: Trajectory) -> float:
    """Return the largest undriven rate over a run, rotations in [rad/s], displacements divided by the scene's size
    [1/s].

    It is at least the rate of a free fall through the scene's size, and one per run time.
    """
    layout = runner.layout
    layout_coordinates = make_coordinates(layout)
    rates = np.abs(run.states[:, layout_coordinates.rates] * layout_coordinates.weights)
    g = float(np.sqrt(np.sum(layout.mechanism.gravity**2)))
    return max(float(rates.max(initial=0.0)), math.sqrt(g / layout.size), 1.0 / float(run.times[-1]))
