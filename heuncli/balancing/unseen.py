"""Laws in the cycle's own angle: where between nodes one may do what no node has seen.

Such a law is one number of the angle, so that bounds over stretches of it hold for what was not seen, too (as those of
what is given in time do, study/search/in_time.py). Stretches in which bounds allow more than the polynomial through the
nodes shows are halved; in the middle of each the law itself is held against the polynomial.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator

import numpy as np

from heuncli import tolerances
from heuncli.balancing.nodes import PieceNodes
from heuncli.expressions.programs import CONST, KNOT, TABLE, VAR, Expression
from heuncli.named_tuples import NamedTuple
from heuncli.records import replace
from heuncli.results import Array

ALLOWED = 1e-6  # of all that a law does over the cycle: what bounds may go beyond what was seen
PLACES = np.array([0.0, 0.25, 0.5, 0.75, 1.0])  # of a stretch, at which the polynomial is looked at
BESIDE = 1e-10  # of a cycle: so near to the ends of pieces laws may be on their other side
MOST_STRETCHES = 60_000
MOST_ROUNDS = 40


class Suspects(NamedTuple):
    """Places (n,) at which laws are not what polynomials through their nodes are; undecided: laws that bounds leave."""

    places: Array
    undecided: tuple[str, ...]


def laws_of_angle(values: Iterable[Expression], joint: str, rate: float) -> Iterator[Expression]:
    """The laws that hang on a joint's angle alone, or on its rate beside it, with the angle in place of the time."""
    for value in values:
        uses = value.uses
        if uses and not value.time_dependent and all(use in ((joint, "angle"), (joint, "rate")) for use in uses):
            yield in_angle(value, rate)


def in_angle(value: Expression, rate: float) -> Expression:
    """A law in one joint's angle, and in its rate, which is held, as one of the time."""
    held, constant = [1 + k for k, use in enumerate(value.uses) if use[1] == "rate"], len(value.constants)
    code: list[int] = []
    is_data = False
    for op, argument in zip(value.code[::2], value.code[1::2], strict=True):
        if is_data or op != VAR:
            code += [op, argument]
        else:
            code += [CONST, constant] if argument in held else [VAR, 0]
        is_data = not is_data and op in (TABLE, KNOT)
    found: Expression = replace(
        value, uses=(), time_dependent=True, code=tuple(code), constants=(*value.constants, rate), held=value.held
    )
    return found


def suspects(laws: Iterable[Expression], nodes: PieceNodes) -> Suspects:
    """Where laws are to be looked at again."""
    found, undecided = [np.zeros(0)], []
    for law in laws:
        places, decided = suspects_of(law, nodes)
        found.append(places)
        if not decided:
            undecided.append(law.source.strip())
    return Suspects(np.unique(np.concatenate(found)), tuple(undecided))


def suspects_of(law: Expression, nodes: PieceNodes) -> tuple[Array, bool]:
    """Places (n,) at which a law is not what its nodes tell, and whether bounds decided that there are no others."""
    values = np.array(law.sample(nodes.angles.tolist()))
    if not np.isfinite(values).all():
        return np.zeros(0), True  # refused by those who solve it
    own = nodes.coefficients(values)
    shrunk = BESIDE * nodes.length
    a, b = nodes.begins + shrunk, nodes.ends - shrunk
    size = float(np.ptp(values))
    found: list[Array] = []
    looked = 0
    a, b = a[b > a], b[b > a]
    for _ in range(MOST_ROUNDS):
        if not len(a):
            return np.concatenate([*found, np.zeros(0)]), True
        looked += len(a)
        if looked > MOST_STRETCHES:
            break
        least, most = bounds(law, nodes, a, b)
        at = a[:, None] + (b - a)[:, None] * PLACES
        seen = nodes.at(own, at.ravel()).reshape(at.shape)
        allowed = ALLOWED * (size if size > 0.0 else float(np.abs(values).max()))
        more = ~((most <= seen.max(axis=1) + allowed) & (least >= seen.min(axis=1) - allowed))
        a, b = a[more], b[more]
        middle = 0.5 * (a + b)
        there = np.array(law.sample(angles(nodes, middle).tolist()))
        off = ~(np.abs(there - nodes.at(own, middle)[:, 0]) <= allowed)
        found.append(middle[off])
        a, middle, b = a[~off], middle[~off], b[~off]
        wide = b - a > tolerances.SIDE_BY_SIDE * nodes.length
        a, middle, b = a[wide], middle[wide], b[wide]
        a, b = np.concatenate([a, middle]), np.concatenate([middle, b])
    return np.concatenate([*found, np.zeros(0)]), False


def angles(nodes: PieceNodes, x: Array) -> Array:
    """The angles of places (n,)."""
    return np.asarray(nodes.begin + (x if nodes.sense > 0.0 else nodes.length - x))


def bounds(law: Expression, nodes: PieceNodes, a: Array, b: Array) -> tuple[Array, Array]:
    """Least and largest values of a law over stretches of places, (n,) each; not finite where there are none."""
    one, other = angles(nodes, a), angles(nodes, b)
    low, high = np.minimum(one, other), np.maximum(one, other)
    least, most = law.bounds(low.tolist(), high.tolist())
    return np.array(least), np.array(most)
