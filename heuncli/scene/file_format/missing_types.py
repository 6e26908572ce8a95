"""The errors for an entry without `type`: the types that its keys fit, and the keys that no type has."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from typing import Any

from pydantic_core import ValidationError

from heuncli.base.spelling import find_similar, match_misspelt_keys
from heuncli.scene.file_format.entries import Entry, fields_of, keys_of
from heuncli.scene.file_format.hints import find_native_key
from heuncli.scene.file_format.pydantic_errors import indefinite_article, unknown_key_error, unknown_type_error
from heuncli.scene.file_format.rules.registry import Violation
from heuncli.scene.file_format.validation import validate_entry

PLACE_KEYS = frozenset({"from", "to", "on", "joint", "of", "body", "at"})  # these alone do not tell a type
NOUNS = {"friction": "friction", "distributed": "a distributed load"}  # of types that are not nouns with an article


def missing_type_errors(
    data: Any, models: Mapping[str, type[Entry]], block: str, context: Any
) -> Iterator[tuple[str, Violation]]:
    """Yield the errors for an entry that is no mapping, or has no known type; paths are relative to the entry."""
    if type(data) is not dict or "type" in data:
        yield unknown_type_error(data, block, list(models))
        return
    known_keys = list(dict.fromkeys(key for model in models.values() for key in keys_of(model)))
    unknown_keys = [key for key in data if key not in known_keys and not _stands_for_type(str(key), data)]
    mended = {key: value for key, value in data.items() if key not in unknown_keys}
    mended |= match_misspelt_keys(data, known_keys)
    native = {find_native_key(str(key), known_keys): data[key] for key in unknown_keys}
    mended = {key: value for key, value in native.items() if key is not None} | mended
    names = find_fitting_types(mended, models, context)
    yield name_types_error(mended, names) if names else unknown_type_error(data, block, list(models))
    if names:
        known_keys = list(dict.fromkeys(key for name in names for key in keys_of(models[name])))
    for key in unknown_keys:
        yield unknown_key_error((key,), known_keys)


def _stands_for_type(key: str, data: Mapping[str, Any]) -> bool:
    """Whether an unknown key is another word for `type`, or one for it by mistake, which is told with the type."""
    return find_native_key(key, ["type"]) is not None or key == find_similar("type", [str(name) for name in data])


def name_types_error(data: Mapping[str, Any], names: list[str]) -> tuple[str, Violation]:
    """Make the error for an entry whose keys fit the types of these names."""
    keys = ", ".join(f"'{key}'" for key in data)
    nouns = [NOUNS.get(name, f"{indefinite_article(name)} {name}") for name in names]
    listed = " or ".join([", ".join(nouns[:-1]), nouns[-1]] if len(nouns) > 1 else nouns)
    message = f"'type' is missing; with {keys} this is {listed}"
    return "missing-key", Violation((), message, f"add {' or '.join(f'type: {name}' for name in names)}", key=True)


def find_fitting_types(data: dict[str, Any], models: Mapping[str, type[Entry]], context: Any) -> list[str]:
    """Find the types that have all keys of an entry and require no others; of these, the ones that accept its values,
    if there are any.
    """
    if data.keys() <= PLACE_KEYS:
        return []
    fitting = [
        name
        for name, model in models.items()
        if data.keys() <= {*keys_of(model)} and _required_keys(model) <= {*data, "type"}
    ]
    return [name for name in fitting if _is_valid(models[name], {**data, "type": name}, context)] or fitting


def _required_keys(model: type[Entry]) -> set[str]:
    return {field.alias or name for name, field in fields_of(model).items() if field.is_required}


def _is_valid(model: type[Entry], data: dict[str, Any], context: Any) -> bool:
    try:
        validate_entry(model, data, context)
    except ValidationError:
        return False
    return True
