"""The foundation (55), its central axis, and the mass effects (56).

    s = sum k - sum m x..,   M_s = sum (x - O) x k + couples - sum [(x_s - O) x m x_s.. + I sigma. + sigma x I sigma]
s and M_s act ON the foundation; k is what is applied from outside: weight, force, couple. Heun (1901), no. 25-26.
"""

from __future__ import annotations

import numpy as np

from heuncli.integration.runner import Recovered
from heuncli.joint_kinds import JOINTS
from heuncli.kinetostatics.bodies import BodyStates
from heuncli.kinetostatics.reactions import JointLoads, in_plane, support_loads
from heuncli.mechanism.model import GROUND, JointLoad, Mechanism, PairLoad, PointLoad
from heuncli.results import Array, Block

NO_FORCE = 1e-12  # of the largest load: below it s is zero and has no axis


def inertia_loads(mechanism: Mechanism, states: BodyStates) -> tuple[Array, Array]:
    """m x_s.. and I sigma. + sigma x I sigma of every body, (n_t, n, 3), world axes."""
    m = np.array([b.mass for b in mechanism.bodies])
    inertia = np.array([b.inertia for b in mechanism.bodies])
    w = np.einsum("tnji,tnj->tni", states.R, states.omega)
    u = np.einsum("tnji,tnj->tni", states.R, states.alpha)
    spin = np.einsum("nij,tnj->tni", inertia, u) + np.cross(w, np.einsum("nij,tnj->tni", inertia, w))
    found = m[:, None] * states.a_centre, np.einsum("tnij,tnj->tni", states.R, spin)
    return in_plane(*found) if mechanism.planar else found


def load_slots(mechanism: Mechanism) -> list[list[int]]:
    """Which of the kernel's loads belong to each load of the mechanism: in a joint one for each motion it acts on."""
    slots, at = [], 0
    for load in mechanism.loads:
        count = len(JOINTS[mechanism.joints[load.joint].kind].motions) if isinstance(load, JointLoad) else 1
        slots.append(list(range(at, at + count)))
        at += count
    return slots


def ends(mechanism: Mechanism, load: PairLoad | JointLoad) -> tuple[int, int]:
    """The bodies on which a load between two bodies acts, `from` first."""
    if isinstance(load, PairLoad):
        return load.a, load.b
    joint = mechanism.joints[load.joint]
    return joint.a, joint.b


def foundation(
    mechanism: Mechanism, found: Recovered, states: BodyStates, joints: list[JointLoads], about: Array
) -> Block:
    """The foundation's block of the results; `about` (3,) is where moments are taken."""
    ma, spin = inertia_loads(mechanism, states)
    arm = states.centre - about
    weight = np.array([b.mass for b in mechanism.bodies])[:, None] * mechanism.gravity
    force = np.sum(weight - ma, axis=1)
    moment = np.sum(np.cross(arm, weight - ma) - spin, axis=1)
    elements: Block = {}
    for load, slots in zip(mechanism.loads, load_slots(mechanism), strict=True):
        F, M = found.loads[:, slots, 0:3].sum(axis=1), found.loads[:, slots, 3:6].sum(axis=1)
        X, Y = found.loads[:, slots[0], 6:9], found.loads[:, slots[0], 9:12]
        if isinstance(load, PointLoad):
            force = force + F
            moment = moment + np.cross(X - about, F) + M
        else:
            a, b = ends(mechanism, load)
            if a == GROUND:
                elements[load.name] = {"force": -F, "moment": -M, "point": Y.copy()}
            elif b == GROUND:
                elements[load.name] = {"force": F, "moment": M, "point": X.copy()}
    supports: Block = {}
    for load_ in joints:
        on_ground = support_loads(load_)
        if on_ground is None:
            continue
        supports[load_.joint.name] = {"force": on_ground[0], "moment": on_ground[1]}
        if load_.joint.drive is not None and not JOINTS[load_.joint.kind].keeps_distance:
            sign = -1.0 if load_.joint.a == GROUND else 1.0
            name = load_.joint.drive.name
            elements[f"drives.{name}" if name in elements else name] = {  # a force may bear its name, too
                "force": sign * load_.drive_force, "moment": sign * load_.drive_moment, "point": load_.point.copy(),
            }  # fmt: skip
    orbital = np.cross(arm, ma).sum(axis=1)
    if mechanism.planar:
        force, moment = in_plane(force, moment)
        _, orbital = in_plane(force, orbital)
    all_forces = (ma, weight, found.loads[..., 0:3], *(j.force for j in joints))
    scale = max(float(np.abs(x).max(initial=0.0)) for x in all_forces)
    block: Block = {
        "about": about, "force": force, "moment": moment, "axis": central_axis(force, moment, about, scale),
        "mass_effect": {
            "force": ma.sum(axis=1), "moment_orbital": orbital, "moment_spin": spin.sum(axis=1),
        },
    }  # fmt: skip
    if supports:
        block["supports"] = supports
    if elements:
        block["elements"] = elements
    return block


def central_axis(s: Array, M: Array, about: Array, scale: float) -> Block:
    """Central axis of the wrench (s, M about `about`): point nearest `about`, direction, pitch [m]; nan where s = 0."""
    s2 = np.sum(s * s, axis=1)
    largest = max(float(np.sqrt(s2.max(initial=0.0))), scale)
    none = s2 <= (NO_FORCE * largest) ** 2
    safe = np.where(none, np.nan, s2)
    return {
        "point": about + np.cross(s, M) / safe[:, None],
        "direction": s / np.sqrt(safe)[:, None],
        "pitch": np.sum(s * M, axis=1) / safe,
    }
