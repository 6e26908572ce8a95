"""The register of rules: each is a function over the document as read, yields violations, and owns one error code."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator
from typing import Any

from heuncli.base.named_tuples import NamedTuple
from heuncli.scene.file_format.format import Document
from heuncli.scene.file_format.names import Names

Path_ = tuple[str | int, ...]


class Violation(NamedTuple):
    """A violation of a rule: path, message, hint; key: the location is that of the key, not of the value."""

    path: Path_
    message: str
    hint: str
    key: bool = False


class DraftDocument(NamedTuple):
    """A document as far as it could be read, which the rules check.

    Entries that could not be read are missing in `document`, but are among `names`; `unread`: the top-level keys in
    which an entry could not be read. reached: what paths into the results lead to, as far as a rule has asked
    (rules/outcome.py): several ask about the same ones.
    """

    document: Document
    names: Names
    unread: frozenset[str]
    reached: dict[str, Any]


Check = Callable[[DraftDocument], Iterable[Violation]]


class Rule(NamedTuple):
    """A check and the code of its violations; a warning does not stop the run.

    follows: its violations may be consequences of what could not be read; for_check: it matters to `heun check` alone.
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


def violations(rules: Iterable[Rule], draft: DraftDocument) -> Iterator[tuple[Rule, Violation]]:
    """The violations of the rules, in their order."""
    for each in rules:
        for violation in each.check(draft):
            yield each, violation
