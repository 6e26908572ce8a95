"""The options of solving that many commands have, those that change a spec once it is read, and printed warnings."""

from __future__ import annotations

from collections.abc import Collection, Iterable, Mapping, Sequence
from typing import TYPE_CHECKING, Any, Protocol

from heuncli.app.cli.options import CaptionRequest, SolverRequest
from heuncli.app.cli.output import print_stderr
from heuncli.base.errors import Problem, UsageError
from heuncli.base.spelling import suggest
from heuncli.base.text_safety import escape
from heuncli.output.tables.run_description import collect_warnings
from heuncli.results.results import Array, Results
from heuncli.scene.file_format.load import load
from heuncli.scene.file_format.models import Spec
from heuncli.study.model.options import Options
from heuncli.study.model.options import collect_results as collect_results  # re-exported for the commands
from heuncli.study.model.options import require_choice as require_choice
from heuncli.study.model.options import require_positive as require_positive
from heuncli.study.model.options import require_tolerance as require_tolerance
from heuncli.study.quantities.captions import OPTIONS, set_captions

if TYPE_CHECKING:
    from heuncli.study.queries.study import Study


def make_solver_options(request: SolverRequest) -> Options:
    """Check the solver's options of a command line, and make those of the study of them. Raises UsageError."""
    return Options(
        tolerance=require_tolerance(request.tolerance),
        method=request.method,
        step=require_positive("--step", request.step),
        least_norm=request.least_norm,
        reduce=not request.no_reduce,
    )


def parse_overrides(words: Sequence[str]) -> dict[str, str]:
    """Parse `name=value` words into a mapping. Raises UsageError."""
    pairs: dict[str, str] = {}
    for word in words:
        name, equals, value = word.partition("=")
        if not equals or not name.strip():
            raise UsageError(
                Problem("bad-option", f"--set {word}: expected NAME=VALUE", hint="for example --set L=1.2")
            )
        pairs[name.strip()] = value.strip()
    return pairs


class SpecRequest(Protocol):
    """A request with a spec, its load case and values set in it."""

    @property
    def spec(self) -> str: ...
    @property
    def set(self) -> Sequence[str]: ...
    @property
    def case(self) -> str | None: ...


def load_spec(request: SpecRequest) -> Spec:
    """Load the spec of a request in its load case, with the values of --set; its `expect` block is not checked.

    Raises UsageError, SpecError.
    """
    return load(request.spec, overrides=parse_overrides(request.set), checking=False, case=request.case)


def require_cases(cases: Collection[str]) -> None:
    """Raise UsageError if all load cases are requested and there is none."""
    if not cases:
        hint = "cases: {NAME: {set: {PARAMETER: VALUE}}}"
        raise UsageError(Problem("unknown-case", "--case all: the spec has no load cases", hint=hint))


def split_spec_and_assignments(words: Sequence[str], command: str, usage: str) -> tuple[str, list[str]]:
    """Split the arguments into the spec's file and the words NAME=.... Raises UsageError unless exactly one file is
    named.
    """
    files = [word for word in words if "=" not in word]
    if len(files) != 1:
        problem_text = (
            f"expected one spec, found {len(files)} files: {', '.join(files)}" if files else "no spec is given"
        )
        raise UsageError(Problem("bad-option", f"{command}: {problem_text}", hint=usage))
    return files[0], [word for word in words if "=" in word]


def parse_instants(words: str, study: Study) -> Array:
    """Return the instants of `--at` in a run, (n_t,) ascending.

    Raises UsageError, also for extremes, which tables show anyway.
    """
    from heuncli.study.queries.at_option import (  # where they are asked for
        find_requested_times,
        make_extreme_requests,
        parse,
    )

    requested = parse(words)
    if make_extreme_requests(requested):
        message = f"--at {words}: tables already show when each number is largest"
        hint = "leave out --at, or give a time, first, last or impulse:NAME"
        raise UsageError(Problem("bad-option", message, hint=hint))
    return find_requested_times(requested, study)


