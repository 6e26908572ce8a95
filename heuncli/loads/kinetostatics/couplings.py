"""Loads of couplings: each condition between two bodies gives a force and a couple at one place, ON both of them.

The loads are those of the kernel's parts for the multipliers of their rows. World axes; shapes (..., n_t, 3), with an
axis of causes before the instants where they are given by cause.

Tooth flanks separate: the radial part of tooth forces is the same whichever of the two flanks carries.

    F = |lambda| h    ON b at the pitch point, the opposite ON a        h per unit of tangential force (gearing.py)

It does no work, however the two turn. So it moves nothing, loads no closure row, and passes from one gear to the other
through the joints of the tree between them, each of which exerts the opposite of the force that it resists.
"""

from __future__ import annotations

from collections.abc import Collection, Iterator, Sequence
from itertools import chain

import numpy as np

from heuncli.base.records import record, replace
from heuncli.loads.kinetostatics.actions import Action, ActionEnd
from heuncli.loads.kinetostatics.bodies import BodyStates
from heuncli.loads.kinetostatics.reactions import JointLoads, KernelResults, project_to_plane
from heuncli.multibody.mechanism.couplings import Coupling, CouplingPart
from heuncli.multibody.mechanism.model import Mechanism
from heuncli.multibody.tree.layout import Layout
from heuncli.results.results import Array
from heuncli.scene.file_format.couplings import Screw
from heuncli.scene.shapes.rotations import cross_rows

# Couplings


@record
class PartLoad:
    """Force and moment of one part ON its body b, about the place there, the opposite ON a, about its place on a.

    place, place_a (n_t, 3): these places
    f, m, m_a (n_t, 3): loads for a multiplier of 1, m about the one place, m_a about the other
    separating_force (n_t, 3): the force ON b for a multiplier of 1 or of -1, or None
    """

    part: CouplingPart
    place: Array
    place_a: Array
    f: Array
    m: Array
    m_a: Array
    multiplier: Array
    separating_force: Array | None = None

    @property
    def force(self) -> Array:
        """Force ON b."""
        result: Array = self.multiplier[..., None] * self.f
        return result if self.separating_force is None else result + self.separation

    @property
    def separation(self) -> Array:
        """The part of the force ON b that keeps its direction when all multipliers change their sign together."""
        if self.separating_force is None:
            return np.zeros_like(self.multiplier[..., None] * self.f)
        total = self.multiplier.reshape(-1, len(self.f)).sum(axis=0)
        result: Array = (np.where(total < 0.0, -1.0, 1.0) * self.multiplier)[..., None] * self.separating_force
        return result

    @property
    def moment(self) -> Array:
        """Moment ON b about the place."""
        result: Array = self.multiplier[..., None] * self.m
        return result

    def with_multiplier(self, multiplier: Array) -> PartLoad:
        """Return the same with another multiplier."""
        return replace(self, multiplier=multiplier)

    @property
    def moment_on_a(self) -> Array:
        """Moment ON a about its place there."""
        result: Array = -self.multiplier[..., None] * self.m_a
        return result

    @property
    def both_loads(self) -> Iterator[tuple[int, Array, Array, Array]]:
        """For b, then for a: the body, the place, the force ON it and the moment about the place."""
        yield self.part.b, self.place, self.force, self.moment
        yield self.part.a, self.place_a, -self.force, self.moment_on_a

    @property
    def ends(self) -> tuple[ActionEnd, ActionEnd]:
        """The points of application on b and on a; it may move over both."""
        on_b = ActionEnd(self.part.b, self.place, None, is_offset=True)
        return on_b, ActionEnd(self.part.a, self.place_a, None, is_offset=True)


