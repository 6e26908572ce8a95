"""Data files as benches, loggers and spreadsheets write them: a trait each; right numbers, or the right refusal."""

from __future__ import annotations

from pathlib import Path
from typing import NamedTuple

import pytest

from heuncli.base.errors import Problem, SpecError
from heuncli.scene.file_format.load import load

BODY = "heun: 1\nbodies: {b: {mass: 1, center: [0, 0, 0], inertia: [1, 1, 1]}}\n"
NAMED = "x: time, y: force"
NUMBERED = "x: 1, y: 2"


def read(folder: Path, content: str | bytes, keys: str) -> tuple[list[tuple[float, float]], list[Problem]]:
    """The points of a table of this file, in SI, and the warnings."""
    (folder / "data.csv").write_bytes(content.encode() if isinstance(content, str) else content)
    spec = load(folder / "spec.yaml", BODY + f"tables:\n  f: {{file: data.csv, {keys}}}\n")
    table = spec.tables["f"]
    return [*zip(table.x, table.y, strict=True)], [*spec.warnings]


POINTS = [(0.0, 1.0), (1.5, 3.0)]
READ = {  # a file, the keys of the table
    "names behind #": ("#time,force\n0,1\n1.5,3\n", NAMED),
    "names behind # beside words": ("# time,state,force\n0,boost,1\n1.5,boost,3\n", NAMED),
    "words first": ("#state,time,force\nboost,0,1\nboost,1.5,3\n", NAMED),
    "numpy.savetxt": ("# time force\n0.0 1.0\n1.5 3.0\n", NAMED),
    "commas in the # row alone": ("# time, force\n0.0 1.0\n1.5 3.0\n", NAMED),
    "last # row": ("# made, by me\n# time,force\n# 17 lines\n0,1\n1.5,3\n", NAMED),
    "a # row above a header": ("# a, b\ntime,force\n0,1\n1.5,3\n", NAMED),
    "units behind #": ("# time [ms],force [kN]\n0,0.001\n1500,0.003\n", NUMBERED),
    "# row of another width": ("# a,b,c\n0,1\n1.5,3\n", NUMBERED),
    "blanks behind # are no names": ("# in kN\n0 1\n1.5 3\n", NUMBERED),
    "# rows below the header": ("time,force\n# ms,kN\n0,1\n# half,way\n1.5,3\n", NAMED),
    "spaces in the file": (" time , force ,flag\n0,1,a\n1.5,3,b\n", NAMED),
    "spaces in the spec": ("time,force,flag\n0,1,a\n1.5,3,b\n", 'x: " time", y: "force  "'),
    "spaces before quotes": ('"time", "force"\n0, 1\n1.5, "3"\n', NAMED),
    "tabs and decimal commas": ("time\tforce\n0,0\t1,0\n1,5\t3,0\n", NAMED),
    "tabs, decimal commas, no header": ("0,0\t1,0\n1,5\t3,0\n", NUMBERED),
    "blanks and decimal commas": ("time force\n0,0 1,0\n1,5 3,0\n", NAMED),
    "blanks and decimal commas, no header": ("0,0 1,0\n1,5 3,0\n", NUMBERED),
    "quoted decimal commas": ('time,force\n"0,0","1,0"\n"1,5","3,0"\n', NAMED),
    "quoted decimal commas and words": ('time,state,force\n"0,0",on,"1,0"\n"1,5",on,"3,0"\n', NAMED),
    "semicolons in quotes": ('"time",force,"a;b"\n0,1,2\n1.5,3,4\n', NAMED),
    "Excel's first line": ("sep=;\ntime;force\n0;1\n1,5;3\n", NAMED),
    "Fortran": ("time force\n0.0D0 1.0D+00\n1.5d0 0.3D1\n", NAMED),
    "Latin-1": ("time;force;Temperatur \xb0C\n0;1;20\n1,5;3;20\n".encode("latin-1"), NAMED),
    "Latin-1 in a name": ("time;Kraft f\xfcr\n0;1\n1,5;3\n".encode("latin-1"), "x: time, y: Kraft f\xfcr"),
    "Windows": ("time;force \x96 axial\n0;1\n1,5;3\n".encode("latin-1"), "x: time, y: force \u2013 axial"),
    "UTF-8 with its mark": ("\ufefftime,force\n0,1\n1.5,3\n", NAMED),
    "UTF-16": ("time\tforce\r\n0,0\t1,0\r\n1,5\t3,0\r\n".encode("utf-16"), NAMED),
    "UTF-16 big": (b"\xfe\xff" + "time,force\n0,1\n1.5,3\n".encode("utf-16-be"), NAMED),
    "skip": ("Device;17\nRate;100\n\ntime;force\n0;1\n1,5;3\n", f"{NAMED}, skip: 3"),
    "skip to blank lines": ("Device;17\nRate;100\n\ntime;force\n0;1\n1,5;3\n", f"{NAMED}, skip: 2"),
    "skip nothing": ("time;force\n0;1\n1,5;3\n", f"{NAMED}, skip: 0"),
    "skip by a parameter's words": ("17\ntime;force\n0;1\n1,5;3\n", f'{NAMED}, skip: "3 - 2"'),
    "skip, by number": ("1,2\n3,4\n0,1\n1.5,3\n", f"{NUMBERED}, skip: 2"),
    "skip numbers behind #": ("# a,b\n9,9\n# time,force\n0,1\n1.5,3\n", f"{NAMED}, skip: 2"),
}  # fmt: skip


