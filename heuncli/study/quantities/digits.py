"""Decide how many digits a number is shown with: no more than its error supports, and never more than six.

The error of a run is known by kind (`accuracy.estimate`): of the motion relative to the size of the scene, of each kind
of loads relative to its own largest. To this comes the rounding of the terms that a number is summed from
(`Magnitudes`): the force on the ground may be 1e-12 N where 30 N cancel.

Numbers of one family (the components of one vector) share their decimals. A number below the last decimal is `0`: it is
known to be negligible beside the others. A family whose largest number is rounding is `0`, too. A family whose largest
number does not exceed its error is `?`: not even its sign is known.

So do the tables of `heun run`. Summaries, reports, pictures and pages show what a reader compares, 24.39 kN: four
significant digits of a family's largest, a unit by size, an error only where it shows.
"""

from __future__ import annotations

import math
from collections.abc import Iterable, Mapping, Sequence
from itertools import chain
from typing import Literal

import numpy as np

from heuncli.base import tolerances
from heuncli.base.named_tuples import NamedTuple
from heuncli.results.path_words import BY_CAUSE
from heuncli.results.results import Array, Magnitudes, Results
from heuncli.results.results_schema import ESTIMATE_OF_ERROR_KIND
from heuncli.study.quantities.channels import Channel, iter_channels, iter_impulse_channels
from heuncli.study.quantities.labels import DEFAULT_UNITS, Labels
from heuncli.study.quantities.table_units import PREFIXES, Units, choose_prefix

DIGITS = 6
LARGE, SMALL = 1e7, 1e-4  # families beyond these are written with an exponent
OPEN = "open"
OPEN_NOTE = "open: statically indeterminate, depends on stiffness"
ZERO_NOTE = "Rows that are zero at all times are not shown."
ZERO_COLUMNS_NOTE = "Columns that are zero in every row are not shown."
UNKNOWN = "?"
UNKNOWN_NOTE = "?: the estimated error is as large as the number, as past the horizon or near a singular position"
LOADS: tuple[Literal["reactions", "drives", "foundation", "sections"], ...] = (
    "reactions", "drives", "foundation", "sections",
)  # fmt: skip
Scales = Mapping[tuple[str, str], float]  # by kind and unit


class Style(NamedTuple):
    """How the numbers of one family are written: with fixed decimals, or an exponent where they are far from 1.

    rounding: magnitudes up to it are shown as 0
    is_known: whether any digit of the family's largest number is certain
    """

    decimals: int
    has_exponent: bool = False
    rounding: float = 0.0
    is_known: bool = True

    def write(self, value: float) -> str:
        """Format the number: `open` for nan, `0` below the certain digits, `?` for an unknown number."""
        if math.isnan(value):
            return OPEN
        if math.isinf(value):
            return "unbounded"
        if abs(value) <= self.rounding:
            return "0"
        if not self.is_known:
            return UNKNOWN
        if abs(value) < 0.5 * 10.0**-self.decimals:
            return "0"
        if self.has_exponent:
            mantissa = min(max(self.decimals + math.floor(math.log10(abs(value))), 0), DIGITS - 1)
            return f"{value:.{mantissa}e}"
        return f"{value:.{max(self.decimals, 0)}f}"


