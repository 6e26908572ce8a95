"""Measures of variants solved one after another are those of single runs: every bit, error, warning and refusal."""

from __future__ import annotations

import random
from pathlib import Path
from typing import Any

import pytest

from heuncli.analyses.variants.evaluation import SPELLING_CODES, Recipe, VariantEvaluator, measure_study
from heuncli.analyses.variants.measures import VariantResult, make_failed_result
from heuncli.analyses.variants.parameters import CASE
from heuncli.base.errors import HeunError
from heuncli.scene.file_format.load import load
from heuncli.study.model.options import Options
from heuncli.study.model.selection import select_paths
from heuncli.study.queries.measure import MeasureRequest
from heuncli.study.workflow import solve
from tests.shared.bits import bits
from tests.shared.folders import ROOT, SPECS

STARTERS = ROOT / "heuncli" / "starters"
COUNT = 4
# A tree; loops that some lengths do not close; a reduced plane; impacts; an event; an impulse; a state; load cases.
FAMILIES: tuple[tuple[Path, dict[str, tuple[float, float]], tuple[tuple[str, str], ...]], ...] = (
    (SPECS / "double.yaml", {"bodies.upper.mass": (0.5, 2.0)}, (("max", "joints.pivot.force"),)),
    (SPECS / "slider_crank.yaml", {"r": (0.02, 0.5), "w": (20.0, 200.0)}, (("abs", "joints.main.force.x"),)),
    (STARTERS / "four_bar.yaml", {"bodies.rocker.points.C.0": (0.1, 1.0)}, (("max", "joints.C.force"),)),
    (SPECS / "top.yaml", {"gravity.2": (-20.0, 0.0)}, (("max", "energy.kinetic"),)),
    (SPECS / "bouncing_ball.yaml", {"e": (-0.2, 1.2), "h": (0.2, 2.0)}, (("max", "stops.floor.force"),)),
    (SPECS / "ladder.yaml", {"tilt": (0.1, 1.2)}, (("first", "events.until.time"), ("max", "joints.wall.force"))),
    (SPECS / "percussion.yaml", {"h": (0.1, 1.0), "H": (-1.0, 1.0)}, (("max", "joints.hand.force"),)),
    (STARTERS / "truss.yaml", {"a": (-0.5, 3.0), "F": (-1e4, 1e4)}, (("max", "joints.low.force"),)),
    (SPECS / "axle_loads.yaml", {"m": (800.0, 2000.0)}, (("max", "foundation.force"),)),
)  # fmt: skip


def solve_alone(path: Path, requests: tuple[MeasureRequest, ...], values: dict[str, str]) -> VariantResult:
    """The result of a variant that nothing was solved before, without anything that variants share."""
    overrides = {name: text for name, text in values.items() if name != CASE}
    try:
        spec = load(path, overrides=overrides, case=values.get(CASE), checking=False)
        selection = select_paths([request.path for request in requests], spec)
        study = solve(spec, Options(requested_reports=selection.reports, entries=selection.entries))
        measures = tuple(measure_study(request, study) for request in requests)
    except HeunError as error:
        return make_failed_result(error)
    read = (problem.message for problem in study.spec.warnings if problem.code not in SPELLING_CODES)
    warnings = (*read, *study.results.warnings, *study.later_warnings)
    is_singular = bool(len(study.history.singular) or study.left_out or study.unknown)
    return VariantResult(measures, warnings=tuple(dict.fromkeys(warnings)), singular=is_singular)


def draw(ranges: dict[str, tuple[float, float]], seed: Any) -> dict[str, str]:
    """Random values of some numbers; by turns only one of them differs from the spec's."""
    numbers = random.Random(seed)
    chosen = ranges if numbers.random() < 0.5 else [numbers.choice([*ranges])]
    return {name: repr(numbers.uniform(*ranges[name])) for name in chosen}


@pytest.mark.parametrize("family", FAMILIES, ids=lambda family: family[0].stem)
@pytest.mark.parametrize("seed", [0, 1])
@pytest.mark.third
def test_a_variant_measures_what_a_single_run_does(family: Any, seed: int) -> None:
    path, ranges, words = family
    requests = tuple(MeasureRequest(how, what) for how, what in words)
    evaluator = VariantEvaluator(Recipe(str(path), path.read_text(), requests, Options(), {}))
    cases = [*evaluator.spec.cases]
    for k in range(COUNT):
        values = draw(ranges, f"{path.stem} {seed} {k}") | ({CASE: cases[k % len(cases)]} if cases else {})
        assert [*bits(evaluator.answer(values))] == [*bits(solve_alone(path, requests, values))], values
