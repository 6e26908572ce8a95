"""Make a plan: the values of the parameters in each variant, made when they are needed, or drawn from a seed.

A plan of many variants holds its axes and its random numbers, not its rows.

Each parameter is first drawn in [0, 1), u, and then mapped by its law to its values:

    uniform, lhs, sobol    a + (b - a) u
    normal                 the u-quantile of mean a, deviation b

uniform and normal each have a stream of their own: the bits of PCG64, seeded by the seed and the parameter's name,
which NumPy guarantees to stay the same (NEP 19). So neither other parameters nor more samples change the draws of one.
With lhs all parameters together are one Latin hypercube, with sobol one scrambled Sobol sequence, as scipy.stats.qmc
draws them from this seed; a normal parameter among them is a further coordinate of that plan.

For Sobol indices every sample is drawn twice, A and B, followed by d variants which are A except for one parameter from
B (Saltelli 2010): d + 2 variants per sample, one after the other. A single plan does not show the error of its indices,
since its points depend on each other. So the samples belong to REPETITIONS plans in turn, each scrambled or shuffled by
itself: sample k is the next point of plan k mod REPETITIONS.
"""

from __future__ import annotations

import math
import warnings
from collections.abc import Iterator, Sequence
from typing import Any

import numpy as np

from heuncli.analyses.variants.parameters import HINT, AxisError, ParameterAxis, RandomVariable
from heuncli.base.named_tuples import NamedTuple
from heuncli.results.results import Array, Indices
from heuncli.scene.file_format.quantity import NumberWithUnit, ParameterValue

MAX_VARIANTS = 10_000_000


class Draws(NamedTuple):
    """Random parameters together: their laws, and their draws in their units, (variants, parameters).

    seed: with which the same draws are repeated
    each: number of consecutive variants of one sample
    repetitions: number of plans that are drawn independently; the samples belong to them in turn
    """

    laws: tuple[RandomVariable, ...]
    values: Array
    seed: int
    each: int = 1
    repetitions: int = 1


class PlanPlaces(NamedTuple):
    """The places that variants have in a plan: for one variant numbers, for several (n,) each.

    row: of the table; axes: which value each axis has; draw: row of the draws
    """

    row: Any
    axes: tuple[Any, ...]
    draw: Any


class Plan(NamedTuple):
    """The variants of a sweep, by number from 0. The first axis changes slowest.

    axes: every combination of their values is a variant
    together: whether the k-th values of all axes make the k-th variant instead
    draws: random samples, which change fastest
    columns: of a table; each of its rows is combined with all of the above, and they change slowest
    """

    axes: tuple[ParameterAxis, ...]
    together: bool = False
    draws: Draws | None = None
    columns: tuple[ParameterAxis, ...] = ()

    @property
    def names(self) -> tuple[str, ...]:
        """The names of what is varied, in the given order."""
        return (
            *(axis.name for axis in (*self.columns, *self.axes)),
            *(law.name for law in (self.draws.laws if self.draws else ())),
        )

    @property
    def size(self) -> int:
        """The number of variants."""
        return self._combinations * (len(self.draws.values) if self.draws is not None else 1)

    @property
    def _combinations(self) -> int:
        rows = len(self.columns[0].values) if self.columns else 1
        if self.together:
            return rows * (len(self.axes[0].values) if self.axes else 1)
        return rows * math.prod(len(axis.values) for axis in self.axes)

    @property
    def course_length(self) -> int:
        """How many successive variants differ only in the draws, or else in the last axis (all if they vary
        together).
        """
        if self.draws is not None:
            return len(self.draws.values)
        return self.size if self.together or not self.axes else len(self.axes[-1].values)

    @property
    def course_axis(self) -> ParameterAxis | None:
        """The last axis, where it alone changes fastest; None otherwise."""
        varies_alone = self.draws is None and (not self.together or len(self.axes) == 1)
        return self.axes[-1] if self.axes and varies_alone else None

    def find_places(self, number: Any) -> PlanPlaces:
        """Split the number of a variant, or (n,) of several: the draw changes fastest, the row of the table slowest."""
        number, draw = divmod(number, len(self.draws.values)) if self.draws is not None else (number, None)
        if self.together and self.axes:
            number, place = divmod(number, len(self.axes[0].values))
            return PlanPlaces(number, (place,) * len(self.axes), draw)
        places = []
        for axis in reversed(self.axes):
            number, place = divmod(number, len(axis.values))
            places.append(place)
        return PlanPlaces(number, tuple(reversed(places)), draw)

    def find_axis_places(self, axis: ParameterAxis, numbers: Indices) -> Indices:
        """Return which value of an axis, or of a column, each of some variants has, (n,)."""
        places = self.find_places(numbers)
        found: Indices = places.axes[self.axes.index(axis)] if axis in self.axes else places.row
        return found

    def find_values(self, number: int) -> dict[str, ParameterValue]:
        """Return the values of a variant."""
        row, places, draw = self.find_places(number)
        values = {column.name: column.find_value(row) for column in self.columns}
        values |= {axis.name: axis.find_value(place) for axis, place in zip(self.axes, places, strict=True)}
        if self.draws is not None:
            drawn = zip(self.draws.laws, self.draws.values[draw].tolist(), strict=True)
            values |= {law.name: NumberWithUnit(value, law.unit) for law, value in drawn}
        return values

    def iter_numbers(self, shard: tuple[int, int] = (1, 1)) -> Iterator[int]:
        """Iterate over the numbers of the variants; shard (k, n): over every n-th one, from the k-th on."""
        k, n = shard
        return iter(range(k - 1, self.size, n))


