"""Random machines that are struck told otherwise: motion, strikes, impulses, sections, extremes, events, shares.

    python -m tests.honesty.struck_told_again --cases 1000 [--seed FIRST] [--save FOLDER]

prints what is not the same, and how differences are spread over the errors that both tellings state.
"""

from __future__ import annotations

import sys
import time
from collections import Counter
from collections.abc import Iterator
from typing import Any

import numpy as np

from heuncli.base.errors import HeunError
from heuncli.results.results_schema import REPORTS, SHARES
from heuncli.study.queries.measure import find_peak
from heuncli.study.queries.study import Study
from tests.faults.sources import parsed
from tests.honesty.rest_poses import spread
from tests.oracle.blows import with_blows
from tests.oracle.read import model, start_state
from tests.oracle.rows import coordinates
from tests.oracle.values import to_yaml
from tests.oracle.weld import ON_THE_SPOT
from tests.oracle.weld import SAW as SAWN
from tests.shared.hunts import asked_of
from tests.shared.rest_told_again import TELLINGS, section_of_the_weld, with_cuts
from tests.shared.said_again import ROUNDING, Difference, Retold, differences, error_of, of_blows
from tests.shared.scenes import study
from tests.shared.stopped_trees import STOPPED, stopped_tree
from tests.shared.trees import weighed

FACTOR = 2.0  # of what is stated: an estimate, no bound
TIMES, TOLERANCE = [0.0, 0.1, 0.3], 1e-10
RIGHT = ("same", "refused", "lost")


def scene(seed: int) -> dict[str, Any]:
    """A machine between stops, with a cut through each body; it is struck at an instant and where a joint passes."""
    rng = np.random.default_rng([seed, 91])
    machine = weighed(stopped_tree(seed))
    struck = with_blows(machine, seed, time=float(rng.uniform(0.05, 0.15)), count=2, couples=False)
    tree = with_cuts(parsed(to_yaml({**struck, "analysis": {"times": TIMES, "tolerance": TOLERANCE}})), rng)
    if condition := passing(machine, seed):
        first = next(iter(tree["impulses"].values()))
        tree["impulses"]["passing"] = {**{k: v for k, v in first.items() if k != "time"}, "when": condition}
        tree["analysis"]["events"] = {"passed": condition}
    return {key: value for key, value in tree.items() if value and key != "heun"}


def passing(scene: dict[str, Any], seed: int) -> str:
    """A condition that a pin or slide meets once it has moved a little from its start, if there is one."""
    state = start_state(scene)
    joints = [joint for joint in model(scene).joints if joint.kind in STOPPED]
    if not joints:
        return ""
    joint = joints[seed % len(joints)]
    quantity = STOPPED[joint.kind]
    start = float(coordinates(joint, state)[quantity])
    far = 0.02 + 0.005 * (seed % 7)
    return f"({joint.name}.{quantity} - ({start!r}))**2 > {far**2!r}"


def answer(tree: Any) -> Study | str:
    """A scene solved, or why not."""
    try:
        return study(to_yaml(tree), requested_reports=frozenset({*REPORTS, SHARES}))
    except HeunError as error:
        return error.problems[0].code


def may_be_sawn(tree: dict[str, Any]) -> bool:
    """Whether all joints bear at points that their `from` bodies keep."""
    return all(joint["type"] in ON_THE_SPOT for joint in tree["joints"].values())


def welded(first: Study, second: Study, told: Retold) -> Iterator[Difference]:
    """A section's loads, and its impulses, against those of the weld that stands for it."""
    name = section_of_the_weld(told)
    pairs = [(first.results.sections, second.results.joints, {"force": "N", "moment": "N·m"})]
    blows = zip(first.results.impulses, second.results.impulses, strict=True)
    pairs += [(a["sections"], b["joints"], {"force": "N·s", "moment": "N·m·s"}) for a, b in blows]
    for cuts, joints, parts in pairs:
        for part, unit in parts.items():
            paths = (first, ("sections", name, part)), (second, ("joints", SAWN, part))
            stated = sum(error_of(run, path, unit) for run, path in paths)
            rounding = ROUNDING * max(run.magnitudes.by_unit[unit] for run in (first, second))
            off = float(np.abs(np.asarray(cuts[name][part]) - np.asarray(joints[SAWN][part])).max())
            yield Difference(f"sections.{name}.{part} [{unit}]", off, stated, rounding)


