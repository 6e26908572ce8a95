"""Charts of methods made by hand: runs of any time and error, one that fails, one that was not tried."""

from __future__ import annotations

from heuncli.analyses.work_precision.results import (
    COMPLETED,
    FAILED,
    NOT_RUN,
    ChartResults,
    ChartRow,
    ChartRun,
    Reference,
    mark_front,
)  # fmt: skip

OWN = {"motion": 1e-13, "reactions": 2e-13, "sections": None}
REFERENCE = Reference("A at 3e-14 and B at 3e-14 agree: motion to 1e-13 of the model size", OWN, 2.0, 201)


def run(method: str, seconds: float, error: float, evaluations: int = 100, local: float = 1e-6) -> ChartRun:
    row = ChartRow(method, "quaternion", local > 1e-4, local)
    errors = {"motion": error, "reactions": 2.0 * error, "sections": None}
    return ChartRun(row, COMPLETED, seconds, 5, 10, evaluations, errors)


def chart(*runs: ChartRun, reference: Reference = REFERENCE) -> ChartResults:
    return ChartResults("A scene", {"path": "scene.yaml", "sha256": "0"}, reference, mark_front(runs), 1.0)


FAILS = ChartRun(
    ChartRow("Euler", "quaternion", True, 0.01), FAILED, 1e-4, failure_time=0.25, code="not-a-number",
    reason="at t = 0.25 s: no finite acceleration exists after this instant",
)  # fmt: skip
TOO_LONG = ChartRun(
    ChartRow("Euler", "quaternion", True, 1e-9), NOT_RUN, 9e3, code="too-long", reason="about 2e9 steps, 9e+03 s"
)
