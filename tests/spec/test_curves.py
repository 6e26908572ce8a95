"""Tables: the curves against SciPy's, the files against what spreadsheets write."""

from __future__ import annotations

import math
import tracemalloc
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from scipy.interpolate import CubicSpline, PchipInterpolator

from heuncli.base.errors import SpecError
from heuncli.kernel.choose import expressions
from heuncli.scene.expressions.curves import interpolate_points
from heuncli.scene.expressions.discontinuities import find_discontinuities
from heuncli.scene.expressions.grammar import compile_expression
from heuncli.scene.expressions.programs import Expression, Pack, TableFunction
from heuncli.scene.expressions.scope import Scope
from heuncli.scene.file_format.column_layout import CsvError, MissingColumnError
from heuncli.scene.file_format.columns import read_column_numbers
from heuncli.scene.file_format.load import load

BODY = "heun: 1\nbodies: {b: {mass: 1, center: [0, 0, 0], inertia: [1, 1, 1], points: {p: [0, 0, 0]}}}\n"


def of(table: TableFunction, text: str = "table(f, t)") -> Expression:
    return compile_expression(text, Scope(tables={"f": table}, in_time=True))


def points(n: int, seed: int = 1) -> tuple[list[float], list[float]]:
    rng = np.random.default_rng(seed)
    return np.cumsum(rng.uniform(0.1, 1.0, n)).tolist(), rng.normal(size=n).tolist()


@pytest.mark.parametrize("n", [2, 3, 4, 5, 17])
@pytest.mark.parametrize("kind", ["linear", "cubic", "pchip"])
def test_curves_are_scipys(n: int, kind: str) -> None:
    x, y = points(n, seed=n)
    curve = of(interpolate_points("f", x, y, kind, None, None))
    oracle = {"linear": None, "cubic": CubicSpline(x, y), "pchip": PchipInterpolator(x, y)}[kind]
    for t in np.linspace(x[0], x[-1], 101).tolist():
        value, first, second = curve.derivatives(t)
        if oracle is None:
            assert value == pytest.approx(float(np.interp(t, x, y)), abs=1e-12)
            continue
        assert value == curve.value(t)
        assert [value, first, second] == pytest.approx([float(oracle(t, k)) for k in range(3)], rel=1e-9, abs=1e-9)


@pytest.mark.parametrize("n", [2, 3, 4, 5, 17])
def test_a_natural_spline_is_scipys(n: int) -> None:
    x, y = points(n, seed=n)
    curve, oracle = of(interpolate_points("f", x, y, "natural", "hold", None)), CubicSpline(x, y, bc_type="natural")
    for t in np.linspace(x[0], x[-1], 101)[1:-1].tolist():
        found, known = list(curve.derivatives(t)), [float(oracle(t, k)) for k in range(3)]
        assert found == pytest.approx(known, rel=1e-9, abs=1e-9)
    held = [curve.value(t) for t in (x[0] - 1.0, x[-1] + 1.0)]
    assert held == pytest.approx([y[0], y[-1]], rel=1e-12, abs=1e-12)


def test_ends_of_a_cubic_table() -> None:
    """Natural ends bend nothing there; not-a-knot, in words or by default, goes on as one cubic."""
    head = "interpolation: cubic, x: [0, 1, 3, 4, 6], y: [0, 2, 1, 3, 2]"
    x, y = [0.0, 1.0, 3.0, 4.0, 6.0], [0.0, 2.0, 1.0, 3.0, 2.0]
    for more, kind in ((", ends: natural", "natural"), (", ends: not-a-knot", "not-a-knot"), ("", "not-a-knot")):
        tail = "forces: {p: {type: force, on: b.p, vector: ['table(f, t)', 0, 0]}}\nanalysis: {duration: 6}\n"
        force: Any = load("x.yaml", f"{BODY}tables: {{f: {{{head}{more}}}}}\n{tail}").forces["p"]
        curve = force.vector[0]
        oracle = CubicSpline(x, y, bc_type=kind)
        for t in (0.01, 0.7, 2.0, 3.5, 5.99):
            known = [float(oracle(t, k)) for k in range(3)]
            assert list(curve.derivatives(t)) == pytest.approx(known, rel=1e-9, abs=1e-9)


@pytest.mark.parametrize(("more", "told"), [
    ("", "a linear table takes no condition at its ends"),
    (", interpolation: pchip", "a pchip table takes no condition at its ends"),
    (", interpolation: cubic, period: 2", "a periodic table takes no ends"),
])  # fmt: skip
def test_ends_are_of_cubic_tables_that_have_some(more: str, told: str) -> None:
    with pytest.raises(SpecError, match=told) as caught:
        load("x.yaml", f"{BODY}tables: {{f: {{x: [0, 1, 2], y: [0, 1, 0], ends: natural{more}}}}}\n")
    assert [(p.code, p.location.path) for p in caught.value.problems if p.location] == [("table-form", "tables.f.ends")]


