"""`--view`: from where a machine is seen."""

from __future__ import annotations

import numpy as np

from heuncli.app.cli.entry import UsageError
from heuncli.base.errors import Finding, Problem
from heuncli.output.machine_geometry.views import view_of


def require_view(words: str | None) -> None:
    """Say before the work that a view is none. Raises UsageError."""
    if words is None:
        return
    try:
        view_of(words, np.zeros(3))
    except Finding as finding:
        problem = Problem(finding.code, f"--view {words}: {finding.message}", hint=finding.hint)
        raise UsageError(problem) from None
