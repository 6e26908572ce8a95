"""How many digits a number is shown with: no more than its error estimate supports, and never more than six.

The error of a run is known by kind: that of the motion relative to the size of the scene, that of the reactions
relative to the largest reaction. So every unit has an absolute error, and below it nothing is printed. Numbers of one
family (the components of one vector) share their decimals, so that a component that is noise beside the others reads 0.
"""

from __future__ import annotations

import math
from collections.abc import Iterable, Mapping, Sequence
from typing import NamedTuple

import numpy as np

from heuncli import tolerances
from heuncli.report.labels import Labels
from heuncli.report.quantities import walk
from heuncli.results import Array, Estimate, Results

DIGITS = 6
LOAD_UNITS = frozenset({"N", "N·m", "N·s", "N·m·s", "Pa"})
LARGE, SMALL = 1e7, 1e-4  # families beyond these are written with an exponent
OPEN = "open"
OPEN_NOTE = "open: the laws of rigid bodies do not give this number (redundant supports)"
ZERO_NOTE = "what is 0 throughout is left out"
BEYOND = "?"


class Certainty(NamedTuple):
    """The absolute error of numbers by unit."""

    errors: Mapping[str, float]

    def error(self, unit: str) -> float:
        """The absolute error of numbers in this unit; 0 where nothing is known of it."""
        return self.errors.get(unit, 0.0)


class Style(NamedTuple):
    """How the numbers of one family are written: fixed decimals, or an exponent where the family is far from 1."""

    decimals: int
    exponent: bool = False

    def write(self, value: float) -> str:
        """The number as text: `open` for nan, `0` for what is below the certain digits."""
        if math.isnan(value):
            return OPEN
        if math.isinf(value):
            return "unbounded"
        if abs(value) < 0.5 * 10.0**-self.decimals:
            return "0"
        if self.exponent:
            mantissa = min(max(self.decimals + math.floor(math.log10(abs(value))), 0), DIGITS - 1)
            return f"{value:.{mantissa}e}"
        return f"{value:.{max(self.decimals, 0)}f}"


def certainty(results: Results, labels: Labels) -> Certainty:
    """The absolute errors of a run, from its own estimates and the largest number of each unit."""
    estimate = results.accuracy.get("estimate", Estimate())
    motion = _relative(estimate.get("motion"))
    loads = max(_relative(estimate.get("reactions")), _relative(results.accuracy.get("balance_residual")))
    if results.accuracy.get("horizon") is not None:
        motion, loads = min(motion, tolerances.CLAIMED), min(loads, tolerances.CLAIMED)
    scales: dict[str, float] = {}
    for series in walk(results, labels):
        scales[series.unit] = max(scales.get(series.unit, 0.0), largest(series.values))
    if "N·m" in scales:  # a moment is at least as uncertain as the largest force times its arm
        scales["N·m"] = max(scales["N·m"], scales.get("N", 0.0) * max(_reach(results), labels.size))
    for turning, moving in (
        ("rad/s", "m/s"),
        ("rad/s²", "m/s²"),
    ):  # a velocity at least as the angular one times the body's extent
        if moving in scales:
            scales[moving] = max(scales[moving], scales.get(turning, 0.0) * labels.size)
    errors = {unit: scale * (loads if unit in LOAD_UNITS else motion) for unit, scale in scales.items()}
    return Certainty(errors | {"MPa": 1e-6 * errors.get("Pa", 0.0)})


def largest(values: Array) -> float:
    """The largest finite magnitude, 0 where there is none."""
    finite = np.abs(values[np.isfinite(values)])
    return float(finite.max()) if finite.size else 0.0


def style(scale: float, error: float) -> Style:
    """The style of a family whose largest magnitude is `scale` and whose numbers are certain to `error`."""
    if scale <= error or scale == 0.0:
        return Style(0 if error <= 0.0 else math.floor(-math.log10(max(error, 1e-300))) - 1)
    decimals = DIGITS - 1 - math.floor(math.log10(scale))
    if scale < LARGE:
        decimals = max(decimals, 0)  # forces of a few million newtons are written without an exponent
    if error > 0.0:
        decimals = min(decimals, math.floor(-math.log10(error)))
    return Style(decimals, exponent=not SMALL <= scale < LARGE or decimals < 0)


def write(values: Iterable[float], how: Style) -> list[str]:
    """The numbers of one family as text, without the zeros that end all of them."""
    return trim([how.write(value) for value in values])


def trim(texts: Sequence[str]) -> list[str]:
    """The texts without the trailing zeros they have in common, one decimal kept."""
    spare = [len(text) - len(text.rstrip("0")) for text in texts if "." in text and "e" not in text]
    whole = [len(text.partition(".")[2]) for text in texts if "." in text and "e" not in text]
    cut = min((min(zeros, decimals - 1) for zeros, decimals in zip(spare, whole, strict=True)), default=0)
    return [text[: len(text) - cut] if cut and "." in text and "e" not in text else text for text in texts]


def write_times(times: Sequence[float], span: float) -> list[str]:
    """Instants as text, to a hundred-thousandth of the run."""
    how = Style(max(0, 5 - math.ceil(math.log10(span))) if span > 0.0 else DIGITS)
    return [trim([how.write(t)])[0] for t in times]


def rough(value: float) -> str:
    """An error to one digit: `3e-11`, `0`."""
    return f"{value:.0e}".replace("e-0", "e-").replace("e+0", "e") if value else "0"


def _relative(error: float | None) -> float:
    return max(error, tolerances.WRITTEN) if error is not None and math.isfinite(error) else tolerances.WRITTEN


def _reach(results: Results) -> float:
    """Half the extent of the joints' points over the run [m]."""
    points = [joint["point"].reshape(-1, 3) for joint in results.joints.values() if "point" in joint]
    if not points:
        return 0.0
    cloud = np.concatenate(points)
    return 0.5 * float(np.linalg.norm(np.nanmax(cloud, axis=0) - np.nanmin(cloud, axis=0)))
