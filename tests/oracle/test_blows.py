"""Blows against the independent solution on absolute coordinates: jumps, impulses, what is open, to 1e-9 of the scale.

Random trees and closed chains, struck at the start or while they move, by several impulses at once.
"""

from __future__ import annotations

from functools import cache

import numpy as np
import pytest

from tests.oracle.blows import with_blows, with_rate_jumps
from tests.oracle.impulses import energy_jump, struck, struck_section, work_of_blow
from tests.oracle.read import start_state, state_at
from tests.oracle.totals import kinetic_energy, mass_effect
from tests.shared import checks
from tests.shared.doubles import redundant_scene
from tests.shared.loops import DRIVEN, loop_scene
from tests.shared.scenes import near, solved, terms_at
from tests.shared.struck_runs import Blown, blown
from tests.shared.trees import ABOUT, cut_through, tree_scene

pytestmark = pytest.mark.heavy  # families at random: with the compiled kernel, which has the same bits

FOUNDATION = {"foundation": {"about": ABOUT.tolist()}}
AT_ONCE = {"analysis": {"type": "impulse"}}
INSTANTS = (0.1, 0.2)
SCENES = {
    **{f"tree {s}": (tree_scene, s, {}) for s in range(20)},
    **{f"thin rods {s}": (tree_scene, s, {"masses": "thin", "kinds": ("ball",)}) for s in range(0, 8, 2)},
    **{f"loop {s}": (loop_scene, s, {}) for s in [*range(24), *DRIVEN[:10]]},
    **{f"redundant {s}": (lambda seed: (redundant_scene(seed)[1], None), s, {}) for s in range(2000, 2012)},
}
MOVING = [n for n in SCENES if n.split()[1] in ("1", "4", "7", "9", "1003", "1004")]


@cache
def case(name: str) -> Blown:
    """Struck where it stands, with the rates it has."""
    make, seed, more = SCENES[name]
    scene = with_blows(make(seed, **more)[0], seed, couples="thin" not in name, thin="thin" in name)
    return blown({**scene, **FOUNDATION, **AT_ONCE})


@cache
def moving_case(name: str) -> Blown:
    """Struck twice while it moves; where it is driven the rates of the drives jump, too."""
    make, seed, more = SCENES[name]
    scene = make(seed, **more)[0]
    for k, t in enumerate(INSTANTS):
        scene = with_blows(scene, 100 * k + seed, t, count=2)
    times = [0.0, *INSTANTS, 0.3]
    return blown({**scene, **FOUNDATION, "analysis": {"times": times, "tolerance": 1e-12}})


CASES = [*((case, n) for n in SCENES), *((moving_case, n) for n in MOVING)]
NAMED = pytest.mark.parametrize(("make", "name"), CASES, ids=[f"{m.__name__} {n}" for m, n in CASES])


@NAMED
@pytest.mark.third
def test_jumps_and_impulses(make: type, name: str) -> None:
    """Verdicts, certain numbers, parts, supports, elements and totals."""
    c = make(name)
    assert c.study.results.status["code"] == "completed"
    assert c.times == ([0.0] if make is case else list(INSTANTS))
    assert all(o.residual < 1e-9 and o.unbalanced < 1e-9 for o in c.oracle)
    checks.same_accelerations(c)
    checks.same_reactions(c)
    checks.same_parts(c)
    checks.same_foundation(c)
    checks.free_directions_carry_nothing(c)


@NAMED
@pytest.mark.third
def test_energy(make: type, name: str) -> None:
    """Of the blow: ½ H·(V⁺ + V⁻), the drives' part included."""
    c = make(name)
    for b, state, o, t in zip(c.study.results.impulses, c.states, c.oracle, c.times, strict=True):
        at_first = kinetic_energy(c.plain, state)
        jump = energy_jump(c.plain, state, o)
        size = max(1.0, at_first, at_first + jump)
        near(b["energy_before"], at_first, size)
        near(b["energy_after"], at_first + jump, size)
        near(b["energy_jump"], jump, size)
        near(b["energy_jump"], work_of_blow(c.plain, state, o, t), size, 1e-8)


@NAMED
@pytest.mark.third
def test_mass_effects(make: type, name: str) -> None:
    """Jumps of Σ m ẋ and of both parts of the moment of momentum."""
    c = make(name)
    found = c.found.foundation["mass_effect"]
    for k, o in enumerate(c.oracle):
        still = {n: s._replace(angular_velocity=np.zeros(3)) for n, s in c.states[k].items()}
        wanted = mass_effect(c.plain, still, o, ABOUT)
        F = c.force[k]
        near(found["force"][k], wanted.force, F)
        near(found["moment_orbital"][k], wanted.moment_orbital, F * c.length)
        near(found["moment_spin"][k], wanted.moment_spin, F * c.length)


@NAMED
def test_certain_sums(make: type, name: str) -> None:
    """Every sum is certain by the oracle, with its value; and they are as many as for forces."""
    c = make(name)
    for k, (b, o) in enumerate(zip(c.study.results.impulses, c.oracle, strict=True)):
        is_open = {f"joints.{n}.{part}" for n, block in b["joints"].items() for part in block["open"]}
        sums = b.get("certain_sums", [])
        for s in sums:
            terms = {n: float(np.ravel(f)[0]) for n, f in s["terms"].items()}
            assert set(terms) <= is_open
            value, certain = o.sum(terms)
            assert certain, terms
            near(np.ravel(s["value"])[0], value, c.force[k] * c.length * sum(abs(x) for x in terms.values()))
        for part, first in (("force", 0), ("moment", 3)):
            names = sorted(n for n in is_open if f".{part}." in n)
            shares = [o.reactions[n.split(".")[1]].share[first + "xyz".index(n[-1])] for n in names]
            rank = np.linalg.matrix_rank(np.array(shares), tol=1e-8) if names else 0
            listed = [s for s in sums if all(f".{part}." in n for n in s["terms"])]
            assert len(listed) == len(names) - rank, (part, len(listed), len(names), rank)


