"""Scenes that only look as if less would do: what is reduced is told, what is not is told with its reason, and wherever
less moves in a scene's place the numbers are those of the whole.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import NamedTuple

import numpy as np
import pytest

from heuncli.base.errors import SolveError
from heuncli.multibody.reduction.compose import ReducedScene
from heuncli.scene.file_format.load import load
from heuncli.study.model.options import Options
from heuncli.study.model.setup import set_up
from heuncli.study.workflow import solve
from tests.oracle.values import to_yaml
from tests.shared.reduced import pair, same
from tests.shared.reducible import driven
from tests.shared.scenes import moving, near, solved

PLANE = "solved in the plane"


class Arm(NamedTuple):
    """Two bars in the xy plane on joints of a kind, and what of them leaves it."""

    kind: str = "ball"
    center: float = 0.0  # of the second bar, above the plane [m]
    spin: float = 0.0  # of the first bar, about x [rad/s]
    gravity: float = 0.0  # along z [m/s^2]
    deviation: float = 0.0  # of the first bar's inertia [kg m^2]
    point: float = 0.0  # of the first bar, above the plane [m]
    tail: str = ""

    def text(self) -> str:
        """The scene."""
        axis = "" if self.kind == "ball" else ", axis: [0, 0, 1]"
        D = self.deviation
        return f"""
heun: 1
gravity: [0, -9.81, {self.gravity!r}]
ground: {{points: {{O: [0, 0, 0], P: [1.5, 0.3, 0]}}}}
bodies:
  a:
    mass: 1
    center: [0.4, 0, 0]
    inertia: [[0.02, 0, {D!r}], [0, 0.03, 0], [{D!r}, 0, 0.045]]
    points: {{o: [0, 0, 0], e: [0.9, 0, 0], s: [0.4, 0.1, {self.point!r}]}}
    orientation: {{axis: [0, 0, 1], angle: -40 deg}}
    angular_velocity: [{self.spin!r}, 0, 0.5]
  b:
    mass: 0.8
    center: [0.3, 0, {self.center!r}]
    inertia: [0.01, 0.02, 0.028]
    points: {{o: [0, 0, 0], e: [0.7, 0, 0]}}
    orientation: {{axis: [0, 0, 1], angle: 20 deg}}
joints:
  root: {{type: {self.kind}, from: ground.O, to: a.o{axis}}}
  elbow: {{type: {self.kind}, from: a.e, to: b.o{axis}}}
{self.tail}
analysis: {{duration: 2, samples: 5}}
"""


def load_of(vector: str, kind: str = "force") -> str:
    return f"forces: {{f: {{type: {kind}, on: b.e, vector: {vector}}}}}"


def spring() -> str:
    return "forces: {f: {type: spring, from: ground.P, to: a.s, stiffness: 50, length: 0.2}}"


FLAT = {
    "as drawn": Arm(),
    "a couple about the normal": Arm(tail=load_of('[0, 0, "sin(3*t)"]', "couple")),
    "a spring": Arm(tail=spring()),
    "a blow along it": Arm(tail="impulses: {h: {on: b.e, vector: [0, 0.1, 0], time: 1}}"),
    "pins, and all that acts points out of it": Arm(
        "pin", center=0.2, point=0.4, deviation=0.001, tail=load_of('[1, "sin(t)", "5*t"]')
    ),
    "pins, and a blow out of it": Arm("pin", tail="impulses: {h: {on: b.e, vector: [0.1, 0.2, 0.5], time: 1}}"),
}
NOT_FLAT = {  # and what is told
    "a centre beside it": (Arm(center=1e-9), "bodies.b.center is 1e-09 m off the plane"),
    "a deviation": (Arm(deviation=1e-9), "bodies.a: its inertia has an out-of-plane component of 1e-09 kg m^2"),
    "gravity beside it": (Arm(gravity=1e-9), "gravity has an out-of-plane component of 1e-09 m/s^2"),
    "a spin": (Arm(spin=1e-9), "bodies.a.angular_velocity has an out-of-plane component of 1e-09 rad/s"),
    "a spring beside it": (Arm(point=1e-9, tail=spring()), "a point of forces.f is 1e-09 m off the plane"),
    "a blow at 1 s": (Arm(tail="impulses: {h: {on: b.e, vector: [0, 1, 1.0e-9], time: 1}}"),
                      "impulses.h at t = 1 s has an out-of-plane component of 1e-09 N s"),
    "a couple": (
        Arm(tail=load_of("[1.0e-6, 0, 1]", "couple")), "forces.f.vector has an out-of-plane component of 1e-06 N m"
    ),
    "a force from 1 s on": (Arm(tail=load_of('[0, 0, "0 if t < 1 else 5"]')), "forces.f.vector varies along z"),
    "a table that begins at 0": (
        Arm(tail="tables: {w: {x: [0, 1, 2], y: [0, 0, 5]}}\n" + load_of('[0, 0, "table(w, t)"]')),
        "forces.f.vector varies along z",
    ),
}  # fmt: skip


def reduced(text: str) -> ReducedScene:
    """What is left out of a scene, nothing integrated."""
    found = set_up(load("scene.yaml", text)).reduction
    assert found is not None
    return found


def in_plane(found: ReducedScene) -> bool:
    return any(sentence.startswith(PLANE) for sentence in found.explanations)


@pytest.mark.parametrize("name", FLAT)
def test_flat(name: str) -> None:
    both = pair(load("scene.yaml", FLAT[name].text()))
    same(both)
    found = both.small.setup.reduction
    assert found is not None and in_plane(found)
    # what joints hold in the plane cannot leave it; what is its own mirror image could
    assert bool(found.limitations) == (FLAT[name].kind == "ball")


@pytest.mark.parametrize("name", NOT_FLAT)
def test_flat_but_for(name: str) -> None:
    arm, why = NOT_FLAT[name]
    found = reduced(arm.text())
    assert not in_plane(found)
    assert any(why in sentence for sentence in found.exceptions), found.exceptions


def lateral(tail: str, rate: float = 0.0) -> str:
    """A pendulum that carries a bar on a pin along itself, which does not turn in the plane."""
    return f"""
