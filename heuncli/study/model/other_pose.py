"""In what another pose differs, in words: coordinates of joints that tell it, else where bodies are."""

from __future__ import annotations

import numpy as np

from heuncli.loads.equilibrium.pose import Pose
from heuncli.loads.kinetostatics.bodies import body_states
from heuncli.loads.kinetostatics.coordinates import coordinates
from heuncli.multibody.tree.layout import Layout
from heuncli.study.model.counts_and_lists import some

UNITS = {"angle": "rad", "travel": "m"}
DIFFERS = 1e-3  # rad, or of the size: what is told of two poses


def other_pose(layout: Layout, here: Pose, there: Pose) -> str:
    """What tells a pose from another one, the largest difference first."""
    own, others = (coordinates(layout, at.recovered, body_states(layout, at.recovered)) for at in (here, there))
    found: list[tuple[float, str]] = []
    for joint, values in others.items():
        for name, unit in UNITS.items():
            if name in values:
                value = float(values[name][0])
                off = abs(value - float(own[joint][name][0])) / (layout.size if unit == "m" else 1.0)
                found.append((off, f"{joint}.{name} = {value:.6g} {unit}"))
    centres, moved = (body_states(layout, at.recovered).centre[0] for at in (here, there))
    bodies = [body.name for body in layout.mechanism.bodies]
    if max((off for off, _ in found), default=0.0) <= DIFFERS:
        for name, c, d in zip(bodies, centres, moved, strict=True):
            x, y, z = d
            found.append((float(np.abs(d - c).max()) / layout.size, f"{name} at ({x:.6g}, {y:.6g}, {z:.6g}) m"))
    return some([text for off, text in sorted(found, key=lambda each: -each[0]) if off > DIFFERS])
