"""Decks read back line by line: every number of the cases stands there, by the sign that each program gives it."""

from __future__ import annotations

import csv
import json
import re
from collections.abc import Callable, Iterator
from functools import cache
from io import StringIO
from typing import Any, NamedTuple

import numpy as np
import pytest

from heuncli.analyses.load_cases.model import LoadCase, LoadCases, LoadedBody
from heuncli.analyses.load_cases.solid_mesh import SolidMesh, read_mesh
from heuncli.analyses.load_cases.unit_systems import convert_load_cases, parse_units
from heuncli.app.commands.export import FORMATS
from heuncli.base.records import replace
from heuncli.output.fe_decks import nastran
from heuncli.output.fe_decks.decks import DECKS, DeckNames, format_exact
from heuncli.results.results import Array
from heuncli.scene.shapes.rotations import cross_vectors
from tests.shared.load_cases import cases_of, point_masses
from tests.shared.scenes import moving, near, study
from tests.shared.trees import tree_scene

NAMES = DeckNames(2001, "ROD_ALL")
UNITS = parse_units("N,mm,t")
SEEDS = (1, 3, 6)


@cache
def written_cases(seed: int) -> tuple[LoadCases, ...]:
    """The cases of all bodies of a random tree, in N, mm, t."""
    scene, _ = tree_scene(seed)
    run = study(moving(scene, (0.0, 0.1, 0.3)))
    return tuple(convert_load_cases(cases_of(run, name, "first,0.1,last"), UNITS) for name in scene["bodies"])


class ReadCase(NamedTuple):
    """What a deck says of a case: forces and moments at nodes, a - g, w and u, by the signs of its program."""

    forces: dict[int, Array]
    moments: dict[int, Array]
    linear: Array
    velocity: Array
    acceleration: Array

    @staticmethod
    def empty() -> ReadCase:
        return ReadCase({}, {}, np.zeros(3), np.zeros(3), np.zeros(3))


class ReadDeck(NamedTuple):
    """The nodes of a deck, and its cases."""

    nodes: dict[int, Array]
    cases: list[ReadCase]


def text_of(form: str, cases: LoadCases) -> str:
    names = NAMES._replace(mesh=tetrahedron(cases.body)) if form == "calculix" else NAMES
    return "".join(DECKS[form].iter_text(cases, names))


def tetrahedron(body: LoadedBody) -> SolidMesh:
    """One of even density, with the body's centre of mass and second moments: numbered from 1 on.

    With corners s + A v, v = (1, 1, 1), (1, -1, -1), ... its second moments about s are m/5 A A'.
    """
    T = 0.5 * np.trace(body.inertia) * np.eye(3) - body.inertia
    A = np.linalg.cholesky(5.0 * T / body.mass)
    corners = body.center + np.array([[1, 1, 1], [1, -1, -1], [-1, 1, -1], [-1, -1, 1]]) @ A.T
    lines = ["*NODE", *(f"{i}, {x!r}, {y!r}, {z!r}" for i, (x, y, z) in enumerate(corners.tolist(), start=1))]
    return read_mesh("\n".join([*lines, "*ELEMENT, TYPE=C3D4", "1, 1, 2, 3, 4"]), "mesh.inp")


def read_ansys(cases: LoadCases) -> ReadDeck:
    deck = ReadDeck({}, [])
    for line in text_of("ansys", cases).splitlines():
        command, *words = line.split(",")
        if command == "N":
            deck.nodes[int(words[0])] = np.array([float(x) for x in words[1:]])
        elif command == "TIME":
            deck.cases.append(ReadCase.empty())
        elif command == "F":
            kind, axis = words[1][0], "XYZ".index(words[1][1])
            box = deck.cases[-1].forces if kind == "F" else deck.cases[-1].moments
            box.setdefault(int(words[0]), np.zeros(3))[axis] = float(words[2])
        elif command in (fields := {"ACEL": "linear", "OMEGA": "velocity", "DOMEGA": "acceleration"}):
            getattr(deck.cases[-1], fields[command])[:] = [float(x) for x in words]
        else:
            assert command.startswith(("!", "/", "FINISH", "ANTYPE", "FDELE", "LSWRITE")), line
    return deck


