"""One schema of results: shapes come from it and never from an array's length, and what is asked for fits it."""

from __future__ import annotations

from typing import get_args

import numpy as np
import pytest

from heuncli.base.errors import HeunError, SpecError
from heuncli.base.units import parse_unit
from heuncli.output.tables import measure
from heuncli.output.tables.export import to_csv
from heuncli.output.tables.page import select_instants
from heuncli.results.path_words import TREE, Node, find_quantity
from heuncli.results.results import Results
from heuncli.results.results_paths import find_values
from heuncli.results.results_schema import REPORTS, ROWS, Quantity
from heuncli.scene.file_format.format import Report
from heuncli.scene.file_format.load import load
from tests.shared.fakes import LABELS, FakeStudy, pendulum, vectors

T = np.linspace(0.0, 2.0, 5)


def run_of(count: int, t: np.ndarray = T) -> dict[str, object]:
    """A series of cuts; at the cut k M2 is k + 1 times a wave, so that the last one has the largest."""
    wave = np.sin(t)[:, None] * np.arange(1.0, count + 1.0)
    force = np.stack([vectors(t, k, 0.0, 0.0) for k in range(count)], axis=1)
    s = np.linspace(0.0, 1.0, count)
    return {"s": s, "side": [None] * count, "normal": vectors(t, 1.0, 0.0, 0.0), "force": force,
            **dict.fromkeys(("N", "Q1", "Q2", "T", "M1", "M2"), wave)}  # fmt: skip


class Cuts(FakeStudy):
    """A study with one run of as many cuts as `changes` says."""

    def resample(self, times: np.ndarray) -> Results:
        """At any instants."""
        t = np.asarray(times)
        return pendulum(t, sections={"run": run_of(int(self.changes["count"]), t)})


def number(words: str, count: int) -> float:
    return float(measure.format_measures([measure.parse_measure(words)], Cuts(T, {"count": count}), "table"))


@pytest.mark.parametrize("count", [2, 3, 4])
def test_a_run_of_three_cuts_is_no_vector(count: int) -> None:
    """Its extremes are those of its cuts, and no magnitude over them."""
    assert number("max abs sections.run.M2", count) == pytest.approx(count, rel=1e-9)
    assert number("min sections.run.M2", count) == pytest.approx(0.0, abs=1e-9)
    assert number("max sections.run.force", count) == pytest.approx(count - 1.0, rel=1e-12)
    for how in ("first", "final", "at 0.5"):
        with pytest.raises(HeunError, match=f"is {count} numbers"):
            number(f"{how} sections.run.M2", count)


@pytest.mark.parametrize("count", [2, 3, 4])
def test_letters_are_of_space_and_cuts_are_counted(count: int) -> None:
    results = pendulum(T, sections={"run": run_of(count)})
    with pytest.raises(SpecError, match=f"has no 'x'; known: 0 ... {count - 1}"):
        find_values(results, "sections.run.M2.x")
    assert find_values(results, "sections.run.force.1.x").values.shape == T.shape
    assert find_values(results, "sections.run.force.1").is_vector
    assert not find_values(results, "sections.run.M2").is_vector
    components = {line.split(",")[4] for line in to_csv(results, LABELS).splitlines() if ",run,M2," in line}
    assert components == {str(cut) for cut in range(count)}


def test_what_stands_for_all_instants_is_not_cut_with_them() -> None:
    """Three cuts, three components of a point, at three instants: only the instants are shortened."""
    t = T[:3]
    whole = pendulum(t, sections={"run": run_of(3, t)}, certain_sums=[
        {"terms": {"joints.a.force.x": np.ones(3), "joints.b.force.x": 1.0}, "value": t},
    ])  # fmt: skip
    short = select_instants(whole, slice(1))
    assert short.time.shape == (1,)
    assert short.sections["run"]["s"].shape == (3,)
    assert short.sections["run"]["M2"].shape == (1, 3)
    assert short.foundation["about"].shape == (3,)
    assert short.certain_sums[0]["value"].shape == short.certain_sums[0]["terms"]["joints.a.force.x"].shape == (1,)


SCENE = """
heun: 1
bodies:
  b: {{shapes: [{{type: rod, from: [0, 0, 0], to: [1, 0, 0], mass: 1}}], points: {{p: [1, 0, 0]}}}}
sections:
  run: {{body: b, from: [0.1, 0, 0], to: [0.9, 0, 0], count: 3}}
  one: {{body: b, at: [0.5, 0, 0], normal: [1, 0, 0], reduce_to: line}}
analysis: {{times: [0, 0.5, 1]}}
expect: [{}]
"""


def judged(item: str) -> str:
    try:
        load("x.yaml", text=SCENE.format(item))
    except SpecError as error:
        return "\n".join(str(problem) for problem in error.problems)
    return ""


@pytest.mark.parametrize(
    ("item", "message"),
    [
        ("{of: sections.run.M2.x, at: 0, is: 1}", "'x' is not a result"),
        ("{of: sections.run.M2.2, at: 0, is: 1}", ""),
        ("{of: sections.run.force.2.x, at: 0, is: 1}", ""),
        ("{of: sections.one.force.x, at: 0, is: 1}", ""),
        ("{of: sections.one.line.kind, at: 0, is: 1}", ""),
        ("{of: sections.one.force, at: 0, is: 1}", "give one of its numbers, such as sections.one.force.x"),
        ("{of: sections.run.M2, at: 0, is: 1}", "give one of its numbers, such as sections.run.M2.0"),
        ("{of: energy.kinetic, is: [1, 2]}", "give one of its numbers, such as energy.kinetic.0"),  # of three instants
        ("{of: points.b.p.position.z, at: 0, is: 1}", ""),
        ("{of: points.b.q.position.z, at: 0, is: 1}", "did you mean b.p?"),
        ("{of: points.b, at: 0, is: 1}", "'b' is not a result"),
    ],
)
def test_expectations_know_the_shapes(item: str, message: str) -> None:
    told = judged(item)
    assert message in told
    assert bool(told) == bool(message)


def test_every_unit_has_a_dimension() -> None:
    for row in ROWS:
        for unit in row.units:
            assert parse_unit(unit)[0] == 1.0, row.path


def test_every_row_is_found_by_its_path() -> None:
    for row in ROWS:
        assert find_quantity(row.path.split(".")) is row
    assert find_quantity(("joints", "elbow", "forc")) is None
    assert find_quantity(("joints", "elbow")) is None
    blow = find_quantity(("impulses", "3", "joints", "elbow", "force"))
    assert blow is not None
    assert blow.units == ("N·s",)


def test_the_format_asks_for_the_reports_there_are() -> None:
    assert get_args(Report) == (*REPORTS, "shares")


def leaves(node: Node) -> list[Quantity]:
    return [row for below in node.values() for row in (leaves(below) if isinstance(below, dict) else [below])]


def test_a_blow_has_rows_of_its_own() -> None:
    assert len(leaves(TREE)) > len(ROWS)
