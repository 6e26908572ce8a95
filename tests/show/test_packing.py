"""Columns of a page are read back to half a step of their largest number; open and constant ones as they are."""

from __future__ import annotations

import numpy as np
import pytest

from heuncli.output.web_page.packing import (
    NUMBER_STEPS,
    POINT_STEPS,
    encode_data,
    pack_exact,
    pack_points,
    pack_values,
)
from heuncli.results.results import Array
from tests.shared.moving_pages import decoded, unpacked

RANDOM = np.random.default_rng(7)
T = np.linspace(0.0, 6.0, 301)
COLUMNS = {
    "smooth": 1e4 * np.sin(T), "noise": RANDOM.normal(size=301), "jumps": np.where(T > 3.0, 1e6, -2.0),
    "wide": 10.0 ** RANDOM.uniform(-12, 9, 301), "tiny": 1e-290 * np.cos(T), "huge": 1e290 * np.cos(T),
}  # fmt: skip


def read(packed: object, count: int) -> Array:
    """A packed column as a page holds it."""
    return unpacked(decoded(encode_data({"column": packed}))["column"], count)


@pytest.mark.parametrize("name", COLUMNS)
def test_a_column_is_kept_to_half_a_step_of_its_largest_number(name: str) -> None:
    values = COLUMNS[name]
    half = 0.5 * np.abs(values).max() / NUMBER_STEPS
    np.testing.assert_allclose(read(pack_values(values), 301), values, rtol=0.0, atol=half * (1 + 1e-9))


def test_a_small_component_is_kept_as_finely_as_the_largest_of_its_vector() -> None:
    values = 1e-3 * np.sin(T)
    found = read(pack_values(values, largest=10.0), 301)
    assert 0.0 < np.abs(found - values).max() <= 0.5 * 10.0 / NUMBER_STEPS * (1 + 1e-9)


@pytest.mark.parametrize("lag", [1, 3, 7])
def test_numbers_of_several_places_are_kept(lag: int) -> None:
    values = np.sin(T[:, None] + np.arange(lag)) * 10.0 ** np.arange(lag)
    found = read(pack_values(values, lag), values.size).reshape(values.shape)
    np.testing.assert_allclose(found, values, rtol=0.0, atol=0.5 * np.abs(values).max() / NUMBER_STEPS * (1 + 1e-9))


def test_what_is_drawn_far_from_the_origin_is_kept_to_a_part_of_its_own_range() -> None:
    points = np.stack([50.0 + np.sin(T), np.cos(T), 0.0 * T], axis=1)
    found = read(pack_points(points), points.size).reshape(points.shape)
    np.testing.assert_allclose(found, points, rtol=0.0, atol=2.0 / POINT_STEPS)


def test_open_numbers_stay_open_and_constants_are_one_number() -> None:
    values = np.where(T > 2.0, np.nan, 3.7 * np.sin(T))
    found = read(pack_values(values), 301)
    np.testing.assert_allclose(found, values, rtol=6e-8)
    assert np.isnan(found).sum() == np.isnan(values).sum() > 0
    assert pack_values(np.full(301, 0.1)) == 0.1


def test_instants_keep_all_their_digits() -> None:
    times = np.sort(RANDOM.uniform(size=100))
    np.testing.assert_array_equal(read(pack_exact(times), 100), times)


def test_smooth_columns_take_few_bytes() -> None:
    text = encode_data([pack_values(np.sin(T + k)) for k in range(50)])
    assert len(text) < 3 * 50 * 301  # of 8 bytes, 10.7 as base64
