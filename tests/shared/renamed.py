"""A spec under other names: every named thing gets a token that no word of heun contains, or a word of heun.

`NeutralSpec` holds a spec whose names are places for tokens. What has one name in two blocks has one in both
afterwards. So a text of heun about the tokens becomes that about the words by replacing token by word.
"""

from __future__ import annotations

import json
import re
from collections.abc import Callable, Iterator, Mapping, Sequence
from typing import Any, NamedTuple, TypeAlias

Tree: TypeAlias = Any  # mappings, lists, numbers and words
# words of heun's results, tables, specs and commands, and what other languages would take for something else
WORDS = (
    "open", "total", "k", "C", "force", "moment", "point", "shares", "at", "kind", "elements", "supports", "axis",
    "mass_effect", "time", "value", "state", "none", "null", "about", "s", "side", "line", "stress", "on", "N", "M1",
    "x", "energy", "work", "status", "code", "names", "bodies", "joints", "forces", "sections", "sum", "reason",
    "number", "drive", "length", "rate", "power", "chosen", "begins", "to", "error", "condition", "case", "base",
    "title", "model", "kinetic", "potential", "scene", "ok", "constructor", "toString", "keys", "items", "T", "q",
    "values", "found", "world", "body", "spec", "heun", "version", "gear", "stop", "impulse", "min", "max", "first",
    "last", "true", "yes", "mean", "orders", "residual", "seen", "blows", "name", "events", "until", "accuracy",
    "horizon", "unknown", "table", "json", "csv", "start", "end", "rest", "free", "driven", "part", "unit", "of",
    "is", "set", "plane", "tension",
)  # fmt: skip
MAPPINGS = (
    "parameters", "bodies", "joints", "drives", "forces", "impulses", "stops", "latches", "couplings", "rolling",
    "sections", "tables", "cases",
)  # fmt: skip
WORDS_ONLY = frozenset({  # keys of values that name nothing of the scene
    "type", "frame", "title", "space", "side", "sequence", "method", "interpolation", "outside", "file", "units",
    "contact", "x_unit", "y_unit", "unit", "gaps",
})  # fmt: skip
NUMBER = r"(?:\d+\.?\d*|\.\d+)(?:[eE][-+]?\d+)?"
TOKEN = re.compile(rf"{NUMBER}(?:\s*[A-Za-z°µ%]\w*(?:[/·^]\w+)*)?|(?P<name>[A-Za-z]\w*)")
WITH_UNIT = re.compile(r"\s*[-+]?(\d+\.?\d*|\.\d+)([eE][-+]?\d+)?\s+[A-Za-z°µ%][^()+]*\Z")


class NeutralSpec(NamedTuple):
    """A spec as JSON text with marks for its names, and the blocks in which each name stands, `points` among them."""

    text: str
    blocks: Mapping[str, frozenset[str]]

    def named(self, tokens: Mapping[str, str]) -> str:
        """The spec with these names."""
        return MARK.sub(lambda found: tokens[found[1]], self.text)


MARK = re.compile("\x00(\\w+)\x01")


def names_of(tree: Tree) -> dict[str, set[str]]:
    """Every name of a spec, and the blocks in which it is given."""
    found: dict[str, set[str]] = {}
    for block in MAPPINGS:
        for name in tree.get(block) or {}:
            found.setdefault(name, set()).add(block)
    for owner in (tree.get("ground") or {}, *(tree.get("bodies") or {}).values()):
        for name in owner.get("points") or {}:
            found.setdefault(name, set()).add("points")
    for name in (tree.get("analysis") or {}).get("events") or {}:
        found.setdefault(name, set()).add("events")
    return found


def neutral(tree: Tree) -> NeutralSpec:
    """The spec with a mark in place of every name."""
    blocks = names_of(tree)

    def mark(word: str) -> str:
        return f"\x00{word}\x01" if word in blocks else word

    def told(path: tuple[str, ...], value: Tree) -> Tree:
        if isinstance(value, dict):
            return {_key(path, key, mark): told((*path, key), own) for key, own in value.items()}
        if isinstance(value, list):
            return [told(path, own) for own in value]
        if not isinstance(value, str) or (path and path[-1] in WORDS_ONLY) or WITH_UNIT.fullmatch(value):
            return value
        return _renamed(path, value, mark)

    text = json.dumps(told((), tree), ensure_ascii=False, indent=1)
    return NeutralSpec(
        text.replace("\\u0000", "\x00").replace("\\u0001", "\x01"), {n: frozenset(b) for n, b in blocks.items()}
    )


def _key(path: tuple[str, ...], key: str, mark: Callable[[str], str]) -> str:
    """A key: a name in the blocks of names, a dotted path in what a case sets."""
    if path[-1:] == ("points",) or path == ("analysis", "events") or (len(path) == 1 and path[0] in MAPPINGS):
        return mark(key)
    return _renamed((*path, key), key, mark) if path[-1:] == ("set",) else key


def _renamed(path: tuple[str, ...], value: str, mark: Callable[[str], str]) -> str:
    """The names in a reference, a path into the results or an expression."""
    if path[-1:] in (("of",), ("peak",)) or path[:1] == ("report",):
        words = value.split(".")
        if words[0] in PATHS:
            return ".".join(_of_path(words, mark))
    return _in_expression(value, mark)


PATHS = frozenset({
    "bodies", "points", "coordinates", "foundation", "joints", "stops", "couplings", "sections", "forces", "impulses",
    "events", "energy", "momentum", "system_vector", "accuracy", "time", "model",
})  # fmt: skip
NAMES_BEHIND = frozenset({"supports", "elements", "shares", "on"})  # a name follows these
QUANTITIES = frozenset({"angle", "rate", "travel", "speed", "length", "x", "y", "z", "vx", "vy", "vz", "acceleration"})


def _of_path(words: Sequence[str], mark: Callable[[str], str]) -> Iterator[str]:
    """A path into the results with its names marked."""
    block, *rest = words
    yield block
    if block == "impulses":
        yield rest[0]
        yield from _of_path(rest[1:], mark)
        return
    names = {"points": 2, "foundation": 0}.get(block, 1)
    for place, word in enumerate(rest):
        behind = place > max(names - 1, 0) and rest[place - 1] in NAMES_BEHIND
        named = place < names or behind
        yield mark(word) if named else word


def _in_expression(value: str, mark: Callable[[str], str]) -> str:
    """A reference or an expression with its names marked: numbers with their units, functions and quantities stay."""

    def told(found: re.Match[str]) -> str:
        word = found["name"]
        if not word or value[found.end() :].lstrip()[:1] == "(":
            return found[0]
        is_quantity = value[: found.start()].endswith(".") and not value[found.end() :].startswith(".")
        return found[0] if is_quantity and word in QUANTITIES else mark(word)

    return TOKEN.sub(told, value)


def tokens_for(words: Sequence[str]) -> dict[str, str]:
    """A token of every word: none is part of another; they sort as the words do, and are as long."""
    found = {}
    for place, word in enumerate(sorted(set(words))):
        token = "Ж" + LETTERS[place // len(LETTERS)] + LETTERS[place % len(LETTERS)]
        found[word] = token + "ж" * (len(word) - len(token))
    return found


LETTERS = "абвгдеийклмнопрстуфхцчшщъыьэю"


def with_words(text: str, tokens: Mapping[str, str]) -> str:
    """A text about tokens as one about their words."""
    for word, token in sorted(tokens.items(), key=lambda item: -len(item[1])):
        text = text.replace(token, word)
    return text
