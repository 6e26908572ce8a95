"""Everything wrong is told, once, where it is; and nothing but that ever comes of a text."""

from __future__ import annotations

import random
from pathlib import Path

import pytest

from heuncli.base.errors import SpecError
from heuncli.scene.file_format.load import load
from heuncli.scene.file_format.models import Spec
from heuncli.scene.file_format.rules import references
from heuncli.scene.file_format.rules.every import RULES, DraftDocument
from tests.shared.folders import ROOT


@pytest.fixture(autouse=True)
def whole_format(monkeypatch: pytest.MonkeyPatch) -> None:
    """The format is read whole, also what is not solved yet."""
    monkeypatch.setattr(references, "NOT_YET", ())


def problems(text: str) -> list[str]:
    """'line:column path code' of every problem."""
    with pytest.raises(SpecError) as caught:
        load("x.yaml", text=text)
    assert caught.value.exit_code == 2
    assert [str(p) for p in caught.value.problems if not p.hint] == []
    return [
        f"{p.location.line}:{p.location.column} {p.location.path} {p.code}" for p in caught.value.problems if p.location
    ]


MANY = """\
heun: 1
parameters: {a: b, b: a, L: 2 m, w: 3 xyz, t: 5}
gravity: [0, 0]
bodies:
  upper:
    masss: 1.0
    mass: 5 mm
    center: [0, 0, L/0]
    inertia: [1, 1, w]
    points: {top: [0, 0, 0], end: [0, 0, -L]}
  low: {mass: 1, center: [0, 0, 0], inertia: [1, 1, 3], points: {top: [0, 0, 0]}}
  odd: {shapes: [{type: tube, from: [0, 0, 0]}, {type: box, center: [0, 0, 0], size: [1, 1]}, 5]}
joints:
  pivot: {type: joint, from: ground.O, to: upper.topp}
  elbow: {type: ball, from: upper.endd, to: lower.top}
  knee: {type: pin, from: low.top, to: low.top}
forces:
  push: {type: force, on: low.top, vector: ["2^t", 0, "sin"]}
  motor: {type: torque, joint: elbow, value: t}
  ram: {type: actuator, from: up.x, to: low.top, valu: 2}
analysis: {duratio: 2, samples: 201}
foo: 1
report: [motion, joint]
expect: [{of: joints.elbow.force.z, is: 1, peak: maxi}, {of: joint.x, is: 1}, {of: time, is: [1, x]}]
"""


def test_all_at_once() -> None:
    assert problems(MANY) == [
        "2:17 parameters.a parameter-circle",
        "2:37 parameters.w unknown-unit",
        "2:44 parameters.t reserved-name",
        "3:10 gravity wrong-length",
        "6:5 bodies.upper.masss unknown-key",
        "7:11 bodies.upper.mass dimension",
        "8:20 bodies.upper.center.2 not-computable",
        "11:46 bodies.low.inertia inertia-not-physical",
        "12:25 bodies.odd.shapes.0.type unknown-shape-type",
        "12:86 bodies.odd.shapes.1.size wrong-length",
        "12:95 bodies.odd.shapes.2 wrong-kind",
        "14:17 joints.pivot.type unknown-joint-type",
        "14:30 joints.pivot.from unknown-point",
        "14:44 joints.pivot.to unknown-point",
        "15:29 joints.elbow.from unknown-point",
        "15:45 joints.elbow.to unknown-body",
        "16:3 joints.knee missing-key",
        "18:45 forces.push.vector.0 expression-syntax",
        "18:55 forces.push.vector.2 function-arguments",
        "19:32 forces.motor.joint load-joint",
        "20:31 forces.ram.from unknown-body",
        "20:50 forces.ram.valu unknown-key",
        "21:12 analysis.duratio unknown-key",
        "22:1 foo unknown-key",
        "23:18 report.1 unknown-word",
        "24:50 expect.0.peak unknown-word",
        "24:62 expect.1.of expect-path",
        "24:94 expect.2.is unknown-name",
    ]


def test_a_comma_inside_a_list_is_explained() -> None:
    with pytest.raises(SpecError) as caught:
        load("x.yaml", text="heun: 1\nbodies: {}\ngravity: [0, 0, atan2(1, 2)]\n")
    assert "quotes" in (caught.value.problems[1].hint or "")


def test_a_decimal_comma_in_braces_is_explained() -> None:
    with pytest.raises(SpecError) as caught:
        load("x.yaml", text=f"heun: 1\nbodies: {{a: {{{LUMP.replace('1,', '1,5,', 1)}}}}}\n")
    assert [(p.code, "point" in (p.hint or "")) for p in caught.value.problems] == [("unknown-key", True)]


def test_what_follows_from_an_error_is_not_told() -> None:
    assert problems(f"""\
heun: 1
parameters: {{L: 1 xyz}}
bodies: {{a: {{{LUMP}, position: [L, 0, 2*L], points: {{p: [0, 0, 0]}}}}}}
tables: {{f: {{x: [1, 0], y: [0, 1]}}}}
forces: {{push: {{type: force, on: a.p, vector: ["table(f, t)", L, 0]}}}}
impulses: {{blow: {{on: a.p, vector: [0, 0, 1], time: 1}}}}
analysis: {{duration: 2, sampels: 5}}
expect: [{{of: time, at: 1, is: 1}}]
""") == [
        "2:17 parameters.L unknown-unit",
        "4:21 tables.f.x.1 table-shape",
        "7:25 analysis.sampels unknown-key",
    ]


LUMP = "mass: 1, center: [0, 0, 0], inertia: [1, 1, 1]"
BAR = "shapes: [{type: rod, from: [0, 0, 0], to: [2, 0, 0], mass: 1}]"
TOP = f"""\
heun: 1
ground: {{points: {{O: [0, 0, 0]}}}}
bodies:
  a: {{{LUMP}, points: {{p: [0, 0, 0], q: [1, 0, 0]}}}}
  bar: {{{BAR}, points: {{p: [0, 0, 0], q: [2, 0, 0]}}}}
joints:
  shaft: {{type: pin, from: ground.O, to: a.p, axis: [0, 0, 1]}}
  guide: {{type: slide, from: ground.O, to: bar.p, axis: [1, 0, 0]}}
  socket: {{type: ball, from: a.q, to: bar.q}}
  collar: {{type: cylinder, from: a.q, to: bar.p, axis: [1, 0, 0]}}
  stay: {{type: rod, from: ground.O, to: bar.q}}
"""


