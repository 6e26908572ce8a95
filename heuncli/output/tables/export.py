"""Results as JSON (manual/results.md) and as CSV in long form; all digits, nothing rounded.

Both are made piece by piece, so that memory holds some of the numbers at a time, and of arrays that stand in a file
(stored_arrays.py) never all. Numbers go through `repr` or the C encoder of json in parts of arrays: below 1 µs each.
"""

from __future__ import annotations

import json
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import fields
from itertools import islice
from typing import Any

import numpy as np

from heuncli.base.errors import LimitError, Problem
from heuncli.base.foreign_text import shown
from heuncli.base.named_tuples import NamedTuple
from heuncli.results.cut_rows import cut_numbers
from heuncli.results.results import Array, Block, Results
from heuncli.results.results_schema import AT_A_BLOW, BLOWS, row_of
from heuncli.results.stored_arrays import AnyArray, StoredArray, in_parts
from heuncli.study.quantities.labels import Labels
from heuncli.study.quantities.series import Series, walk, walk_impulse

FORMAT = 1
MOST_NUMBERS = 200_000_000  # about 4 GB of text
AT_ONCE = 50_000  # numbers that become text together: some megabytes as Python's own
READ = 500_000  # numbers of a series that are read together: columns stand apart where they are stored
ALWAYS = frozenset({"title", "spec", "version", "model", "status", "time"})
CERTAIN_SUM = row_of("certain_sums.NUMBER.value")
CSV_COLUMNS = ("time", "kind", "name", "quantity", "component", "unit", "value")  # and cause, where shares are told
CUT_COLUMNS = ("section", "cut", "s", "side")  # behind these, where there are sections


def to_json(results: Results) -> str:
    """The results as one JSON object, as a whole."""
    return "".join(json_pieces(results))


def to_csv(results: Results, labels: Labels) -> str:
    """The results in long form, as a whole."""
    return "".join(csv_pieces(results, labels))


def json_pieces(results: Results) -> Iterator[str]:
    """The results as one JSON object: a line for each array, `null` for what is open.

    Raises LimitError where they are too many to be written: at once, before there is a piece.
    """
    _limit(results)
    return dumped({"heun": FORMAT, **present(results)})


class InstantTexts:
    """The instants that lines of CSV tell, as text; of many, in texts of so many each, for a text is smaller."""

    def __init__(self, times: Array | None) -> None:
        """times (n,) [s]; None: what holds at all instants, with an empty time."""
        parts = () if times is None else (times[i : i + AT_ONCE] for i in range(0, len(times), AT_ONCE))
        self._blocks = ["\n".join(map(repr, part.tolist())) for part in parts] or [""]

    def __iter__(self) -> Iterator[tuple[int, list[str]]]:
        """So many at a time, and the number of the first."""
        return ((k * AT_ONCE, block.split("\n")) for k, block in enumerate(self._blocks))


class CsvSeries(NamedTuple):
    """The lines of one series in CSV: kind and name, the instants it holds at, and the sections that it may be of."""

    series: Series
    kind: str
    name: str
    instants: InstantTexts
    sections: Block


def csv_pieces(results: Results, labels: Labels) -> Iterator[str]:
    """The results in long form, a line a number; an empty value is open, an empty time holds for all instants.

    Raises LimitError where they are too many to be written: at once, before there is a piece.
    """
    _limit(results)
    return _csv(results, labels)


def _csv(results: Results, labels: Labels) -> Iterator[str]:
    instants, always = InstantTexts(results.time), InstantTexts(None)
    rows = [
        CsvSeries(series, series.kind, series.name, always if series.static else instants, results.sections)
        for series in walk(results, labels)
    ]
    for number, block in enumerate(results.impulses):
        rows += _of_blow(number, block, labels)
    rows += [CsvSeries(series, series.kind, name, instants, {}) for name, series in _sums(results.certain_sums)]
    by_cause = any(row.series.cause for row in rows)
    cut = any(row.series.kind == "sections" for row in rows)
    yield ",".join([*CSV_COLUMNS, *["cause"] * by_cause, *CUT_COLUMNS * cut]) + "\n"
    for row in rows:
        ends = _cuts(row) if cut else [""] * len(row.series.components)
        yield from _lines(row, [f",{row.series.cause}{end}" if by_cause else end for end in ends])
    if results.events:
        from heuncli.output.tables.event_table import csv_lines  # where there are conditions

        yield from csv_lines(results, "," * (by_cause + len(CUT_COLUMNS) * cut))


def _of_blow(number: int, block: Block, labels: Labels) -> Iterator[CsvSeries]:
    """The rows of one blow."""
    at, sections = InstantTexts(np.array([float(block["time"])])), block.get("sections", {})
    for series in walk_impulse(block, labels):
        name = ".".join(part for part in (str(number), series.kind, series.name) if part)
        yield CsvSeries(series, BLOWS, name, at, sections)
    for name, series in _sums(block.get("certain_sums", ())):
        yield CsvSeries(series._replace(unit=AT_A_BLOW[series.unit]), BLOWS, f"{number}.certain_sums.{name}", at, {})


def _sums(sums: Sequence[Any]) -> Iterator[tuple[str, Series]]:
    """The certain sums by their numbers."""
    for number, certain in enumerate(sums):
        of_moments = not any(".force." in term for term in certain["terms"])
        values = np.atleast_1d(np.asarray(certain["value"], dtype=np.float64))[:, None]
        unit = CERTAIN_SUM.unit(turning=of_moments)
        yield str(number), Series("certain_sums", str(number), "value", unit, ("",), values)


