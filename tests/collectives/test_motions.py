"""Collectives of motions: closed forms, turns between the samples, laws of the machine, what is refused."""

from __future__ import annotations

import json
import math
from pathlib import Path

import jsonschema
import numpy as np
import pytest

import heuncli
from heuncli.base.errors import HeunError
from heuncli.output.tables.collective_tables import count_collective
from heuncli.output.tables.results_json_schema import make_results_schema
from heuncli.results.results import Array
from heuncli.study.load_collectives import Collective, Counting, LoadHistory, make_collective
from heuncli.study.queries.study import Study
from heuncli.study.rainflow import count_once
from tests.shared.command import HANGING, TURNED, Heun
from tests.shared.folders import SPECS
from tests.shared.scenes import study

pytestmark = pytest.mark.heavy

SHAKER = """\
heun: 1
title: A table on a guide, pushed
parameters: {{a: 10 N, w: 20, turns: 5, mean: 0 N}}
ground: {{points: {{O: [0, 0, 0]}}}}
bodies:
  table: {{mass: 2, center: [0, 0, 0], inertia: [0.1, 0.1, 0.1], points: {{c: [0, 0, 0]}}}}
joints:
  guide: {{type: slide, from: ground.O, to: table.c, axis: [1, 0, 0]}}
drives:
  hold: {{joint: guide, travel: 0}}
forces:
  push: {{type: force, on: table.c, vector: [0, "{0}", 0]}}
analysis: {{duration: "2*pi*turns/w", samples: 2}}
"""
TONE = "a*cos(w*t) + mean"
TWO_TONES = "a*sin(w*t) + 0.4*a*sin(7*w*t + 1)"
SIDE = "joints.guide.force.y"
ROTOR = """\
heun: 1
title: A wheel out of balance
parameters: {w: 100}
gravity: [0, -9.81, 0]
ground: {points: {O: [0, 0, 0]}}
bodies:
  wheel: {mass: 3, center: [0.002, 0, 0], inertia: [0.1, 0.1, 0.2], points: {hub: [0, 0, 0]}}
joints:
  hub: {type: pin, from: ground.O, to: wheel.hub, axis: [0, 0, 1]}
drives:
  motor: {joint: hub, angle: "w*t"}
analysis: {duration: "2*pi/w", samples: 3}
"""
# a bar that turns about two balls, one above the other: what they carry along their line is open
TWO_BALLS = (
    HANGING.replace(
        "pivot: {type: ball, from: ground.O, to: bar.top}",
        "pivot: {type: ball, from: ground.O, to: bar.top}\n"
        "  foot: {type: ball, from: {body: ground, at: [0, 0, -1]}, to: {body: bar, at: [0, 0, -1]}}",
    ).replace("center: [0, 0, -0.5]", "center: [0.1, 0, -0.5]")
    + "analysis: {duration: 1, samples: 3}\n"
)


def shaker(law: str = TONE, **values: object) -> Study:
    """The table, which is pushed across its guide by a law in time."""
    text = SHAKER.format(law)
    for name, value in values.items():
        head, _, tail = text.partition(f"{name}: ")
        text = f"{head}{name}: {value}{tail[min(i for i in map(tail.find, ',}') if i >= 0) :]}"
    return study(text)


def sizes(one: Collective) -> Array:
    """The ranges of all cycles, twice for a whole one, ascending."""
    return np.sort(np.repeat(one.cycles.ranges, (2.0 * one.cycles.counts).astype(int)))


def same_sizes(one: Collective, other: Array, scale: float = 1.0) -> None:
    """Assert that the ranges are these, each within its error."""
    mine = sizes(one)
    assert mine.shape == other.shape
    assert np.abs(mine - scale * other).max() <= 4.0 * one.history.error


def test_a_tone_is_as_many_cycles_as_turns_of_twice_its_amplitude() -> None:
    one = count_collective(shaker(), SIDE, slopes=(1.0, 3.0, 12.0))
    assert one.total_cycles == 5.0
    same_sizes(one, np.full(10, 20.0))
    for found in one.equivalents:  # 5 cycles of 20 N are one of 20 * 5^(1/m)
        assert abs(found.range - 20.0 * 5.0 ** (1.0 / found.slope)) <= found.error
        assert found.error < 1e-9
    assert one.counts.tolist() == [0.0] * 9 + [5.0]


