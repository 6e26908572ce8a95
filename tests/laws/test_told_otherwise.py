"""The same scene told otherwise runs the same: turned, mirrored, other units, faster, names, origins, ends, other cuts.

A row of `tests/oracle/tellings.py` is a way of telling; a family of scenes says what is compared. Where reactions are
open, the split of least norm is compared: it is told by the scene alone, so it must turn and scale with it; and what is
open must be so in every telling that keeps the axes.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from functools import cache
from typing import Any

import numpy as np
import pytest

from heuncli.results.results import Results
from heuncli.study.queries.study import Study
from tests.oracle.read import state_at
from tests.oracle.solve import solve
from tests.oracle.tellings import EITHER_END, TELLINGS, Telling
from tests.shared import doubles
from tests.shared.loops import DRIVEN, QUICK, SOME, loop_scene
from tests.shared.open_components import open_parts, sums, told_by_sums
from tests.shared.retellings import same_results
from tests.shared.scenes import moving, near, solved, study
from tests.shared.seeds import spared
from tests.shared.trees import SOME as TREES
from tests.shared.trees import cut_through, seeds, tree_scene

TOLERANCE = 1e-12  # of the motion; what is derived from it agrees to SAME
SAME = 1e-9
LOOPS = spared([*SOME, *DRIVEN[:6]], QUICK)
DOUBLES = doubles.SEEDS[::6]
SCALARS = ("axial", "radial", "tilting", "tension", "drive")


def told(scene: dict[str, Any], way: str, seed: int) -> Telling:
    return TELLINGS[way](scene, np.random.default_rng(seed))


def each(ways: Iterable[str], seeds: Iterable[Any]) -> pytest.MarkDecorator:
    """Every way of telling for every seed, seed by seed, so that a scene is solved once for all its tellings."""
    ways = list(ways)
    rows = [s if hasattr(s, "values") else pytest.param(s) for s in seeds]
    pairs = [pytest.param(s.values[0], way, marks=s.marks) for s in rows for way in ways]
    return pytest.mark.parametrize(("seed", "way"), pairs)


def with_sections(scene: dict[str, Any], seed: int) -> dict[str, Any]:
    """A scene with cuts through its bodies."""
    rng = np.random.default_rng(1000 + seed)
    cuts = {f"cut_{name}": cut_through(body, rng) for name, body in scene["bodies"].items()}
    points = {n: f["on"] for n, f in scene.get("forces", {}).items() if f["type"] == "couple"}
    assert all(isinstance(on, dict) or "." in on for on in points.values())  # every couple says where it enters
    return {**scene, "sections": {n: {"body": n[4:], **c} for n, c in cuts.items() if c is not None}}


def run_tree(scene: Mapping[str, Any], time: float = 1.0) -> Results:
    return solved(moving(scene, np.array([0.0, 0.1, 0.25]) * time, TOLERANCE))


@cache
def tree(seed: int, **more: Any) -> tuple[dict[str, Any], Results]:
    scene = with_sections(tree_scene(seed, **more)[0], seed)
    return scene, run_tree(scene)


@pytest.mark.heavy
@each(("turned", "mirrored", "inches, pounds", "faster", "renamed", "other origins"), TREES)
@pytest.mark.sixth
def test_a_tree(seed: int, way: str) -> None:
    scene, first = tree(seed)
    other = told(scene, way, seed)
    same_results(other, first, run_tree(other.scene, other.time), SAME)


@pytest.mark.heavy
@each(("other ends",), seeds(8))
@pytest.mark.third
def test_a_tree_from_its_other_ends(seed: int, way: str) -> None:
    scene, first = tree(seed, kinds=EITHER_END)
    other = told(scene, way, seed)
    assert other.reversed == set(scene["joints"])
    same_results(other, first, run_tree(other.scene), SAME)


def run_loop(scene: Mapping[str, Any], time: float = 1.0) -> Results:
    return solved(moving(scene, np.array([0.0, 0.15]) * time, TOLERANCE), least_norm=True)


@cache
def loop(seed: int) -> tuple[dict[str, Any], Results]:
    scene, _ = loop_scene(seed)
    return scene, run_loop(scene)


@pytest.mark.heavy
@each(("turned", "mirrored", "mm, t, ms", "renamed", "renamed again", "other origins", "other ends"), LOOPS)
@pytest.mark.sixth
def test_a_loop(seed: int, way: str) -> None:
    scene, first = loop(seed)
    other = told(scene, way, seed)
    second = run_loop(other.scene, other.time)
    same_results(other, first, second, SAME)
    if way not in ("turned", "mirrored", "other ends"):
        same_choices(first, second, other.joints)


def same_choices(first: Results, second: Results, names: Mapping[str, str]) -> None:
    """The same components were open before a split was chosen."""
    for name, block in first.joints.items():
        assert second.joints[names.get(name, name)].get("chosen") == block.get("chosen")


@cache
def redundant(seed: int) -> tuple[dict[str, Any], Study]:
    scene = doubles.redundant_scene(seed)[1]
    return scene, study(scene)


def same_sums(one: Results, other: Results, joints: dict[str, str] | None = None) -> None:
    """Each tells what the other tells."""
    back = {new: old for old, new in (joints or {}).items()}
    for a, b, names in ((one, other, joints or {}), (other, one, back)):
        for terms, _ in sums(a):
            parts = [(n.split("."), factor) for n, factor in terms.items()]
            assert told_by_sums(b, {".".join([p[0], names.get(p[1], p[1]), *p[2:]]): factor for p, factor in parts})


@each(("turned", "mirrored"), DOUBLES)
@pytest.mark.third
def test_what_is_open_in_other_axes(seed: int, way: str) -> None:
    """World components are open by the oracle's self-stresses in the new directions; those along joints' axes stay."""
    scene, before = redundant(seed)[0], redundant(seed)[1].results
    other = told(scene, way, seed)
    found = solved(other.scene)
    plain = solve(scene, state_at(before.bodies, 0))
    assert found.model["redundant"] == before.model["redundant"]
    for name, block in found.joints.items():
        for part in ("force", "moment"):
            wanted = [not plain.along(name, **{part: other.Q.T[:, i]})[1] for i in range(3)]
            assert np.isnan(block[part][0]).tolist() == wanted, name
        for part in SCALARS:
            same = np.isnan(before.joints[name].get(part, [0.0])[0])
            assert np.isnan(block.get(part, [0.0])[0]) == same, (name, part)


@each(("mm, t, ms", "renamed"), DOUBLES)
@pytest.mark.third
def test_what_is_open(seed: int, way: str) -> None:
    """The same is open, the same sums are certain; under the same names they have the same terms, and all."""
    scene, before = redundant(seed)[0], redundant(seed)[1].results
    other = told(scene, way, seed)
    found = solved(other.scene)
    assert found.model["redundant"] == before.model["redundant"]
    assert open_parts(found) == {other.joints.get(name, name): parts for name, parts in open_parts(before).items()}
    same_sums(before, found, dict(other.joints))
    if other.joints:
        return
    load = float(np.abs(before.foundation["force"]).max())
    for (terms, value), (others, summed) in zip(sums(before), sums(found), strict=True):
        assert terms.keys() == others.keys()
        unit = other.force if ".force." in next(iter(terms)) else other.moment
        most = max(map(abs, terms.values()))
        near(list(others.values()), list(terms.values()), most, 1e-9)
        near(summed, value * unit, most * load * unit)


def closed_at(run: Study) -> set[str]:
    """The joints a run's loops are closed at."""
    scene = run.setup.scene
    return {scene.mechanism.joints[k].name for k in scene.layout.spanning.cut}


