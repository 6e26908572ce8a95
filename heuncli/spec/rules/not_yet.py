"""What the format knows and this version does not solve yet: refused by name and place, never ignored.

One row a feature; to lift a refusal, delete its row.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator

from heuncli.spec.rules.joints import rate_jumps
from heuncli.spec.rules.registry import Found, Path_, Scene, rule

Where = Callable[[Scene], Iterable[Path_]]
METHODS = ("auto", "DOP853")


def any_of(block: str) -> Where:
    """All entries of a block."""

    def where(scene: Scene) -> Iterator[Path_]:
        for name in scene.names.entries[block]:
            yield block, name

    return where


def other_method(scene: Scene) -> Iterator[Path_]:
    """A method of integration that there is not."""
    if scene.document.analysis.method not in METHODS:
        yield "analysis", "method"


def fixed_step(scene: Scene) -> Iterator[Path_]:
    """The step of a method with fixed steps."""
    if scene.document.analysis.step is not None:
        yield "analysis", "step"


def shares(scene: Scene) -> Iterator[Path_]:
    """Loads by their causes."""
    for i, name in enumerate(scene.document.head.report or ()):
        if name == "shares":
            yield "report", i


NOT_YET: tuple[tuple[str, Where], ...] = (
    ("impulses", any_of("impulses")),
    ("a drive whose rate jumps, which is a blow", rate_jumps),
    (f"a method other than {' and '.join(METHODS)}", other_method),
    ("fixed steps", fixed_step),
    ("shares, loads by their causes", shares),
)


@rule("not-yet", follows=False)
def not_yet(scene: Scene) -> Iterator[Found]:
    """Refuse what stands in the table."""
    for feature, where in NOT_YET:
        for path in where(scene):
            yield Found(path, f"not yet: {feature}", key=path[-1] != "type")
