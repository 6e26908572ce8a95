"""Contacts that touch: which strike, rest, let go. Small complementarity problems on columns of the one map.

    w = q + A z,   z >= 0,   w >= 0,   z . w = 0,      A = W M^-1 W'  (through all that holds both ways)
W are the contacts' unit loads, positive where they bear. Of impulses z, w are the rates of opening behind the blow and
those that Newton's restitution asks for: w = v+ + e v- of what is struck (v- < 0), v+ of what rests. Of forces z, w are
the accelerations of opening. A contact bears or opens, never both (Moreau 1988; Pfeiffer and Glocker 1996).
"""

from __future__ import annotations

import math

import numpy as np

from heuncli import tolerances
from heuncli.errors import Problem, SolveError
from heuncli.integration.contacts.complementarity import Pivots, complementary
from heuncli.integration.evaluator import Recovered
from heuncli.records import fields, record
from heuncli.results import Array, Indices, Mask
from heuncli.shapes.rotations import cross_rows
from heuncli.tree.layout import Contact, Layout
from heuncli.tree.tables import Table

OPEN, CLOSED, LEANS = 0.0, 1.0, 2.0  # of Trajectory.holding: open, closed, closed by others
MOST_ROUNDS = 60  # strikes that follow each other at one instant, before what is left of them is plastic


@record
class Touching:
    """The contacts that touch at a state.

    which (k,): places among the layout's; loads (k, n_b, 6): what each puts on the bodies where it bears 1, moment
    about the joint point and force; rate (k,): of opening; noise (k,): what rounding makes of it; reach (k,): of the
    gap; restitution (k,).
    """

    which: Indices
    loads: Array
    rate: Array
    noise: Array
    reach: Array
    restitution: Array

    def some(self, own: Indices) -> Touching:
        """Some of them."""
        return Touching(**{name: value[own] for name, value in fields(self).items()})


@record
class Struck:
    """Impulses of touching contacts (k,), the rates of opening behind them, and what is worth telling.

    depends (k,): those that others hold, so that how they share is not known; equal (k,): those that took the least
    restitution of all that feel each other; rounds (k,).
    """

    impulses: Array
    rate: Array
    depends: Mask
    equal: Mask
    rounds: Indices

    @property
    def closed(self) -> Mask:
        """Those that take part (k,)."""
        return np.asarray((self.impulses != 0.0) | self.depends)


def touching(layout: Layout, at: Recovered, closed: Mask, event: int | None, last: float) -> Touching:
    """The contacts that touch at a state: closed ones, the row of the event, and those with hardly a gap.

    What was closed until then opens with no rate; nor does what would stay within its reach over the run, up to `last`.
    """
    rows, bodies = at.rows[0], at.bodies[0]
    found = []
    for i, contact in enumerate(layout.contacts):
        gap = -contact.sense * float(rows["gap"][contact.row])
        near = tolerances.CONTACT_TOUCHES * terms_of_gap(layout, bodies, contact)
        if closed[i] or contact.row == event or gap <= near:
            found.append(i)
    own = [layout.contacts[i] for i in found]
    loads = np.array([unit_load(layout, bodies, rows, contact) for contact in own]).reshape(len(own), len(bodies), 6)
    motion = np.concatenate([bodies["omega"], bodies["v"]], axis=1)
    terms = np.array([terms_of_gap(layout, bodies, contact) for contact in own])
    reaches = tolerances.KERNEL["touching"] * terms
    turned, shifted = np.linalg.norm(loads[:, :, :3], axis=2), np.linalg.norm(loads[:, :, 3:], axis=2)
    speeds = turned @ np.linalg.norm(bodies["omega"], axis=1) + shifted @ np.linalg.norm(bodies["v"], axis=1)
    noise = tolerances.CONTACT_RATE * speeds
    return Touching(
        which=np.array(found, dtype=int),
        loads=loads,
        rate=np.where(closed[found], 0.0, np.einsum("kbi,bi->k", loads, motion)),
        noise=np.maximum(noise, reaches / (last or 1.0)),
        reach=reaches,
        restitution=np.array([contact.restitution for contact in own]),
    )


def terms_of_gap(layout: Layout, bodies: Table, contact: Contact) -> float:
    """The size of what a contact's gap is the sum of [m or rad]."""
    row = layout.tables["closures"][contact.row]
    Q = point(layout, bodies, contact)
    return (layout.size + math.sqrt(float(Q @ Q))) / float(row["weight"]) + abs(float(row["length"]))