def make_axes_plan(
    axes: Sequence[ParameterAxis],
    *,
    together: bool = False,
    draws: Draws | None = None,
    columns: Sequence[ParameterAxis] = (),
) -> Plan:
    """Make the plan of some axes, and of the columns of a table, which have equal lengths. Raises AxisError."""
    if together or not axes:
        axes, columns, together = [*columns, *axes], (), together or bool(columns)
    names = [axis.name for axis in (*columns, *axes)] + [law.name for law in (draws.laws if draws else ())]
    for name in names:
        if names.count(name) > 1:
            raise AxisError(name, "is varied twice", "give one axis per parameter")
    if together and len({len(axis.values) for axis in axes}) > 1:
        counts = ", ".join(f"{axis.name} {len(axis.values)}" for axis in axes)
        raise AxisError(
            "--zip", f"the axes have different numbers of values: {counts}", "leave --zip out for all combinations"
        )
    plan = Plan(tuple(axes), together, draws, tuple(columns))
    if plan.size > MAX_VARIANTS:
        raise AxisError(" ".join(names), f"{plan.size:,} variants; at most {MAX_VARIANTS:,}", HINT)
    return plan


BITS = 52  # bits of a random number: (k + 1/2) / 2^52 is neither 0 nor 1, and exact
JOINT_LAWS = ("lhs", "sobol")  # all parameters of them are drawn together
REPETITIONS = 16  # independent plans for Sobol indices
MIN_SHARE = 0.5 * 2.0**-BITS  # least random number
SAMPLES_HINT = "for example --samples 1000"


def make_draws(laws: Sequence[RandomVariable], samples: int, seed: int = 0, *, indices: bool = False) -> Draws:
    """Draw the values of random parameters in their units; indices: for Sobol indices, d + 2 rows per sample.

    Raises AxisError.
    """
    _require_few(laws, samples, len(laws) + 2 if indices else 1)
    if seed < 0:
        raise AxisError("--seed", f"{seed}: expected 0 or more", "for example --seed 7")
    copies = 2 if indices else 1
    repetitions = REPETITIONS if indices and find_joint_law(laws) else 1
    points = _draw_points(laws, samples, seed, copies, repetitions).reshape(samples, copies, len(laws))
    for place, law in enumerate(laws):
        points[..., place] = _apply_law(law, points[..., place])
    if not indices:
        return Draws(tuple(laws), points[:, 0], seed)
    return Draws(tuple(laws), make_saltelli_plan(points[:, 0], points[:, 1]), seed, len(laws) + 2, repetitions)


def make_saltelli_plan(A: Array, B: Array) -> Array:
    """Make Saltelli's plan, (samples (d + 2), d).

    Each sample gives d + 2 rows: A, B, and for each parameter A with that parameter from B.
    """
    samples, d = A.shape
    rows = np.repeat(A[:, None, :], d + 2, axis=1)
    rows[:, 1] = B
    for i in range(d):
        rows[:, 2 + i, i] = B[:, i]
    return rows.reshape(samples * (d + 2), d)


