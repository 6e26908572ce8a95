"""Report what a model of MuJoCo has and a spec does not: one row for each feature, with the names and the first
location.

Each row finds the parts that have the feature. Features that change no result of a spec (cameras, materials, sensors,
solver settings) have no row.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator
from typing import Any

import numpy as np

from heuncli.base.errors import Problem, SourceLocation
from heuncli.base.named_tuples import NamedTuple
from heuncli.base.spelling import list_words
from heuncli.scene.importers.description import LEFT_OUT_CODE
from heuncli.scene.importers.mjcf.compiled_model import CompiledModel
from heuncli.scene.importers.mjcf.loads import find_motor_compensation
from heuncli.scene.importers.mjcf.tendons import is_imported_tendon, sum_joint_damping

MAX_NAMES = 6
DEFAULT_SOLREF = (0.02, 1.0)
DEFAULT_SOLIMP = (0.9, 0.95, 0.001, 0.5, 2.0)
MAX_GROUPS = 3000  # groups of geoms that are checked in pairs


class UnsupportedFeature(NamedTuple):
    """A feature without a counterpart in a spec.

    kind: the kind of parts that have it
    find: returns the numbers of those parts
    what: the message
    hint: what to use instead
    """

    kind: str
    find: Callable[[CompiledModel], Iterable[int]]
    what: str
    hint: str


def find_unsupported(compiled: CompiledModel, rods: frozenset[int], limits: bool, free: bool) -> Iterator[Problem]:
    """Yield a problem for each feature that is left out of the spec. rods: the tendons that are in it."""
    for row in UNSUPPORTED_FEATURES:
        yield from _feature_problem(compiled, row, row.find(compiled))
    acting_tendons = [tendon for tendon in _acting_tendons(compiled) if tendon not in rods]
    yield from _feature_problem(
        compiled, TENDONS, (tendon for tendon in acting_tendons if not is_imported_tendon(compiled, tendon))
    )
    yield from _feature_problem(
        compiled, TENDON_SPRINGS, (tendon for tendon in acting_tendons if is_imported_tendon(compiled, tendon))
    )
    if limits:
        yield from _feature_problem(
            compiled,
            BALL_LIMITS,
            _joints_where(compiled, compiled.model.jnt_limited, _joint_type_mask(compiled, "mjJNT_BALL")),
        )
        yield from _feature_problem(compiled, SOFT_LIMITS, _softened_limits(compiled))
    if not free:
        yield from _feature_problem(compiled, SHARED_WEIGHTS, _partly_compensated_bodies(compiled))
    yield from _model_problems(compiled)


def _feature_problem(compiled: CompiledModel, row: UnsupportedFeature, numbers: Iterable[int]) -> Iterator[Problem]:
    part_numbers = sorted(set(numbers))
    if not part_numbers:
        return
    names = [compiled.name(row.kind, number) or f"number {number}" for number in part_numbers]
    kind_text = row.kind if len(part_numbers) == 1 else {"body": "bodies"}.get(row.kind, f"{row.kind}s")
    names_text = list_words(names[:MAX_NAMES]) + (
        f" and {len(names) - MAX_NAMES} more" if len(names) > MAX_NAMES else ""
    )
    location = compiled.location(row.kind, part_numbers[0])
    where = "" if location else f"{compiled.file}: "
    yield Problem(LEFT_OUT_CODE, f"{where}{row.what}: {kind_text} {names_text}", location, row.hint)


def _model_problems(compiled: CompiledModel) -> Iterator[Problem]:
    """Yield the problems that concern the whole model."""
    option, place = compiled.model.opt, SourceLocation(compiled.file, 1, 1)
    if float(option.density) or float(option.viscosity):
        message = "fluid forces (density, viscosity, wind) are left out"
        yield Problem(LEFT_OUT_CODE, message, place, "model drag on a point by a force: -c*points.tip.vx")
    touching_count = _count_touching_geoms(compiled)
    if touching_count:
        message = f"contacts are left out: {touching_count} of {compiled.count('geom')} geoms may touch others"
        hint = "model a floor under a point by a force that depends on its position, joint limits by stops (--limits)"
        yield Problem(LEFT_OUT_CODE, message, place, hint)
    if int(compiled.model.nplugin):
        message = f"MuJoCo plugins ({int(compiled.model.nplugin)}) are left out"
        yield Problem(LEFT_OUT_CODE, message, place, "model their effect by forces in the spec")


def _joints_where(compiled: CompiledModel, values: Any, mask: Any = True) -> list[int]:
    """Return the numbers of the joints whose value is not 0 and for which the mask holds."""
    return [int(k) for k in np.flatnonzero(np.logical_and(np.asarray(values) != 0, mask))]


def _joint_type_mask(compiled: CompiledModel, *words: str) -> Any:
    kinds = [int(compiled.mujoco.mjtJoint.__members__[word]) for word in words]
    return np.isin(np.asarray(compiled.model.jnt_type), kinds)


def _nonzero_rows(values: Any, count: int) -> list[int]:
    """Return the rows with a nonzero value in an array of one row for each part; none if this version of MuJoCo lacks
    the array.
    """
    if values is None or not count:
        return []
    return [int(k) for k in np.flatnonzero((np.asarray(values).reshape(count, -1) != 0).any(axis=1))]


def _joints_with_nonzero_rates(compiled: CompiledModel, values: Any) -> list[int]:
    """Return the joints of those rates for which the array is not 0."""
    return [int(compiled.model.dof_jntid[dof]) for dof in _nonzero_rows(values, int(compiled.model.nv))]


def _nonlinear_joints(compiled: CompiledModel) -> list[int]:
    """Return the joints whose spring or damper is not linear, or yields."""
    joints = [getattr(compiled.model, name, None) for name in ("jnt_stiffnesspoly", "jnt_springyield")]
    of_springs = [joint for values in joints for joint in _nonzero_rows(values, int(compiled.model.njnt))]
    return of_springs + _joints_with_nonzero_rates(compiled, getattr(compiled.model, "dof_dampingpoly", None))


def _unsupported_damping(compiled: CompiledModel) -> list[int]:
    """Return the free joints with damping, and the balls with negative damping."""
    free, balls = (
        np.flatnonzero(_joint_type_mask(compiled, "mjJNT_FREE")),
        np.flatnonzero(_joint_type_mask(compiled, "mjJNT_BALL")),
    )
    negatively_damped = [int(joint) for joint in balls if sum_joint_damping(compiled, int(joint)) < 0.0]
    return negatively_damped + [int(joint) for joint in free if sum_joint_damping(compiled, int(joint))]


def _partly_compensated_bodies(compiled: CompiledModel) -> Iterator[int]:
    """Yield the bodies whose weight is carried by the motors of some joints, but not of all."""
    for body in _nonzero_rows(compiled.model.body_gravcomp, int(compiled.model.nbody)):
        motors = find_motor_compensation(compiled, body)
        if any(motors) and not all(motors):
            yield body


def _unsupported_actuators(compiled: CompiledModel) -> list[int]:
    """Return the actuators that are more than a torque or thrust made by their control alone."""
    model, mujoco = compiled.model, compiled.mujoco
    is_plain = (
        (np.asarray(model.actuator_dyntype) == int(mujoco.mjtDyn.mjDYN_NONE))
        & (np.asarray(model.actuator_gaintype) == int(mujoco.mjtGain.mjGAIN_FIXED))
        & (np.asarray(model.actuator_biastype) == int(mujoco.mjtBias.mjBIAS_NONE))
    )
    return [int(k) for k in np.flatnonzero(~is_plain)]


def _acting_tendons(compiled: CompiledModel) -> Iterator[int]:
    """Yield the tendons that pull or hold by more than a linear spring and damper that can be imported."""
    names = ["limited", "frictionloss", "armature", "stiffnesspoly", "dampingpoly", "springyield"]
    for tendon in range(compiled.count("tendon")):
        acting = names if is_imported_tendon(compiled, tendon) else [*names, "stiffness", "damping"]
        if any(np.any(getattr(compiled.model, f"tendon_{name}", np.zeros(tendon + 1))[tendon]) for name in acting):
            yield tendon


def _nonlinear_actuator_damping(compiled: CompiledModel) -> list[int]:
    """Return the actuators whose damping is not that of a joint, or a fixed or straight tendon, and linear."""
    model, kinds = compiled.model, compiled.mujoco.mjtTrn.__members__
    nonlinear = _nonzero_rows(getattr(model, "actuator_dampingpoly", None), int(model.nu))
    tendons = [
        k
        for k in _nonzero_rows(getattr(model, "actuator_damping", None), int(model.nu))
        if int(model.actuator_trntype[k]) == int(kinds["mjTRN_TENDON"])
        and not is_imported_tendon(compiled, int(model.actuator_trnid[k][0]))
    ]
    return nonlinear + tendons


def _softened_limits(compiled: CompiledModel) -> list[int]:
    """Return the limited joints whose softness, or distance of action, was set by hand."""
    return [
        k
        for k in _joints_where(compiled, compiled.model.jnt_limited)
        if _is_soft(compiled, "jnt", k) or float(compiled.model.jnt_margin[k])
    ]


def _is_soft(compiled: CompiledModel, prefix: str, number: int) -> bool:
    """Return whether the constraint of a part has a softness other than MuJoCo's default."""
    solref = np.asarray(getattr(compiled.model, f"{prefix}_solref"))[number][:2]
    solimp = np.asarray(getattr(compiled.model, f"{prefix}_solimp"))[number][:5]
    return not (np.allclose(solref, DEFAULT_SOLREF) and np.allclose(solimp, DEFAULT_SOLIMP))


