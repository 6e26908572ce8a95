"""Loads by their causes against the independent solution on absolute coordinates, each cause by itself.

Random trees and closed chains, with drives in some; joints, foundation with its supports, and sections by the weld
oracle. What is open in the whole is open in every share; a split by least norm is linear, so its shares are compared.
"""

from __future__ import annotations

from functools import cache
from typing import Any

import numpy as np
import pytest

from heuncli.results.results import Results
from tests.oracle.causes import solve_by_cause
from tests.oracle.masses import Plane, cut
from tests.oracle.read import State, model, state_at
from tests.oracle.solve import Solution, solve
from tests.oracle.totals import supports
from tests.oracle.turns import unit
from tests.oracle.weld import PIECE, SAW, saw
from tests.shared.loops import loop_scene
from tests.shared.scenes import moving, near, solved, study
from tests.shared.trees import ABOUT, cut_through, tree_scene, weighed

WANTED = frozenset({"motion", "foundation", "joints", "sections", "shares"})
TIMES = (0.0, 0.1)
TREES = [0, 1, 3, *(pytest.param(n, marks=pytest.mark.heavy) for n in range(5, 14))]
LOOPS = [1, *(pytest.param(n, marks=pytest.mark.heavy) for n in [*range(2, 12), *range(1000, 1008)])]
CUT = [pytest.param(n, marks=pytest.mark.heavy) for n in range(6)]


@cache
def scene_of(kind: str, seed: int) -> dict[str, Any]:
    """A random scene; trees all of shapes, to be cut."""
    made, _ = loop_scene(seed) if kind == "loop" else tree_scene(seed, masses="shapes" if kind == "cut" else "given")
    return {**made, "foundation": {"about": ABOUT.tolist()}}


@cache
def run(kind: str, seed: int) -> tuple[Results, list[dict[str, Solution]], list[State]]:
    """Its results by cause, and the oracle's at every instant, with its states."""
    scene = scene_of(kind, seed)
    results = solved(moving(scene, TIMES, 1e-12), requested_reports=WANTED)
    read = model(weighed(scene))
    states = [state_at(results.bodies, k) for k in range(len(TIMES))]
    return results, [solve_by_cause(read, s, t, ABOUT) for s, t in zip(states, TIMES, strict=True)], states


def largest(causes: dict[str, Solution]) -> float:
    """The largest force that any cause makes [N]."""
    return max(
        [float(np.abs(r.force).max()) for o in causes.values() for r in o.reactions.values()]
        + [float(np.abs(p.force).max()) for o in causes.values() for parts in o.loads.values() for p in parts]
        + [1.0]
    )


def length(causes: dict[str, Solution]) -> float:
    """The farthest joint from the origin [m]."""
    return max([1.0, *(float(np.linalg.norm(r.point)) for o in causes.values() for r in o.reactions.values())])


@pytest.mark.parametrize(
    ("kind", "seed"),
    [*(("tree", n) for n in range(3)), ("loop", 1), pytest.param("loop", 1002, marks=pytest.mark.heavy)],
)
def test_what_the_oracle_finds_by_cause_adds_up(kind: str, seed: int) -> None:
    scene = scene_of(kind, seed)
    _, oracle, states = run(kind, seed)
    for causes, state, t in zip(oracle, states, TIMES, strict=True):
        whole = solve(weighed(scene), state, t, ABOUT)
        F = largest(causes)
        near(sum(o.foundation_force for o in causes.values()), whole.foundation_force, F)
        for name, r in whole.reactions.items():
            near(sum(o.reactions[name].force for o in causes.values()), r.force, F)


