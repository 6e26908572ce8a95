"""What a cut says about itself: planes that miss, meet in several places, run along a rod, hold a mass; a bead."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

from heuncli.base.errors import SpecError
from heuncli.results.results import Results
from heuncli.scene.shapes import outlines
from tests.oracle.masses import Plane, cut
from tests.oracle.turns import unit
from tests.shared.bars import HEAD
from tests.shared.scenes import near, solved

FORK = """
bodies:
  fork:
    shapes:
      - {type: box, center: [0.05, 0, 0], size: [0.1, 1, 0.1], density: 1000}
      - {type: box, center: [0.5, 0.4, 0], size: [0.8, 0.1, 0.1], density: 1000}
      - {type: box, center: [0.5, -0.4, 0], size: [0.8, 0.1, 0.1], density: 1000}
    points: {root: [0, 0, 0]}
joints: {wall: {type: weld, from: ground.O, to: fork.root}}
"""


def fork(section: str) -> Results:
    return solved(f"{HEAD}{FORK}sections: {{cut: {{body: fork, {section}}}}}\n")


def test_several_places_give_their_sum_and_a_warning() -> None:
    """Across both tines: the weight of both beyond the plane, 2 × 0.4 m × 0.01 m² × 1000 kg/m³."""
    found = fork("at: [0.5, 0.4, 0], normal: [1, 0, 0], first_axis: [0, 0, 1]")
    near(found.sections["cut"]["Q1"][0], -8 * 9.81, 80.0, 1e-14)
    (warning,) = found.warnings
    assert "cut" in warning and "fork" in warning and "2 separate places" in warning


def test_one_place_gives_none() -> None:
    assert fork("at: [0.05, 0, 0], normal: [1, 0, 0]").warnings == ()


def refused(section: str) -> str:
    with pytest.raises(SpecError) as refusal:
        fork(section)
    (problem,) = refusal.value.problems
    assert problem.location is not None and problem.location.path.startswith("sections.cut")
    return problem.code


def test_a_plane_that_misses_is_refused() -> None:
    assert refused("at: [2, 0, 0], normal: [1, 0, 0]") == "misses-body"
    assert refused("at: [-0.1, 0, 0], normal: [1, 0, 0]") == "misses-body"


BEADS = """
heun: 1
gravity: [0, 0, -10]
ground: {points: {O: [0, 0, 0]}}
bodies:
  beads:
    shapes:
      - {type: cylinder, from: [1, 0, 0], to: [2, 0, 0], radius: 0.02, mass: 1}
      - {type: box, center: [3.5, 0, 0], size: [1, 0.1, 0.1], mass: 2}
      - {type: point, at: [5, 0, 0], mass: 3}
    points: {root: [0, 0, 0], end: [5, 0, 0]}
