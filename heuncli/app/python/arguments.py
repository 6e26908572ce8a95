"""Check the types of Python arguments, and convert them to a spec: a mapping in place of a file, and values of entries.

All wrong arguments of a call are refused at once, by name. Booleans do not count as numbers, nor NumPy arrays as
booleans; a list of texts that contains a number is refused as well.

In a mapping, NumPy numbers and arrays count as numbers and lists, tuples as lists, paths as text. Any other type that
YAML does not have is refused with its location. There are no line numbers: locations are key paths only.
"""

from __future__ import annotations

import math
import os
from collections.abc import Callable, Iterable, Iterator, Mapping
from numbers import Integral, Real

import numpy as np

from heuncli.base.errors import Problem, SourceLocation, SpecError, UsageError
from heuncli.base.named_tuples import NamedTuple
from heuncli.base.text_safety import escape
from heuncli.scene.file_format.parameters import Setting
from heuncli.scene.file_format.reading import STANDARD_INPUT, digest
from heuncli.scene.file_format.source import MAX_DEPTH, TOO_DEEP, TOO_DEEP_HINT, Mark, Path_, SourceFile, format_path


class ArgumentKind(NamedTuple):
    """A type of argument: the test of a value, the type in words, and an example in Python."""

    accepts: Callable[[object], bool]
    words: str
    example: str


def _is_number(value: object) -> bool:
    """Return whether a value is a real number; True and False are none."""
    return isinstance(value, Real) and not isinstance(value, bool | np.bool_)


def _is_text_or_texts(value: object) -> bool:
    """Return whether a value is a text, or a collection of texts that can be read twice."""
    if isinstance(value, str):
        return True
    is_series = isinstance(value, Iterable) and not isinstance(value, Mapping | bytes)
    return is_series and iter(value) is not value and all(isinstance(each, str) for each in value)  # type: ignore[call-overload, attr-defined]


def _is_number_or_numbers(value: object) -> bool:
    """Return whether a value is a number, or a collection of numbers."""
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


MAPPING_NAME, TEXT_NAME = "<mapping>", "<text>"  # in place of a file name in locations
NO_LINE: Mark = (-1, -1)
MAX_LETTERS = 60  # letters of a value in a location
MAX_INTEGER = 10**300  # of integers; larger ones become infinite
KEYS = "keys of a mapping are strings"
READ_OTHERWISE = "PyYAML reads the key `on` as True: give the file, or its text as text="
SpecSource = str | os.PathLike[str] | Mapping[str, object]


def resolve_source(spec: SpecSource | None, text: str | None) -> tuple[str, str | SourceFile | None]:
    """Return the name of the spec, and the content that replaces the file: None, the text, or the mapping. Raises
    UsageError.

    spec: a path, or a mapping built in Python
    text: YAML; a path given with it only names it
    """
    if isinstance(spec, Mapping):
        if text is not None:
            raise _make_usage_error("both a mapping and text= are given", "give one of them")
        return MAPPING_NAME, make_source(spec)
    if spec is None:
        if text is None:
            raise _make_usage_error("no spec is given", "give a path, a mapping, or text=YAML")
        return TEXT_NAME, text
    name = os.fspath(spec) if isinstance(spec, str | os.PathLike) else None
    if not isinstance(name, str):
        raise _make_usage_error(f"{type(spec).__name__} is not a path", "give a path, a mapping, or text=YAML")
    if "\n" in name and text is None:
        raise _make_usage_error("this path has several lines", "pass YAML text as text=")
    if name == STANDARD_INPUT and text is None:
        raise _make_usage_error("- is not a file", "pass standard input as text=sys.stdin.read()")
    return name, text


def _make_usage_error(message: str, hint: str) -> UsageError:
    """Make the error of an invalid argument `spec`."""
    return UsageError(Problem("bad-option", f"spec: {message}", hint=hint))


def make_source(spec: Mapping[str, object]) -> SourceFile:
    """Convert a mapping to the content of a source file. Raises SpecError for values that YAML does not have."""
    import json  # 2 ms that files do not need

    values: dict[Path_, Mark] = {}
    data = _to_plain(spec, (), values, MAPPING_NAME)
    return SourceFile(MAPPING_NAME, digest(json.dumps(data).encode()), data, values, dict(values))


def make_settings(overrides: Mapping[str, object], parameters: Mapping[str, object]) -> list[Setting]:
    """Make the settings of dotted keys and parameters (`set=`), and of parameters that are keyword arguments.

    The location of each is the text of its argument: `n='1500 rpm'`. Raises SpecError, UsageError.
    """
    if duplicates := overrides.keys() & parameters.keys():
        message = f"{', '.join(sorted(duplicates))}: set twice, as an argument and in set="
        raise UsageError(Problem("bad-option", message, hint="keep one"))
    return list(_iter_settings({**overrides, **parameters}))


def _iter_settings(values: Mapping[str, object]) -> Iterator[Setting]:
    """Yield the values to set in a spec, each with its name as location."""
    for key, value in values.items():
        plain = _to_plain(value, (key,), {}, f"{key}=...")
        text = repr(plain)
        word = f"{key}={text if len(text) <= MAX_LETTERS else text[:MAX_LETTERS] + '...'}"
        yield Setting(key, plain, SourceLocation(word, 0, 0, key), SourceLocation(word, 0, 0))


def _to_plain(value: object, path: Path_, places: dict[Path_, Mark], file: str) -> object:
    """Convert a value to what YAML would give; adds the key paths of it and of its members to `places`."""
    places[path] = NO_LINE
    if len(path) > MAX_DEPTH:
        raise _make_spec_error("too-deep", TOO_DEEP, path, file, TOO_DEEP_HINT)
    if isinstance(value, np.generic | np.ndarray):
        value = value.tolist()
    if isinstance(value, Mapping):
        wrong = next((key for key in value if not isinstance(key, str)), None)
        if wrong is not None:
            message = f"expected a string as key, found {type(wrong).__name__}"
            raise _make_spec_error("wrong-kind", message, path, file, READ_OTHERWISE if type(wrong) is bool else KEYS)
        return {str(key): _to_plain(member, (*path, str(key)), places, file) for key, member in value.items()}
    if isinstance(value, list | tuple):
        return [_to_plain(member, (*path, i), places, file) for i, member in enumerate(value)]
    if value is None or isinstance(value, bool):
        return value
    if isinstance(value, str):
        return str(value)
    if isinstance(value, int):
        return int(value) if abs(value) < MAX_INTEGER else math.inf * (1 if value > 0 else -1)
    if isinstance(value, float):
        return float(value)
    if isinstance(value, os.PathLike):
        return os.fspath(value)
    message = f"{type(value).__name__} is not allowed in a spec"
    raise _make_spec_error("wrong-kind", message, path, file, "use numbers, strings, lists and mappings")


def _make_spec_error(code: str, message: str, path: Path_, file: str, hint: str) -> SpecError:
    """Make the error of a value in a mapping, located by its keys."""
    return SpecError(Problem(code, message, SourceLocation(file, 0, 0, escape(format_path(path))), hint))
