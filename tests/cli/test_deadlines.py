"""One time limit over all that a command does, not over its loops alone; and nothing of it is left behind."""

from __future__ import annotations

import contextlib
import importlib.util
import os
import signal
import subprocess
import sys
import threading
import time
from collections.abc import Callable, Iterator
from pathlib import Path
from types import FunctionType
from typing import Any

import numpy as np
import pytest
import yaml

import heuncli
from heuncli.app.cli import timeout
from heuncli.base import files
from heuncli.base.errors import LimitError
from heuncli.motion.integration import evaluator
from heuncli.scene.file_format.load import load
from heuncli.study.workflow import solve
from tests.shared.command import HANGING, Heun
from tests.shared.folders import ROOT, SPECS

ENOUGH = 30.0  # seconds in which a command is given up, on a machine that does much else
REST = HANGING + "analysis: {type: rest}\n"
DRIVEN = (
    HANGING
    + """\
forces: {push: {type: couple, on: bar, vector: ["step(t - 0.05)", 0, 0]}}
analysis: {duration: 0.1, samples: 3}
"""
)

pytestmark = pytest.mark.skipif(not hasattr(signal, "setitimer"), reason="no timer that interrupts")


def test_modules_at_work_that_a_limit_names_are_there() -> None:
    assert all(importlib.util.find_spec(prefix) for prefix, _ in timeout.PHASES)


def as_own(function: FunctionType) -> FunctionType:
    """The function as one of heun's own code."""
    function.__code__ = function.__code__.replace(co_filename=evaluator.__file__)
    return function


@as_own
def forever(*_: Any, **__: Any) -> Any:
    """What takes too long, and handles every error on its way."""
    while True:
        with contextlib.suppress(Exception):
            time.sleep(60.0)


@as_own
def rung(*_: Any, **__: Any) -> Any:
    """What takes too long, and where the alarm rings at once, however far the limit is."""
    signal.setitimer(signal.ITIMER_REAL, 0.001, timeout.ALARM_INTERVAL)
    forever()


def foreign(*_: Any, **__: Any) -> Any:
    """A library that takes too long."""
    while True:
        time.sleep(0.01)


@pytest.mark.parametrize(
    ("slow", "words", "phase"),
    [
        ("heuncli.scene.file_format.load.read_source", "run hanging.yaml", "while the spec was read"),
        ("heuncli.scene.file_format.load.read_source", "validate hanging.yaml", "while the spec was read"),
        ("heuncli.study.model.setup.prepare_coupled", "run hanging.yaml", "while the model was being set up"),
        ("heuncli.study.model.setup.prepare_coupled", "model hanging.yaml", "while the model was being set up"),
        ("heuncli.study.model.setup.prepare_coupled", "modes hanging.yaml", "while the model was being set up"),
        ("heuncli.loads.equilibrium.search.make_rest_law", "run rest.yaml", "while the rest position was searched"),
        (
            "heuncli.scene.expressions.discontinuities._find_switch_changes",
            "run driven.yaml",
            "while jumps in time were searched",
        ),
        (
            "heuncli.motion.integration.check.estimate.choose_instants",
            "run swinging.yaml",
            "while the motion was integrated and checked",
        ),
        (
            "heuncli.motion.integration.check.estimate.choose_instants",
            "check swinging.yaml",
            "swinging.yaml: the time limit",
        ),
        ("heuncli.study.compose.recovery.make_body_states", "run swinging.yaml", "while loads were computed"),
        (
            "heuncli.study.search.extremes.find_best",
            "run swinging.yaml",
            "while extremes between the samples were searched",
        ),
        ("heuncli.app.commands.run.scene.make_query", "run swinging.yaml", "before the work was finished"),
        (
            "heuncli.analyses.motion_diagnostics.study.find_integrated_growth",
            "probe swinging.yaml",
            "while disturbances of the motion were examined",
        ),
    ],
)
def test_whatever_takes_too_long_is_ended(
    heun: Heun, folder: Path, monkeypatch: pytest.MonkeyPatch, slow: str, words: str, phase: str
) -> None:
    (folder / "rest.yaml").write_text(REST)
    (folder / "driven.yaml").write_text(DRIVEN)
    monkeypatch.setattr(slow, rung)
    begun = time.monotonic()
    done = heun(*words.split(), "--time-limit", "60")
    assert time.monotonic() - begun < ENOUGH
    assert (done.returncode, done.stdout) == (4, "")
    assert "[time-limit]" in done.stderr and phase in done.stderr
    assert signal.getitimer(signal.ITIMER_REAL) == (0.0, 0.0)


