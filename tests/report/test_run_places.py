"""Places along a series of cuts: by distance, by end and by number, in every path, whatever rows loads add to it."""

from __future__ import annotations

import json

import numpy as np
import pytest

from heuncli.app.cli.entry import UsageError
from heuncli.base.errors import SpecError
from heuncli.output.tables import measure
from heuncli.output.tables.export import to_csv
from heuncli.results.path_hints import iter_readings
from heuncli.results.path_words import join_path, split_path
from heuncli.results.results_paths import find_values
from heuncli.study.quantities.labels import make_labels
from tests.shared.scenes import near, study

P, LUG, END, W = 30.0, 0.3, 0.7, 4.0 * 9.81
SPACING = END / 14
TEXT = """
heun: 1
gravity: [0, 0, -9.81]
ground: {points: {O: [0, 0, 0]}}
bodies:
  arm:
    shapes: [{type: rod, from: [0, 0, 0], to: [0.7, 0, 0], mass: 4}]
    points: {O: [0, 0, 0], lug: [0.3, 0, 0], end: [0.7, 0, 0]}
joints: {wall: {type: weld, from: ground.O, to: arm.O}}
forces: {pull: {type: force, on: arm.lug, vector: [0, 0, "-30*(1 + t)"]}}
sections:
  arm: {body: arm, from: O, to: end, count: 15, first_axis: [0, 0, 1]}
  one: {body: arm, at: [0.1, 0, 0], normal: [1, 0, 0]}
analysis: {times: [0, 1]}
"""
ARM = study(TEXT + "impulses: {blow: {on: arm.lug, vector: [0, 0, -2], time: 0.5}}\n")
RESULTS = ARM.results


def shear(s: float, t: float, beyond: bool) -> float:
    """Q1 by the beam book, with the other sign: what hangs beyond the cut."""
    return -W * (END - s) / END - (0.0 if s > LUG or (beyond and s == LUG) else P * (1.0 + t))


@pytest.mark.parametrize(
    ("place", "s", "beyond"),
    [
        *((f"@{k * SPACING!r}", k * SPACING, False) for k in (0, 3, 7, 14)),
        *((f".{k}", k * SPACING, False) for k in (0, 3, 7, 14)),
        ("@50mm", 0.05, False),
        ("@5cm", 0.05, False),
        ("@start", 0.0, False),
        ("@end", END, False),
        ("@.35", 0.35, False),
        ("@3.5e-1", 0.35, False),
        ("@0.3:before", LUG, False),
        ("@0.3:beyond", LUG, True),
        (".6:before", LUG, False),
        (".6:beyond", LUG, True),
        ("@0.35:before", 0.35, False),
    ],
)
def test_a_place_is_the_same_whatever_acts_before_it(place: str, s: float, beyond: bool) -> None:
    assert len(RESULTS.sections["arm"]["s"]) == 16  # 15 cuts, and one more row at the lug
    found = find_values(RESULTS, f"sections.arm.Q1{place}")
    assert found.is_timed
    for k, t in enumerate((0.0, 1.0)):
        near(found.values[k], shear(s, t, beyond), W + P)
    near(find_values(RESULTS, f"sections.arm.force{place}.z").values, found.values, W + P)
    if "@" in place:
        near(find_values(RESULTS, f"sections.arm.force.z{place}").values, found.values, W + P)
        assert (
            find_values(RESULTS, f"sections.arm.Q1{place}.1" if ":" in place else f"sections.arm.Q1.1{place}").instant
            == 1
        )


def test_where_both_rows_agree_no_side_is_asked_for() -> None:
    bending = -W * (END - LUG) ** 2 / (2.0 * END)
    for place in ("@0.3", ".6", "@0.3:before", "@0.3:beyond"):
        near(find_values(RESULTS, f"sections.arm.M2{place}").values, np.full(2, bending), W)
        near(find_values(RESULTS, f"sections.arm.s{place}").values, np.array(LUG), 1.0)


def test_of_a_blow() -> None:
    for place, value in (("@0.3:before", -2.0), ("@0.3:beyond", 0.0), ("@0.25", -2.0), ("@end", 0.0)):
        near(find_values(RESULTS, f"impulses.0.sections.arm.Q1{place}").values, np.array(value), 2.0)


