"""How a sweep is told: CSV, JSON and Parquet of one sweep agree and read back; tables mark, sum up and leave out."""

from __future__ import annotations

import csv
import hashlib
import importlib
import importlib.util
import io
import json
import math
import tracemalloc
from collections.abc import Iterator, Sequence
from pathlib import Path
from typing import Any, get_args

import pyarrow.parquet as pq
import pytest

from heuncli.analyses.sweep_rows import SweepHead, SweptRow, explain_missing, find_missing_words
from heuncli.analyses.variants.measures import MeasureLabel, MeasureValue, MissingWord, VariantResult
from heuncli.analyses.variants.parameters import ParameterAxis, RandomVariable, parse_axis_values
from heuncli.analyses.variants.plans import Plan, make_axes_plan, make_draws
from heuncli.app.commands.sweep import as_columns, writer
from heuncli.app.commands.sweep.writer import SweepOutput, make_tables
from heuncli.output.documents.as_text import format_plain
from heuncli.study.quantities.table_units import Units, parse_units
from tests.shared.command import Heun

LEVER = """\
heun: 1
title: A lever, and a stay that has to reach it
parameters: {L: 0.5, m: 2 kg, angle: 0}
gravity: [0, 0, -9.81]
ground: {points: {O: [0, 0, 0], P: [0, 0, 1]}}
bodies:
  lever: {mass: m, center: [0.5, 0, 0], inertia: [0.1, 0.1, 0.1], points: {o: [0, 0, 0], e: [1, 0, 0]}}
  stay: {mass: 0.1, center: [0, 0, -L/2], inertia: [0.1, 0.1, 0.1], points: {o: [0, 0, 0], e: [0, 0, -L]}}
joints:
  hinge: {type: pin, axis: [0, 1, 0], from: ground.O, to: lever.o}
  top: {type: ball, from: ground.P, to: stay.o}
  bottom: {type: ball, from: stay.e, to: lever.e}
"""
MEASURES = ("joints.hinge.force.z", "abs joints.bottom.force.x")


def numbers(text: str | None) -> float | None:
    return float(text) if text else None


def swept(heun: Heun, folder: Path, *words: str) -> tuple[list[dict[str, str]], dict[str, Any], Any]:
    """The same sweep as CSV, JSON and Parquet."""
    (folder / "lever.yaml").write_text(LEVER)
    measures = [word for text in MEASURES for word in ("--measure", text)]
    for form in ("csv", "json", "parquet"):
        done = heun("sweep", "lever.yaml", *words, *measures, "-q", "-o", f"out.{form}")
        assert done.returncode == 0, done.stderr
        assert done.stdout == ""
    rows = list(csv.DictReader(io.StringIO((folder / "out.csv").read_text())))
    return rows, json.loads((folder / "out.json").read_text()), pq.read_table(folder / "out.parquet")


@pytest.mark.heavy
def test_csv_json_and_parquet_agree(heun: Heun, folder: Path) -> None:
    rows, found, table = swept(heun, folder, "L=2200,1200,1400mm", "m=1,1+1", "angle=0")
    assert len(rows) == len(found["rows"]) == table.num_rows == 6
    assert found["parameters"] == [
        {"parameter": "L", "unit": "mm"},
        {"parameter": "m", "unit": None},
        {"parameter": "angle", "unit": None},
    ]
    assert table.column_names == list(rows[0])
    assert list(rows[0])[:4] == ["number", "L [mm]", "m", "angle"] and list(rows[0])[-2:] == ["code", "reason"]
    for row, block, typed in zip(rows, found["rows"], table.to_pylist(), strict=True):
        assert int(row["number"]) == block["number"] == typed["number"]
        assert float(row["L [mm]"]) == block["set"]["L"] == typed["L [mm]"]
        assert row["m"] == block["set"]["m"] == typed["m"]  # 1+1 is no number: both are texts
        for measure, told_ in zip(found["measures"], block["values"], strict=True):
            head = f"{measure['measure']} [{measure['unit']}]"
            assert numbers(row[head]) == told_["value"] == typed[head]
            assert numbers(row[f"{head} error"]) == told_["error"] == typed[f"{head} error"]
            assert numbers(row[f"{head} at [s]"]) == told_["at"] == typed[f"{head} at [s]"]
        assert row["code"] == block["code"] == typed["code"] and row["reason"] == block["reason"] == typed["reason"]
    failed = [row["code"] for row in rows]
    assert failed[:2] == ["does-not-fit"] * 2 and failed[2:] == [""] * 4
    assert all(row["reason"] for row in rows[:2]) and not any(row["reason"] for row in rows[2:])
    assert all(math.isfinite(block["values"][0]["value"]) for block in found["rows"][2:])
    assert found["spec"] == {"path": "lever.yaml", "sha256": hashlib.sha256(LEVER.encode()).hexdigest()}
    meta = json.loads(table.schema.metadata[b"heun"])
    assert meta["sha256"] == found["spec"]["sha256"] and meta["version"] == found["version"]
    assert "statistics" not in found


