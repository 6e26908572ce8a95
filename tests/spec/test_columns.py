"""CSV files: what is read at once and what cell by cell is the same, and what no message tells."""

from __future__ import annotations

import os
import random
import subprocess
import sys
from pathlib import Path

import pytest

from heuncli.base.errors import SpecError
from heuncli.scene.file_format import column_layout, columns
from heuncli.scene.file_format.column_layout import CsvError, MissingColumnError
from heuncli.scene.file_format.columns import read_column_numbers
from heuncli.scene.file_format.load import load

BODY = "heun: 1\nbodies: {b: {mass: 1, center: [0, 0, 0], inertia: [1, 1, 1]}}\n"
CELLS = [
    "1", "-2.5", "+3", "4e-3", ".5", "6.", " 7 ", "1,5", "0x1", "1_0", "nan", "inf", "1e999", "", "a", '"8"', '"9',
    "1 2", "²", "٣", "1e", "-", "1-2", "\x0b", "1d5", "1j", "1e5,", "00012", "1E+05", "  ", "1.5.2", "+-1", "1e400",
    "5e-324", "123456789012345678901234567890.1", "2.2250738585072011e-308", "9007199254740993", "0.1",
]  # fmt: skip
EXTRA = ["", "   ", "# half way", "  # 1,2", "\t", "1"]


def outcome(text: str) -> object:
    try:
        return [list(column) for column in read_column_numbers(text, 1, 2)]
    except (CsvError, MissingColumnError) as error:
        return type(error), str(error), getattr(error, "line", None), error.finding.hint


def random_text(draw: random.Random) -> str:
    mark = draw.choice([",", ";", "\t", " ", ", ", " ; "])
    plain = draw.random() < 0.6
    cells = CELLS[:7] if plain else CELLS
    lines = [mark.join(draw.choice(cells) for _ in range(draw.choice([2, 2, 2, 3]))) for _ in range(draw.randint(1, 6))]
    if draw.random() < 0.5:
        lines.insert(0, mark.join(["x", "y", "z"][: draw.randint(2, 3)]))
    for _ in range(draw.choice([0, 0, 1, 2])):
        lines.insert(draw.randint(0, len(lines)), draw.choice(EXTRA))
    return draw.choice(["\n", "\n", "\r\n", "\r"]).join(lines) + draw.choice(["", "\n"])


@pytest.mark.parametrize("seed", range(4))
def test_numpy_reads_what_is_read_cell_by_cell(seed: int, monkeypatch: pytest.MonkeyPatch) -> None:
    draw = random.Random(seed)
    texts = [random_text(draw) for _ in range(500)]
    monkeypatch.setattr(column_layout, "PIECE", 8)  # several pieces in a few lines
    found = [outcome(text) for text in texts]
    assert sum(isinstance(result, list) for result in found) > 50
    monkeypatch.setattr(columns, "read_plain", lambda *_: False)
    for text, result in zip(texts, found, strict=True):
        assert outcome(text) == result, repr(text)


FIRST = [  # a text; the first column by number, or what is said
    ("0,1,\n1,2,\n2,3,\n", [0, 1, 2]),
    ("0,1,start\n1,2,\n2,3,end\n", [0, 1, 2]),
    ("0;1,5;\n1;2,5;\n", [0, 1]),
    ("0,1,start\n1,2,7\n", [1]),  # names that are numbers, beside one that is a word
    ("t,1000,1500\n0,1,2\n1,3,4\n", [0, 1]),
    (",0,1\n0,1.5,2.5\n1,2,3\n", [0, 1]),
    ("0,NaN\n1,2\n2,3\n", "'NaN' in column 2 is not a number"),
    ("0 s,1 N\n1,2\n2,3\n", "the cell in column 1 is not a number"),
    ("12:00,1\n13,2\n", "the cell in column 1 is not a number"),
    ("1st,force\n1,2\n", [1]),
    ("0,--\n1,2\n2,3\n", "'--' in column 2 is not a number"),
    ("1e400,2\n3,4\n5,6\n", "'1e400' in column 1 is not a number"),
    ("0 1 #a\n1 2\n", [0, 1]),
    ("0,1 # a\n1,2\n2,3\n", "the cell in column 2 is not a number"),
]


