"""Stores of sweeps: what is there is not solved again, what hangs on nothing else is; whose file it is; full disks."""

from __future__ import annotations

import multiprocessing
import os
import sqlite3
from collections.abc import Iterator
from contextlib import closing
from multiprocessing.synchronize import Barrier
from pathlib import Path

import pytest

import heuncli
from heuncli.analyses.sweep_store import Store
from heuncli.analyses.variants.evaluation import VariantEvaluator
from heuncli.analyses.variants.measures import MeasureValue, VariantResult
from heuncli.app.commands.sweep import running
from heuncli.app.commands.sweep.request import SweepRequest
from heuncli.base.errors import OutputError, UsageError
from heuncli.scene.file_format.quantity import NumberWithUnit
from tests.shared import triangles
from tests.shared.command import HANGING, Done, Heun
from tests.shared.shell import shell

PIVOT = ("--measure", "joints.pivot.force.z", "--format", "csv")
MASSES = ("sweep", "hanging.yaml", "m=1:3/5", *PIVOT)
ONE = {"m": NumberWithUnit(1.0)}
STORED = ("--store", "s.sqlite")


@pytest.fixture
def solved(monkeypatch: pytest.MonkeyPatch) -> Iterator[list[dict[str, NumberWithUnit]]]:
    """The variants that were solved since it was emptied, in this process."""
    found: list[dict[str, NumberWithUnit]] = []
    answer = VariantEvaluator.answer

    def counted(self: VariantEvaluator, values: dict[str, NumberWithUnit]) -> object:
        found.append(dict(values))
        return answer(self, values)

    monkeypatch.setattr(VariantEvaluator, "answer", counted)
    monkeypatch.delattr("os.fork")
    yield found


def test_a_second_call_solves_what_is_missing(heun: Heun, solved: list[dict[str, NumberWithUnit]]) -> None:
    first = heun(*MASSES, *STORED)
    assert len(solved) == 5
    assert heun(*MASSES, *STORED) == first
    assert len(solved) == 5
    more = heun("sweep", "hanging.yaml", "m=1:3/9", *PIVOT, *STORED)
    assert [values["m"].value for values in solved[5:]] == [1.25, 1.75, 2.25, 2.75]
    assert more == heun("sweep", "hanging.yaml", "m=1:3/9", *PIVOT)


SAME = {
    "a comment": HANGING.replace("bodies:", "# a bar\nbodies:"),
    "the title": HANGING.replace("A bar hangs", "The bar hangs"),
    "a number written otherwise": HANGING.replace("0.001]", "1e-3]").replace("[0, 0, -0.5]", "[0.0, 0, '-5e-1']"),
    "the value in the file of what is varied": HANGING.replace("m: 1.0", "m: 7"),
    "blocks in another order": HANGING.replace("gravity: [0, 0, -9.81]\n", "") + "gravity: [0, 0, -9.81]\n",
    "what is expected": HANGING + "expect: [{of: joints.pivot.force.x, is: 0, abs: 1}]\n",
}
OTHERS = {
    "a number": HANGING.replace("9.81", "9.80"),
    "a name": HANGING.replace("bar", "rod"),
    "a key more": HANGING + "analysis: {type: state}\nreport: [joints]\n",
    "the centre by an expression": HANGING.replace("[0, 0, -0.5]", "[0, 0, '-m/2']"),
}


@pytest.mark.parametrize("what", SAME)
def test_what_changes_no_answer_solves_nothing(
    heun: Heun, folder: Path, solved: list[dict[str, NumberWithUnit]], what: str
) -> None:
    first = heun(*MASSES, *STORED)
    text = SAME[what].replace("'-5e-1'", "-5e-1")
    assert text != HANGING
    (folder / "hanging.yaml").write_text(text)
    assert (heun(*MASSES, *STORED).stdout, len(solved)) == (first.stdout, 5)


