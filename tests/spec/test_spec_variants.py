"""A spec read again with other values: what hangs on none of them is the object that it was, and nothing else is."""

from __future__ import annotations

import random
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from heuncli.base.errors import SpecError
from heuncli.scene.file_format.entries import fields_of
from heuncli.scene.file_format.format_joints import BallJoint, PinJoint
from heuncli.scene.file_format.format_loads import ForceEntry
from heuncli.scene.file_format.incremental_loader import SpecVariants
from heuncli.scene.file_format.load import load
from heuncli.scene.file_format.lookups import (
    GIVEN_FIELDS,
    KEYS,
    KIND,
    Lookup,
    LookupLog,
    WatchedDocument,
    iter_changed_in_document,
)
from heuncli.scene.file_format.models import Spec
from heuncli.scene.file_format.parameters import PLAIN_NUMBER, parse_settings
from heuncli.scene.file_format.sharing import is_same
from heuncli.scene.file_format.source import parse_source
from tests.shared.bits import bits
from tests.shared.folders import ROOT, SPECS

FILES = sorted([*SPECS.glob("*.yaml"), *(ROOT / "heuncli" / "starters").glob("*.yaml")])
SCENE = """\
heun: 1
parameters: {L: 1.0, H: 2*L, F: 10 N, T: 0.5 s, g: 9.81}
gravity: [0, 0, -g]
tables: {pulse: {file: push.csv, period: T}, pull: {x: [0, L], y: [0, 1]}}
ground: {points: {O: [0, 0, 0]}}
bodies:
  long: {shapes: [{type: rod, from: [0, 0, 0], to: [H, 0, 0], mass: 1}], points: {a: [0, 0, 0], b: [H, 0, 0]}}
  short: {shapes: [{type: rod, from: [0, 0, 0], to: [0.1, 0, 0], mass: 1}], points: {a: [0, 0, 0]}}
joints:
  foot: {type: pin, axis: [0, 1, 0], from: ground.O, to: long.a}
  knee: {type: pin, axis: [0, 1, 0], from: long.b, to: short.a}
forces:
  push: {type: force, on: long.b, vector: ["table(pulse, t)", 0, F]}
  brake: {type: torque, joint: knee, value: -0.1*knee.rate}
analysis: {duration: 1, samples: 3}
expect: [{of: joints.foot.force.x, at: 0.5, is: F*L}, {of: joints.knee.force.x, at: 0.5, is: 0}]
"""


@pytest.fixture
def scene(tmp_path: Path) -> Path:
    (tmp_path / "push.csv").write_text("0,0\n0.25,1\n0.5,0\n", encoding="utf-8")
    path = tmp_path / "scene.yaml"
    path.write_text(SCENE, encoding="utf-8")
    return path


def kept(variants: SpecVariants, **values: str) -> set[str]:
    """The entries of the scene that are the objects that they were."""
    new, old = variants.load(values), variants.spec
    blocks = ("bodies", "joints", "forces", "tables")
    return {
        name for block in blocks for name in getattr(new, block) if entry(new, block, name) is entry(old, block, name)
    }


def entry(spec: Spec, block: str, name: str) -> Any:
    return getattr(spec, block)[name]


def test_what_hangs_on_no_changed_value_is_kept(scene: Path) -> None:
    variants = SpecVariants(scene)
    everything = {"long", "short", "foot", "knee", "brake", "push", "pulse", "pull"}
    assert kept(variants, g="9.8") == everything
    assert kept(variants, F="11 N") == everything - {"push"}
    assert kept(variants, H="3") == everything - {"long", "knee", "push"}
    assert kept(variants, L="1.5") == everything - {"long", "knee", "push", "pull"}
    assert kept(variants, L="1.0") == everything
    assert variants.load({"F": "11 N"}).tables is variants.spec.tables


def test_the_files_are_read_once(scene: Path) -> None:
    variants = SpecVariants(scene)
    scene.write_text("no spec", encoding="utf-8")
    (scene.parent / "push.csv").unlink()
    assert variants.load({"g": "1.62"}).gravity == (0.0, 0.0, -1.62)
    assert variants.load({"F": "1 N"}).tables["pulse"] is variants.spec.tables["pulse"]


