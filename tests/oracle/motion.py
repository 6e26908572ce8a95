"""Motion by brute force: absolute coordinates, unit quaternions, DOP853 at the limit of double precision.

Gaps are not corrected. An independent motion for short times; an evaluation costs an SVD, so a few bodies over a second
or two.
"""

from __future__ import annotations

import itertools
from collections.abc import Sequence

import numpy as np
from scipy.integrate import solve_ivp
from scipy.spatial.transform import Rotation

from tests.oracle.loads import pushes
from tests.oracle.read import Model, Placed, Scene, State, model
from tests.oracle.rows import velocities
from tests.oracle.solve import accelerations, scene_length
from tests.oracle.turns import Array, cross


def motion(scene: Scene, state: State, times: Sequence[float], rtol: float = 1e-13) -> list[dict[str, Placed]]:
    """The states at the given times, the first of which is the time of `state`. Loads must be smooth in between."""
    read = model(scene)
    size = scene_length(read, state)
    n = len(read.names)

    def slope(t: float, y: Array) -> Array:
        now = unpacked(read, y)
        V = y[7 * n :].reshape(n, 6)
        V_dot = accelerations(read, now, t, pushes(read, now, t), size).V_dot
        turning = [quaternion_rate(q, s) for q, s in zip(y[3 * n : 7 * n].reshape(n, 4), V[:, 3:], strict=True)]
        return np.concatenate([V[:, :3].ravel(), *turning, V_dot])

    found = [packed(read, state)]
    for start, stop in itertools.pairwise(times):  # steps end at the asked instants: no interpolation
        run = solve_ivp(slope, (start, stop), found[-1], method="DOP853", rtol=rtol, atol=rtol)
        if not run.success:
            raise RuntimeError(run.message)
        found.append(run.y[:, -1])
    return [unpacked(read, y) for y in found]


def quaternion_rate(q: Array, spin: Array) -> Array:
    """Rate of a quaternion (x, y, z, w) at an angular velocity in world axes: half of (spin, 0) times q."""
    v, w = q[:3], q[3]
    return 0.5 * np.append(w * spin + cross(spin, v), -spin @ v)


def packed(scene: Model, state: State) -> Array:
    """Centres, quaternions (x, y, z, w), then (v of the centre, σ) body by body."""
    centers = [state[b].point(scene.masses[b].center) for b in scene.names]
    turns = [Rotation.from_matrix(state[b].rotation).as_quat() for b in scene.names]
    return np.concatenate([*centers, *turns, velocities(scene, state)])


def unpacked(scene: Model, y: Array) -> dict[str, Placed]:
    """The state of origins behind packed numbers."""
    n = len(scene.names)
    V = y[7 * n :].reshape(n, 6)
    state = {}
    for k, name in enumerate(scene.names):
        R = Rotation.from_quat(y[3 * n + 4 * k : 3 * n + 4 * k + 4]).as_matrix()
        arm = R @ scene.masses[name].center
        state[name] = Placed(y[3 * k : 3 * k + 3] - arm, R, V[k, :3] - cross(V[k, 3:], arm), V[k, 3:])
    return state
