"""How well the results are known: bodies and blows balanced, energy kept, joints closed, errors estimated, the horizon.

The block `accuracy` of the results. Estimates are made while the motion is checked (study/solve/load_errors.py).
"""

from __future__ import annotations

import numpy as np

from heuncli.loads.kinetostatics.balance import balance_residual
from heuncli.loads.kinetostatics.energy import energy_drift, magnitude_of_work, power_imbalance
from heuncli.motion.integration.contacts.blows import met_freely
from heuncli.results.results import Accuracy, Array
from heuncli.study.compose.recovery import OF_ENERGY, Recovery
from heuncli.study.model.setup import Setup
from heuncli.study.solve.history import History


def accuracy_of(history: History, looked: Balance, residual_of_blows: float = 0.0) -> Accuracy:
    """The block `accuracy` of a run at the instants that were looked at.

    residual_of_blows: what its blows leave unmet of d'Alembert's principle, of the largest impulse.
    """
    checked, scene = history.checked, looked.setup.scene
    struck_freely = sum(met_freely(scene.layout, jump.impulses) for jump in history.blows)
    known = looked.told(checked.kinetic if checked is not None else 0.0, struck_freely)
    known["balance_residual"] = max(known["balance_residual"], residual_of_blows)
    gap = checked.run.gap if checked is not None else scene.start.gap
    return known | {
        "constraint_gap": max(known["constraint_gap"], gap),
        "horizon": checked.horizon if checked is not None else None,
        "estimate": history.estimate,
    }


class Balance:
    """How well the instants of a run balance, those looked at so far, ascending: energy, closures, d'Alembert."""

    def __init__(self, setup: Setup, span: float | None = None) -> None:
        """span: how long a run is that was not integrated [s]: there the work is the gain of energy, and powers tell.

        Energy is looked at where it is asked for.
        """
        self.setup, self.span = setup, span
        self.of_energy = bool(OF_ENERGY & setup.asked.reports)
        self.gap = self.residual = 0.0
        self.start: float | None = None  # energy less work at the first instant [J]
        self.change = self.kinetic = self.imbalance = 0.0  # the largest [J]
        self.loads: list[tuple[float, float]] = []  # the largest force and moment of each

    def add(self, recovery: Recovery) -> Balance:
        """More instants; returns itself."""
        mechanism, size = self.setup.scene.mechanism, self.setup.scene.layout.size
        if self.of_energy:
            self.add_energy(recovery)
        self.gap = larger(self.gap, float(recovery.recovered.gap.max(initial=0.0)))
        off = balance_residual(mechanism, recovery.states, recovery.inertia, recovery.actions, size)
        self.residual = larger(self.residual, off)
        return self

    def add_energy(self, recovery: Recovery) -> None:
        """The energy of more instants, or the powers in its place."""
        if self.span is not None:
            joints, layout = recovery.joints, self.setup.scene.layout
            off = power_imbalance(layout, recovery.states, recovery.loads, joints, recovery.couplings, self.span)
            self.imbalance = larger(self.imbalance, off)
            acting = [(largest(x.force), largest(x.moment)) for x in recovery.pushing]
            before = self.loads or [(0.0, 0.0)] * len(acting)
            self.loads = [(larger(F, f), larger(M, m)) for (F, M), (f, m) in zip(before, acting, strict=True)]
        energy = recovery.energy
        total = energy["kinetic"] + energy["potential"] - energy["work"]
        self.start = float(total[0]) if self.start is None else self.start
        self.change = larger(self.change, largest(total - self.start))
        self.kinetic = larger(self.kinetic, float(energy["kinetic"].max(initial=0.0)))

    def told(self, kinetic: float = 0.0, struck: float = 0.0) -> Accuracy:
        """The part of the block `accuracy` that instants tell.

        kinetic: the run's largest [J], which instants asked for may not show; struck: the energy that given blows would
        bring to what nothing holds [J].
        """
        found, mechanism, size = Accuracy(), self.setup.scene.mechanism, self.setup.scene.layout.size
        if self.of_energy:
            lift = sum(body.mass for body in mechanism.bodies) * float(np.abs(mechanism.gravity).max()) * size + struck
            if self.span is not None:
                lift += magnitude_of_work(mechanism, self.loads, size, self.span)
            change = self.change if self.span is None else self.imbalance
            found["energy_drift"] = energy_drift(change, max(kinetic, self.kinetic), lift)
        return found | {"constraint_gap": self.gap, "balance_residual": self.residual}


def larger(so_far: float, value: float) -> float:
    """The larger of the two; what is no number stays none."""
    return float(np.maximum(so_far, value))


def largest(values: Array) -> float:
    """The largest magnitude."""
    return float(np.abs(values).max(initial=0.0))
