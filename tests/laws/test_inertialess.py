"""Bodies without inertia that only the closed loops hold: they run, and as the independent solution has them."""

from __future__ import annotations

import copy
import math
from typing import Any

import numpy as np
import pytest

from heuncli.base.errors import SolveError
from heuncli.study.queries.study import Study
from tests.oracle.read import Placed
from tests.oracle.scenes import random_scene
from tests.oracle.solve import solve
from tests.shared.scenes import instants, moving, near, solved, study

KINDS = ("ball", "line", "plane", "rod", "pin", "universal")
G = 9.81


def lacking(seed: int) -> tuple[dict[str, Any], dict[str, Placed]]:
    """Random loops most of whose bodies are point masses, or thin rods, off their axes; something holds all of them."""
    rng = np.random.default_rng(seed)
    while True:
        n, loops, drives = int(rng.integers(1, 6)), int(rng.integers(1, 5)), int(rng.integers(0, 2))
        try:
            scene, state = random_scene(rng, n, loops=loops, loop_kinds=KINDS, drives=drives)
        except RuntimeError:  # what is driven fits no loop
            continue
        for body in scene["bodies"].values():
            n = rng.standard_normal(3)
            thin = 0.1 * (np.eye(3) * (n @ n) - np.outer(n, n)) if seed % 2 else np.zeros((3, 3))
            if rng.random() < 0.7:
                body["inertia"] = thin.tolist()
        if solve(scene, state).loose.shape[1] == 0 and lent(found := study(scene)) and found.results:
            return scene, state


def lent(found: Study) -> int:
    """How many axes inertia is lent about."""
    return len(found.setup.scene.layout.tables["artificial_inertias"])


def as_the_oracle(scene: dict[str, Any], found: Study, tolerance: float) -> None:
    """Accelerations and certain forces at all instants."""
    results = found.results
    for k, t, state in instants(results):
        true = solve(scene, state, t)
        size = max(1.0, *(float(np.abs(a).max()) for a in true.angular_acceleration.values()))
        for name in scene["bodies"]:
            near(results.bodies[name]["center_acceleration"][k], true.acceleration[name], size, tolerance)
            near(results.bodies[name]["angular_acceleration"][k], true.angular_acceleration[name], size, tolerance)
        force = max(1.0, *(float(np.abs(r.force).max()) for r in true.reactions.values()))
        for name, r in true.reactions.items():
            told = results.joints[name]["force"][k]
            assert np.array_equal(np.isnan(told), ~r.unique[:3])
            near(np.where(r.unique[:3], told - r.force, 0.0), 0.0, force, tolerance)
            assert "drive" not in results.joints[name] or abs(results.joints[name]["drive"][k] - r.drive) < 1e-9 * force


@pytest.mark.parametrize("seed", range(40))
@pytest.mark.third
def test_random_loops(seed: int) -> None:
    scene, _ = lacking(seed)
    as_the_oracle(scene, study(scene), 1e-9)


@pytest.mark.heavy
@pytest.mark.parametrize("seed", (0, 3, 4, 7, 9, 10))
@pytest.mark.third
def test_they_move(seed: int) -> None:
    """What is lent has no energy: kinetic and potential energy less the work stay what they are."""
    scene, _ = lacking(seed)
    found = study(moving(scene, np.linspace(0, 0.1, 5), 1e-9))
    as_the_oracle(scene, found, 1e-8)
    energy = found.results.energy
    total = energy["kinetic"] + energy["potential"] - energy["work"]
    spread = max(1.0, float(np.abs(energy["kinetic"]).max()), float(np.abs(energy["work"]).max()))
    near(total, total[0], spread, 1e-7)


BEAM = {
    "gravity": [0.0, 0.0, -G],
    "ground": {"points": {"A": [0, 0, 0], "B": [2, 0, 0], "C": [1, 1, 0]}},
    "bodies": {
        "beam": {
            "mass": 3.0, "center": [0.8, 0.3, 0], "inertia": [0, 0, 0],
            "points": {"a": [0, 0, 0], "b": [2, 0, 0], "c": [1, 1, 0]},
        }
    },
    "joints": {
        "A": {"type": "ball", "from": "ground.A", "to": "beam.a"},
        "B": {"type": "line", "from": "ground.B", "to": "beam.b", "axis": [1, 0, 0]},
        "C": {"type": "plane", "from": "ground.C", "to": "beam.c", "normal": [0, 0, 1]},
    },
}  # fmt: skip


