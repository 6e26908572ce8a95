"""Rest poses of random scenes told otherwise: pose, verdicts, warnings and loads are the same.

    python -m tests.honesty.rest_told_again --kind stops --cases 3000 [--seed FIRST] [--save FOLDER]

prints what is not, and how differences are spread over the errors that both tellings state.
"""

from __future__ import annotations

import re
import sys
import time
from collections import Counter
from collections.abc import Iterator
from typing import Any, NamedTuple

import numpy as np

from heuncli.base.errors import SolveError
from heuncli.study.queries.study import Study
from tests.honesty.rest_poses import doubtful, flown, spread
from tests.oracle.values import to_yaml
from tests.oracle.weld import SAW as SAWN
from tests.shared.hunts import asked_of
from tests.shared.rest_scenes import KINDS, drawn
from tests.shared.rest_told_again import TELLINGS, resting, section_of_the_weld
from tests.shared.rest_trees import Equations
from tests.shared.said_again import ROUNDING, Difference, Retold, differences, error_of
from tests.shared.scenes import study

FACTOR = 2.0  # of what is stated: an estimate, no bound
APART = 1e-5  # of the size: farther apart are two poses
PRINTED = 1e-3  # of a number in a sentence, which has four digits
LEAST = re.compile(r"smallest eigenvalue stiffness/inertia (\S+) 1/s²")
GROWS = re.compile(r"departs as exp\((\S+) t\)")
SWINGS = re.compile(r"oscillation (\S+) Hz")
RATES = {
    "velocity",
    "acceleration",
    "center_velocity",
    "center_acceleration",
    "angular_velocity",
    "angular_acceleration",
    "rate",
    "speed",
    "momentum",
    "moment_of_momentum",
}  # fmt: skip  (what is left of them is the search's affair)
NUMBERS = ((LEAST, -2), (GROWS, -1), (SWINGS, -1))  # with their powers of time


class Finding(NamedTuple):
    """what: "same", or what is not; ratio: the largest difference over what is stated."""

    what: str
    ratio: float
    more: str


def verdicts(run: Study) -> list[str]:
    """What a rest pose is, in the first words of what is told of it."""
    told = (sentence.partition(":")[0].partition(" except")[0] for sentence in run.results.model["rest"])
    return [words for words in told if not words.startswith("at rest in")]


def near_a_ridge(run: Study) -> bool:
    """Whether a warning names another pose."""
    return any("ridge" in warning for warning in run.results.warnings)


def numbers(run: Study) -> Iterator[tuple[str, float, int]]:
    """The numbers in the sentences, with their powers of time."""
    told = " ".join(run.results.model["rest"])
    for pattern, power in NUMBERS:
        if found := pattern.search(told):
            yield pattern.pattern[:15], float(found[1].rstrip(";,")), power


def answer(tree: Any) -> Study | str:
    """A scene solved, or why not."""
    try:
        return study(to_yaml(tree), time_limit=60)
    except SolveError as error:
        return error.problems[0].code


def agree(first: Study, second: Study, told: Retold) -> Finding:
    """Two rest poses of one scene."""
    all_off = [d for d in differences(first, second, told) if d.path.rpartition(".")[2] not in RATES]
    if SAWN in second.results.joints:
        all_off += welded(first, second, told)
    apart = max((d.off for d in all_off if d.path.endswith(".position")), default=0.0) / second.magnitudes.size
    stated = max(first.results.accuracy["estimate"]["motion"], second.results.accuracy["estimate"]["motion"])
    worst = max(all_off, key=lambda d: d.ratio)
    if apart > max(APART, 4.0 * stated):
        warned = near_a_ridge(first) or near_a_ridge(second)
        return Finding("told of another pose" if warned else "another pose", apart, str(worst))
    if verdicts(first) != verdicts(second):
        return Finding("another verdict", worst.ratio, f"{first.results.model['rest']} {second.results.model['rest']}")
    if near_a_ridge(first) != near_a_ridge(second):
        return Finding("another warning", worst.ratio, f"{first.results.warnings} {second.results.warnings}")
    for (word, a, power), (_, b, _) in zip(numbers(first), numbers(second), strict=True):
        if not abs(a * told.time**power - b) <= PRINTED * abs(b):
            return Finding("another number", worst.ratio, f"{word} {a * told.time**power} {b}")
    return Finding("same" if worst.ratio <= FACTOR else "farther than stated", worst.ratio, str(worst))


def welded(first: Study, second: Study, told: Retold) -> Iterator[Difference]:
    """A section's load against the reaction of the weld that stands for it."""
    name = section_of_the_weld(told)
    cut, weld = first.results.sections[name], second.results.joints[SAWN]
    for part, unit in (("force", "N"), ("moment", "N·m")):
        paths = (first, ("sections", name, part)), (second, ("joints", SAWN, part))
        stated = sum(error_of(run, path, unit) for run, path in paths)
        rounding = ROUNDING * max(run.magnitudes.by_unit[unit] for run in (first, second))
        off = float(np.abs(np.asarray(cut[part]) - np.asarray(weld[part])).max())
        yield Difference(f"sections.{name}.{part}", off, stated, rounding)


def judged(kind: str, seed: int, way: str) -> tuple[Finding, Retold]:
    """A scene and its telling."""
    tree = resting(kind, seed)
    first = answer(tree)
    if isinstance(first, str) and way == "sawn":
        way = "renamed"  # there is no pose to saw at
    told = TELLINGS[way](tree, np.random.default_rng([seed, 5]), first)  # type: ignore[arg-type]
    second = answer(told.tree)
    if isinstance(first, str) or isinstance(second, str):
        return Finding("refused" if second == first else "refused once", 0.0, f"{first} {second}"), told
    return agree(first, second, told), told


RIGHT = ("same", "refused", "told of another pose")


def triaged(found: Finding, kind: str, seed: int) -> Finding:
    """What is not the same near a ridge is said to be near it by an independent flow."""
    if found.what in RIGHT:
        return found
    scene = drawn(kind, seed)
    rest = flown(scene)
    if isinstance(rest, str):
        return found._replace(more=f"no rest: {rest}; {found.more}")
    if doubtful(Equations(scene.tree), rest):
        return found._replace(what=f"{found.what}, near a ridge")
    return found


def main() -> int:
    """Run the cases; 1 if one is wrong."""
    asked = asked_of("tests.honesty.rest_told_again", __doc__, [*KINDS])
    counts: Counter[str] = Counter()
    ratios: list[float] = []
    begun = time.perf_counter()
    for seed in range(asked.seed, asked.seed + asked.cases):
        way = list(TELLINGS)[seed % len(TELLINGS)]
        found, told = judged(asked.kind, seed, way)
        found = triaged(found, asked.kind, seed)
        counts[found.what] += 1
        if found.what in ("same", "farther than stated"):
            ratios.append(found.ratio)
        if found.what not in RIGHT:
            print(f"{asked.kind} {seed} {way}: {found.what} {found.ratio:.3g}: {found.more}", flush=True)
            if asked.save is not None:
                asked.save.mkdir(parents=True, exist_ok=True)
                for part, tree in (("a", resting(asked.kind, seed)), ("b", told.tree)):
                    (asked.save / f"{asked.kind}_{seed}_{part}.yaml").write_text(to_yaml(tree), encoding="utf-8")
    print(f"{asked.kind}: {asked.cases} scenes from {asked.seed}: {dict(counts)}, {time.perf_counter() - begun:.0f} s")
    print(f"difference over stated error: {spread(ratios)}")
    return int(any(what not in RIGHT for what in counts))


if __name__ == "__main__":
    sys.exit(main())
