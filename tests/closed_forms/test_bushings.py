"""Bushings against closed forms: oscillations by the 6 x 6, turns of any size, rest, blows, half a turn, tables."""

from __future__ import annotations

import json
import math
from collections.abc import Mapping
from typing import Any

import numpy as np
import pytest
from scipy.interpolate import CubicSpline

from heuncli.analyses.modes.study import compute_spec_modes
from heuncli.base.errors import SolveError
from heuncli.scene.file_format.load import load
from heuncli.scene.shapes.rotations import cross_matrix
from tests.oracle.values import to_yaml
from tests.shared.scenes import near, solved

WHEEL = """
heun: 1
ground: {{points: {{O: [0, 0, 0]}}}}
bodies: {{wheel: {{mass: 2, center: [0, 0, 0], inertia: [0.3, 0.2, 0.1], points: {{c: [0, 0, 0]}}{start}}}}}
forces: {{mount: {{type: bushing, from: ground.O, to: wheel.c, {mount}}}}}
analysis: {analysis}
"""
RUN = "{duration: 2, samples: 21, tolerance: 1e-12}"


def wheel(mount: str, start: str = "", analysis: str = RUN) -> str:
    return WHEEL.format(mount=mount, start=f", {start}" if start else "", analysis=analysis)


def test_it_turns_to_and_fro_by_any_angle() -> None:
    """About one of its axes J phi'' = -c phi, a harmonic motion, up to nearly half a turn."""
    found = solved(wheel("turning: [5, 3, 7]", "orientation: {axis: [1, 0, 0], angle: 3}"))
    w = np.sqrt(5 / 0.3)
    phi = 3 * np.cos(w * found.time)
    near(found.forces["mount"]["turn"], np.outer(phi, [1, 0, 0]), 3.0, 1e-10)
    near(found.forces["mount"]["moment"], np.outer(-5 * phi, [1, 0, 0]), 15.0, 1e-10)
    near(found.energy["potential"], 2.5 * phi**2, 25.0, 1e-10)


def test_it_is_damped_along_its_axes() -> None:
    """m x'' = f0 - k x - d x' in each of three directions, which orientation turns."""
    found = solved(wheel(
        "stiffness: [50, 8, 200], damping: [2, 8, 0], preload: [3, 0, 0], orientation: {axis: [0, 0, 1], angle: pi/2}",
        "velocity: [0, 0.4, 0]",
    ))  # fmt: skip
    t, m, k, d = found.time, 2.0, 50.0, 2.0
    delta = d / (2 * m)
    w = np.sqrt(k / m - delta**2)
    a, b = -3 / k, (0.4 - delta * 3 / k) / w  # its x is the world's y
    x = 3 / k + np.exp(-delta * t) * (a * np.cos(w * t) + b * np.sin(w * t))
    near(found.bodies["wheel"]["position"][:, 1], x, 0.2, 1e-10)
    near(found.forces["mount"]["shift"], np.stack([x, 0 * t, 0 * t], axis=1), 0.2, 1e-10)


CENTER, INERTIA, MASS = np.array([0.05, -0.02, 0.1]), np.diag([1.2, 1.5, 0.9]), 40.0
MOUNTS = {"a": [0.3, 0.2, -0.1], "b": [0.3, -0.2, -0.1], "c": [-0.4, 0.2, -0.15], "d": [-0.4, -0.2, -0.1]}


PLAIN = {"stiffness": [2e4, 3e4, 9e4], "turning": [30.0, 50.0, 80.0]}
CROSSED = {
    "stiffness": [[2e4, 5e3, -2e3], [5e3, 3e4, 6e3], [-2e3, 6e3, 9e4]],
    "turning": [[30.0, 5.0, -9.0], [5.0, 50.0, 8.0], [-9.0, 8.0, 80.0]],
    "coupling": [[200.0, -300.0, 400.0], [50.0, 250.0, -100.0], [-300.0, 400.0, 500.0]],
}


def engine(weight: float = 0.0, of_bushing: Mapping[str, Any] = PLAIN) -> dict[str, Any]:
    """A block on four bushings, whose axes lean inward; drawn where nothing strains them."""
    lean = {n: {"axis": [1, 0, 0], "angle": 0.6 * np.sign(at[1])} for n, at in MOUNTS.items()}
    return {
        "gravity": [0, 0, -weight], "ground": {"points": MOUNTS},
        "bodies": {"block": {"mass": MASS, "center": CENTER.tolist(), "inertia": np.diag(INERTIA).tolist(),
                             "points": MOUNTS, "position": [0, 0, 0]}},
        "forces": {
            n: {"type": "bushing", "from": f"ground.{n}", "to": f"block.{n}", "orientation": lean[n], **of_bushing}
            for n in MOUNTS
        },
    }  # fmt: skip


