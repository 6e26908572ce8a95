"""What is open between two instants of a search is what a look at each of them finds, in every number that is told."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from heuncli.output.tables.page import make_page
from heuncli.results.results import Array
from heuncli.results.results_schema import REPORTS
from heuncli.scene.file_format.load import load
from heuncli.study.compose.unknown_numbers import VerdictsBetween, find_verdicts
from heuncli.study.model.options import Options
from heuncli.study.quantities.labels import make_labels
from heuncli.study.queries.study import Study
from heuncli.study.search.columns import ChannelSearch, StudyColumns
from heuncli.study.workflow import solve
from tests.oracle.published import windows
from tests.shared.scenes import moving, study

SPECS = Path(__file__).parents[2] / "specs"
WANTED = frozenset(REPORTS)
BETWEEN = 40  # instants looked at in each run

STRUCK = """
heun: 1
gravity: [0, 0, -9.81]
ground: {points: {A: [0, 0, 0], B: [1, 0, 0]}}
bodies:
  door: {mass: 2, center: [0.5, 0.3, 0], inertia: [0.2, 0.2, 0.3], points: {a: [0, 0, 0], b: [1, 0, 0]}}
joints:
  first: {type: pin, from: ground.A, to: door.a, axis: [1, 0, 0], initial: {angle: 0, rate: 0}}
  second: {type: pin, from: ground.B, to: door.b, axis: [1, 0, 0]}
