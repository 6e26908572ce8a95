"""Machine elements look as they work: ropes as long as they are, roads where wheels touch, pulls that bearings hold."""

from __future__ import annotations

from functools import cache

import numpy as np
import pytest

from heuncli.app.commands.show import REPORTS
from heuncli.output.machine_geometry.machine import CouplingForce, Machine, iter_coupling_forces, make_machine
from heuncli.output.machine_geometry.poses import Poses, extract_poses
from heuncli.output.machine_geometry.ropes import iter_rope_lines
from heuncli.output.web_page.moving_page import render_moving_page
from heuncli.results.results import Array
from heuncli.scene.file_format.load import load
from heuncli.study.model.options import Options
from heuncli.study.quantities.table_units import Units
from heuncli.study.queries.study import Study
from heuncli.study.workflow import solve
from tests.shared.folders import SPECS
from tests.shared.moving_pages import data_of, places

HOIST = """heun: 1
gravity: [0, 0, -10]
ground: {points: {O: [0, 0, 4], A: [1.5, 0, 5], a: [-0.3, 0, 0], S: [1.2, 0, 6]}}
bodies:
  drum: {mass: 15, center: [0, 0, 0], inertia: [1, 2, 1], points: {hub: [0, 0, 0]}}
  cage: {mass: 90, center: [0, 0, 0], inertia: [5, 5, 5], points: {top: [0, 0, 0]}}
joints:
  axle: {type: pin, from: ground.O, to: drum.hub, axis: [0, 1, 0]}
  rails: {type: slide, from: ground.a, to: cage.top, axis: [0, 0, 1]}
couplings:
  hoist:
    type: rope
    through:
      - cage.top
      - {sheave: drum.hub, radius: 0.3, axis: [0, 1, 0], slip: none, side: over}
      - {sheave: ground.S, radius: 0.2, axis: [0, 1, 0], side: over}
      - ground.A
analysis: {type: state}
"""
STOPPED = """heun: 1
ground: {points: {O: [1, 0, 0], B: [0, 3, 0]}}
bodies:
  arm: {mass: 1, center: [0.5, 0, 0], inertia: [1, 1, 1], points: {o: [0, 0, 0]}, position: [1, 0, 0]}
  cart: {mass: 1, center: [0, 0, 0], inertia: [1, 1, 1], points: {o: [0, 0, 0]}}
joints:
  hinge: {type: pin, from: ground.O, to: arm.o, axis: [0, 0, 1], initial: {angle: 0.4, rate: 1}}
  rail: {type: slide, from: ground.B, to: cart.o, axis: [1, 0, 0], initial: {travel: 0.5, speed: 1}}
stops:
  wall: {joint: hinge, angle: [-0.2, 1]}
  buffer: {joint: rail, travel: [0, 2]}
latches:
  click: {stop: buffer}
  notch: {joint: rail, travel: 1}
analysis: {duration: 0.1, samples: 2}
"""


@cache
def of_spec(name: str) -> Study:
    return solve(load(SPECS / f"{name}.yaml", checking=False), Options(requested_reports=REPORTS))


def seen(study: Study) -> tuple[Machine, Poses]:
    return make_machine(study.spec, scene=study.setup.scene), extract_poses(study.results)


def pulls(study: Study) -> dict[tuple[str, str], CouplingForce]:
    """By coupling and body; of belts the last strand."""
    return {(one.name, one.body): one for one in iter_coupling_forces(*seen(study), study.results.couplings)}


def length(line: Array) -> float:
    return float(np.sum(np.linalg.norm(np.diff(line, axis=0), axis=1)))


@pytest.mark.parametrize("text", [HOIST, (SPECS / "tower_crane.yaml").read_text()], ids=["hoist", "crane"])
def test_a_rope_is_drawn_as_long_as_it_is_and_hangs_together(text: str) -> None:
    study = solve(load("rope.yaml", text, checking=False), Options(requested_reports=REPORTS))
    machine, poses = seen(study)
    (rope,) = machine.ropes
    (coupling,) = study.setup.scene.mechanism.couplings
    lines = list(iter_rope_lines(rope, poses, 0))
    law = coupling.law
    whole = sum(row.length or 0.0 for row in coupling.rows) if law is None else law.derivatives(0.0)[0]
    arcs = [line for arc, line in zip(rope.arcs, lines[len(rope.spans) :], strict=True) if arc.body != "drum"]
    counted = sum(map(length, lines[: len(rope.spans)] + arcs))  # what lies on the drum counts by its turn
    assert counted == pytest.approx(whole, rel=2e-4)  # arcs are drawn in steps of 0.1 rad
    ends = np.array([line[[0, -1]] for line in lines])
    for arc, line in zip(rope.arcs, lines[len(rope.spans) :], strict=True):
        assert line[[0, -1]] == pytest.approx(ends[[arc.span, arc.span + 1], [1, 0]], abs=1e-12)


