"""Rules about the method of integration: each code is one of spec/methods.py."""

from __future__ import annotations

from collections.abc import Iterator

from heuncli.spec.methods import unfit
from heuncli.spec.rules.registry import DraftDocument, Violation, rule


def among(draft: DraftDocument, code: str) -> Iterator[Violation]:
    """What speaks against the method and the step, of one code; not that one is missing which could not be read."""
    if "analysis" in draft.unread and code == "fixed-step":
        return
    analysis = draft.document.analysis
    last = analysis.duration if analysis.times is None else max(analysis.times, default=None)
    for one in unfit(analysis.method, analysis.step, last):
        if one.code == code:
            yield Violation(("analysis", one.key), one.message, one.hint)


@rule("unknown-method")
def unknown_method(draft: DraftDocument) -> Iterator[Violation]:
    """The method is one that `heun methods` lists."""
    yield from among(draft, "unknown-method")


@rule("fixed-step")
def fixed_step(draft: DraftDocument) -> Iterator[Violation]:
    """A method of fixed step has one, no other has."""
    yield from among(draft, "fixed-step")


@rule("step")
def step(draft: DraftDocument) -> Iterator[Violation]:
    """A step is positive, no longer than the run, and not so short that it needs too many."""
    yield from among(draft, "step")
