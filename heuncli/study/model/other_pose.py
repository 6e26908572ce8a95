"""Describe how another pose differs, in words: by joint coordinates, or else by positions of bodies."""

from __future__ import annotations

import numpy as np

from heuncli.loads.equilibrium.pose import Pose
from heuncli.loads.kinetostatics.bodies import make_body_states
from heuncli.loads.kinetostatics.coordinates import evaluate_joint_coordinates
from heuncli.multibody.tree.layout import Layout
from heuncli.study.model.counts_and_lists import list_some

UNITS = {"angle": "rad", "travel": "m"}
MIN_DIFFERENCE = 1e-3  # rad, or parts of the size: smaller differences are not shown


def describe_other_pose(layout: Layout, here: Pose, there: Pose) -> str:
    """Describe the differences of the pose `there` from `here`, the largest first."""
    own_coordinates, other_coordinates = (
        evaluate_joint_coordinates(layout, at.evaluation, make_body_states(layout, at.evaluation))
        for at in (here, there)
    )
    differences: list[tuple[float, str]] = []
    for joint, values in other_coordinates.items():
        for name, unit in UNITS.items():
            if name in values:
                value = float(values[name][0])
                difference = abs(value - float(own_coordinates[joint][name][0])) / (layout.size if unit == "m" else 1.0)
                differences.append((difference, f"{joint}.{name} = {value:.6g} {unit}"))
    centres, other_centres = (make_body_states(layout, at.evaluation).centre[0] for at in (here, there))
    bodies = [body.name for body in layout.mechanism.bodies]
    if max((difference for difference, _ in differences), default=0.0) <= MIN_DIFFERENCE:
        for name, c, d in zip(bodies, centres, other_centres, strict=True):
            x, y, z = d
            differences.append((float(np.abs(d - c).max()) / layout.size, f"{name} at ({x:.6g}, {y:.6g}, {z:.6g}) m"))
    return list_some(
        [text for difference, text in sorted(differences, key=lambda each: -each[0]) if difference > MIN_DIFFERENCE]
    )
