"""Prepare measured points: smooth out noise, differentiate, integrate, and estimate how sure the result is.

    smoothing     z minimises  sum w_i (y_i - z_i)^2 + lambda * integral of z''(x)^2 dx      (Reinsch 1967)
                  w_i: half the distance between the neighbours of x_i, so that uneven steps have one cut-off
                  an oscillation of frequency f keeps  1/(1 + (sqrt(2) - 1)(f/f_c)^4)  of its amplitude, without a
                  shift; f_c is the cut-off
    derivative    the slopes of the curve through the points
    integral      exact for the curve through the points, from 0 at the first one

The ends of a smoothing spline have no curvature. So the points are continued beyond: by their period, or by parabolas.
"""

from __future__ import annotations

import math
from array import array
from collections.abc import Sequence

import numpy as np

from heuncli.base.named_tuples import NamedTuple
from heuncli.base.records import replace
from heuncli.results.results import Array
from heuncli.scene.expressions.curves import COEFFICIENTS, SLOPES
from heuncli.scene.expressions.programs import TableFunction

CUT_OFF_SHARE = math.sqrt(2.0) - 1.0  # so that the amplitude at the cut-off is 1/sqrt(2)
MEMORY = 7.5  # cut-off periods after which a point has lost its influence, to rounding
ERROR_FACTOR = 3.0  # bounds the errors of noisy sines of all frequencies up to the cut-off (test_table_signals.py)
WINDOW, MIN_WINDOW = 0.5, 4  # cut-off periods, and points at least, to which the parabola at an end is fitted
MIN_POINTS = 8  # fewer can neither be smoothed, nor thinned out to estimate an error


class Integrals(NamedTuple):
    """The integral of a table at its points.

    values, slopes (n,): of the integral
    offset: what was taken out of y
    displacement: by how much drift would have moved the last value
    """

    values: Array
    slopes: Array
    offset: float
    displacement: float


# Smoothing


def smooth_points(x: Array, y: Array, cut_off: float, is_periodic: bool) -> Array:
    """Smooth points (n,) of ascending x by a low pass. With a period, the last point equals the first.

    cut_off: period [as x] of the oscillation that keeps 1/sqrt(2) of its amplitude; at least two steps
    """
    if is_periodic:
        period, count = x[-1] - x[0], len(x) - 1
        copies = math.ceil(MEMORY * cut_off / period)
        xs = np.concatenate([x[:-1] + k * period for k in range(-copies, copies + 1)])
        z = fit_smoothing_spline(xs, np.tile(y[:-1], 2 * copies + 1), cut_off)[copies * count : (copies + 1) * count]
        return np.append(z, z[0])
    step = float(np.median(np.diff(x)))
    away: Array = step * np.arange(1.0, math.ceil(MEMORY * cut_off / step) + 1.0)
    before = continue_points(-x[::-1], y[::-1], cut_off, away)[::-1]
    after = continue_points(x, y, cut_off, away)
    xs, ys = np.concatenate([x[0] - away[::-1], x, x[-1] + away]), np.concatenate([before, y, after])
    return fit_smoothing_spline(xs, ys, cut_off)[len(away) : len(away) + len(x)]


def continue_points(x: Array, y: Array, cut_off: float, away: Array) -> Array:
    """Return the values at distances beyond the last point, on the parabola fitted to the last cut-off period."""
    count = max(len(x) - int(np.searchsorted(x, x[-1] - WINDOW * cut_off)), MIN_WINDOW)
    powers = np.vander((x[-count:] - x[-1]) / cut_off, 3)
    return np.vander(away / cut_off, 3) @ np.linalg.lstsq(powers, y[-count:], rcond=None)[0]


def fit_smoothing_spline(x: Array, y: Array, cut_off: float) -> Array:
    """Compute the values (n,) of the natural smoothing spline by Reinsch's equations.

    (R + lambda Q' W^-1 Q) c = Q' y,  z = y - lambda W^-1 Q c,  c the second derivatives; lengths in median steps
    """
    from scipy.linalg import solveh_banded  # a fifth of a second, where a table is smoothed

    if len(x) < 3:
        return y
    step = float(np.median(np.diff(x)))
    h = np.diff(x) / step
    angle = 2.0 * math.pi * step / cut_off
    # exact for equal steps: of Q', R and W an oscillation has the eigenvalues -4 sin^2(angle/2), (2 + cos(angle))/3, 1
    penalty = CUT_OFF_SHARE * (2.0 + math.cos(angle)) / 3.0 / (2.0 * math.sin(0.5 * angle)) ** 4
    inverse_weights = 2.0 / np.concatenate([h[:1], h[1:] + h[:-1], h[-1:]])
    before, after = 1.0 / h[:-1], 1.0 / h[1:]
    here = -(before + after)
    scaled = penalty * inverse_weights
    diagonal = (h[:-1] + h[1:]) / 3.0 + before**2 * scaled[:-2] + here**2 * scaled[1:-1] + after**2 * scaled[2:]
    first = h[1:-1] / 6.0 + here[:-1] * scaled[1:-2] * before[1:] + after[:-1] * scaled[2:-1] * here[1:]
    second = after[:-2] * scaled[2:-2] * before[2:]
    bands = np.zeros((3, len(x) - 2))
    bands[0], bands[1, :-1], bands[2, :-2] = diagonal, first, second
    curvature = solveh_banded(bands, np.diff(np.diff(y) / h), lower=True, check_finite=False)
    bend = np.zeros(len(x))
    bend[:-2] += before * curvature
    bend[1:-1] += here * curvature
    bend[2:] += after * curvature
    return np.asarray(y - scaled * bend)


