"""A coupling that is a sum of known parts is a class of its keys, what it means, and its rows."""

from __future__ import annotations

from pathlib import Path

import pytest

from tests.contributing.addition import Addition, Edit, after, answers

MIRROR = Addition(  # two joints whose coordinates are opposite: what the one turns, the other turns back
    "A coupling",
    {
        "heuncli/scene/file_format/format_couplings.py": (
            Edit("CouplingEntry = RatioEntry", """class MirrorEntry(Entry):
    type: Literal["mirror"]
    of: list[str]


CouplingEntry = MirrorEntry | RatioEntry"""),
            after("COUPLINGS: dict[str, type[CouplingEntry]] = {\n", """    "mirror": MirrorEntry,
"""),
        ),
        "heuncli/scene/file_format/couplings.py": (
            Edit("Coupling = (  # a union of the classes here\n", """class Mirror(NamedTuple):
    terms: tuple[Term, ...]
    type: Literal["mirror"] = "mirror"

    @property
    def joints(self) -> tuple[str, ...]:
        return joints_of(self.terms)


Coupling = (  # a union of the classes here
    Mirror |
"""),
        ),
        "heuncli/scene/file_format/resolve_couplings.py": (
            Edit("MEANINGS: dict[str, Callable[..., c.Coupling]] = {\n", """def mirror(by, name, entry):
    return c.Mirror(tuple(term(by, word) for word in entry.of))


MEANINGS: dict[str, Callable[..., c.Coupling]] = {
    "mirror": mirror,
"""),
        ),
        "heuncli/multibody/mechanism/build_couplings.py": (
            Edit("BUILDERS: dict[str, Callable[..., tuple[CoupledRow, ...]]] = {\n", """def mirror(given, drawn):
    return (CoupledRow(tuple(coordinate_part(drawn, x, 1.0) for x in given.terms), None, SCENE_SIZE),)


BUILDERS: dict[str, Callable[..., tuple[CoupledRow, ...]]] = {
    "mirror": mirror,
"""),
        ),
    },
)  # fmt: skip
SCENE = """\
heun: 1
ground: {points: {A: [0, 0, 0], B: [1, 0, 0]}}
bodies:
  one: {mass: 1, center: [0, 0, 0], inertia: [1, 1, 2], points: {o: [0, 0, 0]}}
  two: {mass: 1, center: [0, 0, 0], inertia: [2, 2, 3], points: {o: [0, 0, 0]}}
joints:
  a: {type: pin, from: ground.A, to: one.o, axis: [0, 0, 1], initial: {rate: 2}}
  b: {type: pin, from: ground.B, to: two.o, axis: [0, 0, 1]}
couplings: {both: {type: mirror, of: [a, b]}}
forces: {motor: {type: torque, joint: a, value: 10}}
analysis: {times: [0, 1]}
"""


def test_a_coupling(tmp_path: Path) -> None:
    """Two wheels turn as one of both inertias, against each other; the couple is what the second one needs."""
    wanted = {
        "first coordinates.b.rate": -2.0,
        "final coordinates.a.rate": 4.0,
        "final coordinates.b.rate": -4.0,
        "first couplings.both.moment": -6.0,
        "first couplings.both.on.ground.moment.z": 12.0,
    }
    found = answers(MIRROR.made_in(tmp_path), SCENE, list(wanted))
    assert found == pytest.approx(list(wanted.values()), abs=1e-9)


def test_its_list() -> None:
    assert MIRROR.is_as_listed()
