"""What the format knows and this version does not solve yet: an error with its location, never ignored.

One row a feature; to lift a refusal, delete its row.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator

from heuncli.method_rows import NAMES
from heuncli.spec.rules.registry import DraftDocument, Path_, Violation, rule

Where = Callable[[DraftDocument], Iterable[Path_]]


def other_method(draft: DraftDocument) -> Iterator[Path_]:
    """A method of integration that there is not."""
    if draft.document.analysis.method not in NAMES:
        yield "analysis", "method"


def fixed_step(draft: DraftDocument) -> Iterator[Path_]:
    """The step of a method with fixed steps."""
    if draft.document.analysis.step is not None:
        yield "analysis", "step"


def rubbing(draft: DraftDocument) -> Iterator[Path_]:
    """Stops that rub where they are struck."""
    for name, stop in draft.document.stops.items():
        if stop.friction is not None:
            yield "stops", name, "friction"


NOT_YET: tuple[tuple[str, Where], ...] = (
    ("friction at strikes", rubbing),
    (f"a method other than {' and '.join(NAMES)}", other_method),
    ("fixed steps", fixed_step),
)


@rule("not-yet", follows=False)
def not_yet(draft: DraftDocument) -> Iterator[Violation]:
    """Refuse what stands in the table."""
    for feature, where in NOT_YET:
        for path in where(draft):
            yield Violation(path, f"not yet: {feature}", key=path[-1] != "type")
