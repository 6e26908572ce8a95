"""Ratios, differentials and threads in one joint: sums of coordinates that stay, each a term with its factor."""

from __future__ import annotations

import math
from collections.abc import Mapping
from typing import Any, NamedTuple

import numpy as np

from tests.oracle.read import Joint, Model, State, placed
from tests.oracle.turns import Array, cross


class Term(NamedTuple):
    """Of a joint the angle, if it turns, else the travel; its factor in the sum."""

    joint: Joint
    turns: bool
    factor: float


def sums(read: Model) -> dict[str, list[Term]]:
    """The terms of all sums of a scene, by their couplings' names."""
    joints = {j.name: j for j in read.joints}
    found = {}
    for name, given in (read.scene.get("couplings") or {}).items():
        of = [joints[word] for word in given.get("of", ()) if word in joints]
        if given["type"] == "screw" and len(of) == 1:  # travel = lead / 2 pi angle
            found[name] = [Term(of[0], False, 1.0), Term(of[0], True, -given["lead"] / math.tau)]
        elif factors := factors_of(given):
            found[name] = [Term(j, j.kind == "pin", f) for j, f in zip(of, factors, strict=True)]
    return found


def factors_of(given: Mapping[str, Any]) -> list[float]:
    """Of a ratio, as given; seen from the carrier the first shaft of a differential turns `ratio` times the second."""
    if given["type"] == "differential":
        ratio = given["ratio"]
        return [1.0, -ratio, ratio - 1.0]
    return list(given["factors"]) if given["type"] == "ratio" else []


def exerted(terms: list[Term], state: State, multiplier: float) -> dict[str, Array]:
    """What a sum exerts ON each body: force and moment about the origin, (6,)."""
    found: dict[str, Array] = {}
    for joint, turns, factor in terms:
        d = multiplier * factor * (placed(state, joint.a.body).rotation @ joint.axis)
        P = placed(state, joint.b.body).point(joint.b.point)
        load = np.concatenate([np.zeros(3), d] if turns else [d, cross(P, d)])
        for body, sign in ((joint.b.body, 1.0), (joint.a.body, -1.0)):
            found[body] = found.get(body, np.zeros(6)) + sign * load
    return found
