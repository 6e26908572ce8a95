"""What is open and what is certain at special poses, and sums of it, against dense equations of each instant.

    python -m tests.honesty.special_poses --cases 400 [--seed FIRST]

prints what is told otherwise than by the null space of the instant's own equations.
"""

from __future__ import annotations

from collections import Counter
from typing import Any

import numpy as np

from heuncli.base.errors import HeunError
from tests.oracle.read import model, state_at
from tests.oracle.rows import gaps
from tests.oracle.solve import solve
from tests.shared import checks
from tests.shared.hunts import asked_of
from tests.shared.scenes import moving, near, study, terms_at
from tests.shared.special_poses import TIMES, special
from tests.shared.trees import Case, force_of, weighed

CLOSED = 1e-8  # m: a loop farther open is no machine to be compared
REFUSED = ("singular-pose", "closure-lost", "no-length", "nearly-singular")  # poses that it says it cannot pass


def solved_case(scene: dict[str, Any], twin: dict[str, Any]) -> Case:
    """The run, and the dense equations of each instant in its states; twin: the same scene in space."""
    run = study(moving(scene, TIMES, 1e-11), time_limit=20)
    plain = weighed(twin)
    read = model(plain)
    states = [state_at(run.results.bodies, k) for k in range(len(TIMES))]
    oracle = [solve(read, state, t, about=np.zeros(3)) for state, t in zip(states, TIMES, strict=True)]
    points = [reaction.point for one in oracle for reaction in one.reactions.values()]
    length = max(1.0, *(float(np.linalg.norm(p)) for p in points))
    return Case(dict(scene), plain, read, run, states, oracle, [force_of(read, o) for o in oracle], length)


def same_in_the_plane(case: Case) -> None:
    """What lies in the plane of a scene told there: verdicts and values."""
    for name, block in case.found.joints.items():
        for k, (oracle, force) in enumerate(zip(case.oracle, case.force, strict=True)):
            reaction, moment = oracle.reactions[name], force * case.length
            parts = [("force", 0, 0, force), ("force", 1, 1, force), ("moment", 2, 5, moment)]
            for part, i, place, size in parts:
                unique = bool(reaction.unique[place])
                assert bool(np.isfinite(block[part][k][i])) == unique, f"{name}.{part}.{'xyz'[i]} at instant {k}"
                if unique:
                    near(block[part][k][i], getattr(reaction, part)[i], size)
            if "drive" in block:
                assert bool(np.isfinite(block["drive"][k])) == bool(reaction.unique[6]), f"{name}.drive at {k}"
                if reaction.unique[6]:
                    near(block["drive"][k], reaction.drive, moment)


def sums_are_certain(case: Case) -> None:
    """Every listed sum is of what is open, has its value, and is free of every self-stress at every instant."""
    blocks = case.found.joints.items()
    is_open = {f"joints.{name}.{part}" for name, block in blocks for part in block["open"] if "." in part}
    for one in case.found.certain_sums:
        assert set(one["terms"]) <= is_open
        for k, (oracle, force) in enumerate(zip(case.oracle, case.force, strict=True)):
            terms = terms_at(one["terms"], k)
            value, certain = oracle.sum(terms)
            assert certain, (k, terms)
            near(one["value"][k], value, force * case.length * sum(abs(x) for x in terms.values()))


def sums_are_all(case: Case) -> None:
    """As many sums of forces, and of moments, are listed as are certain at usual instants."""
    blocks = case.found.joints.items()
    for part, first in (("force", 0), ("moment", 3)):
        places = [(n, "xyz".index(p[-1])) for n, block in blocks for p in block["open"] if p.startswith(f"{part}.")]
        listed = [s for s in case.found.certain_sums if all(f".{part}." in term for term in s["terms"])]
        ranks = [0]
        for oracle in case.oracle if places else ():
            shares = np.array([oracle.reactions[name].share[first + i] for name, i in places])
            largest = oracle.largest()
            unit = np.where(largest > 0.0, largest, 1.0) * (oracle.length if first else 1.0)
            ranks.append(int(np.linalg.matrix_rank(shares / unit, tol=1e-8)) if shares.size else 0)
        assert len(listed) == len(places) - max(ranks), (part, len(listed), len(places), ranks)


IN_SPACE = (checks.same_reactions, checks.same_parts, checks.same_accelerations, checks.same_foundation)


def judged(seed: int) -> str:
    """What comes of a scene: "same", or why it is not compared. Raises AssertionError where it is otherwise."""
    _, scene, twin = special(seed)
    try:
        case = solved_case(scene, twin)
    except HeunError as error:
        code = error.problems[0].code
        assert code in REFUSED, str(error)
        return f"refused: {code}"
    if case.found.accuracy.get("unknown"):
        return "withheld"  # what rounding reaches beside a singular pose is told as not known
    apart = [gaps(case.read, state, t).values() for state, t in zip(case.states, TIMES, strict=True)]
    if max(float(np.abs(gap).max(initial=0.0)) for one in apart for gap in one) > CLOSED:
        return "not closed"
    for check in (same_in_the_plane,) if "space" in scene else IN_SPACE:
        check(case)
    sums_are_certain(case)
    sums_are_all(case)
    return "same" if case.found.model["redundant"] else "same, nothing open"


def main() -> None:
    asked = asked_of("tests.honesty.special_poses", __doc__)
    found: Counter[str] = Counter()
    for seed in range(asked.seed, asked.seed + asked.cases):
        try:
            what = judged(seed)
        except AssertionError as error:
            what = "otherwise"
            print(seed, special(seed)[0], str(error)[:400])
        found[what] += 1
    print(dict(found))


if __name__ == "__main__":
    main()