@pytest.mark.parametrize("what", OTHERS)
def test_what_may_change_an_answer_solves_all(
    heun: Heun, folder: Path, solved: list[dict[str, NumberWithUnit]], what: str
) -> None:
    heun(*MASSES, *STORED)
    (folder / "hanging.yaml").write_text(OTHERS[what])
    done = heun(*MASSES, *STORED)
    assert (done.returncode, len(solved)) == (0, 10)
    assert done == heun(*MASSES)


@pytest.mark.parametrize(
    "words", [("--tolerance", "1e-6"), ("--set", "gravity=[0, 0, -1]"), ("--measure", "joints.pivot.force.x")]
)
def test_so_do_options_and_measures(
    heun: Heun, solved: list[dict[str, NumberWithUnit]], words: tuple[str, ...]
) -> None:
    heun(*MASSES, *STORED)
    heun(*MASSES, *STORED, *words)
    assert len(solved) == 10


def test_values_of_one_size_are_one_variant(heun: Heun, solved: list[dict[str, NumberWithUnit]]) -> None:
    for word in ("m=2kg,3kg", "m=2000g,3000g", "m=2.0kg,3e0 kg"):
        heun("sweep", "hanging.yaml", word, *PIVOT, *STORED)
    assert len(solved) == 2
    heun("sweep", "hanging.yaml", "m=2,3", *PIVOT, *STORED)  # of no dimension: it is checked otherwise
    assert len(solved) == 4


def test_the_content_of_tables_counts(heun: Heun, folder: Path, solved: list[dict[str, NumberWithUnit]]) -> None:
    text = (
        HANGING + "tables: {f: {file: f.csv}}\nforces: {f: {type: force, on: bar.top, vector: ['table(f, 0)', 0, 0]}}\n"
    )
    (folder / "hanging.yaml").write_text(text.replace("expect", "#"))
    (folder / "f.csv").write_text("-1,5\n1,5\n")
    one = heun(*MASSES, *STORED)
    heun(*MASSES, *STORED)
    assert len(solved) == 5
    (folder / "f.csv").write_text("-1,6\n1,6\n")
    assert heun(*MASSES, *STORED).returncode == one.returncode == 0
    assert len(solved) == 10


def test_the_content_of_meshes_counts(heun: Heun, folder: Path, solved: list[dict[str, NumberWithUnit]]) -> None:
    extra = "  solid: {shapes: [{type: mesh, file: solid.stl, density: 1}], points: {a: [0, 0, 0]}}\njoints:\n"
    text = HANGING.replace("expect", "#").replace("joints:\n", extra, 1)
    (folder / "hanging.yaml").write_text(text)
    for size, count in ((1.0, 5), (1.0, 5), (2.0, 10)):
        (folder / "solid.stl").write_bytes(triangles.binary_stl(size * triangles.box()))
        assert heun(*MASSES, *STORED).returncode == 0
        assert len(solved) == count


def test_what_cannot_be_solved_is_kept(heun: Heun, solved: list[dict[str, NumberWithUnit]]) -> None:
    words = ("sweep", "hanging.yaml", "m=-1,1,2", *PIVOT, *STORED)
    first = heun(*words)
    assert first.returncode == 0
    assert first.stderr == "heun: 1 of 3 variants could not be solved: 1 not-positive\n"
    assert heun(*words) == first
    assert len(solved) == 3
    assert heun(*words, "--strict").returncode == 1


def test_show_tells_it_again(heun: Heun) -> None:
    first = heun(*MASSES, *STORED)
    second = heun("sweep", "hanging.yaml", "m=4,5", *PIVOT, *STORED)
    shown = heun("sweep", "--show", "s.sqlite", "--format", "csv")
    assert shown.stdout == second.stdout
    lines = shown.stderr.splitlines()
    assert [line.partition("  ")[0] for line in lines] == ["heun: s.sqlite:1", "heun: s.sqlite:2"]
    assert lines[0].endswith("hanging.yaml: m; 5 of 5 variants; joints.pivot.force.z")
    assert heun("sweep", "--show", "s.sqlite:1", "--format", "csv") == first
    table = heun(*(word for word in MASSES if word not in ("--format", "csv")))
    assert heun("sweep", "--show", "s.sqlite:1") == table


