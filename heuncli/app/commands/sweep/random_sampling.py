"""Draw random parameters by the options `--samples N --seed S --indices`."""

from __future__ import annotations

from collections.abc import Sequence

from heuncli.analyses.variants.parameters import RandomVariable
from heuncli.analyses.variants.plans import SAMPLES_HINT, Draws, make_draws, make_imbalance_warning
from heuncli.app.cli.entry import UsageError
from heuncli.app.cli.output import print_stderr
from heuncli.app.commands.sweep.request import SweepRequest
from heuncli.base.errors import Problem

RANDOM_HINT = "for example d=normal(100,0.1)mm, r=uniform(20,60)mm, lhs(a,b) or sobol(a,b)"


def draw_samples(laws: Sequence[RandomVariable], request: SweepRequest) -> Draws | None:
    """Draw the values of the random parameters; None if there are none. Raises UsageError, AxisError."""
    if not laws:
        options = {"--samples": request.samples is not None, "--seed": request.seed is not None}
        for option, is_given in (options | {"--indices": request.indices}).items():
            if is_given:
                raise UsageError(Problem("bad-option", f"{option}: no parameter is random", hint=RANDOM_HINT))
        return None
    if request.samples is None:
        message = f"{', '.join(law.name for law in laws)}: the number of samples is missing"
        raise UsageError(Problem("bad-option", message, hint=SAMPLES_HINT))
    draws = make_draws(laws, request.samples, request.seed or 0, indices=request.indices)
    imbalance = make_imbalance_warning(laws, request.samples)
    if imbalance and not request.quiet:
        print_stderr(f"warning: {imbalance}")
    if request.indices and not request.quiet:
        d = len(laws)
        print_stderr(
            f"heun: Sobol indices of {d} parameters: {request.samples:,} x ({d} + 2) = {len(draws.values):,} variants"
        )
    return draws
