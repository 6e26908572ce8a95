"""Only what is asked for is solved and computed: parts nothing asked depends on are left out, by words of the command.

What comes out is compared with a run of everything: each run keeps its own estimate.
"""

from __future__ import annotations

import json
import re
from collections.abc import Iterable
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from heuncli.kernel.choose import KERNEL
from heuncli.motion.integration.run.runner import Runner
from heuncli.results.results import Results
from heuncli.results.results_paths import find_values
from heuncli.scene.file_format.load import load
from heuncli.scene.file_format.models import Spec
from heuncli.study.compose import blocks, recovery, results
from heuncli.study.compose.recovery import Recovery
from heuncli.study.model.options import Options
from heuncli.study.model.selection import restrict_spec, select_paths
from heuncli.study.queries.measure import MeasureRequest, measure_value
from heuncli.study.queries.study import Study
from heuncli.study.solve import load_errors, motion_errors
from heuncli.study.workflow import describe, solve
from tests.shared.command import SPEC_TEXTS as SPECS_OF
from tests.shared.command import Heun
from tests.shared.folders import SPECS

ROD = "shapes: [{type: rod, from: [0, 0, 0], to: [0, 0, -1], mass: 1}]"
MANY = 100 if KERNEL == "compiled" else 10
SMALL = 1e-7  # both runs keep 1e-9 of their scene's size; what is compared is of that size and some ten times as large


def pendulums(n: int, more: str = "", joint: str = "") -> Spec:
    """Pendulums of their own lengths beside each other, the first with two sections."""
    bodies, joints = {}, {}
    for i in range(n):
        mass = f"mass: 1, center: [0, 0, {-0.5 - 0.01 * i}], inertia: [0.1, 0.1, 0]" if i else ROD
        bodies[f"b{i}"] = f"{{{mass}, points: {{top: [0, 0, 0], end: [0, 0, -1]}}}}"
        ends = f"from: {{body: ground, at: [0, {i}, 0]}}, to: b{i}.top"
        joints[f"p{i}"] = f"{{type: pin, {ends}, axis: [0, 1, 0], initial: {{angle: {0.5 + 0.01 * i}}}}}"
    if joint:
        joints["coupler"] = joint
    named = {kind: "".join(f"  {k}: {v}\n" for k, v in own.items()) for kind, own in (("b", bodies), ("j", joints))}
    return load(
        "scene.yaml",
        f"""heun: 1
gravity: [0, 0, -9.81]
bodies:
{named["b"]}joints:
{named["j"]}sections:
  root: {{body: b0, at: [0, 0, -0.1], normal: [0, 0, -1]}}
  along: {{body: b0, from: top, to: end, count: 5}}
{more}analysis: {{duration: 0.5, samples: 11}}
""",
    )


def asked(spec: Spec, paths: Iterable[str], **options: Any) -> Study:
    """A study of what some paths need."""
    what = select_paths(paths, spec)
    return solve(spec, Options(requested_reports=what.reports, entries=what.entries, **options))


def numbers(results: Results, path: str) -> Any:
    return find_values(results, path).values


def test_a_pendulum_beside_a_hundred_costs_what_it_costs_alone() -> None:
    path = "joints.p0.force"
    among, alone = asked(pendulums(MANY + 1), [path]), asked(pendulums(1), [path])
    assert len(among.setup.scene.mechanism.bodies) == 1
    assert among.setup.scene.layout.n_state == alone.setup.scene.layout.n_state
    assert among.results.work["evaluations"] == alone.results.work["evaluations"]
    assert np.array_equal(numbers(among.results, path), numbers(alone.results, path))
    left_out, _ = among.results.model["reduced"]  # and that what is left swings in a plane
    assert left_out == (f"left out, because no requested result depends on it: b1, b2, b3, b4, b5 and {MANY - 5} more")