@pytest.mark.parametrize("n", [3, 4, 5, 17])
def test_periodic_curves_close_smoothly(n: int) -> None:
    x, y = points(n, seed=n)
    y[-1] = y[0]
    period = x[-1] - x[0]
    spline = of(interpolate_points("f", x, y, "cubic", None, period))
    oracle = CubicSpline(x, y, bc_type="periodic")
    for t in np.linspace(x[0] - 3 * period, x[-1] + 3 * period, 203).tolist():
        assert spline.value(t) == pytest.approx(float(oracle(t)), abs=1e-9)
    for kind in ("cubic", "pchip"):
        curve = of(interpolate_points("f", x, y, kind, None, period))
        before, after = curve.derivatives(math.nextafter(x[-1], 0.0)), curve.derivatives(x[-1])
        assert before[:2] == pytest.approx(after[:2], abs=1e-9)


def test_a_monotone_curve_does_not_overshoot() -> None:
    curve = of(interpolate_points("f", [0.0, 1.0, 2.0, 3.0], [0.0, 0.0, 1.0, 1.0], "pchip", None, None))
    values = [curve.value(t) for t in np.linspace(0.0, 3.0, 301)]
    assert min(values) == 0.0
    assert max(values) == 1.0


def test_outside() -> None:
    x, y = [1.0, 2.0, 3.0], [5.0, 7.0, 4.0]
    refused, held = (
        of(interpolate_points("f", x, y, "linear", None, None)),
        of(interpolate_points("f", x, y, "linear", "hold", None)),
    )
    for t in (0.999999, 3.000001, -1e9, 1e9):
        assert math.isnan(refused.value(t))
        assert all(map(math.isnan, refused.derivatives(t)))
    assert [refused.value(t) for t in x] == y
    assert [held.value(t) for t in (-9.0, 1.0, 3.0, 99.0)] == [5.0, 5.0, 4.0, 4.0]
    assert held.derivatives(0.5) == (5.0, 0.0, 0.0)
    assert held.derivatives(1.5) == (6.0, 2.0, 0.0)


def test_the_chain_rule_goes_through_tables() -> None:
    curve = of(interpolate_points("f", *points(9), "cubic", None, None), "table(f, 2 + sin(t))")
    value, first, second = curve.derivatives(0.4)
    inner = of(interpolate_points("f", *points(9), "cubic", None, None)).derivatives(2.0 + math.sin(0.4))
    c, s = math.cos(0.4), math.sin(0.4)
    assert [value, first, second] == pytest.approx([inner[0], inner[1] * c, inner[2] * c * c - inner[1] * s], rel=1e-12)


def test_constants_from_tables() -> None:
    table = interpolate_points("f", [0.0, 1.0], [2.0, 4.0], "linear", None, None)
    other = interpolate_points("g", [0.0, 1.0], [0.0, 10.0], "linear", None, None)
    scope = Scope(tables={"f": table, "g": other}, in_time=True)
    found = compile_expression("table(f, 0.5) + table(g, 0.1)*table(f, 0)", scope)
    assert found.constant == 5.0
    assert of(table, "table(f, 5) if t < 0 else 1").value(1.0) == 1.0


@pytest.mark.parametrize("text", [
    "a,b\n1,2\n3,4\n", "a;b\r\n1;2\r\n3;4\r\n", "a\tb\n1\t2\n3\t4", "a b\n 1 2\n3   4\n", '"a","b"\n"1","2"\n3,4\n',
    "# made by hand\n\na , b\n1, 2\n\n# half way\n3, 4\n", "a;b\n1,0;2,0\n3;4\n",
    "a,c,b\n1,x,2\n3,y,4\n",
])  # fmt: skip
def test_files_as_programs_write_them(text: str) -> None:
    assert [*map(list, read_column_numbers(text, "a", "b"))] == [[1.0, 3.0], [2.0, 4.0]]


def test_columns_by_number() -> None:
    assert [*map(list, read_column_numbers("1,2,3\n4,5,6\n", 3, "1"))] == [[3.0, 6.0], [1.0, 4.0]]
    assert [*map(list, read_column_numbers("a,b\n1,2\n", 2, 1))] == [[2.0], [1.0]]


