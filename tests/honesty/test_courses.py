"""`heun find` on functions that are known: every crossing is found, and lies within its stated error.

The functions come with noise of the size that is stated for them, as measures of runs do. Seeds are not chosen; what
the scan cannot see is left out by its own statement: pairs nearer together than its spacing, of sharp peaks.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import NamedTuple

import numpy as np
import pytest
from scipy.optimize import brentq

from heuncli.analyses.find.narrowing import is_steep
from heuncli.analyses.find.results import IntervalFindings
from heuncli.analyses.find.study import find_meetings
from heuncli.analyses.variants.conditions import Relation
from heuncli.analyses.variants.course import MeasureCourse
from heuncli.analyses.variants.samples import Sample

Function = Callable[[float], float]
FINE = np.linspace(0.0, 1.0, 20_001)


class Family(NamedTuple):
    """Functions of [0, 1] made of random numbers; smooth: without bends; sharp: with peaks as narrow as may be."""

    name: str
    make: Callable[[np.random.Generator], Function]
    sharp: bool = False


def polynomial(rng: np.random.Generator) -> Function:
    factors = rng.normal(size=rng.integers(2, 6)).tolist()

    def value(x: float) -> float:  # np.polyval takes a hundred times as long, and the truth is searched for finely
        sum_so_far = 0.0
        for factor in factors:
            sum_so_far = sum_so_far * (2.0 * x - 1.0) + factor
        return sum_so_far

    return value


def wave(rng: np.random.Generator) -> Function:
    w, p, d = rng.uniform(0.5, 9.0), rng.uniform(0.0, 6.0), rng.uniform(-0.8, 0.8)
    return lambda x: math.sin(w * x + p) - d


def resonance(rng: np.random.Generator) -> Function:
    a, b, c = rng.uniform(0.05, 1.0), rng.uniform(0.02, 1.0), rng.uniform(0.1, 1.0)
    return lambda x: 1.0 / math.hypot(1.0 - (x / a) ** 2, b * x) - 1.0 - c


def largest_of_two(rng: np.random.Generator) -> Function:
    a, b, c, d = rng.normal(size=4).tolist()
    return lambda x: max(abs(a + b * x), abs(c + d * x)) - 0.7


def exponential(rng: np.random.Generator) -> Function:
    a, b = rng.uniform(-6.0, 6.0), rng.uniform(0.0, 1.0)
    return lambda x: math.exp(a * x) - math.exp(a * b)


def two_waves(rng: np.random.Generator) -> Function:
    a, b, c = rng.normal(size=3).tolist()
    return lambda x: a * math.cos(4.0 * x) + b * math.sin(3.0 * x) + c


FAMILIES = (
    Family("polynomial", polynomial), Family("wave", wave), Family("resonance", resonance, sharp=True),
    Family("largest of two", largest_of_two), Family("exponential", exponential), Family("two waves", two_waves),
)  # fmt: skip


def noisy(f: Function, error: float, seed: int, asked: list[float]) -> Callable[[float], Sample]:
    """The function as a run knows it: within the error that it states, relative to 1 + |f|."""

    def ask(x: float) -> Sample:
        asked.append(x)
        value = f(x)
        size = error * (1.0 + abs(value))
        return Sample(x, value + size * math.sin(1e9 * x + seed), size)

    return ask


def looked(f: Function, error: float, seed: int = 0, relation: Relation = "=", count: int = 7) -> IntervalFindings:
    asked: list[float] = []
    found = find_meetings(noisy(f, error, seed, asked), 0.0, 1.0, relation, scan_count=count, max_evaluations=400)
    assert found.is_complete and len(set(asked)) == len(asked) == len(found.samples)  # nothing is asked twice
    return found


def crossings_of(f: Function) -> list[float]:
    values = np.array([f(x) for x in FINE.tolist()])
    places = np.flatnonzero(values[:-1] * values[1:] < 0.0).tolist()
    return [float(brentq(f, FINE[i], FINE[i + 1], xtol=1e-15)) for i in places]


@pytest.mark.parametrize("seed", range(60))
@pytest.mark.parametrize("family", FAMILIES, ids=[family.name for family in FAMILIES])
@pytest.mark.third
def test_all_crossings_are_found_within_their_errors(family: Family, seed: int) -> None:
    rng = np.random.default_rng([seed, FAMILIES.index(family)])
    f, error = family.make(rng), 10.0 ** rng.uniform(-12.0, -5.0)
    found, truth = looked(f, error, seed), crossings_of(f)
    told = [(each.sample.x, each.error) for each in found.crossings]
    for x, error_of_x in told:
        assert any(abs(x - true) <= error_of_x + 1e-15 for true in truth), (x, truth)
    missed = [true for true in truth if not any(abs(x - true) <= e + 1e-15 for x, e in told)]
    missed = [true for true in missed if not any(t.low - 1e-3 <= true <= t.high + 1e-3 for t in found.touches)]
    if family.sharp and missed:  # a peak between two places, which the output speaks of
        assert len(missed) % 2 == 0 and missed[-1] - missed[0] < found.spacing
        return
    assert missed == []


def is_monotone(f: Function) -> bool:
    steps = np.diff([f(x) for x in FINE.tolist()])
    return bool((steps > 0.0).all() or (steps < 0.0).all())


def test_one_crossing_of_a_smooth_rise_takes_few_runs() -> None:
    """Half of them no more than 12, nine of ten no more than 14: the gaps at both ends are looked into as well."""
    runs = []
    for seed in range(100):
        rng = np.random.default_rng([7, seed])
        f = (polynomial, wave, exponential, two_waves)[seed % 4](rng)
        if is_monotone(f) and len(crossings_of(f)) == 1:
            runs.append(len(looked(f, 10.0 ** rng.uniform(-12.0, -8.0), seed).samples))
    assert len(runs) > 25
    assert np.median(runs) <= 12 and np.quantile(runs, 0.9) <= 14, sorted(runs)


@pytest.mark.parametrize("relation", ["<", ">="])
@pytest.mark.parametrize("seed", range(40))
@pytest.mark.third
def test_where_an_inequality_is_met(relation: Relation, seed: int) -> None:
    """Everywhere in the stretches told, nowhere between them, but within the errors of their ends."""
    rng = np.random.default_rng([11, seed])
    f = two_waves(rng)
    found = looked(f, 1e-9, seed, relation)
    for x in FINE[::7].tolist():
        inside = any(met.low.x + met.low.error < x < met.high.x - met.high.error for met in found.met_stretches)
        beside = any(abs(x - edge.x) <= edge.error + 1e-4 for met in found.met_stretches for edge in met)
        if not beside:
            assert inside == (f(x) < 0.0 if relation == "<" else f(x) >= 0.0), x


@pytest.mark.parametrize("place", [0.05, 0.31, 0.5, 0.777])
def test_jumps_and_poles_are_no_crossings(place: float) -> None:
    for f in (lambda x: 1.0 if x > place else -1.0, lambda x: 1.0 / (x - place)):
        found = looked(f, 1e-9)
        (jump,) = found.jumps
        assert found.crossings == () and jump.left.x <= place <= jump.right.x < jump.left.x + 1e-9


@pytest.mark.parametrize("steep", [1e2, 1e4, 1e6])
def test_what_is_steep_is_a_crossing_all_the_same(steep: float) -> None:
    (crossing,) = looked(lambda x: math.tanh(steep * (x - 0.4321)), 1e-9).crossings
    assert abs(crossing.sample.x - 0.4321) <= crossing.error < 1e-6


def test_a_flat_crossing_says_so_and_its_error_holds() -> None:
    """(x - 0.4)^3 is not told from 0 over a thousandth of the interval."""
    (crossing,) = looked(lambda x: (x - 0.4) ** 3, 1e-9).crossings
    assert crossing.flat and abs(crossing.sample.x - 0.4) <= crossing.error < 3e-3


def scattered(f: Function, size: float, rng: np.random.Generator) -> Callable[[float], Sample]:
    """The function within noise of that size, drawn anew at each place."""
    return lambda x: Sample(x, f(x) + size * rng.uniform(-1.0, 1.0), size)


BENT: dict[str, Callable[[float], float]] = {  # all cross at 0, where their slopes are other than beside it
    "bends": lambda u: u * (3.0 if u > 0.0 else 0.1),
    "bends a little": lambda u: u * (3.0 if u > 0.0 else 1.6),
    "cube": lambda u: u**3,
    "fifth power": lambda u: u**5,
    "flat on one side": lambda u: u**3 if u > 0.0 else u,
    "flat and curved": lambda u: u**3 + u**4,
}


@pytest.mark.parametrize("seed", range(15))
@pytest.mark.parametrize("shape", BENT)
def test_crossings_where_the_course_bends_or_is_flat_are_within_their_errors(shape: str, seed: int) -> None:
    rng = np.random.default_rng([13, seed])
    c, way = rng.uniform(0.03, 0.97), rng.choice([-1.0, 1.0])
    size = 10.0 ** rng.uniform(-11.0, -3.5)
    found = find_meetings(
        scattered(lambda x: way * BENT[shape](x - c), size, rng), 0.0, 1.0, "=", scan_count=7, max_evaluations=400
    )
    assert found.is_complete and found.crossings and not found.jumps
    for crossing in found.crossings:
        assert abs(crossing.sample.x - c) <= crossing.error + 1e-15
    if shape.startswith("bends"):
        assert not crossing.flat and crossing.error <= 20.0 * size / 0.1 + 1e-9  # and they are of use


@pytest.mark.parametrize("noise", [1e-11, 1e-6])
def test_a_rise_within_its_noise_is_no_jump(noise: float) -> None:
    """Beside the narrowest bracket noise alone makes the course fall; across it no more is left than both errors."""
    course = MeasureCourse(lambda x: Sample(x, 0.0, noise), 0.0, 1.0, 7, 10)
    places = (0.2, 0.5 - 3.0 * course.finest, 0.5, 0.5 + course.finest, 0.5 + 3.0 * course.finest, 0.8)
    gaps = (-0.3, -1.3 * noise, -1.1 * noise, 1.1 * noise, 1.05 * noise, 0.3)
    course.samples = [Sample(x, gap, noise) for x, gap in zip(places, gaps, strict=True)]
    assert is_steep(course, course.samples[2], course.samples[3])
    jump = [Sample(each.x, gap, noise) for each, gap in zip(course.samples, (-1, -1, -1, 1, 1, 1), strict=True)]
    course.samples = jump
    assert not is_steep(course, jump[2], jump[3])


@pytest.mark.parametrize("f", [lambda x: (x - 0.4) ** 2, lambda x: -abs(x - 0.4), lambda x: (x - 0.4) ** 4])
def test_touches(f: Function) -> None:
    found = looked(f, 1e-9)
    (touch,) = found.touches
    assert found.crossings == () and touch.low - 1e-2 <= 0.4 <= touch.high + 1e-2


@pytest.mark.parametrize(
    ("f", "value", "most"),
    [
        (lambda x: 2.0 * (x - 0.3456) ** 2 + 1.5, 1.5, 25),
        (lambda x: 2.0 * abs(x - 0.3456) + 1.5, 1.5, 25),
        (lambda x: 2.0 / (x - 0.3456), 7.0, 30),
        (lambda x: 2.0 / (x - 0.3456), -20.0, 40),
        (lambda x: 2.0 / (x - 0.3456) ** 2, 700.0, 40),  # a pole that is passed twice
    ],
)
def test_touches_and_poles_take_few_runs(f: Function, value: float, most: int) -> None:
    """Halving takes 20 runs to each side of a touch whose error is 1e-12, and 30 to a pole."""
    found = find_meetings(
        lambda x: Sample(x, f(x) - value, 1e-12 * abs(f(x))),
        -1.0, 2.0, "=", scan_count=7, max_evaluations=300, value=value,
    )  # fmt: skip
    assert found.is_complete and len(found.samples) <= most
    assert len(found.touches) + len(found.jumps) + len(found.crossings) == (1 if value == 1.5 else 2), found


def test_a_measure_that_is_the_value_everywhere() -> None:
    (touch,) = looked(lambda x: 0.0, 1e-9).touches
    assert (touch.low, touch.high, touch.side) == (0.0, 1.0, 0)


def test_crossings_at_the_ends() -> None:
    found = looked(lambda x: x * (x - 1.0), 1e-12)
    assert [crossing.direction for crossing in found.crossings] == [0, 0]
    assert [crossing.sample.x for crossing in found.crossings] == [0.0, 1.0]


def test_a_wave_in_beat_with_an_even_scan_is_seen() -> None:
    """sin(6 pi x) - 0.2 is -0.2 at every sixth of the interval."""
    f: Function = lambda x: math.sin(6.0 * math.pi * x) - 0.2  # noqa: E731
    assert len(looked(f, 1e-9).crossings) == len(crossings_of(f)) == 6


def test_extremes_are_refined_where_nothing_is_met() -> None:
    found = looked(lambda x: math.sin(5.0 * x) + 3.0, 1e-9)
    assert found.is_refined and found.least is not None and found.greatest is not None
    assert found.greatest.gap == pytest.approx(4.0, abs=1e-5) and found.least.gap == pytest.approx(2.0, abs=1e-5)


def test_a_budget_ends_the_search() -> None:
    asked: list[float] = []
    found = find_meetings(
        noisy(lambda x: math.sin(40.0 * x), 1e-9, 0, asked), 0.0, 1.0, "=", scan_count=7, max_evaluations=20
    )
    assert not found.is_complete and len(asked) == 20
