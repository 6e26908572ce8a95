"""Units in the headings of data files, and decimal marks: against a list of units of its own."""

from __future__ import annotations

import random
from pathlib import Path

import pytest

from heuncli.base.errors import SpecError
from heuncli.scene.file_format.column_layout import CsvError
from heuncli.scene.file_format.columns import read_column_numbers
from heuncli.scene.file_format.headings import find_heading_unit
from heuncli.scene.file_format.load import load
from heuncli.scene.file_format.models import Spec

# By definition, in SI: nothing here comes from heun's own table.
SIZES = {
    "s": 1.0, "ms": 1e-3, "N": 1.0, "kN": 1e3, "daN": 10.0, "gf": 9.80665e-3, "kgf": 9.80665, "lbf": 4.4482216152605,
    "mm": 1e-3, "ft": 0.3048, "km/h": 1 / 3.6, "deg": 3.141592653589793 / 180, "°": 3.141592653589793 / 180,
    "rpm": 3.141592653589793 / 30, "U/min": 3.141592653589793 / 30, "bar": 1e5, "MPa": 1e6, "psi": 6894.757293168361,
    "N·m": 1.0, "N-m": 1.0, "Nm": 1.0, "kNm": 1e3, "N mm": 1e-3, "m/s2": 1.0, "m/s²": 1.0, "mm/s^2": 1e-3, "N/mm": 1e3,
    "kg": 1.0, "kgf/cm2": 98066.5, "milliseconds": 1e-3, "Newtons": 1.0, "RPM": 3.141592653589793 / 30, "Sec": 1.0,
}  # fmt: skip
BRACKETS = ["{name} ({unit})", "{name} [{unit}]", "{name}({unit})", "{name}[{unit}]", "{name}_[{unit}]",
            "{name} / ({unit})", "{name} ({unit}) filtered", " {name} ( {unit} ) "]  # fmt: skip
BEHIND = [
    "{name} / {unit}",
    "{name}/{unit}",
    "{name} in {unit}",
    "{name}, {unit}",
    "{name}_{unit}",
    "{name} {unit}",
    "{name} - {unit}",
]
NAMES = ["Time", "F", "Kraft", "force_left", "F_z", "Load cell 1", "main.force.x", "Weg Kolben"]
NO_UNITS = ["force", "F_t", "F_z", "x1", "Sensor 1", "a_rms", "phi (-)", "n [1]", "step_s", "F (left) raw", "", "t"]
TWO_MEANINGS = ["a (g)", "F (lb)", "n [1/min]", "n [1/s]", "f (Hz)", "M in t"]
MAYBE = ["F_min", "force_in", "p_bar", "F_lb", "x/l", "t/h", "N/mm"]


@pytest.mark.parametrize("unit", SIZES)
def test_every_form_states_the_unit(unit: str) -> None:
    for name in NAMES:
        for form in BRACKETS + (BEHIND if len(unit) > 1 and unit not in ("bar", "N/mm") else []):
            stated = find_heading_unit(form.format(name=name, unit=unit))
            assert stated is not None, (form, name)
            assert stated.size == pytest.approx(SIZES[unit], rel=1e-15), (form, name)
            assert stated.name == name


@pytest.mark.parametrize("text", NO_UNITS)
def test_no_unit_is_read_into_a_name(text: str) -> None:
    stated = find_heading_unit(text)
    assert stated is None or stated.size == 1.0


@pytest.mark.parametrize("text", TWO_MEANINGS + MAYBE)
def test_what_has_two_meanings_is_none_for_certain(text: str) -> None:
    stated = find_heading_unit(text)
    assert stated is not None
    assert stated.size is None
    assert stated.meanings
    assert stated.is_certain == (text in TWO_MEANINGS)


SCENE = """heun: 1
tables: {bench: {file: bench.csvENTRY}}
bodies: {b: {mass: 1, center: [0, 0, 0], inertia: [1, 1, 1], points: {o: [0, 0, 0]}}}
forces: {f: {type: force, on: b.o, vector: ["table(bench, t)", 0, 0]}}
analysis: {duration: 0.5}
"""


