"""Bodies without mass: frames between joints, and bars whose mass does not matter.

Against joints that are the same chain (a ball, a universal joint), closed forms, and the limit of a small mass m: what
differs from m = 0 is of first order in m.
"""

from __future__ import annotations

import math

import numpy as np
import pytest

from heuncli.base.errors import SolveError, SpecError
from heuncli.results.results import Array, Results
from heuncli.scene.shapes.rotations import rotation_from_vector
from tests.shared.scenes import near, solved

HEAD = "heun: 1\ngravity: [0, 0, -9.81]\nground: {points: {O: [0, 0, 0], S: [0.4, 0.3, 0.2]}}\n"
TOP = "mass: 2, center: [0.1, 0, -0.5], inertia: [0.1, 0.15, 0.07], points: {a: [0, 0, 0], e: [0, 0, -1]}"
FRAME = "mass: 0, points: {c: [0, 0, 0]}"
SPRING = "forces: {k: {type: spring, from: ground.S, to: s.e, stiffness: 30, length: 0.2}}\n"
RUN = "analysis: {duration: 0.6, samples: 7, tolerance: 1e-11}\n"


def turn(axis: str, angle: float) -> Array:
    """The rotation about an axis by its name."""
    return rotation_from_vector(angle * np.eye(3)["xyz".index(axis)])


def require_same(found: Results, wanted: Results, joint: str, other: str) -> None:
    """The motion of the body s and a joint's force are the same in two results."""
    for key, size in (("position", 1.0), ("rotation", 1.0), ("angular_velocity", 3.0)):
        near(found.bodies["s"][key], wanted.bodies["s"][key], size, 1e-8)
    near(found.joints[joint]["force"], wanted.joints[other]["force"], 20.0, 1e-8)


def test_three_pins_in_a_row_are_a_ball() -> None:
    """A gimbal, its two rings without mass, beside a ball with the same start: R = Rz(a) Rx(b) Rz(c)."""
    a, b, c = 0.3, 0.7, 0.2
    rates = (1.0, 0.5, 3.0)
    pins = (
        f"bodies: {{x: {{{FRAME}}}, y: {{{FRAME}}}, s: {{{TOP}}}}}\njoints:\n"
        f"  u: {{type: pin, from: ground.O, to: x.c, axis: [0, 0, 1], initial: {{angle: {a}, rate: {rates[0]}}}}}\n"
        f"  v: {{type: pin, from: x.c, to: y.c, axis: [1, 0, 0], initial: {{angle: {b}, rate: {rates[1]}}}}}\n"
        f"  w: {{type: pin, from: y.c, to: s.a, axis: [0, 0, 1], initial: {{angle: {c}, rate: {rates[2]}}}}}\n"
    )
    first, second = turn("z", a), turn("z", a) @ turn("x", b)
    spin = rates[0] * np.eye(3)[2] + rates[1] * first[:, 0] + rates[2] * second[:, 2]
    start = f"orientation: {{matrix: {(second @ turn('z', c)).tolist()}}}, angular_velocity: {spin.tolist()}"
    ball = f"bodies: {{s: {{{TOP}, {start}}}}}\njoints: {{b: {{type: ball, from: ground.O, to: s.a}}}}\n"
    require_same(solved(HEAD + pins + SPRING + RUN), solved(HEAD + ball + SPRING + RUN), "w", "b")


def test_two_pins_are_a_universal_joint() -> None:
    """A cross without mass passes the moment on that a universal joint passes on."""
    a, b = 0.3, 0.2
    pins = (
        f"bodies: {{x: {{{FRAME}}}, s: {{{TOP}}}}}\njoints:\n"
        f"  u: {{type: pin, from: ground.O, to: x.c, axis: [0, 1, 0], initial: {{angle: {a}}}}}\n"
        f"  v: {{type: pin, from: x.c, to: s.a, axis: [1, 0, 0], initial: {{angle: {b}}}}}\n"
    )
    start = f"orientation: {{matrix: {(turn('y', a) @ turn('x', b)).tolist()}}}, angular_velocity: [0, 0, 0]"
    cross = (
        f"bodies: {{s: {{{TOP}, {start}}}}}\n"
        "joints: {b: {type: universal, from: ground.O, to: s.a, axis: [0, 1, 0], to_axis: [1, 0, 0]}}\n"
    )
    found, wanted = (solved(HEAD + text + SPRING + RUN) for text in (pins, cross))
    require_same(found, wanted, "v", "b")
    near(found.joints["v"]["moment"], wanted.joints["b"]["moment"], 10.0, 1e-8)
    near(found.joints["u"]["moment"], wanted.joints["b"]["moment"], 10.0, 1e-8)


