"""The axes of a plane, and the directions that may be its normal.

    E = [e1; e2; n]      x' = E x: components along the plane's axes, the third across it

For a coordinate plane the axes are the world's in another order, and components are only permuted.
"""

from __future__ import annotations

from collections.abc import Iterator
from itertools import islice

import numpy as np

from heuncli.base import tolerances
from heuncli.base.joint_kinds import JOINTS
from heuncli.multibody.mechanism.model import GROUND
from heuncli.multibody.tree.prepare import PreparedScene
from heuncli.multibody.tree.starts import body_state
from heuncli.results.results import Array
from heuncli.scene.shapes.rotations import cross_vectors, perpendicular_pair

MAX_CANDIDATES = 8  # directions that are tried: a normal is along or across each axis of a scene, so a few suffice


def plane_axes(n: Array) -> Array:
    """Return the axes of the plane normal to a direction, (3, 3), right-handed."""
    k = int(np.argmax(np.abs(n)))
    if np.abs(np.delete(n, k)).max() <= tolerances.FLAT * abs(float(n[k])):
        return np.eye(3)[[(k + 1) % 3, (k + 2) % 3, k]]
    n = n / np.sqrt(n @ n)
    e, f = perpendicular_pair(n)
    return np.array([e, f, n])


def iter_normals(scene: PreparedScene) -> Iterator[Array]:
    """Yield directions that may be the normal, the most likely ones first, each once."""
    if scene.mechanism.planar:
        yield np.array([0.0, 0.0, 1.0])
        return
    tried: list[Array] = []
    for n in _iter_directions(scene):
        size = float(np.sqrt(n @ n))
        if size > 0.0:
            n = n / size
            if not any(np.abs(cross_vectors(n, other)).max() <= tolerances.FLAT for other in tried):
                tried.append(n)
                yield n
        if len(tried) == MAX_CANDIDATES:
            return


def _iter_directions(scene: PreparedScene) -> Iterator[Array]:
    """Yield axes of pins and hinges, normals of in-plane vectors, world axes, normals of slides, axes of rotation, all
    others.
    """
    mechanism, start = scene.mechanism, scene.start
    axes = [(JOINTS[j.kind], body_state(start, j.a)[1] @ j.axis) for j in mechanism.joints]
    pins = [axis for kind, axis in axes if kind.turns == ("axis",) and not kind.shifts]
    yield from pins[:1]
    yield from islice(_iter_hinge_lines(scene), 1)
    yield from _iter_common_normal(_in_plane_vectors(scene))
    yield from np.eye(3)[::-1]
    yield from _iter_common_normal(np.array([axis for kind, axis in axes if kind.shifts]).reshape(-1, 3))
    yield from start.angular_velocity[:1]
    yield from (axis for kind, axis in axes if kind.has_axis)


def _iter_hinge_lines(scene: PreparedScene) -> Iterator[Array]:
    """Yield the vectors from one joint to another between the same two bodies, as along the hinges of a door."""
    first: dict[tuple[int, int], Array] = {}
    for joint in scene.mechanism.joints:
        x, R, _, _ = body_state(scene.start, joint.b)
        place = x + R @ joint.q
        ends = (min(joint.a, joint.b), max(joint.a, joint.b))
        if ends in first:
            yield place - first[ends]
        first.setdefault(ends, place)


def _in_plane_vectors(scene: PreparedScene) -> Array:
    """Return vectors that lie in the plane if there is one: between points of the scene, gravity, velocities."""
    mechanism, start = scene.mechanism, scene.start
    x, R = start.position, start.rotation
    places = [x[i] + R[i] @ body.center for i, body in enumerate(mechanism.bodies)]
    for joint in mechanism.joints:
        places += [p if b == GROUND else x[b] + R[b] @ p for b, p in ((joint.a, joint.p), (joint.b, joint.q))]
    found = np.array(places)
    return np.concatenate([found[1:] - found[0], start.velocity, mechanism.gravity[None]])


def _iter_common_normal(vectors: Array) -> Iterator[Array]:
    """Yield a direction normal to all vectors, if there is one; each counts by its direction."""
    size = np.sqrt(np.sum(np.square(vectors), axis=1))
    large = size > tolerances.FLAT * size.max(initial=0.0)
    if np.any(large):
        triangle = np.linalg.qr(vectors[large] / size[large, None], mode="r")  # many vectors, the same right-hand side
        yield np.linalg.svd(triangle, full_matrices=True)[2][2]