def read_input(form: str, cases: LoadCases) -> ReadDeck:
    """A deck of Abaqus or CalculiX, of the latter with the nodes of its mesh."""
    deck, keyword = ReadDeck({}, []), ""
    if form == "calculix":
        deck.nodes.update(enumerate(tetrahedron(cases.body).places, start=1))
    for line in text_of(form, cases).splitlines():
        if line.startswith("**"):
            continue
        if line.startswith("*"):
            keyword = line.split(",")[0]
            if keyword == "*STEP":
                deck.cases.append(ReadCase.empty())
            continue
        words = [word.strip() for word in line.split(",")]
        if keyword == "*NODE":
            deck.nodes[int(words[0])] = np.array([float(x) for x in words[1:]])
        elif keyword == "*CLOAD":
            freedom = int(words[1]) - 1
            box = deck.cases[-1].forces if freedom < 3 else deck.cases[-1].moments
            box.setdefault(int(words[0]), np.zeros(3))[freedom % 3] = float(words[2])
        else:
            assert keyword == "*DLOAD" and words[0] == NAMES.elements, line
            size, rest = float(words[2]), np.array([float(x) for x in words[3:]])
            case = deck.cases[-1]
            if words[1] == "GRAV":  # a load along its direction
                case.linear[:] = -size * rest
            else:
                assert not rest[:3].any()  # through the origin
                box_of = {"CENTRIF": (case.velocity, np.sqrt(size)), "ROTA": (case.acceleration, size)}
                box_of[words[1]][0][:] = box_of[words[1]][1] * rest[3:]
    return deck


