"""Blows in tables, CSV, measures and expectations: apart from the forces, and no more than is known."""

from __future__ import annotations

import csv
import io
import re
from dataclasses import replace
from typing import Any

import numpy as np
import pytest

from heuncli.app.cli.entry import UsageError
from heuncli.app.commands.run.scene import _check_strict
from heuncli.base.errors import SpecError
from heuncli.output.documents.as_markdown import render_table
from heuncli.output.documents.as_text import format_plain
from heuncli.output.tables import measure
from heuncli.output.tables.export import to_csv, to_json
from heuncli.output.tables.page import make_page
from heuncli.results.results import Block, Results
from heuncli.scene.file_format.load import load
from heuncli.scene.file_format.models import Expect
from heuncli.scene.file_format.rules import references
from heuncli.study.quantities.labels import StopInfo
from heuncli.study.queries.expectations import compare
from tests.shared.fakes import ACCURATE, LABELS, MAGNITUDES, FakeStudy, pendulum
from tests.shared.heading import format_heading

T = np.linspace(0.0, 2.0, 5)
OF = MAGNITUDES._replace(by_unit={**MAGNITUDES.by_unit, "N·s": 10.0, "N·m·s": 10.0})


def blow(t: float = 0.5, size: float = 1.0, *names: str) -> Block:
    """All that a blow may have."""
    along = {name: size * np.array([k, 0.0, -k], dtype=float) for k, name in enumerate(("N", "Q1", "Q2"), 1)}
    along |= {name: size * np.array([0.0, k, 0.0]) for k, name in enumerate(("T", "M1", "M2"), 1)}
    force, zero = size * np.array([0.25, 0.0, 2.0]), np.zeros(3)
    return {
        "time": t,
        "names": list(names or ("blow",)),
        "bodies": {"upper": {"center_velocity_jump": force, "angular_velocity_jump": zero}},
        "foundation": {
            "about": zero, "force": -force, "moment": size * np.array([0.0, 0.125, 0.0]),
            "axis": {"point": zero, "direction": np.array([0.0, 0.0, -1.0]), "pitch": 0.0},
            "mass_effect": {"force": force, "moment_orbital": zero, "moment_spin": zero},
            "supports": {"pivot": {"force": -force, "moment": zero}},
            "elements": {"buffer": {"force": zero, "moment": zero, "point": zero}},
        },
        "joints": {
            "pivot": {"point": zero, "force": size * np.array([1, np.nan, 8]) / 4, "moment": zero, "open": ["force.y"]},
            "elbow": {"point": zero, "force": 0.5 * force, "moment": zero, "open": [], "drive": 0.75 * size},
        },
        "stops": {"buffer": {"force": 3.0 * size}},
        "sections": {
            "middle": {"N": 0.5 * size, "M1": 1.25 * size, "open": []},
            "along": {"s": np.array([0.0, 0.4, 0.8]), "side": [None, None, None], **along},
        },
        "energy_before": 1.0,
        "energy_after": 1.0 + 0.25 * size,
        "energy_jump": 0.25 * size,
        "certain_sums": [{"terms": {"joints.pivot.force.y": 1.0, "joints.elbow.force.y": 1.0}, "value": 0.5 * size}],
    }  # fmt: skip


def labels() -> Any:
    from heuncli.base.records import replace as changed

    return changed(LABELS, stops={"buffer": StopInfo("guide.travel", None, 0.2)})


def struck(*blows: Block, **changes: Any) -> Results:
    return pendulum(T, impulses=list(blows), **changes)


def text(results: Results, every: bool = False) -> str:
    page = make_page(results, labels(), OF)
    return "\n".join(format_plain(table) for table in page.make_tables_at_instants(results, every_cut=every))


def of_blow(whole: str) -> str:
    return whole[whole.index("IMPULSE") :]


def test_a_blow_has_all_its_tables_in_newton_seconds() -> None:
    found = of_blow(text(struck(blow())))
    lead = "IMPULSE at t = 0.5 s (blow)"
    for heading in ("CENTRAL AXIS", "SECTION along, body lower  impulse of", "DETERMINATE SUMS"):
        assert f"{lead}  {heading}" in found
    whole = found[found.index(f"{lead}\n") :].partition(f"\n{lead}")[0]
    for part in ("BODIES  changes", "FOUNDATION  impulse", "JOINTS  reaction impulse", "STOPS  impulse on",
                 "SECTIONS  impulse of", "ENERGY  kinetic"):  # fmt: skip
        assert f"\n{part}" in whole
    assert {"N·s", "N·m·s"} <= set(whole.split())
    assert not {"N·m", "[N]", "[N·m]"} & set(found.split())
    assert "guide.travel ≤ 0.2 m" in found
    assert "joints.pivot Fy + joints.elbow Fy = 0.5 N·s; distribution indeterminate" in found
    assert "IMPULSES  the blows" not in found


