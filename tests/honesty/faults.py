"""What a run tells of its start against the exact answer, by the error that the run states."""

from __future__ import annotations

from typing import Any

import numpy as np

from heuncli.base import tolerances
from heuncli.study.queries.study import Study
from tests.shared.exact import Exact


def faults(run: Study, scene: dict[str, Any], exact: Exact, apart: float = 0.0) -> list[str]:
    """Numbers at the start that are not right within the error stated: loads, and accelerations.

    apart: how far the scene is from the one that was solved.
    """
    found, size = run.results, run.setup.scene.layout.size
    allowed = found.accuracy["estimate"]["reactions"] + tolerances.WRITTEN + apart
    force, moment, center, angular = ({name: np.array(v, dtype=float) for name, v in of.items()} for of in exact)
    largest = max(9.81 * body["mass"] for body in scene["bodies"].values())
    for F, M in zip(force.values(), moment.values(), strict=True):
        largest = max(largest, np.nanmax(np.abs([F, M / size]), initial=0.0))
    wrong = []
    for name, block in found.joints.items():
        for what, wanted, arm in (("force", force, 1.0), ("moment", moment, size)):
            told = block[what][0]
            number = ~np.isnan(told)  # what is told as open may have a number, not the other way round
            off = np.abs(told - wanted[name])[number].max(initial=0.0) / arm / largest
            if not off <= allowed:
                wrong.append(f"{what} of {name} off by {off:.1e} of {largest:.3g} N, {allowed:.1e} stated: {told}")
    for name, block in found.bodies.items():
        # an acceleration, against what the largest load would give the body
        scale = max(largest / scene["bodies"][name]["mass"], 9.81)
        for what, wanted, length in (("center", center, 1.0), ("angular", angular, size)):
            off = np.abs(block[f"{what}_acceleration"][0] - wanted[name]).max() * length / scale
            if not off <= allowed:
                wrong.append(f"{what} acceleration of {name} off by {off:.2g} of {scale:.2g} m/s^2")
    return wrong
