"""Beside a singular pose: what is told is right, and what rounding reaches is not told.

All bars of a parallelogram turn alike, theta'' = 1.2 g sin(theta), omega^2 = omega_0^2 + 2.4 g (1 - cos(theta)); each
of the coupler's pins carries half of m (a + g), a the acceleration of a top.
"""

from __future__ import annotations

from functools import cache
from pathlib import Path

import numpy as np
import pytest

from heuncli.app.cli.entry import enter
from heuncli.base import tolerances
from heuncli.results.results import Array, Results
from heuncli.study.queries.measure import MeasureRequest, measure_value
from heuncli.study.queries.study import Study
from tests.shared.parallelogram import parallelogram
from tests.shared.scenes import near, study

pytestmark = pytest.mark.heavy  # a family at random: with the compiled kernel, which has the same bits

G = 9.81
FLAT_FOUR_BAR = str(Path(__file__).parents[2] / "specs/flat_four_bar.yaml")
RATES = [1.0, *np.random.default_rng(71).uniform(0.05, 4.0, 5).tolist()]
WANTED = frozenset({"joints", "points", "motion", "foundation", "energy"})


@cache
def swung(rate: float) -> Study:
    return study(parallelogram(rate, 2.0, 5), requested_reports=WANTED)


def accelerations(results: Results) -> Array:
    """Of the tops, (n, 2), from the closed form at the angle and rate reached; nan where the rate is not known."""
    x, y = results.points["left.top"]["position"][:, :2].T
    square = results.bodies["left"]["angular_velocity"][:, 2] ** 2
    return np.stack([1.2 * G * x * y - square * x, -1.2 * G * x * x - square * y], axis=1)


@pytest.mark.parametrize("rate", RATES)
def test_what_is_told_is_right(rate: float) -> None:
    """From a tenth of a second off the flat poses to a billionth: told to six digits of the largest, or not told."""
    s = swung(rate)
    assert s.history.checked_run is not None
    rng = np.random.default_rng(3)
    apart = 10.0 ** rng.uniform(-9.0, -1.0, 60) * rng.choice([-1.0, 1.0], 60)
    times = np.unique(np.concatenate([np.array(s.history.singular)[:, None] + apart]).ravel())
    times = times[(times > 0.0) & (times < 2.0)]
    found = s.resample(times)
    a = accelerations(found)
    load = 0.5 * (a + np.array([0.0, G]))
    scale = max(np.nanmax(np.linalg.norm(load, axis=1)), G)
    told = ~np.isnan(found.joints["C"]["radial"])
    for part, wanted in (("force", load), ("radial", np.linalg.norm(load, axis=1))):
        shown = found.joints["C"][part][:, :2] if part == "force" else found.joints["C"][part]
        known = ~np.isnan(shown + wanted)
        near(shown[known], wanted[known], scale, 2.0 * tolerances.UNKNOWN_NEAR_SINGULAR)
    moving = found.bodies["left"]["center_acceleration"][:, :2]
    known = ~np.isnan(moving + a)
    near(moving[known], 0.5 * a[known], scale, 2.0 * tolerances.UNKNOWN_NEAR_SINGULAR)
    off = np.abs(times[:, None] - np.array(s.history.singular)).min(axis=1)
    speed = np.sqrt(rate**2 + 2.4 * G)  # at the first flat pose
    assert told[off * speed > 1e-2].all()
    assert not told[off * speed < 1e-5].any()
    assert set(found.accuracy["unknown"]) >= set(times[~told].tolist())
    assert any(("numbers near it that are lost to rounding" in w) for w in s.later_warnings)


@pytest.mark.parametrize("rate", RATES)
def test_extremes_are_those_of_what_is_known(rate: float) -> None:
    """The largest load is at the bottom, not the noise of a flat pose."""
    s = swung(rate)
    bottom = 0.5 * (rate**2 + 4.8 * G + G)
    if s.results.points["left.top"]["position"][:, 1].min() > 0.0 or len(s.history.singular) < 2:
        pytest.skip("it does not come to the bottom in two seconds")
    found, at, *_ = measure_value(MeasureRequest("abs", "joints.C.radial"), s)
    assert at is not None
    # a search ends where nothing promises more than a tenth of the error that is told, which singular poses enlarge
    near(found, bottom, bottom, max(1e-8, 0.1 * s.magnitudes.errors["reactions", "N"] / bottom))
    near(measure_value(MeasureRequest("max", "energy.kinetic"), s)[0], 5.0 / 6.0 * (rate**2 + 4.8 * G), bottom, 1e-8)


def test_the_example(capsys: pytest.CaptureFixture[str]) -> None:
    assert enter(["run", FLAT_FOUR_BAR, "--measure", "max abs joints.C.radial"]) == 0
    near(float(capsys.readouterr().out), 28.949, 28.949, 1e-6)
    assert enter(["run", FLAT_FOUR_BAR]) == 0
    assert "extremes exclude the numerically uncertain samples near singular positions" in capsys.readouterr().err
    assert enter(["run", FLAT_FOUR_BAR, "--measure", "at 0.70845 joints.C.radial"]) == 0
    told = capsys.readouterr()
    assert told.out == "?\n"
    assert "singular position at t = 0.70845 s: numbers near it that are lost to rounding" in told.err
    assert enter(["run", FLAT_FOUR_BAR, "--at", "0.70845", "--only", "energy,joints"]) == 0
    shown = capsys.readouterr().out
    assert "?: the estimated error is as large as the number" in shown
    assert "statically indeterminate" not in shown
    assert enter(["run", FLAT_FOUR_BAR, "--measure", "at 0.7 joints.C.radial"]) == 0
    assert 0.0 < float(capsys.readouterr().out) < 28.949