heun: 1
gravity: [0, -9.81, 0]
ground: {{points: {{O: [0, 0, 0]}}}}
bodies:
  a: {{mass: 1, center: [0.4, 0, 0], inertia: [0.02, 0.03, 0.045], points: {{o: [0, 0, 0], e: [0.9, 0, 0]}},
    orientation: {{axis: [0, 0, 1], angle: -40 deg}}}}
  b: {{mass: 0.5, center: [0.2, 0, 0], inertia: [0.01, 0.012, 0.02], points: {{o: [0, 0, 0], e: [0.5, 0, 0]}},
    orientation: {{axis: [0, 0, 1], angle: -40 deg}}}}
joints:
  root: {{type: pin, from: ground.O, to: a.o, axis: [0, 0, 1]}}
  along: {{type: pin, from: a.e, to: b.o, axis: [1, 0, 0], initial: {{angle: 0, rate: {rate!r}}}}}
{tail}
analysis: {{duration: 1, samples: 5}}
"""


OUT_OF_IT = {
    "driven from 0.5 s on": 'drives: {d: {joint: along, angle: "0 if t < 0.5 else (t - 0.5)**2"}}',
    "a torque at an angle": 'forces: {f: {type: torque, joint: along, value: "0.1*step(root.angle + 1)"}}',
    "a force at an angle": 'forces: {f: {type: force, on: b.e, vector: [0, 0, "0 if root.angle > -1 else 5"]}}',
    "named": 'forces: {f: {type: torque, joint: root, value: "1 + along.angle"}}',
    "limited": "stops: {s: {joint: along, angle: [-0.1, 0.1]}}",
    "at its limit": "stops: {s: {joint: along, angle: [0, 0.1]}}",
}


@pytest.mark.parametrize("name", OUT_OF_IT)
def test_coordinates_out_of_the_plane(name: str) -> None:
    """What drives, loads, names or limits the turn that the plane has not."""
    assert not in_plane(reduced(lateral(OUT_OF_IT[name])))


def test_a_coordinate_out_of_the_plane_at_rest() -> None:
    assert in_plane(reduced(lateral("")))
    assert in_plane(reduced(lateral("forces: {f: {type: damper, joint: along, coefficient: 1}}")))
    assert not in_plane(reduced(lateral("", rate=1e-9)))


def wire(tail: str = "", radius: str = "0.01", off: float = 0.0, spin: str = "[0.5, 0.2, 3]") -> str:
    """A wire on a ball that is off its axis by so much."""
    return f"""
heun: 1
gravity: [0, 0, -9.81]
ground: {{points: {{O: [0, 0, 0], P: [0.5, 0, 0]}}}}
bodies:
  w:
    shapes: [{{type: cylinder, from: [0, 0, 0], to: [0, 0, -1], radius: {radius}, density: 7850}}]
    points: {{o: [{off!r}, 0, 0], m: [0, 0, -0.5], e: [0, 0, -1], beside: [0, 0.005, -0.5]}}
    orientation: {{axis: [1, 0, 0], angle: 60 deg}}
    angular_velocity: {spin}
