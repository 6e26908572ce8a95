"""How well the results are known: bodies and blows balanced, energy kept, joints closed, errors estimated, the horizon.

The block `accuracy` of the results. Estimates are made while the motion is checked (study/solve/load_errors.py).
"""

from __future__ import annotations

import numpy as np

from heuncli.integration.contacts.blows import met_freely
from heuncli.kinetostatics.balance import balance_residual
from heuncli.kinetostatics.energy import energy_drift, magnitude_of_work, power_imbalance
from heuncli.results import Accuracy
from heuncli.study.compose.recovery import OF_ENERGY, Recovery
from heuncli.study.solve.history import History


def accuracy_of(history: History, recovery: Recovery, residual_of_blows: float = 0.0) -> Accuracy:
    """The block `accuracy` of a run at the instants of `recovery`.

    residual_of_blows: what its blows leave unmet of d'Alembert's principle, of the largest impulse.
    """
    checked, scene = history.checked, recovery.setup.scene
    struck_freely = sum(met_freely(scene.layout, jump.impulses) for jump in history.blows)
    known = of_instants(recovery, checked.kinetic if checked is not None else 0.0, struck_freely, history.followed_for)
    known["balance_residual"] = max(known["balance_residual"], residual_of_blows)
    gap = checked.run.gap if checked is not None else scene.start.gap
    return known | {
        "constraint_gap": max(known["constraint_gap"], gap),
        "horizon": checked.horizon if checked is not None else None,
        "estimate": history.estimate,
    }


def of_instants(recovery: Recovery, kinetic: float = 0.0, struck: float = 0.0, span: float | None = None) -> Accuracy:
    """How well the instants balance: energy where it is asked for, closures, d'Alembert's principle.

    kinetic: the run's largest [J]; struck: the energy that given blows would bring to what nothing holds [J].
    span: how long a run is that was not integrated [s]: there the work is the gain of energy, and powers tell.
    """
    scene, recovered, found = recovery.setup.scene, recovery.recovered, Accuracy()
    mechanism, size = scene.mechanism, scene.layout.size
    if OF_ENERGY & recovery.setup.asked.reports:
        lift = sum(body.mass for body in mechanism.bodies) * float(np.abs(mechanism.gravity).max()) * size + struck
        imbalance = None
        if span is not None:
            imbalance = power_imbalance(scene.layout, recovery.states, recovery.loads, recovery.joints, span)
            lift += magnitude_of_work(mechanism, recovery.loads, size, span)
        found["energy_drift"] = energy_drift(recovery.energy, kinetic, lift, imbalance)
    found["constraint_gap"] = float(recovered.gap.max(initial=0.0))
    found["balance_residual"] = balance_residual(mechanism, recovery.states, recovery.actions, size)
    return found
