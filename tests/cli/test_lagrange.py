"""`heun lagrange`: what it writes, and what it refuses."""

from __future__ import annotations

import csv
import io
import json
from pathlib import Path

import numpy as np
import pytest

from heuncli.analyses.lagrange.study import LagrangeOptions, solve_lagrange
from heuncli.app.commands.lagrange.forms import KEYS
from heuncli.base.errors import HeunError
from heuncli.scene.file_format.load import load
from tests.shared.command import Heun
from tests.shared.folders import ROOT
from tests.shared.lagrange import double

EXCAVATOR = ROOT / "specs" / "excavator.yaml"
SPECS = sorted((ROOT / "specs").glob("*.yaml"))
NAMES = {
    "coordinates", "rates", "epsilon", "eta", "gamma", "alpha", "momenta", "reciprocal_energy", "forces", "coriolis",
    "energy", "sections", "units", "driven", "accelerations", "drives", "coriolis_matrix", "seen", "partials",
    "residual", "left_out", "state_space",
}  # fmt: skip
# the cart rolls: it has speeds, and no coordinates; the monitor and the jack stick at the start
NOTHING_FREE = {"axle_loads", "gerber_beam", "overhang", "cart", "monitor_arm", "screw_jack", "bracket", "hoist_beam"}


@pytest.fixture
def pendulum(folder: Path) -> str:
    loads = "forces: {push: {type: force, on: b.e, vector: [3, 0, 0]}}"
    (folder / "double.yaml").write_text(double(f"{loads}\nanalysis: {{duration: 1, samples: 11}}"))
    return "double.yaml"


def test_json_keeps_to_the_contract(heun: Heun, pendulum: str) -> None:
    done = heun("lagrange", pendulum, "--format", "json", "--christoffel")
    found = json.loads(done.stdout)
    assert done.returncode == 0 and found.keys() >= NAMES
    assert found["coordinates"] == ["A.angle", "B.angle"] and found["units"] == ["rad", "rad"]
    assert np.shape(found["gamma"]) == np.shape(found["alpha"]) == (2, 2, 2)
    shares = found["forces"]["shares"]
    assert shares.keys() == {"gravity", "push"}
    assert np.allclose(np.sum(list(shares.values()), axis=0), found["forces"]["total"], rtol=1e-15)
    assert found["seen"]["A.angle"].keys() == {"unit", "locked", "free"}
    assert np.shape(found["partials"]["points"]["b.e"]) == (3, 2) == np.shape(found["partials"]["bodies"]["a"]["turn"])
    assert json.loads(heun("lagrange", pendulum, "--format", "json").stdout)["gamma"] is None


def test_long_form_says_the_same(heun: Heun, pendulum: str) -> None:
    found = json.loads(heun("lagrange", pendulum, "--format", "json").stdout)
    rows = list(csv.DictReader(io.StringIO(heun("lagrange", pendulum, "--format", "csv").stdout)))
    own = {(row["name"], row["quantity"], row["component"]): float(row["value"]) for row in rows}
    for i, name in enumerate(found["coordinates"]):
        assert own[name, "coriolis", ""] == found["coriolis"][i]
        assert own[name, "force", "push"] == found["forces"]["shares"]["push"][i]
        assert own[name, "epsilon", "B.angle"] == found["epsilon"][i][1]


@pytest.mark.heavy
def test_an_instant_of_a_motion(heun: Heun, pendulum: str) -> None:
    """The same coordinates, rates and accelerations as the run tells there; and the turns are counted."""
    run = json.loads(heun("run", pendulum, "--format", "json").stdout)
    found = json.loads(heun("lagrange", pendulum, "--format", "json", "--at", "0.7").stdout)
    assert run["time"][7] == pytest.approx(0.7, rel=1e-15)
    for i, joint in enumerate("AB"):
        own = run["coordinates"][joint]
        told = (found["values"][i], found["rates"][i], found["accelerations"][i])
        for name, value in zip(("angle", "rate", "acceleration"), told, strict=True):
            assert own[name][7] == pytest.approx(value, abs=1e-6)
    late = heun("lagrange", pendulum, "--at", "0.7").stdout
    assert "at t = 0.7 s" in late


def test_tables(heun: Heun, pendulum: str) -> None:
    text = heun("lagrange", pendulum, "--christoffel", "--seen", "A.angle,b.e:1,0,0", "--seen", "B.angle").stdout
    for words in (
        "LAGRANGE",
        "MASS",
        "INVERSE MASS MATRIX",
        "FORCES",
        "CHRISTOFFEL",
        "SECTIONS",
        "push",
        "b.e:1,0,0",
        "\nB.angle",
    ):
        assert words in text


