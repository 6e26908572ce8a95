"""What a model of MuJoCo's has and a spec does not: one row each, told with the names and the first place.

A row finds the parts that have it. What changes no number of a spec's results (cameras, materials, sensors, the setting
of the solver) is in no row.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator
from typing import Any

import numpy as np

from heuncli.base.errors import Problem, SourceLocation
from heuncli.base.named_tuples import NamedTuple
from heuncli.base.nearest import listed
from heuncli.scene.importers.described import LEFT_OUT
from heuncli.scene.importers.mjcf.compiled import Compiled
from heuncli.scene.importers.mjcf.loads import by_motor, is_tendon_spring

MOST_NAMES = 6
DEFAULT_SOLREF = (0.02, 1.0)
DEFAULT_SOLIMP = (0.9, 0.95, 0.001, 0.5, 2.0)
MOST_GROUPS = 3000  # of geoms that are looked at in pairs


class WithoutCounterpart(NamedTuple):
    """One thing without counterpart. kind: of the parts that have it; has: their numbers; hint: what there is."""

    kind: str
    has: Callable[[Compiled], Iterable[int]]
    what: str
    hint: str


def without_counterpart(c: Compiled, rods: frozenset[int], limits: bool, free: bool) -> Iterator[Problem]:
    """All that is left out of the spec; rods: the tendons that are in it."""
    for row in ROWS:
        yield from _problem(c, row, row.has(c))
    acting = [tendon for tendon in _acting(c) if tendon not in rods]
    yield from _problem(c, TENDONS, (tendon for tendon in acting if not is_tendon_spring(c, tendon)))
    yield from _problem(c, TENDON_SPRINGS, (tendon for tendon in acting if is_tendon_spring(c, tendon)))
    if limits:
        yield from _problem(c, BALL_LIMITS, _where(c, c.model.jnt_limited, _of_type(c, "mjJNT_BALL")))
    if not free:
        yield from _problem(c, SHARED_WEIGHTS, _shared_weights(c))
    yield from _whole(c)


def _problem(c: Compiled, row: WithoutCounterpart, numbers: Iterable[int]) -> Iterator[Problem]:
    found = sorted(set(numbers))
    if not found:
        return
    names = [c.name(row.kind, number) or f"number {number}" for number in found]
    several = row.kind if len(found) == 1 else {"body": "bodies"}.get(row.kind, f"{row.kind}s")
    shown = listed(names[:MOST_NAMES]) + (f" and {len(names) - MOST_NAMES} more" if len(names) > MOST_NAMES else "")
    location = c.location(row.kind, found[0])
    where = "" if location else f"{c.file}: "
    yield Problem(LEFT_OUT, f"{where}{row.what}: {several} {shown}", location, row.hint)


def _whole(c: Compiled) -> Iterator[Problem]:
    """What holds for the whole model."""
    option, place = c.model.opt, SourceLocation(c.file, 1, 1)
    if float(option.density) or float(option.viscosity):
        message = "the forces of a fluid (density, viscosity, wind) are not in a spec"
        yield Problem(LEFT_OUT, message, place, "drag on a point is a force by its velocity: -c*points.tip.vx")
    touching = _touching(c)
    if touching:
        message = f"contacts are not in a spec: {touching} of {c.count('geom')} geoms may touch others"
        hint = "a floor under a point is a force by its place; ends of a joint's range are stops (--limits)"
        yield Problem(LEFT_OUT, message, place, hint)
    if int(c.model.nplugin):
        message = f"plugins of MuJoCo's ({int(c.model.nplugin)}) have no counterpart in a spec"
        yield Problem(LEFT_OUT, message, place, "say what they do by forces of the spec")


def _where(c: Compiled, joints: Any, of: Any = True) -> list[int]:
    """The numbers of the joints for which both hold."""
    return [int(k) for k in np.flatnonzero(np.logical_and(np.asarray(joints) != 0, of))]


def _of_type(c: Compiled, *words: str) -> Any:
    kinds = [int(c.mujoco.mjtJoint.__members__[word]) for word in words]
    return np.isin(np.asarray(c.model.jnt_type), kinds)


def _rows_with(values: Any, count: int) -> list[int]:
    """The rows of an array, one row a part, in which something is not 0; an array that older versions do not have."""
    if values is None or not count:
        return []
    return [int(k) for k in np.flatnonzero((np.asarray(values).reshape(count, -1) != 0).any(axis=1))]


def _joints_of_dofs(c: Compiled, values: Any) -> list[int]:
    """The joints of the rates for which an array is not 0."""
    return [int(c.model.dof_jntid[dof]) for dof in _rows_with(values, int(c.model.nv))]


def _curved(c: Compiled) -> list[int]:
    """Joints whose spring or damper is not linear, or gives way."""
    joints = [getattr(c.model, name, None) for name in ("jnt_stiffnesspoly", "jnt_springyield")]
    of_springs = [joint for values in joints for joint in _rows_with(values, int(c.model.njnt))]
    return of_springs + _joints_of_dofs(c, getattr(c.model, "dof_dampingpoly", None))


def _free_damped(c: Compiled) -> list[int]:
    """Free joints with damping, and balls with one below 0."""
    free, balls = np.flatnonzero(_of_type(c, "mjJNT_FREE")), np.flatnonzero(_of_type(c, "mjJNT_BALL"))
    driving = [joint for joint in _joints_of_dofs(c, np.minimum(c.model.dof_damping, 0.0)) if joint in balls]
    return driving + [joint for joint in _joints_of_dofs(c, c.model.dof_damping) if joint in free]


def _shared_weights(c: Compiled) -> Iterator[int]:
    """The bodies of which some joints take the weight off by their motors, others not."""
    for body in _rows_with(c.model.body_gravcomp, int(c.model.nbody)):
        motors = by_motor(c, body)
        if any(motors) and not all(motors):
            yield body


def _actuators(c: Compiled) -> list[int]:
    """Those that are more than a torque or thrust which their control alone makes."""
    model, mujoco = c.model, c.mujoco
    plain = (
        (np.asarray(model.actuator_dyntype) == int(mujoco.mjtDyn.mjDYN_NONE))
        & (np.asarray(model.actuator_gaintype) == int(mujoco.mjtGain.mjGAIN_FIXED))
        & (np.asarray(model.actuator_biastype) == int(mujoco.mjtBias.mjBIAS_NONE))
    )
    return [int(k) for k in np.flatnonzero(~plain)]


def _acting(c: Compiled) -> Iterator[int]:
    """Tendons that pull, or hold, and are no spring between two sites."""
    for tendon in range(c.count("tendon")):
        names = ("stiffness", "damping", "limited", "frictionloss", "armature", "stiffnesspoly", "dampingpoly")
        has = {name: bool(np.any(getattr(c.model, f"tendon_{name}", np.zeros(tendon + 1))[tendon])) for name in names}
        spring = is_tendon_spring(c, tendon) and not (has.pop("stiffnesspoly") or has.pop("dampingpoly"))
        if spring:
            del has["stiffness"], has["damping"]
        if any(has.values()):
            yield tendon


def _soft(c: Compiled) -> list[int]:
    """Equalities whose softness was set by hand."""
    n = c.count("equality")
    if not n:
        return []
    hard = np.isclose(np.asarray(c.model.eq_solref).reshape(n, -1)[:, :2], DEFAULT_SOLREF).all(axis=1)
    stiff = np.isclose(np.asarray(c.model.eq_solimp).reshape(n, -1)[:, :5], DEFAULT_SOLIMP).all(axis=1)
    return [int(k) for k in np.flatnonzero(~(hard & stiff))]


def _touching(c: Compiled) -> int:
    """How many geoms may touch one of another body, by their `contype`, `conaffinity` and what is excluded.

    Bodies that are fixed to each other are one; a body and its parent do not touch, unless that is the ground.
    """
    if c.switched_off("CONTACT", "CONSTRAINT"):
        return 0
    model = c.model
    weld = np.asarray(model.body_weldid)
    its = weld[np.asarray(model.geom_bodyid, dtype=int)] if model.ngeom else np.zeros(0, dtype=int)
    rows = np.stack([np.asarray(model.geom_contype), np.asarray(model.geom_conaffinity), its], axis=1)
    groups, member = np.unique(rows, axis=0, return_inverse=True) if len(rows) else (rows, np.zeros(0, dtype=int))
    if len(groups) > MOST_GROUPS:
        return int(np.any(rows[:, :2] != 0, axis=1).sum())
    types, affinities, bodies = groups.T if len(groups) else np.zeros((3, 0), dtype=int)
    may = (types[:, None] & affinities) | (affinities[:, None] & types)
    parents = weld[np.asarray(model.body_parentid)[bodies]]
    filtered = not c.switched_off("FILTERPARENT")
    kin = (parents[:, None] == bodies) & (bodies != 0) & (bodies[:, None] != 0) & filtered
    may = (may != 0) & (bodies[:, None] != bodies) & ~kin & ~kin.T & ~_excluded(c, weld, bodies)
    touching = may.any(axis=1)[member.ravel()] if len(groups) else np.zeros(0, dtype=bool)
    for pair in range(int(model.npair)):
        touching[[int(model.pair_geom1[pair]), int(model.pair_geom2[pair])]] = True
    return int(touching.sum())


def _excluded(c: Compiled, weld: Any, bodies: Any) -> Any:
    """Which of these pairs of bodies a model excludes by name."""
    signatures = np.asarray(c.model.exclude_signature, dtype=int)
    pairs = {(int(weld[s >> 16]), int(weld[s & 0xFFFF])) for s in signatures}
    pairs |= {(b, a) for a, b in pairs}
    out = np.zeros((len(bodies), len(bodies)), dtype=bool)
    for a, b in pairs:
        out |= (bodies[:, None] == a) & (bodies == b)
    return out


ROWS = (
    WithoutCounterpart(
        "joint", lambda c: _joints_of_dofs(c, c.model.dof_armature),
        "the inertia of a motor (armature) is left out: at rest it adds nothing",
        "a motion takes armature * acceleration more than its drive tells",
    ),
    WithoutCounterpart(
        "joint", lambda c: [] if c.switched_off("FRICTIONLOSS") else _joints_of_dofs(c, c.model.dof_frictionloss),
        "dry friction (frictionloss) is left out",
        "a force of type friction has it, with the speed at which it is full",
    ),
    WithoutCounterpart(
        "joint", lambda c: _where(c, c.model.jnt_stiffness, _of_type(c, "mjJNT_BALL", "mjJNT_FREE")),
        "springs in a ball or free joint are not in a spec", "springs between points have their effect",
    ),
    WithoutCounterpart(
        "joint", _free_damped,
        "damping of a free joint, or below 0 of a ball, is not in a spec",
        "drag on a point is a force by its velocity: -c*points.tip.vx",
    ),
    WithoutCounterpart(
        "joint", _curved,
        "springs and dampers that are not linear: their linear part alone is in the spec",
        "a torque has any law in the joint's angle and rate",
    ),
    WithoutCounterpart(
        "actuator", _actuators,
        "actuators with dynamics, or with a feedback of their own, are left out",
        "joints are held by drives, which tell the torque that is needed",
    ),
    WithoutCounterpart("equality", _soft, "softness of equalities (solref, solimp) is not in a spec, where they hold",
        "an elastic coupling is a spring or turn_spring"),
    WithoutCounterpart(
        "flex", lambda c: range(c.count("flex")), "flexible bodies are not in a spec", "a spec has rigid bodies",
    ),
    WithoutCounterpart(
        "body", lambda c: [int(k) for k in np.flatnonzero(np.asarray(c.model.body_mocapid) >= 0)],
        "bodies that a program moves (mocap) stand still in the spec", "move what they hold by a drive",
    ),
)  # fmt: skip
TENDONS = WithoutCounterpart(
    "tendon", lambda c: (), "tendons are in a spec where they run straight between two sites, as springs or rods of "
    "a given length; left out",
    "rods, springs and actuators run between points",
)  # fmt: skip
TENDON_SPRINGS = WithoutCounterpart(
    "tendon", lambda c: (), "limits, friction and armature of tendons, and what is not linear in them, are left out; "
    "their springs and dampers are in the spec",
    "an actuator between two points has any law in its length",
)  # fmt: skip
SHARED_WEIGHTS = WithoutCounterpart(
    "body", lambda c: (), "weights that motors take off (actuatorgravcomp) in some of the joints that carry them: in "
    "the spec no joint carries them",
    "the motor of such a joint takes what its drive tells, and the torque of the weight",
)  # fmt: skip
BALL_LIMITS = WithoutCounterpart("joint", lambda c: (), "limits of a ball's turn are not in a spec", "pins have stops")
