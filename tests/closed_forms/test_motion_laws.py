"""Motion laws and profiles: the literature's accelerations integrated anew, its peak factors, and what is refused."""

from __future__ import annotations

import math
from collections.abc import Callable
from itertools import pairwise
from random import Random
from typing import Any

import mpmath
import numpy as np
import pytest

from heuncli.base.errors import Finding, SpecError
from heuncli.scene.expressions.discontinuities import find_discontinuities
from heuncli.scene.expressions.grammar import compile_expression
from heuncli.scene.expressions.motion_laws import LAWS
from heuncli.scene.expressions.programs import Expression
from heuncli.scene.expressions.scope import Scope
from tests.shared.scenes import solved

PI = math.pi
TRAPEZOID, SINE = mpmath.mpf(8) * mpmath.pi / (2 + mpmath.pi), 4 * mpmath.pi**2 / (4 + mpmath.pi)


def modified_trapezoid(x: Any) -> Any:
    """Return the acceleration of a modified trapezoid: quarters of sines of period 1/2 between constants."""
    if x > 0.5:
        return -modified_trapezoid(1 - x)
    if x < 0.125:
        return TRAPEZOID * mpmath.sin(4 * mpmath.pi * x)
    return TRAPEZOID if x < 0.375 else TRAPEZOID * mpmath.cos(4 * mpmath.pi * (x - 0.375))


def modified_sine(x: Any) -> Any:
    """Return the acceleration of a modified sine: quarters of a sine of period 1/2 about one of period 3/2."""
    if x < 0.125 or x > 0.875:
        return SINE * mpmath.sin(4 * mpmath.pi * x)
    return SINE * mpmath.cos(4 * mpmath.pi / 3 * (x - 0.125))


# Of each law: the acceleration, its breaks, and the largest velocity, acceleration and jerk (Norton; VDI 2143).
REFERENCES: dict[str, tuple[Callable[[Any], Any], list[float], tuple[float, float, float]]] = {
    "cycloid": (lambda x: 2 * mpmath.pi * mpmath.sin(2 * mpmath.pi * x), [], (2.0, 2 * PI, 4 * PI**2)),
    "modsine": (modified_sine, [0.125, 0.875], (4 * PI / (4 + PI), 4 * PI**2 / (4 + PI), 16 * PI**3 / (4 + PI))),
    "modtrap": (modified_trapezoid, [0.125, 0.375, 0.625, 0.875], (2.0, 8 * PI / (2 + PI), 32 * PI**2 / (2 + PI))),
    "poly345": (lambda x: 60 * x * (1 - x) * (1 - 2 * x), [], (1.875, 10 / math.sqrt(3), 60.0)),
    "poly4567": (lambda x: 420 * (x * (1 - x)) ** 2 * (1 - 2 * x), [], (2.1875, 84 * math.sqrt(5) / 25, 52.5)),
}
PRINTED = {  # the factors as handbooks print them
    "cycloid": (2.000, 6.283, 39.478), "modsine": (1.760, 5.528, 69.466), "modtrap": (2.000, 4.888, 61.426),
    "poly345": (1.875, 5.774, 60.000), "poly4567": (2.188, 7.513, 52.500),
}  # fmt: skip
SCOPE = Scope(parameters={}, joints={"guide": "slide"}, in_time=True)


def read(text: str) -> Expression:
    """Compile an expression in time."""
    return compile_expression(text, SCOPE)


def test_each_law_has_a_reference() -> None:
    assert LAWS.keys() == REFERENCES.keys() == PRINTED.keys()