def print_warnings(
    spec: Spec, results: Results | None, quiet: bool, place: str = "heun", later: Iterable[str] = ()
) -> list[str]:
    """Print the warnings of reading, of solving and of later steps, each once; returns them.

    place: names the run in the warnings of solving
    """
    read, solved = collect_warnings(spec, results, later)
    for line in format_warnings(spec, results, place, later) if not quiet else ():
        print_stderr(line)
    return read + solved


def format_warnings(spec: Spec, results: Results | None, place: str, later: Iterable[str] = ()) -> list[str]:
    """Return the warnings as they are printed, one per line, with their locations."""
    read, solved = collect_warnings(spec, results, later)
    return [f"warning: {text}" for text in read + [escape(f"{place}: {text}") for text in solved]]


def format_timings(work: Mapping[str, Any]) -> str:
    """Return the time of each step of the work, in milliseconds."""
    seconds_by_part = {"discarded" if name == "lost" else name: s for name, s in work.get("seconds", {}).items()}
    parts = [f"{name} {1e3 * seconds:.1f} ms" for name, seconds in seconds_by_part.items()]
    return ", ".join(parts)


EXAMPLE = "for example --label joints.main='Main bearing'"


def apply_captions(spec: Spec, request: CaptionRequest) -> Spec:
    """Return a spec with the title and the labels of the command line. Raises UsageError with all that is wrong."""
    if request.title is None and not request.label:
        return spec
    problems = [
        Problem("bad-option", f"--label {word}: expected PATH=TEXT", hint=EXAMPLE)
        for word in request.label
        if "=" not in word
    ]
    labels = [(path.strip(), text) for path, equals, text in (word.partition("=") for word in request.label) if equals]
    try:
        captioned = set_captions(spec, request.title, labels, OPTIONS)
    except UsageError as error:
        problems += error.problems
    if problems:
        raise UsageError(*problems)
    return captioned


def apply_captions_to_cases(cases: Mapping[str, Spec], request: CaptionRequest) -> dict[str, Spec]:
    """Return load cases with the title and the labels of the command line. Raises UsageError."""
    return {name: apply_captions(spec, request) for name, spec in cases.items()}


def find_excluded(spec: Spec, words: Sequence[str]) -> tuple[str, ...]:
    """Return the entries that the words name, as `forces.push`. Raises UsageError with every name that is unknown or
    ambiguous.
    """
    names = [name.strip() for word in words for name in word.split(",")]
    matches = [find_entries(spec, name) for name in names]
    problems = [
        make_problem(spec, name, entries) for name, entries in zip(names, matches, strict=True) if len(entries) != 1
    ]
    if problems:
        raise UsageError(*problems)
    return tuple(dict.fromkeys(entries[0] for entries in matches))


def list_excludable(spec: Spec) -> list[str]:
    """List all forces and drives, as `forces.push`."""
    return [*(f"forces.{name}" for name in spec.forces), *(f"drives.{name}" for name in spec.drives)]


def find_entries(spec: Spec, name: str) -> list[str]:
    """Return the entries with a name, given with or without its block."""
    return [entry for entry in list_excludable(spec) if name in (entry, entry.partition(".")[2])]


def make_problem(spec: Spec, name: str, matches: Sequence[str]) -> Problem:
    """Make the problem of a name that no entry has, or two."""
    if matches:
        message = f"--without {name}: {' and '.join(matches)} have this name"
        return Problem(
            "bad-option", message, hint=f"give {' or '.join(matches)}; or both: --without {','.join(matches)}"
        )
    if not list_excludable(spec):
        return Problem("bad-option", f"--without {name}: the model has no forces or drives", hint="leave it out")
    plain = [entry.partition(".")[2] for entry in list_excludable(spec)]
    hint = suggest(name, list_excludable(spec) if "." in name else plain, "forces and drives")
    return Problem("bad-option", f"--without {name}: no force or drive has this name", hint=hint or "")
