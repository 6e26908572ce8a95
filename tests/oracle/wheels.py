"""Wheels that roll on a plane, as rows on absolute coordinates.

A thin rim of radius R about the axle k touches the plane with the normal n where it is lowest, a ball at its foot:

    r = -R w/|w|,  w = n - (n·k) k;   of a ball r = -R n            from the centre C to the contact
    s = v_C + σ_b×r − v_a − σ_a×(C + r − x_a),   e·s = 0            e: the normal, along the track, aside
    γ = ė·s + e·(c̈_C + σ_b×ṙ − σ_a×(v_C + ṙ − v_a)),   c̈_C = σ_b×(σ_b×(C − c_b))
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np

from tests.oracle.read import GROUND, End, Model, Placed, Scene, State, end, placed
from tests.oracle.turns import Array, across, cross, unit

NORMAL, ALONG, ASIDE = range(3)


@dataclass(frozen=True, eq=False)
class Wheel:
    """A wheel's entry: its centre b and axle (None: a ball), the plane's point a and normal, which rows it has."""

    name: str
    b: End
    axle: Array | None
    radius: float
    a: End
    normal: Array
    rows: tuple[int, ...]


def wheels(scene: Scene) -> tuple[Wheel, ...]:
    """The wheels of a scene."""
    return tuple(wheel(scene, name, given) for name, given in (scene.get("rolling") or {}).items())


def wheel(scene: Scene, name: str, given: Mapping[str, Any]) -> Wheel:
    """One of them."""
    rows = (NORMAL, ASIDE) if given.get("slides") == "along" else (NORMAL, ALONG, ASIDE)
    axle = None if given.get("shape") == "sphere" else unit(given["axis"])
    return Wheel(
        name, end(scene, given["wheel"]), axle, float(given["radius"]), end(scene, given["on"]),
        unit(given["normal"]), rows,
    )  # fmt: skip


def spun(at: Placed, a: Array) -> tuple[Array, Array]:
    """A direction fixed in a body, world axes, and its rate."""
    e = at.rotation @ a
    return e, cross(at.angular_velocity, e)


def lever(w: Wheel, state: State) -> tuple[Array, Array]:
    """From the centre to the contact, and its rate."""
    n, dn = spun(placed(state, w.a.body), w.normal)
    if w.axle is None:
        return -w.radius * n, -w.radius * dn
    k, dk = spun(placed(state, w.b.body), w.axle)
    down = n - float(n @ k) * k
    rate = dn - float(dn @ k + n @ dk) * k - float(n @ k) * dk
    size = float(np.linalg.norm(down))
    u = down / size
    return -w.radius * u, -w.radius * (rate - u * float(u @ rate)) / size


def directions(w: Wheel, state: State) -> list[tuple[Array, Array]]:
    """The directions of its rows, with their rates: of a ball any two in the plane."""
    A = placed(state, w.a.body)
    n, dn = spun(A, w.normal)
    if w.axle is None:
        return [(n, dn), *(spun(A, e) for e in across(w.normal))]
    k, dk = spun(placed(state, w.b.body), w.axle)
    aside, rate = k - float(n @ k) * n, dk - float(dn @ k + n @ dk) * n - float(n @ k) * dn
    size = float(np.linalg.norm(aside))
    l = aside / size
    dl = (rate - l * float(l @ rate)) / size
    found = [(n, dn), (cross(l, n), cross(dl, n) + cross(l, dn)), (l, dl)]
    return [found[row] for row in w.rows]


def contact(w: Wheel, state: State) -> Array:
    """Where it touches."""
    return placed(state, w.b.body).point(w.b.point) + lever(w, state)[0]


def height(w: Wheel, state: State) -> float:
    """How far the contact is above the plane: 0 where the state fits."""
    A = placed(state, w.a.body)
    return float((A.rotation @ w.normal) @ (contact(w, state) - A.point(w.a.point)))


def lines(read: Model, state: State) -> list[tuple[str, Array, Array, float]]:
    """Of all wheels' rows: name, direction, J (6n,) on (v of the centre of mass, σ) body by body, γ."""
    place = {name: 6 * k for k, name in enumerate(read.names)}
    found = []
    for w in wheels(read.scene):
        A, B = placed(state, w.a.body), placed(state, w.b.body)
        r, dr = lever(w, state)
        C, v_C = B.point(w.b.point), B.speed(w.b.point)
        mass = np.zeros(3) if w.a.body == GROUND else read.masses[w.a.body].center
        x_a, v_a = A.point(mass), A.speed(mass)
        s = v_C + cross(B.angular_velocity, r) - v_a - cross(A.angular_velocity, C + r - x_a)
        arm = C - B.point(read.masses[w.b.body].center)
        bias = cross(B.angular_velocity, cross(B.angular_velocity, arm)) + cross(B.angular_velocity, dr)
        bias = bias - cross(A.angular_velocity, v_C + dr - v_a)
        for e, de in directions(w, state):
            line = np.zeros(6 * len(read.names))
            for body, lever_arm, sign in ((w.b.body, arm + r, 1.0), (w.a.body, C + r - x_a, -1.0)):
                if body != GROUND:
                    at = place[body]
                    line[at : at + 3] += sign * e
                    line[at + 3 : at + 6] += sign * cross(lever_arm, e)
            found.append((w.name, e, line, float(de @ s + e @ bias)))
    return found


def loads(read: Model, state: State, multipliers: Array, names: list[str]) -> dict[str, Array]:
    """The force of each plane ON its wheel, of the multipliers of all rows and whose they are."""
    found: dict[str, Array] = {}
    own = {w.name for w in wheels(read.scene)}
    directed = iter(lines(read, state))
    for name, multiplier in zip(names, multipliers, strict=True):
        if name in own:
            _, e, _, _ = next(directed)
            found[name] = found.get(name, np.zeros(3)) + multiplier * e
    return found