def test_units_of_tables(heun: Heun, pendulum: str) -> None:
    """Values, rates, forces and energies in the units asked for; inertias stay."""
    si, other = (heun("lagrange", pendulum, *words).stdout for words in ((), ("--units", "deg,kN,mm")))
    row = [next(line for line in text.splitlines() if line.startswith("A.angle")).split()[1:] for text in (si, other)]
    by = (180 / np.pi, 180 / np.pi, 1, 1, 1, 1, 180 / np.pi)
    assert [float(x) * y for x, y in zip(row[0], by, strict=True)] == pytest.approx(list(map(float, row[1])), rel=1e-5)
    assert "q [deg]" in other and "p = ∂E/∂q' [kN·mm·s]" in other and "A.angle [kN·mm]" in other
    part = [text[text.index("MASS") : text.index("FORCES")] for text in (si, other)]
    assert part[0] == part[1]
    wrong = heun("lagrange", pendulum, "--units", "deg,kg")
    assert wrong.returncode == 2 and "--units deg,kg" in wrong.stderr
    told = heun("lagrange", pendulum, "--units", "deg", "--format", "csv")
    assert told.returncode == 0 and "csv stays in SI" in told.stderr and ",rad," in told.stdout


def test_units_of_a_course(heun: Heun) -> None:
    words = (
        "lagrange",
        str(ROOT / "specs/slider_crank.yaml"),
        "--over",
        "main.angle=0:180deg/7",
        "--units",
        "deg,rpm,kN,mm",
    )
    text = heun(*words).stdout
    assert "largest 0.0266127 kg·m² at 60 deg" in text and "q' = 954.93 rpm" in text and "k [kN·mm]" in text


def test_drives_along_other_coordinates(heun: Heun) -> None:
    """The pins' angles in place of the cylinders' lengths: their moments hold those of the weights, by hand."""
    words = ("lagrange", str(EXCAVATOR), "--coordinates", "foot.angle,elbow.angle")
    found = json.loads(heun(*words, "--format", "json").stdout)
    assert found["drives"] == pytest.approx([7720 * 9.81, 1120 * 9.81], rel=1e-12) and found["residual"] < 1e-12
    assert found["energy"] == {"total": 0.0, "free": None, "mixed": None, "driven": None}
    refused = heun(*words, "--state-space")
    assert (
        refused.returncode == 3
        and "boom_cylinder.length, stick_cylinder.length: driven coordinates must" in refused.stderr
    )


def test_friction_that_sticks_is_locked(heun: Heun) -> None:
    """The block on the belt moves with it: the mass of both, seen from the belt."""
    scene = str(EXCAVATOR.with_name("stick_slip.yaml"))
    found = json.loads(heun("lagrange", scene, "--only", "mass", "--format", "json").stdout)
    assert found["coordinates"] == ["run.travel"]
    assert np.ravel(found["epsilon"]) == pytest.approx([3.0])


def test_a_length_that_is_seen(heun: Heun) -> None:
    """A cylinder's stroke is seen in kg, chosen or not."""
    words = ("lagrange", str(EXCAVATOR), "--seen", "boom_cylinder.length,foot.angle", "--format", "json")
    one, two = (json.loads(heun(*words, "--coordinates", own).stdout)["seen"] for own in (
        "foot.angle,stick_cylinder.length", "boom_cylinder.length,stick_cylinder.length",
    ))  # fmt: skip
    assert one["boom_cylinder.length"]["unit"] == "kg" and one["foot.angle"]["unit"] == "kg·m²"
    assert one["boom_cylinder.length"]["free"] == pytest.approx(two["boom_cylinder.length"]["free"], rel=1e-12)


def test_only_some_parts(heun: Heun, pendulum: str) -> None:
    text = heun("lagrange", pendulum, "--only", "mass,forces").stdout
    assert "MASS" in text and "FORCES" in text and "INVERSE" not in text and "LAGRANGE" not in text
    found = json.loads(heun("lagrange", pendulum, "--only", "mass", "--format", "json").stdout)
    assert found.keys() >= {"coordinates", "epsilon", "seen"} and "eta" not in found
    assert {key for keys in KEYS.values() for key in keys} <= NAMES | {"values", "blows"}


def test_a_script_for_matlab(heun: Heun, pendulum: str, folder: Path) -> None:
    done = heun("lagrange", pendulum, "--state-space", "--at", "0", "-o", "double.m")
    assert done.returncode == 0
    text = (folder / "double.m").read_text()
    assert "A = [" in text and "inputs = {'push'};" in text
    linear = json.loads(heun("lagrange", pendulum, "--state-space", "--format", "json").stdout)["state_space"]
    rows = text.split("A = [")[1].split("]")[0].split(";")
    assert [[float(x) for x in row.split()] for row in rows] == linear["A"]


