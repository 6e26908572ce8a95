"""Series of cuts over a motion: extremes of loads and stresses along and at each cut, the same in head and rows."""

from __future__ import annotations

import math
from pathlib import Path

import numpy as np
import pytest

from heuncli.output.documents.document import OutputTable, format_cell
from heuncli.output.tables import page as snapshot_tables
from heuncli.output.tables.page import Page, make_page
from heuncli.results.results import Array, CutPosition, Extremes
from heuncli.scene.file_format.load import load
from heuncli.study.model.options import Options
from heuncli.study.model.setup import Setup
from heuncli.study.quantities.cut_series import collect_cut_series, find_sample_extremes, merge_extremes
from heuncli.study.quantities.labels import make_labels
from heuncli.study.queries.measure import find_peak
from heuncli.study.queries.study import Study
from heuncli.study.search import cuts
from heuncli.study.workflow import solve

SPEC = """
heun: 1
gravity: [0, 0, -9.81]
ground: {points: {O: [0, 0, 0]}}
bodies:
  bar:
    shapes: [{type: cylinder, from: [0, 0, 0], to: [0, 0, -1], radius: 10 mm, density: 7850 kg/m^3}]
    points: {top: [0, 0, 0], end: [0, 0, -1]}
joints:
  pivot: {type: pin, from: ground.O, to: bar.top, axis: [0, 1, 0], initial: {angle: 60 deg}}
sections:
  bar: {body: bar, from: top, to: end, count: 6, properties: {circle: {radius: 10 mm}}, strength: 200 MPa}
analysis: {duration: 2, samples: 4}
"""
SECTIONS = frozenset({"sections"})


@pytest.fixture(scope="module")
def solved(tmp_path_factory: pytest.TempPathFactory) -> tuple[Study, Page, Extremes]:
    path = tmp_path_factory.mktemp("bar") / "bar.yaml"
    path.write_text(SPEC)
    spec = load(str(path))
    study = solve(spec, Options(requested_reports=SECTIONS))
    page = make_page(study.results, make_labels(spec), study.magnitudes)
    return study, *snapshot_tables.search_page(page, study, SECTIONS)


def cells(table: OutputTable) -> list[tuple[str, ...]]:
    return [tuple(map(format_cell, row)) for row in table.rows if not isinstance(row, str)]


@pytest.mark.heavy
def test_at_each_cut_stand_the_extremes_of_the_motion(solved: tuple[Study, Page, Extremes]) -> None:
    study, page, _ = solved
    (run,) = collect_cut_series(page.results, page.labels)
    found = page.cut_extremes["bar"]
    for i, own in enumerate(run.channels):
        name = own.path
        for cut in (0, 2):
            for bound, how in ((found.low, "min"), (found.high, "max")):
                expected = find_peak(study, f"{name}.{cut}", how).value
                scale = max(abs(expected), 1e-6)
                assert bound[i * len(run.s) + cut] == pytest.approx(expected, abs=1e-8 * scale), (name, cut, how)


@pytest.mark.heavy
def test_head_and_rows_are_of_one_source(solved: tuple[Study, Page, Extremes]) -> None:
    """The root carries m g + m L w^2 / 2 at the lowest point, w^2 = m g L / 2 over the moment of inertia."""
    _, page, found = solved
    head, rows = page.make_tables_of_extremes(found)
    weight = 9.81 * 7850.0 * math.pi * 1e-4
    most = weight * (1.0 + 0.25 / (1.0 / 3.0 + 0.25e-4))
    bounds = {row[0]: row for row in cells(head)}
    columns = {column.title: [row[i] for row in cells(rows)] for i, column in enumerate(rows.columns)}
    assert bounds["N"][5] == columns["N max [N]"][0] == f"{most:.4f}"
    assert float(bounds["M2"][5]) > max(map(float, columns["M2 max [N·m]"]))  # between the cuts, at a third
    assert bounds["mises"][1] == "MPa"
    assert bounds["utilisation"][1] == ""
    assert float(bounds["mises"][5]) / 200.0 == pytest.approx(float(bounds["utilisation"][5]), rel=1e-5)
    assert float(bounds["normal max"][6]) == pytest.approx(0.33, abs=0.01)
    assert [head for head in columns if head.startswith("normal m")] == ["normal max [MPa]", "normal min [MPa]"]
    assert "also between the output times" in rows.notes[0]


