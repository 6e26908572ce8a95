"""What newcomers write first, and what they are told: where, and what to write instead."""

from __future__ import annotations

import ast
import json
from collections.abc import Iterator
from pathlib import Path

import pytest

import heuncli
from heuncli.base.errors import SpecError
from heuncli.scene.file_format.load import load

PACKAGE = Path(heuncli.__file__).parent
ANALYSIS = "analysis: {duration: 2, samples: 11}\n"
LUMP = "{mass: 1 kg, center: [0, 0, 0], inertia: [1, 1, 1], points: {p: [0, 0, 0]}}"
SCENE = f"""\
heun: 1
gravity: [0, 0, -9.81]
ground: {{points: {{O: [0, 0, 0]}}}}
bodies:
  bar:
    shapes: [{{type: cylinder, from: [0, 0, 0], to: [0, 0, -1], radius: 10 mm, density: 7850 kg/m^3}}]
    points: {{top: [0, 0, 0], end: [0, 0, -1]}}
  ball: {LUMP}
joints:
  pivot: {{type: pin, from: ground.O, to: bar.top, axis: [0, 1, 0]}}
{ANALYSIS}"""


def told(text: str) -> dict[str, str]:
    """The hints of all problems by 'path [code]'."""
    with pytest.raises(SpecError) as caught:
        load("x.yaml", text)
    return {f"{p.location.path if p.location else ''} [{p.code}]": p.hint or "" for p in caught.value.problems}


def hint(text: str) -> str:
    found = told(text)
    assert len(found) == 1, found
    return next(iter(found.values()))


@pytest.mark.parametrize("kind", ["ball", "universal, axis: [1, 0, 0], to_axis: [0, 1, 0]"])
@pytest.mark.parametrize(
    "line",
    ["stops: {s: {joint: b, angle: [0, 1]}}", "forces: {m: {type: motor, joint: b, stall: 2, idle: 30}}",
     "forces: {t: {type: torque, joint: b, value: 2}}"],
)  # fmt: skip
def test_a_joint_of_several_rotations_is_pins_in_a_row_for_what_acts_about_one(kind: str, line: str) -> None:
    joint = f"joints:\n  b: {{type: {kind}, from: ground.O, to: ball.p}}\n"
    assert "pins in a row, with bodies of mass: 0 between" in hint(SCENE.replace("joints:\n", joint) + line + "\n")


@pytest.mark.parametrize("key", ["tolerance: 1e-8", "duration: 2", "samples: 5", "times: [0, 1]", "method: auto"])
def test_a_key_of_the_analysis_at_the_top_is_sent_there(key: str) -> None:
    word = key.partition(":")[0]
    found = told(SCENE + f"{key}\n")
    assert f"analysis: {{{word}: ...}}" in found[f"{word} [unknown-key]"]


