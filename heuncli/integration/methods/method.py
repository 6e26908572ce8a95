"""A method of integration as data: rows of (stage, coefficient), zeros left out, and the arrays the kernel takes."""

from __future__ import annotations

from array import array
from collections.abc import Mapping
from functools import cached_property
from typing import Any

from heuncli.records import record

Row = tuple[tuple[int, float], ...]
QUATERNION, GLOBAL, RECENTRED = range(3)  # how attitudes are held within a step (kernel/stepping.py)


@record
class Method:
    """An explicit Runge-Kutta method with dense output, or what stands in for one.

    nodes: of all stages; stages: rows of the stages 1..; solution; extra: further stages for the dense output;
    estimates: the rows of the error, one, or two, of which the first is coarser (then h e5^2 / sqrt(e5^2 + 0.01 e3^2));
    error_order: of the estimate in h; dense: rows of the interpolating polynomial in nested form, beside the three that
    every method has: y + x (F0 + (1 - x) (F1 + x (F2 + (1 - x) (F3 + ...)))). determined: nothing is integrated.

    fixed: steps are given and none is judged. by_step: no dense output of its own: an asked instant within a step is
    reached by a step of the same method from the step's start. implicit: the stages are solved for
    (kernel/collocation.py), by the numbers in `collocation`; dense rows are then of what the stages are beyond the
    start, from 1 on, and of the three. attitude: how it is held within a step. foreign: its name in SciPy, where
    its steps are taken (integration/run/scipy_loop.py). stable: of an explicit method, how large
    h lambda may be of what decays exp(lambda t), lambda < 0, before the method lets it grow: |R(-x)| = 1. within: where
    in a step its interpolation errs most, measured on open and closed chains (tests/convergence/test_between_ends.py).
    check: the method of its check run, where that is another one.
    """

    name: str
    order: int
    nodes: tuple[float, ...]
    stages: tuple[Row, ...]
    solution: Row
    extra: tuple[Row, ...] = ()
    estimates: tuple[Row, ...] = ()
    error_order: int = 1
    dense: tuple[Row, ...] = ()
    determined: bool = False
    fixed: bool = False
    by_step: bool = False
    implicit: bool = False
    attitude: int = QUATERNION
    foreign: str = ""
    stable: float = 0.0
    within: tuple[float, ...] = (0.5, 0.85)
    collocation: Mapping[str, Any] | None = None
    check: Method | None = None

    @cached_property
    def arrays(self) -> dict[str, Any]:
        """The method as the kernel takes it (kernel/stepping.py)."""
        rows = [(), *self.stages, self.solution, *self.extra, *self.estimates, *self.dense]
        begin = [0]
        for row in rows:
            begin.append(begin[-1] + len(row))
        return {
            "stages": len(self.stages) + 1,
            "extra": len(self.extra),
            "dense_rows": len(self.dense),
            "estimates": len(self.estimates),
            "exponent": 1.0 / self.error_order,
            "determined": int(self.determined),
            "fixed": int(self.fixed),
            "by_step": int(self.by_step),
            "implicit": int(self.implicit),
            "attitude": self.attitude,
            "begin": array("i", begin),
            "stage": array("i", [stage for row in rows for stage, _ in row]),
            "coefficient": array("d", [c for row in rows for _, c in row]),
            "node": array("d", self.nodes),
            "collocation": self.collocation,
        }
