"""An integration method as data: rows of (stage, coefficient) without zeros, and the arrays that the kernel takes.

Methods are loaded by name, the coefficients of each on demand; their rows are in heuncli/base/method_rows.py, where the
spec reads them, too. For a motion that its drives determine nothing is integrated (kernel/following.py); the
interpolation of that method has two rows more than the cubic's.
"""

from __future__ import annotations

from array import array
from collections.abc import Mapping
from functools import cached_property
from importlib import import_module
from typing import Any

from heuncli.base.method_rows import AUTO, DEFAULT, find_method
from heuncli.base.records import record

# Method

Row = tuple[tuple[int, float], ...]
QUATERNION, GLOBAL, RECENTRED = range(3)  # how attitudes are held within a step (kernel/stepping.py)


@record
class Method:
    """A Runge-Kutta method with dense output, or a substitute for one; a step goes from y by h, with x = 0 ... 1.

    stages, solution, extra, estimates and dense are rows of its tableau. Of two estimates the first is the coarser one,
    and the error is h e5^2 / sqrt(e5^2 + 0.01 e3^2).

    Dense output is a polynomial in nested form, y + x (F0 + (1 - x) (F1 + x (F2 + (1 - x) (F3 + ...)))). F0, F1, F2 are
    those of the cubic through both ends, which every method has; the rows give the others.
    """

    name: str
    order: int
    nodes: tuple[float, ...]  # of all stages, the first 0
    stages: tuple[Row, ...]  # of stages 1, 2, ...: coefficients of the stages before
    solution: Row
    extra: tuple[Row, ...] = ()  # further stages, for the dense output
    estimates: tuple[Row, ...] = ()  # of the error: one, or two
    error_order: int = 1  # of the estimate in h
    # rows of F3, F4, ...; those of an implicit method apply to stages 1, 2, ... minus the start, then to F0, F1,
    # F2
    dense: tuple[Row, ...] = ()
    is_determined: bool = False  # nothing is integrated: every instant follows from the drives
    has_fixed_step: bool = False  # the step is given, and no error is tested
    by_step: bool = False  # no dense output: an instant within a step is reached by an extra step from its start
    implicit: bool = False  # the stages are solved for (kernel/collocation.py), by the numbers in `collocation`
    attitude: int = QUATERNION  # how attitudes are held within a step
    scipy_name: str = ""  # its name in SciPy, where its steps are taken (motion/integration/run/scipy_loop.py)
    # stability limit: the largest h |lambda| with |R(-h |lambda|)| = 1 for decay exp(lambda t); 0: not watched
    stable: float = 0.0
    # where in a step its interpolation errs most, on open and closed chains (tests/convergence/test_between_ends.py)
    sample_fractions: tuple[float, ...] = (0.5, 0.85)
    collocation: Mapping[str, Any] | None = None
    check: Method | None = None  # the method of its check run, where that is another one

    @cached_property
    def arrays(self) -> dict[str, Any]:
        """The method's arrays for the kernel (kernel/stepping.py)."""
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
            "determined": int(self.is_determined),
            "fixed": int(self.has_fixed_step),
            "by_step": int(self.by_step),
            "implicit": int(self.implicit),
            "attitude": self.attitude,
            "begin": array("i", begin),
            "stage": array("i", [stage for row in rows for stage, _ in row]),
            "coefficient": array("d", [c for row in rows for _, c in row]),
            "node": array("d", self.nodes),
            "collocation": self.collocation,
        }


# Registry


def load_method_by_name(name: str) -> Method:
    """Return the method of that name, in either case; for `auto`, the default method. Raises KeyError for any other
    name.
    """
    row = find_method(DEFAULT if name.lower() == AUTO else name)
    if row is None:
        raise KeyError(name)
    module, _, attribute = row.coefficients.partition(".")
    method: Method = getattr(import_module(f"heuncli.motion.integration.methods.{module}"), attribute)
    return method


# Drive determined

DRIVE_DETERMINED = Method(
    name="none: each instant is solved separately",
    order=1,
    nodes=(0.0,),
    stages=(),
    solution=((0, 1.0),),
    extra=(),
    estimates=(((0, 1.0),),),
    error_order=1,
    dense=((), ()),
    is_determined=True,
)
