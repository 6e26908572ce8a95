"""One number of a run, which knows its unit, its error, and when and where it is."""

from __future__ import annotations

import math

from heuncli.output.snapshots import measure
from heuncli.study.ask.study import Study
from heuncli.study.quantities.stated import error_of, unit_of

ASKED_BY = "measure"


class Number(float):
    """A number of a run: a float, and beside it its unit, error, instant and place.

    unit: SI; error: stated, absolute, nan where the run states none; at: its instant [s], None where it has none;
    s [m], side and cut: where along a run of cuts. horizon: set where the number is not claimed, and so nan; is_open:
    where it is nan since the laws of rigid bodies do not give it.
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
        words = f"{self} {self.unit}" if self.unit not in ("", "1") else str(self)
        words += f" at t = {self.at:.6g} s" if self.at is not None else ""
        words += f", s = {self.s:.6g} m" if self.s is not None else ""
        words += f" (error {self.error:.2g})" if math.isfinite(self.error) else ""
        words += f" (not claimed from t = {self.horizon:.4g} s on)" if self.horizon is not None else ""
        return words + (" (open)" if self.is_open else "")

    def __str__(self) -> str:
        return float.__repr__(self)


def measured(study: Study, words: str) -> Number:
    """The number that the words of a measure mean. Raises UsageError, SpecError [unknown-path]."""
    asked = measure.parse(words, ASKED_BY)
    measure.check([asked], study.spec, ASKED_BY)
    peak, horizon = measure.measured(asked, study, ASKED_BY)
    block = measure.described(asked, study, peak, horizon)
    found = Number(math.nan if block["value"] is None else block["value"])
    found.unit, found.at, found.horizon = unit_of(asked.path, study.spec), block["at"], block.get("horizon")
    found.s, found.side, found.cut = block.get("s"), block.get("side"), block.get("cut")
    stated = error_of(asked, peak, study)
    found.error = math.nan if stated is None else float(stated)
    found.is_open = math.isnan(found) and found.horizon is None and found.at not in study.unknown
    return found
