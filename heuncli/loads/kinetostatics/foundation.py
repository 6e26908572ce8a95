"""The foundation (55), its central axis, the mass effects (56), and the momenta (16), (17) of the bodies.

    s = sum k - sum m x..,   M_s = sum (x - O) x k + couples - sum [(x_s - O) x m x_s.. + I sigma. + sigma x I sigma]

s and M_s act ON the foundation; k is what is applied from outside: weight, force, couple. Heun (1901), no. 25-26.

    sum m x_s.        sum m_s x x_s. + sum I sigma       about a fixed point

The rates of these momenta (Heun (1901), (16) and (17)) are the mass effects.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np

from heuncli.base import tolerances
from heuncli.base.joint_kinds import JOINTS
from heuncli.base.named_tuples import NamedTuple
from heuncli.base.records import record
from heuncli.loads.kinetostatics.actions import Action
from heuncli.loads.kinetostatics.bodies import BodyStates
from heuncli.loads.kinetostatics.reactions import project_to_plane
from heuncli.multibody.mechanism.loads import GROUND, JointLoad
from heuncli.multibody.mechanism.model import Mechanism
from heuncli.results.results import Array, Block, Mask
from heuncli.scene.shapes.rotations import cross_components, cross_rows, instants_first, rotate_components

# Foundation

ElementKeys = Mapping[tuple[str, str], str]  # of `foundation.elements`, by block of the spec and name
BLOCK_OF = {
    "load": "forces",
    "drive": "drives",
    "stop": "stops",
    "coupling": "couplings",
}  # of a spec, by kind of action


def find_inertia_loads(mechanism: Mechanism, states: BodyStates) -> tuple[Array, Array]:
    """Return m x_s.. and I sigma. + sigma x I sigma of every body, (n_t, n, 3), world axes."""
    force, moment = map(instants_first, find_inertia_rows(mechanism, states))
    return force, moment


def find_inertia_rows(mechanism: Mechanism, states: BodyStates) -> tuple[Array, Array]:
    """Return the inertia loads by component, (n, 3, n_t)."""
    m = np.array([b.mass for b in mechanism.bodies])
    J = np.array([b.inertia for b in mechanism.bodies])[..., None]
    w, u = states.turning
    spin = rotate_components(
        states.component_rows("R"), rotate_components(J, u) + cross_components(w, rotate_components(J, w))
    )
    force = m[:, None, None] * states.component_rows("a_centre")
    if not mechanism.planar:
        return force, spin
    return force * np.array([[1.0], [1.0], [0.0]]), spin * np.array([[0.0], [0.0], [1.0]])


def sum_ground_loads(
    states: BodyStates, forces: Array, spin: Array, actions: Sequence[Action], reference: Array
) -> tuple[Array, Array]:
    """Return s and M_s, (n_t, 3).

    forces: weight minus m x_s.. of every body
    spin: I sigma. + sigma x I sigma, (n_t, n, 3)
    """
    force = forces.sum(axis=1)
    moment = (cross_rows(states.centre - reference, forces) - spin).sum(axis=1)
    for action in actions:
        if action.from_end is None:
            force = force + action.force
            moment = moment + cross_rows(action.to_end.position - reference, action.force) + action.moment
    return force, moment


def foundation_block(
    mechanism: Mechanism,
    states: BodyStates,
    actions: Sequence[Action],
    reference: Array,
    inner_forces: Sequence[Array] = (),
) -> Block:
    """Return the foundation's block of the results; `reference` (3,) is where moments are taken.

    inner_forces: those between bodies that are not among the actions, (n_t, 3) each
    """
    ma, spin = find_inertia_loads(mechanism, states)
    weight = np.array([b.mass for b in mechanism.bodies])[:, None] * mechanism.gravity
    force, moment = sum_ground_loads(states, weight - ma, spin, actions, reference)
    ground_blocks: Block = {"supports": {}, "elements": {}}
    for (kind, name), load in find_ground_loads(mechanism, actions).items():
        where = {"point": load.point.copy()} if kind == "elements" else {}
        ground_blocks[kind][name] = {"force": load.force, "moment": load.moment} | where
    orbital = cross_rows(states.centre - reference, ma).sum(axis=1)
    if mechanism.planar:
        force, moment = project_to_plane(force, moment)
        _, orbital = project_to_plane(force, orbital)
    largest = largest_force(mechanism, force, ma, actions, inner_forces)
    block: Block = {
        "about": reference, "force": force, "moment": moment,
        "axis": find_central_axis(force, moment, reference, largest),
        "mass_effect": {
            "force": ma.sum(axis=1), "moment_orbital": orbital, "moment_spin": spin.sum(axis=1),
        },
    }  # fmt: skip
    return block | {kind: entries for kind, entries in ground_blocks.items() if entries}


class GroundLoad(NamedTuple):
    """A force and a moment ON the ground, and the point that the moment is about."""

    force: Array
    moment: Array
    point: Array

    def add(self, other: GroundLoad) -> GroundLoad:
        """Add another part of the same coupling, about the point of the first."""
        moment = self.moment + other.moment + cross_rows(other.point - self.point, other.force)
        return GroundLoad(self.force + other.force, moment, self.point)


def find_ground_loads(mechanism: Mechanism, actions: Sequence[Action]) -> dict[tuple[str, str], GroundLoad]:
    """Find the loads on the ground: ("supports", joint), or ("elements", the key of a force, drive, stop or
    coupling).
    """
    loads: dict[tuple[str, str], GroundLoad] = {}
    keys = make_element_keys(mechanism)
    for action in actions:
        load = action.ground_load()
        if load is None or action.from_end is None:
            continue
        key = ("supports", action.name) if action.kind == "joint" else ("elements", find_element_key(keys, action))
        ground_load = GroundLoad(*load)
        loads[key] = ground_load if key not in loads else loads[key].add(ground_load)
    return loads


def make_element_keys(mechanism: Mechanism) -> ElementKeys:
    """Return the keys in `foundation.elements` of what acts on the ground, by its block in the spec and its name.

    The key is the name. Where a force, a drive or a coupling have one name, the later one is prefixed by its block:
    `drives.NAME`, `couplings.NAME`.
    """
    grounded_joints = {k for k, joint in enumerate(mechanism.joints) if GROUND in (joint.a, joint.b)}
    elements = [
        (mechanism.spec_block(load), load.name)
        for load in mechanism.loads
        if (
            load.joint in grounded_joints
            if isinstance(load, JointLoad)
            else GROUND in (getattr(load, "a", 0), getattr(load, "b", 0))
        )
    ]
    drives = ((joint.drive, JOINTS[joint.kind]) for k, joint in enumerate(mechanism.joints) if k in grounded_joints)
    elements += [("drives", drive.name) for drive, kind in drives if drive is not None and not kind.keeps_distance]
    elements += [("stops", stop.name) for stop in mechanism.stops if stop.joint in grounded_joints]
    elements += [("couplings", own.name) for own in mechanism.couplings if GROUND in own.bodies_and_ground]
    keys: dict[tuple[str, str], str] = {}
    owners: dict[str, str] = {}
    for block, name in elements:
        owner = owners.setdefault(name, block)
        keys[block, name] = name if owner == block else f"{block}.{name}"
    return keys


def find_element_key(keys: ElementKeys, action: Action) -> str:
    """Return the key of an action on the ground; a load may belong to its coupling."""
    block = BLOCK_OF[action.kind]
    if block == "forces" and (block, action.name) not in keys:
        block = "couplings"
    return keys.get((block, action.name), action.name)


def largest_force(
    mechanism: Mechanism, s: Array, ma: Array, actions: Sequence[Action], inner_forces: Sequence[Array] = ()
) -> float:
    """Return the largest force at any instant [N], of s and the forces that it is the sum of: the scale below which s
    is zero.

    s (n_t, 3); ma: m x_s.. of every body, (n_t, n, 3); inner_forces: as of `foundation_block`.
    """
    weight = np.array([b.mass for b in mechanism.bodies])[:, None] * mechanism.gravity
    acting = np.array([*(action.force for action in actions if action.kind != "drive"), *inner_forces])
    scale = max(float(np.abs(x).max(initial=0.0)) for x in (ma, weight, acting))
    return max(float(np.sqrt(np.sum(s * s, axis=1).max(initial=0.0))), scale)


def is_zero_force(s: Array, largest: float) -> Mask:
    """Return at which instants s (n_t, 3) is zero compared with the largest force of the run, (n_t,)."""
    return np.asarray(np.sum(s * s, axis=1) <= (tolerances.NO_FORCE * largest) ** 2)


def find_central_axis(s: Array, M: Array, reference: Array, largest: float) -> Block:
    """Return the central axis of the wrench (s, M about `reference`): nearest point, direction, pitch [m]; nan where s
    = 0.

    largest: the largest force of the run [N]
    """
    s2 = np.sum(s * s, axis=1)
    safe = np.where(is_zero_force(s, largest), np.nan, s2)
    return {
        "point": reference + cross_rows(s, M) / safe[:, None],
        "direction": s / np.sqrt(safe)[:, None],
        "pitch": np.sum(s * M, axis=1) / safe,
    }


# Momentum


@record
class Momenta:
    """Momenta of each body, (n_t, n, 3), world axes: linear [N s]; orbital, spin: moments of momentum about a point [N
    m s].
    """

    linear: Array
    orbital: Array
    spin: Array

    def sum_bodies(self) -> Block:
        """Return the sums over all bodies."""
        parts = {"total": self.linear, "moment_orbital": self.orbital, "moment_spin": self.spin}
        return {name: part.sum(axis=1) for name, part in parts.items()}


def find_momenta(mechanism: Mechanism, states: BodyStates, reference: Array) -> Momenta:
    """Return momentum and moment of momentum about a point (3,)."""
    m = np.array([body.mass for body in mechanism.bodies])
    inertia = np.array([body.inertia for body in mechanism.bodies])
    w = np.einsum("tnji,tnj->tni", states.R, states.omega)
    linear = m[:, None] * states.v_centre
    spin: Array = np.einsum("tnij,njk,tnk->tni", states.R, inertia, w)
    orbital = cross_rows(states.centre - reference, linear)
    if mechanism.planar:
        linear, orbital = project_to_plane(linear, orbital)
        _, spin = project_to_plane(linear, spin)
    return Momenta(linear, orbital, spin)
