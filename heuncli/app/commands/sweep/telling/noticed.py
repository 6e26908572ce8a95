"""What a sweep came to, in some lines on standard error: what could not be solved, and warnings with their counts."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterable

from heuncli.analyses.sweep_store.rows import SweepHead, SweptRow
from heuncli.analyses.variants.once import kind_of_warning
from heuncli.app.cli.output import say
from heuncli.base.named_tuples import NamedTuple

MOST = 20  # kinds of warnings that are told


class Noticed(NamedTuple):
    """How many variants there are, how many failed by which code, and what warned how often.

    warnings: by their words without figures, the first of each kind, and of how many variants. absent: by measure, in
    how many variants there is none of it.
    """

    rows: int
    codes: Counter[str]
    warnings: dict[str, tuple[str, int]]
    more: int
    absent: Counter[str]

    @property
    def failed(self) -> int:
        """How many could not be solved."""
        return self.codes.total()


def noticed_in(head: SweepHead, rows: Iterable[SweptRow]) -> Noticed:
    """What there is to say of all rows, gone through once."""
    count, more = 0, 0
    codes: Counter[str] = Counter()
    warnings: dict[str, tuple[str, int]] = {}
    absent: Counter[str] = Counter()
    for row in rows:
        count += 1
        if row.answer.code:
            codes[row.answer.code] += 1
        for text in row.answer.warnings:
            kind = kind_of_warning(text)
            if kind in warnings or len(warnings) < MOST:
                first, so_far = warnings.get(kind, (text, 0))
                warnings[kind] = first, so_far + 1
            else:
                more += 1
        absent.update(
            m.text for m, one in zip(head.measures, row.answer.measures, strict=False) if one.word == "absent"
        )
    return Noticed(count, codes, warnings, more, absent)


def say_noticed(noticed: Noticed, quiet: bool) -> None:
    """What there is to say beside the rows."""
    if quiet:
        return
    for text, count in noticed.warnings.values():
        say(f"warning: heun: {text} ({_of(count, noticed.rows)})")
    if noticed.more:
        say(f"warning: heun: and {noticed.more} warnings of other kinds; the rows have them all")
    for measure, count in noticed.absent.items():
        if count == noticed.rows - noticed.failed:
            say(f"warning: heun: {measure}: no variant has it")
    if noticed.failed:
        codes = ", ".join(f"{count} {code}" for code, count in noticed.codes.most_common())
        say(f"heun: {_of(noticed.failed, noticed.rows)} could not be solved: {codes}")


def _of(count: int, rows: int) -> str:
    return "all variants" if count == rows else f"{count} of {rows} variants"