class StatedErrors(NamedTuple):
    """The absolute errors of numbers by kind and unit, and their rounding by unit, SI; 0 where none is known.

    singular_times: instants close to singular poses, at which nan means unknown
    units: in which numbers are printed
    """

    errors: Mapping[tuple[str, str], float]
    rounding: Mapping[str, float]
    singular_times: frozenset[float] = frozenset()
    units: Units = DEFAULT_UNITS

    def error_of(self, kind: str, unit: str) -> float:
        """Return the estimated error of numbers of this kind and unit, at least their rounding."""
        return max(self.errors.get((kind, unit), 0.0), self.rounding_of(unit))

    def rounding_of(self, unit: str) -> float:
        """Return the rounding error of numbers of this unit."""
        return self.rounding.get(unit, 0.0)

    def find_error(self, channel: Channel) -> float:
        """Return the estimated error of a channel's numbers, SI."""
        return self.error_of(channel.error_kind, channel.unit)

    def choose_style(self, kind: str, unit: str, scale: float) -> Style:
        """Choose the style, in the display unit, of a family of this kind and unit whose largest magnitude is `scale`;
        SI.
        """
        per_si = self.units.find(unit)[1]
        return choose_style(per_si * scale, per_si * self.error_of(kind, unit), per_si * self.rounding_of(unit))


def find_stated_errors(results: Results, labels: Labels, magnitudes: Magnitudes) -> StatedErrors:
    """Return the errors of a run: those that its check run found, otherwise its estimates times the largest of each
    kind.
    """
    scales = find_scales(results, labels)
    errors = {
        key: results.relative_error(ESTIMATE_OF_ERROR_KIND.get(key[0], key[0])) * scale for key, scale in scales.items()
    }
    for kind in (*LOADS, "sensors", "bearings"):
        relative = results.relative_error(ESTIMATE_OF_ERROR_KIND.get(kind, kind))
        for error_kind in (kind, f"{kind} {BY_CAUSE}"):
            errors |= _find_wrench_errors(error_kind, relative, scales, magnitudes.size)
    errors |= magnitudes.errors
    errors |= results.position_errors(magnitudes.size)
    for unit in ("m", "m/s", "m/s²", "rad/s²"):  # where no path has its own measure of travel
        if ("travels", unit) not in magnitudes.errors and ("motion", unit) in errors:
            errors["travels", unit] = errors["motion", unit]
    rounding = magnitudes.rounding_errors()
    load = max(scales.get(("sections", "N"), 0.0), scales.get(("sections", "N·m"), 0.0) / magnitudes.size)
    if load > 0.0:  # stresses are proportional to the section loads
        stress = scales.get(("sections", "Pa"), 0.0) / load
        error = max(errors["sections", "N"], errors["sections", "N·m"] / magnitudes.size)
        errors["sections", "Pa"] = stress * error
        errors["sections", "1"] = scales.get(("sections", "1"), 0.0) / load * error
        rounding["Pa"] = stress * rounding["N"]
        for unit in ("m", "rad"):
            errors["deflections", unit] = scales.get(("deflections", unit), 0.0) / load * error
        errors["deflections", "1"] = find_buckling_error(results, errors["sections", "N"])
    horizon = results.horizon
    if horizon is not None and results.time[0] >= horizon:
        errors = dict.fromkeys(errors, math.inf)
    return StatedErrors(errors, rounding, units=labels.units)


def find_buckling_error(results: Results, force_error: float) -> float:
    """Return the error of the safety against buckling: relative to it, that of the compression [N]."""
    largest = 0.0
    for section in results.sections.values():
        for safety, N in zip(section.get("buckling", ()), section["N"], strict=False):
            if safety < tolerances.GREATEST_SAFETY:  # then some N is below 0, but perhaps between the cuts
                compression = -float(np.min(N))
                largest = max(largest, float(safety) * force_error / compression if compression > 0.0 else math.inf)
    return largest


def find_scales(results: Results, labels: Labels, only_kind: str | None = None) -> dict[tuple[str, str], float]:
    """Return the largest magnitudes of a run by kind and unit, including its impulses; only_kind: restricts it to one
    kind.
    """
    scales: dict[tuple[str, str], float] = {}
    of_impulses = (channel for impulse in results.impulses for channel in iter_impulse_channels(impulse, labels))
    for channel in chain(iter_channels(results, labels), of_impulses):
        key = (channel.error_kind, channel.unit)
        if only_kind is None or key[0] == only_kind:
            scales[key] = max(scales.get(key, 0.0), largest_magnitude(channel.values))
    return scales


