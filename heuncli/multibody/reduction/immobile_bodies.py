"""Bodies that cannot move are part of the ground: structures in a closed chain, such as a truss that carries a crank.

A set of bodies that hang on each other and on the ground is held if the closure rows among them and the ground alone
have a Jacobian J of full column rank on their coordinates,
    g(q) = 0,   det J'J > 0   =>   q is constant        (implicit function theorem)
for these conditions hold at all times, whatever the loads and whatever else moves: full rank at the start is enough
for the whole run. A body that only does not move at first, a slider at its dead centre, has no share in the motions of
the whole scene, but alone nothing holds it. The largest such set is what is left when all are taken out that have a
share in the null space of J among those that are left, again and again.
"""

from __future__ import annotations

import numpy as np

from heuncli.base import tolerances
from heuncli.base.records import record, replace
from heuncli.multibody.mechanism.model import GROUND, Joint
from heuncli.multibody.reduction.model import Reduction
from heuncli.multibody.reduction.slots import slots
from heuncli.multibody.reduction.smaller_scene import Parts, PlaceInBody, restated
from heuncli.multibody.reduction.spins import spins_of
from heuncli.multibody.reduction.welded_bodies import listed
from heuncli.multibody.response import Jacobian, jacobian, settled, workspace_of
from heuncli.multibody.tree.layout import Island, Layout
from heuncli.multibody.tree.prepare import PreparedScene
from heuncli.multibody.tree.tables import Table
from heuncli.results.results import Array, Mask


def step(scene: PreparedScene) -> Reduction | tuple[str, ...]:
    """The scene with the bodies that cannot move made part of the ground; sentences alone if there are none."""
    layout, mechanism = scene.layout, scene.mechanism
    workspace = workspace_of(layout)
    state, bodies = settled(workspace, layout, 0.0, layout.y0)
    search = ImmobilitySearch(
        layout, jacobian(workspace, layout, np.zeros(1), state[None, :]), idle_axes(scene, bodies["R"])
    )
    held, kept = immobile(search)
    if not held.any():
        return kept
    of = tuple(
        standing(layout, bodies, layout.place[i]) if held[layout.place[i]] else PlaceInBody(i, np.eye(3), np.zeros(3))
        for i in range(len(mechanism.bodies))
    )
    parts = Parts(of, tuple(i for i, part in enumerate(of) if part.body == i))
    smaller = restated(scene, parts, [mechanism.bodies[i] for i in parts.roots])
    places = slots(layout, smaller.layout, parts, resting(layout, held, state))
    begun = replace(smaller.layout, y0=places.restrict(0.0, layout.y0))
    names = [i for i, part in enumerate(of) if part.body == GROUND]
    verb = "is" if len(names) == 1 else "are"
    told = f"{listed(mechanism, names)} {verb} held by joints among themselves and with the ground, whatever else moves"
    told += " and acts: part of the ground"
    return Reduction(replace(smaller, layout=begun), places.embed, places.restrict, (told,), kept=kept)


@record
class ImmobilitySearch:
    """What the search for bodies that cannot move looks at: J at the start, the scene, and spins that are none.

    spins: of bodies, by their places in the tree, world axes (k, 3) about which they do not turn, though no joint holds
    them.
    """

    layout: Layout
    J: Jacobian
    spins: dict[int, Array]


def idle_axes(scene: PreparedScene, R: Array) -> dict[int, Array]:
    """World axes (k, 3) about which bodies rest for ever: no moment acts about them (multibody/reduction/spins.py)."""
    place = scene.layout.place
    found = {place[i]: spin.axis[None, :] for i, spin in spins_of(scene).items() if spin.rate == 0.0}
    found |= {place[spin.body]: spin.axes for spin in scene.idle}
    return {i: axes @ R[i].T for i, axes in found.items()}


def standing(layout: Layout, bodies: Table, place: int) -> PlaceInBody:
    """Where a body of the tree stands on the ground."""
    R, r = bodies["R"][place], bodies["r"][place]
    return PlaceInBody(GROUND, R, r - R @ layout.reference[place])


def resting(layout: Layout, held: Mask, state: Array) -> Array:
    """The state with the rates of the bodies that are held at zero."""
    state = state.copy()
    for group in layout.tables["groups"][: len(held)][held]:
        state[group["rates"] : group["end"]] = 0.0
    return state


def immobile(search: ImmobilitySearch) -> tuple[Mask, tuple[str, ...]]:
    """Which bodies, by their places in the tree, cannot move; why others were left that could be thought to be so."""
    layout = search.layout
    held = ~movable(layout)
    kept: dict[int, str] = {}
    while True:
        rooted(layout, held)
        moving = sorted({i for island in layout.islands for i in in_motion(search, island, held, kept)})
        moving = moving or ends_of_limits(layout, held, kept)
        if not moving:
            return held, tuple(kept[i] for i in sorted(kept))
        held[moving] = False


def movable(layout: Layout) -> Mask:
    """The bodies whose coordinates no closure can hold: they are in none, or driven, limited, coupled or named."""
    mechanism = layout.mechanism
    closed = {n for island in layout.islands for n in island.freedoms.tolist()}
    limited = {stop.joint for stop in mechanism.stops} | {k for own in mechanism.couplings for k in own.joints}
    named = {name for value in mechanism.expressions() for name, _ in value.uses}
    found = np.zeros(len(layout.bodies), dtype=bool)
    for i, h in enumerate(layout.spanning.hangs):
        found[i] = not closed.issuperset(freedoms_of(layout, i))
        if h.joint >= 0:
            joint = mechanism.joints[h.joint]
            found[i] |= varies(joint) or h.joint in limited or joint.name in named
    return found


def varies(joint: Joint) -> bool:
    """Whether a joint is driven along or about a coordinate that changes."""
    return joint.drive is not None and joint.drive.value.constant is None


