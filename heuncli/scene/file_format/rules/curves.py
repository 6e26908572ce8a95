"""Expectations that are curves: of one number over the instants, against time or another number, in their units."""

from __future__ import annotations

from collections.abc import Iterator
from typing import TYPE_CHECKING

from heuncli.base import units as u
from heuncli.base.errors import Finding
from heuncli.results.results_schema import spelled_first
from heuncli.scene.file_format import format as f
from heuncli.scene.file_format.rules.expect import outcomes
from heuncli.scene.file_format.rules.registry import DraftDocument, Path_, Violation, rule
from heuncli.scene.file_format.semantics import type_of

if TYPE_CHECKING:
    from heuncli.scene.file_format.rules.outcome import NumberKind

OF_A_CURVE = ("x", "y", "x_unit", "y_unit", "within")
BESIDE_NONE = ("is", "at", "peak", "below", "above")


@rule("expect-curve")
def expect_curve(draft: DraftDocument) -> Iterator[Violation]:
    """A curve stands alone, is of one number over the instants of a motion, and in its dimension."""
    for path, item, quantity in outcomes(draft):
        if item.curve is None:
            for key in OF_A_CURVE:
                if key in item.model_fields_set:
                    hint = "it is of a measured curve: curve: FILE.csv"
                    yield Violation((*path, key), f"'{key}' without 'curve'", hint, key=True)
            continue
        for key in BESIDE_NONE:
            if (key if key != "is" else "is_") in item.model_fields_set:
                hint = "the curve tells what is expected when; another expectation for this"
                yield Violation((*path, key), f"'{key}' beside 'curve'", hint, key=True)
        if item.within is not None and not 0.0 < item.within <= 1.0:
            hint = "it is the share of the points that must lie within rel and abs: within: 0.95"
            yield Violation((*path, "within"), f"within {item.within:g} is not above 0 and at most 1", hint)
        if (kind := type_of(draft.document)) != "motion" and "analysis" not in draft.unread:
            message = f"a curve runs over the instants; type: {kind} is one instant"
            yield Violation((*path, "curve"), message, "give analysis a duration, or expect one number: is", key=True)
        yield from sides(path, item, quantity, abscissa(item, draft))


def sides(
    path: Path_, item: f.ExpectEntry, quantity: NumberKind | None, across: NumberKind | None
) -> Iterator[Violation]:
    """What is measured and what it is measured against: one number each, in their units; across: None for time."""
    if quantity is not None:
        yield from one_number((*path, "of"), item.of, quantity)
        yield from unit((*path, "y_unit"), item.y_unit, quantity.dimensions)
    if across is not None:
        yield from one_number((*path, "x"), str(item.x), across)
    yield from unit((*path, "x_unit"), item.x_unit, across.dimensions if across is not None else (u.TIME,))


def abscissa(item: f.ExpectEntry, draft: DraftDocument) -> NumberKind | None:
    """The result that x is a path to; None where it names a column of time."""
    if not isinstance(item.x, str) or "." not in item.x:
        return None
    from heuncli.scene.file_format.rules.outcome import NumberKind, reached_in  # as in outcomes

    found = reached_in(draft, item.x)
    return found if isinstance(found, NumberKind) else None


def one_number(path: Path_, of: str, quantity: NumberKind) -> Iterator[Violation]:
    """A curve is of one number that runs over the instants."""
    if not quantity.timed:
        yield Violation(path, f"{of} does not run over the instants", "name a number that changes in time")
    elif quantity.axes:
        hint = f"name one of them, as {of}{spelled_first(quantity.axes)}"
        yield Violation(path, f"{of} is several numbers", hint)


def unit(path: Path_, given: str | None, known: tuple[u.Dimension, ...]) -> Iterator[Violation]:
    """A column's unit, in one of the dimensions that it may have."""
    try:
        dimension = u.parse_unit(given)[1] if given is not None else None
    except Finding:  # told where the column is read
        return
    if dimension is not None and known and dimension not in known:
        expected = " or ".join(u.describe(one) for one in known)
        units = " or ".join(u.si_unit(one) for one in known)
        yield Violation(path, f"'{given}' is {u.describe(dimension)}, expected {expected}", f"such as {units}")
