"""Load cases: what one of them sets, in the way of `--set`, and what is wrong with it."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from typing import Any

from heuncli.base.errors import Problem, SpecError
from heuncli.base.nearest import did_you_mean
from heuncli.scene.file_format.names import mapping
from heuncli.scene.file_format.overrides import Setting, override
from heuncli.scene.file_format.source import SourceFile

CASES = "cases"
NOT_CASES = "a case sets values of the scene; another case stands beside it"


def cases_of(data: Mapping[str, Any]) -> dict[str, dict[str, Any]]:
    """What each load case sets, by its name, of plain data of any shape."""
    return {name: mapping(mapping(case).get("set")) for name, case in mapping(data.get(CASES)).items()}


def settings_of(name: str, source: SourceFile) -> list[Setting]:
    """What a load case sets. Raises SpecError [unknown-case]."""
    known = cases_of(mapping(source.data))
    if name not in known:
        hint = did_you_mean(name, known, "cases") if known else "cases: {NAME: {set: {PARAMETER: VALUE}}}"
        raise SpecError(Problem("unknown-case", f"there is no load case '{name}'", source.location((CASES,)), hint))
    path = (CASES, name, "set")
    return [
        Setting(key, value, source.location((*path, key)), source.location((*path, key), key=True))
        for key, value in known[name].items()
    ]


def faults(data: dict[str, Any], source: SourceFile) -> Iterator[Problem]:
    """What the cases set and cannot, so that it is told with the rest of a file."""
    for name in cases_of(data):
        settings = settings_of(name, source)
        for each in settings:
            if each.key.split(".")[0] == CASES:
                yield Problem("no-such-key", f"'{each.key}' in a load case", each.key_location, NOT_CASES)
        yield from override(data, [each for each in settings if each.key.split(".")[0] != CASES])[2]
