"""Actions on one body at given instants: name, point, source and load of each, in the body's axes.

A distributed load, linear along a line, is replaced by forces at the ends of equal pieces of the line. Each piece, q_0
at one end and q_1 at the other, is statically equal to h (2 q_0 + q_1)/6 and h (q_0 + 2 q_1)/6 there: so the section
loads are exact at the ends of all pieces, and between them off by q h^2/8 at most.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence

import numpy as np

from heuncli.analyses.load_cases.model import AccelerationField, PointAction
from heuncli.base.named_tuples import NamedTuple
from heuncli.base.records import replace
from heuncli.loads.kinetostatics.actions import Action
from heuncli.loads.kinetostatics.piece_loads import AttachedLoad, find_attachments, to_body_axes
from heuncli.multibody.mechanism.loads import GROUND
from heuncli.multibody.mechanism.model import Mechanism
from heuncli.results.results import Array
from heuncli.scene.file_format.models import Spec
from heuncli.scene.shapes.inertia import pseudo_inertia
from heuncli.study.compose.recovery import Recovery

ROUNDING = 1e-14  # of the largest component of its kind: smaller ones are rounding, written as 0
PIECE_COUNT = 10  # of the line of a distributed load
OUTSIDE = "outside"
CENTER_NAME = "center of mass"


class BodyAction(NamedTuple):
    """An action on the body over all instants.

    kind, name, source: its type, its name, and who exerts it
    attachment: where and how it acts
    is_line: whether it is distributed along a line
    """

    kind: str
    name: str
    source: str
    attachment: AttachedLoad
    is_line: bool


def collect_actions(recovery: Recovery, spec: Spec, body: int) -> list[tuple[PointAction, ...]]:
    """Return all actions on a body at each of the recovered instants."""
    body_actions = list(_iter_body_actions(recovery, spec, body))
    points = spec.bodies[recovery.setup.scene.mechanism.bodies[body].name].points
    points_by_name = {name: np.array(point) for name, point in points.items()}
    center = recovery.setup.scene.mechanism.bodies[body].center
    count = len(recovery.solutions.times)
    return [
        _merge_actions(
            [
                point_action
                for action in body_actions
                for point_action in _iter_point_actions(action, k, points_by_name, center)
            ]
        )
        for k in range(count)
    ]


def compute_fields(recovery: Recovery, body: int) -> list[AccelerationField]:
    """Return the accelerations of the body's points, and gravity, at each of the recovered instants."""
    states, gravity = recovery.states, recovery.setup.scene.mechanism.gravity
    R = states.R[:, body]
    vectors = [states.a[:, body], np.broadcast_to(gravity, (len(R), 3)), states.omega[:, body], states.alpha[:, body]]
    a, g, w, u = to_body_axes(R, np.array(vectors))
    mechanism_body = recovery.setup.scene.mechanism.bodies[body]
    P = pseudo_inertia(mechanism_body.mass, mechanism_body.center, mechanism_body.inertia)
    r = float(np.sqrt(np.trace(P[:3, :3]) / (mechanism_body.mass or 1.0)))
    return [_drop_field_rounding(AccelerationField(a[k], g[k], w[k], u[k]), r) for k in range(len(R))]


def _drop_field_rounding(field: AccelerationField, r: float) -> AccelerationField:
    """Set rounding in the field of a body that does not rotate, or moves uniformly, to 0.

    r: radius of gyration of the body
    """
    a, g, w, u = field.origin, field.gravity, field.angular_velocity, field.angular_acceleration
    threshold = ROUNDING * max(float(np.abs(x).max()) for x in (a, g, r * u, r * w * w))
    return AccelerationField(
        _drop_rounding(a, threshold),
        _drop_rounding(g, threshold),
        _drop_rounding(w, ROUNDING * float(np.abs(w).max())),
        np.where(r * np.abs(u) <= threshold, 0.0, u),
    )


def _iter_body_actions(recovery: Recovery, spec: Spec, body: int) -> Iterator[BodyAction]:
    """Yield the body's share of every action; a joint's drive and stops are separate from its constraint load."""
    mechanism, states = recovery.setup.scene.mechanism, recovery.states
    constraints_first = sorted(recovery.separate_actions, key=lambda action: action.kind == "load")
    for action in constraints_first:
        attached_ends = find_attachments(body, states, [action])
        sources = [OUTSIDE] * len(attached_ends) if action.spread else _find_sources(mechanism, action, body)
        for end, source in zip(attached_ends, sources, strict=True):
            yield BodyAction(
                _get_kind(action, spec, bool(recovery.given_actions)), action.name, source, end, bool(action.spread)
            )


def _find_sources(mechanism: Mechanism, action: Action, body: int) -> list[str]:
    """Return who exerts an action on a body, for each of its ends there."""
    if action.from_end is None:
        return [OUTSIDE] * (action.to_end.body == body)
    ends = (action.to_end.body, action.from_end.body)
    return [_get_name(mechanism, other_body) for end_body, other_body in (ends, ends[::-1]) if end_body == body]


