"""Judge the results as a whole: make their block `accuracy`, and refuse numbers that are not finite.

Errors are estimated while the motion is checked (study/solve/load_errors.py). `nan` marks what no law decides (`null`
in JSON): indeterminate loads of joints and sections, axes and lines that a wrench does not have, and numbers that
rounding decides close to a singular pose. Everything else is a number.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping
from typing import Any

import numpy as np

from heuncli.base.errors import Problem, SolveError
from heuncli.loads.kinetostatics.balance import balance_residual, energy_drift, find_power_imbalance, find_work_scale
from heuncli.motion.integration.contacts.impulses import compute_free_impulse_energy
from heuncli.results.path_words import find_quantity
from heuncli.results.results import Accuracy, Array, Mask, Results
from heuncli.results.results_schema import IMPULSES, REPORT_OF, SPACE, Quantity
from heuncli.study.compose.recovery import ENERGY_REPORTS, Recovery
from heuncli.study.model.setup import Setup
from heuncli.study.solve.history import History


def make_accuracy(history: History, balance: Balance, impulse_residual: float = 0.0) -> Accuracy:
    """Make the block `accuracy` of a run at the instants of `balance`.

    impulse_residual: the residual of d'Alembert's principle at its impulses, relative to the largest impulse
    """
    checked, scene = history.checked_run, balance.setup.scene
    free_energy = sum(compute_free_impulse_energy(scene.layout, jump.impulses) for jump in history.impulses)
    known = balance.to_accuracy(checked.kinetic if checked is not None else 0.0, free_energy)
    known["balance_residual"] = max(known["balance_residual"], impulse_residual)
    gap = checked.run.gap if checked is not None else scene.start.gap
    return known | {
        "constraint_gap": max(known["constraint_gap"], gap),
        "horizon": checked.horizon if checked is not None else None,
        "estimate": history.estimate,
    }


class Balance:
    """How well the instants of a run balance, over those added so far, ascending: energy, closures, d'Alembert's
    principle.
    """

    def __init__(self, setup: Setup, span: float | None = None) -> None:
        """span: duration of a run that was not integrated [s]: its work is the gain of energy by definition, so powers
        are compared instead.

        Energy is checked only if it is requested.
        """
        self.setup, self.span = setup, span
        self.checks_energy = bool(ENERGY_REPORTS & setup.selection.reports)
        self.gap = self.residual = 0.0
        self.start: float | None = None  # energy less work at the first instant [J]
        self.change = self.kinetic = self.imbalance = 0.0  # the largest [J]
        self.loads: list[tuple[float, float]] = []  # the largest force and moment of each

    def add(self, recovery: Recovery) -> Balance:
        """Add instants; returns itself."""
        mechanism, size = self.setup.scene.mechanism, self.setup.scene.layout.size
        if self.checks_energy:
            self.add_energy(recovery)
        self.gap = take_larger(self.gap, float(recovery.solutions.gap.max(initial=0.0)))
        residual = balance_residual(mechanism, recovery.states, recovery.inertia, recovery.actions, size)
        self.residual = take_larger(self.residual, residual)
        return self

    def add_energy(self, recovery: Recovery) -> None:
        """Add the energy of instants, or their powers."""
        if self.span is not None:
            joints, layout = recovery.joints, self.setup.scene.layout
            power_error = find_power_imbalance(
                layout, recovery.states, recovery.loads, joints, recovery.couplings, self.span
            )
            self.imbalance = take_larger(self.imbalance, power_error)
            acting = [(largest_magnitude(x.force), largest_magnitude(x.moment)) for x in recovery.law_actions]
            largest_so_far = self.loads or [(0.0, 0.0)] * len(acting)
            self.loads = [
                (take_larger(F, f), take_larger(M, m)) for (F, M), (f, m) in zip(largest_so_far, acting, strict=True)
            ]
        energy = recovery.energy
        total = energy["kinetic"] + energy["potential"] - energy["work"]
        self.start = float(total[0]) if self.start is None else self.start
        self.change = take_larger(self.change, largest_magnitude(total - self.start))
        self.kinetic = take_larger(self.kinetic, float(energy["kinetic"].max(initial=0.0)))

    def to_accuracy(self, kinetic: float = 0.0, impulse_energy: float = 0.0) -> Accuracy:
        """Return the part of the block `accuracy` that instants decide.

        kinetic: the run's largest [J], which the requested instants may not show
        impulse_energy: the energy that the given impulses would bring to free bodies [J]
        """
        found, mechanism, size = Accuracy(), self.setup.scene.mechanism, self.setup.scene.layout.size
        if self.checks_energy:
            lift = (
                sum(body.mass for body in mechanism.bodies) * float(np.abs(mechanism.gravity).max()) * size
                + impulse_energy
            )
            if self.span is not None:
                lift += find_work_scale(mechanism, self.loads, size, self.span)
            change = self.change if self.span is None else self.imbalance
            found["energy_drift"] = energy_drift(change, max(kinetic, self.kinetic), lift)
        return found | {"constraint_gap": self.gap, "balance_residual": self.residual}


def take_larger(so_far: float, value: float) -> float:
    """Return the larger of the two; nan stays nan."""
    return float(np.maximum(so_far, value))


def largest_magnitude(values: Array) -> float:
    """Return the largest magnitude."""
    return float(np.abs(values).max(initial=0.0))


# paths that may be nan: indeterminate loads, and the axis or line of a wrench that has none
MAY_BE_NAN = (
    "joints.JOINT.", "sensors.", "stops.", "couplings.", "sections.", "foundation.supports.", "foundation.elements.",
    "foundation.axis.", "bodies.BODY.rodrigues",
)  # fmt: skip
BLOCKS = ("time", *REPORT_OF, IMPULSES, "events", "certain_sums", "accuracy")  # causes before what follows from them
NumericLeaves = Iterator[tuple[tuple[str, ...], Any, Mapping[str, Any]]]


def require_finite(results: Results) -> Results:
    """Return the results. Raises SolveError with the first path whose number is neither finite nor indeterminate."""
    unknown = results.accuracy.get("unknown", ())
    is_known = ~np.isin(results.time, unknown) if len(unknown) else np.ones(len(results.time), dtype=bool)
    blocks = vars(results)
    require_finite_blocks({name: blocks[name] for name in BLOCKS if len(blocks[name])}, results.time, is_known)
    return results


def require_finite_blocks(blocks: Mapping[str, Any], times: Array, is_known: Mask) -> None:
    """Raise SolveError with the first path in some blocks of results that is neither finite nor indeterminate.

    times, is_known (n_t,): the instants, and those at which all numbers are known
    """
    if is_all_finite(blocks):
        return
    for keys, value, block in iter_numbers(blocks, (), {}):
        if is_wrong(keys, value, block, is_known):
            instant = describe_instant(keys, value, times, is_known)
            message = f"{'.'.join(keys)} is not finite{instant}"
            hint = "check for very large or very small values, and for points that coincide"
            raise SolveError(Problem("not-finite-result", message, hint=hint))


def is_all_finite(node: Any) -> bool:
    """Return whether all numbers below a node of the results are finite, as they are where nothing is indeterminate."""
    if isinstance(node, np.ndarray):
        return node.dtype.kind != "f" or bool(np.isfinite(node).all())
    if isinstance(node, float):
        return math.isfinite(node)
    if isinstance(node, list | tuple):
        return all(map(is_all_finite, node))
    return not isinstance(node, Mapping) or all(map(is_all_finite, node.values()))


def iter_numbers(node: Any, keys: tuple[str, ...], block: Mapping[str, Any]) -> NumericLeaves:
    """Yield the arrays and numbers below a node of the results: their path, value, and block."""
    if isinstance(node, float | np.ndarray):
        yield keys, node, block
    elif isinstance(node, Mapping):
        for name, member in node.items():
            yield from iter_numbers(member, (*keys, name), node)
    elif isinstance(node, list | tuple) and node and not isinstance(node[0], str):
        for i, member in enumerate(node):
            yield from iter_numbers(member, (*keys, str(i)), block)


def is_wrong(keys: tuple[str, ...], value: Array | float, block: Mapping[str, Any], is_known: Mask) -> bool:
    """Return whether a number is neither finite nor indeterminate."""
    if isinstance(value, float) and math.isfinite(value):
        return False
    array = np.asarray(value)
    if array.dtype.kind != "f" or np.isfinite(array).all():
        return False
    if np.isinf(array).any():
        return True
    row = find_quantity(keys)
    if row is None:
        return True
    path = row.path.removeprefix("impulses.NUMBER.")
    if row.is_timed and keys[0] != IMPULSES and len(array) == len(is_known):
        array = array[is_known]
    if not path.startswith(MAY_BE_NAN):  # a load may be nan only if it is friction that sticks together with others
        return bool(np.isnan(array).any()) and not (path == "forces.FORCE.value" and "value" in block.get("open", ()))
    return (
        "open" in block
        and path.startswith("joints.")
        and bool((find_nan(array, row) & ~find_named_open(row, block)).any())
    )


def find_nan(array: Array, row: Quantity) -> Mask:
    """Mark each component of a quantity that is nan at some instant: (3,) for a vector, else (1,)."""
    return np.asarray(np.isnan(array).reshape(-1, 3 if row.shape == (SPACE,) else 1).any(axis=0))


def find_named_open(row: Quantity, block: Mapping[str, Any]) -> Mask:
    """Mark each component of a joint's load that its block lists as indeterminate."""
    name = row.path.rpartition(".")[2]
    names = [f"{name}.{c}" for c in SPACE.letters] if row.shape == (SPACE,) else [name]
    return np.array([name in block["open"] for name in names])


def describe_instant(keys: tuple[str, ...], value: Array | float, times: Array, is_known: Mask) -> str:
    """Describe the first instant at which a number is not finite; empty for numbers without instants."""
    row = find_quantity(keys)
    if row is None or not row.is_timed or keys[0] == IMPULSES or not isinstance(value, np.ndarray):
        return ""
    is_wrong_at = ~np.isfinite(value).reshape(len(value), -1).all(axis=1) & is_known
    return f" at t = {times[int(np.argmax(is_wrong_at))]:.6g} s" if is_wrong_at.any() else ""
