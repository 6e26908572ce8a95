"""The time of `heun balance`: a six-cylinder engine, and a counterweight for it; order 6 against its closed form."""

from __future__ import annotations

import math
from collections.abc import Callable
from pathlib import Path
from typing import Any

from heuncli.analyses.balancing.results import BalanceOptions, WeightRequest
from heuncli.analyses.balancing.study import balance
from heuncli.scene.file_format.load import load

ENGINE = Path(__file__).parents[2] / "specs" / "six_cylinder.yaml"
RATE = 2000.0 * math.pi / 30.0
SIXTH = 6.0 * 2.0 * 0.05 * RATE**2 * 7.437903279419574e-5  # N: 6 m r ω² A6, r/l = 1/4


def balanced(median_ms: Callable[[Callable[[], Any], int], float]) -> None:
    """Print both times; median_ms: of a call that is repeated so often [ms]."""
    spec = load(str(ENGINE))
    weight = BalanceOptions(weights=(WeightRequest("crank", "main", None),))
    sixth = next(row.size for row in balance(spec).orders["force"] if row.order == 6.0)
    alone, weighted = median_ms(lambda: balance(spec), 5), median_ms(lambda: balance(spec, weight), 5)
    off = abs(sixth / SIXTH - 1.0)
    print(f"six cylinders: balance {alone:.0f} ms, order 6 off by {off:.0e}; with a counterweight {weighted:.0f} ms")
