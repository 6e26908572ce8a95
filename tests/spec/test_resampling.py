"""Tables resampled at even steps, and columns named without a unit of one letter."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest

from heuncli.base.errors import SpecError
from heuncli.scene.expressions.programs import TableFunction
from heuncli.scene.file_format.load import load
from heuncli.scene.file_format.table_signals import evaluate_points
from tests.shared.scenes import near

RNG = np.random.default_rng(5)
X = np.sort(np.concatenate([[0.0, 2.0], RNG.uniform(0.0, 2.0, 200)]))
BODY = "heun: 1\nbodies: {b: {mass: 1, center: [0, 0, 0], inertia: [1, 1, 1]}}\n"


def table(keys: str, y: Any, x: Any = X) -> TableFunction:
    points = f"x: {np.asarray(x).tolist()}, y: {np.asarray(y).tolist()}"
    return load("m.yaml", f"{BODY}tables: {{f: {{{points}, x_unit: s, y_unit: N, {keys}}}}}\n").tables["f"]


def test_a_cubic_is_itself_between_and_at_even_steps() -> None:
    def law(t: Any) -> Any:
        return 1.0 - 3.0 * t + 2.0 * t**2 - 0.5 * t**3

    made = table("interpolation: cubic, resample: 30 ms", law(X))
    x = np.frombuffer(made.x)
    near(np.diff(x), np.full(67, 2.0 / 67), 1.0, 1e-14)  # even steps from end to end, of nearly the asked length
    near(made.y, law(x), 3.0, 1e-12)
    places = np.linspace(0.0, 2.0, 401)
    near(evaluate_points(made, places), law(places), 3.0, 1e-12)
    assert made.dimensions == table("interpolation: cubic", X).dimensions
    assert "67 steps of 0.0299 s; its 202 points deviate by up to" in made.notes[0]


@pytest.mark.parametrize(("keys", "steps"), [("resample: 50 Hz", 100), ("resample: 40 ms, interpolation: pchip", 50)])
def test_noise_is_smoothed_before_and_the_points_left_out_are_told(keys: str, steps: int) -> None:
    y = np.cos(6.0 * X) + 0.05 * RNG.normal(size=len(X))
    made = table(f"{keys}, smooth: 4 Hz", y)
    smoothed = table(f"smooth: 4 Hz, {keys.partition(', ')[2]}", y)
    assert len(made.x) == steps + 1 and len(made.notes) == 2
    near(made.y, evaluate_points(smoothed, np.frombuffer(made.x)), 1.0, 1e-12)
    rows = evaluate_points(made, X) - np.frombuffer(smoothed.y)
    assert f"deviate by up to {np.abs(rows).max():.3g} N, {np.sqrt(np.mean(rows**2)):.3g} N (rms)" in made.notes[1]


def test_a_periodic_table_stays_so_and_a_derivative_keeps_its_dimension() -> None:
    x = np.linspace(0.0, 1.0, 41)
    made = table("period: 1 s, interpolation: cubic, derivative: 1, resample: 100 Hz", np.sin(2 * np.pi * x), x)
    assert made.kind == 2 and made.y[0] == made.y[-1] and len(made.x) == 101
    near(made.y, 2 * np.pi * np.cos(2 * np.pi * np.frombuffer(made.x)), 2 * np.pi, 1e-4)
    assert made.dimensions == table("interpolation: cubic, derivative: 1", X).dimensions


@pytest.mark.parametrize(("keys", "said"), [
    ("smooth: 5 Hz, resample: 8 Hz", "steps of 0.125 s lose what smooth keeps"),
    ("resample: 2 m", "the step is a length, but x is a time"),
    ("resample: 3 s", "takes 1 steps"),
    ("resample: 1 us", "takes 2,000,000 steps"),
    ("resample: 0", "the step is 0"),
    ("resample: -1 ms", "the step is -0.001"),
])  # fmt: skip
def test_steps_that_say_nothing_are_refused(keys: str, said: str) -> None:
    with pytest.raises(SpecError) as refused:
        table(keys, np.cos(X))
    (problem,) = refused.value.problems
    assert said in problem.message and problem.hint and problem.code in ("table-form", "dimension")


@pytest.mark.parametrize(("head", "x", "found"), [
    ("t / s;F / N", "t", True), ("t/s;F/N", "t", True), ("t in s;F, N", "t", True),
    ("m/s;F", "m", False),  # a unit
    ("t / s;F", "F", True), ("t / s;t / m;F", "t", False),
])  # fmt: skip
def test_a_column_is_named_without_its_letter_if_that_is_a_unit(folder: Path, head: str, x: str, found: bool) -> None:
    width = head.count(";") + 1
    (folder / "d.csv").write_text(head + "\n" + "\n".join(";".join([str(k)] * width) for k in range(3)))
    text = f"{BODY}tables: {{f: {{file: d.csv, x: {x}, y: F}}}}\n"
    if found:
        assert list(load(str(folder / "m.yaml"), text).tables["f"].x) == [0.0, 1.0, 2.0]
    else:
        with pytest.raises(SpecError, match=r"there (is no|are 2) column"):
            load(str(folder / "m.yaml"), text)
