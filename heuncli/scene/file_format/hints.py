"""Hints for common mistakes: a key in the wrong place, under another name, or with a value of the wrong form."""

from __future__ import annotations

import re
from collections.abc import Collection
from typing import Any

from heuncli.base.spelling import find_similar, suggest
from heuncli.scene.file_format import format as f
from heuncli.scene.file_format.entries import keys_of
from heuncli.scene.file_format.foreign_words import (
    AMBIGUOUS_WORDS,
    COORDINATE_KEYS,
    FORM_HINTS,
    HINTS_BY_KEYS,
    JOINT_LIST_HINT,
    KEY_WORDS,
    KIND_HINTS,
    MISPLACED_KEYS,
    MISSING_KEY_HINTS,
    THREAD_FRICTION_KEYS,
    VALUE_WORDS,
)

AXES = {"x": "[1, 0, 0]", "y": "[0, 1, 0]", "z": "[0, 0, 1]"}
DIRECTIONS = frozenset({"axis", "to_axis", "normal", "first_axis"})
COORDINATES = frozenset({"angle", "rate", "travel", "speed"})


def find_native_key(key: str, known_keys: Collection[str]) -> str | None:
    """Return heun's name for a key of another program, if it is among the known keys."""
    word = key.lower()
    return next((name for name in (KEY_WORDS.get(word), *AMBIGUOUS_WORDS.get(word, ())) if name in known_keys), None)


def unknown_key_hint(key: str, known_keys: Collection[str]) -> str:
    """Return a hint on what to write instead of an unknown key."""
    if key[:1].isdigit():
        return "write decimals with a point: 1.5; a comma ends the value"
    if key.count(")") > key.count("("):
        return "inside { } put an expression with a comma in quotes"
    word = find_native_key(key, known_keys)
    if word is not None:
        return f"it is called {word} here"
    return misplaced_key_hint(key, known_keys) or misplaced_word_hint(key) or suggest(key, known_keys, "keys here")


def find_intended_key(key: str, known_keys: Collection[str]) -> str | None:
    """Return the known key that the hint for an unknown key names: a synonym or a misspelling."""
    word = find_native_key(key, known_keys)
    if word is not None or key[:1].isdigit() or misplaced_key_hint(key, known_keys) or misplaced_word_hint(key):
        return word
    return find_similar(key, known_keys)


def misplaced_key_hint(key: str, known_keys: Collection[str]) -> str | None:
    """Return a hint on where a key of the format belongs, if it is in the wrong place."""
    if "heun" in known_keys:
        for block, model in f.SINGLE_BLOCKS.items():
            word = key if key in keys_of(model) else find_native_key(key, keys_of(model))
            if word is not None and (block == "analysis" or word == key):
                return f"it belongs under {block}: {block}: {{{word}: ...}}"
        if key in keys_of(f.BodyEntry):
            return f"it belongs to a body: bodies: {{NAME: {{{key}: ...}}}}"
    if key in COORDINATES and "initial" in known_keys:
        return f"give the start of a coordinate as initial: {{{key}: ...}}"
    if "lead" in known_keys and key in THREAD_FRICTION_KEYS:
        return "friction: {coefficient: 0.12, radius: 14 mm}, or with efficiency: 0.4 in place of coefficient"
    for keys, words in HINTS_BY_KEYS:
        if key.lower() in words and set(keys) <= set(known_keys):
            return words[key.lower()]
    if key == "initial" and "length" in known_keys:
        return "a rod starts as assembled, or with a given length: ..."
    if key == "initial" and {"from", "to"} <= set(known_keys):
        return (
            "only a pin, slide or cylinder has coordinates; otherwise give the start of the body: "
            "bodies: {NAME: {orientation: ..., angular_velocity: [0, 0, 1]}}"
        )
    return None


def misplaced_word_hint(word: str) -> str | None:
    """Return a hint where a word belongs in the format, if it was written in the wrong place."""
    word = word.lower()
    return MISPLACED_KEYS.get(word) or (MISPLACED_KEYS["stops"] if KEY_WORDS.get(word) == "stops" else None)


def missing_key_hint(key: str, present: Collection[str]) -> str:
    """Return a hint on a missing key: what it is, or which present key stands for it."""
    synonym = next((name for name in present if find_native_key(name, [key])), None)
    if synonym is not None:
        return f"'{synonym}' is called {key} here"
    return JOINT_LIST_HINT if key == "of" and "type" in present else MISSING_KEY_HINTS.get(key, f"add {key}: ...")


def form_hint(key: str, value: Any, expected_kind: str) -> str:
    """Return a hint on what a value should look like.

    expected_kind: "a list", "a mapping", ... as in the message
    """
    if expected_kind == "a list" and (key == "of" or key in FORM_HINTS):
        return JOINT_LIST_HINT if key == "of" else FORM_HINTS[key]
    if expected_kind == "a list" and isinstance(value, str) and re.fullmatch(r"[+-]?[xyzXYZ]", value.strip()):
        axis = AXES[value.strip()[-1].lower()]
        return f"the {value.strip()[-1].lower()} axis is {axis.replace('1', '-1') if value.strip()[0] == '-' else axis}"
    if key in DIRECTIONS:
        return "a direction such as [0, 0, 1]"
    if expected_kind == "a list" and isinstance(value, dict):
        return "write a list with a dash before each entry, or in [ ]"
    if expected_kind == "a list" and key in COORDINATE_KEYS:
        return "three coordinates [x, y, z], for example [0.5, 0, 0]"
    if expected_kind == "a list":
        return (
            "three components, for example [0, 0, 1]" if not isinstance(value, str) else f"write a list: [{value}, ...]"
        )
    return FORM_HINTS.get(key) or KIND_HINTS.get(expected_kind) or f"write {expected_kind} after {key or 'it'}:"


def word_hint(word: str, allowed: Collection[str]) -> str:
    """Return a hint on which of the allowed words was meant."""
    suggestion = next((name for name in VALUE_WORDS.get(word.lower(), ()) if name in allowed), None) or find_similar(
        word, allowed
    )
    return (
        f"did you mean {suggestion}?"
        if suggestion is not None
        else f"write one of them, for example {next(iter(allowed))}"
    )
