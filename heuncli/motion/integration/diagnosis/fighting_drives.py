"""Find drives that require of coupled joints what the couplings do not allow. Imported only for an error.

sum of factor q' = 0    and the same of q'', for each sum of couplings' conditions whose coordinates are all driven
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence

import numpy as np

from heuncli.base import tolerances
from heuncli.base.errors import Problem
from heuncli.motion.integration.contacts.shared_impulses import join_names
from heuncli.multibody.mechanism.couplings import Coordinate, Coupling
from heuncli.multibody.mechanism.model import Mechanism
from heuncli.results.results import Array


def find_fighting_drives(mechanism: Mechanism, t: float, start_time: float) -> Problem | None:
    """Return the problem of drives that couplings hold against each other at an instant t [s]; start_time: the
    reported start.
    """
    relations = [
        (coupling, coordinates)
        for coupling in mechanism.couplings
        for coordinates in iter_relations(mechanism, coupling)
    ]
    keys = list(dict.fromkeys((x.joint, x.quantity) for _, coordinates in relations for x in coordinates))
    factors = np.zeros((len(relations), len(keys)))
    for row, (_, coordinates) in enumerate(relations):
        for x in coordinates:
            factors[row, keys.index((x.joint, x.quantity))] += x.ratio
    drives = [mechanism.joints[joint].drive for joint, _ in keys]
    for weights in eliminate(factors, [drive is None for drive in drives]):
        terms = weights @ factors
        acting = [(drive, term) for drive, term in zip(drives, terms, strict=True) if drive is not None and term != 0.0]
        rates = np.array([[term * rate for rate in drive.value.derivatives(t)[1:3]] for drive, term in acting])
        if len(acting) > 1 and np.any(np.abs(rates.sum(0)) > tolerances.DRIVES_DISAGREE * np.abs(rates).max(0)):
            couplings = [coupling for (coupling, _), weight in zip(relations, weights, strict=True) if weight != 0.0]
            return make_problem(list(dict.fromkeys(couplings)), [drive.name for drive, _ in acting], start_time)
    return None


def eliminate(factors: Array, is_free: Sequence[bool]) -> Iterator[Array]:
    """Yield the weights of sums of rows (n, m) in which no free column is left, the shortest first."""
    sums, weights = factors.copy(), np.eye(len(factors))
    scale = tolerances.DRIVES_DISAGREE * np.abs(factors).max(initial=0.0)
    for column in np.flatnonzero(is_free):
        if not len(sums):
            return
        pivot = int(np.argmax(np.abs(sums[:, column])))
        if abs(sums[pivot, column]) <= scale:
            continue
        ratio = sums[:, column] / sums[pivot, column]
        sums, weights = sums - np.outer(ratio, sums[pivot]), weights - np.outer(ratio, weights[pivot])
        sums, weights = np.delete(sums, pivot, 0), np.delete(weights, pivot, 0)
    yield from sorted(weights, key=np.count_nonzero)


def make_problem(couplings: Sequence[Coupling], drives: Sequence[str], t: float) -> Problem:
    """Make the problem, with the couplings and their drives."""
    texts = [f"{coupling.name} ({coupling.entry.type})" for coupling in couplings]
    coupling_text = f"coupling {texts[0]}" if len(texts) == 1 else f"the couplings {join_names(texts)}"
    message = f"at t = {t:.9g} s the drives {join_names(drives)} begin to violate {coupling_text}"
    hint = "leave out one of them: its joint follows the couplings"
    return Problem("rates-do-not-fit", message, hint=hint, entry_path=f"couplings.{couplings[0].name}")


def iter_relations(mechanism: Mechanism, coupling: Coupling) -> Iterator[Sequence[Coordinate]]:
    """Yield, for each condition of a coupling with fixed ratios, its coordinates with their factors."""
    if coupling.entry.type == "ratio":
        places = {joint.name: k for k, joint in enumerate(mechanism.joints)}
        yield [Coordinate(places[term.joint], term.quantity, term.factor) for term in coupling.entry.terms]
        return
    for row in coupling.rows:
        if all(part.kind in ("turn", "mesh") for part in row.parts):
            yield [x._replace(ratio=part.factor * x.ratio) for part in row.parts for x in part.coordinates]
