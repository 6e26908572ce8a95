"""Find the contacts that touch at a state: their loads, their rates of opening, and the rounding error of both."""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np

from heuncli.base import tolerances
from heuncli.base.records import fields, record
from heuncli.kernel.choose import scene as kernel
from heuncli.motion.integration.evaluator import Evaluation
from heuncli.multibody.tree.layout import Contact, Layout
from heuncli.multibody.tree.tables import Table
from heuncli.results.results import Array, Indices, Mask
from heuncli.scene.shapes.rotations import cross_rows

ON_SHEAVE = (kernel.ARC, kernel.WOUND)  # the parts of a rope on its sheaves, which load nothing


@record
class TouchingContacts:
    """The contacts that touch at a state.

    indices (k,): numbers among the layout's contacts
    loads (k, n_b, 6): load on the bodies if the contact bears 1; moment about the joint point and force
    rate (k,): rates of opening
    noise (k,): rounding error of the rates
    reach (k,): rounding error of the gaps
    restitution (k,): coefficients of restitution
    length (k,): ratio of the unit of the gap to a length [m]
    """

    indices: Indices
    loads: Array
    rate: Array
    noise: Array
    reach: Array
    restitution: Array
    length: Array

    def select(self, selection: Indices | Mask) -> TouchingContacts:
        """Select some of them."""
        return TouchingContacts(**{name: value[selection] for name, value in fields(self).items()})


def find_touching(
    layout: Layout, evaluation: Evaluation, is_closed: Mask, event_row: int | None, end_time: float
) -> TouchingContacts:
    """Find the contacts that touch at a state: closed ones, the one whose row caused the event, and those with hardly a
    gap.

    A closed contact has no rate of opening. Nor has one that opens so slowly that up to `end_time` it would stay within
    the rounding of its gap.
    """
    rows, bodies = evaluation.rows[0], evaluation.bodies[0]
    numbers = []
    for i, contact in enumerate(layout.contacts):
        if contact.sense == 0:
            continue  # a latch
        gap = -contact.sense * float(rows["gap"][contact.row])
        tolerance = tolerances.CONTACT_TOUCHES * find_gap_term_size(layout, bodies, contact)
        if is_closed[i] or contact.row == event_row or gap <= tolerance:
            numbers.append(i)
    contacts = [layout.contacts[i] for i in numbers]
    loads = np.array([make_unit_load(layout, evaluation, contact, -contact.sense) for contact in contacts])
    loads = loads.reshape(len(contacts), len(bodies), 6)
    motion = np.concatenate([bodies["omega"], bodies["v"]], axis=1)
    terms = np.array([find_gap_term_size(layout, bodies, contact) for contact in contacts])
    reaches = tolerances.KERNEL["touching"] * terms
    moments, forces = np.linalg.norm(loads[:, :, :3], axis=2), np.linalg.norm(loads[:, :, 3:], axis=2)
    speeds = moments @ np.linalg.norm(bodies["omega"], axis=1) + forces @ np.linalg.norm(bodies["v"], axis=1)
    noise = tolerances.CONTACT_RATE * speeds
    return TouchingContacts(
        indices=np.array(numbers, dtype=int),
        loads=loads,
        rate=np.where(
            is_closed[numbers],
            0.0,
            np.einsum("kbi,bi->k", loads, motion) + find_prescribed_opening_rate(layout, contacts, evaluation),
        ),
        noise=np.maximum(noise, reaches / (end_time or 1.0)),
        reach=reaches,
        restitution=np.array([contact.restitution for contact in contacts]),
        length=layout.tables["closures"]["weight"][[contact.row for contact in contacts]],
    )


def find_prescribed_opening_rate(layout: Layout, contacts: Sequence[Contact], evaluation: Evaluation) -> Array:
    """Return how fast a prescribed motion makes contacts open: the rate of a rope that is paid out, 0 for others."""
    laws = {law.owner: law.value for law in layout.mechanism.laws}
    is_driven = layout.tables["closures"]["program"]["count"] > 0
    t = float(evaluation.times[0])
    rates = [c.sense * laws[c.joint].derivatives(t)[1] if is_driven[c.row] else 0.0 for c in contacts]
    return np.array(rates).reshape(len(contacts))


