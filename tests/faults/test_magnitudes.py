"""What rounding hides of scenes with numbers of any magnitude is a word, never a bug, a warning or no number."""

from __future__ import annotations

import pytest

from tests.faults.outcome import run

BAR = """\
heun: 1
gravity: [0, 0, -9.81]
ground: {points: {O: [0, 0, 0]}}
bodies: {bar: {shapes: [SHAPE], points: {a: [0, 0, 0], b: [0, 0, 30]}}}
joints: {foot: {type: pin, from: ground.O, to: bar.a, axis: [0, 1, 0]}}
sections: {cut: {body: bar, CUT}}
"""
LONG = BAR.replace("SHAPE", "{type: rod, from: [5e15, 0, 0], to: [0, 0, 30], mass: 1}")
THIN = BAR.replace("SHAPE", "{type: cylinder, from: [0, 0, 0], to: [0, 0, 1e-38], radius: 0.3, density: 7850}")
SHORT_RUN = LONG.replace("CUT", "from: a, to: b, count: 31")
ASKEW = THIN.replace("CUT", "at: [0, 0, 5e-39], normal: [0.5, 0, 0.8], side: beyond")
RODS = """\
heun: 1
gravity: [0, 0, -9.81]
ground: {points: {O: [0, 0, 0]}}
bodies:
  a: {shapes: [{type: rod, from: [0, 0, 0], to: [0, 0, -1], mass: 1}], points: {o: [0, 0, 0], e: [0, 0, -1]}}
  b: {shapes: [{type: rod, from: [0, 0, 0], to: [0, 0, -1e18], mass: 1}], points: {o: [0, 0, 0]}}
joints: {A: {type: ball, from: ground.O, to: a.o}, B: {type: ball, from: a.e, to: b.o}}
"""
# the beam can turn about a line only, about which it has no inertia
BEAM = """\
heun: 1
gravity: [0, 0, -9.81]
ground: {points: {A: [0, 0, 0], B: [2, 0, 0], C: [1, 1e14, 0]}}
bodies:
  beam: {mass: 3, center: [0.8, 1e3, 0], inertia: [0, 0, 0], points: {a: [0, 0, 0], b: [2, 0, 0], c: [1, 1, 0]}}
  jack: {mass: 1, center: [2, 0, 0], inertia: [0.1, 0.1, 0.1], points: {top: [2, 0, 0]}}
joints:
  A: {type: ball, from: ground.A, to: beam.a}
  B: {type: line, from: jack.top, to: beam.b, axis: [1, 0, 0]}
  C: {type: plane, from: ground.C, to: beam.c, normal: [0, 0, 1]}
  guide: {type: slide, from: ground.B, to: jack.top, axis: [0, 0, 1]}
drives: {screw: {joint: guide, travel: "0.1*(1 - cos(10*t))"}}
analysis: {duration: 0.6, samples: 3}
"""
PUSHED = """\
heun: 1
gravity: [0, 0, 9.81]
ground: {points: {O: [0, 0, 0]}}
bodies: {load: {mass: 1, center: [0, 0, 0], inertia: [1, 1, 1], points: {c: [0, 0, 0]}, position: [0, 0, -1]}}
joints: {rope: {type: rod, from: ground.O, to: load.c, tension_only: true}}
analysis: {duration: 1, samples: 3}
"""
GROWING = """\
heun: 1
ground: {points: {O: [0, 0, 0]}}
bodies: {a: {mass: 1e-10, center: [1, 0, 0], inertia: [1e-10, 1e-10, 1e-10], points: {o: [0, 0, 0]}}}
joints: {p: {type: pin, from: ground.O, to: a.o, axis: [0, 1, 0]}}
forces: {f: {type: torque, joint: p, value: "LOAD"}}
"""
WELDED = PUSHED.replace("type: rod", "type: weld").replace(", tension_only: true", "").replace(", 0, -1]", ", 0, 0]")
STUCK = WELDED.replace("samples: 3", "samples: 3, method: Radau5")
DRIVEN = BEAM.replace("0.1*(1 -", "2e256*(1 -")
UNSTABLE = """\
heun: 1
ground: {points: {O: [0, 0, 0]}}
bodies: {bar: {mass: 1, center: [0.5, 0, 0], inertia: [0.1, 0.1, 0.1], points: {top: [0, 0, 0]}}}
joints: {pivot: {type: pin, from: ground.O, to: bar.top, axis: [0, 1, 0]}}
forces: {k: {type: turn_spring, joint: pivot, stiffness: 1e9, angle: 1}}
analysis: {duration: 1, samples: 3, method: RK4, step: 0.1}
"""


@pytest.mark.parametrize(("command", "text", "code", "word"), [
    ("validate", SHORT_RUN, 2, "[short-run]"),
    ("run", SHORT_RUN, 2, "[short-run]"),
    ("validate", ASKEW, 2, "[thin-shape]"),
    ("modes", RODS, 3, "[mass-ratios]"),
    ("run", BEAM, 3, "[no-inertia]"),
    ("probe", PUSHED, 0, ""),
    ("run", STUCK, 0, ""),
    ("run", UNSTABLE, 3, "too large for the computation"),
    ("run", DRIVEN, 3, "<stdin>:12:40: drives.screw.travel: at t = 0 s the acceleration of '2e256*(1"),
    ("run", GROWING.replace("LOAD", "1e55"), 3, "angular acceleration of bodies.a is 5e+64, too large"),
    ("run", GROWING.replace("LOAD", "1e40*1e30*(1 + t)"), 3, "<stdin>:5:45: forces.f.value: at t = 0 s '1e40*1e30"),
])  # fmt: skip
def test_what_rounding_hides_is_told(command: str, text: str, code: int, word: str) -> None:
    done = run([command, "-"], text.encode())
    assert done.code == code, done.err
    assert word in done.err.decode()
