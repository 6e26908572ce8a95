"""Ropes over sheaves: strands that touch circles, each pulled by the rope's tension where it touches.

    u: from centre to centre, t: u turned about n by asin (s_a R_a - s_b R_b)/|u|, w = t x n
    P_a = C_a + s_a R_a w,  P_b = C_b + s_b R_b w         s = 1 where the rope runs round counter-clockwise about n
    J V = sum t . (v_b(P_b) - v_a(P_a)) = 0               of what lies between two places that hold the rope
    T = k (S - l0) + c J V                                of one that stretches, S with the arcs R (angle of t to t)
The points of the bodies that are touched, turning with them: a sheave on which the rope slides is pulled by both
strands alike, so that its turning cancels; on one that holds the rope it counts. Strands lie in their sheaves' planes.
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from itertools import pairwise
from typing import Any, NamedTuple

import numpy as np

from tests.oracle.read import End, Model, State, end, moved_on, placed
from tests.oracle.turns import Array, about, cross, unit

H = 1e-4  # [s] of the differences


class Stay(NamedTuple):
    """Where a rope passes: a point, or the centre of a sheave with its axis, body axes, and s times its radius."""

    at: End
    axis: Array
    signed: float
    holds: bool


class Strand(NamedTuple):
    """The bodies that it pulls, where it touches them, and its direction."""

    a: str
    P_a: Array
    b: str
    P_b: Array
    t: Array


def ropes(read: Model) -> dict[str, list[Stay]]:
    """Where the ropes of a scene pass, by their names."""
    found = {}
    for name, given in (read.scene.get("couplings") or {}).items():
        if given["type"] == "rope":
            found[name] = [stay(read, place) for place in given["through"]]
    return found


def stay(read: Model, place: Mapping[str, Any]) -> Stay:
    """One place."""
    if "point" in place:
        return Stay(end(read.scene, place["point"]), np.zeros(3), 0.0, False)
    signed = place["radius"] * (1.0 if place["side"] == "left" else -1.0)
    return Stay(end(read.scene, place["sheave"]), unit(place["axis"]), signed, place.get("slip") == "none")


def strands(stays: Sequence[Stay], state: State) -> list[Strand]:
    """All of a rope, in its order."""
    found = []
    for one, other in pairwise(stays):
        A, B = placed(state, one.at.body), placed(state, other.at.body)
        C, u = A.point(one.at.point), B.point(other.at.point) - A.point(one.at.point)
        n = A.rotation @ one.axis if one.signed else B.rotation @ other.axis
        if not (one.signed or other.signed):
            found.append(Strand(one.at.body, C, other.at.body, C + u, unit(u)))
            continue
        assert abs(float(n @ u)) < 1e-5
        far = float(np.linalg.norm(u))
        t = about(unit(n), math.asin((one.signed - other.signed) / far)) @ u / far
        w = cross(t, n)
        found.append(Strand(one.at.body, C + one.signed * w, other.at.body, C + u + other.signed * w, t))
    return found


def length(stays: Sequence[Stay], state: State) -> float:
    """S: strands and what lies on the sheaves between."""
    way = strands(stays, state)
    found = sum(float(np.linalg.norm(own.P_b - own.P_a)) for own in way)
    for here, before, behind in zip(stays[1:-1], way, way[1:], strict=False):
        n = placed(state, here.at.body).rotation @ here.axis
        turn = math.atan2(float(n @ cross(before.t, behind.t)), float(before.t @ behind.t))
        found += abs(here.signed) * (math.copysign(1.0, here.signed) * turn % math.tau)
    return found


def line(read: Model, way: Sequence[Strand], state: State) -> Array:
    """J (6n,) on (v of the centre of mass, sigma) body by body."""
    found = np.zeros(6 * len(read.names))
    for own in way:
        for body, P, sign in ((own.b, own.P_b, 1.0), (own.a, own.P_a, -1.0)):
            if body in read.names:
                k = 6 * read.names.index(body)
                found[k : k + 3] += sign * own.t
                found[k + 3 : k + 6] += sign * cross(P - placed(state, body).point(read.masses[body].center), own.t)
    return found


def motion(read: Model, state: State) -> Array:
    """(v of the centre of mass, sigma) body by body, (6n,)."""
    own = [(state[name].speed(read.masses[name].center), state[name].angular_velocity) for name in read.names]
    return np.ravel(own)


def runs(stays: Sequence[Stay]) -> list[slice]:
    """Which strands lie between two places that hold the rope."""
    last = len(stays) - 1
    held = [k for k, own in enumerate(stays) if own.holds or k in (0, last)]
    return [slice(i, j) for i, j in pairwise(held)]


def lines(read: Model, state: State) -> list[tuple[str, Array, Array, float]]:
    """Of those that keep their length, a row a run: name, no direction, J, gamma by differences."""
    found = []
    V = motion(read, state)
    for name, stays in ropes(read).items():
        if "stiffness" in read.scene["couplings"][name]:
            continue
        moved = {s: moved_on(read, state, s * H) for s in (-2, -1, 1, 2)}
        for run in runs(stays):
            J = {s: line(read, strands(stays, there)[run], there) for s, there in moved.items()}
            gamma = float((8.0 * (J[1] - J[-1]) - (J[2] - J[-2])) @ V) / (12.0 * H)
            found.append((name, np.zeros(3), line(read, strands(stays, state)[run], state), gamma))
    return found


def tension(read: Model, name: str, state: State) -> float:
    """Of a rope that stretches."""
    given, stays = read.scene["couplings"][name], ropes(read)[name]
    V = motion(read, state)
    longer = length(stays, state) - given["length"]
    rate = float(line(read, strands(stays, state), state) @ V)
    return float(given["stiffness"] * longer + given.get("damping", 0.0) * rate)


def exerted(way: Sequence[Strand], tension: float) -> list[tuple[str, Array, Array]]:
    """Body, place and force of a tension along strands."""
    found = []
    for own in way:
        found += [(own.a, own.P_a, tension * own.t), (own.b, own.P_b, -tension * own.t)]
    return found


def pulls(read: Model, state: State) -> dict[str, list[tuple[str, Array, Array]]]:
    """What ropes that stretch pull with, by their names."""
    return {
        name: exerted(strands([stay(read, place) for place in given["through"]], state), tension(read, name, state))
        for name, given in (read.scene.get("couplings") or {}).items()
        if given["type"] == "rope" and "stiffness" in given
    }
