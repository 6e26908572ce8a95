"""Words in place of paths: every quantity of the results has some, and a label takes the place of a name."""

from __future__ import annotations

import re

import pytest

from heuncli.results.results_schema import CUT, ROWS, Quantity
from heuncli.study.quantities.captions import (
    WORDS,
    describe_axis,
    describe_measure,
    describe_object,
    describe_path,
    describe_sentence,
    parse_path,
)
from heuncli.study.quantities.labels import ForceInfo, JointInfo, Labels

NAMES = {
    "POINT": "left_arm.upper_eye", "ELEMENT": "drives.main_motor", "JOINT": "front_left", "BODY": "left_arm",
    "SECTION": "long_bar", "CORNER": "top_left", "FORCE": "gas_spring", "CAUSE": "gas_spring", "STOP": "end_stop",
    "COUPLING": "first_gear",
    "END": "left_arm", "EVENT": "is_open", "NUMBER": "2", "SENSOR": "load_cell", "BEARING": "1",
}  # fmt: skip
LABELS = Labels(
    {"front_left": JointInfo("pin", "", ""), "guide": JointInfo("slide", "", "")},
    {"gas_spring": ForceInfo("spring"), "brake": ForceInfo("couple")},
    captions={
        "joints.main": "Main bearing", "bodies.crank": "Crankshaft", "points.crank.pin": "Crank pin",
        "drives.motor": "Motor", "forces.gas": "Gas pressure", "parameters.r": "Throw", "stops.catch": "Catch",
        "couplings.mesh": "First stage",
    },
)  # fmt: skip


def fill(row: Quantity) -> list[str]:
    """Paths of a quantity in a scene with names of two words: as a whole, and to one number."""
    path = ".".join(NAMES.get(word, word) for word in row.path.split("."))
    end = "".join(".3" if axis is CUT else f".{axis.make_labels(1)[0]}" for axis in row.shape)
    return list(dict.fromkeys((path, path + end)))


def test_every_quantity_has_words_of_its_own() -> None:
    lacking = []
    for row in ROWS:
        words = [word for word in row.path.split(".") if word not in NAMES]
        keys = (".".join(words[-2:]), f"{words[0]}.{words[-1]}", words[-1])
        lacking += [] if any(key in WORDS for key in keys) else [row.path]
    assert lacking == []


@pytest.mark.parametrize("row", ROWS, ids=lambda row: row.path)
def test_words_have_no_underscore_and_no_dot(row: Quantity) -> None:
    for path in fill(row):
        words = describe_path(path, LABELS)
        assert not re.search(r"[_.{}]", words)
        assert words == words.strip()
        parts = parse_path(path)
        assert parts is not None
        assert parts.row is row
        for placeholder in set(row.path.split(".")) & {"JOINT", "BODY", "SECTION", "FORCE", "STOP", "COUPLING"}:
            assert NAMES[placeholder].replace("_", " ") in words


def test_numbers_of_one_thing_have_different_words() -> None:
    """A legend can tell them apart."""
    by_words: dict[str, set[str]] = {}
    for row in ROWS:
        if row.units and not row.path.startswith(("coordinates", "impulses", "accuracy")):
            for path in fill(row):
                by_words.setdefault(describe_path(path, LABELS), set()).add(path)
    same = {words for words, paths in by_words.items() if len(paths) > 1}
    assert same <= {"gas spring, force"}  # the value of most loads, the vector of bushings


