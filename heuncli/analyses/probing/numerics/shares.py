"""The share of a joint's coordinate in the motion of its closed chains; where it vanishes is a dead centre.

    J T = 0,   T' T = 1             T: how the loop's freedoms may move, its drives released; scaled by turn and size
    c T = s v'                      c: the loop's coordinates; v: the one motion that they take part in, s their shares
A coordinate whose s is 0 stands while the others move: no torque or force there drives the mechanism.
"""

from __future__ import annotations

import numpy as np

from heuncli.analyses.probing.numerics.twists import Twists, closure_rows, twists
from heuncli.base import tolerances
from heuncli.base.joint_kinds import JOINTS
from heuncli.base.records import record
from heuncli.kernel.choose import scene as kernel
from heuncli.motion.integration.evaluator import Recovered
from heuncli.multibody.tree.islands import loop_of
from heuncli.multibody.tree.layout import Island, Layout
from heuncli.results.results import Array, Indices


@record
class Loop:
    """An island with its freedoms, the driven ones among them, its rows that are no drives, and its coordinates."""

    freedoms: Indices
    unit: Array  # of the freedoms: 1 of a turn, the size of a shift
    rows: Indices
    coordinates: tuple[tuple[int, str], ...]  # joint, and angle or travel


def loops_of(layout: Layout) -> list[Loop]:
    """The islands whose joints have coordinates."""
    found = []
    for island in layout.islands:
        bodies, joints = parts_of(layout, island)
        freedoms, unit = freedoms_of(layout, bodies)
        rows = [r for r in island.rows.tolist() if not layout.tables["closures"]["program"]["count"][r]]
        own = [(k, name) for k in joints for name in JOINTS[layout.mechanism.joints[k].kind].coordinates]
        kept = tuple((k, name) for k, name in own if name in ("angle", "travel"))
        if len(kept) > 1 and rows:
            found.append(Loop(np.array(freedoms), np.array(unit), np.array(rows), kept))
    return found


def parts_of(layout: Layout, island: Island) -> tuple[list[int], list[int]]:
    """The bodies (tree order) and the joints of an island's loops."""
    cut = {layout.rows[row] for row in island.rows.tolist()}
    bodies = sorted({body for k in cut for body in loop_of(layout, k)})
    joints = cut | {layout.spanning.hangs[body].joint for body in bodies} - {-1}
    return bodies, sorted(k for k in joints if k < len(layout.mechanism.joints))  # and no couplings


def freedoms_of(layout: Layout, bodies: list[int]) -> tuple[list[int], list[float]]:
    """The freedoms of some bodies, by their answers, and the unit of each."""
    found, unit = [], []
    table = layout.tables["freedoms"]
    for body in layout.bodies[bodies]:
        turns = 3 if body["ball"] else 0
        found += [int(body["answer_at"]) + i for i in range(turns)]
        unit += [1.0] * turns
        for j in range(int(body["first_freedom"]), int(body["end_freedom"])):
            found.append(int(table["answer_at"][j]))
            unit.append(layout.size if table["kind"][j] == kernel.SHIFT else 1.0)
    return found, unit


def motions(layout: Layout, loop: Loop, at: Recovered) -> tuple[Array, Array]:
    """Shares of a loop's coordinates and its freedoms in its motion, (n_t, c + n), and how many motions there are.

    nan where there is not one motion that the coordinates take part in. The sign of each instant is arbitrary.
    """
    found = twists(layout, at)
    J = closure_rows(found, at)[:, loop.rows][:, :, loop.freedoms] * loop.unit
    J = J * (at.rows["closed"][:, loop.rows] > 0.0)[:, :, None]
    size = np.sqrt(np.sum(J * J, axis=2, keepdims=True))
    J = J / np.where(size > 0.0, size, 1.0)
    _, s, V = np.linalg.svd(J, full_matrices=True)
    rank = (s > tolerances.RANK * s.max(axis=1, initial=1.0)[:, None]).sum(axis=1)
    c = coordinate_rows(found, layout, loop)
    n = len(loop.freedoms)
    shares, count = np.full((len(J), len(loop.coordinates) + n), np.nan), np.zeros(len(J), dtype=int)
    for r in np.unique(rank).tolist():
        which = np.flatnonzero(rank == r)
        if r == n:
            continue
        T = V[which, r:].swapaxes(1, 2)
        _, own, v = np.linalg.svd(c[which] @ T, full_matrices=False)
        moving = own > tolerances.RANK
        count[which] = moving.sum(axis=1)
        one = moving.sum(axis=1) == 1
        x = np.einsum("tij,tj->ti", T, v[:, 0])
        both = np.concatenate([np.einsum("tci,ti->tc", c[which], x), x], axis=1)
        shares[which[one]] = both[one]
    return shares, count


def coordinate_rows(found: Twists, layout: Layout, loop: Loop) -> Array:
    """What the loop's freedoms make of its coordinates, travels by the scene's size, (n_t, c, n)."""
    rows = np.zeros((len(found.turn), len(loop.coordinates), len(loop.freedoms)))
    for i, (k, name) in enumerate(loop.coordinates):
        joint = layout.mechanism.joints[k]
        axis, Q = found.direction(joint.a, joint.axis), found.point(joint.b, joint.q)
        (turn_a, shift_a), (turn_b, shift_b) = found.of_point(joint.a, Q), found.of_point(joint.b, Q)
        apart = turn_b - turn_a if name == "angle" else (shift_b - shift_a) / layout.size
        rows[:, i] = np.einsum("tni,ti->tn", apart, axis)[:, loop.freedoms] * loop.unit
    return rows


def continued(shares: Array, before: Array | None = None) -> Array:
    """Shares with the signs of one motion that goes on; before (n,): the share before the first."""
    first = np.nan_to_num(shares if before is None else np.vstack([before, shares]))
    turned = np.sum(first[1:] * first[:-1], axis=1) < 0.0
    sign = np.cumprod(np.concatenate([[1.0], np.where(turned, -1.0, 1.0)]))
    return np.asarray(shares * (sign if before is None else sign[1:])[:, None])
