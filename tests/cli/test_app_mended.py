"""What commands once got wrong without a word: options they ignored, parts they left out, errors that hid others."""

from __future__ import annotations

import csv
import io
import os
import sqlite3
import sys
import time
from collections.abc import Iterator
from pathlib import Path

import pytest

import heuncli
from heuncli.analyses.sweep_store import Store
from heuncli.app.cli import jobs
from heuncli.app.commands.explain import pages
from heuncli.app.commands.run import cases
from heuncli.app.commands.run.command import read_state
from heuncli.app.commands.sweep import running
from heuncli.app.commands.sweep.request import SweepRequest
from heuncli.base import programs, signals
from heuncli.base.errors import Finding, SpecError, UsageError
from heuncli.base.text_safety import escape
from heuncli.base.units import parse_unit
from heuncli.output.documents.as_data import format_line
from heuncli.output.documents.document import OutputDocument, write_decimal_comma
from heuncli.output.snapshots.changes import Tolerance, _compare_sums
from heuncli.output.snapshots.golden_file import NumberSnapshot, SumSnapshot
from heuncli.output.tables.measure import PATH, parse_measure, require_known_paths
from heuncli.results.path_words import find_node
from heuncli.results.results_schema import Quantity
from heuncli.scene.file_format.load import load
from tests.shared.command import HANGING, Heun

SHOWN = ["--dask tcp://h:1", "--no-reduce", "--least-norm", "--seed 0"]


@pytest.mark.parametrize("words", SHOWN)
def test_show_refuses_what_it_would_ignore(heun: Heun, words: str) -> None:
    done = heun("sweep", "--show", "s.sqlite", *words.split())
    assert done.returncode == 2
    assert f"--show and {words.split()[0]} cannot be combined" in done.stderr


def test_show_takes_the_rest() -> None:
    running._require_alone(SweepRequest(show="s.sqlite", format="csv", shard="1/2"))


def test_a_path_of_many_colons_ends() -> None:
    assert PATH.match("a:" * 200 + "!") is None
    assert PATH.match("sections.a@0.1:before.M1") and not PATH.match("a b")


def test_stresses_of_an_impulse_need_properties() -> None:
    text = HANGING + (
        "sections: {s: {body: bar, at: [0, 0, -0.2], normal: [0, 0, -1], "
        "piece: {mass: 0.5, center: [0, 0, -0.6], inertia: [0.01, 0.01, 0.001]}}}\n"
        "impulses: {blow: {on: bar.top, vector: [1, 0, 0]}}\n"
    )
    spec = load("scene.yaml", text)
    with pytest.raises(SpecError, match="the section has no properties"):
        require_known_paths([parse_measure("impulses.0.sections.s.stress.mises")], spec)