def test_the_better_of_two_searches_stands_in_both() -> None:
    """3.1 of the cut against 3.0 of the stretch there; at the other end the stretch has the better one."""
    from tests.shared.fakes import LABELS, pendulum

    (run,) = collect_cut_series(pendulum(np.linspace(0.0, 1.0, 3)), LABELS)
    run = run._replace(channels=run.channels[:1])
    one = np.zeros(1, dtype=np.intp)
    places = ((CutPosition(0.0, None, 0), CutPosition(0.2, None, 1)),)
    ends = Extremes(
        np.array([-2.0]), np.array([0.5]), one, np.array([3.0]), np.array([0.6]), one, is_searched=True, places=places
    )
    at = find_sample_extremes(np.array([0.1, 0.2]), np.array([[-1.9, -1.0, 0.0, 0.0, 0.0], [-1.5, 3.1, 0.0, 0.0, 0.0]]))
    whole, cuts = merge_extremes(run, np.arange(5), ends, at)
    assert (whole.high[0], whole.high_at[0], whole.places[0][1].cut) == (3.1, 0.2, 1)
    assert (whole.low[0], cuts.low[0]) == (-2.0, -2.0)


def test_of_too_many_numbers_the_samples_stand(solved: tuple[Study, Page, Extremes]) -> None:
    _, page, found = solved
    _, rows = page._replace(cut_extremes={}).make_tables_of_extremes(found)
    assert "at 4 output times" in rows.notes[0]


def test_the_command_shows_stresses_of_runs(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    from heuncli.app.cli.entry import enter

    path = tmp_path / "bar.yaml"
    path.write_text(SPEC)
    assert enter(["run", str(path), "--only", "sections", "--at", "0.5"]) == 0
    assert "mises [MPa]" in capsys.readouterr().out


LOADED_BOX = """
heun: 1
gravity: [0, 0, -9.81]
ground: {points: {wall: [0, 0, 0]}}
bodies:
  beam:
    shapes: [{type: box, center: [0.5, 0, 0], size: [1, 0.02, 0.02], density: 7850}]
    points: {root: [0, 0, 0], tip: [1, 0, 0]}
joints: {wall: {type: weld, from: ground.wall, to: beam.root}}
forces: {load: {type: force, on: beam.tip, vector: [0, 0, -100]}}
sections:
  on: {body: beam, from: root, to: tip, count: 5, properties: {rectangle: {width: 0.02, height: 0.02}}, strength: 9e7}
"""


def test_the_place_of_a_stress_is_not_sought_in_rounding(monkeypatch: pytest.MonkeyPatch) -> None:
    """Beyond the cuts of a box pieces are sums: a stress that is 0 all along is noise, of finer cuts ever more."""
    asked: list[int] = []
    cut_at = cuts.cut_at

    def counted(setup: Setup, name: str, s: Array, ends: tuple[float, float]) -> Setup:
        asked.append(len(s))
        return cut_at(setup, name, s, ends)

    monkeypatch.setattr(cuts, "cut_at", counted)
    found = solve(load("box.yaml", LOADED_BOX), Options())
    run = next(iter(collect_cut_series(found.results, make_labels(found.spec))))
    certain = make_page(found.results, make_labels(found.spec), found.magnitudes).stated_errors
    told = snapshot_tables.search_stresses(run, certain, found)
    assert told.places[-1][1] == CutPosition(0.0, "beyond", 0)  # of the utilisation
    assert sum(asked) < 2000