@pytest.mark.parametrize(
    ("path", "message", "hint"),
    [
        ("arm.Q1@0.3", "so the values on its two sides differ", "@0.3:before or @0.3:beyond"),
        ("arm.Q1.6", "so the values on its two sides differ", "6:before or 6:beyond"),
        ("arm.Q1@0.33", "the nearest are at @0.3 and @0.35", "a count other than 15"),
        ("arm.Q1@0.8", "the run is 0.7 m long", "@end"),
        ("arm.Q1.15", "the series has 15 cuts, 0 to 14", "14"),
        ("arm.Q1@start:before", "the series begins there, with the cut just beyond", "@start:beyond"),
        ("arm.Q1@end:beyond", "", ""),
        ("arm.Q1@0.3:under", "is not a position along a series of cuts", ":before or :beyond"),
        ("arm.Q1@middle", "is not a position along a series of cuts", "@start or @end"),
        ("arm.Q1@3deg", "deg is an angle", "@280mm"),
        ("arm.Q1@3parsec", "'parsec' is not a unit", "@280mm"),
        ("one.Q1@0.1", "has no '@0.1'", "a position along a series of cuts"),
    ],
)
def test_what_is_no_place(path: str, message: str, hint: str) -> None:
    if not message:  # nothing acts at the end: either side is the one row
        near(find_values(RESULTS, f"sections.{path}").values, np.zeros(2), W)
        return
    with pytest.raises(SpecError) as caught:
        find_values(RESULTS, f"sections.{path}")
    (problem,) = caught.value.problems
    assert problem.code == "unknown-path"
    assert message in problem.message
    assert hint in problem.hint


def test_a_place_is_measured_between_the_samples_too() -> None:
    swing = study(TEXT.replace("-30*(1 + t)", "-30*sin(3*t)").replace("[0, 1]", "[0, 0.4, 1]"))
    for place, side in (("@0.3:before", 1.0), ("@0.3:beyond", 0.0), ("@0.25", 1.0)):
        s = LUG if "0.3" in place else 0.25
        found = float(measure.format_measures([measure.parse_measure(f"min sections.arm.Q1{place}")], swing, "table"))
        near(found, -W * (END - s) / END - side * P, W + P, 1e-9)


def test_the_number_told_of_a_cut_is_the_one_that_paths_take() -> None:
    text = measure.format_measures([measure.parse_measure("at 1 sections.arm.M2@0.5")], ARM, "json")
    peak = json.loads(measure.format_measures([measure.parse_measure("max sections.arm.Q1")], ARM, "json"))
    assert (peak["s"], peak["cut"]) == (END, 14)
    near(json.loads(text)["value"], -W * 0.2**2 / (2.0 * END), W)
    lines = [line.split(",") for line in to_csv(RESULTS, make_labels(ARM.spec)).splitlines()]
    cuts = [line[-3:] for line in lines if line[1:4] == ["sections", "arm", "Q1"] and line[0] == "0.0"]
    assert [int(cut) for cut, _, _ in cuts] == [0, 1, 2, 3, 4, 5, 6, 6, *range(7, 15)]
    assert [side for _, _, side in cuts][5:9] == ["", "before", "beyond", ""]


def test_a_place_is_judged_before_the_run() -> None:
    with pytest.raises(SpecError, match="no cut was requested there"):
        measure.require_known_paths([measure.parse_measure("max abs sections.arm.M2@0.33")], ARM.spec)
    with pytest.raises(UsageError):
        measure.parse_measure("max sections.arm.M2 @0.3")
    wrong = TEXT + "expect: [{of: sections.arm.Q1@0.3:under, is: 1}, {of: joints.wall.force@0.3, is: 1}]\n"
    with pytest.raises(SpecError) as caught:
        study(wrong)
    assert [problem.code for problem in caught.value.problems] == ["expect-path", "expect-path"]


def test_words_and_paths() -> None:
    for path in (
        "a.M2@0.28",
        "a.force@0.28.z",
        "a.force.z@280mm:before",
        "a.M2.7:before",
        "a.M2@1.5e-3:beyond.0",
        "a.b",
    ):
        assert join_path(split_path(path)) == path
    assert split_path("a.force@0.28.z") == ["a", "force", "@0.28", "z"]
    assert ["sections", "arm", "M2", "@0.28"] in list(iter_readings(split_path("arm.M2@0.28")))