@pytest.mark.parametrize(("text", "expected"), [
    # bodies
    ("bodies.c: {}", "bodies.c mass-or-shapes"),
    ("bodies.c: {mass: 1, center: [0, 0, 0]}", "bodies.c mass-or-shapes"),
    (f"bodies.c: {{{LUMP}, {BAR}}}", "bodies.c.mass mass-or-shapes"),
    (f"bodies.c: {{{BAR}, deviation: [0, 0, 0]}}", "bodies.c.deviation mass-or-shapes"),
    ("bodies.c: {shapes: []}", "bodies.c.shapes mass-or-shapes"),
    ("bodies.c: {shapes: 5}", "bodies.c.shapes wrong-kind"),
    ("bodies.c: {shapes: [{type: mesh, file: a.stl, mass: 1}]}", "bodies.c.shapes.0.file mesh-file"),
    ("bodies.c: {shapes: [{type: mesh, mass: 1}]}", "bodies.c.shapes.0 missing-key"),
    (
        "bodies.c: {shapes: [{type: mesh, file: a.stl}]}",
        "bodies.c.shapes.0 shape-form, bodies.c.shapes.0.file mesh-file",
    ),
    ("bodies.c: {shapes: [{type: stl, file: a.stl}]}", "bodies.c.shapes.0.type unknown-shape-type"),
    ("bodies.c: {shapes: [{from: [0, 0, 0]}]}", "bodies.c.shapes.0 missing-key"),
    ("bodies.c: {shapes: [{type: rod, from: [0, 0, 0], to: [0, 0, 0], mass: 1}]}", "bodies.c.shapes.0.to shape-form"),
    ("bodies.c: {shapes: [{type: rod, from: [0, 0, 0], to: [1, 0, 0]}]}", "bodies.c.shapes.0 shape-form"),
    ("bodies.c: {shapes: [{type: rod, from: [0, 0, 0], to: [1, 0, 0], density: 1}]}",
     "bodies.c.shapes.0.density unknown-key"),
    ("bodies.c: {shapes: [{type: cylinder, from: [0, 0, 0], to: [1, 0, 0], mass: 1, radius: 1, inner_radius: 1}]}",
     "bodies.c.shapes.0.inner_radius shape-form"),
    ("bodies.c: {shapes: [{type: cone, from: [0, 0, 0], to: [1, 0, 0], mass: 1, radius: 0, to_radius: 0}]}",
     "bodies.c.shapes.0.radius not-positive"),
    ("bodies.c: {shapes: [{type: cone, from: [0, 0, 0], to: [1, 0, 0], mass: 1, radius: 0, to_radius: 1}]}", ""),
    ("bodies.c: {shapes: [{type: box, center: [0, 0, 0], size: [1, 0, 1], mass: 1}]}",
     "bodies.c.shapes.0.size not-positive"),
    ("bodies.c: {shapes: [{type: sphere, center: [0, 0, 0], radius: -1, density: 0}]}",
     "bodies.c.shapes.0.density not-positive, bodies.c.shapes.0.radius not-positive"),
    ("bodies.c: {shapes: [{type: point, at: [0, 0, 0], mass: 0}]}", "bodies.c.shapes.0.mass not-positive"),
    ("bodies.c: {shapes: [{type: box, center: [0, 0, 0], size: [1, 1, 1], mass: 1, orientation: {angle: 1}}]}",
     "bodies.c.shapes.0.orientation orientation"),
    ("bodies.c: {mass: -1, center: [0, 0, 0], inertia: [1, 1, 1]}", "bodies.c.mass not-positive"),
    ("bodies.c: {mass: 0, center: [0, 0, 0], inertia: [1, 1, 1]}", "bodies.c.inertia inertia-not-physical"),
    ("bodies.c: {mass: 1, center: [0, 0, 0], inertia: [-1, 1, 1]}", "bodies.c.inertia inertia-not-physical"),
    ("bodies.c: {mass: 1, center: [0, 0, 0], inertia: [0, 0, 1]}", "bodies.c.inertia inertia-not-physical"),
    ("bodies.c: {mass: 1, center: [0, 0, 0], inertia: [1, 1, 1], deviation: [0, 0, 2]}",
     "bodies.c.inertia inertia-not-physical"),
    ("bodies.c: {mass: 1, center: [0, 0, 0], inertia: [0, 1, 1]}", ""),
    ("bodies.c: {mass: 1, center: [0, 0, 0], inertia: [0, 0, 0]}", ""),
    ("bodies.c: {mass: 1, center: [0, 0, 0], inertia: 1}", "bodies.c.inertia inertia-form"),
    ("bodies.c: {mass: 1, center: [0, 0, 0], inertia: [1, 1]}", "bodies.c.inertia wrong-length"),
    ("bodies.c: {mass: 1, center: [0, 0, 0], inertia: [[1, 0, 0], [0, 1], [0, 0, 1]]}",
     "bodies.c.inertia.1 wrong-length"),
    ("bodies.c: {mass: 1, center: [0, 0, 0], inertia: {a: 1}}", "bodies.c.inertia wrong-kind"),
    ("bodies.c: {mass: 1, center: [0, 0, 0], inertia: [[1, 1, 0], [0, 1, 0], [0, 0, 1]]}",
     "bodies.c.inertia inertia-form"),
    ("bodies.c: {mass: 1, center: [0, 0, 0], inertia: [[1, 0, 0], [0, 1, 0], [0, 0, 1]], deviation: [0, 0, 0]}",
     "bodies.c.deviation inertia-form"),
    (f"bodies.c: {{{LUMP}, near: {{orientation: {{axis: [1, 0, 0]}}}}}}", "bodies.c.near.orientation orientation"),
    (f"bodies.c: {{{LUMP}, points: {{1a: [0, 0, 0]}}}}", "bodies.c.points.1a bad-name"),
    (f"bodies.c: {{{LUMP}, velocity: 5}}", "bodies.c.velocity wrong-kind"),
    (f"bodies.c: {{{LUMP}, velocity: {{vector: [1, 2, 3], frame: local}}}}", "bodies.c.velocity.frame unknown-word"),
    (f"bodies.c: {{{LUMP}, velocity: {{frame: body}}}}", "bodies.c.velocity missing-key"),
    (f"bodies.ground: {{{LUMP}}}", "bodies.ground reserved-name"),
    (f"bodies._c: {{{LUMP}}}", "bodies._c bad-name"),
    ("bodies.c: 5", "bodies.c wrong-kind"),
    # joints
    ("joints.j: {type: ball, from: a.p, to: a.q}", "joints.j.to same-body"),
    ("joints.j: {type: ball, from: ground.O, to: {body: ground, at: [1, 0, 0]}}", "joints.j.to same-body"),
    ("joints.j: {type: ball, from: ground.P, to: c.q}", "joints.j.from unknown-point, joints.j.to unknown-body"),
    ("joints.j: {type: ball, from: ground.O, to: {body: a}}", "joints.j.to unknown-point"),
    ("joints.j: {type: ball, from: ground.O, to: {at: [0, 0, 0]}}", "joints.j.to missing-key"),
    ("joints.j: {type: ball, from: ground.O, to: {body: a, at: [0, 0]}}", "joints.j.to.at wrong-length"),
    ("joints.j: {type: ball, from: ground.O, to: 5}", "joints.j.to wrong-kind"),
    ("joints.j: {type: ball, from: ground.O.x, to: .q}", "joints.j.from end, joints.j.to end"),
    ("joints.j: {type: ball, from: ground.O, to: a.p, axis: [0, 0, 1]}", "joints.j.axis unknown-key"),
    ("joints.j: {type: 5, from: ground.O, to: a.p}", "joints.j.type wrong-kind"),
    ("joints.j: {type: weld, from: ground.O, to: a.p, stiffness: 0}", "joints.j.stiffness not-positive"),
    ("joints.j: {type: weld, from: ground.O, to: a.p, stiffness: {force: [1, -1, 1]}}",
     "joints.j.stiffness not-positive"),
    ("joints.j: {type: weld, from: ground.O, to: a.p, stiffness: {force: [1, 0, 1], moment: 0}}", ""),
    ("joints.j: {type: weld, from: ground.O, to: a.p, stiffness: [1, 1, 1]}", "joints.j.stiffness wrong-kind"),
    ("joints.j: {type: weld, from: ground.O, to: a.p, stiffness: 1 N*m}", "joints.j.stiffness dimension"),
    ("joints.j: {type: rod, from: ground.O, to: a.p, length: 0}", "joints.j.length not-positive"),
    ("joints.j: {type: rod, from: ground.O, to: a.p, tension_only: 1}", "joints.j.tension_only wrong-kind"),
    ("joints.j: {type: universal, from: ground.O, to: a.p, axis: [0, 0, 1]}", "joints.j missing-key"),
    ("joints.j: {type: pin, from: ground.O, to: a.p, axis: [0, 0, 1], initial: {travel: 1}}",
     "joints.j.initial.travel unknown-key"),
    ("joints.sin: {type: ball, from: ground.O, to: a.p}", "joints.sin reserved-name"),
    # drives
    ("drives.d: {joint: shaft}", "drives.d drive-form"),
    ("drives.d: {joint: shaft, angle: 1, travel: 1}", "drives.d drive-form"),
    ("drives.d: {joint: shaft, length: 1}", "drives.d.length drive-form"),
    ("drives.d: {joint: socket, angle: 1}", "drives.d.angle drive-form"),
    ("drives.d: {joint: stay, length: '1 + t'}", ""),
    ("drives.d: {joint: stay, length: 1, zero: assembled}", "drives.d.zero drive-form"),
    ("drives.d: {joint: collar, travel: 1}", ""),
    ("drives.d: {joint: nobody, angle: 1}", "drives.d.joint unknown-joint"),
    ("drives.d: {joint: shaft, angle: guide.travel}", "drives.d.angle drive-form"),
    ("drives: {d: {joint: shaft, angle: 1}, e: {joint: shaft, angle: 2}}", "drives.e.joint drive-form"),
    ("drives.d: {joint: shaft, angle: log(t)}", "drives.d.angle drive-jumps"),
    ("drives.d: {joint: shaft, angle: sqrt(t - 1)}", "drives.d.angle drive-jumps"),
    ("drives.d: {joint: shaft, angle: 1 m}", "drives.d.angle dimension"),
    # forces
    ("forces.f: {type: force, on: ground.O, vector: [0, 0, 1]}", "forces.f.on ground-cannot"),
    ("forces.f: {type: couple, on: ground, vector: [0, 0, 1]}", "forces.f.on ground-cannot"),
    ("forces.f: {type: couple, on: c, vector: [0, 0, 1]}", "forces.f.on unknown-body"),
    ("forces.f: {type: force, on: a, vector: [0, 0, 1]}", "forces.f.on end"),
    ("forces.f: {type: force, on: a.p, vector: [0, 0, 1 m]}", "forces.f.vector.2 dimension"),
    ("forces.f: {type: force, on: a.p, vector: '5*t'}", "forces.f.vector wrong-kind"),
    ("forces.gravity: {type: force, on: a.p, vector: [0, 0, 1]}", "forces.gravity reserved-name"),
    ("forces.f: {type: torque, joint: shaft, value: 1 N}", "forces.f.value dimension"),
    ("forces.f: {type: torque, joint: guide, value: 1 N}", ""),
    ("forces.f: {type: torque, joint: guide, value: 1 N*m}", "forces.f.value dimension"),
    ("forces.f: {type: torque, joint: collar, value: 1}", "forces.f.joint load-joint"),
    ("forces.f: {type: damper, joint: stay, coefficient: 1}", "forces.f.joint load-joint"),
    ("forces.f: {type: damper, joint: socket, coefficient: 1 N*s/m}", "forces.f.coefficient dimension"),
    ("forces.f: {type: damper, joint: guide, coefficient: 1 N*m*s}", "forces.f.coefficient dimension"),
    ("forces.f: {type: damper, joint: guide, coefficient: t}", "forces.f.coefficient not-in-time"),
    ("forces.f: {type: damper, joint: shaft, coefficient: 1, sliding: 1}", "forces.f.sliding load-joint"),
    ("forces.f: {type: damper, joint: collar, sliding: 1}", ""),
    ("forces.f: {type: damper, joint: collar}", "forces.f load-joint"),
    ("forces.f: {type: damper, joint: shaft}", "forces.f load-joint"),
    ("forces.f: {type: damper, joint: shaft, sliding: 1}", "forces.f.sliding load-joint"),
    ("forces.f: {type: damper, joint: collar, coefficient: 1, sliding: -1}", "forces.f.sliding negative"),
    ("forces.f: {type: friction, joint: shaft, force: 1, speed: 1}", "forces.f.force load-joint"),
    ("forces.f: {type: friction, joint: shaft, speed: 1}", "forces.f load-joint"),
    ("forces.f: {type: friction, joint: collar, force: 1, speed: 1 mm/s}", ""),
    ("forces.f: {type: friction, joint: collar, force: 1, speed: 1 rpm}", "forces.f.speed dimension"),
    ("forces.f: {type: friction, joint: socket, torque: 1, speed: 1}", "forces.f.joint load-joint"),
    ("forces.f: {type: friction, joint: shaft, torque: 1, speed: 0}", "forces.f.speed not-positive"),
    ("forces.f: {type: spring, from: a.p, to: a.q, stiffness: 1, length: 1}", ""),
    ("forces.f: {type: spring, from: a.p, to: {body: a, at: [0, 0, 0]}, stiffness: 1, length: 1}",
     "forces.f.to same-point"),
    ("forces.f: {type: actuator, from: a.q, to: a.q, value: 1}", "forces.f.to same-point"),
    ("forces.f: {type: actuator, from: ground.O, to: {body: ground, at: [1, 0, 0]}, value: 1}",
     "forces.f.to same-point"),
    ("forces.f: {type: spring, from: a.p, to: bar.q, stiffness: -1, length: -1, damping: -1}",
     "forces.f.damping negative, forces.f.length negative, forces.f.stiffness negative"),
    ("forces.f: {type: spring, from: ground.O, to: bar.q, stiffness: 1}", "forces.f missing-key"),
    # impulses
    ("impulses.i: {on: a.p}", "impulses.i impulse-form"),
    ("impulses.i: {on: a.p, vector: [1, 0, 0], body: a}", "impulses.i impulse-form"),
    ("impulses.i: {body: a, vector: [1, 0, 0]}", "impulses.i impulse-form"),
    ("impulses.i: {body: ground, couple: [1, 0, 0]}", "impulses.i.body ground-cannot"),
    ("impulses.i: {body: c, couple: [1, 0, 0]}", "impulses.i.body unknown-body"),
    ("impulses.i: {on: a.p, vector: [1, 0, 0], time: 1}", "impulses.i.time impulse-time"),
    ("impulses.i: {on: a.p, vector: [1, 0, 0], time: -1}", "impulses.i.time impulse-time"),
    ("impulses.i: {on: a.x, vector: [1, 0]}", "impulses.i.on unknown-point, impulses.i.vector wrong-length"),
    ("impulses.i: {on: a.p, vector: [1, 0, 0], restitution: 0.5}", "impulses.i.restitution unknown-key"),
    ("impulses.i: {on: a, vector: [1, 0, 0]}", "impulses.i.on unknown-point"),
    ("impulses.i: {on: ground.O, vector: [1, 0, 0]}", "impulses.i.on ground-cannot"),
    ("impulses.i: {on: a, couple: [1, 0, 0]}", ""),
    ("impulses.i: {on: a.p, couple: [1, 0, 0]}", ""),
    ("impulses.i: {on: a.p, couple: [1, 0, 0], vector: [1, 0, 0]}", "impulses.i impulse-form"),
    ("impulses.i: {on: a.p, couple: [1, 0, 0], body: a}", "impulses.i impulse-form"),
    ("impulses.i: {on: a.p, vector: [1 N, 0, 0]}", "impulses.i.vector.0 dimension"),
    ("impulses.motion: {on: a.p, vector: [1, 0, 0]}", "impulses.motion reserved-name"),
    # stops
    ("stops.s: {joint: shaft, angle: [-1, 1]}", ""),
    ("stops.s: {joint: shaft, angle: [-90 deg, null], restitution: 1}", ""),
    ("stops.s: {joint: shaft}", "stops.s stop-form"),
    ("stops.s: {joint: shaft, angle: [-1, 1], travel: [0, 1]}", "stops.s stop-form"),
    ("stops.s: {joint: shaft, travel: [0, 1]}", "stops.s.travel stop-form"),
    ("stops.s: {joint: shaft, angle: [1, -1]}", "stops.s.angle stop-form"),
    ("stops.s: {joint: shaft, angle: [1, 1]}", "stops.s.angle stop-form"),
    ("stops.s: {joint: shaft, angle: [null, null]}", "stops.s.angle stop-form"),
    ("stops.s: {joint: shaft, angle: 1}", "stops.s.angle wrong-kind"),
    ("stops.s: {joint: shaft, angle: [1]}", "stops.s.angle wrong-kind"),
    ("stops.s: {joint: shaft, angle: [0, 1 m]}", "stops.s.angle.1 dimension"),
    ("stops.s: {joint: socket, angle: [0, 1]}", "stops.s.angle stop-form"),
    ("stops.s: {joint: shft, angle: [0, 1]}", "stops.s.joint unknown-joint"),
    ("stops.s: {joint: shaft, angle: [0, 1], restitution: 1.5}", "stops.s.restitution restitution"),
    ("stops.s: {joint: shaft, angle: [0, 1], restitution: -0.5}", "stops.s.restitution restitution"),
    ("stops.s: {joint: shaft, angle: [0, 1], stiffness: 5}", "stops.s.stiffness unknown-key"),
    ("stops.shaft: {joint: shaft, angle: [0, 1]}", "stops.shaft shared-name"),
    ("stops.gravity: {joint: shaft, angle: [0, 1]}", "stops.gravity reserved-name"),
    ("stops: {s: {joint: shaft, angle: [0, 1]}, r: {joint: shaft, angle: [null, 2]}}", "stops.r.angle.1 stop-joint"),
    ("stops: {s: {joint: shaft, angle: [0, null]}, r: {joint: shaft, angle: [null, 2]}}", ""),
    ("bumpers: {s: {joint: shaft, angle: [0, null]}}", "bumpers unknown-key"),
    ("latches.l: {stop: s}", "latches.l.stop unknown-stop"),
    ("latches.l: {}", "latches.l latch-form"),
    ("latches.l: {joint: shaft, limit: upper}", "latches.l.limit latch-form"),
    ("latches.l: {joint: shaft, travel: 1}", "latches.l.travel latch-form"),
    ("latches.l: {joint: socket}", "latches.l.joint latch-form"),
    ("latches.l: {joint: shft}", "latches.l.joint unknown-joint"),
    ("latches.l: {joint: shaft, every: true}", "latches.l.every latch-form"),
    ("latches.l: {joint: shaft, when: 5}", "latches.l.when condition"),
    ("latches.shaft: {joint: shaft}", "latches.shaft shared-name"),
    ("latches.gravity: {joint: shaft}", "latches.gravity reserved-name"),
    ("latches: {l: {joint: shaft, angle: 1}, r: {joint: shaft, angle: 1}}", "latches.r.joint latch-joint"),
    ("latches: {l: {joint: shaft, angle: 1}, r: {joint: shaft, angle: 2}}", ""),
    ("latches: {l: {joint: shaft}, r: {joint: shaft}}", ""),
    # sections
    ("sections.s: {body: bar}", "sections.s section-form"),
    ("sections.s: {body: bar, at: [1, 0, 0], normal: [1, 0, 0], count: 3}", "sections.s section-form"),
    ("sections.s: {body: bar, from: p, to: q}", "sections.s section-form"),
    ("sections.s: {body: bar, from: p, to: q, count: 1}", "sections.s.count section-form"),
    ("sections.s: {body: bar, from: p, to: q, count: 2.5}", "sections.s.count wrong-kind"),
    ("sections.s: {body: bar, from: p, to: [0, 0, 0], count: 2}", "sections.s.to section-form"),
    ("sections.s: {body: bar, from: p, to: q, count: 2, side: before}", "sections.s.side section-form"),
    ("sections.s: {body: bar, from: p, to: x, count: 2}", "sections.s.to unknown-point"),
    ("sections.s: {body: bar, at: x, normal: [1, 0, 0]}", "sections.s.at unknown-point"),
    ("sections.s: {body: c, at: x, normal: [1, 0, 0]}", "sections.s.body unknown-body"),
    ("sections.s: {body: ground, at: O, normal: [1, 0, 0]}", "sections.s.body ground-cannot"),
    ("sections.s: {body: bar, at: p, normal: [0, 0, 0]}", "sections.s.normal zero-direction"),
    ("sections.s: {body: bar, at: p, normal: [1, 0, 0], first_axis: [-3, 0, 0]}", "sections.s.first_axis first-axis"),
    ("sections.s: {body: bar, from: p, to: q, count: 3, first_axis: [1, 0, 0]}", "sections.s.first_axis first-axis"),
    ("sections.s: {body: bar, at: p, normal: [1, 0, 0], reduce_to: centre}", "sections.s.reduce_to section-form"),
    ("sections.s: {body: bar, at: p, normal: [1, 0, 0], reduce_to: bar.x}", "sections.s.reduce_to unknown-point"),
    ("sections.s: {body: bar, at: p, normal: [1, 0, 0], properties: {}}", "sections.s.properties properties-form"),
    ("sections.s: {body: bar, at: p, normal: [1, 0, 0], properties: {area: 1}}",
     "sections.s.properties properties-form"),
    ("sections.s: {body: bar, at: p, normal: [1, 0, 0], properties: {circle: {radius: 1}, area: 1}}",
     "sections.s.properties properties-form"),
    ("sections.s: {body: bar, at: p, normal: [1, 0, 0], properties: {circle: {radius: 0}}}",
     "sections.s.properties.circle.radius not-positive"),
    ("sections.s: {body: bar, at: p, normal: [1, 0, 0], strength: 1}", "sections.s.strength properties-form"),
    ("sections.s: {body: bar, at: p, normal: [1, 0, 0], piece: {mass: 1, center: [0, 0, 0], inertia: [0, 0, 0]}}",
     "sections.s.piece piece-form"),
    ("sections.s: {body: a, at: p, normal: [1, 0, 0]}", "sections.s.body section-matter"),
    ("sections.s: {body: a, at: p, normal: [1, 0, 0], piece: {mass: 1, center: [0, 0, 0], inertia: [0, 0, 0]}}", ""),
    ("sections.s: {body: a, from: p, to: q, count: 3}", "sections.s.body section-matter"),
    # couplings
    ("couplings.g: {type: gear, of: [shaft, shaft], at: {body: a}}",
     "couplings.g.at unknown-point, couplings.g.of.1 coupled-joint"),
    ("couplings.g: {type: gear, of: [shaft, shaft], at: x.p}",
     "couplings.g.at unknown-body, couplings.g.of.1 coupled-joint"),
    ("couplings.g: {type: gear, of: [shaft, shaft], at: a.none}",
     "couplings.g.at unknown-point, couplings.g.of.1 coupled-joint"),
    ("couplings.r: {type: rope, through: [ground.O, a.q], length: 1 + shaft.angle}", "couplings.r.length rope-bounds"),
    ("couplings.r: {type: rope, through: [ground.O, a.q], length: sqrt(t - 1)}", "couplings.r.length drive-jumps"),
    # the rest
    ("analysis: {duration: 0}", "analysis.duration not-positive"),
    ("analysis: {duration: 1, samples: 1}", "analysis.samples times"),
    ("analysis: {duration: 1, samples: 1e12}", "analysis.samples times"),
    ("analysis: {samples: 3}", "analysis.samples times"),
    ("analysis: {duration: 1, times: [0, 1]}", "analysis.duration times"),
    ("analysis: {times: []}", "analysis.times times"),
    ("analysis: {times: [0]}", "analysis.times times"),
    ("analysis: {times: [-1, 0, 0]}", "analysis.times.0 times, analysis.times.2 times"),
    ("analysis: {type: motion}", "analysis.type analysis-type"),
    ("analysis: {type: state, duration: 1}", "analysis.type analysis-type"),
    ("analysis: {type: impulse}", "analysis.type analysis-type"),
    ("analysis: {duration: 1, tolerance: 0}", "analysis.tolerance tolerance"),
    ("analysis: {duration: 1, step: 0}", "analysis.step not-positive"),
    ("analysis: {duration: 1 m}", "analysis.duration dimension"),
    ("analysis: 5", "analysis wrong-kind"),
    ("foundation: {about: Q}", "foundation.about unknown-point"),
    ("foundation: {about: a.p}", "foundation.about ground-cannot"),
    ("foundation: {about: [0, 0]}", "foundation.about wrong-length"),
    ("title: 5", "title wrong-kind"),
    ("heun: true", "heun version"),
    ("heun: '1'", "heun version"),
    ("heun:", "heun version"),
    ("space: flat", "space unknown-word"),
    ("report: motion", "report wrong-kind"),
    ("gravity: 9.81", "gravity wrong-kind"),
    ("parameters: [1]", "parameters wrong-kind"),
    ("parameters: {sin: 1}", "parameters.sin reserved-name"),
    ("parameters: {a b: 1}", "parameters.a b bad-name"),
    ("drives: [1]", "drives wrong-kind"),
    ("tables: 5", "tables wrong-kind"),
    ("expect: {of: a, is: 1}", "expect wrong-kind"),
    ("expect: [{of: time}]", "expect.0 missing-key"),
    ("expect: [{of: time, is: 1, at: 0, peak: max}]", "expect.0.peak expect-form"),
    ("expect: [{of: model.freedoms, peak: max, is: 1}]", "expect.0.peak expect-form"),
    ("expect: [{of: accuracy.horizon, peak: max, is: 1}]", "expect.0.peak expect-form"),
    ("expect: [{of: accuracy.estimate, below: 1}]", "expect.0.of expect-path"),
    ("expect: [{of: work.steps, at: 0, below: 9}]", "expect.0.at expect-form"),
    ("expect: [{of: joints.shaft.open, is: null}]", "expect.0.of expect-path"),
    ("expect: [{of: joints.shaft.open.0, peak: max, is: 1}]", "expect.0.of expect-path"),
    ("expect: [{of: status.code, is: 1}]", "expect.0.of expect-path"),
    ("expect: [{of: foundation.force.99.x, is: 0}]", "expect.0.of expect-instants"),
    ("expect: [{of: foundation.force.-1.x, is: 0}]", "expect.0.of expect-path"),
    ("expect: [{of: foundation.force.x.0, is: 0}]", "expect.0.of expect-path"),
    (f"expect: [{{of: time.{'1' * 5000}, is: 0}}]", "expect.0.of expect-path"),
    (f"expect: [{{of: impulses.{'1' * 5000}.time, is: 0}}]", "expect.0.of expect-path"),
    ("expect: [{of: bodies.a.quaternion, peak: max, is: 1}]", "expect.0.of expect-form"),
    ("expect: [{of: bodies.a.rotation, peak: max, is: 1}]", "expect.0.of expect-form"),
    ("expect: [{of: joints.shaft.force, peak: abs, is: 1, rel: 1}]", "expect.0.rel expect-form"),
    ("expect: [{of: joints.shaft.force, peak: abs, is: 1, rel: nan}]", "expect.0.rel not-finite"),
    ("expect: [{of: time, is: 1, at: 5}]", "expect.0.at expect-instants"),
    ("expect: [{of: time, is: 1, at: [0, 1]}]", "expect.0.at wrong-kind"),
    ("expect: [{of: joints.shaft.force.w, is: 1}]", "expect.0.of expect-path"),
    ("expect: [{of: joints.shaft.force.3, is: 1}]", "expect.0.of expect-path"),
    ("expect: [{of: joints.shaft.force.x.x.x, is: 1}]", "expect.0.of expect-path"),
    ("expect: [{of: joints.shaft.axial.x, is: 1}]", "expect.0.of expect-path"),
    ("expect: [{of: joints.shaft, is: 1}]", "expect.0.of expect-path"),
    ("expect: [{of: foundation.axis.pich, is: 1}]", "expect.0.of expect-path"),
    ("expect: [{of: joints.shaft.force.0.x, is: 1}, {of: bodies.a.rotation.2.2, is: 1}]", ""),
    ("expect: [{of: joints.shaft.force.z, is: 15 kg}]", "expect.0.is expect-form"),
    ("expect: [{of: joints.shaft.force.z, is: 15 N, abs: 1 mN}]", ""),
    ("expect: [{of: joints.shaft.force.z, is: 15 N, abs: 1 mm}]", "expect.0.abs expect-form"),
    ("expect: [{of: joints.shaft.force, is: [15 N, 0, 1 m]}]", "expect.0.is.2 expect-form"),
    ("expect: [{of: joints.shaft.drive, is: 15 N}, {of: joints.shaft.drive, is: 15 N*m}]", ""),
    ("expect: [{of: joints.shaft.drive, is: 15 m}]", "expect.0.is expect-form"),
    ("expect: [{of: certain_sums.0.value, is: 15 kg}]", "expect.0.is expect-form"),
    ("expect: [{of: joints.shaft.force, is: [1, 2]}]", "expect.0.is expect-instants"),
    ("expect: [{of: joints.shaft.force, is: 1}]", "expect.0.is expect-instants"),
    ("expect: [{of: joints.shaft.force.z, is: [1]}]", "expect.0.is expect-instants"),
    ("expect: [{of: joints.shaft.force, is: [1, 2, 3]}, {of: joints.shaft.force, is: null}]", ""),
    ("expect: [{of: joints.shaft.force, is: 1, peak: max}]", ""),
    ("expect: [{of: joints.shaft.force, is: [1, 2, 3], peak: max}]", "expect.0.is expect-instants"),
    ("expect: [{of: bodies.a.rotation, is: [[1, 0, 0], [0, 1]]}]", "expect.0.is expect-form"),
    ("expect: [{of: bodies.a.rotation, is: [[1, 0, 0], [0, 1, 0], [0, 0, 1]]}]", ""),
    ("expect: [{of: foundation.about, is: 1, peak: max}]", "expect.0.peak expect-form"),
    ("expect: [{of: time, is: 1, rel: -1}]", "expect.0.rel negative"),
    ("expect: [{of: joints.shaft.force.z, below: 15 N}, {of: joints.shaft.force, above: 0, at: 0}]", ""),
    ("expect: [{of: joints.shaft.force.z, below: 2, above: 1, peak: abs}]", ""),
    ("expect: [{of: joints.shaft.force.z, below: 15 kg}]", "expect.0.below expect-form"),
    ("expect: [{of: joints.shaft.force.z, below: 15, is: 3}]", "expect.0.is expect-form"),
    ("expect: [{of: joints.shaft.force.z, below: 15, is: null}]", "expect.0.is expect-form"),
    ("expect: [{of: joints.shaft.force.z, above: 15, rel: 1e-3}]", "expect.0.rel expect-form"),
    ("expect: [{of: joints.shaft.force.z, above: 15, below: 15}]", "expect.0.above expect-form"),
    ("expect: [{of: joints.shaft.force.z, above: [1, 2]}]", "expect.0.above wrong-kind"),
    ("expect: [{of: bodies.a.rotation, below: 2}]", "expect.0.of expect-form"),
    ("expect: [{of: bodies.a.rotation.0, below: 2}]", ""),
    ("expect: [{of: foundation.about, below: 1, peak: max}]", "expect.0.peak expect-form"),
    ("expect: [{of: coordinates.stay.angle, is: 1}]", "expect.0.of expect-path"),
    ("expect: [{of: bodies.c.position, is: 1}]", "expect.0.of expect-path"),
    ("expect: [{of: joints.shaft.forse, is: 1}]", "expect.0.of expect-path"),
    ("expect: [{of: points.a.r.position, is: 1}]", "expect.0.of expect-path"),
    ("expect: [{of: foundation.supports.shft.force, is: 1}]", "expect.0.of expect-path"),
    ("expect: [{of: foundation.supports.shaft.force.x, is: 1}, {of: impulses.0.energy_jump, is: 1}]", ""),
])  # fmt: skip
def test_rules(text: str, expected: str) -> None:
    assert ", ".join(sorted(line.partition(" ")[2] for line in found_in(text))) == expected


