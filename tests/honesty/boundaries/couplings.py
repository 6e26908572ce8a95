"""Couplings: axes of gears that are meant to be parallel, pitch points that are meant to lie on both; ropes."""

from __future__ import annotations

import math

import numpy as np

from heuncli.base.errors import HeunError
from heuncli.motion.integration.diagnosis.guide_departures import (
    find_recounted,
    find_wound_up,
    is_counted_round,
    iter_rope_parts,
)
from heuncli.scene.file_format.load import load
from heuncli.study.workflow import solve
from tests.honesty.boundaries.part import Part, Row

PAIR = """
heun: 1
ground: {points: {A: [0, 0, 0], B: [0.4, 0, 0], P: [PLACE, 0, 0]}}
bodies:
  one: {mass: 1, center: [0, 0, 0], inertia: [1, 1, 1], points: {o: [0, 0, 0]}}
  two: {mass: 1, center: [0, 0, 0], inertia: [1, 1, 1], points: {o: [0, 0, 0]}}
joints:
  a: {type: pin, from: ground.A, to: one.o, axis: [0, 0, 1]}
  b: {type: pin, from: ground.B, to: two.o, axis: [0, TILT, 1]}
couplings: {mesh: {type: gear, of: [a, b], teeth: [20, 60], at: ground.P}}
analysis: {type: state}
"""


def meshes(tilt: float, place: float) -> str:
    """Two gears, whose axes are tilted against each other, at a pitch point."""
    try:
        solve(load("gears.yaml", text=PAIR.replace("TILT", repr(tilt)).replace("PLACE", repr(place))))
    except HeunError as error:
        return f"refused: {error.problems[0].code}"
    return "fine"


PATH = """
heun: 1
tables: {x: {X, interpolation: cubic}, z: {Z, interpolation: cubic}}
ground: {points: {O: [0, 0, 0]}}
bodies: {bead: {mass: 1, center: [0, 0, 0], inertia: [1, 1, 1], points: {P: [0, 0, 0]}, near: {position: [0, 0, 0]}}}
joints: {wire: {type: curve, from: ground.O, to: bead.P, x: x, z: zNEXT}}
analysis: {type: state}
"""


def bead_runs(x: str, z: str, next_: str = "") -> str:
    """A bead on a path by two tables."""
    try:
        solve(load("bead.yaml", text=PATH.replace("X,", f"{x},").replace("Z,", f"{z},").replace("NEXT", next_)))
    except HeunError as error:
        return f"refused: {error.problems[0].code}"
    return "fine"


def slow(slope: float) -> str:
    """On (s^2, slope s) r' is least in the middle, `slope`, where |r'| at the ends is 2: a share of slope / 2."""
    z = f"x: [-1, 0, 1], y: [{-2.0 * slope!r}, 0, {2.0 * slope!r}]"
    return bead_runs("x: [-1, 0, 1], y: [1, 0, 1]", z, ", initial: {travel: 0.5}")


def touches(apart: float) -> str:
    """A loop x = s^3 - s, z = s^2 - 1 + half s, which at s = -1 and 1 comes to x = 0, there apart by 2 half."""
    s = [-1.0, -0.75, -0.5, -0.25, 0.0, 0.25, 0.5, 0.75, 1.0]
    half = 0.5 * apart * REACH
    x, z = [v**3 - v for v in s], [v * v - 1.0 + half * v for v in s]
    return bead_runs(f"x: {s}, y: {x}", f"x: {s}, y: {z}")


REACH = 1.0  # of that path: |r| is 1 in the middle, where z = -1

