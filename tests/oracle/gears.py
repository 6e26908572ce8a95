"""Gears, belts and screws as rows on absolute coordinates: a load fixed in what carries both, which they cannot feed.

    s = v_2(P) − v_1(P),  f·s + m·(σ_2 − σ_1) = 0          P, f, m: fixed in the carrier c
    γ = (σ_c×f)·s + f·(σ_2×(Ṗ − ċ_2) − σ_1×(Ṗ − ċ_1)) + (σ_c×m)·(σ_2 − σ_1)
Of teeth f lies along the way of the wheel at P, less what the helix turns it by; of a thread f is its axis; of a belt f
and m are half of 1 N along the one strand and half of -1 N along the other.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from typing import Any, NamedTuple

import numpy as np

from tests.oracle.read import GROUND, Joint, Model, Placed, State, end, placed, start_state
from tests.oracle.turns import Array, cross, unit


class Teeth(NamedTuple):
    """The carrier's name, those of both members, and P, f, m in the carrier's axes."""

    name: str
    carrier: str
    first: str
    second: str
    P: Array
    f: Array
    m: Array


class Turning(NamedTuple):
    """What moves on the carrier: its name, whether it turns, a point of its axis, its direction."""

    body: str
    turns: bool
    point: Array
    axis: Array


def teeth(read: Model) -> list[Teeth]:
    """Of all gears and screws of a scene."""
    joints = {j.name: j for j in read.joints}
    found = []
    for name, given in (read.scene.get("couplings") or {}).items():
        if given["type"] in MADE and len(given["of"]) == 2:
            pair = [joints[k] for k in given["of"]]
            found.append(MADE[given["type"]](read, name, given, pair[0], pair[1]))
    return found


def on(read: Model, joint: Joint, carrier: str) -> Turning:
    """What a joint on the carrier moves, in the carrier's axes as all stands at the start."""
    state = start_state(read.scene)
    C, A = placed(state, carrier), placed(state, joint.a.body)
    mine, other = (joint.a, joint.b) if joint.a.body == carrier else (joint.b, joint.a)
    return Turning(other.body, joint.kind != "slide", mine.point, C.rotation.T @ A.rotation @ joint.axis)


def parts(read: Model, first: Joint, second: Joint) -> tuple[str, Turning, Turning]:
    """The carrier and both members; one that turns beside the carrier does so about the carrier's own axis."""
    shared = {first.a.body, first.b.body} & {second.a.body, second.b.body}
    if shared:
        (carrier,) = shared
        return carrier, on(read, first, carrier), on(read, second, carrier)
    for arm in read.joints:
        for beside, mate in ((first, second), (second, first)):
            base = {arm.a.body, arm.b.body} & {beside.a.body, beside.b.body}
            carriers = {arm.a.body, arm.b.body} & {mate.a.body, mate.b.body}
            if len(base) == len(carriers) == 1 and coaxial(read, arm, beside):
                (carrier,), (body,) = carriers, {beside.a.body, beside.b.body} - base
                own, other = on(read, arm, carrier)._replace(body=body), on(read, mate, carrier)
                return (carrier, own, other) if beside is first else (carrier, other, own)
    raise ValueError(f"{first.name}, {second.name}")


def coaxial(read: Model, one: Joint, other: Joint) -> bool:
    """Whether two joints turn about one line, as all stands at the start."""
    state = start_state(read.scene)
    (P, n), (Q, m) = (
        (placed(state, j.a.body).point(j.a.point), placed(state, j.a.body).rotation @ j.axis) for j in (one, other)
    )
    return bool(np.linalg.norm(cross(n, m)) < 1e-9 and np.linalg.norm(cross(n, Q - P)) < 1e-9)


def gear(read: Model, name: str, given: Mapping[str, Any], first: Joint, second: Joint) -> Teeth:
    """Teeth at the point that is given."""
    carrier, one, other = parts(read, first, second)
    P = end(read.scene, given["at"]).point
    wheel = one if one.turns else other
    along = wheel.axis
    if one.turns and other.turns and np.linalg.norm(cross(one.axis, other.axis)) > 1e-6:  # on the way to the apex
        lines = np.array([one.axis, -other.axis]).T
        s = np.linalg.lstsq(lines, other.point - one.point, rcond=None)[0][0]
        along = unit(P - one.point - s * one.axis)
        along = along * math.copysign(1.0, float(along @ wheel.axis))
    way = unit(cross(wheel.axis, P - wheel.point))
    return Teeth(name, carrier, one.body, other.body, P, way - math.tan(given.get("helix", 0.0)) * along, np.zeros(3))


