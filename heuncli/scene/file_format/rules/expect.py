"""Rules about expectations: of results that exist, in their dimension and shape, at output instants.

Rules about expected curves: one number over the instants, against time or another number, in their units.
"""

from __future__ import annotations

from bisect import bisect_left
from collections.abc import Iterator
from typing import TYPE_CHECKING, Any

from heuncli.base import tolerances
from heuncli.base import units as u
from heuncli.base.errors import Finding
from heuncli.results.results_schema import INDEX, INSTANT, first_element_suffix, independent_axes
from heuncli.scene.expressions.programs import Expression
from heuncli.scene.file_format import format as f
from heuncli.scene.file_format import format_joints as fj
from heuncli.scene.file_format.rules.registry import DraftDocument, Path_, Violation, rule
from heuncli.scene.file_format.semantics import find_analysis_type, list_instants

if TYPE_CHECKING:
    from heuncli.results.results_schema import Shape
    from heuncli.scene.file_format.rules.outcome import NumberKind


# Expect

RAGGED = -1  # the length of a list whose members have different ones
Lengths = tuple[int | None, ...]  # of nested lists, the outer first; None: not known before the run


def iter_expected_quantities(draft: DraftDocument) -> Iterator[tuple[Path_, f.ExpectEntry, NumberKind | None]]:
    """Yield every expectation with the quantity at its path, or None."""
    if draft.document.expect:
        from heuncli.scene.file_format.rules.outcome import (  # a run without expectations starts faster
            NumberKind,
            find_path_target,
        )

        for i, item in draft.document.expect.items():
            target = find_path_target(draft, item.of)
            yield ("expect", i), item, target if isinstance(target, NumberKind) else None


@rule("expect-path")
def check_expected_path(draft: DraftDocument) -> Iterator[Violation]:
    """`of` leads to a result."""
    if draft.document.expect:
        from heuncli.scene.file_format.rules.outcome import find_cut_series, find_path_error  # as in outcomes

        cut_series = find_cut_series(draft)
        for i, item in draft.document.expect.items():
            if (wrong := find_path_error(item.of, draft.names, cut_series)) is not None:
                yield Violation(("expect", i, "of"), *wrong)


@rule("expect-form")
def check_expected_form(draft: DraftDocument) -> Iterator[Violation]:
    """An expectation is at an instant or at a peak, a number or a list, in the dimension of the result."""
    for path, item, quantity in iter_expected_quantities(draft):
        if item.at is not None and item.peak is not None:
            yield Violation(
                (*path, "peak"), "at and peak are both given", "at is one instant, peak is over all of them", key=True
            )
        if RAGGED in list_lengths(item.is_):
            yield Violation((*path, "is"), "lists of different lengths", "write [1, 2, 3], or [[1, 0], [0, 1]]")
        if item.rel is not None and item.rel >= 1.0:
            message = f"rel {item.rel:g} is not below 1: even 0 would pass"
            yield Violation((*path, "rel"), message, "it is relative to the expected number: rel: 1e-6; or give abs")
        yield from check_bounds(path, item)
        if quantity is not None:
            yield from check_time_keys(path, item, quantity)
            yield from check_dimensions((*path, "is"), item.is_, quantity.dimensions)
            for key in ("abs", "below", "above"):
                yield from check_dimensions((*path, key), getattr(item, key), quantity.dimensions)


def check_time_keys(path: Path_, item: f.ExpectEntry, quantity: NumberKind) -> Iterator[Violation]:
    """Only a result over time has a value at an instant or a peak, and only a single number has an extreme."""
    for key in ("at", "peak") if not quantity.is_timed else ():
        if getattr(item, key) is not None:
            yield Violation((*path, key), f"{item.of} does not change in time", f"leave {key} out", key=True)
    if item.peak is not None or item.is_bounded:
        other_axes = independent_axes(quantity.axes)
        if other_axes and other_axes != (INDEX,):  # bounds of a list apply to all its numbers
            hint = f"give one of its numbers, such as {item.of}{first_element_suffix(quantity.axes)}"
            yield Violation(
                (*path, "of"), f"{item.of} is {describe_lengths(tuple(x.size for x in quantity.axes))}", hint
            )


def check_bounds(path: Path_, item: f.ExpectEntry) -> Iterator[Violation]:
    """Bounds stand alone, and the lower one is below the upper one."""
    if not item.is_bounded:
        return
    bound_key = "below" if item.below is not None else "above"
    for key in ("is", "rel", "abs"):
        if (key if key != "is" else "is_") in item.model_fields_set:
            hint = (
                "give is: with rel: and abs:, or below: and above: alone" if key == "is" else "include it in the bound"
            )
            yield Violation((*path, key), f"'{key}' given together with '{bound_key}'", hint, key=True)
    low, high = (None if x is None else x.constant for x in (item.above, item.below))
    if low is not None and high is not None and low >= high:
        hint = "for a range give above: (lower number) and below: (higher number)"
        yield Violation((*path, "above"), f"no number is above {low:g} and below {high:g}", hint, key=True)


