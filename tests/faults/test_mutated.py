"""Whatever stands in a spec or on a command line ends as documented: 60 cases by turns, 240 in a long run.

`python -m tests.faults --cases 720` and more makes as many as are wanted.
"""

from __future__ import annotations

import pytest

from tests.faults.__main__ import drawn
from tests.faults.pool import judged
from tests.faults.worker import LAWS

CASES = 240
BATCHES = 4  # a process each
LAW_CASES = 40
EACH_BATCH = [pytest.param(batch, marks=[pytest.mark.long] * (batch > 0)) for batch in range(BATCHES)]

pytestmark = pytest.mark.heavy  # cases are judged by the time they take, too


@pytest.mark.parametrize("batch", EACH_BATCH)
def test_every_case_ends_as_documented(batch: int) -> None:
    """Exit codes, forms of errors, numbers, time and memory: invariant.py; --replay KIND:SEED shows a case."""
    cases = drawn(CASES // BATCHES, batch * CASES // BATCHES, None)
    wrong = [f"{one.kind}:{one.seed} {what}" for one in judged(cases) for what in one.violations]
    assert not wrong, "\n".join(wrong)


@pytest.mark.parametrize("batch", EACH_BATCH)
def test_what_is_told_otherwise_says_the_same(batch: int) -> None:
    """Scenes that run, turned, faster, reordered, begun later, not reduced, by another method: laws.py."""
    cases = drawn(LAW_CASES // BATCHES, batch * LAW_CASES // BATCHES, LAWS)
    done = list(judged(cases))
    wrong = [f"{one.kind}:{one.seed} {what}" for one in done for what in one.violations]
    assert not wrong, "\n".join(wrong)
    assert sum(one.code == 0 for one in done) > LAW_CASES // BATCHES // 2
