"""The golden file: the numbers of a run, stored to be compared with later ones, one number a line, keys sorted.

A file of format 1 holds for each quantity its ends, its extremes and eleven even instants; format 2 also holds sums
over its whole course and the errors of the instants of its extremes. What one of two files lacks is not compared.

A value is a number, or a word in its place: `open` (indeterminate by the laws of rigid bodies), `unknown` (near a
singular position), `beyond` (the horizon, after which nothing is claimed).
"""

from __future__ import annotations

import json
from collections.abc import Mapping, Sequence
from typing import Annotated, Any, Final, Literal

from pydantic import BaseModel, BeforeValidator, ConfigDict, Field, InstanceOf, PlainSerializer, ValidationError

from heuncli.base.errors import Finding
from heuncli.results.results import CutPosition

FORMAT: Final = 2  # of the files that are written
READABLE = (1, 2)  # other formats are refused
MAX_BYTES = 64_000_000
OPEN: Final = "open"
UNKNOWN: Final = "unknown"
BEYOND: Final = "beyond"
WORDS = (OPEN, UNKNOWN, BEYOND)
Number = Annotated[float, Field(allow_inf_nan=False, strict=True)]
Value = Number | Literal["open", "unknown", "beyond"]
N_EVEN = 11  # number of evenly spaced instants at which every quantity is stored
REWRITE_HINT = "delete it and recreate it with --update"


def format_place(place: CutPosition) -> str:
    """Format a place along a series of cuts as a file has it: its distance [m], and the side of the load there."""
    return " ".join([f"{place.s:.6g} m", *([place.side] if place.side else [])])


def parse_place(value: object) -> object:
    """Read a place from the text of a file. Raises ValueError."""
    if not isinstance(value, str):
        return value
    distance, unit, side = value.partition(" m")
    if not unit:
        raise ValueError("expected a distance such as '0.28 m before'")
    return CutPosition(float(distance), side.strip() or None, None)


Place = Annotated[InstanceOf[CutPosition], BeforeValidator(parse_place), PlainSerializer(format_place)]


class SnapshotPart(BaseModel):
    """A part of a golden file, which has no other keys than its own."""

    model_config = ConfigDict(extra="forbid")


class NumberSnapshot(SnapshotPart):
    """One quantity over a run: its values at the ends, the extremes with their instants, and at the even instants.

    error: as stated by its run, absolute, rounding included
    constant: the value, if it is the same throughout
    least_place, greatest_place: of an extreme along a series of cuts
    least_at_error, greatest_at_error: how far the instant may lie elsewhere [s]
    drift: its rate at the last instant, if an event ends the run
    tenths: the means over uneven instants of each tenth of the run
    mean_square: over all of these
    mean, moment: integrals over the run, of the quantity and of it times the place in the run from -1 to 1
    mean_error: error of both in addition to `error`
    """

    unit: str
    error: float
    constant: Value | None = None
    first: Value | None = None
    last: Value | None = None
    least: Value | None = None
    least_at: Number | None = None
    least_place: Place | None = None
    greatest: Value | None = None
    greatest_at: Number | None = None
    greatest_place: Place | None = None
    least_at_error: Number | None = None
    greatest_at_error: Number | None = None
    even: list[Value] = []
    drift: Number | None = None
    tenths: list[Value] = []
    mean_square: Number | None = None
    mean: Number | None = None
    moment: Number | None = None
    mean_error: Number | None = None

    @property
    def values(self) -> dict[str | int, Value]:
        """The values that are compared, by their words; those at even instants by their number."""
        if self.constant is not None:
            return dict.fromkeys((*ENDS, *BOUNDS, *range(N_EVEN)), self.constant)
        named: dict[str | int, Value | None] = {word: getattr(self, word) for word in (*ENDS, *BOUNDS)}
        named |= dict(enumerate(self.even))
        return {word: value for word, value in named.items() if value is not None}


ENDS, BOUNDS = ("first", "last"), ("least", "greatest")


