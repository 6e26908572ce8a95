"""Which reports tables tell of a spec where nobody asks for others."""

from __future__ import annotations

from heuncli.report.page import TABLE_DEFAULT
from heuncli.results_schema import BLOWS
from heuncli.spec.models import Spec


def told_by_default(spec: Spec) -> frozenset[str]:
    """Those of the spec's `report`; else all but motion and points, and of blows at time 0 alone the blows."""
    if spec.report is not None:
        return frozenset(spec.report)
    return frozenset({BLOWS}) if spec.analysis.type == "impulse" else TABLE_DEFAULT
