"""What Python gives in place of a file and of words: a mapping that is a spec, and values that are set in one.

NumPy's numbers and arrays count as numbers and lists, tuples as lists, paths as text; whatever is not a value of YAML
is refused by the place at which it stands. There are no lines: places are paths alone.
"""

from __future__ import annotations

import math
import os
from collections.abc import Iterator, Mapping

import numpy as np

from heuncli.base.errors import Problem, SourceLocation, SpecError, UsageError
from heuncli.base.foreign_text import shown
from heuncli.scene.file_format.digest import digest
from heuncli.scene.file_format.overrides import Setting
from heuncli.scene.file_format.reading import STANDARD_INPUT
from heuncli.scene.file_format.source import DEEPEST, TOO_DEEP, TOO_DEEP_HINT, Mark, Path_, SourceFile, dotted

MAPPING, TEXT = "<mapping>", "<text>"  # what stands in places in front of paths, where there is no file
NO_LINE: Mark = (-1, -1)
LONG = 60  # letters of a value that are told in a place
LARGEST = 10**300  # of whole numbers: what is larger is no number of a scene
KEYS = "keys of a mapping are texts"
READ_OTHERWISE = "PyYAML takes the word on for true: give the file, or its text as text="
SpecGiven = str | os.PathLike[str] | Mapping[str, object]


def source_of(spec: SpecGiven | None, text: str | None) -> tuple[str, str | SourceFile | None]:
    """The name of what is read, and what stands for the file: None, the text, or the mapping. Raises UsageError.

    spec: a path, or a mapping built in Python; text: YAML, for which the path, if there is one, is a name alone.
    """
    if isinstance(spec, Mapping):
        if text is not None:
            raise _unclear("a mapping and a text are given", "give one of them")
        return MAPPING, source_in(spec)
    if spec is None:
        if text is None:
            raise _unclear("no spec is given", "a path, a mapping, or text=YAML")
        return TEXT, text
    name = os.fspath(spec) if isinstance(spec, str | os.PathLike) else None
    if not isinstance(name, str):
        raise _unclear(f"{type(spec).__name__} is no path", "a path, a mapping, or text=YAML")
    if "\n" in name and text is None:
        raise _unclear("this path has several lines", "a text of YAML is given as text=")
    if name == STANDARD_INPUT and text is None:
        raise _unclear("- is no file", "read standard input yourself: text=sys.stdin.read()")
    return name, text


def _unclear(message: str, hint: str) -> UsageError:
    return UsageError(Problem("bad-option", f"spec: {message}", hint=hint))


def source_in(spec: Mapping[str, object]) -> SourceFile:
    """A mapping as what a file holds. Raises SpecError for what cannot stand in one."""
    import json  # 2 ms that files do not need

    values: dict[Path_, Mark] = {}
    data = _plain(spec, (), values, MAPPING)
    return SourceFile(MAPPING, digest(json.dumps(data).encode()), data, values, dict(values))


def settings_of(given: Mapping[str, object], named: Mapping[str, object]) -> list[Setting]:
    """Values to be set: of dotted keys or parameters, and of parameters that are arguments.

    Raises SpecError, UsageError. They have as their place what was given: `n='1500 rpm'`.
    """
    if twice := given.keys() & named.keys():
        message = f"{', '.join(sorted(twice))}: set twice, as an argument and in set="
        raise UsageError(Problem("bad-option", message, hint="keep one"))
    return list(_settings({**given, **named}))


def _settings(given: Mapping[str, object]) -> Iterator[Setting]:
    for key, value in given.items():
        plain = _plain(value, (key,), {}, f"{key}=...")
        told = repr(plain)
        word = f"{key}={told if len(told) <= LONG else told[:LONG] + '...'}"
        yield Setting(key, plain, SourceLocation(word, 0, 0, key), SourceLocation(word, 0, 0))


def _plain(value: object, path: Path_, places: dict[Path_, Mark], file: str) -> object:
    """A value as YAML would give it; places: of it and all within it."""
    places[path] = NO_LINE
    if len(path) > DEEPEST:
        raise _refused("too-deep", TOO_DEEP, path, file, TOO_DEEP_HINT)
    if isinstance(value, np.generic | np.ndarray):
        value = value.tolist()
    if isinstance(value, Mapping):
        wrong = next((key for key in value if not isinstance(key, str)), None)
        if wrong is not None:
            message = f"a key is a plain word, found {type(wrong).__name__}"
            raise _refused("wrong-kind", message, path, file, READ_OTHERWISE if type(wrong) is bool else KEYS)
        return {str(key): _plain(member, (*path, str(key)), places, file) for key, member in value.items()}
    if isinstance(value, list | tuple):
        return [_plain(member, (*path, i), places, file) for i, member in enumerate(value)]
    if value is None or isinstance(value, bool):
        return value
    if isinstance(value, str):
        return str(value)
    if isinstance(value, int):
        return int(value) if abs(value) < LARGEST else math.inf * (1 if value > 0 else -1)
    if isinstance(value, float):
        return float(value)
    if isinstance(value, os.PathLike):
        return os.fspath(value)
    message = f"{type(value).__name__} is no value of a spec"
    raise _refused("wrong-kind", message, path, file, "numbers, texts, lists and mappings are")


def _refused(code: str, message: str, path: Path_, file: str, hint: str) -> SpecError:
    return SpecError(Problem(code, message, SourceLocation(file, 0, 0, shown(dotted(path))), hint))
