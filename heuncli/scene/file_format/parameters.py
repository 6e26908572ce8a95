"""Evaluate the parameters of a scene: numbers that may refer to each other in any order."""

from __future__ import annotations

from typing import Any

from heuncli.base.errors import Finding
from heuncli.base.records import record
from heuncli.scene.expressions.grammar import DimensionedParameter
from heuncli.scene.file_format.quantity import DependentError, Scope, read_function

MAX_LISTED_NAMES = 12  # names of a cycle that a message lists
CIRCLE_HINT = "give one of them as a number"


class _UnknownParameter(Exception):
    """A parameter that has to be evaluated first."""

    def __init__(self, name: str) -> None:
        super().__init__(name)
        self.name = name


class _Values(dict[str, float | None]):
    """Known values; looking up one that is given but not yet known raises _UnknownParameter."""

    def __init__(self, block: dict[str, Any]) -> None:
        super().__init__()
        self.block = block
        self.used_names: set[object] = set()

    def __contains__(self, name: object) -> bool:
        self.used_names.add(name)
        return name in self.block

    def __missing__(self, name: str) -> float | None:
        raise _UnknownParameter(name)


@record
class Parameters:
    """Evaluated parameters.

    values: in SI; None for wrong ones
    given_quantities: those with a dimension, as written
    findings: what is wrong
    uses: the names that each parameter looks up
    """

    values: dict[str, float | None]
    given_quantities: dict[str, DimensionedParameter]
    findings: list[tuple[str, Finding]]
    uses: dict[str, set[object]]


def evaluate_parameters(block: dict[str, Any], earlier: Parameters | None = None) -> Parameters:
    """Evaluate the parameters of a block.

    earlier: results of an earlier evaluation that remain valid
    """
    values = _Values(block)
    given_quantities: dict[str, DimensionedParameter] = {}
    uses: dict[str, set[object]] = {name: set() for name in block}
    if earlier is not None:
        values.update(earlier.values)
        given_quantities.update(earlier.given_quantities)
        uses.update(earlier.uses)
    scope = Scope(parameters=values, given=given_quantities)
    findings: list[tuple[str, Finding]] = []
    for first in block:
        pending = {first: None}  # ordered: the last one is evaluated next
        while pending:
            name = next(reversed(pending))
            if name in values.keys():  # noqa: SIM118  # `in values` asks whether it is given
                pending.popitem()
                continue
            values.used_names = uses[name]
            try:
                expression = read_function(block[name], None, scope)
                values[name] = expression.constant
                if expression.dimension is not None:
                    given_quantities[name] = DimensionedParameter(expression.dimension, expression.source.strip())
            except _UnknownParameter as unknown:
                if unknown.name in pending:
                    chain = list(pending)
                    cycle = [*chain[chain.index(unknown.name) :], unknown.name]
                    message = f"circular reference between parameters: {' -> '.join(abbreviate_names(cycle))}"
                    findings.append((unknown.name, Finding("parameter-circle", message, CIRCLE_HINT)))
                    values.update(dict.fromkeys(cycle))
                else:
                    pending[unknown.name] = None
            except DependentError:
                values[name] = None
            except Finding as finding:
                values[name] = None
                findings.append((name, finding))
    return Parameters({name: values[name] for name in block}, given_quantities, findings, uses)


def abbreviate_names(names: list[str]) -> list[str]:
    """Abbreviate a long list of names to its two ends."""
    omitted = len(names) - MAX_LISTED_NAMES
    return names if omitted <= 0 else [*names[: MAX_LISTED_NAMES - 2], f"({omitted} more)", *names[-2:]]