@pytest.mark.parametrize(("text", "line", "words"), [
    ("", 1, "no rows"), ("# nothing\n", 1, "no rows"), ("a,b\n1,2\n3\n", 3, "column 2 is missing"),
    ("a,b\n1,2\n\n3,x\n", 4, "'x'"), ("a,b\n1,2\n3,nan\n", 3, "'nan'"), ("a,b\n1,2\n3,1e999\n", 3, "'1e999'"),
    ('a,b\n1,"2\n', 2, "cannot be read"),
    ("a,b\n1_0,2\n", 2, "'1_0'"),
])  # fmt: skip
def test_files_with_accidents(text: str, line: int, words: str) -> None:
    with pytest.raises(CsvError) as caught:
        read_column_numbers(text, "a", "b")
    assert caught.value.line == line
    assert words in caught.value.finding.message


@pytest.mark.parametrize(("text", "wanted", "number", "words", "hint"), [
    ("a,c\n1,2\n", ("a", "b"), 1, "no column 'b'", "columns: a, c"),
    ("angle,pressure\n1,2\n", ("angel", "pressure"), 0, "no column 'angel'", "did you mean angle? columns: "),
    ("1,2\n", ("a", 2), 0, "no column 'a'", "the first row contains numbers"),
    ("1,2\n", (1, 3), 1, "no column 3", "from 1 to 2"),
    ("1,2\n", (0, 1), 0, "no column 0", "from 1 to 2"),
])  # fmt: skip
def test_columns_that_are_not_there(text: str, wanted: tuple[object, ...], number: int, words: str, hint: str) -> None:
    with pytest.raises(MissingColumnError) as caught:
        read_column_numbers(text, *wanted)
    assert caught.value.number == number
    assert words in caught.value.finding.message
    assert hint in (caught.value.finding.hint or "")


def test_a_column_that_is_not_there_is_told_where_it_is_asked_for(tmp_path: Path) -> None:
    (tmp_path / "gas.csv").write_text("angle,pressure\n0,1\n1,2\n")
    for key, columns in (("x", "x: angel, y: pressure"), ("y", "x: angle, y: presure")):
        spec = tmp_path / "a.yaml"
        spec.write_text(BODY + f"tables: {{f: {{file: gas.csv, {columns}}}}}\n")
        with pytest.raises(SpecError) as caught:
            load(spec)
        (problem,) = caught.value.problems
        assert problem.location is not None
        assert (problem.location.file, problem.location.path) == (str(spec), f"tables.f.{key}")
        assert "gas.csv" in problem.message
        assert "columns: angle, pressure" in (problem.hint or "")


def test_a_table_from_a_file(tmp_path: Path) -> None:
    (tmp_path / "gas.csv").write_text("angle;pressure\n0;1,0\n360;25,5\n720;1,0\n")
    spec = tmp_path / "engine.yaml"
    spec.write_text(BODY + "tables: {gas: {file: gas.csv, x: angle, y: pressure, x_unit: deg, y_unit: bar, "
                    "period: 720 deg, interpolation: cubic}}\n"
                    'forces: {gas: {type: force, on: b.p, vector: ["table(gas, t)*1e-4", 0, 0]}}\n')  # fmt: skip
    scene = load(spec)
    table = scene.tables["gas"]
    assert table.x == pytest.approx([0.0, 2 * math.pi, 4 * math.pi])
    assert table.y == pytest.approx([1e5, 25.5e5, 1e5])
    value = scene.forces["gas"].vector[0]  # type: ignore[union-attr]
    assert value.value(2 * math.pi) == pytest.approx(255.0)
    assert value.value(6 * math.pi) == pytest.approx(255.0)
    assert load("-", text="heun: 1\nbodies: {b: {mass: 1, center: [0,0,0], inertia: [0,0,0]}}\n").tables == {}


@pytest.mark.parametrize(("entry", "code", "path", "words"), [
    ("{x: [0, 1], y: [1]}", "table-shape", "tables.f", "2 values of x and 1"),
    ("{x: [0], y: [1]}", "table-shape", "tables.f", "two points"),
    ("{x: [0, 0], y: [1, 2]}", "table-shape", "tables.f.x.1", "jump"),
    ("{x: [0, 1], y: [1, a]}", "unknown-name", "tables.f.y.1", "'a'"),
    ("{x: [0, 1], y: [1, true]}", "wrong-kind", "tables.f.y.1", "true"),
    ("{x: 1, y: 2}", "table-form", "tables.f", "lists"),
    ("{file: a.csv, x: [1, 2], y: 2}", "table-form", "tables.f", "columns"),
    ("{x: [0, 1], y: [1, 1], period: 1, outside: hold}", "table-form", "tables.f.outside", "outside"),
    ("{x: [0, 360], y: [1, 1], x_unit: deg, period: 360}", "table-period", "tables.f.period", "360 deg"),
    ("{x: [0, 1], y: [1, 2], period: 1}", "table-period", "tables.f.period", "must be equal"),
    ("{x: [0, 1], y: [1, 2], x_unit: degs}", "unknown-unit", "tables.f.x_unit", "deg"),
    ("{x: [0, 1], y: [1, 2], interpolation: spline}", "unknown-word", "tables.f.interpolation", "cubic"),
    ("{x: [0, 1e-320], y: [1, 2]}", "magnitude", "tables.f.x.1", "1e-60"),
    ("{x: [0, 1e-55], x_unit: mm, y: [0, 1e60], y_unit: kN}", "magnitude", "tables.f.y.1", "1e60"),
    ("{x: [0, 1e-58], x_unit: mm, y: [0, 1]}", "magnitude", "tables.f.x.1", "1e-60"),
    ("{x: [0, 1], y: [1, 2], z: 3}", "unknown-key", "tables.f.z", "z"),
    ("{file: none.csv}", "table-file", "tables.f.file", "none.csv"),
    ("{file: .}", "table-file", "tables.f.file", "cannot be read"),
    ("5", "wrong-kind", "tables.f", "mapping"),
])  # fmt: skip
def test_tables_with_accidents(entry: str, code: str, path: str, words: str) -> None:
    with pytest.raises(SpecError) as caught:
        load("x.yaml", text=BODY + f"tables: {{f: {entry}}}\n")
    (problem,) = caught.value.problems
    assert problem.location is not None
    assert (problem.code, problem.location.path) == (code, path)
    assert words in f"{problem.message} {problem.hint}"


