"""Check the types of Python arguments, and refuse all wrong ones of a call at once, by name.

Booleans do not count as numbers, nor NumPy arrays as booleans; a list of texts that contains a number is refused as
well.
"""

from __future__ import annotations

import os
from collections.abc import Callable, Iterable, Mapping
from numbers import Integral, Real

import numpy as np

from heuncli.base.errors import Problem, UsageError
from heuncli.base.named_tuples import NamedTuple


class ArgumentKind(NamedTuple):
    """A type of argument: the test of a value, the type in words, and an example in Python."""

    accepts: Callable[[object], bool]
    words: str
    example: str


def _is_number(value: object) -> bool:
    return isinstance(value, Real) and not isinstance(value, bool | np.bool_)


def _is_text_or_texts(value: object) -> bool:
    if isinstance(value, str):
        return True
    is_series = isinstance(value, Iterable) and not isinstance(value, Mapping | bytes)
    return is_series and iter(value) is not value and all(isinstance(each, str) for each in value)  # type: ignore[call-overload, attr-defined]


def _is_number_or_numbers(value: object) -> bool:
    if _is_number(value):
        return True
    if isinstance(value, str | bytes | Mapping) or not isinstance(value, Iterable):
        return False
    try:
        array = np.asarray(value)
    except ValueError:  # rows of different lengths
        return False
    return array.size == 0 or array.dtype.kind in "iuf"


TEXT = ArgumentKind(lambda value: isinstance(value, str), "a string", "'...'")
TEXTS = ArgumentKind(_is_text_or_texts, "a string or a list of strings", "['joints', 'energy']")
NUMBER = ArgumentKind(_is_number, "a number", "0.5")
INTEGER = ArgumentKind(lambda value: isinstance(value, Integral) and _is_number(value), "a whole number", "10")
NUMBERS = ArgumentKind(_is_number_or_numbers, "a number or an array of numbers", "[0.1, 0.2]")
NUMBER_OR_TEXT = ArgumentKind(lambda value: isinstance(value, str) or _is_number(value), "a number or a string", "0.5")
BOOLEAN = ArgumentKind(lambda value: isinstance(value, bool | np.bool_), "True or False", "True")
CAPTIONS = ArgumentKind(
    lambda value: isinstance(value, Mapping) and all(isinstance(word, str) for pair in value.items() for word in pair),
    "a mapping of paths to strings",
    "{'joints.main': 'Main bearing'}",
)
MAPPING = ArgumentKind(lambda value: isinstance(value, Mapping), "a mapping", "{'bodies.rod.mass': 2}")
FILE = ArgumentKind(lambda value: isinstance(value, str | os.PathLike), "a file name", "'results.json'")


def check_arguments(*arguments: tuple[str, object, ArgumentKind], optional: bool = True) -> None:
    """Require that each argument (name, value, kind) is of its kind.

    optional: None is allowed, and means that the argument is not given

    Raises UsageError with a problem for each wrong argument.
    """
    problems = []
    for name, value, kind in arguments:
        if (value is None and optional) or kind.accepts(value):
            continue
        message = f"{name}: expected {kind.words}, found {type(value).__name__}"
        problems.append(Problem("bad-option", message, hint=f"for example {name}={kind.example}"))
    if problems:
        raise UsageError(*problems)