stops: {sill: {joint: first, angle: [-30 deg, null]}}
analysis: {duration: 1, samples: 5}
"""


def columns_of(found: Study) -> StudyColumns:
    """All that the tables tell of a run, as the columns of a search that has seen its grid."""
    page = make_page(found.results, make_labels(found.spec), found.magnitudes)
    search = page.make_search()
    single = ChannelSearch(lambda at: [own for own in search.collect(at) if not own.has_cuts], search.find_error)
    columns = StudyColumns(found, single, WANTED)
    columns.sample(found.search_times)
    return columns


def between(found: Study) -> tuple[StudyColumns, Array]:
    """The columns, and instants between those of the grid."""
    rng = np.random.default_rng(5)
    return columns_of(found), np.sort(rng.uniform(found.results.time[0], found.results.time[-1], BETWEEN))


def told_and_found(found: Study) -> tuple[Array, Array, int]:
    """The columns as they follow from the grid, and as a look at each instant finds them; how many did follow."""
    columns, at = between(found)
    told = columns.sample(at)
    columns.grid_verdicts = None  # type: ignore[assignment]
    looked = columns.sample(at)
    columns = columns_of(found)
    assert columns.grid_verdicts is not None
    return told, looked, int(columns.grid_verdicts.covers(found.find_recovery(at, WANTED).solutions).sum())


@pytest.mark.heavy
@pytest.mark.parametrize("name", ["bricard", "four_bar", "flat_four_bar", "engine", "press", "hammered_four_bar"])
@pytest.mark.third
def test_specs_with_closed_chains(name: str) -> None:
    """Every number and every `open` of the worked examples, at instants that nobody asked for."""
    told, looked, followed = told_and_found(solve(load(str(SPECS / f"{name}.yaml"))))
    np.testing.assert_array_equal(told, looked)
    assert followed > 0.8 * BETWEEN


@pytest.mark.parametrize("count", [1, 3])
def test_windows_through_their_flat_pose(count: int) -> None:
    """Windows of bars pass a singular pose, at which more is open, and beside which rounding reaches some numbers."""
    found = study(moving(windows(count, 0.0, 1.0), (0.0, 0.5, 1.0), 1e-6))
    told, looked, followed = told_and_found(found)
    assert np.isnan(looked).any() and not np.isnan(looked).all(axis=0).all()
    np.testing.assert_array_equal(np.isnan(told), np.isnan(looked))
    np.testing.assert_array_equal(told, looked)
    assert followed > 0.5 * BETWEEN


def test_a_contact_that_closes_opens_more() -> None:
    """Where a stop closes on one of two hinges the verdict is another on either side of the strike."""
    found = study(STRUCK)
    columns, at = between(found)
    assert columns.grid_verdicts is not None
    closed = found.find_recovery(at, WANTED).solutions.holding[:, 0] > 0.0
    told, looked, followed = told_and_found(found)
    np.testing.assert_array_equal(told, looked)
    assert closed.any() and not closed.all() and followed > 0


@pytest.mark.parametrize("count", [1, 2, 3])
def test_cuts_of_a_body_held_twice(count: int) -> None:
    """A force along the line of the hinges is open, and with it all loads of the cuts between them, how many ever."""
    at = (
        "from: [0.1, 0, 0], to: [0.9, 0, 0], count: " + str(count)
        if count > 1
        else "at: [0.1, 0, 0], normal: [1, 0, 0]"
    )
    bar = "{type: cylinder, from: [0, 0, 0], to: [1, 0, 0], radius: 0.05, mass: 1}"
    flap = "{type: box, center: [0.95, 0.3, 0], size: [0.1, 0.6, 0.02], mass: 1}"
    of_shapes = STRUCK.replace("mass: 2, center: [0.5, 0.3, 0], inertia: [0.2, 0.2, 0.3]", f"shapes: [{bar}, {flap}]")
    found = study(of_shapes + f"sections: {{run: {{body: door, {at}}}}}\n")
    told, looked, followed = told_and_found(found)
    np.testing.assert_array_equal(told, looked)
    assert followed > 0 and np.isnan(looked).any()
    columns, at = between(found)
    recovery, tells = found.find_recovery(at, WANTED), columns.grid_verdicts
    assert tells is not None
    recovery = recovery.select(tells.covers(recovery.solutions))
    named = [
        x.sections["run"]["open"]
        for x in (
            found.compose_reports(recovery.without_indeterminacy_search(), WANTED, tells),
            found.compose_reports(recovery, WANTED),
        )
    ]
    assert named[0] == named[1] and "N" in named[0] and "force.x" in named[0]


@pytest.mark.parametrize("what", ["dependent", "is_regular", "open"])
def test_disagreement_is_looked_at(what: str) -> None:
    """Where the two sides differ in rank, in being singular or in what is open, instants between are looked at."""
    found = study(moving(windows(1, 0.3, 1.0), (0.0, 0.2), 1e-6))
    columns, at = between(found)
    tells = columns.grid_verdicts
    assert tells is not None and tells.covers(found.find_recovery(at, WANTED).solutions).all()
    whole = find_verdicts(columns.grid[0], WANTED)
    assert whole is not None
    changed = {
        "dependent": whole._replace(dependent=whole.dependent + (np.arange(len(whole.times)) % 2)),
        "is_regular": whole._replace(is_regular=np.arange(len(whole.times)) % 2 > 0),
        "open": whole._replace(open=tuple(None if mask is None else mask & odd(mask) for mask in whole.open)),
    }[what]
    assert not VerdictsBetween([changed]).covers(found.find_recovery(at, WANTED).solutions).any()


def odd(mask: Array) -> Array:
    """Every other instant."""
    return np.asarray((np.arange(len(mask)) % 2 > 0).reshape(-1, *[1] * (mask.ndim - 1)))


def test_a_split_is_found_at_each_instant() -> None:
    """A split by least norm turns with the pose: nothing of it is taken from the grid."""
    found = study(moving(windows(1, 0.3, 1.0), (0.0, 0.2), 1e-6), least_norm=True)
    assert columns_of(found).grid_verdicts is None


@pytest.mark.heavy
def test_searches_of_one_run_share_their_instants(monkeypatch: pytest.MonkeyPatch) -> None:
    """The grid of a second search is not solved again."""
    found = solve(load(str(SPECS / "four_bar.yaml")), Options())
    columns_of(found)
    asked: list[int] = []
    own = found._recover
    monkeypatch.setitem(found.__dict__, "_recover", lambda at, wanted: asked.append(len(at)) or own(at, wanted))
    columns_of(found)
    assert not asked
