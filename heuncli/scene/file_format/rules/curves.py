"""Rules about expected curves: one number over the instants, against time or another number, in their units."""

from __future__ import annotations

from collections.abc import Iterator
from typing import TYPE_CHECKING

from heuncli.base import units as u
from heuncli.base.errors import Finding
from heuncli.results.results_schema import first_element_suffix
from heuncli.scene.file_format import format as f
from heuncli.scene.file_format.rules.expect import iter_expected_quantities
from heuncli.scene.file_format.rules.registry import DraftDocument, Path_, Violation, rule
from heuncli.scene.file_format.semantics import find_analysis_type

if TYPE_CHECKING:
    from heuncli.scene.file_format.rules.outcome import NumberKind

CURVE_KEYS = ("x", "y", "x_unit", "y_unit", "within")
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
