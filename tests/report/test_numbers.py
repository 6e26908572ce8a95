"""No more digits than the run can stand behind."""

from __future__ import annotations

import math

import numpy as np
import pytest

from heuncli.report.numbers import certainty, rough, style, trim, write, write_times
from tests.shared.fakes import ACCURATE, LABELS, pendulum

T = np.linspace(0.0, 2.0, 11)


@pytest.mark.parametrize("seed", range(50))
def test_what_is_printed_is_right_to_one_unit_of_the_last_place_and_certain(seed: int) -> None:
    random = np.random.default_rng(seed)
    scale = 10.0 ** random.uniform(-9.0, 9.0)
    error = scale * 10.0 ** random.uniform(-13.0, 0.5)
    values = scale * random.uniform(-1.0, 1.0, 5)
    how = style(float(np.abs(values).max()), error)
    for value, text in zip(values, write(values.tolist(), how), strict=True):
        mantissa, _, exponent = text.partition("e")
        digits = mantissa.replace("-", "").replace(".", "").lstrip("0")
        last = 10.0 ** (int(exponent or 0) - len(mantissa.partition(".")[2]))
        assert len(digits) <= 8
        assert abs(float(text) - value) <= 0.51 * max(last, 10.0 * error)
        if text != "0" and "." in mantissa and len(trim([text])[0]) == len(text):
            assert last >= 0.99 * error


def test_engineers_numbers() -> None:
    assert write([33.99999999999997, -0.5], style(34.0, 1e-12)) == ["34.0", "-0.5"]
    assert write([9.81, 1e-13], style(9.81, 1e-12)) == ["9.81", "0"]
    assert write([49.05, -3.7e-7], style(49.05, 0.0)) == ["49.05", "0"]
    assert write([123456789.0], style(123456789.0, 0.0)) == ["1.23457e+08"]
    assert write([2.0e-7], style(2.0e-7, 0.0)) == ["2.00000e-07"]
    assert write([math.nan, math.inf, 1.0], style(1.0, 0.0)) == ["open", "unbounded", "1.0"]


def test_an_error_as_large_as_the_number_leaves_nothing() -> None:
    assert write([3.0, -2.0], style(3.0, 5.0)) == ["0", "0"]


def test_common_zeros_go_but_one_decimal_stays() -> None:
    assert trim(["34.0000", "0", "open"]) == ["34.0", "0", "open"]
    assert trim(["1.2500", "3.0000"]) == ["1.25", "3.00"]
    assert trim(["1200", "34"]) == ["1200", "34"]


def test_instants_are_told_to_a_hundred_thousandth_of_the_run() -> None:
    assert write_times([0.0, 1.0 / 3.0, 2.0], 2.0) == ["0", "0.3333", "2.0"]
    assert write_times([1.0 / 3.0], 0.02) == ["0.333333"]
    assert write_times([0.25], 0.0) == ["0.25"]


def test_the_error_of_loads_is_relative_to_the_largest_of_them() -> None:
    errors = certainty(pendulum(T), LABELS)
    assert errors.error("N") == pytest.approx(5e-10 * pendulum(T).joints["pivot"]["force"].max(), rel=0.01)
    assert errors.error("rad") == pytest.approx(4e-11 * 1.0, rel=0.1)
    assert errors.error("furlong") == 0.0


def test_a_moment_is_no_more_certain_than_a_force_on_its_arm() -> None:
    results = pendulum(T)
    reach = 0.5 * np.linalg.norm(np.ptp(results.joints["elbow"]["point"], axis=0))
    assert certainty(results, LABELS).error("N·m") >= 0.99 * reach * certainty(results, LABELS).error("N")


def test_before_the_horizon_the_error_is_that_at_the_horizon() -> None:
    lost = {**ACCURATE, "horizon": 1.0, "estimate": {"motion": 0.3, "reactions": 5.0}}
    assert certainty(pendulum(T, accuracy=lost), LABELS).error("rad") == pytest.approx(1e-3, rel=0.1)


def test_errors_are_spoken_of_in_one_digit() -> None:
    assert [rough(x) for x in (3.4e-11, 0.0, 1e-3)] == ["3e-11", "0", "1e-3"]
