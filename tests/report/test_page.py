"""The tables as a whole: what a reader finds on them."""

from __future__ import annotations

import dataclasses
from collections.abc import Callable
from typing import Any

import numpy as np
import pytest

from heuncli.output.documents.as_text import format_plain
from heuncli.output.documents.document import format_cell
from heuncli.output.tables.extremes_tables import MAX_FULL_GROUPS
from heuncli.output.tables.page import Page, make_page
from heuncli.results.results import Array, Extremes, Results
from heuncli.study.search import extremes as peaks
from tests.shared.fakes import ACCURATE, LABELS, MAGNITUDES, FakeStudy, found_extremes, pendulum, restrict, vectors
from tests.shared.heading import format_heading

T = np.linspace(0.0, 2.0, 21)


def extremes_page(
    study: FakeStudy, wanted: frozenset[str] = frozenset({"foundation", "joints", "energy", "sections"})
) -> str:
    page = make_page(restrict(study.results, wanted), LABELS, MAGNITUDES)
    found = found_extremes(study, page, wanted)
    return "\n".join(format_plain(table) for table in page.make_tables_of_extremes(found))


def line_of(text: str, group: str, label: str) -> list[str]:
    """The cells of a row in a group."""
    lines = text.splitlines()
    start = next(i for i, line in enumerate(lines) if line.startswith(f"{group}  ") or line == group)
    return next(line.split() for line in lines[start + 1 :] if line.split()[:1] == [label])


def test_headings_say_on_what_by_what_in_which_axes_about_which_point() -> None:
    text = extremes_page(FakeStudy(T))
    assert "FOUNDATION  force and moment ON the ground, world axes, moment about O = (0, 0, 0) m" in text
    assert (
        'JOINTS  reaction of "from" on "to"; drive and friction are listed separately; world axes, '
        'moment about the "to" point' in text
    )
    assert (
        "SECTION along, body lower  force of the far side on the near side of the cut; N > 0 tension; "
        "e1 = body x, e2 = n × e1; moments about the cut's point" in text
    )
    assert "pivot  ball, ground.O → upper.top" in text


def test_extremes_are_those_between_the_samples_with_their_instants() -> None:
    text = extremes_page(FakeStudy(T))
    assert line_of(text, "pivot", "Fx") == ["Fx", "N", "0", "-2.2704", "-2.2704", "2.0", "3.0000", "0.7854"]
    assert line_of(text, "pivot", "Fz") == ["Fz", "N", "10.8100", "9.1564", "8.8100", "1.5708", "10.8100", "0"]


def test_a_minimum_of_a_magnitude_is_found_though_it_has_a_kink_there() -> None:
    assert line_of(extremes_page(FakeStudy(T[1:])), "elbow", "|M|")[4:6] == ["0", "1.5708"]


def test_a_constant_has_no_instant() -> None:
    text = extremes_page(FakeStudy(T))
    assert next(line for line in text.splitlines() if line.startswith("sum")).split()[2:] == ["0.5"] * 4


def test_what_is_0_throughout_takes_no_line_but_is_told() -> None:
    text = extremes_page(FakeStudy(T))
    pivot = text[text.index("pivot  ball") : text.index("elbow  pin")]
    assert [line.split()[0] for line in pivot.splitlines()[1:]] == ["Fx", "Fz", "|F|"]
    assert "Rows that are zero at all times are not shown." in text
    nothing = FakeStudy(T, {"joints": {"idle": {"force": np.zeros((len(T), 3)), "point": np.zeros((len(T), 3))}}})
    alone = make_page(restrict(nothing.results, {"joints"}), LABELS, MAGNITUDES)
    zero, paths = np.zeros(4), tuple(f"joints.idle.force{part}" for part in (".x", ".y", ".z", ""))
    (table,) = alone.make_tables_of_extremes(
        Extremes(zero, zero, zero.astype(int), zero, zero, zero.astype(int), is_searched=True, paths=paths)
    )
    assert "idle\n  all values 0\n" in format_plain(table)