def test_far_from_a_singular_pose_everything_is_told() -> None:
    """A coupler a little too long keeps the chain from lying flat; its loads are large there, and told."""
    s = study(parallelogram(0.2, 2.0, 201, coupler=1.01), requested_reports=WANTED)
    found = s.resample(s.search_times)
    assert "unknown" not in found.accuracy
    assert not np.isnan(found.joints["C"]["radial"]).any()
    assert not s.later_warnings


def folding(a: float, b: float, c: float, phi: float, rate: float) -> str:
    """A four-bar of rods a, b, c on a ground of g with the longest and the shortest as long as the others: it lies flat
    once a turn. phi: of the crank at the start; rate: its angular velocity."""
    g = sorted([a, b, c])[0] + sorted([a, b, c])[2] - sorted([a, b, c])[1]
    tip = a * np.array([np.cos(phi), np.sin(phi)])
    way = np.array([g, 0.0]) - tip
    far = float(np.hypot(*way))
    along = (b * b - c * c + far * far) / (2.0 * far)
    e = way / far
    pin = tip + along * e + np.sqrt(b * b - along * along) * np.array([-e[1], e[0]])
    angles = {"crank": tip, "coupler": pin - tip, "rocker": pin - [g, 0.0]}
    places = {"crank": (0.0, 0.0), "coupler": tip, "rocker": (g, 0.0)}
    bodies = "".join(
        f"  {name}: {{shapes: [{{type: rod, from: [0, 0, 0], to: [{length}, 0, 0], mass: {mass}}}], "
        f"points: {{foot: [0, 0, 0], tip: [{length}, 0, 0]}}, "
        f"{'orientation' if name == 'crank' else f'near: {{position: [{x!r}, {y!r}, 0], orientation'}: "
        f"{{axis: [0, 0, 1], angle: {float(np.arctan2(way[1], way[0]))!r}}}{'' if name == 'crank' else '}'}"
        f"{f', angular_velocity: [0, 0, {rate!r}]' if name == 'crank' else ''}}}\n"
        for (name, way), (x, y), length, mass in zip(
            angles.items(), [tuple(map(float, p)) for p in places.values()], (a, b, c), (1.3, 0.7, 1.1), strict=True
        )
    )
    ends = {"A": "ground.A crank.foot", "B": "ground.B rocker.foot", "C": "crank.tip coupler.foot",
            "D": "coupler.tip rocker.tip"}  # fmt: skip
    joints = "".join(
        f"  {name}: {{type: pin, from: {both.split()[0]}, to: {both.split()[1]}, axis: [0, 0, 1]}}\n"
        for name, both in ends.items()
    )
    return (
        f"heun: 1\ngravity: [0, -9.81, 0]\nground: {{points: {{A: [0, 0, 0], B: [{g!r}, 0, 0]}}}}\n"
        f"bodies:\n{bodies}joints:\n{joints}analysis: {{duration: 1.5, samples: 4}}\n"
    )


LENGTHS = np.random.default_rng(12).uniform(0.8, 2.0, (12, 3)).round(2).tolist()


@pytest.mark.heavy
@pytest.mark.parametrize("lengths", LENGTHS, ids=str)
@pytest.mark.third
def test_bars_of_any_length_through_a_flat_pose(lengths: list[float]) -> None:
    """Loads may grow there without bound: those that are told agree with a run a thousand times as fine."""
    text = folding(*lengths, 0.9, 4.0)
    s, fine = (study(text, requested_reports=WANTED, tolerance=tolerance) for tolerance in (1e-9, 1e-12))
    assert s.history.checked_run is not None
    if not s.history.singular or s.history.checked_run.horizon is not None:
        pytest.skip("it does not come to a flat pose, or nothing is claimed")
    flat = s.history.singular[0]
    rng = np.random.default_rng(8)
    times = np.sort(flat + 10.0 ** rng.uniform(-8.0, -1.5, 60) * rng.choice([-1.0, 1.0], 60))
    times = times[(times > 0.0) & (times < 1.5)]
    found, wanted = s.resample(times), fine.resample(times)
    for load in (found.joints["C"], found.joints["B"]):
        known = ~np.isnan(load["radial"])
        assert known[np.abs(times - flat) > 1e-2].all()
        assert not known[np.abs(times - flat) < 1e-6].any()
    for path in (("joints", "C", "radial"), ("joints", "B", "radial"), ("foundation", "force"),
                 ("bodies", "coupler", "angular_acceleration"), ("energy", "kinetic")):  # fmt: skip
        x, y = getattr(found, path[0]), getattr(wanted, path[0])
        for key in path[1:]:
            x, y = x[key], y[key]
        known = ~np.isnan(x + y)
        size = np.maximum(np.abs(x), 100.0)  # what accelerations and loads come to without a flat pose
        assert (np.abs(x - y)[known] <= 2.0 * tolerances.UNKNOWN_NEAR_SINGULAR * size[known]).all(), path
