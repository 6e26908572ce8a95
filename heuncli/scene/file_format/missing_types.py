"""The error for an entry without `type`: it names the types that the entry's keys fit."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from pydantic_core import ValidationError

from heuncli.scene.file_format.entries import Entry, fields_of, keys_of
from heuncli.scene.file_format.pydantic_errors import indefinite_article
from heuncli.scene.file_format.rules.registry import Violation
from heuncli.scene.file_format.validation import validate_entry

PLACE_KEYS = frozenset({"from", "to", "on", "joint", "of", "body", "at"})  # these alone do not tell a type
NOUNS = {"friction": "friction", "distributed": "a distributed load"}  # of types that are not nouns with an article


def missing_type_error(data: Any, models: Mapping[str, type[Entry]], context: Any) -> tuple[str, Violation] | None:
    """Make the error for an entry without a type. Returns None if the entry has one, or if its keys fit no type."""
    names = find_fitting_types(data, models, context) if type(data) is dict and "type" not in data else []
    if not names:
        return None
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