def check_dimensions(path: Path_, value: Any, allowed: tuple[u.Dimension, ...]) -> Iterator[Violation]:
    """Yield a violation for each number with a unit of another dimension."""
    if isinstance(value, tuple):
        for i, member in enumerate(value):
            yield from check_dimensions((*path, i), member, allowed)
    elif isinstance(value, Expression) and value.dimension is not None and allowed and value.dimension not in allowed:
        expected = " or ".join(u.describe(dimension) for dimension in allowed)
        message = f"'{value.source.strip()}' is {u.describe(value.dimension)}, expected {expected}"
        units = " or ".join(u.si_unit(dimension) for dimension in allowed)
        yield Violation(path, message, f"a number without a unit is taken to be in {units}")


@rule("expect-instants", for_check=True)
def check_expected_instants(draft: DraftDocument) -> Iterator[Violation]:
    """An expectation fits the output instants: `at` is one of them, `is` has as many numbers as the result."""
    document = draft.document
    instants = list_instants(document) if find_analysis_type(document) == "motion" else (0.0,)
    if not instants or document.analysis.type == "impulse" or "analysis" in draft.unread:
        return
    count, ascending = count_output_instants(draft, len(instants)), sorted(instants)
    for path, item, quantity in iter_expected_quantities(draft):
        if quantity is None or not quantity.is_known:
            continue
        if quantity.instant is not None and quantity.instant >= len(instants):
            message = (
                f"{item.of} refers to instant {quantity.instant}, but the output has {format_count(len(instants))}"
            )
            yield Violation(
                (*path, "of"), message, "instants count from 0; or leave the number out, and give at: a time"
            )
            continue
        if item.at is not None and quantity.is_timed:
            nearest_instant = find_nearest(ascending, item.at)
            may_end_before = count is None and 0.0 < item.at < ascending[-1]  # the run may end earlier
            if not may_end_before and abs(nearest_instant - item.at) > tolerances.SAME_INSTANT * max(
                instants[-1], abs(item.at)
            ):
                message = f"{item.at:.10g} s is not an output time; the nearest is {nearest_instant:.10g} s"
                yield Violation((*path, "at"), message, "add it to analysis.times, or change samples")
                continue
        if item.is_ is not None and not item.is_bounded:
            yield from check_sizes((*path, "is"), item, quantity, count)


def find_nearest(ascending: list[float], time: float) -> float:
    """Return the instant nearest to a time, from an ascending list; the earlier of two at the same distance."""
    index = bisect_left(ascending, time)
    return min(ascending[max(index - 1, 0) : index + 1], key=lambda instant: abs(instant - time))


def format_count(instants: int) -> str:
    """Format a number of instants with the range of their indices."""
    return "only one, 0" if instants == 1 else f"{instants}, 0 to {instants - 1}"


def count_output_instants(draft: DraftDocument, requested: int) -> int | None:
    """Return how many instants the output will have; None if a rope, a path or a condition may end the run earlier."""
    rods = [joint for joint in draft.document.joints.values() if isinstance(joint, fj.RodJoint)]
    may_stop = any(rod.tension_only and rod.restitution is None for rod in rods)
    curves = [joint for joint in draft.document.joints.values() if isinstance(joint, fj.CurveJoint)]
    may_stop |= any(curve.one_sided and curve.restitution is None for curve in curves)
    may_stop |= draft.document.analysis.until is not None
    return None if may_stop and requested > 1 else requested


def check_sizes(path: Path_, item: f.ExpectEntry, quantity: NumberKind, instants: int | None) -> Iterator[Violation]:
    """An expectation has as many numbers as the result, in the same nested lists."""
    is_over_time = quantity.is_timed and item.at is None and item.peak is None and instants != 1
    axes: Shape = () if item.peak is not None else quantity.axes
    instant_lengths = tuple(axis.size for axis in axes)
    lengths: Lengths = (instants, *instant_lengths) if is_over_time else instant_lengths
    given_lengths = list_lengths(item.is_)
    if RAGGED in given_lengths or matches_lengths(given_lengths, lengths):
        return
    if is_over_time and matches_lengths(given_lengths, instant_lengths):
        yield Violation(
            path,
            f"{describe_lengths(given_lengths)} for {item.of} at all instants",
            "add at: (an instant), or peak: max",
        )
    else:
        example_words = first_element_suffix((INSTANT, *axes) if is_over_time else axes)
        hint = f"give one of its numbers, such as {item.of}{example_words}" if lengths else None
        message = f"{describe_lengths(given_lengths)} for {item.of}, which is {describe_lengths(lengths)}"
        yield Violation(path, message, hint or "give one number")


