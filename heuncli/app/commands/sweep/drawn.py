"""What is drawn at random, as the command line asks for it: `--samples N --seed S --indices`."""

from __future__ import annotations

from collections.abc import Sequence

from heuncli.analyses.variants.axes import Drawn
from heuncli.analyses.variants.draws import SAMPLES_HINT, draws_of, unbalanced
from heuncli.analyses.variants.plans import Draws
from heuncli.app.cli.entry import UsageError
from heuncli.app.cli.output import say
from heuncli.app.commands.sweep.request import SweepRequest
from heuncli.base.errors import Problem

RANDOM_HINT = "such as d=normal(100,0.1)mm, r=uniform(20,60)mm, lhs(a,b) or sobol(a,b)"


def drawn(laws: Sequence[Drawn], request: SweepRequest) -> Draws | None:
    """The values of the random parameters; None where there are none. Raises UsageError, AxisError."""
    if not laws:
        asked = {"--samples": request.samples is not None, "--seed": request.seed is not None}
        for option, given in (asked | {"--indices": request.indices}).items():
            if given:
                raise UsageError(Problem("bad-option", f"{option}: nothing is drawn at random", hint=RANDOM_HINT))
        return None
    if request.samples is None:
        message = f"{', '.join(law.name for law in laws)}: how many are drawn?"
        raise UsageError(Problem("bad-option", message, hint=SAMPLES_HINT))
    draws = draws_of(laws, request.samples, request.seed or 0, indices=request.indices)
    lost = unbalanced(laws, request.samples)
    if lost and not request.quiet:
        say(f"warning: {lost}")
    if request.indices and not request.quiet:
        d = len(laws)
        say(f"heun: Sobol indices of {d} parameters: {request.samples:,} x ({d} + 2) = {len(draws.values):,} variants")
    return draws