def lines_of(found: str) -> dict[str, list[str]]:
    """The cells of the lines of a blow's table, by part, name and label; a name stands before its first line alone."""
    lines, name, title = dict[str, list[str]](), "", ""
    for line in found.splitlines():
        title = line.split()[0] if line[:1].strip() else title
        if line.startswith("  ") and title.isupper():
            name = line[2:].partition("  ")[0] or name
            cells = line[2:].removeprefix(name).split()
            lines[f"{title} {name} {cells[0] if cells else ''}"] = cells[1:]
    return lines


def test_a_blow_is_told_in_one_table_without_what_it_does_not_load() -> None:
    one = blow()
    one["joints"]["elbow"] |= {"force": np.array([0.0, 0.0, -2.0]), "axial": 0.0, "radial": 2.0, "tilting": 0.0}
    one["joints"]["idle"] = {"point": np.zeros(3), "force": np.zeros(3), "moment": np.zeros(3), "open": []}
    page = make_page(struck(one), labels(), OF, details=False)
    tables = [format_plain(table) for table in page.make_tables_at_instants(page.results)]
    assert not any("CENTRAL AXIS" in table or "MASS EFFECT" in table for table in tables)
    (whole,) = [table for table in tables if table.startswith("IMPULSE at t = 0.5 s (blow)\n")]
    told = lines_of(whole)
    for line, cells in {
        "BODIES upper Δv": ["m/s", 0.25, 0.0, 2.0, 2.01556],
        "FOUNDATION total F": ["N·s", -0.25, 0.0, -2.0, 2.01556],
        "JOINTS pivot F": ["N·s", 0.25, "open", 2.0, "open"],
        "JOINTS elbow F": ["N·s", 0.0, 0.0, -2.0, 2.0],  # radial is all of it: told once
        "JOINTS elbow drive": ["N·m·s", 0.75],
        "STOPS buffer force": ["N·s", 3.0],
    }.items():
        numbers = [float(cell) if cell[-1].isdigit() else cell for cell in told[line][: len(cells)]]
        assert numbers == cells
    assert not any("idle" in name or "Δω" in name or "radial" in name for name in told)
    assert "Rows that are zero at all times are not shown." in whole


def test_a_blow_that_loads_nothing_says_so() -> None:
    idle = {"point": np.zeros(3), "force": np.zeros(3), "moment": np.zeros(3), "open": []}
    one: Block = {"time": 0.5, "names": ["blow"], "joints": {"pivot": idle}}
    assert of_blow(text(struck(one))) == "IMPULSE at t = 0.5 s (blow)\nall values 0\n"


def test_what_is_open_in_a_blow_reads_open_and_fails_strict() -> None:
    assert "open" in of_blow(text(struck(blow())))
    assert _check_strict(struck(blow()), []) == 1
    closed = blow()
    closed["joints"]["pivot"] |= {"force": np.zeros(3), "open": []}
    assert _check_strict(struck(closed), []) == 0


def test_tables_are_written_as_markdown() -> None:
    page = make_page(struck(blow()), labels(), OF)
    written = "\n".join(render_table(table) for table in page.make_tables_at_instants(page.results))
    assert "### IMPULSE at t = 0.5 s (blow)\n" in written
    assert "| **JOINTS  reaction impulse" in written


def test_of_many_blows_all_are_listed_and_the_largest_shown() -> None:
    blows = [blow(0.1 * k, size, f"b{k}") for k, size in enumerate((1.0, 5.0, 2.0, 4.0, 3.0), 1)]
    found = of_blow(text(struck(*blows)))
    assert "IMPULSES  all impulses of the run" in found
    assert [k for k in range(1, 6) if f"IMPULSE at t = 0.{k} s (b{k})" in found] == [2, 4, 5]
    assert "details below: 1, 3, 4 (the largest); all: --all" in found
    every = of_blow(text(struck(*blows), every=True))
    assert [k for k in range(1, 6) if f"IMPULSE at t = 0.{k} s (b{k})" in every] == [1, 2, 3, 4, 5]
    both = of_blow(text(struck(blow(0.5, 1.0, "hammer", "buffer"), blow(1.0))))
    assert "hammer, buffer" in both


