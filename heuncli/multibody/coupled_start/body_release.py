"""Choose the bodies that a start releases to satisfy its couplings: those around the coupled loops first, their parents
later.

A placed body is not moved to spare the ones that it carries (manual/format.md, "Where bodies start"): of two geared
shafts the one without a given rate turns, and not the frame that carries both. Only where the loop by itself cannot
satisfy its rows is its parent released, too, one body further in at a time.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence

from heuncli.multibody.tree.islands import loop_bodies
from heuncli.multibody.tree.layout import Layout
from heuncli.results.results import Indices


class ReleasedBodies:
    """The tree indices of bodies that may move, in groups that share closure rows.

    coupled: closure rows of couplings

    `first` contains only the bodies around their loops.
    """

    def __init__(self, layout: Layout, coupled_rows: Iterable[int]) -> None:
        self.parents: list[int] = layout.bodies["parent"].tolist()
        loops = {owner: loop_bodies(layout, owner) for owner in dict.fromkeys(layout.rows)}
        self.loops = [loops[owner] for owner in layout.rows]
        rows = layout.tables["closures"][: len(layout.rows)]
        paths = [layout.indices[row["path"] : row["path"] + row["path_count"]] for row in rows]
        self.moved_by = [({*path, *loop}, loop) for path, loop in zip(paths, self.loops, strict=True)]
        self.first: set[int] = self._close_under_rows({i for r in coupled_rows for i in self.loops[r]})
        self.places = set(self.first)

    def widen(self, rows: Sequence[int] | Indices) -> bool:
        """Release the parents of the loops of some closure rows; return whether there is any."""
        within = self._close_under_rows({i for r in rows for i in self.loops[int(r)]})
        while True:
            grown = within | {self.parents[i] for i in within if self.parents[i] >= 0}
            if grown == within:
                return False
            within = self._close_under_rows(grown)
            if not within <= self.places:
                self.places |= within
                return True

    def find_carried(self) -> set[int]:
        """Return the bodies (tree indices) released beyond the first ones, and all bodies on them."""
        bodies = self.places - self.first
        for i, parent in enumerate(self.parents):  # a parent stands before what it carries
            if parent in bodies:
                bodies.add(i)
        return bodies

    def _close_under_rows(self, places: set[int]) -> set[int]:
        """Add all bodies around closure rows that these bodies move: a cv joint turns what its shaft carries."""
        bodies, grown = set(places), True
        while grown:
            reached = {i for movers, loop in self.moved_by if not bodies.isdisjoint(movers) for i in loop}
            grown = not reached <= bodies
            bodies |= reached
        return bodies