def test_a_lone_support_is_not_told_twice() -> None:
    text = extremes_page(FakeStudy(T))
    assert "support pivot" not in text
    assert "carried entirely by pivot, the only support" in text


def test_several_supports_are_shown_each() -> None:
    def two(results: Results) -> Results:
        half = {"force": 0.5 * results.foundation["force"], "moment": results.foundation["moment"]}
        return dataclasses.replace(
            results, foundation={**results.foundation, "supports": {"pivot": half, "elbow": half}}
        )

    text = extremes_page(Changed(T, change=two))
    assert "support pivot  ball, ground.O → upper.top" in text
    assert "support elbow" in text


@dataclasses.dataclass(frozen=True, eq=False)
class Changed(FakeStudy):
    """A fake study whose results are changed at all instants."""

    change: Callable[[Results], Results] = dataclasses.field(default=lambda results: results)

    def resample(self, times: Array) -> Results:
        return self.change(super().resample(times))


def opened(results: Results) -> Results:
    force = results.joints["pivot"]["force"].copy()
    force[:, 2] = np.nan
    force[results.time > 1.0, 0] = np.nan
    pivot = {**results.joints["pivot"], "force": force, "open": ["force.x", "force.z"]}
    return dataclasses.replace(results, joints={**results.joints, "pivot": pivot})


def test_open_components_are_named_together_and_partly_open_ones_are_marked() -> None:
    text = extremes_page(Changed(T, change=opened))
    assert "\n  open: Fz, |F|\n" in text
    partly = line_of(text, "pivot", "Fx*")
    assert partly[3] == "open"
    assert float(partly[-2]) == pytest.approx(3.0)
    assert "open: statically indeterminate, depends on stiffness" in text
    assert "* open at some times" in text


def test_open_components_read_open_at_an_instant() -> None:
    study = Changed(T, change=opened)
    page = make_page(restrict(study.results, {"joints"}), LABELS, MAGNITUDES)
    (table,) = page.make_tables_at_instants(restrict(study.resample(np.array([0.5])), {"joints"}))
    assert [format_cell(cell) for cell in table.rows[0][2:6]] == ["2.52441", "0", "open", "open"]


def test_a_chosen_split_is_labelled() -> None:
    def choose(results: Results) -> Results:
        pivot = {**results.joints["pivot"], "chosen": ["force.z", "moment.x"]}
        model = {**results.model, "split": "chosen by least norm"}
        return dataclasses.replace(results, joints={**results.joints, "pivot": pivot}, model=model)

    study = Changed(T, change=choose)
    assert "indeterminate, one distribution chosen: pivot Fz Mx" in extremes_page(study)
    assert "split     chosen by least norm; other distributions are equally possible" in format_heading(study.results)


def test_beyond_the_horizon_nothing_is_claimed() -> None:
    study = FakeStudy(T, {"accuracy": {**ACCURATE, "horizon": 1.2, "estimate": {"motion": 0.02, "reactions": 0.1}}})
    page = make_page(restrict(study.results, frozenset({"joints"})), LABELS, MAGNITUDES)
    assert page.results.time[-1] == pytest.approx(1.1)
    shown = restrict(study.resample(np.array([0.5, 1.5])), frozenset({"joints"}))
    lines = [line.split() for line in format_plain(page.make_tables_at_instants(shown)[0]).splitlines()]
    assert next(line for line in lines if line[0] == "1.5")[1:5] == ["?", "0", "?", "?"]  # Fy is 0.0 in all bits
    assert next(line for line in lines if line[0] == "0.5")[1] == "2.5"
    assert "no results are claimed from t = 1.2 s on" in format_heading(study.results)


def test_a_run_that_ends_beyond_its_horizon_has_no_last_value() -> None:
    text = extremes_page(FakeStudy(T, {"accuracy": {**ACCURATE, "horizon": 1.2}}))
    assert line_of(text, "pivot", "Fx")[2:4] == ["0", "?"]
    assert line_of(text, "pivot", "Fz")[3] == "?"
    assert "Fy" not in text  # 0.0 in all bits, to the end


