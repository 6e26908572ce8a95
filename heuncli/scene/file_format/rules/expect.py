"""Expectations: of results that there are, in their dimension and shape, at instants of the output."""

from __future__ import annotations

from bisect import bisect_left
from collections.abc import Iterator
from typing import TYPE_CHECKING, Any

from heuncli.base import tolerances
from heuncli.base import units as u
from heuncli.results.results_schema import INDEX, INSTANT, beside_magnitudes, spelled_first
from heuncli.scene.expressions.programs import Expression
from heuncli.scene.file_format import format as f
from heuncli.scene.file_format.rules.registry import DraftDocument, Path_, Violation, rule
from heuncli.scene.file_format.semantics import instants_of, type_of

if TYPE_CHECKING:
    from heuncli.results.results_schema import Shape
    from heuncli.scene.file_format.rules.outcome import NumberKind

RAGGED = -1  # the length of a list whose members have different ones
Lengths = tuple[int | None, ...]  # of nested lists, the outer first; None: not known before the run


def outcomes(draft: DraftDocument) -> Iterator[tuple[Path_, f.ExpectEntry, NumberKind | None]]:
    """Every expectation with the quantity at its path; None where there is none."""
    if draft.document.expect:
        from heuncli.scene.file_format.rules.outcome import (  # a run without expectations starts faster
            NumberKind,
            reached_in,
        )

        for i, item in draft.document.expect.items():
            found = reached_in(draft, item.of)
            yield ("expect", i), item, found if isinstance(found, NumberKind) else None


@rule("expect-path")
def expect_path(draft: DraftDocument) -> Iterator[Violation]:
    """`of` leads to a result."""
    if draft.document.expect:
        from heuncli.scene.file_format.rules.outcome import runs_of, wrong_path  # as in outcomes

        runs = runs_of(draft)
        for i, item in draft.document.expect.items():
            if (wrong := wrong_path(item.of, draft.names, runs)) is not None:
                yield Violation(("expect", i, "of"), *wrong)


@rule("expect-form")
def expect_form(draft: DraftDocument) -> Iterator[Violation]:
    """An expectation is at an instant or at a peak, a number or a list, in the dimension of the result."""
    for path, item, quantity in outcomes(draft):
        if item.at is not None and item.peak is not None:
            yield Violation(
                (*path, "peak"), "both at and peak", "at is one instant, peak is over all of them", key=True
            )
        if RAGGED in lengths_of(item.is_):
            yield Violation((*path, "is"), "lists of different lengths", "[1, 2, 3], or [[1, 0], [0, 1]]")
        if item.rel is not None and item.rel >= 1.0:
            message = f"rel {item.rel:g} is not below 1: 0 would pass for anything"
            yield Violation((*path, "rel"), message, "it is a share of the number expected: rel: 1e-6; or give abs")
        yield from bounds(path, item)
        if quantity is not None:
            yield from over_instants(path, item, quantity)
            yield from dimensions((*path, "is"), item.is_, quantity.dimensions)
            for key in ("abs", "below", "above"):
                yield from dimensions((*path, key), getattr(item, key), quantity.dimensions)


def over_instants(path: Path_, item: f.ExpectEntry, quantity: NumberKind) -> Iterator[Violation]:
    """Only what runs over the instants is one at one of them or has a peak, and only one number has an extreme."""
    for key in ("at", "peak") if not quantity.timed else ():
        if getattr(item, key) is not None:
            yield Violation((*path, key), f"{item.of} does not run over the instants", f"leave {key} out", key=True)
    if item.peak is not None or item.is_bounded:
        several = beside_magnitudes(quantity.axes)
        if several and several != (INDEX,):  # of a list all its numbers are bounded
            hint = f"name one of its numbers, as {item.of}{spelled_first(quantity.axes)}"
            yield Violation((*path, "of"), f"{item.of} is {described(tuple(x.size for x in quantity.axes))}", hint)


def bounds(path: Path_, item: f.ExpectEntry) -> Iterator[Violation]:
    """Bounds stand alone and leave room between them."""
    if not item.is_bounded:
        return
    first = "below" if item.below is not None else "above"
    for key in ("is", "rel", "abs"):
        if (key if key != "is" else "is_") in item.model_fields_set:
            hint = "is: beside rel: and abs:, or below: and above: alone" if key == "is" else "put it into the bound"
            yield Violation((*path, key), f"'{key}' beside '{first}'", hint, key=True)
    low, high = (None if x is None else x.constant for x in (item.above, item.below))
    if low is not None and high is not None and low >= high:
        hint = "what lies between two numbers is above the lower and below the higher one"
        yield Violation((*path, "above"), f"nothing is above {low:g} and below {high:g}", hint, key=True)


