"""What in a scene decays or swings so fast that explicit steps are short: by the tangent's largest eigenvalue.

Loaded where a run was left because of it.
"""

from __future__ import annotations

import numpy as np

from heuncli.motion.integration.evaluator import Evaluator
from heuncli.multibody.mechanism.model import JointLoad, Load, PairLoad
from heuncli.multibody.response import tangent
from heuncli.results.results import Array

STEP = 1e-8  # rad, or of the size, and of rates [1/s]: by which the state is moved along the eigenvector


def fastest(scene: Evaluator, t: float, state: Array, h: float) -> str:
    """What is fast at a state, how fast, and how fast the motion is beside it, in a sentence; h: explicit steps [s]."""
    values, vectors = np.linalg.eig(tangent(scene.workspace, t, state))
    k = int(np.argmax(np.abs(values)))
    largest = complex(values[k])
    does = "swings" if abs(largest.imag) > abs(largest.real) else "decays"
    answers = scene.recovered(np.array([t]), state[None, :])
    omega = np.sqrt(np.sum(answers.bodies["omega"] ** 2, axis=2)).max(initial=0.0)
    speed = np.sqrt(np.sum(answers.bodies["v"] ** 2, axis=2)).max(initial=0.0) / scene.size
    what = responsible(scene, t, state, vectors[:, k], abs(largest))
    return (
        f"stiff: {what} {does} at {abs(largest):.2g} 1/s where the motion goes at {max(omega, speed):.2g} 1/s: "
        f"at t = {t:.3g} s it keeps explicit steps at {h:.2g} s"
    )


def responsible(scene: Evaluator, t: float, state: Array, along: Array, rate: float) -> str:
    """The load that answers most to a motion along an eigenvector, by the work it does there."""
    loads = scene.layout.mechanism.loads
    if not loads:
        return "the scene"
    work = np.zeros(len(scene.layout.tables["loads"]))
    for part in (along.real, along.imag):
        size = np.abs(part * scene.layout.weights).max(initial=0.0)
        if size > 0.0:
            moved = state[None, :] + np.array([[-1.0], [1.0]]) * (STEP / size * part)
            found = scene.recovered(np.array([t, t]), moved).loads
            change = {name: np.abs(found[name][1] - found[name][0]) for name in ("value", "span", "rate")}
            work += change["value"] * (change["rate"] + rate * change["span"])
    shares = {load: float(work[rows].sum()) for load, rows in scene.layout.mechanism.load_rows()}
    load = max(loads, key=lambda one: shares[one])
    return f"{kind_of(load)} `{load.name}`" if shares[load] > 0.0 else "the scene"


def kind_of(load: Load) -> str:
    """The kind of a load, as the spec has it."""
    if isinstance(load, PairLoad):
        return "spring" if load.value is None else "actuator"
    return load.kind.replace("_", " ") if isinstance(load, JointLoad) else load.kind
