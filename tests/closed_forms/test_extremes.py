"""Extremes by closed forms: between the samples, through zero, over the whole stretch of a series of cuts."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np
import pytest

from heuncli.output.documents.document import format_cell
from heuncli.output.tables import measure
from heuncli.output.tables.page import make_page
from heuncli.results.results import Extremes
from heuncli.results.results_schema import REPORTS
from heuncli.study.quantities.labels import make_labels
from heuncli.study.queries.study import Study
from heuncli.study.search.extremes import search_extremes
from tests.shared.measured import measured
from tests.shared.scenes import near, study

pytestmark = pytest.mark.heavy  # families: the plain kernel has the same bits (tests/package/test_kernels_agree.py)

G = 9.81


def in_table(run: Study, heading: str, label: str) -> list[str]:
    """The cells of a row of the tables with this heading."""
    page = make_page(run.results, make_labels(run.spec), run.magnitudes)
    found = run.search_extremes(page.make_search(), frozenset(REPORTS), whole=True)
    one = len(run.results.time) == 1
    tables = (
        page.make_tables_at_instants(run.results, search_result=found) if one else page.make_tables_of_extremes(found)
    )
    table = next(t for t in tables if t.heading.startswith(heading) and any(row[0] == label for row in t.rows))
    return list(map(format_cell, next(row for row in table.rows if row[0] == label)))


# ---- in time
RATES, ARMS, MASSES = (27.0, 41.3, 66.1), (0.05, 0.03, 0.02), (4.0, 3.0, 2.0)


def rotors(turns: float = 54.0, samples: int = 21) -> Study:
    """Three unbalanced rotors on one ground, the fastest of which turns 54 times."""
    bodies, joints, drives = {}, {}, {}
    for k, (rate, arm, mass) in enumerate(zip(RATES, ARMS, MASSES, strict=True)):
        shapes = [{"type": "point", "at": [arm, 0.0, 0.0], "mass": mass}, {"type": "sphere", "center": [0.0, 0.0, 0.0],
                  "radius": 0.05, "mass": 1.0}]  # fmt: skip
        bodies[f"b{k}"] = {"shapes": shapes, "points": {"O": [0.0, 0.0, 0.0]}}
        joints[f"p{k}"] = {"type": "pin", "from": "ground.O", "to": f"b{k}.O", "axis": [0, 0, 1]}
        drives[f"d{k}"] = {"joint": f"p{k}", "angle": f"{rate}*t"}
    duration = 2.0 * np.pi * turns / RATES[-1]
    return study({
        "gravity": [0, 0, 0], "ground": {"points": {"O": [0.0, 0.0, 0.0]}}, "bodies": bodies,
        "joints": joints, "drives": drives, "analysis": {"duration": float(duration), "samples": samples},
    })  # fmt: skip


def thrown(t: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """The force of the rotors on the ground, x and y."""
    waves = [
        m * a * w * w * np.stack([np.cos(w * t), np.sin(w * t)]) for w, a, m in zip(RATES, ARMS, MASSES, strict=True)
    ]
    x, y = np.sum(waves, axis=0)
    return x, y


@pytest.mark.parametrize("samples", [2, 21])
@pytest.mark.third
def test_the_highest_of_many_summits_between_few_samples(samples: int) -> None:
    """Driven rotors need no steps: their loads turn all the same."""
    run = rotors(samples=samples)
    t = np.linspace(0.0, run.results.time[-1], 2_000_001)
    x, y = thrown(t)
    size = float(np.hypot(x, y).max())
    for words, exact in (("max foundation.force", size), ("min foundation.force", np.hypot(x, y).min()),
                         ("max foundation.force.x", x.max()), ("abs foundation.force.y", np.abs(y).max())):  # fmt: skip
        # two million samples miss a summit by (66 * 7e-6 / 2)^2 / 2 of its size, and a crossing of zero by more
        near(measured(run, words)["value"], exact, size, 1e-6)
    assert measured(run, "max foundation.force")["value"] >= size * (1.0 - 1e-12)
    low, high = in_table(run, "FOUNDATION", "|F|")[4:7:2]
    for text, words in ((low, "min foundation.force"), (high, "max foundation.force")):
        near(float(text), measured(run, words)["value"], size, 2e-6)  # six digits


def test_a_magnitude_through_zero() -> None:
    """A mass on a turning arm, fast enough to weigh nothing at the top: its pin carries 2 m g |cos(φ/2)|."""
    r, m = 0.4, 3.0
    rate = float(np.sqrt(G / r))
    run = study({
        "gravity": [0, -G, 0], "ground": {"points": {"O": [0, 0, 0]}},
        "bodies": {"arm": {"shapes": [{"type": "sphere", "center": [r, 0, 0], "radius": 0.05, "mass": m}],
                           "points": {"O": [0, 0, 0]}}},
        "joints": {"pin": {"type": "pin", "from": "ground.O", "to": "arm.O", "axis": [0, 0, 1]}},
        "drives": {"turn": {"joint": "pin", "angle": f"{rate!r}*t - pi/2"}},
        "analysis": {"duration": float(2.0 * np.pi / rate), "samples": 8},
    })  # fmt: skip
    for quantity in ("radial", "force"):
        near(measured(run, f"min joints.pin.{quantity}")["value"], 0.0, m * G, 1e-11)
        near(measured(run, f"max joints.pin.{quantity}")["value"], 2.0 * m * G, m * G, 1e-11)
        near(measured(run, f"min joints.pin.{quantity}")["at"], np.pi / rate, 1.0, 1e-10)
    assert in_table(run, "JOINTS", "radial")[4] == "0"


# ---- along series of cuts
RADIUS, DENSITY, AT, END, PUSH = 0.02, 7850.0, 0.37, 0.55, 500.0


def shaft(count: int, middle: bool = False, **more: Any) -> Study:
    """A shaft on bearings at 0 and AT, pushed down at its free end; a third bearing makes it redundant."""
    points = {"A": [0.0, 0.0, 0.0], "B": [AT, 0.0, 0.0], **({"C": [0.2, 0.0, 0.0]} if middle else {})}
    joints = {"left": {"type": "ball", "from": "ground.A", "to": "shaft.A"}}
    for name in sorted(points.keys() - {"A"}):
        joints[name] = {"type": "line", "from": f"ground.{name}", "to": f"shaft.{name}", "axis": [1, 0, 0]}
    return study({
        "gravity": [0, 0, -G], "ground": {"points": points},
        "bodies": {"shaft": {"shapes": [{"type": "cylinder", "from": [-0.05, 0, 0], "to": [END, 0, 0],
                                         "radius": RADIUS, "density": DENSITY}],
                             "points": {**points, "end": [END, 0.0, 0.0]}}},
        "joints": joints,
        "forces": {"push": {"type": "force", "on": "shaft.end", "vector": [0, 0, -PUSH]}},
        "sections": {"shaft": {"body": "shaft", "from": [-0.05, 0, 0], "to": [END, 0, 0], "count": count, **more}},
        "analysis": {"type": "state"},
    })  # fmt: skip


WEIGHT = np.pi * RADIUS**2 * DENSITY * G
ARM = END - AT


@pytest.mark.parametrize("count", [2, 5, 8, 12, 24])
def test_the_bearing_moment_whatever_cuts_are_asked(count: int) -> None:
    """|M| = P a + w a²/2 at the bearing, between all asked cuts; the shear force jumps there."""
    run = shaft(count)
    found = measured(run, "max abs sections.shaft.M1")
    near(found["value"], PUSH * ARM + 0.5 * WEIGHT * ARM**2, 100.0, 1e-12)
    near(found["s"], AT + 0.05, 1.0, 1e-12)
    shear = measured(run, "min sections.shaft.Q2")
    near(shear["value"], -PUSH - WEIGHT * ARM, 100.0, 1e-12)
    assert (shear["side"], shear["cut"]) == ("beyond", None)
    lift = (PUSH * ARM + 0.5 * WEIGHT * (ARM**2 - (AT + 0.05) ** 2) + WEIGHT * 0.05 * AT) / AT
    assert measured(run, "max sections.shaft.Q2")["side"] == "before"
    assert lift > 0.0
    value, place = in_table(run, "SECTION shaft", "M1")[4:]
    assert value == f"{found['value']:.4f}"
    assert place in {"0.42 before", "0.42 beyond"}  # the moment does not jump: rounding decides which is larger
    assert len(run.results.sections["shaft"]["s"]) == count


def test_the_largest_moment_between_bearings_under_the_own_weight() -> None:
    """A bar on its ends: w L²/8 in its middle, which no cut of four meets."""
    run = study({
        "gravity": [0, 0, -G], "ground": {"points": {"A": [0, 0, 0], "B": [2.0, 0, 0]}},
        "bodies": {"bar": {"shapes": [{"type": "rod", "from": [0, 0, 0], "to": [2.0, 0, 0], "line_density": 3.0}],
                           "points": {"A": [0, 0, 0], "B": [2.0, 0, 0]}}},
        "joints": {"a": {"type": "ball", "from": "ground.A", "to": "bar.A"},
                   "b": {"type": "line", "from": "ground.B", "to": "bar.B", "axis": [1, 0, 0]}},
        "sections": {"bar": {"body": "bar", "from": "A", "to": "B", "count": 4}}, "analysis": {"type": "state"},
    })  # fmt: skip
    for words in ("max abs sections.bar.M1", "max sections.bar.moment"):
        found = measured(run, words)
        near(found["value"], 3.0 * G * 2.0**2 / 8.0, 1.0, 1e-12)
        near(found["s"], 1.0, 1.0, 1e-7)
        assert (found["side"], found["cut"]) == (None, None)


def test_a_stress_between_the_cuts() -> None:
    """At the bearing: bending of P a + w a²/2 over W, beside no other normal stress."""
    run = shaft(5, properties={"circle": {"radius": RADIUS}}, strength=235e6)
    most = (PUSH * ARM + 0.5 * WEIGHT * ARM**2) / (0.25 * np.pi * RADIUS**3)
    near(measured(run, "max sections.shaft.stress.normal_max")["value"], most, most, 1e-9)
    assert measured(run, "max sections.shaft.stress.utilisation")["value"] * 235e6 >= most * (1.0 - 1e-9)


def test_open_in_part_is_open() -> None:
    """Beyond the last bearing the moment is certain, between the three it is not: nobody knows the largest."""
    run = shaft(5, middle=True)
    assert measured(run, "max abs sections.shaft.M1")["value"] is None
    assert measure.format_measures([measure.parse_measure("max sections.shaft.moment")], run, "table") == "open\n"
    assert in_table(run, "SECTION shaft", "M1")[2] == "open"
    assert measured(run, "max abs sections.shaft.N")["value"] == 0.0
    assert measured(run, "max abs sections.shaft.M1.3")["value"] > 0.0  # of a cut that is certain


@pytest.mark.parametrize("count", [2, 7])
def test_under_a_trolley_that_runs_along_a_beam(count: int) -> None:
    """Its weight P at x bends the beam by P x (L − x)/L there, its own weight by w x (L − x)/2: most in the middle."""
    length, own, mass, speed = 3.0, 7.0, 40.0, 0.5
    ends = {"A": [0, 0, 0], "B": [length, 0, 0]}
    run = study({
        "gravity": [0, 0, -G], "ground": {"points": ends},
        "bodies": {
            "beam": {"shapes": [{"type": "rod", "from": [0, 0, 0], "to": [length, 0, 0], "line_density": own}],
                     "points": ends},
            "trolley": {"shapes": [{"type": "sphere", "center": [0, 0, 0], "radius": 0.05, "mass": mass}],
                        "points": {"O": [0, 0, 0]}, "position": [0.4, 0, 0]},
        },
        "joints": {"a": {"type": "ball", "from": "ground.A", "to": "beam.A"},
                   "b": {"type": "line", "from": "ground.B", "to": "beam.B", "axis": [1, 0, 0]},
                   "run": {"type": "slide", "from": "beam.A", "to": "trolley.O", "axis": [1, 0, 0]}},
        "drives": {"drive": {"joint": "run", "travel": f"0.4 + {speed}*t"}},
        "sections": {"beam": {"body": "beam", "from": "A", "to": "B", "count": count}},
        "analysis": {"duration": 4.0, "samples": 5},
    })  # fmt: skip
    found = measured(run, "max abs sections.beam.M1")
    most = 0.25 * mass * G * length + 0.125 * own * G * length**2
    near(found["value"], most, most, 1e-11)
    near(found["at"], (0.5 * length - 0.4) / speed, 1.0, 1e-5)
    near(found["s"], 0.5 * length, 1.0, 1e-5)
    # the shear force is largest at the end that the trolley is nearest to: in the beginning, before it
    near(
        measured(run, "max abs sections.beam.Q2")["value"],
        mass * G * (1.0 - 0.4 / length) + 0.5 * own * G * length,
        most,
        1e-11,
    )


# ---- peaks of the same height
TURN = 2.0 * np.pi


def first_extremes(f: Callable[[np.ndarray], np.ndarray], error: float, turns: float = 5.2, **more: Any) -> Extremes:
    """The extremes of f over some turns, from 17.3 samples a turn."""
    times = np.arange(0.0, turns * TURN, TURN / 17.3)
    return search_extremes(lambda t: f(t)[:, None], times, errors=np.array([error]), **more)


@pytest.mark.parametrize("phase", [0.0, 0.3, 1.1, 2.5, 4.0])
def test_the_first_of_equal_peaks_is_named(phase: float) -> None:
    found = first_extremes(lambda t: np.sin(t + phase), 1e-13)
    near(found.high, [1.0], 1.0, 1e-13)
    near(found.high_at, [(0.25 * TURN - phase) % TURN], TURN, 1e-6)
    near(found.low_at, [(0.75 * TURN - phase) % TURN], TURN, 1e-6)


@pytest.mark.parametrize(
    ("growth", "error", "turn"),
    [(1e-9, 1e-10, 5), (1e-9, 1e-8, 0), (-1e-9, 1e-10, 0), (1e-5, 1e-6, 5), (1e-5, 2e-5, 5)],
)
def test_a_later_peak_is_named_if_it_is_higher_by_more_than_the_error(growth: float, error: float, turn: int) -> None:
    """The last row: numbers known to fewer than six digits are not compared with their error."""
    found = first_extremes(lambda t: (1.0 + growth * t / TURN) * np.sin(t), error, turns=5.9)
    near(found.high_at, [(0.25 + turn) * TURN], TURN, 1e-4)


def test_the_first_of_equal_magnitudes_and_of_two_columns() -> None:
    found = first_extremes(lambda t: (np.sin(t) + 0.2) ** 2, 1e-13, is_squared=np.array([True]))
    near([found.high[0], found.high_at[0]], [1.44, 0.25 * TURN], TURN, 1e-6)
    times = np.arange(0.0, 4.6 * TURN, TURN / 17.3)
    both = search_extremes(lambda t: np.stack([np.sin(t), np.cos(t - 1.0)], axis=1), times, [[0, 1]])
    near(both.high_at, [1.0], TURN, 1e-6)
    assert both.high_column.tolist() == [1]


def test_all_loads_of_a_press_are_greatest_in_its_first_turn() -> None:
    """Two turns of a driven slider-crank: each row names the first, whatever rounding makes of the second."""
    run = study("""
