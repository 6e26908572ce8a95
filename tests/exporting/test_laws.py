"""Laws of load cases: each balances, turns with the world, grows as the square of the speed, cuts to section loads."""

from __future__ import annotations

import json
from typing import Any

import numpy as np
import pytest

from heuncli.analyses.load_cases.assembly import BALANCE_TOLERANCE
from heuncli.analyses.load_cases.model import LoadCase, LoadCases, LoadedBody
from heuncli.analyses.load_cases.unit_systems import convert_load_cases, parse_units
from heuncli.results.results import Array
from heuncli.scene.file_format.load import load
from heuncli.scene.file_format.source import read_source
from heuncli.scene.shapes.rotations import cross_vectors
from heuncli.study.model.options import Options
from heuncli.study.queries.study import Study
from heuncli.study.workflow import solve
from tests.oracle.turns import random_rotation
from tests.oracle.values import to_yaml
from tests.shared import retell
from tests.shared.load_cases import cases_of, point_masses
from tests.shared.loops import loop_scene
from tests.shared.manual import ROOT
from tests.shared.scenes import moving, near, study
from tests.shared.trees import tree_scene

TIMES, AT = (0.0, 0.1, 0.3), "first,0.1,last"
SCENES = [*((tree_scene, seed) for seed in range(10)), *((loop_scene, seed) for seed in (1, 3, 5, 7, 1000, 1001, 1003))]
IDS = [f"{make.__name__}-{seed}" for make, seed in SCENES]


def run_of(scene: Any) -> Study:
    """A scene's run, split where something is open: a split balances, too."""
    return study(moving(scene, TIMES), least_norm=True)


def sums_of_points(body: LoadedBody, case: LoadCase) -> tuple[Array, Array]:
    """Forces and moments about the origin; the inertia is that of point masses under the case's acceleration."""
    masses, places = point_masses(body)
    inertia = [-m * case.field.acceleration_at(x) for m, x in zip(masses, places, strict=True)]
    force = sum((a.force for a in case.actions), np.sum(inertia, axis=0))
    moments = [cross_vectors(a.at, a.force) + a.moment for a in case.actions]
    moments += [cross_vectors(x, F) for x, F in zip(places, inertia, strict=True)]
    return force, np.sum(moments, axis=0)


@pytest.mark.parametrize(("make", "seed"), SCENES, ids=IDS)
@pytest.mark.third
def test_every_body_balances(make: Any, seed: int) -> None:
    """Of random trees and closed chains with loads and drives of all kinds; also with the inertia of point masses."""
    scene, _ = make(seed)
    run = run_of(scene)
    for name in scene["bodies"]:
        cases = cases_of(run, name, AT)
        for case in cases.cases:
            sums = cases.body.compute_sums(case)
            assert sums.relative <= BALANCE_TOLERANCE
            force, moment = sums_of_points(cases.body, case)
            near(force, 0.0, sums.largest_force)
            near(moment, 0.0, sums.largest_moment)


def compared(mine: LoadCases, its: LoadCases, Q: Array, force: float) -> None:
    """Its loads are mine, turned by Q and `force` times as large, in the same order."""
    for a, b in zip(mine.cases, its.cases, strict=True):
        sums = its.body.compute_sums(b)
        assert [(one.kind, one.name, one.source) for one in a.actions] == [
            (one.kind, one.name, one.source) for one in b.actions
        ]
        for one, other in zip(a.actions, b.actions, strict=True):
            near(Q @ one.at, other.at, 1.0)
            near(force * Q @ one.force, other.force, sums.largest_force, 1e-8)
            near(force * Q @ one.moment, other.moment, sums.largest_moment, 1e-8)
        masses, places = point_masses(mine.body)
        for m, x in zip(masses, places, strict=True):
            near(
                force * m * Q @ a.field.acceleration_at(x), m * b.field.acceleration_at(Q @ x), sums.largest_force, 1e-8
            )


@pytest.mark.parametrize("seed", [5, 8])
def test_the_world_turned(seed: int) -> None:
    """World and body axes turned by Q: every vector of a load case is turned with them."""
    scene, _ = tree_scene(seed)
    tree = retell.plain(read_source("scene.yaml", to_yaml(moving(scene, TIMES))).data)
    Q = random_rotation(np.random.default_rng(seed))
    runs = [solve(load("scene.yaml", json.dumps(one)), Options()) for one in (tree, retell.turned(tree, Q))]
    for name in scene["bodies"]:
        compared(cases_of(runs[0], name, "last"), cases_of(runs[1], name, "last"), Q, 1.0)


