"""Write results as JSON (manual/results.md) and as CSV in long form, with all digits.

Both are written piece by piece, so that memory holds only part of the numbers at a time, and never a whole array that
is stored in a file (stored_arrays.py). Parts of arrays are formatted by `repr` or by the C encoder of json, which takes
less than 1 µs for each number.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from dataclasses import fields
from itertools import islice
from typing import Any

import numpy as np

from heuncli.base.errors import LimitError, Problem
from heuncli.base.named_tuples import NamedTuple
from heuncli.output.documents.as_data import AT_ONCE, FORMAT, iter_json
from heuncli.results.cut_rows import cut_indices
from heuncli.results.path_words import IMPULSE_UNITS
from heuncli.results.results import Array, Block, Results
from heuncli.results.results_schema import EVENTS, IMPULSES, find_row
from heuncli.results.stored_arrays import StoredArray
from heuncli.study.quantities.channels import Channel, iter_channels, iter_impulse_channels
from heuncli.study.quantities.labels import Labels

MOST_NUMBERS = 200_000_000  # about 4 GB of text
READ = 500_000  # numbers of a channel read together, as stored columns are not contiguous
REQUIRED_KEYS = frozenset({"title", "spec", "version", "model", "status", "time"})
CERTAIN_SUM = find_row("certain_sums.NUMBER.value")
CSV_COLUMNS = ("time", "kind", "name", "quantity", "component", "unit", "value")  # then cause, if there are shares
CUT_COLUMNS = ("section", "cut", "s", "side")  # after these, if there are sections


def to_json(results: Results) -> str:
    """Return the results as one JSON object."""
    return "".join(iter_json_pieces(results))


def to_csv(results: Results, labels: Labels) -> str:
    """Return the results as CSV in long form."""
    return "".join(iter_csv_pieces(results, labels))


def iter_json_pieces(results: Results) -> Iterator[str]:
    """Yield the results as one JSON object in pieces: a line for each array, `null` for what is indeterminate.

    Raises LimitError before the first piece if there are too many numbers.
    """
    _require_writable_size(results)
    return iter_json({"heun": FORMAT, **collect_blocks(results)})


class InstantTexts:
    """The instants of CSV lines as text; many instants are joined in blocks, which take less memory."""

    def __init__(self, times: Array | None) -> None:
        """times (n,) [s]; None for a quantity that holds at all instants, whose time is empty."""
        parts = () if times is None else (times[i : i + AT_ONCE] for i in range(0, len(times), AT_ONCE))
        self._blocks = ["\n".join(map(repr, part.tolist())) for part in parts] or [""]

    def __iter__(self) -> Iterator[tuple[int, list[str]]]:
        """Yield the index of the first instant of each block, and the texts of the block."""
        return ((k * AT_ONCE, block.split("\n")) for k, block in enumerate(self._blocks))


class CsvChannel(NamedTuple):
    """The CSV lines of one channel: its kind and name, its instants, and the sections to which it may belong."""

    channel: Channel
    kind: str
    name: str
    instants: InstantTexts
    sections: Block


def iter_csv_pieces(results: Results, labels: Labels) -> Iterator[str]:
    """Yield the results in long form in pieces, a line for each number.

    An empty value is indeterminate, an empty time holds for all instants. Raises LimitError before the first piece if
    there are too many numbers.
    """
    _require_writable_size(results)
    return _iter_csv(results, labels)


def _iter_csv(results: Results, labels: Labels) -> Iterator[str]:
    instants, no_instants = InstantTexts(results.time), InstantTexts(None)
    rows = [
        CsvChannel(
            channel, channel.kind, channel.name, no_instants if channel.is_static else instants, results.sections
        )
        for channel in iter_channels(results, labels)
    ]
    for number, block in enumerate(results.impulses):
        rows += _iter_impact_channels(number, block, labels)
    rows += [
        CsvChannel(channel, channel.kind, name, instants, {})
        for name, channel in _iter_sum_channels(results.certain_sums)
    ]
    by_cause = any(row.channel.cause for row in rows)
    has_sections = any(row.channel.kind == "sections" for row in rows)
    yield ",".join([*CSV_COLUMNS, *["cause"] * by_cause, *CUT_COLUMNS * has_sections]) + "\n"
    for row in rows:
        ends = _format_cut_columns(row) if has_sections else [""] * len(row.channel.components)
        yield from _iter_csv_text(row, [f",{row.channel.cause}{end}" if by_cause else end for end in ends])
    if results.events:
        yield from _iter_event_lines(results, "," * (by_cause + len(CUT_COLUMNS) * has_sections))


def _iter_impact_channels(number: int, block: Block, labels: Labels) -> Iterator[CsvChannel]:
    """Yield the channels of one impact."""
    instant, sections = InstantTexts(np.array([float(block["time"])])), block.get("sections", {})
    for channel in iter_impulse_channels(block, labels):
        name = ".".join(part for part in (str(number), channel.kind, channel.name) if part)
        yield CsvChannel(channel, IMPULSES, name, instant, sections)
    for name, channel in _iter_sum_channels(block.get("certain_sums", ())):
        yield CsvChannel(
            channel._replace(unit=IMPULSE_UNITS[channel.unit]), IMPULSES, f"{number}.certain_sums.{name}", instant, {}
        )


def _iter_sum_channels(sums: Sequence[Any]) -> Iterator[tuple[str, Channel]]:
    """Yield the determinate sums with their numbers as names."""
    for number, certain_sum in enumerate(sums):
        of_moments = not any(".force." in term for term in certain_sum["terms"])
        values = np.atleast_1d(np.asarray(certain_sum["value"], dtype=np.float64))[:, None]
        unit = certain_sum.get("unit") or CERTAIN_SUM.select_unit(turning=of_moments)
        yield str(number), Channel("certain_sums", str(number), "value", unit, ("",), values)


def collect_blocks(results: Results) -> dict[str, Any]:
    """Return the blocks that are not empty by their JSON keys, in the order of manual/results.md, "Paths"."""
    blocks = {f.name: getattr(results, f.name) for f in fields(results)}
    return {name: block for name, block in blocks.items() if name in REQUIRED_KEYS or len(block)}


def _iter_csv_text(row: CsvChannel, ends: Sequence[str]) -> Iterator[str]:
    """Yield the lines of a channel, a line for each instant and component, joined in long texts.

    ends: of each component, the text after its number
    """
    texts = _iter_column_text(row, ends)
    lines_per_text = max(1, AT_ONCE // max(len(row.channel.values), 1))
    while text := "".join(
        islice(texts, lines_per_text)
    ):  # of a short column a line, Python's own share would be half of it
        yield text


def _iter_column_text(row: CsvChannel, ends: Sequence[str]) -> Iterator[str]:
    """Yield the lines of each component in texts of at most AT_ONCE lines."""
    channel, values = row.channel, row.channel.values
    columns_per_read = max(1, READ // max(len(values), 1))
    for c in range(0, len(ends), columns_per_read):
        columns = values[:, c : c + columns_per_read].T
        for component, column, end in zip(
            channel.components[c : c + columns_per_read], columns, ends[c : c + columns_per_read], strict=True
        ):
            middle = f",{row.kind},{row.name},{channel.quantity},{component},{channel.unit},"
            for first, times in row.instants:
                yield "".join(_format_column(times, middle, column[first : first + len(times)], end))


def _format_column(times: Sequence[str], middle: str, column: Array, end: str) -> list[str]:
    """Format the lines of one component at some instants."""
    numbers, tail = list(map(repr, (column + 0.0).tolist())), f"{end}\n"
    for i in np.flatnonzero(~np.isfinite(column)).tolist():
        numbers[i] = ""
    return [f"{t}{middle}{number}{tail}" for t, number in zip(times, numbers, strict=True)]


def _format_cut_columns(row: CsvChannel) -> list[str]:
    """Format the last four columns of each component: section, cut of a run, distance, side; empty if it is of no
    section.
    """
    channel = row.channel
    if channel.kind != "sections":
        return [",,,,"] * len(channel.components)
    name = channel.name.split(".")[0]
    if not channel.has_cuts or "s" not in row.sections[name]:
        return [f",{name},,,"] * len(channel.components)
    s = [repr(float(position)) for position in row.sections[name]["s"]]
    side = [word or "" for word in row.sections[name].get("side") or [None] * len(s)]
    rows = [int(component.partition(".")[0]) for component in channel.components]
    cuts = cut_indices(np.asarray(row.sections[name]["s"])).tolist()
    return [f",{name},{cuts[k]},{s[k]},{side[k]}" for k in rows]


def _require_writable_size(results: Results) -> None:
    count = sum(_count_numbers(block) for block in collect_blocks(results).values())
    if count > MOST_NUMBERS:
        message = f"the results hold {count:,} numbers; at most {MOST_NUMBERS:,} are written"
        raise LimitError(Problem("output-size", message, hint="fewer samples, or --only with what is needed"))


def _count_numbers(block: Any) -> int:
    if isinstance(block, np.ndarray | StoredArray):
        return block.size
    if isinstance(block, dict):
        return sum(_count_numbers(member) for member in block.values())
    return sum(_count_numbers(member) for member in block) if isinstance(block, (list, tuple)) else 1


def _iter_event_lines(results: Results, end: str) -> Iterator[str]:
    """Yield for each instant of a condition a line with its new value and a line with the error of the instant.

    end: text of the remaining columns
    """
    for name, event in results.events.items():
        for quantity in ("to", "error"):
            unit = find_row(f"events.EVENT.{quantity}").select_unit()
            for t, value in zip(event["time"].tolist(), event[quantity], strict=True):
                number = repr(float(value)) if math.isfinite(value) else ""
                yield f"{t!r},{EVENTS},{name},{quantity},,{unit},{number}{end}\n"
