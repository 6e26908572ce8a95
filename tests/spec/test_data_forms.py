"""Data files that are no CSV: Excel, Parquet, rocket motors, LabVIEW; the same numbers, or the right refusal."""

from __future__ import annotations

import io
import sys
import zipfile
from pathlib import Path
from typing import Any

import pytest

from heuncli.base.errors import Problem, SpecError
from heuncli.scene.file_format.load import load
from heuncli.study.queries.expectations import compare
from heuncli.study.workflow import solve

BODY = "heun: 1\nbodies: {b: {mass: 1, center: [0, 0, 0], inertia: [1, 1, 1]}}\n"
POINTS = [(0.0, 1.0), (1.5, 3.0)]
TABLE = "x: time, y: force"


def read(folder: Path, name: str, keys: str = TABLE) -> list[tuple[float, float]]:
    spec = load(folder / "spec.yaml", BODY + f"tables:\n  f: {{file: {name}, {keys}}}\n")
    assert not spec.warnings
    return [*zip(spec.tables["f"].x, spec.tables["f"].y, strict=True)]


def refused(folder: Path, name: str, keys: str = TABLE) -> tuple[str, str, str]:
    with pytest.raises(SpecError) as caught:
        read(folder, name, keys)
    (problem,) = caught.value.problems
    return problem.code, problem.message, problem.hint or ""


def line_of(problem: Problem) -> int:
    assert problem.location is not None
    return problem.location.line


def zipped(name: str) -> bytes:
    packed = io.BytesIO()
    with zipfile.ZipFile(packed, "w") as parts:
        parts.writestr(name, "0,1\n")
    return packed.getvalue()


# Excel


def write_workbook(path: Path, sheets: dict[str, list[list[Any]]]) -> None:
    openpyxl = pytest.importorskip("openpyxl")
    book = openpyxl.Workbook()
    book.remove(book.active)
    for name, rows in sheets.items():
        sheet = book.create_sheet(name)
        for row in rows:
            sheet.append(row)
    book.save(path)


ROWS: list[list[Any]] = [["time", "note", "force"], [0, "a", 1.0], [1.5, 'b\t"c"\nd', 3]]


def test_a_sheet_of_excel_is_read_as_a_csv_file_is(tmp_path: Path) -> None:
    write_workbook(tmp_path / "a.xlsx", {"Bench": ROWS, "Other": [["time", "force"], [0, 5], [2, 6]]})
    assert read(tmp_path, "a.xlsx") == POINTS
    assert read(tmp_path, "a.xlsx", f"{TABLE}, sheet: Bench") == POINTS
    assert read(tmp_path, "a.xlsx", f"{TABLE}, sheet: Other") == [(0, 5), (2, 6)]
    code, message, hint = refused(tmp_path, "a.xlsx", f"{TABLE}, sheet: Othr")
    assert code == "table-file" and "no sheet 'Othr'" in message and "Other" in hint


def test_skip_gaps_units_and_all_digits_hold_for_excel(tmp_path: Path) -> None:
    rows: list[list[Any]] = [["Device 17"], [], ["t [ms]", "F [kN]"], [0, 0.1], [1500, 1 / 3], [1600, None], [1700, 2]]
    write_workbook(tmp_path / "a.xlsx", {"Bench": rows})
    spec = load(tmp_path / "spec.yaml", BODY + "tables: {f: {file: a.xlsx, x: t, y: F, skip: 2, gaps: skip}}\n")
    assert [*spec.tables["f"].y] == [0.1 * 1e3, 1 / 3 * 1e3, 2e3] and [*spec.tables["f"].x] == [0, 1.5, 1.7]
    (warning,) = spec.warnings
    assert warning.code == "table-gaps" and line_of(warning) == 6
    code, message, _ = refused(tmp_path, "a.xlsx", "x: t, y: F, skip: 2")
    assert code == "table-file" and "column 2 is missing" in message


def test_a_word_in_a_column_is_refused_at_its_row(tmp_path: Path) -> None:
    write_workbook(tmp_path / "a.xlsx", {"Bench": [["time", "force"], [0, 1], [1, "two"], [2, 3]]})
    with pytest.raises(SpecError) as caught:
        read(tmp_path, "a.xlsx")
    assert line_of(caught.value.problems[0]) == 3


