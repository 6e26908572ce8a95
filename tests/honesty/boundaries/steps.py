"""Lengths of steps."""

from __future__ import annotations

from tests.honesty.boundaries.part import Part, Row
from tests.shared.scenes import near, solved


def beyond_its_steps(x: float) -> str:
    """A fall of ten given steps and x of one more, into which the last one goes or which is a step by itself."""
    fall = {
        "gravity": [0, 0, -9.81], "bodies": {"b": {"mass": 1, "center": [0, 0, 0], "inertia": [1, 1, 1]}},
        "analysis": {"times": [0.0, 1.0 + 0.1 * x], "method": "RK4", "step": 0.1},
    }  # fmt: skip
    found = solved(fall, reduce=False)
    near(found.bodies["b"]["position"][-1][2], -0.5 * 9.81 * found.time[-1] ** 2, 5.0, 1e-14)
    return f"{found.work['steps']} steps"


PART = Part(
    ("kernel: steps",),
    rows=(Row("KERNEL.given_end", beyond_its_steps, "10 steps", "11 steps"),),
    exempt={
        "KERNEL.singular_retries": "lengths of steps that are tried: the estimate says what was reached",
        "KERNEL.retry_ratio": "lengths of steps that are tried: the estimate says what was reached",
        "KERNEL.pivot_rounding": "lengths of steps that are tried: the estimate says what was reached",
        "KERNEL.pivot_noise": "lengths of steps that are tried: the estimate says what was reached",
        "KERNEL.slow_rate": "lengths of steps of what is slow beside others: the estimate says what they are worth",
        "KERNEL.balanced_rate": "lengths of steps of what rests: the estimate says what they are worth",
        "KERNEL.imposed_rounding": "lengths of steps of what rests: the estimate says what they are worth",
        "KERNEL.held_rate": "lengths of the first steps from rest: the estimate says what they are worth",
    },
    wanted={
        "KERNEL.least_step": "whether a step has collapsed",
    },
)
