"""What is no load case is refused with a hint: open reactions, instants beyond the horizon, units of no system."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from heuncli.analyses.load_cases.assembly import require_balance
from heuncli.analyses.load_cases.solid_mesh import read_mesh
from heuncli.analyses.load_cases.unit_systems import SI, parse_units
from heuncli.base.errors import Finding, SolveError
from heuncli.base.records import replace
from tests.shared.command import Heun
from tests.shared.load_cases import cases_of
from tests.shared.scenes import study

DOOR = """\
heun: 1
gravity: [0, 0, -9.81]
ground: {points: {A: [0, 0, 0], B: [0, 0, 2]}}
bodies:
  door: {mass: 5, center: [0.5, 0, 1], inertia: [3, 4, 1], points: {a: [0, 0, 0], b: [0, 0, 2]}}
joints:
  bottom: {type: pin, axis: [0, 0, 1], from: ground.A, to: door.a}
  top: {type: pin, axis: [0, 0, 1], from: ground.B, to: door.b}
"""
BEAM = """\
heun: 1
gravity: [0, 0, -9.81]
ground: {points: {O: [0, 0, 0]}}
bodies:
  beam:
    shapes: [{type: rod, from: [0, 0, 0], to: [2, 0, 0], mass: 6}]
    points: {root: [0, 0, 0], p: [0.5, 0, 0], q: [1.5, 0, 0]}
joints: {wall: {type: weld, from: ground.O, to: beam.root}}
forces:
  snow: {type: distributed, on: beam, from: p, to: q, vector: [0, 0, -30], to_vector: [0, 0, -90]}
  twist: {type: couple, on: beam, vector: [7, 0, 0]}
