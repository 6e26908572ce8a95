"""Make bodies that cannot move part of the ground: structures in a closed chain, such as a truss that carries a crank.

A set of bodies that hang on each other and on the ground is immobile if the closure rows among them and the ground
alone have a Jacobian J of full column rank on their coordinates,

    g(q) = 0,   det J'J > 0   =>   q is constant        (implicit function theorem)

for these conditions hold at all times, whatever the loads and whatever else moves: full rank at the start is enough for
the whole run. A body that only happens to rest at first, such as a slider at its dead centre, has no part in the
motions of the whole scene, but nothing holds it by itself. The largest such set is found by repeatedly removing all
bodies that take part in the null space of J among those that are left.
"""

from __future__ import annotations

import numpy as np

from heuncli.base import tolerances
from heuncli.base.linear_algebra import compute_null_space
from heuncli.base.records import record, replace
from heuncli.multibody.mechanism.loads import GROUND
from heuncli.multibody.mechanism.model import Joint
from heuncli.multibody.reduction.compose import Reduction
from heuncli.multibody.reduction.smaller_scene import BodyParts, BodyPlacement, make_smaller_scene
from heuncli.multibody.reduction.spins import find_constant_spins
from heuncli.multibody.reduction.state_embedding import make_state_embedding
from heuncli.multibody.reduction.welded_bodies import format_body_names
from heuncli.multibody.response import Jacobian, jacobian, make_workspace, settle_state
from heuncli.multibody.tree.layout import Island, Layout
from heuncli.multibody.tree.prepare import PreparedScene
from heuncli.multibody.tree.tables import Table
from heuncli.results.results import Array, Mask


def step(scene: PreparedScene) -> Reduction | tuple[str, ...]:
    """Make the bodies that cannot move part of the ground; return only sentences if there are none."""
    layout, mechanism = scene.layout, scene.mechanism
    workspace = make_workspace(layout)
    state, bodies = settle_state(workspace, layout, 0.0, layout.y0)
    search = ImmobilitySearch(
        layout, jacobian(workspace, layout, np.zeros(1), state[None, :]), resting_spin_axes(scene, bodies["R"])
    )
    held, exceptions = find_immobile_bodies(search)
    if not held.any():
        return exceptions
    placements = tuple(
        ground_placement(layout, bodies, layout.place[i])
        if held[layout.place[i]]
        else BodyPlacement(i, np.eye(3), np.zeros(3))
        for i in range(len(mechanism.bodies))
    )
    parts = BodyParts(placements, tuple(i for i, part in enumerate(placements) if part.body == i))
    smaller = make_smaller_scene(scene, parts, [mechanism.bodies[i] for i in parts.roots])
    embedding = make_state_embedding(layout, smaller.layout, parts, stop_bodies(layout, held, state))
    layout_at_start = replace(smaller.layout, y0=embedding.restrict(0.0, layout.y0))
    names = [i for i, part in enumerate(placements) if part.body == GROUND]
    verb = "is" if len(names) == 1 else "are"
    explanation = f"{format_body_names(mechanism, names)} {verb} fixed to the ground by joints, whatever else moves"
    explanation += " and whatever loads act: part of the ground"
    return Reduction(
        replace(smaller, layout=layout_at_start),
        embedding.embed,
        embedding.restrict,
        (explanation,),
        exceptions=exceptions,
    )


@record
class ImmobilitySearch:
    """The data of the search for bodies that cannot move: J at the start, the layout, and inactive spins.

    spins: of bodies, by tree index, world axes (k, 3) about which they do not turn, though no joint holds them
    """

    layout: Layout
    J: Jacobian
    spins: dict[int, Array]


def resting_spin_axes(scene: PreparedScene, R: Array) -> dict[int, Array]:
    """Return world axes (k, 3) about which bodies never turn: no moment acts about them
    (multibody/reduction/spins.py).
    """
    place = scene.layout.place
    axes_by_body = {
        place[body_index]: spin.axis[None, :]
        for body_index, spin in find_constant_spins(scene).items()
        if spin.rate == 0.0
    }
    axes_by_body |= {place[spin.body]: spin.axes for spin in scene.idle_spins}
    return {body_index: axes @ R[body_index].T for body_index, axes in axes_by_body.items()}


