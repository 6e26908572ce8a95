"""The tangent of the motion against dual numbers run through the plain kernel, which know nothing of its equations.

At the start of a scene, and moved from there at random: trees, loops, the planar sweep, drives, lent inertia; every
kind of load, expressions in coordinates and rates on all their branches.
"""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

from heuncli.multibody.response import make_workspace, tangent
from heuncli.multibody.tree.layout import Layout
from heuncli.scene.file_format.load import load
from heuncli.study.model.setup import set_up
from tests.oracle.values import to_yaml
from tests.shared.coupled_scenes import coupled_scene
from tests.shared.dual_tangent import dual_tangent
from tests.shared.folders import SPECS
from tests.shared.loops import loop_scene
from tests.shared.parallelogram import parallelogram
from tests.shared.planar_scenes import flat_scene
from tests.shared.rolling_scenes import rolling_scene
from tests.shared.thin_rods import thin_rods
from tests.shared.trees import tree_scene

pytestmark = pytest.mark.heavy
MOVED = 0.2  # of a radian, or metre: far from where a scene was drawn
NAMES = ("bricard", "cardan", "crane", "crankshaft", "double", "engine", "excavator", "hammered_four_bar", "lamp",
         "lift", "press", "spatial_crank", "swing")  # fmt: skip
BALLS = ("ball", "ball", "pin", "ball")  # of a parallelogram of thin rods: a spin that nothing holds

# every load between two bodies, and expressions in coordinates on both sides of their branches
LOADED = """
heun: 1
gravity: [0.3, -9.81, 1]
tables: {gas: {x: [-20, -1, 0, 1, 2, 20], y: [3, 1, 0, 2, 5, 1], interpolation: cubic}}
ground: {points: {O: [0, 0, 0], P: [0, 0, 0.5], A: [1.3, 0.4, 0.2]}}
bodies:
  rod: {mass: 2, center: [0.1, -0.6, 0], inertia: [0.3, 0.1, 0.3],
        points: {o: [0, 0, 0], p: [0, 0, 0.5], a: [0, -1, 0.5]}}
  two: {mass: 1, center: [0.1, -0.3, 0.2], inertia: [0.3, 0.2, 0.4], points: {o: [0, 0, 0], a: [0.3, -1, 0.1]}}
  three: {mass: 1, center: [0.1, -0.3, 0.2], inertia: [0.3, 0.2, 0.4], points: {o: [0, 0, 0], a: [0.3, -1, 0.1]}}
joints:
  hinge: {type: pin, from: ground.O, to: rod.o, axis: [0, 0, 1], initial: {angle: 0.7, rate: 1.3}}
  second: {type: pin, from: ground.P, to: rod.p, axis: [0, 0, 1]}
  sleeve: {type: cylinder, from: rod.a, to: two.o, axis: [1, 0.3, 0.2], to_axis: [1, 0.3, 0.2]}
  cross: {type: universal, from: two.a, to: three.o, axis: [1, 0, 0], to_axis: [0, 1, 0]}
forces:
  coil: {type: turn_spring, joint: hinge, stiffness: 50, angle: 0.1, damping: 0.3}
  other: {type: turn_spring, joint: second, stiffness: 20, angle: -0.1}
  oil: {type: damper, joint: hinge, coefficient: 1.7}
  grease: {type: damper, joint: cross, coefficient: 0.7}
  sliding: {type: damper, joint: sleeve, sliding: 0.7, coefficient: 0.2}
  brake: {type: friction, joint: second, torque: 0.8, speed: 1e-1}
  dry: {type: friction, joint: hinge, torque: 0.8, speed: 1e-6}
  drag: {type: torque, joint: hinge,
         value: "-0.4*hinge.rate*abs(hinge.rate) + 3*sin(hinge.angle) + table(gas, hinge.rate)"}
  wind: {type: force, on: three.a, frame: body, vector: ["sin(hinge.angle)*t", "max(hinge.rate, 2)*hinge.angle**2",
         "2 if hinge.angle > 0 else hinge.rate"]}
  twist: {type: couple, on: three, vector: ["atan2(hinge.angle, hinge.rate)", 0.3, "hypot(hinge.rate, 2)"], frame: body}
  spring: {type: spring, from: ground.A, to: three.a, stiffness: 30, length: 0.4, damping: 2}
  muscle: {type: actuator, from: rod.a, to: three.a, value: "5*sqrt(1 + hinge.angle**2)"}
  snow: {type: distributed, on: two, from: o, to: a, vector: [1, 2, 3], to_vector: [0, 2, 1], frame: body}
analysis: {duration: 1, samples: 2}
"""