def present(results: Results) -> dict[str, Any]:
    """The blocks that apply, in the order of manual/results.md, "Paths", by their names in the JSON."""
    blocks = {f.name: getattr(results, f.name) for f in fields(results)}
    return {name: block for name, block in blocks.items() if name in ALWAYS or len(block)}


def dump(value: Any) -> str:
    """Any small nest of plain data as JSON, laid out like the results."""
    return "".join(dumped(value))


def dumped(value: Any) -> Iterator[str]:
    """Plain data and arrays as JSON, piece by piece."""
    yield from _nested(value, "")
    yield "\n"


def _nested(value: Any, indent: str) -> Iterator[str]:
    """Nested mappings a key a line, lists of mappings too; everything else on one line."""
    if isinstance(value, dict) and value:
        yield from _members(((f"{_text(key)}: ", member) for key, member in value.items()), "{}", indent)
    elif isinstance(value, (list, tuple)) and any(isinstance(member, dict) for member in value):
        yield from _members((("", member) for member in value), "[]", indent)
    elif isinstance(value, StoredArray) or (isinstance(value, np.ndarray) and value.size > AT_ONCE):
        yield from _in_parts(value)
    else:
        yield _text(value)


def _members(members: Iterable[tuple[str, Any]], brackets: str, indent: str) -> Iterator[str]:
    inner = indent + " "
    yield brackets[0]
    for number, (label, member) in enumerate(members):
        yield f"{',' if number else ''}\n{inner}{label}"
        yield from _nested(member, inner)
    yield f"\n{indent}{brackets[1]}"


def _in_parts(values: AnyArray) -> Iterator[str]:
    """A long array, some of its rows at a time."""
    yield "["
    for number, part in enumerate(in_parts(values, AT_ONCE)):
        yield ", " * (number > 0) + _text(part)[1:-1]
    yield "]"


def _text(value: Any) -> str:
    if isinstance(value, np.ndarray):
        value = _plain(value)
    elif isinstance(value, np.generic):
        value = value.item()
    if isinstance(value, float) and not np.isfinite(value):
        value = None
    return shown(json.dumps(value, ensure_ascii=False, allow_nan=False, default=_plain))


def _plain(values: Any) -> Any:
    """Nested lists of the array's numbers, None where they are not finite, and no minus before a zero."""
    finite = np.isfinite(values)
    return (
        (values + 0.0).tolist()
        if finite.all()
        else np.where(finite, (values + 0.0).astype(object), np.array(None)).tolist()
    )


def _lines(row: CsvSeries, ends: Sequence[str]) -> Iterator[str]:
    """A line an instant and component, in texts of many; ends: what stands behind its number."""
    texts = _columns(row, ends)
    many = max(1, AT_ONCE // max(len(row.series.values), 1))
    while text := "".join(islice(texts, many)):  # of a short column a line, Python's own share would be half of it
        yield text


def _columns(row: CsvSeries, ends: Sequence[str]) -> Iterator[str]:
    """The lines of each component, in texts of at most AT_ONCE."""
    series, values = row.series, row.series.values
    many = max(1, READ // max(len(values), 1))
    for c in range(0, len(ends), many):
        columns = values[:, c : c + many].T
        for component, column, end in zip(series.components[c : c + many], columns, ends[c : c + many], strict=True):
            middle = f",{row.kind},{row.name},{series.quantity},{component},{series.unit},"
            for first, times in row.instants:
                yield "".join(_column(times, middle, column[first : first + len(times)], end))


def _column(times: Sequence[str], middle: str, column: Array, end: str) -> list[str]:
    """The lines of one component at some instants."""
    numbers, tail = list(map(repr, (column + 0.0).tolist())), f"{end}\n"
    for i in np.flatnonzero(~np.isfinite(column)).tolist():
        numbers[i] = ""
    return [f"{t}{middle}{number}{tail}" for t, number in zip(times, numbers, strict=True)]


def _cuts(row: CsvSeries) -> list[str]:
    """The last four columns of the lines of each component: section, cut of a run, distance, side; empty elsewhere."""
    series = row.series
    if series.kind != "sections":
        return [",,,,"] * len(series.components)
    name = series.name.split(".")[0]
    if not series.of_cuts or "s" not in row.sections[name]:
        return [f",{name},,,"] * len(series.components)
    s = [repr(float(at)) for at in row.sections[name]["s"]]
    side = [word or "" for word in row.sections[name].get("side") or [None] * len(s)]
    rows = [int(component.partition(".")[0]) for component in series.components]
    cuts = cut_numbers(np.asarray(row.sections[name]["s"])).tolist()
    return [f",{name},{cuts[k]},{s[k]},{side[k]}" for k in rows]


def _limit(results: Results) -> None:
    count = sum(_count(block) for block in present(results).values())
    if count > MOST_NUMBERS:
        message = f"the results hold {count:,} numbers; at most {MOST_NUMBERS:,} are written"
        raise LimitError(Problem("output-size", message, hint="fewer samples, or --only with what is needed"))


def _count(block: Any) -> int:
    if isinstance(block, np.ndarray | StoredArray):
        return block.size
    if isinstance(block, dict):
        return sum(_count(member) for member in block.values())
    return sum(_count(member) for member in block) if isinstance(block, (list, tuple)) else 1