def point(layout: Layout, bodies: Table, contact: Contact) -> Array:
    """World place of the `to` point, where a contact's force acts on both bodies."""
    row = layout.tables["closures"][contact.row]
    q: Array = np.array(row["q"].tolist())
    return q if row["b"] < 0 else bodies["r"][row["b"]] + bodies["R"][row["b"]] @ q


def unit_load(layout: Layout, bodies: Table, rows: Table, contact: Contact) -> Array:
    """What a contact that bears 1 puts on the bodies, (n_b, 6)."""
    row = layout.tables["closures"][contact.row]
    Q = point(layout, bodies, contact)
    f, m = (-contact.sense * rows[of][contact.row] for of in ("f", "m"))
    load = np.zeros((len(bodies), 6))
    for body, sign in ((int(row["b"]), 1.0), (int(row["a"]), -1.0)):
        if body >= 0:
            load[body, :3] += sign * (m + cross_rows(Q - bodies["r"][body], f))
            load[body, 3:] += sign * f
    return load


def answers(touch: Touching, columns: Table) -> Array:
    """Rates of opening that columns of jumps give, (k, n_c)."""
    motion = np.concatenate([columns["alpha"], columns["a"]], axis=2)
    return np.asarray(np.einsum("kbi,cbi->kc", touch.loads, motion))


def answerable(layout: Layout, touch: Touching, A: Array) -> Mask:
    """Whether something moves where a contact bears: else all that holds both ways holds it, too."""
    mass = layout.bodies["mass"]
    size = np.einsum("kbi,b->k", touch.loads[:, :, 3:] ** 2, 1.0 / mass)
    size += np.einsum("kbi,b->k", (touch.loads[:, :, :3] / layout.size) ** 2, 1.0 / mass)
    return np.asarray(np.diag(A) > tolerances.NO_ANSWER * size)


def strikes(touch: Touching, A: Array, moves: Mask, pressed: Array, plastic: Mask) -> Struck:
    """The impulses of contacts that are struck, or pressed by given blows (pressed: rates these add).

    What moves apart at the instant takes part only if it is struck in a later round. plastic: contacts that rest behind
    the blow, whatever their restitution, and though they would open by less than is seen. Contacts that do not feel
    each other are struck as if each were alone: what one machine loses does not hide what another would gain.
    """
    k = len(touch.which)
    none = np.zeros(k, dtype=bool)
    found = Struck(np.zeros(k), touch.rate.copy(), none.copy(), none.copy(), np.zeros(k, dtype=int))
    for own in feeling(A):
        part = struck_together(touch.some(own), A[np.ix_(own, own)], moves[own], pressed[own], plastic[own])
        for name, values in fields(part).items():
            getattr(found, name)[own] = values
    return found


def feeling(A: Array) -> list[Indices]:
    """The groups of contacts that feel each other, by what one that bears does to the other, in their order."""
    size = np.sqrt(np.maximum(np.diag(A), 0.0))
    felt = np.abs(A) > tolerances.SUM_ROUNDING * size[:, None] * size
    np.fill_diagonal(felt, True)
    for _ in range(len(A)):
        reached = felt @ felt
        if np.array_equal(reached, felt):
            break
        felt = reached
    return [np.flatnonzero(row) for k, row in enumerate(felt) if not row[:k].any()]


def struck_together(touch: Touching, A: Array, moves: Mask, pressed: Array, plastic: Mask) -> Struck:
    """The same of contacts that feel each other."""
    v = touch.rate.copy()
    total = np.zeros(len(v))
    depends = np.zeros(len(v), dtype=bool)
    noise, equal, rounds = touch.noise + tolerances.CONTACT_RATE * np.abs(pressed), False, 0
    while rounds < 2 * MOST_ROUNDS:
        struck = v < -noise
        if not (struck.any() or (v + pressed < -noise).any()):
            v = v + pressed  # blows that lift what rests, say
            break
        e = np.where(plastic | (rounds >= MOST_ROUNDS), 0.0, touch.restitution)
        own = np.flatnonzero((v <= noise) & moves)
        found = one_round(A, v, pressed, own, np.where(struck, e, 0.0), noise)
        z = spread(found.z, own, len(v))
        if gained(z, v, pressed, A) and struck.any():
            e = np.where(struck, e[struck].min(), 0.0)
            found = one_round(A, v, pressed, own, e, noise)
            z, equal = spread(found.z, own, len(v)), True
        depends[own[found.depends]] = True
        rebound, bears = np.where(struck, -e * v, 0.0), own[found.bears]
        v = v + pressed + A @ z
        v[bears] = rebound[bears]
        pressed = np.zeros(len(v))
        total += z
        rounds += 1
        noise = np.maximum(noise, tolerances.CONTACT_RATE * (np.abs(A) @ total))
    v = np.where(np.abs(v) <= noise, 0.0, v)
    if (plastic & (v > 0.0)).any():
        own = np.flatnonzero(moves & (v == 0.0) & (total > 0.0) | plastic & (v > 0.0))
        total[own] -= np.linalg.lstsq(A[np.ix_(own, own)], v[own], rcond=tolerances.CONTACT_DEPENDS)[0]
        v[own] = 0.0
    every = np.ones(len(v), dtype=bool)
    return Struck(total, v, depends & (total == 0.0), equal & every, rounds * every)