def test_a_long_list_of_blows_is_cut() -> None:
    blows = [blow(0.01 * k, 1.0 / k, f"b{k}") for k in range(1, 31)]
    found = of_blow(text(struck(*blows)))
    listed = found.partition("IMPULSE at")[0]
    assert "b20" in listed
    assert "b21" not in listed
    assert "10 further, the last at t = 0.3 s" in listed
    assert "b30" in of_blow(text(struck(*blows), every=True)).partition("IMPULSE at")[0]


def test_the_heading_tells_of_contacts() -> None:
    told = [f"contact {k} rests" for k in range(8)]
    written = format_heading(replace(pendulum(T), model={**pendulum(T).model, "contacts": told}))
    assert "contacts  contact 0 rests" in written
    assert "contact 4 rests" in written
    assert "contact 5" not in written
    assert "3 more in --format json, model.contacts" in written


def test_beyond_the_horizon_nothing_is_told_of_a_blow() -> None:
    accuracy = {**ACCURATE, "horizon": 0.7}
    results = struck(blow(0.5, 1.0, "early"), blow(1.5, 2.0, "late"), accuracy=accuracy)
    late = of_blow(text(results)).partition("(late)\n")[2].partition("\nIMPULSE")[0]
    told = lines_of(late)
    assert told["BODIES upper Δv"] == ["m/s", "?", "0", "?", "?"]
    assert told["JOINTS elbow drive"][:2] == ["N·m·s", "?"]
    numbers = {cell for line in told.values() for cell in line[1:5] if re.fullmatch(r"[-\d.?]+", cell)}
    assert numbers - {"0.2"} == {"?", "0"}  # the limit of the stop is none of them
    study = FakeStudy(T, {"impulses": results.impulses, "accuracy": accuracy})
    assert measure.format_measures([measure.parse_measure("impulses.0.energy_jump")], study, "table") == "0.25\n"
    assert measure.format_measures([measure.parse_measure("impulses.1.energy_jump")], study, "table") == "?\n"


@pytest.mark.parametrize(("words", "value"), [
    ("impulses.0.energy_jump", 0.25),
    ("impulses.0.foundation.force.z", -2.0),
    ("max abs impulses.0.foundation.force.z", 2.0),
    ("impulses.0.stops.buffer.force", 3.0),
    ("impulses.0.sections.middle.M1", 1.25),
    ("impulses.0.sections.along.N.2", -1.0),
    ("max abs impulses.0.sections.along.Q2", 3.0),
    ("min impulses.0.sections.along.Q2", -3.0),
    ("max impulses.0.sections.along.M1", 2.0),
    ("max abs impulses.0.joints.elbow.force", 0.5 * np.hypot(0.25, 2.0)),
    ("impulses.0.certain_sums.0.value", 0.5),
    ("impulses.0.time", 0.5),
])  # fmt: skip
def test_measures(words: str, value: float) -> None:
    study = FakeStudy(T, {"impulses": [blow()]})
    asked = measure.parse_measure(words)
    assert float(measure.format_measures([asked], study, "table")) == pytest.approx(value, rel=1e-14)


def test_what_is_open_measures_open() -> None:
    study = FakeStudy(T, {"impulses": [blow()]})
    for words in ("impulses.0.joints.pivot.force.y", "max abs impulses.0.joints.pivot.force"):
        assert measure.format_measures([measure.parse_measure(words)], study, "table") == "open\n"


@pytest.mark.parametrize(("words", "message"), [
    ("first impulses.0.energy_jump", "one instant, that of the impulse"),
    ("at 0.5 impulses.0.energy_jump", "one instant, that of the impulse"),
    ("impulses.0.sections.along.N", "is 3 numbers"),
])  # fmt: skip
def test_measures_that_are_no_number(words: str, message: str) -> None:
    with pytest.raises(UsageError, match=message):
        measure.format_measures([measure.parse_measure(words)], FakeStudy(T, {"impulses": [blow()]}), "table")


