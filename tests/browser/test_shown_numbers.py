"""The numbers of a moving page, read from the browser at several frames, are those of the run, to the digits shown."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from heuncli.output.web_page.packing import NUMBER_STEPS
from heuncli.results.results_schema import REPORTS
from tests.shared.chromium import Chromium, Tab
from tests.shared.folders import SPECS
from tests.shared.shown_numbers import frames, largest_of_run, numbers, of_run, to_frame

Pages = Callable[..., Path]
Runs = Callable[..., dict[str, Any]]

# Balls, pins and slides; sections of one cut and of many, stresses; open components; a blow; what stands still.
NAMES = ["double", "engine", "jib", "crane", "hammered_four_bar", "press", "bricard", "skew_rod", "crankshaft", "swing"]
UNTOLD = {"?", "open"}  # of no digit of which anything is known; held more than once


def compare(tab: Tab, results: dict[str, Any], k: int) -> int:
    """The numbers shown against those of the run at its instant of a number; how many there are."""
    shown = numbers(tab)
    for path, number in shown.items():
        wanted = of_run(results, path, k)
        if np.isnan(wanted):
            assert number.value is None, path
            continue
        rounding = 2.0 / NUMBER_STEPS * largest_of_run(results, path)  # between the samples it may be twice as large
        assert number.value == pytest.approx(wanted, rel=1e-12, abs=rounding), path
        if number.text in UNTOLD:
            continue
        read, half = number.read()
        assert abs(read - wanted) <= half + rounding, path
    return len(shown)


@pytest.mark.parametrize("name", NAMES)
@pytest.mark.sixth
def test_numbers_of_a_frame_are_those_of_the_run(name: str, browser: Chromium, page: Pages, results: Runs) -> None:
    spec = SPECS / f"{name}.yaml"
    path, run = page(spec), results(spec, "--only", ",".join(REPORTS))
    times = np.array(run["time"])
    both = [(k, int(found[0])) for k, t in enumerate(frames(path)) if len(found := np.flatnonzero(times == t))]
    with browser.open(path) as tab:
        for frame, k in {both[0], both[len(both) // 3], both[-1]}:
            if len(times) > 1:
                to_frame(tab, frame)
            assert float(tab.evaluate("document.querySelector('#instant').dataset.value")) == times[k]
            assert compare(tab, run, k) > 5
        assert tab.faults == []


def test_a_run_of_cuts_shows_the_cut_that_is_chosen(browser: Chromium, page: Pages, results: Runs) -> None:
    run = results(SPECS / "jib.yaml")
    with browser.open(page(SPECS / "jib.yaml")) as tab:
        to_frame(tab, 0)
        tab.evaluate("document.querySelector('#cut').focus()")
        tab.press("End")
        last = len(run["sections"]["along"]["s"]) - 1
        for cut in (last, last - 1):
            largest = np.abs(run["sections"]["along"]["M1"]).max()
            found = numbers(tab)[f"sections.along.M1.{cut}"].value
            assert found == pytest.approx(run["sections"]["along"]["M1"][0][cut], abs=largest / NUMBER_STEPS)
            tab.press("ArrowLeft")


def test_numbers_in_other_units_are_the_same_numbers(browser: Chromium, page: Pages) -> None:
    shown = []
    for options in ((), ("--units", "kN,mm,deg")):
        with browser.open(page(SPECS / "jib.yaml", *options)) as tab:
            to_frame(tab, 40)
            shown.append(numbers(tab))
    assert {path: number.value for path, number in shown[0].items()} == {
        path: number.value for path, number in shown[1].items()
    }
    assert {"kN", "kN·mm", "deg"} <= {number.unit for number in shown[1].values()}
    for path, number in shown[1].items():
        read, half = number.read()
        assert abs(read - (number.value or 0.0)) <= half * (1 + 1e-9), path


def test_nothing_is_shown_beyond_the_horizon(browser: Chromium, page: Pages, results: Runs, tmp_path: Path) -> None:
    spec = tmp_path / "long.yaml"
    text = (SPECS / "double.yaml").read_text().partition("expect:")[0]
    spec.write_text(text.replace("duration: 2,", "duration: 40,"))
    horizon = results(spec, "--tolerance", "1e-2")["accuracy"]["horizon"]
    path = page(spec, "--tolerance", "1e-2")
    assert 10.0 < horizon < 39.0
    with browser.open(path) as tab:
        tab.press("End")
        last = float(tab.evaluate("document.querySelector('#instant').dataset.value"))
        assert 0.9 * horizon < last < horizon
        assert f"t = {horizon:.6g} s" in tab.evaluate("document.querySelector('#notes').textContent")
