"""Rainflow counting as numbers: ASTM's printed examples, the package `rainflow` and its own tests, repetition."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterator
from typing import Any

import numpy as np
import pytest

from heuncli.results.results import Array
from heuncli.study import rainflow
from heuncli.study.load_collectives import compute_range_norm, find_damage_shares
from heuncli.study.rainflow import Cycles, count_endless, count_once, count_repeated, find_turning_points

pytestmark = pytest.mark.heavy  # no kernel in it

# ASTM E1049-85, Fig. 6: the history A to I, and its cycles, range to count
FIGURE_6 = np.array([-2.0, 1.0, -3.0, 5.0, -1.0, 3.0, -4.0, 4.0, -2.0])
COUNTED_6 = {3.0: 0.5, 4.0: 1.5, 6.0: 0.5, 8.0: 1.0, 9.0: 0.5}
CASES = 1000
# of the tests of the package rainflow (MIT): a history, and amplitude, mean and count of its cycles
OF_PACKAGE = [
    0.60727647, 0.14653493, 0.19643957, 0.56821631, 0.88833878, 0.29612997, 0.59539649, 0.6996683,
    0.10524973, 0.12334626, 0.68401331, 0.85985292, 0.73141117, 0.36808646, 0.94015761, 0.85626572,
    0.76956161, 0.49777263, 0.54066458, 0.45931667, 0.82204694, 0.76816398, 0.66417278, 0.62238591,
    0.61302659, 0.0158001, 0.35254166, 0.54150519, 0.14868205, 0.91848263, 0.8989403, 0.90866213,
    0.831834, 0.48128077, 0.60999729, 0.78850529, 0.67725795, 0.76098028, 0.96626931, 0.91693159,
    0.19347573, 0.4920361, 0.16060596, 0.10603582, 0.0017221, 0.6250337, 0.43623379, 0.54612575,
    0.00411415, 0.91371242, 0.08600793, 0.77993431, 0.89695114, 0.43309567, 0.70051438, 0.05484055,
    0.0673957, 0.68068416, 0.12452928, 0.00811467, 0.33861137, 0.61719287, 0.49407856, 0.8300253,
    0.29934456, 0.7107892, 0.38225825, 0.02715285, 0.0189073, 0.68926121, 0.46134276, 0.25709821,
    0.46942654, 0.68086762, 0.3117921, 0.89299606, 0.43332419, 0.04576419, 0.09044587, 0.28137508,
    0.365343, 0.94461639, 0.48949621, 0.03472242, 0.79210514, 0.94612641, 0.25696703, 0.61546048,
    0.04270415, 0.6681445, 0.79452558, 0.41156153, 0.4671666, 0.01783284, 0.8529705, 0.56580293,
    0.62133836, 0.74723755, 0.28597705, 0.7421038,
]  # fmt: skip
OF_PACKAGE_COUNTED = [
    (0.2304, 0.3769, 0.5), (0.2018, 0.4979, 1.0), (0.3709, 0.5174, 0.5), (0.2459, 0.614, 1.0),
    (0.3915, 0.4968, 0.5), (0.0214, 0.5192, 1.0), (0.1814, 0.6407, 1.0), (0.4175, 0.5227, 0.5),
    (0.1964, 0.3451, 1.0), (0.0049, 0.9038, 1.0), (0.0556, 0.7329, 1.0), (0.2186, 0.6999, 1.0),
    (0.4622, 0.478, 0.5), (0.1493, 0.3428, 1.0), (0.4752, 0.491, 0.5), (0.0549, 0.4912, 1.0),
    (0.3105, 0.3146, 1.0), (0.1337, 0.5668, 1.0), (0.4055, 0.4915, 1.0), (0.3129, 0.3678, 1.0),
    (0.0616, 0.5556, 1.0), (0.2057, 0.5051, 1.0), (0.1845, 0.4963, 1.0), (0.2161, 0.4732, 1.0),
    (0.4056, 0.4245, 1.0), (0.4236, 0.4694, 1.0), (0.4528, 0.4609, 1.0), (0.4549, 0.4897, 1.0),
    (0.1792, 0.4362, 1.0), (0.0278, 0.4394, 1.0), (0.3759, 0.4186, 1.0), (0.0907, 0.6565, 1.0),
    (0.4823, 0.484, 0.5), (0.4722, 0.4739, 0.5), (0.4641, 0.482, 0.5), (0.4176, 0.4354, 0.5),
    (0.2835, 0.5695, 0.5), (0.2281, 0.514, 0.5),
]  # fmt: skip


def by_range_and_mean(cycles: Cycles) -> Counter[tuple[float, float]]:
    """How often each pair of range and mean is counted."""
    found: Counter[tuple[float, float]] = Counter()
    for key, n in zip(zip(cycles.ranges.tolist(), cycles.means.tolist(), strict=True), cycles.counts, strict=True):
        found[key] += float(n)
    return found


def by_range(cycles: Cycles) -> dict[float, float]:
    """How often each range is counted."""
    found: Counter[float] = Counter()
    for (size, _), n in by_range_and_mean(cycles).items():
        found[size] += n
    return dict(found)


def histories(seed: int = 20261126) -> Iterator[Array]:
    """Random ones: noise, walks, whole numbers with many ties and plateaus, growing and shrinking ranges."""
    rng = np.random.default_rng(seed)
    for k in range(CASES):
        n = int(rng.integers(3, 80))
        noise = rng.normal(size=n)
        whole = rng.integers(-4, 5, n).astype(float)
        swing = np.where(np.arange(n) % 2, 1.0, -1.0) * np.abs(np.arange(n) - rng.integers(0, n))
        yield (noise, np.cumsum(noise), whole, swing)[k % 4]


def test_astm_figure_6() -> None:
    cycles = count_once(FIGURE_6)
    assert by_range(cycles) == COUNTED_6
    assert cycles.begin[cycles.counts == 1.0].tolist() == [-1.0]  # E-F, the one that closes
    assert cycles.end[cycles.counts == 1.0].tolist() == [3.0]


def test_astm_figure_7_begins_at_the_highest_peak() -> None:
    """5.4.5: the same history repeated, begun at D; its printed cycles: 3, 4, 7 and 9."""
    history = np.array([5.0, -1.0, 3.0, -4.0, 4.0, -3.0, 1.0, -2.0, 5.0])
    again = np.concatenate([history[3:-1], history[:4]])
    for one in (history, again):
        cycles = count_endless(one)
        assert set(cycles.counts.tolist()) == {1.0}
        assert by_range(cycles) == {3.0: 1.0, 4.0: 1.0, 7.0: 1.0, 9.0: 1.0}


def test_the_packages_own_tests() -> None:
    """Plateaus and points on a slope change nothing; its history of 100 numbers, printed to four decimals."""
    assert by_range(count_once(np.repeat(FIGURE_6, 2))) == COUNTED_6
    slopes = np.interp(np.arange(0.0, 8.01, 0.25), np.arange(9.0), FIGURE_6)
    assert by_range(count_once(slopes)) == COUNTED_6
    cycles = count_once(np.array(OF_PACKAGE))
    found = zip(0.5 * cycles.ranges, cycles.means, cycles.counts, strict=True)
    rounded = Counter((round(float(size), 4), round(float(mean), 4), float(n)) for size, mean, n in found)
    assert rounded == Counter(OF_PACKAGE_COUNTED)


def test_as_the_package_rainflow_on_random_histories() -> None:
    """The same ranges and means as often: three points of 5.4.4 there, four points and halves here.

    They differ where there are no turns: of two values alone the package counts nothing, and this half a cycle.
    """
    package: Any = pytest.importorskip("rainflow", reason="the package rainflow is not there")
    for history in histories():
        wanted: Counter[tuple[float, float]] = Counter()
        for size, mean, n, _, _ in package.extract_cycles(history.tolist()):
            wanted[size, mean] += n
        assert by_range_and_mean(count_once(history)) == Counter({k: n for k, n in wanted.items() if k[0] > 0.0})
    assert list(package.extract_cycles([0.0, 1.0])) == []
    assert by_range(count_once(np.array([0.0, 1.0]))) == {1.0: 0.5}


def test_classes_as_the_package_rainflow() -> None:
    package: Any = pytest.importorskip("rainflow", reason="the package rainflow is not there")
    rng = np.random.default_rng(3)
    for n in (1, 2, 5, 9, 10):
        for history in (FIGURE_6, rng.normal(size=60)):
            cycles = count_once(history)
            limits = rainflow.make_class_limits(0.0, float(cycles.ranges.max()), n)
            wanted = [count for _, count in package.count_cycles(history.tolist(), nbins=n)]
            assert rainflow.count_by_range(cycles, limits, 1e-12).tolist() == wanted


def test_a_repeated_history_counts_as_one_told_so_many_times() -> None:
    for k, history in enumerate(histories()):
        history[-1] = history[0]
        times = 1 + k % 6
        told = np.concatenate([history, *[history[1:]] * (times - 1)])
        assert by_range_and_mean(count_repeated(history, times)) == by_range_and_mean(count_once(told))


def test_endless_is_what_each_further_time_adds() -> None:
    for history in histories():
        history[-1] = history[0]
        added = by_range_and_mean(count_repeated(history, 9))
        added.subtract(by_range_and_mean(count_repeated(history, 8)))
        assert by_range_and_mean(count_endless(history)) == Counter({key: n for key, n in added.items() if n})


def test_halves_and_cycles_use_every_range_once() -> None:
    """Each turning point behind the first ends one half cycle."""
    for history in histories():
        points = len(find_turning_points(history))
        assert count_once(history).counts.sum() == 0.5 * max(points - 1, 0)


def test_laws_of_a_count() -> None:
    """Scaled, shifted loads have such ranges and means; turned in sign or time, or warped, they count alike."""
    for history in histories():
        cycles = by_range_and_mean(count_once(history))
        scaled = by_range_and_mean(count_once(4.0 * history))
        assert scaled == Counter({(4.0 * size, 4.0 * mean): n for (size, mean), n in cycles.items()})
        turned = by_range_and_mean(count_once(-history))
        assert turned == Counter({(size, -mean + 0.0): n for (size, mean), n in cycles.items()})
        assert by_range(count_once(history[::-1])) == by_range(count_once(history))
        warped = np.insert(history, 1, 0.5 * (history[0] + history[1]))
        assert by_range_and_mean(count_once(warped)) == cycles
        shifted = count_once(history + 64.0)
        assert np.allclose(np.sort(shifted.ranges), np.sort(count_once(history).ranges), rtol=0, atol=1e-12)
        assert np.allclose(np.sort(shifted.means), np.sort(count_once(history).means + 64.0), rtol=0, atol=1e-12)


def test_crossings_are_those_of_the_history() -> None:
    """A level is passed upwards by a range that begins at or below it and ends above; counted there, one by one."""
    for history in histories():
        points = find_turning_points(history)
        a, b = points[:-1], points[1:]
        levels = np.linspace(history.min(), history.max(), 9)
        found = rainflow.count_crossings(count_once(history), levels)
        assert found.upward.tolist() == [float(np.sum((a <= L) & (b > L))) for L in levels]
        assert found.downward.tolist() == [float(np.sum((a >= L) & (b < L))) for L in levels]
        assert found.count_by_reference(0.0).tolist() == np.where(levels >= 0.0, found.upward, found.downward).tolist()


def test_the_matrix_adds_up_to_the_classes() -> None:
    for history in histories():
        cycles = count_once(history)
        limits = rainflow.make_class_limits(0.0, float(cycles.ranges.max(initial=0.0)), 7)
        cells = rainflow.count_matrix(cycles, limits, 1e-12)
        assert cells.counts.sum(axis=1).tolist() == rainflow.count_by_range(cycles, limits, 1e-12).tolist()


def test_rounding_decides_no_class() -> None:
    """Ranges at a limit, off by their error upwards, belong below it as those off downwards do."""
    cycles = Cycles(np.zeros(3), np.array([0.5 - 1e-13, 0.5 + 1e-13, 1.0]), np.ones(3))
    assert rainflow.count_by_range(cycles, rainflow.make_class_limits(0.0, 1.0, 2), 1e-12).tolist() == [2.0, 1.0]


def test_equivalent_range() -> None:
    """Of ranges 1 (8 times) and 2 (once): D = 8 + 2^m; for a slope of 3 that of 16 cycles of range 1."""
    ranges, counts = np.array([1.0, 2.0]), np.array([8.0, 1.0])
    assert compute_range_norm(ranges, counts, 3.0, 16.0) == pytest.approx(1.0, rel=1e-15)
    assert compute_range_norm(ranges, counts, 3.0, 2.0) == pytest.approx(2.0, rel=1e-15)
    assert find_damage_shares(ranges, counts, 3.0).tolist() == pytest.approx([0.5, 0.5])
    assert compute_range_norm(1e200 * ranges, counts, 9.0, 1.0) == pytest.approx(
        1e200 * (8 + 2**9) ** (1 / 9), rel=1e-14
    )
    assert compute_range_norm(np.zeros(0), np.zeros(0), 3.0, 1.0) == 0.0
