"""Refuse, with a location, what the format knows but this version does not solve.

One row per feature; to lift a refusal, delete its row.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator

from heuncli.scene.file_format.rules.registry import DraftDocument, Path_, Violation, rule

PathFinder = Callable[[DraftDocument], Iterable[Path_]]


def iter_stop_friction(draft: DraftDocument) -> Iterator[Path_]:
    """Yield the friction of stops at impacts."""
    for name, stop in draft.document.stops.items():
        if stop.friction is not None:
            yield "stops", name, "friction"


NOT_YET: tuple[tuple[str, PathFinder], ...] = (("friction at impacts", iter_stop_friction),)


@rule("not-yet", may_be_consequence=False)
def check_not_yet(draft: DraftDocument) -> Iterator[Violation]:
    """Refuse the features of the table."""
    for feature, find_paths in NOT_YET:
        for path in find_paths(draft):
            yield Violation(
                path,
                f"not available yet: {feature}",
                "leave it out: planned for a later version",
                key=path[-1] != "type",
            )
