"""Draw random parameters from a seed, so that the same numbers can be drawn again.

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

import warnings
from collections.abc import Sequence

import numpy as np

from heuncli.analyses.variants.axes import AxisError
from heuncli.analyses.variants.parameters import RandomVariable
from heuncli.analyses.variants.plans import MAX_VARIANTS, Draws
from heuncli.results.results import Array

BITS = 52  # of a random number: (k + 1/2) / 2^52 is neither 0 nor 1, and exact
JOINT_LAWS = ("lhs", "sobol")
REPETITIONS = 16  # of a plan for Sobol indices
MIN_SHARE = 0.5 * 2.0**-BITS  # of them
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
    """Make Saltelli's plan: of each sample A, B, and A with its i-th parameter from B, (samples (d + 2), d)."""
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
        warnings.simplefilter("ignore", UserWarning)  # of counts that are no power of two: see warn_unbalanced
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
