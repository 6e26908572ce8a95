"""Translate pydantic's errors into the messages, codes and paths of specs.

The error for an entry without `type` names the types that the entry's keys fit.
"""

from __future__ import annotations

import types
from collections.abc import Iterator, Mapping
from typing import TYPE_CHECKING, Annotated, Any, Union, get_args, get_origin

from heuncli.base.errors import Finding
from heuncli.base.spelling import find_similar, match_misspelt_keys, suggest
from heuncli.scene.file_format.entries import Entry, fields_of, keys_of, validate_entry
from heuncli.scene.file_format.foreign_words import PLANNED_WORDS, TYPE_ALIASES, TYPES
from heuncli.scene.file_format.format import list_labelled_models
from heuncli.scene.file_format.hints import (
    find_intended_key,
    find_native_key,
    form_hint,
    misplaced_word_hint,
    missing_key_hint,
    unknown_key_hint,
    word_hint,
)
from heuncli.scene.file_format.labels import LABEL
from heuncli.scene.file_format.quantity import DependentError, describe_kind
from heuncli.scene.file_format.rules.registry import Path_, Violation

if TYPE_CHECKING:
    from pydantic_core import ValidationError

# Pydantic errors

KINDS = {  # pydantic's error types for a value of the wrong kind
    "dict_type": "a mapping", "model_type": "a mapping", "model_attributes_type": "a mapping", "list_type": "a list",
    "tuple_type": "a list", "string_type": "a text", "bool_type": "true or false", "int_type": "a whole number",
}  # fmt: skip
POINT_KEYS = frozenset({"at", "from", "to", "about"})  # keys of points, given by name or by coordinates
FORM_NAMES = {"single": "a number", "list": "a list", "rows": "a list of lists", "mapping": "a mapping"}


def require_validation_error(error: ValueError) -> ValidationError:
    """Return an error of `validate_entry` as pydantic's. Raises the error if it is none."""
    from pydantic_core import ValidationError  # for entries with errors alone

    if isinstance(error, ValidationError):
        return error
    raise error


def translate_errors(error: ValidationError, data: Any, model: type[Entry]) -> Iterator[tuple[str, Violation]]:
    """Yield a code and a violation for each error in data read as a model; paths are relative to the data."""
    short_lists: set[Path_] = set()
    for item in error.errors(include_url=False, include_input=True):
        path = find_path(item["loc"], data)
        kind, context = item["type"], item.get("ctx", {})
        if kind == "value_error" and isinstance(context.get("error"), Finding):
            finding = context["error"]
            yield finding.code, Violation(path, finding.message, finding.hint)
        elif kind == "missing" and isinstance(item["loc"][-1], int):
            if path not in short_lists:
                short_lists.add(path)
                value = get_value(data, path)
                count = required_length(item["loc"])
                message, hint = f"{len(value)} values instead of {count}", list_hint(path, count)
                if (len(value), count) == (2, 3):
                    hint = "two components need a model in the xy plane: space: planar"
                yield "wrong-length", Violation(path, message, hint)
        elif kind == "missing" and is_given_under_synonym(str(item["loc"][-1]), get_value(data, path), model, path):
            continue  # reported for the synonym that was written instead
        elif kind == "missing":
            yield missing_key_error(path, str(item["loc"][-1]), get_value(data, path))
        elif kind == "extra_forbidden":
            yield unknown_key_error(path, list_known_keys(path[:-1], model))
        elif kind == "too_long":
            message = f"{context['actual_length']} values instead of {context['max_length']}"
            is_split = any(isinstance(part, str) and part.count("(") > part.count(")") for part in item["input"])
            hint = "inside [ ] put an expression with a comma in quotes"
            hint = hint if is_split else list_hint(path, context["max_length"])
            if path[-1:] == ("inertia",):
                hint = "give the products of inertia separately: deviation: [D1, D2, D3], D1 = sum of m*a2*a3"
            yield "wrong-length", Violation(path, message, hint)
        elif kind in ("union_tag_invalid", "union_tag_not_found"):
            yield "wrong-kind", wrong_form(path, context, data)
        elif kind == "literal_error":
            yield wrong_word_error(path, item["input"], str(context["expected"]))
        else:
            yield "wrong-kind", wrong_kind_error(path, KINDS.get(kind, "something else"), item["input"])


