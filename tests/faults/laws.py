"""Wrong numbers with exit code 0, hunted by laws: a mutated scene that runs fine, told otherwise, must say the same.

The world turned; everything faster (Heun: k -> c² k with σ -> c σ makes all reactions c² times as large); another order
in the file; begun anew at a later instant; nothing reduced; another method; other instants; a body in two halves that
are welded; a joint from its other end.
"""

from __future__ import annotations

import time
from collections.abc import Callable
from random import Random
from typing import Any, NamedTuple

import numpy as np

from heuncli.base.errors import HeunError
from heuncli.scene.file_format.load import load
from heuncli.study.model.options import Options
from heuncli.study.queries.study import Study
from heuncli.study.workflow import solve
from tests.faults import mild, sources
from tests.faults.agree import apart, beyond_peaks, growing, kept, measured_in, state_at, turning
from tests.faults.outcome import peak
from tests.faults.sources import Tree
from tests.shared import retell
from tests.shared.retell_elements import NotTold
from tests.shared.retell_elements import from_the_other_side as from_side

LIMIT = 5.0  # seconds of a run
SEVERAL = 0.3  # of the scenes so many are random ones, the others the repository's
OF_ELEMENTS = 0.5  # of the random ones so many have machine elements
OTHER_METHODS = ("DOP853", "Radau5", "Radau9", "Verner98", "DOPRI5", "DOP853-recentred")


class Twins(NamedTuple):
    """A scene, its twin, what that does to the numbers, and what it leaves alone."""

    first: Tree
    second: Tree
    apart: Callable[[Study, Study], list[Any]]
    options: dict[str, Any] = {}  # noqa: RUF012 (of a named tuple: never changed)


def scene(random: Random) -> Tree:
    """A scene of the repository, or a random one, changed mildly or not at all."""
    if random.random() < SEVERAL:
        return mild.changed(random, random_scene(random), mild.OF_HELD)
    return mild.changed(random, sources.tree(random.choice(sources.names())))


def random_scene(random: Random) -> Tree:
    """A tree or a closed chain with all its values in time, as the oracle makes them; machine elements."""
    from tests.oracle.values import to_yaml
    from tests.shared.coupled_scenes import coupled_scene
    from tests.shared.loops import loop_scene
    from tests.shared.trees import tree_scene

    seed = random.randrange(100_000)
    if random.random() < OF_ELEMENTS:
        found: Tree = sources.parsed(to_yaml(coupled_scene(seed)))
        return found
    made = random.choice((tree_scene, lambda seed: loop_scene(seed % 1000 + random.choice((0, 1000)))))(seed)[0]
    analysis = {"times": [0.0, 0.05, 0.1, 0.2]}
    told: Tree = sources.parsed(to_yaml({**made, "analysis": analysis}))
    return told


def judged(seed: int) -> dict[str, Any]:
    """The verdict on a case: code 0 if both ran, 1 if the scene was refused."""
    random = Random(f"laws {seed}")
    begun = time.process_time()
    law, code, found = "none", 0, list[str]()
    try:
        tree = retell.plain(scene(random))
        law, twins = told_otherwise(random, tree, solved(tree))
        first = solved(twins.first)
    except SCENE_AT_FAULT:
        code = 1
    except Broken as bug:
        code, found = 70, [f"a bug in heun: {bug}"]
    else:
        found = compared(twins, first)
    told = [f"{law}: {what}" for what in found]
    return {
        "code": code, "seconds": time.process_time() - begun, "memory": peak(), "violations": told, "command": law,
    }  # fmt: skip


def compared(twins: Twins, first: Study) -> list[str]:
    """What the twin says otherwise."""
    try:
        second = solved(twins.second, **twins.options)
    except HeunError as error:
        return refused(error)
    except Broken as bug:
        return [f"a bug in heun: {bug}"]
    ends = [one.results.status["code"] for one in (first, second)]
    lost = any(one.results.accuracy.get("horizon") is not None for one in (first, second))
    return [f"ends: {ends}"] if ends[0] != ends[1] and not lost else [str(one) for one in twins.apart(first, second)]


class Broken(Exception):
    """A bug in what is judged."""


# A mutated tree may be no scene; what heun says of it is judged by the other kinds of cases.
SCENE_AT_FAULT = (HeunError, NotTold, KeyError, TypeError, AttributeError, ValueError, IndexError)


def told_otherwise(random: Random, tree: Tree, study: Study) -> tuple[str, Twins]:
    """The first of the laws, in a random order, that applies to a scene."""
    for law in random.sample(list(LAWS), len(LAWS)):
        try:
            return law, LAWS[law](random, tree, study)
        except NotTold:
            continue
    raise NotTold("no law applies")


# What a run may be refused for in one telling and not in another: limits, and steps of methods that were asked for.
OF_ITS_OWN = {"time-limit", "step-limit", "stages-unsolved", "method-scene", "half-turn", "too-many-states"}


def refused(error: HeunError) -> list[str]:
    """A twin that is refused; not where that is the other method's own affair."""
    codes = {problem.code for problem in error.problems}
    return [] if codes <= OF_ITS_OWN else [f"refused: {error.problems[0]}"]


def solved(tree: Tree, **options: Any) -> Study:
    """A tree solved, with all that it may report."""
    tree = {key: value for key, value in tree.items() if key != "report"}
    try:
        return solve(load("spec.yaml", sources.text(tree).decode()), Options(time_limit=LIMIT, **options))
    except HeunError:
        raise
    except Exception as bug:
        raise Broken(f"{type(bug).__name__}: {bug}") from bug


