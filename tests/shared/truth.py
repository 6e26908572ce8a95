"""How far a run is from the truth: from runs of its own start whose steps err less than its rounding."""

from __future__ import annotations

import numpy as np

from heuncli.motion.integration.run.request import MotionTask
from heuncli.results.results import Array, Results
from heuncli.study.queries.study import Study

TRUTH, SECOND = 3e-15, 1e-14  # local tolerances; the run judged has 3e-14 at best
KNOWN = 0.3  # of what is stated: how well the truth must be known to judge by it


def off(run: Study, shown: Results, times: Array, tolerance: float, blows: tuple[float, ...] = ()) -> Array:
    """How far the motion is from a run at a local tolerance, up to each instant, of the scene's size."""
    runner, layout = run.setup.runner, run.setup.scene.layout
    fine = runner.evaluate(times, runner.run(MotionTask(times, tolerance, discontinuities=blows)).states).bodies
    worst = np.zeros(len(times))
    for i, one in enumerate(layout.mechanism.bodies):
        k = layout.place[i]
        for p, found in (
            (one.center, shown.bodies[one.name]["center"]),
            *((p, shown.points[f"{one.name}.{name}"]["position"]) for name, p in one.points.items()),
        ):
            where = fine["r"][:, k] + np.einsum("tij,j->ti", fine["R"][:, k], p - layout.reference[k])
            worst = np.maximum(worst, np.sqrt(np.sum((where - found) ** 2, axis=1)))
    return np.asarray(np.maximum.accumulate(worst) / layout.size)
