"""What is not flat is not taken to be: it is said what leaves the plane, and by how much; and what is hidden."""

from __future__ import annotations

import pytest

from heuncli.multibody.mechanism.build import build
from heuncli.multibody.reduction.compose import Reduction
from heuncli.multibody.reduction.plane.step import step
from heuncli.multibody.tree.prepare import prepare
from heuncli.scene.file_format.load import load
from tests.honesty.nearly_flat import swing


def found(text: str) -> Reduction | tuple[str, ...]:
    return step(prepare(build(load("scene.yaml", text), {})))


@pytest.mark.parametrize(
    ("part", "size", "what"),
    [
        ("gravity", 1e-9, "gravity has an out-of-plane component of 1e-09 m/s^2"),
        ("gravity", 0.1, "gravity has an out-of-plane component of 0.1 m/s^2"),
        ("center", 1e-9, "bodies.upper.center is 1e-09 m off the plane"),
        ("force", 1e-9, "forces.push.vector has an out-of-plane component of 1e-09 N"),
        ("couple", 0.5, "forces.turn.vector has an out-of-plane component of 0.5 N m"),
        ("blow", 1e-9, "impulses.blow at t = 0.5 s has an out-of-plane component of 1e-09 N s"),
        ("blow", 1.0, "impulses.blow at t = 0.5 s has an out-of-plane component of 1 N s"),
        ("turning", 1e-9, "bodies.upper.angular_velocity has an out-of-plane component of 1e-09 rad/s"),
    ],
)
def test_what_leaves_the_plane_is_told_with_its_number(part: str, size: float, what: str) -> None:
    (told,) = found(swing(**{part: size}))
    assert told.startswith(f"not solved in the plane normal to y: {what}")


@pytest.mark.parametrize("force", ["max(0, t - 5)", "sin(t)", "1e-30*t", "0*t"])
def test_a_force_in_time_is_not_looked_at_by_sampling(force: str) -> None:
    """Only what is written as zero is."""
    told = found(swing().replace('["2*t", 0.0, 1]', f'["2*t", "{force}", 1]'))
    assert told == (
        "not solved in the plane normal to y: forces.push.vector varies along y, of which 1 points out of the plane",
    )


DRIVEN_OUT = """
heun: 1
gravity: [0, 0, -9.81]
ground: {points: {O: [0, 0, 0]}}
bodies:
  arm: {mass: 1, center: [0, 0, 0.5], inertia: [1, 1, 1], points: {p: [0, 0, 0], q: [0, 0, 1]}}
  bob: {mass: 1, center: [0, 0, -1], inertia: [1, 1, 0.5], points: {p: [0, 0, 0]}, angular_velocity: [0, 1, 0]}
joints: {hook: {type: ball, from: ground.O, to: arm.p}, side: {type: pin, axis: [1, 0, 0], from: arm.q, to: bob.p}}
analysis: {duration: 1, samples: 3}
"""


@pytest.mark.parametrize(
    ("more", "what"),
    [
        ("stops: {s: {joint: side, angle: [-1, 1]}}", "stops.s limits an out-of-plane coordinate"),
        ("forces: {f: {type: torque, joint: side, value: 2}}", "forces.f acts out of the plane"),
        (
            "forces: {f: {type: force, on: {body: bob, at: [0, 0, -1]}, vector: [side.angle, 0, 0]}}",
            "forces.f uses side.angle, an out-of-plane coordinate",
        ),
        ("drives: {d: {joint: side, angle: 'sin(t)**2'}}", "drives.d moves joints.side out of the plane"),
    ],
)
def test_what_limits_names_or_moves_what_the_plane_leaves_out(more: str, what: str) -> None:
    assert isinstance(found(DRIVEN_OUT), Reduction)
    assert found(f"{DRIVEN_OUT}\n{more}\n") == (f"not solved in the plane normal to y: {what}",)


def test_a_force_that_turns_with_its_body_stays_in_the_plane() -> None:
    assert isinstance(found(swing(frame="body")), Reduction)


def test_the_plane_is_all_that_the_reduced_model_shows() -> None:
    """A motion in the plane that would leave it if it were pushed: that it cannot be seen is said."""
    reduced = found(swing())
    assert isinstance(reduced, Reduction)
    assert "symmetric about this plane" in reduced.explanations[0]
    assert "stability of the planar motion against out-of-plane disturbances" in reduced.limitations[0]


DOOR = """
heun: 1
gravity: [0.3, 0, -9.81]
ground: {{points: {{A: [0, 0, 0], B: [0, 0, 2], C: [1, 0, 0]}}}}
bodies:
  door: {{mass: 10, center: [0.5, 0.1, 1], inertia: [3, 4, 2], deviation: [0.1, 0.2, 0.3],
         points: {{a: [0, 0, 0], b: [{beside!r}, 0, 2], c: [0.9, 0.1, 1.2]}}}}
joints:
  bottom: {{type: ball, from: ground.A, to: door.a}}
  top: {{type: {top}, from: ground.B, to: door.b}}
forces:
  wind: {{type: force, on: door.c, vector: [0, "sin(t)", "cos(t)"]}}
  spring: {{type: spring, from: ground.C, to: door.c, stiffness: 20, length: 0.5}}
analysis: {{duration: 1, samples: 3}}
"""


@pytest.mark.parametrize("top", ["ball", "line, axis: [0, 0, 1]", "cylinder, axis: [0, 0, 1]"])
def test_two_hinges_hold_what_acts_out_of_the_plane(top: str) -> None:
    reduced = found(DOOR.format(top=top, beside=0.0))
    assert isinstance(reduced, Reduction)
    assert "the joints allow only rotations" in reduced.explanations[0]
    assert not reduced.limitations


@pytest.mark.parametrize("top", ["line, axis: [1, 0, 0]", "plane, normal: [0, 1, 0]"])
def test_one_hinge_and_a_guide_do_not(top: str) -> None:
    assert found(DOOR.format(top=top, beside=0.0)) == ()


def test_a_hinge_beside_the_line_of_the_other() -> None:
    """It turns about another line, by 5e-10: as the drawing has it, in the plane across that."""
    reduced = found(DOOR.format(top="ball", beside=1e-9).replace("B: [0, 0, 2]", "B: [1e-9, 0, 2]"))
    assert isinstance(reduced, Reduction)
    assert "normal to (5e-10, 0, 1)" in reduced.explanations[0]
