"""What the commands share: options read from words, warnings and timings written."""

from __future__ import annotations

from collections.abc import Collection, Iterable, Mapping, Sequence
from typing import TYPE_CHECKING, Any, Protocol

from heuncli.app.cli.output import say
from heuncli.base.errors import Problem, UsageError
from heuncli.base.foreign_text import shown
from heuncli.output.snapshots.warned import warnings_of
from heuncli.results.results import Array, Results
from heuncli.scene.file_format.models import Spec
from heuncli.study.ask.asked_values import all_or_errors as all_or_errors  # for the commands, beside these here
from heuncli.study.ask.asked_values import choice as choice
from heuncli.study.ask.asked_values import positive as positive
from heuncli.study.ask.asked_values import tolerance as tolerance
from heuncli.study.model.options import Options

if TYPE_CHECKING:
    from heuncli.study.ask.study import Study


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


def spec_among(words: Sequence[str], command: str, usage: str) -> tuple[str, list[str]]:
    """The one word that names the spec's file, and those that say NAME=... of something. Raises UsageError."""
    files = [word for word in words if "=" not in word]
    if len(files) != 1:
        found = f"{len(files)} files: {', '.join(files)}" if files else "no spec is named"
        raise UsageError(Problem("bad-option", f"{command}: {found}", hint=usage))
    return files[0], [word for word in words if "=" in word]


def instants(words: str, study: Study) -> Array:
    """The instants of `--at` in a run, (n_t,) ascending. Raises UsageError, also of extremes, which tables tell."""
    from heuncli.study.ask.asked_instants import measures, parse, times_of  # where they are asked for

    asked = parse(words)
    if measures(asked):
        message = f"--at {words}: tables show by themselves when each number is largest"
        hint = "leave --at out; or name a time, first, last, impulse:NAME"
        raise UsageError(Problem("bad-option", message, hint=hint))
    return times_of(asked, study)


def warn(spec: Spec, results: Results | None, quiet: bool, place: str = "heun", later: Iterable[str] = ()) -> list[str]:
    """Tell the warnings of reading, of solving (of which `place`) and of what came later, once each; returns them."""
    read, solved = warnings_of(spec, results, later)
    for line in warning_lines(spec, results, place, later) if not quiet else ():
        say(line)
    return read + solved


def warning_lines(spec: Spec, results: Results | None, place: str, later: Iterable[str] = ()) -> list[str]:
    """The warnings as they are told, a line each, with their places."""
    read, solved = warnings_of(spec, results, later)
    return [f"warning: {text}" for text in read + [shown(f"{place}: {text}") for text in solved]]


def timings(work: Mapping[str, Any]) -> str:
    """Where the time went, in milliseconds."""
    parts = [f"{name} {1e3 * seconds:.1f} ms" for name, seconds in work.get("seconds", {}).items()]
    return ", ".join(parts)
