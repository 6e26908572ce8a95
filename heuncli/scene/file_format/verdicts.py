"""pydantic's errors in the words, codes and paths of specs."""

from __future__ import annotations

import types
from collections.abc import Iterator
from typing import Annotated, Any, Union, get_args, get_origin

from pydantic_core import ValidationError

from heuncli.base.errors import Finding
from heuncli.base.nearest import did_you_mean, nearest
from heuncli.scene.file_format.entries import Entry, fields_of, keys_of
from heuncli.scene.file_format.hints import called, elsewhere, of_form, of_key, of_missing, of_word, stands_for
from heuncli.scene.file_format.quantity import Follows, kind_of
from heuncli.scene.file_format.rules.registry import Path_, Violation
from heuncli.scene.file_format.words import LATER, TYPES

KINDS = {  # pydantic's error types for a value of the wrong kind
    "dict_type": "a mapping", "model_type": "a mapping", "model_attributes_type": "a mapping", "list_type": "a list",
    "tuple_type": "a list", "string_type": "a text", "bool_type": "true or false", "int_type": "a whole number",
}  # fmt: skip
PLACES = frozenset({"at", "from", "to", "about"})  # keys of points, by name or by coordinates
FORMS = {"single": "a number", "list": "a list", "rows": "a list of lists", "mapping": "a mapping"}


def verdicts(error: ValidationError, data: Any, model: type[Entry]) -> Iterator[tuple[str, Violation]]:
    """Codes and violations, one for each thing wrong in data read as a model; paths are within the data."""
    short: set[Path_] = set()
    for item in error.errors(include_url=False, include_input=True):
        path = path_of(item["loc"], data)
        kind, context = item["type"], item.get("ctx", {})
        if kind == "value_error" and isinstance(context.get("error"), Finding):
            finding = context["error"]
            yield finding.code, Violation(path, finding.message, finding.hint)
        elif kind == "missing" and isinstance(item["loc"][-1], int):
            if path not in short:
                short.add(path)
                value = at(data, path)
                count = needed(item["loc"])
                message, hint = f"{len(value)} values instead of {count}", as_many(path, count)
                if (len(value), count) == (2, 3):
                    hint = "two components are for a scene in the xy plane: space: planar"
                yield "wrong-length", Violation(path, message, hint)
        elif kind == "missing" and is_there_as_another(str(item["loc"][-1]), at(data, path), model, path):
            continue  # told of the key by which it is called
        elif kind == "missing":
            yield missing(path, str(item["loc"][-1]), at(data, path))
        elif kind == "extra_forbidden":
            yield unknown_key(path, keys_known(path[:-1], model))
        elif kind == "too_long":
            message = f"{context['actual_length']} values instead of {context['max_length']}"
            cut = any(isinstance(part, str) and part.count("(") > part.count(")") for part in item["input"])
            hint = "inside [ ] an expression with a comma is written in quotes"
            hint = hint if cut else as_many(path, context["max_length"])
            if path[-1:] == ("inertia",):
                hint = "the products of inertia stand beside it: deviation: [D1, D2, D3], D1 = sum of m*a2*a3"
            yield "wrong-length", Violation(path, message, hint)
        elif kind in ("union_tag_invalid", "union_tag_not_found"):
            yield "wrong-kind", wrong_form(path, context, data)
        elif kind == "literal_error":
            yield wrong_word(path, item["input"], str(context["expected"]))
        else:
            yield "wrong-kind", wrong_kind(path, KINDS.get(kind, "something else"), item["input"])


def is_primary(code: str) -> bool:
    """Whether an error is one of its own, not the consequence of another."""
    return code != Follows().code


def path_of(location: tuple[str | int, ...], data: Any) -> Path_:
    """The path in the data, without the tags that pydantic puts between."""
    path: Path_ = ()
    node = data
    for part in location:
        if (isinstance(node, dict) and part in node) or (
            isinstance(node, list) and isinstance(part, int) and part < len(node)
        ):
            node = node[part]  # type: ignore[index]
            path = (*path, part)
    return path


def at(data: Any, path: Path_) -> Any:
    """The value at a path that exists."""
    for part in path:
        data = data[part]
    return data


def needed(location: tuple[str | int, ...]) -> int:
    """How many values the list must have: four of a quaternion, else three."""
    return 4 if "quaternion" in location else 3


def as_many(path: Path_, count: int) -> str:
    """What a list of so many numbers looks like."""
    named = {"quaternion": "[w, x, y, z]", "size": "[along x, along y, along z]", "euler": "[a, b, c]"}
    key = next((str(part) for part in reversed(path) if isinstance(part, str)), "")
    return f"{key}: {named.get(key, '[x, y, z]' if count == 3 else f'{count} values')}"


def is_there_as_another(key: str, owner: dict[str, Any], model: type[Entry], path: Path_) -> bool:
    """Whether an unknown key beside it stands for a missing one."""
    known = keys_known(path, model)
    return any(name not in known and stands_for(str(name), known) == key for name in owner)