@pytest.mark.parametrize("inertia", [[0, 0, 0], [0.1, 0.2, 0.3]])
@pytest.mark.parametrize("order", ["ABC", "CBA", "BAC"])
def test_beam_on_ball_line_and_plane(inertia: list[float], order: str) -> None:
    """The centre is 0.45 A + 0.25 B + 0.3 C: so they share the weight, whatever the inertia."""
    scene = copy.deepcopy(BEAM)
    scene["bodies"]["beam"]["inertia"] = inertia  # type: ignore[index]
    scene["joints"] = {name: scene["joints"][name] for name in order}  # type: ignore[index]
    found = solved(scene)
    for name, share in (("A", 0.45), ("B", 0.25), ("C", 0.3)):
        near(found.joints[name]["force"][0], [0, 0, 3 * G * share], 3 * G, 1e-14)
    near(found.foundation["mass_effect"]["force"], 0.0, 3 * G, 1e-14)
    assert found.model["freedoms"] == 0


def test_a_spin_that_is_idle_beside_turns_that_are_held() -> None:
    """A point mass on a ball, its lever on another joint, lifted: all weight on the ball, none on the lever."""
    found = solved("""
heun: 1
gravity: [0, 0, -9.81]
ground: {points: {A: [0, 0, 0], B: [2, 0, 0]}}
bodies:
  m: {mass: 3, center: [0, 0, 0], inertia: [0, 0, 0], points: {a: [0, 0, 0], b: [2, 0, 0]}}
  jack: {mass: 1, center: [2, 0, 0], inertia: [0.1, 0.1, 0.1], points: {top: [2, 0, 0]}}
joints:
  A: {type: ball, from: ground.A, to: m.a}
  B: {type: line, axis: [1, 0, 0], from: jack.top, to: m.b}
  g: {type: slide, axis: [0, 0, 1], from: ground.B, to: jack.top}
drives: {s: {joint: g, travel: "0.1*sin(5*t)"}}
analysis: {duration: 1, samples: 5}
""")
    t = found.time
    near(found.joints["A"]["force"], np.tile([0, 0, 3 * G], (5, 1)), 3 * G, 1e-14)
    near(found.joints["B"]["force"], 0.0, 3 * G, 1e-14)
    near(found.joints["g"]["drive"], G - 2.5 * np.sin(5 * t), 3 * G, 1e-14)
    near(found.bodies["m"]["rotation"][:, 2, 0], 0.05 * np.sin(5 * t), 1.0, 1e-13)  # its end at the jack's height
    assert any("m: the spin about its own axis" in note for note in found.model["reasons"])


BEAD = """
heun: 1
gravity: [0, -9.81, 0]
{plane}
ground: {{points: {{A: [0, 0, 0]}}}}
bodies:
  bead: {{mass: 2, center: [0, 0, 0], inertia: [0, 0, 0], points: {{a: [0, 0, 0]}}}}
joints:
  wire: {{type: line, axis: [0.6, 0.8, 0], from: ground.A, to: bead.a}}
analysis: {{times: [0, 0.5], tolerance: 1e-12}}
"""


@pytest.mark.parametrize("plane", ["space: planar", ""], ids=["plane", "space"])
def test_bead_on_a_wire(plane: str) -> None:
    """It slides with 0.8 g down the wire; its spin matters to nothing."""
    found = solved(BEAD.format(plane=plane))
    near(found.bodies["bead"]["center_acceleration"], np.tile([-0.48 * G, -0.64 * G, 0], (2, 1)), G, 1e-14)
    near(found.bodies["bead"]["center"][1], [-0.06 * G, -0.08 * G, 0], 1.0, 1e-11)
    near(found.joints["wire"]["force"], 2 * 0.6 * G * np.array([[-0.8, 0.6, 0]] * 2), G, 1e-14)
    which = "the spin about its own axis" if plane else "its spin"
    assert f"bead: {which} is undetermined but harmless; set to zero" in found.model["reasons"]
    assert found.model["freedoms"] == 1


