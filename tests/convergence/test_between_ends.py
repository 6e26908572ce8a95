"""What a method errs by between the ends of its steps is seen at the instants at which its runs are compared.

An estimate of the ends alone, or of other parts of the steps, told half of what stiff methods erred by.
"""

from __future__ import annotations

import numpy as np
import pytest

from heuncli.base.method_rows import METHODS
from heuncli.motion.integration.methods.method import load_method_by_name
from heuncli.motion.integration.run.request import MotionTask
from heuncli.results.results import Array
from tests.shared.bars import chain, double
from tests.shared.scenes import study
from tests.shared.tops import heavy_top

pytestmark = pytest.mark.heavy

NAMES = [row.name for row in METHODS if row.kind != "SciPy" and row.attitude != "rodrigues"]
SCENES = {
    "two balls": double("{times: [1]}"), "five balls": chain(5, "{times: [1]}"),
    "top": heavy_top(8, "60 deg", "[1]"),
}  # fmt: skip
PARTS = np.linspace(0.0, 1.0, 41)[1:]  # of a step
SEEN = 0.66  # of the largest error of any part of the step: twice the difference of the runs is then no less than it
STEP, LOCAL = 0.02, 1e-5
SOME = 6  # steps of a run
ROUNDED = 1e-12  # of numbers of some units: below, it is rounding that errs


def erred(name: str, scene: str) -> list[Array]:
    """Of some steps the error at PARTS of them, against the motion that goes on from the step's start."""
    runner = study(SCENES[scene]).setup.runner
    method = load_method_by_name(name)
    run = runner.run(MotionTask(np.array([0.0, 0.8]), STEP if method.has_fixed_step else LOCAL, method=method))
    ends = run.ends
    found = []
    for k in np.unique(np.linspace(1, len(ends) - 2, SOME).astype(int)).tolist():
        inner = ends[k - 1] + PARTS * (ends[k] - ends[k - 1])
        begin = runner.resample(run, ends[k - 1 : k])[0]
        exact = runner.run(MotionTask(inner - ends[k - 1], 1e-14, start=begin))
        found.append(np.abs(runner.resample(run, inner) - exact.states).max(axis=1))
    return [error for error in found if error.max() > ROUNDED]


@pytest.mark.parametrize("scene", SCENES)
@pytest.mark.parametrize("name", NAMES)
@pytest.mark.third
def test_the_largest_error_is_seen(name: str, scene: str) -> None:
    errors = erred(name, scene)
    assert errors or name == "Gauss6"
    parts = (*load_method_by_name(name).sample_fractions, 1.0)
    seen = [max(float(error[int(np.argmin(np.abs(PARTS - x)))]) for x in parts) for error in errors]
    assert all(s >= SEEN * float(error.max()) for s, error in zip(seen, errors, strict=True))


TOLERANCES = 10.0 ** np.arange(-11.5, -7.5, 0.3)


@pytest.mark.parametrize("samples", [2, 101, 201])
@pytest.mark.parametrize("name", ["DOP853", "DOP853-recentred"])
@pytest.mark.third
def test_what_is_told_holds_between_the_asked_instants(name: str, samples: int) -> None:
    """Several instants asked for in each step need not lie where it errs most: it is told."""
    text = double(f"{{duration: 1.5, samples: {samples}}}")
    times = np.linspace(0.0, 1.5, 400)
    exact = study(text, method="Verner98", tolerance=1e-14, reduce=False).resample(times)
    for tolerance in TOLERANCES.tolist():
        one = study(text, method=name, tolerance=tolerance, reduce=False)
        found, size = one.resample(times), one.setup.runner.layout.size
        off = max(float(np.abs(found.bodies[b]["center"] - exact.bodies[b]["center"]).max()) for b in exact.bodies)
        assert off / size <= found.accuracy["estimate"]["motion"]