# springs, dampers and friction in the joints of a loop, one of which is cut: the angle is then counted beside the tree
FOUR_BAR = """
heun: 1
space: SPACE
gravity: [0, -9.81, 0]
ground: {points: {O: [0, 0, 0], A: [3, 0, 0]}}
bodies:
  a: {mass: 2, center: [0, 0.5, 0], inertia: [0.3, 0.1, 0.3], points: {o: [0, 0, 0], e: [0, 1, 0]}}
  b: {mass: 2, center: [1.5, 0.1, 0], inertia: [0.3, 0.1, 0.3], points: {o: [0, 0, 0], e: [3, 0.5, 0]}}
  c: {mass: 2, center: [0, 0.5, 0], inertia: [0.3, 0.1, 0.3], points: {o: [0, 0, 0], e: [0, 1.5, 0]}}
joints:
  j1: {type: pin, from: ground.O, to: a.o, axis: [0, 0, 1], initial: {rate: 1.3}}
  j2: {type: pin, from: a.e, to: b.o, axis: [0, 0, 1]}
  j3: {type: pin, from: b.e, to: c.e, axis: [0, 0, 1]}
  j4: {type: pin, from: ground.A, to: c.o, axis: [0, 0, 1]}
forces:
  s1: {type: turn_spring, joint: j1, stiffness: 50, angle: 0.1, damping: 2}
  s2: {type: turn_spring, joint: j2, stiffness: 50, angle: 0.1, damping: 2}
  s3: {type: turn_spring, joint: j3, stiffness: 50, angle: 0.1, damping: 2}
  s4: {type: turn_spring, joint: j4, stiffness: 50, angle: 0.1, damping: 2}
  f3: {type: friction, joint: j3, torque: 0.3, speed: 1e-3}
analysis: {duration: 1, samples: 2}
"""


# bushings and laws of what loads act between, on turning bodies and on the ground, on all their branches
ELASTIC = """
heun: 1
gravity: [0.3, -9.81, 1]
tables:
  rubber: {x: [-9, -0.01, 0, 0.01, 9], y: [-9000, -20, 0, 20, 9000]}
  turny: {x: [-4, -0.3, 0, 0.3, 4], y: [-400, -20, 0, 20, 400], interpolation: cubic}
  torq: {x: [-500, 0, 100, 500], y: [30, 25, 20, -50], outside: hold}
ground: {points: {O: [0, 0, 0], P: [0, 0, 0.5]}}
bodies:
  frame: {mass: 4, center: [0.1, 0.02, 0.05], inertia: [1.2, 1.5, 0.9], points: {c: [0, 0, 0], d: [0.3, 0.1, 0]},
          position: [0.01, 0.02, 0], orientation: {axis: [1, 2, 3], angle: 0.7}, angular_velocity: [3, -2, 4]}
  rotor: {mass: 3, center: [0.1, 0, 0], inertia: [0.2, 0.3, 0.25], points: {a: [0, 0, 0]}, position: [0.3, 0.1, 0.1]}
  drum: {mass: 3, center: [0, 0, 0], inertia: [0.2, 0.2, 0.3], points: {a: [0, 0, 0]}}
joints: {s: {type: pin, from: frame.d, to: drum.a, axis: [0, 0, 1], initial: {rate: 2, angle: 0.3}}}
forces:
  mount: {type: bushing, from: ground.O, to: frame.c, stiffness: {x: rubber, y: 300, z: 500}, preload: [10, 20, 39],
          turning: {x: turny, y: 50, z: 80}, turning_preload: [1, 2, 3], damping: [1, 2, 3], turning_damping: [1, 2, 3]}
  two: {type: bushing, from: frame.d, to: rotor.a, stiffness: 400, turning: [10, 50, 20], damping: [4, 1, 2],
        turning_damping: [0.1, 0.2, 0.3], orientation: {axis: [1, 0, 0], angle: 0.5}}
  six: {type: bushing, from: frame.d, to: rotor.a, stiffness: [[400, 50, -20], [50, 300, 60], [-20, 60, 500]],
        turning: [[10, 2, -1], [2, 50, 3], [-1, 3, 20]], coupling: [[9, -7, 2], [5, 3, -6], [-3, 8, 5]],
        damping: [[4, 1, 0], [1, 2, 0.5], [0, 0.5, 3]], turning_damping: [[0.3, 0.1, 0], [0.1, 0.2, 0], [0, 0, 0.3]],
        coupling_damping: [[0.2, 0.1, 0.3], [0, -0.3, 0.1], [0.2, 0, 0.1]]}
  back: {type: bushing, from: rotor.a, to: ground.P, stiffness: [40, 50, 60], turning: {y: turny}, preload: [1, 2, 3]}
  coil: {type: spring, from: ground.P, to: drum.a, force: "table(rubber, length - 0.5) - 4*rate + s.angle"}
  motor: {type: motor, joint: s, curve: torq, ratio: 5, limit: 22, value: "min(1 + t, 1.5)"}
  twist: {type: turn_spring, joint: s, torque: "-2*angle**3 - 0.1*rate"}
  oil: {type: damper, joint: s, torque: "-0.01*rate*abs(rate)"}
  brake: {type: friction, joint: s, torque: "5*t + 1", speed: 0.1}
"""


