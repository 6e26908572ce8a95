"""The events of a motion as a table, and as lines of the CSV."""

from __future__ import annotations

import math
from collections.abc import Iterator

from heuncli.output.tables.text_table import TextColumn, TextTable
from heuncli.results.results import Block, Results
from heuncli.results.results_schema import EVENTS, row_of
from heuncli.study.quantities.digits import UNKNOWN, style, trim

HEADING = "EVENTS  instants at which conditions change, and what they become"
COLUMNS = (
    TextColumn("event", "left"),
    TextColumn("condition", "left"),
    TextColumn("t [s]"),
    TextColumn("becomes", "left"),
)
ONLY_JUST = "only just: a run beside this one may not show it, as its margin is as small as its error"
MOST = 20  # instants of an event that a table shows, unless it shows all


def events_table(results: Results, *, every: bool = False) -> TextTable:
    """The table; every: with all instants."""
    rows: list[tuple[str, ...]] = []
    only_just = False
    for name, event in results.events.items():
        own = list(lines(event))
        only_just = only_just or any(not math.isfinite(error) for error in event["error"])
        shown = own if every else own[:MOST]
        begins = "true" if event["begins"] else "false"
        shown = shown or [("", f"{begins} throughout")]
        rows += [(name, event["condition"], *shown[0]), *(("", "", *line) for line in shown[1:])]
        if len(own) > len(shown):
            rows.append(("", f"{len(own) - len(shown)} more with --all", "", ""))
    return TextTable(HEADING, COLUMNS, tuple(rows), (ONLY_JUST,) if only_just else ())


def lines(event: Block) -> Iterator[tuple[str, str]]:
    """Each instant with the digits that its error leaves, and what the condition becomes there."""
    for t, error, to in zip(event["time"].tolist(), event["error"].tolist(), event["to"], strict=True):
        becomes = "true" if to else "false"
        known = math.isfinite(error)
        how = style(t, error if known else 0.5 * t)
        text = trim([how.write(t)])[0] if how.known else UNKNOWN
        yield (text, becomes) if known else (f"{t:.3g}", f"{becomes}, only just")


def csv_lines(results: Results, end: str) -> Iterator[str]:
    """A line for what each condition becomes at each instant, and one for the error of the instant."""
    for name, event in results.events.items():
        for quantity in ("to", "error"):
            unit = row_of(f"events.EVENT.{quantity}").unit()
            for t, value in zip(event["time"].tolist(), event[quantity], strict=True):
                number = repr(float(value)) if math.isfinite(value) else ""
                yield f"{t!r},{EVENTS},{name},{quantity},,{unit},{number}{end}\n"
