"""Bearing pairs and sensors: by hand, against two real bearings, and open where the reaction is."""

from __future__ import annotations

import json
from itertools import product
from pathlib import Path
from types import SimpleNamespace
from typing import Any, cast

import numpy as np
import pytest

from heuncli.base.errors import SpecError
from heuncli.loads.kinetostatics.moved_reactions import PlacedSensor
from heuncli.loads.kinetostatics.reactions import JointLoads
from heuncli.multibody.mechanism.loads import GROUND
from heuncli.results.results import Results
from heuncli.results.results_paths import find_values
from heuncli.results.results_schema import REPORTS
from heuncli.scene.file_format.load import load
from heuncli.study.quantities.digits import find_stated_errors
from heuncli.study.quantities.labels import make_labels
from heuncli.study.solve.load_errors import LoadErrors
from tests.shared.command import Heun
from tests.shared.folders import ROOT
from tests.shared.scenes import near, solved, study

PULL, WEIGHT, OVERHANG, SPAN = 100.0, 50.0, 0.1, 0.2
OVERHUNG = f"""\
heun: 1
ground: {{points: {{O: [0, 0, 0], P: [0.2, 0.1, 0]}}}}
bodies:
  shaft:
    mass: 1
    center: [0, 0, 0]
    inertia: [1e-3, 1e-3, 1e-3]
    points: {{a: [0, 0, 0], end: [0, 0, {SPAN + OVERHANG}]}}
joints:
  main: {{type: pin, from: ground.O, to: shaft.a, axis: [0, 0, 1], bearings: {{at: [0, {SPAN}], axial: second}}}}
sensors:
  cell: {{of: joints.main, point: ground.P}}
forces: {{pull: {{type: force, on: shaft.end, vector: [{PULL}, 0, {WEIGHT}]}}}}
analysis: {{type: state}}
"""
# an unbalanced, skew rotor that spins up under its weight; on a pin, or on a ball and a point on a line
ROTOR = """\
heun: 1
gravity: [1, -9.81, 3]
ground: {points: {O: [0, 0, 0], A: [0, 0, 0.1], B: [0, 0, 0.5]}}
bodies:
  rotor:
    mass: 2
    center: [0.03, 0.01, 0.35]
    inertia: [[0.03, 0.002, 0.004], [0.002, 0.03, -0.003], [0.004, -0.003, 0.02]]
    points: {o: [0, 0, 0], a: [0, 0, 0.1], b: [0, 0, 0.5], rim: [0.1, 0, 0.7]}
    angular_velocity: [0, 0, 30]
JOINTS
forces:
  belt: {type: force, on: rotor.rim, vector: [20, "5*sin(40*t)", -8]}
  motor: {type: couple, on: rotor.o, vector: [0, 0, 0.4]}
BLOW
analysis: {times: [0, 0.02, 0.05, 0.1], tolerance: 1e-11}
"""
PIN = """joints:
  main: {type: pin, from: ground.O, to: rotor.o, axis: [0, 0, 1], bearings: {at: [0.1, 0.5], axial: first}}"""
REAL = """joints:
  fixed: {type: ball, from: ground.A, to: rotor.a}
  loose: {type: line, from: ground.B, to: rotor.b, axis: [0, 0, 1]}"""
BLOW = "impulses: {blow: {on: rotor.rim, vector: [1, 2, -3], time: 0.02}}"


def test_an_overhung_shaft_by_hand() -> None:
    """R2 = F (1 + a/l) against the pull, R1 = F a/l along it; about P the moment is (P - O) x F less."""
    results = solved(OVERHUNG)
    first, second = results.joints["main"]["bearings"].values()
    near(first["radial_force"], [[PULL * OVERHANG / SPAN, 0.0, 0.0]], PULL, 1e-14)
    near(second["radial_force"], [[-PULL * (1.0 + OVERHANG / SPAN), 0.0, 0.0]], PULL, 1e-14)
    near([first["axial"], second["axial"]], [[0.0], [-WEIGHT]], PULL, 1e-14)
    cell = results.sensors["cell"]
    near(cell["force"], [[-PULL, 0.0, -WEIGHT]], PULL, 1e-14)
    # about the origin (0, -0.3 F, 0); P = (0.2, 0.1, 0) takes P x F from it
    near(cell["moment"], [[0.1 * WEIGHT, -0.3 * PULL - 0.2 * WEIGHT, -0.1 * PULL]], PULL, 1e-14)