def of_events(first: Study, second: Study, told: Retold) -> Iterator[Difference]:
    """The instants of events, by the errors that both runs state of them.

    One that is told "only just", without an error, need not be in the other run; what is certain is there as well.
    """
    rounding = ROUNDING * float(second.results.time[-1])
    for name, one in first.results.events.items():
        other = second.results.events[told.name(name)]
        mine = list(zip(one["time"] * told.time, one["error"] * told.time, one["to"], strict=True))
        theirs = list(zip(other["time"], other["error"], other["to"], strict=True))
        for these, those in ((mine, theirs), (theirs, mine)):
            for t, error, to in these:
                if np.isfinite(error):
                    alike = [(abs(t - at), own) for at, own, becomes in those if becomes == to]
                    off, own = min(alike, default=(np.inf, 0.0))
                    stated = float(error + (own if np.isfinite(own) else 0.0))
                    yield Difference(f"events.{name} at {t:.9g}", float(off), stated, rounding)


def of_extremes(first: Study, second: Study, told: Retold) -> Iterator[Difference]:
    """The largest magnitudes between the samples, of each section's numbers that no mirror turns."""
    for name in first.results.sections if "sections" not in told.skipped else ():
        for number, unit in (("N", "N"), ("M2", "N·m")):
            path = ("sections", name, number)
            one, other = (find_peak(run, ".".join(p), "abs").value
                          for run, p in ((first, path), (second, ("sections", told.name(name), number))))  # fmt: skip
            stated = error_of(first, path, unit) * told.scale(unit) + error_of(second, path, unit)
            rounding = ROUNDING * second.magnitudes.by_unit[unit]
            yield Difference(f"max abs {'.'.join(path)}", abs(one * told.scale(unit) - other), stated, rounding)


def all_of(first: Study, second: Study, told: Retold) -> Iterator[Difference]:
    """All that two runs tell."""
    yield from differences(first, second, told)
    yield from of_blows(first, second, told)
    yield from of_events(first, second, told)
    yield from of_extremes(first, second, told)
    if SAWN in second.results.joints:
        yield from welded(first, second, told)


def judged(seed: int, way: str) -> tuple[str, float, str, Any, Any]:
    """What a telling is ("same", or what is not), the largest difference over what is stated, and both scenes."""
    tree = scene(seed)
    way = "turned" if way == "sawn" and not may_be_sawn(tree) else way
    first = answer(tree)
    if isinstance(first, str):
        return "refused", 0.0, first, tree, tree
    told = TELLINGS[way](tree, np.random.default_rng([seed, 7]), first)
    second = answer(told.tree)
    if isinstance(second, str):
        return "refused once", 0.0, second, tree, told.tree
    if any(run.results.accuracy.get("horizon") is not None for run in (first, second)):
        return "lost", 0.0, "", tree, told.tree
    blows = [len(run.results.impulses) for run in (first, second)]
    if blows[0] != blows[1]:
        return "other blows", 0.0, str(blows), tree, told.tree
    worst = max(all_of(first, second, told), key=lambda d: d.ratio)
    what = "same" if worst.ratio <= FACTOR else "farther than stated"
    return what, worst.ratio, f"{worst}; {blows[0]} blows", tree, told.tree


def main() -> int:
    """Run the cases; 1 if one is wrong."""
    asked = asked_of("tests.honesty.struck_told_again", __doc__)
    counts: Counter[str] = Counter()
    ratios: list[float] = []
    begun = time.perf_counter()
    for seed in range(asked.seed, asked.seed + asked.cases):
        way = list(TELLINGS)[seed % len(TELLINGS)]
        what, ratio, more, tree, other = judged(seed, way)
        counts[what] += 1
        if what in ("same", "farther than stated"):
            ratios.append(ratio)
        if what not in RIGHT:
            print(f"{seed} {way}: {what} {ratio:.3g}: {more}", flush=True)
            if asked.save is not None:
                asked.save.mkdir(parents=True, exist_ok=True)
                for part, each in (("a", tree), ("b", other)):
                    (asked.save / f"struck_{seed}_{part}.yaml").write_text(to_yaml(each), encoding="utf-8")
    print(f"{asked.cases} scenes from {asked.seed}: {dict(counts)}, {time.perf_counter() - begun:.0f} s")
    print(f"difference over stated error: {spread(ratios)}")
    return int(any(what not in RIGHT for what in counts))


if __name__ == "__main__":
    sys.exit(main())
