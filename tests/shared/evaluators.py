"""The evaluator of expressions, compiled and as plain Python, and what either answers to the last bit."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from typing import Any

from heuncli.kernel.choose import expressions, jets
from heuncli.scene.expressions.programs import Pack
from tests.shared.plain_kernel import plain_module

Form = tuple[Any, Any]  # evaluator and derivatives
COMPILED: Form = expressions, jets
PLAIN: Form = plain_module("expressions"), plain_module("jets")  # as plain Python files, whatever runs otherwise


def answers(form: Form, pack: Pack, count: int, x: Sequence[float]) -> list[str]:
    """Value, and value with derivatives in time alone, of the pack's first program, to the last bit."""
    evaluator, derived = form
    programs = evaluator.Expressions(pack.code, pack.constants, len(pack.variables), 0, pack.starts, pack.tables)
    return bits([programs.evaluate(0, count, x), *derived.find_derivatives(programs, 0, count, x[0])])


def bits(numbers: Iterable[float]) -> list[str]:
    """Numbers to the last bit; one NaN is like another."""
    return [float(x).hex() if x == x else "nan" for x in numbers]