def _softened_equalities(compiled: CompiledModel) -> list[int]:
    """Return the equalities whose softness was set by hand."""
    return [k for k in range(compiled.count("equality")) if _is_soft(compiled, "eq", k)]


def _count_touching_geoms(compiled: CompiledModel) -> int:
    """Count the geoms that may touch one of another body, by their `contype`, `conaffinity` and the exclusions.

    Bodies that are fixed to each other count as one. A body and its parent do not touch, unless that is the ground.
    """
    if compiled.is_disabled("CONTACT", "CONSTRAINT"):
        return 0
    model = compiled.model
    weld = np.asarray(model.body_weldid)
    geom_body = weld[np.asarray(model.geom_bodyid, dtype=int)] if model.ngeom else np.zeros(0, dtype=int)
    rows = np.stack([np.asarray(model.geom_contype), np.asarray(model.geom_conaffinity), geom_body], axis=1)
    groups, member = np.unique(rows, axis=0, return_inverse=True) if len(rows) else (rows, np.zeros(0, dtype=int))
    if len(groups) > MAX_GROUPS:
        return int(np.any(rows[:, :2] != 0, axis=1).sum())
    types, affinities, bodies = groups.T if len(groups) else np.zeros((3, 0), dtype=int)
    may_touch = (types[:, None] & affinities) | (affinities[:, None] & types)
    parents = weld[np.asarray(model.body_parentid)[bodies]]
    filtered = not compiled.is_disabled("FILTERPARENT")
    kin = (parents[:, None] == bodies) & (bodies != 0) & (bodies[:, None] != 0) & filtered
    may_touch = (
        (may_touch != 0) & (bodies[:, None] != bodies) & ~kin & ~kin.T & ~_excluded_pairs(compiled, weld, bodies)
    )
    touching = may_touch.any(axis=1)[member.ravel()] if len(groups) else np.zeros(0, dtype=bool)
    for pair in range(int(model.npair)):
        touching[[int(model.pair_geom1[pair]), int(model.pair_geom2[pair])]] = True
    return int(touching.sum())