def find_joint_law(laws: Sequence[RandomVariable]) -> str:
    """Return `lhs` or `sobol` if some parameters are drawn together by it, else empty. Raises AxisError if both are
    named.
    """
    joint_laws = {law.law for law in laws} & {*JOINT_LAWS}
    if len(joint_laws) > 1:
        names = " ".join(law.name for law in laws if law.law in JOINT_LAWS)
        raise AxisError(names, "lhs and sobol in one sweep", "use one of them: its parameters are drawn together")
    return joint_laws.pop() if joint_laws else ""


def make_imbalance_warning(laws: Sequence[RandomVariable], samples: int) -> str:
    """Return a warning if the number of samples is no power of two, where a Sobol sequence is not balanced; empty
    otherwise.
    """
    if find_joint_law(laws) != "sobol" or samples & (samples - 1) == 0:
        return ""
    low = 1 << (samples.bit_length() - 1)
    return f"--samples {samples}: a Sobol sequence is balanced at powers of two, such as {low} and {2 * low}"


def _require_few(laws: Sequence[RandomVariable], samples: int, rows_per_sample: int) -> None:
    if samples < 2:
        raise AxisError("--samples", f"{samples}: expected 2 or more", SAMPLES_HINT)
    if samples * rows_per_sample > MAX_VARIANTS:
        names = " ".join(law.name for law in laws)
        raise AxisError(
            names, f"{samples * rows_per_sample:,} variants; at most {MAX_VARIANTS:,}", "use fewer --samples"
        )


def _draw_points(laws: Sequence[RandomVariable], samples: int, seed: int, copies: int, repetitions: int) -> Array:
    """Draw numbers in [0, 1), (samples, copies d): the d parameters of the first copy, then those of the next."""
    law = find_joint_law(laws)
    d = len(laws)
    joint_places = [
        place for place, variable in enumerate(laws) if variable.law in JOINT_LAWS or (law and variable.law == "normal")
    ]
    points = np.empty((samples, copies * d))
    for copy in range(copies):
        for place, variable in enumerate(laws):
            if place not in joint_places:
                points[:, copy * d + place] = _draw_stream(variable.name, seed, copy, samples)
    if joint_places:
        columns = [copy * d + place for copy in range(copies) for place in joint_places]
        for plan in range(min(repetitions, samples)):
            sample_indices = np.arange(plan, samples, repetitions)
            points[sample_indices[:, None], columns] = _draw_joint(
                law, len(columns), len(sample_indices), (seed, plan) if repetitions > 1 else seed
            )
    return points


def _draw_stream(name: str, seed: int, copy: int, samples: int) -> Array:
    """Draw the numbers in (0, 1) of one parameter, (samples,)."""
    sequence = np.random.SeedSequence(seed, spawn_key=(copy, *name.encode()))
    raw = np.random.PCG64(sequence).random_raw(samples)
    found: Array = ((raw >> np.uint64(64 - BITS)).astype(np.float64) + 0.5) * 2.0**-BITS
    return found


def _draw_joint(law: str, columns: int, samples: int, seed: int | tuple[int, int]) -> Array:
    """Draw the points of one plan in all columns, (samples, columns) in [0, 1]."""
    from scipy.stats import qmc  # takes half a second to load

    generator = np.random.Generator(np.random.PCG64(seed))
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", UserWarning)  # of counts that are no power of two: see make_imbalance_warning
        if law == "sobol":
            found: Array = qmc.Sobol(columns, seed=generator).random(samples)
        else:
            found = qmc.LatinHypercube(columns, seed=generator).random(samples)
    return found


def _apply_law(law: RandomVariable, u: Array) -> Array:
    """Return the values of a law at the shares u of its distribution."""
    if law.law != "normal":
        found: Array = u * (law.b - law.a) + law.a  # in this order, as qmc.scale has it
        return found
    from statistics import NormalDist  # some milliseconds

    quantile = NormalDist(law.a, law.b).inv_cdf
    # a joint plan may have points at its ends, whose quantiles are infinite
    clipped = np.clip(u, MIN_SHARE, 1.0 - MIN_SHARE)
    return np.array([quantile(x) for x in clipped.ravel().tolist()]).reshape(u.shape)
