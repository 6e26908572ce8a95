"""A scene solved again with other values is what `heun run --set` makes of it: every bit, every error, in any order."""

from __future__ import annotations

import random
from collections.abc import Callable, Iterator, Mapping
from contextlib import suppress
from pathlib import Path
from typing import Any

import pytest

from heuncli.analyses.variants.solver import VariantSolver
from heuncli.base.errors import HeunError, SpecError
from heuncli.loads.redundancy import count
from heuncli.scene.file_format.load import load
from heuncli.scene.file_format.models import Spec
from heuncli.study.model.options import Options
from heuncli.study.queries import measure
from heuncli.study.queries.measure import MeasureRequest, measure_value
from heuncli.study.queries.study import Study
from heuncli.study.workflow import solve
from tests.shared.bits import bits
from tests.shared.folders import ROOT, SPECS

FILES = sorted([*SPECS.glob("*.yaml"), *(ROOT / "heuncli" / "starters").glob("*.yaml")])
SHORT = 0.05  # of a motion: what is kept is kept of the set-up
PINS = """\
heun: 1
parameters: {L: 1.0, m: 2 kg, n: 5, F: 10 N, a: 0.3, k: 0, T: 1 s, w: 3 rad/s, density: 7850}
gravity: [0, -9.81, 0]
tables:
  push: {x: [0, T/2, T], y: [0, F, 0], period: T}
ground: {points: {O: [0, 0, 0]}}
bodies:
  bar:
    shapes: [{type: cylinder, from: [0, 0, 0], to: [L, 0, 0], radius: 0.02, density: density}]
    points: {top: [0, 0, 0], end: [L, 0, 0]}
    orientation: {axis: [0, 0, 1], angle: -a}
  bob: {mass: m, center: [0, 0, k], inertia: [k, k, k], points: {p: [0, 0, 0]}}
joints:
  pivot: {type: pin, axis: [0, 0, 1], from: ground.O, to: bar.top, initial: {rate: w}}
  hold: {type: weld, from: bar.end, to: bob.p}
forces:
  push: {type: force, on: bar.end, vector: ["table(push, t)", "k*sin(w*t)", 0]}
  gust: {type: force, on: bar.end, vector: [0, "F if t < T/4 else 0", k]}
sections:
  along: {body: bar, from: top, to: end, count: n}
analysis: {duration: 0.1, samples: 5}
expect: [{of: joints.pivot.force.x, at: 0.05, below: 1e9}]
"""
PLANAR = """\
heun: 1
space: planar
parameters: {b: 0.2, c: 0.5, w: 20, F: 100}
ground: {points: {O: [0, 0], Q: [0.4, 0]}}
bodies:
  crank: {mass: 1, center: [b/2, 0], inertia: 0.01, points: {a: [0, 0], b: [b, 0]}}
  coupler: {mass: 1, center: [c/2, 0], inertia: 0.02, points: {a: [0, 0], b: [c, 0]}, near: {position: [0, b]}}
  rocker: {mass: 1, center: [0, 0.2], inertia: 0.02, points: {a: [0, 0], b: [0, 0.4]}, near: {position: [0.4, 0]}}
joints:
  main: {type: pin, from: ground.O, to: crank.a, initial: {angle: 1}}
  big: {type: pin, from: crank.b, to: coupler.a}
  small: {type: pin, from: coupler.b, to: rocker.b}
  foot: {type: pin, from: ground.Q, to: rocker.a}
drives: {motor: {joint: main, angle: "1 + w*t"}}
forces: {load: {type: torque, joint: foot, value: -F*foot.rate/10}}
analysis: {type: state}
"""
# Values that change what the scene is made of: a pattern of zeros, how many cuts there are, kinds of joints, the plane.
STRUCTURE: Mapping[str, tuple[dict[str, str], ...]] = {
    PINS: (
        {"L": "1.25"}, {"m": "3 kg"}, {"n": "7"}, {"n": "1"}, {"n": "2.5"}, {"F": "0"}, {"F": "-20 N"}, {"F": "3 m"},
        {"k": "0.1"}, {"k": "-0.1"}, {"T": "0.05 s"}, {"T": "0"}, {"w": "0"}, {"w": "-w"}, {"w": "2*L"},
        {"a": "20 deg"},
        {"density": "1"}, {"density": "-1"}, {"L": "0"}, {"L": "1e300"}, {"nothing": "1"}, {"L": "[1"}, {"L": "true"},
        {"joints.pivot.type": "ball", "joints.pivot.axis": "null"}, {"joints.hold.type": "ball"},
        {"joints.pivot.axis": "[0, 1, 0]"}, {"bodies.bob.mass": "5 kg"}, {"bodies.bob.points.p": "[0.1, 0, 0]"},
        {"gravity": "[0, 0, -9.81]"}, {"gravity": "[0, 0, 0]"}, {"analysis.samples": "9"}, {"analysis.type": "state"},
        {"tables.push.interpolation": "cubic"}, {"bodies.bar.shapes.0.radius": "L/10"}, {"title": "another"},
        {"forces.gust.vector.1": "F*t", "k": "0.2"}, {"L": "1.25", "w": "4 rad/s", "F": "12"}, {},
    ),
    PLANAR: (
        {"b": "0.21"}, {"w": "0"}, {"w": "25"}, {"F": "0"}, {"c": "0.05"}, {"c": "-0.5"}, {"space": "spatial"},
        {"drives.motor.joint": "foot"}, {"joints.main.initial.angle": "1.1"}, {"bodies.rocker.mass": "0"},
        {"analysis.type": "motion", "analysis.duration": "0.02", "analysis.samples": "3"}, {"b": "0.25", "F": "10"},
    ),
}  # fmt: skip