def test_what_is_told_of_a_part_is_what_the_whole_scene_tells_of_it() -> None:
    paths = ["sections.along.M2", "joints.p3.force", "coordinates.p5.angle", "points.b3.end.position"]
    spec = pendulums(7)
    part, whole = asked(spec, paths).results, solve(spec).results
    for path in paths:
        assert np.abs(numbers(part, path) - numbers(whole, path)).max() < SMALL
    assert part.model["bodies"] == 3 and whole.model["bodies"] == 7
    assert list(part.joints) == ["p3"] and list(part.sections) == ["along"] and not part.bodies


def test_nothing_is_left_out_where_that_is_forbidden() -> None:
    spec, paths = pendulums(3), ["joints.p1.force"]
    full, part = (asked(spec, paths, reduce=reduce) for reduce in (False, True))
    assert (full.results.model["bodies"], part.results.model["bodies"]) == (3, 1)
    assert "reduced" not in full.results.model
    assert list(full.results.joints) == ["p1"]
    assert np.abs(numbers(full.results, *paths) - numbers(part.results, *paths)).max() < SMALL


LINKS = {  # of b0 to the others, and what it then needs
    "spring": ("forces: {s: {type: spring, from: b0.end, to: b2.end, stiffness: 10, length: 1}}", {"b0", "b2"}),
    "actuator": ("forces: {s: {type: actuator, from: b2.end, to: b0.end, value: 1}}", {"b0", "b2"}),
    "spring back": ("forces: {s: {type: spring, from: b3.end, to: b0.end, stiffness: 9, length: 1}}", {"b0", "b3"}),
    "force given in an angle": ("forces: {f: {type: force, on: b0.end, vector: [p2.angle, 0, 0]}}", {"b0", "b2"}),
    "couple given in a rate": ("forces: {f: {type: couple, on: b0.end, vector: [0, p1.rate, 0]}}", {"b0", "b1"}),
    "torque given in a table of an angle": (
        "tables: {k: {x: [-4, 4], y: [0, 1]}}\nforces: {f: {type: torque, joint: p0, value: 'table(k, p1.angle)'}}",
        {"b0", "b1"},
    ),
    "one that follows one that follows": (
        "forces: {f: {type: torque, joint: p0, value: p1.angle}, g: {type: torque, joint: p1, value: p2.angle}}",
        {"b0", "b1", "b2"},
    ),
    "only the other follows": ("forces: {f: {type: torque, joint: p1, value: p0.angle}}", {"b0"}),
    "a spring to the ground": (
        "forces: {s: {type: spring, from: {body: ground, at: [0, 9, 0]}, to: b0.end, stiffness: 1, length: 0}}", {"b0"},
    ),
}  # fmt: skip


@pytest.mark.parametrize("link", LINKS)
def test_what_a_part_follows_is_needed(link: str) -> None:
    more, bodies = LINKS[link]
    follows_the_whole(pendulums(4, f"{more}\n"), bodies)


@pytest.mark.heavy
def test_bodies_that_a_joint_couples_are_one_part() -> None:
    follows_the_whole(pendulums(4, joint="{type: rod, from: b1.end, to: b0.end}"), {"b0", "b1"})


@pytest.mark.parametrize("seed", range(12))
def test_whatever_follows_whatever(seed: int) -> None:
    """Some forces between five pendulums, each given in the angle of any: a body is left out if it has no way to p0."""
    rng = np.random.default_rng(seed)
    kinds = ("{{type: spring, from: b{0}.end, to: b{1}.end, stiffness: 2, length: 1}}",
             "{{type: torque, joint: p{0}, value: p{1}.angle}}",
             "{{type: actuator, from: b{0}.end, to: b{1}.top, value: p{2}.rate}}",
             "{{type: force, on: b{0}.end, vector: [0, 0, p{1}.angle*p{2}.angle]}}")  # fmt: skip
    drawn = [(int(rng.integers(len(kinds))), rng.permutation(5)[:3].tolist()) for _ in range(3)]
    lines = "".join(f"  f{i}: {kinds[kind].format(*of)}\n" for i, (kind, of) in enumerate(drawn))
    ways = {0: ((0, 1), (1, 0)), 1: ((0, 1),), 2: ((0, 1), (1, 0), (0, 2), (1, 2)), 3: ((0, 1), (0, 2))}
    to = {(of[a], of[b]) for kind, of in drawn for a, b in ways[kind]}
    found = {0}
    for _ in range(5):
        found |= {b for a, b in to if a in found}
    follows_the_whole(pendulums(5, f"forces:\n{lines}"), {f"b{i}" for i in found})


