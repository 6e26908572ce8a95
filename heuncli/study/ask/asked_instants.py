"""The words of `--at`: instants, the first and the last, those of extremes of the results, and blows."""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from typing import Literal

import numpy as np

from heuncli.base.errors import Problem, SolveError, UsageError
from heuncli.base.named_tuples import NamedTuple
from heuncli.base.nearest import did_you_mean
from heuncli.results.results import Array, Block
from heuncli.study.ask.asked_values import within_run
from heuncli.study.ask.measure import MeasureRequest, NotOneNumber, lost_from, peak
from heuncli.study.ask.study import Study

EXTREMES: dict[str, Literal["abs", "max", "min"]] = {"peak": "abs", "max": "max", "min": "min"}
IMPULSE = "impulse"
FORMS = "a number, first, last, peak:PATH, max:PATH, min:PATH, impulse:NAME or impulse:NUMBER"
HINT = "such as --at peak:sections.middle.M1,0.31,last"
SO_LATE = "--at {}: beyond the horizon of the run, t = {:.6g} s, nothing is claimed"
SHORTEN = "heun probe tells why; let the run end before, or take an instant before"


class AskedInstant(NamedTuple):
    """A word of `--at`: at [s] of a number; what: a path, the name of a blow, or its number."""

    word: str
    kind: Literal["at", "first", "last", "extreme", "impulse"]
    what: str = ""
    at: float = 0.0


class TakenInstant(NamedTuple):
    """When a case is taken: its name, the instant [s], and of a blow its number."""

    name: str
    time: float
    blow: int | None = None


def parse(words: str) -> list[AskedInstant]:
    """The instants that `--at` asks for. Raises UsageError with all words that ask for none."""
    found, problems = list[AskedInstant](), list[Problem]()
    for word in (part.strip() for part in words.split(",")):
        one = _parsed(word)
        if one is None:
            problems.append(Problem("bad-option", f"--at {word or words}: expected {FORMS}", hint=_meant(word)))
        elif all(one.word != other.word for other in found):
            found.append(one)
    if problems:
        raise UsageError(*problems)
    return found


def _parsed(word: str) -> AskedInstant | None:
    if word in ("first", "last"):
        return AskedInstant(word, "first" if word == "first" else "last")
    kind, colon, what = word.partition(":")
    if colon and what:
        if kind in EXTREMES:
            return AskedInstant(word, "extreme", what)
        return AskedInstant(word, "impulse", what) if kind == IMPULSE else None
    try:
        t = float(word)
    except ValueError:
        return None
    return AskedInstant(word, "at", at=t) if math.isfinite(t) else None


def _meant(word: str) -> str:
    """What may be meant by a word that asks for nothing."""
    kind, colon, what = word.partition(":")
    if not colon and "." in word and not word[0].isdigit():
        return f"did you mean peak:{word}?"
    known = (*EXTREMES, IMPULSE) if colon else ("first", "last")
    near = did_you_mean(kind, known, "words")
    if not near.startswith("did you mean") or (colon and not what):
        return HINT
    return near.replace("?", f":{what}?") if colon else near


def measures(asked: Sequence[AskedInstant]) -> list[MeasureRequest]:
    """The extremes among them, as measures of the run."""
    return [MeasureRequest(EXTREMES[one.word.partition(":")[0]], one.what) for one in asked if one.kind == "extreme"]


def times_of(asked: Sequence[AskedInstant], study: Study) -> Array:
    """The instants of a run that are asked for, (n,) ascending, each once, also those of which nothing is claimed."""
    return np.unique([one.time for word in asked for one in _taken(word, study)])


def taken(asked: Sequence[AskedInstant], study: Study) -> list[TakenInstant]:
    """When the cases of a body are taken. Raises NotOneNumber, SolveError beyond the horizon."""
    found = [one for word in asked for one in _taken(word, study)]
    horizon = study.results.horizon
    for one in found:
        if horizon is not None and one.time >= horizon:
            raise SolveError(Problem("beyond-horizon", SO_LATE.format(one.name, horizon), hint=SHORTEN))
    return found


def _taken(asked: AskedInstant, study: Study) -> Iterator[TakenInstant]:
    times = study.results.time
    if asked.kind == IMPULSE:
        yield from _blows(asked, study)
    elif asked.kind == "extreme":
        yield TakenInstant(asked.word, _of_extreme(asked, study))
    elif asked.kind == "at":
        yield TakenInstant(asked.word, float(within_run("--at", [asked.at], study.results.time)[0]))
    else:
        yield TakenInstant(asked.word, float(times[0 if asked.kind == "first" else -1]))


def _of_extreme(asked: AskedInstant, study: Study) -> float:
    """When a number of the results is at its extreme, searched between the samples too."""
    (measure,) = measures([asked])
    horizon = lost_from(measure, study)
    if horizon is not None:
        raise SolveError(Problem("beyond-horizon", SO_LATE.format(asked.word, horizon), hint=SHORTEN))
    try:
        found = peak(study, asked.what, measure.how)
    except NotOneNumber as error:
        (problem,) = error.problems
        raise NotOneNumber(f"--at {asked.word}: {problem.message}", problem.hint) from None
    if found.at is None or math.isnan(found.value) or found.open_at is not None:
        at = "" if found.open_at is None else f" at t = {found.open_at:.6g} s"
        hint = "draw what the machine leaves loose (heun explain open), or --least-norm"
        raise SolveError(Problem("open-load-case", f"--at {asked.word}: it is open{at}, so it has no peak", hint=hint))
    return found.at


def _blows(asked: AskedInstant, study: Study) -> Iterator[TakenInstant]:
    """The blows of a name, or that of a number."""
    blows = study.impulses()
    named = [k for k, block in enumerate(blows) if asked.what in block["names"]]
    if asked.what.isdecimal() and int(asked.what) < len(blows):
        named = [int(asked.what)]
    if not named:
        raise NotOneNumber(f"--at {asked.word}: there is no such blow in this run", _known(blows, asked.what))
    for k in named:
        word = asked.word if len(named) == 1 else f"{asked.word}#{k}"
        yield TakenInstant(word, float(blows[k]["time"]), k)


def _known(blows: Sequence[Block], word: str) -> str:
    if not blows:
        return "nothing is struck in it: times take cases, such as --at last"
    names = dict.fromkeys(name for block in blows for name in block["names"])
    listed = ", ".join(f"{k} ({' and '.join(block['names'])})" for k, block in enumerate(blows[:5]))
    more = f" ... {len(blows) - 1}" if len(blows) > 5 else ""
    near = did_you_mean(word, names, "blows")
    return near if near.startswith("did you mean") else f"known: {listed}{more}"
