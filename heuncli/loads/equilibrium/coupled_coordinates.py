"""Find coordinates that a gear, a thread or a belt couples, so that none of them counts as farther than the others.

A spindle turns many times before its nut reaches its spring, and a pinion before its wheel does.
"""

from __future__ import annotations

from heuncli.base.records import record
from heuncli.multibody.tree.layout import Layout
from heuncli.results.results import Array, Indices
from heuncli.scene.file_format.couplings import Belt, Gear, Ratio, Screw


@record
class CoupledPairs:
    """Pairs of coordinates, by their numbers in the scene, each of which moves exactly as the other does."""

    pairs: tuple[tuple[int, int], ...]

    def take_minimum(self, distances: Array) -> Array:
        """Return for each coordinate (n,) the smallest distance of itself and all that it is coupled to."""
        minima = distances.copy()
        for _ in self.pairs:  # along a train from its one end to the other
            for one, other in self.pairs:
                minima[one] = minima[other] = min(minima[one], minima[other])
        return minima


def find_coupled_pairs(layout: Layout, freedoms: Indices, numbers: Indices) -> CoupledPairs:
    """Find the pairs of a scene: coordinates of couplings between just two; freedoms, numbers (k,): as in
    Coordinates.
    """
    number = dict(zip(freedoms.tolist(), numbers.tolist(), strict=True))
    named = {(f.joint, f.quantity): number[i] for i, f in enumerate(layout.freedoms) if i in number}
    joints = {joint.name: k for k, joint in enumerate(layout.mechanism.joints)}
    pairs = []
    for coupling in layout.mechanism.couplings:
        if isinstance(coupling.entry, Ratio):
            coupled = [(joints[x.joint], x.quantity) for x in coupling.entry.terms]
        elif isinstance(coupling.entry, Gear | Screw | Belt):
            coupled = [(x.joint, x.quantity) for row in coupling.rows for part in row.parts for x in part.coordinates]
        else:
            continue
        undriven = [named[x] for x in coupled if x in named]
        if len(coupled) == len(undriven) == 2:
            pairs.append((undriven[0], undriven[1]))
    return CoupledPairs(tuple(pairs))
