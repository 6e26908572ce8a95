"""Random machines with axes reversed and ends exchanged: the physics is the same.

    python -m tests.honesty.reversed_told_again --kind spatial --cases 1000 [--seed FIRST] [--save FOLDER]

prints what is not the same, and how differences are spread over the errors that both tellings state.
"""

from __future__ import annotations

import sys
import time
from collections import Counter
from collections.abc import Callable, Iterator
from typing import Any

import numpy as np

from heuncli.base.errors import HeunError
from heuncli.results.path_words import TREE
from heuncli.results.results import Array
from heuncli.results.results_schema import REPORTS, SPACE, Quantity
from heuncli.study.queries.study import Study
from tests.faults.sources import parsed
from tests.honesty.rest_poses import spread
from tests.oracle.values import to_yaml
from tests.shared import coupled_in_a_plane, planar_scenes, retell
from tests.shared.coupled_scenes import coupled_scene
from tests.shared.hunts import asked_of
from tests.shared.reversed_joints import Reversal, reversed_scene
from tests.shared.said_again import ROUNDING, RUNS, STRUCK, Difference, Retold, error_of, leaves, turns
from tests.shared.scenes import study
from tests.shared.stopped_trees import stopped_tree
from tests.shared.trees import weighed

Tree = dict[str, Any]
TIMES, TOLERANCE = [0.0, 0.04, 0.1], 1e-10
FACTOR = 2.0  # of what is stated: an estimate, no bound
RIGHT = ("same", "refused", "lost")
OF_COORDINATES = frozenset({"value", "rate", "angle", "drive"})  # of a joint or a load in one
ALONG_AXES = frozenset({"axial", "torque"})
ACROSS_AXES = frozenset({"axial", "radial", "tilting"})  # of a joint with two axes: of the other one
TWO_AXES = frozenset({"universal", "cv"})
WANDERS = frozenset({"slide", "cylinder"})  # loads stand at the `to` point, on one side of a cut or on the other
OTHER_END = {"tension": "last_tension", "last_tension": "tension"}  # of a rope that is listed from there
PLACES = frozenset({"point", "tilting"})  # of the `to` point, which is another one


def spatial(seed: int) -> Tree:
    """Machine elements on carriers that move anyhow."""
    return moved(coupled_scene(seed))


def flat(seed: int) -> Tree:
    """Machine elements that move in a plane which lies anywhere, and is found."""
    return moved(coupled_in_a_plane.coupled_flat(seed))


def declared(seed: int) -> Tree:
    """The same in the world's xy plane, which is declared."""
    return moved(coupled_in_a_plane.coupled_flat(seed, how="declared"))


def planar(seed: int) -> Tree:
    """Trees and loops in a plane that is declared, with drives, stops, ropes and loads in joints."""
    return {key: value for key, value in parsed(planar_scenes.flat_scene(seed)).items() if key != "heun"}


def stopped(seed: int) -> Tree:
    """Trees in space between stops, on ropes that catch."""
    return moved(weighed(stopped_tree(seed)))


KINDS: dict[str, Callable[[int], Tree]] = {
    "spatial": spatial, "flat": flat, "declared": declared, "planar": planar, "stopped": stopped,
}  # fmt: skip


def moved(scene: Any) -> Tree:
    """A scene as a tree of text and numbers, in a short motion."""
    tree = parsed(to_yaml({**scene, "analysis": {"times": TIMES, "tolerance": TOLERANCE}}))
    return {key: value for key, value in tree.items() if value and key != "heun"}


def answer(tree: Any, reduce: bool) -> Study | str:
    """A scene solved, or why not."""
    try:
        return study(to_yaml(tree), requested_reports=frozenset(REPORTS), reduce=reduce)
    except HeunError as error:
        return error.problems[0].code


