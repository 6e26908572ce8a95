"""One scene in other units of length, mass and time, twenty powers of ten away: the same numbers, in these units."""

from __future__ import annotations

from functools import cache

import numpy as np
import pytest

from heuncli.results.results import Array, Results
from tests.shared.scenes import solved

# a spring, a stop that is struck twice, a closed loop or a drive, a cut; l: the metre, m: the kilogram, t: the second
SCENE = """\
heun: 1
gravity: [0, 0, -9.81*l/t0**2]
parameters: {{l: {l!r}, m: {m!r}, t0: {t!r}, N: m*l/t0**2, J: m*l**2}}
ground: {{points: {{O: [0, 0, 0], P: [2*l, 0, 0], Q: [0, 3*l, 0]}}}}
bodies:
  a: {{mass: m, center: [0.5*l, 0, 0], inertia: [0.02*J, 0.1*J, 0.1*J], points: {{o: [0, 0, 0], e: [l, 0, 0]}}}}
  b:
    shapes: [{{type: cylinder, from: [0, 0, 0], to: [0, 0, l], radius: 0.05*l, mass: m}}]
    points: {{o: [0, 0, 0], e: [0, 0, l]}}
    position: [l, 0, 0]
  c: {{mass: m, center: [0, 0, 0], inertia: [0.1*J, 0.1*J, 0.1*J], points: {{o: [0, 0, 0]}}, position: [2*l, 0, 0]}}
  d: {{mass: m, center: [0, 0, 0], inertia: [J, J, J], points: {{o: [0, 0, 0]}}, position: [0, 3*l, l]}}
joints:
  A: {{type: pin, from: ground.O, to: a.o, axis: [0, 1, 0], initial: {{rate: 1/t0}}}}
  B: {{type: ball, from: a.e, to: b.o}}
  S: {{type: slide, from: ground.Q, to: d.o, axis: [0, 0, 1]}}
  {loop}
stops: {{floor: {{joint: S, travel: [0, null], restitution: 0.5}}}}
forces:
  s: {{type: spring, from: ground.P, to: b.e, stiffness: 5*m/t0**2, length: 0.5*l, damping: 0.1*m/t0}}
  f: {{type: force, on: b.e, vector: [0, "N*sin(3*t/t0)", 0]}}
sections: {{cut: {{body: b, from: o, to: e, count: 5}}}}
analysis: {{duration: t0, samples: 5}}
"""
CLOSED = "C: {type: rod, from: b.o, to: c.o}\n  D: {type: slide, from: ground.P, to: c.o, axis: [1, 0, 0]}"
DRIVEN = 'D: {type: pin, from: ground.P, to: c.o, axis: [1, 0, 0]}\ndrives: {m: {joint: D, angle: "t/t0 + (t/t0)**2"}}'


@cache
def run(loop: str, l: float = 1.0, m: float = 1.0, t: float = 1.0) -> Results:
    return solved(SCENE.format(l=l, m=m, t=t, loop=loop))


def numbers(found: Results, l: float, m: float, t: float) -> dict[str, Array]:
    """Numbers of a run in its own units."""
    force, energy = m * l / t**2, m * l**2 / t**2
    return {
        **{f"force of {name}": joint["force"] / force for name, joint in found.joints.items()},
        **{f"moment of {name}": joint["moment"] / energy for name, joint in found.joints.items()},
        "cut": found.sections["cut"]["M2"] / energy, "place": found.bodies["b"]["center"] / l,
        "fall": found.bodies["d"]["center"] / l, "kinetic": found.energy["kinetic"] / energy,
        "struck": np.array([blow["time"] / t for blow in found.impulses]),
        "spring": found.forces["s"]["value"] / force,
    }  # fmt: skip


@pytest.mark.heavy
@pytest.mark.parametrize("loop", [CLOSED, DRIVEN], ids=["closed", "driven"])
@pytest.mark.parametrize(("l", "m", "t"), [
    (1e-20, 1.0, 1.0), (1e20, 1e-9, 1.0), (1.0, 1e-30, 1e-12), (1e9, 1e20, 1e12), (1e-9, 1e-12, 1e-15),
])  # fmt: skip
@pytest.mark.third
def test_the_same_in_other_units(loop: str, l: float, m: float, t: float) -> None:
    wanted = numbers(run(loop), 1.0, 1.0, 1.0)
    assert len(wanted["struck"]) == 2
    for name, found in numbers(run(loop, l, m, t), l, m, t).items():
        assert found == pytest.approx(wanted[name], rel=0.0, abs=1e-8 * np.abs(wanted[name]).max() + 1e-12), name