heun: 1
space: planar
gravity: [0, 0, 0]
ground: {points: {O: [0, 0, 0], G: [0.9, 0, 0]}}
bodies:
  crank: {mass: 2, center: [0.05, 0, 0], inertia: 0.01, points: {O: [0, 0, 0], A: [0.1, 0, 0]}}
  rod: {mass: 3, center: [0.25, 0, 0], inertia: 0.06, points: {A: [0, 0, 0], B: [0.5, 0, 0]}}
  ram: {mass: 20, center: [0, 0, 0], inertia: 0.1, points: {B: [0, 0, 0]}}
joints:
  O: {type: pin, from: ground.O, to: crank.O}
  A: {type: pin, from: crank.A, to: rod.A}
  B: {type: pin, from: rod.B, to: ram.B}
  G: {type: slide, from: ground.G, to: ram.B, axis: [1, 0, 0]}
drives: {motor: {joint: O, angle: 30*t}}
forces: {press: {type: force, on: ram.B, vector: ["-20 kN*max(0, sin(30*t))", 0, 0]}}
analysis: {duration: 0.4, samples: 101}
""")
    page = make_page(run.results, make_labels(run.spec), run.magnitudes)
    found = run.search_extremes(page.make_search(), frozenset(REPORTS), whole=True)
    names = [k for k, path in enumerate(found.paths) if path.split(".")[0] in ("joints", "foundation", "forces")]
    assert len(names) > 20
    assert max(*found.low_at[names], *found.high_at[names]) < TURN / 30.0