def compared(kind: str, seed: int) -> None:
    results, oracle, states = run(kind, seed)
    for k, (causes, state) in enumerate(zip(oracle, states, strict=True)):
        F, L = largest(causes), length(causes)
        for cause, o in causes.items():
            for name, block in results.joints.items():
                share, r = block["shares"][cause], o.reactions[name]
                for quantity, wanted, size, places in (
                    ("force", r.force, F, slice(0, 3)), ("moment", r.moment, F * L, slice(3, 6)),
                ):  # fmt: skip
                    unique = r.unique[places]
                    assert not np.isnan(share[quantity][k][unique]).any(), (name, cause)
                    near(share[quantity][k][unique], wanted[unique], size)
                if "drive" in share and r.unique[6]:
                    near(share["drive"][k], r.drive, F * L)
            near(results.foundation["shares"][cause]["force"][k], o.foundation_force, F)
            near(results.foundation["shares"][cause]["moment"][k], o.foundation_moment, F * L)
            for name, w in supports(weighed(scene_of(kind, seed)), state, o).items():
                known = ~np.isnan(results.foundation["supports"][name]["force"][k])
                own = results.foundation["supports"][name]["shares"][cause]
                assert np.array_equal(np.isnan(own["force"][k]), ~known)
                near(own["force"][k][known], w.force[known], F)


@pytest.mark.parametrize("seed", TREES)
@pytest.mark.third
def test_trees(seed: int) -> None:
    compared("tree", seed)


@pytest.mark.parametrize("seed", LOOPS)
@pytest.mark.third
def test_closed_chains(seed: int) -> None:
    compared("loop", seed)


@pytest.mark.parametrize("seed", LOOPS)
@pytest.mark.third
def test_a_split_by_least_norm(seed: int) -> None:
    """Of redundant joints, with moments by the length that the split is told with."""
    scene = scene_of("loop", seed)
    made = study({**scene, "analysis": {"type": "state"}}, requested_reports=WANTED, least_norm=True)
    resolution = made.recovery.resolution
    if resolution is None or resolution.stress is None:
        return
    found = made.results
    causes = solve_by_cause(weighed(scene), state_at(found.bodies, 0), 0.0, ABOUT, length=resolution.stress.length)
    F, L = largest(causes), length(causes)
    for cause, o in causes.items():
        for name, block in found.joints.items():
            near(block["shares"][cause]["force"][0], o.reactions[name].force, F, 1e-7)
            near(block["shares"][cause]["moment"][0], o.reactions[name].moment, F * L, 1e-7)


@pytest.mark.parametrize("seed", CUT)
@pytest.mark.third
def test_sections(seed: int) -> None:
    """The weld between the two parts of every body, cause by cause; what stands on the piece is told apart."""
    scene = scene_of("cut", seed)
    rng = np.random.default_rng(seed)
    cuts = {f"cut_{name}": {"body": name, **(cut_through(body, rng) or {})} for name, body in scene["bodies"].items()}
    found = solved({**moving(scene, TIMES, 1e-12), "sections": cuts}, requested_reports=WANTED)
    for k, t in enumerate(TIMES):
        state = state_at(found.bodies, k)
        for name, told in cuts.items():
            plane = Plane(np.array(told["at"]), unit(told["normal"]), None)
            piece = cut(scene["bodies"][told["body"]], plane)[1]
            sawn = model(saw(weighed(scene), state, told["body"], told["at"], told["normal"], None, piece))
            both = {**state, told["body"] + PIECE: state[told["body"]]}
            causes = solve_by_cause(sawn, both, t)
            F, L = largest(causes), length(causes)
            for cause, o in causes.items():
                share = found.sections[name]["shares"][cause]
                near(share["force"][k], o.reactions[SAW].force, F)
                near(share["moment"][k], o.reactions[SAW].moment, F * L)
                own = [p for parts in o.loads.values() for p in parts if p.body == told["body"] + PIECE]
                if own or "direct_force" in share:
                    at = o.reactions[SAW].point
                    near(share["direct_force"][k], sum((p.force for p in own), np.zeros(3)), F)
                    near(share["direct_moment"][k], sum((p.about(at) for p in own), np.zeros(3)), F * L)