def matches_lengths(lengths: Lengths, expected_lengths: Lengths) -> bool:
    """Whether the lists have the expected lengths, where these are known."""
    return len(lengths) == len(expected_lengths) and all(
        expected_length is None or length == expected_length
        for length, expected_length in zip(lengths, expected_lengths, strict=True)
    )


def list_lengths(value: Any) -> Lengths:
    """Return the lengths of nested lists of numbers, the outer one first."""
    if not isinstance(value, tuple):
        return ()
    inner = {list_lengths(member) for member in value}
    return (len(value), *inner.pop()) if len(inner) == 1 else (RAGGED,)


def describe_lengths(lengths: Lengths) -> str:
    """Describe the lengths of lists in words."""
    if not lengths:
        return "one number"
    return "a list of " + " lists of ".join("some" if length is None else str(length) for length in lengths)


# Curves

CURVE_KEYS = ("skip", "gaps", "sheet", "x", "y", "x_unit", "y_unit", "within")
KEYS_WITHOUT_CURVE = ("is", "at", "peak", "below", "above")


@rule("expect-curve")
def check_expected_curve(draft: DraftDocument) -> Iterator[Violation]:
    """A curve stands alone in its expectation, belongs to one number over a motion, and has its dimension."""
    for path, item, quantity in iter_expected_quantities(draft):
        if item.curve is None:
            for key in CURVE_KEYS:
                if key in item.model_fields_set:
                    hint = "it belongs to a measured curve: curve: FILE.csv"
                    yield Violation((*path, key), f"'{key}' without 'curve'", hint, key=True)
            continue
        for key in KEYS_WITHOUT_CURVE:
            if (key if key != "is" else "is_") in item.model_fields_set:
                hint = "the curve gives the expected values over time; write a separate expectation for this"
                yield Violation((*path, key), f"'{key}' given together with 'curve'", hint, key=True)
        if item.within is not None and not 0.0 < item.within <= 1.0:
            hint = "the fraction of the points that must lie within rel and abs, for example 0.95"
            yield Violation((*path, "within"), f"within must be above 0 and at most 1, but is {item.within:g}", hint)
        if (kind := find_analysis_type(draft.document)) != "motion" and "analysis" not in draft.unread:
            message = f"a curve needs a motion, but type: {kind} is one instant"
            yield Violation(
                (*path, "curve"), message, "give analysis a duration, or expect one number with is:", key=True
            )
        yield from check_curve_axes(path, item, quantity, find_x_quantity(item, draft))


def check_curve_axes(
    path: Path_, item: f.ExpectEntry, quantity: NumberKind | None, x_quantity: NumberKind | None
) -> Iterator[Violation]:
    """Check both axes of a curve: one number each, in its unit.

    x_quantity: the result that x is; None: time
    """
    if quantity is not None:
        yield from require_one_number((*path, "of"), item.of, quantity)
        yield from check_unit((*path, "y_unit"), item.y_unit, quantity.dimensions)
    if x_quantity is not None:
        yield from require_one_number((*path, "x"), str(item.x), x_quantity)
    yield from check_unit(
        (*path, "x_unit"), item.x_unit, x_quantity.dimensions if x_quantity is not None else (u.TIME,)
    )


def find_x_quantity(item: f.ExpectEntry, draft: DraftDocument) -> NumberKind | None:
    """Return the result that x is a path to; None if x is time."""
    if not isinstance(item.x, str) or "." not in item.x:
        return None
    from heuncli.scene.file_format.rules.outcome import NumberKind, find_path_target  # as in outcomes

    target = find_path_target(draft, item.x)
    return target if isinstance(target, NumberKind) else None


def require_one_number(path: Path_, result_path: str, quantity: NumberKind) -> Iterator[Violation]:
    """A curve belongs to one number that changes over the instants."""
    if not quantity.is_timed:
        yield Violation(path, f"{result_path} does not change in time", "give a number that changes in time")
    elif quantity.axes:
        hint = f"give one of them, such as {result_path}{first_element_suffix(quantity.axes)}"
        yield Violation(path, f"{result_path} is several numbers", hint)


def check_unit(path: Path_, unit_text: str | None, allowed: tuple[u.Dimension, ...]) -> Iterator[Violation]:
    """A column's unit has one of the allowed dimensions."""
    try:
        dimension = u.parse_unit(unit_text)[1] if unit_text is not None else None
    except Finding:  # reported where the column is read
        return
    if dimension is not None and allowed and dimension not in allowed:
        expected = " or ".join(u.describe(one) for one in allowed)
        units = " or ".join(u.si_unit(one) for one in allowed)
        yield Violation(path, f"'{unit_text}' is {u.describe(dimension)}, expected {expected}", f"for example {units}")