def follows_the_whole(spec: Spec, bodies: set[str]) -> None:
    """The reaction of p0 needs these bodies, and is then that of the whole scene."""
    assert set(restrict_spec(spec, select_paths(["joints.p0.force"], spec)).bodies) == bodies
    runs = (asked(spec, ["joints.p0.force"], reduce=reduce).results for reduce in (True, False))
    part, whole = (numbers(results, "joints.p0.force") for results in runs)
    assert np.abs(part - whole).max() < SMALL * np.abs(whole).max()


LAWS = """
heun: 1
gravity: [0, 0, -9.81]
ground: {points: {O: [0, 0, 0], P: [0.3, 0.5, 0], R: [3, 0, 2]}}
tables:
  soft: {x: [-1, 0, 1], y: [-300, 0, 500], outside: hold}
  curve: {x: [-10, 0, 10], y: [4, 3, 1], outside: hold}
bodies:
  a: {mass: 2, center: [0.2, 0, 0], inertia: [0.1, 0.1, 0.1], points: {o: [0, 0, 0], e: [1, 0, 0]}}
  b: {mass: 1, center: [0, 2, 0], inertia: [0.1, 0.1, 0.1], points: {o: [0, 2, 0]}}
  c: {mass: 1, center: [0, 4, 0], inertia: [0.1, 0.1, 0.1], points: {o: [0, 4, 0]}}
  d: {mass: 3, center: [3, 0, 0], inertia: [0.1, 0.1, 0.1], points: {o: [3, 0, 0]}}
  e: {mass: 1, center: [5, 0, 0], inertia: [0.1, 0.1, 0.1], points: {o: [5, 0, 0]}}
joints:
  A: {type: pin, from: ground.O, to: a.o, axis: [0, 0, 1], initial: {angle: 0.2, rate: 0.3}}
  B: {type: slide, from: {body: ground, at: [0, 2, 0]}, to: b.o, axis: [1, 0, 0], initial: {travel: 0.1, speed: 0.2}}
  C: {type: pin, from: {body: ground, at: [0, 4, 0]}, to: c.o, axis: [0, 0, 1], initial: {angle: 0, rate: 1}}
  D: {type: slide, from: {body: ground, at: [3, 0, 0]}, to: d.o, axis: [0, 0, 1]}
  E: {type: slide, from: {body: ground, at: [5, 0, 0]}, to: e.o, axis: [1, 0, 0], initial: {travel: 0, speed: 1}}
drives:
  lift: {joint: D, travel: 0.1*t**2}
forces:
  own: {type: spring, from: ground.P, to: a.e, force: "-200*(length - 0.4)**3 - 4*rate + 3*t*abs(length - 0.55)"}
  own2: {type: turn_spring, joint: A, torque: "-3*angle - 0.1*rate"}
  rub: {type: damper, joint: B, force: "-2*rate*abs(rate)"}
  follow: {type: force, on: b.o, vector: ["3*A.angle + points.a.e.vx", 0, 0]}
  mount: {type: bushing, from: {body: ground, at: [0, 4, 0]}, to: c.o, turning: soft}
  motor: {type: motor, joint: C, curve: curve, ratio: 2}
  pull: {type: actuator, from: ground.R, to: e.o, value: "table(soft, B.travel)"}
latches:
  hold: {joint: E, travel: 0.05, when: "A.angle > 0.1"}
impulses:
  blow: {on: b.o, vector: [0.1, 0, 0], when: "C.angle > 0.05"}
analysis: {duration: 0.07, samples: 3, events: {turned: "C.angle > 0.1"}}
"""
LAW_PATHS = (
    "joints.A.force", "joints.B.force", "coordinates.C.acceleration", "coordinates.E.travel", "points.a.e.velocity",
    "forces.own.length", "forces.rub.power", "forces.mount.turn", "forces.motor.value", "forces.pull.value",
    "foundation.elements.lift.force", "stops.hold.force",
)  # fmt: skip