LIMIT = "mass: {m!r}, center: [0, 0, 0], inertia: [{J!r}, {J!r}, {J!r}]"
SCENES = {
    "springs, a torque and friction on the frame": (
        "bodies: {{x: {{{frame}, points: {{c: [0, 0, 0], e: [0, 0.1, 0.2]}}}}, s: {{{top}}}}}\njoints:\n"
        "  u: {{type: pin, from: ground.O, to: x.c, axis: [0, 1, 0]}}\n"
        "  v: {{type: pin, from: x.e, to: s.a, axis: [1, 0, 0], initial: {{angle: 0.2}}}}\n"
        "forces:\n  k: {{type: spring, from: ground.S, to: x.e, stiffness: 30, length: 0.1}}\n"
        "  t: {{type: torque, joint: u, value: 0.8*sin(3*t)}}\n  r: {{type: friction, joint: u, torque: 0.3}}\n"
    ),
    "stops and a blow": (
        "bodies: {{x: {{{frame}, points: {{c: [0, 0, 0], e: [0, 0.1, 0.2]}}}}, s: {{{top}}}}}\njoints:\n"
        "  u: {{type: pin, from: ground.O, to: x.c, axis: [0, 1, 0]}}\n"
        "  v: {{type: pin, from: x.e, to: s.a, axis: [1, 0, 0], initial: {{angle: 0.2}}}}\n"
        "stops: {{s: {{joint: v, angle: [-0.1, 0.4], restitution: 0.5}}, w: {{joint: u, angle: [-0.3, 0.1], "
        "restitution: 0.3}}}}\nimpulses: {{h: {{on: x.e, vector: [1, 0, 0.3], time: 0.05}}}}\n"
    ),
    "the slider of a crank": (
        "bodies:\n  s: {{mass: 1, center: [0.05, 0, 0], inertia: [0.001, 0.01, 0.01], points: {{o: [0, 0, 0], "
        "p: [0.1, 0, 0]}}}}\n  rod: {{mass: 2, center: [0.2, 0, 0], inertia: [0.001, 0.03, 0.03], "
        "points: {{p: [0, 0, 0], e: [0.4, 0, 0]}}}}\n  slider: {{{frame}, points: {{c: [0, 0, 0]}}}}\njoints:\n"
        "  u: {{type: pin, from: ground.O, to: s.o, axis: [0, 1, 0], initial: {{angle: 0.5, rate: 10}}}}\n"
        "  p: {{type: pin, from: s.p, to: rod.p, axis: [0, 1, 0]}}\n"
        "  v: {{type: pin, from: rod.e, to: slider.c, axis: [0, 1, 0]}}\n"
        "  g: {{type: slide, from: ground.O, to: slider.c, axis: [1, 0, 0]}}\n"
    ),
}


@pytest.mark.heavy
@pytest.mark.parametrize("scene", SCENES)
def test_a_small_mass_differs_in_first_order(scene: str) -> None:
    def solve_with(frame: str) -> tuple[Array, Array]:
        results = solved(HEAD + SCENES[scene].format(frame=frame, top=TOP) + RUN)
        reactions = [results.joints[name][key] for name in ("u", "v") for key in ("force", "moment")]
        return np.concatenate([results.bodies["s"]["position"], results.bodies["s"]["rotation"][:, 0]]), np.array(
            [np.nan_to_num(reaction) for reaction in reactions]
        )

    exact = solve_with("mass: 0")
    large, small = (solve_with(LIMIT.format(m=m, J=0.01 * m)) for m in (1e-4, 1e-5))
    for none, less, more in zip(exact, small, large, strict=True):
        extrapolated = less + (less - more) / 9.0
        size = float(np.abs(none).max())
        assert np.abs(less - none).max() > 1e-8 * size, "the mass matters"
        near(extrapolated, none, size, 1e-7)


