"""The option `--view`: the direction from which a machine is seen."""

from __future__ import annotations

import numpy as np

from heuncli.app.cli.entry import UsageError
from heuncli.base.errors import Finding, Problem
from heuncli.output.machine_geometry.views import parse_view


def require_view(words: str | None) -> None:
    """Require that `--view` is valid, before any work. Raises UsageError."""
    if words is None:
        return
    try:
        parse_view(words, np.zeros(3))
    except Finding as finding:
        problem = Problem(finding.code, f"--view {words}: {finding.message}", hint=finding.hint)
        raise UsageError(problem) from None
