"""Conditions at the start of one-sided joints: slack ropes, bodies that leave their path, rods free between limits.

A rope shorter than the distance of its points as assembled without it acts as a rod; a longer one is slack and sets no
condition; one that just reaches, or whose length is not given, is taut: it keeps its rate where the held velocities
allow it. Where they do not, an impact occurs at once, or it goes slack.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence

import numpy as np

from heuncli.base import tolerances
from heuncli.base.errors import SolveError
from heuncli.base.records import replace
from heuncli.multibody.assembly.conditions import JointCondition, JointConstraint
from heuncli.multibody.mechanism.model import GROUND, Assembly, Mechanism
from heuncli.scene.expressions.roller_path import left_normal

UNCONSTRAINED = JointConstraint("none", "free")
Assemble = Callable[[list[JointCondition]], Assembly]


def find_one_sided_joints(mechanism: Mechanism) -> tuple[list[int], list[int]]:
    """Find the joints that are ropes or one-sided paths, and the rods whose length a stop limits."""
    free = sorted({stop.joint for stop in mechanism.stops if stop.quantity == "length"})
    ropes = [
        k
        for k, joint in enumerate(mechanism.joints)
        if joint.restitution is not None and joint.travel is None and k not in free
    ]
    return ropes, free


def assemble_with_ropes(
    mechanism: Mechanism, conditions: Sequence[JointCondition], size: float, assemble: Assemble
) -> Assembly:
    """Assemble the start, with ropes as taut as they are found. Raises SolveError as `assemble` does."""
    ropes, free = find_one_sided_joints(mechanism)
    present_conditions = list(conditions)
    for k in (*ropes, *free):
        present_conditions[k] = replace(conditions[k], pose=UNCONSTRAINED, rate=UNCONSTRAINED)
    start = assemble(present_conditions)
    tolerance = tolerances.OPEN_GAP * size
    short: set[int] = set()
    while stretched := {k for k in set(ropes) - short if rope_excess(mechanism, start, k) > tolerance}:
        short |= stretched
        for k in stretched:
            present_conditions[k] = replace(conditions[k], rate=UNCONSTRAINED)
        start = assemble(present_conditions)
    taut = [k for k in ropes if abs(rope_excess(mechanism, start, k)) <= tolerance]
    if not taut:
        return start
    taut_conditions = list(present_conditions)
    for k in taut:
        taut_conditions[k] = replace(present_conditions[k], rate=conditions[k].rate)
    try:
        return assemble(taut_conditions)
    except SolveError as error:
        if error.problems[0].code != "rates-do-not-fit":
            raise
        return start


def rope_excess(mechanism: Mechanism, start: Assembly, k: int) -> float:
    """Distance of a rope's points less its length [m]; 0 for a rope as long as this distance.

    For a path that pushes to its left: how far its point is to the right of it.
    """
    joint = mechanism.joints[k]
    if joint.length is None and joint.path is None:
        return 0.0
    places = [
        point if body == GROUND else start.position[body] + start.rotation[body] @ point
        for body, point in ((joint.a, joint.p), (joint.b, joint.q))
    ]
    D = places[1] - places[0]
    if joint.path is not None:
        offset = D if joint.a == GROUND else D @ start.rotation[joint.a]
        r, slope, _ = joint.path.evaluate(float(joint.path.find_nearest(offset)))
        return float((r - offset) @ left_normal(joint.path.normal, slope))
    assert joint.length is not None
    return float(np.sqrt(D @ D)) - joint.length
