"""Drives that ask of the joints of one coupling for what it does not allow. Imported only for an error.

sum of factor q' = 0    and the same of q'', of a coupling whose coordinates are all of them driven in time
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence

from heuncli.base import tolerances
from heuncli.base.errors import Problem
from heuncli.multibody.mechanism.couplings import Coordinate, Coupling
from heuncli.multibody.mechanism.model import Mechanism


def fighting(mechanism: Mechanism, t: float, from_: float) -> Problem | None:
    """The problem of drives that a coupling holds against each other at an instant t [s]; from_: since when, told."""
    for coupling in mechanism.couplings:
        for coordinates in relations(mechanism, coupling):
            driven = [mechanism.joints[own.joint].drive for own in coordinates]
            drives = [drive for drive in driven if drive is not None]
            if len(drives) < max(2, len(driven)):
                continue
            jets = [drive.value.derivatives(t)[1:] for drive in drives]
            terms = [[own.ratio * jet[k] for own, jet in zip(coordinates, jets, strict=True)] for k in range(2)]
            if any(abs(sum(own)) > tolerances.PARTED * max(map(abs, own)) for own in terms):
                return told(mechanism, coupling, [drive.name for drive in drives], from_)
    return None


def told(mechanism: Mechanism, coupling: Coupling, drives: Sequence[str], t: float) -> Problem:
    """The problem, with the coupling and its drives."""
    names = f"{', '.join(drives[:-1])} and {drives[-1]}"
    what = f"coupling {coupling.name} ({coupling.given.type})"
    message = f"at t = {t:.9g} s the drives {names} begin to ask for what {what} does not allow together"
    hint = "leave out one of them: its joint follows the coupling"
    return Problem("rates-do-not-fit", message, hint=hint, about=f"couplings.{coupling.name}")


def relations(mechanism: Mechanism, coupling: Coupling) -> Iterator[Sequence[Coordinate]]:
    """The coordinates that a coupling holds in fixed ratios, with their factors; of each such condition."""
    if coupling.given.type == "ratio":
        places = {joint.name: k for k, joint in enumerate(mechanism.joints)}
        yield [Coordinate(places[term.joint], term.quantity, term.factor) for term in coupling.given.terms]
        return
    for row in coupling.rows:
        if all(part.kind in ("turn", "mesh") for part in row.parts):
            yield [x._replace(ratio=part.factor * x.ratio) for part in row.parts for x in part.coordinates]