def _excluded_pairs(compiled: CompiledModel, weld: Any, bodies: Any) -> Any:
    """Return which of these pairs of bodies the model excludes by name."""
    signatures = np.asarray(compiled.model.exclude_signature, dtype=int)
    pairs = {(int(weld[s >> 16]), int(weld[s & 0xFFFF])) for s in signatures}
    pairs |= {(b, a) for a, b in pairs}
    out = np.zeros((len(bodies), len(bodies)), dtype=bool)
    for a, b in pairs:
        out |= (bodies[:, None] == a) & (bodies == b)
    return out


UNSUPPORTED_FEATURES = (
    UnsupportedFeature(
        "joint",
        lambda compiled: _joints_with_nonzero_rates(compiled, compiled.model.dof_armature),
        "the rotor inertia of motors (armature) is left out: it has no effect at rest",
        "in motion, add armature * acceleration to the reported drive torque",
    ),
    UnsupportedFeature(
        "actuator",
        lambda compiled: _nonzero_rows(getattr(compiled.model, "actuator_armature", None), int(compiled.model.nu)),
        "the rotor inertia of actuators (armature) is left out: it has no effect at rest",
        "in motion, add armature * gear^2 * acceleration to the reported drive torque",
    ),
    UnsupportedFeature(
        "actuator",
        _nonlinear_actuator_damping,
        "damping of actuators that is not linear, or acts on a tendon that bends, is left out",
        "use a torque with any law in the joint's rate",
    ),
    UnsupportedFeature(
        "joint",
        lambda compiled: (
            []
            if compiled.is_disabled("FRICTIONLOSS")
            else _joints_with_nonzero_rates(compiled, compiled.model.dof_frictionloss)
        ),
        "dry friction (frictionloss) is left out",
        "use a force of type friction, with the speed at which it is fully developed",
    ),
    UnsupportedFeature(
        "joint",
        lambda compiled: _joints_where(
            compiled, compiled.model.jnt_stiffness, _joint_type_mask(compiled, "mjJNT_BALL", "mjJNT_FREE")
        ),
        "springs in ball or free joints are left out",
        "use springs between points",
    ),
    UnsupportedFeature(
        "joint",
        _unsupported_damping,
        "damping of free joints, and negative damping of ball joints, is left out",
        "model drag on a point by a force: -c*points.tip.vx",
    ),
    UnsupportedFeature(
        "joint",
        _nonlinear_joints,
        "nonlinear springs and dampers: only their linear part is in the spec",
        "use a torque with any law in the joint's angle and rate",
    ),
    UnsupportedFeature(
        "actuator",
        _unsupported_actuators,
        "actuators with dynamics or feedback are left out",
        "drives hold the joints and report the required torque",
    ),
    UnsupportedFeature(
        "equality",
        _softened_equalities,
        "softness of equalities (solref, solimp) is left out: they are exact in the spec",
        "for an elastic coupling use a spring or turn_spring",
    ),
    UnsupportedFeature(
        "flex",
        lambda compiled: range(compiled.count("flex")),
        "flexible bodies are left out",
        "a spec has only rigid bodies",
    ),
    UnsupportedFeature(
        "body",
        lambda compiled: [int(k) for k in np.flatnonzero(np.asarray(compiled.model.body_mocapid) >= 0)],
        "bodies moved by a program (mocap) are fixed in the spec",
        "use a drive to move what is attached to them",
    ),
)
TENDONS = UnsupportedFeature(
    "tendon", lambda compiled: (), "tendons are left out unless they are fixed, or run straight between two sites",
    "use rods, springs or actuators between points",
)  # fmt: skip
TENDON_SPRINGS = UnsupportedFeature(
    "tendon", lambda compiled: (), "limits, friction and armature of tendons, and their nonlinear parts, are left out; "
    "their springs and dampers are in the spec",
    "use an actuator between two points, with any law in its length",
)  # fmt: skip
SHARED_WEIGHTS = UnsupportedFeature(
    "body", lambda _: (), "gravity compensation by motors (actuatorgravcomp) in only some of the supporting joints: "
    "in the spec no joint carries this weight",
    "the motor of such a joint takes the reported drive torque plus the torque of the weight",
)  # fmt: skip
SOFT_LIMITS = UnsupportedFeature(
    "joint", lambda compiled: (), "softness of limits (solreflimit, solimplimit, margin) is left out: stops are rigid",
    "for an elastic stop use a torque: -k*max(elbow.angle - 1.2, 0)",
)  # fmt: skip
BALL_LIMITS = UnsupportedFeature(
    "joint", lambda compiled: (), "rotation limits of ball joints are left out", "use stops on pins"
)