def test_a_run_that_begins_beyond_its_horizon_has_no_value_at_all() -> None:
    text = extremes_page(FakeStudy(T + 1.0, {"accuracy": {**ACCURATE, "horizon": 0.5}}))
    assert line_of(text, "pivot", "Fx")[2:] == ["?"] * 4
    assert {text for line in text.splitlines() if "Fz" in line for text in line.split()[2:6]} == {"?"}


def test_a_peak_between_the_samples_makes_the_scale() -> None:
    """At the samples there is rounding only: the peak between them is shown, with the digits it has."""
    noise = pendulum(T[[0, -1]], joints={"a": {"force": np.full((2, 3), 1e-17), "point": np.zeros((2, 3))}})
    page = make_page(restrict(noise, {"joints"}), LABELS, MAGNITUDES)
    channels = page.make_search().collect(page.results)
    columns = np.concatenate([channel.searched_values for channel in channels], axis=1)
    found = peaks.search_extremes(lambda _: columns, T[[0, -1]], search_between=False)
    found = found._replace(high=np.array([0.4, 0.0, 0.0, 0.4]), paths=tuple(channel.path for channel in channels))
    (table,) = page.make_tables_of_extremes(found)
    assert [[format_cell(row[k]) for k in (0, 1, 2, 6)] for row in table.rows[1:]] == [["Fx", "N", "0", "0.4"]]


def test_fewer_certain_digits_show_fewer_digits() -> None:
    def digits(error: float) -> int:
        study = FakeStudy(T, {"accuracy": {**ACCURATE, "estimate": {"motion": error, "reactions": error}}})
        return len(line_of(extremes_page(study), "pivot", "Fz")[2].replace(".", ""))

    assert [digits(10.0**-k) for k in (12, 5, 4, 3)] == [6, 5, 4, 3]


def instants_page(times: list[float], wanted: set[str], **options: Any) -> list[str]:
    study = FakeStudy(T)
    page = make_page(restrict(study.results, wanted), LABELS, MAGNITUDES)
    shown = restrict(study.resample(np.array(times)), wanted)
    return [format_plain(table) for table in page.make_tables_at_instants(shown, **options)]


def test_instants_stand_below_each_other() -> None:
    (text,) = instants_page([0.5, 1.0], {"joints"})
    lines = text.splitlines()
    assert lines[1].split()[:3] == ["t", "[s]", "Fx"]
    assert [line.split()[0] for line in lines if line.startswith("    ")] == ["0.5", "1.0"] * 2
    assert f"{3.0 * np.sin(1.0):.4f}" in lines[3]


def test_one_instant_takes_a_line_a_joint() -> None:
    (text,) = instants_page([0.5], {"joints"})
    assert [line.split()[0] for line in text.splitlines()] == ["JOINTS", "joint", "pivot", "elbow", "Columns"]


def test_columns_of_different_unit_stand_in_different_tables() -> None:
    push, motor = instants_page([0.5], {"forces"})
    assert "value [N]" in push
    assert "value [N·m]" in motor
    assert "FORCES" not in motor


def test_the_central_axis_is_shown_at_instants_only() -> None:
    assert "CENTRAL AXIS" in "".join(instants_page([0.5], {"foundation"}))
    assert "CENTRAL AXIS" not in extremes_page(FakeStudy(T), frozenset({"foundation"}))


def many(results: Results) -> Results:
    joints = {
        f"j{i}": {
            "point": np.zeros((len(results.time), 3)),
            "force": vectors(results.time, i * np.sin(results.time), 0.0, 0.0),
            "moment": np.zeros((len(results.time), 3)),
            "open": [],
        }
        for i in range(MAX_FULL_GROUPS + 1)
    }
    return dataclasses.replace(results, joints=joints)


def test_many_joints_take_a_line_each_and_say_how_to_get_the_rest() -> None:
    text = extremes_page(Changed(T, change=many), frozenset({"joints"}))
    assert len(text.splitlines()) == MAX_FULL_GROUPS + 4
    assert "--format csv" in text
    assert next(line for line in text.splitlines() if line.startswith("j7 ")).split()[:3] == ["j7", "7.00000", "1.5708"]


