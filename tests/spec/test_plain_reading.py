"""The reader of entries without pydantic's engine: it refuses schemas that it would read only in part."""

from __future__ import annotations

from typing import Any

import pytest
from pydantic_core import SchemaValidator, core_schema

from heuncli.scene.file_format.plain_reading import ReadInfo, make_reader

INFO = ReadInfo(None)
BOUNDED: dict[str, Any] = {
    "length of a text": core_schema.str_schema(min_length=2),
    "pattern": core_schema.str_schema(pattern="a+"),
    "bound of a number": core_schema.int_schema(ge=0),
    "length of a list": core_schema.list_schema(core_schema.int_schema(), min_length=1),
    "length of a mapping": core_schema.dict_schema(core_schema.str_schema(), core_schema.any_schema(), max_length=1),
    "in a list": core_schema.list_schema(core_schema.int_schema(le=3)),
    "in a choice": core_schema.union_schema([core_schema.str_schema(), core_schema.int_schema(ge=0)]),
    "variadic tuple": core_schema.tuple_schema([core_schema.int_schema()], variadic_item_index=0),
    "type": core_schema.float_schema(),
    "field": core_schema.model_fields_schema({"a": core_schema.model_field(core_schema.str_schema(), frozen=True)}),
    "default": core_schema.model_fields_schema({
        "a": core_schema.model_field(
            core_schema.with_default_schema(core_schema.str_schema(), default="b", validate_default=True)
        ),
    }),
}  # fmt: skip


@pytest.mark.parametrize("name", BOUNDED)
def test_a_schema_with_a_constraint_that_is_not_read_has_no_reader(name: str) -> None:
    SchemaValidator(BOUNDED[name])  # pydantic takes it
    with pytest.raises(NotImplementedError):
        make_reader(BOUNDED[name])


def test_the_same_schemas_without_constraints_have_one() -> None:
    schema = core_schema.dict_schema(core_schema.str_schema(), core_schema.list_schema(core_schema.int_schema()))
    assert make_reader(dict(schema))({"a": [1, 2]}, INFO) == {"a": [1, 2]}
