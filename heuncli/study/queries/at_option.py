"""The words of `--at`: instants, the first and the last, the instants of extremes of the results, and impulses."""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from typing import Literal

import numpy as np

from heuncli.base.errors import Problem, SolveError, UsageError
from heuncli.base.named_tuples import NamedTuple
from heuncli.base.spelling import suggest
from heuncli.results.results import Array, Block
from heuncli.study.model.options import require_within_run
from heuncli.study.queries.measure import MeasureRequest, NotOneNumber, find_exceeded_horizon, find_peak
from heuncli.study.queries.study import Study

EXTREMES: dict[str, Literal["abs", "max", "min"]] = {"peak": "abs", "max": "max", "min": "min"}
IMPULSE = "impulse"
FORMS = "a number, first, last, peak:PATH, max:PATH, min:PATH, impulse:NAME or impulse:NUMBER"
HINT = "for example --at peak:sections.middle.M1,0.31,last"
BEYOND_HORIZON = "--at {}: past the horizon of the run, t = {:.6g} s, results are not reliable"
HORIZON_HINT = "heun probe shows why; use an earlier instant, or end the run earlier"


class InstantRequest(NamedTuple):
    """One word of `--at`.

    time [s]: of a number
    what: a path, the name of an impulse, or its number
    """

    word: str
    kind: Literal["at", "first", "last", "extreme", "impulse"]
    what: str = ""
    time: float = 0.0


class LoadCaseInstant(NamedTuple):
    """The instant of one load case: its name, time [s], and for an impulse its number."""

    name: str
    time: float
    impulse: int | None = None


def parse(words: str) -> list[InstantRequest]:
    """Parse the value of `--at`. Raises UsageError with every word that is not understood."""
    requests, problems = list[InstantRequest](), list[Problem]()
    for word in (part.strip() for part in words.split(",")):
        request = _parse_word(word)
        if request is None:
            problems.append(Problem("bad-option", f"--at {word or words}: expected {FORMS}", hint=_suggest_word(word)))
        elif all(request.word != other.word for other in requests):
            requests.append(request)
    if problems:
        raise UsageError(*problems)
    return requests


def _parse_word(word: str) -> InstantRequest | None:
    """Parse one word of --at; None if it means nothing."""
    if word in ("first", "last"):
        return InstantRequest(word, "first" if word == "first" else "last")
    kind, colon, what = word.partition(":")
    if colon and what:
        if kind in EXTREMES:
            return InstantRequest(word, "extreme", what)
        return InstantRequest(word, "impulse", what) if kind == IMPULSE else None
    try:
        t = float(word)
    except ValueError:
        return None
    return InstantRequest(word, "at", time=t) if math.isfinite(t) else None


def _suggest_word(word: str) -> str:
    """Return a hint for a word that is not understood."""
    kind, colon, what = word.partition(":")
    if not colon and "." in word and not word[0].isdigit():
        return f"did you mean peak:{word}?"
    known = (*EXTREMES, IMPULSE) if colon else ("first", "last")
    near = suggest(kind, known, "words")
    if not near.startswith("did you mean") or (colon and not what):
        return HINT
    return near.replace("?", f":{what}?") if colon else near


def make_extreme_requests(requests: Sequence[InstantRequest]) -> list[MeasureRequest]:
    """Return the extremes among the requests, as measures of the run."""
    return [MeasureRequest(EXTREMES[one.word.partition(":")[0]], one.what) for one in requests if one.kind == "extreme"]


def find_requested_times(requests: Sequence[InstantRequest], study: Study) -> Array:
    """Return the requested instants of a run, (n,) ascending, without duplicates, including those beyond the
    horizon.
    """
    return np.unique([one.time for word in requests for one in _iter_instants(word, study)])


def find_load_case_instants(requests: Sequence[InstantRequest], study: Study) -> list[LoadCaseInstant]:
    """Return the instants of the load cases of a body. Raises NotOneNumber, and SolveError beyond the horizon."""
    found = [one for word in requests for one in _iter_instants(word, study)]
    horizon = study.results.horizon
    for one in found:
        if horizon is not None and one.time >= horizon:
            raise SolveError(Problem("beyond-horizon", BEYOND_HORIZON.format(one.name, horizon), hint=HORIZON_HINT))
    return found


def _iter_instants(request: InstantRequest, study: Study) -> Iterator[LoadCaseInstant]:
    """Yield the instants that a word means. Raises UsageError."""
    times = study.results.time
    if request.kind == IMPULSE:
        yield from _iter_impulses(request, study)
    elif request.kind == "extreme":
        yield LoadCaseInstant(request.word, _find_extreme_time(request, study))
    elif request.kind == "at":
        yield LoadCaseInstant(request.word, float(require_within_run("--at", [request.time], study.results.time)[0]))
    else:
        yield LoadCaseInstant(request.word, float(times[0 if request.kind == "first" else -1]))


def _find_extreme_time(request: InstantRequest, study: Study) -> float:
    """Return the time of an extreme of the results, searched between the samples too."""
    (measure,) = make_extreme_requests([request])
    horizon = find_exceeded_horizon(measure, study)
    if horizon is not None:
        raise SolveError(Problem("beyond-horizon", BEYOND_HORIZON.format(request.word, horizon), hint=HORIZON_HINT))
    try:
        found = find_peak(study, request.what, measure.how)
    except NotOneNumber as error:
        (problem,) = error.problems
        raise NotOneNumber(f"--at {request.word}: {problem.message}", problem.hint) from None
    if found.time is None or math.isnan(found.value) or found.open_at is not None:
        time_text = "" if found.open_at is None else f" at t = {found.open_at:.6g} s"
        hint = "release what the real machine leaves free (heun explain open), or use --least-norm"
        raise SolveError(
            Problem("open-load-case", f"--at {request.word}: it is open{time_text}, so it has no peak", hint=hint)
        )
    return found.time


def _iter_impulses(request: InstantRequest, study: Study) -> Iterator[LoadCaseInstant]:
    """Yield the impulses of the requested name, or the one of the requested number."""
    impulses = study.make_impulse_blocks()
    named = [k for k, block in enumerate(impulses) if request.what in block["names"]]
    if request.what.isdecimal() and int(request.what) < len(impulses):
        named = [int(request.what)]
    if not named:
        raise NotOneNumber(
            f"--at {request.word}: there is no such impulse in this run", _format_impulse_hint(impulses, request.what)
        )
    for k in named:
        word = request.word if len(named) == 1 else f"{request.word}#{k}"
        yield LoadCaseInstant(word, float(impulses[k]["time"]), k)


def _format_impulse_hint(impulses: Sequence[Block], word: str) -> str:
    """Name the impulses of a run, or the most similar one."""
    if not impulses:
        return "this run has no impulses: use a time, such as --at last"
    names = dict.fromkeys(name for block in impulses for name in block["names"])
    listed = ", ".join(f"{k} ({' and '.join(block['names'])})" for k, block in enumerate(impulses[:5]))
    more = f" ... {len(impulses) - 1}" if len(impulses) > 5 else ""
    near = suggest(word, names, "impulses")
    return near if near.startswith("did you mean") else f"known: {listed}{more}"
