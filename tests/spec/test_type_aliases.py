"""Common words for types of joints and loads mean heun's own, and an entry without a type is told what it may be."""

from __future__ import annotations

import json
from typing import Any

import pytest
from jsonschema import Draft7Validator

from heuncli.app.cli.completion import complete_measures, complete_overrides
from heuncli.base.errors import SpecError
from heuncli.output.tables.export import to_json
from heuncli.scene.file_format.entries import keys_of
from heuncli.scene.file_format.foreign_words import TYPE_ALIASES, TYPES, replace_type_aliases
from heuncli.scene.file_format.format import ENTRY_BLOCKS
from heuncli.scene.file_format.incremental_loader import SpecVariants
from heuncli.scene.file_format.json_schema import make_spec_schema
from heuncli.scene.file_format.load import load
from heuncli.scene.file_format.models import Spec
from heuncli.scene.file_format.source import read_source
from heuncli.study.model.options import Options
from heuncli.study.workflow import solve

# every canonical type that has other words, in one mechanism: `swing` on a guide, with a bob and a plate
SPEC = """\
heun: 1
gravity: [0, 0, -9.81]
parameters: {k: 3}
ground: {points: {O: [0, 0, 0]}}
bodies:
  sled: {mass: 2, center: [0, 0, 0], inertia: [0.1, 0.1, 0.1], points: {c: [0, 0, 0]}}
  arm: {mass: 1, center: [0, 0, -0.5], inertia: [0.1, 0.1, 0.01], points: {top: [0, 0, 0], end: [0, 0, -1]}}
  plate: {mass: 0.3, center: [0, 0, -1.1], inertia: [0.01, 0.02, 0.02], points: {p: [0, 0, -1]}}
  bob: {mass: 0.5, center: [0, 0, -1.5], inertia: [0.01, 0.01, 0.01], points: {top: [0, 0, -1]}}
joints:
  guide: {type: slide, from: ground.O, to: sled.c, axis: [1, 0, 0]}
  pivot: {type: pin, from: sled.c, to: arm.top, axis: [0, 1, 0], initial: {angle: 0.5}}
  bolt: {type: weld, from: arm.end, to: plate.p}
  eye: {type: ball, from: arm.end, to: bob.top}
forces:
  coil: {type: turn_spring, joint: pivot, stiffness: k, damping: 0.1, angle: 0.2}
analysis: {duration: 0.2, samples: 3}
"""
ALIASES = [(block, alias, name) for block, aliases in TYPE_ALIASES.items() for alias, name in aliases.items()]
EACH = pytest.mark.parametrize(("block", "alias", "name"), ALIASES, ids=[alias for _, alias, _ in ALIASES])


def results(spec: Spec) -> dict[str, Any]:
    """What a run writes as JSON, without the digest of the text and the time that it took."""
    written: dict[str, Any] = json.loads(to_json(solve(spec, Options()).results))
    return {key: value for key, value in written.items() if key not in ("spec", "work")}


def entry_of(block: str, name: str) -> str:
    """The entry of SPEC that has a type."""
    entries: dict[str, dict[str, Any]] = read_source("x.yaml", SPEC).data[block]
    return next(entry for entry, value in entries.items() if value["type"] == name)


@pytest.fixture(scope="module")
def canonical() -> dict[str, Any]:
    return results(load("x.yaml", SPEC))


@EACH
def test_the_words_are_accepted_with_equal_results(
    block: str, alias: str, name: str, canonical: dict[str, Any]
) -> None:
    """To the bit: in the file, by --set, and in a load case."""
    key = f"{block}.{entry_of(block, name)}.type"
    case = f"{SPEC}cases: {{other: {{set: {{{key}: {alias}}}}}}}\n"
    assert results(load("x.yaml", SPEC.replace(f"type: {name}", f"type: {alias}"))) == canonical
    assert results(load("x.yaml", SPEC, {key: alias})) == canonical
    of_case = results(load("x.yaml", case, case="other"))
    assert {**of_case, "title": ""} == canonical


@EACH
def test_variants_may_set_them(block: str, alias: str, name: str) -> None:
    """Also where the rest of the spec is kept from the first loading."""
    variants = SpecVariants("x.yaml", SPEC)
    of_type = variants.load({f"{block}.{entry_of(block, name)}.type": alias, "k": "4"})
    assert results(of_type) == results(load("x.yaml", SPEC, {"k": "4"}))
    aliased = SpecVariants("x.yaml", SPEC.replace(f"type: {name}", f"type: {alias}"))
    assert results(aliased.load({"k": "4"})) == results(load("x.yaml", SPEC, {"k": "4"}))


