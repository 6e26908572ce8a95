"""`heun find` on random courses that are known in closed form: find_courses.py beside it."""

from __future__ import annotations

import pytest

from heuncli.analyses.find.study import find_meetings
from heuncli.analyses.variants.samples import Sample
from tests.honesty.find_courses import KINDS, KnownCourse, found_directly, judged


@pytest.mark.heavy
@pytest.mark.parametrize("kind", KINDS)
@pytest.mark.third
def test_what_is_told_of_a_known_course_is_true(kind: str) -> None:
    for seed in range(3):
        course, relation, verdict = judged(seed, kind, direct=True)
        assert verdict.wrong == [], (course, relation)


@pytest.mark.heavy
@pytest.mark.parametrize("seed", [0, 4])
def test_so_it_is_by_the_whole_command(seed: int) -> None:
    course, relation, verdict = judged(seed)
    assert verdict.wrong == [], (course, relation)


@pytest.mark.parametrize("seed", [1068, 1097, 1104, 1110, 1123, 1240, 1263, 1353, 1595, 1938])
@pytest.mark.third
def test_narrow_peaks_flat_touches_and_near_pairs_are_not_passed_over(seed: int) -> None:
    """Each was told as met nowhere, at a place out of its stated ends, or as met throughout."""
    course, relation, verdict = judged(seed, direct=True)
    assert verdict.wrong == [], (course, relation)


@pytest.mark.parametrize("seed", [592, 729, 2003, 152, 620, 971, 958, 1565])
@pytest.mark.third
def test_gaps_at_ends_beside_poles_and_touches_of_zero_are_searched(seed: int) -> None:
    """A law that breaks in the last gap; a pole and a zero in one gap; touches whose error vanishes there."""
    course, relation, verdict = judged(seed, direct=True)
    assert verdict.wrong == [], (course, relation)
    assert verdict.runs < 250


@pytest.mark.parametrize(("off", "is_open"), [(3.0, True), (1000.0, False)])
def test_what_errors_leave_open_is_not_met_nowhere(off: float, is_open: bool) -> None:
    """A parabola three errors above the value comes to it as far as anyone knows; at a thousand errors it does not."""
    error = 1e-9
    found = find_meetings(
        lambda x: Sample(x, (x - 0.4) ** 2 + off * error, error), 0.0, 1.0, "=", scan_count=7, max_evaluations=300
    )
    assert found.is_complete and not found.touches and found.is_met_nowhere is not is_open
    assert [one.left.x <= 0.4 <= one.right.x for one in found.not_excluded] == [True] * is_open


@pytest.mark.parametrize(("formula", "ways"), [("x", [None]), ("x - 0.25", ["rises"]), ("0.5 - x", ["falls"])])
def test_a_crossing_at_an_end_has_no_way(formula: str, ways: list[str | None]) -> None:
    told = found_directly(KnownCourse("", formula, 0.0, 1.0, 0.0, lambda x: x), "=")
    assert [one["way"] for one in told["crossings"]] == ways
