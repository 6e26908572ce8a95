"""Load cases: the settings of a case, as those of `--set`, and the problems with them."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from typing import Any

from heuncli.base.errors import Problem, SpecError
from heuncli.base.spelling import suggest
from heuncli.scene.file_format.names import as_mapping
from heuncli.scene.file_format.overrides import Setting, apply_settings
from heuncli.scene.file_format.source import SourceFile

CASES = "cases"
NESTED_CASE_HINT = "a case sets values of the model; write another case next to it"


def get_case_values(data: Mapping[str, Any]) -> dict[str, dict[str, Any]]:
    """Return the values that each load case sets, by name, from plain data of any shape."""
    return {name: as_mapping(as_mapping(case).get("set")) for name, case in as_mapping(data.get(CASES)).items()}


def list_case_settings(name: str, source: SourceFile) -> list[Setting]:
    """List the settings of a load case. Raises SpecError [unknown-case]."""
    cases = get_case_values(as_mapping(source.data))
    if name not in cases:
        hint = suggest(name, cases, "cases") if cases else "cases: {NAME: {set: {PARAMETER: VALUE}}}"
        raise SpecError(Problem("unknown-case", f"there is no load case '{name}'", source.location((CASES,)), hint))
    path = (CASES, name, "set")
    return [
        Setting(key, value, source.location((*path, key)), source.location((*path, key), prefer_key=True))
        for key, value in cases[name].items()
    ]


def iter_case_problems(data: dict[str, Any], source: SourceFile) -> Iterator[Problem]:
    """Yield what the load cases set but cannot, so that it is reported with the other problems of the file."""
    for name in get_case_values(data):
        settings = list_case_settings(name, source)
        for setting in settings:
            if setting.key.split(".")[0] == CASES:
                yield Problem("no-such-key", f"'{setting.key}' in a load case", setting.key_location, NESTED_CASE_HINT)
        yield from apply_settings(data, [setting for setting in settings if setting.key.split(".")[0] != CASES])[2]