def linkage(inertia: float, lever: float = 1.0, crank: float = 0.0) -> str:
    """A parallelogram whose crank and coupler are point masses at their pins, so that the rocker alone has inertia."""
    return f"""
heun: 1
space: planar
gravity: [0, -9.81, 0]
ground: {{points: {{A: [0, 0, 0], B: [2, 0, 0]}}}}
bodies:
  crank: {{mass: 1, center: [0, 0, 0], inertia: {crank!r}, points: {{a: [0, 0, 0], b: [0, {lever!r}, 0]}}}}
  coupler: {{mass: 1, center: [0, {lever!r}, 0], inertia: {crank!r}, points: {{a: [0, {lever!r}, 0], b: [2, {lever!r}, 0]}}}}
  rocker: {{mass: 2, center: [2, 0, 0], inertia: {inertia!r}, points: {{a: [2, 0, 0], b: [2, {lever!r}, 0]}}}}
joints:
  A: {{type: pin, from: ground.A, to: crank.a}}
  C: {{type: pin, from: crank.b, to: coupler.a}}
  D: {{type: pin, from: rocker.b, to: coupler.b}}
  B: {{type: pin, from: ground.B, to: rocker.a}}
forces: {{push: {{type: couple, on: rocker, vector: [0, 0, 3]}}}}
"""  # noqa: E501


@pytest.mark.parametrize("inertia", [1e-3, 1.0, 1e3, 1e6])
@pytest.mark.parametrize("lever", [1e-3, 1.0])
def test_the_turning_inertia_may_be_light_or_heavy(inertia: float, lever: float) -> None:
    """(J + m l^2) phi.. = 3 N m, the coupler's m at the crank's end; the bar to the rocker carries J phi.. - 3 N m."""
    found = solved(linkage(inertia, lever))
    alpha = 3 / (inertia + lever**2)
    digits = 1e-14 * (1 + lever / math.sqrt(inertia))  # a light rocker that drives the heavy mass: by the root of both
    for body in ("crank", "rocker"):
        near(found.bodies[body]["angular_acceleration"][0, 2], alpha, alpha, digits)
    near(found.bodies["coupler"]["angular_acceleration"][0, 2], 0.0, alpha, digits)
    near(found.joints["D"]["force"][0, 0], -(3 - inertia * alpha) / lever, 3 / lever, digits)


@pytest.mark.heavy
def test_as_with_next_to_no_inertia() -> None:
    """What small true inertias tend to, by Richardson's rule."""
    more = ", angular_velocity: [0, 0, 2]}}\njoints"
    run = "\nanalysis: {times: [0, 0.4], tolerance: 1e-12}"
    ends = []
    for small in (0.0, 1e-3, 2e-3, 4e-3):
        text = linkage(0.5, 1.0, small).replace("}}\njoints", more) + run
        found = solved(text)
        ends.append(np.concatenate([found.bodies["rocker"]["rotation"][1, :2, 0], found.joints["A"]["force"][1, :2]]))
    exact, a, b, c = ends
    once = 2 * a - b, 2 * b - c
    near((4 * once[0] - once[1]) / 3, exact, 30.0, 1e-7)


REFUSED = {
    "a bead held at its side": (
        """
bodies:
  other: {mass: 1, inertia: [1, 1, 1], center: [0, 0, 0], points: {p: [0, 0, 0]}}
  b: {mass: 1, center: [0, 0.4, 0], inertia: [0, 0, 0], points: {p: [0, 0, 0]}}
joints:
  I: {type: pin, axis: [0, 0, 1], from: ground.O, to: other.p}
  J: {type: line, axis: [1, 0, 0], from: ground.O, to: b.p}
forces: {f: {type: force, on: b.p, vector: [0, 0, 1]}}
""",
        "bodies.b has no inertia about its axis (0, 0, 1)",
    ),
    "a rod along its pin, beside one across": (
        """
bodies:
  across: {shapes: [{type: rod, from: [0, 0, 0], to: [1, 0, 0], mass: 1}], points: {p: [0, 0, 0], q: [1, 0, 0]}}
  along: {shapes: [{type: rod, from: [1, 0, 0], to: [1, 0, 1], mass: 1}], points: {p: [1, 0, 0]}}
joints:
  I: {type: pin, axis: [0, 0, 1], from: ground.O, to: across.p}
  J: {type: pin, axis: [0, 0, 1], from: across.q, to: along.p}
""",
        "bodies.along has no inertia about its axis (0, 0, 1)",
    ),
    "a beam on a ball and a plane": (
        """
bodies:
  b: {mass: 1, center: [0.5, 0, 0], inertia: [0, 0, 0], points: {p: [0, 0, 0], q: [0, 1, 0], r: [1, 0, 0]}}
joints:
  I: {type: ball, from: ground.O, to: b.p}
  J: {type: plane, normal: [0, 0, 1], from: ground.O, to: b.r}
forces: {f: {type: force, on: b.q, vector: [0, 0, 1]}}
""",
        "bodies.b has no inertia about its axis (1, 0, 0)",
    ),
}


