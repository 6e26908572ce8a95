"""What the commands share: options read from words, warnings and timings written."""

from __future__ import annotations

import math
from collections.abc import Callable, Collection, Iterable, Mapping, Sequence
from typing import Any, Protocol, TypeVar

import numpy as np

from heuncli import tolerances
from heuncli.cli.entry import UsageError
from heuncli.cli.output import say
from heuncli.errors import HeunError, Problem
from heuncli.foreign_text import shown
from heuncli.nearest import did_you_mean
from heuncli.results import Array, Results
from heuncli.spec.methods import unfit_tolerance
from heuncli.spec.models import Spec
from heuncli.study.model.options import Options

T = TypeVar("T")


class SolverRequest(Protocol):
    """A request with the options by which scenes are solved."""

    @property
    def tolerance(self) -> float | None: ...
    @property
    def method(self) -> str | None: ...
    @property
    def step(self) -> float | None: ...
    @property
    def least_norm(self) -> bool: ...
    @property
    def no_reduce(self) -> bool: ...


def solver_options(request: SolverRequest) -> Options:
    """By what a scene is solved. Raises UsageError."""
    return Options(
        tolerance=tolerance(request.tolerance),
        method=request.method,
        step=positive("--step", request.step),
        least_norm=request.least_norm,
        reduce=not request.no_reduce,
    )


def choice(option: str, value: str, known: Sequence[str]) -> str:
    """The value if it is one of the known ones, else a UsageError that lists them."""
    if value not in known:
        hint = did_you_mean(value, known, "values")
        raise UsageError(Problem("bad-option", f"{option} {value}: known: {', '.join(known)}", hint=hint))
    return value


def overrides(words: Sequence[str]) -> dict[str, str]:
    """`name=value` words as a mapping."""
    pairs: dict[str, str] = {}
    for word in words:
        name, equals, value = word.partition("=")
        if not equals or not name.strip():
            raise UsageError(Problem("bad-option", f"--set {word}: expected NAME=VALUE", hint="such as --set L=1.2"))
        pairs[name.strip()] = value.strip()
    return pairs


def require_cases(cases: Collection[str]) -> None:
    """Raise UsageError where all load cases are asked for, and there is none."""
    if not cases:
        hint = "cases: {NAME: {set: {PARAMETER: VALUE}}}"
        raise UsageError(Problem("unknown-case", "--case all: the spec has no load cases", hint=hint))


def all_or_errors(calls: Iterable[Callable[[], T]]) -> list[T]:
    """What all of them give. Raises what the first that fails raises, with the problems of all that do."""
    given: list[T] = []
    errors: list[HeunError] = []
    for call in calls:
        try:
            given.append(call())
        except HeunError as error:
            errors.append(error)
    if errors:
        errors[0].tell(*dict.fromkeys(problem for error in errors for problem in error.problems))
        raise errors[0]
    return given


def spec_among(words: Sequence[str], command: str, usage: str) -> tuple[str, list[str]]:
    """The one word that names the spec's file, and those that say NAME=... of something. Raises UsageError."""
    files = [word for word in words if "=" not in word]
    if len(files) != 1:
        found = f"{len(files)} files: {', '.join(files)}" if files else "no spec is named"
        raise UsageError(Problem("bad-option", f"{command}: {found}", hint=usage))
    return files[0], [word for word in words if "=" in word]


def positive(option: str, value: float | None) -> float | None:
    """The value if it is a positive number or not given."""
    if value is not None and not (math.isfinite(value) and value > 0.0):
        message = f"{option} {value}: expected a positive number"
        raise UsageError(Problem("bad-option", message, hint=f"such as {option} 0.001, in s"))
    return value


def tolerance(value: float | None) -> float | None:
    """The value of --tolerance if it is one that can be met, as in a spec, or not given."""
    found = unfit_tolerance(value) if value is not None else None
    if found is not None:
        raise UsageError(Problem("bad-option", f"--{found.message}", hint=found.hint))
    return value


def instants(words: str, times: Array) -> Array:
    """The instants of `--at`, sorted; all must lie within the run, (n_t,) ascending."""
    try:
        asked = sorted({float(word) for word in words.split(",")})
    except ValueError:
        raise UsageError(Problem("bad-option", f"--at {words}: expected numbers", hint="such as --at 0.5,1")) from None
    slack = tolerances.SAME_INSTANT * float(np.ptp(times))
    for t in asked:
        if not times[0] - slack <= t <= times[-1] + slack:
            span = f"the run goes from {times[0]:.6g} to {times[-1]:.6g} s"
            message = span if len(times) > 1 else f"there is one instant, t = {times[0]:.6g} s"
            hint = "leave --at out" if len(times) == 1 else f"such as --at {times[-1]:.6g}"
            hint += ", or a longer duration" if times[-1] < t < math.inf else ""
            raise UsageError(Problem("bad-option", f"--at {t:.6g}: {message}", hint=hint))
    within: Array = np.clip(np.array(asked), times[0], times[-1])
    return within


def warn(spec: Spec, results: Results | None, quiet: bool, place: str = "heun", later: Iterable[str] = ()) -> list[str]:
    """Tell the warnings of reading, of solving (of which `place`) and of what came later, once each; returns them."""
    read, solved = _warnings(spec, results, later)
    for line in warning_lines(spec, results, place, later) if not quiet else ():
        say(line)
    return read + solved


def warning_lines(spec: Spec, results: Results | None, place: str, later: Iterable[str] = ()) -> list[str]:
    """The warnings as they are told, a line each, with their places."""
    read, solved = _warnings(spec, results, later)
    return [f"warning: {text}" for text in read + [shown(f"{place}: {text}") for text in solved]]


def _warnings(spec: Spec, results: Results | None, later: Iterable[str]) -> tuple[list[str], list[str]]:
    """Those of reading, and those of solving that are not among them."""
    known = {problem.message for problem in spec.warnings}
    solved = [text for text in results.warnings if text not in known] if results else []
    return [str(problem) for problem in spec.warnings], solved + list(later)


def timings(work: Mapping[str, Any]) -> str:
    """Where the time went, in milliseconds."""
    parts = [f"{name} {1e3 * seconds:.1f} ms" for name, seconds in work.get("seconds", {}).items()]
    return ", ".join(parts)