def test_a_planar_model_takes_them() -> None:
    planar = """\
heun: 1
space: planar
gravity: [0, -9.81]
ground: {points: {O: [0, 0]}}
bodies: {arm: {mass: 1, center: [0.5, 0], inertia: 0.1, points: {o: [0, 0]}}}
joints: {pivot: {type: pin, from: ground.O, to: arm.o}}
forces: {coil: {type: turn_spring, joint: pivot, stiffness: 3}}
analysis: {duration: 0.2, samples: 3}
"""
    expected = results(load("x.yaml", planar))
    for word in ("hinge", "revolute", "spherical"):  # a ball is a pin about z
        text = planar.replace("type: pin", f"type: {word}").replace("turn_spring", "torsion_spring")
        assert results(load("x.yaml", text)) == expected


@EACH
def test_the_schema_has_them(block: str, alias: str, name: str) -> None:
    """With the keys that the type requires."""
    validator = Draft7Validator(make_spec_schema())
    data = read_source("x.yaml", SPEC).data
    entry = {**data[block][entry_of(block, name)], "type": alias}
    assert validator.is_valid({**data, block: {**data[block], entry_of(block, name): entry}})
    if "axis" in entry:
        del entry["axis"]
        assert not validator.is_valid({**data, block: {**data[block], entry_of(block, name): entry}})


@EACH
def test_each_word_means_a_type(block: str, alias: str, name: str) -> None:
    """One that the block has, by another word than all types; the hint for other spellings names the same."""
    models = ENTRY_BLOCKS[block]
    assert isinstance(models, dict)
    assert name in models
    assert alias not in models
    assert TYPES[block][2][alias] == name


def test_what_has_no_alias_is_shared() -> None:
    data = read_source("x.yaml", SPEC).data
    assert replace_type_aliases(data) is data
    for strange in ({"joints": None}, {"joints": [1]}, {"joints": {"a": 1, "b": {"type": ["hinge"]}}}, {}):
        assert replace_type_aliases(strange) is strange
    changed = replace_type_aliases({**data, "joints": {**data["joints"], "pivot": {"type": "hinge", "axis": 1}}})
    assert list(changed["joints"]["pivot"].items()) == [("type", "pin"), ("axis", 1)]
    assert changed["joints"]["guide"] is data["joints"]["guide"]
    assert changed["bodies"] is data["bodies"]


def test_completion_knows_the_paths_of_their_entries() -> None:
    own = read_source("x.yaml", SPEC).data
    other = read_source("x.yaml", SPEC.replace("type: pin", "type: hinge")).data
    for complete, typed in ((complete_measures, "max joints.pivot."), (complete_overrides, "joints.pivot.")):
        assert [*complete(other, typed)] == [*complete(own, typed)]


def problems(text: str) -> list[str]:
    with pytest.raises(SpecError) as caught:
        load("x.yaml", text)
    return [str(problem) for problem in caught.value.problems]


def test_errors_name_the_place_of_the_alias() -> None:
    wrong = SPEC.replace("type: turn_spring, joint: pivot", "type: torsion_spring, joint: guide")
    (found,) = problems(wrong)
    assert found.startswith(
        "x.yaml:16:39: forces.coil.joint: a turn_spring acts in a pin, cylinder or universal, not in a slide"
    )
    assert "[load-joint]" in found
    found, *_ = problems(SPEC.replace("type: pin", "type: hinges"))
    assert found.startswith("x.yaml:12:17: joints.pivot.type: 'hinges' is not a joint type")
    assert found.endswith("did you mean hinge?")