def differences(first: Study, second: Study, told: Reversal) -> Iterator[Difference]:
    """All that two runs tell, and their blows."""
    same = Retold(told.tree)
    pairs = [(first.results, second.results, (*RUNS, "couplings"), TREE)]
    for one, other in zip(first.results.impulses, second.results.impulses, strict=True):
        rows: Any = TREE["impulses"]
        pairs.append((one, other, (*STRUCK, "couplings"), rows["NUMBER"]))
        yield Difference("impulses.time", abs(one["time"] - other["time"]), 1e-9, 1e-12)
    for one, other, blocks, rows in pairs:
        of = dict.get if isinstance(one, dict) else getattr
        joints = of(one, "joints"), of(other, "joints")
        for block in blocks:
            a, b = of(one, block), of(other, block)
            for path, row, x, y in leaves((block,), rows.get(block), a, b, same):
                for each in compared(first, second, told, path, row, (x, y), (a, b), joints):
                    if isinstance(one, dict) and path[-1] == "point":  # it moves on until a later blow
                        way = abs(one["time"] - other["time"]) * first.magnitudes.by_unit["m/s"]
                        each = each._replace(stated=each.stated + way)
                    yield each


def compared(
    first: Study,
    second: Study,
    told: Reversal,
    path: tuple[str, ...],
    row: Quantity,
    pair: tuple[Any, Any],
    blocks: Any,
    joints: tuple[Any, Any],
) -> Iterator[Difference]:
    """A number of the first run as the second has to tell it."""
    word, unit = ".".join(path), row.select_unit(turns(first, path))
    joint = joint_of(first, path)
    if path[-1] in PLACES and (path[0] == "couplings" or {"supports", "elements", *told.exchanged_ends} & set(path)):
        return
    if path[0] == "sections" and any(told.tree["joints"][name]["type"] in WANDERS for name in told.exchanged_ends):
        return
    if path[-1] in ACROSS_AXES and joint in told.exchanged_ends and told.tree["joints"][joint]["type"] in TWO_AXES:
        return
    if pair[1] is None:
        yield Difference(f"{word} is missing", np.inf, 0.0, 0.0)
        return
    wanted, found = (np.asarray(x, dtype=float) for x in pair)
    if joint in told.exchanged_ends and path[0] == "joints" and path[-1] in ("force", "moment", "point"):
        wanted = from_the_other_end(path, blocks)
    elif path[-1] == "moment" and (path[0] == "foundation" or "on" in path):
        wanted = about_the_other_point(path, blocks, joints)
    elif path[0] == "couplings" and row.shape[-1:] != (SPACE,):
        other = OTHER_END.get(path[-1]) if path[1] in told.exchanged else None
        if path[1] in told.exchanged and told.tree["couplings"][path[1]]["type"] == "differential":
            return  # which is told times each factor, and all of them times another number
        wanted = np_block(blocks[0], path[:-1]).get(other, wanted) if other is not None else wanted
        wanted, found = np.abs(wanted), np.abs(found)
    elif path[-1] in ALONG_AXES and path[0] == "joints":
        wanted = told.axes[path[1]] * wanted
    elif joint is not None and (path[0] in ("coordinates", "stops") or path[-1] in OF_COORDINATES):
        wanted = told.sign(joint) * wanted
    if path[-1] == "moment" and row.shape[-1:] == (SPACE,) and told.tree.get("space") == "planar":
        wanted = wanted * [0.0, 0.0, 1.0]  # what is across the plane is not told
    off = float(np.nanmax(np.abs(wanted - found), initial=0.0))
    stated = error_of(first, path, unit) + error_of(second, path, unit)
    if path[-1] == "moment":  # moved on from another point
        stated += 3.0 * (error_of(first, (*path[:-1], "force"), "N") * first.magnitudes.size)
    yield Difference(word, off, stated, ROUNDING * max(s.magnitudes.by_unit.get(unit, 0.0) for s in (first, second)))


