"""What acts on one body at some instants, each action with its name, its point and who exerts it, in the body's axes.

A distributed load, linear along a line, stands as forces at the ends of equal pieces of it. Each piece, q_0 at one end
and q_1 at the other, is statically equal to h (2 q_0 + q_1)/6 and h (q_0 + 2 q_1)/6 there: so the section loads are
exact at the ends of all pieces, and between them off by q h^2/8 at most.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence

import numpy as np

from heuncli.analyses.load_cases.model import AccelerationField, PointAction
from heuncli.base.named_tuples import NamedTuple
from heuncli.base.records import replace
from heuncli.loads.kinetostatics.actions import Action
from heuncli.loads.kinetostatics.sections import Attachment, attachments, in_body_axes
from heuncli.multibody.mechanism.model import GROUND, Mechanism
from heuncli.results.results import Array
from heuncli.scene.file_format.models import Spec
from heuncli.scene.shapes.inertia import pseudo_inertia
from heuncli.study.compose.recovery import Recovery

ROUNDING = 1e-14  # of the largest component of its kind: what is less stands for nothing, and is written as 0
PIECES = 10  # of the line of a distributed load
OUTSIDE = "outside"
CENTER = "center of mass"


class OneAction(NamedTuple):
    """An action's attachment to the body, over the instants, and its words."""

    kind: str
    name: str
    by: str
    on: Attachment
    is_line: bool


def actions_on(recovery: Recovery, spec: Spec, body: int) -> list[tuple[PointAction, ...]]:
    """All that acts on a body at each of the recovered instants."""
    attached = list(_attached(recovery, spec, body))
    points = spec.bodies[recovery.setup.scene.mechanism.bodies[body].name].points
    named = {name: np.array(point) for name, point in points.items()}
    center = recovery.setup.scene.mechanism.bodies[body].center
    count = len(recovery.recovered.times)
    return [_tidy([one for own in attached for one in _at(own, k, named, center)]) for k in range(count)]


def fields_of(recovery: Recovery, body: int) -> list[AccelerationField]:
    """How the body's points are accelerated at each of the recovered instants, and what gravity does."""
    states, gravity = recovery.states, recovery.setup.scene.mechanism.gravity
    R = states.R[:, body]
    vectors = [states.a[:, body], np.broadcast_to(gravity, (len(R), 3)), states.omega[:, body], states.alpha[:, body]]
    a, g, w, u = in_body_axes(R, np.array(vectors))
    own = recovery.setup.scene.mechanism.bodies[body]
    P = pseudo_inertia(own.mass, own.center, own.inertia)
    r = float(np.sqrt(np.trace(P[:3, :3]) / own.mass))
    return [_tidy_field(AccelerationField(a[k], g[k], w[k], u[k]), r) for k in range(len(R))]


def _tidy_field(field: AccelerationField, r: float) -> AccelerationField:
    """The field without what rounding makes of a body that does not turn, or not so; r: how far its masses lie."""
    a, g, w, u = field.origin, field.gravity, field.angular_velocity, field.angular_acceleration
    least = ROUNDING * max(float(np.abs(x).max()) for x in (a, g, r * u, r * w * w))
    return AccelerationField(
        _cut(a, least), _cut(g, least), _cut(w, ROUNDING * float(np.abs(w).max())),
        np.where(r * np.abs(u) <= least, 0.0, u),
    )  # fmt: skip


def _attached(recovery: Recovery, spec: Spec, body: int) -> Iterator[OneAction]:
    """The body's share of every action; a joint's drive and stops beside what its constraint carries."""
    mechanism, states = recovery.setup.scene.mechanism, recovery.states
    for action in sorted(recovery.standing, key=lambda own: own.kind == "load"):  # what holds it comes first
        on = attachments(body, states, [action])
        by = [OUTSIDE] * len(on) if action.spread else _exerted_by(mechanism, action, body)
        for own, other in zip(on, by, strict=True):
            yield OneAction(_kind(action, spec, bool(recovery.given)), action.name, other, own, bool(action.spread))


