"""Tables of measured signals: smoothing, derivatives and integrals against closed forms, SciPy, and what is said."""

from __future__ import annotations

import itertools
import math
from pathlib import Path

import numpy as np
import pytest
from numpy.typing import NDArray
from scipy.interpolate import PPoly, make_smoothing_spline

from heuncli.base import tolerances
from heuncli.base.errors import SpecError
from heuncli.scene.expressions.measured_signals import (
    differentiate_points,
    estimate_derivative_error,
    fit_smoothing_spline,
    smooth_points,
)
from heuncli.scene.expressions.programs import TableFunction
from heuncli.scene.file_format.load import load
from heuncli.scene.file_format.models import Spec
from heuncli.study.workflow import solve
from tests.shared.scenes import near

Array = NDArray[np.float64]
BODY = "heun: 1\nbodies: {b: {mass: 1, center: [0, 0, 0], inertia: [1, 1, 1]}}\n"
STEPS = 400


def read(x: Array, y: Array, keys: str) -> Spec:
    points = f"x: {x.tolist()!r}, y: {y.tolist()!r}"
    return load("spec.yaml", BODY + f"tables:\n  f: {{{points}, {keys}}}\n")


def table(x: Array, y: Array, keys: str) -> TableFunction:
    return read(x, y, keys).tables["f"]


def values(found: TableFunction) -> Array:
    return np.array(found.y)


def refused(x: Array, y: Array, keys: str) -> tuple[str, str, str]:
    with pytest.raises(SpecError) as caught:
        read(x, y, keys)
    (problem,) = caught.value.problems
    assert problem.location is not None
    return problem.location.path.removeprefix("tables.f."), problem.code, problem.hint or ""


# Smoothing


@pytest.mark.parametrize("times_cut_off", [0.1, 0.3, 0.5, 1.0, 2.0, 4.0])
@pytest.mark.parametrize("periodic", [False, True])
def test_an_oscillation_keeps_the_stated_part_of_its_amplitude_and_its_phase(
    times_cut_off: float, periodic: bool
) -> None:
    x = np.linspace(0.0, 10.0, 10 * STEPS + 1)
    y = np.sin(2.0 * math.pi * times_cut_off * x + 0.3)  # cut-off at 1 Hz, 400 steps a period
    y[-1] = y[0] if periodic else y[-1]
    found = values(table(x, y, "smooth: 1 Hz, x_unit: s" + (", period: 10 s" if periodic else "")))
    kept = 1.0 / (1.0 + (math.sqrt(2.0) - 1.0) * times_cut_off**4)
    inner = slice(0, None) if periodic else slice(3 * STEPS, -3 * STEPS)
    near(found[inner], kept * y[inner], 1.0, 2e-5)


@pytest.mark.parametrize("steps", [2.0, 2.5, 3.0, 7.0])
def test_the_amplitude_at_the_cut_off_is_exact_on_few_steps_a_period(steps: float) -> None:
    x = np.arange(600.0)
    y = np.cos(2.0 * math.pi * x / steps)
    near(smooth_points(x, y, steps, False)[200:400], y[200:400] / math.sqrt(2.0), 1.0, 1e-6)


def test_noise_is_taken_out_and_the_notes_say_how_much() -> None:
    rng = np.random.default_rng(5)
    x = np.linspace(0.0, 2.0, 2001)
    clean, noise = 3.0 * np.sin(2.0 * math.pi * x), 0.1 * rng.normal(size=len(x))
    found = table(x, clean + noise, "smooth: 20 Hz, x_unit: s, y_unit: N")
    left = values(found) - clean
    # white noise keeps the part  integral of H^2 df / (half the sampling rate) = 20 Hz * 1.14 / 500 Hz of its power
    assert 0.6 < math.sqrt(float(np.mean(left**2))) / (0.1 * math.sqrt(20.0 * 1.14 / 500.0)) < 1.5
    (note,) = found.notes
    removed = float(note.partition("takes out ")[2].partition(" N (rms)")[0])
    assert "cut-off 20 Hz, period 0.05 s" in note and abs(removed - 0.0977) < 0.005


def test_parabolas_stay_as_they_are_to_the_ends() -> None:
    x = (np.arange(300.0) + np.random.default_rng(1).uniform(-0.4, 0.4, 300)) / 75.0
    y = 3.0 - 2.0 * x + 5.0 * x**2
    near(smooth_points(x, y, 0.4, False), y, 80.0, 1e-11)


