"""What is wrong with names of what is varied and of what is measured is told by one call, with the wrong word."""

from __future__ import annotations

import pytest

from tests.shared.command import Heun


@pytest.mark.parametrize(
    ("words", "at"),
    [
        (("sweep", "hanging.yaml", "Q=1:2/2", "--measure", "joints.pivit.force"), "--measure"),
        (("find", "hanging.yaml", "Q=1:2", "joints.pivit.force = 3"), "find"),
        (("tune", "hanging.yaml", "Q=1:2", "m=1:2", "--minimise", "joints.pivit.force"), "tune"),
        (("sensitivity", "hanging.yaml", "Q", "--measure", "joints.pivit.force"), "--measure"),
    ],
)
def test_all_that_is_wrong_is_told_at_once(heun: Heun, words: tuple[str, ...], at: str) -> None:
    done = heun(*words)
    assert (done.returncode, done.stdout) == (2, "")
    assert f"heun: {at}: 'joints.pivit.force': 'pivit' is not a result [unknown-path]" in done.stderr
    assert "Q" in done.stderr and "known parameters: m" in done.stderr
    assert done.stderr.count("hint: ") == 2