WITHOUT_A_VALUE = {
    "bushing": "bushing, from: ground.O, to: a.o, turning: 20",
    "spring": "spring, from: ground.P, to: a.c, stiffness: 20, length: 0",
    "turn spring": "turn_spring, joint: p, stiffness: 20, angle: 0",
    "damper": "damper, joint: p, coefficient: 20",
    "distributed": "distributed, on: a, from: o, to: c, vector: [0, -1, 0]",
    "friction of what presses": "friction, joint: p, coefficient: 0.1, radius: 0.01, speed: 0.1",
}
ON_A_PIN = """
heun: 1
ground: {{points: {{O: [0, 0, 0], P: [2, 0, 0]}}}}
bodies:
  a: {{mass: 1, center: [0, 0, 0], inertia: [1, 1, 1], points: {{o: [0, 0, 0], c: [1, 0, 0]}}}}
joints: {{p: {{type: pin, from: ground.O, to: a.o, axis: [0, 0, 1]}}}}
forces:
  b: {{type: {load}}}
  f: {{type: torque, joint: p, value: 1}}
analysis: {{type: state}}
"""


@pytest.mark.parametrize("kind", WITHOUT_A_VALUE)
def test_loads_without_a_value_are_no_inputs(heun: Heun, folder: Path, kind: str) -> None:
    (folder / "pin.yaml").write_text(ON_A_PIN.format(load=WITHOUT_A_VALUE[kind]))
    refused = heun("lagrange", "pin.yaml", "--state-space", "--inputs", "b")
    assert refused.returncode == 3 and "hint:" in refused.stderr
    if kind.startswith("friction"):  # hangs on the inputs: no state space at all
        return
    assert "known inputs: f" in refused.stderr
    found = json.loads(heun("lagrange", "pin.yaml", "--state-space", "--format", "json").stdout)["state_space"]
    assert found["inputs"] == ["f"] and found["B"] == [[0.0], [1.0]]
    if kind == "bushing":
        assert found["A"] == [[0.0, 1.0], [-20.0, 0.0]]


@pytest.mark.heavy
def test_over_in_all_forms(heun: Heun) -> None:
    spec, words = str(ROOT / "specs" / "slider_crank.yaml"), "main.angle=0:90deg/4"
    found = json.loads(heun("lagrange", spec, "--over", words, "--format", "json").stdout)
    assert found["over"]["coordinate"] == "main.angle" and len(found["over"]["values"]) == 4
    assert np.shape(found["epsilon"]) == (4, 1, 1)
    rows = list(csv.DictReader(io.StringIO(heun("lagrange", spec, "--over", words, "--format", "csv").stdout)))
    told = [float(row["value"]) for row in rows if row["quantity"] == "epsilon"]
    assert told == np.ravel(found["epsilon"]).tolist()
    assert "1.0472" in heun("lagrange", spec, "--over", words).stdout


@pytest.mark.parametrize(
    ("words", "code", "says"),
    [
        (["--coordinates", "A.angel,B.angle"], 3, "A.angel"),
        (["--coordinates", "A.angle"], 3, "2 degrees of freedom, but 1 coordinate named"),
        (["--seen", "b.f:1,0,0"], 3, "b.f"),
        (["--seen", "b.e:1,0"], 2, "three numbers"),
        (["--over", "A.angle=0:1"], 3, "something is still free"),
        (["--over", "A.angle=0"], 2, "FROM:TO"),
        (["--over", "A.angle=0:1 kg"], 2, "kg"),
        (["--over", "A.angle=0:1", "--christoffel"], 2, "--over and --christoffel"),
        (["--only", "masses"], 2, "masses"),
        (["--inputs", "push"], 2, "without --state-space"),
        (["--state-space", "--inputs", "pull"], 3, "pull"),
        (["--state-space", "--outputs", "b.e.q"], 3, "b.e.q"),
        (["--at", "-1"], 2, "--at"),
    ],
)
def test_what_is_refused(heun: Heun, pendulum: str, words: list[str], code: int, says: str) -> None:
    done = heun("lagrange", pendulum, *words)
    assert done.returncode == code and done.stdout == ""
    assert says in done.stderr and "hint:" in done.stderr


def test_coordinates_that_all_stand(heun: Heun) -> None:
    done = heun("lagrange", str(ROOT / "specs" / "table.yaml"), "--coordinates", "A.x,A.y,A.dz")
    assert done.returncode == 3 and "cannot describe the motion here" in done.stderr and "(dead centre)" in done.stderr


@pytest.mark.heavy
@pytest.mark.parametrize("path", SPECS, ids=lambda path: path.stem)
@pytest.mark.third
def test_every_spec_has_its_equations(path: Path) -> None:
    try:
        found = solve_lagrange(load(str(path), checking=False), LagrangeOptions())
    except HeunError as error:
        assert path.stem in NOTHING_FREE, error
        return
    assert path.stem not in NOTHING_FREE
    assert found.residual < 1e-12
    assert np.linalg.eigvalsh(found.epsilon).min() > 0.0
