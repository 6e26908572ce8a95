"""The range of magnitudes that heun accepts; the reason for its bounds is given at them in tolerances.py."""

from __future__ import annotations

from typing import TYPE_CHECKING

from heuncli.base import tolerances
from heuncli.base.errors import Finding

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray

    Array = NDArray[np.float64]
    Mask = NDArray[np.bool_]

ACCEPTED = f"0, or {tolerances.LEAST_MAGNITUDE:.0e} to {tolerances.MOST_MAGNITUDE:.0e} in SI units".replace("+", "")
TOO_SMALL = "check its unit; for zero write 0"
TOO_LARGE = "check its unit; for no limit leave the entry out"


def is_in_range(value: float) -> bool:
    """Whether a number is 0, or of a magnitude that is computed with; nan and inf are not."""
    return value == 0.0 or tolerances.LEAST_MAGNITUDE <= abs(value) <= tolerances.MOST_MAGNITUDE


def are_in_range(values: Array) -> Mask:
    """Return where `is_in_range` holds, as an array of the same shape."""
    sizes = abs(values)
    fits: Mask = (values == 0.0) | ((sizes >= tolerances.LEAST_MAGNITUDE) & (sizes <= tolerances.MOST_MAGNITUDE))
    return fits


def range_error(value: float, what: str = "") -> Finding:
    """Return the error for a number out of range; what: the name of a computed number that is not written in the
    spec.
    """
    is_small = abs(value) < 1.0
    subject = f"{what} is {value:g}, " if what else f"{value:g} is "
    message = f"{subject}too {'small' if is_small else 'large'} for the computation; accepted: {ACCEPTED}"
    return Finding("magnitude", message, TOO_SMALL if is_small else TOO_LARGE)
