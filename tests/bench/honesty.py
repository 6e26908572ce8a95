"""Honesty, printed: true error over estimate, by kind, over random scenes. `python -m tests.bench honesty`.

A scene is run as its seed asks, and judged by two finer runs of it: one at the least tolerance, and one told in turned
axes at another tolerance, so that its steps and its rounding are others. Where these two do not agree ten times better
than the estimate, the truth is not known well enough: that kind of that scene is not judged, and counted.
"""

from __future__ import annotations

import math
import time
from collections import Counter
from collections.abc import Iterator, Mapping
from multiprocessing import Pool
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from heuncli.base import tolerances
from heuncli.base.errors import HeunError
from heuncli.results.results import Results
from heuncli.study.queries.study import Study
from tests.oracle.scenes import ALL_KINDS, random_scene
from tests.oracle.tellings import with_cuts
from tests.oracle.transforms import turned
from tests.oracle.turns import about, random_rotation
from tests.oracle.values import to_yaml
from tests.shared.scenes import study
from tests.shared.trees import cut_through

Array = NDArray[np.float64]
Scene = dict[str, Any]

KINDS = ("motion", "reactions", "drives", "foundation", "sections", "energy")
PLACES = ("asked", "other")
KNOWN = 0.1  # of the estimate: how well the truth must be known to judge by it
TRUTH, SECOND = tolerances.LEAST_TOLERANCE, 4.0 * tolerances.LEAST_TOLERANCE  # tolerances of the two finer runs
BETWEEN = 100  # instants looked at that nobody asked for: what is stated holds for all of the run
NONE = -1.0  # in place of a ratio, where a scene has nothing of a kind
TIME_LIMIT = 20.0  # s, of one run
QUANTILES = (0.05, 0.25, 0.5, 0.75, 0.95, 0.99, 1.0)


class Judged(NamedTuple):
    """A scene's ratios by (kind, where); nan: the truth is not known, NONE: no such kind. said: why it was not run."""

    seed: int
    ratios: Mapping[tuple[str, str], float]
    said: str = ""


# ---- scenes
class Told(NamedTuple):
    """A scene told twice: the second time with all vectors turned by Q."""

    scene: Scene
    other: Scene
    Q: Array


def told(seed: int) -> Told:
    """A random scene with what it asks for: trees, loops, in the plane; drives, springs, sections, several periods."""
    rng = np.random.default_rng([7, seed])
    made = planar(rng) if seed % 4 == 3 else spatial(rng, seed)
    duration = float(10.0 ** rng.uniform(-0.5, 0.8))
    analysis = {
        "duration": duration,
        "samples": int(rng.integers(2, 31)),
        "tolerance": float(10.0 ** rng.uniform(-11, -6)),
    }
    return Told({**made.scene, "analysis": analysis}, {**made.other, "analysis": analysis}, made.Q)


def spatial(rng: np.random.Generator, seed: int) -> Told:
    """A tree, or closed chains, of any joints; a cut through every body in half of them."""
    loops = (0, 1, 0, 0, 2, 0, 1, 0, 3)[seed % 9]
    drives = (0, 0, 1, 0, 2)[seed % 5]
    scene, _ = random_scene(
        rng, int(rng.integers(1 + (loops > 0), 6)), loops=loops, drives=drives, roots=0.2, free=0.05 * (loops == 0),
        kinds=("ball", "pin") if rng.random() < 0.3 else ALL_KINDS,
        masses="shapes" if rng.random() < 0.6 else "given", in_time=bool(rng.random() < 0.5),
        loads=("force", "couple", "spring", "torque", "damper") if rng.random() < 0.7 else (),
    )  # fmt: skip
    cuts = {f"cut_{name}": cut_through(body, rng) for name, body in scene["bodies"].items()}
    cuts = {name: {"body": name[4:], **cut} for name, cut in cuts.items() if cut is not None}
    if cuts and rng.random() < 0.7:
        scene["sections"] = cuts
    Q = random_rotation(rng)
    return Told(scene, with_cuts(scene, turned(scene, Q), lambda _, v, place: Q @ v), Q)


def planar(rng: np.random.Generator) -> Told:
    """A chain of bars in the plane, hanging free, or closed by a pin or a rod; driven or with a spring."""
    seed = int(rng.integers(2**31))
    angle = float(rng.uniform(1, 5))
    turn = about(np.array([0.0, 0.0, 1.0]), angle)
    return Told(bars(np.random.default_rng(seed), np.eye(3)), bars(np.random.default_rng(seed), turn), turn)


