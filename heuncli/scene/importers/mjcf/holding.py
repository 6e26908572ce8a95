"""Which joints are held by drives, so that nothing of the machine is left free, and nothing is held twice.

Of a tree that is every hinge and slide. Where equalities close loops, some coordinates follow from others: what is held
then is one joint after another whose rate the equalities and the joints before it leave open,

    rank [J; e_1; ...; e_k; e] > rank [J; e_1; ...; e_k]      J: rows of the equalities, e_i q' the rate of joint i

those that lead another first, whose drive needs their parameter, then those that an actuator moves.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from typing import Any

import numpy as np

from heuncli.base.named_tuples import NamedTuple
from heuncli.scene.importers.mjcf.closings import Closings, JointEquality
from heuncli.scene.importers.mjcf.compiled import Compiled
from heuncli.scene.importers.mjcf.tree import COORDINATE, JointTree

# Of a rate of 1, what is left of it beside all that follows from others: those that are well open are taken first, so
# that none is held which another all but determines.
OPEN = (0.1, 1e-3, 1e-6)


class HeldJoints(NamedTuple):
    """joints: the numbers of those that are held, in MuJoCo's order; followed: the couplings that hold others."""

    joints: tuple[int, ...]
    followed: tuple[JointEquality, ...]


def held(c: Compiled, tree: JointTree, closings: Closings, q: Any) -> HeldJoints:
    """What is held. A joint whose leader nothing holds follows none: it is one among the others."""
    couplings = [*closings.couplings]
    while True:
        joints = _held(c, tree, closings, couplings, q)
        idle = _without_leader(couplings, joints)
        if idle is None:
            return HeldJoints(joints, tuple(couplings))
        couplings.remove(idle)


def _held(c: Compiled, tree: JointTree, closings: Closings, couplings: list[JointEquality], q: Any) -> tuple[int, ...]:
    slaves = {coupling.slave for coupling in couplings}
    movable = [joint for joint, step in tree.of_joint.items() if step.kind in COORDINATE]
    joints = [joint for joint in movable if joint not in slaves]
    if not closings.carried:
        return tuple(joints)
    leaders = {coupling.master for coupling in couplings}
    moved = set(_moved(c))
    order = sorted(joints, key=lambda joint: (joint not in leaders, joint not in moved))
    dofs = [int(c.model.jnt_dofadr[joint]) for joint in order]
    carried = closings.carried | {coupling.equality for coupling in couplings}
    return tuple(sorted(order[k] for k in _independent(_rows(c, carried, q), dofs)))


def _without_leader(couplings: list[JointEquality], joints: tuple[int, ...]) -> JointEquality | None:
    """The first coupling that leads back to no joint that is held; None where all do."""
    led: set[int | None] = {None, *joints}
    left = couplings
    while left:
        rest = [coupling for coupling in left if coupling.master not in led]
        if len(rest) == len(left):
            return rest[0]
        led |= {coupling.slave for coupling in left if coupling.master in led}
        left = rest
    return None


def _moved(c: Compiled) -> Iterator[int]:
    """The joints that an actuator moves."""
    kinds = [int(c.mujoco.mjtTrn.__members__[word]) for word in ("mjTRN_JOINT", "mjTRN_JOINTINPARENT")]
    for number in range(int(c.model.nu)):
        if int(c.model.actuator_trntype[number]) in kinds:
            yield int(c.model.actuator_trnid[number][0])


def _rows(c: Compiled, wanted: frozenset[int], q: Any) -> Any:
    """Rows of the equalities that the spec holds, (rows, rates)."""
    mujoco, model = c.mujoco, c.model
    data = mujoco.MjData(model)
    data.qpos[:] = q
    kept = int(model.opt.jacobian)
    model.opt.jacobian = int(mujoco.mjtJacobian.mjJAC_DENSE)
    try:
        mujoco.mj_kinematics(model, data)
        mujoco.mj_comPos(model, data)
        mujoco.mj_tendon(model, data)
        mujoco.mj_makeConstraint(model, data)
    finally:
        model.opt.jacobian = kept
    J = np.array(data.efc_J).reshape(-1, int(model.nv))[: int(data.ne)]
    return J[[int(number) in wanted for number in np.array(data.efc_id)[: len(J)]]]


def _independent(J: Any, dofs: Iterable[int]) -> Iterator[int]:
    """The places in the list of those rates that the rows and the rates before leave open."""
    sizes = np.linalg.norm(J, axis=1)
    rows = J[sizes > 0.0] / sizes[sizes > 0.0, None]
    _, s, V = np.linalg.svd(rows, full_matrices=False) if len(rows) else (0, np.zeros(0), rows)
    base = V[s > OPEN[-1] * max(1.0, s.max(initial=0.0))]
    left = dict(enumerate(dofs))
    for least in OPEN:
        for place, dof in list(left.items()):
            rest = -base.T @ base[:, dof]
            rest[dof] += 1.0
            rest -= base.T @ (base @ rest)
            size = np.linalg.norm(rest)
            if size > least:
                yield place
                base = np.vstack([base, rest / size])
                del left[place]