def found_in(text: str) -> list[str]:
    """The problems of the scene with one entry ("block.name: value") or one block ("block: value") more."""
    key, _, value = text.partition(": ")
    block, dot, name = key.partition(".")
    lines = TOP.splitlines()
    if key in ("heun", "heun:"):
        lines[0] = text
    elif not dot:
        lines.append(text)
    elif f"{block}:" in lines:
        lines.insert(lines.index(f"{block}:") + 1, f"  {name}: {value}")
    else:
        lines += [f"{block}:", f"  {name}: {value}"]
    try:
        assert isinstance(load("x.yaml", text="\n".join(lines)), Spec)
    except SpecError as error:
        assert [str(p) for p in error.problems if not p.hint] == []
        return [f"{p.location.line} {p.location.path} {p.code}" for p in error.problems if p.location]
    return []


def test_instants_that_are_expected() -> None:
    """A motion has a list over its instants where neither one of them nor a peak is named."""
    one = "of: joints.pivot.force.z"
    for item, expected in (
        (f"{one}, is: 1", ["expect-instants"]),
        (f"{one}, is: [1, 2]", ["expect-instants"]),
        (f"{one}, is: [1, 2, 3]", []),
        (f"{one}, at: 0.5, is: 1", []),
        (f"{one}, at: 0.5, is: [1, 2, 3]", ["expect-instants"]),
        (f"{one}, peak: max, is: 1", []),
        ("of: joints.pivot.force.0.z, is: 1", []),
        ("of: joints.pivot.force, at: 0.5, is: [1, 2, 3]", []),
        ("of: sections.along.N, at: 0.5, is: [1, 2, 3, 4]", []),
        ("of: sections.along.N.0, at: 0.5, is: 1", []),
        ("of: sections.along.N, at: 0.5, is: 1", ["expect-instants"]),
        ("of: sections.along.s, is: [0, 1, 2]", []),
        ("of: sections.along.force.0, at: 0.5, is: [0, 1, 2]", []),
        ("of: sections.along.force.0.w, at: 0.5, is: 1", ["expect-path"]),
        ("of: sections.along.normal, at: 0.5, is: [1, 0, 0]", []),
        ("of: foundation.elements.motor.moment.z, at: 0.5, is: 1", []),
        (f"{one}, at: 0.3, is: 1", ["expect-instants"]),
    ):
        text = f"""\
heun: 1
ground: {{points: {{O: [0, 0, 0]}}}}
bodies: {{bar: {{{BAR}, points: {{p: [0, 0, 0], q: [2, 0, 0]}}}}}}
joints: {{pivot: {{type: pin, from: ground.O, to: bar.p, axis: [0, 0, 1]}}}}
drives: {{motor: {{joint: pivot, angle: t}}}}
sections: {{along: {{body: bar, from: p, to: q, count: 3}}}}
analysis: {{duration: 1, samples: 3}}
expect: [{{{item}}}]
"""
        try:
            found = [] if load("x.yaml", text=text) else None
        except SpecError as error:
            found = [p.code for p in error.problems]
            assert all(p.hint for p in error.problems)
        assert found == expected, item


