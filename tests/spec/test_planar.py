"""Scenes declared planar: two components mean what three with a zero do; what has no spin needs none."""

from __future__ import annotations

import re

import pytest

from heuncli.base.errors import SpecError
from heuncli.scene.file_format.load import load
from tests.shared.scenes import near, solved

SCENE = """
heun: 1
space: planar
gravity: [0, -9.81{z}]
ground: {{points: {{O: [0, 0{z}]}}}}
bodies:
  bar: {{mass: 1, center: [0.5, 0{z}], inertia: 0.1, points: {{a: [0, 0{z}], b: ["2 cm", 0{z}]}},
        near: {{position: [0, 1{z}]}}}}
  tube: {{shapes: [{{type: rod, from: [0, 0{z}], to: [1, 0{z}], mass: 1}}, {{type: point, at: [1, 0{z}], mass: 2}},
                 {{type: box, center: [0, 0{z}], size: [1, 1, 1], mass: 1}}],
         position: [0, 1{z}], velocity: {{vector: [1, 2{z}], frame: body}}, angular_velocity: [0, 0, 1]}}
joints:
  guide: {{type: slide, axis: [1, 1{z}], from: {{body: ground, at: [0, 0{z}]}}, to: bar.a}}
  way: {{type: plane, normal: [0, 1{z}], from: bar.b, to: {{body: tube, at: [0, 0{z}]}}}}
forces:
  push: {{type: force, on: bar.b, vector: ["sin(t)", 0{z}]}}
  turn: {{type: couple, on: bar, vector: [0, 0, 1]}}
impulses: {{blow: {{on: {{body: tube, at: [1, 0{z}]}}, vector: [0, 1{z}], time: 0.5}}}}
sections: {{cut: {{body: tube, at: [0.7, 0{z}], normal: [1, 0{z}], first_axis: [0, 1{z}]}}}}
foundation: {{about: [1, 1{z}]}}
stops: {{end: {{joint: guide, travel: [-1, 2]}}}}
analysis: {{times: [0, 1]}}
"""


def test_two_components_mean_three_with_a_zero() -> None:
    two, three = (load("x.yaml", SCENE.format(z=z)) for z in ("", ", 0"))
    for name in ("gravity", "ground", "bodies", "joints", "forces", "impulses", "sections", "stops", "foundation"):
        one, other = (repr(getattr(spec, name)) for spec in (two, three))
        assert places_left_out(one) == places_left_out(other), name


def places_left_out(text: str) -> str:
    """Without the places in the file, which differ."""
    return re.sub(r"(None|SourceLocation\([^)]*\))", "", text)


@pytest.mark.parametrize(
    ("line", "problem"),
    [
        ("gravity: [0]", "gravity wrong-length"),
        ("gravity: [0, 1, 0, 0]", "gravity wrong-length"),
        ("forces: {f: {type: couple, on: c, vector: [0, 1]}}", "forces.f.vector wrong-length"),
        ("impulses: {i: {body: c, couple: [0, 1]}}", "impulses.i.couple wrong-length"),
        ("gravity: [0, [1]]", "gravity.1 wrong-kind"),
    ],
)
def test_what_is_no_vector_of_the_plane(line: str, problem: str) -> None:
    scene = f"heun: 1\nspace: planar\nbodies: {{c: {{mass: 1, center: [0, 0], inertia: 1}}}}\n{line}\n"
    with pytest.raises(SpecError) as error:
        load("x.yaml", scene)
    assert [f"{p.location.path} {p.code}" for p in error.value.problems if p.location] == [problem]


def test_two_components_in_space_get_a_hint() -> None:
    with pytest.raises(SpecError) as error:
        load("x.yaml", "heun: 1\ngravity: [0, 1]\nbodies: {c: {mass: 1, center: [0, 0, 0], inertia: [1, 1, 1]}}\n")
    assert "space: planar" in str(error.value.problems[0].hint)


HUNG = """
heun: 1
space: planar
gravity: [0, -9.81]
ground: {{points: {{O: [0, 0]}}}}
bodies:
  arm: {{mass: 1, center: [0.5, 0], inertia: 0.1, points: {{a: [0, 0], b: [1, 0]}}}}
{mass}
analysis: {{times: [0, 0.3, 0.7], tolerance: 1e-11}}
"""
AT_TIP = """
  lump: {{mass: 2, center: [0, 0], inertia: {inertia}, points: {{p: [0, 0]}}}}
joints:
  pivot: {{type: ball, from: ground.O, to: arm.a}}
  tip: {{type: {kind}, from: arm.b, to: lump.p}}
"""
WITHIN = """
joints: {pivot: {type: pin, from: ground.O, to: arm.a}}
"""


@pytest.mark.parametrize("kind", ["ball", "pin"])
def test_a_point_mass_on_a_ball_is_part_of_its_arm(kind: str) -> None:
    """The same as a lump that does not turn, and as an arm with the mass in it: m c = 2.5, J about the pivot 2.35."""
    hung = solved(HUNG.format(mass=AT_TIP.format(inertia=0, kind=kind)))
    lump = solved(HUNG.format(mass=AT_TIP.format(inertia=1e-3, kind=kind)))
    whole = "mass: 3, center: [2.5/3, 0], inertia: 2.35 - 2.5**2/3"
    arm = HUNG.replace("mass: 1, center: [0.5, 0], inertia: 0.1", whole)
    one = solved(arm.format(mass=WITHIN))
    for other in (hung, lump):
        near(other.coordinates["pivot"]["angle"], one.coordinates["pivot"]["angle"], 1.0, 1e-9)
        near(other.foundation["force"], one.foundation["force"], 30.0, 1e-8)
    assert "tip" not in hung.coordinates and "tip" in lump.coordinates
