"""Several processes: the same bytes whatever their number; one that dies costs its one spec; picking, ending early."""

from __future__ import annotations

import contextlib
import os
import signal
import subprocess
import sys
import time
from collections.abc import Iterator, Mapping
from pathlib import Path

import pytest

from heuncli.analyses.variants.evaluation import VariantEvaluator
from heuncli.analyses.variants.measures import VariantResult
from heuncli.app.cli import jobs
from heuncli.app.commands.check import command
from heuncli.base.errors import LimitError
from tests.shared.command import HANGING, SPEC_TEXTS, Heun
from tests.shared.folders import SPECS
from tests.shared.processes import wait_until_solving
from tests.shared.sweeps import workers_of


@pytest.fixture
def many(folder: Path) -> Path:
    """A folder of twelve specs, some of which fail or are wrong."""
    below = folder / "many"
    below.mkdir()
    for number in range(12):
        kind = ("expecting", "failing", "wrong", "swinging")[number % 4]
        (below / f"{number:02}.yaml").write_text(f"title: scene {number}\n" + SPEC_TEXTS[kind].replace("title:", "#"))
    return below


@pytest.mark.heavy
@pytest.mark.parametrize(
    "form", ["table", "json", *(pytest.param(form, marks=pytest.mark.long) for form in ("markdown", "github"))]
)
def test_what_is_told_does_not_depend_on_the_number_of_processes(heun: Heun, many: Path, form: str) -> None:
    one, *others = (heun("check", "many", "--format", form, "--jobs", n) for n in ("1", "2", "5"))
    assert one.returncode == 2
    assert all(other == one for other in others)