def _exerted_by(mechanism: Mechanism, action: Action, body: int) -> list[str]:
    """Who exerts an action on a body, for each of its ends there."""
    if action.from_ is None:
        return [OUTSIDE] * (action.to.body == body)
    ends = (action.to.body, action.from_.body)
    return [_name(mechanism, other) for own, other in (ends, ends[::-1]) if own == body]


def _name(mechanism: Mechanism, body: int) -> str:
    return "ground" if body == GROUND else mechanism.bodies[body].name


def _kind(action: Action, spec: Spec, struck: bool) -> str:
    """The word for an action: that of its type in the spec, of what is no load its own."""
    if action.kind != "load":
        return action.kind
    if struck:  # a force may have the name of a blow
        return "impulse"
    return spec.forces[action.name].type if action.name in spec.forces else "coupling"  # a belt's pretension


def _at(own: OneAction, k: int, named: Mapping[str, Array], center: Array) -> Iterator[PointAction]:
    """What it does at an instant; of a distributed load at the ends of the pieces of its line."""
    at, to = (None if x is None else (x[k] if x.ndim == 2 else x) for x in (own.on.at, own.on.to))
    assert at is not None
    force, moment = own.on.force[k], own.on.moment[k]
    words = own.kind, own.name, own.by
    if to is None:
        yield PointAction(*words, _point_at(at, named, center), at, force, moment)
        return
    run = to - at
    densest = force / (0.5 * float(np.sqrt(run @ run)))
    for end, share, density in zip(_ends_of_pieces(at, to), *_falling(), strict=True):
        yield PointAction(*words, _point_at(end, named, center), end, share * force, moment, density * densest)


def _ends_of_pieces(at: Array, to: Array) -> list[Array]:
    """Points from `at` to `to`, to the last bit those from `to` to `at`: loads from either end are summed up there."""
    forth = at.tolist() <= to.tolist()
    low, high = (at, to) if forth else (to, at)
    points = [low, *(low + (i / PIECES) * (high - low) for i in range(1, PIECES)), high]
    return points if forth else points[::-1]


def _falling() -> tuple[Array, Array]:
    """Of a force that falls evenly along its line to nothing: its shares at the ends of the pieces, and its density.

    Of the density at the beginning, which is 2 F/l.
    """
    q = np.linspace(1.0, 0.0, PIECES + 1)
    shares = np.zeros(PIECES + 1)
    shares[:-1] += (2.0 * q[:-1] + q[1:]) / (3.0 * PIECES)
    shares[1:] += (q[:-1] + 2.0 * q[1:]) / (3.0 * PIECES)
    return shares, q


def _point_at(at: Array, named: Mapping[str, Array], center: Array) -> str:
    """The name of the body's point that is there, or nothing."""
    found = next((name for name, point in named.items() if np.array_equal(point, at)), "")
    return found or (CENTER if np.array_equal(center, at) else "")


def _tidy(actions: Sequence[PointAction]) -> tuple[PointAction, ...]:
    """The actions without those that do nothing; of a distributed load what acts at one place together."""
    together: dict[tuple[str, ...], PointAction] = {}
    for one in actions:
        key = (one.kind, one.name, one.by, *map(repr, one.at.tolist()))
        if one.per_length is None or key not in together:
            key = (*key, str(len(together))) if one.per_length is None else key
            together[key] = one
            continue
        other = together[key]
        assert other.per_length is not None
        together[key] = replace(
            one, force=one.force + other.force, moment=one.moment + other.moment,
            per_length=one.per_length + other.per_length,
        )  # fmt: skip
    found = list(together.values())
    force, moment, reach = (_largest(found, of) for of in ("force", "moment", "at"))
    least = ROUNDING * force, ROUNDING * max(moment, force * reach)
    # none of it the scene's own arrays: whoever is given a case may change it
    kept = [
        replace(one, at=one.at.copy(), force=_cut(one.force, least[0]), moment=_cut(one.moment, least[1]))
        for one in found
    ]
    return tuple(one for one in kept if one.force.any() or one.moment.any() or one.kind == "joint")


def _largest(actions: Sequence[PointAction], of: str) -> float:
    return max((float(np.abs(getattr(one, of)).max()) for one in actions), default=0.0)


def _cut(vector: Array, least: float) -> Array:
    return np.where(np.abs(vector) <= least, 0.0, vector)
