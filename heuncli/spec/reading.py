"""One entry read by its model: every value by its annotation, every objection with its path in the entry.

An annotation is made into a function once, when the first entry that needs it is read.
"""

from __future__ import annotations

import types
from collections.abc import Callable
from typing import Annotated, Any, Literal, NamedTuple, Union, get_args, get_origin

from heuncli.errors import Finding
from heuncli.spec.fields import Before, Context, Form, Model, Tag, Value, fields_of, keys_of
from heuncli.spec.rules.registry import Found, Path_
from heuncli.spec.verdicts import missing, unknown_key, wrong_form, wrong_kind, wrong_length, wrong_word

Findings = list[tuple[str, Found]]
Read = Callable[[Any, Path_, Context, Findings], Any]  # what a value at a path means; objections are added to the list
ReadMapping = Callable[[Any, Path_, Context, Findings, set[str]], Any]  # the same, and the keys in error
READERS: dict[type[Model], ReadMapping] = {}  # of the models that have been read
NAMES: dict[Any, tuple[type | tuple[type, ...], str]] = {
    str: (str, "a text"), bool: (bool, "true or false"), str | int: ((str, int), "a text or a whole number"),
}  # fmt: skip


class Entry(NamedTuple):
    """What was read, the objections, and the entry's keys that these concern."""

    value: Any
    findings: Findings
    wrong: set[str]


def read(model: type[Model], data: Any, context: Context) -> Entry:
    """Data as a model."""
    findings: Findings = []
    wrong: set[str] = set()
    return Entry(mapping_of(model)(data, (), context, findings, wrong), findings, wrong)


def mapping_of(model: type[Model]) -> ReadMapping:
    """The reader of a mapping with known keys."""
    if model not in READERS:
        READERS[model] = new_mapping(model)
    return READERS[model]


def new_mapping(model: type[Model]) -> ReadMapping:
    """The same, made."""
    rows = [(name, key.alias or name, key.required, reader(key.annotation)) for name, key in fields_of(model).items()]
    known = keys_of(model)

    def read_mapping(data: Any, path: Path_, context: Context, findings: Findings, wrong: set[str]) -> Any:
        if type(data) is not dict:
            if not isinstance(data, model):
                findings.append(wrong_kind(path, "a mapping", data))
            return data
        values: dict[str, Any] = {}
        for name, key, required, read_value in rows:
            if key in data:
                before = len(findings)
                values[name] = read_value(data[key], (*path, key), context, findings)
                if len(findings) > before:
                    wrong.add(key)
            elif required:
                findings.append(missing(path, key, data))
                wrong.add(key)
        if len(values) < len(data):
            for key in data:
                if key not in known:
                    findings.append(unknown_key((*path, key), list(known)))
                    wrong.add(str(key))
        return model(**values)

    return read_mapping


def reader(annotation: Any) -> Read:
    """The reader of values of an annotated type."""
    origin, parts = get_origin(annotation), get_args(annotation)
    if origin is Annotated:
        return annotated(parts[0], parts[1:])
    if origin in (Union, types.UnionType) and type(None) in parts:
        others = [part for part in parts if part is not type(None)]
        return optional(reader(others[0] if len(others) == 1 else Union[tuple(others)]))  # noqa: UP007
    if origin is tuple:
        return row_of([reader(part) for part in parts])
    if origin is list:
        return list_of(reader(parts[0]))
    if origin is dict:
        return named(reader(parts[1]))
    if origin is Literal:
        return word_of(parts)
    if annotation is Any:
        return lambda value, path, context, findings: value
    if isinstance(annotation, type) and issubclass(annotation, Model):
        return lambda value, path, context, findings: mapping_of(annotation)(value, path, context, findings, set())
    return plain(*NAMES[annotation])


def annotated(inner: Any, notes: tuple[Any, ...]) -> Read:
    """The reader of a type with notes: a value of its own, one changed first, or one of several forms."""
    for note in notes:
        if isinstance(note, Value):
            return own(note.read)
        if isinstance(note, Before):
            return changed(note.change, reader(inner))
        if isinstance(note, Form):
            return formed(note.of, {tag_of(part): reader(part) for part in get_args(inner)})
    return reader(inner)


def tag_of(part: Any) -> str:
    """The form that an alternative takes."""
    return next(note.form for note in get_args(part)[1:] if isinstance(note, Tag))


def own(read_value: Callable[[Any, Context], Any]) -> Read:
    def read_own(value: Any, path: Path_, context: Context, findings: Findings) -> Any:
        try:
            return read_value(value, context)
        except Finding as finding:
            findings.append((finding.code, Found(path, finding.message, finding.hint)))
            return None

    return read_own


def changed(change: Callable[[Any], Any], then: Read) -> Read:
    def read_changed(value: Any, path: Path_, context: Context, findings: Findings) -> Any:
        try:
            value = change(value)
        except Finding as finding:
            findings.append((finding.code, Found(path, finding.message, finding.hint)))
            return None
        return then(value, path, context, findings)

    return read_changed


def formed(form_of: Callable[[Any], str], readers: dict[str, Read]) -> Read:
    def read_formed(value: Any, path: Path_, context: Context, findings: Findings) -> Any:
        form = form_of(value)
        if form in readers:
            return readers[form](value, path, context, findings)
        findings.append(wrong_form(path, readers, value))
        return None

    return read_formed


def optional(then: Read) -> Read:
    return lambda value, path, context, findings: None if value is None else then(value, path, context, findings)


def row_of(readers: list[Read]) -> Read:
    """The reader of a list of so many values, as a tuple."""
    count = len(readers)

    def read_row(value: Any, path: Path_, context: Context, findings: Findings) -> Any:
        if type(value) is not list:
            findings.append(wrong_kind(path, "a list", value))
            return None
        if len(value) > count:
            findings.append(wrong_length(path, value, count))
            return None
        pairs = zip(readers, value, strict=False)
        found = tuple([read_one(x, (*path, i), context, findings) for i, (read_one, x) in enumerate(pairs)])
        if len(value) < count:
            findings.append(wrong_length(path, value, count))
        return found

    return read_row


def list_of(read_one: Read) -> Read:
    def read_list(value: Any, path: Path_, context: Context, findings: Findings) -> Any:
        if type(value) is not list:
            findings.append(wrong_kind(path, "a list", value))
            return None
        return [read_one(x, (*path, i), context, findings) for i, x in enumerate(value)]

    return read_list


def named(read_one: Read) -> Read:
    def read_named(value: Any, path: Path_, context: Context, findings: Findings) -> Any:
        if type(value) is not dict:
            findings.append(wrong_kind(path, "a mapping", value))
            return None
        return {name: read_one(x, (*path, name), context, findings) for name, x in value.items()}

    return read_named


def word_of(words: tuple[str, ...]) -> Read:
    def read_word(value: Any, path: Path_, context: Context, findings: Findings) -> Any:
        if type(value) is not str or value not in words:
            findings.append(wrong_word(path, value, words))
        return value

    return read_word


def plain(kind: type | tuple[type, ...], expected: str) -> Read:
    def read_plain(value: Any, path: Path_, context: Context, findings: Findings) -> Any:
        if not isinstance(value, kind) or (type(value) is bool and kind is not bool):
            findings.append(wrong_kind(path, expected, value))
        return value

    return read_plain
