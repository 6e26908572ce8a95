"""Make the block `accuracy` of the results: balance of bodies and impulses, energy, closure of joints, estimated
errors, the horizon.

The estimates are made while the motion is checked (study/solve/load_errors.py).
"""

from __future__ import annotations

import numpy as np

from heuncli.loads.kinetostatics.balance import balance_residual
from heuncli.loads.kinetostatics.energy import energy_drift, power_imbalance, work_scale
from heuncli.motion.integration.contacts.impulses import free_impulse_energy
from heuncli.results.results import Accuracy, Array
from heuncli.study.compose.recovery import ENERGY_REPORTS, Recovery
from heuncli.study.model.setup import Setup
from heuncli.study.solve.history import History


def make_accuracy(history: History, balance: Balance, impulse_residual: float = 0.0) -> Accuracy:
    """Make the block `accuracy` of a run at the instants of `balance`.

    impulse_residual: the residual of d'Alembert's principle at its impulses, relative to the largest impulse
    """
    checked, scene = history.checked_run, balance.setup.scene
    free_energy = sum(free_impulse_energy(scene.layout, jump.impulses) for jump in history.impulses)
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
        self.of_energy = bool(ENERGY_REPORTS & setup.selection.reports)
        self.gap = self.residual = 0.0
        self.start: float | None = None  # energy less work at the first instant [J]
        self.change = self.kinetic = self.imbalance = 0.0  # the largest [J]
        self.loads: list[tuple[float, float]] = []  # the largest force and moment of each

    def add(self, recovery: Recovery) -> Balance:
        """Add instants; returns itself."""
        mechanism, size = self.setup.scene.mechanism, self.setup.scene.layout.size
        if self.of_energy:
            self.add_energy(recovery)
        self.gap = larger(self.gap, float(recovery.solutions.gap.max(initial=0.0)))
        residual = balance_residual(mechanism, recovery.states, recovery.inertia, recovery.actions, size)
        self.residual = larger(self.residual, residual)
        return self

    def add_energy(self, recovery: Recovery) -> None:
        """Add the energy of instants, or their powers."""
        if self.span is not None:
            joints, layout = recovery.joints, self.setup.scene.layout
            power_error = power_imbalance(
                layout, recovery.states, recovery.loads, joints, recovery.couplings, self.span
            )
            self.imbalance = larger(self.imbalance, power_error)
            acting = [(largest_magnitude(x.force), largest_magnitude(x.moment)) for x in recovery.law_actions]
            largest_so_far = self.loads or [(0.0, 0.0)] * len(acting)
            self.loads = [(larger(F, f), larger(M, m)) for (F, M), (f, m) in zip(largest_so_far, acting, strict=True)]
        energy = recovery.energy
        total = energy["kinetic"] + energy["potential"] - energy["work"]
        self.start = float(total[0]) if self.start is None else self.start
        self.change = larger(self.change, largest_magnitude(total - self.start))
        self.kinetic = larger(self.kinetic, float(energy["kinetic"].max(initial=0.0)))

    def to_accuracy(self, kinetic: float = 0.0, impulse_energy: float = 0.0) -> Accuracy:
        """Return the part of the block `accuracy` that instants decide.

        kinetic: the run's largest [J], which the requested instants may not show
        impulse_energy: the energy that the given impulses would bring to free bodies [J]
        """
        found, mechanism, size = Accuracy(), self.setup.scene.mechanism, self.setup.scene.layout.size
        if self.of_energy:
            lift = (
                sum(body.mass for body in mechanism.bodies) * float(np.abs(mechanism.gravity).max()) * size
                + impulse_energy
            )
            if self.span is not None:
                lift += work_scale(mechanism, self.loads, size, self.span)
            change = self.change if self.span is None else self.imbalance
            found["energy_drift"] = energy_drift(change, max(kinetic, self.kinetic), lift)
        return found | {"constraint_gap": self.gap, "balance_residual": self.residual}


def larger(so_far: float, value: float) -> float:
    """Return the larger of the two; nan stays nan."""
    return float(np.maximum(so_far, value))


def largest_magnitude(values: Array) -> float:
    """The largest magnitude."""
    return float(np.abs(values).max(initial=0.0))
