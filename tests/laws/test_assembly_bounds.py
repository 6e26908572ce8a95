"""Loops that provably cannot close are refused early, with the very words of a search that tries everything."""

from __future__ import annotations

from collections.abc import Callable
from contextlib import suppress
from typing import Any

import numpy as np
import pytest

from heuncli.base.errors import SolveError
from heuncli.base.records import replace
from heuncli.multibody.assembly.assemble import assemble
from heuncli.multibody.assembly.conditions import joint_conditions, mean_arm
from heuncli.multibody.assembly.fit import IslandFit
from heuncli.multibody.assembly.islands import AssemblyIsland
from heuncli.multibody.assembly.poses import PoseAssembly
from heuncli.multibody.mechanism.model import Mechanism
from tests.shared.bits import bits
from tests.shared.drafted_loops import four_bar, random_loop, slider_crank

POINTS = ("ball", "pin", "universal", "rod")


def stretch(s: Mechanism, seed: int) -> Mechanism:
    """Move one joint's point on a body so far out that most loops cannot close any more."""
    rng = np.random.default_rng(seed)
    k = int(rng.integers(len(s.joints)))
    joints = list(s.joints)
    joints[k] = replace(joints[k], p=joints[k].p * 10.0 ** rng.uniform(0.0, 1.5))
    return replace(s, joints=tuple(joints))


def draft(seed: int) -> Mechanism:
    """A loop of random lengths: a four-bar or engine, driven or not; or a random one, stretched."""
    rng = np.random.default_rng(seed)
    angle = {"angle": float(rng.uniform(-3.0, 3.0))} if rng.random() < 0.5 else {}
    kind = seed % 4
    if kind == 0:
        return four_bar(*rng.uniform(0.1, 4.0, size=4).tolist(), **angle)
    if kind == 1:
        s = slider_crank(**angle)
        joints = list(s.joints)
        joints[1] = replace(joints[1], p=np.array([float(rng.uniform(0.1, 1.0)), 0.0, float(rng.choice([0.0, 0.4]))]))
        return replace(s, joints=tuple(joints))
    return stretch(random_loop(seed, 0.1, POINTS) if kind == 2 else random_loop(seed, 0.1, count=3), seed)


def told(s: Mechanism) -> Any:
    """All bits of the start, or the problems why there is none."""
    try:
        return [*bits(assemble(s))]
    except SolveError as error:
        return error.problems


@pytest.mark.heavy
@pytest.mark.parametrize("seed", range(24))
@pytest.mark.third
def test_a_proof_changes_no_word_and_no_bit(seed: int, monkeypatch: pytest.MonkeyPatch) -> None:
    s = draft(seed)
    found = told(s)
    monkeypatch.setattr(IslandFit, "bound_gap", lambda fit: 0.0)
    assert found == told(s)


@pytest.mark.parametrize("seed", range(40))
def test_no_pose_is_below_the_bound(seed: int) -> None:
    found: list[tuple[float, float]] = []

    def look(fit: IslandFit) -> None:
        bound = fit.bound_gap()
        fit.close(1e-10)
        found.append((bound, fit.gap(fit.rows())))

    watch(draft(seed), look)
    assert found
    assert all(0.0 <= bound <= gap for bound, gap in found)


@pytest.mark.parametrize(
    ("lengths", "lack"), [((1.0, 1.0, 1.0, 5.0), 2.0), ((1.0, 7.0, 2.0, 3.0), 1.0), ((1.0, 3.0, 2.5, 3.5), 0.0)]
)
def test_a_four_bar_lacks_what_its_longest_side_is_too_long(lengths: tuple[float, ...], lack: float) -> None:
    s = four_bar(*lengths)
    found: list[float] = []
    watch(s, lambda fit: found.append(fit.bound_gap()))
    assert found[0] == pytest.approx(lack / mean_arm(s), abs=1e-12)
    assert found[0] <= lack / mean_arm(s)


def watch(s: Mechanism, look: Callable[[IslandFit], None]) -> None:
    """Look at each island of an assembly where it would be fitted, in place of that."""
    assembly = PoseAssembly(s, joint_conditions(s, 0.0), mean_arm(s))

    def fit(island: AssemblyIsland, afresh: bool) -> None:
        look(IslandFit(assembly.poses, island, assembly.conditions, assembly.tree.depth, assembly.size, False))

    assembly._fit = fit  # type: ignore[method-assign]
    with suppress(SolveError):
        assembly.fit()
