"""Find drives that require of the joints of one coupling what it does not allow. Imported only for an error.

sum of factor q' = 0    and the same of q'', of a coupling whose coordinates are all driven in time
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence

from heuncli.base import tolerances
from heuncli.base.errors import Problem
from heuncli.multibody.mechanism.couplings import Coordinate, Coupling
from heuncli.multibody.mechanism.model import Mechanism


def find_fighting_drives(mechanism: Mechanism, t: float, start_time: float) -> Problem | None:
    """Return the problem of drives that a coupling holds against each other at an instant t [s]; start_time: the
    reported start.
    """
    for coupling in mechanism.couplings:
        for coordinates in iter_relations(mechanism, coupling):
            driven = [mechanism.joints[coordinate.joint].drive for coordinate in coordinates]
            drives = [drive for drive in driven if drive is not None]
            if len(drives) < max(2, len(driven)):
                continue
            jets = [drive.value.derivatives(t)[1:] for drive in drives]
            terms = [
                [coordinate.ratio * jet[k] for coordinate, jet in zip(coordinates, jets, strict=True)] for k in range(2)
            ]
            if any(
                abs(sum(coordinate)) > tolerances.DRIVES_DISAGREE * max(map(abs, coordinate)) for coordinate in terms
            ):
                return make_problem(mechanism, coupling, [drive.name for drive in drives], start_time)
    return None


def make_problem(mechanism: Mechanism, coupling: Coupling, drives: Sequence[str], t: float) -> Problem:
    """Make the problem, with the coupling and its drives."""
    names = f"{', '.join(drives[:-1])} and {drives[-1]}"
    coupling_text = f"coupling {coupling.name} ({coupling.entry.type})"
    message = f"at t = {t:.9g} s the drives {names} begin to violate {coupling_text}"
    hint = "leave out one of them: its joint follows the coupling"
    return Problem("rates-do-not-fit", message, hint=hint, entry_path=f"couplings.{coupling.name}")


def iter_relations(mechanism: Mechanism, coupling: Coupling) -> Iterator[Sequence[Coordinate]]:
    """Yield, for each condition of a coupling with fixed ratios, its coordinates with their factors."""
    if coupling.entry.type == "ratio":
        places = {joint.name: k for k, joint in enumerate(mechanism.joints)}
        yield [Coordinate(places[term.joint], term.quantity, term.factor) for term in coupling.entry.terms]
        return
    for row in coupling.rows:
        if all(part.kind in ("turn", "mesh") for part in row.parts):
            yield [x._replace(ratio=part.factor * x.ratio) for part in row.parts for x in part.coordinates]