def is_load(kind: str, unit: str) -> bool:
    """Return whether numbers are forces or moments of a kind that has one common error."""
    return kind in LOADS and unit in ("N", "N·m")


def find_load_error(results: Results, labels: Labels, magnitudes: Magnitudes, kind: str, unit: str) -> float:
    """Return the error of one kind of loads, as `find_stated_errors` gives it without a horizon."""
    estimates = _find_wrench_errors(
        kind, results.relative_error(kind), find_scales(results, labels, kind), magnitudes.size
    )
    errors = {**estimates, **magnitudes.errors}
    return max(errors[kind, unit], magnitudes.rounding_errors().get(unit, 0.0))


def _find_wrench_errors(kind: str, relative: float, scales: Scales, size: float) -> dict[tuple[str, str], float]:
    """Find the errors of forces and moments of one kind of loads.

    A force counts as a moment with the scene's size as lever.
    """
    errors: dict[tuple[str, str], float] = {}
    for force, moment in (("N", "N·m"), ("N·s", "N·m·s")):
        largest_force = max(scales.get((kind, force), 0.0), scales.get((kind, moment), 0.0) / size)
        errors |= {(kind, force): relative * largest_force, (kind, moment): relative * largest_force * size}
    return errors


def add_axis_errors(
    stated_errors: StatedErrors, results: Results, magnitudes: Magnitudes, unit: str = "N"
) -> StatedErrors:
    """Add the errors of the central axis at the shown instants: it is no more accurate than its force.

    direction s/|s|, point s × M / s², pitch s·M / s²: an error of M is one of s on a lever. unit: N·s of impulses.
    """
    if "axis" not in results.foundation:
        return stated_errors
    axis = results.foundation["axis"]
    force = np.sqrt(np.sum(results.foundation["force"] ** 2, axis=1))[np.isfinite(axis["pitch"])]
    relative = stated_errors.error_of("foundation", unit) / float(force.min()) if force.size else 0.0
    lever = magnitudes.size + largest_magnitude(axis["point"]) + largest_magnitude(axis["pitch"])
    bounds = {("axis", "1"): relative, ("axis", "m"): relative * lever}
    axis_errors = {key: max(bound, stated_errors.errors.get(key, 0.0)) for key, bound in bounds.items()}
    return stated_errors._replace(errors={**stated_errors.errors, **axis_errors})


def largest_magnitude(values: Array) -> float:
    """Return the largest finite magnitude, 0 where there is none."""
    maximum = float(np.abs(values).max(initial=0.0))
    if math.isfinite(maximum):
        return maximum
    finite = np.abs(values[np.isfinite(values)])
    return float(finite.max()) if finite.size else 0.0


def choose_style(scale: float, error: float, rounding: float = 0.0) -> Style:
    """Choose the style of a family whose largest magnitude is `scale` and whose numbers are certain to `error`."""
    if scale <= rounding or scale == 0.0:
        return Style(0, rounding=scale)
    if not error < scale:
        return Style(0, rounding=rounding, is_known=False)
    decimals = DIGITS - 1 - math.floor(math.log10(scale))
    if scale < LARGE:
        decimals = max(decimals, 0)  # forces of a few million newtons are written without an exponent
    if error > 0.0:
        decimals = min(decimals, math.floor(-math.log10(error)))
    is_known = scale >= 0.5 * 10.0**-decimals
    return Style(decimals, not SMALL <= scale < LARGE or decimals < 0, rounding, is_known)


def write_numbers(values: Iterable[float], style: Style) -> list[str]:
    """Format the numbers of one family, without the trailing zeros that they have in common."""
    return trim_zeros([style.write(value) for value in values])