@pytest.mark.parametrize("name", READ)
def test_what_programs_write_is_read(name: str, tmp_path: Path) -> None:
    content, keys = READ[name]
    points, warnings = read(tmp_path, content, keys)
    assert points == POINTS
    assert not warnings


class Gaps(NamedTuple):
    content: str
    gaps: str
    points: list[tuple[float, float]]
    line: int
    words: str


GAPS = {
    "empty": Gaps("t,F\n0,1\n1,\n2,3\n", "skip", [(0, 1), (2, 3)], 3, "1 of 3 rows has a gap: 1 left out"),
    "words": Gaps("t,F\n0,1\nNaN,2\n1,n/a\n1.5,--\n2,3\n", "skip", [(0, 1), (2, 3)], 3, "3 of 5 rows have a gap"),
    "short row": Gaps("t,F\n0,1\n1\n2,3\n", "skip", [(0, 1), (2, 3)], 3, "1 of 3 rows"),
    "at the ends": Gaps("t,F\n0,\n1,2\n2,3\n3,\n", "linear", [(1, 2), (2, 3)], 2, "2 of 4 rows have a gap: 2 left out"),
    "filled": Gaps("t,F\n0,1\n1,\n3,\n4,9\n", "linear", [(0, 1), (1, 3), (3, 7), (4, 9)], 3,
                   "2 of 4 rows have a gap: 2 filled"),
    "filled and left out": Gaps("t,F\n0,1\n,5\n2,nan\n4,9\n", "linear", [(0, 1), (2, 5), (4, 9)], 3,
                                "2 of 4 rows have a gap: 1 left out, 1 filled"),
    "decimal commas": Gaps("t;F\n0;1,5\n# here\n1;-\n2;3\n", "skip", [(0, 1.5), (2, 3)], 4, "1 of 3 rows"),
}  # fmt: skip


@pytest.mark.parametrize("name", GAPS)
def test_gaps_are_closed_as_asked_and_counted(name: str, tmp_path: Path) -> None:
    case = GAPS[name]
    points, (warning,) = read(tmp_path, case.content, f"{NUMBERED}, gaps: {case.gaps}")
    assert points == case.points
    assert warning.location is not None
    assert (warning.code, warning.location.line) == ("table-gaps", case.line)
    assert case.words in warning.message
    with pytest.raises(SpecError) as refused:
        read(tmp_path, case.content, NUMBERED)
    assert [problem.code for problem in refused.value.problems] == ["table-file"]
    for gaps in ("refuse", "skip", "linear"):
        assert read(tmp_path, "t,F\n0,1\n1.5,3\n", f"{NUMBERED}, gaps: {gaps}") == (POINTS, [])


