"""Find what in a scene decays or swings so fast that explicit steps are short, from the tangent's largest eigenvalue.

Imported where a run was stopped because of it.
"""

from __future__ import annotations

import numpy as np

from heuncli.motion.integration.evaluator import Evaluator
from heuncli.multibody.response import tangent
from heuncli.results.results import Array

STEP = 1e-8  # displacement of the state along the eigenvector: rad, or relative to the size, and rates [1/s]


def describe_fastest_motion(scene: Evaluator, t: float, state: Array, h: float) -> str:
    """Describe in a sentence what is fast at a state, how fast, and how fast the motion itself is; h: explicit steps
    [s].
    """
    values, vectors = np.linalg.eig(tangent(scene.workspace, t, state))
    k = int(np.argmax(np.abs(values)))
    largest = complex(values[k])
    does = "oscillates" if abs(largest.imag) > abs(largest.real) else "decays"
    evaluation = scene.evaluate(np.array([t]), state[None, :])
    omega = np.sqrt(np.sum(evaluation.bodies["omega"] ** 2, axis=2)).max(initial=0.0)
    speed = np.sqrt(np.sum(evaluation.bodies["v"] ** 2, axis=2)).max(initial=0.0) / scene.size
    load_name = find_responsible_load(scene, t, state, vectors[:, k], abs(largest))
    return (
        f"stiff: {load_name} {does} at {abs(largest):.2g} 1/s, the motion changes at {max(omega, speed):.2g} 1/s; "
        f"this limits explicit steps to {h:.2g} s at t = {t:.3g} s"
    )


def find_responsible_load(scene: Evaluator, t: float, state: Array, eigenvector: Array, rate: float) -> str:
    """Return the load that responds most to a motion along an eigenvector, by the work it does there."""
    loads = scene.layout.mechanism.loads
    if not loads:
        return "the model"
    work = np.zeros(len(scene.layout.tables["loads"]))
    for part in (eigenvector.real, eigenvector.imag):
        size = np.abs(part * scene.layout.weights).max(initial=0.0)
        if size > 0.0:
            moved_states = state[None, :] + np.array([[-1.0], [1.0]]) * (STEP / size * part)
            loads_there = scene.evaluate(np.array([t, t]), moved_states).loads
            change = {name: np.abs(loads_there[name][1] - loads_there[name][0]) for name in ("value", "span", "rate")}
            work += change["value"] * (change["rate"] + rate * change["span"])
    shares = {load: float(work[rows].sum()) for load, rows in scene.layout.mechanism.iter_load_rows()}
    load = max(loads, key=lambda one: shares[one])
    return f"{load.row.display_name} `{load.name}`" if shares[load] > 0.0 else "the model"