def test_two_tones_are_counted_between_the_samples() -> None:
    """Two samples, five turns: the turns of a formula looked at a million times."""
    w = 20.0
    t = np.linspace(0.0, 10.0 * np.pi / w, 1_000_001)
    law = 10.0 * np.sin(w * t) + 4.0 * np.sin(7.0 * w * t + 1.0)
    cycles = count_once(law)
    one = count_collective(shaker(TWO_TONES), SIDE)
    wanted = np.sort(np.repeat(cycles.ranges, (2.0 * cycles.counts).astype(int)))
    mine = sizes(one)
    assert mine.shape == wanted.shape
    assert np.abs(mine - wanted).max() < 0.5 * 4.0 * (7.0 * w * (t[1] - t[0])) ** 2 * 2.0  # what a formula misses
    assert (mine - wanted).min() > -1e-9  # a summit is no lower than what stands beside it


@pytest.mark.parametrize(
    ("name", "path"),
    [
        ("crane", "joints.slew.force"), ("crane", "sections.along.M2@8"), ("spatial_crank", "joints.ball.force.y"),
        ("top", "energy.kinetic"), ("struck_door", "joints.high.force.y"),
    ],
)  # fmt: skip
@pytest.mark.third
def test_machines_looked_at_closely_have_the_same_cycles(name: str, path: str) -> None:
    """Solved with two samples, against 40,000 instants of the same run, which miss summits by some 1e-6 of them."""
    solved = heuncli.solve(SPECS / f"{name}.yaml", set={"analysis.samples": 2})
    one = solved.collective(path)
    values = solved[path].at(np.linspace(solved.time[0], solved.time[-1], 40_001))
    values = np.sqrt(np.sum(values**2, axis=1)) if values.ndim > 1 else values
    cycles, size = count_once(values), float(np.ptp(values))
    wanted = np.sort(np.repeat(cycles.ranges, (2.0 * cycles.counts).astype(int)))
    mine = sizes(one)
    mine, wanted = (own[own > 1e-4 * size] for own in (mine, wanted))
    assert len(mine) == len(wanted) > 0
    assert np.abs(mine - wanted).max() < 1e-4 * size


def test_scaled_turned_shifted_and_slowed() -> None:
    """Loads c times as large: ranges, too; turned round: the same; a mean moves none; time does not matter."""
    wanted = sizes(count_collective(shaker(TWO_TONES), SIDE))
    for values in ({"a": "30 N"}, {"a": "-10 N"}, {"w": "3.7"}):
        same_sizes(count_collective(shaker(TWO_TONES, **values), SIDE), wanted, 3.0 if values == {"a": "30 N"} else 1.0)
    same_sizes(count_collective(shaker(TWO_TONES + " + 1000"), SIDE), wanted)
    warped = TWO_TONES.replace("*t", "*(t + 0.02*sin(4*t)**2)")  # comes to the same phase at the end
    same_sizes(count_collective(shaker(warped, turns=5), SIDE), wanted)


def test_repeated_is_a_run_of_so_many_turns() -> None:
    long = count_collective(shaker(TWO_TONES, turns=7), SIDE, slopes=(4.0,))
    short = count_collective(shaker(TWO_TONES, turns=1), SIDE, slopes=(4.0,), repeat=7, cycles=1.0)
    same_sizes(short, sizes(long))
    assert abs(long.equivalents[0].range - short.equivalents[0].range) <= 2 * long.equivalents[0].error
    assert long.crossings.upward.tolist() == short.crossings.upward.tolist()


def test_closed_has_whole_cycles_only() -> None:
    one = count_collective(shaker(turns=1), SIDE, is_closed=True)
    assert one.cycles.counts.tolist() == [1.0]
    same_sizes(one, np.full(2, 20.0))


