"""What Lagrange's equations cost beside the results of their state, and over a turn."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

from heuncli.analyses.lagrange.inertia_curve import find_inertia_curve
from heuncli.analyses.lagrange.study import LagrangeOptions, solve_lagrange
from heuncli.app.commands.lagrange.command import parse_range
from heuncli.scene.file_format.load import load
from heuncli.study.workflow import solve
from tests.shared.folders import ROOT

SPECS = ("slider_crank", "excavator", "chain")


def equations(median_ms: Callable[[Callable[[], Any], int], float]) -> None:
    """Print both, start-up left out; median_ms: of a call that is repeated so often [ms]."""
    for name in SPECS:
        spec = load(str(ROOT / "specs" / f"{name}.yaml"))
        state = spec._replace(analysis=spec.analysis._replace(type="state", times=(0.0,), duration=None, conditions=()))
        own = median_ms(lambda state=state: solve_lagrange(state, LagrangeOptions()), 9)  # type: ignore[misc]
        run = median_ms(lambda state=state: solve(state), 9)  # type: ignore[misc]
        print(f"{name}: lagrange {own:.1f} ms, the results of its state {run:.1f} ms")
    spec = load(str(ROOT / "specs" / "slider_crank.yaml"))
    asked = parse_range("main.angle=0:360deg/73", spec)
    found = median_ms(lambda: find_inertia_curve(spec, asked), 9)
    print(f"slider-crank: lagrange over 73 values of a turn {found:.1f} ms")
