"""A type of load of a known law is its keys, what they mean, and a load of the mechanism."""

from __future__ import annotations

from pathlib import Path

import pytest

from tests.contributing.addition import Addition, Edit, after, answers, heun

COUNTERWEIGHT = Addition(  # a rope over a pulley, whose pull is the same at any length
    "A load",
    {
        "heuncli/scene/file_format/format.py": (
            Edit("    ForceInTime,\n", "    Force,\n    ForceInTime,\n"),
            Edit("LoadEntry = (\n", """class CounterweightEntry(Entry):
    type: Literal["counterweight"]
    from_: AnEnd = key(alias="from")
    to: AnEnd
    pull: Force


LoadEntry = (
    CounterweightEntry |
"""),
            after("LOADS: dict[str, type[LoadEntry]] = {\n", """    "counterweight": CounterweightEntry,
"""),
        ),
        "heuncli/scene/file_format/models.py": (
            Edit("Force = (\n    PointForce | ", '''class Counterweight(NamedTuple):
    """A force that draws two points together, the same at any distance [N]."""

    from_: End
    to: End
    pull: float
    type: Literal["counterweight"] = "counterweight"


Force = (
    Counterweight | PointForce | '''),
        ),
        "heuncli/scene/file_format/resolve.py": (
            Edit("            case f.TurnSpringEntry():\n", """            case f.CounterweightEntry():
                return m.Counterweight(self.end(load.from_), self.end(load.to), load.pull)
            case f.TurnSpringEntry():
"""),
        ),
        "heuncli/scene/file_format/rules/references.py": (
            Edit("f.ActuatorEntry | f.SpringEntry):", "f.ActuatorEntry | f.SpringEntry | f.CounterweightEntry):"),
        ),
        "heuncli/scene/file_format/rules/joints.py": (
            after("not isinstance(load, f.ActuatorEntry | f.SpringEntry", " | f.CounterweightEntry"),
        ),
        "heuncli/multibody/mechanism/build.py": (
            Edit("        case m.Torque() | m.Motor():\n", """        case m.Counterweight():
            a, b = f.from_, f.to
            ends = index[a.body], np.array(a.point), index[b.body], np.array(b.point)
            return PairLoad(name, *ends, Expression.from_number(-f.pull), 0.0, 0.0, 0.0)
        case m.Torque() | m.Motor():
"""),
            after("import numpy as np\n", "\nfrom heuncli.scene.expressions.programs import Expression"),
        ),
        "heuncli/study/quantities/labels.py": (
            Edit('"actuator", "spring"})', '"actuator", "spring", "counterweight"})'),
        ),
    },
)  # fmt: skip
SCENE = """\
heun: 1
ground: {points: {O: [0, 0, 0], pulley: [0, 0, 2]}}
bodies: {a: {mass: 4, center: [0, 0, 0], inertia: [1, 1, 1], points: {c: [0, 0, 0]}}}
joints: {u: {type: slide, from: ground.O, to: a.c, axis: [0, 0, 1], initial: {travel: 0, speed: 0}}}
forces: {w: {type: counterweight, from: PLACE, to: a.c, pull: 12}}
analysis: {times: [0, 0.5]}
"""


def test_a_load(tmp_path: Path) -> None:
    """It draws a mass up with 3 m/s^2 and puts its work into it; a place that there is not is told where it stands."""
    folder = COUNTERWEIGHT.made_in(tmp_path)
    scene = SCENE.replace("PLACE", "ground.pulley")
    paths = "coordinates.u.travel", "energy.work", "forces.w.power", "foundation.elements.w.force.z"
    found = answers(folder, scene, [f"final {path}" for path in paths])
    assert found == pytest.approx([0.375, 12.0 * 0.375, 12.0 * 1.5, -12.0], rel=1e-9)
    wrong = heun(folder, "validate", "-", text=SCENE.replace("PLACE", "ground.wheel"))
    assert "forces.w.from" in wrong.stderr and wrong.returncode != 0
    assert "same point" in heun(folder, "validate", "-", text=SCENE.replace("PLACE", "a.c")).stderr


def test_its_list() -> None:
    assert COUNTERWEIGHT.is_as_listed()