joints: {wall: {type: weld, from: ground.O, to: beads.root}}
"""


def beads(section: str) -> Results:
    return solved(f"{BEADS}sections: {{cut: {{body: beads, {section}}}}}\n")


@pytest.mark.parametrize(("x", "shear", "bending"), [(0.5, -60.0, 10 * 1.0 + 20 * 3.0 + 30 * 4.5),
                                                     (2.5, -50.0, 20 * 1.0 + 30 * 2.5),
                                                     (4.5, -30.0, 30 * 0.5)])  # fmt: skip
@pytest.mark.parametrize("turned", [False, True])
def test_between_shapes_the_loads_are_those_of_what_lies_beyond(
    x: float, shear: float, bending: float, turned: bool
) -> None:
    """As if a bar without mass held them: before the first of them, between two, before the last; from either side."""
    found = beads(f"at: [{x}, 0, 0], normal: [{-1 if turned else 1}, 0, 0]")
    (warning,) = found.warnings
    assert "no material" in warning and "beads" in warning
    sign = -1.0 if turned else 1.0
    near(found.sections["cut"]["force"][0, 2], sign * shear, 60.0, 1e-14)
    near(found.sections["cut"]["moment"][0, 1], sign * bending, 200.0, 1e-14)


def test_a_run_passes_what_lies_between_shapes() -> None:
    """The shear force falls where there is mass, and rests between."""
    found = beads("from: root, to: end, count: 11")
    cut = found.sections["cut"]
    near(cut["s"], np.arange(11) / 2.0, 5.0, 1e-15)
    near(cut["Q2"][0], [-60, -60, -60, -55, -50, -50, -50, -40, -30, -30, -30], 60.0, 1e-14)
    (warning,) = found.warnings
    assert "5 of 11 cuts meet no material" in warning


def test_between_shapes_there_is_no_centroid() -> None:
    """Moments about it are refused; stresses of given properties are those about the cut's own point."""
    between = "at: [2.5, 0.1, 0], normal: [1, 0, 0]"
    with pytest.raises(SpecError, match="no centroid"):
        beads(f"{between}, reduce_to: centroid")
    found = beads(f"{between}, properties: {{circle: {{radius: 0.02}}}}")
    cut = found.sections["cut"]
    near(cut["stress"]["shear_torsion"][0], abs(cut["T"][0]) / (np.pi * 0.02**3 / 2), 1e6, 1e-13)
    assert cut["T"][0] != 0.0 and "stresses refer to the cut's point" in found.warnings[0]
    with pytest.raises(SpecError, match="does not intersect the body"):
        beads("at: [5.1, 0, 0], normal: [1, 0, 0]")


def test_what_is_joined_is_not_compared_again(monkeypatch: pytest.MonkeyPatch) -> None:
    """Many shapes in one another: once a pair at most, all cuts together; 500 boxes and 200 cuts took minutes."""
    calls: list[object] = []
    apart = outlines.are_separate

    def counted(*given: Any) -> Any:
        calls.append(given)
        return apart(*given)

    monkeypatch.setattr(outlines, "are_separate", counted)
    boxes = ", ".join(f"{{type: box, center: [{i / 40}, 0, 0], size: [0.4, 0.1, 0.1], density: 1}}" for i in range(40))
    found = solved(
        "heun: 1\nground: {points: {O: [0, 0, 0]}}\nbodies:\n"
        f"  b: {{shapes: [{boxes}, {{type: box, center: [0.5, 1, 0], size: [1, 0.1, 0.1], density: 1}}]}}\n"
        "joints: {w: {type: weld, from: ground.O, to: {body: b, at: [0, 0, 0]}}}\n"
        "sections: {s: {body: b, from: [0.1, 0, 0], to: [0.9, 0, 0], count: 30}}\n"
    )
    assert len(calls) <= 41 * 40 / 2
    (warning,) = found.warnings
    assert "2 separate places" in warning


def test_a_joint_in_the_plane_needs_a_side() -> None:
    assert refused("at: root, normal: [0, 1, 0]") == "needs-side"
    left, right = (fork(f"at: root, normal: [0, 1, 0], side: {side}") for side in ("before", "beyond"))
    whole = left.joints["wall"]["force"][0]
    near(left.sections["cut"]["force"][0] - right.sections["cut"]["force"][0], whole, 300.0, 1e-13)


BRIDGE = """
heun: 1
gravity: [0, 0, -10]
ground: {points: {O: [0, 0, 0]}}
bodies:
  beam:
    shapes: [{type: box, center: [1, 0, 0], size: [2, 0.1, 0.1], mass: 1}]
    points: {a: [0, 0, 0], m: [1, 0, 0]}
  car: {mass: 3, center: [0, 0, 0.1], inertia: [0.1, 0.1, 0.1], points: {p: [0, 0, 0]}, position: [1, 0, 0]}
joints:
  w: {type: weld, from: ground.O, to: beam.a}
  g: {type: JOINT, from: beam.FROM, to: car.p}
sections:
  c: {body: beam, at: [1, 0, 0], normal: [1, 0, 0], side: SIDE}
"""