def test_another_zip_or_a_damaged_workbook_is_refused(tmp_path: Path) -> None:
    pytest.importorskip("openpyxl")
    (tmp_path / "a.xlsx").write_bytes(zipped("a.csv"))
    assert "no workbook" in refused(tmp_path, "a.xlsx")[1]
    (tmp_path / "a.xlsx").write_bytes(b"PK\x03\x04 and no more")
    assert "no workbook" in refused(tmp_path, "a.xlsx")[1]
    (tmp_path / "a.xlsx").write_bytes(zipped("xl/workbook.xml"))
    assert "damaged" in refused(tmp_path, "a.xlsx")[1]


def test_a_workbook_that_unpacks_to_too_much_is_refused(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    write_workbook(tmp_path / "a.xlsx", {"Bench": ROWS})
    monkeypatch.setattr("heuncli.scene.file_format.data_files.MAX_UNPACKED_SIZE", 1000)
    assert refused(tmp_path, "a.xlsx")[0] == "too-large"


def test_a_sheet_is_named_of_excel_files_only(tmp_path: Path) -> None:
    (tmp_path / "a.csv").write_text("time,force\n0,1\n1.5,3\n")
    assert "no Excel file" in refused(tmp_path, "a.csv", f"{TABLE}, sheet: a")[1]
    with pytest.raises(SpecError, match="sheet is given without a file"):
        load("x.yaml", BODY + "tables: {f: {x: [0, 1], y: [0, 1], sheet: a}}\n")


# Parquet


def write_parquet(path: Path, columns: dict[str, list[Any]]) -> None:
    pa = pytest.importorskip("pyarrow")
    from pyarrow import parquet

    parquet.write_table(pa.table(columns), path)


def test_parquet_is_read_as_a_csv_file_is(tmp_path: Path) -> None:
    write_parquet(tmp_path / "a.parquet", {"time": [0.0, 1.5], "note": ["a", None], "force": [1, 3]})
    assert read(tmp_path, "a.parquet") == POINTS
    write_parquet(tmp_path / "b.parquet", {"t [ms]": [0.0, 1.0, 1500.0], "F": [1.0, None, 3.0]})
    spec = load(tmp_path / "spec.yaml", BODY + "tables: {f: {file: b.parquet, x: t, y: F, gaps: skip}}\n")
    assert [*spec.tables["f"].x] == [0.0, 1.5] and spec.warnings[0].code == "table-gaps"
    assert refused(tmp_path, "b.parquet", "x: t, y: F")[0] == "table-file"
    (tmp_path / "c.parquet").write_bytes(b"PAR1 and no more")
    assert "not Parquet" in refused(tmp_path, "c.parquet")[1]


@pytest.mark.parametrize(
    ("content", "package", "extra"),
    [(zipped("xl/workbook.xml"), "openpyxl", "heuncli[excel]"), (b"PAR1", "pyarrow.parquet", "heuncli[parquet]")],
)
def test_without_its_package_a_file_is_refused_with_the_command_that_installs_it(
    content: bytes, package: str, extra: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setitem(sys.modules, package, None)
    (tmp_path / "a.bin").write_bytes(content)
    code, message, hint = refused(tmp_path, "a.bin")
    assert code == "missing-extra" and package.partition(".")[0] in message and extra in hint


@pytest.mark.parametrize("mark", [b"\xd0\xcf\x11\xe0", b"TDSm", b"MATLAB 5.0 MAT-file", b"\x89HDF\r\n"])
def test_other_binary_files_are_refused_with_what_to_save(mark: bytes, tmp_path: Path) -> None:
    (tmp_path / "a.bin").write_bytes(mark + bytes(100))
    code, message, hint = refused(tmp_path, "a.bin")
    assert code == "table-file" and "it is a" in message and "CSV" in hint


# Rocket motors and LabVIEW

MOTOR = """; a motor of the class C
; with a long burn
C6 18 70 0-3-5-7 0.0108 0.0231 Estes
   0.031 0.946
   0.092 4.826
   1.860 0.000
;
"""


@pytest.mark.parametrize("keys", ["x: time, y: thrust", "x: 1, y: 2"])
def test_the_thrust_of_a_rocket_motor_begins_at_0(keys: str, tmp_path: Path) -> None:
    (tmp_path / "c6.eng").write_text(MOTOR)
    assert read(tmp_path, "c6.eng", keys) == [(0, 0), (0.031, 0.946), (0.092, 4.826), (1.86, 0)]
    (tmp_path / "c6.ENG").write_text(MOTOR.replace("0.031 0.946", "0.0 0.946"))
    assert read(tmp_path, "c6.ENG", keys)[0] == (0, 0.946)


def test_a_motor_with_an_error_is_refused_at_its_line(tmp_path: Path) -> None:
    (tmp_path / "a.eng").write_text(MOTOR.replace("4.826", "4.8x"))
    with pytest.raises(SpecError) as caught:
        read(tmp_path, "a.eng", "x: 1, y: 2")
    assert line_of(caught.value.problems[0]) == 5
    (tmp_path / "a.eng").write_text(MOTOR + MOTOR)
    assert "several motors: C6, C6" in refused(tmp_path, "a.eng")[1]
    (tmp_path / "a.eng").write_text("; nothing\n")
    assert "no motor" in refused(tmp_path, "a.eng")[1]


LABVIEW = """LabVIEW Measurement\t
Separator\tTab
Decimal_Separator\t,
***End_of_Header***\t
\t
Channels\t1\t
Samples\t2\t
***End_of_Header***\t
time\tforce\tComment
0,0\t1,0
1,5\t3,0
"""


def test_the_headers_of_labview_are_passed_over(tmp_path: Path) -> None:
    (tmp_path / "a.lvm").write_text(LABVIEW)
    assert read(tmp_path, "a.lvm") == POINTS
    (tmp_path / "a.lvm").write_text(LABVIEW.replace("3,0", "x"))
    with pytest.raises(SpecError) as caught:
        read(tmp_path, "a.lvm")
    assert line_of(caught.value.problems[0]) == 11
    (tmp_path / "a.lvm").write_text(LABVIEW + LABVIEW.partition("\n")[2])
    assert "segments" in refused(tmp_path, "a.lvm")[1]


# Curves of expectations

FALL = """heun: 1
gravity: [0, 0, -9.81]
bodies: {b: {mass: 1, center: [0, 0, 0], inertia: [1, 1, 1]}}
analysis: {duration: 1, samples: 11}
expect:
  - {of: bodies.b.position.z, curve: fall.csv, x: t, y: z, rel: 1e-5, MORE}
"""


def test_curves_take_skip_gaps_and_the_same_files(tmp_path: Path) -> None:
    rows = [(0.1 * k, -0.5 * 9.81 * (0.1 * k) ** 2) for k in range(11)]
    lines = [f"{t:.1f};{z!r}" if k != 4 else f"{t:.1f};" for k, (t, z) in enumerate(rows)]
    (tmp_path / "fall.csv").write_text("\n".join(["Device;17", "Rate;10", "t;z", *lines]))
    spec = load(tmp_path / "spec.yaml", FALL.replace("MORE", "skip: 2, gaps: skip"))
    (warning,) = spec.warnings
    assert (warning.code, line_of(warning)) == ("table-gaps", 8)
    curve = spec.expect[0].curve
    assert curve is not None and [*curve.lines] == [4, 5, 6, 7, 9, 10, 11, 12, 13, 14]
    assert compare(solve(spec), spec.expect[0]).is_met
    for more in ("skip: 2", "gaps: skip", "skip: -1"):
        with pytest.raises(SpecError):
            load(tmp_path / "spec.yaml", FALL.replace("MORE", more))
    write_workbook(tmp_path / "fall.xlsx", {"s": [["t", "z"], *map(list, rows)]})
    text = FALL.replace("fall.csv", "fall.xlsx").replace("MORE", "sheet: s")
    spec = load(tmp_path / "spec.yaml", text)
    assert compare(solve(spec), spec.expect[0]).is_met
    with pytest.raises(SpecError):
        load(tmp_path / "spec.yaml", FALL.replace("curve: fall.csv, x: t, y: z, rel: 1e-5, MORE", "is: 1, skip: 2"))