@pytest.mark.parametrize(
    ("line", "path", "said"),
    [
        ("time: 2", "time [unknown-key]", "analysis: {duration: ...}"),
        ("points: {a: [0, 0, 0]}", "points [unknown-key]", "belongs under ground"),
        ("mass: 2", "mass [unknown-key]", "bodies: {NAME: {mass: ...}}"),
        ("sections: {s: {on: bar, from: top, to: end, n: 5}}", "sections.s.n [unknown-key]", "it is called count here"),
        ("sections: {s: {body: bar, from: bar.top, to: end, count: 5}}", "sections.s.from [unknown-point]", ": top"),
        ("units: mm", "units [unknown-key]", "12 mm"),
        ("report: joints", "report [wrong-kind]", "[joints, energy]"),
        ("expect: {of: time, is: 1}", "expect [wrong-kind]", "[{of: "),
        ("sections: {s: {body: bar, at: 0.5, normal: [0, 0, 1]}}", "sections.s.at [wrong-kind]", "[x, y, z]"),
        ("drives: {d: {joint: pivot, torque: 5}}", "drives.d.torque [unknown-key]", "type torque"),
        ("drives: {d: {joint: pivot, rpm: 1500}}", "drives.d.rpm [unknown-key]", "rate"),
        ("forces: [{type: torque}]", "forces [wrong-kind]", "forces: {NAME: {...}}"),
        ("forces: {f: {type: torque, on: bar, value: 5}}", "forces.f.on [unknown-key]", "couple"),
        ("forces: {f: {type: damper, joint: pivot, damping: 5}}", "forces.f.damping [unknown-key]", "coefficient"),
        ("forces: {f: {type: friction, joint: pivot, mu: 5, speed: 1}}", "forces.f.mu [unknown-key]", "coefficient"),
        ("forces: {f: {type: friction, joint: pivot, coefficient: 0.1, speed: 1}}", "forces.f [load-joint]", "20 mm"),
        (
            "forces: {f: {type: friction, joint: pivot, coefficient: 0.1, torque: 1, radius: 0.1, speed: 1}}",
            "forces.f [load-joint]",
            "a pin takes torque or coefficient",
        ),
        (
            "forces: {f: {type: friction, joint: pivot, torque: 1, radius: 0.1, speed: 1}}",
            "forces.f.radius [load-joint]",
            "or write coefficient",
        ),
        (
            "forces: {f: {type: friction, joint: pivot, coefficient: 0.1, radius: 0.1, length: 1, speed: 1}}",
            "forces.f.length [load-joint]",
            "a pin has a radius",
        ),
        (
            "forces: {f: {type: friction, joint: pivot, coefficient: 0.1, radius: 0, speed: 1}}",
            "forces.f.radius [not-positive]",
            "above 0",
        ),
        ("forces: {f: {type: force, on: bar, vector: [0, 0, 1]}}", "forces.f.on [end]", "bar.top, or bar.end?"),
        (
            "couplings: {c: {type: rope, through: [ground.O, bar.end], k: 4e4}}",
            "couplings.c.k [unknown-key]",
            "it is called stiffness here",
        ),
        (
            "couplings: {c: {type: rope, through: [ground.O, bar.end], damping: 300}}",
            "couplings.c.damping [rope-bounds]",
            "stiffness: 4e5 N/m",
        ),
        (
            "forces: {f: {type: friction, joint: pivot, torque: 1, speed: 1, ramp: 0.2}}",
            "forces.f.ramp [unknown-key]",
            "min(t/0.2, 1)",
        ),
        ("latches: {l: {joint: pivot, at: 1}}", "latches.l.at [unknown-key]", "angle or travel"),
        ("latches: {l: {joint: pivot, until: t > 1}}", "latches.l.until [unknown-key]", "release: t > 1.5"),
        (
            "forces: {f: {type: motor, joint: pivot, stall: 2, idle: 0}}",
            "forces.f.idle [motor]",
            "both must have the same sign",
        ),
        ("forces: {f: {type: motor, joint: pivot, curve: 2, idle: 3}}", "forces.f.idle [motor]", "one of them out"),
        (
            "forces: {f: {type: motor, joint: pivot, curve: 2, limit: 0}}",
            "forces.f.limit [motor]",
            "in both directions",
        ),
        (
            "forces: {f: {type: motor, joint: pivot, curve: 2, inertia: 1}}",
            "forces.f.inertia [unknown-key]",
            "rotor: {",
        ),
        (
            "forces: {f: {type: motor, joint: pivot, curve: 2, rotor: 1}}",
            "forces.f.rotor [wrong-kind]",
            "{mass: 0.2 kg",
        ),
        (
            "forces: {f: {type: motor, joint: pivot, curve: 2, rotor: {mass: 0, inertia: 1}}}",
            "forces.f.rotor.mass [motor]",
            "leave the rotor out",
        ),
        ("forces: {f: {type: force, on: bar.end, vector: 5}}", "forces.f.vector [wrong-kind]", "three components"),
    ],
)
def test_a_line_more(line: str, path: str, said: str) -> None:
    assert said in told(f"{SCENE}{line}\n")[path]


