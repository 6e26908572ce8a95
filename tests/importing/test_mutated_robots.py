"""Files with a slip in them: each is a machine that runs, or refused with the place, what was found, and a hint."""

from __future__ import annotations

import random
import re

import pytest

from heuncli.base.errors import SpecError
from tests.shared.imported_robots import imported_robot
from tests.shared.scenes import solved
from tests.shared.urdf_texts import Wishes, drawn_robot

TAG, ATTRIBUTE = re.compile(r"<[^>?!]+>"), re.compile(r'(\w+)="([^"]*)"')
ELEMENT, BLOCK = re.compile(r"<\w+\b[^>]*/>"), re.compile(r"<(inertial|link|joint)\b[^>]*(?<!/)>.*?</\1>\n?", re.DOTALL)
VALUES = (
    "", "0", "0 0 0", "0 0 1", "1 2", "nan", "-1", "1e308", "1e-300", "x", "1,5", "fixed", "planar", "floating",
    "prismatic", "1e5", "  1 0 0 ", "-0", ".5", "1.",
)  # fmt: skip


def mutated(text: str, rng: random.Random) -> str:
    """The text with a piece taken out, doubled, swapped, misspelt, or a value put into it."""
    form = rng.choice((TAG, ATTRIBUTE, ELEMENT, BLOCK))
    found = list(form.finditer(text))
    one, other = sorted(rng.sample(found, 2), key=lambda match: match.start())
    before, piece, after = text[: one.start()], one[0], text[one.end() :]
    slip = rng.choice(("out", "twice", "swapped", "misspelt", "value"))
    if slip == "out":
        return before + after
    if slip == "twice":
        return before + piece + piece + after
    if slip == "swapped":
        return before + other[0] + text[one.end() : other.start()] + piece + text[other.end() :]
    if slip == "misspelt":
        k = rng.randrange(len(piece))
        return before + piece[:k] + rng.choice("abxyz_ ") + piece[k + 1 :] + after
    inner = ATTRIBUTE.search(piece)
    if inner is None:
        return before + after
    return before + piece[: inner.start(2)] + rng.choice(VALUES) + piece[inner.end(2) :] + after


@pytest.mark.heavy
def test_a_slip_is_told_or_makes_a_machine_that_runs() -> None:
    taken = 0
    for seed in range(160):
        rng = random.Random(seed)
        text = mutated(drawn_robot(seed, Wishes(links=4 + seed % 5)).text, rng)
        try:
            robot = imported_robot(text)
        except SpecError as refused:
            for problem in refused.problems:
                assert problem.location is not None and problem.location.line > 0, problem
                assert problem.message and problem.hint, problem
            continue
        taken += 1
        solved(robot.spec_of_tests)
    assert 16 < taken < 144