@pytest.mark.parametrize("name", REFERENCES)
def test_a_law_is_its_acceleration_integrated_twice(name: str) -> None:
    """At random places: f by the mean of f'' (x - z), f' by its integral, to the rounding of 4-5-6-7's coefficients."""
    acceleration, breaks, _ = REFERENCES[name]
    law, random = read(f"{name}(t)"), Random(5)
    with mpmath.workdps(30):
        for x in [*(random.random() for _ in range(10)), *breaks, 1e-3, 0.999, 1.0]:
            nodes = [0.0, *(b for b in breaks if b < x), x]
            value = mpmath.quad(lambda z: acceleration(z) * (x - z), nodes)  # noqa: B023 (called at once)
            rate = mpmath.quad(acceleration, nodes)
            found = law.derivatives(x)
            assert found[0] == pytest.approx(float(value), abs=5e-14), x
            assert found[1] == pytest.approx(float(rate), abs=3e-13), x
            assert found[2] == pytest.approx(float(acceleration(mpmath.mpf(x))), abs=2e-12), x
    assert [law.derivatives(t) for t in (-3.0, 1.0, 7.5)] == [(0.0, 0.0, 0.0), (1.0, 0.0, 0.0), (1.0, 0.0, 0.0)]


@pytest.mark.parametrize("name", REFERENCES)
def test_the_rate_integrates_to_the_rise(name: str) -> None:
    breaks = [0.0, *REFERENCES[name][1], 1.0]
    law = read(f"{name}(t)")
    nodes, weights = np.polynomial.legendre.leggauss(40)
    total = sum(
        0.5 * (b - a) * weight * law.derivatives(a + 0.5 * (b - a) * (1.0 + x))[1]
        for a, b in pairwise(breaks)
        for x, weight in zip(nodes, weights, strict=True)
    )
    assert total == pytest.approx(1.0, abs=1e-14)


@pytest.mark.parametrize("name", REFERENCES)
def test_peak_factors_are_those_of_the_literature(name: str) -> None:
    law, (_, breaks, factors) = read(f"{name}(t)"), REFERENCES[name]
    grid = sorted({*np.linspace(0.0, 1.0, 100_001)[:-1], *breaks})
    _, rate, second = (np.array(column) for column in law.sample_derivatives(grid))
    jerk = np.diff(second) / np.diff(grid)
    found = rate.max(), np.abs(second).max(), np.abs(jerk).max()
    assert found == pytest.approx(factors, rel=1e-4)
    assert factors == pytest.approx(PRINTED[name], abs=6e-4)
    assert rate.max() <= factors[0] * (1.0 + 1e-15)


@pytest.mark.parametrize("name", REFERENCES)
def test_breaks_are_found_and_bounds_hold(name: str) -> None:
    law, random = read(f"{name}((t - 0.3)/0.7)"), Random(8)
    ends = [0.3 + 0.7 * x for x in (0.0, *REFERENCES[name][1], 1.0)]
    found = find_discontinuities(law, 0.0, 2.0)
    assert all(min(abs(t - end) for end in ends) < 1e-14 for t in found)
    assert all(min(abs(t - end) for t in found) < 1e-14 for end in ends)
    for _ in range(200):
        begin = 1.4 * random.random() - 0.1
        end = begin + 0.3 * random.random() ** 3
        (low,), (high,) = law.bounds([begin], [end])
        values = [law.value(begin + (end - begin) * random.random()) for _ in range(20)]
        assert low <= min(values) <= max(values) <= high


def limits_of(random: Random) -> tuple[float, float, float, float]:
    """Return distance, rate, acceleration and jerk over some powers of ten, so that all kinds of profiles occur."""
    distance, rate, acceleration, jerk = (10.0 ** random.uniform(-2.0, 2.0) for _ in range(4))
    return random.choice((-1.0, 1.0)) * distance, rate, acceleration, jerk


def shortest_time(distance: float, rate: float, acceleration: float, jerk: float) -> float:
    """Return the duration of the fastest profile: its largest rate is found by bisection."""

    def rise_time(top: float) -> float:
        return 2.0 * math.sqrt(top / jerk) if top * jerk < acceleration**2 else top / acceleration + acceleration / jerk

    if rate * rise_time(rate) <= distance:
        return rise_time(rate) + distance / rate
    low, high = 0.0, rate
    for _ in range(200):
        middle = 0.5 * (low + high)
        low, high = (middle, high) if middle * rise_time(middle) <= distance else (low, middle)
    return 2.0 * rise_time(low)