def freedoms_of(layout: Layout, i: int) -> list[int]:
    """The answers of a body's freedoms that are not driven."""
    row = layout.bodies[i]
    own = layout.tables["freedoms"][row["first_freedom"] : row["end_freedom"]]
    ball = range(row["answer_at"], row["answer_at"] + 3) if row["ball"] else ()
    return [*ball, *own["answer_at"][own["driven"] == 0].tolist()]


def rooted(layout: Layout, held: Mask) -> None:
    """Take out what hangs on bodies that are not held."""
    for i, parent in enumerate(layout.bodies["parent"].tolist()):
        held[i] &= parent < 0 or held[parent]


def ends_of_limits(layout: Layout, held: Mask, kept: dict[int, str]) -> list[int]:
    """A body that is held by a rope or limited by a stop whose other end cannot move either: those end the run."""
    mechanism = layout.mechanism
    limited = {stop.joint for stop in mechanism.stops}
    for k, joint in enumerate(mechanism.joints):
        ends = [layout.place[i] for i in (joint.a, joint.b) if i != GROUND]
        if (joint.tension_only or k in limited) and ends and held[ends].all():
            name = mechanism.bodies[layout.spanning.hangs[max(ends)].body].name
            kept[max(ends)] = f"bodies.{name} cannot move, but stays: joints.{joint.name} may go slack, or is limited"
            return [max(ends)]
    for owner, own in enumerate(mechanism.couplings, len(mechanism.joints)):
        places = [layout.place[i] for i in own.bodies]
        if held[places].all():
            name = mechanism.bodies[layout.spanning.hangs[max(places)].body].name
            kept[max(places)] = f"bodies.{name} cannot move, but stays: {mechanism.owner(owner)} holds it as well"
            return [max(places)]
    return []


def in_motion(search: ImmobilitySearch, island: Island, held: Mask, kept: dict[int, str]) -> list[int]:
    """Of an island's bodies that are left those that can move, if the others do not."""
    layout = search.layout
    bodies = {i: free for i in np.flatnonzero(held).tolist() if (free := within(layout, island, i))}
    if not bodies:
        return []
    freedoms: Array = np.concatenate([np.array(free) for free in bodies.values()])
    rows: Array = np.array([r for r in island.rows.tolist() if lasting(layout, r, held)], dtype=int)
    A = scaled(search, island, rows, freedoms)
    basis = without_spins(search, bodies)
    _, sigma, Vt = np.linalg.svd(A @ basis, full_matrices=True)
    sigma = np.concatenate([sigma, np.zeros(len(Vt) - len(sigma))])
    largest = max(float(sigma.max(initial=0.0)), 1.0)
    loose = sigma <= tolerances.NEARLY_SINGULAR * largest
    share = np.abs(Vt[loose] @ basis.T).max(axis=0, initial=0.0)
    owner = np.repeat(np.array(list(bodies)), [len(free) for free in bodies.values()])
    moving = sorted({int(i) for i in owner[share > tolerances.MOVES]})
    if loose.any() and float(sigma.min()) > tolerances.RANK * largest:
        names = listed(layout.mechanism, [layout.spanning.hangs[i].body for i in moving])
        kept[moving[0]] = f"{names} could hardly move, but stay: {float(sigma.min()):.1g} is left of what holds them"
    return moving


def within(layout: Layout, island: Island, i: int) -> list[int]:
    """The freedoms of a body that are in an island."""
    own = freedoms_of(layout, i)
    return own if own and own[0] in set(island.freedoms.tolist()) else []


def lasting(layout: Layout, r: int, held: Mask) -> bool:
    """Whether a closure row is between bodies that are left and the ground, and holds them so at all times.

    Those of couplings are not asked: what they hold hangs on coordinates, or rolls.
    """
    if layout.rows[r] >= len(layout.mechanism.joints):
        return False
    row = layout.tables["closures"][r]
    one_sided = r in set(layout.tables["contacts"]["row"].tolist())
    ends = [int(row[end]) for end in ("a", "b") if row[end] >= 0]
    return bool(held[ends].all()) and not one_sided and not varies(layout.mechanism.joints[layout.rows[r]])


def scaled(search: ImmobilitySearch, island: Island, rows: Array, freedoms: Array) -> Array:
    """J of some of an island's rows and freedoms, as loads/redundancy/self_stress.py measures it, (rows, freedoms)."""
    couples, turns = np.isin(rows, island.rows[island.couples]), np.isin(freedoms, island.freedoms[island.turns])
    J = search.J.block(rows, freedoms)[0]
    J = J * np.where(couples, island.length, 1.0)[:, None] / np.where(turns, island.length, 1.0)
    return np.asarray(J / np.maximum(np.sqrt(np.sum(J * J, axis=1, keepdims=True)), 1.0))


def without_spins(search: ImmobilitySearch, bodies: dict[int, list[int]]) -> Array:
    """Unit motions, as columns (freedoms, n), of all freedoms but the spins that are none."""
    blocks = []
    for i, free in bodies.items():
        block = np.eye(len(free))
        if i in search.spins and search.layout.bodies["ball"][i]:
            axes = np.zeros((len(search.spins[i]), len(free)))
            axes[:, :3] = search.spins[i]
            block = np.linalg.svd(axes, full_matrices=True)[2][len(axes) :].T
        blocks.append(block)
    n = [block.shape for block in blocks]
    found = np.zeros((sum(rows for rows, _ in n), sum(columns for _, columns in n)))
    at = np.cumsum([(0, 0), *n], axis=0)
    for (row, column), block in zip(at[:-1].tolist(), blocks, strict=True):
        found[row : row + block.shape[0], column : column + block.shape[1]] = block
    return found
