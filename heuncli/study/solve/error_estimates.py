"""Estimate the errors of loads and energy, by kind: twice the difference between runs, plus the rounding of sums.

Errors are the largest over the whole run, including instants that are not requested; each is relative to the largest
result of its kind at the requested instants. Forces of a kind are compared with its largest force, or its largest
moment divided by its longest arm; its moments with the largest moment, or the largest force times the size of the
scene. The arm is the size of the scene; for the foundation it is the reach of the scene from the point that its moment
is taken about. Drives: torques and thrusts each against their own largest. Energy: against the largest kinetic, or the
range of potential energy and work, because these have no zero of their own. Where larger terms cancel and only rounding
is left of a kind, its error is given as 0.

motion_errors.py and load_errors.py collect the differences over a run; here are what one quantity collects (Extent),
the terms whose rounding its sums carry (BalanceTerms), and the errors that follow (ErrorEstimates).
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from functools import cached_property, reduce

import numpy as np

from heuncli.base import tolerances
from heuncli.base.named_tuples import NamedTuple
from heuncli.loads.kinetostatics.actions import AppliedLoad
from heuncli.loads.kinetostatics.bodies import BodyStates
from heuncli.loads.kinetostatics.foundation import find_inertia_rows
from heuncli.motion.integration.evaluator import Evaluation
from heuncli.multibody.mechanism.loads import RopeLoad
from heuncli.results.path_words import BY_CAUSE
from heuncli.results.results import Array, ErrorEstimate, Mask
from heuncli.results.results_schema import IMPULSES
from heuncli.scene.shapes.rotations import instants_first, instants_last, largest_magnitude, squared_lengths
from heuncli.study.model.setup import Setup


class Weights(NamedTuple):
    """The weights of an error: of the difference between the runs, and of the rounding of sums."""

    difference: float
    rounding: float


ESTIMATED = Weights(2.0, 1.0)  # error of a run, estimated by a finer one
DIFFERENCE_ONLY = Weights(1.0, 0.0)  # the difference itself


class Extent:
    """The largest difference, rounding, terms and range of one quantity over the instants added so far.

    claimed: the largest difference before the horizon
    """

    def __init__(self, weights: Weights = ESTIMATED) -> None:
        self.weights = weights
        self.difference = self.claimed = self.rounding = self.terms = 0.0
        self.largest = self.largest_requested = 0.0
        self.low, self.high = np.inf, -np.inf

    def add(
        self,
        values: Array,
        rounding: Array,
        terms: Array,
        which: tuple[Mask, Mask],
        extra_difference: Array | None = None,
    ) -> None:
        """Add values (c n, ...) of c runs, at each instant one run after the other.

        extra_difference (n,): added to the differences
        rounding, terms: (c n,)
        which: masks of the requested instants, and of those before the horizon, (n,)
        """
        is_requested, is_claimed = which
        if not values.size:
            return
        count, last = len(values) // len(is_requested), instants_last(values)
        first_run = last[..., 0::count]
        size = _compute_lengths(first_run)
        difference = reduce(np.maximum, [_compute_lengths(first_run - last[..., k::count]) for k in range(1, count)])
        self.add_difference(difference if extra_difference is None else difference + extra_difference, is_claimed)
        self.rounding = _larger(self.rounding, rounding)
        self.terms = _larger(self.terms, terms)
        self.largest, self.largest_requested = (
            _larger(self.largest, size),
            _larger(self.largest_requested, size[is_requested]),
        )
        self.low, self.high = min(self.low, float(first_run.min())), max(self.high, float(first_run.max()))

    def add_difference(self, difference: Array, is_claimed: Mask) -> None:
        """Add differences (n,); is_claimed: which of them are before the horizon."""
        self.difference, self.claimed = (
            _larger(self.difference, difference),
            _larger(self.claimed, difference[is_claimed]),
        )

    @property
    def error(self) -> float:
        """The estimated error over the whole run."""
        return self.weights.difference * self.difference + self.weights.rounding * self.rounding

    @property
    def claimed_error(self) -> float:
        """The estimated error before the horizon, up to which results are claimed."""
        return self.weights.difference * self.claimed + self.weights.rounding * self.rounding

    @property
    def range_or_largest(self) -> float:
        """The range between lowest and highest value, or the largest magnitude if that is smaller."""
        return max(min(self.high - self.low, self.largest), 0.0)


def compute_norms(vectors: Array) -> Array:
    """Return the lengths of vectors (n, m, 3), (n, m)."""
    return np.asarray(np.sqrt(np.einsum("tni,tni->tn", vectors, vectors)))


def compute_lengths(values: Array) -> Array:
    """Return the largest length of the vectors (n, ..., 3), or magnitude of the numbers (n,), at each instant."""
    return _compute_lengths(instants_last(values))


def _compute_lengths(values: Array) -> Array:
    """Return the same for values with the instants last, (..., 3, n) or (n,)."""
    if values.ndim == 1:
        return np.abs(values)
    squares = (values * values).sum(axis=-2).reshape(-1, values.shape[-1])
    return np.asarray(np.sqrt(squares.max(axis=0)))


def _larger(so_far: float, values: Array) -> float:
    """Return the largest; nan counts as infinite."""
    largest = float(values.max(initial=0.0))
    return max(so_far, largest) if np.isfinite(largest) else np.inf


def relative_error(error: float, terms: float, *scales: float) -> float:
    """Divide an error by the first of the scales that exceeds the rounding of its terms; 0 if none does."""
    scale = next((x for x in scales if x > tolerances.NO_LOAD * terms), 0.0)
    if scale == 0.0:
        return 0.0
    found = error / scale if np.isfinite(scale) else np.inf
    return min(found, tolerances.UNKNOWN)


MOTION_KINDS = ("motion", "attitudes", "rodrigues")  # kinds of errors of a motion


def estimate_load_rounding(solutions: Evaluation, force: Array, moment: Array, size: float) -> tuple[Array, Array]:
    """Estimate the rounding of forces [N] and moments [N m] at each instant, (c n,); force, moment: their largest
    terms.

    It is that of sums of some dozen terms, plus the kernel's estimate of the rounding of each multiplier: near a
    singular pose the closures amplify it (kernel/orthogonal.py).
    """
    rows = solutions.rows
    by_force = (rows["doubt"] * np.abs(rows["f"]).max(axis=2)).max(axis=1, initial=0.0)
    by_moment = (rows["doubt"] * np.abs(rows["m"]).max(axis=2)).max(axis=1, initial=0.0)
    F = tolerances.SUM_ROUNDING * force + by_force + by_moment / size
    return F, tolerances.SUM_ROUNDING * moment + by_moment + size * by_force


class BalanceTerms:
    """The terms of the balances: inertia loads, weights, and the largest of all at each instant (c n,).

    by_component: the inertia loads, force and moment, (b, 3, c n)
    force: [N]
    moment: [N m], including that of forces with the reach of the scene as arm
    rounding: of the loads, absolute
    """

    def __init__(self, setup: Setup, solutions: Evaluation, states: BodyStates, loads: Sequence[AppliedLoad]) -> None:
        mechanism, size = setup.scene.mechanism, setup.scene.layout.size
        ma, spin = self.by_component = find_inertia_rows(mechanism, states)
        self.weight = np.array([b.mass for b in mechanism.bodies])[:, None] * mechanism.gravity
        row_forces = solutions.rows["multiplier"][..., None] * solutions.rows["f"]
        applied = [load.action for load in loads]
        pulls = [
            solutions.loads["value"][:, own] for load, own in mechanism.iter_load_rows() if isinstance(load, RopeLoad)
        ]
        # a free spin is a balance of terms, too: m x_s.. and I sigma. + sigma x I sigma vanish there
        layout, bodies = setup.scene.layout, mechanism.bodies
        angular_motion = np.abs(states.component_rows("alpha")).max(axis=1) + squared_lengths(
            states.component_rows("omega")
        )
        arms = [b.center - layout.reference[layout.place[i]] for i, b in enumerate(bodies)]
        offset = np.array([[b.mass * float(np.abs(arm).max())] for b, arm in zip(bodies, arms, strict=True)])
        gyration = np.array([[float(np.trace(b.inertia))] for b in bodies])
        joint_force, joint_moment = (instants_last(solutions.bodies[name]) for name in ("joint_force", "joint_moment"))
        forces = [
            ma,
            angular_motion * offset,
            joint_force,
            instants_last(row_forces),
            *(instants_last(x.force) for x in applied),
            *(x.T for x in pulls),
        ]
        moments = [spin, angular_motion * gyration, joint_moment, *(instants_last(x.moment) for x in applied)]
        self.force = np.maximum(_find_largest_at_each_instant(forces), np.abs(self.weight).max(initial=0.0))
        self.moment = np.maximum(_find_largest_at_each_instant(moments), size * self.force)
        self.rounding = estimate_load_rounding(solutions, self.force, self.moment, size)

    @cached_property
    def ma(self) -> Array:
        """m x_s.. of the bodies, (c n, b, 3) [N]."""
        return instants_first(self.by_component[0])

    @cached_property
    def spin(self) -> Array:
        """I sigma. + sigma x I sigma, (c n, b, 3) [N m]."""
        return instants_first(self.by_component[1])


def _find_largest_at_each_instant(values: Iterable[Array]) -> Array:
    """Return the largest of all values at each instant, (c n,); each (..., c n)."""
    return np.asarray(np.max([largest_magnitude(x) for x in values], axis=0))


UNITS = {"force": "N", "moment": "N·m", "place": "m", "angle": "rad"}

# Kinds, and the reports that show them: kinds that are not requested are not compared.
REPORTS_OF_KIND = {
    "reactions": {"joints", "foundation"},
    "foundation": {"foundation"},
    "sections": {"sections"},
    "forces": {"forces"},
    "motion": {"motion", "points", "forces", IMPULSES},
    "energy": {"energy", IMPULSES},
}


class ErrorEstimates:
    """The extents of all quantities by kind, for the kinds that are requested, and the errors that follow from them.

    compared: the kinds
    reach: of the centre of mass that is farthest from the point that the foundation's moment is about
    """

    def __init__(self, setup: Setup, weights: Weights = ESTIMATED) -> None:
        self.setup, self.weights = setup, weights
        self.compared = frozenset(
            kind for kind, reports in REPORTS_OF_KIND.items() if reports & setup.selection.reports
        )
        self.extents: dict[tuple[str, str], Extent] = {}
        self.reach = 0.0

    def find_extent(self, kind: str, quantity: str) -> Extent:
        """Return what is collected of a quantity of a kind."""
        return self.extents.setdefault((kind, quantity), Extent(self.weights))

    def estimate(self) -> ErrorEstimate:
        """Return the estimated error of each requested kind, relative to its largest result."""
        size, found = self.setup.scene.layout.size, ErrorEstimate()
        if "reactions" in self.compared:
            found["reactions"] = self.find_relative_wrench_error(size, "reactions")
            found["drives"] = max(
                self.find_relative_wrench_error(1.0, "drives", "thrust", ""),
                self.find_relative_wrench_error(1.0, "drives", "", "torque"),
            )
        if "foundation" in self.compared:
            found["foundation"] = self.find_relative_wrench_error(
                size + self.reach, "foundation", other_kinds=("effects", "elements")
            )
        if "sections" in self.compared:
            found["sections"] = self.find_relative_wrench_error(size, "sections")
        if "energy" in self.compared:
            found["energy"] = self.find_relative_energy_error()
        return found

    def errors(self) -> dict[tuple[str, str], float]:
        """Return the estimated errors by kind and unit, before the horizon."""
        error_by_name = {name: extent.claimed_error for name, extent in self.extents.items()}
        found = {
            name: error
            for name, error in error_by_name.items()
            if name[0] in (*MOTION_KINDS, "forces", "strains", "travels", "axis")
        }
        foundation_kinds = ("foundation", "effects", "elements")
        for kind, parts in (
            ("reactions", ("reactions",)),
            ("sections", ("sections",)),
            ("sensors", ("sensors",)),
            ("bearings", ("bearings",)),
            ("foundation", foundation_kinds),
        ):
            for quantity, unit in (("force", "N"), ("moment", "N·m")):
                found[kind, unit] = max(error_by_name.get((part, quantity), 0.0) for part in parts)
        found |= {
            ("reactions", UNITS[x]): error_by_name["reactions", x]
            for x in ("place", "angle")
            if ("reactions", x) in error_by_name
        }
        found["drives", "N"], found["drives", "N·m"] = (
            error_by_name.get(("drives", x), 0.0) for x in ("thrust", "torque")
        )
        found["energy", "J"] = max(
            error_by_name.get(("energy", name), 0.0) for name in ("kinetic", "potential", "work")
        )
        return found | self.estimate_errors_by_cause()

    def estimate_errors_by_cause(self) -> dict[tuple[str, str], float]:
        """Return the estimated errors of shares by cause, by kind and unit, before the horizon."""
        units = {"force": "N", "moment": "N·m"}
        extents = {name: extent for name, extent in self.extents.items() if name[0].endswith(BY_CAUSE)}
        return {(kind, units[name]): extent.claimed_error for (kind, name), extent in extents.items()}

    def find_relative_wrench_error(
        self, arm: float, kind: str, force: str = "force", moment: str = "moment", other_kinds: Sequence[str] = ()
    ) -> float:
        """Return the relative error of forces and moments of a kind, together with those of other kinds.

        arm: the longest lever of a moment
        """
        if not other_kinds and not {(kind, force), (kind, moment)} & self.extents.keys():
            return 0.0
        size = self.setup.scene.layout.size
        F, M = self.find_extent(kind, force), self.find_extent(kind, moment)
        parts = [(F, M), *((self.find_extent(other, force), self.find_extent(other, moment)) for other in other_kinds)]
        terms_F, terms_M = max(f.terms for f, _ in parts), max(m.terms for _, m in parts)
        forces = [
            max(F.largest_requested, M.largest_requested / arm),
            *(max(f.largest, m.largest / arm) for f, m in parts),
        ]
        moments = [
            max(M.largest_requested, F.largest_requested * size),
            *(max(m.largest, f.largest * size) for f, m in parts),
        ]
        return max(
            relative_error(max(f.error for f, _ in parts), max(terms_F, terms_M / arm), *forces),
            relative_error(max(m.error for _, m in parts), max(terms_M, terms_F * size), *moments),
        )

    def find_relative_energy_error(self) -> float:
        """Return the relative error of the energies."""
        mechanism, size = self.setup.scene.mechanism, self.setup.scene.layout.size
        kinetic, potential, work = (self.find_extent("energy", name) for name in ("kinetic", "potential", "work"))
        lift = sum(b.mass for b in mechanism.bodies) * float(np.abs(mechanism.gravity).max()) * size
        if kinetic.largest <= tolerances.NO_ENERGY * lift:
            return 0.0
        error = max(x.error for x in (kinetic, potential, work))
        shown_energy = max(kinetic.largest_requested, potential.range_or_largest, work.range_or_largest)
        return relative_error(error, kinetic.largest, shown_energy, kinetic.largest)

    def find_largest_kinetic_energy(self) -> float:
        """Return the largest kinetic energy over the run [J]."""
        return self.find_extent("energy", "kinetic").largest