def test_shards_add_up_to_the_whole(heun: Heun) -> None:
    """On one store, which then shows the whole; and in their rows."""
    whole = heun(*MASSES)
    parts = [heun(*MASSES, *STORED, "--shard", f"{k}/3") for k in (1, 2)]
    shown = heun("sweep", "--show", "s.sqlite", "--format", "csv")
    assert shown.stderr == "heun: 4 of 5 variants are done\n"
    parts.append(heun(*MASSES, *STORED, "--shard", "3/3"))
    assert heun("sweep", "--show", "s.sqlite", "--format", "csv") == whole
    heads = {part.stdout.splitlines()[0] for part in parts}
    lines = [line for part in parts for line in part.stdout.splitlines()[1:]]
    assert [*heads, *sorted(lines)] == whole.stdout.splitlines()
    assert heun(*MASSES, "--shard", "2/3") == parts[1]


def test_a_spec_that_is_gone_is_not_needed_to_show(heun: Heun, folder: Path) -> None:
    first = heun(*MASSES, *STORED)
    (folder / "hanging.yaml").unlink()
    assert heun("sweep", "--show", "s.sqlite", "--format", "csv") == first


def foreign(folder: Path, kind: str) -> str:
    """A file that is no store, of some kind; returns what is said of it."""
    path = folder / "s.sqlite"
    if kind == "text":
        path.write_text("heun: 1\n" * 1000)
        return "s.sqlite: not a store of sweeps [not-a-store]"
    with closing(sqlite3.connect(path)) as connection:
        if kind == "another program":
            connection.execute("CREATE TABLE notes (text)")
            said = "s.sqlite: not a store of sweeps: it is a database of another program [not-a-store]"
        elif kind in ("form 1", "form 99"):  # 1 held the values of parameters as texts
            connection.execute(f"PRAGMA application_id = {0x6865756E}")
            connection.execute(f"PRAGMA user_version = {kind.split()[1]}")
            connection.execute("CREATE TABLE heun (version)")
            message = f"store format {kind.split()[1]}, of another version of heun; this version uses format 2"
            said = f"s.sqlite: {message} [not-a-store]"
        connection.commit()
    return said


@pytest.mark.parametrize("kind", ["text", "another program", "form 1", "form 99"])
def test_a_file_that_is_no_store_is_refused_by_name(heun: Heun, folder: Path, kind: str) -> None:
    said = foreign(folder, kind)
    before = (folder / "s.sqlite").read_bytes()
    for words in ((*MASSES, *STORED), ("sweep", "--show", "s.sqlite")):
        done = heun(*words)
        assert (done.returncode, done.stdout) == (2, "")
        assert done.stderr.splitlines()[0] == f"heun: {said}"
    assert (folder / "s.sqlite").read_bytes() == before
    assert not list(folder.glob("s.sqlite-*"))


def test_a_store_of_another_version_is_shown_and_not_written(heun: Heun, folder: Path) -> None:
    first = heun(*MASSES, *STORED)
    with closing(sqlite3.connect(folder / "s.sqlite")) as connection:
        connection.execute("UPDATE heun SET version = '0.0.1'")
        connection.commit()
    done = heun(*MASSES, *STORED)
    assert done.returncode == 2
    assert done.stderr.startswith("heun: s.sqlite: written by heun 0.0.1, this is heun ")
    assert "hint: give another file; heun sweep --show s.sqlite prints its contents" in done.stderr
    assert heun("sweep", "--show", "s.sqlite", "--format", "csv") == first


@pytest.mark.parametrize(
    "words", ["--store hanging.yaml", "--store s.csv -o s.csv", "--store no/s.sqlite", "--store ."]
)
def test_a_store_stands_where_nothing_else_does(heun: Heun, folder: Path, words: str) -> None:
    before = (folder / "hanging.yaml").read_text()
    done = heun(*MASSES, *words.split())
    assert (done.returncode, done.stdout) in ((2, ""), (5, ""))
    assert "hint: " in done.stderr
    assert (folder / "hanging.yaml").read_text() == before