def _get_name(mechanism: Mechanism, body: int) -> str:
    """Return the name of a body."""
    return "ground" if body == GROUND else mechanism.bodies[body].name


def _get_kind(action: Action, spec: Spec, is_impulse: bool) -> str:
    """Return the type of an action: a load's type in the spec, otherwise the action's own kind."""
    if action.kind != "load":
        return action.kind
    if is_impulse:  # a force may have the name of an impulse
        return "impulse"
    return spec.forces[action.name].type if action.name in spec.forces else "coupling"  # a belt's pretension


def _iter_point_actions(
    body_action: BodyAction, k: int, points_by_name: Mapping[str, Array], center: Array
) -> Iterator[PointAction]:
    """Yield the point actions at instant k; a distributed load acts at the ends of the pieces of its line."""
    start_point, end_point = (
        None if x is None else (x[k] if x.ndim == 2 else x)
        for x in (body_action.attachment.point, body_action.attachment.line_end)
    )
    assert start_point is not None
    force, moment = body_action.attachment.force[k], body_action.attachment.moment[k]
    labels = body_action.kind, body_action.name, body_action.source
    if end_point is None:
        yield PointAction(*labels, _find_point_name(start_point, points_by_name, center), start_point, force, moment)
        return
    line = end_point - start_point
    densest = force / (0.5 * float(np.sqrt(line @ line)))
    for end, force_share, density in zip(_divide_line(start_point, end_point), *_triangle_shares(), strict=True):
        yield PointAction(
            *labels, _find_point_name(end, points_by_name, center), end, force_share * force, moment, density * densest
        )


def _divide_line(start: Array, end: Array) -> list[Array]:
    """Return points from start to end, equal to the last bit to those in the opposite direction, so that loads from
    either end add up there.
    """
    is_ascending = start.tolist() <= end.tolist()
    low, high = (start, end) if is_ascending else (end, start)
    points = [low, *(low + (i / PIECE_COUNT) * (high - low) for i in range(1, PIECE_COUNT)), high]
    return points if is_ascending else points[::-1]


def _triangle_shares() -> tuple[Array, Array]:
    """Return shares of the force, at the ends of the pieces, of a load that decreases linearly to zero, and its density
    relative to the density 2 F/l at the start.
    """
    q = np.linspace(1.0, 0.0, PIECE_COUNT + 1)
    shares = np.zeros(PIECE_COUNT + 1)
    shares[:-1] += (2.0 * q[:-1] + q[1:]) / (3.0 * PIECE_COUNT)
    shares[1:] += (q[:-1] + 2.0 * q[1:]) / (3.0 * PIECE_COUNT)
    return shares, q


def _find_point_name(position: Array, points_by_name: Mapping[str, Array], center: Array) -> str:
    """Return the name of the body's point at a position, or an empty string."""
    point_name = next((name for name, point in points_by_name.items() if np.array_equal(point, position)), "")
    return point_name or (CENTER_NAME if np.array_equal(center, position) else "")


def _merge_actions(actions: Sequence[PointAction]) -> tuple[PointAction, ...]:
    """Drop actions without effect, and merge what a distributed load does at one place."""
    merged: dict[tuple[str, ...], PointAction] = {}
    for action in actions:
        key = (action.kind, action.name, action.source, *map(repr, action.at.tolist()))
        if action.per_length is None or key not in merged:
            key = (*key, str(len(merged))) if action.per_length is None else key
            merged[key] = action
            continue
        earlier = merged[key]
        assert earlier.per_length is not None
        merged[key] = replace(
            action, force=action.force + earlier.force, moment=action.moment + earlier.moment,
            per_length=action.per_length + earlier.per_length,
        )  # fmt: skip
    all_actions = list(merged.values())
    force, moment, reach = (_find_largest(all_actions, of) for of in ("force", "moment", "at"))
    thresholds = ROUNDING * force, ROUNDING * max(moment, force * reach)
    # copies, as the caller may change the arrays of a case
    cleaned = [
        replace(
            action,
            at=action.at.copy(),
            force=_drop_rounding(action.force, thresholds[0]),
            moment=_drop_rounding(action.moment, thresholds[1]),
        )
        for action in all_actions
    ]
    return tuple(action for action in cleaned if action.force.any() or action.moment.any() or action.kind == "joint")


def _find_largest(actions: Sequence[PointAction], field_name: str) -> float:
    """Return the largest component of a field over all actions."""
    return max((float(np.abs(getattr(action, field_name)).max()) for action in actions), default=0.0)


def _drop_rounding(vector: Array, threshold: float) -> Array:
    """Return a vector with 0 in place of components below a threshold."""
    return np.where(np.abs(vector) <= threshold, 0.0, vector)