@pytest.mark.parametrize("blow", ["", BLOW])
def test_two_real_bearings_carry_the_same(blow: str) -> None:
    """A ball and a point on a line hold the same shaft; their reactions are those of the pair."""
    text = ROTOR.replace("BLOW", blow)
    pair, real = solved(text.replace("JOINTS", PIN)), solved(text.replace("JOINTS", REAL))
    cases: list[tuple[Any, Any]] = [(pair.joints, real.joints)]
    cases += [(a["joints"], b["joints"]) for a, b in zip(pair.impulses, real.impulses, strict=True)]
    assert len(cases) == 1 + bool(blow)
    for mine, its in cases:
        first, second = mine["main"]["bearings"].values()
        fixed, loose = its["fixed"]["force"], its["loose"]["force"]
        scale = float(np.abs(fixed).max())
        near(first["radial_force"][..., :2], fixed[..., :2], scale, 1e-9)
        near(first["axial"], fixed[..., 2], scale, 1e-9)
        near(second["radial_force"], loose, scale, 1e-9)
        near(second["axial"], np.zeros_like(second["axial"]), scale, 1e-12)
        assert first["radial"] == pytest.approx(np.linalg.norm(fixed[..., :2], axis=-1), rel=1e-8)


def test_their_axes_turn_with_the_rotor() -> None:
    """In the axes of the rotor the loads of its bearings are those of the world, turned."""
    text = ROTOR.replace("BLOW", "").replace("JOINTS", PIN)
    reports = frozenset({"joints", "motion", "shares"})
    world, own = (solved(text, axes=axes, requested_reports=reports) for axes in ("world", "to"))
    for number in ("0", "1"):
        first, second = (results.joints["main"]["bearings"][number] for results in (world, own))
        for a, b in [(first, second), *((first["shares"][c], second["shares"][c]) for c in first["shares"])]:
            turned = np.einsum("tji,tj->ti", world.bodies["rotor"]["rotation"], a["radial_force"])
            near(b["radial_force"], turned, 1e3, 1e-14)


def test_a_bearing_that_nobody_named_leaves_the_thrust_open() -> None:
    results = solved(OVERHUNG.replace(", axial: second", ""))
    joint = results.joints["main"]
    assert [bearing["open"] for bearing in joint["bearings"].values()] == [["axial"], ["axial"]]
    assert all(np.isnan(bearing["axial"]).all() for bearing in joint["bearings"].values())
    near(joint["bearings"]["0"]["radial"], [50.0], PULL, 1e-14)
    near(joint["axial"], [-WEIGHT], PULL, 1e-14)


def test_what_two_hinges_share_is_open_at_a_sensor() -> None:
    """The weight of a door on two balls: along the hinges open, and so are the moments that it makes beside them."""
    text = (ROOT / "specs" / "door.yaml").read_text().split("expect:")[0]
    name = next(iter(load("door.yaml", text).joints))
    cell = f"{{of: joints.{name}, point: {{body: ground, at: [0.5, 0, 0]}}}}"
    text += f"sensors: {{cell: {cell}, own: {{of: joints.{name}}}}}"
    results = solved(text)
    joint, found = results.joints[name], results.sensors["cell"]
    assert joint["open"] == ["force.z"]
    assert found["open"] == ["force.z", "moment.y"]
    assert np.isnan(found["moment"][:, 1]).all()
    assert np.isfinite(found["moment"][:, 2]).all()
    assert np.array_equal(results.sensors["own"]["force"], joint["force"], equal_nan=True)
    assert np.isfinite(solved(text, least_norm=True).sensors["cell"]["moment"]).all()


def test_bearings_of_redundant_pins_are_open_with_them() -> None:
    """Two pins on one axis hold a bar: their tilting moments are open, so are the bearings' loads; their sum is not."""
    text = """\
heun: 1
gravity: [0, 0, -9.81]
ground: {points: {O: [0, 0, 0], P: [1, 0, 0]}}
bodies: {bar: {mass: 1, center: [0.3, 0.1, 0], inertia: [1, 1, 1], points: {a: [0, 0, 0], b: [1, 0, 0]}}}
joints:
  one: {type: pin, from: ground.O, to: bar.a, axis: [1, 0, 0], bearings: {at: [-0.1, 0.1]}}
  two: {type: pin, from: ground.P, to: bar.b, axis: [1, 0, 0], stiffness: {moment: 0, force: [0, 1e8, 1e8]}}
analysis: {type: state}
"""
    one = solved(text).joints["one"]
    assert np.isfinite(one["bearings"]["0"]["radial"]).all()
    free = solved(text.replace(", stiffness: {moment: 0, force: [0, 1e8, 1e8]}", "")).joints["one"]
    assert all({"radial", "radial_force.z"} <= {*bearing["open"]} for bearing in free["bearings"].values())
    assert np.isnan(free["bearings"]["0"]["radial"]).all()