@pytest.mark.parametrize(
    ("given", "instead", "said"),
    [
        ("gravity: [0, 0, -9.81]", "gravity: -9.81", "[0, 0, -9.81]"),
        ("from: [0, 0, 0]", "from: top", "three coordinates [x, y, z], for example"),
        ("axis: [0, 1, 0]}", "axis: y}", "the y axis is [0, 1, 0]"),
        ("axis: [0, 1, 0]}", "axis: -z}", "the z axis is [0, 0, -1]"),
        ("axis: [0, 1, 0]}", "axis: [0, 1, 0], angle: 60 deg}", "initial: {angle: ...}"),
        ("axis: [0, 1, 0]}", "axis: [0, 1, 0], drive: 3*t}", "drives: {motor: {joint: NAME, rate: 1500 rpm}}"),
        ("axis: [0, 1, 0]}", "axis: [0, 1, 0], friction: 0.1}", "type: friction, joint: NAME, torque: 0.3 N m"),
        ("axis: [0, 1, 0]}", "axis: [0, 1, 0], damping: 3}", "type: damper, joint: NAME, coefficient: 0.01"),
        ("axis: [0, 1, 0]}", "axis: [0, 1, 0], spring: 3}", "type: turn_spring, joint: NAME"),
        ("joints:\n", "joints:\n  b: {type: ball, from: ground.O, to: ball.p, initial: {rate: 3}}\n", "orientation"),
        ("type: pin", "type: pivot", "type: pin"),
        ("type: pin", "type: rigid", "type: weld"),
        ("type: pin", "type: revolut", "did you mean revolute?"),
        ("radius: 10 mm", "raduis: 10 mm", "did you mean radius?"),
        ("type: pin", "typ: pin", "did you mean type instead of 'typ'?"),
        ("from: ground.O", "from: O", "did you mean ground.O?"),
        ("from: ground.O", "from: origin", "did you mean ground.O?"),
        ("from: ground.O", "from: world.O", "called ground: ground.O"),
        ("axis: [0, 1, 0]}", "axis: 90 deg}", "a direction such as [0, 0, 1]"),
        ("type: pin", "type: motor", "drives: {motor: {joint: NAME, rate: 1500 rpm}}"),
        ("type: pin", "type: rzeppa", "for 'rzeppa' write type: cv"),
        ("type: pin", "kind: pin", "'kind' is called type here"),
        ("density: 7850 kg/m^3", "density: 7.85 t/m3", "7.85 tonne/m^3"),
        ("points: {top: [0, 0, 0], end: [0, 0, -1]}", "points: [top, end]", "by name"),
        (ANALYSIS, ANALYSIS + "report: [stresses]\n", "did you mean sections?"),
        (
            ANALYSIS,
            ANALYSIS + "forces: {f: {type: spring, from: ground.O, to: bar.end, k: 100, length: 1}}\n",
            "it is called stiffness here",
        ),
        (ANALYSIS, ANALYSIS + "sections: {s: {body: rod, from: top, to: end, count: 3}}\n", "known bodies: bar, ball"),
        (ANALYSIS, "analysis: {duration: 2, samples: 11, tolerance: 1}\n", "the default is 1e-9"),
        (ANALYSIS, "analysis: {duration: 1e20, samples: 11}\n", "is its unit right?"),
        (ANALYSIS, "analysis: {duration: 1, samples: 1000000000}\n", "between the samples"),
        ("from: ground.O", "from: ground", "did you mean ground.O?"),
        ("from: ground.O", "from: [0, 0, 1]", "{body: ground, at: [0, 0, 1]}"),
        ("to: bar.top", "to: top", "did you mean bar.top?"),
        (ANALYSIS, "analysis: {times: [0]}\n", "analysis: {type: state}"),
        (ANALYSIS, "analysis: {type: dynamic, duration: 2}\n", "did you mean motion?"),
        (ANALYSIS, "analysis: {duration: 2, dt: 0.01}\n", "samples"),
        ("density: 7850 kg/m^3", "density: 7.85 g/cm3", "write 7.85 g/cm^3"),
        ("inertia: [1, 1, 1]", "inertia: [1 kgm2, 1, 1]", "write 1 kg*m^2"),
        ("inertia: [1, 1, 1]", "inertia: [1 kgm^2, 1, 1]", "write 1 kg*m^2"),
        ("inertia: [1, 1, 1]", "inertia: [1 kg*m2, 1, 1]", "write 1 kg*m^2"),
        ("inertia: [1, 1, 1]", "inertia: [1, 1, 1, 0, 0, 0]", "deviation"),
        ("inertia: [1, 1, 1]", "inertia: {xx: 1}", "[A1, A2, A3]"),
        ("mass: 1 kg", "mass: 1,5 kg", "write decimals with a point"),
        ("bar:\n", "bar: &a\n", "JSON"),
        ("shapes: [{", "orientation: 60 deg\n    shapes: [{", "{axis: [0, 0, 1], angle: 60 deg}"),
        ("radius: 10 mm", "radius: 10 mm, diameter: 20 mm", "half the diameter"),
    ],
)
def test_one_thing_wrong_has_one_hint(given: str, instead: str, said: str) -> None:
    assert given in SCENE
    assert said in hint(SCENE.replace(given, instead))