def test_expectations_need_not_fit_where_they_are_not_used() -> None:
    text = "\n".join([*TOP.splitlines(), "analysis: {duration: 1, samples: 3}", "expect: [EXPECT]"])
    at = text.replace("EXPECT", "{of: energy.kinetic, at: 0.5, is: 0}")
    shorter = {"analysis.duration": "0.6"}
    assert load("x.yaml", text=at, overrides=shorter, checking=False).analysis.duration == 0.6
    with pytest.raises(SpecError):
        load("x.yaml", text=at, overrides=shorter)
    with pytest.raises(SpecError):  # what is no expectation at all is an error for everybody
        load("x.yaml", text=text.replace("EXPECT", "{of: energy.kinetik, at: 0.5, is: 0}"), checking=False)


def test_points_under_a_misspelt_key_are_points() -> None:
    text = TOP.replace("points: {p: [0, 0, 0], q: [1", "point: {p: [0, 0, 0], q: [1")
    text = text.replace("ground: {points", "ground: {pionts")
    section = "sections: {s: {body: bar, at: p, normal: [1, 0, 0]}, r: {body: a, at: x, normal: [1, 0, 0]}}"
    assert [line.partition(" ")[2] for line in problems(f"{text}{section}\n")] == [
        "ground.pionts unknown-key", "bodies.a.point unknown-key", "sections.r.body section-matter",
        "sections.r.at unknown-point",
    ]  # fmt: skip


