"""Rows of sweeps are what `heun run --set ... --measure` says, to the bit, whoever solves them, and in any order."""

from __future__ import annotations

import json
from collections.abc import Sequence
from pathlib import Path
from typing import Any, NamedTuple

import pytest

from tests.shared.command import Heun
from tests.shared.folders import ROOT, SPECS

STARTERS = ROOT / "heuncli" / "starters"
CASES = """\
heun: 1
gravity: [0, 0, -9.81]
parameters: {F: 100 N, m: 2}
ground: {points: {O: [0, 0, 0]}}
bodies:
  bar: {mass: m, center: [0, 0, -0.5], inertia: [0.08, 0.08, 0.001], points: {top: [0, 0, 0], end: [0, 0, -1]}}
joints: {pivot: {type: weld, from: ground.O, to: bar.top}}
forces: {push: {type: force, on: bar.end, vector: [F, 0, 0]}}
analysis: {type: state}
cases:
  calm: {set: {F: 0}}
  storm: {set: {F: 3 kN, m: 2.5}}
"""


class Swept(NamedTuple):
    """A spec, what is varied in it, and what is measured."""

    path: Path
    axes: tuple[str, ...]
    measures: tuple[str, ...]
    short: tuple[str, ...] = ()


SWEPT = (
    Swept(SPECS / "double.yaml", ("bodies.upper.mass=0.8,1,1.25", "bodies.lower.mass=1:2/2"),
          ("max abs joints.elbow.force", "final energy.kinetic", "at 0.1 joints.pivot.force.z"),
          ("--set", "analysis.duration=0.2")),
    Swept(SPECS / "slider_crank.yaml", ("w=50:150/3", "r=0.04,0.05,0.5"),
          ("max joints.main.force", "final coordinates.guide.travel")),
    Swept(SPECS / "rotor.yaml", ("n=1000:3000/3rpm", "m=10,30g"),
          ("max joints.right.force", "first joints.left.force.z")),
    Swept(SPECS / "percussion.yaml", ("H=0.5:2/4",), ("impulses.0.energy_jump", "max abs energy.kinetic")),
    Swept(STARTERS / "truss.yaml", ("F=1,5,20kN", "a=1.5:2.5/3"), ("joints.low.force", "joints.high.force.x")),
    Swept(STARTERS / "struck_rod.yaml", ("s=0.6:0.9/3m", "S=5,8"),
          ("impulses.0.joints.pin.force", "impulses.0.energy_jump")),
)  # fmt: skip


class Row(NamedTuple):
    """A variant as a sweep tells it: what is set, its code, and number and instant of each measure."""

    values: dict[str, str]
    code: str
    told: list[tuple[float | None, float | None]]


def single(heun: Heun, spec: str, measure: str, settings: Sequence[str], case: str | None = None) -> Any:
    """What `heun run` says of a measure: its number and its instant; of what cannot be solved the code."""
    words = [word for setting in settings for word in ("--set", setting)]
    named = ("--case", case) if case is not None else ()
    done = heun("run", spec, *words, *named, "--measure", measure, "--format", "json", "--quiet")
    if done.returncode:
        return done.stderr.partition("[")[2].partition("]")[0]
    told = json.loads(done.stdout)
    return told["value"], told["at"]


def swept(heun: Heun, *words: str) -> list[Row]:
    """The rows of a sweep."""
    done = heun("sweep", *words, "--format", "json", "--quiet")
    assert done.returncode == 0, done.stderr
    told = json.loads(done.stdout)
    units = {one["parameter"]: one["unit"] for one in told["parameters"]}
    return [
        Row({name: in_words(value, units[name]) for name, value in row["set"].items()}, row["code"],
            [(one["value"], one["at"]) for one in row["values"]])
        for row in told["rows"]
    ]  # fmt: skip


def in_words(value: float | str, unit: str | None) -> str:
    """A value as --set takes it."""
    return value if isinstance(value, str) else f"{value!r} {unit or ''}".strip()


@pytest.mark.heavy
@pytest.mark.parametrize("one", SWEPT, ids=lambda one: one.path.stem)
@pytest.mark.third
def test_rows_are_single_runs_to_the_bit(heun: Heun, one: Swept) -> None:
    measures = [word for measure in one.measures for word in ("--measure", measure)]
    rows = swept(heun, str(one.path), *one.axes, *measures, *one.short, "--jobs", "2")
    assert len(rows) > 2
    for row in rows:
        settings = [*one.short[1::2], *(f"{name}={text}" for name, text in row.values.items())]
        for k, measure in enumerate(one.measures):
            alone = single(heun, str(one.path), measure, settings)
            assert (row.code or row.told[k]) == alone, (settings, measure)


@pytest.mark.heavy
@pytest.mark.parametrize("words", [("case=all",), ("m=1,2", "case=storm,calm")])
def test_load_cases_are_those_of_a_run(heun: Heun, folder: Path, words: tuple[str, ...]) -> None:
    (folder / "cases.yaml").write_text(CASES)
    rows = swept(heun, "cases.yaml", *words, "--measure", "joints.pivot.moment")
    assert {row.values["case"] for row in rows} == {"calm", "storm"}
    for row in rows:
        settings = [f"{name}={text}" for name, text in row.values.items() if name != "case"]
        alone = single(heun, "cases.yaml", "joints.pivot.moment", settings, row.values["case"])
        assert row.told == [alone]


@pytest.mark.heavy
@pytest.mark.parametrize("form", ["table", "json", "csv"])
@pytest.mark.long
def test_what_is_told_does_not_depend_on_who_solves(heun: Heun, form: str) -> None:
    words = ("sweep", str(SPECS / "rotor.yaml"), "n=1000:3000/9rpm", "m=10,20,30g", "--format", form)
    words += ("--measure", "max joints.right.force", "--set", "turn=0.01")
    one, *others = (heun(*words, "--jobs", jobs) for jobs in ("1", "2", "5"))
    assert one.returncode == 0
    assert all(other == one for other in others)


def test_the_spec_need_not_be_sound_without_its_variants(heun: Heun, folder: Path) -> None:
    unsound = (folder / "hanging.yaml").read_text().replace("m: 1.0", "m: 0")
    (folder / "hanging.yaml").write_text(unsound)
    rows = swept(heun, "hanging.yaml", "m=-1,2,3", "--measure", "joints.pivot.force.z")
    assert [row.code for row in rows] == ["not-positive", "", ""]
    assert rows[1].told == [single(heun, "hanging.yaml", "joints.pivot.force.z", ["m=2"])]