def turned(random: Random, tree: Tree, _: Study) -> Twins:
    Q = retell.turn_of(random)
    first = retell.with_first_axes(tree)
    own = frozenset(f"forces.{n}" for n, load in retell.entries(tree, "forces") if load.get("type") == "bushing")
    twin = retell.turned(first, Q)
    return Twins(first, twin, lambda a, b: apart(a, b, turning(Q), same_open=False, skipped=own))


def faster(random: Random, tree: Tree, _: Study) -> Twins:
    c = random.choice((0.5, 2.0, 1.7, 10.0))
    return Twins(tree, retell.faster(tree, c), lambda a, b: apart(a, b, growing(c), clock=lambda t: t / c))


def in_units(random: Random, tree: Tree, _: Study) -> Twins:
    of = (random.choice((1.0, 2.2, 1e3)), random.choice((1.0, 39.37, 1e3)), random.choice((1.0, 0.1)))
    twin = retell.in_units(tree, *of)
    change = measured_in(*of)
    return Twins(tree, twin, lambda a, b: apart(a, b, change, clock=lambda t: t * of[2], same_open=of[1] == 1.0))


def from_the_other_side(random: Random, tree: Tree, _: Study) -> Twins:
    twin, name = from_side(tree, random)
    blocks = ("couplings", "foundation.elements")
    paths = frozenset(f"{before}{block}.{name}" for before in ("", "impulses.0.") for block in blocks)
    return Twins(tree, twin, lambda a, b: apart(a, b, kept, skipped=paths))


def reordered(random: Random, tree: Tree, _: Study) -> Twins:
    return Twins(tree, retell.reordered(tree, random), lambda a, b: apart(a, b, kept))


def later(random: Random, tree: Tree, study: Study) -> Twins:
    found = study.results
    times = found.time
    if len(times) < 3 or found.accuracy.get("horizon") is not None or found.status["code"] != "completed":
        raise NotTold("too short")
    turns = [np.abs(block["angle"]).max() for block in found.coordinates.values() if "angle" in block]
    if max(turns, default=0.0) > 3.0:
        raise NotTold("turns are counted")
    k = random.randrange(1, len(times) - 1)
    tree = {**tree, "analysis": {**tree["analysis"], "times": times.tolist()}}
    for key in ("duration", "samples"):
        tree["analysis"].pop(key, None)
    twin = retell.later(tree, float(times[k]), state_at(found.bodies, k))
    begin, skipped = float(times[k]), frozenset({"work"})
    return Twins(tree, twin, lambda a, b: apart(a, b, kept, skipped=skipped, clock=lambda t: t - begin))


def unreduced(_: Random, tree: Tree, __: Study) -> Twins:
    return Twins(tree, tree, lambda a, b: apart(a, b, kept), {"reduce": False})


def another_method(random: Random, tree: Tree, _: Study) -> Twins:
    if "analysis" not in tree or {"method", "step"} & set(tree["analysis"]):
        raise NotTold("a method of its own")
    options = {"method": random.choice(OTHER_METHODS)}
    return Twins(tree, tree, lambda a, b: apart(a, b, kept), options)


def otherwise_sampled(random: Random, tree: Tree, study: Study) -> Twins:
    times = study.results.time.tolist()
    if len(times) < 3 or (tree.get("analysis") or {}).get("until"):
        raise NotTold("one instant")
    kept_ones = [0.0, *(t for t in times[1:-1] if random.random() < 0.5), times[-1]]
    others = [random.uniform(0.0, times[-1]) for _ in range(random.choice((0, 3, 40)))]
    analysis = {key: value for key, value in tree["analysis"].items() if key not in ("duration", "samples")}
    twin = {**tree, "analysis": {**analysis, "times": sorted({*kept_ones, *others})}}
    return Twins(tree, twin, lambda a, b: apart(a, b, kept))


def within_extremes(random: Random, tree: Tree, study: Study) -> Twins:
    times = study.results.time
    if len(times) < 2 or (tree.get("analysis") or {}).get("until"):
        raise NotTold("one instant")
    analysis = {key: value for key, value in tree["analysis"].items() if key not in ("times", "samples")}
    dense = {**tree, "analysis": {**analysis, "duration": float(times[-1]), "samples": 401}}
    return Twins(tree, dense, lambda a, b: beyond_peaks(a, b, random))


def in_halves(random: Random, tree: Tree, _: Study) -> Twins:
    twin, halved = retell.in_halves(tree, random), frozenset({"momentum", "moment_of_momentum"})
    return Twins(tree, twin, lambda a, b: apart(a, b, kept, more=True, same_open=False, skipped=halved))


def from_the_other_end(random: Random, tree: Tree, _: Study) -> Twins:
    twin, name = retell.from_the_other_end(tree, random)
    return Twins(tree, twin, lambda a, b: apart(a, b, kept, skipped=frozenset({name})))


LAWS: dict[str, Callable[[Random, Tree, Study], Twins]] = {
    "turned": turned, "faster": faster, "reordered": reordered, "later": later, "unreduced": unreduced,
    "another method": another_method, "otherwise sampled": otherwise_sampled, "in halves": in_halves,
    "from the other end": from_the_other_end, "in units": in_units, "from the other side": from_the_other_side,
    "within extremes": within_extremes,
}  # fmt: skip
