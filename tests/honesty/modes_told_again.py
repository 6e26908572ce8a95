"""Small oscillations of random scenes told otherwise: as many of each kind, at the same frequencies and growths.

    python -m tests.honesty.modes_told_again --kind friction --cases 3000 [--seed FIRST] [--save FOLDER]

prints what is not, and how differences are spread over the errors that both tellings state.
"""

from __future__ import annotations

import sys
import time
from collections import Counter
from collections.abc import Iterator
from functools import cache
from typing import Any, NamedTuple

import numpy as np

from heuncli.analyses.modes.study import compute_spec_modes
from heuncli.base.errors import SolveError
from heuncli.motion.linearisation.oscillations import Mode, SceneModes
from heuncli.scene.file_format.load import load
from tests.honesty.indifferent import PARTS, Bench
from tests.honesty.rest_poses import spread
from tests.oracle.values import to_yaml
from tests.shared.hunts import asked_of
from tests.shared.rest_scenes import KINDS, drawn
from tests.shared.rest_told_again import TELLINGS
from tests.shared.said_again import Retold

FACTOR = 2.0  # of what is stated: an estimate, no bound
ROUNDING = 64.0 * float(np.finfo(float).eps)  # of the fastest, beside it
WAYS = [way for way in TELLINGS if way != "sawn"]  # of two parts welded there is one
INDIFFERENT = "indifferent"  # a kind beside those of rest: parts of which it is known what holds them


class Finding(NamedTuple):
    """what: "same", or what is not; ratio: the largest difference over what is stated."""

    what: str
    ratio: float
    more: str


def scene(kind: str, seed: int) -> dict[str, Any]:
    """A scene at rest, loads and closures of a kind."""
    if kind != INDIFFERENT:
        return drawn(kind, seed).spec
    bench = Bench(seed, space=bool(seed % 2))
    for k in range(int(bench.rng.integers(2, 4))):
        PARTS[int(bench.rng.integers(len(PARTS)))](bench, np.array([4.0 * k, 0.0, 0.0]))
    return {key: value for key, value in bench.scene().items() if key != "heun"}


def answer(tree: Any) -> SceneModes | str:
    """The modes of a scene, or why there are none."""
    try:
        return compute_spec_modes(load("scene.yaml", to_yaml(tree)))
    except SolveError as error:
        return error.problems[0].code
    except np.linalg.LinAlgError as error:
        return f"failed: {error}"


@cache
def first_answer(kind: str, seed: int) -> SceneModes | str:
    """The modes of a scene as it is drawn, found once for all that it is compared with."""
    return answer(scene(kind, seed))


def by_kind(found: SceneModes) -> dict[str, list[Mode]]:
    """The modes of each kind, by their eigenvalues."""
    kinds: dict[str, list[Mode]] = {}
    for mode in sorted(found.modes, key=lambda m: (m.eigenvalue.imag, m.eigenvalue.real)):
        kinds.setdefault(mode.kind, []).append(mode)
    return kinds


def ratios(first: SceneModes, second: SceneModes, told: Retold) -> Iterator[tuple[float, str]]:
    """Of each mode how far the two are apart over what is stated, and what they are."""
    rate = 1.0 / told.time
    one, other = by_kind(first), by_kind(second)
    fastest = max((abs(mode.eigenvalue) for mode in second.modes), default=0.0)
    for kind, members in one.items():
        for a, b in zip(members, other[kind], strict=True):
            stated = a.error * rate + b.error + ROUNDING * fastest
            off = abs(a.eigenvalue * rate - b.eigenvalue)
            if kind == "free":
                off = 0.0
            yield off / stated if off else 0.0, f"{kind} {a.eigenvalue * rate} {b.eigenvalue} stated {stated:.3g}"


def agree(first: SceneModes | str, second: SceneModes | str, told: Retold) -> Finding:
    """The modes of one scene told twice."""
    if isinstance(first, str) or isinstance(second, str):
        both = [x if isinstance(x, str) else "found" for x in (first, second)]
        failed = any(x.startswith("failed") for x in both)
        return Finding("failed" if failed else "refused" if first == second else "refused once", 0.0, str(both))
    counts = [{kind: len(members) for kind, members in by_kind(found).items()} for found in (first, second)]
    if counts[0] != counts[1]:
        return Finding("other kinds", 0.0, f"{counts} {[(m.kind, m.eigenvalue, m.error) for m in first.modes]}")
    worst, more = max(ratios(first, second, told), default=(0.0, ""))
    return Finding("same" if worst <= FACTOR else "farther than stated", worst, more)


def judged(kind: str, seed: int, way: str) -> tuple[Finding, Any, Retold]:
    """A scene and its telling."""
    tree = scene(kind, seed)
    told = TELLINGS[way](tree, np.random.default_rng([seed, 6]), None)  # type: ignore[arg-type]
    return agree(first_answer(kind, seed), answer(told.tree), told), tree, told


RIGHT = ("same", "refused")


def main() -> int:
    """Run the cases; 1 if one is wrong."""
    asked = asked_of("tests.honesty.modes_told_again", __doc__, [*KINDS, INDIFFERENT])
    counts: Counter[str] = Counter()
    all_ratios: list[float] = []
    begun = time.perf_counter()
    for seed in range(asked.seed, asked.seed + asked.cases):
        way = WAYS[seed % len(WAYS)]
        found, tree, told = judged(asked.kind, seed, way)
        counts[found.what] += 1
        if found.what in ("same", "farther than stated"):
            all_ratios.append(found.ratio)
        if found.what not in RIGHT:
            print(f"{asked.kind} {seed} {way}: {found.what} {found.ratio:.3g}: {found.more}", flush=True)
            if asked.save is not None:
                asked.save.mkdir(parents=True, exist_ok=True)
                for part, each in (("a", tree), ("b", told.tree)):
                    (asked.save / f"{asked.kind}_{seed}_{part}.yaml").write_text(to_yaml(each), encoding="utf-8")
    print(f"{asked.kind}: {asked.cases} scenes from {asked.seed}: {dict(counts)}, {time.perf_counter() - begun:.0f} s")
    print(f"difference over stated error: {spread(all_ratios)}")
    return int(any(what not in RIGHT for what in counts))


if __name__ == "__main__":
    sys.exit(main())