def bars(rng: np.random.Generator, Q: Array) -> Scene:
    """The chain with all that is drawn turned by Q."""

    def drawn(x: float, y: float) -> list[float]:
        return [float(c) for c in Q @ np.array([x, y, 0.0])]

    n, closed = int(rng.integers(1, 5)), rng.choice(["free", "pin", "rod"])
    closed = "free" if n < 3 and closed == "pin" else closed
    at, places = np.zeros(2), [np.zeros(2)]
    for _ in range(n):
        step = float(rng.uniform(0.3, 1.2)) * np.array([math.cos(a := float(rng.uniform(-2, 2))), math.sin(a)])
        at = at + step
        places.append(at)
    ground = {"O": drawn(0, 0), "S": drawn(*rng.uniform(-2, 2, 2)), "E": drawn(*places[-1])}
    ground["R"] = drawn(*(places[-1] + rng.uniform(0.5, 1.5, 2)))
    bodies, joints, sections = {}, {}, {}
    for k in range(n):
        a, b = drawn(*places[k]), drawn(*places[k + 1])
        shape = {"type": "rod", "from": a, "to": b, "mass": float(rng.uniform(0.3, 3))}
        bodies[f"b{k}"] = {"shapes": [shape], "points": {"a": a, "b": b}}
        joints[f"j{k}"] = {"type": "pin", "from": f"b{k - 1}.b" if k else "ground.O", "to": f"b{k}.a"}
        sections[f"s{k}"] = {"body": f"b{k}", "from": "a", "to": "b", "count": 3}
    if closed == "pin":
        joints["close"] = {"type": "pin", "from": "ground.E", "to": f"b{n - 1}.b"}
    elif closed == "rod":
        joints["close"] = {"type": "rod", "from": "ground.R", "to": f"b{n - 1}.b"}
    g = rng.standard_normal(2) * 5
    scene: Scene = {"title": "bars", "space": "planar", "gravity": drawn(*g), "ground": {"points": ground},
                    "bodies": bodies, "joints": joints, "sections": sections}  # fmt: skip
    if rng.random() < 0.3:
        rate = float(rng.uniform(0.5, 4))
        scene["drives"] = {"motor": {"joint": "j0", "angle": Text(f"{rate!r}*t + 0.3*sin({2 * rate!r}*t)")}}
        if closed != "free" and n < 3:
            del scene["drives"]  # nothing would be left to move
        elif closed == "pin":
            scene["drives"]["motor"]["angle"] = Text(f"0.2*sin({rate!r}*t)")
    held = closed == "rod" and n == 1
    if "drives" not in scene and rng.random() < 0.7 and not held:
        bodies["b0"]["angular_velocity"] = [0.0, 0.0, float(rng.uniform(-4, 4))]
    if rng.random() < 0.5:
        stiffness, length = float(10.0 ** rng.uniform(0, 2.5)), float(rng.uniform(0.2, 1.5))
        spring = {"type": "spring", "from": "ground.S", "to": f"b{n - 1}.b", "stiffness": stiffness, "length": length}
        scene["forces"] = {"spring": {**spring, "damping": float(rng.uniform(0, 0.5))}}
    if rng.random() < 0.3:
        push = [Text(f"{c!r}*sin(3*t)") if c else 0.0 for c in drawn(2.0, -1.0)]
        scene.setdefault("forces", {})["push"] = {"type": "force", "on": "b0.b", "vector": push}
    return scene


class Text(NamedTuple):
    """An expression of a spec."""

    source: str

    def __call__(self, t: float) -> float:
        raise NotImplementedError


# ---- judging
def judged(seed: int) -> Judged:
    """The ratios of one scene."""
    scenes = told(seed)
    try:
        run = study(scenes.scene, time_limit=TIME_LIMIT)
        others = between(run, seed)
        fine = study(scenes.scene, tolerance=TRUTH, time_limit=3 * TIME_LIMIT)
        second = study(scenes.other, tolerance=SECOND, time_limit=3 * TIME_LIMIT)
        if not len(run.results.time) == len(fine.results.time) == len(second.results.time):
            return Judged(seed, {}, "stopped early")
        ratios = {}
        for where, shown in (("asked", [run, fine, second]), ("other", [run, fine, second])):
            answers = [one.results if where == "asked" else one.resample(others) for one in shown]
            for kind in KINDS:
                ratios[kind, where] = ratio(kind, run, answers, scenes.Q)
    except HeunError as error:
        return Judged(seed, {}, error.problems[0].code)
    return Judged(seed, ratios)


def between(run: Study, seed: int) -> Array:
    """Instants within the run that nobody asked for, one close to its end."""
    end = float(run.results.time[-1])
    return np.sort(np.random.default_rng([8, seed]).uniform(0.0, 1.0, BETWEEN)) * end