@pytest.mark.parametrize(("joint", "end"), [("slide, axis: [1, 0, 0]", "a"), ("plane, normal: [0, 0, 1]", "a"),
                                             ("cylinder, axis: [1, 0, 0]", "a"), ("line, axis: [1, 0, 0]", "a"),
                                             ("ball", "m")])  # fmt: skip
@pytest.mark.parametrize(("side", "shear"), [("before", -35.0), ("beyond", -5.0)])
def test_a_side_holds_for_what_comes_there(joint: str, end: str, side: str, shear: float) -> None:
    """A car at mid span, 30 N, on joints whose contact stays on the beam or moves along it; half the beam's 10 N."""
    found = solved(BRIDGE.replace("JOINT", joint).replace("FROM", end).replace("SIDE", side))
    near(found.sections["c"]["Q2"][0], shear, 40.0, 1e-13)


def test_what_lies_in_the_plane_is_named() -> None:
    scene = BRIDGE.replace("JOINT", "ball").replace("FROM", "m").replace(", side: SIDE", "")
    push = "forces: {push: {type: force, on: beam.m, vector: [0, 0, -1]}}\n"
    with pytest.raises(SpecError, match="joint g and force push lie in the plane of the cut"):
        solved(scene + push)


def test_the_line_of_an_open_load_is_open() -> None:
    """A beam between two balls: what it carries along itself is open, so nothing is known of the line."""
    text = """
heun: 1
gravity: [0, 0, -10]
bodies:
  beam:
    shapes: [{type: box, center: [1, 0, 0], size: [2, 0.1, 0.1], mass: 1}]
    points: {a: [0, 0, 0], b: [2, 0, 0]}
joints:
  A: {type: ball, from: {body: ground, at: [0, 0, 0]}, to: beam.a}
  B: {type: ball, from: {body: ground, at: [2, 0, 0]}, to: beam.b}
sections: {c: {body: beam, at: [0.5, 0, 0], normal: [1, 0, 0], reduce_to: line}}
"""
    cut_ = solved(text).sections["c"]
    assert np.isnan(cut_["N"]).all() and np.isfinite(cut_["Q2"]).all()
    assert all(np.isnan(value).all() for value in cut_["line"].values())


@pytest.mark.parametrize("side", ["before", "beyond"])
def test_a_point_mass_in_the_plane_needs_a_side(side: str) -> None:
    """It belongs to the piece for a cut before it; the oracle's quadrature tells what the piece weighs."""
    shapes = [{"type": "rod", "from": [0.0, 0, 0], "to": [1.0, 0, 0], "mass": 2.0},
              {"type": "point", "at": [0.6, 0.1, 0], "mass": 3.0}]  # fmt: skip
    scene = {"gravity": [0.0, 0, -10.0], "ground": {"points": {"O": [0.0, 0, 0]}},
             "bodies": {"b": {"shapes": shapes, "points": {"root": [0.0, 0, 0]}}},
             "joints": {"wall": {"type": "weld", "from": "ground.O", "to": "b.root"}}}  # fmt: skip
    section = {"body": "b", "at": [0.6, 0.0, 0], "normal": [1.0, 0, 0]}
    with pytest.raises(SpecError) as refusal:
        solved({**scene, "sections": {"cut": section}})
    assert refusal.value.problems[0].code == "needs-side"
    found = solved({**scene, "sections": {"cut": {**section, "side": side}}}).sections["cut"]
    piece = cut({"shapes": shapes}, Plane(np.array([0.6, 0, 0]), unit([1, 0, 0]), side))[1]
    weight = np.array([0.0, 0.0, -10.0 * piece.mass])
    near(found["force"][0], weight, 50.0, 1e-14)
    near(found["moment"][0], np.cross(piece.center - [0.6, 0, 0], weight), 50.0, 1e-14)


