"""One number of a run, with its unit, its error, its instant and its position."""

from __future__ import annotations

import math

from heuncli.output.documents.document import append_unit
from heuncli.output.tables import measure
from heuncli.study.queries.measure_uncertainty import find_unit, measure_uncertainty
from heuncli.study.queries.study import Study

COMMAND = "measure"


class Number(float):
    """A number of a run: a float with its unit, error, instant and position.

    unit: SI
    error: the stated absolute error, nan if the run states none
    at: its instant [s], or None
    s: position along a series of cuts [m]; side, cut: the side of a load there, and the number of the cut
    horizon: the instant [s] from which on nothing is claimed, if that makes the number nan
    is_open: whether it is nan because the laws of rigid bodies do not determine it
    """

    unit: str = ""
    error: float = math.nan
    at: float | None = None
    s: float | None = None
    side: str | None = None
    cut: int | None = None
    horizon: float | None = None
    is_open: bool = False

    def __repr__(self) -> str:
        words = append_unit(str(self), self.unit)
        words += f" at t = {self.at:.6g} s" if self.at is not None else ""
        words += f", s = {self.s:.6g} m" if self.s is not None else ""
        words += f" (error {self.error:.2g})" if math.isfinite(self.error) else ""
        words += f" (not reliable from t = {self.horizon:.4g} s on)" if self.horizon is not None else ""
        return words + (" (open)" if self.is_open else "")

    def __str__(self) -> str:
        return float.__repr__(self)


def compute_number(study: Study, words: str) -> Number:
    """Compute the number that the words of a measure describe. Raises UsageError, SpecError [unknown-path]."""
    request = measure.parse_measure(words, COMMAND)
    measure.require_known_paths([request], study.spec, COMMAND)
    peak, horizon = measure.measure_number(request, study, COMMAND)
    block = measure.describe_measure(request, study, peak, horizon)
    number = Number(math.nan if block["value"] is None else block["value"])
    number.unit, number.at, number.horizon = find_unit(request.path, study.spec), block["at"], block.get("horizon")
    number.s, number.side, number.cut = block.get("s"), block.get("side"), block.get("cut")
    stated = measure_uncertainty(study, request.path, request.how, peak.value)
    number.error = math.nan if stated is None else float(stated)
    number.is_open = math.isnan(number) and number.horizon is None and number.at not in study.unknown
    return number
