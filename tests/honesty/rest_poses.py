"""Rest poses of random scenes against the damped motion from their start (tests/shared/damped_flow.py).

    python -m tests.honesty.rest_poses --kind plane --cases 3000 [--seed FIRST] [--save FOLDER]

prints what is not as said, and how the true error of poses is spread over the one that is stated.
"""

from __future__ import annotations

import sys
import time
from collections import Counter
from pathlib import Path
from typing import NamedTuple

import numpy as np

from heuncli.base.errors import HeunError
from tests.oracle.values import to_yaml
from tests.shared.damped_flow import RTOL, NoRest, Rest, rest_of
from tests.shared.hunts import asked_of
from tests.shared.rest_ridges import beside_a_ridge
from tests.shared.rest_scenes import KINDS, Scene, drawn
from tests.shared.rest_trees import Equations, Vector
from tests.shared.scenes import study

SAME = 1e-5  # of the size: farther apart are two poses
FACTOR = 2.0  # of what is stated: an estimate, no bound
ROUNDING = 1e-15  # of the size, beside it
FLOWN = 1e-8  # of the size: how well the flow's end is known along what is indifferent
HARDLY = 1e-9  # of the largest push, or m: a contact that bears so little may as well be open
ASIDE = 1e-7  # rad or m: a start as far off that comes to rest elsewhere is one near a ridge
WRONG = (
    "another pose",
    "rests where nothing does",
    "told stable",
    "told unstable",
    "understated",
    "indifferent",
    "refused",
    "failed",
)


RIDGES = "ridges"  # a kind beside those of the scenes: starts near where two ways part


class Verdict(NamedTuple):
    """what: "same", "said" or one of WRONG; ratio: true over stated error of the same pose; off: the error, of size."""

    what: str
    ratio: float
    more: str
    off: float = 0.0


class Told(NamedTuple):
    """Points of the bodies (p, 3), stated error and size, warnings and sentences."""

    points: Vector
    stated: float
    size: float
    warnings: list[str]
    rest: list[str]


def told(scene: Scene) -> Told:
    """What heun finds. Raises HeunError."""
    run = study(to_yaml(scene.spec), time_limit=60)
    found, places = run.results, []
    for body in scene.tree.bodies:
        one = found.bodies[body.name]
        for p in (np.zeros(3), *body.points.values()):
            places.append(scene.R.T @ (one["position"][0] + one["rotation"][0] @ p))
    stated = found.accuracy["estimate"]["motion"]
    return Told(np.array(places), stated, run.setup.scene.layout.size, list(found.warnings), list(found.model["rest"]))


def flown(scene: Scene, rtol: float = RTOL) -> Rest | str:
    """Where its flow comes to rest, or why nowhere."""
    try:
        return rest_of(Equations(scene.tree), None, rtol)
    except NoRest as error:
        return str(error)


def judged(scene: Scene, rest: Rest | str) -> Verdict:
    """A scene as heun tells it, by where its flow comes to rest."""
    eq = Equations(scene.tree)
    try:
        found: Told | str = told(scene)
    except HeunError as error:
        found = str(error)
    except Exception as error:  # whatever else comes is a finding, too
        return Verdict("failed", 0.0, repr(error)[:200])
    if isinstance(rest, str):
        return without(scene, rest, found)
    if isinstance(found, str):
        return by_refusal(eq, rest, found)
    return compared(eq, rest, found)


def without(scene: Scene, rest: str, found: Told | str) -> Verdict:
    """Where the flow comes to no rest."""
    if isinstance(found, str):
        return Verdict("said", 0.0, f"no rest: {rest}; {found.splitlines()[0]}")
    return Verdict("rests where nothing does", 0.0, f"{rest}; told {found.rest}")


def by_refusal(eq: Equations, rest: Rest, found: str) -> Verdict:
    """Where heun refuses what the flow brings to rest."""
    if doubtful(eq, rest):
        return Verdict("said", 0.0, f"near a ridge, {found}")
    return Verdict("refused", 0.0, f"{found}; ridge {rest.ridge:.1e}, {rest.steps} steps")


