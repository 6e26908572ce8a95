"""The numbers of a run as they are kept to be compared with later ones: a golden file, one number a line, keys sorted.

A file of format 1 holds of each quantity its ends, its extremes and eleven even instants; since format 2 also sums over
its whole course and how well the instants of its extremes are known. What one of two does not hold is not compared.

A value is a number, or a word in its place: `open` (the laws of rigid bodies leave it open), `unknown` (beside a
singular pose), `beyond` (the horizon, past which nothing is claimed).
"""

from __future__ import annotations

import json
from collections.abc import Mapping, Sequence
from typing import Annotated, Any, Final, Literal

from pydantic import BaseModel, ConfigDict, Field, ValidationError

from heuncli.base.errors import Finding

FORMAT: Final = 2  # of the file that is written
READABLE = (1, 2)  # a reader of another says so
MOST_BYTES = 64_000_000
OPEN: Final = "open"
UNKNOWN: Final = "unknown"
BEYOND: Final = "beyond"
WORDS = (OPEN, UNKNOWN, BEYOND)
Number = Annotated[float, Field(allow_inf_nan=False, strict=True)]
Value = Number | Literal["open", "unknown", "beyond"]
EVEN = 11  # instants at which every quantity is kept, evenly over the run
ANOTHER = "remove it, and let --update write it anew"


class KeptPart(BaseModel):
    """A part of what is kept; no other keys than its own."""

    model_config = ConfigDict(extra="forbid")


class KeptNumber(KeptPart):
    """One quantity over a run: its values at the ends, the extremes with their instants, and at the even instants.

    error: what its run states of it, absolute, rounding included. What is the same throughout is `constant`. A place
    stands where the extreme is one along a run of cuts. drift: its rate at the last instant, where that is an event's.
    least_at_error, greatest_at_error [s]: how far the instant may lie elsewhere. tenths: the means over uneven instants
    of each tenth of the run; mean_square: over all of these. mean, moment: integrals over the run, of the quantity and
    of it times the place in the run from -1 to 1; mean_error: what both may err by beside `error`.
    """

    unit: str
    error: float
    constant: Value | None = None
    first: Value | None = None
    last: Value | None = None
    least: Value | None = None
    least_at: Number | None = None
    least_place: str | None = None
    greatest: Value | None = None
    greatest_at: Number | None = None
    greatest_place: str | None = None
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
        """The values that decide, by their words; those at even instants by their number."""
        if self.constant is not None:
            return dict.fromkeys((*ENDS, *BOUNDS, *range(EVEN)), self.constant)
        named: dict[str | int, Value | None] = {word: getattr(self, word) for word in (*ENDS, *BOUNDS)}
        named |= dict(enumerate(self.even))
        return {word: value for word, value in named.items() if value is not None}


ENDS, BOUNDS = ("first", "last"), ("least", "greatest")


class KeptSum(KeptPart):
    """A certain sum: its factors at the first instant with their error, and its value in the samples."""

    factors: Mapping[str, Value]
    error: Number
    value: KeptNumber


class KeptEvent(KeptPart):
    """The instants of an event with their errors, and what its condition becomes there."""

    condition: str
    begins: bool
    time: list[Number]
    error: Sequence[Value]
    to: list[bool]


class KeptBlow(KeptPart):
    """A blow: its instant with its error, what struck, and its numbers."""

    time: Number
    time_error: Number
    names: list[str]
    numbers: dict[str, KeptNumber]


class KeptRun(KeptPart):
    """The numbers of one run. time: its first and last instant, the error of the last where an event ends it."""

    status: str
    model: dict[str, int]
    time: dict[str, Number]
    even_at: list[Number]
    horizon: Number | None = None
    open: list[str]
    numbers: dict[str, KeptNumber]
    certain_sums: dict[str, KeptSum] = {}
    events: dict[str, KeptEvent] = {}
    blows: int = 0
    impulses: list[KeptBlow] = []


class KeptSpec(KeptPart):
    """The spec that the numbers are of: as it was named, and its digest."""

    path: str
    sha256: str


class KeptFile(KeptPart):
    """A golden file: the numbers of a spec as it stands and of its cases; the version; digests of what was read."""

    format: Literal[1, 2]
    heun: str
    spec: KeptSpec
    tables: dict[str, str] = {}
    base: KeptRun
    cases: dict[str, KeptRun] = {}

    @property
    def holds_courses(self) -> bool:
        """Whether it holds what tells of whole courses; files of format 1 do not."""
        return self.format > 1


def text_of(kept: KeptFile) -> str:
    """The file's text: keys sorted, one number a line; what is not given is left out."""
    data = kept.model_dump(exclude_defaults=True)
    return json.dumps(data, indent=1, sort_keys=True, ensure_ascii=False, allow_nan=False) + "\n"


def read_kept(text: str) -> KeptFile:
    """The file of a text. Raises Finding [not-golden] with what is wrong with it."""
    try:
        data = json.loads(text)
    except (ValueError, RecursionError) as error:
        where = f"line {error.lineno}: " if isinstance(error, json.JSONDecodeError) else ""
        whole = "it ends before it is complete; " * text_ends_early(text, error)
        raise Finding("not-golden", f"this is not JSON: {whole}{where}{_said(error)}", ANOTHER) from None
    return of_data(data)


def of_data(data: Any) -> KeptFile:
    """The file that stands in decoded JSON. Raises Finding [not-golden]."""
    if not isinstance(data, dict) or "format" not in data:
        raise Finding("not-golden", "this is no golden file: it has no 'format'", ANOTHER)
    if data["format"] not in READABLE:
        readable = " and ".join(map(str, READABLE))
        message = f"kept in format {data['format']!r:.40}; this version reads {readable}"
        raise Finding("not-golden", message, ANOTHER)
    try:
        return KeptFile.model_validate(data)
    except ValidationError as error:
        first = error.errors(include_url=False, include_input=False)[0]
        place = ".".join(map(str, first["loc"]))
        raise Finding("not-golden", f"{place}: {first['msg']}", ANOTHER) from None


def text_ends_early(text: str, error: Exception) -> bool:
    """Whether a text was cut off: its error stands at its end, or in a string that does not end."""
    if not isinstance(error, json.JSONDecodeError):
        return False
    return error.pos >= len(text.rstrip()) - 1 or error.msg.startswith("Unterminated string")


def _said(error: Exception) -> str:
    return error.msg if isinstance(error, json.JSONDecodeError) else "nested too deeply"
