"""The contacts that touch at a state: their loads, their rates of opening, and what rounding makes of both."""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np

from heuncli.base import tolerances
from heuncli.base.records import fields, record
from heuncli.kernel.choose import scene as kernel
from heuncli.motion.integration.evaluator import Recovered
from heuncli.multibody.tree.layout import Contact, Layout
from heuncli.multibody.tree.tables import Table
from heuncli.results.results import Array, Indices, Mask
from heuncli.scene.shapes.rotations import cross_rows

OPEN, CLOSED, LEANS = 0.0, 1.0, 2.0  # of Trajectory.holding: open, closed, closed by others


@record
class Touching:
    """The contacts that touch at a state.

    which (k,): places among the layout's; loads (k, n_b, 6): what each puts on the bodies where it bears 1, moment
    about the joint point and force; rate (k,): of opening; noise (k,): what rounding makes of it; reach (k,): of the
    gap; restitution (k,); length (k,): what the unit of the gap is of a length [m].
    """

    which: Indices
    loads: Array
    rate: Array
    noise: Array
    reach: Array
    restitution: Array
    length: Array

    def some(self, own: Indices | Mask) -> Touching:
        """Some of them."""
        return Touching(**{name: value[own] for name, value in fields(self).items()})


def touching(layout: Layout, at: Recovered, closed: Mask, event: int | None, last: float) -> Touching:
    """The contacts that touch at a state: closed ones, the row of the event, and those with hardly a gap.

    What was closed until then opens with no rate; nor does what would stay within its reach over the run, up to `last`.
    """
    rows, bodies = at.rows[0], at.bodies[0]
    found = []
    for i, contact in enumerate(layout.contacts):
        if contact.sense == 0:
            continue  # a latch
        gap = -contact.sense * float(rows["gap"][contact.row])
        near = tolerances.CONTACT_TOUCHES * terms_of_gap(layout, bodies, contact)
        if closed[i] or contact.row == event or gap <= near:
            found.append(i)
    own = [layout.contacts[i] for i in found]
    loads = np.array([unit_load(layout, at, contact, -contact.sense) for contact in own])
    loads = loads.reshape(len(own), len(bodies), 6)
    motion = np.concatenate([bodies["omega"], bodies["v"]], axis=1)
    terms = np.array([terms_of_gap(layout, bodies, contact) for contact in own])
    reaches = tolerances.KERNEL["touching"] * terms
    turned, shifted = np.linalg.norm(loads[:, :, :3], axis=2), np.linalg.norm(loads[:, :, 3:], axis=2)
    speeds = turned @ np.linalg.norm(bodies["omega"], axis=1) + shifted @ np.linalg.norm(bodies["v"], axis=1)
    noise = tolerances.CONTACT_RATE * speeds
    return Touching(
        which=np.array(found, dtype=int),
        loads=loads,
        rate=np.where(closed[found], 0.0, np.einsum("kbi,bi->k", loads, motion) + paid_out(layout, own, at)),
        noise=np.maximum(noise, reaches / (last or 1.0)),
        reach=reaches,
        restitution=np.array([contact.restitution for contact in own]),
        length=layout.tables["closures"]["weight"][[contact.row for contact in own]],
    )


def paid_out(layout: Layout, contacts: Sequence[Contact], at: Recovered) -> Array:
    """How fast a law in time makes contacts open: of a rope that is paid out its rate, of others 0."""
    laws = {law.owner: law.value for law in layout.mechanism.laws}
    driven = layout.tables["closures"]["program"]["count"] > 0
    t = float(at.times[0])
    rates = [c.sense * laws[c.joint].derivatives(t)[1] if driven[c.row] else 0.0 for c in contacts]
    return np.array(rates).reshape(len(contacts))


def terms_of_gap(layout: Layout, bodies: Table, contact: Contact) -> float:
    """The size of what a contact's gap is the sum of [m or rad]."""
    row = layout.tables["closures"][contact.row]
    places = [point(bodies, part) for part in conditions(layout, contact.row) if part["kind"] not in LYING]
    far = sum(layout.size + math.sqrt(float(Q @ Q)) for Q in places)
    return far / float(row["weight"]) + abs(float(row["length"]))


LYING = (kernel.ARC, kernel.WOUND)  # what of a rope lies on its sheaves, which loads nothing


def conditions(layout: Layout, row: int) -> Table:
    """The conditions of two bodies that a closure row is the sum of; its own, where it is none."""
    own = layout.tables["closures"][row]
    if own["kind"] != kernel.SUM:
        return layout.tables["closures"][row : row + 1]
    return layout.tables["parts"][own["part"] : own["part"] + own["part_count"]]


def point(bodies: Table, row: Table) -> Array:
    """World place of the `to` point of a condition of two bodies."""
    q: Array = np.array(row["q"].tolist())
    return q if row["b"] < 0 else bodies["r"][row["b"]] + bodies["R"][row["b"]] @ q


def unit_load(layout: Layout, at: Recovered, contact: Contact, way: float) -> Array:
    """What a contact whose multiplier is `way` puts on the bodies, (n_b, 6)."""
    bodies, own = at.bodies[0], layout.tables["closures"][contact.row]
    load = np.zeros((len(bodies), 6))
    for k, row in enumerate(conditions(layout, contact.row), int(own["part"])):
        if own["kind"] == kernel.SUM:
            Q, f, m = (at.parts[of][0, k] for of in ("Q", "f", "m"))
        else:
            Q, f, m = point(bodies, row), at.rows["f"][0, contact.row], at.rows["m"][0, contact.row]
        f, m = way * f, way * m
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


def spread(z: Array, own: Indices, n: int) -> Array:
    """Values of some contacts, 0 of the others."""
    out = np.zeros(n)
    out[own] = z
    return out