@pytest.mark.heavy
def test_a_value_is_that_of_the_single_run(heun: Heun, folder: Path) -> None:
    rows, _, _ = swept(heun, folder, "L=1200,1400mm")
    for row in rows:
        run = heun("run", "lever.yaml", "--set", f"L={row['L [mm]']} mm", "--measure", MEASURES[0])
        assert float(run.stdout) == float(row[f"{MEASURES[0]} [N]"])


def random_sweep(heun: Heun, *words: str) -> dict[str, Any]:
    """A sweep of the bar that hangs, as JSON; what weighs less than nothing cannot be solved."""
    done = heun("sweep", "hanging.yaml", *words, "--measure", "joints.pivot.force.z", "--format", "json", "-q")
    assert done.returncode == 0, done.stderr
    found: dict[str, Any] = json.loads(done.stdout)
    return found


def test_random_sweeps_repeat_and_say_how_they_were_drawn(heun: Heun) -> None:
    words = ("m=normal(2000,100)g", "--samples", "12")
    found = random_sweep(heun, *words)
    assert found["samples"] == 12 and found["seed"] == 0
    assert found["parameters"] == [{"parameter": "m", "unit": "g", "law": "normal", "of": [2000.0, 100.0]}]
    assert found == random_sweep(heun, *words, "--seed", "0")
    other = random_sweep(heun, *words, "--seed", "1")
    assert found["rows"][0]["set"]["m"] != other["rows"][0]["set"]["m"]
    drawn = [row["set"]["m"] for row in found["rows"]]
    values = [row["values"][0]["value"] for row in found["rows"]]
    assert all(math.isclose(9.81e-3 * m, value, rel_tol=1e-12) for m, value in zip(drawn, values, strict=True))
    (own,) = found["statistics"]
    assert own["variants"] == 12 and own["left_out"] == 0 and own["unit"] == "N" and own["sure"] == 0.95
    assert math.isclose(own["mean"]["value"], sum(values) / 12, rel_tol=1e-14)
    assert [one["percent"] for one in own["percentiles"]] == [1.0, 5.0, 50.0, 95.0, 99.0] and "indices" not in own


def test_what_could_not_be_solved_is_left_out_of_statistics_and_counted(heun: Heun) -> None:
    found = random_sweep(heun, "m=uniform(-1,2)kg", "gravity=[0, 0, -1],[0, 0, -2]", "--samples", "30")
    lost = sum(1 for row in found["rows"] if row["code"]) // 2
    first, second = found["statistics"]
    assert 0 < lost < 29 and first["variants"] == second["variants"] == 30
    assert first["left_out"] == second["left_out"] == lost
    assert (first["set"], second["set"]) == ({"gravity": "[0, 0, -1]"}, {"gravity": "[0, 0, -2]"})
    assert math.isclose(second["mean"]["value"], 2.0 * first["mean"]["value"], rel_tol=1e-12)
    known = [row["set"]["m"] for row in found["rows"][:30] if not row["code"]]
    assert math.isclose(first["mean"]["value"], sum(known) / len(known), rel_tol=1e-12)
    words = ("sweep", "hanging.yaml", "m=uniform(-1,2)kg", "--samples", "30", "--measure", "joints.pivot.force.z")
    text = heun(*words).stdout
    assert f"30 variants, {lost} left out" in text and "left out: could not be solved" in text


