"""Runs with blows beside the oracle's answers, in the form that the checks of instants take (checks.py).

A blow is to velocities and impulses what an instant is to accelerations and forces: the same checks serve both.
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from types import SimpleNamespace
from typing import Any

import numpy as np

from heuncli.study.queries.study import Study
from tests.oracle.impulses import struck
from tests.oracle.read import Model, Placed, model, state_at
from tests.oracle.solve import Solution
from tests.shared.scenes import study
from tests.shared.trees import ABOUT, force_of, weighed

JUMPS = {"center_velocity_jump": "center_acceleration", "angular_velocity_jump": "angular_acceleration"}


@dataclass(frozen=True, eq=False)
class Blown:
    """As Case (tests/shared/trees.py), with blows for instants: jumps for accelerations, impulses for forces.

    times: of the blows; states: just before each; found: the blocks of the results one after the other.
    """

    scene: dict[str, Any]
    plain: dict[str, Any]
    read: Model
    study: Study
    times: list[float]
    states: list[dict[str, Placed]]
    oracle: list[Solution]
    force: list[float]
    length: float
    found: Any


def blown(scene: Mapping[str, Any]) -> Blown:
    """Run a scene with impulses. The states before the blows are the run's own, by `before`."""
    run = study(scene)
    blocks = run.results.impulses
    plain = weighed(scene)
    read = model(plain)
    times = [float(b["time"]) for b in blocks]
    states = [before(run, plain, b) for b in blocks]
    oracle = [struck(plain, s, t, about=ABOUT) for s, t in zip(states, times, strict=True)]
    points = [r.point for o in oracle for r in o.reactions.values()]
    points += [s.point(read.masses[b].center) for state in states for b, s in state.items()]
    length = max(1.0, *(float(np.linalg.norm(p)) for p in points))
    force = [force_of(read, o) for o in oracle]
    return Blown(dict(scene), plain, read, run, times, states, oracle, force, length, stacked(blocks))


def before(run: Study, plain: Mapping[str, Any], block: Mapping[str, Any]) -> dict[str, Placed]:
    """The state just before a blow: of the run the double next below, at its start what the scene itself says."""
    t = float(block["time"])
    if t > float(run.setup.spec.analysis.times[0]):
        return state_at(run.resample(np.array([math.nextafter(t, 0.0)])).bodies, 0)
    after = state_at(run.resample(np.array([t])).bodies, 0)
    state = {}
    for name, s in after.items():  # placed by the assembly; its rates are those after less the jumps
        turn = np.asarray(block["bodies"][name]["angular_velocity_jump"])
        center = model(plain).masses[name].center
        shift = np.asarray(block["bodies"][name]["center_velocity_jump"]) - np.cross(turn, s.rotation @ center)
        state[name] = s._replace(velocity=s.velocity - shift, angular_velocity=s.angular_velocity - turn)
    return state


def stacked(blocks: Sequence[Mapping[str, Any]]) -> Any:
    """The blocks of all blows as one with a leading axis."""

    def joined(parts: Sequence[Any], key: str = "") -> Any:
        if key == "open":
            return sorted({name for part in parts for name in part})
        if isinstance(parts[0], Mapping):
            return {k: joined([p[k] for p in parts], k) for k in parts[0]}
        return [*parts] if isinstance(parts[0], str) else np.array(parts, dtype=float)

    kinds = [k for k in ("bodies", "foundation", "joints", "sections") if k in blocks[0]]
    shown = {k: joined([b[k] for b in blocks], k) for k in kinds}
    bodies = {b: {JUMPS.get(k, k): v for k, v in block.items()} for b, block in shown["bodies"].items()}
    return SimpleNamespace(**{"sections": {}, "joints": {}, "couplings": {}, **shown, "bodies": bodies})
