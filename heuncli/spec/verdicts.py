"""What reading one entry may object to, in the words and codes of specs."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from typing import Any

from heuncli.nearest import did_you_mean, nearest
from heuncli.spec.quantity import Follows, kind_of
from heuncli.spec.rules.registry import Found, Path_
from heuncli.spec.words import KEY_WORDS, LATER, TYPES

FORMS = {"single": "a number", "list": "a list", "rows": "a list of lists", "mapping": "a mapping"}


def is_told(code: str) -> bool:
    """Whether a finding is one of its own, not the consequence of another."""
    return code != Follows().code


def wrong_kind(path: Path_, expected: str, value: Any) -> tuple[str, Found]:
    """A value of another kind than its key takes."""
    hint = "write it in quotes" if expected == "a text" and isinstance(value, int | float | bool) else None
    return "wrong-kind", Found(path, f"expected {expected}, found {kind_of(value)}", hint)


def wrong_length(path: Path_, values: list[Any], needed: int) -> tuple[str, Found]:
    """A list with more or fewer values than its key takes."""
    cut = len(values) > needed and any(isinstance(v, str) and v.count("(") > v.count(")") for v in values)
    hint = "inside [ ] an expression with a comma is written in quotes" if cut else None
    return "wrong-length", Found(path, f"{len(values)} values instead of {needed}", hint)


def missing(path: Path_, key: str, owner: dict[str, Any]) -> tuple[str, Found]:
    """A key that must be there."""
    if key == "heun":
        return "missing-key", Found(path, "'heun' is missing", "a spec starts with the line 'heun: 1'")
    present = [k for k in owner if KEY_WORDS.get(k) == key]
    hint = f"'{present[0]}' is called {key} here" if present else None
    return "missing-key", Found(path, f"'{key}' is missing", hint, key=True)


def unknown_key(path: Path_, known: list[str]) -> tuple[str, Found]:
    """A key that means nothing here."""
    key = str(path[-1])
    if ("keys", key) in LATER:
        return "not-yet", Found(path, f"not yet: {key}", key=True)
    if key.isdigit() and key not in known:
        comma = "a decimal is written with a point, as 1.5; a comma ends the value"
        return "unknown-key", Found(path, f"'{key}' is not known here", comma, key=True)
    word = KEY_WORDS.get(key.lower())
    hint = f"it is called {word} here" if word in known else did_you_mean(key, known, "keys here")
    return "unknown-key", Found(path, f"'{key}' is not known here", hint, key=True)


def unknown_type(entry: Any, block: str, known: list[str]) -> tuple[str, Found]:
    """An entry that is no mapping, or whose type is none; its path is within the entry."""
    code, what, words = TYPES[block]
    listed = ", ".join(known)
    if type(entry) is not dict:
        return "wrong-kind", Found((), f"expected a mapping, found {kind_of(entry)}")
    if "type" not in entry:
        return "missing-key", Found((), "'type' is missing", f"known: {listed}", key=True)
    tag = entry["type"]
    if type(tag) is not str:
        return "wrong-kind", Found(("type",), f"expected {what}, found {kind_of(tag)}", f"known: {listed}")
    if (block, tag) in LATER:
        return "not-yet", Found(("type",), f"not yet: {what.removeprefix('a ')} {tag}")
    word = words.get(tag.lower().replace("-", "_"))
    hint = f"{article(tag)} {tag} is type: {word}" if word else did_you_mean(tag, known, "types")
    return code, Found(("type",), f"'{tag}' is not {what}; known: {listed}", hint)


def wrong_form(path: Path_, tags: Iterable[str], value: Any) -> tuple[str, Found]:
    """A value in a form that its key does not take."""
    forms = " or ".join("a name" if tag == "single" and path[-1:] == ("at",) else FORMS[tag] for tag in tags)
    return "wrong-kind", Found(path, f"expected {forms}, found {kind_of(value)}")


def article(word: str) -> str:
    return "an" if word[:1].lower() in "aeio" else "a"


def wrong_word(path: Path_, found: Any, known: Sequence[str]) -> tuple[str, Found]:
    """A word that is none of those that may stand here."""
    if not isinstance(found, str):
        return "wrong-kind", Found(path, f"expected one of {', '.join(known)}, found {kind_of(found)}")
    near = nearest(found, known)
    message = f"'{found}' is not known here; known: {', '.join(known)}"
    return "unknown-word", Found(path, message, f"did you mean {near}?" if near else None)