def screw(read: Model, name: str, given: Mapping[str, Any], first: Joint, second: Joint) -> Teeth:
    """A thread on the axis of what turns: travel = lead / 2 pi angle, each from `from` to `to`."""
    carrier, one, other = parts(read, first, second)
    spindle, nut = (one, other) if one.turns else (other, one)
    turn, slide = (first, second) if one.turns else (second, first)
    by = given["lead"] / math.tau
    signs = [1.0 if j.a.body == carrier else -1.0 for j in (slide, turn)]
    f, m = signs[0] * nut.axis, by * signs[1] * spindle.axis
    return Teeth(name, carrier, spindle.body, nut.body, spindle.point, f, m)


def strands(read: Model, given: Mapping[str, Any], first: Joint, second: Joint) -> list[tuple[Array, Array, Array]]:
    """Both strands of a belt, axes of what carries it: where it leaves the first pulley and the second; its way.

    By the angle between a strand and the line of centres, to either side of it.
    """
    _, one, other = parts(read, first, second)
    C, n = one.point, one.axis
    D = other.point - n * float(n @ (other.point - C))
    x, far = unit(D - C), float(np.linalg.norm(D - C))
    r, R = given["radii"]
    lean = math.asin((R + r if given.get("crossed") else R - r) / far)
    found = []
    for side in (1.0, -1.0):
        y = side * cross(n, x)
        way = math.cos(lean) * x + math.sin(lean) * (-y if given.get("crossed") else y)
        out = math.cos(lean) * y - math.sin(lean) * (-x if given.get("crossed") else x)
        found.append((C + r * out, D - R * out if given.get("crossed") else D + R * out, way))
    return found


def belt(read: Model, name: str, given: Mapping[str, Any], first: Joint, second: Joint) -> Teeth:
    """A belt in the plane of its first pulley."""
    carrier, one, other = parts(read, first, second)
    f, m = np.zeros(3), np.zeros(3)
    for half, (leaves, _, way) in zip((0.5, -0.5), strands(read, given, first, second), strict=True):
        f, m = f + half * way, m + half * cross(leaves - one.point, way)
    return Teeth(name, carrier, one.body, other.body, one.point, f, m)


def pulls(read: Model, state: State) -> dict[str, list[tuple[str, Array, Array]]]:
    """What belts at rest pull with, by their names: at the body, from the place, with the force."""
    joints = {j.name: j for j in read.joints}
    found = {}
    for name, given in (read.scene.get("couplings") or {}).items():
        if given["type"] != "belt":
            continue
        one, other = (joints[k] for k in given["of"])
        carrier, first, second = parts(read, one, other)
        c = placed(state, carrier)
        found[name] = []
        for leaves, reaches, way in strands(read, given, one, other):
            force = given["pretension"] * (c.rotation @ way)
            found[name] += [(first.body, c.point(leaves), force), (second.body, c.point(reaches), -force)]
    return found


MADE = {"gear": gear, "screw": screw, "belt": belt}


def lines(read: Model, state: State) -> list[tuple[str, Array, Array, float]]:
    """Of all of them: name, direction, J (6n,) on (v of the centre of mass, σ) body by body, γ."""
    place = {name: 6 * k for k, name in enumerate(read.names)}
    found = []
    for own in teeth(read):
        c = placed(state, own.carrier)
        P, P_rate, s_c = c.point(own.P), c.speed(own.P), c.angular_velocity
        f, m = c.rotation @ own.f, c.rotation @ own.m
        line, bias = np.zeros(6 * len(read.names)), 0.0
        s, turning = np.zeros(3), np.zeros(3)
        for body, sign in ((own.second, 1.0), (own.first, -1.0)):
            at = placed(state, body)
            centre = read.masses[body].center if body != GROUND else np.zeros(3)
            arm = P - at.point(centre)
            s, turning = (
                s + sign * (at.speed(centre) + cross(at.angular_velocity, arm)),
                turning + sign * at.angular_velocity,
            )
            bias += sign * float(f @ cross(at.angular_velocity, P_rate - at.speed(centre)))
            if body != GROUND:
                k = place[body]
                line[k : k + 3] += sign * f
                line[k + 3 : k + 6] += sign * (cross(arm, f) + m)
        bias += float(cross(s_c, f) @ s + cross(s_c, m) @ turning)
        found.append((own.name, f, line, bias))
    return found


def load(read: Model, own: Teeth, state: Mapping[str, Placed], multiplier: float) -> tuple[Array, Array, Array]:
    """Place, force and moment ON the second of them."""
    c = placed(state, own.carrier)
    return c.point(own.P), multiplier * (c.rotation @ own.f), multiplier * (c.rotation @ own.m)
