"""The entries of a spec are judged as models of pydantic would: same values, same errors at the same places."""

from __future__ import annotations

import contextlib
import copy
import random
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest
from pydantic_core import ValidationError

import heuncli
from heuncli.base.errors import Finding, SpecError
from heuncli.scene.expressions.programs import Expression
from heuncli.scene.file_format import document, entries
from heuncli.scene.file_format.entries import Entry, fields_of, validate_entry
from heuncli.scene.file_format.fields import ReadContext
from heuncli.scene.file_format.json_schema import make_model
from heuncli.scene.file_format.load import load

SPECS = Path(heuncli.__file__).parents[1] / "specs"
FILES = sorted([*SPECS.glob("*.yaml"), *SPECS.glob("broken/*.yaml")])
WRONG = [
    None, True, "", "5 s", "nonsense*2", "ground.O", -1, 2.5, [], [1, 2], [1, 2, 3], ["a", None, {}], [[1, 2, 3]] * 3,
    {}, {"body": "ground"}, {"vector": [1, 2, 3], "frame": "moon"},
]  # fmt: skip
Read = tuple[type[Entry], Any, ReadContext]


def reads(path: Path, monkeypatch: pytest.MonkeyPatch) -> list[Read]:
    """What is read as entries of which kinds when a spec is loaded."""
    found: list[Read] = []

    def listening(model: type[Entry], data: Any, context: ReadContext) -> Entry:
        found.append((model, copy.deepcopy(data), context))
        return validate_entry(model, data, context)

    monkeypatch.setattr(document, "validate_entry", listening)
    with contextlib.suppress(SpecError):
        load(path)
    return found


def changed(data: Any, draw: random.Random) -> Any:
    """The data with a value of it, at any depth, left out, added or of another kind."""
    data = copy.deepcopy(data)
    node = data
    while isinstance(node, dict | list) and node:
        place = draw.choice([*node] if isinstance(node, dict) else range(len(node)))
        if not isinstance(node[place], dict | list) or draw.random() < 0.4:  # type: ignore[index]
            how = draw.choice(["out", "other", "other", "more"])
            if how == "out":
                del node[place]  # type: ignore[arg-type]
            elif how == "other":
                node[place] = copy.deepcopy(draw.choice(WRONG))  # type: ignore[index]
            elif isinstance(node, dict):
                node[draw.choice(["more", "from", "at", "type"])] = draw.choice(WRONG)
            else:
                node.append(draw.choice(WRONG))
            break
        node = node[place]  # type: ignore[index]
    return data


def told(value: Any) -> Any:
    """Values as they may be compared: entries and models by their fields, expressions by their text."""
    if isinstance(value, Entry) or hasattr(value, "model_fields_set"):
        fields = {name: told(field) for name, field in value.__dict__.items()}
        return type(value).__name__, fields, sorted(value.model_fields_set)
    if isinstance(value, Expression):
        return repr(value.source), value.constant
    if isinstance(value, dict):
        return {name: told(member) for name, member in value.items()}
    return type(value)(map(told, value)) if isinstance(value, list | tuple) else value


def errors(error: ValidationError) -> Iterator[tuple[Any, ...]]:
    """Each thing wrong, with what is said of it."""
    for item in error.errors(include_url=False):
        finding = item.get("ctx", {}).get("error")
        words = (finding.code, str(finding), finding.hint) if isinstance(finding, Finding) else item.get("ctx")
        yield item["type"], item["loc"], item["msg"], words, repr(item["input"])


def outcome(judge: Any) -> Any:
    try:
        return told(judge())
    except ValidationError as error:
        return error.title, *errors(error)


@pytest.mark.parametrize("path", FILES, ids=lambda path: path.stem)
@pytest.mark.third
def test_as_models_of_pydantic_do(path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    draw = random.Random(path.stem)
    for model, data, context in reads(path, monkeypatch)[:40]:
        for given in (data, *(changed(data, draw) for _ in range(5))):
            own = outcome(lambda: validate_entry(model, given, context))  # noqa: B023
            assert own == outcome(lambda: make_model(model).model_validate(given, context=context)), given  # noqa: B023


@pytest.mark.parametrize("path", sorted(SPECS.glob("*.yaml")), ids=lambda path: path.stem)
def test_a_spec_without_errors_is_read_without_pydantic(path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    def judging(model: type[Entry]) -> Any:
        raise AssertionError(f"{model.__name__} is not read without a doubt")

    monkeypatch.setattr(entries, "make_validator", judging)
    load(path)


def kinds() -> Iterator[type[Entry]]:
    waiting = [Entry]
    while waiting:
        waiting += (found := waiting.pop().__subclasses__())
        yield from found


@pytest.mark.parametrize("model", sorted(set(kinds()), key=lambda model: model.__name__))
def test_defaults_are_those_of_the_model(model: type[Entry]) -> None:
    required = {name: field for name, field in fields_of(model).items() if field.is_required}
    own, made = model.model_construct(), make_model(model).model_construct()
    assert {name for name in fields_of(model) if name not in own.__dict__} == required.keys()
    assert told(own) == told(made)
    assert own == model.model_construct() and own.model_copy({"extra": 1}) != own
    with pytest.raises(AttributeError, match="frozen"):
        own.anything = 1  # type: ignore[attr-defined]