def is_primary(code: str) -> bool:
    """Whether an error is not merely the consequence of another one."""
    return code != DependentError().code


def find_path(location: tuple[str | int, ...], data: Any) -> Path_:
    """Return the path in the data, without the tags that pydantic inserts."""
    path: Path_ = ()
    node = data
    for part in location:
        if (isinstance(node, dict) and part in node) or (
            isinstance(node, list) and isinstance(part, int) and part < len(node)
        ):
            node = node[part]  # type: ignore[index]
            path = (*path, part)
    return path


def get_value(data: Any, path: Path_) -> Any:
    """Return the value at a path that exists."""
    for part in path:
        data = data[part]
    return data


def required_length(location: tuple[str | int, ...]) -> int:
    """Return how many values a list must have: four for a quaternion, else three."""
    return 4 if "quaternion" in location else 3


def list_hint(path: Path_, count: int) -> str:
    """Return a hint showing a list of `count` numbers."""
    layouts = {"quaternion": "[w, x, y, z]", "size": "[along x, along y, along z]", "euler": "[a, b, c]"}
    key = next((str(part) for part in reversed(path) if isinstance(part, str)), "")
    return f"{key}: {layouts.get(key, '[x, y, z]' if count == 3 else f'{count} values')}"


def is_given_under_synonym(key: str, owner: dict[str, Any], model: type[Entry], path: Path_) -> bool:
    """Whether an unknown key of the same mapping stands for a missing one."""
    known = list_known_keys(path, model)
    return any(name not in known and find_intended_key(str(name), known) == key for name in owner)


def missing_key_error(path: Path_, key: str, owner: dict[str, Any]) -> tuple[str, Violation]:
    """Make the error for a required key that is absent."""
    if key == "heun":
        return "missing-key", Violation(path, "'heun' is missing", "a spec starts with the line 'heun: 1'")
    return "missing-key", Violation(path, f"'{key}' is missing", missing_key_hint(key, owner), key=True)


def wrong_kind_error(path: Path_, expected_kind: str, value: Any) -> Violation:
    """Make the violation for a value that is no list, no mapping, ..."""
    key = next((part for part in reversed(path) if isinstance(part, str)), "")
    hint = form_hint(key, value, expected_kind)
    if expected_kind == "a text" and isinstance(value, int | float | bool):
        hint = "write it in quotes"
        if key in POINT_KEYS:
            expected_kind, hint = "a point", "[x, y, z], or the name of a point"
    return Violation(path, f"expected {expected_kind}, found {describe_kind(value)}", hint)


def unknown_key_error(path: Path_, known_keys: list[str]) -> tuple[str, Violation]:
    """Make the error for a key that means nothing here."""
    key = str(path[-1])
    if ("keys", key) in PLANNED_WORDS:
        return "not-yet", Violation(
            path, f"not available yet: {key}", "leave it out: planned for a later version", key=True
        )
    return "unknown-key", Violation(path, f"'{key}' is not known here", unknown_key_hint(key, known_keys), key=True)


def unknown_type_error(entry: Any, block: str, known_types: list[str]) -> tuple[str, Violation]:
    """Make the error for an entry that is no mapping or has no known type; its path is relative to the entry."""
    code, description, synonyms = TYPES[block]
    listed = ", ".join(known_types)
    if type(entry) is not dict:
        return "wrong-kind", Violation(
            (), f"expected a mapping, found {describe_kind(entry)}", f"{{type: {known_types[0]}, ...}}"
        )
    if "type" not in entry:
        synonym_key = next((name for name in entry if find_native_key(name, ["type"])), None)
        hint = f"'{synonym_key}' is called type here" if synonym_key is not None else f"known: {listed}"
        if synonym_key is None and (similar_key := find_similar("type", [str(name) for name in entry])) is not None:
            hint = f"did you mean type instead of '{similar_key}'? {hint}"
        return "missing-key", Violation((), "'type' is missing", hint, key=True)
    tag = entry["type"]
    if type(tag) is not str:
        return "wrong-kind", Violation(
            ("type",), f"expected {description}, found {describe_kind(tag)}", f"known: {listed}"
        )
    if (block, tag) in PLANNED_WORDS:
        return "not-yet", Violation(
            ("type",), f"not available yet: {description.removeprefix('a ')} {tag}", f"available: {listed}"
        )
    word = synonyms.get(tag.lower().replace("-", "_"))
    hint = (
        f"for '{tag}' write type: {word}"
        if word
        else misplaced_word_hint(tag) or suggest(tag, [*known_types, *TYPE_ALIASES.get(block, ())], "types")
    )
    return code, Violation(("type",), f"'{tag}' is not {description}; known: {listed}", hint)


