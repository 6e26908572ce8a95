"""What the format knows and this version does not solve yet: an error with its location, never ignored.

One row a feature; to lift a refusal, delete its row.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator

from heuncli.scene.file_format.rules.registry import DraftDocument, Path_, Violation, rule

Where = Callable[[DraftDocument], Iterable[Path_]]


def rubbing(draft: DraftDocument) -> Iterator[Path_]:
    """Stops that rub where they are struck."""
    for name, stop in draft.document.stops.items():
        if stop.friction is not None:
            yield "stops", name, "friction"


NOT_YET: tuple[tuple[str, Where], ...] = (("friction at strikes", rubbing),)


@rule("not-yet", follows=False)
def not_yet(draft: DraftDocument) -> Iterator[Violation]:
    """Refuse what stands in the table."""
    for feature, where in NOT_YET:
        for path in where(draft):
            yield Violation(path, f"not yet: {feature}", "leave it out: a later version has it", key=path[-1] != "type")
