"""The error that is stated with one measure is that which tables show and goldens keep of the same number."""

from __future__ import annotations

import math

import numpy as np
import pytest

import heuncli
from heuncli.analyses.variants.evaluation import Recipe, VariantEvaluator, measure_study
from heuncli.output.snapshots.take_snapshot import take_run_snapshot
from heuncli.results.results_schema import REPORTS
from heuncli.scene.file_format.load import load
from heuncli.study.model.options import Options
from heuncli.study.queries.measure import MeasureRequest
from heuncli.study.queries.measure_uncertainty import find_search_error, find_unit, measure_uncertainty
from heuncli.study.workflow import solve
from tests.shared.folders import ROOT, SPECS

SCENES = (
    SPECS / "double.yaml", SPECS / "slider_crank.yaml", SPECS / "table.yaml", SPECS / "crane.yaml",
    SPECS / "cart_pole.yaml", ROOT / "heuncli" / "starters" / "truss.yaml",
)  # fmt: skip


@pytest.mark.heavy
@pytest.mark.parametrize("scene", SCENES, ids=lambda path: path.stem)
@pytest.mark.third
def test_unit_and_error_are_those_of_the_tables(scene: object) -> None:
    study = solve(load(str(scene)), Options())
    numbers = take_run_snapshot(study, frozenset(REPORTS)).numbers
    assert numbers
    for path, kept in numbers.items():
        asked = path.removesuffix(".lowest").removesuffix(".highest")
        error = measure_uncertainty(study, asked, "max", 1.0)
        assert find_unit(asked, study.spec) == kept.unit, path
        assert math.isclose(error or 0.0, kept.error, rel_tol=1e-12), path


def test_the_error_of_a_place_covers_a_coarse_run() -> None:
    """A pendulum to six digits: the door, curves and the search of extremes know it no better than that."""
    solved, close = (heuncli.solve(text=PENDULUM, tolerance=tolerance) for tolerance in (1e-6, 1e-12))
    for path, unit in (("coordinates.pivot.angle", "rad"), ("points.bob.p.position", "m")):
        off = float(np.abs(solved[path].values - close[path].values).max())
        told = solved[path].error
        assert solved[path].unit == unit
        assert 1e-9 < off <= told < 1e-4
        assert find_search_error(solved.study, solved.study.find_numbers(path).keys) == told
        assert solved.measure(f"max {path}").error == told


DRUM = """
heun: 1
space: planar
gravity: [0, -10]
ground: {points: {O: [0, 0]}}
bodies:
  drum: {mass: 1, center: [0, 0], inertia: 0.1, points: {c: [0, 0]}}
  load: {mass: 1, center: [0, 0], inertia: 0.1, points: {p: [0, 0]}, position: [1, -1]}
joints: {pin: {type: pin, from: ground.O, to: drum.c}}
couplings: {rope: {type: rope, through: [{sheave: drum.c, radius: 0.2, slip: none, side: left}, load.p]}}
drives: {motor: {joint: pin, rate: 1}}
analysis: {duration: 1, samples: 11}
"""
WHEEL = """
heun: 1
gravity: [0, 0, -10]
ground: {points: {O: [0, 0, 0]}}
bodies:
  wheel: {mass: 1, center: [0, 0, 0], inertia: [0.01, 0.02, 0.01], points: {c: [0, 0, 0]},
          orientation: {axis: [1, 0, 0], angle: 0.4}, angular_velocity: {vector: [0, 20, 1], frame: body}}
rolling: {rim: {wheel: wheel.c, axis: [0, 1, 0], radius: 0.2, on: ground.O, normal: [0, 0, 1], held: true}}
analysis: {duration: 1, samples: 11}
"""
SUM = """
heun: 1
gravity: [0, -10, 0]
ground: {points: {A: [0, 0, 0], B: [1, 0, 0]}}
bodies:
  a: {mass: 1, center: [1, 0, 0], inertia: [0.1, 0.1, 0.1], points: {o: [0, 0, 0]}}
  b: {mass: 1, center: [0.5, 0, 0], inertia: [0.1, 0.1, 0.1], points: {o: [0, 0, 0]}, position: [1, 0, 0]}
joints:
  p: {type: pin, from: ground.A, to: a.o, axis: [0, 0, 1]}
  q: {type: pin, from: ground.B, to: b.o, axis: [0, 0, 1]}
couplings: {sum: {type: ratio, of: [p, q], factors: [0.001, 0.003]}}
analysis: {duration: 1, samples: 11}
"""
PATH = """
heun: 1
gravity: [0, 0, -10]
tables:
  x: {x: [-2000, -1000, 0, 1000, 2000], y: [-2, -1, 0, 1, 2], interpolation: cubic}
  z: {x: [-2000, -1000, 0, 1000, 2000], y: [2, 0.5, 0, 0.5, 2], interpolation: cubic}
ground: {points: {O: [0, 0, 0]}}
bodies: {bead: {mass: 1, center: [0, 0, 0], inertia: [0.1, 0.1, 0.1], points: {P: [0, 0, 0]}}}
joints: {wire: {type: curve, from: ground.O, to: bead.P, x: x, z: z, initial: {travel: 1000}}}
analysis: {duration: 1, samples: 11}
"""
SWINGING = """
heun: 1
gravity: [0, 0, -3]
ground: {points: {A: [0, 0, 0], B: [1, 0, 0]}}
bodies: {a: {mass: 1, center: [1, 0, 0.1], inertia: [0.1, 0.1, 0.1], points: {o: [0, 0, 0], p: [1.2, 0.1, 0.3]}}}
joints: {u: {type: universal, from: ground.A, to: a.o, axis: [0, 1, 0], to_axis: [0, 0, 1]}}
forces:
  turning: {type: turn_spring, joint: u, stiffness: 40}
  spring: {type: spring, from: ground.B, to: a.p, stiffness: 20, length: 0.2}
analysis: {duration: 2, samples: 11}
"""


