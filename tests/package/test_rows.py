"""The rows that scenes are laid out in have fields of the kernel's structs, and what is not given is zero."""

from __future__ import annotations

import numpy as np
import pytest

from heuncli.kernel.choose import scene as kernel
from heuncli.multibody.tree import rows
from heuncli.multibody.tree.tables import struct_dtype

ROWS = {
    "Body": [rows.BodyRow],
    "Freedom": [rows.FreedomRow],
    "Load": [rows.LoadRow],
    "Closure": [rows.ClosureRow, rows.ClosureIndices],
    "Contact": [rows.ContactRow],
    "Counter": [rows.CounterRow],
    "Variable": [rows.VariableRow],
    "Watch": [rows.WatchRow],
    "Group": [rows.GroupRow],
    "Island": [rows.IslandRow],
}


@pytest.mark.parametrize("name", ROWS)
def test_each_field_is_one_of_the_struct(name: str) -> None:
    given = [field for part in ROWS[name] for field in part.__annotations__]
    struct = struct_dtype(getattr(kernel, name))
    assert len(set(given)) == len(given)
    assert set(given) <= set(struct.names or ())
    for part in ROWS[name]:
        for field, kind in part.__annotations__.items():
            own = struct[field]
            assert (kind == "int") == (own.kind == "i"), field
            assert (kind == "float") == (own.kind == "f"), field


@pytest.mark.parametrize("name", ROWS)
def test_what_has_a_default_is_zero_without_it(name: str) -> None:
    for part in ROWS[name]:
        assert all(not np.any(vars(part)[field]) for field in part.__annotations__ if field in vars(part))
