"""How many digits a number is shown with: no more than its error supports, and never more than six.

The error of a run is known by kind (`accuracy.estimate`): that of the motion relative to the size of the scene, that of
each kind of loads relative to its own largest. Beside it stands the rounding of what a number is summed from
(`Magnitudes`): the force on the ground may be 1e-12 N where 30 N cancel.

Numbers of one family (the components of one vector) share their decimals. What is below the last of them is `0`: it is
known to be nothing beside the others. A family whose largest number is rounding is `0`, too. A family whose largest
number is not above the error is `?`: nothing is known of it, not even its sign.
"""

from __future__ import annotations

import math
from collections.abc import Iterable, Mapping, Sequence
from itertools import chain
from typing import Literal

import numpy as np

from heuncli.base.named_tuples import NamedTuple
from heuncli.results.results import Array, Magnitudes, Results
from heuncli.results.results_schema import BY_CAUSE, KIND_OF, SHARES, kind_of_error
from heuncli.study.quantities.labels import Labels
from heuncli.study.quantities.series import Series, walk, walk_impulse
from heuncli.study.quantities.table_units import Units

DIGITS = 6
LARGE, SMALL = 1e7, 1e-4  # families beyond these are written with an exponent
OPEN = "open"
OPEN_NOTE = "open: the laws of rigid bodies do not give this number (redundant supports)"
ZERO_NOTE = "what is 0 throughout is left out"
UNKNOWN = "?"
UNKNOWN_NOTE = "?: the estimated error is as large as the number, as beyond the horizon or beside a singular pose"
LOADS: tuple[Literal["reactions", "drives", "foundation", "sections"], ...] = (
    "reactions", "drives", "foundation", "sections",
)  # fmt: skip
Scales = Mapping[tuple[str, str], float]  # by kind and unit


class Style(NamedTuple):
    """How the numbers of one family are written: fixed decimals, or an exponent where the family is far from 1.

    rounding: what is not above it is 0; known: whether any digit of the family's largest number is certain.
    """

    decimals: int
    exponent: bool = False
    rounding: float = 0.0
    known: bool = True

    def write(self, value: float) -> str:
        """The number as text: `open` for nan, `0` for what is below the certain digits, `?` for what is not known."""
        if math.isnan(value):
            return OPEN
        if math.isinf(value):
            return "unbounded"
        if abs(value) <= self.rounding:
            return "0"
        if not self.known:
            return UNKNOWN
        if abs(value) < 0.5 * 10.0**-self.decimals:
            return "0"
        if self.exponent:
            mantissa = min(max(self.decimals + math.floor(math.log10(abs(value))), 0), DIGITS - 1)
            return f"{value:.{mantissa}e}"
        return f"{value:.{max(self.decimals, 0)}f}"


class Certainty(NamedTuple):
    """The absolute errors of numbers by kind and unit, and their rounding by unit; 0 where none is known.

    beside: instants beside singular poses, at which what is nan is not known.
    """

    errors: Mapping[tuple[str, str], float]
    rounding: Mapping[str, float]
    beside: frozenset[float] = frozenset()

    def error(self, kind: str, unit: str) -> float:
        """The estimated error of numbers of this kind and unit, not below their rounding."""
        return max(self.errors.get((kind, unit), 0.0), self.lost(unit))

    def lost(self, unit: str) -> float:
        """What numbers of this unit lose by rounding."""
        return self.rounding.get(unit, 0.0)

    def style(self, kind: str, unit: str, scale: float) -> Style:
        """The style of a family of this kind and unit whose largest magnitude is `scale`."""
        return style(scale, self.error(kind, unit), self.lost(unit))


def certainty(results: Results, labels: Labels, of: Magnitudes) -> Certainty:
    """The errors of a run: as its check run found them, else from its estimates and the largest of each kind."""
    scales = scales_of(results, labels)
    errors = {key: results.relative_error(KIND_OF.get(key[0], key[0])) * scale for key, scale in scales.items()}
    for kind in LOADS:
        for own in (kind, f"{kind} {BY_CAUSE}"):
            errors |= _of_wrench(own, results.relative_error(kind), scales, of.size)
    errors |= of.errors
    errors |= results.errors_of_places(of.size)
    for unit in ("m", "m/s", "m/s²", "rad/s²"):  # where no path counts them in its own measure
        if ("travels", unit) not in of.errors and ("motion", unit) in errors:
            errors["travels", unit] = errors["motion", unit]
    lost = of.lost()
    load = max(scales.get(("sections", "N"), 0.0), scales.get(("sections", "N·m"), 0.0) / of.size)
    if load > 0.0:  # stresses are in proportion to what makes them
        stress = scales.get(("sections", "Pa"), 0.0) / load
        error = max(errors["sections", "N"], errors["sections", "N·m"] / of.size)
        errors["sections", "Pa"] = stress * error
        errors["sections", "1"] = scales.get(("sections", "1"), 0.0) / load * error
        lost["Pa"] = stress * lost["N"]
    horizon = results.horizon
    if horizon is not None and results.time[0] >= horizon:
        errors = dict.fromkeys(errors, math.inf)
    return with_units(Certainty(errors, lost), labels.units)


def scales_of(results: Results, labels: Labels, only: str | None = None) -> dict[tuple[str, str], float]:
    """The largest magnitudes of a run by kind and unit, of its blows, too; only: of one kind."""
    scales: dict[tuple[str, str], float] = {}
    struck = (series for impulse in results.impulses for series in walk_impulse(impulse, labels))
    for series in chain(walk(results, labels), struck):
        key = (kind_of(series), series.unit)
        if only is None or key[0] == only:
            scales[key] = max(scales.get(key, 0.0), largest(series.values))
    return scales


