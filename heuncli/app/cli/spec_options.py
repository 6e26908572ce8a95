"""Options that change a spec once it is read: `--title` and `--label PATH=TEXT` for its readers, and `--without`."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Protocol

from heuncli.base.errors import Problem, UsageError
from heuncli.base.spelling import suggest
from heuncli.scene.file_format.models import Spec
from heuncli.study.quantities.captions import OPTIONS, set_captions

EXAMPLE = "for example --label joints.main='Main bearing'"


class CaptionRequest(Protocol):
    """A request with the options of captions."""

    @property
    def title(self) -> str | None: ...
    @property
    def label(self) -> Sequence[str]: ...


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
