"""Where the numbers of each closure row stand: the bodies on its path, the answers these make, what fills it.

A row of the closure Jacobian has numbers for the freedoms of the bodies on its path, which is between its two ends and
the ground. Taking earlier rows out of it fills in those of the bodies that they reach.
"""

from __future__ import annotations

from array import array
from collections.abc import Sequence

from heuncli.multibody.tree.rows import BodyRow, ClosurePlaces


def places_of(paths: Sequence[list[int]], bodies: Sequence[BodyRow]) -> tuple[list[ClosurePlaces], array[int], int]:
    """Of each closure row, by its path, where its indices stand; these indices; how long all columns are together.

    paths: places in the tree, tips first. Rows of one path share their indices.
    """
    indices = array("i")
    shared: dict[tuple[int, ...], tuple[int, int, int, int]] = {}
    places: list[ClosurePlaces] = []
    column = 0
    coupled, filled = fill_in(paths)

    def put(data: Sequence[int]) -> int:
        indices.extend(data)
        return len(indices) - len(data)

    for path, rows, others in zip(paths, coupled, filled, strict=True):
        key = (*path, -1, *others)
        if key not in shared:
            answers = [n for i in path for n in bodies[i].answers]
            more = [n for i in others for n in bodies[i].answers]
            shared[key] = put(path), put(answers + more), len(answers), len(answers) + len(more)
        path_at, answers_at, count, filled_count = shared[key]
        places.append(
            ClosurePlaces(
                path=path_at,
                path_count=len(path),
                column=column,
                answers=answers_at,
                answer_count=count,
                filled_count=filled_count,
                couplings=put(rows),
                coupling_count=len(rows),
                rank=-1,
            )
        )
        column += filled_count
    return places, indices, column


def fill_in(paths: Sequence[list[int]]) -> tuple[list[list[int]], list[list[int]]]:
    """For each row the earlier rows (and itself) that may fill it when they are taken out of it, and what they fill.

    A row meets the earlier ones whose bodies are on its path, or on what those have filled. Filled are the bodies that
    are not on its own path, tips first.
    """
    group: dict[int, int] = {}  # body -> the group of rows that reaches it
    rows: dict[int, list[int]] = {}
    bodies: dict[int, set[int]] = {}
    coupled: list[list[int]] = []
    filled: list[list[int]] = []
    for r, path in enumerate(paths):
        met = sorted({group[i] for i in path if i in group})
        into = met[0] if met else r
        rows.setdefault(into, [])
        bodies.setdefault(into, set())
        for other in met[1:]:
            rows[into] += rows.pop(other)
            bodies[into] |= bodies.pop(other)
        rows[into].append(r)
        bodies[into] |= set(path)
        for i in bodies[into]:
            group[i] = into
        coupled.append(sorted(rows[into]))
        filled.append(sorted(bodies[into] - set(path), reverse=True))
    return coupled, filled
