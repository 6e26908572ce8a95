"""Read entries without errors by a schema of pydantic_core, without importing it.

A reader takes each value only in the form in which YAML gives a right one: a mapping as dict, a list as list, a text as
str. Where anything else is found, or a function refuses a value, there is a doubt, and pydantic_core judges the entry
anew; so all errors, and all conversions between types, are its own. Readers have the results of pydantic_core for what
they take (tests/spec/test_judging.py).
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

from heuncli.base.named_tuples import NamedTuple

CoreSchema = dict[str, Any]
Reader = Callable[[Any, "ReadInfo"], Any]
MISSING: Any = object()
FIELD_KEYS = frozenset({"type", "schema", "validation_alias"})
DEFAULT_KEYS = frozenset({"type", "schema", "default", "default_factory"})
UNION_TYPES: dict[str, type] = {"str": str, "int": int}


class DoubtfulError(Exception):
    """A value is not read without a doubt."""


class ReadInfo(NamedTuple):
    """What functions of a schema learn besides the value: what it may refer to."""

    context: Any


def make_reader(schema: CoreSchema) -> Reader:
    """Make the reader of a schema; it raises DoubtfulError.

    Raises NotImplementedError for a schema that it would read only in part, such as one with a bound.
    """
    maker, keys = MAKERS.get(schema["type"], (None, frozenset()))
    if maker is None:
        raise NotImplementedError(f"a schema of type '{schema['type']}'")
    require_known_keys(schema, keys | {"type"})
    return maker(schema)


def require_known_keys(schema: CoreSchema, keys: frozenset[str]) -> None:
    """Raise NotImplementedError if a part of a schema has other keys than these."""
    if unknown := sorted(schema.keys() - keys):
        raise NotImplementedError(f"{', '.join(unknown)} in a schema of type '{schema.get('type', 'field')}'")


def read_anything(value: Any, info: ReadInfo) -> Any:
    return value


def refuse(value: Any, info: ReadInfo) -> Any:
    """Refuse every value: of a form that is none of a tagged union's."""
    raise DoubtfulError


def make_type_reader(kind: type) -> Callable[[CoreSchema], Reader]:
    """Make what makes readers of values of exactly one type."""

    def read(value: Any, info: ReadInfo) -> Any:
        if type(value) is not kind:
            raise DoubtfulError
        return value

    return lambda schema: read


def make_literal_reader(schema: CoreSchema) -> Reader:
    words = {word: word for word in schema["expected"] if type(word) is str}

    def read(value: Any, info: ReadInfo) -> Any:
        if type(value) is not str or value not in words:
            raise DoubtfulError
        return words[value]

    return read


def make_tuple_reader(schema: CoreSchema) -> Reader:
    readers = [make_reader(own) for own in schema["items_schema"]]

    def read(value: Any, info: ReadInfo) -> Any:
        if type(value) is not list or len(value) != len(readers):
            raise DoubtfulError
        return tuple([reader(member, info) for reader, member in zip(readers, value, strict=True)])

    return read


def make_list_reader(schema: CoreSchema) -> Reader:
    reader = make_reader(schema["items_schema"])

    def read(value: Any, info: ReadInfo) -> Any:
        if type(value) is not list:
            raise DoubtfulError
        return [reader(member, info) for member in value]

    return read


def make_dict_reader(schema: CoreSchema) -> Reader:
    read_key, read_value = make_reader(schema["keys_schema"]), make_reader(schema["values_schema"])

    def read(value: Any, info: ReadInfo) -> Any:
        if type(value) is not dict:
            raise DoubtfulError
        return {read_key(name, info): read_value(member, info) for name, member in value.items()}

    return read


def make_union_reader(schema: CoreSchema) -> Reader:
    """Make the reader of a text or a number: a value of exactly one of these types."""
    kinds = {UNION_TYPES[own["type"]] for own in schema["choices"] if own["type"] in UNION_TYPES}
    for own in schema["choices"]:
        require_known_keys(own, frozenset({"type"}) if own["type"] in UNION_TYPES else frozenset(own))

    def read(value: Any, info: ReadInfo) -> Any:
        if type(value) not in kinds:
            raise DoubtfulError
        return value

    return read


