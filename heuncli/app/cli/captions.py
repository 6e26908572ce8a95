"""`--title` and `--label PATH=TEXT`: texts for readers that a command line puts in place of those of the spec."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Protocol

from heuncli.base.errors import Problem, UsageError
from heuncli.scene.file_format.models import Spec
from heuncli.study.quantities.given_captions import OPTIONS, set_captions

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
