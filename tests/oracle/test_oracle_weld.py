"""The weld oracle against d'Alembert on the piece."""

from __future__ import annotations

import numpy as np
import pytest

from tests.oracle.checks import T, close, size_of, some_scene
from tests.oracle.masses import Plane, cut
from tests.oracle.read import GROUND, model
from tests.oracle.solve import solve
from tests.oracle.turns import cross, random_unit
from tests.oracle.weld import section


@pytest.mark.parametrize("seed", range(16))
@pytest.mark.third
def test_sawn_body(seed: int) -> None:
    """Against d'Alembert on the piece from the whole body's own accelerations; both sides add to nothing."""
    scene, state = some_scene(seed, masses="shapes")
    rng = np.random.default_rng(seed)
    read, found = model(scene), solve(scene, state)
    name = read.names[rng.integers(len(read.names))]
    m, s = read.masses[name], state[name]
    plane = Plane(m.center + 0.2 * rng.standard_normal(3), random_unit(rng))
    there = section(scene, state, T, name, plane.at, plane.normal)
    back = section(scene, state, T, name, plane.at, -plane.normal)
    size = size_of(found)
    if there.unique.all():
        close(there.force + back.force, np.zeros(3), size)
        close(there.moment + back.moment, np.zeros(3), size)
    piece = cut(scene["bodies"][name], plane)[1]
    P, c = s.point(plane.at), s.point(piece.center)
    spin, spin_rate = s.angular_velocity, found.angular_acceleration[name]
    arm = c - s.point(m.center)
    a = found.acceleration[name] + cross(spin_rate, arm) + cross(spin, cross(spin, arm))
    I_world = s.rotation @ piece.inertia @ s.rotation.T
    force = -piece.mass * a
    moment = -cross(c - P, piece.mass * a) - I_world @ spin_rate - cross(spin, I_world @ spin)
    parts = [p for n, parts in found.loads.items() if n != "gravity" for p in parts if p.body == name]
    places = [(p.place, p.force, p.couple) for p in parts] + [(c, piece.mass * read.gravity, np.zeros(3))]
    for j in read.joints:
        r = found.reactions[j.name]
        axis = (np.eye(3) if j.a.body == GROUND else state[j.a.body].rotation) @ j.axis
        F, M = r.force, r.moment
        if j.drive is not None and j.kind != "rod":
            F, M = (F, M + r.drive * axis) if j.drive[0] == "angle" else (F + r.drive * axis, M)
        for end, sign in ((j.b, 1.0), (j.a, -1.0)):
            if end.body == name:
                at = s.point(end.point) if j.kind == "rod" else r.point
                places.append((at, sign * F, sign * M))
    n = s.rotation @ plane.normal
    for k, (place, F, M) in enumerate(places):
        weight = k == len(parts)
        if weight or (place - P) @ n > 0:
            force, moment = force + F, moment + cross(place - P, F) + M
    if there.unique.all() and all(r.unique.all() for r in found.reactions.values()):
        close(there.force, force, size)
        close(there.moment, moment, size)
    else:
        assert not all(r.unique.all() for r in found.reactions.values())


def test_a_whole_free_body_and_an_empty_piece() -> None:
    scene, state = some_scene(3, n_bodies=1, roots=0.0, kinds=("ball",), masses="shapes", loops=0, drives=0)
    name = "b0"
    scene["joints"] = {}
    scene.pop("forces", None)
    for at in ([9.0, 0, 0], [-9.0, 0, 0]):
        found = section(scene, state, T, name, at, [1.0, 0, 0])
        close(found.force, np.zeros(3), 10.0)
        close(found.moment, np.zeros(3), 100.0)