def test_a_variant_in_error_leaves_no_trace(scene: Path) -> None:
    variants = SpecVariants(scene)
    before = [*bits(variants.load({"L": "1.5"})._replace(path=""))]
    for values in ({"L": "0"}, {"F": "3 m"}, {"H": "H"}, {"bodies.long": "3"}, {"joints.knee.to": "nobody.a"}):
        with pytest.raises(SpecError) as fresh:
            load(scene, overrides=values)
        with pytest.raises(SpecError) as again:
            variants.load(values)
        assert again.value.problems == fresh.value.problems
    assert [*bits(variants.load({"L": "1.5"})._replace(path=""))] == before


def outcome(read: Callable[[], Spec]) -> Any:
    try:
        return [*bits(read())]
    except SpecError as error:
        return error.problems


@pytest.mark.heavy
@pytest.mark.parametrize("path", FILES, ids=lambda path: f"{path.parent.name}-{path.stem}")
@pytest.mark.sixth
def test_every_variant_is_read_as_if_it_were_the_first(path: Path) -> None:
    variants = SpecVariants(path)
    names = [*variants.spec.parameters]
    draw = random.Random(path.stem)
    given = [{}, {"title": "other"}, {"gravity": "[0, 0, 1]"}, {"analysis.type": "state"}]
    given += [{f"bodies.{body}.mass": "3 kg"} for body in variants.spec.bodies]
    given += [{f"joints.{joint}.type": "ball"} for joint in variants.spec.joints]
    for name in names:
        other = draw.choice(names)
        wanted = (repr(1.1 * variants.spec.parameters[name]), "0", "-2 mm", f"{other}**2", "1e200", "''", "[1, 2]")
        given += [{name: value} for value in draw.sample(wanted, 2)]
        given.append({name: "0.5", other: "2"})
    draw.shuffle(given)
    for values in given:
        assert outcome(lambda: variants.load(values)) == outcome(lambda: load(path, overrides=values)), values  # noqa: B023


def test_values_are_the_same_to_the_bit_and_by_type() -> None:
    assert is_same({"a": (1.0, "x")}, {"a": (1.0, "x")})
    assert is_same(np.array([1.0, np.nan]), np.array([1.0, np.nan]))
    assert not is_same(0.0, -0.0)
    assert not is_same(1, 1.0)
    assert not is_same(True, 1)
    assert not is_same(np.array([0.0]), np.array([-0.0]))
    assert not is_same({"a": 1, "b": 2}, {"b": 2, "a": 1})
    assert not is_same((1.0, 2.0), (1.0,))
    assert not is_same(object(), object())


def test_idle_parameters_are_those_on_which_nothing_hangs(scene: Path) -> None:
    """Neither by themselves nor by another parameter; what is expected does not count."""
    scene.write_text(
        SCENE.replace("g: 9.81}", "g: 9.81, spare: 2, twice: 2*spare, once: F, limit: 1}").replace("F*L", "limit")
    )
    variants = SpecVariants(scene)
    names = ["L", "H", "F", "T", "g", "spare", "twice", "once", "limit", "bodies.long.points.a.0", "no"]
    assert variants.unused_parameters(names) == {"spare", "twice", "once", "limit"}


@pytest.mark.heavy
@pytest.mark.parametrize("path", FILES, ids=lambda path: f"{path.parent.name}-{path.stem}")
@pytest.mark.third
def test_idle_parameters_change_nothing(path: Path) -> None:
    variants = SpecVariants(path, checking=False)
    parameters = variants.spec.parameters
    for name in variants.unused_parameters([*parameters]):
        other = variants.load({name: repr(1.001 * parameters[name] + 1e-3 * (parameters[name] == 0.0))})
        for field in set(Spec._fields) - {"parameters", "expect", "locations", "warnings"}:
            assert [*bits(getattr(other, field))] == [*bits(getattr(variants.spec, field))], (name, field)