@pytest.mark.parametrize(
    "name", [":memory:", "file:x.sqlite?mode=memory", "file::memory:", "a%20b#c?d.sqlite", "-s.sqlite"]
)
def test_whatever_its_name_a_store_is_a_file(
    heun: Heun, folder: Path, solved: list[dict[str, NumberWithUnit]], name: str
) -> None:
    stored = f"--store={name}"
    first = heun(*MASSES, stored)
    assert first.returncode == 0
    assert (folder / name).is_file()
    assert heun(*MASSES, stored) == first
    assert len(solved) == 5


def full(folder: Path, more: str) -> Done:
    """A sweep where no file may have more than some hundred kilobytes."""
    line = f"trap '' XFSZ; ulimit -f 600; heun sweep hanging.yaml m=1:3/400 --measure joints.pivot.force.z {more}"
    done = shell(line, folder)
    return Done(done.returncode, done.stdout, done.stderr)


@pytest.mark.heavy
@pytest.mark.long
def test_a_full_disk_is_5_and_what_is_done_is_kept(heun: Heun, folder: Path) -> None:
    done = full(folder, "--store s.sqlite --format csv")
    assert (done.returncode, done.stdout) == (5, "")
    assert "heun: s.sqlite: " in done.stderr and " of 400 variants are done and kept [output-failed]" in done.stderr
    with closing(sqlite3.connect(folder / "s.sqlite")) as connection:
        assert connection.execute("PRAGMA integrity_check").fetchone() == ("ok",)
        (kept,) = connection.execute("SELECT count(*) FROM answers").fetchone()
    assert f"{kept} of 400 variants are done" in done.stderr
    assert 0 < kept < 400
    words = ("sweep", "hanging.yaml", "m=1:3/400", *PIVOT)
    assert heun(*words, *STORED) == heun(*words)


def test_without_a_store_the_folder_of_temporary_files_may_be_full() -> None:
    with Store(None) as store:
        store.connection.execute("PRAGMA max_page_count = 30")
        with pytest.raises(OutputError, match="the temporary folder: the disk is full") as error:
            for number in range(10_000):
                store.add_result(1, number, number.to_bytes(32, "big"), ONE, VariantResult((MeasureValue(1.0),)))
        assert error.value.exit_code == 5
        assert 0 < store.connection.execute("SELECT count(*) FROM answers").fetchone()[0] < 10_000


@pytest.mark.heavy
@pytest.mark.long
def test_a_store_that_many_begin_at_once_is_made_once(tmp_path: Path) -> None:
    """Some look at it while others make it."""
    context = multiprocessing.get_context("fork")
    for attempt in range(15):
        name, begins = str(tmp_path / f"{attempt}.sqlite"), context.Barrier(8)
        processes = [context.Process(target=begin, args=(name, begins)) for _ in range(8)]
        for process in processes:
            process.start()
        for process in processes:
            process.join()
        assert [process.exitcode for process in processes] == [0] * 8


def begin(name: str, begins: Barrier) -> None:
    """Open a store when all others do; the exit code is 1 where that fails."""
    begins.wait()
    with Store(name) as store:
        store.add_result(1, os.getpid(), os.urandom(32), ONE, VariantResult((MeasureValue(1.0),)))


@pytest.mark.parametrize("words", ["--dask tcp://h:1", "--no-reduce", "--least-norm", "--seed 0"])
def test_show_refuses_what_it_would_ignore(heun: Heun, words: str) -> None:
    done = heun("sweep", "--show", "s.sqlite", *words.split())
    assert done.returncode == 2
    assert f"--show and {words.split()[0]} cannot be combined" in done.stderr


def test_show_takes_the_rest() -> None:
    running._require_alone(SweepRequest(show="s.sqlite", format="csv", shard="1/2"))


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
