"""Ropes that go slack, what flies off its path, rods free between limits, at the start: what they ask of it.

A rope shorter than the distance of its points as assembled without it is a rod; one that is longer is slack and asks
for nothing; one that just reaches, or whose length is not given, is taut: its rate is kept where the velocities that
are held let it. Where they do not, it is struck at once, or goes slack.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence

import numpy as np

from heuncli.base import tolerances
from heuncli.base.errors import SolveError
from heuncli.base.records import replace
from heuncli.multibody.assembly.conditions import Ask, JointCondition
from heuncli.multibody.mechanism.model import GROUND, Assembly, Mechanism
from heuncli.scene.expressions.beside import left

NOTHING = Ask("none", "free")
Assemble = Callable[[list[JointCondition]], Assembly]


def one_sided(mechanism: Mechanism) -> tuple[list[int], list[int]]:
    """The ropes that go slack and what may lie beside its path; the rods whose length a stop limits: joints."""
    free = sorted({stop.joint for stop in mechanism.stops if stop.quantity == "length"})
    ropes = [
        k
        for k, joint in enumerate(mechanism.joints)
        if joint.restitution is not None and joint.travel is None and k not in free
    ]
    return ropes, free


def assembled(mechanism: Mechanism, found: Sequence[JointCondition], size: float, assemble: Assemble) -> Assembly:
    """The start, with ropes as taut as it finds them. Raises SolveError as `assemble` does."""
    ropes, free = one_sided(mechanism)
    asking = list(found)
    for k in (*ropes, *free):
        asking[k] = replace(found[k], pose=NOTHING, rate=NOTHING)
    start = assemble(asking)
    near = tolerances.OPEN_GAP * size
    short: set[int] = set()
    while more := {k for k in set(ropes) - short if beyond(mechanism, start, k) > near}:
        short |= more
        for k in more:
            asking[k] = replace(found[k], rate=NOTHING)
        start = assemble(asking)
    taut = [k for k in ropes if abs(beyond(mechanism, start, k)) <= near]
    if not taut:
        return start
    kept = list(asking)
    for k in taut:
        kept[k] = replace(asking[k], rate=found[k].rate)
    try:
        return assemble(kept)
    except SolveError as error:
        if error.problems[0].code != "rates-do-not-fit":
            raise
        return start


def beyond(mechanism: Mechanism, start: Assembly, k: int) -> float:
    """How far the points of a rope are farther apart than it is long [m]; 0 of one that is as long as they are.

    Of a path that pushes to its left: how far to the right of it its point is.
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
        off = D if joint.a == GROUND else D @ start.rotation[joint.a]
        r, slope, _ = joint.path.at(float(joint.path.nearest(off)))
        return float((r - off) @ left(joint.path.normal, slope))
    assert joint.length is not None
    return float(np.sqrt(D @ D)) - joint.length
