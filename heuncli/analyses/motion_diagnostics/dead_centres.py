"""Dead centres of closed chains: where a coordinate stops while the others of its loop move, so that it cannot drive.

The shares of a loop's coordinates in its only motion form a vector of arbitrary sign, which is continued along the
motion; a dead centre is a zero of one of them.
"""

from __future__ import annotations

import numpy as np

from heuncli.analyses.motion_diagnostics.motion_events import MotionSearch, find_zeros, format_duration
from heuncli.analyses.motion_diagnostics.results import DEAD_CENTRE, Event
from heuncli.analyses.motion_diagnostics.twists import Twists, closure_rows, compute_twists
from heuncli.base import tolerances
from heuncli.base.joint_kinds import JOINTS
from heuncli.base.records import record
from heuncli.kernel.choose import scene as kernel
from heuncli.loads.redundancy.self_stress import find_neighbour_poses
from heuncli.motion.integration.evaluator import Evaluation
from heuncli.multibody.tree.islands import loop_bodies
from heuncli.multibody.tree.layout import Island, Layout
from heuncli.results.results import Array, Indices, Mask


def find_dead_centres(motion: MotionSearch) -> tuple[list[Event], list[str]]:
    """Return the dead centres of the closed chains, and the reasons why loops were skipped."""
    loops = find_loops(motion.layout)
    if not loops:
        return [], []
    parts = motion.recover_in_parts()
    events, skipped = [], []
    neighbour_poses = find_adjacent_poses(motion)
    for loop in loops:
        part_motions = [compute_loop_motions(motion.layout, loop, part) for part in parts]
        shares, count = (np.concatenate([part[i] for part in part_motions]) for i in (0, 1))
        neighbour_shares = (
            shares if neighbour_poses is None else compute_loop_motions(motion.layout, loop, neighbour_poses)[0]
        )
        if np.median(count) != 1:
            skipped.append(explain_skipped(motion, loop, int(np.median(count))))
            continue
        c = len(loop.coordinates)
        largest = np.max(np.abs(np.nan_to_num(np.vstack([shares, neighbour_shares])[:, :c])), axis=0)
        events += find_loop_dead_centres(motion, loop, continue_signs(shares), largest > tolerances.REMAINING_RATE)
    return events, skipped


def explain_skipped(motion: MotionSearch, loop: Loop, count: int) -> str:
    """Explain why no dead centre of a loop is searched."""
    names = format_joints(motion, loop)
    if count == 0:
        return f"the coordinates of {names} do not move"
    return f"the coordinates of {names} have {count} degrees of freedom together: no single one drives the others"


def format_joints(motion: MotionSearch, loop: Loop) -> str:
    """Return the names of the joints of a loop."""
    return ", ".join(dict.fromkeys(motion.layout.mechanism.joints[k].name for k, _ in loop.coordinates))


def find_adjacent_poses(motion: MotionSearch) -> Evaluation | None:
    """Return poses close to the only one of a scene, to see which coordinates move; None for a motion."""
    if len(motion.times) > 1:
        return None
    recovered = motion.study.history.solutions
    return find_neighbour_poses(
        motion.study.setup.runner,
        float(recovered.times[0]),
        recovered.states[0],
        (tolerances.NEIGHBOUR,),
        holding=recovered.holding[0],
    )


def find_loop_dead_centres(motion: MotionSearch, loop: Loop, shares: Array, is_moving: Mask) -> list[Event]:
    """Return the dead centres of one loop; is_moving: which of its coordinates move at all."""
    joints, events = motion.layout.mechanism.joints, []

    def track(recovered: Evaluation) -> Array:
        """Return the shares of the loop's coordinates at recovered instants."""
        return compute_loop_motions(motion.layout, loop, recovered)[0]

    for i, (k, name) in enumerate(loop.coordinates):
        if not is_moving[i]:
            continue
        for interval in find_zeros(motion, track, shares, i):
            others = [f"{joints[j].name}.{what}" for j, what in loop.coordinates if (j, what) != (k, name)]
            coordinate = f"{joints[k].name}.{name}"
            motion_text = f"{' and '.join(others[:2])} {'moves' if len(others) == 1 else 'move'}"
            message = f"{coordinate} stops while {motion_text}: it cannot drive the mechanism there"
            events.append(
                Event(
                    interval.begin, DEAD_CENTRE, f"joints.{joints[k].name}", message + format_duration(interval, motion)
                )
            )
    return events


@record
class Loop:
    """An island of closed chains.

    freedoms: those of its bodies, including driven ones
    unit: unit of each freedom: 1 of a turn, the scene's size of a shift
    rows: its closure rows that are not drives
    coordinates: joint, and `angle` or `travel`, of each coordinate
    """

    freedoms: Indices
    unit: Array
    rows: Indices
    coordinates: tuple[tuple[int, str], ...]