def test_an_alarm_that_an_object_swallows_on_its_way_out_says_nothing(capsys: pytest.CaptureFixture[str]) -> None:
    """A generator that is given up with processes to wait for; the next alarm ends what goes on behind it."""

    @as_own
    def busy() -> Iterator[int]:
        try:
            yield 0
        finally:
            time.sleep(60.0)

    @as_own
    def work() -> None:
        generator = busy()
        next(generator)
        del generator
        forever()

    with pytest.raises(LimitError, match="was reached"):
        timeout.run_with_limit(work, 0.05, grace=0.0)
    assert capsys.readouterr().err == ""


def test_the_alarm_rings_in_heuns_own_code_alone() -> None:
    """A library finishes what it is at; it is ended where it comes back to heun."""
    finished: list[str] = []

    def library() -> None:
        until = time.monotonic() + 0.2
        while time.monotonic() < until:
            time.sleep(0.001)
        finished.append("library")

    @as_own
    def work() -> None:
        library()
        forever()
        finished.append("work")

    with pytest.raises(LimitError, match="was reached"):
        timeout.run_with_limit(work, 0.05, grace=0.0)
    assert finished == ["library"]


def test_what_is_cleared_away_behind_an_alarm_is_not_interrupted() -> None:
    """Not by the next ring either."""
    cleared: list[str] = []

    @as_own
    def work() -> None:
        try:
            forever()
        finally:
            time.sleep(3.0 * timeout.EXCEPTION_INTERVAL)
            cleared.append("all")

    with pytest.raises(LimitError, match="was reached"):
        timeout.run_with_limit(work, 0.05, grace=0.0)
    assert cleared == ["all"]


def test_an_exception_that_a_library_makes_of_the_alarm_is_the_limit() -> None:
    @as_own
    def work() -> None:
        try:
            forever()
        except BaseException as error:
            raise RuntimeError(f"a validator could not be built: {error}") from None

    with pytest.raises(LimitError, match=r"the time limit of 0\.05 s was reached"):
        timeout.run_with_limit(work, 0.05, grace=0.0)


def ended_hard(folder: Path, work: Callable[[], object]) -> tuple[int, str]:
    """The exit code and the standard error of a process in which work goes on in a library."""
    child = os.fork()
    if child == 0:
        os.dup2(os.open(folder / "err", os.O_WRONLY | os.O_CREAT), 2)
        timeout.HARD_END = 0.2
        timeout.run_with_limit(work, 0.05, grace=0.0)
        os._exit(0)
    return os.waitstatus_to_exitcode(os.waitpid(child, 0)[1]), (folder / "err").read_text()


@pytest.mark.parametrize("forking", [False, True])
def test_work_that_does_not_stop_ends_the_process(folder: Path, forking: bool) -> None:
    """By a thread; while processes are forked by the ring. Nothing half written is left."""
    before = sorted(path.name for path in folder.iterdir())

    def written() -> Iterator[bytes]:
        yield b"half"
        foreign()

    def work() -> None:
        with timeout.pause_watch() if forking else contextlib.nullcontext():
            files.write(written(), str(folder / "out.json"))

    code, err = ended_hard(folder, work)
    assert code == 4
    assert "the time limit of 0.05 s was reached" in err and "did not stop" in err and err.count("[time-limit]") == 1
    assert sorted(path.name for path in folder.iterdir()) == sorted([*before, "err"])


