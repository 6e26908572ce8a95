"""Rows that scenes are packed in: fields by name, none missing, unknown or computed; what is not given is zero."""

from __future__ import annotations

import pytest

from heuncli.kernel.choose import scene as kernel
from heuncli.kernel.choose import structs
from heuncli.multibody.tree.tables import make_table

PACKED = {
    record.__name__: record
    for record in vars(kernel).values()
    if isinstance(record, type) and issubclass(record, structs.Record) and record is not structs.Record
}


@pytest.mark.parametrize("name", PACKED)
def test_a_row_gives_what_it_must_and_nothing_of_the_kernel(name: str) -> None:
    record = PACKED[name]
    needed = dict.fromkeys(record.required_fields, 1)
    for wrong in ({"lenght": 1}, *({field: 1} for field in set(record.__annotations__) - record.row_fields)):
        with pytest.raises(TypeError, match=next(iter(wrong))):
            record(**needed, **wrong)
    for field in record.required_fields:
        with pytest.raises(TypeError, match=field):
            record(**{other: 1 for other in needed if other != field})
    assert record(**needed).collect_fields() == needed


def test_a_table_takes_rows_of_different_fields() -> None:
    """What only later rows give is kept, what a row leaves out is zero, and a copy of a row may have more."""
    first = kernel.Closure(kind=kernel.ROD, a=1, b=2, weight=1.0, length=2.0)
    made = make_table(kernel.Closure, [first, first.replace(a=3, e=(4.0, 5.0, 6.0))])
    assert made["a"].tolist() == [1, 3]
    assert made["length"].tolist() == [2.0, 2.0]
    assert made["e"].tolist() == [(0.0, 0.0, 0.0), (4.0, 5.0, 6.0)]
    assert not made["gap"].any() and not made["Q"]["x"].any()