def test_an_accident_in_a_file_is_told_in_that_file(tmp_path: Path) -> None:
    (tmp_path / "gas.csv").write_text("a,b\n0,1\n1,x\n")
    spec = tmp_path / "engine.yaml"
    spec.write_text(BODY + "tables: {f: {file: gas.csv, x: a, y: b}}\n")
    with pytest.raises(SpecError) as caught:
        load(spec)
    (problem,) = caught.value.problems
    assert str(problem.location) == f"{tmp_path / 'gas.csv'}:3:1"


def test_a_number_of_a_file_is_told_by_its_row(tmp_path: Path) -> None:
    (tmp_path / "gas.csv").write_text("a,b\n0,1\n1,1e70\n")
    (tmp_path / "engine.yaml").write_text(BODY + "tables: {f: {file: gas.csv, x: a, y: b}}\n")
    with pytest.raises(SpecError) as caught:
        load(tmp_path / "engine.yaml")
    (problem,) = caught.value.problems
    assert problem.code == "magnitude"
    assert problem.location is not None
    assert (problem.location.file, problem.location.line) == (str(tmp_path / "gas.csv"), 3)
    assert problem.message.startswith("number 2 of y (SI) is 1e+70, too large")


def test_units_inside_lists() -> None:
    scene = load("x.yaml", text=BODY + "parameters: {w: 5}\n"
                 "tables: {f: {x: [0, 90, 180 deg, 2*pi], x_unit: deg, y: [0, 1 bar, w, '2*w']}}\n")  # fmt: skip
    assert scene.tables["f"].x == pytest.approx([0.0, math.pi / 2, math.pi, 2 * math.pi])
    assert list(scene.tables["f"].y) == [0.0, 1e5, 5.0, 10.0]


@pytest.mark.heavy
def test_the_numbers_of_a_table_stand_once_however_many_expressions_use_it() -> None:
    """Values, bounds and jumps of a hundred expressions, one of them at a constant: no copy of the table is made."""
    many = 20_000
    table = interpolate_points("f", [0.001 * i for i in range(many)], [0.0] * many, "linear", "hold", None)
    scope = Scope(tables={"f": table}, in_time=True)
    size = 8 * len(table.numbers)
    tracemalloc.start()
    try:
        made = [compile_expression(f"{i} + table(f, {'t' if i else '0.5'})", scope) for i in range(100)]
        assert [e.value(0.25) for e in made] == list(range(100))
        assert [e.bounds([0.0], [1.0])[1][0] for e in made[1:]] == list(range(1, 100))
        assert find_discontinuities(made[1], 0.0, 0.0025) == pytest.approx([0.001, 0.002])
        pack = Pack()
        for e in made:
            pack.add(e)
        _, most = tracemalloc.get_traced_memory()
    finally:
        tracemalloc.stop()
    assert len(pack.tables) == 1
    assert pack.tables[0] is table.numbers
    assert most < 2 * size + 500_000  # packs of their own took 200 times its size


@pytest.mark.skipif(not expressions.COMPILED, reason="only there it is read by its address")
def test_numbers_that_the_kernel_reads_keep_their_place() -> None:
    table = interpolate_points("f", [0.0, 1.0], [0.0, 1.0], "linear", "hold", None)
    pack = compile_expression("table(f, t)", Scope(tables={"f": table}, in_time=True)).pack
    assert pack.expressions is not None
    with pytest.raises(BufferError):
        table.numbers.append(0.0)