@pytest.mark.parametrize("name", [n for n in SCENES if n.startswith(("tree", "loop"))][::2])
@pytest.mark.third
def test_the_state_before_a_blow_is_the_start(name: str) -> None:
    """The states that the jumps start from are those of the scene, not only what the results say of themselves."""
    c = case(name)
    for body, s in start_state(c.plain).items():
        near(c.states[0][body].velocity, s.velocity, 10.0, 1e-10)
        near(c.states[0][body].angular_velocity, s.angular_velocity, 10.0, 1e-10)


# ---- sections
SAWN = [("tree", s) for s in range(2, 20, 3)] + [("loop", s) for s in (2, 3, 6, 7, 10, 11, 14, 15, 18, 19)]


@cache
def sawn(kind: str, seed: int) -> Blown:
    """A cut, and the same turned round, through every body."""
    scene = {"tree": tree_scene, "loop": loop_scene}[kind](seed, masses="shapes")[0]
    scene = with_blows(scene, seed, couples=False)
    rng = np.random.default_rng(seed)
    cuts = {}
    for name, body in scene["bodies"].items():
        through = cut_through(body, rng)
        assert through is not None
        cuts[f"one_{name}"] = {"body": name, **through}
        cuts[f"two_{name}"] = {"body": name, **through, "normal": [-x for x in through["normal"]]}
    return blown({**scene, "sections": cuts, **FOUNDATION, **AT_ONCE})


@pytest.mark.parametrize(("kind", "seed"), SAWN)
@pytest.mark.third
def test_a_cut_carries_what_its_weld_would(kind: str, seed: int) -> None:
    """The impulse of the piece on the remainder: the body sawn and welded; open where its weld is; both sides."""
    c = sawn(kind, seed)
    F, M = c.force[0], c.force[0] * c.length
    for name, told in c.scene["sections"].items():
        if name.startswith("two"):
            continue
        found, back = c.found.sections[name], c.found.sections["two" + name[3:]]
        weld = struck_section(c.scene, c.states[0], 0.0, told["body"], told["at"], told["normal"])
        sure = weld.unique
        near(found["point"][0], weld.point, c.length)
        assert (~np.isnan(found["force"][0])).tolist() == sure[:3].tolist()
        assert (~np.isnan(found["moment"][0])).tolist() == sure[3:].tolist()
        near(np.where(sure[:3], found["force"][0], 0), np.where(sure[:3], weld.force, 0), F)
        near(np.where(sure[3:], found["moment"][0], 0), np.where(sure[3:], weld.moment, 0), M)
        near(np.where(sure[:3], back["force"][0], 0), np.where(sure[:3], -weld.force, 0), F)
        near(np.where(sure[3:], back["moment"][0], 0), np.where(sure[3:], -weld.moment, 0), M)
        n = weld.normal
        first = c.states[0][told["body"]].rotation @ np.array(told["first_axis"])
        e1 = first - (first @ n) * n
        e1 = e1 / np.linalg.norm(e1)
        axes = {"N": n, "Q1": e1, "Q2": np.cross(n, e1), "T": n, "M1": e1, "M2": np.cross(n, e1)}
        for part, axis in axes.items():
            v, size = (weld.force, F) if part[0] in "NQ" else (weld.moment, M)
            if sure.all():
                near(found[part][0], v @ axis, size)


# ---- drives whose rates jump
@pytest.mark.parametrize("name", [f"tree {s}" for s in (0, 5, 6, 7, 11)] + [f"loop {s}" for s in range(1000, 1010)])
@pytest.mark.third
def test_rates_of_drives_jump(name: str) -> None:
    """In the middle of a motion; where the loops do not let all drives jump so, the scene is passed over."""
    make, seed, more = SCENES[name]
    scene = make(seed, **{"drives": 1, **more})[0]
    if not scene.get("drives"):
        pytest.skip("nothing in it can be driven")
    at = 0.15
    scene = with_rate_jumps(scene, seed, at)
    smooth = solved({**make(seed, **{"drives": 1, **more})[0], "analysis": {"times": [0.0, at], "tolerance": 1e-12}})
    before = state_at(smooth.bodies, 1)
    if struck(scene, before, at).residual > 1e-9:
        pytest.skip("the loops do not let the drives jump so")
    c = blown({**scene, **FOUNDATION, "analysis": {"times": [0.0, at, 0.3], "tolerance": 1e-12}})
    assert c.times == [at]
    assert set(c.study.results.impulses[0]["names"]) == set(scene["drives"])
    for body, s in before.items():
        near(c.states[0][body].velocity, s.velocity, 10.0)
        near(c.states[0][body].angular_velocity, s.angular_velocity, 10.0)
    checks.same_accelerations(c)
    checks.same_reactions(c)
    checks.same_foundation(c)


def test_sums_that_turn_are_told_at_the_instant() -> None:
    """Factors are numbers at a blow, which is one instant."""
    for name in (n for n in SCENES if n.startswith("redundant")):
        for block in case(name).study.results.impulses:
            for s in block.get("certain_sums", []):
                assert all(np.size(f) == 1 for f in s["terms"].values()), terms_at(s["terms"], 0)