class SumSnapshot(SnapshotPart):
    """A determinate sum: its factors at the first instant with their error, and its value in the samples."""

    factors: Mapping[str, Value]
    error: Number
    value: NumberSnapshot


class EventSnapshot(SnapshotPart):
    """The instants of an event with their errors, and what its condition becomes there."""

    condition: str
    begins: bool
    time: list[Number]
    error: Sequence[Value]
    to: list[bool]


class ImpactSnapshot(SnapshotPart):
    """An impact: its instant with its error, the names of what met, and its numbers."""

    time: Number
    time_error: Number
    names: list[str]
    numbers: dict[str, NumberSnapshot]


class RunSnapshot(SnapshotPart):
    """The numbers of one run.

    time: its first and last instant, and the error of the last if an event ends the run
    """

    status: str
    model: dict[str, int]
    time: dict[str, Number]
    even_at: list[Number]
    horizon: Number | None = None
    open: list[str]
    numbers: dict[str, NumberSnapshot]
    certain_sums: dict[str, SumSnapshot] = {}
    events: dict[str, EventSnapshot] = {}
    blows: int = 0
    impulses: list[ImpactSnapshot] = []


class SpecDigest(SnapshotPart):
    """The spec of the numbers: its path as given, and its digest."""

    path: str
    sha256: str


class GoldenFile(SnapshotPart):
    """A golden file: the numbers of a spec and of its load cases, heun's version, and digests of the files that were
    read.
    """

    format: Literal[1, 2]
    heun: str
    spec: SpecDigest
    tables: dict[str, str] = {}
    base: RunSnapshot
    cases: dict[str, RunSnapshot] = {}

    @property
    def has_courses(self) -> bool:
        """Whether it holds sums over whole courses; files of format 1 do not."""
        return self.format > 1


def format_golden_file(golden: GoldenFile) -> str:
    """Format the file: keys sorted, one number a line, without default values."""
    data = golden.model_dump(exclude_defaults=True)
    return json.dumps(data, indent=1, sort_keys=True, ensure_ascii=False, allow_nan=False) + "\n"


def read_golden_file(text: str) -> GoldenFile:
    """Read a golden file from its text. Raises Finding [not-golden] with what is wrong with it."""
    try:
        data = json.loads(text)
    except (ValueError, RecursionError) as error:
        line_note = f"line {error.lineno}: " if isinstance(error, json.JSONDecodeError) else ""
        cut_off_note = "the file is incomplete; " * is_text_cut_off(text, error)
        raise Finding(
            "not-golden", f"not valid JSON: {cut_off_note}{line_note}{_describe_error(error)}", REWRITE_HINT
        ) from None
    return validate_golden_data(data)


def validate_golden_data(data: Any) -> GoldenFile:
    """Return the golden file of decoded JSON. Raises Finding [not-golden]."""
    if not isinstance(data, dict) or "format" not in data:
        raise Finding("not-golden", "not a golden file: 'format' is missing", REWRITE_HINT)
    if data["format"] not in READABLE:
        readable = " and ".join(map(str, READABLE))
        message = f"golden file format {data['format']!r:.40}; this version reads {readable}"
        raise Finding("not-golden", message, REWRITE_HINT)
    try:
        return GoldenFile.model_validate(data)
    except ValidationError as error:
        first = error.errors(include_url=False, include_input=False)[0]
        place = ".".join(map(str, first["loc"]))
        raise Finding("not-golden", f"{place}: {first['msg']}", REWRITE_HINT) from None


def is_text_cut_off(text: str, error: Exception) -> bool:
    """Return whether a text was cut off: its error is at its end, or in an unterminated string."""
    if not isinstance(error, json.JSONDecodeError):
        return False
    return error.pos >= len(text.rstrip()) - 1 or error.msg.startswith("Unterminated string")


def _describe_error(error: Exception) -> str:
    return error.msg if isinstance(error, json.JSONDecodeError) else "nested too deeply"
