"""JSON and CSV: every number, all its digits, null where open, and fast."""

from __future__ import annotations

import csv
import io
import json
import time
from typing import Any

import numpy as np
import pytest

from heuncli.base.errors import LimitError
from heuncli.output.tables import export
from heuncli.output.tables.export import to_csv, to_json
from heuncli.study.quantities.channels import iter_channels
from tests.shared.fakes import BLOW, LABELS, pendulum

T = np.linspace(0.0, 2.0, 7)


def assert_same(parsed: Any, block: Any) -> None:
    if isinstance(block, dict):
        assert list(parsed) == list(block)
        for key, value in block.items():
            assert_same(parsed[key], value)
    elif isinstance(block, np.ndarray):
        assert np.array_equal(np.array(parsed, dtype=np.float64), block, equal_nan=True)
    elif isinstance(block, (list, tuple)):
        assert len(parsed) == len(block)
        for one, other in zip(parsed, block, strict=True):
            assert_same(one, other)
    else:
        assert parsed == block


def test_json_is_the_results_to_the_last_bit() -> None:
    results = pendulum(T, impulses=[BLOW])
    parsed = json.loads(to_json(results))
    assert parsed.pop("heun") == 1
    assert_same(parsed, export.collect_blocks(results))


def test_json_has_null_where_open_and_only_what_applies() -> None:
    results = pendulum(T, sections={}, certain_sums=[])
    results.joints["pivot"]["force"][2, 1] = np.nan
    text = to_json(results)
    parsed = json.loads(text)
    assert parsed["joints"]["pivot"]["force"][2][1] is None
    assert "sections" not in parsed
    assert "certain_sums" not in parsed
    assert "NaN" not in text
    assert "-0.0" not in text.replace(" -0.0", "?-0.0?") or "?-0.0?" not in text


def test_json_takes_a_line_for_an_array() -> None:
    assert '  "kinetic": [' in to_json(pendulum(T))
    assert len(to_json(pendulum(np.linspace(0.0, 2.0, 500))).splitlines()) == len(to_json(pendulum(T)).splitlines())


def rows(text: str) -> list[dict[str, str]]:
    return list(csv.DictReader(io.StringIO(text)))


def test_csv_holds_every_number_once() -> None:
    results = pendulum(T)
    lines = rows(to_csv(results, LABELS))
    assert len(lines) == sum(series.values.size for series in iter_channels(results, LABELS))
    found = [
        float(r["value"])
        for r in lines
        if (r["kind"], r["name"], r["quantity"], r["component"]) == ("joints", "pivot", "force", "z")
    ]
    assert found == results.joints["pivot"]["force"][:, 2].tolist()
    keys = [(r["time"], r["kind"], r["name"], r["quantity"], r["component"]) for r in lines]
    assert len(set(keys)) == len(keys)


def test_csv_units_follow_the_kind_of_the_thing() -> None:
    units = {(r["name"], r["quantity"]): r["unit"] for r in rows(to_csv(pendulum(T), LABELS))}
    assert units["elbow", "acceleration"] == "rad/s²"
    assert units["push", "value"] == "N"
    assert units["motor", "value"] == "N·m"
    assert units["pivot", "moment"] == "N·m"
    assert units["upper", "center"] == "m"


def test_csv_names_the_cuts_of_a_run_by_their_number_and_tells_where_they_are() -> None:
    lines = [r for r in rows(to_csv(pendulum(T), LABELS)) if r["name"] == "along"]
    places = {r["component"]: float(r["value"]) for r in lines if r["quantity"] == "s"}
    assert list(places) == ["0", "1", "2", "3", "4"]
    assert places["4"] == 0.8
    assert {r["time"] for r in lines if r["quantity"] == "s"} == {""}
    assert {r["component"]: r["value"] for r in lines if r["quantity"] == "side"}["2"] == "-1.0"
    assert {r["component"] for r in lines if r["quantity"] == "M2"} == set(places)
    assert {r["component"] for r in lines if r["quantity"] == "normal"} == {"x", "y", "z"}
    forces = {r["component"]: r["value"] for r in lines if r["quantity"] == "force"}
    assert forces["3.x"] == "3.0"
    assert len(forces) == 15


def test_csv_has_section_cut_distance_and_side_in_columns() -> None:
    lines = rows(to_csv(pendulum(T, impulses=[BLOW]), LABELS))
    assert list(lines[0])[7:] == ["section", "cut", "s", "side"]
    along = {r["cut"]: r for r in lines if r["name"] == "along" and r["quantity"] == "force"}
    assert [along[cut]["side"] for cut in "01234"] == ["", "", "before", "beyond", ""]
    assert [float(along[cut]["s"]) for cut in "01234"] == pendulum(T).sections["along"]["s"].tolist()
    assert all(r["cut"] == r["component"].split(".")[0] for r in lines if r["cut"])
    assert {(r["section"], r["cut"]) for r in lines if r["quantity"] == "normal"} == {("along", "")}
    assert {r["section"] for r in lines if r["name"] == "middle"} == {"middle"}
    assert {r["section"] for r in lines if r["name"] == "pivot"} == {""}
    without = rows(to_csv(pendulum(T, sections={}), LABELS))
    assert "section" not in without[0]


def test_csv_leaves_what_is_open_empty() -> None:
    results = pendulum(T)
    results.joints["pivot"]["force"][2, 1] = np.nan
    empty = [r for r in rows(to_csv(results, LABELS)) if r["value"] == "" and r["quantity"] != "side"]
    assert [(r["name"], r["component"], r["time"]) for r in empty] == [("pivot", "y", repr(float(T[2])))]


def test_csv_has_impulses_in_newton_seconds_and_sums() -> None:
    sums = [{"terms": {"joints.a.force.x": 1, "joints.b.force.x": 1}, "value": 2.0 * T}]
    lines = rows(to_csv(pendulum(T, impulses=[BLOW], certain_sums=sums), LABELS))
    blow = {(r["name"], r["quantity"], r["component"]): r for r in lines if r["kind"] == "impulses"}
    assert blow["0.foundation", "force", "z"]["unit"] == "N·s"
    assert blow["0.foundation", "force", "z"]["value"] == "2.0"
    assert blow["0.foundation", "force", "z"]["time"] == "0.5"
    assert blow["0.foundation", "moment", "x"]["unit"] == "N·m·s"
    assert blow["0", "energy_jump", ""]["unit"] == "J"
    assert [float(r["value"]) for r in lines if r["kind"] == "certain_sums"] == (2.0 * T).tolist()


def test_what_no_disk_would_hold_is_refused(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(export, "MOST_NUMBERS", 100)
    with pytest.raises(LimitError, match="output-size"):
        to_json(pendulum(T))


@pytest.mark.heavy
@pytest.mark.parametrize("write", [to_json, lambda results: to_csv(results, LABELS)], ids=["json", "csv"])
@pytest.mark.third
def test_cost_grows_no_faster_than_the_numbers(write: Any) -> None:
    def seconds(n: int) -> float:
        results = pendulum(np.linspace(0.0, 2.0, n))
        start = time.perf_counter()
        write(results)
        return time.perf_counter() - start

    seconds(200)
    assert min(seconds(4000) for _ in range(3)) < 60.0 * min(seconds(200) for _ in range(3))
