"""Files that a spec names, read once and taken elsewhere: a variant answers there what it answers beside them."""

from __future__ import annotations

import pickle
from pathlib import Path

import pytest

from heuncli.analyses.variants.evaluation import Recipe, VariantEvaluator
from heuncli.analyses.variants.parameters import parse_axis_values
from heuncli.analyses.variants.plans import Plan, make_axes_plan
from heuncli.app.commands.sweep.cluster.scheduler import add_files, add_named_files
from heuncli.output.tables import measure
from heuncli.scene.file_format.named_files import FileNotPreloaded
from heuncli.study.model.options import Options
from tests.shared import triangles

DRIVEN = """\
heun: 1
title: A block on rails, driven by a table
ground: {points: {O: [0, 0, 0]}}
tables:
  push: {file: a.csv, y_unit: mm, interpolation: cubic}
bodies:
  block: {mass: 2, center: [0, 0, 0], inertia: [1, 1, 1], points: {a: [0, 0, 0]}}
joints:
  rail: {type: slide, from: ground.O, to: block.a, axis: [1, 0, 0]}
drives:
  motor: {joint: rail, travel: "table(push, t)"}
analysis: {duration: 1, samples: 3}
expect:
  - {of: coordinates.rail.travel, curve: seen.csv, abs: 1}
cases:
  other: {title: Another drive, set: {tables.push.file: b.csv}}
"""
MEASURES = ("final coordinates.rail.travel", "max abs joints.rail.drive")
AXES = ("tables.push.file=a.csv,b.csv,'c d.csv',none.csv,wrong.csv,../far.csv,large.bin", "case=other")


@pytest.fixture
def beside(tmp_path: Path) -> Path:
    """A folder with the spec and its files."""
    folder = tmp_path / "specs"
    folder.mkdir()
    (folder / "driven.yaml").write_text(DRIVEN)
    rows = {"a": "0,0\n0.4,3\n1,5\n", "b": "0,0\n0.5,1\n1,9\n", "c d": "t;s\n0;0\n0,7;1,5\n1;2\n", "seen": "0,0\n1,1\n"}
    for name, text in rows.items():
        (folder / f"{name}.csv").write_text(text)
    (folder / "wrong.csv").write_bytes(b"0,0\n1,\xff\n")
    (tmp_path / "far.csv").write_text(rows["b"])
    with (folder / "large.bin").open("wb") as file:
        file.truncate(300_000_000)
    return folder


def recipe_in(folder: Path) -> Recipe:
    path = str(folder / "driven.yaml")
    return Recipe(path, (folder / "driven.yaml").read_text(), tuple(measure.parse_measures(MEASURES)), Options(), {})


def plan(*words: str) -> Plan:
    return make_axes_plan([parse_axis_values(word) for word in words or AXES])


@pytest.mark.heavy
def test_variants_answer_elsewhere_what_they_answer_here(beside: Path) -> None:
    recipe = recipe_in(beside)
    here = VariantEvaluator(recipe)
    variants = [plan().find_values(number) for number in plan().iter_numbers()] + [{}, {"case": "other"}]
    asked = [here.answer(values) for values in variants]
    assert {answer.code for answer in asked} == {"", "table-file", "too-large"}
    far = {"tables.push.file": "../far.csv"}
    warned = here.load(far).warnings
    assert [problem.code for problem in warned] == ["outside-folder"]
    sent = pickle.dumps(add_files(recipe, plan()))
    for file in [*beside.iterdir(), beside.parent / "far.csv"]:
        file.unlink()
    there = VariantEvaluator(pickle.loads(sent))
    assert [there.answer(values) for values in variants] == asked
    assert there.load(far).warnings == warned


def test_what_was_read_is_what_counts(beside: Path) -> None:
    sent = add_files(recipe_in(beside), plan())
    before = VariantEvaluator(sent).answer({})
    (beside / "a.csv").write_text("0,0\n1,2\n")
    assert VariantEvaluator(sent).answer({}) == before
    assert VariantEvaluator(recipe_in(beside)).answer({}) != before


def test_a_file_that_was_not_sent_is_asked_for_and_not_looked_for_on_a_disk(beside: Path) -> None:
    recipe = recipe_in(beside)
    whole = {"tables.push": "{file: b.csv, y_unit: mm}"}
    sent = add_files(recipe, plan("tables.push.y_unit=mm,cm"))
    with pytest.raises(FileNotPreloaded) as missing:
        VariantEvaluator(sent).answer(whole)
    assert missing.value.name == "b.csv"
    more = add_named_files(sent, ["b.csv"])
    assert VariantEvaluator(more).answer(whole) == VariantEvaluator(recipe).answer(whole)


SOLID = """\
heun: 1
title: A solid on a clamp
parameters: {unit: 1 mm, rho: 7850, turn: 0}
gravity: [0, 0, -9.81]
ground: {points: {O: [0, 0, 0]}}
bodies:
  solid:
    shapes: [{type: mesh, file: a.stl, scale: unit, density: rho, orientation: {axis: [0, 0, 1], angle: turn}}]
    points: {a: [0, 0, 0]}
joints:
  clamp: {type: weld, from: ground.O, to: solid.a}
sections:
  root: {body: solid, at: [0, 0, 0.01], normal: [0, 0, 1]}
"""
PULLS = ("joints.clamp.force.z", "joints.clamp.moment.y", "sections.root.N")
SOLIDS = ("bodies.solid.shapes.0.file=a.stl,b.stl,open.stl,none.stl", "turn=0,1")


@pytest.mark.heavy
def test_variants_of_meshes_answer_as_each_alone_here_and_elsewhere(tmp_path: Path) -> None:
    box = triangles.box([10, -5, 0], [40, 15, 60])
    for name, surface in {"a": box, "b": triangles.torus(9, 7, 30.0, 20.0), "open": box[1:]}.items():
        (tmp_path / f"{name}.stl").write_bytes(triangles.binary_stl(surface))
    (tmp_path / "solid.yaml").write_text(SOLID)
    recipe = Recipe(str(tmp_path / "solid.yaml"), SOLID, tuple(measure.parse_measures(PULLS)), Options(), {})
    axes = plan(*SOLIDS)
    here = VariantEvaluator(recipe)
    variants = [axes.find_values(number) for number in axes.iter_numbers()]
    asked = [here.answer(values) for values in variants]
    assert asked == [VariantEvaluator(recipe).answer(values) for values in variants]
    assert {answer.code for answer in asked} == {"", "open-mesh", "mesh-file"}
    assert len({repr(answer) for answer in asked if not answer.code}) == 4
    sent = pickle.dumps(add_files(recipe, axes))
    for file in tmp_path.glob("*.stl"):
        file.unlink()
    assert [VariantEvaluator(pickle.loads(sent)).answer(values) for values in variants] == asked
