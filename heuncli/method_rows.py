"""The methods of integration, one row each: everything else reads the rows.

`auto` is no method but a choice among them. Lies below the spec, and so needs no NumPy; the coefficients stand in
heuncli/integration/methods, a family to a file.
"""

from __future__ import annotations

from typing import Literal, NamedTuple


class MethodRow(NamedTuple):
    """A method: its name and order, how it goes, how it holds attitudes within a step, and what it is for.

    coefficients: the module in heuncli/integration/methods, and the name in it.
    """

    name: str
    order: int
    kind: Literal["explicit", "implicit", "SciPy"]
    steps: Literal["fixed", "adaptive"]
    attitude: Literal["quaternion", "rodrigues", "recentred"]
    purpose: str
    coefficients: str


AUTO, DEFAULT = "auto", "DOP853"
METHODS = (
    MethodRow(
        "DOP853", 8, "explicit", "adaptive", "quaternion",
        "the default: smooth motions to six digits and more", "dop853.DOP853",
    ),
    MethodRow(
        "DOP853-rodrigues", 8, "explicit", "adaptive", "rodrigues",
        "Heun's no. 20: attitudes from the drawn one; ends at half turns", "charted.GLOBAL",
    ),
    MethodRow(
        "DOP853-recentred", 8, "explicit", "adaptive", "recentred",
        "attitudes from each step's start: as good as quaternions", "charted.ANEW",
    ),
)  # fmt: skip
BY_NAME = {row.name.lower(): row for row in METHODS}
NAMES = (AUTO, *(row.name for row in METHODS))


def row_of(name: str) -> MethodRow | None:
    """The row of a method, its name in whatever case; None of any other word, and of `auto`."""
    return BY_NAME.get(name.lower())