@pytest.mark.heavy
def test_indices_leave_out_whole_samples(heun: Heun) -> None:
    words = ("m=uniform(-0.2,2)kg", "bodies.bar.center=[0, 0, -1]", "--samples", "40", "--indices")
    found = random_sweep(heun, *words)
    broken = {row["number"] // 3 for row in found["rows"] if row["code"]}
    (own,) = found["statistics"]
    assert len(found["rows"]) == 120 and 0 < len(broken) < 40 and own["samples"] == 40 - len(broken)
    (index,) = own["indices"]
    assert index["parameter"] == "m" and abs(index["first"]["value"] - 1.0) < 1.0 and index["first"]["low"] is None
    text = heun("sweep", "hanging.yaml", *words, "--measure", "joints.pivot.force.z").stdout
    assert "SOBOL INDICES" in text and f"{40 - len(broken)} samples" in text
    assert f"no intervals for {40 - len(broken)} samples: 64 or more needed (--samples 64)" in text


def test_of_what_does_not_vary_there_are_no_indices(heun: Heun) -> None:
    words = ("m=uniform(1,2)kg", "--samples", "16", "--indices", "--measure", "joints.pivot.force.x")
    done = heun("sweep", "hanging.yaml", *words)
    assert done.returncode == 0 and "no Sobol indices: it varies by no more than the errors of its runs" in done.stdout


# Tables, from rows made by hand.


def head_of(plan: Plan, *units: str) -> SweepHead:
    measures = tuple(MeasureLabel(f"m{k}", unit) for k, unit in enumerate(units))
    return SweepHead("A title", "spec.yaml", "0" * 64, "1", plan, measures)


def rows_of(plan: Plan, *values: list[float | None], error: float = 1e-6) -> list[SweptRow]:
    """Rows with these values of each measure."""
    return [
        SweptRow(
            k,
            plan.find_values(k),
            VariantResult(tuple(MeasureValue(v, None if v is None else error, 0.1 * k) for v in found)),
        )
        for k, found in enumerate(zip(*values, strict=True))
    ]


def text_of(head: SweepHead, rows: list[SweptRow], units: Units | None = None, every: bool = False) -> str:
    return "\n".join(format_plain(table) for table in make_tables(head, rows, units or Units(), every))


def axis(word: str) -> ParameterAxis:
    found = parse_axis_values(word)
    assert isinstance(found, ParameterAxis)
    return found


def test_the_table_marks_least_and_greatest_and_draws_the_course() -> None:
    plan = make_axes_plan([axis("n=1:8/8rpm")])
    text = text_of(head_of(plan, "N"), rows_of(plan, [1.0, 2.0, 3.0, 4.0, 5.0, 6.0, 7.0, 8.0]))
    lines = text.splitlines()
    assert lines[0] == "SWEEP  A title: 8 variants"
    assert lines[1].split() == ["n", "[rpm]", "m0", "[N]", "at", "[s]"]
    assert lines[2].split() == ["1", "1.0", "0", "min"] and lines[9].split() == ["8", "8.0", "0.7", "max"]
    assert sum("min" in line for line in lines[2:10]) == sum("max" in line for line in lines[2:10]) == 1
    assert "▁▂▃▄▅▆▇█" in text and "n = 1 rpm" in text and "over n" in text


def test_what_cannot_be_told_apart_is_marked_alike() -> None:
    plan = make_axes_plan([axis("n=1,2,3,4")])
    lines = text_of(head_of(plan, "N"), rows_of(plan, [1.0, 1.0 + 1e-9, 2.0, 1.5])).splitlines()
    assert [line.split()[3:] for line in lines[2:6]] == [["min"], ["min"], ["max"], []]
    assert "1.0  n = 1 or 1 more  2.0  n = 3" in "\n".join(lines)
    flat = text_of(head_of(plan, "N"), rows_of(plan, [1.0, 1.0 + 1e-9, 1.0, 1.0]))
    assert "m0: the same in all variants within their errors" in flat and "▁▁▁▁" in flat
    assert not any(word in line for line in flat.splitlines()[2:6] for word in ("min", "max"))


def test_no_more_digits_than_the_error_supports_and_in_the_units_asked_for() -> None:
    plan = make_axes_plan([axis("n=1,2")])
    rows = rows_of(plan, [1234.56789, 0.004], error=0.02)
    assert "1234.6" in text_of(head_of(plan, "N"), rows) and "1234.57" not in text_of(head_of(plan, "N"), rows)
    lines = text_of(head_of(plan, "N"), rows, parse_units("kN")).splitlines()
    assert "m0 [kN]" in lines[1] and lines[2].split()[1] == "1.2346"
    assert lines[3].split()[1] == "0"  # below its error, beside a larger one
    alone = text_of(head_of(plan, "N"), rows_of(plan, [0.004, -0.003], error=0.02)).splitlines()
    assert alone[2].split()[1] == alone[3].split()[1] == "?"


@pytest.mark.heavy
def test_a_long_sweep_shows_its_ends_and_its_extremes() -> None:
    plan = make_axes_plan([axis("n=1:1000/1000"), axis("k=1")])
    values: list[float | None] = [float(k) for k in range(1000)]
    values[500], values[700], values[600] = -1.0, 2000.0, None
    head, rows = head_of(plan, "N"), rows_of(plan, values)
    text = text_of(head, rows)
    shown = [line.split()[0] for line in text.partition("MEASURES")[0].splitlines()[2:] if line]
    assert shown == [*map(str, range(10)), "...", "500", "...", "700", "...", *map(str, range(990, 1000))]
    assert "... 490 more: --all" in text and "min" in text and "-1.0" in text
    every = text_of(head, rows, every=True)
    assert "more: --all" not in every.partition("MEASURES")[0] and every.count("\n") > 1000


def test_several_axes_have_a_line_of_letters_each() -> None:
    plan = make_axes_plan([axis("L=1,2mm"), axis("n=1:4/4")])
    text = text_of(head_of(plan, "N"), rows_of(plan, [1.0, 2.0, 3.0, 4.0, 5.0, 6.0, None, 8.0]))
    assert "▁▂▃▄  L = 1 mm" in text and "▅▆·█  L = 2 mm" in text
    many = make_axes_plan([axis("L=1:50/50"), axis("n=1:2/2")])
    text = text_of(head_of(many, "N"), rows_of(many, [float(k) for k in range(100)]))
    assert "m0: 38 more lines: --all" in text


def test_words_stand_for_what_is_not_known() -> None:
    plan = make_axes_plan([axis("n=1,2,3,4")])
    answers = [VariantResult((MeasureValue(None, word=word),)) for word in ("open", "beyond", "unknown")]
    failed = VariantResult(code="does-not-fit", reason="joint C cannot be closed")
    rows = [SweptRow(k, plan.find_values(k), answer) for k, answer in enumerate([*answers, failed])]
    lines = text_of(head_of(plan, "N"), rows).splitlines()
    assert [line.split()[1] for line in lines[2:5]] == ["open", "?", "?"]
    assert lines[5].split() == ["4", "does-not-fit:", "joint", "C", "cannot", "be", "closed"]
    assert any(line.startswith(("  open: ", "open: ")) for line in lines)
    text = "".join(writer.iter_pieces(head_of(plan, "N"), rows, SweepOutput("csv")))
    reasons = [row["reason"] for row in csv.DictReader(io.StringIO(text))]
    assert reasons[0].startswith("m0 [N]: open") and "horizon" in reasons[1] and "singular" in reasons[2]


def test_the_word_of_a_missing_measure_is_read_again_from_the_reason() -> None:
    """Of any measure of several, and whatever the sentences say."""
    words = [*get_args(MissingWord)]
    measures = [f"m{k} [N]" for k in range(len(words))]
    values = tuple(MeasureValue(None if word else 1.0, word=word) for word in words)
    reason = explain_missing(SweptRow(0, {}, VariantResult(values)), measures)
    assert find_missing_words(reason, measures) == {m: word for m, word in zip(measures, words, strict=True) if word}
    assert find_missing_words("joint C cannot be closed", measures) == {}


def test_a_parameter_that_is_called_as_a_column_is_told_apart() -> None:
    plan = make_axes_plan([axis("number=1,2kg")])
    text = "".join(writer.iter_pieces(head_of(plan, "N"), rows_of(plan, [1.0, 2.0]), SweepOutput("csv")))
    assert text.splitlines()[0].startswith("number,number (parameter) [kg],m0 [N],")


# Files.


class ManyNumbers(Sequence[float]):
    """Many values of an axis, made as they are asked for."""

    def __len__(self) -> int:
        return 40_000

    def __getitem__(self, place: Any) -> Any:
        if place >= len(self):
            raise IndexError
        return float(place)


@pytest.mark.heavy
@pytest.mark.parametrize(
    ("form", "fewer", "more"),
    [
        pytest.param("csv", 24_000, 40_000, marks=pytest.mark.long),
        ("json", 8_000, 13_000),
        ("parquet", 4_000, 9_000),
    ],
)
def test_memory_does_not_grow_with_the_rows(
    form: str, fewer: int, more: int, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Counts from where the buffers of a form are full; of JSON and Parquet 8 bytes of each row more would be seen."""
    plan = make_axes_plan([ParameterAxis("n", ManyNumbers(), "rpm")])

    def rows(count: int) -> Iterator[SweptRow]:
        answer = VariantResult((MeasureValue(1.5, 1e-9, 0.25),))
        return (SweptRow(k, plan.find_values(k), answer) for k in range(count))

    monkeypatch.setattr(as_columns, "ROWS_AT_ONCE", 1000)
    how = SweepOutput(form, str(tmp_path / f"out.{form}"))
    writer.write_sweep(head_of(plan, "N"), rows(1), how)  # what is loaded for it
    peaks = []
    for count in (fewer, more):
        tracemalloc.start()
        writer.write_sweep(head_of(plan, "N"), rows(count), how)
        peaks.append(tracemalloc.get_traced_memory()[1])
        tracemalloc.stop()
    assert peaks[1] < 1.01 * peaks[0] + 20_000, peaks


@pytest.mark.heavy
def test_statistics_take_floats_alone(tmp_path: Path) -> None:
    """Of each measure a value and an error, and the number of the variant: 24 bytes."""
    importlib.import_module("scipy.special")  # whose code is no part of it
    count = 10_000
    plan = make_axes_plan([], draws=make_draws([RandomVariable("d", "uniform", 0.0, 1.0, "")], count))
    answer = VariantResult((MeasureValue(1.5, 1e-9, 0.25),))
    rows = (SweptRow(k, plan.find_values(k), answer) for k in range(count))
    tracemalloc.start()
    writer.write_sweep(head_of(plan, "N"), rows, SweepOutput("json", str(tmp_path / "out.json")))
    peak = tracemalloc.get_traced_memory()[1]
    tracemalloc.stop()
    assert peak < count * 150, peak


def test_parquet_goes_to_a_file_and_needs_its_extra(heun: Heun, folder: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    (folder / "lever.yaml").write_text(LEVER)
    words = ("sweep", "lever.yaml", "L=1,1.1", "--measure", MEASURES[0])
    for more in (("--format", "parquet"), ("--format", "parquet", "-o", "-")):
        done = heun(*words, *more)
        assert done.returncode == 2 and "parquet requires a file" in done.stderr and not done.stdout
    (folder / "out.parquet").write_text("old")
    monkeypatch.setattr(as_columns.importlib.util, "find_spec", lambda name: None)
    done = heun(*words, "-o", "out.parquet")
    assert done.returncode == 2 and "[missing-extra]" in done.stderr
    assert 'pip install "heuncli[parquet]"' in done.stderr and (folder / "out.parquet").read_text() == "old"


def test_parquet_is_written_whole_or_not_at_all(tmp_path: Path) -> None:
    plan = make_axes_plan([axis("n=1,2,3")])

    def rows() -> Iterator[SweptRow]:
        yield from rows_of(plan, [1.0, 2.0, 3.0])[:2]
        raise KeyboardInterrupt

    (tmp_path / "out.parquet").write_text("old")
    with pytest.raises(KeyboardInterrupt):
        writer.write_sweep(head_of(plan, "N"), rows(), SweepOutput("parquet", str(tmp_path / "out.parquet")))
    assert [path.name for path in tmp_path.iterdir()] == ["out.parquet"]
    assert (tmp_path / "out.parquet").read_text() == "old"


def test_parquet_has_row_groups(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(as_columns, "ROWS_AT_ONCE", 2)
    plan = make_axes_plan([axis("n=1:5/5")])
    path = tmp_path / "out.parquet"
    writer.write_sweep(head_of(plan, "N"), rows_of(plan, [1.0, 2.0, None, 4.0, 5.0]), SweepOutput("parquet", str(path)))
    assert pq.ParquetFile(path).num_row_groups == 3
    assert pq.read_table(path).column("m0 [N]").to_pylist() == [1.0, 2.0, None, 4.0, 5.0]
    empty = tmp_path / "none.parquet"
    writer.write_sweep(head_of(plan, "N"), [], SweepOutput("parquet", str(empty)))
    assert pq.read_table(empty).num_rows == 0 and importlib.util.find_spec("pyarrow") is not None


def test_units_are_of_tables(heun: Heun, folder: Path) -> None:
    (folder / "lever.yaml").write_text(LEVER)
    words = ("sweep", "lever.yaml", "L=1.2,1.3", "--measure", MEASURES[0], "--units", "kN")
    assert f"{MEASURES[0]} [kN]" in heun(*words).stdout
    done = heun(*words, "--format", "csv")
    assert f"{MEASURES[0]} [N]" in done.stdout and "csv stays in SI" in done.stderr


@pytest.mark.parametrize(
    ("words", "told_"),
    [
        (("L=uniform(1,2)",), "L: the number of samples is missing"),
        (("L=1,2", "--samples", "5"), "--samples: no parameter is random"),
        (("L=1,2", "--seed", "5"), "--seed: no parameter is random"),
        (("L=1,2", "--indices"), "--indices: no parameter is random"),
        (("L=lhs(1,2)", "m=sobol(1,2)kg", "--samples", "4"), "lhs and sobol in one sweep"),
        (("L=lhs(1,2)", "--samples", "4", "--seed", "-1"), "expected 0 or more"),
    ],
)
def test_what_cannot_be_drawn_is_a_usage_error(heun: Heun, folder: Path, words: tuple[str, ...], told_: str) -> None:
    (folder / "lever.yaml").write_text(LEVER)
    done = heun("sweep", "lever.yaml", *words, "--measure", MEASURES[0])
    assert done.returncode == 2 and told_ in done.stderr and "hint: " in done.stderr and not done.stdout


def test_a_sobol_sequence_that_is_cut_off_is_warned_of(heun: Heun, folder: Path) -> None:
    (folder / "lever.yaml").write_text(LEVER)
    words = ("sweep", "lever.yaml", "L=sobol(1.2,1.3)", "--samples", "6", "--measure", MEASURES[0])
    done = heun(*words)
    assert done.returncode == 0 and "balanced at powers of two, such as 4 and 8" in done.stderr
    assert heun(*words, "-q").stderr == ""


@pytest.mark.heavy
def test_a_jump_over_the_last_parameter_is_told_between_its_variants(heun: Heun, folder: Path) -> None:
    """The mass takes F to one side of 2.5 N, and 4 F beyond; at half the mass it jumps there, too."""
    text = """
heun: 1
parameters: {F: 1 N, m: 1 kg}
ground: {points: {O: [0, 0, 0]}}
bodies: {b: {mass: m, center: [0, 0, 0], inertia: [1, 1, 1], points: {p: [0, 0, 0]}}}
joints: {g: {type: slide, from: ground.O, to: b.p, axis: [1, 0, 0]}}
forces: {f: {type: force, on: b.p, vector: ["F if F < 2.5 else 4*F", 0, 0]}}
"""
    (folder / "s.yaml").write_text(text, encoding="utf-8")
    asked = ["sweep", "s.yaml", "m=1:0.5/2", "F=4:1/31N", "--measure", "bodies.b.center_acceleration.x", "-q"]
    jumps = json.loads(heun(*asked, "--format", "json").stdout)["jumps"]
    ends = [(one["before"]["set"], one["before"]["value"], one["after"]["value"]) for one in jumps]
    assert [where["m"] for where, _, _ in ends] == [1.0, 0.5]
    for where, before, after in ends:
        assert where["F"] == pytest.approx(2.5)
        assert (before, after) == (pytest.approx(10.0 / where["m"]), pytest.approx(2.4 / where["m"]))
    assert "jumps between F = 2.5 and 2.4 N, m = 0.5" in heun(*asked).stdout
    smooth = ["sweep", "s.yaml", "F=1:2.4/15N", "--measure", "bodies.b.center_acceleration.x", "-q"]
    assert "jumps" not in heun(*smooth, "--format", "json").stdout + heun(*smooth).stdout