joints: {{p: {{type: ball, from: ground.O, to: w.o}}}}
{tail}
analysis: {{duration: 0.5, samples: 5}}
"""


SPUN = {
    "alone": wire(),
    "fast": wire(spin="{vector: [0.5, 0.2, 200], frame: body}"),
    "a spring on its axis": wire("forces: {s: {type: spring, from: ground.P, to: w.m, stiffness: 20, length: 0.1}}"),
    "a blow on its axis": wire("impulses: {h: {on: w.e, vector: [0.1, 0, 0], time: 0.25}}"),
}
TURNED = {
    "a joint beside its axis": wire(off=1e-10),
    "a couple along it": wire("forces: {c: {type: couple, on: w, vector: [0.01, 0, 1.0e-9], frame: body}}"),
    "a couple along it, later": wire(
        'forces: {c: {type: couple, on: w, vector: [0, 0, "1e-3*step(t - 0.25)"], frame: body}}'
    ),
    "a force beside it": wire("forces: {c: {type: force, on: w.beside, vector: [1, 0, 0]}}"),
    "a blow beside it": wire("impulses: {h: {on: w.beside, vector: [1, 0, 0], time: 0.25}}"),
    "a couple's blow": wire("impulses: {h: {body: w, couple: [0.01, 0.02, 0.03], time: 0.25}}"),
    "a spring beside it": wire("forces: {s: {type: spring, from: ground.P, to: w.beside, stiffness: 20, length: 0}}"),
    "a damper": wire("forces: {d: {type: damper, joint: p, coefficient: 0.01}}"),
}


@pytest.mark.parametrize("name", SPUN)
def test_spins(name: str) -> None:
    both = pair(load("scene.yaml", SPUN[name]))
    same(both)
    assert any("axisymmetric" in sentence for sentence in both.told)


@pytest.mark.parametrize("name", TURNED)
def test_spins_that_something_changes(name: str) -> None:
    assert not any("axisymmetric" in sentence for sentence in reduced(TURNED[name]).explanations)


def test_a_thin_wire_moves_as_a_rod() -> None:
    """A hundredth of a millimetre on a metre: but for the square of that, 1e-10, as without inertia about its axis."""
    thin = solve(load("scene.yaml", wire(radius="1.0e-5"))).results
    mass = math.pi * 1e-10 * 7850
    shape = f"{{type: rod, from: [0, 0, 0], to: [0, 0, -1], mass: {mass!r}}}"
    cylinder = "{type: cylinder, from: [0, 0, 0], to: [0, 0, -1], radius: 1.0e-5, density: 7850}"
    rod = solve(load("scene.yaml", wire(radius="1.0e-5").replace(cylinder, shape))).results
    error = 1e-9 + thin.accuracy["estimate"]["motion"] + rod.accuracy["estimate"]["motion"]
    near(thin.bodies["w"]["center"], rod.bodies["w"]["center"], 1.0, error)
    assert thin.work["steps"] <= 2 * rod.work["steps"]


EQUAL = """
heun: 1
gravity: [0, -9.81, 0]
ground: {points: {O: [0, 0, 0]}}
bodies:
  crank: {mass: 1, center: [0.2, 0, 0], inertia: [0.01, 0.02, 0.02], points: {o: [0, 0, 0], e: [0.4, 0, 0]}}
  rod: {mass: 0.8, center: [0.2, 0, 0], inertia: [0.01, 0.07, 0.07], points: {a: [0, 0, 0], e: [0.4, 0, 0]}}
  piston: {mass: 0.5, center: [0, 0, 0], inertia: [0.001, 0.001, 0.001], points: {o: [0, 0, 0]}}
joints:
  shaft: {type: pin, from: ground.O, to: crank.o, axis: [0, 0, 1]}
  big: {type: pin, from: crank.e, to: rod.a, axis: [0, 0, 1]}
  small: {type: pin, from: rod.e, to: piston.o, axis: [0, 0, 1]}
  guide: {type: slide, from: ground.O, to: piston.o, axis: [1, 0, 0]}