def test_what_an_entry_is_asked_for_is_written_down_field_by_field(scene: Path) -> None:
    document = SpecVariants(scene)._first.draft.document
    log = LookupLog()
    watched = WatchedDocument("document", document, log)
    assert isinstance(watched.forces["push"], ForceEntry)
    assert log.take() == {Lookup("document.forces", "push"), Lookup("document.forces.push", KIND)}
    assert watched.forces["push"].vector is document.forces["push"].vector
    assert Lookup("document.forces.push", "vector") in log.take()
    assert "vector" in watched.forces["push"].model_fields_set
    assert Lookup("document.forces.push", GIVEN_FIELDS) in log.take()
    assert vars(watched.joints["foot"]) == vars(document.joints["foot"])
    assert Lookup("document.joints.foot", KEYS) in log.take()
    assert "gust" not in watched.forces
    assert Lookup("document.forces", "gust") in log.take()
    assert [*watched.bodies] == ["long", "short"]
    assert log.take() == {Lookup("document.bodies", KEYS)}
    assert watched.head.gravity == document.head.gravity
    assert log.take() == {Lookup("document.head", "gravity")}


@pytest.mark.parametrize(
    ("key", "value", "differing"),
    [
        ("F", "11 N", {("forces.push", "vector"), ("forces.push", KEYS), ("expect.0", "is_"), ("expect.0", KEYS)}),
        ("g", "9.8", {("head", "gravity"), ("head", KEYS)}),
        ("L", "1.0", set()),
        ("joints.knee.type", "ball", {("joints.knee", KIND), ("joints.knee", KEYS), ("joints.knee", "type")}),
        ("expect.1.rel", "0.1", {("expect.1", "rel"), ("expect.1", KEYS), ("expect.1", GIVEN_FIELDS)}),
        ("forces.brake", "null", {("forces", "brake"), ("forces", KEYS)}),
    ],
)
def test_what_differs_between_two_documents(scene: Path, key: str, value: str, differing: set[tuple[str, str]]) -> None:
    old = SpecVariants(scene)._first.draft.document
    if value == "null":
        new = old._replace(forces={name: force for name, force in old.forces.items() if name != "brake"})
    elif key == "joints.knee.type":
        knee = old.joints["knee"]
        ball = BallJoint.model_construct(**{**vars(knee), "type": "ball"})
        object.__setattr__(ball, "__pydantic_fields_set__", knee.model_fields_set)
        new = old._replace(joints={**old.joints, "knee": ball})
    else:
        new = SpecVariants(scene, overrides={key: value})._first.draft.document
    found = {
        (one.container.removeprefix("document."), one.key) for one in iter_changed_in_document("document", new, old)
    }
    if key == "joints.knee.type":  # a pin has keys that a ball does not have
        found -= {("joints.knee", name) for name in fields_of(PinJoint).keys() - fields_of(BallJoint).keys()}
    assert found == differing


def test_what_is_read_again_is_planned_for_what_differs_and_not_for_names(scene: Path) -> None:
    variants = SpecVariants(scene)
    first = variants._first
    for F in ("11 N", "12 N", "13 N"):
        variants.load({"F": F})
    assert len(first.rereads) == len(first.plans) == len(first.unchanged_parts) == 1
    ((_, again),) = first.rereads.items()
    assert again == [("forces", "push"), ("expect", 0)]
    ((_, plan),) = first.plans.items()
    assert {rule.code for rule, found in plan.verdicts if found is None} == {"expect-form", "expect-instants"}
    ((_, standing),) = first.unchanged_parts.items()
    assert ("forces", "push") not in standing.parts
    assert {("forces", "brake"), ("bodies", "long"), ("expect", 1), ("analysis", None)} <= standing.parts
    assert "bodies" in standing.blocks and "forces" not in standing.blocks
    variants.load({"H": "3"})
    assert len(first.rereads) == 2


@pytest.mark.parametrize("text", ["12", "-1.5", "+3", "1.", "0.5e-3", "012", "-0", "1e400", "1E5", "00.5", "9" * 18])
def test_a_plain_figure_is_what_yaml_makes_of_it(text: str) -> None:
    assert PLAIN_NUMBER.fullmatch(text)
    ((setting,), problems) = parse_settings({"F": text})
    assert problems == []
    assert [*bits(setting.value)] == [*bits(parse_source("x", text, "").data)]
    assert type(setting.value) is type(parse_source("x", text, "").data)


@pytest.mark.parametrize("text", ["1:30", "1_000", "0x10", "1e", "- 1", "1 ", "٣", "1.5.2", ".5", "9" * 19, "~"])
def test_what_is_no_plain_figure_is_read_as_yaml(text: str) -> None:
    assert not PLAIN_NUMBER.fullmatch(text)
