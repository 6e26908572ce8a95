"""What a part of the table of thresholds is: scenes on either side of each threshold of one concept."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from types import MappingProxyType
from typing import NamedTuple

FACTORS = (0.01, 1 / 3, 3.0, 100.0)
NONE: Mapping[str, str] = MappingProxyType({})


class Row(NamedTuple):
    """A threshold by name (KERNEL.x: of the kernel), its boundary as a scene, and the verdicts on either side.

    `seen(x)` answers with the verdict where the judged quantity is x, in the threshold's own measure, by the smallest
    scene, or the smallest call, that reaches it; what it answers with numbers it holds against their closed form, so
    that both sides are honest: a refusal, a warning, or a right number.
    factors: of the threshold, where the verdict is looked at.
    """

    name: str
    seen: Callable[[float], str]
    below: str
    above: str
    factors: tuple[float, ...] = FACTORS


class Part(NamedTuple):
    """The thresholds under some headings of heuncli/base/tolerances.py ("kernel: " before those of the kernel's table).

    exempt: thresholds that decide no verdict, and why: on either side the same numbers, to their digits.
    wanted: thresholds that decide the verdict that is named here, and have no scene at their boundary yet.
    """

    headings: tuple[str, ...]
    rows: tuple[Row, ...] = ()
    exempt: Mapping[str, str] = NONE
    wanted: Mapping[str, str] = NONE
