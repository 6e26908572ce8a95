"""Which bodies a start releases to meet its couplings: those around the coupled loops first, what carries them after.

A body that is placed already is not moved to spare the ones that it carries (manual/format.md, "Where bodies start"):
of two geared shafts the one without a given rate turns, and not the frame in which both stand. Only where the loop by
itself cannot meet its rows, what carries it is released, too, one body further in at a time.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence

from heuncli.multibody.tree.islands import loop_of
from heuncli.multibody.tree.layout import Layout
from heuncli.results.results import Indices


class ReleasedBodies:
    """The places in the tree of bodies that may move, in groups that share closure rows.

    coupled: closure rows that couplings ask for. `first` has the bodies around their loops alone.
    """

    def __init__(self, layout: Layout, coupled: Iterable[int]) -> None:
        self.parents: list[int] = layout.bodies["parent"].tolist()
        loops = {owner: loop_of(layout, owner) for owner in dict.fromkeys(layout.rows)}
        self.loops = [loops[owner] for owner in layout.rows]
        rows = layout.tables["closures"][: len(layout.rows)]
        paths = [layout.indices[row["path"] : row["path"] + row["path_count"]] for row in rows]
        self.moved_by = [({*path, *loop}, loop) for path, loop in zip(paths, self.loops, strict=True)]
        self.first: set[int] = self._joined({i for r in coupled for i in self.loops[r]})
        self.places = set(self.first)

    def widen(self, rows: Sequence[int] | Indices) -> bool:
        """Release what carries the loops of some closure rows; whether there is any such body."""
        within = self._joined({i for r in rows for i in self.loops[int(r)]})
        while True:
            grown = within | {self.parents[i] for i in within if self.parents[i] >= 0}
            if grown == within:
                return False
            within = self._joined(grown)
            if not within <= self.places:
                self.places |= within
                return True

    def carried(self) -> set[int]:
        """The bodies (places in the tree) on those that were released beyond the first ones, and these."""
        found = self.places - self.first
        for i, parent in enumerate(self.parents):  # a parent stands before what it carries
            if parent in found:
                found.add(i)
        return found

    def _joined(self, places: set[int]) -> set[int]:
        """The bodies with all others around closure rows that they move: a cv joint turns what its shaft carries."""
        found, grown = set(places), True
        while grown:
            met = {i for movers, loop in self.moved_by if not found.isdisjoint(movers) for i in loop}
            grown = not met <= found
            found |= met
        return found