@record
class CouplingLoads:
    """What a coupling exerts; multipliers: of its rows, (..., n_t) each.

    A rope that stretches has no row; the value of its load serves as a multiplier.

    friction: of a thread, from what its row carries; it is among the applied loads and is included here
    """

    coupling: Coupling
    rows: tuple[int, ...]
    multipliers: tuple[Array, ...]
    parts: tuple[PartLoad, ...]
    friction: Action | None = None

    def with_friction(self, applied_actions: Sequence[Action]) -> CouplingLoads:
        """Return the loads with their friction, found by name among the applied loads."""
        if not isinstance(self.coupling.entry, Screw) or self.coupling.entry.friction is None:
            return self
        return replace(self, friction=next((own for own in applied_actions if own.name == self.coupling.name), None))

    @property
    def load_name(self) -> str:
        """Name of its load: a moment, where it only transmits couples; for a cam the contact force."""
        if self.coupling.entry.type == "cam":
            return "contact"
        return "moment" if self.coupling.loading_rows[0].is_couple else "force"

    @property
    def carried_load(self) -> Array:
        """That load, (..., n_t): the multiplier of the first row; for a cam positive where it presses."""
        if self.load_name != "contact":
            return self.multipliers[0]
        (load,) = self.parts
        size: Array = load.part.factor * np.sqrt(np.sum(load.f * load.f, axis=-1))
        return size * self.multipliers[0]

    def with_multipliers(self, multipliers: Array) -> CouplingLoads:
        """Return the loads for other multipliers of all rows, (..., n_t, rows); stretching ropes carry nothing then."""
        own_multipliers = tuple(multipliers[..., r] for r in self.rows)
        if self.coupling.stretched_row is not None:
            own_multipliers = (np.zeros(multipliers.shape[:-1]),)
        if not self.parts:
            return CouplingLoads(self.coupling, self.rows, own_multipliers, ())
        part_loads = iter(self.parts)
        parts = tuple(
            next(part_loads).with_multiplier(multiplier)
            for row, multiplier in zip(self.coupling.loading_rows, own_multipliers, strict=True)
            for _ in row.parts
        )
        return CouplingLoads(self.coupling, self.rows, own_multipliers, parts)

    def iter_row_parts(self) -> Iterator[tuple[int, PartLoad]]:
        """Yield the parts, each with the closure row that it belongs to."""
        owners = [r for r, row in zip(self.rows, self.coupling.rows, strict=True) for _ in row.parts]
        return zip(owners, self.parts, strict=self.coupling.stretched_row is None)

    def add_multipliers(self, increments: Array | None) -> CouplingLoads:
        """Add to the multipliers of all rows, (..., n_t, rows); None: nothing."""
        if increments is None or self.coupling.stretched_row is not None:
            return self
        total = np.zeros_like(increments)
        for r, multiplier in zip(self.rows, self.multipliers, strict=True):
            total[..., r] = multiplier + increments[..., r]
        return self.with_multipliers(total)

    def body_loads(self, extra_actions: Sequence[Action] = ()) -> dict[int, tuple[Array, Array, Array]]:
        """Return for each loaded body, including the ground: a place, the force ON it, the moment about the place.

        extra_actions: such as the pretension of a belt
        """
        loads_by_body: dict[int, tuple[Array, Array, Array]] = {}
        loading_parts = (body_force for body_force in self.parts if not body_force.part.has_no_load)
        # of sheaves their centres come first
        parts = sorted(loading_parts, key=lambda body_force: not body_force.part.lies_on_sheave)
        friction_actions = () if self.friction is None else (self.friction,)
        part_loads = (body_load for part in parts for body_load in part.both_loads)
        action_loads = (
            (end.body, end.position, F, M)
            for action in (*extra_actions, *friction_actions)
            for end, F, M in action.iter_ends()
        )
        for body, place, body_force, body_moment in chain(part_loads, action_loads):
            position, force, moment = loads_by_body.get(
                body, (place, np.zeros_like(body_force), np.zeros_like(body_moment))
            )
            loads_by_body[body] = (
                position,
                force + body_force,
                moment + body_moment + cross_rows(place - position, body_force),
            )
        return loads_by_body


def find_coupling_loads(
    layout: Layout, results: KernelResults, states: BodyStates, only: Collection[str] | None = None
) -> list[CouplingLoads]:
    """Find the loads of all couplings, in the order of the spec; only: those with the given names."""
    mechanism, all_loads = layout.mechanism, []
    for owner, coupling in enumerate(mechanism.couplings, len(mechanism.joints)):
        if only is not None and coupling.name not in only:
            continue
        rows = tuple(r for r, k in enumerate(layout.rows) if k == owner)[: len(coupling.rows)]
        multipliers = tuple(results.rows["multiplier"][..., r] for r in rows)
        firsts = [int(layout.tables["closures"][r]["part"]) for r in rows]
        if coupling.stretched_row is not None:
            multipliers, firsts = _stretch_force(layout, coupling.name, results)
        parts: list[PartLoad] = []
        for first, row, multiplier in zip(firsts, coupling.loading_rows, multipliers, strict=False):
            parts += _iter_part_loads(first, row.parts, multiplier, results, states)
        all_loads.append(CouplingLoads(coupling, rows, multipliers, tuple(parts)))
    return all_loads


