"""The load cases of a spec that was read, each as a scene of its own. Impure: reads the spec's file again."""

from __future__ import annotations

from collections.abc import Iterator, Mapping

from heuncli.errors import Problem, SpecError
from heuncli.spec.load import load
from heuncli.spec.models import Spec
from heuncli.spec.reading import STANDARD_INPUT


def each_case(
    spec: Spec, overrides: Mapping[str, str] | None = None, text: str | None = None, checking: bool = True
) -> Iterator[Spec]:
    """Every case of a spec, in their order. Raises SpecError with the problems of a case, which is named in them."""
    for name in spec.cases:
        yield load_case(spec, name, overrides, text, checking)


def load_case(
    spec: Spec, name: str, overrides: Mapping[str, str] | None = None, text: str | None = None, checking: bool = True
) -> Spec:
    """One case of a spec. Raises SpecError with what is wrong in this case alone."""
    try:
        return load(spec.path, text, overrides, checking, name)
    except SpecError as error:
        raise SpecError(*(_of(name, problem) for problem in error.problems)) from None


def require_sound_cases(spec: Spec) -> None:
    """Raise SpecError with all that is wrong in the cases of a spec, and not in the spec as it stands."""
    problems: list[Problem] = []
    for name in spec.cases if spec.path != STANDARD_INPUT else ():
        try:
            load_case(spec, name)
        except SpecError as error:
            problems += error.problems
    if problems:
        raise SpecError(*problems)


def _of(name: str, problem: Problem) -> Problem:
    return problem._replace(message=f"in case {name}: {problem.message}")
