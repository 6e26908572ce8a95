"""No more digits than the run can stand behind."""

from __future__ import annotations

import math

import numpy as np
import pytest

from heuncli.study.quantities.digits import (
    choose_style,
    find_stated_errors,
    format_error,
    trim_zeros,
    write_numbers,
    write_times,
)
from tests.shared.fakes import ACCURATE, LABELS, MAGNITUDES, pendulum

T = np.linspace(0.0, 2.0, 11)


@pytest.mark.parametrize("seed", range(50))
def test_what_is_printed_is_right_to_one_unit_of_the_last_place_and_certain(seed: int) -> None:
    random = np.random.default_rng(seed)
    scale = 10.0 ** random.uniform(-9.0, 9.0)
    error = scale * 10.0 ** random.uniform(-13.0, 0.5)
    values = scale * random.uniform(-1.0, 1.0, 5)
    how = choose_style(float(np.abs(values).max()), error)
    for value, text in zip(values, write_numbers(values.tolist(), how), strict=True):
        if text == "?":
            assert np.abs(values).max() < 5.0 * error
            continue
        mantissa, _, exponent = text.partition("e")
        digits = mantissa.replace("-", "").replace(".", "").lstrip("0")
        last = 10.0 ** (int(exponent or 0) - len(mantissa.partition(".")[2]))
        assert len(digits) <= 8
        assert abs(float(text) - value) <= 0.51 * max(last, 10.0 * error)
        if text != "0" and "." in mantissa and len(trim_zeros([text])[0]) == len(text):
            assert last >= 0.99 * error


def test_engineers_numbers() -> None:
    assert write_numbers([33.99999999999997, -0.5], choose_style(34.0, 1e-12)) == ["34.0", "-0.5"]
    assert write_numbers([9.81, 1e-13], choose_style(9.81, 1e-12)) == ["9.81", "0"]
    assert write_numbers([49.05, -3.7e-7], choose_style(49.05, 0.0)) == ["49.05", "0"]
    assert write_numbers([123456789.0], choose_style(123456789.0, 0.0)) == ["1.23457e+08"]
    assert write_numbers([2.0e-7], choose_style(2.0e-7, 0.0)) == ["2.00000e-07"]
    assert write_numbers([math.nan, math.inf, 1.0], choose_style(1.0, 0.0)) == ["open", "unbounded", "1.0"]


def test_an_error_as_large_as_the_number_leaves_nothing() -> None:
    assert write_numbers([3.0, -2.0], choose_style(3.0, 5.0)) == ["?", "?"]
    assert write_numbers([3.0, -2.0, 0.0], choose_style(3.0, 3.0)) == ["?", "?", "0"]
    assert write_numbers([math.nan, math.inf], choose_style(3.0, 5.0)) == ["open", "unbounded"]


def test_a_number_is_never_0_where_its_family_has_no_certain_digit() -> None:
    """49 certain to 30 would round to no hundreds."""
    assert write_numbers([49.0, 3.0], choose_style(49.0, 30.0)) == ["?", "?"]
    assert write_numbers([490.0, 3.0], choose_style(490.0, 30.0)) == ["5e+02", "0"]


def test_what_is_rounding_of_its_sum_is_0_and_not_unknown() -> None:
    assert write_numbers([6.4e-16, 0.0, -1e-17], choose_style(6.4e-16, 1e-12, 1e-12)) == ["0", "0", "0"]
    assert write_numbers([2e-12, 1e-13], choose_style(2e-12, 1e-9, 1e-12)) == ["?", "0"]
    assert write_numbers([2e-12, 1e-13], choose_style(2e-12, 1e-12, 1e-12)) == ["2e-12", "0"]


def test_common_zeros_go_but_one_decimal_stays() -> None:
    assert trim_zeros(["34.0000", "0", "open"]) == ["34.0", "0", "open"]
    assert trim_zeros(["1.2500", "3.0000"]) == ["1.25", "3.00"]
    assert trim_zeros(["1200", "34"]) == ["1200", "34"]