def test_work_that_holds_the_interpreter_ends_with_the_process_too(folder: Path) -> None:
    """One call that runs no Python code: only a thread sees the limit."""
    waiting = threading.Lock()
    waiting.acquire()

    def work() -> None:
        signal.pthread_sigmask(signal.SIG_BLOCK, {signal.SIGALRM})
        waiting.acquire()

    assert ended_hard(folder, work)[0] == 4


def test_of_several_specs_only_the_one_that_does_not_stop_is_lost(
    heun: Heun, folder: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    (folder / "rest.yaml").write_text(REST)
    monkeypatch.setattr("heuncli.loads.equilibrium.search.make_rest_law", foreign)
    monkeypatch.setattr(timeout, "HARD_END", 0.2)
    done = heun("check", "rest.yaml", "expecting.yaml", "--time-limit", "0.5")
    assert done.returncode == 4
    assert "1 check passed, 0 failed, 1 spec not solved" in done.stdout
    assert "rest.yaml: the time limit was reached, but the work did not stop [time-limit]" in done.stderr


@pytest.mark.heavy
def test_alarms_at_any_instant_of_any_command() -> None:
    """A share of `python -m tests.faults.alarms --every 0.001`."""
    line = [sys.executable, "-m", "tests.faults.alarms", "--each", "2", "--only", "validate,modes"]
    done = subprocess.run(line, capture_output=True, text=True, cwd=ROOT, timeout=300, check=False)
    assert (done.returncode, done.stderr) == (0, ""), done.stdout


def test_a_limit_in_a_thread_of_a_program_uses_no_signal_and_ends_nothing_else() -> None:
    spec = yaml.safe_load(HANGING) | {"analysis": {"duration": 1e5, "samples": 3}}
    spec["bodies"]["bar"]["orientation"] = {"axis": [1, 0, 0], "angle": "60 deg"}
    ends: list[BaseException | None] = []

    def solving() -> None:
        try:
            heuncli.solve(spec, time_limit=0.05)
        except heuncli.LimitError as error:
            ends.append(error)

    before = signal.getsignal(signal.SIGALRM)
    threads = [threading.Thread(target=solving) for _ in range(2)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    assert len(ends) == 2
    assert (signal.getsignal(signal.SIGALRM), signal.getitimer(signal.ITIMER_REAL)) == (before, (0.0, 0.0))


def test_each_spec_has_its_own_limit(heun: Heun, folder: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """The others are checked all the same."""
    (folder / "rest.yaml").write_text(REST)
    monkeypatch.setattr("heuncli.loads.equilibrium.search.make_rest_law", rung)
    done = heun("check", "rest.yaml", "expecting.yaml", "--time-limit", "60")
    assert done.returncode == 4
    assert "1 check passed, 0 failed, 1 spec not solved" in done.stdout
    assert "rest.yaml: the time limit of 60 s was reached while the rest position was searched" in done.stderr
    done = heun("validate", "hanging.yaml", "expecting.yaml", "--time-limit", "10")
    assert done.returncode == 0


def test_what_goes_out_goes_out_whole(heun: Heun, folder: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """The alarm rings while the last of a file is being written."""
    fsync = os.fsync

    def slowly(number: int) -> None:
        signal.setitimer(signal.ITIMER_REAL, 0.001, 0.001)
        time.sleep(0.1)
        fsync(number)

    monkeypatch.setattr(os, "fsync", slowly)
    done = heun("run", "hanging.yaml", "-o", "out.json", "--time-limit", "60")
    assert (done.returncode, done.stderr) == (0, "")
    assert (folder / "out.json").read_text().endswith("}\n")


def test_what_is_still_made_is_given_up(heun: Heun, folder: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Of a file that is written whole or not at all the limit holds until its last piece is made."""
    (folder / "out.json").write_text("old")
    monkeypatch.setattr("heuncli.output.documents.as_data._format_json", rung)
    done = heun("run", "hanging.yaml", "-o", "out.json", "--time-limit", "60")
    assert (done.returncode, done.stdout) == (4, "")
    assert "while the results were written" in done.stderr
    assert (folder / "out.json").read_text() == "old"
    assert not [path for path in folder.iterdir() if path.name.startswith(".heun-")]


def test_text_for_a_pipe_counts_against_the_limit(heun: Heun, folder: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Under a limit no half of a table reaches a pipe."""
    monkeypatch.setattr("heuncli.output.documents.as_data._format_json", rung)
    done = heun("run", "hanging.yaml", "--format", "json", "--time-limit", "60")
    assert (done.returncode, done.stdout) == (4, "")
    assert "while the results were written" in done.stderr


def test_long_text_under_a_limit_is_the_same_text(heun: Heun, folder: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Kept in a temporary file or in memory, and read back in blocks."""
    monkeypatch.setattr("heuncli.app.cli.output.BLOCK", 1000)
    plain = heun("run", "hanging.yaml", "--format", "csv", "--all")
    for memory in (1 << 24, 10):
        monkeypatch.setattr("heuncli.app.cli.output.MEMORY", memory)
        limited = heun("run", "hanging.yaml", "--format", "csv", "--all", "--time-limit", "60")
        assert limited.returncode == 0 and limited.stdout == plain.stdout and len(plain.stdout) > 1000


def test_a_fifo_without_a_writer_is_given_up(heun: Heun, folder: Path) -> None:
    os.mkfifo(folder / "pipe.yaml")
    done = heun("run", "pipe.yaml", "--time-limit", "0.2")
    assert done.returncode == 4 and "while the spec was read" in done.stderr


@pytest.mark.parametrize("words", ["run hanging.yaml", "validate hanging.yaml", "check hanging.yaml"])
@pytest.mark.parametrize("limit", ["0", "-1", "nan", "inf"])
def test_limits_that_are_none(heun: Heun, words: str, limit: str) -> None:
    done = heun(*words.split(), f"--time-limit={limit}")
    assert done.returncode == 2 and "expected a positive number" in done.stderr


def test_a_huge_limit_and_another_thread(heun: Heun) -> None:
    """The timer takes no limit of a thousand years, and interrupts the first thread alone."""
    codes = [heun("run", "hanging.yaml", "--time-limit", "1e300").returncode]
    other = threading.Thread(target=lambda: codes.append(heun("run", "hanging.yaml", "--time-limit", "60").returncode))
    other.start()
    other.join()
    assert codes == [0, 0]


@pytest.mark.heavy
@pytest.mark.parametrize("name", ["double", "four_bar"])
@pytest.mark.parametrize("hold_rows", [False, True])
def test_states_are_recovered_alike_in_short_calls(monkeypatch: pytest.MonkeyPatch, name: str, hold_rows: bool) -> None:
    """One state to a call of the kernel, or all."""
    study = solve(load(str(SPECS / f"{name}.yaml")))
    runner, times = study.setup.runner, study.results.time[::20]
    states = study.history.solutions.states[::20]
    whole = runner.evaluate(times, states, hold_rows=hold_rows)
    monkeypatch.setattr(evaluator, "AT_ONCE", 1)
    single = runner.evaluate(times, states, hold_rows=hold_rows)
    for field in ("alpha", "a"):
        np.testing.assert_allclose(single.bodies[field], whole.bodies[field], rtol=1e-12, atol=1e-12)
    np.testing.assert_allclose(single.pivot, whole.pivot, rtol=1e-9)
    np.testing.assert_allclose(single.states, whole.states, rtol=1e-14, atol=1e-14)