@pytest.mark.parametrize("count", [3, 6])
def test_a_boom_without_mass_carries_its_load(count: int) -> None:
    """A mass at its end, turned by w t + a t^2/2: N = m w'^2 L, Q1 = -m a L, Q2 = -m g, moments these times L - s."""
    w, a, L, m = 2.0, 3.0, 1.5, 5.0
    scene = (
        f"{HEAD}bodies:\n  boom: {{mass: 0, points: {{root: [0, 0, 0], end: [{L}, 0, 0]}}}}\n"
        f"  load: {{mass: {m}, center: [0, 0, 0], inertia: [0, 0, 0], points: {{c: [0, 0, 0]}}}}\njoints:\n"
        "  u: {type: pin, from: ground.O, to: boom.root, axis: [0, 0, 1]}\n"
        "  fixed: {type: weld, from: boom.end, to: load.c}\n"
        f"drives: {{d: {{joint: u, angle: {w}*t + {a / 2}*t**2}}}}\n"
        f"sections:\n  r: {{body: boom, from: root, to: end, count: {count}, first_axis: [0, 1, 0]}}\n"
        "  one: {body: boom, at: [0.5, 0, 0], normal: [1, 0, 0], first_axis: [0, 1, 0]}\n"
        "analysis: {duration: 1, samples: 5}\n"
    )
    results = solved(scene)
    t = results.time
    for section, s in ((results.sections["r"], np.linspace(0.0, L, count)), (results.sections["one"], np.array([0.5]))):
        N, Q1, Q2, M1, M2 = (np.asarray(section[key]).reshape(len(t), -1) for key in ("N", "Q1", "Q2", "M1", "M2"))
        near(N, (m * (w + a * t) ** 2 * L)[:, None] + 0.0 * s, 100.0, 1e-12)
        near(Q1, -m * a * L + 0.0 * N, 100.0, 1e-12)
        near(Q2, -m * 9.81 + 0.0 * N, 100.0, 1e-12)
        near(M1, m * 9.81 * (L - s) + 0.0 * N, 100.0, 1e-12)
        near(M2, -m * a * L * (L - s) + 0.0 * N, 100.0, 1e-12)


def test_frames_at_rest() -> None:
    """A pendulum on a frame, drawn aside by a force in each direction: it hangs along the force and the weight."""
    scene = (
        f"{HEAD}bodies: {{x: {{{FRAME}}}, s: {{mass: 2, center: [0, 0, -0.5], inertia: [0, 0, 0], "
        "points: {a: [0, 0, 0], e: [0, 0, -0.5]}}}\n"
        "joints:\n  u: {type: pin, from: ground.O, to: x.c, axis: [0, 1, 0]}\n"
        "  v: {type: pin, from: x.c, to: s.a, axis: [1, 0, 0]}\n"
        "forces: {f: {type: force, on: s.e, vector: [3, 4, 0]}}\nanalysis: {type: rest}\n"
    )
    results = solved(scene)
    force = np.array([3.0, 4.0, -19.62])
    near(results.bodies["s"]["center"][0], 0.5 * force / math.sqrt(force @ force), 1.0, 1e-10)
    near(results.joints["v"]["force"][0], -force, 20.0, 1e-12)


LOOSE = {
    "the cross of parallel pins": (
        "joints: {u: {type: pin, from: ground.O, to: x.c, axis: [0, 1, 0]}, "
        "v: {type: pin, from: x.c, to: s.a, axis: [0, 1, 0]}}",
        "bodies.x has no inertia about its axis (0, 1, 0)",
    ),
    "a slide that carries nothing": (
        "joints: {u: {type: slide, from: ground.O, to: x.c, axis: [0, 1, 0]}, "
        "v: {type: pin, from: ground.O, to: s.a, axis: [0, 1, 0]}}",
        "bodies.x can shift without moving any mass",
    ),
    "nothing holds it": (
        "joints: {v: {type: pin, from: ground.O, to: s.a, axis: [0, 1, 0]}}",
        "bodies.x can shift without moving any mass",
    ),
}