def test_the_bearing_of_a_wheel_out_of_balance() -> None:
    """m e w² turns with the wheel: across, one cycle of 2 m e w² a turn; on the ring that turns the weight does it."""
    unbalance, weight = 3 * 0.002 * 100**2, 3 * 9.81
    solved = study(ROTOR)
    for axis, mean in (("x", 0.0), ("y", weight)):
        one = count_collective(solved, f"joints.hub.force.{axis}", is_closed=True)
        same_sizes(one, np.full(2, 2 * unbalance))
        assert abs(one.cycles.means[0] - mean) <= one.history.error
    ring = count_collective(study(ROTOR, axes="to"), "joints.hub.force.y", is_closed=True)
    same_sizes(ring, np.full(2, 2 * weight))


def test_a_magnitude_has_lost_its_sign() -> None:
    """|a cos|: twice as many cycles of half the range; the kinks at zero are met."""
    one = count_collective(shaker(), "joints.guide.force")
    assert one.history.is_magnitude
    assert one.total_cycles == 10.0
    same_sizes(one, np.full(20, 10.0))


def test_both_sides_of_jumps_count() -> None:
    one = count_collective(shaker("a*(step(sin(w*t + 0.3)) + 0.1*w*t)"), SIDE)
    t = np.sort(np.concatenate([(np.arange(1, 11) * np.pi - 0.3) / 20.0] * 2))
    low = np.tile([1.0, 0.0, 0.0, 1.0], 5)
    rest = 10.0 * np.concatenate([[1.0], low + 2.0 * t, [1.0 + 0.1 * 20.0 * 10.0 * np.pi / 20.0]])
    rest[1:-1] = 10.0 * (low + 0.1 * 20.0 * t)
    cycles = count_once(rest)
    same_sizes(one, np.sort(np.repeat(cycles.ranges, (2.0 * cycles.counts).astype(int))))


def test_what_does_not_vary_has_no_cycles() -> None:
    """Noise of rounding is counted apart, in no class and no sum."""
    one = count_collective(study(ROTOR.replace("gravity: [0, -9.81, 0]\n", "")), "joints.hub.force", slopes=(3.0,))
    assert one.total_cycles == 0.0
    assert one.equivalents[0].range == 0.0
    assert 0.0 < one.equivalents[0].error <= 2.0 * one.below_error.range * one.below_error.cycles ** (1.0 / 3.0)


def test_the_error_covers_histories_within_it() -> None:
    """Random histories, moved by up to e: equivalent ranges differ by no more than is stated."""
    rng = np.random.default_rng(7)
    asked = Counting(slopes=(1.0, 3.0, 8.0))
    for _ in range(200):
        values, e = np.cumsum(rng.normal(size=60)), float(10.0 ** rng.uniform(-3, 0))
        moved = values + e * rng.choice([-1.0, 1.0, 0.3], size=60)
        one, other = (make_collective(LoadHistory("", "N", values, own, e), asked) for own in (values, moved))
        for mine, others in zip(one.equivalents, other.equivalents, strict=True):
            assert abs(mine.range - others.range) <= mine.error + 1e-12


def test_the_stated_error_covers_a_coarse_run() -> None:
    """A bar swings, told to three digits and to twelve."""
    coarse, fine = (
        count_collective(
            study(TURNED + "analysis: {duration: 5, samples: 3}\n", tolerance=tolerance), path, slopes=(3.0,)
        )
        for tolerance in (1e-5, 1e-12)
        for path in ("joints.pivot.force.z",)
    )
    assert coarse.total_cycles == fine.total_cycles > 3
    off = abs(coarse.equivalents[0].range - fine.equivalents[0].range)
    assert off <= coarse.equivalents[0].error < 1e-2 * fine.equivalents[0].range


@pytest.mark.parametrize(
    ("text", "path", "words"),
    [
        (HANGING, "joints.pivot.force.z", "needs a motion"),
        (SHAKER.format(TONE), "bodies.table.rotation", "is 9 numbers"),
        (SHAKER.format(TONE), "accuracy.balance_residual", "no time history"),
        (TWO_BALLS, "joints.pivot.force.z", "joints.pivot.force.z is open at t = 0 s"),
    ],
    ids=["state", "several", "constant", "open"],
)  # fmt: skip
def test_refused(text: str, path: str, words: str) -> None:
    with pytest.raises(HeunError, match=words) as caught:
        count_collective(study(text), path)
    assert all(problem.hint for problem in caught.value.problems)