def test_a_plane_along_a_rod_is_told() -> None:
    """The rod's mass lies on the side chosen, with a warning."""
    text = (
        HEAD
        + """
bodies:
  tee:
    shapes:
      - {type: box, center: [0.25, 0, 0], size: [0.5, 0.1, 0.1], density: 1000}
      - {type: rod, from: [0.5, -0.3, 0], to: [0.5, 0.3, 0], mass: 2}
      - {type: box, center: [0.6, 0, 0], size: [0.2, 0.1, 0.1], density: 1000}
    points: {root: [0, 0, 0]}
joints: {wall: {type: weld, from: ground.O, to: tee.root}}
sections: {cut: {body: tee, at: [0.5, 0, 0], normal: [1, 0, 0], first_axis: [0, 0, 1], side: SIDE}}
"""
    )
    for side, mass in (("before", 4.0), ("beyond", 2.0)):
        found = solved(text.replace("SIDE", side))
        near(found.sections["cut"]["Q1"][0], -9.81 * mass, 50.0, 1e-14)
        assert any("along a rod" in w for w in found.warnings)


def test_a_couple_on_a_cut_body_needs_its_point() -> None:
    """Else no one knows which side of the cut it enters."""
    load = "forces: {twist: {type: couple, on: fork, vector: [1, 0, 0]}}\n"
    with pytest.raises(SpecError) as refusal:
        solved(f"{HEAD}{FORK}{load}sections: {{cut: {{body: fork, at: [0.05, 0, 0], normal: [1, 0, 0]}}}}\n")
    (problem,) = refusal.value.problems
    assert problem.location is not None and problem.location.path.startswith("forces.twist")


@pytest.mark.parametrize("joint", ["slide", "line"])
def test_a_bead_runs_past_the_cut(joint: str) -> None:
    """A bead of 2 kg on a level bar: beyond the cut it weighs there and bends by its lever, before it not at all."""
    turning = ", orientation: {axis: [0, 0, 1], angle: 0}, angular_velocity: [0, 0, 0]" if joint == "slide" else ""
    found = solved(
        HEAD
        + f"""
bodies:
  bar:
    shapes: [{{type: box, center: [1, 0, 0], size: [2, 0.1, 0.1], density: 100}}]
    points: {{root: [0, 0, 0]}}
  bead: {{mass: 2, center: [0, 0, 0], inertia: [0.1, 0.1, 0.1], points: {{c: [0, 0, 0]}}, position: [1.9, 0, 0.2],
          velocity: [-1, 0, 0]{turning}}}
joints:
  wall: {{type: weld, from: ground.O, to: bar.root}}
  rail: {{type: {joint}, from: {{body: bar, at: [0, 0, 0.2]}}, to: bead.c, axis: [1, 0, 0]}}
sections:
  cut: {{body: bar, at: [1, 0, 0], normal: [1, 0, 0], first_axis: [0, 0, 1]}}
  run: {{body: bar, from: [0, 0, 0], to: [2, 0, 0], count: 5, first_axis: [0, 0, 1]}}
analysis: {{times: [0, 0.3, 0.7, 1.1, 1.5], tolerance: 1e-12}}
"""
    )
    place = 1.9 - np.array([0, 0.3, 0.7, 1.1, 1.5])
    block = found.sections["cut"]
    there = (place > 1.0) * 2 * 9.81
    near(block["Q1"], -(9.81 * 1.0 * 1.0 + there), 50.0, 1e-12)  # 1 kg a metre of bar
    near(block["M2"], -(9.81 * 0.5 + there * (place - 1.0)), 50.0, 1e-12)  # hogging
    for k, s in enumerate(found.sections["run"]["s"].tolist()):
        there = (place > s) * 2 * 9.81
        near(found.sections["run"]["Q1"][:, k], -(9.81 * (2 - s) + there), 50.0, 1e-12)
