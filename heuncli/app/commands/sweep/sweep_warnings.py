"""The failures and warnings of a sweep: how many variants each concerns. Impure: prints to standard error."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterable

from heuncli.analyses.sweep_rows import SweepHead, SweptRow
from heuncli.analyses.variants.measures import strip_numbers
from heuncli.app.cli.output import print_stderr
from heuncli.base.named_tuples import NamedTuple

MAX_KINDS = 20  # kinds of warnings that are told


class SweepWarnings(NamedTuple):
    """The failures and warnings of a sweep.

    rows: number of variants
    codes: number of failed variants by code
    warnings: by their words without figures, the first of each kind, and the number of variants
    more: number of warnings of further kinds
    absent: by measure, number of variants without it
    """

    rows: int
    codes: Counter[str]
    warnings: dict[str, tuple[str, int]]
    more: int
    absent: Counter[str]

    @property
    def failure_count(self) -> int:
        """Number of variants that could not be solved."""
        return self.codes.total()


def collect_warnings(head: SweepHead, rows: Iterable[SweptRow]) -> SweepWarnings:
    """Collect the failures and warnings of all rows, read once."""
    count, other_kinds = 0, 0
    codes: Counter[str] = Counter()
    warnings: dict[str, tuple[str, int]] = {}
    absent: Counter[str] = Counter()
    for row in rows:
        count += 1
        if row.result.code:
            codes[row.result.code] += 1
        for text in row.result.warnings:
            kind = strip_numbers(text)
            if kind in warnings or len(warnings) < MAX_KINDS:
                first, so_far = warnings.get(kind, (text, 0))
                warnings[kind] = first, so_far + 1
            else:
                other_kinds += 1
        absent.update(
            m.text for m, reading in zip(head.measures, row.result.measures, strict=False) if reading.word == "absent"
        )
    return SweepWarnings(count, codes, warnings, other_kinds, absent)


def print_warnings_summary(summary: SweepWarnings, quiet: bool) -> None:
    """Print to standard error how many variants failed by code, and each warning with its count."""
    if quiet:
        return
    for text, count in summary.warnings.values():
        print_stderr(f"warning: heun: {text} ({_format_share(count, summary.rows)})")
    if summary.more:
        print_stderr(f"warning: heun: and {summary.more} warnings of other kinds; the rows list all")
    for measure, count in summary.absent.items():
        if count == summary.rows - summary.failure_count:
            print_stderr(f"warning: heun: {measure}: no variant has it")
    if summary.failure_count:
        codes = ", ".join(f"{count} {code}" for code, count in summary.codes.most_common())
        print_stderr(f"heun: {_format_share(summary.failure_count, summary.rows)} could not be solved: {codes}")


def _format_share(count: int, rows: int) -> str:
    """Format for how many of the variants a warning holds."""
    return "all variants" if count == rows else f"{count} of {rows} variants"
