"""The closure rows that carry the motion, chosen anew at a pose or put aside as numbers and taken up again.

What follows from a state follows from these rows, too: others, as independent, give the same to rounding only.
"""

from __future__ import annotations

try:
    import cython
except ImportError:
    from heuncli.kernel.shadow import cython

if not cython.compiled:
    from heuncli.kernel.orthogonal import list_coupled
    from heuncli.kernel.response import settle
    from heuncli.kernel.scene import Closure, Scene
    from heuncli.kernel.selection import order_all, select_independent_rows
    from heuncli.kernel.shadow import cython


def choose_afresh(scene: cython.pointer[Scene], t: cython.double, y: cython.p_double) -> cython.void:
    """Choose the rows at a pose, and measure their nearness from there: nothing of earlier poses is left."""
    scene.pivot = 1.0
    scene.pivot_chosen = 1.0
    select_independent_rows(scene, t, y, True)


def judge_start(scene: cython.pointer[Scene], t: cython.double, y: cython.p_double) -> cython.void:
    """What has to be left of a row for it to be chosen, by the gap and the rows of the start.

    On the way through a singular pose a row is left out where rounding would tell more of it than the pose; a scene
    that is as near to one from its beginning keeps its rows.
    """
    scene.least_row = scene.limits.independent
    select_independent_rows(scene, t, y, True)
    gap: cython.double = scene.rank_of_gap * settle(scene, t, y)
    if gap > scene.least_row:
        scene.least_row = gap
        select_independent_rows(scene, t, y, True)
    least: cython.double = scene.limits.passing_of_start * order_all(scene, 0.0)
    if least > scene.limits.passing:
        least = scene.limits.passing
    if least > scene.least_row:
        scene.least_row = least


def chosen_width(scene: cython.pointer[Scene]) -> cython.int:
    """How many numbers the choice is."""
    return 1 + 2 * scene.closure_count


def put_chosen(scene: cython.pointer[Scene], out: cython.p_double, at: cython.Py_ssize_t) -> cython.void:
    """Write the choice: the least pivot when it was made; of each row its place (-1: left out) and its scale."""
    i: cython.Py_ssize_t
    out[at] = scene.pivot_chosen
    for i in range(scene.closure_count):
        row: cython.pointer[Closure] = cython.address(scene.closures[i])
        out[at + 1 + 2 * i] = row.rank
        out[at + 2 + 2 * i] = row.pose_scale


def take_chosen(scene: cython.pointer[Scene], given: cython.p_double, at: cython.Py_ssize_t) -> cython.void:
    """The choice as it was written; the next factorisation is over its rows."""
    i: cython.int
    rank: cython.int
    scene.pivot = 1.0
    scene.pivot_chosen = given[at]
    scene.selected_count = 0
    for i in range(scene.closure_count):
        row: cython.pointer[Closure] = cython.address(scene.closures[i])
        rank = int(given[at + 1 + 2 * i])
        row.rank = rank
        row.pose_scale = given[at + 2 + 2 * i]
        if rank >= 0:
            scene.selected[rank] = i
            scene.selected_count += 1
    list_coupled(scene)