@pytest.mark.parametrize("scene", LOOSE)
def test_a_freedom_that_moves_no_mass_is_refused(scene: str) -> None:
    joints, message = LOOSE[scene]
    with pytest.raises(SolveError) as refused:
        solved(f"{HEAD}bodies: {{x: {{{FRAME}}}, s: {{{TOP}}}}}\n{joints}\n{RUN}")
    assert [problem.code for problem in refused.value.problems] == ["no-inertia"]
    assert message in str(refused.value)


def test_a_gimbal_in_line_is_refused() -> None:
    """Its first and third axis coincide at the start: the rings turn against each other without moving mass."""
    with pytest.raises(SolveError, match="no inertia about"):
        solved(
            f"{HEAD}bodies: {{x: {{{FRAME}}}, y: {{{FRAME}}}, s: {{{TOP}}}}}\njoints:\n"
            "  u: {type: pin, from: ground.O, to: x.c, axis: [0, 0, 1]}\n"
            "  v: {type: pin, from: x.c, to: y.c, axis: [1, 0, 0], initial: {angle: 0}}\n"
            f"  w: {{type: pin, from: y.c, to: s.a, axis: [0, 0, 1]}}\n{RUN}"
        )


@pytest.mark.parametrize("arm", [0.1, 0.2, 0.3, 0.31, 0.5, 0.7, 0.9])
def test_two_pins_on_one_axis_are_refused_wherever_the_load_hangs(arm: float) -> None:
    """The ring between the pins can turn by itself, whatever rounding leaves of the inertia that it carries."""
    text = HEAD + (
        f"bodies:\n  x: {{{FRAME}}}\n  s: {{mass: 100, center: [{arm}, 0, {-arm}], inertia: [0.1, 0.1, 0.1]}}\n"
        "joints:\n"
        "  u: {type: pin, from: ground.O, to: x.c, axis: [0, 1, 0.3]}\n"
        "  v: {type: pin, from: x.c, to: {body: s, at: [0, 0, 0]}, axis: [0, 1, 0.3]}\n"
    )
    with pytest.raises(SolveError) as refused:
        solved(text + "analysis: {duration: 0.1, samples: 2}\n")
    assert refused.value.problems[0].code == "no-inertia"


def test_some_body_has_mass() -> None:
    with pytest.raises(SpecError, match="mass must be greater than 0"):
        solved(f"{HEAD}bodies: {{x: {{{FRAME}}}}}\njoints: {{u: {{type: pin, from: ground.O, to: x.c}}}}\n{RUN}")


@pytest.mark.parametrize("origin", [0.0, -0.2])
def test_a_planar_bar_without_mass_has_the_angle_of_its_pin(origin: float) -> None:
    """Wherever its origin is, also at the pin: a load on a bar of length L at the angle a, a'' = -g cos a/L."""
    L = 0.8
    results = solved(
        "heun: 1\nspace: planar\ngravity: [0, -9.81, 0]\nground: {points: {O: [0, 0, 0]}}\n"
        f"bodies:\n  bar: {{mass: 0, points: {{root: [{origin}, 0, 0], end: [{origin + L}, 0, 0]}}}}\n"
        "  load: {mass: 2, center: [0, 0, 0], inertia: 0.0, points: {c: [0, 0, 0]}}\njoints:\n"
        "  u: {type: pin, from: ground.O, to: bar.root}\n  fixed: {type: weld, from: bar.end, to: load.c}\n"
        "analysis: {duration: 1, samples: 11}\n"
    )
    swing, position = results.coordinates["u"], results.bodies["load"]["center"]
    near(swing["angle"], np.arctan2(position[:, 1], position[:, 0]), 1.0, 1e-12)
    near(swing["acceleration"], -9.81 * np.cos(swing["angle"]) / L, 10.0, 1e-9)
    near(results.joints["u"]["radial"], np.linalg.norm(results.joints["u"]["force"], axis=1), 20.0, 1e-12)
