"""Index the numbers of each closure row: the bodies on its path, their answers, and the fill-in.

A row of the closure Jacobian has numbers for the freedoms of the bodies on its path, which is between its two ends and
the ground. Eliminating earlier rows from it fills in those of the bodies that they reach.
"""

from __future__ import annotations

from array import array
from collections.abc import Sequence

from heuncli.multibody.tree.rows import BodyRow, ClosureIndices


def index_rows(paths: Sequence[list[int]], bodies: Sequence[BodyRow]) -> tuple[list[ClosureIndices], array[int], int]:
    """Return, for each closure row by its path, where its indices are; these indices; and the total length of all
    columns.

    paths: tree indices, tips first

    Rows with the same path share their indices.
    """
    indices = array("i")
    shared: dict[tuple[int, ...], tuple[int, int, int, int]] = {}
    places: list[ClosureIndices] = []
    column = 0
    coupled, filled = find_fill_in(paths)

    def append_data(data: Sequence[int]) -> int:
        indices.extend(data)
        return len(indices) - len(data)

    for path, rows, others in zip(paths, coupled, filled, strict=True):
        key = (*path, -1, *others)
        if key not in shared:
            answers = [n for i in path for n in bodies[i].answers]
            more = [n for i in others for n in bodies[i].answers]
            shared[key] = append_data(path), append_data(answers + more), len(answers), len(answers) + len(more)
        path_at, answers_at, count, filled_count = shared[key]
        places.append(
            ClosureIndices(
                path=path_at,
                path_count=len(path),
                column=column,
                answers=answers_at,
                answer_count=count,
                filled_count=filled_count,
                couplings=append_data(rows),
                coupling_count=len(rows),
                rank=-1,
            )
        )
        column += filled_count
    return places, indices, column


def find_fill_in(paths: Sequence[list[int]]) -> tuple[list[list[int]], list[list[int]]]:
    """Return for each row the earlier rows (and itself) whose elimination may fill it, and the bodies that they fill.

    A row meets the earlier ones whose bodies are on its path, or among those filled before. Filled bodies are those not
    on its own path, tips first.
    """
    group: dict[int, int] = {}  # body -> the group of rows that reaches it
    rows: dict[int, list[int]] = {}
    bodies: dict[int, set[int]] = {}
    coupled: list[list[int]] = []
    filled: list[list[int]] = []
    for r, path in enumerate(paths):
        met_groups = sorted({group[i] for i in path if i in group})
        target = met_groups[0] if met_groups else r
        rows.setdefault(target, [])
        bodies.setdefault(target, set())
        for other in met_groups[1:]:
            rows[target] += rows.pop(other)
            bodies[target] |= bodies.pop(other)
        rows[target].append(r)
        bodies[target] |= set(path)
        for i in bodies[target]:
            group[i] = target
        coupled.append(sorted(rows[target]))
        filled.append(sorted(bodies[target] - set(path), reverse=True))
    return coupled, filled
