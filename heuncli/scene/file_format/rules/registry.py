"""The registry of rules: each is a function that checks the document as read, yields violations, and owns one error
code.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator
from typing import Any

from heuncli.base.named_tuples import NamedTuple
from heuncli.scene.file_format.format import Document
from heuncli.scene.file_format.names import SceneNames

Path_ = tuple[str | int, ...]


class Violation(NamedTuple):
    """A violation of a rule.

    path, message, hint: where, what, and what to do
    key: whether the location is that of the key, not of the value
    """

    path: Path_
    message: str
    hint: str
    key: bool = False


class DraftDocument(NamedTuple):
    """A document as far as it could be read, which the rules check.

    document: entries that could not be read are missing here, but are among `names`
    unread: top-level keys in which an entry could not be read
    path_targets: cached targets of paths into the results (rules/outcome.py), because several rules need the same ones
    """

    document: Document
    names: SceneNames
    unread: frozenset[str]
    path_targets: dict[str, Any]


Check = Callable[[DraftDocument], Iterable[Violation]]


class Rule(NamedTuple):
    """A check and the code of its violations; a warning does not stop the run.

    may_be_consequence: its violations may be consequences of something that could not be read
    for_check: it only matters to `heun check`
    """

    code: str
    check: Check
    is_warning: bool
    may_be_consequence: bool
    for_check: bool


RULES: list[Rule] = []


def rule(
    code: str, is_warning: bool = False, may_be_consequence: bool = True, for_check: bool = False
) -> Callable[[Check], Check]:
    """Register a check."""

    def register(check: Check) -> Check:
        RULES.append(Rule(code, check, is_warning, may_be_consequence, for_check))
        return check

    return register


def iter_violations(rules: Iterable[Rule], draft: DraftDocument) -> Iterator[tuple[Rule, Violation]]:
    """Yield the violations of the rules, in the order of the rules."""
    for single_rule in rules:
        for violation in single_rule.check(draft):
            yield single_rule, violation