@pytest.mark.parametrize("seed", [1, 4])
def test_twice_as_fast(seed: int) -> None:
    """k -> c^2 k with sigma -> c sigma: all loads of a case are four times as large, the weight's included."""
    scene, _ = tree_scene(seed)
    tree = retell.plain(read_source("scene.yaml", to_yaml(moving(scene, TIMES))).data)
    runs = [solve(load("scene.yaml", json.dumps(one)), Options()) for one in (tree, retell.faster(tree, 2.0))]
    for name in scene["bodies"]:
        compared(cases_of(runs[0], name, "last"), cases_of(runs[1], name, "last"), np.eye(3), 4.0)


SECTIONED = [
    ("conrod", "rod", "rod", "peak:sections.rod.M2,first,0.0031"),
    ("whirling_rod", "rod", "blade", "first,0.01"),
    ("skew_rod", "rod", "half", "first"),
    ("crane", "jib", "along", "first,last"),
    ("chimney", "chimney", "shaft", "first"),
    ("hammered_four_bar", "coupler", "coupler", "impulse:0,last"),
    ("percussion", "bat", "along", "impulse:0"),
]


@pytest.mark.parametrize(("spec", "body", "section", "at"), SECTIONED, ids=[row[0] for row in SECTIONED])
def test_cut_through_a_case_are_the_section_loads(spec: str, body: str, section: str, at: str) -> None:
    """What stands on the piece, and the piece's inertia under the case's acceleration, are the section's loads."""
    run = solve(load(ROOT / "specs" / f"{spec}.yaml"), Options())
    cuts = next(cuts for cuts in run.setup.cuts if cuts.name == section)
    cases = cases_of(run, body, at)
    for case in cases.cases:
        told = section_of(run, case, section)
        sums = cases.body.compute_sums(case)
        for k, point in enumerate(cuts.points):
            beyond = [a for a in case.actions if side_of(a.at, point, cuts, k) > 0.0]
            force, about_origin = case.field.inertia_loads(cuts.pieces[k])
            force = sum((a.force for a in beyond), force)
            moment = sum((a.moment + cross_vectors(a.at - point, a.force) for a in beyond), about_origin)
            moment = moment - cross_vectors(point, case.field.inertia_loads(cuts.pieces[k])[0])
            for name, value in (("N", cuts.n @ force), ("Q1", cuts.e1 @ force), ("Q2", cuts.e2 @ force)):
                near(value, told[name][k], sums.largest_force)
            for name, value in (("T", cuts.n @ moment), ("M1", cuts.e1 @ moment), ("M2", cuts.e2 @ moment)):
                near(value, told[name][k], sums.largest_moment)


def section_of(run: Study, case: LoadCase, section: str) -> dict[str, Array]:
    """What the run tells of a section at the instant of a case, or at its blow, (k,)."""
    if case.is_impulse:
        return dict(run.make_impulse_blocks()[0]["sections"][section])
    told = run.resample(np.array([case.time])).sections[section]
    return {name: told[name][0] for name in ("N", "Q1", "Q2", "T", "M1", "M2")}


def side_of(at: Array, point: Array, cuts: Any, k: int) -> float:
    """On which side of a cut a point lies; in its plane the side of the cut decides."""
    off = float((at - point) @ cuts.n)
    return float(cuts.side[k]) if abs(off) <= cuts.plane_tolerance else off


@pytest.mark.parametrize("words", ["N,mm,t", "kN,mm,kg,ms", "lbf,in,slinch"])
def test_what_balances_does_so_in_any_units(words: str) -> None:
    """Rates and accelerations are of the unit of time, too: else the parts of the inertia would not fit together."""
    scene, _ = tree_scene(3)
    run = run_of(scene)
    for name in scene["bodies"]:
        told = cases_of(run, name, AT)
        own = convert_load_cases(told, parse_units(words))
        assert any(case.field.angular_acceleration.any() for case in own.cases)
        for case in own.cases:
            assert own.body.compute_sums(case).relative <= BALANCE_TOLERANCE
