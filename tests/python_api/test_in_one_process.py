"""Many solutions in one process: the same bits each time, in threads, after an interrupt, within a time limit."""

from __future__ import annotations

import json
import signal
import sys
import threading
import time
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

import numpy as np
import pytest

import heuncli
from heuncli.base import process
from heuncli.study.solve import history
from tests.shared.command import SPEC_TEXTS
from tests.shared.folders import SPECS
from tests.shared.processes import interruptible

SOME = [SPECS / f"{name}.yaml" for name in ("double", "chain", "struck_door", "overhang", "bouncing_ball", "rotor")]
pytestmark = pytest.mark.heavy


def text(path: Path) -> str:
    """All that a run tells, but for how long it took."""
    data = heuncli.solve(path).as_dict()
    del data["work"]["seconds"]
    return json.dumps(data)


@pytest.fixture(scope="module")
def alone() -> list[str]:
    return [text(path) for path in SOME]


def test_solved_again_it_is_the_same_to_the_bit(alone: list[str]) -> None:
    assert [text(path) for path in reversed(SOME)] == alone[::-1]


def test_threads_solve_as_one_does(alone: list[str]) -> None:
    before = sys.getswitchinterval()
    sys.setswitchinterval(1e-5)
    try:
        with ThreadPoolExecutor(4) as pool:
            together = list(pool.map(text, SOME[::-1] + SOME))
    finally:
        sys.setswitchinterval(before)
    assert together == alone[::-1] + alone


def test_one_scene_may_be_asked_by_several_threads() -> None:
    """The kernel's memory serves one at a time, and lets others run meanwhile."""
    study = heuncli.solve(SPECS / "double.yaml")
    path = next(path for path in study.paths("joints") if path.endswith(".force"))
    times = np.linspace(study.time[0], study.time[-1], 400)
    alone = [study[path].at(times[k::8]) for k in range(8)]
    most = study.measure(f"max abs {path}")
    with ThreadPoolExecutor(4) as pool:
        asked = [pool.submit(lambda k=k: study[path].at(times[k % 8 :: 8])) for k in range(32)]
        measured = [pool.submit(study.measure, f"max abs {path}") for _ in range(4)]
        assert all(np.array_equal(each.result(), alone[k % 8]) for k, each in enumerate(asked))
        assert all(each.result() == most for each in measured)


def test_a_time_limit_holds_in_every_thread() -> None:
    handlers = [signal.getsignal(signal.SIGINT), signal.getsignal(signal.SIGALRM)]

    def limited() -> float:
        begun = time.monotonic()
        with pytest.raises(heuncli.LimitError, match="the time limit was reached at t ="):
            heuncli.solve(text=SPEC_TEXTS["long"], tolerance=1e-13, time_limit=0.05)
        return time.monotonic() - begun

    assert limited() < 20.0
    with ThreadPoolExecutor(1) as pool:
        assert pool.submit(limited).result() < 20.0
    assert handlers == [signal.getsignal(signal.SIGINT), signal.getsignal(signal.SIGALRM)]


def test_what_would_not_fit_into_memory_is_refused_before_it_is_begun(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(process, "_iter_remaining_memory", lambda: iter([2e7]))
    with pytest.raises(heuncli.LimitError, match="is allowed") as caught:
        heuncli.solve(text=SPEC_TEXTS["swinging"], set={"analysis.samples": 100_001})
    assert caught.value.problems[0].code == "too-much-memory" and "would fit" in caught.value.problems[0].hint


def test_an_interrupt_leaves_nothing_broken(monkeypatch: pytest.MonkeyPatch) -> None:
    """Ctrl-C in a cell: the next cell solves as if nothing had been; a study that was asked can be asked again."""
    path = SPECS / "struck_door.yaml"
    whole, study = text(path), heuncli.solve(path)
    before = study["energy.kinetic"].at(0.0123)
    with monkeypatch.context() as patch:
        patch.setattr(history, "resample", None)
        patch.setattr("heuncli.study.queries.study.resample", interrupted)
        patch.setattr("heuncli.study.workflow.recover", interrupted)
        for ask in (lambda: heuncli.solve(path), lambda: study["energy.kinetic"].at(0.02)):
            with pytest.raises(KeyboardInterrupt):
                ask()
    assert text(path) == whole and study["energy.kinetic"].at(0.0123) == before
    timer = threading.Timer(0.02, signal.raise_signal, [signal.SIGINT])
    with pytest.raises(KeyboardInterrupt), interruptible():
        timer.start()
        while True:
            heuncli.solve(path)
    timer.join()
    assert text(path) == whole


def interrupted(*_: object, **__: object) -> None:
    raise KeyboardInterrupt