def test_an_unread_key_hides_no_other() -> None:
    """A mapping with a wrong key or value is judged without it; what only follows from that is not told."""
    text = """\
heun: 1
title: 5
space: planar
ground: {points: {O: [0, 0, 0]}}
bodies:
  b: {mass: -1, center: [0, 0, 0], inertia: 0.1, color: red, points: {o: [0, 0, 0]}}
  c: {mass: heavy, center: [0, 0, 0], inertia: -0.1}
joints: {A: {type: ball, from: ground.O, to: b.q, stifness: 3}}
analysis: {duration: -1, samples: 0, toleranc: 3}
expect: [{of: joint.A, is: 1, at: 0, abss: 1}]
"""
    assert problems(text) == [
        "2:8 title wrong-kind",
        "6:13 bodies.b.mass not-positive",
        "6:50 bodies.b.color unknown-key",
        "7:13 bodies.c.mass unknown-name",
        "7:48 bodies.c.inertia inertia-not-physical",
        "8:46 joints.A.to unknown-point",
        "8:51 joints.A.stifness unknown-key",
        "9:22 analysis.duration not-positive",
        "9:35 analysis.samples times",
        "9:38 analysis.toleranc unknown-key",
        "10:15 expect.0.of expect-path",
        "10:38 expect.0.abss unknown-key",
    ]


