"""Coordinates that a gear, a thread or a belt ties to one another: none of them goes farther than all the others do.

A spindle turns many times before its nut has come to its spring, and a pinion before its wheel has.
"""

from __future__ import annotations

from heuncli.base.records import record
from heuncli.multibody.tree.layout import Layout
from heuncli.results.results import Array, Indices
from heuncli.scene.file_format.couplings import Belt, Gear, Ratio, Screw


@record
class Tied:
    """Pairs of coordinates, by their numbers among those of a scene, each of which moves exactly as the other does."""

    pairs: tuple[tuple[int, int], ...]

    def least(self, far: Array) -> Array:
        """How far each has come (n,), and what it is tied to: the least of them."""
        found = far.copy()
        for _ in self.pairs:  # along a train from its one end to the other
            for one, other in self.pairs:
                found[one] = found[other] = min(found[one], found[other])
        return found


def tied(layout: Layout, freedoms: Indices, numbers: Indices) -> Tied:
    """The pairs of a scene: what a coupling of just two coordinates ties; freedoms, numbers (k,): as Coordinates."""
    number = dict(zip(freedoms.tolist(), numbers.tolist(), strict=True))
    named = {(f.joint, f.quantity): number[i] for i, f in enumerate(layout.freedoms) if i in number}
    joints = {joint.name: k for k, joint in enumerate(layout.mechanism.joints)}
    pairs = []
    for coupling in layout.mechanism.couplings:
        if isinstance(coupling.given, Ratio):
            of = [(joints[x.joint], x.quantity) for x in coupling.given.terms]
        elif isinstance(coupling.given, Gear | Screw | Belt):
            of = [(x.joint, x.quantity) for row in coupling.rows for part in row.parts for x in part.coordinates]
        else:
            continue
        own = [named[x] for x in of if x in named]
        if len(of) == len(own) == 2:
            pairs.append((own[0], own[1]))
    return Tied(tuple(pairs))