def told(solve: Callable[[], Study]) -> Any:
    """All numbers and words of a run but how long it took; of one that fails its problems."""
    try:
        study = solve()
    except HeunError as error:
        return type(error), error.problems
    results = vars(study.results)
    work = {key: value for key, value in study.results.work.items() if key != "seconds"}
    spec = study.spec._replace(tables={}, locations={})
    return [*bits({**results, "work": work}), *bits(study.history.estimate), *bits(spec.analysis)]


def shortened(path: Path) -> dict[str, str]:
    """What to set for a run of a small part of a spec's motion; nothing where it has no such part."""
    spec = load(path, checking=False)
    last = repr(SHORT * spec.analysis.times[-1])
    for settings in ({"analysis.duration": last, "analysis.samples": "3"}, {"analysis.times": f"[0, {last}]"}):
        with suppress(SpecError):
            if spec.analysis.type == "motion":
                load(path, overrides=settings, checking=False)
                return settings
    return {}


def values_of(spec: Spec) -> Iterator[dict[str, str]]:
    """Of each parameter by turns a slightly larger value, zero and its negative."""
    for k, (name, value) in enumerate(spec.parameters.items()):
        yield {name: repr((1.01 * value + 1e-3 * (value == 0.0), 0.0, -value)[k % 3])}


@pytest.mark.heavy
@pytest.mark.parametrize("path", FILES, ids=lambda path: f"{path.parent.name}-{path.stem}")
@pytest.mark.sixth
def test_a_variant_has_the_bits_of_a_fresh_run(path: Path) -> None:
    short = shortened(path)
    variants = VariantSolver(path, overrides=short)
    for values in values_of(variants.spec):
        fresh = told(lambda: solve(load(path, overrides={**short, **values}, checking=False)))  # noqa: B023 - at once
        assert told(lambda: variants.solve(values)) == fresh, values  # noqa: B023


@pytest.mark.heavy
@pytest.mark.parametrize(
    ("text", "seed"),
    [
        pytest.param(PINS, 0, id="pins-0"),
        pytest.param(PLANAR, 0, id="planar-0", marks=pytest.mark.long),
        pytest.param(PINS, 1, id="pins-1", marks=pytest.mark.long),
        pytest.param(PLANAR, 1, id="planar-1"),
    ],
)
def test_the_order_of_variants_does_not_matter(text: str, seed: int) -> None:
    options = Options(requested_reports=frozenset({"joints", "sections", "energy"})) if seed else Options()
    given = [*STRUCTURE[text]]
    fresh = [told(lambda: solve(load("x.yaml", text, values, checking=False), options)) for values in given]  # noqa: B023
    assert any(one[0] is SpecError for one in fresh)
    variants = VariantSolver("x.yaml", text, options=options)
    order = [*range(len(given)), *range(len(given))]
    random.Random(seed).shuffle(order)
    for k in order:
        assert told(lambda: variants.solve(given[k])) == fresh[k], given[k]  # noqa: B023


def test_a_rate_at_the_start_keeps_the_count_of_redundant_conditions(monkeypatch: pytest.MonkeyPatch) -> None:
    drive = 'drives: {motor: {joint: main, angle: "1 + w*t"}}\n'
    text = PLANAR.replace(drive, "").replace("initial: {angle: 1}", "initial: {angle: 1, rate: w}")
    variants, values = VariantSolver("x.yaml", text), {"w": "25"}
    fresh = told(lambda: solve(load("x.yaml", text, values, checking=False)))
    monkeypatch.setattr(count, "count_self_stresses", None)
    assert told(lambda: variants.solve(values)) == fresh


@pytest.mark.parametrize(
    "path", [SPECS / "double.yaml", SPECS / "swing.yaml", SPECS / "slider_crank.yaml"], ids=lambda path: path.stem
)
def test_a_measure_read_alone_has_the_bits_of_one_from_results(path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    joints = load(path).joints
    measures = [
        MeasureRequest(how, f"joints.{name}.{what}")
        for name in joints for how in ("max", "min", "abs") for what in ("force", "moment", "force.x", "moment.z")
    ]  # fmt: skip
    study = VariantSolver(path, measures=[request.path for request in measures]).solve({})
    found = [[*bits(measure_value(request, study))] for request in measures]
    is_tree = not study.setup.scene.layout.rows
    reads = [read_one(study, request) is not None for request in measures]
    assert reads == [is_tree] * len(measures)
    monkeypatch.setattr(measure, "make_joint_reader", lambda *_: lambda recovery: None)
    assert [[*bits(measure_value(request, study))] for request in measures] == found


def read_one(study: Study, request: MeasureRequest) -> Any:
    """What is read of a recovery without results."""
    return measure.make_joint_reader(study, study.find_numbers(request.path), request.path)(study.recovery)
