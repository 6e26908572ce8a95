"""Choose the joints that drives hold, so that no coordinate stays free and none is held twice.

In a tree these are all hinges and slides. Where equalities close loops, some coordinates follow from others. Then a
joint is held if the equalities and the joints chosen before it leave its rate free,

    rank [J; e_1; ...; e_k; e] > rank [J; e_1; ...; e_k]      J: rows of the equalities, e_i q' the rate of joint i

Joints that lead others come first, because the drives of the others need their parameter; then joints with an actuator.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from typing import Any

import numpy as np

from heuncli.base.linear_algebra import count_rank
from heuncli.base.named_tuples import NamedTuple
from heuncli.scene.importers.mjcf.compiled_model import CompiledModel
from heuncli.scene.importers.mjcf.loop_closures import JointEquality, LoopClosures
from heuncli.scene.importers.mjcf.tree import COORDINATE_KEYS, JointTree

# Least part of a unit rate that is independent of the others; the most independent rates are chosen first.
INDEPENDENCE_THRESHOLDS = (0.1, 1e-3, 1e-6)


class HeldJoints(NamedTuple):
    """joints: numbers of the joints that drives hold, in MuJoCo's order
    couplings: the couplings that determine other joints
    """

    joints: tuple[int, ...]
    couplings: tuple[JointEquality, ...]


def choose_held_joints(c: CompiledModel, tree: JointTree, closures: LoopClosures, q: Any) -> HeldJoints:
    """Choose the held joints. A coupling is dropped if nothing holds its leader; its joint is then treated as any
    other.
    """
    couplings = [*closures.couplings]
    while True:
        joints = _choose_for_couplings(c, tree, closures, couplings, q)
        without_leader = _find_coupling_without_leader(couplings, joints)
        if without_leader is None:
            return HeldJoints(joints, tuple(couplings))
        couplings.remove(without_leader)


def _choose_for_couplings(
    c: CompiledModel, tree: JointTree, closures: LoopClosures, couplings: list[JointEquality], q: Any
) -> tuple[int, ...]:
    followers = {coupling.follower for coupling in couplings}
    movable = [joint for joint, step in tree.step_by_joint.items() if step.kind in COORDINATE_KEYS]
    joints = [joint for joint in movable if joint not in followers]
    if not closures.imported_equalities:
        return tuple(joints)
    leaders = {coupling.leader for coupling in couplings}
    actuated = set(_actuated_joints(c))
    order = sorted(joints, key=lambda joint: (joint not in leaders, joint not in actuated))
    dofs = [int(c.model.jnt_dofadr[joint]) for joint in order]
    imported_equalities = closures.imported_equalities | {coupling.equality for coupling in couplings}
    return tuple(sorted(order[k] for k in _iter_independent(_equality_rows(c, imported_equalities, q), dofs)))


def _find_coupling_without_leader(couplings: list[JointEquality], joints: tuple[int, ...]) -> JointEquality | None:
    """Find the first coupling that leads back to no held joint; None if all do."""
    determined: set[int | None] = {None, *joints}
    remaining = couplings
    while remaining:
        still_remaining = [coupling for coupling in remaining if coupling.leader not in determined]
        if len(still_remaining) == len(remaining):
            return still_remaining[0]
        determined |= {coupling.follower for coupling in remaining if coupling.leader in determined}
        remaining = still_remaining
    return None


def _actuated_joints(c: CompiledModel) -> Iterator[int]:
    """Yield the joints that an actuator moves."""
    kinds = [int(c.mujoco.mjtTrn.__members__[word]) for word in ("mjTRN_JOINT", "mjTRN_JOINTINPARENT")]
    for number in range(int(c.model.nu)):
        if int(c.model.actuator_trntype[number]) in kinds:
            yield int(c.model.actuator_trnid[number][0])


def _equality_rows(c: CompiledModel, equalities: frozenset[int], q: Any) -> Any:
    """Compute the constraint rows (rows, rates) of the equalities that the spec holds."""
    mujoco, model = c.mujoco, c.model
    data = mujoco.MjData(model)
    data.qpos[:] = q
    previous = int(model.opt.jacobian)
    model.opt.jacobian = int(mujoco.mjtJacobian.mjJAC_DENSE)
    try:
        mujoco.mj_kinematics(model, data)
        mujoco.mj_comPos(model, data)
        mujoco.mj_tendon(model, data)
        mujoco.mj_makeConstraint(model, data)
    finally:
        model.opt.jacobian = previous
    J = np.array(data.efc_J).reshape(-1, int(model.nv))[: int(data.ne)]
    return J[[int(number) in equalities for number in np.array(data.efc_id)[: len(J)]]]


def _iter_independent(J: Any, dofs: Iterable[int]) -> Iterator[int]:
    """Yield the indices in `dofs` of the rates that the rows and the rates before them leave free."""
    sizes = np.linalg.norm(J, axis=1)
    rows = J[sizes > 0.0] / sizes[sizes > 0.0, None]
    _, s, V = np.linalg.svd(rows, full_matrices=False) if len(rows) else (0, np.zeros(0), rows)
    base = V[: count_rank(s, INDEPENDENCE_THRESHOLDS[-1])]
    remaining = dict(enumerate(dofs))
    for threshold in INDEPENDENCE_THRESHOLDS:
        for index, dof in list(remaining.items()):
            residual = -base.T @ base[:, dof]
            residual[dof] += 1.0
            residual -= base.T @ (base @ residual)
            size = np.linalg.norm(residual)
            if size > threshold:
                yield index
                base = np.vstack([base, residual / size])
                del remaining[index]