def test_in_a_scene_declared_planar() -> None:
    """The plane's force is shared by the lever, nothing acts across the plane."""
    results: Results = solved("""\
heun: 1
space: planar
gravity: [0, -9.81]
ground: {points: {O: [0, 0]}}
bodies: {bar: {mass: 2, center: [1, 0], inertia: 1, points: {a: [0, 0]}}}
joints: {pivot: {type: pin, from: ground.O, to: bar.a, bearings: {at: [-0.1, 0.3]}}}
sensors: {cell: {of: joints.pivot, point: {body: bar, at: [1, 0, 0.5]}, axes: bar}}
analysis: {type: state}
""")
    joint = results.joints["pivot"]
    force = joint["force"]
    near(joint["bearings"]["0"]["radial_force"], 0.75 * force, 20.0, 1e-14)
    near(joint["bearings"]["1"]["radial_force"], 0.25 * force, 20.0, 1e-14)
    assert joint["bearings"]["0"]["open"] == []
    assert not joint["bearings"]["0"]["axial"].any()
    near(results.sensors["cell"]["moment"], [[0.0, 0.0, -force[0, 1]]], 20.0, 1e-14)


def test_its_stated_error_grows_with_the_lever_and_covers_the_true_one() -> None:
    """The same run, a hundred times finer; read at 3 m and at 300 m, and of bearings 1 mm apart."""
    text = ROTOR.replace("BLOW", "").replace("JOINTS", PIN.replace("0.1, 0.5", "0.1, 0.101")).replace("1e-11", "1e-6")
    text += "sensors: {cell: {of: joints.main, point: {body: ground, at: [FAR, 0, 0]}}}\n"

    def run(far: float, tolerance: str) -> Any:
        return study(text.replace("FAR", str(far)).replace("1e-6", tolerance))

    def stated(far: float, kind: str, unit: str) -> float:
        own = run(far, "1e-6")
        return find_stated_errors(own.results, make_labels(own.spec), own.magnitudes).error_of(kind, unit)

    coarse, fine = run(300.0, "1e-6").results, run(300.0, "1e-10").results
    true = float(np.abs(coarse.sensors["cell"]["moment"] - fine.sensors["cell"]["moment"]).max())
    assert true <= stated(300.0, "sensors", "N·m") <= 1e5 * true
    assert stated(300.0, "sensors", "N·m") > 30.0 * stated(3.0, "sensors", "N·m")
    pairs = [results.joints["main"]["bearings"]["0"]["radial_force"] for results in (coarse, fine)]
    assert float(np.abs(pairs[0] - pairs[1]).max()) <= stated(3.0, "bearings", "N")
    assert stated(3.0, "bearings", "N") > 30.0 * stated(3.0, "reactions", "N")


def test_the_rounding_of_a_moved_moment_covers_both_products_of_each_component() -> None:
    """(d x F)_z = d_x F_y - d_y F_x: if each component of F may be off by e, it is off by (|d_x| + |d_y|) e."""
    far, rounding, found = np.array([30.0, -40.0, 2.0]), 1e-3, {}
    zeros, error = np.zeros((1, 3)), np.full(1, rounding)
    load = SimpleNamespace(joint=SimpleNamespace(name="main", bearings=None), point=zeros, force=zeros, moment=zeros)
    sensor = PlacedSensor("cell", "main", None, GROUND, far, GROUND)
    scene = SimpleNamespace(mechanism=SimpleNamespace(planar=False))
    own = SimpleNamespace(
        setup=SimpleNamespace(sensors=(sensor,), cuts=(), scene=scene),
        add_values=lambda name, values, rounding, terms: found.update({name: rounding[0]}),
    )
    states: Any = SimpleNamespace(point_position=lambda body, point: point[None])
    terms: Any = SimpleNamespace(rounding=(error, 0.0 * error), force=error, moment=error)
    LoadErrors.add_moved_reactions(cast(LoadErrors, own), states, [cast(JointLoads, load)], [], terms)
    worst = np.abs([np.cross(-far, signs) for signs in product([-rounding, rounding], repeat=3)]).max()
    assert found["sensors", "moment"] >= worst > 1.5 * 40.0 * rounding