@pytest.mark.parametrize(
    ("entry", "message", "hint"),
    [
        (
            "{stiffness: 100, from: ground.O, to: arm.end, length: 1}",
            "with 'stiffness', 'from', 'to', 'length' this is a spring",
            "add type: spring",
        ),
        (
            "{stiffness: 100, from: ground.O, to: arm.end}",
            "with 'stiffness', 'from', 'to' this is a spring or a bushing",
            "add type: spring or type: bushing",
        ),
        ("{stiffness: [1, 2, 3], from: ground.O, to: arm.end}", "this is a bushing", "add type: bushing"),
        ("{joint: pivot, stiffness: 3}", "with 'joint', 'stiffness' this is a turn_spring", "add type: turn_spring"),
        ("{on: arm.end, vector: [1, 0, 0]}", "this is a force or a couple", "add type: force or type: couple"),
        ("{on: arm, vector: [1, 0, 0]}", "this is a couple", "add type: couple"),
        ("{on: arm.end, vector: [1 kN, 0, 0]}", "this is a force", "add type: force"),
        ("{from: ground.O, to: arm.end, value: 5}", "this is an actuator", "add type: actuator"),
        ("{from: ground.O, to: arm.end, value: x}", "this is an actuator", "add type: actuator"),
        ("{joint: pivot, torque: 1, speed: 1}", "this is friction", "add type: friction"),
    ],
)
def test_a_load_without_type_is_named_by_its_keys(entry: str, message: str, hint: str) -> None:
    (found,) = problems(SPEC.replace("forces:\n", f"forces:\n  f: {entry}\n"))
    first, second = found.split("\n")
    assert first.startswith("x.yaml:16:3: forces.f: 'type' is missing; with ")
    assert first.endswith(f"{message} [missing-key]")
    assert second == f"  hint: {hint}"


@pytest.mark.parametrize("entry", ["{}", "{joint: pivot}", "{from: ground.O, to: arm.end}"])
def test_where_no_type_fits_all_are_listed(entry: str) -> None:
    (found,) = problems(SPEC.replace("forces:\n", f"forces:\n  f: {entry}\n"))
    assert "forces.f: 'type' is missing [missing-key]" in found
    assert "known: force, couple, torque" in found


def test_joints_and_shapes_without_type_are_named_too() -> None:
    found, *_ = problems(SPEC.replace("{type: pin, from: sled.c", "{from: sled.c"))
    assert "with 'from', 'to', 'axis', 'initial' this is a pin or a cylinder [missing-key]" in found
    mass = "mass: 2, center: [0, 0, 0], inertia: [0.1, 0.1, 0.1]"
    (found,) = problems(SPEC.replace(mass, "shapes: [{at: [0, 0, 0], mass: 2}]"))
    assert "bodies.sled.shapes.0: 'type' is missing; with 'at', 'mass' this is a point [missing-key]" in found


def misspelt(key: str) -> str:
    """The key without its last letter but one, or with one more."""
    return key[:-2] + key[-1] if len(key) > 4 else f"{key}x"


KEYS_OF_TYPES = [
    (block, key)
    for block in ("joints", "forces")
    for key in dict.fromkeys(key for model in dict(ENTRY_BLOCKS[block]).values() for key in keys_of(model))
    if key != "type"
]


@pytest.mark.parametrize(("block", "key"), KEYS_OF_TYPES, ids=[f"{block}.{key}" for block, key in KEYS_OF_TYPES])
def test_a_misspelt_key_is_told_beside_the_missing_type(block: str, key: str) -> None:
    """Each of the two has its place and its hint, whatever else the entry lacks."""
    word = misspelt(key)
    found = problems(SPEC.replace(f"{block}:\n", f"{block}:\n  one: {{{word}: 3}}\n"))
    assert any(f"{block}.one: 'type' is missing" in problem for problem in found)
    assert any(f"{block}.one.{word}: '{word}' is not known here [unknown-key]" in problem for problem in found)


@pytest.mark.parametrize(
    ("entry", "key", "hint"),
    [("{joint: pivot, stifness: 3}", "stifness", "did you mean stiffness?"),
     ("{joint: pivot, k: 3}", "k", "it is called stiffness here"),
     ("{stiffness: 3, bogus: 1, joint: pivot}", "bogus",
      "known keys here: type, joint, stiffness, angle, damping, torque")],
)  # fmt: skip
def test_the_type_is_told_by_what_a_misspelt_key_means(entry: str, key: str, hint: str) -> None:
    first, second = problems(SPEC.replace("forces:\n", f"forces:\n  f: {entry}\n"))
    assert "with 'joint', 'stiffness' this is a turn_spring" in first or "with 'stiffness', 'joint'" in first
    assert f"forces.f.{key}: '{key}' is not known here [unknown-key]" in second
    assert hint in second
