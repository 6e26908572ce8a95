"""The parameters of a scene: numbers that may refer to each other in any order."""

from __future__ import annotations

from typing import Any

from heuncli.base.errors import Finding
from heuncli.base.records import record
from heuncli.scene.expressions.grammar import GivenParameter
from heuncli.scene.file_format.quantity import Follows, Scope, in_time

MOST_TOLD = 12  # names of a circle
CUT = "give one of them as a number"


class _Needed(Exception):
    """A parameter that has to be known first."""

    def __init__(self, name: str) -> None:
        super().__init__(name)
        self.name = name


class _Values(dict[str, float | None]):
    """Known values; asking for one that is given but not yet known raises _Needed."""

    def __init__(self, given: dict[str, Any]) -> None:
        super().__init__()
        self.given = given
        self.asked: set[object] = set()

    def __contains__(self, name: object) -> bool:
        self.asked.add(name)
        return name in self.given

    def __missing__(self, name: str) -> float | None:
        raise _Needed(name)


@record
class Parameters:
    """Values in SI, None for those in error; those with a dimension, as they are written; and what is wrong.

    uses: the names that each of them asks for.
    """

    values: dict[str, float | None]
    given: dict[str, GivenParameter]
    findings: list[tuple[str, Finding]]
    uses: dict[str, set[object]]


def evaluate_parameters(given: dict[str, Any], known: Parameters | None = None) -> Parameters:
    """The parameters that a spec gives; known: those that hang on nothing that has changed since."""
    values = _Values(given)
    written: dict[str, GivenParameter] = {}
    uses: dict[str, set[object]] = {name: set() for name in given}
    if known is not None:
        values.update(known.values)
        written.update(known.given)
        uses.update(known.uses)
    scope = Scope(parameters=values, given=written)
    findings: list[tuple[str, Finding]] = []
    for first in given:
        waiting = {first: None}  # in the order in which they were asked for
        while waiting:
            name = next(reversed(waiting))
            if name in values.keys():  # noqa: SIM118  # `in values` asks whether it is given
                waiting.popitem()
                continue
            values.asked = uses[name]
            try:
                expression = in_time(given[name], None, scope)
                values[name] = expression.constant
                if expression.dimension is not None:
                    written[name] = GivenParameter(expression.dimension, expression.source.strip())
            except _Needed as needed:
                if needed.name in waiting:
                    asked = list(waiting)
                    circle = [*asked[asked.index(needed.name) :], needed.name]
                    message = f"parameters refer to each other in a circle: {' -> '.join(shortened(circle))}"
                    findings.append((needed.name, Finding("parameter-circle", message, CUT)))
                    values.update(dict.fromkeys(circle))
                else:
                    waiting[needed.name] = None
            except Follows:
                values[name] = None
            except Finding as finding:
                values[name] = None
                findings.append((name, finding))
    return Parameters({name: values[name] for name in given}, written, findings, uses)


def shortened(names: list[str]) -> list[str]:
    """A long row of names by its ends."""
    left_out = len(names) - MOST_TOLD
    return names if left_out <= 0 else [*names[: MOST_TOLD - 2], f"({left_out} more)", *names[-2:]]