@pytest.mark.heavy
def test_a_process_that_dies_costs_its_one_spec(heun: Heun, many: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    at_work = command.check_spec

    def dying(task, request, jobs):  # type: ignore[no-untyped-def]
        if task.spec.path.endswith("04.yaml"):
            os.kill(os.getpid(), signal.SIGKILL)
        return at_work(task, request, jobs)

    monkeypatch.setattr(command, "check_spec", dying)
    done = heun("check", "many", "--jobs", "3", "--format", "json")
    assert done.returncode == 70
    assert "many/04.yaml: the process that checked it failed twice: killed by signal 9 [bug]" in done.stderr
    assert done.stdout.count('"file"') == 12


def test_x_ends_at_the_first_that_fails(heun: Heun, many: Path) -> None:
    one, several = (heun("check", "many", "-x", "--jobs", n) for n in ("1", "3"))
    assert one == several
    assert one.stdout.splitlines()[-1] == "2 specs, 1 check passed, 1 failed"


@pytest.mark.heavy
def test_k_picks_by_path_and_title(heun: Heun, many: Path) -> None:
    assert heun("check", "many", "-k", "SCENE 11").stdout.startswith("1 spec, ")
    assert heun("check", "many", "-k", "many/0").stdout.splitlines()[-1].startswith("10 specs, ")
    assert heun("check", "many", "-k", "nothing").returncode == 2


@pytest.mark.heavy
def test_the_slowest_are_told_apart_from_the_results(heun: Heun, many: Path) -> None:
    done = heun("check", "many", "--durations", "3")
    assert "slowest 3 of 12:" in done.stderr
    assert "slowest" not in done.stdout


@pytest.mark.parametrize("words", [("--jobs", "0"), ("--jobs", "-2"), ("--durations", "0"), ("--jobs", "two")])
def test_numbers_that_mean_nothing(heun: Heun, words: tuple[str, str]) -> None:
    assert heun("check", "hanging.yaml", *words).returncode == 2


def test_as_many_processes_as_processors_where_there_is_enough_to_do() -> None:
    assert jobs.choose_job_count(None, jobs.MIN_ITEMS - 1) == 1
    assert jobs.choose_job_count(None, jobs.MIN_ITEMS) == min(jobs.count_processors(), jobs.MIN_ITEMS)
    assert jobs.choose_job_count(9, 3) == 3


def at_work_in(group: int) -> list[str]:
    """The processes of a group that still run; those that ended and that nobody asked for are none."""
    found = []
    for stat in Path("/proc").glob("[0-9]*/stat"):
        with contextlib.suppress(OSError):
            state, _, its_group = stat.read_text().rpartition(")")[2].split()[:3]
            found += [str(stat)] if int(its_group) == group and state != "Z" else []
    return found


@pytest.mark.heavy
@pytest.mark.skipif(not Path("/proc/self/stat").exists(), reason="the processes of a group are read from /proc")
def test_an_interrupt_ends_all_processes_and_leaves_no_file(tmp_path: Path) -> None:
    for number in range(4):
        text = HANGING.replace("top: [0, 0, 0]}", "top: [0, 0, 0]}, orientation: {axis: [1, 0, 0], angle: 60 deg}")
        (tmp_path / f"{number}.yaml").write_text(text + "analysis: {duration: 100000, samples: 11}\n")
    words = [sys.executable, "-m", "heuncli", "check", ".", "--jobs", "2", "--golden", "g", "--update", "--force"]
    process = subprocess.Popen(
        words, cwd=tmp_path, stdout=subprocess.PIPE, stderr=subprocess.PIPE, start_new_session=True
    )
    with process:
        wait_until_solving(process.pid, lambda pid: len(workers_of(pid)) == 2)
        os.killpg(process.pid, signal.SIGINT)
        process.communicate(timeout=10)
        assert process.returncode in (130, -signal.SIGINT)
        for _ in range(100):  # what is killed ends when the system gets to it
            if not at_work_in(process.pid):
                break
            time.sleep(0.05)
        assert at_work_in(process.pid) == []
    assert sorted(path.name for path in tmp_path.iterdir()) == [f"{number}.yaml" for number in range(4)]


@pytest.mark.parametrize("jobs_", [1, 3])
def test_what_a_process_was_at_that_dies_is_tried_once_more(tmp_path: Path, jobs_: int) -> None:
    """Number 3 ends one process, number 5 all of them, number 7 at its time limit."""

    def work(number: int) -> str:
        if number == 7:
            os._exit(LimitError.exit_code)
        if number == 5 or (number == 3 and not (tmp_path / "tried").exists()):
            (tmp_path / "tried").touch()
            os.kill(os.getpid(), signal.SIGKILL)
        (tmp_path / f"{number}").touch(exist_ok=False)
        return f"{number} answered"

    found = list(
        jobs.run_in_order(
            work, range(9), jobs_, lambda number, died: f"{number} {died.description}", separate_process=True
        )
    )
    assert found[5] == "5 killed by signal 9" and found[7] == f"7 exit code {LimitError.exit_code}"
    assert [text for number, text in enumerate(found) if number not in (5, 7)] == [
        f"{number} answered" for number in (0, 1, 2, 3, 4, 6, 8)
    ]


@pytest.mark.heavy
def test_a_process_of_a_search_that_dies_costs_no_variant(
    heun: Heun, folder: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    words = ("tune", "hanging.yaml", "m=1:2kg", "--minimise", "joints.pivot.force.z", "--evaluations", "8")
    undisturbed = heun(*words, "--jobs", "2")
    answer = VariantEvaluator.answer

    def dying(self: VariantEvaluator, values: Mapping[str, str]) -> VariantResult:
        if not (folder / "tried").exists():
            (folder / "tried").touch()
            os.kill(os.getpid(), signal.SIGKILL)
        return answer(self, values)

    monkeypatch.setattr(VariantEvaluator, "answer", dying)
    assert heun(*words, "--jobs", "2") == undisturbed
    assert undisturbed.returncode == 0 and (folder / "tried").exists()


@pytest.mark.heavy
def test_a_spec_that_is_not_solved_goes_from_process_to_process(heun: Heun, folder: Path) -> None:
    """With what it expects, which is not compared."""
    text = (SPECS / "broken" / "does-not-fit.yaml").read_text(encoding="utf-8")
    (folder / "unsolved.yaml").write_text(text + "expect: [{of: energy.kinetic, is: 0, at: 0}]\n", encoding="utf-8")
    one, other = (heun("check", "unsolved.yaml", "hanging.yaml", "--jobs", n) for n in ("1", "2"))
    assert one == other and one.returncode == 3


@pytest.mark.skipif(not jobs.can_fork(), reason="no fork")
def test_an_error_of_the_work_is_no_good_end() -> None:
    items: Iterator[int] = iter([1])

    def fail(item: int) -> int:
        os.dup2(os.open(os.devnull, os.O_WRONLY), 2)
        raise BrokenPipeError

    ((_, outcome),) = jobs.run_as_completed(fail, lambda: next(items, None), 1)
    assert isinstance(outcome, jobs.ProcessDeath) and outcome.code == 1