def test_csv_has_every_number_of_a_blow() -> None:
    lines = list(csv.DictReader(io.StringIO(to_csv(struck(blow(), blow(1.5, 2.0)), labels()))))
    own = {(r["name"], r["quantity"], r["component"]): r for r in lines if r["kind"] == "impulses"}
    for key, value, unit in (
        (("0", "energy_before", ""), 1.0, "J"),
        (("1", "energy_jump", ""), 0.5, "J"),
        (("0.foundation", "force", "z"), -2.0, "N·s"),
        (("0.stops.buffer", "force", ""), 3.0, "N·s"),
        (("0.joints.elbow", "drive", ""), 0.75, "N·m·s"),
        (("0.sections.along", "M2", "1"), 3.0, "N·m·s"),
        (("0.bodies.upper", "center_velocity_jump", "z"), 2.0, "m/s"),
        (("0.certain_sums.0", "value", ""), 0.5, "N·s"),
    ):
        assert (float(own[key]["value"]), own[key]["unit"]) == (value, unit)
    assert own["0.joints.pivot", "force", "y"]["value"] == ""
    assert {row["time"] for (name, _, _), row in own.items() if name.startswith("1")} == {"1.5"}


def test_json_keeps_the_nesting() -> None:
    written = to_json(struck(blow()))
    for part in ('"names": ["blow"]', '"energy_before": 1.0', '"certain_sums": [', '"buffer": {'):
        assert part in written


SCENE = """
heun: 1
ground: {{points: {{O: [0, 0, 0]}}}}
bodies:
  b: {{shapes: [{{type: rod, from: [0, 0, 0], to: [1, 0, 0], mass: 1}}], points: {{o: [0, 0, 0], p: [1, 0, 0]}}}}
joints: {{j: {{type: pin, from: ground.O, to: b.o, axis: [0, 0, 1]}}}}
impulses: {{hit: {{on: b.p, vector: [0, 1, 0]}}}}
stops: {{s: {{joint: j, angle: [-1, 1]}}}}
sections:
  run: {{body: b, from: [0.1, 0, 0], to: [0.9, 0, 0], count: 3}}
analysis: {{duration: 1}}
expect: [{}]
"""


@pytest.mark.parametrize(("item", "message"), [
    ("{of: impulses.0.foundation.force.z, is: 1}", ""),
    ("{of: impulses.0.foundation.force.z, is: 1 N*s}", ""),
    ("{of: impulses.0.foundation.force, is: [1, 2, 3]}", ""),
    ("{of: impulses.0.sections.run.M2, is: 1}", "give one of its numbers"),
    ("{of: impulses.0.sections.run.M2.2, is: 1}", ""),
    ("{of: impulses.0.stops.s.moment, is: 1}", ""),
    ("{of: impulses.0.joints.j.force.z, is: 1 N}", "expected an impulse"),
    ("{of: impulses.0.joints.k.force.z, is: 1}", "'k' is not a result"),
    ("{of: impulses.force, is: 1}", "'force' is not a result"),
    ("{of: impulses.0.energy_jump, at: 0, is: 1}", "does not change in time"),
    ("{of: impulses.0.energy_jump, peak: max, is: 1}", "does not change in time"),
    ("{of: impulses.0.sections.run.stress.mises, is: 1}", "'stress' is not a result"),
    ("{of: stops.s.moment, at: 0, is: 1}", ""),
    ("{of: stops.s.force, at: 0, is: 1}", "a stop of an angle exerts a moment: write moment"),
    ("{of: impulses.0.stops.s.force, is: 1}", "a stop of an angle exerts a moment: write moment"),
    ("{of: impulses.0.foundation.elements.s.force.z, is: 1}", ""),
])  # fmt: skip
def test_expectations_of_blows(item: str, message: str, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(references, "NOT_YET", ())
    told = ""
    try:
        load("x.yaml", text=SCENE.format(item))
    except SpecError as error:
        told = "\n".join(f"{problem} {problem.hint}" for problem in error.problems)
    assert message in told
    assert bool(told) == bool(message)


def test_expectations_are_compared() -> None:
    study: Any = FakeStudy(T, {"impulses": [blow()]})
    location: Any = None

    def case(of: str, value: Any) -> bool:
        return compare(study, Expect(of, None, None, value, None, None, location)).is_met

    assert case("impulses.0.foundation.force", (-0.25, 0.0, -2.0))
    assert case("impulses.0.joints.pivot.force.y", None)
    assert not case("impulses.0.foundation.force.z", 2.0)
    assert not case("impulses.1.foundation.force.z", -2.0)


def test_a_resting_stop_has_its_force_beside_the_joints() -> None:
    results = replace(pendulum(T), stops={"buffer": {"force": np.full(len(T), 4.5)}})
    found = text(results)
    assert 'STOPS  force on "to"' in found
    assert "4.5" in found.partition("STOPS")[2].partition("SECTIONS")[0]
    lines = list(csv.DictReader(io.StringIO(to_csv(results, labels()))))
    assert {r["unit"] for r in lines if r["kind"] == "stops"} == {"N"}