LONG = "time,force\n" + "".join(f"{k / 1000},{k}\n" for k in range(3000))
REFUSED = {  # a file, the keys; the code, the line in the data file (0: in the spec), words
    "x twice": (LONG.replace("1.5,1500", "1.499,1500"), NAMED, "table-shape", 1502, "1.499 follows 1.499"),
    "x falls": ("time,force\n0,1\n\n# here\n2,3\n1,4\n", NAMED, "table-shape", 6, "sort the points"),
    "x twice beside gaps": ("time,force\n0,1\n1,\n2,3\n2,4\n", f"{NAMED}, gaps: skip", "table-shape", 5, "increase x"),
    "x twice after skip": ("a\nb\ntime,force\n0,1\n0,4\n", f"{NAMED}, skip: 2", "table-shape", 5, "increase x"),
    "too large": ("time,force\n0,1\n1,1e70\n", NAMED, "magnitude", 3, "number 2 of y"),
    "preamble": ("Device;17\nRate;100\n\ntime;force\n0;1\n", NAMED, "table-file", 0, "this name: give skip: 3"),
    "preamble and units": ("Device,17\nTime (s),F (N)\n0,1\n1,2\n", "x: Time, y: F", "table-file", 0, "skip: 1"),
    "preamble, by number": ("Device;17\nRate;100\ntime;force\n0;1\n", NUMBERED, "table-file", 2, "skip: N"),
    "preamble of one cell": ("Report\ntime,force\n0,1\n", NUMBERED, "table-file", 0, "skip: N"),
    "skipped all": ("time,force\n0,1\n", f"{NAMED}, skip: 5", "table-file", 1, "no rows after line 5"),
    "skip below 0": ("time,force\n0,1\n", f"{NAMED}, skip: -1", "table-form", 0, "0 or more"),
    "two marks": ("time\tforce\n0\t0,5\n1\t1.5\n", NAMED, "table-file", 3, "two decimal marks"),
    "two marks in quotes": ('time,force\n0,"0,5"\n1,1.5\n', NAMED, "table-file", 3, "two decimal marks"),
    "thousands, tabs": ("time\tforce\n0\t1,234\n1\t2,345\n", NAMED, "table-file", 2, "thousands"),
    "thousands, quotes": ('time,force\n0,"1,234"\n1,"2,345"\n', NAMED, "table-file", 2, "thousands"),
    "bare decimal commas": ("time,force\n0,0,1,0\n1,5,3,0\n", NAMED, "table-file", 2, "decimal marks"),
    "another name": ("time, force ,flag,note\n0,1,a,\n1,2,b,7\n", "x: time, y: Forse", "table-file", 0, "time, force"),
    "a name beside a footer": (LONG + "end,of,file\n", "x: time, y: Forse", "table-file", 0, "columns: time, force"),
    "a name, open rows": ("time,force\n0,1,\n1,2,\n", "x: time, y: F", "table-file", 0, "columns: time, force"),
    "names with gaps": ("time,force\n0,\n1,2\n", "x: time, y: f", "table-file", 0, "columns: time, force"),
    "no text": (b"PK\x03\x04\x14\x00\x06\x00", NUMBERED, "table-file", 0, "not a text"),
    "UTF-16 cut off": (b"\xff\xfe" + "0,1\n".encode("utf-16-le")[:-1], NUMBERED, "table-file", 0, "not UTF-16"),
    "a gap": ("time,force\n0,1\n1,NaN\n", NAMED, "table-file", 3, "gaps: skip"),
    "gaps only": ("time,force\n0,\n1,\n", f"{NAMED}, gaps: linear", "table-shape", 0, "at least two points"),
}  # fmt: skip


@pytest.mark.parametrize("name", REFUSED)
def test_what_is_no_table_is_told_at_its_place(name: str, tmp_path: Path) -> None:
    content, keys, code, line, words = REFUSED[name]
    with pytest.raises(SpecError) as refused:
        read(tmp_path, content, keys)
    problem = next(one for one in refused.value.problems if one.code == code)
    assert problem.location is not None
    file = tmp_path / ("data.csv" if line else "spec.yaml")
    assert (problem.location.file, problem.location.line) == (str(file), line or 4)
    assert words in f"{problem.message} {problem.hint}"


@pytest.mark.parametrize("key", ["skip: 1", "gaps: skip"])
def test_keys_of_files_do_not_go_with_lists(key: str) -> None:
    with pytest.raises(SpecError) as refused:
        load("spec.yaml", BODY + f"tables: {{f: {{x: [0, 1], y: [0, 1], {key}}}}}\n")
    (problem,) = refused.value.problems
    assert problem.location is not None
    assert (problem.code, problem.location.path) == ("table-form", f"tables.f.{key.partition(':')[0]}")
