"""Products of a spec's quantities are refused where they are too small or too large to be computed with."""

from __future__ import annotations

import numpy as np
import pytest

from heuncli.base.errors import SpecError
from heuncli.base.units import are_in_range, is_in_range
from heuncli.scene.file_format import format_shapes as fs
from heuncli.scene.file_format.entries import fields_of
from heuncli.scene.file_format.load import load
from heuncli.scene.file_format.resolve import resolve_member
from heuncli.scene.file_format.rules.products import shape_mass
from heuncli.scene.shapes.composite_solid import make_composite_solid
from tests.shared.solids import SOLIDS

SCENE = """\
heun: 1
ground: {points: {O: [0, 0, 0]}}
bodies:
  bar: {BODY, points: {a: [0, 0, 0]}}
  other: {mass: 1, center: [0, 0, 0], inertia: [1, 1, 1], points: {a: [0, 0, 0]}}
joints: {p: {type: ball, from: ground.O, to: bar.a}, q: {type: ball, from: bar.a, to: other.a}}
"""
LARGE = "radius: 1e25, density: 1e10"


@pytest.mark.parametrize(("body", "path", "words"), [
    (f"shapes: [{{type: sphere, center: [0, 0, 0], {LARGE}}}]", "shapes.0", "(density times volume) is 4.18"),
    ("shapes: [{type: sphere, center: [0, 0, 0], radius: 1e-25, density: 1}]", "shapes.0", "too small"),
    (f"shapes: [{{type: cylinder, from: [0, 0, 0], to: [0, 0, 1e25], {LARGE}}}]", "shapes.0", "too large"),
    (f"shapes: [{{type: cone, from: [0, 0, 0], to: [0, 0, 1e25], to_radius: 0, {LARGE}}}]", "shapes.0", "too large"),
    ("shapes: [{type: box, center: [0, 0, 0], size: [1e-20, 1e-20, 1e-20], density: 0.1}]", "shapes.0", "too small"),
    ("shapes: [{type: rod, from: [0, 0, 0], to: [1e40, 0, 0], line_density: 1e40}]", "shapes.0", "is 1e+80"),
    ("shapes: [{type: point, at: [1e20, 0, 0], mass: 1e30}]", "", "(1e+30 kg times the square of 1e+20 m) is 1e+70"),
    ("shapes: [{type: box, center: [0, 0, 0], size: [1, 1, 1e40], mass: 1}]", "", "the inertia of this body"),
    ("mass: 1, center: [0, 1e31, 0], inertia: [0, 0, 0]", "", "1e+62"),
    ("mass: 1e-50, center: [0, 1e-6, 0], inertia: [0, 0, 0]", "", "1e-62, too small"),
    ("mass: 1, center: [0, 0, 0], inertia: [1, 1, 1], position: [0, 0, 1e31]", "", "about the origin"),
])  # fmt: skip
def test_products_out_of_range(body: str, path: str, words: str) -> None:
    with pytest.raises(SpecError) as caught:
        load("x.yaml", text=SCENE.replace("BODY", body))
    problem = caught.value.problems[0]
    assert problem.location is not None
    assert (problem.code, problem.location.path) == ("magnitude", f"bodies.bar.{path}".rstrip("."))
    assert words in problem.message
    assert problem.hint


@pytest.mark.parametrize("body", [
    "shapes: [{type: point, at: [0, 0, 0], mass: 1e-60}]",
    "shapes: [{type: sphere, center: [0, 0, 0], radius: 1e-8, density: 1e-10}]",
    "shapes: [{type: cylinder, from: [0, 0, 0], to: [0, 0, 1e18], radius: 2e-60, inner_radius: 1e-60, mass: 1e10}]",
    "mass: 1e-40, center: [1e40, 0, 0], inertia: [1e-30, 1e-30, 1e-30]",
])  # fmt: skip
def test_products_in_range(body: str) -> None:
    load("x.yaml", text=SCENE.replace("BODY", body))


def test_all_are_told_at_once() -> None:
    body = "mass: 1e99, center: [0, 0, 0], inertia: [1e99, 1, 1]"
    text = SCENE.replace("BODY", body).replace("mass: 1, center", "mass: 1e50, position: [1e9, 0, 0], center")
    with pytest.raises(SpecError) as caught:
        load("x.yaml", text=text)
    assert [p.location and p.location.path for p in caught.value.problems] == [
        "bodies.bar.mass",
        "bodies.bar.inertia.0",
        "bodies.other",
    ]


@pytest.mark.parametrize("name", SOLIDS)
def test_masses_of_shapes_are_those_that_are_computed_with(name: str) -> None:
    shape = SOLIDS[name]
    written = fs.SHAPES[shape.type]
    keys = {key: getattr(shape, key) for key in fields_of(written) if hasattr(shape, key)}
    mass = float(make_composite_solid([shape]).whole_inertia()[3, 3])
    assert shape_mass(written.model_construct(**keys)) == pytest.approx(mass, rel=1e-13)


ENDS = {"from_": (0.1, 0.2, 0.3), "to": (1.1, 0.4, 0.6), "density": 1.5}
MEMBERS = {
    "I": {"height": 0.2, "width": 0.1, "web": 0.01, "flange": 0.012, "radius": 0.01, "to_height": 0.1, "to_web": 0.005},
    "C": {"height": 0.2, "width": 0.1, "web": 0.01, "flange": 0.012, "radius": 0.01, "toe_radius": 0.004},
    "L": {"height": 0.2, "width": 0.1, "web": 0.01, "flange": 0.012, "toe_radius": 0.004, "to_width": 0.15},
    "T": {"height": 0.2, "width": 0.1, "web": 0.01, "flange": 0.012, "radius": 0.01},
    "profile": {"profile": "UPN 200", "to_profile": "UPN 100"},
    "box": {"center": (0.1, 0.2, 0.3), "size": (0.1, 0.5, 0.2), "wall": 0.01},
}


@pytest.mark.parametrize("kind", MEMBERS)
def test_masses_of_members_are_those_that_are_computed_with(kind: str) -> None:
    written = fs.SHAPES[kind]
    keys = MEMBERS[kind] | {key: value for key, value in ENDS.items() if key in fields_of(written)}
    entry = written.model_construct(**{"type": kind} | keys)
    mass = float(make_composite_solid([resolve_member(entry)]).whole_inertia()[3, 3])
    assert shape_mass(entry) == pytest.approx(mass, rel=1e-12)


def test_all_kinds_of_shapes_are_among_them() -> None:
    assert {shape.type for shape in SOLIDS.values()} | {"point", "mesh"} | MEMBERS.keys() == set(fs.SHAPES)


def test_many_numbers_are_judged_as_one() -> None:
    values = [0.0, -0.0, 1e-60, 9e-61, -1e-60, 1e60, 1.1e60, -1e60, 1.0, np.inf, -np.inf, np.nan]
    assert are_in_range(np.array(values)).tolist() == [is_in_range(value) for value in values]