def one_round(A: Array, v: Array, pressed: Array, own: Indices, e: Array, noise: Array) -> Pivots:
    """Impulses of one round: those that leave v+ >= -e v-."""
    q = (v + pressed + e * v)[own]
    return complementary(A[np.ix_(own, own)], q, noise[own])


def spread(z: Array, own: Indices, n: int) -> Array:
    """Values of some contacts, 0 of the others."""
    out = np.zeros(n)
    out[own] = z
    return out


def gained(z: Array, v: Array, pressed: Array, A: Array) -> bool:
    """Whether impulses add energy: work by the mean of the rates before and behind, beyond rounding."""
    work = 0.5 * z * (2.0 * v + pressed + A @ z)
    return bool(work.sum() > tolerances.SUM_ROUNDING * np.abs(work).sum())


def rests(touch: Touching, A: Array, moves: Mask, rate: Array, at: Recovered, layout: Layout) -> tuple[Array, Array]:
    """Which of the touching contacts are held from here on (k,), and the accelerations of opening of all (k,).

    at: the state behind all blows, every contact open. What rests is what does not open with a rate.
    """
    contacts = [layout.contacts[i] for i in touch.which.tolist()]
    rows = at.rows[0]
    q = np.array([-c.sense * float(rows["acceleration"][c.row]) for c in contacts])
    noise = tolerances.CONTACT_ACCELERATION * acceleration_terms(layout, touch, A, at)
    still = rate == 0.0
    own = np.flatnonzero(still & moves)
    found = complementary(A[np.ix_(own, own)], q[own], noise[own])
    holding = np.full(len(contacts), OPEN)
    holding[own[found.bears]] = CLOSED
    holding[own[found.depends]] = LEANS
    holding[still & ~moves] = LEANS
    return holding, q + A @ spread(found.z, own, len(contacts))


def acceleration_terms(layout: Layout, touch: Touching, A: Array, at: Recovered) -> Array:
    """Sizes of the terms that accelerations of opening are sums of (k,): of motion, and of all loads and weights.

    Where a contact lets go these cancel: what bears nothing is known to the rounding of what it bore.
    """
    rows = [layout.contacts[i].row for i in touch.which.tolist()]
    weights = float(layout.bodies["mass"].sum() * np.abs(layout.mechanism.gravity).sum())
    load = weights + float(np.abs(at.loads["force"][0]).sum() + np.abs(at.loads["moment"][0]).sum() / layout.size)
    weight = layout.tables["closures"]["weight"][rows]
    return np.asarray(at.rows["terms"][0, rows] + np.diag(A) * weight * load)


def short_flights(touch: Touching, rate: Array, acceleration: Array, instant: float) -> Mask:
    """Whether what rebounds comes back before it is seen to leave: u^2 / 2 a within the rounding of its gap.

    Or in less time than instants are told apart.
    """
    a = -acceleration
    falls = (rate > 0.0) & (a > 0.0)
    a = np.where(falls, a, 1.0)
    return np.asarray(falls & ((rate * rate <= 2.0 * a * touch.reach) | (2.0 * rate <= a * instant)))


def undecided(t: float, name: str) -> SolveError:
    """The problem of contacts that follow each other at one instant without an end; name: of the one most struck."""
    message = f"at t = {t:.9g} s stops and ropes strike and let go again and again without the time going on"
    hint = "contacts that work against each other: loosen one of them"
    return SolveError(Problem("chattering", message, hint=hint, about=name))