def read_nastran(cases: LoadCases) -> ReadDeck:
    """By columns: eight for the name, then four fields of sixteen; a number's exponent may lack its e."""
    lines = text_of("nastran", cases).splitlines()
    bulk = [line for line in lines[lines.index("BEGIN BULK") + 1 :] if not line.startswith(("$", "ENDDATA"))]
    cards: list[list[str]] = []
    for line in bulk:
        assert len(line) <= 72
        fields = [line[8 + 16 * i : 24 + 16 * i].strip() for i in range(4)]
        if line.startswith("*"):
            cards[-1] += fields
        else:
            cards.append([line[:8].strip().rstrip("*"), *fields])
    deck = ReadDeck({}, [ReadCase.empty() for _ in cases.cases])
    sums = {int(card[1]): [int(x) for x in card[4::2] if x] for card in cards if card[0] == "LOAD"}
    whole = {member: number for number, members in sums.items() for member in members}
    for name, *fields in cards:
        if name == "GRID":
            deck.nodes[int(fields[0])] = np.array([real(x) for x in fields[2:5]])
            continue
        if name == "LOAD":
            assert all(real(x) == 1.0 for x in [fields[1], *fields[2::2]] if x)
            continue
        case = deck.cases[whole[int(fields[0])] // 10 - 1]
        if name in ("FORCE", "MOMENT"):
            assert real(fields[3]) == 1.0 and fields[2] == "0"
            box = case.forces if name == "FORCE" else case.moments
            box[int(fields[1])] = np.array([real(x) for x in fields[4:7]])
        elif name == "GRAV":
            case.linear[:] = -real(fields[2]) * np.array([real(x) for x in fields[3:6]])
        else:
            assert name == "RFORCE" and fields[1:3] == ["0", "0"]
            axis, A = np.array([real(x) for x in fields[4:7]]), real(fields[3])
            if A:
                case.velocity[:] = 2 * np.pi * A * axis
            else:  # along the angular acceleration, against its load
                case.acceleration[:] = -2 * np.pi * real(fields[8]) * axis
    return deck


def real(text: str) -> float:
    return float(re.sub(r"(?<=[\d.])([+-]\d+)$", r"e\1", text))


READERS: dict[str, Callable[[LoadCases], ReadDeck]] = {
    "ansys": read_ansys,
    "nastran": read_nastran,
    "abaqus": lambda cases: read_input("abaqus", cases),
    "calculix": lambda cases: read_input("calculix", cases),
}
DIGITS = {"nastran": 1e-11}  # large fields have twelve digits


@pytest.mark.parametrize("form", READERS)
@pytest.mark.parametrize("seed", SEEDS)
@pytest.mark.third
def test_a_deck_has_the_numbers(form: str, seed: int) -> None:
    """Forces at nodes add up to those of the case at their places, the accelerations are those of the case."""
    for cases in written_cases(seed):
        deck = READERS[form](cases)
        assert len(deck.cases) == len(cases.cases)
        assert min(n for n in deck.nodes if n > 4) == NAMES.first_node
        for case, told in zip(cases.cases, deck.cases, strict=True):
            compare(cases, case, deck, told, DIGITS.get(form, 1e-12))
            balanced(cases, case, deck, told, 1e-9)


def compare(cases: LoadCases, case: LoadCase, deck: ReadDeck, told: ReadCase, tolerance: float) -> None:
    sums = cases.body.compute_sums(case)
    linear = case.field.linear
    if 1 not in deck.nodes:  # else it stands as forces at the nodes of the mesh, which have to balance the case
        near(told.acceleration, case.field.angular_acceleration, 1.0 + rate(case), tolerance)
    near(told.linear, linear, 1.0 + float(np.abs(linear).max()), tolerance)
    spin = told.velocity * np.sign(told.velocity @ case.field.angular_velocity)  # CENTRIF has no sense of turning
    near(spin, case.field.angular_velocity, 1.0 + rate(case), tolerance)
    places = {n: x for n, x in deck.nodes.items() if n >= NAMES.first_node}
    for action in case.actions:
        (node,) = [n for n, x in places.items() if np.allclose(x, action.at, atol=1e-9)]
        here = [a for a in case.actions if np.array_equal(a.at, action.at)]
        force, moment = (sum(getattr(a, of) for a in here) for of in ("force", "moment"))
        near(told.forces.get(node, np.zeros(3)), force, sums.largest_force, tolerance)
        near(told.moments.get(node, np.zeros(3)), moment, sums.largest_moment, tolerance)


def rate(case: LoadCase) -> float:
    return float(np.abs([case.field.angular_velocity, case.field.angular_acceleration]).max())


def balanced(cases: LoadCases, case: LoadCase, deck: ReadDeck, told: ReadCase, tolerance: float) -> None:
    """The deck alone, on a mesh that is the body: what its cards make of point masses sums up to nothing."""
    masses, places = point_masses(cases.body)
    w, u = told.velocity, told.acceleration
    inertia = [
        -m * (told.linear + cross_vectors(u, x) + cross_vectors(w, cross_vectors(w, x)))
        for m, x in zip(masses, places, strict=True)
    ]
    force = np.sum([*told.forces.values(), *inertia], axis=0)
    moments = [*told.moments.values(), *(cross_vectors(deck.nodes[n], F) for n, F in told.forces.items())]
    moment = np.sum([*moments, *(cross_vectors(x, F) for x, F in zip(places, inertia, strict=True))], axis=0)
    sums = cases.body.compute_sums(case)
    near(force, 0.0, sums.largest_force, tolerance)
    near(moment, 0.0, sums.largest_moment, tolerance)


@pytest.mark.parametrize("seed", SEEDS)
def test_csv_and_json_have_the_numbers(seed: int) -> None:
    """All digits, a row a vector; and as one object."""
    for cases in written_cases(seed):
        rows = list(csv.DictReader(text_of("csv", cases).splitlines()))
        whole = json.loads(text_of("json", cases))
        assert [case["name"] for case in whole["cases"]] == [case.name for case in cases.cases]
        for case, block in zip(cases.cases, whole["cases"], strict=True):
            own = [row for row in rows if row["case"] == case.name]
            for of in ("force", "moment"):
                told = [vector(row) for row in own if row["quantity"] == of and row["kind"] not in ("sum", "inertia")]
                assert told == [list(getattr(action, of) + 0.0) for action in case.actions]
                assert told == [[x + 0.0 for x in load[of]] for load in block["loads"]]
            (origin,) = [vector(row) for row in own if row["quantity"] == "acceleration"]
            assert origin == list(case.field.origin) == block["origin"]["acceleration"]
            (sums,) = [row for row in own if row["kind"] == "sum" and row["quantity"] == "force"]
            assert np.abs(vector(sums)).max() <= 1e-9 * cases.body.compute_sums(case).largest_force
            assert {row["unit"] for row in own if row["quantity"] == "moment"} == {"N*mm"}


def vector(row: dict[str, str]) -> list[float]:
    return [float(row[axis]) for axis in "xyz"]


@pytest.mark.heavy
def test_nastran_by_pynastran(monkeypatch: pytest.MonkeyPatch) -> None:
    """pyNastran reads a deck, masses beside it, and sums forces and moments up; what masses feel is added."""
    monkeypatch.setattr(np, "in1d", np.isin, raising=False)  # a name that NumPy 2.4 dropped
    bdf = pytest.importorskip("pyNastran.bdf.bdf", reason="pyNastran is not installed")
    from pyNastran.bdf.mesh_utils.loads import sum_forces_moments as summed

    for cases in written_cases(6):
        model = bdf.BDF(debug=None)
        masses, places = point_masses(cases.body)
        text = text_of("nastran", cases)
        model.read_bdf(StringIO(text), xref=False)
        assert sorted(model.subcases) == [0, *range(1, len(cases.cases) + 1)]
        for k, (m, x) in enumerate(zip(masses, places, strict=True)):
            model.add_grid(1 + k, x)
            model.add_conm2(1 + k, 1 + k, m)
        model.cross_reference()
        for k, case in enumerate(cases.cases, start=1):
            assert model.subcases[k]["LOAD"][0] == 10 * k
            force, moment = summed(model, np.zeros(3), 10 * k)
            loads, factors, _ = model.get_reduced_loads(10 * k)
            assert set(factors) == {1.0}
            for card in loads:
                for mass in model.masses.values():
                    F = mass.Mass() * pushed(card, mass.Centroid())
                    force, moment = force + F, moment + cross_vectors(mass.Centroid(), F)
            sums = cases.body.compute_sums(case)
            near(force, 0.0, sums.largest_force)
            near(moment, 0.0, sums.largest_moment)


def pushed(card: Any, x: Array) -> Array:
    """The load per mass of a card of inertia at a place."""
    if card.type == "GRAV":
        return np.asarray(card.GravityVector())
    if card.type != "RFORCE":
        return np.zeros(3)
    w, u = (2 * np.pi * size * np.array(card.r123) for size in (card.scale, card.racc))
    return np.asarray(cross_vectors(u, x) - cross_vectors(w, cross_vectors(w, x)))


HOSTILE = (
    "x\nFORCE,11,1,0,1.E9,1.,0.,0.\nENDDATA",
    "y $ FDELE,ALL ! z",
    "*STEP, NAME=a\r*DLOAD\u2028*END STEP",
    "größe 長さ \u202e " + "a" * 1000,
    "",
)


@pytest.mark.parametrize("form", READERS)
def test_no_name_becomes_a_card(form: str) -> None:
    """Titles, file names and names of cases that would be cards are comments; the numbers stay."""
    cases = written_cases(6)[0]
    plain = READERS[form](cases)
    for word in HOSTILE:
        foreign = replace(
            cases, title=word, spec=word, split=word, body=replace(cases.body, name=word),
            cases=tuple(replace(case, name=word) for case in cases.cases),
        )  # fmt: skip
        told = READERS[form](foreign)
        assert np.array_equal([*told.nodes.values()], [*plain.nodes.values()])
        for a, b in zip(plain.cases, told.cases, strict=True):
            assert np.array_equal(a.linear, b.linear)
            assert a.forces.keys() == b.forces.keys()
            assert np.array_equal([*a.forces.values()], [*b.forces.values()])
        assert text_of(form, foreign).isascii()
        comments = [line for line in text_of(form, foreign).splitlines() if line.startswith(MARKS[form])]
        assert max(map(len, comments)) <= 80
        assert commands(form, foreign) == commands(form, cases)


MARKS = {"ansys": "!", "nastran": "$", "abaqus": "**", "calculix": "**"}


def commands(form: str, cases: LoadCases) -> list[str]:
    """The lines that are no comments, without the names of steps."""
    lines = text_of(form, cases).splitlines()
    return [re.sub(r"(NAME|SUBTITLE)\s*=\s*\w+", r"\1", line) for line in lines if not line.startswith(MARKS[form])]


def test_numbers_have_room() -> None:
    """Of all magnitudes and signs, with a point: twelve digits and more in 20 characters, eleven in a large field."""
    rng = np.random.default_rng(0)
    for x in [0.0, -0.0, 0.3, 0.1 + 0.2, 6000.000000000001, *numbers(rng)]:
        for text, room, digits in ((nastran.format_real(x), 16, 1e-10), (format_exact(x), 20, 1e-12)):
            assert len(text) <= room and "." in text
            assert abs(real(text) - x) <= digits * abs(x)
        assert nastran.parse_real(nastran.format_real(x)) == real(nastran.format_real(x))


def numbers(rng: np.random.Generator) -> Iterator[float]:
    for _ in range(500):
        yield float(rng.normal() * 10.0 ** rng.integers(-60, 60))


def test_the_command_names_the_forms_that_there_are() -> None:
    """`--help` loads none of what writes them, so that their names stand twice."""
    assert tuple(DECKS) == FORMATS
