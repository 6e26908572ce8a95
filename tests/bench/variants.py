"""What a variant takes: a scene solved again with one value changed, read and set up anew, and by the door."""

from __future__ import annotations

import statistics
import time
from collections.abc import Callable
from contextlib import suppress
from typing import Any, NamedTuple

from heuncli.analyses.variants.solver import VariantSolver
from heuncli.base.errors import HeunError
from heuncli.results.results_schema import REPORTS
from heuncli.scene.file_format.load import load
from heuncli.study.model.options import Options
from heuncli.study.queries.measure import MeasureRequest, measure_value
from heuncli.study.workflow import solve
from tests.bench.finds import finds
from tests.shared.folders import ROOT, SPECS

STARTERS = ROOT / "heuncli" / "starters"
REPEATS, MEASURES = 31, 200


class Case(NamedTuple):
    """A spec, what is set in it, its value in the file, and what hangs on that."""

    path: Any
    key: str
    value: float
    what: str


CASES = (
    Case(SPECS / "double.yaml", "bodies.upper.mass", 1.0, "a mass"),
    Case(SPECS / "double.yaml", "bodies.lower.angular_velocity.vector.0", -0.5, "a start"),
    Case(SPECS / "slider_crank.yaml", "r", 0.05, "lengths of a loop"),
    Case(SPECS / "slider_crank.yaml", "w", 100.0, "a rate"),
    Case(SPECS / "percussion.yaml", "H", 1.0, "a blow"),
    Case(SPECS / "rotor.yaml", "n", 300.0, "a drive"),
    Case(STARTERS / "truss.yaml", "F", 1e4, "a load"),
    Case(STARTERS / "truss.yaml", "a", 2.0, "lengths of a loop"),
)

MEASURED = (
    (CASES[0], MeasureRequest("max", "joints.pivot.force")),
    (CASES[2], MeasureRequest("max", "joints.main.force")),
    (CASES[5], MeasureRequest("max", "joints.left.force")),
    (CASES[6], MeasureRequest("max", "joints.low.force")),
)

REFUSED = (
    Case(SPECS / "slider_crank.yaml", "r", 0.5, "a crank longer than the rod"),
    Case(STARTERS / "four_bar.yaml", "bodies.rocker.points.C.0", 1.5, "a rocker longer than all other bars"),
    Case(SPECS / "four_bar.yaml", "bodies.coupler.points.C.0", 1.5, "a coupler longer than all other bars"),
)


def variants() -> None:
    """Print it, of all results and of one joint's loads alone, and of one measure; and what a search takes."""
    print(f"{'':28s}{'all results [ms]':>26s}{'one joint [ms]':>26s}")
    print(f"{'':28s}{'fresh':>10s}{'door':>8s}{'read':>8s}{'fresh':>10s}{'door':>8s}{'read':>8s}")
    for case in CASES:
        joint = next(iter(load(case.path).joints), None)
        one = Options(requested_reports=frozenset({"joints"}), entries=frozenset({("joints", joint)} if joint else ()))
        figures = [
            ms for options in (Options(requested_reports=frozenset(REPORTS)), one) for ms in costs(case, options)
        ]
        columns = "".join(f"{ms:{10 if k % 3 == 0 else 8}.2f}" for k, ms in enumerate(figures))
        print(f"{case.path.stem + ' ' + case.what:28s}{columns}")
    print(f"\n{'one measure of each, searched between the samples':58s}{'median':>8s}{'mean':>8s} [ms]")
    for case, asked in MEASURED:
        took = of_measure(case, asked)
        title = f"{case.path.stem} {case.what}: {asked.how} {asked.path}"
        print(f"{title:58s}{statistics.median(took):8.2f}{statistics.fmean(took):8.2f}")
    print(f"\n{'variants that cannot be assembled':58s}{'median':>8s} [ms]")
    for case in REFUSED:
        print(f"{case.path.stem + ' ' + case.what:58s}{of_refusal(case):8.1f}")
    finds()


def of_measure(case: Case, asked: MeasureRequest) -> list[float]:
    """Processor time of each of some variants with one measure, as `heun run --set ... --measure` has it [ms]."""
    prepared = VariantSolver(case.path, measures=[asked.path])
    found = []
    for k in range(MEASURES):
        values = {case.key: repr(case.value * (1.0 + 0.2 * k / MEASURES))}
        begun = time.process_time()
        measure_value(asked, prepared.solve(values))
        found.append(1e3 * (time.process_time() - begun))
    return found


def of_refusal(case: Case) -> float:
    """Median processor time of a variant that is refused [ms]."""
    prepared, found = VariantSolver(case.path), []
    for k in range(5):
        begun = time.process_time()
        with suppress(HeunError):
            prepared.solve({case.key: repr(case.value * (1.0 + 0.01 * k))})
        found.append(1e3 * (time.process_time() - begun))
    return statistics.median(found)


def costs(case: Case, options: Options) -> tuple[float, float, float]:
    """Median processor time of a variant [ms]: fresh, by the door, and of that the reading; in turn."""
    prepared = VariantSolver(case.path, options=options)
    found: dict[str, list[float]] = {"fresh": [], "door": [], "read": []}
    for k in range(REPEATS):
        values = {case.key: repr(case.value * (1.0 + 1e-3 * (k + 1)))}
        doing: dict[str, Callable[[], Any]] = {
            "fresh": lambda: solve(load(case.path, overrides=values, checking=False), options),  # noqa: B023 - at once
            "door": lambda: prepared.solve(values),  # noqa: B023
            "read": lambda: prepared.load(values),  # noqa: B023
        }
        for name, do in doing.items():
            begun = time.process_time()
            do()
            found[name].append(1e3 * (time.process_time() - begun))
    fresh, door, read = (statistics.median(times) for times in found.values())
    return fresh, door, read