def stiffness(of_bushing: Mapping[str, Any] = PLAIN) -> np.ndarray[Any, Any]:
    """The 6 x 6 of shift of, and turn about, the centre of mass."""
    K = np.zeros((6, 6))
    for at in MOUNTS.values():
        angle = 0.6 * np.sign(at[1])
        c, s = np.cos(angle), np.sin(angle)
        T = np.array([[1, 0, 0], [0, c, -s], [0, s, c]])
        G = np.hstack([np.eye(3), -cross_matrix(np.array(at) - CENTER)])  # d = shift + turn x arm
        strains = np.vstack([T.T @ G, np.hstack([np.zeros((3, 3)), T.T])])  # shift and turn in the bushing's axes
        upper, lower = (np.diag(x) if np.ndim(x := of_bushing[key]) == 1 else np.array(x) for key in PLAIN)
        coupling = np.array(of_bushing.get("coupling", np.zeros((3, 3))))
        K += strains.T @ np.block([[upper, coupling], [coupling.T, lower]]) @ strains
    return K


@pytest.mark.parametrize("of_bushing", [PLAIN, CROSSED], ids=["plain", "crossed"])
def test_an_engine_on_four_bushings(of_bushing: Mapping[str, Any]) -> None:
    """Six rigid-body modes, as of the 6 x 6 by hand; with weight on it those about the pose that rests lie beside."""
    told = compute_spec_modes(load("scene.yaml", to_yaml(engine(0.0, of_bushing))))
    M = np.zeros((6, 6))
    M[:3, :3], M[3:, 3:] = MASS * np.eye(3), INERTIA
    wanted = np.sqrt(np.linalg.eigvals(np.linalg.solve(M, stiffness(of_bushing))).real)
    found = sorted(mode.eigenvalue.imag for mode in told.modes if mode.eigenvalue.imag > 0.0)
    assert len(found) == 6
    assert np.abs(np.array(found) - np.sort(wanted)).max() <= 1e-11 * max(wanted)


@pytest.mark.parametrize("of_bushing", [PLAIN, CROSSED], ids=["plain", "crossed"])
def test_it_rests_where_its_springs_bear_it(of_bushing: Mapping[str, Any]) -> None:
    """Small weight: the shift and turn that the 6 x 6 gives, to second order; what they bear is the weight."""
    weight = 1e-3
    found = solved(
        engine(weight, of_bushing) | {"analysis": {"type": "rest"}, "report": ["motion", "foundation", "forces"]}
    )
    small = np.linalg.solve(stiffness(of_bushing), [0, 0, -MASS * weight, 0, 0, 0])
    moved = np.asarray(found.bodies["block"]["center"])[0] - CENTER
    near(moved, small[:3], float(np.abs(small[:3]).max()), 1e-4)
    near(found.foundation["force"][0], [0, 0, -MASS * weight], MASS * weight, 1e-9)


def test_a_blow_passes_it() -> None:
    """A bushing is soft: in a blow it does nothing, and the wheel takes all of it."""
    struck = wheel("stiffness: [5e6, 5e6, 5e6], turning: 1e4", analysis="{type: impulse}")
    struck += "impulses: {blow: {on: wheel.c, vector: [3, 0, 1]}}\n"
    found = solved(struck)
    near(found.impulses[0]["bodies"]["wheel"]["center_velocity_jump"], [1.5, 0, 0.5], 1.5, 1e-14)


@pytest.mark.parametrize("rate", [12.0, 40.0])
def test_half_a_turn_is_told(rate: float) -> None:
    """With more energy than its spring can hold it would turn over: the run is refused there, and says when."""
    with pytest.raises(SolveError) as refused:
        solved(wheel("turning: 1", f"angular_velocity: [0, 0, {rate}]", "{duration: 3, samples: 4}"))
    assert "[bushing-turned]" in str(refused.value) or refused.value.problems[0].code == "bushing-turned"
    w = np.sqrt(1 / 0.1)
    at = np.arcsin(np.pi * w / rate) / w
    told = float(refused.value.problems[0].message.split("t = ")[1].split(" s")[0])
    assert abs(told - at) < 0.05


def test_a_table_bends_where_it_is_told_to() -> None:
    """Free within a gap, then stiff: from the middle at v it turns back after pi sqrt(m/k), and bends there exactly."""
    swing = float(np.sqrt(2 / 800))
    times = [0.01, 0.02 + 0.5 * math.pi * swing, 0.04 + math.pi * swing, 0.04 + 0.02 + 1.5 * math.pi * swing]
    text = wheel("stiffness: {x: gap}", "velocity: [0.5, 0, 0]", f"{{times: {[0.0, *times]}, tolerance: 1e-12}}")
    found = solved(text + "tables: {gap: {x: [-1.01, -0.01, 0, 0.01, 1.01], y: [-800, 0, 0, 0, 800]}}\n")
    far = 0.01 + 0.5 * swing
    near(found.bodies["wheel"]["position"][1:, 0], [0.005, far, 0.0, -far], far, 1e-10)
    near(found.forces["mount"]["force"][2], [-0.5 * swing * 800, 0, 0], 20.0, 1e-9)
    near(found.energy["kinetic"] + found.energy["potential"], 0.25, 0.25, 1e-10)
    assert not found.energy["work"].any()


