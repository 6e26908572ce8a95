"""Reading takes as long as the text is long: what once took its square would take minutes here."""

from __future__ import annotations

import re
import time
from collections.abc import Callable

import pytest

from heuncli.base.errors import SpecError
from heuncli.base.spelling import reset_effort, suggest
from heuncli.results.path_hints import find_similar_path
from heuncli.scene.file_format.brackets import QUOTED
from heuncli.scene.file_format.load import load
from heuncli.scene.file_format.quantity import OVER_UNIT, WITH_UNIT, Scope, WrittenQuantity, product_hint

pytestmark = pytest.mark.heavy  # reading alone: no kernel is at work

MANY = 3000
SECONDS = 10.0  # tens of times what it takes; by the square it was from 8 s to minutes
BALL = "mass: 1, center: [0, 0, 0], inertia: [1, 1, 1]"
HEAD = f"heun: 1\nbodies:\n  one: {{{BALL}, points: {{p: [0, 0, 0]}}}}\n"


def each(block: str, entry: str) -> str:
    return f"{block}:\n" + "".join(f"  {entry}\n".replace("N", str(i)) for i in range(MANY))


WRONG = {
    "unknown-body": f"heun: 1\nground: {{points: {{O: [0, 0, 0]}}}}\n{each('bodies', f'bN: {{{BALL}}}')}"
    + each("joints", "jN: {type: ball, from: ground.O, to: cN.p}"),
    "unknown-point": f"{HEAD}ground:\n  {each('points', '  pN: [0, 0, 0]')}"
    + each("joints", "jN: {type: ball, from: ground.qN, to: one.p}"),
    "unknown-name": HEAD + each("parameters", "pN: qN + 1"),
    "expect-path": f"heun: 1\n{each('bodies', f'bN: {{{BALL}}}')}"
    + each("expect", "- {of: bodies.cN.center.x, is: 0}"),
    "end": f"heun: 1\n{each('bodies', f'bN: {{{BALL}}}')}ground: {{points: {{O: [0, 0, 0]}}}}\n"
    + each("joints", "jN: {type: ball, from: ground.O, to: pN}"),
    "wrong-length": f"heun: 1\n{each('bodies', f'bN: {{{BALL[:-4]}]}}')}",
    "unknown-unit": f"heun: 1\n{each('bodies', 'bN: {mass: 1 kgm, center: [0, 0, 0], inertia: [1, 1, 1]}')}",
}


@pytest.mark.parametrize("code", WRONG)
@pytest.mark.third
def test_thousands_of_problems_are_all_told_in_time(code: str) -> None:
    begun = time.process_time()
    with pytest.raises(SpecError) as caught:
        load("spec.yaml", WRONG[code])
    assert time.process_time() - begun < SECONDS
    assert [problem.code for problem in caught.value.problems] == [code] * MANY


def test_a_list_of_thousands_is_told_by_its_first() -> None:
    with pytest.raises(SpecError) as caught:
        load("spec.yaml", f"heun: 1\n{each('bodies', f'bN: {{{BALL}}}')}expect: [{{of: bodies, is: 0}}]\n")
    assert (caught.value.problems[0].hint or "").endswith("b18, b19, ...")


def test_thousands_of_expectations_on_thousands_of_points() -> None:
    text = f"heun: 1\nanalysis: {{duration: 1, samples: {MANY}}}\n"
    text += each("bodies", f"bN: {{{BALL}, points: {{p: [0, 0, 0]}}}}")
    text += each("expect", "- {of: points.bN.p.position.x, at: 0, is: 0, abs: 1}")
    begun = time.process_time()
    assert len(load("spec.yaml", text).expect) == MANY
    assert time.process_time() - begun < SECONDS


@pytest.mark.parametrize("name", ["k" * 300_000, "é" * 300_000, "\u202e" * 300_000])
def test_of_a_long_word_the_ends_are_told(name: str) -> None:
    with pytest.raises(SpecError) as caught:
        load("spec.yaml", f"{HEAD}space: '{name}'\n")
    (problem,) = caught.value.problems
    assert len(str(problem)) < 40_000
    assert "characters more) ... " in str(problem)