def long_run(n_cuts: int, side: list[str | None] | None = None) -> Callable[[Results], Results]:
    def change(results: Results) -> Results:
        s = np.linspace(0.0, 1.0, n_cuts)
        shape = np.sin(results.time)[:, None] * (s * (1.0 - s) * 4.0)
        run = {name: k * shape for k, name in enumerate(("N", "Q1", "Q2", "T", "M1", "M2"))}
        return dataclasses.replace(results, sections={"along": {"s": s, "side": side or [None] * n_cuts, **run}})

    return change


def test_a_run_of_cuts_shows_extremes_over_place_and_time() -> None:
    text = extremes_page(Changed(T, change=long_run(201)), frozenset({"sections"}))
    row = next(line.split() for line in text.splitlines() if line.startswith("M2"))
    assert row[-3:] == ["5.0", "0.5", "1.5708"]


@pytest.mark.parametrize(("n_cuts", "most"), [(3, 3), (25, 25), (200, 25)])
def test_a_diagram_can_be_read_for_few_cuts_and_for_many(n_cuts: int, most: int) -> None:
    study = Changed(T, change=long_run(n_cuts))
    page = make_page(restrict(study.results, {"sections"}), LABELS, MAGNITUDES)
    shown = restrict(study.resample(np.array([0.5])), {"sections"})
    (table,) = page.make_tables_at_instants(shown)
    assert len(table.rows) <= most
    assert (len(table.rows) < n_cuts) == any("all cuts: --all" in note for note in table.notes)
    (whole,) = page.make_tables_at_instants(shown, every_cut=True)
    assert len(whole.rows) == n_cuts


def test_a_thinned_diagram_keeps_both_rows_of_a_jump() -> None:
    side: list[str | None] = [None] * 100
    side[41], side[42] = "before", "beyond"
    study = Changed(T, change=long_run(100, side))
    page = make_page(restrict(study.results, {"sections"}), LABELS, MAGNITUDES)
    (table,) = page.make_tables_at_instants(restrict(study.resample(np.array([0.5])), {"sections"}))
    assert [row[1] for row in table.rows if row[1]] == ["before", "beyond"]


def test_a_blow_has_tables_of_its_own_in_newton_seconds() -> None:
    blow = {
        "time": 0.5,
        "names": ["blow"],
        "foundation": {"force": np.array([0.0, 0.0, 2.0]), "moment": np.array([1.0, 0.0, 0.0])},
        "joints": {"pivot": {"force": np.array([0.0, 3.0, 0.0]), "moment": np.zeros(3), "open": []}},
        "energy_jump": 0.25,
    }
    study = FakeStudy(T, {"impulses": [blow]})
    text = extremes_page(study)
    part = text[text.index("IMPULSE at t = 0.5 s (blow)\n") :]
    assert 'JOINTS  reaction impulse of "from" on "to"' in part
    assert {"N·s", "N·m·s"} <= set(part.split())
    assert not {"N", "N·m"} & set(part.split())


def test_the_heading_tells_what_was_solved_and_how_accurate_it_is() -> None:
    text = format_heading(pendulum(T, warnings=("the bar is thin",)))
    for part in (
        "A fake",
        "spatial, 2 bodies, 4 degrees of freedom",
        "0 to 2 s, 21 samples; dop853, 57 steps, 812 evaluations; compiled kernel",
        "motion within 4e-11 of model size, loads within 5e-10 of the largest load",
        "relative energy error 2e-12, largest constraint error 1e-16 m, force balance error 3e-15",
        "warning   the bar is thin",
    ):
        assert part in text


def test_a_planar_scene_says_what_there_is_not() -> None:
    flat = dataclasses.replace(pendulum(T), model={**pendulum(T).model, "space": "planar", "plane": "declared"})
    assert "planar, 2 bodies, 4 degrees of freedom; out-of-plane components are 0" in format_heading(flat)


def test_nothing_asked_for_leaves_nothing_to_search() -> None:
    page = make_page(restrict(pendulum(T), frozenset()), LABELS, MAGNITUDES)
    assert isinstance(page, Page)
    assert page.make_search().collect(page.results) == []