def test_instants_are_told_to_a_hundred_thousandth_of_the_run() -> None:
    assert write_times([0.0, 1.0 / 3.0, 2.0], 2.0) == ["0", "0.3333", "2.0"]
    assert write_times([1.0 / 3.0], 0.02) == ["0.333333"]
    assert write_times([0.25], 0.0) == ["0.25"]


def test_the_error_of_loads_is_relative_to_the_largest_of_their_kind() -> None:
    results = pendulum(T)
    errors = find_stated_errors(results, LABELS, MAGNITUDES)
    largest = results.joints["pivot"]["force"].max()
    assert errors.error_of("reactions", "N") == pytest.approx(ACCURATE["estimate"]["reactions"] * largest, rel=0.01)
    assert errors.error_of("motion", "rad") == pytest.approx(ACCURATE["estimate"]["motion"], rel=0.01)
    assert errors.error_of("motion", "furlong") == 0.0


def test_each_kind_of_loads_has_its_own_error() -> None:
    kinds = {"reactions": 1e-3, "foundation": 1e-4, "sections": 1e-5, "drives": 1e-6}
    errors = find_stated_errors(pendulum(T, accuracy={**ACCURATE, "estimate": kinds}), LABELS, MAGNITUDES)
    certain = [errors.error_of(kind, "N") for kind in ("reactions", "foundation", "sections")]
    assert certain[0] > 5.0 * certain[1] > 25.0 * certain[2] > 0.0


def test_a_moment_is_no_more_certain_than_a_force_on_its_arm() -> None:
    errors = find_stated_errors(pendulum(T), LABELS, MAGNITUDES)
    assert errors.error_of("reactions", "N·m") >= MAGNITUDES.size * errors.error_of("reactions", "N")


def test_errors_that_a_check_run_found_go_first() -> None:
    found = {("reactions", "N"): 0.25, ("motion", "m/s²"): 0.5}
    errors = find_stated_errors(pendulum(T), LABELS, MAGNITUDES._replace(errors=found))
    assert errors.error_of("reactions", "N") == 0.25
    assert errors.error_of("motion", "m/s²") == 0.5
    assert errors.error_of("motion", "m") == pytest.approx(ACCURATE["estimate"]["motion"] * MAGNITUDES.size)


def test_a_stress_is_as_uncertain_as_the_loads_that_make_it() -> None:
    cut = {"N": 100.0 + T, "M2": 3.0 * T, "stress": {"normal_max": 5e6 + T}, "open": []}
    found = {("sections", "N"): 0.0, ("sections", "N·m"): 0.25}
    errors = find_stated_errors(pendulum(T, sections={"a": cut}), LABELS, MAGNITUDES._replace(errors=found))
    assert errors.error_of("sections", "Pa") == pytest.approx(5e6 / 102.0 * 0.25 / MAGNITUDES.size, rel=1e-3)


def test_before_the_horizon_the_error_is_that_at_the_horizon() -> None:
    lost = {**ACCURATE, "horizon": 1.0, "estimate": {"motion": 0.3, "reactions": 5.0}}
    errors = find_stated_errors(pendulum(T, accuracy=lost), LABELS, MAGNITUDES)
    assert errors.error_of("motion", "rad") == pytest.approx(1e-3, rel=0.1)


def test_beyond_the_horizon_nothing_is_certain() -> None:
    lost = {**ACCURATE, "horizon": 1.0, "estimate": {"motion": 0.3, "reactions": 5.0}}
    errors = find_stated_errors(pendulum(T + 1.0, accuracy=lost), LABELS, MAGNITUDES)
    assert errors.choose_style("reactions", "N", 49.0).write(49.0) == "?"


def test_errors_are_spoken_of_in_one_digit() -> None:
    assert [format_error(x) for x in (3.4e-11, 0.0, 1e-3)] == ["3e-11", "0", "1e-3"]
