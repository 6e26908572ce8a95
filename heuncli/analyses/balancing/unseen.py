"""Laws in the cycle's own angle: where between nodes one may do what no node has seen.

Such a law is one number of the angle, so that bounds over stretches of it hold for what was not seen, too (as those of
what is given in time do, study/search/in_time.py). Stretches in which bounds allow more than the polynomial through the
nodes shows are halved; in the middle of each the law itself is held against the polynomial.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator

import numpy as np

from heuncli.analyses.balancing.nodes import PieceNodes
from heuncli.base import tolerances
from heuncli.base.named_tuples import NamedTuple
from heuncli.base.records import replace
from heuncli.results.results import Array
from heuncli.scene.expressions.composed import JUMPS
from heuncli.scene.expressions.programs import CONST, HOLD, KNOT, TABLE, VAR, Expression

ALLOWED = 1e-6  # of all that a law does over the cycle: what bounds may go beyond what was seen
PLACES = np.array([0.0, 0.25, 0.5, 0.75, 1.0])  # of a stretch, at which the polynomial is looked at
BESIDE = 1e-10  # of a cycle: so near to the ends of pieces laws may be on their other side
LATER = 1e-2  # of the most that any stretch may hide: those that may hide less are looked at later; and of what one
# may hide: a place that shows less of it is not yet where it is
MOST_STRETCHES = 60_000


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
    """A law in one joint's angle, and in its rate, which is held, as one of the time; its branches are not held."""
    steady, constant = [1 + k for k, use in enumerate(value.uses) if use[1] == "rate"], len(value.constants)
    pairs = list(zip(value.code[::2], value.code[1::2], strict=True))
    is_data = [False] * (len(pairs) + 1)
    for i, (op, _) in enumerate(pairs):
        is_data[i + 1] = not is_data[i] and op in (TABLE, KNOT)
    holds = [op == HOLD and not data for (op, _), data in zip(pairs, is_data, strict=False)]
    at = [i - sum(holds[:i]) for i in range(len(pairs) + 1)]  # where each instruction comes to stand
    code: list[int] = []
    for i, (op, k) in enumerate(pairs):
        if holds[i]:
            continue
        if not is_data[i] and op == VAR:
            op, k = (CONST, constant) if k in steady else (VAR, 0)
        elif not is_data[i] and op in JUMPS:
            k = at[i + 1 + k] - at[i + 1]
        code += [op, k]
    found: Expression = replace(
        value, uses=(), time_dependent=True, code=tuple(code), constants=(*value.constants, rate), held=()
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
    a, b = a[b > a], b[b > a]
    more = excess(law, nodes, own, a, b)
    size, found, looked = float(np.ptp(values)), [np.zeros(0)], 0
    while len(a):
        # those that may hide most are looked at first: what they hide tells what is small beside it
        now = ~(more <= LATER * more.max()) | ~np.isfinite(more)
        looked += int(now.sum())
        if looked > MOST_STRETCHES:
            return np.concatenate(found), False
        middle = 0.5 * (a[now] + b[now])
        off = np.abs(np.array(law.sample(angles(nodes, middle).tolist())) - nodes.at(own, middle)[:, 0])
        size = max(size, float(off.max(initial=0.0)))
        seen = (off > ALLOWED * size) & (off > LATER * more[now])
        found.append(middle[seen])
        left, right = a[now][~seen], b[now][~seen]
        wide = right - left > tolerances.SIDE_BY_SIDE * nodes.length
        left, middle, right = left[wide], middle[~seen][wide], right[wide]
        fresh_a, fresh_b = np.concatenate([left, middle]), np.concatenate([middle, right])
        fresh = excess(law, nodes, own, fresh_a, fresh_b)
        a, b = np.concatenate([a[~now], fresh_a]), np.concatenate([b[~now], fresh_b])
        more = np.concatenate([more[~now], fresh])
        counts = ~(more <= ALLOWED * size) if size > 0.0 else more > 0.0
        a, b, more = a[counts], b[counts], more[counts]
    return np.concatenate(found), True


def excess(law: Expression, nodes: PieceNodes, own: Array, a: Array, b: Array) -> Array:
    """By how much a law may go beyond what its polynomials show of it over stretches, (n,)."""
    if not len(a):
        return np.zeros(0)
    least, most = bounds(law, nodes, a, b)
    at = a[:, None] + (b - a)[:, None] * PLACES
    seen = nodes.at(own, at.ravel()).reshape(at.shape)
    found = np.maximum(most - seen.max(axis=1), seen.min(axis=1) - least)
    return np.asarray(np.where(np.isnan(found), np.inf, found))


def angles(nodes: PieceNodes, x: Array) -> Array:
    """The angles of places (n,)."""
    return np.asarray(nodes.begin + (x if nodes.sense > 0.0 else nodes.length - x))


def bounds(law: Expression, nodes: PieceNodes, a: Array, b: Array) -> tuple[Array, Array]:
    """Least and largest values of a law over stretches of places, (n,) each; not finite where there are none."""
    one, other = angles(nodes, a), angles(nodes, b)
    low, high = np.minimum(one, other), np.maximum(one, other)
    least, most = law.bounds(low.tolist(), high.tolist())
    return np.array(least), np.array(most)
