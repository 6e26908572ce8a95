"""Estimate the errors of loads and energy of a motion from what was collected of the differences between its runs.

The kinds of errors, and what each is relative to: load_errors.py.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from heuncli.base import tolerances
from heuncli.results.path_words import BY_CAUSE
from heuncli.results.results import ErrorEstimate
from heuncli.results.results_schema import IMPULSES
from heuncli.study.model.setup import Setup
from heuncli.study.solve.error_extents import ESTIMATED, MOTION_KINDS, Extent, Weights, relative_error

UNITS = {"force": "N", "moment": "N·m", "place": "m", "angle": "rad"}

# Kinds, and the reports that show them: kinds that are not requested are not compared.
REPORTS_OF_KIND = {
    "reactions": {"joints", "foundation"},
    "foundation": {"foundation"},
    "sections": {"sections"},
    "forces": {"forces"},
    "motion": {"motion", "points", "forces", IMPULSES},
    "energy": {"energy", IMPULSES},
}


class ErrorEstimates:
    """The extents of all quantities by kind, for the kinds that are requested, and the errors that follow from them.

    compared: the kinds
    reach: of the centre of mass that is farthest from the point that the foundation's moment is about
    """

    def __init__(self, setup: Setup, weights: Weights = ESTIMATED) -> None:
        self.setup, self.weights = setup, weights
        self.compared = frozenset(
            kind for kind, reports in REPORTS_OF_KIND.items() if reports & setup.selection.reports
        )
        self.extents: dict[tuple[str, str], Extent] = {}
        self.reach = 0.0

    def find_extent(self, kind: str, quantity: str) -> Extent:
        """Return what is collected of a quantity of a kind."""
        return self.extents.setdefault((kind, quantity), Extent(self.weights))

    def estimate(self) -> ErrorEstimate:
        """Return the estimated error of each requested kind, relative to its largest result."""
        size, found = self.setup.scene.layout.size, ErrorEstimate()
        if "reactions" in self.compared:
            found["reactions"] = self.relative_wrench_error(size, "reactions")
            found["drives"] = max(
                self.relative_wrench_error(1.0, "drives", "thrust", ""),
                self.relative_wrench_error(1.0, "drives", "", "torque"),
            )
        if "foundation" in self.compared:
            found["foundation"] = self.relative_wrench_error(
                size + self.reach, "foundation", other_kinds=("effects", "elements")
            )
        if "sections" in self.compared:
            found["sections"] = self.relative_wrench_error(size, "sections")
        if "energy" in self.compared:
            found["energy"] = self.relative_energy_error()
        return found

    def errors(self) -> dict[tuple[str, str], float]:
        """Return the estimated errors by kind and unit, before the horizon."""
        error_by_name = {name: extent.claimed_error for name, extent in self.extents.items()}
        found = {
            name: error
            for name, error in error_by_name.items()
            if name[0] in (*MOTION_KINDS, "forces", "strains", "travels", "axis")
        }
        foundation_kinds = ("foundation", "effects", "elements")
        for kind, parts in (
            ("reactions", ("reactions",)),
            ("sections", ("sections",)),
            ("foundation", foundation_kinds),
        ):
            for quantity, unit in (("force", "N"), ("moment", "N·m")):
                found[kind, unit] = max(error_by_name.get((part, quantity), 0.0) for part in parts)
        found |= {
            ("reactions", UNITS[x]): error_by_name["reactions", x]
            for x in ("place", "angle")
            if ("reactions", x) in error_by_name
        }
        found["drives", "N"], found["drives", "N·m"] = (
            error_by_name.get(("drives", x), 0.0) for x in ("thrust", "torque")
        )
        found["energy", "J"] = max(
            error_by_name.get(("energy", name), 0.0) for name in ("kinetic", "potential", "work")
        )
        return found | self.errors_by_cause()

    def errors_by_cause(self) -> dict[tuple[str, str], float]:
        """Return the estimated errors of shares by cause, by kind and unit, before the horizon."""
        units = {"force": "N", "moment": "N·m"}
        extents = {name: extent for name, extent in self.extents.items() if name[0].endswith(BY_CAUSE)}
        return {(kind, units[name]): extent.claimed_error for (kind, name), extent in extents.items()}

    def relative_wrench_error(
        self, arm: float, kind: str, force: str = "force", moment: str = "moment", other_kinds: Sequence[str] = ()
    ) -> float:
        """The relative error of forces and moments of a kind, together with those of other kinds; arm: the longest of a
        moment.
        """
        if not other_kinds and not {(kind, force), (kind, moment)} & self.extents.keys():
            return 0.0
        size = self.setup.scene.layout.size
        F, M = self.find_extent(kind, force), self.find_extent(kind, moment)
        parts = [(F, M), *((self.find_extent(other, force), self.find_extent(other, moment)) for other in other_kinds)]
        terms_F, terms_M = max(f.terms for f, _ in parts), max(m.terms for _, m in parts)
        forces = [
            max(F.largest_requested, M.largest_requested / arm),
            *(max(f.largest, m.largest / arm) for f, m in parts),
        ]
        moments = [
            max(M.largest_requested, F.largest_requested * size),
            *(max(m.largest, f.largest * size) for f, m in parts),
        ]
        return max(
            relative_error(max(f.error for f, _ in parts), max(terms_F, terms_M / arm), *forces),
            relative_error(max(m.error for _, m in parts), max(terms_M, terms_F * size), *moments),
        )

    def relative_energy_error(self) -> float:
        """The relative error of the energies."""
        mechanism, size = self.setup.scene.mechanism, self.setup.scene.layout.size
        kinetic, potential, work = (self.find_extent("energy", name) for name in ("kinetic", "potential", "work"))
        lift = sum(b.mass for b in mechanism.bodies) * float(np.abs(mechanism.gravity).max()) * size
        if kinetic.largest <= tolerances.NO_ENERGY * lift:
            return 0.0
        error = max(x.error for x in (kinetic, potential, work))
        shown_energy = max(kinetic.largest_requested, potential.range_or_largest, work.range_or_largest)
        return relative_error(error, kinetic.largest, shown_energy, kinetic.largest)

    def largest_kinetic_energy(self) -> float:
        """The largest kinetic energy over the run [J]."""
        return self.find_extent("energy", "kinetic").largest
