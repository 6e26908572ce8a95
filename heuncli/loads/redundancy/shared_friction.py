"""Mark what is indeterminate where several frictions stick together (motion/integration/contacts/friction_groups.py).

Such frictions hold one degree of freedom together, and nothing decides what each contributes. The contributions change
joints, sections and supports by self-stresses (self_stress.py). This module marks the values of the frictions, and
finds the sum of them that is determinate:

    sum of t_i value_i,  t_i the ratio of the rate of friction i to that of the group's leader
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from heuncli.base import tolerances
from heuncli.base.errors import Problem, SolveError
from heuncli.base.records import replace
from heuncli.loads.kinetostatics.actions import AppliedLoad
from heuncli.loads.kinetostatics.foundation import ElementKeys
from heuncli.loads.redundancy.indeterminate_components import mask_indeterminate
from heuncli.motion.integration.evaluator import Evaluation
from heuncli.multibody.tree.layout import Layout
from heuncli.results.results import Array, Block, DeterminateSum, Mask


def find_shared(layout: Layout, solutions: Evaluation) -> Mask:
    """Return which frictions that may stick do so with others, (n_t, k)."""
    return np.asarray(layout.read_groups(solutions.holding)[0] >= 0)


def mark_values(layout: Layout, solutions: Evaluation, loads: Sequence[AppliedLoad]) -> list[AppliedLoad]:
    """Return applied loads with nan as the value of each friction while it sticks with others."""
    is_shared = find_shared(layout, solutions)
    shared_by_name = {name: is_shared[:, k] for k, name in enumerate(list_names(layout))}
    return [
        replace(own, value=mask_indeterminate(own.value, shared_by_name[own.load.path]))
        if own.load.path in shared_by_name
        else own
        for own in loads
    ]


def list_names(layout: Layout) -> list[str]:
    """List the paths of the frictions that may stick."""
    return [layout.contacts[i].name for i in layout.friction_contacts]


def mark_elements(layout: Layout, solutions: Evaluation, elements: Block, keys: ElementKeys) -> None:
    """Mark the loads that such frictions put on the ground, in place; they act along the axes of their joints."""
    is_shared = find_shared(layout, solutions)
    for k, i in enumerate(layout.friction_contacts):
        block, _, name = layout.contacts[i].name.partition(".")
        element = elements.get(keys.get((block, name), ""))
        if element is None or not is_shared[:, k].any():
            continue
        rows = solutions.rows[:, layout.contacts[i].row]
        for quantity, unit in (("force", rows["f"]), ("moment", rows["m"])):
            is_open = is_shared[:, k, None] & (np.abs(unit) > tolerances.OPEN_SHARE)
            element[quantity] = mask_indeterminate(element[quantity], is_open)


def find_friction_sums(layout: Layout, solutions: Evaluation) -> list[DeterminateSum]:
    """Find the determinate sum of the frictions of each group; 0 at instants at which it does not stick."""
    leaders, transmissions = layout.read_groups(solutions.holding)
    names = list_names(layout)
    values = solutions.loads["value"][:, [layout.contacts[i].load_row for i in layout.friction_contacts]]
    groups = {tuple(np.flatnonzero(row == leader)) for row in leaders for leader in set(row.tolist()) - {-1}}
    sums: list[DeterminateSum] = []
    for members in sorted(groups):
        leader = leaders[:, members]
        is_held = (leader >= 0).all(axis=1) & (leader == leader[:, :1]).all(axis=1)
        is_held &= (leaders == leader[:, :1]).sum(axis=1) == len(members)
        factors = np.where(is_held[:, None], transmissions[:, members], 0.0)
        total: Array = sum((c * values[:, k] for c, k in zip(factors.T, members, strict=True)), np.zeros(1))
        terms = {f"{names[k]}.value": simplify_factor(c) for c, k in zip(factors.T, members, strict=True)}
        first = int(leader[np.argmax(is_held), 0])
        is_moment = bool(solutions.rows["m"][0, layout.contacts[first].row].any())
        sums.append({"terms": terms, "value": total, "unit": "N·m" if is_moment else "N"})
    return sums


def simplify_factor(factors: Array) -> float | Array:
    """Return factors (n_t,) as one number where they are all the same."""
    return float(factors[0]) if (factors == factors[0]).all() else factors


def require_no_split(layout: Layout, solutions: Evaluation, what: str) -> None:
    """Raise SolveError where frictions stick as one and something is asked for that depends on how they share."""
    is_shared = find_shared(layout, solutions)
    instants = np.flatnonzero(is_shared.any(axis=1))
    if not len(instants):
        return
    names = [name for name, is_own in zip(list_names(layout), is_shared[instants[0]], strict=True) if is_own]
    message = (
        f"at t = {solutions.times[instants[0]]:.9g} s {', '.join(names)} stick as one; {what} depends on their shares"
    )
    hint = "leave it out; or let friction stick in one joint of each degree of freedom, and smooth the others: speed"
    raise SolveError(Problem("friction-indeterminate", message, hint=hint, entry_path=names[0]))
