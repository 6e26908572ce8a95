"""Sweeps whose workers or whose own process is killed, or interrupted: what was done is kept, the rest is done later.

`python -m tests.faults.kills` kills more of them.
"""

from __future__ import annotations

import signal
import time
from pathlib import Path
from typing import NamedTuple

import pytest

from heuncli.analyses.variants.evaluation import VariantEvaluator
from heuncli.app.cli import variant_workers
from heuncli.scene.file_format.quantity import NumberWithUnit
from tests.shared.command import Heun
from tests.shared.sweeps import (
    COUNT,
    DURATION,
    STORE,
    SWINGING,
    begin,
    held,
    killed,
    rows,
    timed,
    wait_until_gone,
    workers_of,
)

pytestmark = pytest.mark.heavy


class Undisturbed(NamedTuple):
    """The rows of a sweep that nobody disturbs, and how long its workers work [s]."""

    rows: str
    seconds: float


@pytest.fixture
def swinging(folder: Path) -> Path:
    """A folder with a spec whose variants take a while."""
    (folder / "swinging.yaml").write_text(SWINGING)
    return folder


@pytest.fixture(scope="module")
def undisturbed(tmp_path_factory: pytest.TempPathFactory) -> Undisturbed:
    """Its rows, and what they take."""
    folder = tmp_path_factory.mktemp("undisturbed")
    (folder / "swinging.yaml").write_text(SWINGING)
    return Undisturbed(*timed(folder))


def test_what_is_killed_is_taken_up_again(swinging: Path, undisturbed: Undisturbed) -> None:
    """Before its workers are at work its own process, while they are one of them, then its own again."""
    took = undisturbed.seconds
    kept = [killed(swinging, share * took, worker=bool(k % 2)) for k, share in enumerate((-0.2, 0.2, 0.4))]
    assert sorted(kept) == kept
    assert rows(swinging, "--store", STORE) == undisturbed.rows
    assert held(swinging) == (COUNT, [(1, number) for number in range(COUNT)])


def test_workers_end_when_their_parent_is_killed(swinging: Path) -> None:
    with begin(swinging, "--jobs", "3") as process:
        while len(workers_of(process.pid)) < 3:
            assert process.poll() is None
            time.sleep(0.01)
        theirs = workers_of(process.pid)
        process.kill()
        process.communicate()
    wait_until_gone(theirs)


@pytest.mark.parametrize(
    ("number", "word", "store"),
    [
        (signal.SIGINT, "interrupted", True),
        (signal.SIGINT, "interrupted", False),
        pytest.param(signal.SIGTERM, "terminated", True, marks=pytest.mark.long),
    ],
)
def test_an_interrupt_keeps_what_is_done(
    swinging: Path, undisturbed: Undisturbed, number: signal.Signals, word: str, store: bool
) -> None:
    """Rows that no store keeps are told."""
    with begin(swinging, "--jobs", "2", *(("--store", STORE) if store else ())) as process:
        while len(workers_of(process.pid)) < 2:
            assert process.poll() is None
            time.sleep(0.01)
        time.sleep(0.2 * undisturbed.seconds)
        theirs = workers_of(process.pid)
        process.send_signal(number)
        out, err = process.communicate(timeout=60)
    wait_until_gone(theirs)
    assert process.returncode == 128 + number
    done = held(swinging).answers if store else max(len(out.splitlines()) - 1, 0)
    goes_on = "the same command continues with the rest" if store else "--store FILE keeps them"
    assert err == f"heun: {word}: {done} of {COUNT} variants are done; {goes_on}\n"
    assert 0 < done < COUNT
    if store:
        assert out == ""
        assert rows(swinging, "--store", STORE) == undisturbed.rows
    else:
        assert set(out.splitlines()) < set(undisturbed.rows.splitlines())


@pytest.mark.long
def test_two_sweeps_at_once_on_one_store(swinging: Path) -> None:
    undisturbed = rows(swinging)
    with (
        begin(swinging, "--store", STORE, "--jobs", "1") as one,
        begin(swinging, "--store", STORE, "--jobs", "1") as two,
    ):
        assert [process.communicate(timeout=300) for process in (one, two)] == [(undisturbed, "")] * 2
    assert held(swinging) == (COUNT, [(1, number) for number in range(COUNT)])


def test_a_variant_that_ends_its_process_is_tried_once_more(
    heun: Heun, folder: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """The others of its batch are none the worse; it is tried again by the next call, for the store has no answer."""
    answer = VariantEvaluator.answer

    def deadly(self: VariantEvaluator, values: dict[str, NumberWithUnit]) -> object:
        if values["m"].value == 3.0:
            signal.raise_signal(signal.SIGKILL)
        return answer(self, values)

    words = ("sweep", "hanging.yaml", "m=1:5/5", "--measure", "joints.pivot.force.z", "--format", "csv")
    undisturbed = heun(*words)
    monkeypatch.setattr(VariantEvaluator, "answer", deadly)
    monkeypatch.setattr(variant_workers.Batches, "next", in_one(variant_workers.Batches.next))
    done = heun(*words, "--store", "s.sqlite", "--jobs", "2")
    assert done.returncode == 0
    assert done.stderr == "heun: 1 of 5 variants could not be solved: 1 worker-died\n"
    lines, expected = done.stdout.splitlines(), undisturbed.stdout.splitlines()
    assert "worker-died,the process that solved it failed twice: killed by signal 9" in lines[3]
    assert lines[:3] + lines[4:] == expected[:3] + expected[4:]
    monkeypatch.setattr(VariantEvaluator, "answer", answer)
    assert heun(*words, "--store", "s.sqlite") == undisturbed


def in_one(following):  # type: ignore[no-untyped-def]
    """Batches that begin with all there is."""

    def next_(self: variant_workers.Batches) -> object:
        self.size = max(self.size, 100)
        return following(self)

    return next_


def test_a_variant_that_takes_too_long_is_tried_again(heun: Heun, folder: Path) -> None:
    slow = SWINGING.replace(DURATION, "duration: T").replace("m: 1.0", "m: 1.0, T: 1.0")
    (folder / "slow.yaml").write_text(slow)
    words = ("sweep", "slow.yaml", "T=0.1,1e7", "--measure", "final energy.kinetic", "--format", "csv")
    done = heun(*words, "--store", "s.sqlite", "--time-limit", "0.5")
    assert done.returncode == 0
    assert done.stderr == "heun: 1 of 2 variants could not be solved: 1 time-limit\n"
    assert "time-limit,the time limit was reached at" in done.stdout.splitlines()[2]
    again = heun(*words, "--store", "s.sqlite", "--time-limit", "1", "--strict")
    assert again.returncode == 1
    assert again.stdout.splitlines()[2] != done.stdout.splitlines()[2]
    assert again.stdout.splitlines()[:2] == done.stdout.splitlines()[:2]