def find_gap_term_size(layout: Layout, bodies: Table, contact: Contact) -> float:
    """Return the sum of the magnitudes of the terms of a contact's gap [m or rad], the scale of its rounding."""
    row = layout.tables["closures"][contact.row]
    places = [
        world_point(bodies, part) for part in find_conditions(layout, contact.row) if part["kind"] not in ON_SHEAVE
    ]
    extent = sum(layout.size + math.sqrt(float(Q @ Q)) for Q in places)
    return extent / float(row["weight"]) + abs(float(row["length"]))


def find_conditions(layout: Layout, row: int) -> Table:
    """Return the conditions between two bodies that a closure row is the sum of; the row itself if it is no sum."""
    closure = layout.tables["closures"][row]
    if closure["kind"] != kernel.SUM:
        return layout.tables["closures"][row : row + 1]
    return layout.tables["parts"][closure["part"] : closure["part"] + closure["part_count"]]


def world_point(bodies: Table, row: Table) -> Array:
    """Return the world position of the `to` point of a condition between two bodies."""
    q: Array = np.array(row["q"].tolist())
    return q if row["b"] < 0 else bodies["r"][row["b"]] + bodies["R"][row["b"]] @ q


def make_unit_load(layout: Layout, evaluation: Evaluation, contact: Contact, multiplier: float) -> Array:
    """Return the load on the bodies of a contact with a given multiplier, (n_b, 6).

    Moments are about the joint points; the last three are the forces.
    """
    bodies, closure = evaluation.bodies[0], layout.tables["closures"][contact.row]
    load = np.zeros((len(bodies), 6))
    for k, row in enumerate(find_conditions(layout, contact.row), int(closure["part"])):
        if closure["kind"] == kernel.SUM:
            # f and m of a part contain its factor in the sum
            Q, f, m = (evaluation.parts[name][0, k] for name in ("Q", "f", "m"))
        else:
            Q, f, m = (
                world_point(bodies, row),
                evaluation.rows["f"][0, contact.row],
                evaluation.rows["m"][0, contact.row],
            )
        f, m = multiplier * f, multiplier * m
        for body, sign in ((int(row["b"]), 1.0), (int(row["a"]), -1.0)):
            if body >= 0:
                load[body, :3] += sign * (m + cross_rows(Q - bodies["r"][body], f))
                load[body, 3:] += sign * f
    return load


def find_opening_rates(touching: TouchingContacts, columns: Table) -> Array:
    """Return the rates of opening that columns of jumps give, (k, n_c)."""
    motion = np.concatenate([columns["alpha"], columns["a"]], axis=2)
    return np.asarray(np.einsum("kbi,cbi->kc", touching.loads, motion))


def find_free_response(layout: Layout, loads: Array) -> Array:
    """Return the order of the rates (k,) that unit impulses at contacts would give free bodies; loads (k, n_b, 6)."""
    mass = layout.mechanism.scale_masses[[link.body for link in layout.spanning.links]]
    size = np.einsum("kbi,b->k", loads[:, :, 3:] ** 2, 1.0 / mass)
    size += np.einsum("kbi,b->k", (loads[:, :, :3] / layout.size) ** 2, 1.0 / mass)
    return np.asarray(size)


def can_move_bodies(layout: Layout, touching: TouchingContacts, A: Array) -> Mask:
    """Return whether each contact could move a body if it bore a load, (k,); if not, bilateral constraints hold all
    that it pushes.
    """
    return np.asarray(np.diag(A) > tolerances.NO_ANSWER * find_free_response(layout, touching.loads))


def scatter(z: Array, indices: Indices, n: int) -> Array:
    """Return n values: those given at some indices, 0 elsewhere."""
    out = np.zeros(n)
    out[indices] = z
    return out