def trim_zeros(texts: Sequence[str]) -> list[str]:
    """Remove the trailing zeros that the texts have in common; one decimal stays."""
    spare = [len(text) - len(text.rstrip("0")) for text in texts if "." in text and "e" not in text]
    whole = [len(text.partition(".")[2]) for text in texts if "." in text and "e" not in text]
    cut = min((min(zeros, decimals - 1) for zeros, decimals in zip(spare, whole, strict=True)), default=0)
    return [text[: len(text) - cut] if cut and "." in text and "e" not in text else text for text in texts]


def format_unclaimed(value: float, unit: str, stated_errors: StatedErrors, text: str) -> str:
    """Format a number after the horizon: `?`, unless it is indeterminate or only rounding."""
    if text == OPEN:
        return OPEN
    return "0" if abs(value) <= stated_errors.rounding_of(unit) else UNKNOWN


def write_times(times: Sequence[float], span: float) -> list[str]:
    """Format instants, to a hundred-thousandth of the run."""
    style = Style(max(0, 5 - math.ceil(math.log10(span))) if span > 0.0 else DIGITS)
    return [trim_zeros([style.write(t)])[0] for t in times]


def format_error(value: float) -> str:
    """Format an error to one digit: `3e-11`, `0`."""
    return f"{value:.0e}".replace("e-0", "e-").replace("e+0", "e") if value else "0"


MAX_DIGITS = 10  # digits
LARGE_ALONE, SMALL_ALONE = 1e10, 1e-4  # beyond these with an exponent


def format_with_error(value: float, error: float) -> str:
    """Format a number so that its last digit is that of the error's first; without an error with up to MAX_DIGITS
    digits.
    """
    if not math.isfinite(value):
        return "unbounded"
    if value == 0.0:
        return "0"
    if error <= 0.0:
        return f"{value:.{MAX_DIGITS}g}"
    lead = math.floor(math.log10(abs(value)))
    last = min(max(math.floor(math.log10(error)), lead - MAX_DIGITS + 1), lead)
    if not SMALL_ALONE <= abs(value) < LARGE_ALONE or last > 0:
        return f"{value:.{lead - last}e}"
    return f"{value:.{-last}f}"


READER_DIGITS = 4


class ReaderStyle(NamedTuple):
    """How the numbers of one family are written for a reader.

    unit: display unit; per_si: how many of it make one SI unit
    decimals: of fixed numbers
    error: of the numbers, in the display unit
    """

    unit: str
    per_si: float
    decimals: int
    error: float = 0.0

    def write(self, value: float) -> str:
        """Format an SI number in the display unit, with U+2212 as minus; 0 below the last decimal."""
        shown = self.per_si * value
        if math.isnan(shown):
            return OPEN
        if abs(shown) < 0.5 * 10.0**-self.decimals:
            return "0"
        if self.error >= abs(shown):
            return UNKNOWN
        return f"{shown:.{max(self.decimals, 0)}f}".replace("-", "−")

    def write_with_error(self, value: float) -> str:
        """Format an SI number, and its error where this reaches the last decimal."""
        text = self.write(value)
        if self.error < 0.5 * 10.0**-self.decimals or text in (OPEN, UNKNOWN, "0"):
            return text
        return f"{text} ± {self.error:.{max(self.decimals, 0)}f}"


def choose_reader_style(unit: str, scale: float, units: Units, error: float = 0.0) -> ReaderStyle:
    """Choose how a family of numbers is written.

    unit: SI unit; scale: the largest magnitude, SI; error: of the numbers, SI
    units: a unit that the user chose stays; another is chosen by size
    """
    shown_unit, per_si = units.find(unit)
    if unit in PREFIXES and not units.is_chosen(unit):
        shown_unit, per_si = choose_prefix(unit, scale)
    shown = per_si * scale
    digits = READER_DIGITS - 1 - math.floor(math.log10(shown)) if math.isfinite(shown) and shown > 0.0 else 0
    return ReaderStyle(shown_unit, per_si, max(digits, 0), per_si * error)
