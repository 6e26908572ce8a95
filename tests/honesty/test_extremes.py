"""Extremes against many samples: never short of any of them by more than the stated error."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from heuncli.base.errors import HeunError
from heuncli.output.tables.page import TABLE_DEFAULT, make_page
from heuncli.scene.file_format.load import load
from heuncli.study.model.options import Options
from heuncli.study.quantities.labels import make_labels
from heuncli.study.queries.study import Study
from heuncli.study.workflow import solve
from tests.bench.honesty import told
from tests.shared.scenes import study

SPECS = sorted((Path(__file__).parents[2] / "specs").glob("*.yaml"))
SAMPLES = 1_000
# Through its flat pose a run is known to rounding over the fourth power of how near it is; what is told at the edge of
# what is not errs by more than the run's own error.
BESIDE = {"flat_four_bar.yaml": 1e-4}


def short_by(run: Study, samples: int, slack: float = 0.0) -> list[tuple[str, float]]:
    """Which rows of the tables pass their extremes at some of so many instants, by how many times the stated error."""
    page = make_page(run.results, make_labels(run.spec), run.magnitudes)
    search = page.make_search()
    found = run.search_extremes(search, TABLE_DEFAULT)
    last, horizon = run.results.time[-1], run.results.accuracy.get("horizon")
    times = np.linspace(run.results.time[0], last, samples)
    results = run.compute_reports(times if horizon is None else times[times < horizon], TABLE_DEFAULT)
    missed = []
    for k, channel in enumerate(search.collect(results)):
        values = channel.values
        if np.isnan(values).all() or np.isnan(found.high[k]):
            continue
        high, low = float(np.nanmax(values)), float(np.nanmin(values))
        top, bottom = float(found.high[k]), float(found.low[k])
        allowed = search.find_error(channel) + (slack + 1e-12) * max(abs(high), abs(low))
        if max(high - top, bottom - low) > allowed:
            missed.append((channel.path, max(high - top, bottom - low) / allowed))
    return missed


@pytest.mark.parametrize("path", SPECS, ids=lambda path: path.stem)
@pytest.mark.sixth
def test_of_every_spec(path: Path) -> None:
    spec = load(str(path))
    if spec.analysis.type != "motion":
        pytest.skip("one instant")
    assert not short_by(solve(spec, Options(requested_reports=TABLE_DEFAULT)), SAMPLES, BESIDE.get(path.name, 0.0))


@pytest.mark.heavy
@pytest.mark.parametrize("seed", [0, 1, 2, 3, 4, 29])
@pytest.mark.third
def test_of_random_scenes(seed: int) -> None:
    """Trees and loops, drives, loads in time; at 29 a joint slides past a cut twice within one step."""
    try:
        run = study(told(seed).scene, time_limit=20.0, requested_reports=TABLE_DEFAULT)
    except HeunError:
        pytest.skip("cannot be solved")
    assert not short_by(run, SAMPLES)