@pytest.mark.parametrize(
    ("path", "words"),
    [
        ("joints.main.radial", "Main bearing, radial force"),
        ("sections.root.stress.points.top_left.normal", "root, normal stress at top left"),
        ("joints.main.force", "Main bearing, force"),
        ("joints.main.force.x", "Main bearing, Fx"),
        ("joints.front_left.moment.z", "front left, Mz"),
        ("joints.front_left.drive", "front left, drive torque"),
        ("joints.guide.drive", "guide, drive force"),
        ("coordinates.main.angle", "Main bearing, angle"),
        ("bodies.crank.center_velocity.x", "Crankshaft, v x"),
        ("points.crank.pin.position.y", "Crank pin, position y"),
        ("points.crank.end.velocity", "Crankshaft end, velocity"),
        ("points.ground.O.position", "ground O, position"),
        ("forces.brake.value", "brake, torque"),
        ("forces.gas.value", "Gas pressure, force"),
        ("foundation.force.z", "foundation, Fz"),
        ("foundation.supports.main.force", "Main bearing on the ground, force"),
        ("foundation.elements.drives.motor.moment.x", "Motor on the ground, Mx"),
        ("foundation.shares.gas.force.x", "foundation, Fx due to Gas pressure"),
        ("foundation.elements.catch.force", "Catch on the ground, force"),
        ("sections.rod.M2.7", "rod, bending moment M2 at cut 7"),
        ("sections.rod.M2.7:before", "rod, bending moment M2 at cut 7, before the load"),
        ("sections.rod.M2@280mm", "rod, bending moment M2 at 280 mm"),
        ("sections.rod.N@0.28:beyond", "rod, axial force N at 0.28 m, beyond the load"),
        ("sections.rod.force@end.x", "rod, Fx at the end"),
        ("couplings.mesh.on.crank.force.z", "First stage on Crankshaft, Fz"),
        ("impulses.2.joints.main.force.x", "Main bearing, Fx at impulse 2"),
        ("impulses.0.energy_jump", "change of kinetic energy at impulse 0"),
        ("certain_sums.1.value", "determinate sum 1"),
        ("r", "Throw"),
        ("parameters.oil_film", "oil film"),
        ("bodies.crank.mass", "Crankshaft, mass"),
        ("energy.kinetic", "kinetic energy"),
    ],
)
def test_words_of_a_path(path: str, words: str) -> None:
    assert describe_path(path, LABELS) == words


def test_axes_measures_and_things() -> None:
    assert describe_axis("joints.main.force", LABELS, "kN") == "Main bearing, force [kN]"
    assert describe_axis("sections.rod.stress.utilisation", LABELS, "1") == "rod, utilisation"
    assert describe_measure("max abs joints.main.force", LABELS) == "Main bearing, force, greatest magnitude"
    assert describe_measure("at 0.5 energy.kinetic", LABELS) == "kinetic energy, at 0.5 s"
    assert describe_object("foundation", "", LABELS) == "foundation"
    assert describe_object("rolling", "mesh", LABELS) == "First stage"
    assert describe_object("cases", "full_load", LABELS) == "full load"


def test_a_label_of_one_quantity_is_its_words() -> None:
    labels = Labels(captions={"joints.main.radial": "Bearing load", "joints.main": "Main bearing"})
    assert describe_path("joints.main.radial", labels) == "Bearing load"
    assert describe_path("joints.main.axial", labels) == "Main bearing, axial force"


def test_names_of_quantities_do_not_mislead() -> None:
    """A joint called force, a body called shares."""
    assert describe_path("joints.force.force.x", LABELS) == "force, Fx"
    assert describe_path("joints.shares.shares.gravity.force", LABELS) == "shares, force due to gravity"


@pytest.mark.parametrize(
    ("said", "read"),
    [
        (
            "sections.long_bar: the plane meets the body crank twice",
            "section long bar: the plane meets the body Crankshaft twice",
        ),
        ("joints.main.radial is open", "Main bearing, radial force is open"),
        ("joints.main: too short", "joint Main bearing: too short"),
        (
            "the rod front_left would have to push (tension_only)",
            "the rod front left would have to push (tension_only)",
        ),
        ("t = 0.5 s: the body is free", "t = 0.5 s: the body is free"),
    ],
)
def test_a_message_of_the_solver_names_things_by_their_labels(said: str, read: str) -> None:
    assert describe_sentence(said, LABELS) == read