def ratio(kind: str, run: Study, answers: list[Results], Q: Array) -> float:
    """True error over estimate of one kind; nan where the truth is not known well enough."""
    estimate: float = run.results.accuracy["estimate"].get(kind, math.nan)  # type: ignore[assignment]
    size = run.setup.scene.layout.size
    own, true, other = (list(parts(kind, answer, size)) for answer in answers)
    before = earlier(run, answers[0])
    worst = doubt = largest = 0.0
    for (a, _), (b, _), (c, turns) in zip(own, true, other, strict=True):
        c = c @ Q if turns else c
        worst = max(worst, apart(a[before], b[before]))
        doubt = max(doubt, apart(c[before], b[before]))
        largest = max(largest, apart(b[before], np.zeros_like(b[before])))
    for b, _ in parts(kind, run.results, size):
        largest = max(largest, apart(b, np.zeros_like(b)))
    if kind == "motion":
        largest = size
    if largest == 0.0 or not own:
        return NONE
    if estimate == 0.0:  # nothing is told to err
        return NONE if worst <= tolerances.WRITTEN * largest else math.inf
    return worst / largest / estimate if doubt <= KNOWN * estimate * largest else math.nan


def earlier(run: Study, shown: Results) -> NDArray[np.bool_]:
    """The instants before the horizon."""
    horizon = run.results.accuracy["horizon"]
    return np.ones(len(shown.time), dtype=bool) if horizon is None else np.asarray(shown.time < horizon)


def apart(a: Array, b: Array) -> float:
    """Largest distance of numbers or vectors; what is open counts as nought."""
    d = np.nan_to_num(a - b)
    d = d if d.ndim == 1 else np.sqrt(np.sum(d * d, axis=-1))
    return float(np.abs(d).max(initial=0.0))


def parts(kind: str, shown: Results, size: float) -> Iterator[tuple[Array, bool]]:
    """What is told of a kind, moments over the size; and whether it turns with the world."""
    if kind == "motion":
        for block in shown.bodies.values():
            yield block["center"], True
            yield block["position"], True
        for block in shown.points.values():
            yield block["position"], True
    elif kind == "energy":
        for name in ("kinetic", "potential", "work"):
            yield shown.energy[name], False
    elif kind == "drives":
        for name, block in shown.joints.items():
            if "drive" in block:
                yield block["drive"] / (size if "angle" in shown.coordinates.get(name, {}) else 1.0), False
    else:
        blocks: Mapping[str, Any] = {"f": shown.foundation} if kind == "foundation" else getattr(shown, NAMED[kind])
        for block in blocks.values():
            yield block["force"], True
            yield block["moment"] / size, True


NAMED = {"reactions": "joints", "sections": "sections"}


# ---- printing
def honesty(scenes: int, seed: int, jobs: int, keep: Path | None = None) -> None:
    """Judge that many scenes from a seed on, and print."""
    begun = time.perf_counter()
    with Pool(jobs) as pool:
        found = list(pool.imap(judged, range(seed, seed + scenes), chunksize=4))
    print(f"true error / estimate over {scenes} random scenes from seed {seed} ({time.perf_counter() - begun:.0f} s)")
    for line in table(found):
        print(line)
    for line in worst_scenes(found, keep):
        print(line)


def table(found: list[Judged]) -> Iterator[str]:
    """Quantiles a kind and place; how many could not be judged."""
    heads = "".join(f"{'max' if q == 1 else f'{100 * q:.0f} %':>9s}" for q in QUANTILES)
    yield f"{'kind':10s} {'instants':8s} {'judged':>6s} {'not':>5s}{heads}"
    for kind in KINDS:
        for where in PLACES:
            all_of = np.array([one.ratios[kind, where] for one in found if one.ratios])
            all_of = all_of[all_of != NONE]
            known = all_of[~np.isnan(all_of)]
            shown = "".join(f"{x:9.2g}" for x in np.quantile(known, QUANTILES, method="nearest")) if len(known) else ""
            yield f"{kind:10s} {where:8s} {len(known):6d} {len(all_of) - len(known):5d}{shown}"
    refused = Counter(one.said for one in found if one.said)
    yield f"not run: {', '.join(f'{n} {code}' for code, n in refused.most_common()) or 'none'}"


def worst_scenes(found: list[Judged], keep: Path | None) -> Iterator[str]:
    """The scenes above 1, the worst first, and whether their text was kept."""
    over = [(x, one.seed, *where) for one in found for where, x in one.ratios.items() if x > 1.0]
    judged_at_all = sum(x >= 0.0 for one in found for x in one.ratios.values())
    yield f"above 1: {len(over)} of {judged_at_all}, in {len({o[1] for o in over})} scenes"
    for x, seed, kind, where in sorted(over, reverse=True)[:40]:
        yield f"  seed {seed}: {kind}, {where} instants: {x:.3g}"
        if keep is not None:
            keep.mkdir(parents=True, exist_ok=True)
            (keep / f"honesty_{seed}.yaml").write_text(to_yaml(told(seed).scene), encoding="utf-8")