def test_a_ropes_ends_and_sheaves_on_the_ground_stand_on_it() -> None:
    """Away from where the rope pulls: the end at A up and to the left, the sheave S down."""
    study = solve(load("rope.yaml", HOIST), Options(requested_reports=REPORTS))
    machine, poses = seen(study)
    stood = {mark.description: mark.locate(poses) for mark in machine.marks}
    (end, away), (sheave, off) = stood["hoist: on the ground"], stood["hoist: a sheave on the ground"]
    assert end[0] == pytest.approx([1.5, 0.0, 5.0]) and sheave[0] == pytest.approx([1.2, 0.0, 6.0])
    assert away[0] == pytest.approx((end[0] - sheave[0]) / np.linalg.norm(end[0] - sheave[0]))
    assert off[0][2] > 0.0


def test_stops_and_latches_stand_where_their_coordinates_come_to() -> None:
    study = solve(load("stops.yaml", STOPPED), Options(requested_reports=REPORTS))
    machine, poses = seen(study)
    found = {(mark.name, round(float(mark.locate(poses)[0][0, 0]), 6)): mark for mark in machine.marks}
    out = 0.3  # of the arm's 0.5 m to its centre of mass
    for angle, sense in ((-0.2, -1.0), (1.0, 1.0)):
        place, way = found["wall", round(1.0 + out * np.cos(angle), 6)].locate(poses)
        assert place == pytest.approx(np.tile([1.0 + out * np.cos(angle), out * np.sin(angle), 0.0], (2, 1)))
        assert way[0] / out == pytest.approx([-sense * np.sin(angle), sense * np.cos(angle), 0.0])
    for name, x, symbol in (("buffer", 0.0, "stop"), ("buffer", 2.0, "stop"), ("click", 2.0, "latch"),
                            ("notch", 1.0, "latch")):  # fmt: skip
        place, way = found[name, x].locate(poses)
        assert found[name, x].symbol == symbol and place[0] == pytest.approx([x, 3.0, 0.0])
        assert way[0] == pytest.approx([-1.0 if x == 0.0 else 1.0, 0.0, 0.0])


def test_roads_lie_where_wheels_touch_them_at_all_instants() -> None:
    study = of_spec("cart")
    machine, poses = seen(study)
    for mark in machine.marks:
        name = mark.description.partition(":")[0]
        place, way = mark.locate(poses)
        assert mark.symbol == "road" and way == pytest.approx(np.tile([0.0, 0.0, -1.0], (len(place), 1)))
        assert place == pytest.approx(study.results.couplings[name]["on"]["ground"]["point"], abs=1e-12)


def test_a_coupling_pulls_once_on_what_it_moves_and_a_rope_on_each_along_its_line_of_action() -> None:
    """Cam and wheels: the counterpart is not drawn. The crane's falls hang on the trolley's two sheaves."""
    assert set(pulls(of_spec("valve_train"))) == {("valve", "tappet")}
    assert set(pulls(of_spec("cart"))) == {("tyre_left", "left"), ("tyre_right", "right")}
    crane = of_spec("tower_crane")
    found = pulls(crane)
    assert {on for _, on in found} == {"trolley", "hook", "ground"}
    one, other = found["hoist", "trolley"], found["hoist", "hook"]
    assert one.forces == pytest.approx(-other.forces, abs=1e-6) and (other.forces[:, 1] > 0.0).all()
    assert one.points[:, 0] == pytest.approx(crane.results.bodies["trolley"]["center"][:, 0])  # in the middle of both


def test_both_strands_of_a_belt_pull_what_its_bearing_holds() -> None:
    study = of_spec("belt_drive")
    strands = list(iter_coupling_forces(*seen(study), study.results.couplings))
    assert [(one.name, one.body) for one in strands] == [("belt", "fan")] * 2
    held = study.results.joints["hub"]["force"]
    assert sum(one.forces for one in strands) == pytest.approx(-held, abs=1e-6 * float(np.abs(held).max()))
    hub = study.results.joints["hub"]["point"]
    turning = sum(np.cross(one.points - hub, one.forces)[:, 2] for one in strands)
    radius = study.spec.couplings["belt"].radii[1]  # type: ignore[union-attr]
    assert turning == pytest.approx(radius * np.asarray(study.results.couplings["belt"]["force"]), abs=1e-9)


def test_a_page_holds_the_ends_of_ropes_at_each_frame_and_what_stands_still_once() -> None:
    study = of_spec("tower_crane")
    data = data_of(render_moving_page({"": study}, Units()))
    scene, count = data["scene"], data["count"]
    (rope,) = scene["ropes"]
    ends = places(rope["ends"]).reshape(count, rope["count"], 2, 3)
    trolley = places(scene["bodies"][0]["places"]).reshape(count, 3)
    falls = ends[:, 1:3, :, 0].min(axis=2)  # hang on the trolley's sheaves, a diameter apart
    assert falls.mean(axis=1) == pytest.approx(trolley[:, 0], abs=1e-5) and np.ptp(trolley[:, 0]) > 1.0
    assert {pull["row"].split(".")[3] for pull in scene["pulls"]} == {"trolley", "hook", "ground"}
    assert [(own["joint"], own["symbols"], own["slides"]) for own in scene["acting"]] == [(0, ["sliding"] * 2, True)]
    stopping = solve(load("stops.yaml", STOPPED), Options(requested_reports=REPORTS))
    stopped = data_of(render_moving_page({"": stopping}, Units()))["scene"]
    assert [len(places(mark["places"])) for mark in stopped["marks"]] == [3] * 7
    assert set(stopped["symbols"]) == {"stop", "latch"}