def test_an_s_curve_keeps_its_limits_and_takes_the_shortest_time() -> None:
    """Random limits: at rest at both ends, smooth, within the limits, one of which is reached at every instant."""
    random, cruising, shorter = Random(3), 0, 0
    for _ in range(60):
        distance, rate, acceleration, jerk = limits_of(random)
        profile = read(f"scurve(t, {distance!r}, {rate!r}, {acceleration!r}, {jerk!r})")
        whole = shortest_time(abs(distance), rate, acceleration, jerk)
        breaks = find_discontinuities(profile, -whole, 2.0 * whole)
        assert breaks[-1] == pytest.approx(whole, rel=1e-12)
        grid = np.linspace(0.0, whole, 1001)
        value, speed, second = (np.array(column) for column in profile.sample_derivatives(grid.tolist()))
        assert np.abs(speed).max() <= rate * (1.0 + 1e-12)
        assert np.abs(second).max() <= acceleration * (1.0 + 1e-12)
        third = np.diff(second) / np.diff(grid)
        assert np.abs(third).max() <= jerk * (1.0 + 1e-9) + 1e-9 * acceleration / whole
        assert np.abs(np.diff(value) - 0.5 * np.diff(grid) * (speed[1:] + speed[:-1])).max() < 1e-3 * abs(distance)
        assert profile.value(whole * (1.0 + 1e-12)) == distance
        assert profile.derivatives(-0.1) == (0.0, 0.0, 0.0)
        for t in breaks:  # neither place nor rate nor acceleration jumps
            near = 1e-9 * whole
            before, after = profile.derivatives(t - near), profile.derivatives(t + near)
            for k, (size, slope) in enumerate(pairwise((abs(distance), rate, acceleration, jerk))):
                assert abs(after[k] - before[k]) < 1e-9 * size + 3.0 * near * slope
        at_limit = (
            (np.abs(speed[1:-1]) > rate * (1.0 - 1e-9))
            | (np.abs(second[1:-1]) > acceleration * (1.0 - 1e-9))
            | (np.abs(np.gradient(second, grid)[1:-1]) > jerk * (1.0 - 1e-6))
        )
        assert np.mean(at_limit) > 0.98  # but for samples on both sides of a break
        cruising += bool(np.abs(speed).max() > rate * (1.0 - 1e-9))
        shorter += bool(np.abs(second).max() < acceleration * (1.0 - 1e-3))
    assert min(cruising, 60 - cruising, shorter, 60 - shorter) > 6


def test_a_trapezoid_is_an_s_curve_of_great_jerk() -> None:
    random = Random(4)
    for _ in range(60):
        distance, rate, acceleration, _ = limits_of(random)
        sharp = read(f"trapezoid(t, {distance!r}, {rate!r}, {acceleration!r})")
        size = max(rate / acceleration, math.sqrt(abs(distance) / acceleration), abs(distance) / rate)
        smooth = read(f"scurve(t, {distance!r}, {rate!r}, {acceleration!r}, {1e9 * acceleration / size!r})")
        for t in np.linspace(0.0, 3.0 * size, 40):
            assert sharp.value(t) == pytest.approx(smooth.value(t), abs=1e-6 * abs(distance))


def test_by_hand() -> None:
    """3 m at 2 m/s and 4 m/s²: 0.5 s and 0.5 m up to speed, 1 s at speed; 0.25 m turns around at 1 m/s, after 0.5 s."""
    profile = read("trapezoid(t, 3, 2, 4)")
    assert [profile.value(t) for t in (0.25, 0.5, 1.0, 1.5, 1.75, 2.0)] == [0.125, 0.5, 1.5, 2.5, 2.875, 3.0]
    assert read("trapezoid(t, 0.25, 2, 4)").derivatives(0.25)[:2] == (0.125, 1.0)
    assert read("trapezoid(t, 0, 2, 4)").value(1.0) == read("scurve(t, 0, 2, 4, 8)").value(1.0) == 0.0
    assert read("cycloid(0.25)").constant == pytest.approx(0.25 - 0.5 / PI, abs=1e-16)