@pytest.mark.parametrize(("text", "expected"), FIRST)
def test_a_first_row_of_numbers_is_a_point(text: str, expected: object) -> None:
    found = outcome(text)
    assert (found[0] if isinstance(found, list) else found[1]) == expected  # type: ignore[index]


WIDE = [
    "x y\n1 0 5\n2 1 6\n",  # of R: the first column has the names of the rows, and no heading
    '"x","y"\n"1",0,5\n"2",1,6\n',
    "x,y\n0,1\n1,2,5\n2,3\n",  # 2,5 is 2.5
    "x;y\n0;1;7\n1;2;8\n",
    "x,y\n0,1\n# half way\n1,2,5\n",
]


@pytest.mark.parametrize("text", WIDE)
def test_more_numbers_than_headings_may_be_other_columns(text: str) -> None:
    with pytest.raises(CsvError) as caught:
        read_column_numbers(text, "x", "y")
    assert "the row has 3 cells, rows before it 2" in str(caught.value)
    assert caught.value.line == text[: text.index("5" if "5" in text else "7")].count("\n") + 1


@pytest.mark.parametrize("text", ["0,1\n1,2,5\n", "title of it,\n0,1\n1,2,5\n"])
def test_a_number_beyond_the_columns_by_number_is_refused_too(text: str) -> None:
    with pytest.raises(CsvError, match="3 cells, rows before it 2"):
        read_column_numbers(text, 1, 2)


def test_words_and_empty_cells_beyond_the_headings_and_rows_below_a_title_are_read() -> None:
    assert outcome("x,y\n0,1,\n1,2,end\n") == [[0, 1], [1, 2]]
    assert outcome("Measurement 5\n1 2 3\n2 3 4\n") == [[1, 2], [2, 3]]


@pytest.mark.parametrize("word", ["#N/A", "#NV", "#VALUE!", "#DIV/0!", "#NAME?"])
@pytest.mark.parametrize("mark", [",", ";", "\t"])
def test_an_error_of_a_spreadsheet_is_a_cell_not_a_comment(word: str, mark: str) -> None:
    rows = [["x", "y"], ["0", "1"], [word, "2"], ["2", "9"]]
    with pytest.raises(CsvError) as caught:
        read_column_numbers("\n".join(mark.join(row) for row in rows), "x", "y")
    assert caught.value.line == 3
    assert outcome(f"0{mark}1\n#A comment!\n#N/A of it\n2{mark}9\n") == [[0, 2], [1, 9]]


@pytest.mark.heavy
def test_seven_hundred_thousand_rows(tmp_path: Path) -> None:
    rows = "\n".join(map("%d,1".__mod__, range(700_000)))
    (tmp_path / "large.csv").write_text(f"x,y\n{rows}\n")
    (tmp_path / "spec.yaml").write_text(BODY + "tables: {f: {file: large.csv, x: x, y: y}}\n")
    code = (
        "import time\nfrom pathlib import Path\nfrom heuncli.app.cli.entry import enter\n"
        "assert enter(['validate', 'spec.yaml']) == 0\nstatus = Path('/proc/self/status').read_text().split()\n"
        "print(time.process_time(), status[status.index('VmHWM:') + 1])"
    )
    path = os.pathsep.join([str(Path(__file__).parents[2]), os.environ.get("PYTHONPATH", "")])
    run = subprocess.run([sys.executable, "-c", code], cwd=tmp_path, env={**os.environ, "PYTHONPATH": path},
                         capture_output=True, text=True, check=True)  # fmt: skip
    seconds, kilobytes = map(float, run.stdout.splitlines()[-1].split())
    assert kilobytes < 120_000  # 92 MB where it was measured; as lists of Python's numbers several times as much
    assert seconds < 10.0  # 0.6 s where it was measured


