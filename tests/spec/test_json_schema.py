"""The JSON Schemas: what editors are told of specs and results is what the models take and the runs write."""

from __future__ import annotations

import json
import subprocess
import sys
from functools import cache
from pathlib import Path
from typing import Any

import pytest
import yaml
from jsonschema import Draft7Validator

from heuncli.base.joint_kinds import TYPES
from heuncli.output.tables.export import to_json
from heuncli.output.tables.results_json_schema import make_results_schema
from heuncli.results.results_schema import REPORTS, SHARES
from heuncli.scene.file_format.foreign_words import list_aliases
from heuncli.scene.file_format.format_joints import JOINTS
from heuncli.scene.file_format.json_schema import make_spec_schema
from heuncli.scene.file_format.load import load
from heuncli.study.model.options import Options
from heuncli.study.workflow import solve
from tests.manual.keys import PLACES
from tests.shared.folders import ROOT

SPECS = sorted((ROOT / "specs").glob("*.yaml"))
BROKEN = sorted((ROOT / "specs" / "broken").glob("*.yaml"))
OF_STRUCTURE = {  # codes of specs in specs/broken that are wrong in keys, types and forms
    "missing-key", "not-a-scene", "unknown-key", "unknown-joint-type", "unknown-force-type", "unknown-shape-type",
    "unknown-word", "wrong-kind", "version",
}  # fmt: skip


@cache
def of_specs() -> Draft7Validator:
    schema = make_spec_schema()
    Draft7Validator.check_schema(schema)
    return Draft7Validator(schema)


@cache
def of_results() -> Draft7Validator:
    schema = make_results_schema()
    Draft7Validator.check_schema(schema)
    return Draft7Validator(schema)


@pytest.mark.heavy
def test_check_jsonschema_passes_every_spec_and_starter(tmp_path: Path) -> None:
    schema = tmp_path / "heun.schema.json"
    schema.write_text(json.dumps(make_spec_schema()))
    starters = sorted((ROOT / "heuncli" / "starters").glob("*.yaml"))
    words = [sys.executable, "-m", "check_jsonschema", "--schemafile", str(schema), *map(str, [*SPECS, *starters])]
    done = subprocess.run(words, capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stdout


@pytest.mark.parametrize("path", BROKEN, ids=lambda path: path.stem)
def test_what_is_wrong_in_structure_fails(path: Path) -> None:
    """And what is refused for another reason, such as a name, passes: a schema cannot know it."""
    if path.stem not in OF_STRUCTURE:
        return
    assert not of_specs().is_valid(yaml.safe_load(path.read_text()))


def test_every_code_of_structure_has_its_spec() -> None:
    assert {path.stem for path in BROKEN} >= OF_STRUCTURE


def keys_in(schema: Any) -> set[str]:
    """All keys that a schema knows."""
    if isinstance(schema, list):
        return set().union(*map(keys_in, schema))
    if not isinstance(schema, dict):
        return set()
    own = set(schema.get("properties", {})) if isinstance(schema.get("properties"), dict) else set()
    return own.union(*map(keys_in, schema.values()))


def test_every_key_of_the_manual_is_in_it_with_its_words() -> None:
    schema = of_specs().schema
    assert isinstance(schema, dict)
    assert {place.key for place in PLACES} <= keys_in(schema)
    described = [key for key, block in schema["properties"].items() if "description" in block]
    assert sorted(described) == sorted(schema["properties"])
    lacking = [
        f"{name}.{key}" for name, block in schema["definitions"].items() for key, own in block["properties"].items()
        if "description" not in own and key not in ("type", "body", "at", "frame", "value", "x", "y", "z")
    ]  # fmt: skip
    assert len(lacking) < 25, lacking


def test_entries_have_examples_that_are_such_entries() -> None:
    """Of the specs to start from: all kinds of entries that stand in them."""
    schema = of_specs().schema
    assert isinstance(schema, dict)
    found = {name: block["examples"] for name, block in schema["definitions"].items() if "examples" in block}
    assert {
        "BodyEntry",
        "PinJoint",
        "DriveEntry",
        "SpringEntry",
        "SectionEntry",
        "AnalysisEntry",
        "CaseEntry",
    } <= found.keys()
    for name, examples in found.items():
        own = Draft7Validator({**schema["definitions"][name], "definitions": schema["definitions"]})
        assert all(own.is_valid(example) for example in examples), name


def test_joint_kinds_are_named() -> None:
    """Each with the other words that are accepted for it."""
    schema = of_specs().schema
    assert isinstance(schema, dict)
    for kind in TYPES:
        words = schema["definitions"][JOINTS[kind].__name__]["properties"]["type"]
        assert words.get("enum", [words.get("const")]) == [kind, *list_aliases("joints", kind)]


@pytest.mark.parametrize(
    "change",
    [{"bodys": {}}, {"gravity": 9.81}, {"heun": None}, {"expect": {}}, {"joints": {"a": {"type": "pivot"}}},
     {"analysis": {"durations": 1}}, {"cases": {"a": {}}}, {"drives": {"m": {"angle": [1]}}}],
    ids=lambda change: next(iter(change)),
)  # fmt: skip
def test_an_editor_underlines(change: dict[str, Any]) -> None:
    scene = yaml.safe_load((ROOT / "specs" / "double.yaml").read_text())
    assert of_specs().is_valid(scene)
    assert not of_specs().is_valid({**scene, **change})


def kinds(value: Any) -> tuple[Any, Any]:
    """A value whose long lists hold one entry of each kind, and its kind: its keys, lengths, types."""
    if isinstance(value, dict):
        parts = {key: kinds(part) for key, part in value.items()}
        return {key: short for key, (short, _) in parts.items()}, tuple((key, kind) for key, (_, kind) in parts.items())
    if isinstance(value, list):
        firsts: dict[Any, Any] = {}
        for short, kind in map(kinds, value):
            firsts.setdefault(kind, short)
        return (list(firsts.values()) if len(value) > 9 else value), (len(value), *firsts)
    return value, type(value) if not isinstance(value, str) else value


def test_lists_keep_one_entry_of_each_kind() -> None:
    rows = [[1.0, 2.0, 3.0]] * 9
    assert kinds({"a": [*rows, [1.0, None, 3.0], [1.0], "x", "y", *rows]})[0] == {
        "a": [rows[0], [1.0, None, 3.0], [1.0], "x", "y"]
    }


@pytest.mark.heavy
@pytest.mark.parametrize("path", SPECS, ids=lambda path: path.stem)
@pytest.mark.sixth
def test_every_result_is_what_the_schema_of_results_says(path: Path) -> None:
    wanted = frozenset(REPORTS if path.stem == "monitor_arm" else {*REPORTS, SHARES})  # sticks as one: no shares
    results = json.loads(to_json(solve(load(str(path)), Options(requested_reports=wanted)).results))
    assert [error.json_path for error in of_results().iter_errors(kinds(results)[0])] == []


@pytest.mark.heavy
def test_the_schema_of_results_refuses_what_is_none() -> None:
    results = json.loads(
        to_json(
            solve(load(str(ROOT / "specs" / "double.yaml"), overrides={"analysis.samples": "3"}), Options()).results
        )
    )
    assert of_results().is_valid(results)
    for spoilt in ({"joint": {}}, {"status": 3}, {"energy": {"kinetic": ["x"]}}):
        assert not of_results().is_valid({**results, **spoilt})
    del results["time"]
    assert not of_results().is_valid(results)
