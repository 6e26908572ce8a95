"""Charts made by hand: the front, ties, failures and bounds, in table, JSON and CSV."""

from __future__ import annotations

import csv
import io
import json

import pytest

from heuncli.analyses.work_precision.results import (
    KINDS,
    ChartResults,
    ChartRow,
    ChartRun,
    mark_front,
    round_as_shown,
)  # fmt: skip
from heuncli.app.commands import chart as report
from heuncli.base.records import replace
from heuncli.output.documents.as_data import dump_json, render_csv
from heuncli.output.documents.as_text import DEFAULT_WIDTH, format_plain, render_text
from heuncli.output.documents.document import OutputDocument
from tests.shared.fake_charts import FAILS, REFERENCE, TOO_LONG, chart, run


def front(*runs: ChartRun) -> list[bool]:
    return [each.front for each in mark_front(runs)]


def test_the_front_is_what_no_other_run_beats() -> None:
    assert front(run("A", 1.0, 1e-3), run("A", 2.0, 1e-6), run("B", 3.0, 1e-5), run("B", 4.0, 1e-8)) == [
        True, True, False, True,
    ]  # fmt: skip


def test_what_fails_is_never_on_the_front_and_beats_nothing() -> None:
    assert front(FAILS, run("A", 1.0, 1e-3), TOO_LONG) == [False, True, False]


def test_equal_times_are_decided_by_the_error_and_equal_errors_by_the_time() -> None:
    assert front(run("A", 1.0, 1e-3), run("B", 1.0, 1e-4)) == [False, True]
    assert front(run("A", 1.0, 1e-3), run("B", 0.5, 1e-3)) == [False, True]


def test_times_and_errors_that_read_the_same_are_ties_decided_by_evaluations() -> None:
    a, b = run("A", 1.01e-3, 1.04e-6, 120), run("B", 1.04e-3, 0.96e-6, 100)
    assert round_as_shown(a.seconds or 0.0) == round_as_shown(b.seconds or 0.0)
    assert front(a, replace(b, error={**b.error, "motion": 1.02e-6})) == [False, True]
    assert front(run("A", 1.0, 1e-6), run("B", 1.0, 1e-6)) == [True, False]  # equal in all: the first


def test_a_run_that_is_lost_is_never_on_the_front() -> None:
    assert front(run("A", 0.1, 2e122), run("B", 1.0, 1e-3)) == [False, True]
    assert front(run("A", 0.1, 1.0)) == [False]


def test_a_single_run_is_the_front() -> None:
    assert front(run("A", 1.0, 0.5)) == [True]


def test_what_the_reference_does_not_tell_apart_is_a_bound() -> None:
    error, bounded = REFERENCE.to_errors({"motion": 0.5e-13, "reactions": 1e-9, "sections": None})
    assert error == {"motion": 2e-13, "reactions": 1e-9, "sections": None} and bounded == {"motion"}
    error, bounded = REFERENCE.to_errors({"motion": 1.5e-13, "reactions": 2e-13, "sections": 1.0})
    assert error == {"motion": 2e-13, "reactions": 4e-13, "sections": None} and bounded == {"reactions"}


def table(made: ChartResults) -> str:
    return render_text(OutputDocument(parts=[report.make_table(made)]))


def test_the_table_marks_the_front_bounds_and_failures_within_a_page() -> None:
    known = replace(run("DOP853", 2e-3, 2e-13), upper_bounds=frozenset({"motion"}))
    text = table(chart(FAILS, TOO_LONG, run("DOP853", 1e-3, 1.5e-6), known))
    lines = text.splitlines()
    assert max(map(len, lines)) <= DEFAULT_WIDTH
    assert any("0.01 s" in line and "fails at t = 0.25 s [not-a-number]" in line for line in lines)
    assert "  [not-a-number] Euler: no finite acceleration exists after this instant" in lines
    assert any("1e-9 s" in line.replace("1e-09", "1e-9") and "not run: about 2e9 steps" in line for line in lines)
    assert any(line.split()[:3] == ["*", "1e-6", "1"] and "1.5e-06" in line and "3.0e-06" in line for line in lines)
    assert any("≤2.0e-13" in line for line in lines) and "≤: the run differs" in text
    assert "sections" not in text and "DOP853  order 8, explicit, adaptive" in text


def test_json_keeps_to_the_contract() -> None:
    found = json.loads(dump_json(report.to_block(chart(FAILS, run("DOP853", 1e-3, 1.5e-6)))))
    assert found["reference"] == REFERENCE.description
    failed, done = found["runs"]
    assert done["tolerance"] == 1e-6 and "step" not in done and done["seconds"] == 1e-3 and done["front"] is True
    assert done["error"] == {"motion": 1.5e-6, "reactions": 3e-6, "sections": None} and done["status"] == "completed"
    assert (done["method"], done["chart"], done["steps"], done["evaluations"]) == ("DOP853", "quaternion", 10, 100)
    assert failed["step"] == 0.01 and "tolerance" not in failed and failed["at"] == 0.25 and not failed["front"]
    assert failed["status"] == "failed" and failed["seconds"] is None and set(failed["error"].values()) == {None}
    assert failed["code"] == "not-a-number" and "no finite acceleration" in failed["reason"]


def test_csv_has_a_line_a_run() -> None:
    rows = list(
        csv.DictReader(io.StringIO(render_csv(report.make_document(chart(FAILS, run("DOP853", 1e-3, 1.5e-6))))))
    )
    assert [row["method"] for row in rows] == ["Euler", "DOP853"]
    assert rows[0]["step"] == "0.01" and rows[0]["error_motion"] == "" and rows[0]["at"] == "0.25"
    assert float(rows[1]["error_reactions"]) == 3e-6 and rows[1]["front"] == "true" and rows[1]["step"] == ""
    assert set(report.COLUMNS) == set(rows[0]) and {f"error_{kind}" for kind in KINDS} <= set(rows[0])


def test_the_table_tells_failures_alone() -> None:
    assert "fails at t = 0.25 s [" in table(chart(FAILS, TOO_LONG))


def test_rows_of_a_method_that_tell_the_same_are_one() -> None:
    rows = (ChartRow("BDF", "quaternion", False, local) for local in (1e-4, 1e-6, 1e-8))
    refused = [replace(TOO_LONG, row=row, code="method-scene", reason="no stops") for row in rows]
    text = format_plain(report.make_table(chart(run("A", 1e-3, 1e-6), *refused, FAILS)))
    assert "     1e-4 to 1e-8 " in text and text.count("not run: no stops") == 1 and "1e-6 " in text
    assert json.loads(dump_json(report.to_block(chart(*refused))))["runs"][2]["reason"] == "no stops"


@pytest.mark.parametrize(
    ("seconds", "told"), [(4.816e-4, "0.482"), (0.0123, "12.3"), (1.6349, "1630"), (0.99951, "1000"), (123.0, "123000")]
)
def test_times_have_three_digits_and_no_power_of_ten(seconds: float, told: str) -> None:
    assert report.format_milliseconds(seconds) == told