@pytest.mark.parametrize(("text", "code"), [
    ("gravity: [0, -9.81, 1]", "gravity.2 not-planar"),
    (f"bodies: {{c: {{{LUMP}, orientation: {{axis: [1, 0, 0], angle: 1}}}}}}", "bodies.c.orientation not-planar"),
    (f"bodies: {{c: {{{LUMP}, orientation: {{axis: [0, 0, 3], angle: 1}}}}}}", ""),
    ("joints: {j: {type: pin, from: ground.O, to: c.p, axis: [1, 0, 0]}}", "joints.j.axis not-planar"),
    ("joints: {j: {type: pin, from: ground.O, to: c.p, axis: [0, 0, -1]}}", ""),
    ("joints: {j: {type: slide, from: ground.O, to: c.p, axis: [0, 1, 1]}}", "joints.j.axis not-planar"),
    ("joints: {j: {type: plane, from: ground.O, to: c.p, normal: [0, 0, 1]}}", "joints.j.normal not-planar"),
    ("joints: {j: {type: cylinder, from: ground.O, to: c.p, axis: [0, 0, 1]}}", "joints.j.type not-planar"),
    ("joints: {j: {type: ball, from: ground.O, to: c.p}}", ""),
    ("joints: {j: {type: ball, from: ground.O, to: c.p, initial: {angle: 1}}}", ""),
    ("joints: {j: {type: pin, from: ground.O, to: c.p}}", ""),
    (f"bodies: {{c: {{{LUMP}, velocity: [1, 2, 3]}}}}", "bodies.c.velocity.2 not-planar"),
    (f"bodies: {{c: {{{LUMP}, angular_velocity: [0, 1, 3]}}}}", "bodies.c.angular_velocity.1 not-planar"),
    (f"bodies: {{c: {{{LUMP}, angular_velocity: {{vector: [1, 0, 3], frame: body}}}}}}",
     "bodies.c.angular_velocity.vector.0 not-planar"),
    ('forces: {f: {type: force, on: c.p, vector: [1, t, "0*t"]}}', "forces.f.vector.2 not-planar"),
    ("forces: {f: {type: force, on: c.p, vector: [1, t, 0]}}", ""),
    ("forces: {f: {type: couple, on: c, vector: [0, 1, 1]}}", "forces.f.vector.1 not-planar"),
])  # fmt: skip
def test_rules_of_the_plane(text: str, code: str) -> None:
    bodies = "" if text.startswith("bodies") else f"bodies: {{c: {{{LUMP}, points: {{p: [0, 0, 0]}}}}}}\n"
    scene = f"heun: 1\nspace: planar\nground: {{points: {{O: [0, 0, 0]}}}}\n{bodies}{text}\n"
    if code:
        assert [line.partition(" ")[2] for line in problems(scene)] == [code]
    else:
        assert load("x.yaml", text=scene).space == "planar"


