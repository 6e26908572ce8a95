"""The foundation (55), its central axis, and the mass effects (56).

    s = sum k - sum m x..,   M_s = sum (x - O) x k + couples - sum [(x_s - O) x m x_s.. + I sigma. + sigma x I sigma]
s and M_s act ON the foundation; k is what is applied from outside: weight, force, couple. Heun (1901), no. 25-26.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np

from heuncli.base import tolerances
from heuncli.base.joint_kinds import JOINTS
from heuncli.base.named_tuples import NamedTuple
from heuncli.loads.kinetostatics.actions import Action
from heuncli.loads.kinetostatics.bodies import BodyStates
from heuncli.loads.kinetostatics.reactions import in_plane
from heuncli.multibody.mechanism.model import GROUND, JointLoad, Mechanism
from heuncli.results.results import Array, Block, Mask
from heuncli.scene.shapes.by_component import cross, instants_first, turned
from heuncli.scene.shapes.rotations import cross_rows

ElementKeys = Mapping[tuple[str, str], str]  # of `foundation.elements`, by block of the spec and name
BLOCK_OF = {
    "load": "forces",
    "drive": "drives",
    "stop": "stops",
    "coupling": "couplings",
}  # of a spec, by kind of action


def inertia_loads(mechanism: Mechanism, states: BodyStates) -> tuple[Array, Array]:
    """m x_s.. and I sigma. + sigma x I sigma of every body, (n_t, n, 3), world axes."""
    force, moment = map(instants_first, inertia_rows(mechanism, states))
    return force, moment


def inertia_rows(mechanism: Mechanism, states: BodyStates) -> tuple[Array, Array]:
    """The same by component, (n, 3, n_t)."""
    m = np.array([b.mass for b in mechanism.bodies])
    J = np.array([b.inertia for b in mechanism.bodies])[..., None]
    w, u = states.turning
    spin = turned(states.rows_of("R"), turned(J, u) + cross(w, turned(J, w)))
    force = m[:, None, None] * states.rows_of("a_centre")
    if not mechanism.planar:
        return force, spin
    return force * np.array([[1.0], [1.0], [0.0]]), spin * np.array([[0.0], [0.0], [1.0]])


def total(
    states: BodyStates, forces: Array, spin: Array, actions: Sequence[Action], about: Array
) -> tuple[Array, Array]:
    """s and M_s, (n_t, 3); forces: weight less m x_s.. of every body, spin: I sigma. + sigma x I sigma, (n_t, n, 3)."""
    force = forces.sum(axis=1)
    moment = (cross_rows(states.centre - about, forces) - spin).sum(axis=1)
    for action in actions:
        if action.from_ is None:
            force = force + action.force
            moment = moment + cross_rows(action.to.position - about, action.force) + action.moment
    return force, moment


def foundation(mechanism: Mechanism, states: BodyStates, actions: Sequence[Action], about: Array) -> Block:
    """The foundation's block of the results; `about` (3,) is where moments are taken."""
    ma, spin = inertia_loads(mechanism, states)
    weight = np.array([b.mass for b in mechanism.bodies])[:, None] * mechanism.gravity
    force, moment = total(states, weight - ma, spin, actions, about)
    standing: Block = {"supports": {}, "elements": {}}
    for (kind, name), on in on_ground(mechanism, actions).items():
        where = {"point": on.about.copy()} if kind == "elements" else {}
        standing[kind][name] = {"force": on.force, "moment": on.moment} | where
    orbital = cross_rows(states.centre - about, ma).sum(axis=1)
    if mechanism.planar:
        force, moment = in_plane(force, moment)
        _, orbital = in_plane(force, orbital)
    block: Block = {
        "about": about, "force": force, "moment": moment,
        "axis": central_axis(force, moment, about, largest_force(mechanism, force, ma, actions)),
        "mass_effect": {
            "force": ma.sum(axis=1), "moment_orbital": orbital, "moment_spin": spin.sum(axis=1),
        },
    }  # fmt: skip
    return block | {kind: own for kind, own in standing.items() if own}