def compared(eq: Equations, rest: Rest, found: Told) -> Verdict:
    """Two poses."""
    off = float(np.abs(found.points - rest.points).max()) / found.size
    worst = f"off {off:.3g}, stated {found.stated:.3g}, ridge {rest.ridge:.1e}, indifferent {rest.indifferent}"
    loose = rest.indifferent > 0 or rest.margin < HARDLY
    ratio = max(off - FLOWN * loose, 0.0) / (found.stated + ROUNDING)
    if ratio > FACTOR:
        if rest.indifferent:
            return Verdict("indifferent", ratio, f"{worst}; {found.rest}", off)
        if off <= SAME:
            return Verdict("understated", ratio, worst)
        if any("damped motion" in warning for warning in found.warnings):
            return Verdict("said", 0.0, f"{worst}; {found.warnings}")
        if doubtful(eq, rest):
            return Verdict("said", 0.0, f"near a ridge: {worst}; {found.warnings}")
        return Verdict("another pose", ratio, f"{worst}; {found.warnings}")
    says = any("unstable" in sentence for sentence in [*found.warnings, *found.rest])
    if says != rest.unstable:
        return Verdict("told unstable" if says else "told stable", ratio, f"{worst}; {rest.eigenvalues}; {found.rest}")
    return Verdict("same", ratio, worst)


def doubtful(eq: Equations, rest: Rest) -> bool:
    """Whether starts beside come to rest elsewhere."""
    for k in range(2 * eq.f):
        by = np.zeros(eq.f)
        by[k // 2] = ASIDE * (-1) ** k
        try:
            other = rest_of(eq, eq.moved(eq.y0, by))
        except NoRest:
            return True
        if np.abs(other.points - rest.points).max() > 1e4 * ASIDE:
            return True
    return False


# ---- many of them --------------------------------------------------------------------------------------------------
EDGES = (0.0, 1e-3, 1e-2, 0.1, 0.25, 0.5, 1.0, 2.0, np.inf)


def spread(ratios: list[float]) -> str:
    """How many ratios lie between the edges."""
    counts, _ = np.histogram(ratios, bins=EDGES)
    return ", ".join(f"< {b:g}: {n}" for b, n in zip(EDGES[1:], counts.tolist(), strict=True))


def save(folder: Path, scene: Scene, verdict: Verdict) -> None:
    """The scene as a file, what is wrong with it in its first line."""
    folder.mkdir(parents=True, exist_ok=True)
    head = f"# {verdict.what}: {' '.join(verdict.more.split())}; {scene.kind} {scene.seed}\n"
    name = f"{scene.kind}_{scene.seed}_{verdict.what.replace(' ', '_')}.yaml"
    (folder / name).write_text(head + to_yaml(scene.spec), encoding="utf-8")


def main() -> int:
    """Run the cases; 1 if one is wrong."""
    asked = asked_of("tests.honesty.rest_poses", __doc__, [*KINDS, RIDGES])
    counts: Counter[str] = Counter()
    ratios: list[float] = []
    begun = time.perf_counter()
    for seed in range(asked.seed, asked.seed + asked.cases):
        scene = beside_a_ridge(seed, rest_of)[0] if asked.kind == RIDGES else drawn(asked.kind, seed)
        verdict = judged(scene, flown(scene))
        counts[verdict.what] += 1
        if verdict.what in WRONG or verdict.what == "said":
            print(f"{asked.kind} {seed} {verdict.what} {verdict.ratio:.3g}: {verdict.more}", flush=True)
        else:
            ratios.append(verdict.ratio)
        if asked.save is not None and verdict.what in WRONG:
            save(asked.save, scene, verdict)
    print(f"{asked.kind}: {asked.cases} scenes from {asked.seed}: {dict(counts)}, {time.perf_counter() - begun:.0f} s")
    print(f"true over stated error: {spread(ratios)}")
    return int(any(counts[what] for what in WRONG))


if __name__ == "__main__":
    sys.exit(main())