def joint_of(run: Study, path: tuple[str, ...]) -> str | None:
    """The joint that a number is about."""
    name = path[1]
    if path[0] in ("coordinates", "joints"):
        return name
    for block in (run.spec.forces, run.spec.stops, run.spec.latches):
        if name in block and path[0] in ("forces", "stops"):
            own = getattr(block[name], "joint", None)
            stop = getattr(block[name], "stop", None)
            return joint_of(run, ("stops", stop)) if own is None and stop else own
    return None


def from_the_other_end(path: tuple[str, ...], blocks: Any) -> Array:
    """What a joint's other end tells: about its point, and turned round."""
    one, other = (np_block(block, path[:-1]) for block in blocks)
    if path[-1] == "point":
        return np.asarray(other["point"])
    if path[-1] == "force":
        return -np.asarray(one["force"])
    return -(one["moment"] - np.cross(np.subtract(other["point"], one["point"]), one["force"]))


def about_the_other_point(path: tuple[str, ...], blocks: Any, joints: tuple[Any, Any]) -> Array:
    """A moment about the point of the second telling: of a support that of its joint."""
    one, other = (np_block(block, path[:-1]) for block in blocks)
    points = [block.get("point") for block in (one, other)]
    if path[1:2] == ("supports",):
        points = [block[path[2]]["point"] for block in joints]
    if points[0] is None or points[1] is None or np.shape(points[0]) != np.shape(one["force"]):
        return np.asarray(one["moment"], dtype=float)
    return np.asarray(one["moment"] - np.cross(np.subtract(points[1], points[0]), one["force"]))


def np_block(block: Any, path: tuple[str, ...]) -> Any:
    """What stands in a block under a path, which begins with the block's own name."""
    for word in path[1:]:
        block = block[word]
    return block


def judged(kind: str, seed: int) -> tuple[str, float, str, Any, Any]:
    """What a telling is ("same", or what is not), the largest difference over what is stated, and both scenes."""
    tree = retell.plain(KINDS[kind](seed))
    reduce = seed % 3 != 2
    first = answer(tree, reduce)
    if isinstance(first, str):
        return "refused", 0.0, first, tree, tree
    attitudes = {name: np.asarray(body["rotation"][0]) for name, body in first.results.bodies.items()}
    told = reversed_scene(tree, np.random.default_rng([seed, 13]), attitudes)
    second = answer(told.tree, reduce)
    if isinstance(second, str):
        return "refused once", 0.0, second, tree, told.tree
    if any(run.results.accuracy.get("horizon") is not None for run in (first, second)):
        return "lost", 0.0, "", tree, told.tree
    blows = [len(run.results.impulses) for run in (first, second)]
    if blows[0] != blows[1]:
        return "other blows", 0.0, str(blows), tree, told.tree
    worst = max(differences(first, second, told), key=lambda d: d.ratio)
    what = "same" if worst.ratio <= FACTOR else "farther than stated"
    return what, worst.ratio, str(worst), tree, told.tree


def main() -> int:
    """Run the cases; 1 if one is wrong."""
    asked = asked_of("tests.honesty.reversed_told_again", __doc__, tuple(KINDS))
    counts: Counter[str] = Counter()
    ratios: list[float] = []
    begun = time.perf_counter()
    for seed in range(asked.seed, asked.seed + asked.cases):
        what, ratio, more, tree, other = judged(asked.kind, seed)
        counts[what] += 1
        if what in ("same", "farther than stated"):
            ratios.append(ratio)
        if what not in RIGHT:
            print(f"{seed}: {what} {ratio:.3g}: {more}", flush=True)
            if asked.save is not None:
                asked.save.mkdir(parents=True, exist_ok=True)
                for part, each in (("a", tree), ("b", other)):
                    (asked.save / f"{asked.kind}_{seed}_{part}.yaml").write_text(to_yaml(each), encoding="utf-8")
    print(f"{asked.cases} {asked.kind} scenes from {asked.seed}: {dict(counts)}, {time.perf_counter() - begun:.0f} s")
    print(f"difference over stated error: {spread(ratios)}")
    return int(any(what not in RIGHT for what in counts))


if __name__ == "__main__":
    sys.exit(main())