PART = Part(
    headings=("couplings",),
    rows=(
        Row("TYPED_AXES", lambda x: meshes(x, 0.1), "fine", "refused: gear-axes"),
        Row("TYPED_POINT", lambda x: meshes(0.0, 0.1 + 0.4 * x), "fine", "refused: gear-axes"),
        Row("NO_PATH_DIRECTION", slow, "refused: path-form", "fine"),
        Row("SAME_PLACE", touches, "refused: path-branch", "fine"),
    ),
    exempt={
        "DRIVES_DISAGREE": "why a run ended; tests/closed_forms/test_couplings.py: drives that fight, and that agree",
    },
)
JIB = """
heun: 1
gravity: [0, 0, -9.81]
ground: {points: {O: [0, 0, 5], P: [-1, 0, 5.2]}}
bodies:
  sheave: {mass: 1, center: [0, 0, 0], inertia: [0.02, 0.03, 0.02], points: {hub: [0, 0, 0]}}
  load: {mass: 3, center: [0, 0, 0], inertia: [0.1, 0.2, 0.15], position: [0.2, SIDE, 2], points: {top: [0, 0, 0]}}
joints:
  wheel: {type: pin, from: ground.O, to: sheave.hub, axis: [0, 1, 0]}
couplings:
  rope: {type: rope, through: [ground.P, {sheave: sheave.hub, radius: 0.2, side: over}, load.top]}
analysis: {type: state}
"""
ROUND = """
heun: 1
space: planar
ground: {points: {O: [0, 0], A: [-1, 0.1], B: [1, 0]}}
bodies:
  drawn: {mass: 1, center: [0, 0], inertia: 1, points: {top: [0, 0]}}
  lifted: {mass: 1, center: [0, 0], inertia: 1, points: {top: [0, 0]}}
joints:
  along: {type: slide, from: ground.A, to: drawn.top, axis: [1, 0], initial: {travel: 0}}
  up: {type: slide, from: ground.B, to: lifted.top, axis: [0, 1]}
drives:
  lift: {joint: up, travel: HEIGHT*t}
couplings:
  rope: {type: rope, through: [drawn.top, {sheave: ground.O, radius: 0.1, side: over}, lifted.top]}
analysis: {duration: 1, samples: 2}
"""
TWO = """
heun: 1
gravity: [0, 0, -9.81]
ground: {points: {O: [0, 0, 5], P: [1, 0, 5]}}
bodies:
  arm: {mass: 1, center: [0, 0, 0], inertia: [1, 1, 1], points: {hub: [0, 0, 0]}}
  load: {mass: 3, center: [0, 0, 0], inertia: [0.1, 0.2, 0.15], position: [1.2, 0, 2], points: {top: [0, 0, 0]}}
joints:
  swivel: {type: pin, from: ground.P, to: arm.hub, axis: [0, 0, 1]}
drives:
  swivel: {joint: swivel, angle: TILT*t}
couplings:
  rope:
    type: rope
    through:
      - {sheave: ground.O, radius: 0.2, axis: [0, 1, 0], side: over}
      - {sheave: arm.hub, radius: 0.2, axis: [0, 1, 0], side: over}
      - load.top
analysis: {duration: 1, samples: 2}
"""


def roped(text: str) -> str:
    """What a scene with a rope ends as: refused, warned of, or fine."""
    try:
        results = solve(load("rope.yaml", text=text)).results
    except HeunError as error:
        return f"refused: {error.problems[0].code}"
    return "warned of" if any("plane" in told for told in results.warnings) else "fine"


def swung(angle: float) -> str:
    """A rope that leaves its sheave's plane by an angle: the way across the axis is 3 m."""
    return roped(JIB.replace("SIDE", repr(3.0 * math.tan(angle))))


def lifted(angle: float) -> str:
    """The end of a rope is lifted until its strand rises by an angle, beyond where it lies on the sheave."""
    return roped(ROUND.replace("HEIGHT", repr((0.1 + math.sin(angle)) / math.cos(angle))))


def left_at(x: float) -> str:
    """A strand of a run that failed, whose length was x of its sheave's radius."""
    study = solve(load("rope.yaml", text=JIB.replace("SIDE", "0.0")))
    layout, evaluation = study.setup.scene.layout, study.history.solutions
    for _, part, k, _ in iter_rope_parts(layout, evaluation):
        if part.kind == "strand" and part.g[0]:
            evaluation.parts["gap"][0, k] = x * abs(part.g[0])
    return "wound up" if find_wound_up(layout, evaluation) else "not for its rope"


def turned(x: float) -> str:
    """An arc that changes by x from one step to the next."""
    return "counted anew" if len(find_recounted(np.array([0.0, 1.0]), np.array([0.1, 0.1 + x]))) else "turned"


ROPES = Part(
    headings=("ropes over sheaves",),
    rows=(
        Row("FLEET_ANGLE", swung, "warned of", "refused: rope-off-sheave"),
        Row("FLEET_SEEN", swung, "fine", "warned of"),
        Row("ASKEW", lambda x: roped(TWO.replace("TILT", repr(x))), "fine", "refused: rope-off-sheave"),
        Row("WOUND_UP", left_at, "wound up", "not for its rope"),
        Row("COUNTED_ROUND", lambda x: "all round" if is_counted_round(-x) else "lifts off", "lifts off", "all round"),
        Row("RECOUNTED", turned, "turned", "counted anew"),
        Row("OFF_SHEAVE", lifted, "fine", "refused: rope-off-sheave"),
    ),
)