def ground_placement(layout: Layout, bodies: Table, place: int) -> BodyPlacement:
    """Return the placement of a tree body on the ground."""
    R, r = bodies["R"][place], bodies["r"][place]
    return BodyPlacement(GROUND, R, r - R @ layout.reference[place])


def stop_bodies(layout: Layout, is_held: Mask, state: Array) -> Array:
    """Return the state with the rates of the held bodies set to zero."""
    state = state.copy()
    for group in layout.tables["groups"][: len(is_held)][is_held]:
        state[group["rates"] : group["end"]] = 0.0
    return state


def find_immobile_bodies(search: ImmobilitySearch) -> tuple[Mask, tuple[str, ...]]:
    """Find the bodies, by tree index, that cannot move, and the reasons why others that seem immobile were left."""
    layout = search.layout
    is_held = ~find_movable_bodies(layout)
    exceptions: dict[int, str] = {}
    while True:
        remove_carried_bodies(layout, is_held)
        moving = sorted(
            {i for island in layout.islands for i in find_moving_bodies(search, island, is_held, exceptions)}
        )
        moving = moving or find_limited_body(layout, is_held, exceptions)
        if not moving:
            return is_held, tuple(exceptions[i] for i in sorted(exceptions))
        is_held[moving] = False


def find_movable_bodies(layout: Layout) -> Mask:
    """Find the bodies whose coordinates no closure can fix: in no loop, or driven, limited, coupled or used in
    expressions.
    """
    mechanism = layout.mechanism
    closed = {n for island in layout.islands for n in island.freedoms.tolist()}
    limited = {stop.joint for stop in mechanism.stops} | {
        k for coupling in mechanism.couplings for k in coupling.joints
    }
    limited |= {friction.joint for friction in mechanism.iter_sticking()}
    joint_names = {name for value in mechanism.iter_expressions() for name, _ in value.uses}
    is_movable = np.zeros(len(layout.bodies), dtype=bool)
    for i, link in enumerate(layout.spanning.links):
        is_movable[i] = not closed.issuperset(body_freedoms(layout, i))
        if link.joint >= 0:
            joint = mechanism.joints[link.joint]
            is_movable[i] |= is_moved_by_drive(joint) or link.joint in limited or joint.name in joint_names
    return is_movable


def is_moved_by_drive(joint: Joint) -> bool:
    """Return whether a joint has a drive whose value changes."""
    return joint.drive is not None and joint.drive.value.constant is None


def body_freedoms(layout: Layout, i: int) -> list[int]:
    """Return the answer indices of a body's freedoms that are not driven."""
    row = layout.bodies[i]
    own = layout.tables["freedoms"][row["first_freedom"] : row["end_freedom"]]
    ball = range(row["velocity_at"], row["velocity_at"] + 3) if row["ball"] else ()
    return [*ball, *own["velocity_at"][own["driven"] == 0].tolist()]


def remove_carried_bodies(layout: Layout, is_held: Mask) -> None:
    """Remove the bodies whose parents are not held."""
    for i, parent in enumerate(layout.bodies["parent"].tolist()):
        is_held[i] &= parent < 0 or is_held[parent]


def find_limited_body(layout: Layout, is_held: Mask, exceptions: dict[int, str]) -> list[int]:
    """Find a body on a rope or stop whose other end cannot move either: such a rope or stop may end the run."""
    mechanism = layout.mechanism
    limited = {stop.joint for stop in mechanism.stops} | {own.joint for own in mechanism.iter_sticking()}
    for k, joint in enumerate(mechanism.joints):
        ends = [layout.place[i] for i in (joint.a, joint.b) if i != GROUND]
        if (joint.tension_only or k in limited) and ends and is_held[ends].all():
            name = mechanism.bodies[layout.spanning.links[max(ends)].body].name
            exceptions[max(ends)] = (
                f"bodies.{name} cannot move, but stays a body: joints.{joint.name} may go slack, or is limited"
            )
            return [max(ends)]
    for owner, coupling in enumerate(mechanism.couplings, len(mechanism.joints)):
        places = [layout.place[i] for i in coupling.bodies]
        if is_held[places].all():
            name = mechanism.bodies[layout.spanning.links[max(places)].body].name
            exceptions[max(places)] = (
                f"bodies.{name} cannot move, but stays a body: {mechanism.owner_path(owner)} also constrains it"
            )
            return [max(places)]
    return []


