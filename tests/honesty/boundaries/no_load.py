"""Loads that are none."""

from __future__ import annotations

from typing import Any

import numpy as np

from heuncli.loads.kinetostatics.balance import energy_drift
from heuncli.loads.kinetostatics.foundation import find_central_axis
from heuncli.study.compose.warnings import warn_unbalanced
from tests.honesty.boundaries.part import Part, Row
from tests.honesty.boundaries.scenes import WEIGHT, bar
from tests.shared.scenes import near, solved, study


def nearly_carried(x: float) -> str:
    """What hangs on an upright slide, pushed up by its weight and x of it more."""
    text = f"""
heun: 1
gravity: [0, 0, -9.81]
ground: {{points: {{O: [0, 0, 0]}}}}
bodies: {{b: {{mass: 2, center: [0, 0, 0], inertia: [1, 1, 1], points: {{O: [0, 0, 0]}}}}}}
joints: {{j: {{type: slide, from: ground.O, to: b.O, axis: [0, 0, 1]}}}}
forces: {{up: {{type: force, on: b.O, vector: [0, 0, {19.62 * (1.0 + x)!r}]}}}}
"""
    return "moves" if study(text).results.model.get("moves") else "rests"


def carried_by_nothing(x: float) -> str:
    """A body on a ball at its centre, held up but for x of its weight: whether that is a load to judge by."""
    up = f"forces: {{f: {{type: force, on: bar.top, vector: [0, 0, {WEIGHT * (1 - x)!r}]}}}}"
    text = bar(", angular_velocity: [0, 0, 1]", f"{up}\nanalysis: {{duration: 0.1, samples: 3}}")
    found = solved(text.replace("center: [0, 0, -0.5]", "center: [0, 0, 0]"))
    near(found.joints["pivot"]["force"][:, 2], x * WEIGHT, WEIGHT, 1e-14)
    return "judged" if found.accuracy["estimate"]["reactions"] > 0.0 else "none"


def axis_of(x: float) -> str:
    found: Any = find_central_axis(np.array([[x, 0, 0]]), np.array([[0, 0, x]]), np.zeros(3), 1.0)
    return "no axis" if np.isnan(found["pitch"][0]) else "an axis"


def drift(x: float) -> str:
    return "at rest" if energy_drift(x, x, 1.0) == 0.0 else "a drift"


PART = Part(
    ("loads that are none",),
    rows=(
        Row("STARTS_MOVING", nearly_carried, "rests", "moves"),
        Row("NO_FORCE", axis_of, "no axis", "an axis"),
        Row("NO_LOAD", carried_by_nothing, "none", "judged"),
        Row("NO_ENERGY", drift, "at rest", "a drift"),
        Row("UNBALANCED", lambda x: "warned" if warn_unbalanced(x) else "fine", "fine", "warned"),
    ),
    exempt={
        "CONSTANT": "whether a peak of a thirteenth digit is looked for",
    },
)
