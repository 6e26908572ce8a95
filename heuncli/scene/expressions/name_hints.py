"""Names that an expression cannot use, and what is proposed instead: of other programs, and of results."""

from __future__ import annotations

from heuncli.results.results_schema import ROWS, SHARED_BLOCKS

OTHER_NAMES = {  # names from other programs, and heun's
    "arcsin": "asin", "arccos": "acos", "arctan": "atan", "arctan2": "atan2", "ln": "log", "fabs": "abs", "sgn": "sign",
    "heaviside": "step", "time": "t", "PI": "pi", "Pi": "pi", "π": "pi", "degrees": "deg", "pow": "**", "sqr": "**2",
    "interp": "table(NAME, ...)", "lookup": "table(NAME, ...)", "spline": "table(NAME, ...)",
}  # fmt: skip
RESULT_BLOCKS = SHARED_BLOCKS | {"stops", "couplings"}  # blocks of the results that follow from the motion
REACTIONS = frozenset(
    row.path.split(".")[2]
    for row in ROWS
    if row.path.startswith(("joints.JOINT.", "stops.STOP.")) and set(row.units) & {"N", "N·m"}
) - {"shares"}
LAW_HINT = (
    "a law may use t, parameters and coordinates such as shaft.angle, shaft.rate, guide.travel, guide.speed; "
    "a condition may use {of: joints.NAME.force.z, below: 0}"
)