@pytest.mark.parametrize(
    ("written", "said"),
    [
        ("1.5t", "1.5*t"),
        ("5*sin(2pi*t)", "2*pi"),
        ("2(t + 1)", "2*("),
        ("t(1)", "t*(...)"),
        ("Sin(t)", "did you mean sin?"),
        ("2*cycloide(t)", "did you mean cycloid?"),
        ("2 cycloide(t)", "did you mean 2*cycloid(t)?"),
        ("5 arcsin(t)", "write 5*asin(t)"),
        ("2 N*m*cycloide(t)", "did you mean cycloid?"),
        ("2 wurzel(t)", "known functions: "),
        ("2 Nn(m)", "did you mean N?"),
        ("20 newtn", "did you mean N?"),
        ("5 secnds", "did you mean s?"),
        ("arcsin(t)", "asin"),
        ("math.sin(t)", "write sin"),
        ("t^2", "**"),
        ("'1,5'", "1.5"),
        ("5*sin(t) N", "right after a number: 20 N"),
        ("5 kg * sin(t)", "fits any dimension"),
        ("50%", "0.5"),
        ("'if(t > 1, 5, 0)'", "a if c else b"),
        ("'t > 1 ? 5 : 0'", "a if c else b"),
        ("5*pivot", "pivot.angle"),
        ("21/s", "with a unit: 21 1/s"),
        ("5/q", "no parameters are defined"),
        ("joints.pivot.force.z", "{of: "),
        ("\"table('f', t)\"", "write no quotes"),
        ("interp(t)", "table(NAME, ...)"),
        ("5*time", "write t"),
        ("5*", "a value is missing"),
        ("5 = 3", "compare with >"),
    ],
)
def test_an_expression_as_others_write_it(written: str, said: str) -> None:
    force = f"forces: {{f: {{type: force, on: bar.end, vector: [{written}, 0, 0]}}}}\n"
    assert said in hint(SCENE + force)


def test_a_list_in_place_of_the_bodies_is_told_once() -> None:
    assert hint("heun: 1\nbodies:\n  - {name: bar, mass: 1}\n") == "write each under its name: bodies: {NAME: {...}}"


def test_json_is_read() -> None:
    blocks = {"heun": 1, "bodies": {"bar": {"mass": 1.0, "center": [0, 0, 1e-3], "inertia": [1, 1, 1]}}}
    assert load("x.json", json.dumps(blocks, indent=1)).bodies["bar"].center == (0.0, 0.0, 1e-3)


def test_units_that_are_understood() -> None:
    text = SCENE.replace("axis: [0, 1, 0]}", "axis: [0, 1, 0], initial: {angle: 60°}, stiffness: {moment: 5 Nm/rad}}")
    assert load("x.yaml", text).joints["pivot"].stiffness is not None


NEEDS_NONE: dict[str, str] = {}  # codes whose messages themselves say what to do, and why that is enough
PLACE_OF_HINT = {"Problem": 3, "Finding": 2, "Violation": 2}


def without_hint(path: Path) -> Iterator[str]:
    """The errors that a module constructs without a word on what to do next."""
    text = path.read_text(encoding="utf-8")
    if not any(f"{name}(" in text for name in PLACE_OF_HINT):
        return
    for node in ast.walk(ast.parse(text)):
        name = getattr(node.func, "id", getattr(node.func, "attr", "")) if isinstance(node, ast.Call) else ""
        if not isinstance(node, ast.Call) or name not in PLACE_OF_HINT:
            continue
        if any(repr(code) in ast.unparse(node) for code in NEEDS_NONE):
            continue
        given = [keyword.value for keyword in node.keywords if keyword.arg == "hint"] + node.args[PLACE_OF_HINT[name] :]
        given += [argument for argument in node.args if isinstance(argument, ast.Starred)]  # with its hint
        if not given or (isinstance(given[0], ast.Constant) and not given[0].value):
            yield f"{path.name}:{node.lineno} {ast.unparse(node)}"


@pytest.mark.heavy
def test_every_error_says_what_to_do_next() -> None:
    assert [found for path in sorted(PACKAGE.rglob("*.py")) for found in without_hint(path)] == []