def test_the_first_dozens_get_suggestions_and_the_next_file_again() -> None:
    for _ in range(2):
        with pytest.raises(SpecError) as caught:
            load("spec.yaml", WRONG["unknown-point"])
        suggested = ["did you mean" in (problem.hint or "") for problem in caught.value.problems]
        assert 12 <= sum(suggested) < 200
        assert not any(suggested[-1000:])
        assert (caught.value.problems[-1].hint or "").startswith("known points of ground: p0, p1, ")


def test_long_words_are_not_compared() -> None:
    begun = time.process_time()
    names = [f"{'x' * 3000}{i}" for i in range(1000)]
    assert (suggest("x" * 3001, names, "names") or "").startswith("known names: ")
    assert time.process_time() - begun < SECONDS


def test_paths_of_many_words_have_no_other_reading() -> None:
    reset_effort()
    assert find_similar_path(".".join(["fx"] * 40), lambda words: False) is None  # 2**40 of them


@pytest.mark.parametrize(
    ("pattern", "text"),
    [
        (WITH_UNIT, "1" * 100_000),
        (WITH_UNIT, "1" * 100_000 + " m,"),
        (WITH_UNIT, " " * 100_000 + ","),
        (WITH_UNIT, "-" + " " * 100_000 + ","),
        (WITH_UNIT, "1 m" + " " * 100_000 + ","),
        (OVER_UNIT, "1" * 100_000),
        (OVER_UNIT, "1" + " " * 100_000),
    ],
)
def test_numbers_are_read_once(pattern: re.Pattern[str], text: str) -> None:
    begun = time.process_time()
    assert pattern.match(text) is None
    assert time.process_time() - begun < SECONDS


@pytest.mark.parametrize("mark", QUOTED)
def test_a_quote_left_open_is_read_once(mark: str) -> None:
    begun = time.process_time()
    assert QUOTED[mark].match(mark + "ab\n" * 300_000) is None
    assert time.process_time() - begun < SECONDS


@pytest.mark.parametrize("text", ["1" * 3000, f"1 {'m*' * 3000}m", " " * 3000])
def test_what_is_too_long_for_an_expression_is_not_read(text: str) -> None:
    spec = HEAD + f"parameters: {{a: '{text}'}}\n"
    with pytest.raises(SpecError) as caught:
        load("spec.yaml", spec)
    assert [problem.code for problem in caught.value.problems] == ["expression-limit"]


def test_a_hint_is_found_in_time() -> None:
    begun = time.process_time()
    assert product_hint(WrittenQuantity("1", "m + " + " " * 100_000 + "!"), Scope()) is None
    assert time.process_time() - begun < SECONDS


@pytest.mark.parametrize("order", [lambda i: i + 1, lambda i: (i + 1) % MANY])
def test_parameters_in_a_row_and_in_a_circle(order: Callable[[int], int]) -> None:
    text = f"{HEAD}parameters:\n" + "".join(f"  p{i}: p{order(i)} + 1\n" for i in range(MANY)) + f"  p{MANY}: 1\n"
    try:
        assert load("spec.yaml", text).parameters["p0"] == MANY + 1
    except SpecError as error:
        (problem,) = error.problems
        assert problem.code == "parameter-circle"
        assert "(2989 more) -> p2999 -> p0" in problem.message


@pytest.mark.parametrize("unit", ["m/(km^99)^99", "1/(mm^99)^99", "m*(km^99)^9"])
def test_powers_of_powers_are_no_units(unit: str) -> None:
    with pytest.raises(SpecError) as caught:
        load("spec.yaml", HEAD.replace("mass: 1", f"mass: 1 {unit}"))
    assert [problem.code for problem in caught.value.problems] == ["unknown-unit"]
