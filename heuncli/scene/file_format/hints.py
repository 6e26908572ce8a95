"""Hints for what newcomers write: a key in another place, by another name, or with a value of another form."""

from __future__ import annotations

import re
from collections.abc import Collection
from typing import Any

from heuncli.base.nearest import did_you_mean, nearest
from heuncli.scene.file_format import format as f
from heuncli.scene.file_format.entries import keys_of
from heuncli.scene.file_format.words import (
    BY_KEYS,
    ELSEWHERE,
    FORMS,
    FORMS_OF_KINDS,
    JOINTS,
    KEY_WORDS,
    MISSING,
    OF_THREADS,
    PLACES,
    SEVERAL,
    WORDS,
)

AXES = {"x": "[1, 0, 0]", "y": "[0, 1, 0]", "z": "[0, 0, 1]"}
DIRECTIONS = frozenset({"axis", "to_axis", "normal", "first_axis"})
COORDINATES = frozenset({"angle", "rate", "travel", "speed"})


def called(key: str, known: Collection[str]) -> str | None:
    """What a key of another program is called here, if it is one of the known ones."""
    word = key.lower()
    return next((name for name in (KEY_WORDS.get(word), *SEVERAL.get(word, ())) if name in known), None)


def of_key(key: str, known: Collection[str]) -> str:
    """What to write in place of an unknown key."""
    if key[:1].isdigit():
        return "a decimal is written with a point, as 1.5; a comma ends the value"
    if key.count(")") > key.count("("):
        return "inside { } an expression with a comma is written in quotes"
    word = called(key, known)
    if word is not None:
        return f"it is called {word} here"
    return belonging(key, known) or elsewhere(key) or did_you_mean(key, known, "keys here")


def stands_for(key: str, known: Collection[str]) -> str | None:
    """Which of the known keys an unknown one is told to be: by the name of another program, or misspelt."""
    word = called(key, known)
    if word is not None or key[:1].isdigit() or belonging(key, known) or elsewhere(key):
        return word
    return nearest(key, known)


def belonging(key: str, known: Collection[str]) -> str | None:
    """Where a key of the format belongs that stands in a wrong place."""
    if "heun" in known:
        for block, model in f.SINGLE.items():
            word = key if key in keys_of(model) else called(key, keys_of(model))
            if word is not None and (block == "analysis" or word == key):
                return f"it belongs under {block}: {block}: {{{word}: ...}}"
        if key in keys_of(f.BodyEntry):
            return f"it belongs to a body: bodies: {{NAME: {{{key}: ...}}}}"
    if key in COORDINATES and "initial" in known:
        return f"the start of a coordinate is initial: {{{key}: ...}}"
    if "lead" in known and key in OF_THREADS:
        return (
            "friction: {coefficient: 0.12, radius: 14 mm, speed: 0.01}, or with efficiency: 0.4 in place of the first"
        )
    for keys, words in BY_KEYS:
        if key.lower() in words and set(keys) <= set(known):
            return words[key.lower()]
    if key == "initial" and "length" in known:
        return "a rod starts as it is assembled, or with its length: ..."
    if key == "initial" and {"from", "to"} <= set(known):
        return (
            "only a pin, slide or cylinder has coordinates; else the start is the body's: "
            "bodies: {NAME: {orientation: ..., angular_velocity: [0, 0, 1]}}"
        )
    return None


def elsewhere(word: str) -> str | None:
    """Where what a word means is written, if not where it was."""
    word = word.lower()
    return ELSEWHERE.get(word) or (ELSEWHERE["stops"] if KEY_WORDS.get(word) == "stops" else None)


def of_missing(key: str, present: Collection[str]) -> str:
    """What a missing key is, or which one stands for it."""
    other = next((name for name in present if called(name, [key])), None)
    if other is not None:
        return f"'{other}' is called {key} here"
    return JOINTS if key == "of" and "type" in present else MISSING.get(key, f"add {key}: ...")


def of_form(key: str, found: Any, wanted: str) -> str:
    """What a value should look like; wanted: "a list", "a mapping", ... as it is told."""
    if wanted == "a list" and (key == "of" or key in FORMS):
        return JOINTS if key == "of" else FORMS[key]
    if wanted == "a list" and isinstance(found, str) and re.fullmatch(r"[+-]?[xyzXYZ]", found.strip()):
        axis = AXES[found.strip()[-1].lower()]
        return f"the {found.strip()[-1].lower()} axis is {axis.replace('1', '-1') if found.strip()[0] == '-' else axis}"
    if key in DIRECTIONS:
        return "a direction, as [0, 0, 1]"
    if wanted == "a list" and isinstance(found, dict):
        return "a list has a dash before each of its entries, or [ ] around them"
    if wanted == "a list" and key in PLACES:
        return "three coordinates [x, y, z], as [0.5, 0, 0]"
    if wanted == "a list":
        return "three components, as [0, 0, 1]" if not isinstance(found, str) else f"a list is [{found}, ...]"
    return FORMS.get(key) or FORMS_OF_KINDS.get(wanted) or f"write {wanted} behind {key or 'it'}:"


def of_word(word: str, known: Collection[str]) -> str:
    """Which of the allowed words was meant."""
    near = next((name for name in WORDS.get(word.lower(), ()) if name in known), None) or nearest(word, known)
    return f"did you mean {near}?" if near is not None else f"write one of them, as {next(iter(known))}"
