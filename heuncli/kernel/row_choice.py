"""The choice of the closure rows that carry the motion: made at a pose, saved as numbers, and restored.

What is computed at a state depends on these rows too: another set of independent rows agrees to rounding only.
"""

from __future__ import annotations

from heuncli.kernel.declarations import *
from heuncli.kernel.orthogonal import list_coupled_rows
from heuncli.kernel.response import project_state
from heuncli.kernel.selection import order_all, select_independent_rows

# What a saved choice has of each row, behind its pivot.
ROW_RANK, ROW_SCALE = range(2)
ROW_NUMBERS = 2


def choose_rows_again(scene: cython.pointer[Scene], t: cython.double, y: cython.p_double) -> cython.void:
    """Choose the rows at a pose and reset the measure of how independent they are; nothing of earlier poses remains."""
    scene.pivot = 1.0
    scene.pivot_chosen = 1.0
    select_independent_rows(scene, t, y, True)


def set_row_threshold(scene: cython.pointer[Scene], t: cython.double, y: cython.p_double) -> cython.void:
    """Set what must be left of a row for it to be chosen, from the gap and the rows at the start.

    On the way through a singular pose a row is left out where rounding would contribute more to it than the pose does.
    A scene that is already as near to a singular pose at its start keeps its rows.
    """
    scene.least_row = scene.limits.independent
    select_independent_rows(scene, t, y, True)
    gap: cython.double = scene.rank_of_gap * project_state(scene, t, y)
    if gap > scene.least_row:
        scene.least_row = gap
        select_independent_rows(scene, t, y, True)
    threshold: cython.double = scene.limits.passing_of_start * order_all(scene, 0.0)
    if threshold > scene.limits.passing:
        threshold = scene.limits.passing
    if threshold > scene.least_row:
        scene.least_row = threshold


def choice_width(scene: cython.pointer[Scene]) -> cython.int:
    """Return how many numbers a saved choice has."""
    return 1 + ROW_NUMBERS * scene.closure_count


def save_choice(scene: cython.pointer[Scene], buffer: cython.p_double, offset: cython.Py_ssize_t) -> cython.void:
    """Write the choice: the smallest pivot when it was made; for each row its rank (-1: left out) and its scale."""
    i: cython.Py_ssize_t
    offset = write_number(buffer, offset, scene.pivot_chosen)
    for i in range(scene.closure_count):
        offset = write_number(buffer, offset, scene.closures[i].rank)
        offset = write_number(buffer, offset, scene.closures[i].pose_scale)


def restore_choice(
    scene: cython.pointer[Scene], saved_choice: cython.p_double, offset: cython.Py_ssize_t
) -> cython.void:
    """Restore a saved choice; the next factorisation uses its rows."""
    i: cython.int
    rank: cython.int
    scene.pivot = 1.0
    scene.pivot_chosen = saved_choice[offset]
    scene.selected_count = 0
    for i in range(scene.closure_count):
        row: cython.pointer[Closure] = cython.address(scene.closures[i])
        rank = int(saved_choice[offset + 1 + ROW_NUMBERS * i + ROW_RANK])
        row.rank = rank
        row.pose_scale = saved_choice[offset + 1 + ROW_NUMBERS * i + ROW_SCALE]
        if rank >= 0:
            scene.selected[rank] = i
            scene.selected_count += 1
    list_coupled_rows(scene)
