"""A true change of a course between its extremes is found in golden files; the same told otherwise is none."""

from __future__ import annotations

import pytest

from heuncli.output.snapshots.changes import find_changes
from tests.honesty import golden_means
from tests.honesty.golden_courses import Course, Pulse, drawn, kept, look_at


@pytest.mark.heavy
@pytest.mark.parametrize("seed", range(7))
def test_changes_above_the_error_are_found(seed: int) -> None:
    outcome = look_at(drawn(seed))
    assert outcome.is_right, outcome


def test_a_load_that_moves_and_a_second_peak_that_grows_are_found() -> None:
    """The greatest value stays 100 N, and no even instant sees the pulses."""
    still = Pulse(100.0, 0.23, 0.02, bell=False)
    early = Course((still._replace(height=60.0), still._replace(at=0.53)), (0.0, 1.0, 0.0), ())
    late = Course((still._replace(height=99.0), still._replace(at=0.87)), (0.0, 1.0, 0.0), ())
    one, other = kept(early.spec(101)), kept(late.spec(101))
    assert one.numbers["joints.w.force"].greatest == other.numbers["joints.w.force"].greatest
    assert {change.path for change in find_changes(one, other)} >= {"joints.w.force", "joints.w.force.x"}


@pytest.mark.heavy
@pytest.mark.parametrize("seed", range(12))
@pytest.mark.third
def test_means_of_loads_that_jump_are_right_to_their_error(seed: int) -> None:
    outcome = golden_means.look_at(seed)
    assert outcome.ratios is None or max(outcome.ratios) <= 1.0, outcome