def dimensions(path: Path_, value: Any, known: tuple[u.Dimension, ...]) -> Iterator[Violation]:
    """Numbers written with a unit of another dimension."""
    if isinstance(value, tuple):
        for i, member in enumerate(value):
            yield from dimensions((*path, i), member, known)
    elif isinstance(value, Expression) and value.dimension is not None and known and value.dimension not in known:
        expected = " or ".join(u.describe(dimension) for dimension in known)
        message = f"'{value.source.strip()}' is {u.describe(value.dimension)}, expected {expected}"
        units = " or ".join(u.si_unit(dimension) for dimension in known)
        yield Violation(path, message, f"a number without a unit is taken in {units}")


@rule("expect-instants", for_check=True)
def expect_instants(draft: DraftDocument) -> Iterator[Violation]:
    """An expectation fits the instants of the output: `at` is one of them, `is` has as many numbers as the result."""
    document = draft.document
    instants = instants_of(document) if type_of(document) == "motion" else (0.0,)
    if not instants or document.analysis.type == "impulse" or "analysis" in draft.unread:
        return
    count, ascending = output_instants(draft, len(instants)), sorted(instants)
    for path, item, quantity in outcomes(draft):
        if quantity is None or not quantity.known:
            continue
        if quantity.instant is not None and quantity.instant >= len(instants):
            message = f"{item.of} is of instant {quantity.instant}, but the output has {count_of(len(instants))}"
            yield Violation((*path, "of"), message, "they count from 0; or leave the number out, and give at: a time")
            continue
        if item.at is not None and quantity.timed:
            nearest = nearest_of(ascending, item.at)
            may_end_there = count is None and 0.0 < item.at < ascending[-1]  # where a run ends is known after it
            if not may_end_there and abs(nearest - item.at) > tolerances.SAME_INSTANT * max(instants[-1], abs(item.at)):
                message = f"{item.at:.10g} s is not an instant of the output; the nearest is {nearest:.10g} s"
                yield Violation((*path, "at"), message, "add it to analysis.times, or choose other samples")
                continue
        if item.is_ is not None and not item.is_bounded:
            yield from sizes((*path, "is"), item, quantity, count)


def nearest_of(ascending: list[float], t: float) -> float:
    """The instant nearest to a time, of those in ascending order; the earlier of two as near."""
    place = bisect_left(ascending, t)
    return min(ascending[max(place - 1, 0) : place + 1], key=lambda instant: abs(instant - t))


def count_of(instants: int) -> str:
    """A number of instants in words."""
    return "one alone, 0" if instants == 1 else f"{instants}, 0 to {instants - 1}"


def output_instants(draft: DraftDocument, asked: int) -> int | None:
    """How many instants the output will have; None where a rope or a condition may end the run before."""
    rods = [joint for joint in draft.document.joints.values() if isinstance(joint, f.RodJoint)]
    may_stop = any(rod.tension_only and rod.restitution is None for rod in rods)
    curves = [joint for joint in draft.document.joints.values() if isinstance(joint, f.CurveJoint)]
    may_stop |= any(curve.one_sided and curve.restitution is None for curve in curves)
    may_stop |= draft.document.analysis.until is not None
    return None if may_stop and asked > 1 else asked


def sizes(path: Path_, item: f.ExpectEntry, quantity: NumberKind, instants: int | None) -> Iterator[Violation]:
    """As many numbers as the result has there, in the same lists."""
    over_instants = quantity.timed and item.at is None and item.peak is None and instants != 1
    axes: Shape = () if item.peak is not None else quantity.axes
    at_one = tuple(axis.size for axis in axes)
    lengths: Lengths = (instants, *at_one) if over_instants else at_one
    given = lengths_of(item.is_)
    if RAGGED in given or fits(given, lengths):
        return
    if over_instants and fits(given, at_one):
        yield Violation(path, f"{described(given)} for {item.of} at all instants", "give at: an instant, or peak: max")
    else:
        one = spelled_first((INSTANT, *axes) if over_instants else axes)
        hint = f"name one of its numbers, as {item.of}{one}" if lengths else None
        message = f"{described(given)} for {item.of}, which is {described(lengths)}"
        yield Violation(path, message, hint or "give one number")


def fits(given: Lengths, expected: Lengths) -> bool:
    """Whether the lists have the expected lengths, where these are known."""
    return len(given) == len(expected) and all(b is None or a == b for a, b in zip(given, expected, strict=True))


def lengths_of(value: Any) -> Lengths:
    """Lengths of the lists in which numbers are given, the outer first."""
    if not isinstance(value, tuple):
        return ()
    inner = {lengths_of(member) for member in value}
    return (len(value), *inner.pop()) if len(inner) == 1 else (RAGGED,)


def described(lengths: Lengths) -> str:
    """Lengths of lists in words."""
    if not lengths:
        return "one number"
    return "a list of " + " lists of ".join("some" if length is None else str(length) for length in lengths)
