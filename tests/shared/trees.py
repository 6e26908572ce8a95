"""Random trees, solved once for all laws: even seeds hang on balls and pins, odd ones on joints of every kind."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from functools import cache
from typing import Any

import numpy as np

from heuncli.results.results import Results
from heuncli.study.queries.study import Study
from tests.oracle.masses import mass_of
from tests.oracle.read import Model, Placed, model, state_at
from tests.oracle.scenes import ALL_KINDS, random_scene
from tests.oracle.solve import Solution, solve
from tests.oracle.transforms import entry, without_mass
from tests.oracle.turns import Array, random_unit
from tests.shared.scenes import moving, study
from tests.shared.seeds import spared

QUICK = frozenset({0, 1, 4, 6, 8, 9, 11, 12, 14, 16})  # scenes that the plain kernel runs in half a second


def seeds(count: int) -> list[Any]:
    """The first seeds, those too long for the plain kernel marked."""
    return spared(range(count), QUICK)


SEEDS = seeds(60)
SOME = seeds(13)
TIMES = (0.0, 0.1, 0.3)
ABOUT = np.array([0.3, -0.2, 0.5])  # where moments of the foundation are taken


@dataclass(frozen=True, eq=False)
class Case:
    """A scene, its run, and the oracle's answer at every instant of the run.

    plain: the same with the oracle's mass properties in place of shapes.
    force, length: what deviations are measured in: the largest load, reaction or inertia force of that instant [N], and
    the farthest any joint or centre lies from the origin [m].
    """

    scene: dict[str, Any]
    plain: dict[str, Any]
    read: Model
    study: Study
    states: list[dict[str, Placed]]
    oracle: list[Solution]
    force: list[float]
    length: float

    @property
    def found(self) -> Results:
        """What the run tells."""
        return self.study.results


def tree_scene(seed: int, **more: Any) -> tuple[dict[str, Any], dict[str, Placed]]:
    """The scene of a seed; `more` as random_scene takes it."""
    rng = np.random.default_rng(seed)
    settings: dict[str, Any] = {
        "n_bodies": int(rng.integers(1, 7)), "free": 0.1, "roots": 0.2,
        "kinds": ALL_KINDS if seed % 2 else ("ball", "pin"), "masses": "shapes" if seed // 2 % 2 else "given",
    }  # fmt: skip
    return random_scene(rng, **{**settings, **more})


@cache
def tree(seed: int) -> Case:
    """A random tree's run over TIMES."""
    scene, _ = tree_scene(seed)
    return case({**scene, "foundation": {"about": ABOUT.tolist()}})


def case(scene: Mapping[str, Any]) -> Case:
    """Any scene's run over TIMES, with the oracle's answer."""
    run = study(moving(scene, TIMES, 1e-12))
    plain = weighed(scene)
    read = model(plain)
    states = [state_at(run.results.bodies, k) for k in range(len(TIMES))]
    oracle = [solve(read, s, t, about=ABOUT) for s, t in zip(states, TIMES, strict=True)]
    points = [r.point for o in oracle for r in o.reactions.values()]
    points += [s.point(read.masses[b].center) for state in states for b, s in state.items()]
    length = max(1.0, *(float(np.linalg.norm(p)) for p in points))
    return Case(dict(scene), plain, read, run, states, oracle, [force_of(read, o) for o in oracle], length)


def weighed(scene: Mapping[str, Any]) -> dict[str, Any]:
    """The scene with mass properties, as the oracle finds them, in place of shapes."""
    bodies = {name: {**without_mass(body), **entry(mass_of(body))} for name, body in scene["bodies"].items()}
    return {**scene, "bodies": bodies}


def force_of(read: Model, o: Solution) -> float:
    """Largest load, reaction or inertia force [N]."""
    loads = [np.linalg.norm(p.force) for parts in o.loads.values() for p in parts]
    loads += [np.linalg.norm(r.force) for r in o.reactions.values()]
    loads += [m.mass * np.linalg.norm(o.acceleration[b]) for b, m in read.masses.items()]
    return float(max(loads))


def inside(shape: dict[str, Any], rng: np.random.Generator) -> Array:
    """A place inside a shape, not its centre, where another shape may have a point."""
    if "from" in shape:
        return 0.4 * np.array(shape["from"]) + 0.6 * np.array(shape["to"])
    reach = min(shape["size"]) / 2 if "size" in shape else shape["radius"]
    return np.array(shape["center"]) + 0.4 * reach * random_unit(rng)


def cut_through(body: dict[str, Any], rng: np.random.Generator) -> dict[str, Any] | None:
    """An oblique cut of a body with shapes."""
    solid = [s for s in body.get("shapes", ()) if s["type"] != "point"]
    if not solid:
        return None
    at = inside(solid[0], rng)
    return {"at": at.tolist(), "normal": random_unit(rng).tolist(), "first_axis": random_unit(rng).tolist()}