def scene(folder: Path, heads: tuple[str, str], entry: str = "", mark: str = ",") -> Spec:
    (folder / "bench.csv").write_text(f"{heads[0]}{mark}{heads[1]}\n0{mark}1\n1000{mark}3\n", encoding="utf-8")
    (folder / "scene.yaml").write_text(SCENE.replace("ENTRY", entry))
    return load(str(folder / "scene.yaml"))


def points(spec: Spec) -> tuple[list[float], list[float], object]:
    table = spec.tables["bench"]
    return list(table.x), list(table.y), table.dimensions


def codes(spec: Spec) -> list[tuple[str, int | None]]:
    return [(one.code, one.location.line if one.location else None) for one in spec.warnings]


def test_a_table_takes_the_units_of_its_headings(tmp_path: Path) -> None:
    spec = scene(tmp_path, ("Time (ms)", "Force (kN)"))
    table = spec.tables["bench"]
    assert (list(table.x), list(table.y)) == ([0.0, 1.0], [1000.0, 3000.0])
    assert spec.warnings == ()
    by_name = scene(tmp_path, ("Time (ms)", "Force (kN)"), ", x: Time, y: Force")
    assert points(by_name) == points(spec)
    given = scene(tmp_path, ("Time", "Force"), ", x_unit: ms, y_unit: kN")
    assert points(given) == points(spec)


def test_a_given_unit_goes_first_and_is_warned_of_where_it_differs(tmp_path: Path) -> None:
    other = scene(tmp_path, ("Time (ms)", "Force (kN)"), ", x_unit: s, y_unit: kN")
    assert codes(other) == [("column-unit", 1)]
    assert "says 'ms', x_unit says 's'" in other.warnings[0].message
    plain = scene(tmp_path, ("Time", "Force"), ", x_unit: s, y_unit: kN")
    assert points(other) == points(plain)
    same = scene(tmp_path, ("Time (ms)", "Force (kN)"), ", x_unit: ms, y_unit: kN")
    assert codes(same) == []


def test_a_word_that_is_no_unit_is_warned_of(tmp_path: Path) -> None:
    assert codes(scene(tmp_path, ("Time (s)", "Force (raw)"))) == [("column-unit", 1)]
    assert codes(scene(tmp_path, ("Time (s)", "Force (raw)"), ", y_unit: '1'")) == []
    assert codes(scene(tmp_path, ("Time (s)", "F_min"))) == [("column-unit", 1)]
    assert codes(scene(tmp_path, ("Time (s)", "F_t"))) == []


def test_a_unit_with_two_meanings_is_refused(tmp_path: Path) -> None:
    with pytest.raises(SpecError) as caught:
        scene(tmp_path, ("Time (s)", "Force (lb)"))
    (problem,) = caught.value.problems
    assert (problem.code, problem.location and problem.location.file) == ("column-unit", str(tmp_path / "bench.csv"))
    assert codes(scene(tmp_path, ("Time (s)", "Force (lb)"), ", y_unit: lbf")) == []


def test_a_heading_of_another_dimension_is_refused_where_the_table_is_used(tmp_path: Path) -> None:
    with pytest.raises(SpecError, match="wrong-dimension"):
        scene(tmp_path, ("Time (s)", "Travel (mm)"))


@pytest.mark.parametrize("seed", range(40))
def test_two_decimal_marks_are_refused_and_one_is_read(seed: int) -> None:
    draw = random.Random(seed)
    marks = [draw.choice(["", ",", "."]) for _ in range(2 * draw.randint(2, 6))]
    numbers = [
        f"{draw.randint(1, 9)}{mark}{draw.randint(0, 999):03d}" if mark else str(draw.randint(1, 9)) for mark in marks
    ]
    text = "t;F\n" + "".join(f"{x};{y};1.5,2\n" for x, y in zip(numbers[::2], numbers[1::2], strict=True))
    if {",", "."} <= set(marks):
        with pytest.raises(CsvError, match="two decimal marks"):
            read_column_numbers(text, 1, 2)
        return
    found = [value for row in zip(*read_column_numbers(text, 1, 2), strict=True) for value in row]
    assert found == [float(number.replace(",", ".")) for number in numbers]
