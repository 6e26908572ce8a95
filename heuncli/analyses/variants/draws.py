"""Random parameters: numbers that a seed draws again.

Each parameter is drawn in [0, 1) first, u, and then turned by its law into its values:

    uniform, lhs, sobol    a + (b - a) u
    normal                 the u-quantile of mean a, deviation b

uniform and normal have each a stream of their own: the bits of PCG64, seeded by the seed and the parameter's name, of
which NumPy promises that they stay (NEP 19). So neither other parameters nor more samples change what is drawn of one.
Of lhs all parameters together are one Latin hypercube, of sobol one scrambled Sobol sequence, as scipy.stats.qmc draws
them by this seed; a normal beside them is a further coordinate of that plan.

For Sobol indices every sample is drawn twice, A and B, and d variants follow it which are A but for one parameter, that
of B (Saltelli 2010): d + 2 variants a sample, one behind the other. One plan tells nothing of how far its indices are
off, since its points hang on each other. So the samples are of REPETITIONS plans in turn, each scrambled or shuffled by
itself: sample k is the next point of plan k mod REPETITIONS.
"""

from __future__ import annotations

import warnings
from collections.abc import Sequence

import numpy as np

from heuncli.analyses.variants.axes import AxisError, Drawn
from heuncli.analyses.variants.plans import MOST_VARIANTS, Draws
from heuncli.results.results import Array

BITS = 52  # of a random number: (k + 1/2) / 2^52 is neither 0 nor 1, and exact
JOINT = ("lhs", "sobol")
REPETITIONS = 16  # of a plan for Sobol indices
LEAST = 0.5 * 2.0**-BITS  # of them
SAMPLES_HINT = "such as --samples 1000"


def draws_of(laws: Sequence[Drawn], samples: int, seed: int = 0, *, indices: bool = False) -> Draws:
    """The values of random parameters in their units; indices: for Sobol indices, d + 2 rows a sample.

    Raises AxisError.
    """
    _require_few(laws, samples, len(laws) + 2 if indices else 1)
    if seed < 0:
        raise AxisError("--seed", f"{seed}: expected a number from 0 on", "such as --seed 7")
    copies = 2 if indices else 1
    repetitions = REPETITIONS if indices and joint_law(laws) else 1
    points = _points(laws, samples, seed, copies, repetitions).reshape(samples, copies, len(laws))
    for place, law in enumerate(laws):
        points[..., place] = _by_law(law, points[..., place])
    if not indices:
        return Draws(tuple(laws), points[:, 0], seed)
    return Draws(tuple(laws), with_one_exchanged(points[:, 0], points[:, 1]), seed, len(laws) + 2, repetitions)


def with_one_exchanged(A: Array, B: Array) -> Array:
    """Saltelli's plan: of each sample A, B, and A with its i-th parameter from B, (samples (d + 2), d)."""
    samples, d = A.shape
    rows = np.repeat(A[:, None, :], d + 2, axis=1)
    rows[:, 1] = B
    for i in range(d):
        rows[:, 2 + i, i] = B[:, i]
    return rows.reshape(samples * (d + 2), d)


def joint_law(laws: Sequence[Drawn]) -> str:
    """`lhs` or `sobol` where some are drawn so, together; else empty. Raises AxisError where both are named."""
    named = {law.law for law in laws} & {*JOINT}
    if len(named) > 1:
        names = " ".join(law.name for law in laws if law.law in JOINT)
        raise AxisError(names, "lhs and sobol in one sweep", "one of both: their parameters are drawn together")
    return named.pop() if named else ""


def unbalanced(laws: Sequence[Drawn], samples: int) -> str:
    """What is lost where a Sobol sequence is cut off within a power of two; else empty."""
    if joint_law(laws) != "sobol" or samples & (samples - 1) == 0:
        return ""
    low = 1 << (samples.bit_length() - 1)
    return f"--samples {samples}: a Sobol sequence is balanced at powers of two, such as {low} and {2 * low}"


def _require_few(laws: Sequence[Drawn], samples: int, each: int) -> None:
    if samples < 2:
        raise AxisError("--samples", f"{samples}: expected 2 or more", SAMPLES_HINT)
    if samples * each > MOST_VARIANTS:
        names = " ".join(law.name for law in laws)
        raise AxisError(names, f"{samples * each:,} variants; at most {MOST_VARIANTS:,}", "fewer --samples")


def _points(laws: Sequence[Drawn], samples: int, seed: int, copies: int, repetitions: int) -> Array:
    """Numbers in [0, 1), (samples, copies d): the d parameters of the first copy, then those of the next."""
    law = joint_law(laws)
    d = len(laws)
    together = [place for place, one in enumerate(laws) if one.law in JOINT or (law and one.law == "normal")]
    points = np.empty((samples, copies * d))
    for copy in range(copies):
        for place, one in enumerate(laws):
            if place not in together:
                points[:, copy * d + place] = _stream(one.name, seed, copy, samples)
    if together:
        columns = [copy * d + place for copy in range(copies) for place in together]
        for plan in range(min(repetitions, samples)):
            own = np.arange(plan, samples, repetitions)
            points[own[:, None], columns] = _joint(
                law, len(columns), len(own), (seed, plan) if repetitions > 1 else seed
            )
    return points


def _stream(name: str, seed: int, copy: int, samples: int) -> Array:
    """The numbers in (0, 1) of one parameter, (samples,)."""
    own = np.random.SeedSequence(seed, spawn_key=(copy, *name.encode()))
    raw = np.random.PCG64(own).random_raw(samples)
    found: Array = ((raw >> np.uint64(64 - BITS)).astype(np.float64) + 0.5) * 2.0**-BITS
    return found


def _joint(law: str, columns: int, samples: int, seed: int | tuple[int, int]) -> Array:
    """The points of one plan in all columns, (samples, columns) in [0, 1]."""
    from scipy.stats import qmc  # half a second, where it is asked for

    generator = np.random.Generator(np.random.PCG64(seed))
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", UserWarning)  # of counts that are no power of two: unbalanced() tells of them
        if law == "sobol":
            found: Array = qmc.Sobol(columns, seed=generator).random(samples)
        else:
            found = qmc.LatinHypercube(columns, seed=generator).random(samples)
    return found


def _by_law(law: Drawn, u: Array) -> Array:
    """The values whose shares below them are u."""
    if law.law != "normal":
        found: Array = u * (law.b - law.a) + law.a  # in this order, as qmc.scale has it
        return found
    from statistics import NormalDist  # some milliseconds

    quantile = NormalDist(law.a, law.b).inv_cdf
    within = np.clip(u, LEAST, 1.0 - LEAST)  # a joint plan may have points at its ends, whose quantiles are infinite
    return np.array([quantile(x) for x in within.ravel().tolist()]).reshape(u.shape)