def test_the_error_of_the_central_axis_covers_a_coarse_run() -> None:
    """Its point is s × M / s²: near next to no force it errs by more than force and moment do of their largest."""
    for quantity in ("point", "direction"):
        path = f"foundation.axis.{quantity}"
        coarse, close = (heuncli.solve(text=SWINGING, tolerance=tolerance)[path] for tolerance in (1e-3, 1e-10))
        off = np.linalg.norm(coarse.values - close.values, axis=1).max()
        assert close.error < 1e-2 * off < off <= coarse.error < 10.0 * off


@pytest.mark.parametrize(
    ("scene", "path"),
    [
        (DRUM, "couplings.rope.on.drum.moment"),
        (WHEEL, "couplings.rim.on.ground.point"),
        (PATH, "coordinates.wire.travel"),
        (PATH, "coordinates.wire.speed"),
        (PATH, "coordinates.wire.acceleration"),
        (SUM, "couplings.sum.moment"),
        (SUM, "couplings.sum.shares.gravity.moment"),
    ],
    ids=["drum", "wheel", "travel", "speed", "acceleration", "sum", "share"],
)
def test_the_error_of_what_a_machine_element_tells_covers_a_coarse_run(scene: str, path: str) -> None:
    """What turns a drum, where a wheel touches, a way in mm, a load of small factors: none is an action or a place."""
    asked = {"by_cause": "shares" in path}
    coarse, close = (heuncli.solve(text=scene, tolerance=tolerance, **asked)[path] for tolerance in (1e-3, 1e-10))
    off = np.linalg.norm((coarse.values - close.values).reshape(11, -1), axis=1).max()
    assert close.error < 1e-2 * off < off <= coarse.error < 1e2 * off


@pytest.mark.heavy
def test_an_extreme_beside_a_singular_pose_is_not_known() -> None:
    """The least acceleration, −1.2 g, lies in the flat pose, around which the search looks at nothing."""
    flat = SPECS / "flat_four_bar.yaml"
    least, greatest = MeasureRequest("min", "coordinates.B.acceleration"), MeasureRequest("max", "coordinates.B.rate")
    asker = VariantEvaluator(Recipe(str(flat), flat.read_text(encoding="utf-8"), (least, greatest), Options(), {}))
    beside, apart = asker.answer({"g": "10.466811241737235", "rate": "7.046032184352546"}).measures
    assert beside.value is None and beside.word == "unknown"
    assert apart.value is not None and apart.error is not None


PENDULUM = """\
heun: 1
gravity: [0, 0, -9.81]
ground: {points: {O: [0, 0, 0]}}
bodies: {bob: {mass: 1, center: [0, 0, -1], inertia: [0, 0, 0], points: {O: [0, 0, 0], p: [0, 0, -1]}}}
joints: {pivot: {type: pin, from: ground.O, to: bob.O, axis: [0, 1, 0], initial: {angle: 2 rad}}}
analysis: {duration: 20, samples: 41}
"""
HANGING = """\
heun: 1
gravity: [0, 0, -9.81]
ground: {points: {O: [0, 0, 0]}}
bodies:
  bar:
    shapes: [{type: rod, from: [0, 0, 0], to: [0, 0, -3], mass: 700}]
    points: {top: [0, 0, 0], end: [0, 0, -3]}
joints: {pivot: {type: weld, from: ground.O, to: bar.top}}
sections: {along: {body: bar, from: top, to: end, count: 21}}
"""


@pytest.mark.parametrize("path", ["sections.along.force", "sections.along.moment"])
def test_the_least_magnitude_along_cuts_is_nothing_within_its_error(path: str) -> None:
    """At the free end nothing is left: the root of what rounding leaves of a square is larger than a load's error."""
    study = solve(load("hanging.yaml", HANGING), Options())
    least = measure_study(MeasureRequest("min", path), study)
    assert least.value is not None and least.error is not None
    assert least.value <= least.error < 1e-6 * 700 * 9.81 * 3
    greatest = measure_study(MeasureRequest("max", "sections.along.force"), study)
    assert greatest.error is not None and abs(greatest.value - 700 * 9.81) <= greatest.error < 1e-6