def test_the_spline_is_that_of_scipy_on_uneven_steps() -> None:
    rng = np.random.default_rng(2)
    x = np.arange(300.0) + rng.uniform(-0.4, 0.4, 300)
    y = np.sin(x / 9.0) + 0.1 * rng.normal(size=300)
    h, cut_off = np.diff(x), 12.0
    weights = np.concatenate([h[:1], h[1:] + h[:-1], h[-1:]]) / 2.0
    step = float(np.median(h))
    angle = 2.0 * math.pi * step / cut_off
    penalty = (math.sqrt(2.0) - 1.0) * (2.0 + math.cos(angle)) / 3.0 / (2.0 * math.sin(angle / 2.0)) ** 4 * step**4
    near(fit_smoothing_spline(x, y, cut_off), make_smoothing_spline(x, y, w=weights, lam=penalty)(x), 1.0, 1e-10)


def test_the_cut_off_is_a_period_or_a_frequency() -> None:
    x = np.linspace(0.0, 1.0, 101)
    y = np.cos(40.0 * x)
    one, other, third = (
        table(x, y, f"smooth: {cut_off}, x_unit: s") for cut_off in ("40 ms", "25 Hz", "0.025 kHz")
    )  # fmt: skip
    near(values(one), values(other), 1.0, 1e-15)
    near(values(third), values(other), 1.0, 1e-15)
    turned = table(x, y, "smooth: 20 deg, x_unit: rad")
    assert "cut-off period 0.349" in turned.notes[0] or "Hz" not in turned.notes[0]


# Derivatives


@pytest.mark.parametrize("curve", ["cubic", "pchip"])
def test_the_derivative_of_a_line_and_the_two_of_a_parabola_are_exact(curve: str) -> None:
    x = np.array([0.0, 0.1, 0.25, 0.3, 0.5, 0.6, 0.9, 1.0, 1.2, 1.3])
    near(values(table(x, 2.0 - 3.0 * x, f"derivative: 1, interpolation: {curve}")), -3.0, 3.0, 1e-13)
    if curve == "cubic":
        parabola = 1.0 - 2.0 * x + 5.0 * x**2
        near(values(table(x, parabola, "derivative: 1, interpolation: cubic")), 10.0 * x - 2.0, 10.0, 1e-13)
        near(values(table(x, parabola, "derivative: 2, interpolation: cubic")), 10.0, 10.0, 1e-11)


def test_the_derivative_of_a_periodic_sine_is_its_cosine() -> None:
    x = np.linspace(0.0, 2.0 * math.pi, 201)
    y = np.sin(x)
    y[-1] = y[0]
    keys = f"interpolation: cubic, period: {2.0 * math.pi!r}"
    first, second = (values(table(x, y, f"derivative: {times}, {keys}")) for times in (1, 2))
    near(first, np.cos(x), 1.0, 1e-7)
    near(second, -np.sin(x), 1.0, 1e-6)


@pytest.mark.parametrize("seed", range(6))
@pytest.mark.parametrize("cut_off", [None, 0.1, 0.3, 1.0])
@pytest.mark.parametrize("times", [1, 2])
@pytest.mark.parametrize("noise", [0.0, 1e-4, 0.01])
def test_the_stated_error_of_a_derivative_bounds_the_true_one(
    seed: int, cut_off: float | None, times: int, noise: float
) -> None:
    rng = np.random.default_rng(seed)
    x = np.linspace(0.0, 4.0, 401)
    rate = 1.0 + seed
    y = np.sin(rate * x) + noise * rng.normal(size=len(x))
    true = rate * np.cos(rate * x) if times == 1 else -(rate**2) * np.sin(rate * x)
    smoothed = y if cut_off is None else smooth_points(x, y, cut_off, False)
    error = float(np.abs(differentiate_points(x, smoothed, "cubic", False, times) - true).max())
    stated = estimate_derivative_error(x, y, "cubic", False, times, cut_off)
    assert stated is not None and error <= stated <= 30.0 * error


@pytest.mark.parametrize("cut_off", [None, 0.3, 0.6])
@pytest.mark.parametrize(("curve", "times"), [("pchip", 1), ("natural", 1), ("cubic", 1)])
@pytest.mark.parametrize("count", [10, 20, 200])
def test_the_stated_error_holds_the_one_of_the_curve_between_uneven_points_too(
    cut_off: float | None, curve: str, times: int, count: int
) -> None:
    """A smoothed signal whose curve through the points is the coarser part: flat at peaks, straight at its ends.

    It is an estimate: of a few points far apart, smoothed over half of the record, one signal in eight may exceed it.
    """
    ratios = []
    for seed in range(8):
        rng = np.random.default_rng(seed)
        x = np.sort(np.concatenate([[0.0, 1.0], rng.uniform(0.0, 1.0, count - 2)]))
        rate = 2.0 * math.pi * rng.uniform(0.3, 0.9)
        y = np.sin(rate * x + seed)
        true = rate * np.cos(rate * x + seed) if times == 1 else -(rate**2) * np.sin(rate * x + seed)
        smoothed = y if cut_off is None else smooth_points(x, y, cut_off, False)
        error = float(np.abs(differentiate_points(x, smoothed, curve, False, times) - true).max())
        stated = estimate_derivative_error(x, y, curve, False, times, cut_off)
        assert stated is not None
        ratios.append(error / stated)
    exceeded = [ratio for ratio in ratios if ratio > 1.0]
    assert len(exceeded) <= (0 if cut_off is None or count == 200 else 1)
    assert max(ratios) < 1.5


