"""What a motion comes near to: a lock of Euler angles, exponential growth."""

from __future__ import annotations

import math

import numpy as np

from heuncli.analyses.motion_diagnostics.growth import make_results
from heuncli.analyses.motion_diagnostics.lyapunov import DisturbanceGrowth
from heuncli.analyses.motion_diagnostics.study import probe
from heuncli.scene.file_format.load import load
from heuncli.study.model.options import Options
from tests.honesty.boundaries.part import Part, Row
from tests.shared.scenes import near


def tilted_by(x: float) -> str:
    """A body whose z is x off the world's."""
    body = f"{{mass: 1, center: [0, 0, 0], inertia: [1, 1, 1], orientation: {{axis: [1, 0, 0], angle: {x!r}}}}}"
    found = probe(load("scene.yaml", f"heun: 1\nbodies: {{b: {body}}}\nanalysis: {{type: state}}\n"), Options())
    wanted = 1.0 / math.tan(0.5 * x)
    near(found.attitudes[0].euler["zxz"][0], wanted, wanted, 1e-7)
    return found.events[0].kind if found.events else "none"


def grown(x: float) -> str:
    """A disturbance that grows x times over the second half of a run, and as evenly before."""
    times = np.linspace(0.0, 1.0, 11)
    growing, _ = make_results(DisturbanceGrowth(times, 2.0 * math.log(x) * times, np.ones(11)), 1)
    assert growing is not None
    near(growing.rate, 2.0 * math.log(x), 1.0)
    return "exponential" if growing.exponential else "with the time"


PART = Part(
    ("what a motion comes near to",),
    rows=(
        Row("GIMBAL", tilted_by, "gimbal lock", "none"),
        Row("FASTER_THAN_TIME", grown, "with the time", "exponential"),
    ),
)