class OnGround(NamedTuple):
    """A force and a moment ON the ground, and where the moment is taken."""

    force: Array
    moment: Array
    about: Array

    def with_another(self, own: OnGround) -> OnGround:
        """Together with another part of the same coupling, about the place of the first."""
        moment = self.moment + own.moment + cross_rows(own.about - self.about, own.force)
        return OnGround(self.force + own.force, moment, self.about)


def on_ground(mechanism: Mechanism, actions: Sequence[Action]) -> dict[tuple[str, str], OnGround]:
    """What stands on the ground: ("supports", joint), or ("elements", the key of a force, drive, stop or coupling)."""
    found: dict[tuple[str, str], OnGround] = {}
    keys = element_keys(mechanism)
    for action in actions:
        on = action.on_ground()
        if on is None or action.from_ is None:
            continue
        key = ("supports", action.name) if action.kind == "joint" else ("elements", element_key(keys, action))
        own = OnGround(*on)
        found[key] = own if key not in found else found[key].with_another(own)
    return found


def element_keys(mechanism: Mechanism) -> ElementKeys:
    """The keys in `foundation.elements` of what stands on the ground, by its block in the spec and its name.

    The key is the name. Where a force, a drive or a coupling have one name, the later of them has its block before it:
    `drives.NAME`, `couplings.NAME`.
    """
    grounded = {k for k, joint in enumerate(mechanism.joints) if GROUND in (joint.a, joint.b)}
    standing = [
        (mechanism.block_of(load), load.name)
        for load in mechanism.loads
        if (
            load.joint in grounded
            if isinstance(load, JointLoad)
            else GROUND in (getattr(load, "a", 0), getattr(load, "b", 0))
        )
    ]
    drives = ((joint.drive, JOINTS[joint.kind]) for k, joint in enumerate(mechanism.joints) if k in grounded)
    standing += [("drives", drive.name) for drive, kind in drives if drive is not None and not kind.keeps_distance]
    standing += [("stops", stop.name) for stop in mechanism.stops if stop.joint in grounded]
    standing += [("couplings", own.name) for own in mechanism.couplings if GROUND in own.ends]
    keys: dict[tuple[str, str], str] = {}
    taken: dict[str, str] = {}
    for block, name in standing:
        owner = taken.setdefault(name, block)
        keys[block, name] = name if owner == block else f"{block}.{name}"
    return keys


def element_key(keys: ElementKeys, action: Action) -> str:
    """The key of an action on the ground; a load may be its coupling's own."""
    block = BLOCK_OF[action.kind]
    if block == "forces" and (block, action.name) not in keys:
        block = "couplings"
    return keys.get((block, action.name), action.name)


def largest_force(mechanism: Mechanism, s: Array, ma: Array, actions: Sequence[Action]) -> float:
    """The largest force at any of the instants [N], of those that s is the sum of, and s itself: s beside it is none.

    s (n_t, 3); ma: m x_s.. of every body, (n_t, n, 3).
    """
    weight = np.array([b.mass for b in mechanism.bodies])[:, None] * mechanism.gravity
    acting = np.array([action.force for action in actions if action.kind != "drive"])
    scale = max(float(np.abs(x).max(initial=0.0)) for x in (ma, weight, acting))
    return max(float(np.sqrt(np.sum(s * s, axis=1).max(initial=0.0))), scale)


def no_force(s: Array, largest: float) -> Mask:
    """At which instants s (n_t, 3) is none beside the largest force of the run, (n_t,)."""
    return np.asarray(np.sum(s * s, axis=1) <= (tolerances.NO_FORCE * largest) ** 2)


def central_axis(s: Array, M: Array, about: Array, largest: float) -> Block:
    """Central axis of the wrench (s, M about `about`): point nearest `about`, direction, pitch [m]; nan where s = 0.

    largest: the largest force of the run [N].
    """
    s2 = np.sum(s * s, axis=1)
    safe = np.where(no_force(s, largest), np.nan, s2)
    return {
        "point": about + cross_rows(s, M) / safe[:, None],
        "direction": s / np.sqrt(safe)[:, None],
        "pitch": np.sum(s * M, axis=1) / safe,
    }
