"""Scale the columns of an impulse, correct their sum, and bring to rest what moves by rounding alone."""

from __future__ import annotations

import numpy as np

from heuncli.base import tolerances
from heuncli.motion.integration.contacts.touching import TouchingContacts
from heuncli.multibody.response import Columns
from heuncli.multibody.tree.layout import Layout
from heuncli.multibody.tree.tables import Table
from heuncli.results.results import Array


def scale_columns(layout: Layout, units: Columns, contacts_touching: TouchingContacts, impulses: Array) -> Columns:
    """Return the columns of what is given and those of the contacts times their impulses, each with its own
    multiplier.
    """
    n = len(units.multipliers) - len(impulses)
    factors = np.concatenate([np.ones(n), impulses])

    def scale_table(table: Table) -> Table:
        out = table.copy()
        for name in table.dtype.names or ():
            out[name] = table[name] * factors.reshape(-1, *([1] * (table[name].ndim - 1)))
        return out

    multipliers = units.multipliers * factors[:, None]
    for k, i in enumerate(contacts_touching.indices.tolist()):
        contact = layout.contacts[i]
        multipliers[n + k, contact.row] -= contact.sense * impulses[k]
    return Columns(scale_table(units.bodies), scale_table(units.freedoms), multipliers)


def distribute_remainder(columns: Columns, exact_sum: Columns, place: int) -> None:
    """Add to the column at a place, in place, what the sum of all columns lacks of an exact one.

    column += exact sum - sum of all columns
    """
    total = columns.sum()
    for part in ("bodies", "freedoms"):
        table, right, summed = (getattr(x, part) for x in (columns, exact_sum, total))
        for name in table.dtype.names or ():
            table[name][place] += right[name][0] - summed[name]
    columns.multipliers[place] += exact_sum.multipliers[0] - total.multipliers


def bring_to_rest(layout: Layout, before_state: Array, after_state: Array) -> None:
    """Set rates after an impulse to zero, in place, where they are rounding of those before: what stands still has
    no motion.
    """
    for group in layout.tables["groups"]:
        rates = slice(group["rates"], group["end"])
        if group["rates"] < group["end"] and group["coordinates"] < group["rates"]:
            largest = np.abs(before_state[rates] * layout.weights[rates]).max()
            if np.abs(after_state[rates] * layout.weights[rates]).max() <= tolerances.SUM_ROUNDING * largest:
                after_state[rates] = 0.0
