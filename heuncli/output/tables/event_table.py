"""The events of a motion as a table and as lines of the CSV."""

from __future__ import annotations

import math
from collections.abc import Iterator

from heuncli.output.documents.document import OutputColumn, OutputTable
from heuncli.results.results import Block, Results
from heuncli.results.results_schema import EVENTS, find_row
from heuncli.study.quantities.digits import UNKNOWN, choose_style, trim_zeros

HEADING = "EVENTS  times at which conditions change, and their new values"
COLUMNS = (
    OutputColumn("event", "text"),
    OutputColumn("condition", "text"),
    OutputColumn("t [s]"),
    OutputColumn("becomes", "text"),
)
ONLY_JUST = "marginal: the margin is as small as the error, so a slightly different run may not show it"
MAX_INSTANTS = 20  # instants of an event in a table, unless all are requested


def make_events_table(results: Results, *, all_instants: bool = False) -> OutputTable:
    """Make the table of events; all_instants: show every instant of each event."""
    rows: list[tuple[str, ...]] = []
    only_just = False
    for name, event in results.events.items():
        event_lines = list(iter_event_lines(event))
        only_just = only_just or any(not math.isfinite(error) for error in event["error"])
        shown = event_lines if all_instants else event_lines[:MAX_INSTANTS]
        begins = "true" if event["begins"] else "false"
        shown = shown or [("", f"{begins} at all times")]
        rows += [(name, event["condition"], *shown[0]), *(("", "", *line) for line in shown[1:])]
        if len(event_lines) > len(shown):
            rows.append(("", f"{len(event_lines) - len(shown)} more with --all", "", ""))
    return OutputTable(HEADING, COLUMNS, tuple(rows), (ONLY_JUST,) if only_just else ())


def iter_event_lines(event: Block) -> Iterator[tuple[str, str]]:
    """Yield each instant with the digits that its error leaves, and what the condition becomes there."""
    for t, error, to in zip(event["time"].tolist(), event["error"].tolist(), event["to"], strict=True):
        becomes = "true" if to else "false"
        known = math.isfinite(error)
        number_style = choose_style(t, error if known else 0.5 * t)
        text = trim_zeros([number_style.write(t)])[0] if number_style.is_known else UNKNOWN
        yield (text, becomes) if known else (f"{t:.3g}", f"{becomes}, marginal")


def iter_csv_lines(results: Results, end: str) -> Iterator[str]:
    """Yield for each instant of a condition a line with its new value and a line with the error of the instant.

    end: text of the remaining columns
    """
    for name, event in results.events.items():
        for quantity in ("to", "error"):
            unit = find_row(f"events.EVENT.{quantity}").select_unit()
            for t, value in zip(event["time"].tolist(), event[quantity], strict=True):
                number = repr(float(value)) if math.isfinite(value) else ""
                yield f"{t!r},{EVENTS},{name},{quantity},,{unit},{number}{end}\n"