@pytest.fixture(scope="module")
def whole_by_laws() -> Results:
    """All of the scene."""
    return solve(load("scene.yaml", LAWS), Options(reduce=False)).results


@pytest.mark.heavy
@pytest.mark.parametrize("path", LAW_PATHS)
@pytest.mark.third
def test_loads_by_laws_follow_the_whole(path: str, whole_by_laws: Results) -> None:
    """Laws of a load's own line, joint or shift, of a table, of another part's coordinate or point."""
    part = asked(load("scene.yaml", LAWS), [path]).results
    a, b = numbers(part, path), find_values(whole_by_laws, path).values
    assert a.shape == b.shape and np.abs(a - b).max() <= 10.0 * SMALL * max(float(np.abs(b).max()), 1.0)


@pytest.mark.heavy
@pytest.mark.parametrize("words", [["--only", "joints.A"], ["--only", "forces"], ["--measure", "max forces.own.value"]])
def test_words_that_name_a_spring_by_its_own_law(heun: Heun, folder: Path, words: list[str]) -> None:
    (folder / "laws.yaml").write_text(LAWS)
    assert heun("run", "laws.yaml", *words).returncode == 0


def test_a_moment_about_another_body_needs_it() -> None:
    text = "  far: {body: b0, at: [0, 0, -0.2], normal: [0, 0, -1], reduce_to: b2.end}\n"
    spec = pendulums(4, text)
    path = "sections.far.moment"
    part, whole = asked(spec, [path]), solve(spec).results
    assert list(part.setup.spec.bodies) == ["b0", "b2"]
    assert np.abs(numbers(part.results, path) - numbers(whole, path)).max() < SMALL


def test_a_share_of_a_force_elsewhere_is_nothing() -> None:
    spec = pendulums(3, "forces: {far: {type: force, on: b2.end, vector: [1, 0, 0]}}\n")
    found = asked(spec, ["joints.p0.shares.far.force"])
    assert list(found.setup.spec.bodies) == ["b0", "b2"]
    assert not numbers(found.results, "joints.p0.shares.far.force").any()
    assert not found.results.forces


@pytest.mark.parametrize("report", ["foundation", "energy", "motion", "impulses"])
def test_what_is_about_all_bodies_needs_all(report: str) -> None:
    spec = pendulums(3)
    assert restrict_spec(spec, Options(requested_reports=frozenset({report})).selection).bodies == spec.bodies


def test_a_rope_elsewhere_does_not_end_the_run() -> None:
    spec = load(
        "scene.yaml",
        """heun: 1
gravity: [0, 0, -9.81]
bodies:
  ball: {mass: 1, center: [0, 0, 0], inertia: [0, 0, 0], points: {c: [0, 0, 0]}, position: [0, 9, 1]}
  bar: {mass: 1, center: [0, 0, -1], inertia: [0, 0, 0], points: {top: [0, 0, 0]}}
joints:
  rope: {type: rod, from: {body: ground, at: [0, 9, 0]}, to: ball.c, tension_only: true}
  pin: {type: pin, from: {body: ground, at: [0, 0, 0]}, to: bar.top, axis: [0, 1, 0], initial: {angle: 1}}
analysis: {duration: 1, samples: 3}
""",
    )
    assert asked(spec, ["joints.pin.force"], reduce=False).results.status["code"] == "stopped"
    found = asked(spec, ["joints.pin.force"]).results
    assert found.status["code"] == "completed" and len(found.time) == 3