HELD = {"x": [0.1, 0.3, 0.6, 1.0], "y": [2.0, 5.0, -1.0, 4.0], "interpolation": "cubic", "outside": "hold"}
AROUND = {"x": [0.2, 0.5, 0.9, 1.2], "y": [1.0, 3.0, -1.0, 1.0], "interpolation": "cubic", "period": 1.0}


@pytest.mark.parametrize("way", [1.0, -1.0])
def test_what_a_table_has_stored(way: float) -> None:
    """The areas from 0 under tables held beyond their ends, with a period, and finely told: as SciPy has them."""
    fine = {"x": np.linspace(-9, 9, 400).tolist(), "y": np.sinh(np.linspace(-1, 2, 400)).tolist()}
    laws = "stiffness: {x: held, y: around, z: fine}"
    text = wheel(laws, f"velocity: [{2 * way}, {4 * way}, {3 * way}]", "{duration: 1, samples: 41, tolerance: 1e-9}")
    found = solved(text + f"tables: {json.dumps({'held': HELD, 'around': AROUND, 'fine': fine})}\n")
    stored = np.zeros(41)
    for x, table in zip(found.forces["mount"]["shift"].T, (HELD, AROUND, fine), strict=True):
        kind = {"bc_type": "periodic"} if "period" in table else {}
        smooth = CubicSpline(table["x"], table["y"], **kind) if "interpolation" in table else None
        for k, to in enumerate(x):
            nodes, weights = stretches(min(to, 0.0), max(to, 0.0), table)
            inside = np.clip(nodes, table["x"][0], table["x"][-1]) if "outside" in table else nodes
            y = smooth(inside) if smooth is not None else np.interp(nodes, table["x"], table["y"])
            stored[k] += np.sign(to) * (weights @ y)
    assert found.forces["mount"]["shift"][-1] @ [way, way, way] > 5.0
    near(found.energy["potential"], stored, float(np.abs(stored).max()), 1e-13)
    near(found.energy["kinetic"] + found.energy["potential"], found.energy["kinetic"][0], 30.0, 1e-7)


def stretches(low: float, high: float, table: dict[str, Any]) -> tuple[np.ndarray, np.ndarray]:
    """Nodes and weights of Gauss's rule between the knots of a table, wherever they come again."""
    turns = np.arange(-9, 10) if "period" in table else np.zeros(1)
    knots = np.unique(np.add.outer(table["x"], turns))
    ends = np.array([low, *knots[(knots > low) & (knots < high)], high])
    x, w = np.polynomial.legendre.leggauss(4)
    h = 0.5 * np.diff(ends)[:, None]
    return (ends[:-1, None] + h * (1.0 + x)).ravel(), (h * w).ravel()


def test_a_turn_that_leaves_its_table_is_told_by_its_place() -> None:
    """A moment beyond the last value of the table: the run ends where the turn is the last that it covers."""
    with pytest.raises(SolveError) as refused:
        solved("""
heun: 1
ground: {points: {O: [0, 0, 0]}}
tables: {k: {x: [-0.5, 0, 0.5], y: [-2, 0, 2]}}
bodies: {block: {mass: 1, center: [0, 0, 0], inertia: [0.01, 0.01, 0.01], points: {o: [0, 0, 0]}}}
forces:
  mount: {type: bushing, from: ground.O, to: block.o, stiffness: 1e3, turning: [9, 9, k], turning_damping: 0.05}
  push: {type: couple, on: block.o, vector: [0, 0, 3]}
analysis: {duration: 1, samples: 3}
""")
    (problem,) = refused.value.problems
    assert problem.code == "no-value"
    assert "forces.mount.turn_z = 0.5: table k covers x from -0.5 to 0.5" in problem.message


def test_a_part_that_rests_at_a_knot_is_no_doubt() -> None:
    """A table bends where nothing turns about its axis: the moment's other parts say what is small."""
    found = solved("""
heun: 1
ground: {points: {O: [0, 0, 0]}}
tables: {k: {x: [-0.5, 0, 0.5], y: [-2, 0, 4]}}
bodies: {block: {mass: 2, center: [0, 0, 0], inertia: [0.01, 0.01, 0.01], points: {o: [0, 0, 0]}}}
forces:
  mount: {type: bushing, from: ground.O, to: block.o, stiffness: 1e4, turning: [k, 50, 50], turning_damping: 0.1}
  push: {type: couple, on: block.o, vector: [0, 1, -2]}
analysis: {duration: 0.1, samples: 3}
""")
    assert found.warnings == ()