def test_more_rows_are_too_many(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(columns, "MOST_ROWS", 10)
    assert len(read_column_numbers("1,2\n" * 10, 1)[0]) == 10
    with pytest.raises(CsvError) as caught:
        read_column_numbers("1,2\n" * 11, 1)
    assert caught.value.finding.code == "too-large"


@pytest.mark.parametrize("interpolation", ["linear", "cubic", "pchip"])
def test_points_that_have_no_slope_are_told_without_a_warning(interpolation: str) -> None:
    text = f"tables: {{f: {{x: [0, 1e-60, 1], y: [0, 1e60, -1e60], interpolation: {interpolation}}}}}\n"
    try:
        load("spec.yaml", BODY + text)
    except SpecError as error:
        assert [problem.code for problem in error.problems] == ["table-shape"]


@pytest.mark.parametrize(("wanted", "words"), [
    (("a", "b"), "there are 2 columns 'a'"),
    (("b", "c"), "there is no column 'c'"),
    (("²", "b"), "there is no column '²'"),
    (("٣", "b"), "there is no column '٣'"),
    (("9" * 5000, "b"), "there is no column '999"),
    ((1.5, "b"), "there is no column 1.5"),
])  # fmt: skip
def test_columns_are_named_as_they_are(wanted: tuple[object, ...], words: str) -> None:
    with pytest.raises(MissingColumnError) as caught:
        read_column_numbers("a,b,a\n1,2,3\n4,5,6\n", *wanted)
    assert words in caught.value.finding.message


def test_a_column_that_is_there_twice_is_named_by_its_number() -> None:
    text = "a,b,a\n1,2,3\n4,5,6\n"
    assert [*map(list, read_column_numbers(text, "b", 3))] == [[2.0, 5.0], [3.0, 6.0]]
    with pytest.raises(MissingColumnError) as caught:
        read_column_numbers(text, "a", "b")
    assert caught.value.finding.hint == "give its number: 1 or 3"
    assert list(read_column_numbers("²,b\n1,2\n", "²")[0]) == [1.0]


@pytest.mark.parametrize("word", ["tables.f.x=²", "tables.f.x.²=1", f"tables.f.x.{'9' * 5000}=1", "expect.²=1"])
def test_strange_digits_on_the_command_line_are_words(word: str) -> None:
    key, _, value = word.partition("=")
    with pytest.raises(SpecError):
        load("spec.yaml", BODY + "tables: {f: {x: [0, 1], y: [0, 1]}}\nexpect: []\n", {key: value})


@pytest.mark.parametrize("unit", ["m^²", "m**²", "m ²²", "m^٣"])
def test_strange_digits_in_units_are_words(unit: str) -> None:
    with pytest.raises(SpecError) as caught:
        load("spec.yaml", BODY.replace("mass: 1", f"mass: 1 {unit}"))
    assert caught.value.problems[0].code in ("unknown-unit", "dimension")


SECRETS = [
    "root:x:0:0:root:/root:/bin/bash\ndaemon:x:1:1:daemon:/usr/sbin:/usr/sbin/nologin\n",
    "root:$6$salt$hash\n",
    "-----BEGIN KEY-----\nc2VjcmV0LXNlY3JldA==\nroot\n-----END KEY-----\n",
    "PASSWORD,root\nhunter2,root\n",
    "root\thunter2\n5\tx\n",
    '"root" hunter2\n"root\n',
    "root;hunter2\nroot;1\n1;2\n",
    "1root-2,3\n",
]


@pytest.mark.parametrize("secret", SECRETS)
@pytest.mark.parametrize("wanted", ["x: a, y: b", "x: 1, y: 2", "x: 2, y: 1", "x: 1, y: 1", "x: roots, y: rooz"])
def test_no_message_tells_what_stands_in_a_file_that_is_no_table(wanted: str, secret: str, tmp_path: Path) -> None:
    (tmp_path / "secret").write_text(secret)
    with pytest.raises(SpecError) as caught:
        load(tmp_path / "spec.yaml", BODY + f"tables: {{f: {{file: secret, {wanted}}}}}\n")
    told = str(caught.value).replace("'roots'", "").replace(str(tmp_path), "")
    assert not any(word in told for word in ("root", "hunter2", "PASSWORD", "KEY", "c2V"))


def test_a_wrong_cell_among_numbers_is_told() -> None:
    with pytest.raises(CsvError) as caught:
        read_column_numbers("a,b,c\n1,2,z\n3,four,z\n", "a", "b")
    assert (caught.value.line, caught.value.finding.message) == (3, "'four' in column 2 is not a number")
    with pytest.raises(MissingColumnError) as other:
        read_column_numbers("a,b\n1,2\n", "d")
    assert other.value.finding.hint == "columns: a, b; columns may also be given by number: 1, 2, ..."


def test_a_file_that_is_no_spec_is_not_told_either() -> None:
    with pytest.raises(SpecError) as caught:
        load("spec.yaml", "hunter2\n")
    assert "hunter2" not in str(caught.value)