def _stretch_force(layout: Layout, name: str, results: KernelResults) -> tuple[tuple[Array], list[int]]:
    """Return the value of a rope that stretches, and where its parts begin; none in an impulse, in which it does not
    stretch.
    """
    k, values = layout.mechanism.rope_load_row(name), results.loads["value"]
    if k < 0 or values.shape[-1] <= k:
        return (np.zeros(values.shape[:-1]),), []
    return (values[..., k],), [int(layout.tables["loads"][k]["part"])]


def _iter_part_loads(
    first: int,
    parts: Sequence[CouplingPart],
    multiplier: Array,
    results: KernelResults,
    states: BodyStates,
) -> Iterator[PartLoad]:
    """Yield the loads of the parts of one row, starting with part number `first`."""
    for k, part in enumerate(parts, first):
        f, m, Q, on_a, on_b = (results.parts[name][:, k] for name in ("f", "m", "Q", "on_a", "on_b"))
        if part.on_a is not None:
            on_a = states.point_position(part.c, part.on_a)
        separating_force = (
            states.world_direction(part.c, np.asarray(part.separating_force)) if np.any(part.separating_force) else None
        )
        m_a = m + cross_rows(Q - on_a, f)
        yield PartLoad(part, on_b, on_a, f, m + cross_rows(Q - on_b, f), m_a, multiplier, separating_force)


def list_rope_actions(couplings: Sequence[CouplingLoads]) -> list[Action]:
    """List the actions of ropes that stretch; like loads, each has a law of its own."""
    return list_coupling_actions([own for own in couplings if own.coupling.stretched_row is not None])


def list_coupling_actions(couplings: Sequence[CouplingLoads]) -> list[Action]:
    """List the actions of couplings, one for each part."""
    return [
        Action("coupling", own.coupling.name, *part.ends, part.force, part.moment, opposite=part.moment_on_a)
        for own in couplings
        for part in own.parts
        if not (part.part.lies_on_sheave or part.part.has_no_load)
    ]


# Flanks


def has_separating_forces(mechanism: Mechanism) -> bool:
    """Return whether a coupling has such flanks."""
    return any(np.any(part.separating_force) for own in mechanism.couplings for row in own.rows for part in row.parts)


def find_joints_between(layout: Layout, part: CouplingPart) -> dict[int, float]:
    """Return the joints of the tree between the two bodies of a part, with the factor of its load ON b in each joint's
    load ON `to`.
    """
    on_a, on_b = set(layout.path_to_root(part.a)), set(layout.path_to_root(part.b))
    factors = {}
    for i in on_a ^ on_b:
        link = layout.spanning.links[i]
        factors[link.joint] = (-1.0 if i in on_b else 1.0) * (-1.0 if link.reverse else 1.0)
    return factors


def add_separating_forces(
    layout: Layout, joints: Sequence[JointLoads], couplings: Sequence[CouplingLoads]
) -> list[JointLoads]:
    """Add the separating forces to joint loads that were computed without them."""
    if not has_separating_forces(layout.mechanism):
        return list(joints)
    added = {load.joint.name: load for load in joints}
    for part in (part for own in couplings for part in own.parts if part.separating_force is not None):
        for k, share in find_joints_between(layout, part.part).items():
            name = layout.mechanism.joints[k].name
            if name in added:
                added[name] = _add_to_joint(added[name], share, part, layout.mechanism.planar)
    return list(added.values())


def _add_to_joint(load: JointLoads, share: float, part: PartLoad, planar: bool) -> JointLoads:
    """Add a share of the separating force of two flanks to a joint's load."""
    force, moment = transfer_force(load, share * part.separation, part.place)
    if planar:
        force, moment = project_to_plane(force, moment)
    result: JointLoads = replace(load, force=load.force + force, moment=load.moment + moment)
    return result


def transfer_force(load: JointLoads, force: Array, place: Array) -> tuple[Array, Array]:
    """Return a force at a place as force and moment about a joint's point."""
    return force, cross_rows(place - load.point, force)