def test_refused_beyond_the_horizon_and_where_a_cycle_does_not_close(heun: Heun) -> None:
    words = ("run", str(SPECS / "double.yaml"), "--set", "analysis.duration=60", "--collective", "joints.pivot.force")
    done = heun(*words)
    assert (done.returncode, done.stdout) == (3, "")
    assert "joints.pivot.force: not reliable from t = " in done.stderr
    done = heun(*words[:2], "--collective", "joints.pivot.force.z,joints.elbow.force", "--repeat", "3")
    assert (done.returncode, done.stdout) == (3, "")
    assert done.stderr.count("--repeat requires a periodic motion") == 2


def test_options_that_mean_nothing_are_refused_all_at_once(heun: Heun) -> None:
    done = heun("run", "hanging.yaml", "--slope", "0.5,x", "--cycles", "0", "--bins", "0", "--repeat", "2.5", "--all")
    assert done.returncode == 2
    assert "--slope applies to load spectra" in done.stderr
    done = heun(
        "run", "hanging.yaml", "--collective", "a,,b", "--slope", "0.5", "--cycles", "0", "--bins", "0", "--repeat",
        "2.5", "--all", "--measure", "time",
    )  # fmt: skip
    assert done.returncode == 2
    assert done.stderr.count("[bad-option]") == 6
    assert "cannot be combined with --measure, --all" in done.stderr


@pytest.mark.parametrize("cycles", [math.nan, 1e-308, math.inf])
def test_python_asks_alike(cycles: float) -> None:
    """The door gives the same object, and refuses ways to count that are none, by their names."""
    solved = heuncli.solve(text=SHAKER.format(TWO_TONES))
    one = solved.collective(SIDE, slopes=[3], repeat=2)
    other = count_collective(shaker(TWO_TONES), SIDE, slopes=(3.0,), repeat=2)
    assert one.equivalents == other.equivalents
    assert solved.collective(SIDE, slopes=np.int64(3), repeat=2).equivalents == one.equivalents
    with pytest.raises(heuncli.UsageError) as caught:
        solved.collective(SIDE, slopes=[0.5], cycles=cycles, bins=0, repeat=0)
    assert [problem.message.split()[0] for problem in caught.value.problems] == ["slopes", "cycles", "bins", "repeat"]


def test_forms(heun: Heun, folder: Path) -> None:
    """JSON as its schema says, alone and of all cases; CSV with the same numbers; tables in the units asked for."""
    cases = "cases: {soft: {set: {a: 1 N}}, hard: {set: {a: 50 N}}}\n"
    (folder / "shaker.yaml").write_text(SHAKER.format(TWO_TONES) + cases)
    words = ("run", "shaker.yaml", "--collective", f"{SIDE},joints.guide.force", "--slope", "3,5", "--bins", "4")
    alone = json.loads(heun(*words, "--format", "json").stdout)
    both = json.loads(heun(*words, "--format", "json", "--case", "all").stdout)
    for told in (alone, both):
        jsonschema.validate(told, make_results_schema())
    one = alone["collectives"][SIDE]
    assert sum(one["ranges"]["cycles"]) == one["cycles"] == sum(one["rainflow"]["count"])
    assert list(both["cases"]) == ["soft", "hard"]
    hard = both["cases"]["hard"]["collectives"][SIDE]
    assert hard["equivalent"][0]["range"] == pytest.approx(5.0 * one["equivalent"][0]["range"], rel=1e-9)
    lines = heun(*words, "--format", "csv").stdout.splitlines()
    assert f"{SIDE},equivalent_range,N,3.0,,,,,{one['equivalent'][0]['range']!r}" in lines
    assert {line.count(",") for line in lines} == {8}
    assert heun(*words, "--format", "csv", "--case", "all").stdout.startswith("case,path,")
    table = heun(*words, "--units", "kN").stdout
    assert "range above [kN]" in table
    assert "a magnitude has no sign" in table
    assert heun(*words, "--case", "all").stdout.count("EQUIVALENT RANGE") == 4
    assert "| slope m | cycles | range [N] | error [N] |" in heun(*words, "--format", "markdown").stdout


def test_blows_are_told_to_be_in_none(heun: Heun) -> None:
    done = heun("run", str(SPECS / "bouncing_ball.yaml"), "--collective", "stops.floor.force")
    assert "the impulses themselves (N·s)" in done.stdout