def test_a_derivative_too_noisy_is_warned_of_and_its_error_stands_in_the_notes() -> None:
    rng = np.random.default_rng(3)
    x = np.linspace(0.0, 1.0, 501)
    y = np.sin(6.0 * x) + 1e-3 * rng.normal(size=len(x))
    keys = "derivative: 1, interpolation: cubic, x_unit: s, y_unit: mm"
    (warning,) = read(x, y, keys).warnings
    assert warning.code == "table-derivative" and warning.location is not None
    assert warning.location.path == "tables.f.derivative"
    calm = read(x, y, f"{keys}, smooth: 5 Hz")
    assert not calm.warnings and " m/s" in calm.tables["f"].notes[1]
    assert calm.tables["f"].dimensions == ((0, 0, 1), (0, 1, -1))
    few = read(x[:6], x[:6] ** 2, keys)
    assert "too few points" in few.warnings[0].message


# Integrals


def test_a_known_acceleration_with_an_offset_gives_its_path_back() -> None:
    t = np.linspace(0.0, 2.0, 2001)
    a = np.sin(2.0 * math.pi * t)
    path = t / (2.0 * math.pi) - np.sin(2.0 * math.pi * t) / (4.0 * math.pi**2)
    found = table(t, a + 0.05, "integral: 2, drift: rest, interpolation: cubic, x_unit: s, y_unit: m/s^2")
    near(values(found), path, 0.3, 1e-11)  # (2 pi h)^4/720 = 2e-12
    assert found.dimensions[1] == (0, 1, 0)
    assert "offset 0.05 m/s^2" in found.notes[0] and "moved the end by 0.1 m" in found.notes[0]
    kept = table(t, a + 0.05, "integral: 2, interpolation: cubic")
    near(values(kept), path + 0.025 * t**2, 0.5, 1e-11)
    assert "no drift taken out" in kept.notes[0]


@pytest.mark.parametrize("times", [1, 2])
def test_a_linear_law_is_integrated_exactly_between_its_points_too(times: int) -> None:
    t = np.array([0.0, 0.4, 1.0, 1.5])
    a = np.array([1.0, 3.0, -2.0, 0.0])
    found = table(t, a, f"integral: {times}")
    numbers = np.frombuffer(found.numbers)
    pieces = numbers[found.pieces + 2 :].reshape(-1, 4)
    level = speed = 0.0
    for (value, slope), (start, end), piece in zip(
        zip(a, np.diff(a) / np.diff(t), strict=False), itertools.pairwise(t), pieces, strict=True
    ):  # fmt: skip
        h = np.linspace(0.0, end - start, 7)
        v = speed + value * h + slope * h**2 / 2.0
        s = level + speed * h + value * h**2 / 2.0 + slope * h**3 / 6.0
        near(np.polyval(piece[::-1], h), v if times == 1 else s, 1.0, 1e-14)
        speed, level = float(v[-1]), float(s[-1])


def make_polynomial(found: TableFunction) -> PPoly:
    numbers = np.frombuffer(found.numbers)
    knots, pieces = numbers[1 : found.pieces + 2], numbers[found.pieces + 2 :].reshape(-1, 4)
    return PPoly(pieces[:, ::-1].T, knots)


@pytest.mark.parametrize("times", [1, 2])
@pytest.mark.parametrize(
    "keys",
    ["linear", "cubic", "cubic, ends: natural", "pchip", "cubic, drift: mean", "cubic, period: 1.5, drift: mean"],
)
@pytest.mark.parametrize("count", [2, 3, 4, 9])
def test_the_integral_of_a_curve_through_few_points_is_right_between_them(keys: str, times: int, count: int) -> None:
    """As of 2 x through two points, whose integral at x = 0.5 is 0.25, not 0.5."""
    x = np.sort(np.array([0.0, 1.5, 0.2, 0.45, 0.5, 0.7, 0.8, 1.1, 1.3])[:count])
    y = np.cos(3.0 * x)
    if "period" in keys:
        y[-1] = y[0]
    curve = make_polynomial(table(x, y, f"interpolation: {keys.split(', drift')[0]}"))
    at = np.linspace(0.0, 1.5, 301)
    mean = curve.integrate(0.0, 1.5) / 1.5 if "mean" in keys else 0.0
    first, second = curve.antiderivative(1)(at) - mean * at, curve.antiderivative(2)(at) - 0.5 * mean * at**2
    start = second[-1] / 1.5 if "mean" in keys else 0.0
    true = first - start if times == 1 else second - start * at
    found = make_polynomial(table(x, y, f"integral: {times}, interpolation: {keys}"))
    near(found(at), true, float(np.ptp(true)) or 1.0, 2e-9)


