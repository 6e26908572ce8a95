"""The register of rules: each is a function over the read document, yields what it finds, and owns one error code."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator
from typing import NamedTuple

from heuncli.spec.format import Document
from heuncli.spec.names import Names

Path_ = tuple[str | int, ...]


class Found(NamedTuple):
    """One thing a rule objects to: where, what, what next; key: the place is the key's, not the value's."""

    path: Path_
    message: str
    hint: str | None = None
    key: bool = False


class Scene(NamedTuple):
    """What rules look at.

    Entries that could not be read are missing in `document`, but are among `names`; `unread` are the keys of the top
    level in which something was.
    """

    document: Document
    names: Names
    unread: frozenset[str] = frozenset()


Check = Callable[[Scene], Iterable[Found]]


class Rule(NamedTuple):
    """A check and the code of what it finds; a warning does not stop the run.

    follows: what it finds may only follow from what could not be read; for_check: it matters to `heun check` alone.
    """

    code: str
    check: Check
    is_warning: bool
    follows: bool
    for_check: bool


RULES: list[Rule] = []


def rule(
    code: str, is_warning: bool = False, follows: bool = True, for_check: bool = False
) -> Callable[[Check], Check]:
    """Register a check."""

    def register(check: Check) -> Check:
        RULES.append(Rule(code, check, is_warning, follows, for_check))
        return check

    return register


def found_by(rules: Iterable[Rule], scene: Scene) -> Iterator[tuple[Rule, Found]]:
    """What the rules find, in their order."""
    for each in rules:
        for found in each.check(scene):
            yield each, found