def wrong_form(path: Path_, context: dict[str, Any], data: Any) -> Violation:
    """Make the violation for a value in a form that its key does not accept."""
    tags = [tag.strip(" '") for tag in str(context.get("expected_tags", "")).split(",")]
    forms = " or ".join("a name" if tag == "single" and path[-1:] == ("at",) else FORM_NAMES[tag] for tag in tags)
    hint = form_hint(str(path[-1]) if path else "", get_value(data, path), forms)
    return Violation(path, f"expected {forms}, found {describe_kind(get_value(data, path))}", hint)


def indefinite_article(word: str) -> str:
    return "an" if word[:1].lower() in "aeio" else "a"


def wrong_word_error(path: Path_, word: Any, choices: str) -> tuple[str, Violation]:
    """Make the error for a word that is not among those allowed."""
    allowed = [word.strip(" '") for word in choices.replace(" or ", ", ").split(",")]
    if not isinstance(word, str):
        message = f"expected one of {', '.join(allowed)}, found {describe_kind(word)}"
        return "wrong-kind", Violation(path, message, f"for example {path[-1]}: {allowed[0]}")
    message = f"'{word}' is not known here; known: {', '.join(allowed)}"
    return "unknown-word", Violation(path, message, word_hint(word, allowed))


def find_models(annotation: Any) -> tuple[int, list[type[Entry]]]:
    """Find the models that a field may hold, and how many keys or indices lie between: 1 for dict[str, X] and
    list[X].
    """
    origin = get_origin(annotation)
    if origin is Annotated:
        return find_models(get_args(annotation)[0])
    if origin in (Union, types.UnionType):
        parts = [find_models(part) for part in get_args(annotation)]
        return max(depth for depth, _ in parts), [model for _, models in parts for model in models]
    if origin in (dict, list):
        depth, models = find_models(get_args(annotation)[-1])
        return depth + 1, models
    return 0, [annotation] if isinstance(annotation, type) and issubclass(annotation, Entry) else []


def list_known_keys(path: Path_, model: type[Entry]) -> list[str]:
    """List the keys of the mapping at a path within a model."""
    owner: type[Entry] | None = model
    levels = 0
    for part in path:
        if levels == 0:
            fields = fields_of(owner) if owner is not None else {}
            field = next((field for name, field in fields.items() if (field.alias or name) == part), None)
            levels, models = find_models(field.annotation) if field is not None else (0, [])
            owner = models[0] if models else None
        else:
            levels -= 1
    if owner is None:
        return []
    return [*keys_of(owner), LABEL] if owner in list_labelled_models() else [*keys_of(owner)]


# Missing types

PLACE_KEYS = frozenset({"from", "to", "on", "joint", "of", "body", "at"})  # these alone do not tell a type
NOUNS = {"friction": "friction", "distributed": "a distributed load"}  # words for types whose name takes no article


def missing_type_errors(
    data: Any, models: Mapping[str, type[Entry]], block: str, context: Any
) -> Iterator[tuple[str, Violation]]:
    """Yield the errors for an entry that is no mapping, or has no known type; paths are relative to the entry."""
    if type(data) is not dict or "type" in data:
        yield unknown_type_error(data, block, list(models))
        return
    known_keys = list(dict.fromkeys(key for model in models.values() for key in keys_of(model)))
    unknown_keys = [key for key in data if key not in known_keys and not _replaces_type(str(key), data)]
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


def _replaces_type(key: str, data: Mapping[str, Any]) -> bool:
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
    except ValueError:
        return False
    return True
