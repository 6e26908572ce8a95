"""Assembly is nearest: from a drawing a little off, never more than twice as far as to a known pose that closes."""

from __future__ import annotations

import numpy as np
import pytest

from heuncli.assembly.assemble import assemble
from heuncli.mechanism.model import Assembly
from heuncli.records import replace
from tests.shared.drafts import body, joint, largest_gap, scene
from tests.shared.misdrawn import MODES, drawn, known

CHUNK = 25


@pytest.mark.parametrize("first", range(0, 500, CHUNK))
def test_five_hundred_loops_close_near_their_drawing(first: int) -> None:
    """Off by up to 3 %, in every way of drawing by turns; the closed pose is known by construction."""
    for seed in range(first, first + CHUNK):
        d = drawn(known(seed), 0.03, MODES[seed % 5 % len(MODES)])
        rest = np.zeros((len(d.x), 3))
        assert largest_gap(d.scene, Assembly(d.x_known, d.R_known, rest, rest, (), 0.0)) < 1e-12
        a = assemble(d.scene)
        assert largest_gap(d.scene, a) < 1e-12
        way, known_way = d.ways(a.position, a.rotation), d.ways(d.x_known, d.R_known)
        assert np.linalg.norm(way) <= 1.3 * np.linalg.norm(known_way), seed  # the nearest may be left by a fifth
        assert way.max() <= 2.0 * known_way.max(), seed


@pytest.mark.parametrize("seed", range(0, 80, 3))
def test_how_a_body_is_drawn_does_not_matter(seed: int) -> None:
    """Near poses, bodies drawn in world coordinates, both mixed: one start, one end."""
    ends = []
    for mode in MODES:
        d = drawn(known(seed), 0.03, mode)
        a = assemble(d.scene)
        c = np.array([b.center for b in d.scene.bodies])
        ends.append(np.hstack([a.position + np.einsum("nij,nj->ni", a.rotation, c), d.ways(a.position, a.rotation)]))
    assert np.array(ends) == pytest.approx(np.broadcast_to(ends[0], (len(MODES), *ends[0].shape)), abs=1e-6)


@pytest.mark.parametrize("seed", range(1, 40, 3))
def test_a_small_loop_in_a_large_scene_is_fitted_as_it_is_alone(seed: int) -> None:
    """A thousandth of its size, beside a boom of a hundred metres that it has nothing to do with."""
    d = drawn(known(seed), 0.03, "world")
    s, small = d.scene, 1e-3
    boom = scene(
        [body("boom", center=(50, 0, 0), mass=1e3)],
        [joint("foot", "ball", "ground", (0, 0, 9), "boom", (0, 0, 0))],
    )
    bodies = [replace(b, center=small * b.center) for b in s.bodies]
    joints = [replace(j, p=small * j.p, q=small * j.q, length=j.length and small * j.length) for j in s.joints]
    joints.append(replace(boom.joints[0], b=len(bodies)))
    a, b = assemble(s), assemble(replace(s, bodies=(*bodies, *boom.bodies), joints=tuple(joints)))
    ways = d.ways(a.position, a.rotation), d.ways(b.position[:-1] / small, b.rotation[:-1])
    assert ways[1] == pytest.approx(ways[0], abs=3e-4)