def missing(path: Path_, key: str, owner: dict[str, Any]) -> tuple[str, Violation]:
    """A key that must be there."""
    if key == "heun":
        return "missing-key", Violation(path, "'heun' is missing", "a spec starts with the line 'heun: 1'")
    return "missing-key", Violation(path, f"'{key}' is missing", of_missing(key, owner), key=True)


def wrong_kind(path: Path_, expected: str, found: Any) -> Violation:
    """A value that is no list, no mapping, ..."""
    key = next((part for part in reversed(path) if isinstance(part, str)), "")
    hint = of_form(key, found, expected)
    if expected == "a text" and isinstance(found, int | float | bool):
        hint = "write it in quotes"
        if key in PLACES:
            expected, hint = "a point", "[x, y, z], or the name of a point"
    return Violation(path, f"expected {expected}, found {kind_of(found)}", hint)


def unknown_key(path: Path_, known: list[str]) -> tuple[str, Violation]:
    """A key that means nothing here."""
    key = str(path[-1])
    if ("keys", key) in LATER:
        return "not-yet", Violation(path, f"not yet: {key}", "leave it out: a later version has it", key=True)
    return "unknown-key", Violation(path, f"'{key}' is not known here", of_key(key, known), key=True)


def unknown_type(entry: Any, block: str, known: list[str]) -> tuple[str, Violation]:
    """An entry that is no mapping, or whose type is none; its path is within the entry."""
    code, what, words = TYPES[block]
    listed = ", ".join(known)
    if type(entry) is not dict:
        return "wrong-kind", Violation((), f"expected a mapping, found {kind_of(entry)}", f"{{type: {known[0]}, ...}}")
    if "type" not in entry:
        other = next((name for name in entry if called(name, ["type"])), None)
        hint = f"'{other}' is called type here" if other is not None else f"known: {listed}"
        if other is None and (like := nearest("type", [str(name) for name in entry])) is not None:
            hint = f"did you mean type where '{like}' stands? {hint}"
        return "missing-key", Violation((), "'type' is missing", hint, key=True)
    tag = entry["type"]
    if type(tag) is not str:
        return "wrong-kind", Violation(("type",), f"expected {what}, found {kind_of(tag)}", f"known: {listed}")
    if (block, tag) in LATER:
        return "not-yet", Violation(("type",), f"not yet: {what.removeprefix('a ')} {tag}", f"there are: {listed}")
    word = words.get(tag.lower().replace("-", "_"))
    hint = f"{article(tag)} {tag} is type: {word}" if word else elsewhere(tag) or did_you_mean(tag, known, "types")
    return code, Violation(("type",), f"'{tag}' is not {what}; known: {listed}", hint)


def wrong_form(path: Path_, context: dict[str, Any], data: Any) -> Violation:
    """A value in a form that its key does not take."""
    tags = [tag.strip(" '") for tag in str(context.get("expected_tags", "")).split(",")]
    forms = " or ".join("a name" if tag == "single" and path[-1:] == ("at",) else FORMS[tag] for tag in tags)
    hint = of_form(str(path[-1]) if path else "", at(data, path), forms)
    return Violation(path, f"expected {forms}, found {kind_of(at(data, path))}", hint)


def article(word: str) -> str:
    return "an" if word[:1].lower() in "aeio" else "a"


def wrong_word(path: Path_, word: Any, expected: str) -> tuple[str, Violation]:
    """A word that is not one of those allowed here."""
    known = [word.strip(" '") for word in expected.replace(" or ", ", ").split(",")]
    if not isinstance(word, str):
        message = f"expected one of {', '.join(known)}, found {kind_of(word)}"
        return "wrong-kind", Violation(path, message, f"as {path[-1]}: {known[0]}")
    message = f"'{word}' is not known here; known: {', '.join(known)}"
    return "unknown-word", Violation(path, message, of_word(word, known))


def models_in(annotation: Any) -> tuple[int, list[type[Entry]]]:
    """The models that a field may hold, and how many keys or indices stand between: 1 for dict[str, X] and list[X]."""
    origin = get_origin(annotation)
    if origin is Annotated:
        return models_in(get_args(annotation)[0])
    if origin in (Union, types.UnionType):
        parts = [models_in(part) for part in get_args(annotation)]
        return max(depth for depth, _ in parts), [model for _, models in parts for model in models]
    if origin in (dict, list):
        depth, models = models_in(get_args(annotation)[-1])
        return depth + 1, models
    return 0, [annotation] if isinstance(annotation, type) and issubclass(annotation, Entry) else []


def keys_known(path: Path_, model: type[Entry]) -> list[str]:
    """The keys of the mapping at a path below what a model reads."""
    owner: type[Entry] | None = model
    between = 0
    for part in path:
        if between == 0:
            fields = fields_of(owner) if owner is not None else {}
            field = next((field for name, field in fields.items() if (field.alias or name) == part), None)
            between, models = models_in(field.annotation) if field is not None else (0, [])
            owner = models[0] if models else None
        else:
            between -= 1
    return [*keys_of(owner)] if owner is not None else []