@pytest.mark.heavy
def test_closed_elsewhere() -> None:
    """Joints told in reverse close chains at others: counted, so that the test of it tests something."""
    elsewhere = 0
    for seed in DOUBLES:
        scene, before = redundant(seed)
        run = study({**scene, "joints": dict(reversed(scene["joints"].items()))})
        elsewhere += closed_at(before) != closed_at(run)
        assert open_parts(run.results) == open_parts(before.results)
        same_sums(before.results, run.results)
    assert elsewhere >= 5


LOOP = {"type": "pin", "axis": [0.1, 0.2, 1.0]}


def ring(kinds: tuple[str, ...]) -> dict[str, Any]:
    """A closed chain of bars in space, each on a pin or slide to the next, all axes parallel."""
    n = len(kinds)
    corners = np.array([[np.cos(a), np.sin(a), 0.1 * k] for k, a in enumerate(2 * np.pi * np.arange(n) / n)])
    axis = np.array(LOOP["axis"])
    bodies: dict[str, Any] = {}
    for k in range(1, n):
        middle = (corners[k - 1] + corners[k]) / 2
        bodies[f"b{k}"] = {
            "mass": 1.0 + 0.2 * k,
            "center": middle.tolist(),
            "inertia": [0.11, 0.12, 0.13],
            "points": {"O": [0, 0, 0]},
        }
    joints = {}
    for k, kind in enumerate(kinds):
        a, b = ("ground", "b1") if k == 0 else (f"b{k}", f"b{k + 1}") if k < n - 1 else (f"b{n - 1}", "ground")
        direction = axis if kind == "pin" else np.cross(axis, corners[k] + [0.3, 0, 0])
        ends = {"from": {"body": a, "at": corners[k].tolist()}, "to": {"body": b, "at": corners[k].tolist()}}
        joints[f"j{k}"] = {"type": kind, "axis": direction.tolist(), **ends}
    joints["j0"]["initial"] = {"rate": 1.3}
    return {"title": "ring", "gravity": [1.0, -9.0, 0.5], "bodies": bodies, "joints": joints}


@pytest.mark.parametrize("kinds", [("pin",) * 4, ("pin", "pin", "slide", "pin"), ("pin", "slide", "pin", "pin", "pin")])
def test_every_cut_gives_the_same(kinds: tuple[str, ...]) -> None:
    """A joint named in an expression is never cut: naming all but one chooses where the ring is closed."""
    scene = ring(kinds)
    if len(kinds) == 5:
        scene["joints"]["j1"]["initial"] = {"speed": 0.4}
    cuts, results = set(), []
    for open_at in range(len(kinds)):
        named = [f"j{k}.angle" if kind == "pin" else f"j{k}.travel" for k, kind in enumerate(kinds) if k != open_at]
        nothing = {"type": "force", "on": "b1.O", "vector": ["0*(" + "+".join(named) + ")", 0, 0]}
        run = study(moving({**scene, "forces": {"nothing": nothing}}, (0.0, 0.15), TOLERANCE), least_norm=True)
        cuts |= closed_at(run)
        results.append(run.results)
    assert cuts == set(scene["joints"])
    for other in results[1:]:
        same_results(Telling(scene), results[0], other, SAME)
        same_choices(results[0], other, {})
        for name, block in results[0].coordinates.items():
            for what, values in block.items():
                near(other.coordinates[name][what], values, max(1.0, float(np.abs(values).max())), SAME)