def test_what_is_not_yet_solved_is_refused_by_name(monkeypatch: pytest.MonkeyPatch) -> None:
    def where(scene: DraftDocument) -> list[tuple[str | int, ...]]:
        return [("forces", name, "type") for name, load in scene.document.forces.items() if load.type == "damper"]

    monkeypatch.setattr(references, "NOT_YET", (("dampers", where),))
    assert found_in("forces.f: {type: damper, joint: shaft, coefficient: 1}") == ["13 forces.f.type not-yet"]
    assert found_in("forces.f: {type: torque, joint: shaft, value: 1}") == []


def test_rules_have_codes_of_their_own() -> None:
    codes = [rule.code for rule in RULES]
    assert len(codes) == len(set(codes))
    assert all(rule.check.__doc__ for rule in RULES)


SPECS = sorted((ROOT / "specs").glob("*.yaml"))


@pytest.mark.parametrize("path", SPECS, ids=lambda path: path.stem)
@pytest.mark.sixth
def test_no_damage_to_a_spec_gives_anything_but_errors(path: Path) -> None:
    text = path.read_text()
    for seed in range(12):
        damaged = damage(text, random.Random(f"{path.stem} {seed}"))
        try:
            found = load(path, text=damaged)
        except SpecError as error:
            assert error.problems
            lines = damaged.count("\n") + 2
            for problem in error.problems:
                assert problem.location is not None
                assert problem.location.line <= lines or problem.code == "table-file"
        else:
            assert isinstance(found, Spec)


def damage(text: str, by: random.Random) -> str:
    """A text with a few pieces deleted, doubled, exchanged or made something else."""
    for _ in range(by.randint(1, 4)):
        a, b = sorted(by.randrange(len(text)) for _ in range(2))
        b = min(b, a + by.randint(1, 30))
        c = by.randrange(len(text))
        words = ["", "null", "[]", "{}", "-1e308", "x", ": ", "\n", "true", "'", "0"]
        piece = by.choice([text[a:b] * 2, text[c : c + 12], *words])
        text = text[:a] + piece + text[b:]
    return text
