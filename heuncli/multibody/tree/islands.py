"""Islands: closed loops that share bodies. The loads in a loop depend only on the other loops of its island.

A self-stress is within one island, so each is examined alone and scaled by its own length.
"""

from __future__ import annotations

from collections.abc import Collection

import numpy as np

from heuncli.base import tolerances
from heuncli.base.records import replace
from heuncli.kernel.choose import scene as kernel
from heuncli.multibody.mechanism.couplings import CoupledRow
from heuncli.multibody.mechanism.loads import GROUND
from heuncli.multibody.tree.layout import Island, Layout
from heuncli.multibody.tree.tables import make_table
from heuncli.results.results import Array, Mask

COUPLES = (kernel.DOT, kernel.TURN)  # kinds of closure rows whose load is a couple


def add_islands(layout: Layout) -> Layout:
    """Add the islands to the layout and to the kernel's tables, where they scale rows and freedoms."""
    islands_found = find_islands(layout)
    velocity_scale = np.zeros(layout.velocity_count)
    rows = []
    for island in islands_found:
        velocity_scale[island.freedoms] = np.where(island.turns, 1.0 / island.length, 1.0)
        layout.tables["closures"]["unit_load_size"][island.rows] = np.where(island.couples, island.length, 1.0)
        first_index = len(layout.indices)
        layout.indices.extend(island.rows.tolist() + island.freedoms.tolist())
        n = len(island.rows)
        rows.append(
            kernel.Island(rows=first_index, row_count=n, freedoms=first_index + n, freedom_count=len(island.freedoms))
        )
    tables = layout.tables | {"islands": make_table(kernel.Island, rows)}
    return replace(layout, islands=tuple(islands_found), velocity_scale=velocity_scale, tables=tables)


def find_islands(layout: Layout) -> list[Island]:
    """Return all islands, in the order of their first rows."""
    loops = {k: loop_bodies(layout, k) for k in dict.fromkeys((*layout.spanning.cut, *layout.rows))}
    group = {k: k for k in loops}

    def root(k: int) -> int:
        while group[k] != k:
            group[k] = group[group[k]]
            k = group[k]
        return k

    through: dict[int, int] = {}  # body -> a cut joint whose loop it is in
    for k, loop in loops.items():
        for i in loop:
            group[root(k)] = root(through.setdefault(i, k))
    found: dict[int, tuple[list[int], set[int]]] = {}
    for r, k in enumerate(layout.rows):
        rows, bodies = found.setdefault(root(k), ([], set()))
        rows.append(r)
        bodies |= loops[k]
    is_couple = find_couples(layout)
    return [_make_island(layout, np.array(rows), sorted(bodies), is_couple) for rows, bodies in found.values()]


def loop_bodies(layout: Layout, joint: int) -> set[int]:
    """Return the bodies (tree order) around the loop of a cut joint: on the path to one of its ends and not to the
    other.
    """
    mechanism = layout.mechanism
    if joint >= len(mechanism.joints):
        return set().union(
            *(coupling_loop_bodies(layout, row) for row in mechanism.couplings[joint - len(mechanism.joints)].rows)
        )
    cut = mechanism.joints[joint]
    return set(layout.path_to_root(cut.a)) ^ set(layout.path_to_root(cut.b))


def coupling_loop_bodies(layout: Layout, row: CoupledRow) -> set[int]:
    """Return the bodies whose freedoms a coupling's row may move: for each part those of a loop through its two
    ends.
    """
    return {i for part in row.parts for i in set(layout.path_to_root(part.a)) ^ set(layout.path_to_root(part.b))}


def _make_island(layout: Layout, rows: Array, bodies: list[int], is_couple: Mask) -> Island:
    freedoms: list[int] = []
    turns: list[bool] = []
    for body in layout.bodies[bodies]:
        if body["ball"]:
            freedoms += range(body["velocity_at"], body["velocity_at"] + 3)
            turns += [True] * 3
        own = layout.tables["freedoms"][body["first_freedom"] : body["end_freedom"]]
        own = own[own["driven"] == 0]
        freedoms += own["velocity_at"].tolist()
        turns += (own["kind"] != kernel.SHIFT).tolist()
    length = mean_lever(layout, {layout.rows[r] for r in rows.tolist()})
    return Island(rows, np.array(freedoms, dtype=int), is_couple[rows], np.array(turns, dtype=bool), length)


def find_couples(layout: Layout) -> Mask:
    """Return whether the load of each closure row is a couple, (rows,); of a sum: the loads of all its parts."""
    closures, part_kinds = layout.tables["closures"], layout.tables["parts"]["kind"]
    if not len(closures):
        return np.zeros(0, dtype=bool)
    is_couple = np.asarray(np.logical_or.reduce([closures["kind"] == kind for kind in COUPLES]))
    for r in np.flatnonzero(closures["kind"] == kernel.SUM).tolist():
        first, count = int(closures["part"][r]), int(closures["part_count"][r])
        is_couple[r] = np.isin(part_kinds[first : first + count], COUPLES).all()
    return is_couple


def mean_lever(layout: Layout, joints: Collection[int]) -> float:
    """Mean distance of the joints' points from the centres of their bodies [m]; the scene's size if there are none.

    Distances that are only rounding, such as those of points on one axis seen along it, do not count as a lever: scaled
    by them, the rounding of the rows would hold a rotation.
    """
    bodies = layout.mechanism.bodies
    count = len(layout.mechanism.joints)
    island_joints = [layout.mechanism.joints[k] for k in joints if k < count]
    parts = [
        part for k in joints if k >= count for row in layout.mechanism.couplings[k - count].rows for part in row.parts
    ]
    places = [(b, p) for j in island_joints for b, p in ((j.a, j.p), (j.b, j.q))]
    places += [(b, np.asarray(p)) for part in parts for b, p in part.body_points]
    arms = [p - bodies[b].center for b, p in places if b != GROUND]
    mean = float(np.mean([np.sqrt(a @ a) for a in arms])) if arms else 0.0
    return mean if mean > tolerances.GAP_ROUNDING * layout.size else layout.size
