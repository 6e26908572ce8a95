"""The run from the moved start that a finer run needs: the check run of the discarded one, at other instants.

Both take the same steps. It is run anew where it would not: where the first run misses the tolerance by so much that
the finer one is finer than the check run, and where the finer run ends at another instant.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
import pytest

from heuncli.base.records import fields
from heuncli.motion.integration.check.runs import Runs
from heuncli.motion.integration.trajectory import Trajectory
from heuncli.results.results import Array
from heuncli.scene.file_format.load import load
from heuncli.study.workflow import solve
from tests.shared.folders import ROOT, SPECS

FREE = ("seconds", "evaluations", "records", "polynomials")  # they depend on the instants and on what is stored


class MovedRun(NamedTuple):
    """A run from the moved start, its instants, and the check run before it."""

    runs: Runs
    found: Trajectory
    instants: Array
    check: Trajectory | None

    @property
    def is_repeated(self) -> bool:
        """Whether it has the steps of the check run."""
        return self.check is not None and self.found.ends is self.check.ends


def list_moved_runs(text: str, monkeypatch: pytest.MonkeyPatch) -> list[MovedRun]:
    """The runs from the moved start that a spec needs."""
    calls: list[MovedRun] = []
    make = Runs.run_from_moved_start

    def record(self: Runs, a: Trajectory, check_times: Array) -> Trajectory | None:
        check, made = self.last_check, make(self, a, check_times)
        if made is not None:
            calls.append(MovedRun(self, made, check_times, check))
        return made

    monkeypatch.setattr(Runs, "run_from_moved_start", record)
    solve(load(str(SPECS / "scene.yaml"), text))  # the spec's tables are beside it
    return calls


def read(name: str) -> str:
    return (SPECS / f"{name}.yaml").read_text(encoding="utf-8")


@pytest.mark.parametrize("name", ["top", "charpy", "flat_four_bar"])  # free, struck, and a closed loop
def test_it_has_the_bits_of_a_run_of_its_own(name: str, monkeypatch: pytest.MonkeyPatch) -> None:
    (call,) = list_moved_runs(read(name), monkeypatch)
    assert call.is_repeated
    again = call.runs.try_run(call.found.local, call.found, call.instants, call.runs.perturbed_start)
    assert again is not None
    known = fields(call.found)
    for field, value in fields(again).items():
        same = (
            np.array_equal(value, known[field]) if isinstance(value, np.ndarray) else repr(value) == repr(known[field])
        )
        assert same or field in FREE, field


def test_a_much_finer_run_has_one_of_its_own(monkeypatch: pytest.MonkeyPatch) -> None:
    """The wing nut's first run misses its tolerance 400 times, so the next is finer than the check run."""
    (call,) = list_moved_runs(read("wingnut"), monkeypatch)
    assert not call.is_repeated


def test_a_run_that_ends_elsewhere_has_one_of_its_own(monkeypatch: pytest.MonkeyPatch) -> None:
    """A condition ends the finer run at a slightly different instant."""
    text = (ROOT / "heuncli" / "starters" / "pendulum.yaml").read_text(encoding="utf-8")
    (call,) = list_moved_runs(text, monkeypatch)
    assert call.is_repeated
    ended = text.replace("analysis:", "analysis:\n  until: pivot.angle < 0.5 rad", 1)
    (call,) = list_moved_runs(ended, monkeypatch)
    assert call.instants[-1] < 2.0 and not call.is_repeated