def test_a_vibration_keeps_neither_offset_nor_mean_speed() -> None:
    t = np.linspace(0.0, 3.0, 3001)
    w = 2.0 * math.pi
    a = np.cos(w * t + 0.4)  # its speed sin(w t + 0.4)/w begins with sin(0.4)/w
    a[-1] = a[0]
    for period in ("", ", period: 3"):
        first = values(table(t, a + 0.2, f"integral: 1, drift: mean, interpolation: cubic{period}"))
        second = values(table(t, a + 0.2, f"integral: 2, drift: mean, interpolation: cubic{period}"))
        near(first, np.sin(w * t + 0.4) / w, 0.2, 1e-7)
        near(second, (math.cos(0.4) - np.cos(w * t + 0.4)) / w**2, 0.05, 1e-7)


def test_a_slide_driven_by_measured_acceleration_needs_the_force_that_it_says(tmp_path: Path) -> None:
    t = np.linspace(0.0, 1.0, 1001)
    rows = "".join(
        f"{x:.4f},{y!r}\n" for x, y in zip(t, (10.0 * np.sin(2.0 * math.pi * t) + 0.3).tolist(), strict=True)
    )
    (tmp_path / "bench.csv").write_text(f"t [s],a [m/s^2]\n{rows}")
    text = """heun: 1
tables: {path: {file: bench.csv, x: t, y: a, integral: 2, drift: rest, interpolation: cubic}}
ground: {points: {o: [0, 0, 0]}}
bodies: {b: {mass: 2, center: [0, 0, 0], inertia: [1, 1, 1], points: {p: [0, 0, 0]}}}
joints: {guide: {type: slide, from: ground.o, to: b.p, axis: [1, 0, 0]}}
drives: {motor: {joint: guide, travel: "table(path, t)"}}
analysis: {duration: 1, samples: 5}
"""
    (tmp_path / "spec.yaml").write_text(text)
    results = solve(load(tmp_path / "spec.yaml")).results
    near(results.joints["guide"]["drive"], 20.0 * np.sin(2.0 * math.pi * np.linspace(0.0, 1.0, 5)), 20.0, 2e-5)
    assert any("table path: integrated twice" in note for note in results.model["notes"])


# What is refused

X = np.linspace(0.0, 1.0, 11)
REFUSED = {
    "derivative: 3, interpolation: cubic": ("derivative", "table-form", "1 or 2"),
    "integral: 0": ("integral", "table-form", "1 or 2"),
    "derivative: 1": ("derivative", "table-form", "cubic"),
    "derivative: 2, interpolation: pchip": ("derivative", "table-form", "cubic"),
    "derivative: 1, integral: 1, interpolation: cubic": ("integral", "table-form", "one of them"),
    "drift: rest": ("drift", "table-form", "integral: 1"),
    "smooth: 0": ("smooth", "table-form", "above 0"),
    "smooth: 0 Hz": ("smooth", "table-form", "above 0"),
    "smooth: 0.19": ("smooth", "table-form", "longer period"),
    "smooth: 1.1": ("smooth", "table-form", "shorter period"),
    "smooth: 20 ms, x_unit: deg": ("smooth", "dimension", "unit of x"),
    "smooth: 20 Hz, x_unit: mm": ("smooth", "dimension", "unit of x"),
    "smooth: 20 rpm": ("smooth", "table-form", "shorter period"),
}


@pytest.mark.parametrize("keys", REFUSED)
def test_what_makes_no_signal_is_refused(keys: str) -> None:
    path, code, hint = REFUSED[keys]
    found = refused(X, X**2, keys)
    assert found[:2] == (path, code) and hint in found[2]


def test_a_few_points_are_not_smoothed() -> None:
    assert refused(X[:7], X[:7] ** 2, "smooth: 0.3") == ("smooth", "table-form", "give at least 8 points")


def test_the_integral_of_a_periodic_table_needs_its_mean_taken_out() -> None:
    assert refused(X, np.sin(2.0 * math.pi * X).round(12), "integral: 1, period: 1") == (
        "integral", "table-form", "write drift: mean",
    )  # fmt: skip


@pytest.mark.heavy
def test_a_cut_off_of_more_steps_than_digits_allow_is_refused() -> None:
    x = np.linspace(0.0, 1.0, 21 * 10**4)
    with pytest.raises(SpecError, match="longer than 100000 of its steps"):
        read(x, x, "smooth: 0.5")


def test_the_threshold_of_the_warning_is_a_part_of_the_largest_value() -> None:
    assert tolerances.DERIVATIVE_ERROR == 0.1
