"""Memory is looked at before the work: what it would take, what there is, and what would fit."""

from __future__ import annotations

import re
import sys
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from heuncli.base import process
from heuncli.motion.integration.run.progress import GrowingRows
from heuncli.motion.integration.trajectory import StepRecords
from heuncli.results.results_schema import REPORT_OF, REPORTS, SHARES
from heuncli.scene.file_format.load import load
from heuncli.study.model.memory import format_bytes, iter_numbers_by_block, truncate_to_two_digits
from heuncli.study.model.options import Options
from heuncli.study.model.selection import Selection
from heuncli.study.model.setup import set_up
from heuncli.study.workflow import solve
from tests.shared.command import Heun
from tests.shared.folders import SPECS
from tests.shared.shell import shell


@pytest.mark.heavy
@pytest.mark.parametrize("words", ["run", "run --format json", "run --format csv", "check"])
def test_what_would_not_fit_is_refused_with_what_would(
    heun: Heun, folder: Path, monkeypatch: pytest.MonkeyPatch, words: str
) -> None:
    left, told = (2e6, "1 MB") if "format" in words else (2e7, "10 MB")  # what is exported takes its states alone
    monkeypatch.setattr(process, "_iter_remaining_memory", lambda: iter([left]))
    many = (folder / "swinging.yaml").read_text().replace("samples: 11", "samples: 100001")
    (folder / "many.yaml").write_text(many)
    done = heun(*words.split(), "many.yaml")
    assert (done.returncode, done.stdout) == (4, "")
    assert "the results at 100,001 output times need about" in done.stderr and f"{told} is allowed" in done.stderr
    fit = re.search(r"hint: ([\d,]+) samples would fit", done.stderr)
    assert fit is not None
    samples = int(fit[1].replace(",", ""))
    assert 100 < samples < 20_000
    (folder / "many.yaml").write_text(many.replace("100001", str(samples)))
    assert heun(*words.split(), "many.yaml").returncode == 0


@pytest.mark.heavy  # 10,000 steps
def test_steps_that_are_known_before_are_counted(heun: Heun, folder: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """A table whose 10,000 points in the run each end a step; with little memory it is refused before it moves."""
    scene = (
        "heun: 1\nbodies: {b: {mass: 1, center: [0, 0, 0], inertia: [1, 1, 1], points: {p: [0, 0, 0]}}}\n"
        "tables: {f: {x: [0, 0.0001, 0.0002], y: [0, 1, 0], period: 0.0002}}\n"
        "forces: {f: {type: force, on: b.p, vector: ['table(f, t)', 0, 0]}}\nanalysis: {duration: 1, samples: 3}\n"
    )
    (folder / "dense.yaml").write_text(scene)
    monkeypatch.setattr(process, "_iter_remaining_memory", lambda: iter([8e6]))
    done = heun("run", "dense.yaml")
    assert (done.returncode, done.stdout) == (4, "")
    assert "loads and drives have 10,000 jumps or kinks" in done.stderr and "[too-much-memory]" in done.stderr
    assert "hint: a shorter duration, or tables with fewer points" in done.stderr
    monkeypatch.setattr(process, "_iter_remaining_memory", lambda: iter([8e8]))
    assert heun("run", "dense.yaml", "--quiet").returncode == 0


@pytest.mark.heavy
@pytest.mark.parametrize("name", ["double", "overhang", "door"])
@pytest.mark.parametrize("shares", [False, True])
def test_the_estimate_counts_what_is_told(name: str, shares: bool) -> None:
    """No less, and no more than a few times as much: not every joint has all that a joint may have."""
    asked = Selection(frozenset((*REPORTS, SHARES) if shares else REPORTS))
    spec = load(str(SPECS / f"{name}.yaml"))
    estimated = dict(iter_numbers_by_block(set_up(spec, selection=asked)))
    results = solve(spec, Options(requested_reports=asked.reports)).results
    for block in REPORT_OF:
        there = counted(getattr(results, block), len(results.time)) / len(results.time)
        assert there <= estimated.get(block, 0) <= 4.0 * there + 40.0, block


def counted(block: Any, instants: int) -> int:
    if isinstance(block, dict):
        return sum(counted(member, instants) for member in block.values())
    return block.size if isinstance(block, np.ndarray) and len(np.atleast_1d(block)) == instants else 0


@pytest.mark.parametrize(
    ("size", "text"), [(3e5, "0.3 MB"), (8.34e6, "8.3 MB"), (8.39e7, "83 MB"), (7.4e8, "740 MB"), (1.43e12, "1,400 GB")]
)
def test_sizes_in_words(size: float, text: str) -> None:
    assert format_bytes(size) == text
    assert truncate_to_two_digits(1675.9) == 1600.0


@pytest.mark.skipif(sys.platform != "linux", reason="no limit on addresses")
@pytest.mark.parametrize(
    ("limit", "words", "text"),
    [
        (60_000, "run swinging.yaml", "heun needs 160 MB to start [out-of-memory]"),
        (60_000, "validate swinging.yaml", "heun needs 160 MB to start [out-of-memory]"),
        (400_000, "run swinging.yaml --set analysis.samples=2000001", "[too-much-memory]"),
    ],
)
def test_a_limit_on_addresses_is_4(folder: Path, limit: int, words: str, text: str) -> None:
    done = shell(f"ulimit -v {limit}; exec heun {words}", folder)
    assert (done.returncode, done.stdout) == (4, "")
    assert text in done.stderr and "hint:" in done.stderr and "Traceback" not in done.stderr


@pytest.mark.parametrize(
    ("said", "code"),
    [("libx.so: failed to map segment from shared object", 4), ("cannot import name 'nothing'", 70)],
)
def test_a_library_that_finds_no_memory(heun: Heun, monkeypatch: pytest.MonkeyPatch, said: str, code: int) -> None:
    def fail(*_: object, **__: object) -> None:
        raise ImportError(said)

    monkeypatch.setattr("heuncli.app.commands.run.command.read", fail)
    assert heun("run", "hanging.yaml").returncode == code


def test_rows_that_grow() -> None:
    rng = np.random.default_rng(1)
    grown, whole = GrowingRows(3), np.zeros((0, 3))
    for n in (1, 100, 0, 7, 500):
        rows = rng.random((n, 3))
        grown.add(rows)
        whole = np.concatenate([whole, rows])
    np.testing.assert_array_equal(grown.rows, whole)
    grown.thin()
    np.testing.assert_array_equal(grown.rows, whole[::2])
    kept = StepRecords(np.array([0, 2, 4]), whole[:3]).merge({2: whole[7], 5: whole[8]})
    assert kept.steps.tolist() == [0, 2, 4, 5]
    np.testing.assert_array_equal(kept.records, whole[[0, 7, 2, 8]])