@pytest.mark.heavy
def test_one_section_alone_is_recovered(monkeypatch: pytest.MonkeyPatch) -> None:
    """No other cuts, no foundation, no energy, no sums; the balance, which tells whether numbers are wrong, stays."""
    spec = load(str(SPECS / "jib.yaml"))
    for module, names in {
        recovery: ("energy_block",),
        blocks: (
            "foundation_block",
            "evaluate_joint_coordinates",
            "system_vector",
            "evaluate_point_motions",
            "make_force_blocks",
        ),
        results: ("find_determinate_sums",),
        motion_errors: ("energy_block",),
        load_errors: ("sum_ground_loads",),
    }.items():
        for name in names:
            monkeypatch.setattr(module, name, forbidden)
    study = asked(spec, ["sections.root.M1"])
    assert [cuts.name for cuts in study.setup.cuts] == ["root"]
    assert measure_value(MeasureRequest("abs", "sections.root.N"), study).value > 0.0
    assert study.results.accuracy["balance_residual"] < 1e-9
    assert study.results.accuracy["estimate"].keys() == {"motion", "sections"}


@pytest.mark.heavy
def test_a_motion_asks_for_no_verdicts(monkeypatch: pytest.MonkeyPatch) -> None:
    spec = load(str(SPECS / "four_bar.yaml"))
    monkeypatch.setattr(Recovery, "resolution", property(forbidden))
    monkeypatch.setattr(load_errors, "find_joint_loads", forbidden)
    study = asked(spec, ["coordinates.rocker.angle"])
    assert measure_value(MeasureRequest("max", "coordinates.rocker.angle"), study).value > 0.0
    assert study.results.accuracy["balance_residual"] < 1e-9