drives: {motor: {joint: shaft, angle: "0.3 + 2*t"}}
analysis: {duration: 1, samples: 5}
"""


def test_a_crank_as_long_as_its_rod() -> None:
    """In the folded pose another motion branches off: what is followed comes no nearer, what is integrated goes on."""
    both = pair(load("scene.yaml", EQUAL))
    same(both)
    assert any("singular position" in why for why in both.small.results.model["not_reduced"])


@pytest.mark.heavy
def test_a_lock_is_told_alike() -> None:
    """Steps along a branch become ever shorter where the drives ask for what does not go."""
    scene = load("scene.yaml", to_yaml(moving(driven(21), (0.0, 0.3), 1e-9)))
    told = []
    for reduce in (False, True):
        with pytest.raises(SolveError) as error:
            solve(scene, Options(reduce=reduce))
        told.append(error.value.problems[0])
    assert [problem.code for problem in told] == ["closure-lost"] * 2
    assert "0.18033" in told[0].message and "0.18033" in told[1].message


@pytest.mark.parametrize("axis", [(1.0, 0.0, 0.0), (0.9164473465668924, -0.1543267025528435, -0.36919849654307685)])
def test_bearings_in_line_let_a_shaft_turn_whatever_its_direction(axis: tuple[float, ...]) -> None:
    """Seen along an oblique shaft, their points are apart by rounding, which holds no turn: it stood still once."""
    n = np.array(axis)
    places = {f"b{k}": (0.1 * k * n).tolist() for k in range(4)}
    bearing = {"type": "line", "axis": list(axis)}
    first = {"type": "ball", "from": "ground.b0", "to": "shaft.b0"}
    others = {name: bearing | {"from": f"ground.{name}", "to": f"shaft.{name}"} for name in list(places)[1:]}
    across = np.eye(3) - np.outer(n, n)
    found = solved({
        "ground": {"points": places},
        "bodies": {"shaft": {"mass": 3.0, "center": (0.2 * n).tolist(), "points": places,
                             "inertia": (0.5 * np.outer(n, n) + 0.7 * across).tolist()}},
        "joints": {"b0": first, **others},
        "forces": {"motor": {"type": "couple", "on": "shaft", "vector": (2.0 * n).tolist()}},
        "analysis": {"times": [0.0, 0.5, 1.0]},
    })  # fmt: skip
    assert found.bodies["shaft"]["angular_velocity"] @ n == pytest.approx([0.0, 2.0, 4.0], abs=1e-9)


@pytest.mark.parametrize("reduce", [True, False])
@pytest.mark.parametrize("axis", ["z", "x"])
@pytest.mark.parametrize(
    ("text", "law"),
    [
        ("1 + 2*step(g.speed)", lambda x, u: 3.0),
        ("1 + 2*step(g.travel - 0.3)", lambda x, u: 1.0 if x < 0.3 else 3.0),
        ("abs(g.travel - 0.25)", lambda x, u: abs(x - 0.25)),
        ("3 if 0.1 < g.travel and g.travel < 0.21 else u0", lambda x, u: 3.0 if 0.1 < x < 0.21 else 1.0),
        ("sign(1.3 - g.speed)", lambda x, u: math.copysign(1.0, 1.3 - u)),
    ],
)
def test_a_load_across_the_plane_by_cases_is_that_of_its_case(
    text: str, law: Callable[[float, float], float], axis: str, reduce: bool
) -> None:
    """A slider at 1 m/s and 1 m/s^2: nothing in the plane of its motion has the cases of the load across it."""
    vector = f'[0, 0, "{text}"]' if axis == "z" else f'["{text}", 0, 0]'
    kind = (
        f"{{type: force, on: b.p, vector: {vector}}}" if axis == "z" else f"{{type: couple, on: b, vector: {vector}}}"
    )
    found = solved(
        f"""
heun: 1
parameters: {{u0: 1}}
ground: {{points: {{O: [0, 0, 0]}}}}
bodies: {{b: {{mass: 2, center: [0, 0, 0], inertia: [1, 1, 1], points: {{p: [0, 0, 0]}}}}}}
joints: {{g: {{type: slide, from: ground.O, to: b.p, axis: [1, 0, 0], initial: {{travel: 0, speed: 1}}}}}}
forces: {{push: {{type: force, on: b.p, vector: [2, 0, 0]}}, across: {kind}}}
analysis: {{times: [0, 0.05, 0.15, 0.2, 0.35, 0.4]}}
""",
        reduce=reduce,
    )
    block = found.joints["g"]["force" if axis == "z" else "moment"][:, 2 if axis == "z" else 0]
    expected = [-law(t + 0.5 * t * t, 1.0 + t) for t in found.time.tolist()]
    assert block == pytest.approx(expected, abs=1e-9)
