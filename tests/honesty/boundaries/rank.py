"""Which conditions of the joints hold what others hold already, and how near to a singular pose a machine comes."""

from __future__ import annotations

import math

import numpy as np

from heuncli.results.results import Results
from heuncli.study.compose.unknown_numbers import SAFETY, estimate_errors, find_unknown
from tests.honesty.boundaries.part import Part, Row
from tests.honesty.boundaries.scenes import WEIGHT, four_bar, verdict
from tests.shared.scenes import near
from tests.shared.stretched_chain import stretched_chain


def moved_by(x: float) -> str:
    """A load whose largest companion is 2 N, where its state is moved by rounding."""
    off = estimate_errors(np.array([3.0]), np.array([3.0, 3.0 - 2.0 * x / SAFETY, 3.0]))
    return "not known" if find_unknown(off, np.array([2.0])).any() else "told"


def across(x: float) -> str:
    """A straight chain pulled by 1 N along it, and x across, over what counts as arms: half a link and both of them."""
    return verdict(stretched_chain(0.0, f"[1, 0, {2.5 * x!r}]"))


def parallelogram(angle: float) -> str:
    """Bars of 1 m, so far from flat: d'Alembert gives what the coupler's pin carries."""
    c, s = math.cos(angle), math.sin(angle)

    def right(found: Results) -> None:
        # theta'' = -6/5 g cos(theta); the coupler moves with the bars' ends, half of it hangs on either pin
        ax, ay = 1.2 * WEIGHT * c * s, -1.2 * WEIGHT * c * c
        force = found.joints["C"]["force"][0]
        near(force[1], 0.5 * (ay + WEIGHT), WEIGHT, 1e-7)
        if not np.isnan(force[0]):
            near(force[0], 0.5 * ax, WEIGHT, 1e-7)

    return verdict(four_bar((c, s), (1 + c, s)), right)


def beside_flat(x: float) -> str:
    """Bars of 1 m past the pose in which they lie flat, the coupler longer by the square of x, which keeps them off it.

    The closures' least singular value there goes with the root of that length. The right bar turns back.
    """
    b = 1.0 + 1.8e-9 * (x / 4.0) ** 2
    p = np.array([math.cos(2.6), math.sin(2.6)])
    to = np.array([1.0, 0.0]) - p
    L = math.sqrt(float(to @ to))
    k = (L * L + b * b - 1.0) / (2.0 * L)  # from p to the foot of the height on the diagonal
    q = p + (k * to + math.sqrt(b * b - k * k) * np.array([-to[1], to[0]])) / L

    def right(found: Results) -> None:
        ends = [found.points[name]["position"][-1] for name in ("left.t", "right.t")]
        assert ends[0][1] < 0.0 < ends[1][1]
        near(math.sqrt(float(np.sum((ends[1] - ends[0]) ** 2))), b, 1.0, 1e-11)

    tail = "analysis: {duration: 0.3, samples: 3}"
    return verdict(four_bar(p, q, ", angular_velocity: [0, 0, 4]", tail), right)


def flat_by(x: float) -> str:
    """A parallelogram whose row has x left of it."""
    return parallelogram(x / math.sqrt(2))


PART = Part(
    ("rank", "kernel: rank"),
    rows=(
        Row("KERNEL.independent", flat_by, "warned: singular position", "warned: nearly singular position"),
        Row("LOAD_ALONG_FREE_MOTION", across, "warned: singular position", "refused: singular-pose"),
        Row("NEARLY_SINGULAR", lambda x: parallelogram(x / math.sqrt(2)), "warned: nearly singular position", "fine"),
        Row("SINGULAR_MET", beside_flat, "warned: singular position", "fine", (1 / 3, 3.0)),
        Row("UNKNOWN_NEAR_SINGULAR", moved_by, "told", "not known"),
    ),
    exempt={
        "NO_SINGULAR_VALUE": "which solution of least squares is taken, of those that rounding alone tells apart",
        "KERNEL.preference": "which of the rows alike carry the motion",
        "KERNEL.pivot_drop": "when rows are chosen anew: costs digits, which the estimate shows",
        "KERNEL.near_singular": "which stages are settled: costs digits, which the estimate shows",
        "KERNEL.rounding": "the doubt of the multipliers, in steps of one rounding",
    },
    wanted={
        "NEIGHBOUR": "which rank is the generic one, where a machine can hardly leave its singular start",
        "REMAINING_RATE": "whether a displaced pose counts",
        "UNSEEN_GAP": "how far states beside a singular pose are moved; UNKNOWN_NEAR_SINGULAR decides what is told",
        "NEAR_PIVOT": "whether a state is recovered again, moved by its rounding; UNKNOWN_NEAR_SINGULAR decides",
        "SUSPECT_PIVOT": "whether a singular pose is looked for in a step",
        "KERNEL.row_across": "what a pivot is measured by",
        "RANK": "which motions of bodies without inertia, and of the assembly, are none; the kernel has its own of it",
        "RANK_OF_GAP": "which rows a gap feigns: what is near to a singular pose closes its gaps by a move",
        "SINGULAR_FALL": "whether a pose is passed through that is everywhere as near to a singular one",
        "NEARLY_DEPENDENT": "whether a dependence is told as not quite one",
        "UNMET_ROW_FACTOR": "whether accelerations that leave rows unmet are refused",
        "KERNEL.passing": "which rows are left out on the way through a singular pose",
        "KERNEL.passing_of_start": "the same in a scene that begins beside one",
        "KERNEL.locked": "whether a step that collapsed is a lock",
        "KERNEL.locked_step": "whether a step that collapsed is a lock",
    },
)