"""


@pytest.fixture
def export(heun: Heun, folder: Path) -> Heun:
    """`heun export loads` in a folder of specs."""
    (folder / "door.yaml").write_text(DOOR)
    (folder / "beam.yaml").write_text(BEAM)
    return lambda *words: heun("export", "loads", *words)


REFUSED = [
    ("door.yaml", 3, "open-load-case", "determinate: joints.bottom.force.z + joints.top.force.z = 49.05"),
    ("door.yaml --body dor", 2, "bad-option", "did you mean door?"),
    ("hanging.yaml --at peak", 2, "bad-option", "expected a number, first, last, peak:PATH"),
    ("hanging.yaml --at lst", 2, "bad-option", "did you mean last?"),
    ("hanging.yaml --at joints.pivot.force", 2, "bad-option", "did you mean peak:joints.pivot.force?"),
    ("swinging.yaml", 2, "bad-option", "no instants are given"),
    ("swinging.yaml --at peak:joints.pivto.force", 2, "unknown-path", "did you mean pivot?"),
    ("swinging.yaml --at 1.5", 2, "bad-option", "the run goes from 0 to 1 s"),
    ("swinging.yaml --at impulse:0", 2, "bad-option", "there is no such impulse"),
    ("swinging.yaml --at last --case all", 2, "bad-option", "a deck holds one load case"),
    ("hanging.yaml --units N,mm,kg", 2, "bad-option", "--units N,mm,t"),
    ("hanging.yaml --units N,mm", 2, "bad-option", "no unit for a mass"),
    ("hanging.yaml -o loads.inp", 2, "bad-option", "--format calculix or --format abaqus"),
    ("hanging.yaml -o loads.xyz", 2, "bad-option", "unknown file extension"),
    ("hanging.yaml -o hanging.yaml --format csv", 2, "bad-option", "would overwrite the spec itself"),
    ("swinging.yaml --at last --format calculix", 2, "bad-option", "--mesh FILE"),
    ("swinging.yaml --at last --format calculix --mesh none.inp", 2, "bad-mesh", "No such file"),
    ("swinging.yaml --at last --format ansys --mesh hanging.yaml", 2, "bad-option", "leave it out"),
    ("hanging.yaml --first-node 0", 2, "bad-option", "expected a whole number"),
    ("hanging.yaml --elements A,B", 2, "bad-option", "expected a letter, then letters"),
]


@pytest.mark.parametrize(("words", "code", "name", "told"), REFUSED, ids=[row[0] for row in REFUSED])
def test_refused(export: Heun, words: str, code: int, name: str, told: str) -> None:
    done = export(*words.split())
    assert done.returncode == code and done.stdout == ""
    assert f"[{name}]" in done.stderr and told in done.stderr and "hint:" in done.stderr


def test_a_split_is_told(export: Heun) -> None:
    done = export("door.yaml", "--least-norm", "--format", "abaqus")
    assert done.returncode == 0
    assert "distribution of indeterminate reactions" in done.stdout


def test_a_blow_in_a_deck_takes_its_time(export: Heun, folder: Path) -> None:
    """Impulses in N s as they are; over a time as the mean forces, which a deck says."""
    blow = "impulses: {hit: {on: bar.tip, vector: [0, 3, 0], time: 0}}\n"
    scene = (folder / "hanging.yaml").read_text().replace("top: [0, 0, 0]", "top: [0, 0, 0], tip: [0, 0, -1]") + blow
    (folder / "hit.yaml").write_text(scene)
    told = export("hit.yaml").stdout
    assert "impulse:0,0.0,impulse,hit,outside,tip,force,N*s,0.0,3.0,0.0" in told
    assert "angular_velocity_jump,rad/s" in told
    done = export("hit.yaml", "--format", "ansys")
    assert done.returncode == 2 and "--blow-over SECONDS" in done.stderr
    deck = export("hit.yaml", "--format", "ansys", "--blow-over", "0.002").stdout
    assert "an impulse as its mean force over 0.002 s" in deck
    assert ",FY,1500.0\n" in deck


def test_a_distributed_load_stands_along_its_line(export: Heun) -> None:
    """q from 30 to 90 N/m from 0.5 to 1.5 m: 60 N at 7/12 of it, exact moments at the ends of the pieces; q there."""
    lines = export("beam.yaml").stdout.splitlines()
    own = [line.split(",") for line in lines if ",snow," in line]
    x = np.array([float(row[8]) for row in own if row[6] == "position"])
    F, q = (np.array([float(row[10]) for row in own if row[6] == of]) for of in ("force", "force_per_length"))
    assert np.allclose(x, np.linspace(0.5, 1.5, 11)) and np.allclose(q, -np.linspace(30, 90, 11))
    assert F.sum() == pytest.approx(-60.0) and x @ F == pytest.approx(-60.0 * (0.5 + 7 / 12))
    middle = ["", "", "", "", "center of mass", "", "", "", ""]
    for at in x:  # of q = 30 + 60 s, s from 0.5 m on, the moment about a place of what lies beyond it
        s, beyond = at - 0.5, x >= at
        exact = 15.0 * (1 - s) ** 2 + 60.0 * ((1 - s**3) / 3 - s * (1 - s**2) / 2)
        assert (x[beyond] - at) @ F[beyond] == pytest.approx(-exact, abs=1e-12)
    assert [row[5] for row in own if row[6] == "position"] == ["p", *middle, "q"]
    assert [line.split(",")[5] for line in lines if ",twist," in line] == ["center of mass"] * 3


def test_beyond_the_horizon(export: Heun, folder: Path) -> None:
    """Of a chaotic run nothing is claimed late: neither an instant nor the largest of it all."""
    links = "".join(
        f"  b{i}: {{mass: 1, center: [0, 0, -0.5], inertia: [0.08, 0.09, 0.01],"
        f" points: {{a: [0, 0, 0], b: [0, 0, -1]}}, orientation: {{axis: [1, 0.2, 0], angle: {100 + 30 * i} deg}}}}\n"
        for i in range(3)
    )
    joints = "".join(f"  j{i}: {{type: ball, from: b{i - 1}.b, to: b{i}.a}}\n" for i in (1, 2))
    head = "heun: 1\ngravity: [0, 0, -9.81]\nground: {points: {O: [0, 0, 0]}}\nbodies:\n"
    scene = f"{head}{links}joints:\n  j0: {{type: ball, from: ground.O, to: b0.a}}\n{joints}"
    (folder / "chaos.yaml").write_text(scene + "analysis: {duration: 25, samples: 26}\n")
    for at in ("last", "peak:joints.j0.force"):
        done = export("chaos.yaml", "--body", "b2", "--at", at)
        assert done.returncode == 3 and "[beyond-horizon]" in done.stderr, done.stderr
    assert export("chaos.yaml", "--body", "b2", "--at", "2").returncode == 0


def test_a_case_that_does_not_balance_is_refused() -> None:
    """One sign of one force, or a millionth of it, and the case is none."""
    cases = cases_of(study(BEAM), "beam", "first")
    (case,) = cases.cases
    require_balance(cases.body, case)
    first, *others = case.actions
    for factor in (-1.0, 1.0 + 1e-6):
        wrong = replace(case, actions=(replace(first, force=factor * first.force), *others))
        with pytest.raises(SolveError, match="unbalanced-load-case"):
            require_balance(cases.body, wrong)


SYSTEMS = ["N,mm,t", "N,m,kg", "kN,m,t", "lbf,in,slinch", "lbf,ft,slug", "kN,mm,kg,ms", "t,N,mm", "mN,mm,kg"]


@pytest.mark.parametrize("words", SYSTEMS)
def test_units_that_go_together(words: str) -> None:
    """Force is mass times length over time squared, in numbers."""
    found = parse_units(words)
    assert found.force == pytest.approx(found.mass * found.length / found.time**2, rel=1e-12)
    assert sorted(found.names[:3]) == sorted(words.split(",")[:3])


@pytest.mark.parametrize(
    "words", ["N,mm,kg", "N,cm,t", "lbf,in,lb", "lbf,ft,lb", "N,m,kg,ms", "N,N,m", "N,m", "Nm,m,kg"]
)
def test_units_that_do_not(words: str) -> None:
    with pytest.raises(Finding) as raised:
        parse_units(words)
    assert "--units" in raised.value.hint


def test_si_is_the_default() -> None:
    assert parse_units("N,m,kg") == SI


MESHES = [
    ("*NODE\n1, 0, 0, 0\n*ELEMENT, TYPE=S4\n1, 1, 1, 1, 1\n", "type S4"),
    ("*NODE\n1, 0, 0, 0\n*ELEMENT, TYPE=C3D4\n1, 1, 2, 3, 4\n", "node 2 of an element"),
    ("*NODE\n1, 0, 0, 0\n*ELEMENT, TYPE=C3D4\n1, 1, 1, 1\n", "an element with 4 nodes lists 3"),
    ("*NODE\n1, 0, 0, 0\n*ELEMENT, TYPE=C3D4\n1, 1, 1, 1, 1\n", "no volume"),
    ("*NODE\n1, 0, 0, nan\n2, 1, 0, 0\n3, 0, 1, 0\n4, 0, 0, 1\n*ELEMENT, TYPE=C3D4\n1, 1, 2, 3, 4\n", "no volume"),
    ("*NODE\n1, x, 0, 0\n", "are not numbers"),
    ("*INCLUDE, INPUT=/etc/passwd\n", "INCLUDE is not followed"),
    ("", "no elements"),
    ("*ELEMENT, TYPE=C3D4\n1, 1, 2, 3,\n", "an element with 4 nodes lists 3"),
    ("*ELEMENT, TYPE=C3D4\n1, 1, 2, 3,\n*NODE\n", "an element with 4 nodes lists 3"),
    ("*NODE\n,,,\n", "mesh.inp:2: a node without a number"),
    ("*NODE, INPUT=nodes.inp\n", "NODE with INPUT is not followed"),
    ("*ELEMENT, TYPE=C3D4, input = e.inp\n", "ELEMENT with INPUT is not followed"),
]


@pytest.mark.parametrize(("text", "told"), MESHES, ids=[told for _, told in MESHES])
def test_meshes_that_are_none(text: str, told: str) -> None:
    with pytest.raises(Finding, match=told):
        read_mesh(text, "mesh.inp")


BRICK = np.array([[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0], [0, 0, 1], [1, 0, 1], [1, 1, 1], [0, 1, 1]], dtype=float)
BOX = "*NODE\n" + "".join(f"{i}, {x}, {2 * y}, {3 * z}\n" for i, (x, y, z) in enumerate(BRICK, start=1))
WEDGES = "*ELEMENT, TYPE=C3D6\n1, 1, 2, 3, 5, 6, 7\n2, 1, 3, 4, 5, 7, 8\n"


@pytest.mark.parametrize("elements", ["*ELEMENT, TYPE=C3D8R\n1, 1, 2, 3, 4,\n5, 6, 7, 8\n", WEDGES])
def test_a_box_of_solids_weighs_as_a_box(elements: str) -> None:
    """1 x 2 x 3 of mass 6: centre, inertia; and the nodal forces of an angular acceleration have that resultant."""
    mesh = read_mesh(BOX + elements, "mesh.inp")
    center, inertia = mesh.center_and_inertia(6.0)
    assert np.allclose(center, [0.5, 1.0, 1.5])
    assert np.allclose(inertia, np.diag([4 + 9, 1 + 9, 1 + 4]) * 6.0 / 12.0)
    u = np.array([0.3, -0.7, 1.1])
    F = mesh.nodal_forces(6.0, u)
    assert np.allclose(F.sum(axis=0), -6.0 * np.cross(u, center))
    about_origin = inertia + 6.0 * (center @ center * np.eye(3) - np.outer(center, center))
    assert np.allclose(np.cross(mesh.places, F).sum(axis=0), -about_origin @ u)