def make_nullable_reader(schema: CoreSchema) -> Reader:
    reader = make_reader(schema["schema"])
    return lambda value, info: None if value is None else reader(value, info)


def make_tagged_reader(schema: CoreSchema) -> Reader:
    readers, find_tag = {tag: make_reader(own) for tag, own in schema["choices"].items()}, schema["discriminator"]
    return lambda value, info: readers.get(find_tag(value), refuse)(value, info)


def make_function_reader(schema: CoreSchema) -> Reader:
    """Make the reader of a function, after which a schema may read on."""
    function, takes_info = schema["function"]["function"], schema["function"]["type"] == "with-info"
    read_on = make_reader(schema["schema"]) if "schema" in schema else read_anything

    def read(value: Any, info: ReadInfo) -> Any:
        try:
            converted = function(value, info) if takes_info else function(value)
        except (ValueError, AssertionError) as refusal:
            raise DoubtfulError from refusal
        return read_on(converted, info)

    return read


def make_fields_reader(schema: CoreSchema) -> Reader:
    """Make the reader of a mapping with known keys: it returns their values with the defaults, and the given names."""
    rows = []
    for name, field in schema["fields"].items():
        own = field["schema"]
        require_known_keys(field, FIELD_KEYS)
        has_default = own["type"] == "default"
        if has_default:
            require_known_keys(own, DEFAULT_KEYS)
        reader = make_reader(own["schema"] if has_default else own)
        factory = own.get("default_factory") if has_default else None
        default = own.get("default", MISSING) if has_default else MISSING
        rows.append((name, field.get("validation_alias", name), reader, factory, default))

    def read(data: Any, info: ReadInfo) -> Any:
        if type(data) is not dict:
            raise DoubtfulError
        values, given = {}, set()
        for name, key, reader, factory, default in rows:
            value = data.get(key, MISSING)
            if value is not MISSING:
                values[name] = reader(value, info)
                given.add(name)
            elif factory is not None:
                values[name] = factory()
            elif default is not MISSING:
                values[name] = default
            else:
                raise DoubtfulError
        if len(given) < len(data):  # unknown keys
            raise DoubtfulError
        return values, given

    return read


def make_model_reader(schema: CoreSchema) -> Reader:
    model, read_fields = schema["cls"], make_reader(schema["schema"])

    def read(data: Any, info: ReadInfo) -> Any:
        values, given = read_fields(data, info)
        entry = object.__new__(model)
        parts = {"__dict__": values, "__pydantic_extra__": None, "__pydantic_private__": None}
        for name, part in {**parts, "__pydantic_fields_set__": given}.items():
            object.__setattr__(entry, name, part)
        return entry

    return read


# For each type of schema: the function that makes its reader, and the keys of the schema that it uses besides `type`.
MAKERS: dict[str, tuple[Callable[[CoreSchema], Reader], frozenset[str]]] = {
    kind: (maker, frozenset(keys.split()))
    for kind, maker, keys in (
        ("any", lambda schema: read_anything, ""),
        ("str", make_type_reader(str), ""),
        ("int", make_type_reader(int), ""),
        ("bool", make_type_reader(bool), "strict"),
        ("literal", make_literal_reader, "expected"),
        ("tuple", make_tuple_reader, "items_schema"),
        ("list", make_list_reader, "items_schema"),
        ("dict", make_dict_reader, "keys_schema values_schema"),
        ("nullable", make_nullable_reader, "schema"),
        ("union", make_union_reader, "choices"),
        ("tagged-union", make_tagged_reader, "choices discriminator"),
        ("function-plain", make_function_reader, "function"),
        ("function-before", make_function_reader, "function schema"),
        ("model-fields", make_fields_reader, "fields model_name"),
        ("model", make_model_reader, "cls config schema"),
    )
}