def test_a_law_of_a_coordinate_is_an_elastic_force_like_any_other() -> None:
    """A spring whose force follows a modified sine of the travel: energy is kept over the pieces of the law."""
    results = solved(
        "heun: 1\nbodies: {b: {mass: 2, center: [0, 0, 0], inertia: [1, 1, 1], points: {o: [0, 0, 0]}}}\n"
        "ground: {points: {O: [0, 0, 0]}}\n"
        "joints: {guide: {type: slide, from: ground.O, to: b.o, axis: [1, 0, 0], initial: {travel: 0, speed: 0.5}}}\n"
        'forces: {push: {type: torque, joint: guide, value: "3*modsine(guide.travel/0.4 + 0.1)"}}\n'
        "analysis: {duration: 2, samples: 21, tolerance: 1e-11}\n"
    )
    speed = results.coordinates["guide"]["speed"][-1]
    x = float(results.coordinates["guide"]["travel"][-1]) / 0.4 + 0.1
    with mpmath.workdps(30):  # the integral of f is that of f'' (x - z)^2/2, and of 1 behind the end
        rise = mpmath.quad(lambda z: modified_sine(z) * (1 - z) ** 2 / 2, [0, 0.125, 0.875, 1])
        begin = mpmath.quad(lambda z: modified_sine(z) * (mpmath.mpf("0.1") - z) ** 2 / 2, [0, 0.1])
    assert x > 1.0
    assert 0.5 * 2.0 * (speed**2 - 0.25) == pytest.approx(3.0 * 0.4 * (float(rise - begin) + x - 1.0), rel=1e-9)


@pytest.mark.parametrize(
    ("text", "code", "words"),
    [
        ("scurve(t, 1, 2, 3)", "function-arguments", "5 arguments"),
        ("cycloid(t, 1)", "function-arguments", "1 argument"),
        ("scurve(t, 1, -2, 3, 4)", "function-arguments", "rate of scurve() must be positive"),
        ("trapezoid(t, 1, 2, 0)", "function-arguments", "acceleration of trapezoid() must be positive"),
        ("trapezoid(t, t, 2, 1)", "function-arguments", "distance of trapezoid() changes"),
        ("cycloids(t)", "unknown-name", "cycloids"),
        ("cycloid", "function-arguments", "is a function"),
        ("cycloid(modtrap(t))", "expression-limit", "100 operations"),
    ],
)
def test_what_is_refused(text: str, code: str, words: str) -> None:
    with pytest.raises(Finding) as caught:
        read(text)
    assert caught.value.code == code
    assert words in caught.value.message


@pytest.mark.parametrize(
    ("value", "words"),
    [
        ("scurve(t, D, a, a, j)", "an acceleration as the rate over a length"),
        ("scurve(D, D, v, a, j)", "takes scurve at a length"),
        ("scurve(t, w, v, a, j)", "as the rate over an angle"),
        ("cycloid(D)", "takes cycloid of a length"),
        ("scurve(t, v, a, j, 3.5)", "a velocity, expected a length"),
    ],
)
def test_units_must_fit(value: str, words: str) -> None:
    with pytest.raises(SpecError) as caught:
        solved(
            "heun: 1\nparameters: {D: 20 mm, v: 1 m/s, a: 2 m/s^2, j: 9 m/s^3, w: 90 deg}\n"
            "bodies: {b: {mass: 2, center: [0, 0, 0], inertia: [1, 1, 1], points: {o: [0, 0, 0]}}}\n"
            "ground: {points: {O: [0, 0, 0]}}\n"
            "joints: {guide: {type: slide, from: ground.O, to: b.o, axis: [1, 0, 0]}}\n"
            f'drives: {{servo: {{joint: guide, travel: "{value}"}}}}\nanalysis: {{duration: 1}}\n'
        )
    assert words in str(caught.value.problems[0].message)