def test_they_are_measured_expected_awaited_and_shown(heun: Heun, folder: Path) -> None:
    expected = "expect: [{of: joints.main.bearings.1.radial, is: 150 N}, {of: sensors.cell.force.x, is: -100 N}]\n"
    (folder / "shaft.yaml").write_text(OVERHUNG + expected)
    assert heun("check", "shaft.yaml").returncode == 0
    assert heun("run", "shaft.yaml", "--measure", "sensors.cell.moment.x").stdout.strip().startswith("5")
    shown = heun("run", "shaft.yaml").stdout
    assert "main.bearings.1  at 0.2 m along the axis" in shown
    assert "cell    main, about ground.P, world axes" in shown
    only = json.loads(heun("run", "shaft.yaml", "--only", "sensors.cell", "--format", "json").stdout)
    assert [*only["sensors"]] == ["cell"]
    assert not only.get("joints")
    until = ROTOR.replace("BLOW", "sensors: {cell: {of: joints.main}}").replace("JOINTS", PIN)
    until = until.replace("{times: [0, 0.02, 0.05, 0.1]", "{duration: 0.5, until: {of: sensors.cell.force.x, above: 0}")
    (folder / "rotor.yaml").write_text(until)
    last = json.loads(heun("run", "rotor.yaml", "--format", "json").stdout)["sensors"]["cell"]["force"][-1]
    assert abs(last[0]) < 1e-3


@pytest.mark.parametrize(("wrong", "right", "code", "words"), [
    ("joints.main, p", "joints.mian, p", "sensor-of", "did you mean main"),
    ("joints.main, p", "main, p", "sensor-of", "write joints.main"),
    ("ground.P}", "ground.Q}", "unknown-point", "ground has no point 'Q'"),
    ("ground.P}", "ground.P, axes: shaf}", "unknown-body", "did you mean shaft"),
    (f"[0, {SPAN}]", "[0.2, 0.2]", "bearings-form", "both bearings are at 0.2 m"),
    ("type: pin", "type: line", "bearings-form", "a line carries no tilting moment"),
    ("type: pin", "type: cylinder", "bearings-form", "a cylinder slides along its axis"),
])  # fmt: skip
def test_what_means_nothing_is_refused(wrong: str, right: str, code: str, words: str) -> None:
    text = OVERHUNG.replace(wrong, right)
    assert text != OVERHUNG
    with pytest.raises(SpecError) as refused:
        load("shaft.yaml", text)
    (problem,) = refused.value.problems
    assert problem.code == code
    assert words in f"{problem.message}; {problem.hint}"


PATHS = (
    "sensors.own.force", "sensors.cut.moment", "joints.main.force", "foundation.force", "sections.mid.N",
    "impulses.0.sensors.cut.force",
)  # fmt: skip


@pytest.mark.parametrize("path", PATHS)
def test_what_is_not_asked_for_need_not_be_cut(heun: Heun, folder: Path, path: str) -> None:
    """A sensor of a cut keeps its section where it is asked for, and goes with it elsewhere: all tell the same."""
    text = ROTOR.replace("JOINTS", PIN).replace("BLOW", BLOW).replace("times: [0, 0.02, 0.05, 0.1]", "times: [0, 0.1]")
    piece = "piece: {mass: 1, center: [0, 0, 0.6], inertia: [0.01, 0.01, 0.01]}"
    text = text.replace("    mass: 2\n", f"    mass: 2\n    {piece}\n")
    text += "sections: {mid: {body: rotor, at: [0, 0, 0.4], normal: [0, 0, 1]}}\n"
    text += "sensors: {own: {of: joints.main}, cut: {of: sections.mid, point: rotor.rim, axes: rotor}}\n"
    (folder / "rotor.yaml").write_text(text)
    alone = heun("run", "rotor.yaml", "--measure", path if path.startswith("impulses") else f"first {path}")
    assert alone.returncode == 0, alone.stderr
    whole = find_values(solved(text, requested_reports=frozenset(REPORTS)), path)
    first = whole.values[0] if whole.is_timed else whole.values
    assert float(alone.stdout) == pytest.approx(float(np.linalg.norm(first) if first.size > 1 else first), rel=1e-9)
