"""What is called open, against brute force: the null space of the whole Jacobian at every instant of random motions."""

from __future__ import annotations

from collections import Counter

import numpy as np
import pytest

from tests.oracle.rows import assemble
from tests.oracle.solve import OPEN, RANK, scene_length
from tests.shared import checks
from tests.shared.doubles import QUICK, SEEDS, redundant, redundant_scene
from tests.shared.scenes import moving, near, solved, terms_at
from tests.shared.seeds import list_daily_seeds, spared
from tests.shared.trees import TIMES

SPARED = spared(SEEDS, QUICK)
KEYS = ("center", "rotation", "center_velocity", "angular_velocity", "center_acceleration", "angular_acceleration")


@pytest.mark.parametrize("seed", SPARED)
@pytest.mark.third
def test_verdicts(seed: int) -> None:
    """Open exactly where the oracle says, certain numbers equal to its, in joints, supports, parts and totals."""
    c = redundant(seed)
    assert checks.same_reactions(c) > 0
    checks.same_parts(c)
    checks.same_foundation(c)
    checks.same_accelerations(c)
    checks.free_directions_carry_nothing(c)


@pytest.mark.long
def test_scenes_are_what_they_should_be() -> None:
    """Every kind is doubled and doubles; drives are in; one to many loads are held twice."""
    kinds: Counter[str] = Counter()
    daily = list_daily_seeds(SEEDS)
    for seed in daily:
        c = redundant(seed)
        kinds.update(j.kind + (" double" if "double" in j.name else "") for j in c.read.joints)
        kinds.update("driven" for j in c.read.joints if j.drive is not None)
        assert c.study.results.model["redundant"] == c.oracle[0].rows - c.oracle[0].rank
        assert c.study.results.model["freedoms"] == c.oracle[0].freedoms
        assert c.study.results.model["grubler"] == c.oracle[0].grubler
    for kind in ("ball", "pin", "slide", "cylinder", "universal", "weld", "line", "plane", "rod"):
        assert kinds[kind] >= 5, kind
    assert sum(kinds[k] for k in kinds if k.endswith("double")) >= 1.4 * len(daily)
    assert kinds["driven"] >= 0.4 * len(daily)


@pytest.mark.heavy
@pytest.mark.parametrize("seed", SEEDS)
@pytest.mark.third
def test_scenes_are_far_from_the_thresholds(seed: int) -> None:
    """Singular values and shares are rounding or plainly there, so that a verdict is no matter of a threshold."""
    c = redundant(seed)
    for o, state, t in zip(c.oracle, c.states, TIMES, strict=True):
        length = scene_length(c.read, state)
        J = assemble(c.read, state, t).J / np.tile([1.0, 1, 1, length, length, length], len(c.read.names))
        sigma = np.linalg.svd(J / np.linalg.norm(J, axis=1)[:, None], compute_uv=False)
        parts = [np.abs(r.weight[:, None] * r.share) / o.largest() for r in o.reactions.values()]
        largest = np.concatenate(parts).max(axis=1, initial=0.0)
        for values, limit in ((sigma / sigma[0], RANK), (largest, OPEN)):
            assert not np.any((values > 1e-4 * limit) & (values < 1e4 * limit))


@pytest.mark.heavy
@pytest.mark.parametrize("seed", SEEDS[::3])
@pytest.mark.third
def test_doubles_do_not_change_the_motion(seed: int) -> None:
    """To 1e-12: poses, rates and accelerations of the scene without what holds twice."""
    plain, doubled = redundant_scene(seed)
    times = (0.0, 0.1)
    first, second = (solved(moving(s, times, 1e-13)).bodies for s in (plain, doubled))
    for name, body in first.items():
        other = second[name]
        for key in KEYS:
            near(other[key], body[key], max(1.0, float(np.abs(body[key]).max())), 1e-12)


@pytest.mark.parametrize("seed", SPARED)
def test_certain_sums(seed: int) -> None:
    """Every listed sum is certain by the oracle, at every instant, with its value; of open components only.

    And there are as many as are independent, of forces and of moments: what is certain is all told.
    """
    c = redundant(seed)
    found = c.study.results
    is_open = {f"joints.{n}.{part}" for n, block in found.joints.items() for part in block["open"]}
    for s in found.certain_sums:
        assert set(s["terms"]) <= is_open
        assert len({n.split(".")[2] for n in s["terms"]}) == 1 or len(found.certain_sums) == 1
        for k, o in enumerate(c.oracle):
            terms = terms_at(s["terms"], k)
            value, certain = o.sum(terms)
            assert certain, terms
            near(s["value"][k], value, c.force[k] * c.length * sum(abs(x) for x in terms.values()))
    for part, first in (("force", 0), ("moment", 3)):
        names = sorted(n for n in is_open if f".{part}." in n)
        ranks = []
        for o in c.oracle:
            shares = [o.reactions[n.split(".")[1]].share[first + "xyz".index(n[-1])] for n in names]
            ranks.append(np.linalg.matrix_rank(np.array(shares), tol=1e-8) if names else 0)
        listed = [s["terms"] for s in found.certain_sums if all(f".{part}." in n for n in s["terms"])]
        assert len(listed) == len(names) - max(ranks)
        for k in range(len(TIMES)):
            rows = np.array([[terms_at(terms, k).get(n, 0.0) for n in names] for terms in listed])
            assert np.linalg.matrix_rank(rows, tol=1e-8) == len(listed) if listed else not rows.size