# Derivatives


def differentiate_points(x: Array, y: Array, curve: str, is_periodic: bool, times: int) -> Array:
    """Compute the first or second derivative (n,) of the curve through points, at these points.

    curve: a key of SLOPES
    """
    h = np.diff(x)
    for _ in range(times):
        d = np.diff(y) / h
        y = SLOPES[curve](x, h, d, is_periodic) if len(x) > 2 else np.repeat(d, 2)
    return y


def estimate_derivative_error(
    x: Array, y: Array, curve: str, is_periodic: bool, times: int, cut_off: float | None
) -> float | None:
    """Estimate the largest error of the derivative of points that are smoothed before, unless `cut_off` is None.

    It is three times how much the derivative changes if every second point is left out, or, if that is more, with half
    the period at the cut-off. None for too few points.
    """
    if len(x) < MIN_POINTS:
        return None
    smoothed = y if cut_off is None else smooth_points(x, y, cut_off, is_periodic)
    fine = differentiate_points(x, smoothed, curve, is_periodic, times)
    half = np.append(np.arange(0, len(x) - 2, 2), len(x) - 1)
    changes = [fine[half] - differentiate_points(x[half], smoothed[half], curve, is_periodic, times)]
    if cut_off is not None:
        is_fine = cut_off >= 4.0 * float(np.median(np.diff(x)))
        rough = smooth_points(x, y, 0.5 * cut_off, is_periodic) if is_fine else y
        changes.append(fine - differentiate_points(x, rough, curve, is_periodic, times))
    return ERROR_FACTOR * max(float(np.abs(change).max()) for change in changes)


# Integrals


def integrate_table(table: TableFunction, times: int, drift: str) -> Integrals:
    """Integrate the curve of a table once or twice.

    drift: keep; rest: without the mean of y, so that the first integral ends at 0 as it begins; mean: also without the
    mean of the first integral
    """
    numbers = np.frombuffer(table.numbers)
    x, y = numbers[1 : table.pieces + 2], np.frombuffer(table.y)
    c = numbers[table.pieces + 2 :].reshape(-1, COEFFICIENTS).T
    h, along = np.diff(x), x - x[0]
    first = accumulate(h * (c[0] + h * (c[1] / 2.0 + h * (c[2] / 3.0 + h * c[3] / 4.0))))
    own = h**2 * (c[0] / 2.0 + h * (c[1] / 6.0 + h * (c[2] / 12.0 + h * c[3] / 20.0)))
    second = accumulate(first[:-1] * h + own)
    offset = 0.0 if drift == "keep" else float(first[-1] / along[-1])
    drift_of_first, drift_of_second = offset * along, 0.5 * offset * along**2
    if drift == "mean":
        start = float((second[-1] - drift_of_second[-1]) / along[-1])
        drift_of_first, drift_of_second = drift_of_first + start, drift_of_second + start * along
    if times == 1:
        return Integrals(first - drift_of_first, y - offset, offset, float(offset * along[-1]))
    return Integrals(second - drift_of_second, first - drift_of_first, offset, float(drift_of_second[-1]))


def halve_pieces(table: TableFunction) -> TableFunction:
    """Return the same curve with a point in the middle of each piece; the same table where one is too short for it."""
    numbers, count = np.frombuffer(table.numbers), table.pieces
    x, (c0, c1, c2, c3) = numbers[1 : count + 2], numbers[count + 2 :].reshape(-1, COEFFICIENTS).T
    points = np.empty(2 * count + 1)
    points[::2], points[1::2] = x, x[:-1] + 0.5 * np.diff(x)
    if not (np.diff(points) > 0.0).all():
        return table
    h = points[1::2] - x[:-1]
    coefficients, y = np.empty((2 * count, COEFFICIENTS)), np.empty(2 * count + 1)
    coefficients[::2] = np.stack([c0, c1, c2, c3], axis=1)
    middles = [c0 + h * (c1 + h * (c2 + h * c3)), c1 + h * (2.0 * c2 + 3.0 * h * c3), c2 + 3.0 * h * c3, c3]
    coefficients[1::2] = np.stack(middles, axis=1)
    y[::2], y[1::2] = np.frombuffer(table.y), middles[0]
    halved = array("d", np.concatenate([numbers[:1], points, coefficients.ravel()]).tobytes())
    x_array, y_array = array("d", points.tobytes()), array("d", y.tobytes())
    return replace(table, pieces=2 * count, numbers=halved, x=x_array, y=y_array)


def find_deviation(table: TableFunction, values: Array) -> float:
    """Return the largest deviation of a table from values (4 n + 1,): at its points and at three places in each of its
    n pieces.
    """
    numbers, count = np.frombuffer(table.numbers), table.pieces
    h = np.diff(numbers[1 : count + 2])
    c = numbers[count + 2 :].reshape(-1, COEFFICIENTS).T
    rows = [np.polynomial.polynomial.polyval(share * h, c, tensor=False) - values[k:-1:4]
            for k, share in enumerate((0.0, 0.25, 0.5, 0.75))]  # fmt: skip
    return float(np.abs(rows).max())


def accumulate(parts: Sequence[float] | Array) -> Array:
    """Return the sums of the first 0, 1, ... parts."""
    return np.concatenate([[0.0], np.cumsum(parts)])
