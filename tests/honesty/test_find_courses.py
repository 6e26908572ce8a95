"""`heun find` on random courses that are known in closed form: find_courses.py beside it."""

from __future__ import annotations

import pytest

from tests.honesty.find_courses import KINDS, judged


@pytest.mark.heavy
@pytest.mark.parametrize("kind", KINDS)
def test_what_is_told_of_a_known_course_is_true(kind: str) -> None:
    for seed in range(3):
        course, relation, verdict = judged(seed, kind, direct=True)
        assert verdict.wrong == [], (course, relation)


@pytest.mark.heavy
@pytest.mark.parametrize("seed", [0, 4])
def test_so_it_is_by_the_whole_command(seed: int) -> None:
    course, relation, verdict = judged(seed)
    assert verdict.wrong == [], (course, relation)
