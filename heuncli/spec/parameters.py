"""The parameters of a scene: numbers that may refer to each other in any order."""

from __future__ import annotations

from typing import Any

from heuncli.errors import Finding
from heuncli.spec.quantity import Follows, Scope, number


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

    def __contains__(self, name: object) -> bool:
        return name in self.given

    def __missing__(self, name: str) -> float | None:
        raise _Needed(name)


def evaluate_parameters(given: dict[str, Any]) -> tuple[dict[str, float | None], list[tuple[str, Finding]]]:
    """Values in SI (None for those in error) and what is wrong."""
    values = _Values(given)
    scope = Scope(parameters=values)
    findings: list[tuple[str, Finding]] = []
    for first in given:
        waiting = [first]
        while waiting:
            name = waiting[-1]
            if name in values.keys():  # noqa: SIM118  # `in values` asks whether it is given
                waiting.pop()
                continue
            try:
                values[name] = number(given[name], None, scope)
            except _Needed as needed:
                if needed.name in waiting:
                    circle = [*waiting[waiting.index(needed.name) :], needed.name]
                    message = f"parameters refer to each other in a circle: {' -> '.join(circle)}"
                    findings.append((needed.name, Finding("parameter-circle", message)))
                    values.update(dict.fromkeys(circle))
                else:
                    waiting.append(needed.name)
            except Follows:
                values[name] = None
            except Finding as finding:
                values[name] = None
                findings.append((name, finding))
    return {name: values[name] for name in given}, findings