def test_a_state_integrates_nothing(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(Runner, "run", forbidden)
    found = solve(load(str(SPECS / "flywheel.yaml"))).results
    assert found.work["steps"] == 0 and found.sections


def forbidden(*given: Any, **named: Any) -> None:
    raise AssertionError("nobody asked for it")


def test_entries_are_asked_for_by_their_paths(heun: Heun) -> None:
    text = heun("run", "swinging.yaml", "--only", "joints.pivot,foundation.supports.pivot", "--format", "json").stdout
    shown = json.loads(text)
    assert list(shown["joints"]) == ["pivot"] and "energy" not in shown
    assert shown["foundation"].keys() == {"about", "supports"}
    table = heun("run", "hanging.yaml", "--only", "foundation.supports.pivot").stdout
    assert "support pivot" in table and "total" not in table and "JOINTS" not in table
    both = json.loads(heun("run", "hanging.yaml", "--only", "joints.pivot,joints", "--format", "json").stdout)
    assert "stops" not in both and list(both["joints"]) == ["pivot"]


@pytest.mark.parametrize(("words", "told"), [
    ("joints.pivto", "did you mean joints.pivot?"),
    ("joints.pivot.force", "use joints.pivot; --measure prints single numbers"),
    ("sections.middle", "the model has no sections"),
    ("foundation.force", "use foundation; --measure prints single numbers"),
    ("foundation.axes", "did you mean foundation.axis?"),
    ("foundation.total", "--only foundation shows all of it; entries: foundation.axis, foundation.mass_effect"),
    ("foundation.supports", "entries: foundation.supports.pivot"),
    ("joint.pivot", "did you mean joints.pivot?"),
    ("nothing.else", "known: motion"),
    ("joint", "did you mean joints?"),
    ("drive", "drive is part of joints: --only joints"),
])  # fmt: skip
def test_what_is_no_entry_is_refused(heun: Heun, words: str, told: str) -> None:
    done = heun("run", "hanging.yaml", "--only", words)
    assert (done.returncode, done.stdout) == (2, "")
    assert words in done.stderr and told in done.stderr


@pytest.mark.heavy
def test_the_axis_and_the_mass_effect_are_shown_where_they_are_asked_for(heun: Heun, folder: Path) -> None:
    def tables(*words: str, spec: str = "hanging.yaml") -> set[str]:
        text = heun("run", spec, *words).stdout
        return {name for name in ("FOUNDATION", "CENTRAL AXIS", "MASS EFFECT") if f"\n{name}  " in text}

    assert tables() == tables("--by-cause") == {"FOUNDATION"}
    assert tables("--only", "foundation") == {"FOUNDATION", "CENTRAL AXIS", "MASS EFFECT"}
    assert tables("--only", "joints,foundation.axis") == {"FOUNDATION", "CENTRAL AXIS"}
    assert tables("--only", "foundation.mass_effect") == {"MASS EFFECT"}
    (folder / "named.yaml").write_text(SPECS_OF["hanging"] + "report: [foundation]\n")
    assert tables(spec="named.yaml") == {"FOUNDATION", "CENTRAL AXIS", "MASS EFFECT"}
    told = heun("run", "swinging.yaml", "--only", "foundation.axis").stdout
    assert "show it at given times with --at or --all" in told
    assert "CENTRAL AXIS" in heun("run", "swinging.yaml", "--only", "foundation.axis", "--at", "0.5").stdout
    written = json.loads(heun("run", "hanging.yaml", "--format", "json").stdout)["foundation"]
    assert {"axis", "mass_effect"} <= written.keys()
    alone = json.loads(heun("run", "hanging.yaml", "--only", "foundation.axis", "--format", "json").stdout)
    assert alone["foundation"] == {key: written[key] for key in ("about", "force", "moment", "axis")}


@pytest.mark.heavy
def test_what_is_left_out_is_told(heun: Heun, folder: Path) -> None:
    more = "  other: {mass: 1, center: [0, 0, 0], inertia: [1, 1, 1], points: {o: [0, 0, 0]}}\njoints:\n"
    (folder / "two.yaml").write_text(SPECS_OF["swinging"].replace("joints:\n", more) + "report: [joints]\n")
    line = "reduced   left out, because no requested result depends on it: other"
    assert line in heun("run", "two.yaml", "--verbose").stdout
    assert "reduced" not in heun("run", "two.yaml").stdout
    assert line not in heun("run", "two.yaml", "--verbose", "--no-reduce").stdout
    assert line not in heun("run", "two.yaml", "--verbose", "--only", "energy").stdout
    assert "Simplifications\n  - left out, because" in heun("model", "two.yaml").stdout


def test_the_note_tells_what_is_integrated_and_what_its_beginning_takes() -> None:
    sentences = describe(load(str(SPECS / "double.yaml")))["integrates"]
    assert sentences[0].startswith(
        "14 state variables, integrated by DOP853, an explicit method of order 8, tolerance 1e-09"
    )
    took = r"the first 0\.2 s take \d+ steps, \d+ evaluations, [\d.e+]+ ms; the whole run about 10 times that.*"
    assert re.fullmatch(took, sentences[1])
    assert describe(load(str(SPECS / "table.yaml")))["integrates"] == ["none: one instant is solved"]


def test_the_note_names_bodies_and_joints(heun: Heun) -> None:
    text = heun("model", "swinging.yaml").stdout
    assert "bodies     1: bar\n" in text and "joints     1: pivot (ball)\n" in text
    assert json.loads(heun("model", "swinging.yaml", "--format", "json").stdout)["names"]["joints"] == {"pivot": "ball"}


def test_the_model_calls_joints_as_specs_do(heun: Heun, folder: Path) -> None:
    (folder / "flat.yaml").write_text(FLAT)
    told = json.loads(heun("model", "flat.yaml", "--format", "json").stdout)["names"]["joints"]
    assert told == {"rail": "line", "hinge": "pin"}


FLAT = """
heun: 1
space: planar
ground: {points: {O: [0, 0, 0]}}
bodies:
  cart: {mass: 5, center: [0, 0, 0], inertia: 0, points: {o: [0, 0, 0]}}
  load: {mass: 1, center: [0, -1, 0], inertia: 0.1, points: {o: [0, 0, 0]}}
joints:
  rail: {type: line, from: ground.O, to: cart.o, axis: [1, 0, 0]}
  hinge: {type: pin, from: cart.o, to: load.o, axis: [0, 0, 1]}
"""