def test_a_store_that_cannot_be_made_is_left_empty(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    from heuncli.analyses import sweep_store_file

    opened: list[sqlite3.Connection] = []
    connect = sqlite3.connect

    def record_connection(*words: object, **options: object) -> sqlite3.Connection:
        opened.append(connect(*words, **options))  # type: ignore[call-overload]
        return opened[-1]

    monkeypatch.setattr(sqlite3, "connect", record_connection)
    monkeypatch.setattr(sweep_store_file, "TABLES", (*sweep_store_file.TABLES, "CREATE NONSENSE"))
    with pytest.raises(heuncli.HeunError):
        Store(str(tmp_path / "s.sqlite"))
    with pytest.raises(sqlite3.ProgrammingError, match="closed"):
        opened[0].execute("SELECT 1")
    with connect(tmp_path / "s.sqlite") as again:
        assert again.execute("SELECT count(*) FROM sqlite_master").fetchone() == (0,)


def test_a_store_without_its_version_is_damaged(tmp_path: Path) -> None:
    name = str(tmp_path / "s.sqlite")
    with Store(name) as store:
        store.connection.execute("DELETE FROM heun")
    with pytest.raises(UsageError, match="damaged"):
        Store(name)


@pytest.mark.skipif(sys.platform == "win32", reason="no process groups")
def test_a_child_that_holds_the_output_ends_too(tmp_path: Path) -> None:
    _, reason = programs.run_program(["sh", "-c", "sleep 60 & echo $! > child"], str(tmp_path), 0.3)
    assert "longer than 0.3 s" in reason
    assert has_ended(tmp_path / "child")


@pytest.mark.skipif(sys.platform == "win32", reason="no process groups")
def test_a_child_ends_with_a_program_that_succeeds(tmp_path: Path) -> None:
    line = "sleep 60 > /dev/null 2>&1 & echo $! > child; echo done"
    assert programs.run_program(["sh", "-c", line], str(tmp_path), 10.0) == (b"done\n", "")
    assert has_ended(tmp_path / "child")


def has_ended(file: Path) -> bool:
    """Whether the process whose number stands in a file has ended, or does so within a second."""
    state = Path(f"/proc/{file.read_text().strip()}/stat")
    for _ in range(100):
        try:
            if state.read_text().split()[2] == "Z":
                return True
        except (FileNotFoundError, ProcessLookupError):
            return True
        time.sleep(0.01)
    return False


def test_one_cleanup_does_not_stop_the_others(monkeypatch: pytest.MonkeyPatch) -> None:
    done: list[object] = []
    monkeypatch.setattr(signals, "_cleanups", [lambda: done.append("first"), lambda: 1 / 0])
    monkeypatch.setattr(os, "_exit", done.append)
    monkeypatch.setattr(os, "write", lambda number, line: done.append(line))
    signals.exit_after_cleanup(130, b"told")
    assert done == ["first", b"told", 130]


def test_the_watch_sees_every_file_of_a_spec(tmp_path: Path) -> None:
    spec = tmp_path / "scene.yaml"
    spec.write_text(
        HANGING + "report: {logo: logo.png}\ncases: {a: {set: {tables.gas.file: b.csv}}}\n"
        "tables: {gas: {file: a.csv}}\nexpect: [{of: x, curve: c.csv}]\n"
        "other: [{shapes: [{type: mesh, file: m.stl}]}]\n"
    )
    names = ("logo.png", "a.csv", "b.csv", "c.csv", "m.stl")
    for name in names:
        (tmp_path / name).write_text("1")
    assert {Path(state[0]).name for state in read_state(str(spec)) if state} == {"scene.yaml", *names}


def test_a_cell_with_a_line_break_stays_one_cell() -> None:
    text = format_line(["of", "text"]) + format_line(["x", 'two\u2028 "lines"']) + '"a\nb",1\n'
    rows = list(csv.reader(io.StringIO("".join(cases._iter_csv({"one": text, "two": text})))))
    assert [row[0] for row in rows] == ["case", "one", "one", "two", "two"]
    assert rows[2][1:] == [escape("a\nb"), "1"]


def test_solve_cases_suggests_none_of_what_it_lacks() -> None:
    text = HANGING + "cases: {a: {set: {m: 2}}}\n"
    with pytest.raises(SpecError) as raised:
        heuncli.solve_cases(text=text, cas="a")
    assert "option case" not in str(raised.value)


def test_a_sum_is_compared_in_all_that_one_run_has() -> None:
    value = NumberSnapshot(unit="N", error=0.1, first=1.0, last=1.0)
    old = SumSnapshot(factors={"a": 1.0}, error=0.0, value=value)
    new = SumSnapshot(factors={"a": 1.0, "b": 1.0}, error=0.0, value=value.model_copy(update={"least": 0.0}))
    for pair in ((old, new), (new, old)):
        assert [change.what for change in _compare_sums("s", *pair, Tolerance(None, {}))] == ["factor of b", "least"]
    assert not [*_compare_sums("s", old, old, Tolerance(None, {}))]


@pytest.mark.parametrize("unit", ["mm^99*mm^99/m^99/m^98", "km^99*km^99*km^99"])
def test_a_unit_has_a_size(unit: str) -> None:
    with pytest.raises(Finding, match="out of number range"):
        parse_unit(unit)


def test_facts_have_decimal_commas() -> None:
    assert write_decimal_comma(OutputDocument(facts=[("mass", "1.5 kg")])).facts == [("mass", "1,5 kg")]


@pytest.mark.skipif(not jobs.can_fork(), reason="no fork")
def test_an_error_of_the_work_is_no_good_end() -> None:
    items: Iterator[int] = iter([1])

    def fail(item: int) -> int:
        os.dup2(os.open(os.devnull, os.O_WRONLY), 2)
        raise BrokenPipeError

    ((_, outcome),) = jobs.run_as_completed(fail, lambda: next(items, None), 1)
    assert isinstance(outcome, jobs.ProcessDeath) and outcome.code == 1


def test_only_the_unit_1_is_none(monkeypatch: pytest.MonkeyPatch) -> None:
    row = next(node for node in find_node(("joints", "JOINT")).values() if isinstance(node, Quantity))  # type: ignore[union-attr]
    told = dict(pages._describe_quantity("joints.j.x", ["joints", "j", "x"], row._replace(units=("1", "1/s"))))
    assert told["unit"].startswith("none or 1/s")