def find_moving_bodies(
    search: ImmobilitySearch, island: Island, is_held: Mask, exceptions: dict[int, str]
) -> list[int]:
    """Find the bodies of an island that can still move when all others are held."""
    layout = search.layout
    bodies = {i: free for i in np.flatnonzero(is_held).tolist() if (free := island_freedoms(layout, island, i))}
    if not bodies:
        return []
    freedoms: Array = np.concatenate([np.array(free) for free in bodies.values()])
    rows: Array = np.array([r for r in island.rows.tolist() if is_permanent(layout, r, is_held)], dtype=int)
    A = scaled_jacobian(search, island, rows, freedoms)
    basis = motion_basis(search, bodies)
    _, sigma, Vt = np.linalg.svd(A @ basis, full_matrices=True)
    sigma = np.concatenate([sigma, np.zeros(len(Vt) - len(sigma))])
    largest = max(float(sigma.max(initial=0.0)), 1.0)
    is_null = sigma <= tolerances.NEARLY_SINGULAR * largest
    share = np.abs(Vt[is_null] @ basis.T).max(axis=0, initial=0.0)
    owner = np.repeat(np.array(list(bodies)), [len(free) for free in bodies.values()])
    moving = sorted({int(i) for i in owner[share > tolerances.REMAINING_RATE]})
    if is_null.any() and float(sigma.min()) > tolerances.RANK * largest:
        names = format_body_names(layout.mechanism, [layout.spanning.links[i].body for i in moving])
        exceptions[moving[0]] = (
            f"{names} can hardly move, but stay bodies: their constraints are nearly dependent, "
            f"by {float(sigma.min()):.1g}"
        )
    return moving


def island_freedoms(layout: Layout, island: Island, i: int) -> list[int]:
    """Return the freedoms of a body that are in an island."""
    own = body_freedoms(layout, i)
    return own if own and own[0] in set(island.freedoms.tolist()) else []


def is_permanent(layout: Layout, r: int, is_held: Mask) -> bool:
    """Return whether a closure row is between held bodies and the ground, and constrains them at all times.

    Rows of couplings do not count: they depend on coordinates, or roll.
    """
    if layout.rows[r] >= len(layout.mechanism.joints):
        return False
    row = layout.tables["closures"][r]
    one_sided = r in set(layout.tables["contacts"]["row"].tolist())
    ends = [int(row[end]) for end in ("a", "b") if row[end] >= 0]
    return (
        bool(is_held[ends].all()) and not one_sided and not is_moved_by_drive(layout.mechanism.joints[layout.rows[r]])
    )


def scaled_jacobian(search: ImmobilitySearch, island: Island, rows: Array, freedoms: Array) -> Array:
    """J of some of an island's rows and freedoms, scaled as in loads/redundancy/self_stress.py, (rows, freedoms)."""
    couples, turns = np.isin(rows, island.rows[island.couples]), np.isin(freedoms, island.freedoms[island.turns])
    J = search.J.block(rows, freedoms)[0]
    J = J * np.where(couples, island.length, 1.0)[:, None] / np.where(turns, island.length, 1.0)
    return np.asarray(J / np.maximum(np.sqrt(np.sum(J * J, axis=1, keepdims=True)), 1.0))


def motion_basis(search: ImmobilitySearch, bodies: dict[int, list[int]]) -> Array:
    """Return unit motions, as columns (freedoms, n), of all freedoms except the inactive spins."""
    blocks = []
    for i, free in bodies.items():
        block = np.eye(len(free))
        if i in search.spins and search.layout.bodies["ball"][i]:
            axes = np.zeros((len(search.spins[i]), len(free)))
            axes[:, :3] = search.spins[i]
            block = compute_null_space(axes)
        blocks.append(block)
    n = [block.shape for block in blocks]
    basis = np.zeros((sum(rows for rows, _ in n), sum(columns for _, columns in n)))
    offsets = np.cumsum([(0, 0), *n], axis=0)
    for (row, column), block in zip(offsets[:-1].tolist(), blocks, strict=True):
        basis[row : row + block.shape[0], column : column + block.shape[1]] = block
    return basis