# a runner held at a limit of its path, which swings with its body; another hangs from it
HELD = """
heun: 1
gravity: [0.3, -9.81, 1]
tables:
  x: {x: [-2, -1, 0, 1, 2], y: [-2, -1, 0, 1.2, 2], interpolation: cubic}
  y: {x: [-2, -1, 0, 1, 2], y: [2, 0.5, 0, 0.5, 2], interpolation: cubic}
  z: {x: [-2, -1, 0, 1, 2], y: [1, 0.5, 0, 0.1, -1], interpolation: cubic}
ground: {points: {O: [0, 0, 0]}}
bodies:
  arm: {mass: 3, center: [0.2, 0.1, 0], inertia: [0.4, 0.3, 0.5], points: {O: [0, 0, 0]}, angular_velocity: [1, 2, 3]}
  runner: {mass: 2, center: [0.1, 0.2, 0.3], inertia: [0.3, 0.2, 0.3], points: {P: [0, 0, 0], Q: [0.3, 0, 0.1]}}
  hung: {mass: 1, center: [0.1, 0.4, 0], inertia: [0.3, 0.2, 0.3], points: {P: [0, 0, 0]}}
joints:
  hub: {type: ball, from: ground.O, to: arm.O}
  wire: {type: curve, from: arm.O, to: runner.P, x: x, y: y, z: z, initial: {travel: 0.7}}
  link: {type: ball, from: runner.Q, to: hung.P}
stops: {end: {joint: wire, travel: [null, 0.7]}}
analysis: {duration: 1, samples: 2}
"""


def scene_of(kind: str, which: Any) -> Layout:
    """A scene, laid out."""
    if kind == "spec":
        return set_up(load(SPECS / f"{which}.yaml")).scene.layout
    texts: dict[str, Any] = {
        "tree": lambda: to_yaml(tree_scene(which)[0]),
        "loop": lambda: to_yaml(loop_scene(which)[0]),
        "flat": lambda: flat_scene(which),
        "thin": lambda: to_yaml(thin_rods(which)[0]),
        "rolling": lambda: rolling_scene(which)[0],
        "curve": lambda: coupled_scene(which, ("curve",)),
        "tracks": lambda: coupled_scene(which, ("tracks",)),
        "spinning": lambda: parallelogram(1.0, 0.5, 3, which),
        "text": lambda: which,
    }
    text = texts[kind]()
    return set_up(load("scene.yaml", text if isinstance(text, str) else to_yaml(text))).scene.layout


CASES = [
    *(("spec", name) for name in NAMES),
    *(("tree", seed) for seed in (1, 3, 4, 5, 7, 9, 11)),
    *(("loop", seed) for seed in (1, 2, 5, 7, 1000, 1003, 1006, 1009)),
    *(("flat", seed) for seed in (0, 2, 6, 14)),
    *(("thin", seed) for seed in (0, 1)),
    *(("rolling", seed) for seed in (3, 4, 5)),
    *(("curve", seed) for seed in (0, 1)),  # a point on its path, a roller beside
    *(("tracks", seed) for seed in (0, 1)),  # two points of a body, each on its path
    ("spinning", BALLS), ("text", LOADED), ("text", ELASTIC), ("text", FOUR_BAR.replace("SPACE", "spatial")),
    ("text", FOUR_BAR.replace("SPACE", "planar")),
]  # fmt: skip


@pytest.mark.parametrize(("kind", "which"), CASES, ids=lambda x: str(x).strip()[:18])
@pytest.mark.third
def test_as_dual_numbers_tell(kind: str, which: Any) -> None:
    """At the start, and beside it with everything in motion; off what the closures admit, too."""
    layout = scene_of(kind, which)
    rng = np.random.default_rng(0)
    for t in (0.0, 0.1):
        start = layout.y0 + (MOVED * rng.standard_normal(layout.n_state) if t else 0.0)
        state, exact = dual_tangent(layout, t, start)
        found = tangent(make_workspace(layout), t, state)
        assert np.abs(found - exact).max() <= 1e-12 * np.abs(exact).max()


def test_a_limit_of_a_path_that_holds() -> None:
    """The same with the contact closed."""
    layout = scene_of("text", HELD)
    start = layout.y0 + MOVED * np.random.default_rng(1).standard_normal(layout.n_state)
    state, exact = dual_tangent(layout, 0.1, start, closed=1.0)
    at = make_workspace(layout)
    at.hold([1.0])
    found = tangent(at, 0.1, state)
    assert np.abs(found - exact).max() <= 1e-12 * np.abs(exact).max()