def is_of_load(kind: str, unit: str) -> bool:
    """Whether numbers are forces or moments of a kind whose error is one of the whole kind."""
    return kind in LOADS and unit in ("N", "N·m")


def error_of_load(results: Results, labels: Labels, of: Magnitudes, kind: str, unit: str) -> float:
    """The error of one kind of loads, as `certainty` has it where there is no horizon."""
    own = _of_wrench(kind, results.relative_error(kind), scales_of(results, labels, kind), of.size)
    found = {**own, **of.errors}
    return max(found[kind, unit], of.lost().get(unit, 0.0))


def with_units(certain: Certainty, units: Units) -> Certainty:
    """Errors and rounding by the SI units of the results, and beside these by the units that tables show for them."""
    errors, lost = dict(certain.errors), dict(certain.rounding)
    for (kind, unit), error in certain.errors.items():
        shown, size = units.of(unit)
        errors[kind, shown] = size * error
    for unit, rounding in certain.rounding.items():
        shown, size = units.of(unit)
        lost[shown] = size * rounding
    return certain._replace(errors=errors, rounding=lost)


def kind_of(series: Series) -> str:
    """The kind of estimate (`accuracy.estimate`) that states the error of a series."""
    name = f"{series.name}.{SHARES}.{series.cause}" if series.cause else series.name
    return kind_of_error(series.kind, name, series.quantity)


def _of_wrench(kind: str, relative: float, scales: Scales, size: float) -> dict[tuple[str, str], float]:
    """Errors of one kind of loads; against a moment stands a force on the scene's size as lever."""
    errors: dict[tuple[str, str], float] = {}
    for force, moment in (("N", "N·m"), ("N·s", "N·m·s")):
        own = max(scales.get((kind, force), 0.0), scales.get((kind, moment), 0.0) / size)
        errors |= {(kind, force): relative * own, (kind, moment): relative * own * size}
    return errors


def with_axis(certain: Certainty, results: Results, of: Magnitudes, units: Units, unit: str = "N") -> Certainty:
    """The errors of a run with those of the central axis at the instants that are shown: no better than its force's.

    direction s/|s|, point s × M / s², pitch s·M / s²: an error of M is one of s on a lever. unit: N·s of impulses.
    """
    if "axis" not in results.foundation:
        return certain
    axis = results.foundation["axis"]
    force = np.sqrt(np.sum(results.foundation["force"] ** 2, axis=1))[np.isfinite(axis["pitch"])]
    relative = certain.error("foundation", unit) / float(force.min()) if force.size else 0.0
    lever = of.size + largest(axis["point"]) + largest(axis["pitch"])
    shown, size = units.of("m")
    bounds = {("axis", "1"): relative, ("axis", shown): relative * lever * size}
    own = {key: max(bound, certain.errors.get(key, 0.0)) for key, bound in bounds.items()}
    return certain._replace(errors={**certain.errors, **own})


def largest(values: Array) -> float:
    """The largest finite magnitude, 0 where there is none."""
    whole = float(np.abs(values).max(initial=0.0))
    if math.isfinite(whole):
        return whole
    finite = np.abs(values[np.isfinite(values)])
    return float(finite.max()) if finite.size else 0.0


def style(scale: float, error: float, rounding: float = 0.0) -> Style:
    """The style of a family whose largest magnitude is `scale` and whose numbers are certain to `error`."""
    if scale <= rounding or scale == 0.0:
        return Style(0, rounding=scale)
    if not error < scale:
        return Style(0, rounding=rounding, known=False)
    decimals = DIGITS - 1 - math.floor(math.log10(scale))
    if scale < LARGE:
        decimals = max(decimals, 0)  # forces of a few million newtons are written without an exponent
    if error > 0.0:
        decimals = min(decimals, math.floor(-math.log10(error)))
    known = scale >= 0.5 * 10.0**-decimals
    return Style(decimals, not SMALL <= scale < LARGE or decimals < 0, rounding, known)


def write(values: Iterable[float], how: Style) -> list[str]:
    """The numbers of one family as text, without the zeros that end all of them."""
    return trim([how.write(value) for value in values])


def trim(texts: Sequence[str]) -> list[str]:
    """The texts without the trailing zeros they have in common, one decimal kept."""
    spare = [len(text) - len(text.rstrip("0")) for text in texts if "." in text and "e" not in text]
    whole = [len(text.partition(".")[2]) for text in texts if "." in text and "e" not in text]
    cut = min((min(zeros, decimals - 1) for zeros, decimals in zip(spare, whole, strict=True)), default=0)
    return [text[: len(text) - cut] if cut and "." in text and "e" not in text else text for text in texts]


def beyond_horizon(value: float, unit: str, certain: Certainty, text: str) -> str:
    """What stands for a number beyond the horizon: `?`, unless it is open or nothing but rounding."""
    if text == OPEN:
        return OPEN
    return "0" if abs(value) <= certain.lost(unit) else UNKNOWN


def write_times(times: Sequence[float], span: float) -> list[str]:
    """Instants as text, to a hundred-thousandth of the run."""
    how = Style(max(0, 5 - math.ceil(math.log10(span))) if span > 0.0 else DIGITS)
    return [trim([how.write(t)])[0] for t in times]


def rough(value: float) -> str:
    """An error to one digit: `3e-11`, `0`."""
    return f"{value:.0e}".replace("e-0", "e-").replace("e+0", "e") if value else "0"