def find_loops(layout: Layout) -> list[Loop]:
    """Return the islands whose joints have coordinates."""
    loops = []
    for island in layout.islands:
        bodies, joints = find_loop_parts(layout, island)
        freedoms, unit = find_freedoms(layout, bodies)
        rows = [r for r in island.rows.tolist() if not layout.tables["closures"]["program"]["count"][r]]
        coordinates = [(k, name) for k in joints for name in JOINTS[layout.mechanism.joints[k].kind].coordinates]
        angles_and_travels = tuple((k, name) for k, name in coordinates if name in ("angle", "travel"))
        if len(angles_and_travels) > 1 and rows:
            loops.append(Loop(np.array(freedoms), np.array(unit), np.array(rows), angles_and_travels))
    return loops


def find_loop_parts(layout: Layout, island: Island) -> tuple[list[int], list[int]]:
    """Return the bodies (tree order) and the joints of an island's loops."""
    closing_joints = {layout.rows[row] for row in island.rows.tolist()}
    bodies = sorted({body for k in closing_joints for body in loop_bodies(layout, k)})
    joints = closing_joints | {layout.spanning.links[body].joint for body in bodies} - {-1}
    return bodies, sorted(k for k in joints if k < len(layout.mechanism.joints))  # and no couplings


def find_freedoms(layout: Layout, bodies: list[int]) -> tuple[list[int], list[float]]:
    """Return the freedoms of bodies, by their index in the solution, and the unit of each."""
    freedoms, unit = [], []
    table = layout.tables["freedoms"]
    for body in layout.bodies[bodies]:
        turns = 3 if body["ball"] else 0
        freedoms += [int(body["velocity_at"]) + i for i in range(turns)]
        unit += [1.0] * turns
        for j in range(int(body["first_freedom"]), int(body["end_freedom"])):
            freedoms.append(int(table["velocity_at"][j]))
            unit.append(layout.size if table["kind"][j] == kernel.SHIFT else 1.0)
    return freedoms, unit


def compute_loop_motions(layout: Layout, loop: Loop, recovered: Evaluation) -> tuple[Array, Array]:
    """Return the shares of a loop's coordinates and freedoms in its motion, (n_t, c + n), and the number of motions.

    nan unless the coordinates take part in exactly one motion. The sign at each instant is arbitrary.
    """
    body_twists = compute_twists(layout, recovered)
    J = closure_rows(body_twists, recovered)[:, loop.rows][:, :, loop.freedoms] * loop.unit
    J = J * (recovered.rows["closed"][:, loop.rows] > 0.0)[:, :, None]
    size = np.sqrt(np.sum(J * J, axis=2, keepdims=True))
    J = J / np.where(size > 0.0, size, 1.0)
    _, s, V = np.linalg.svd(J, full_matrices=True)
    rank = (s > tolerances.RANK * s.max(axis=1, initial=1.0)[:, None]).sum(axis=1)
    coordinate_rows = make_coordinate_rows(body_twists, layout, loop)
    n = len(loop.freedoms)
    shares, count = np.full((len(J), len(loop.coordinates) + n), np.nan), np.zeros(len(J), dtype=int)
    for r in np.unique(rank).tolist():
        instants = np.flatnonzero(rank == r)
        if r == n:
            continue
        T = V[instants, r:].swapaxes(1, 2)
        _, sizes, v = np.linalg.svd(coordinate_rows[instants] @ T, full_matrices=False)
        moving = sizes > tolerances.RANK
        count[instants] = moving.sum(axis=1)
        is_single = moving.sum(axis=1) == 1
        x = np.einsum("tij,tj->ti", T, v[:, 0])
        single_shares = np.concatenate([np.einsum("tci,ti->tc", coordinate_rows[instants], x), x], axis=1)
        shares[instants[is_single]] = single_shares[is_single]
    return shares, count


def make_coordinate_rows(body_twists: Twists, layout: Layout, loop: Loop) -> Array:
    """Return the rows of a loop's coordinates on its freedoms, travels divided by the scene's size, (n_t, c, n)."""
    rows = np.zeros((len(body_twists.turn), len(loop.coordinates), len(loop.freedoms)))
    for i, (k, name) in enumerate(loop.coordinates):
        joint = layout.mechanism.joints[k]
        axis, Q = body_twists.to_world(joint.a, joint.axis), body_twists.locate_point(joint.b, joint.q)
        (turn_a, shift_a), (turn_b, shift_b) = body_twists.point_twist(joint.a, Q), body_twists.point_twist(joint.b, Q)
        relative_motion = turn_b - turn_a if name == "angle" else (shift_b - shift_a) / layout.size
        rows[:, i] = np.einsum("tni,ti->tn", relative_motion, axis)[:, loop.freedoms] * loop.unit
    return rows


def continue_signs(shares: Array, previous: Array | None = None) -> Array:
    """Return shares with continuous signs; previous (n,): the share before the first."""
    all_shares = np.nan_to_num(shares if previous is None else np.vstack([previous, shares]))
    is_turned = np.sum(all_shares[1:] * all_shares[:-1], axis=1) < 0.0
    sign = np.cumprod(np.concatenate([[1.0], np.where(is_turned, -1.0, 1.0)]))
    return np.asarray(shares * (sign if previous is None else sign[1:])[:, None])
