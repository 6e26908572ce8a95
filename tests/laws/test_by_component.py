"""Vectors by component: the same bits as those of arrays whose instants come first."""

from __future__ import annotations

import numpy as np
import pytest

from heuncli.results.results import Array
from heuncli.scene.shapes.rotations import (
    bodies_contiguous,
    cross_components,
    instants_first,
    instants_last,
    largest_magnitude,
    quadratic_form,
    rotate_components,
    squared_lengths,
)  # fmt: skip

SHAPES = [(1, 1), (1, 7), (402, 2), (5, 40)]  # instants, bodies


def random_arrays(shape: tuple[int, int]) -> tuple[Array, Array, Array]:
    """Two families of vectors and one of matrices, of sizes that cancel and that do not."""
    rng = np.random.default_rng(sum(shape))
    a, b = (rng.normal(size=(*shape, 3)) * 10.0 ** rng.integers(-3, 4, size=(*shape, 3)) for _ in range(2))
    return a, b, rng.normal(size=(*shape, 3, 3))


@pytest.mark.parametrize("shape", SHAPES)
def test_to_the_bit(shape: tuple[int, int]) -> None:
    a, b, R = random_arrays(shape)
    J = R[0]
    x, y, A = instants_last(a), instants_last(b), instants_last(R)
    assert np.array_equal(instants_first(cross_components(x, y)), np.cross(a, b))
    assert np.array_equal(instants_first(squared_lengths(x)), np.sum(a * a, axis=-1))
    assert np.array_equal(largest_magnitude(x), np.abs(a).max(axis=(1, 2)))
    back = (R[..., 0, :] * a[..., [0]] + R[..., 1, :] * a[..., [1]]) + R[..., 2, :] * a[..., [2]]
    assert np.array_equal(instants_first(rotate_components(A, x, back=True)), back)
    forth = (R[..., 0] * a[..., [0]] + R[..., 2] * a[..., [2]]) + R[..., 1] * a[..., [1]]
    assert np.array_equal(instants_first(rotate_components(A, x)), forth)
    near = {"rtol": 1e-12, "atol": 1e-12 * float(np.abs(a).max()) ** 2}
    np.testing.assert_allclose(instants_first(quadratic_form(x, J)), np.einsum("tni,nij,tnj->tn", a, J, a), **near)
    np.testing.assert_allclose(forth, np.einsum("tnij,tnj->tni", R, a), **near)
    np.testing.assert_allclose(back, np.einsum("tnji,tnj->tni", R, a), **near)


def test_what_was_laid_by_rows_is_laid_back() -> None:
    a, _, R = random_arrays((6, 3))
    for values in (a, R, a[..., 0]):
        assert np.array_equal(instants_first(instants_last(values)), values)
        assert np.array_equal(bodies_contiguous(instants_last(values)), values)