@pytest.mark.parametrize("name", REFUSED)
def test_what_nothing_holds_is_named(name: str) -> None:
    """The bodies that turn, and no others; the axis about which they do, in their own components."""
    text, wanted = REFUSED[name]
    with pytest.raises(SolveError) as refusal:
        solved("heun: 1\ngravity: [0, 0, -9.81]\nground: {points: {O: [0, 0, 0]}}" + text)
    (problem,) = refusal.value.problems
    assert problem.code == "no-inertia"
    assert problem.message == f"at t = 0 s a degree of freedom has no inertia: {wanted}"


@pytest.mark.heavy
def test_where_the_loops_cease_to_hold_the_run_ends() -> None:
    """Towards the dead centre the slider's mass is behind the crank by the square of a slope that vanishes there."""
    with pytest.raises(SolveError) as refusal:
        solved(dead_centre(1.0).replace("vector: [0, 0, 1]", "vector: [0, 0, -1]") + "analysis: {times: [0, 3]}")
    (problem,) = refusal.value.problems
    assert problem.code == "step-collapsed"
    assert problem.hint.endswith("closed loops release the rotation of bodies without inertia: bodies.crank")


def dead_centre(angle: float) -> str:
    """A crank without inertia and a heavy slider, the crank turned by an angle from where it lies along the rod."""
    c, s = math.cos(angle), math.sin(angle)
    x = c + math.sqrt(9 - s * s)
    return f"""
heun: 1
space: planar
ground: {{points: {{O: [0, 0, 0]}}}}
bodies:
  crank: {{mass: 1, center: [0, 0, 0], inertia: 0, points: {{o: [0, 0, 0], p: [{c!r}, {s!r}, 0]}}}}
  slider: {{mass: 2, center: [{x!r}, 0, 0], inertia: 1, points: {{q: [{x!r}, 0, 0]}}}}
joints:
  O: {{type: pin, from: ground.O, to: crank.o}}
  rod: {{type: rod, length: 3, from: crank.p, to: slider.q}}
  guide: {{type: slide, axis: [1, 0, 0], from: ground.O, to: slider.q}}
forces: {{turn: {{type: couple, on: crank, vector: [0, 0, 1]}}}}
"""


@pytest.mark.parametrize("angle", [1.0, 1e-2, 1e-4, 3e-6])
def test_beside_a_dead_centre(angle: float) -> None:
    """The slider's mass behind the crank by the square of dx/dphi, which vanishes with the angle."""
    slope = -math.sin(angle) * (1 + math.cos(angle) / math.sqrt(9 - math.sin(angle) ** 2))
    found = solved(dead_centre(angle))
    near(found.bodies["slider"]["center_acceleration"][0, 0], 0.5 / slope, 0.5 / abs(slope), 1e-14 / angle)
    near(found.bodies["crank"]["angular_acceleration"][0, 2], 0.5 / slope**2, 0.5 / slope**2, 1e-14 / angle)


@pytest.mark.parametrize("angle", [0.0, 1e-9, 1e-7, 3e-7])
def test_at_a_dead_centre_nothing_is_behind_the_crank(angle: float) -> None:
    with pytest.raises(SolveError, match=r"has no inertia: bodies\.crank has no inertia about its axis \(0, 0, 1\)"):
        solved(dead_centre(angle))
