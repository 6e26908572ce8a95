"""The weld oracle: saw a body in two, weld the parts together again, and read the weld.

manual/theory.md, "Laws that catch signs".

The piece is where (x − at)·normal > 0. With `from` the piece and `to` the remainder the weld's reaction is what the
piece exerts ON the remainder, about the cut's point: Heun's s' and M'(P). All that stands on the body goes to the
part it stands on.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any, NamedTuple

import numpy as np

from tests.oracle.masses import Mass, Plane, cut, mass_of, without
from tests.oracle.read import InTime, Scene, State, at_time, end, placed
from tests.oracle.solve import Solution, solve
from tests.oracle.turns import Array, cross, unit

SAW = "sawn_apart"  # the weld's name
PIECE = "_beyond"  # added to the body's name
ON_THE_SPOT = ("ball", "pin", "universal", "weld", "rod")  # `from` feels these at its own point, others where `to` is


class Section(NamedTuple):
    """s' [N] and M' [N m] about `point`, world axes, and which of the six are certain."""

    point: Array
    normal: Array
    force: Array
    moment: Array
    unique: Array
    solution: Solution

    def about(self, point: Array) -> Array:
        """M' about another point."""
        return self.moment + cross(self.point - point, self.force)


def section(
    scene: Scene,
    state: State,
    t: float,
    body: str,
    point: str | Sequence[float] | Array,
    normal: Sequence[float] | Array,
    side: str | None = None,
    piece: Mass | None = None,
) -> Section:
    """Section load at a plane of a body; `point` (or a point's name) and `normal` in body axes.

    `side` ("before": to the piece, "beyond": to the remainder) for what lies in the plane; `piece` for a body without
    shapes.
    """
    sawn = saw(scene, state, body, point, normal, side, piece)
    solution = solve(sawn, {**state, body + PIECE: state[body]}, t)
    weld = solution.reactions[SAW]
    return Section(weld.point, state[body].rotation @ unit(normal), weld.force, weld.moment, weld.unique[:6], solution)


def saw(
    scene: Scene,
    state: State,
    body: str,
    point: str | Sequence[float] | Array,
    normal: Sequence[float] | Array,
    side: str | None = None,
    piece: Mass | None = None,
) -> dict[str, Any]:
    """The scene with the body in two parts, welded at the plane."""
    whole = scene["bodies"][body]
    at = np.array(whole["points"][point] if isinstance(point, str) else point, dtype=float)
    plane = Plane(at, unit(normal), side)
    size = max([1e-300, *(float(np.abs(p).max()) for p in whole.get("points", {}).values())])

    def part(x: Array) -> str:
        return body + PIECE if plane.beyond(x, size) else body

    def own(value: str | Mapping[str, Any], x: Array | None = None) -> str | Mapping[str, Any]:
        place = end(scene, value)
        if place.body != body:
            return value
        return {"body": part(place.point if x is None else x), "at": place.point.tolist()}

    def touched(spec: Mapping[str, Any]) -> Array | None:
        """Where a sliding joint bears on this body, if the body is its `from`: at the `to` point, now."""
        if spec["type"] in ON_THE_SPOT or end(scene, spec["from"]).body != body:
            return None
        to = end(scene, spec["to"])
        me = state[body]
        return me.rotation.T @ (placed(state, to.body).point(to.point) - me.position)

    remainder, cut_off = cut(whole, plane) if piece is None else (without(mass_of(whole), piece), piece)
    pose = ("points", "position", "orientation", "velocity", "angular_velocity")
    kept = {k: v for k, v in whole.items() if k in pose}
    bodies = dict(scene["bodies"])
    bodies[body], bodies[body + PIECE] = {**kept, **given(remainder)}, {**kept, **given(cut_off)}
    joints = {
        name: {**spec, "from": own(spec["from"], touched(spec)), "to": own(spec["to"])}
        for name, spec in (scene.get("joints") or {}).items()
    }
    joints[SAW] = {
        "type": "weld",
        "from": {"body": body + PIECE, "at": at.tolist()},
        "to": {"body": body, "at": at.tolist()},
    }
    forces = {}
    for name, spec in (scene.get("forces") or {}).items():
        if spec["type"] == "distributed":
            forces |= divided(name, spec, plane, body) if spec["on"] == body else {name: spec}
            continue
        if spec.get("on") == body:
            raise ValueError(f"{name}: a couple on a body with a section needs the point")
        forces[name] = {**spec, **{key: own(spec[key]) for key in ("on", "from", "to") if key in spec}}
    blows = {}
    for name, spec in (scene.get("impulses") or {}).items():
        if body in (spec.get("on"), spec.get("body")):
            raise ValueError(f"{name}: a couple on a body with a section needs the point")
        blows[name] = {**spec, **({"on": own(spec["on"])} if "on" in spec else {})}
    return {**scene, "bodies": bodies, "joints": joints, "forces": forces, "impulses": blows}


def divided(name: str, spec: Mapping[str, Any], plane: Plane, body: str) -> dict[str, Any]:
    """A distributed load on the two parts: that before the plane and that beyond it, where it crosses the plane."""
    a, b = (np.array(spec[key], dtype=float) for key in ("from", "to"))
    first, last = spec["vector"], spec.get("to_vector", spec["vector"])
    h, k = (float(plane.normal @ (x - plane.at)) for x in (a, b))
    owner = {True: body + PIECE, False: body}
    if (h > 0.0) == (k > 0.0):
        return {name: {**spec, "on": owner[h > 0.0]}}
    x = h / (h - k)
    between, there = [Between(x, p, q) for p, q in zip(first, last, strict=True)], (a + x * (b - a)).tolist()
    return {
        f"{name}_1": {**spec, "on": owner[h > 0.0], "to": there, "vector": first, "to_vector": between},
        f"{name}_2": {**spec, "on": owner[k > 0.0], "from": there, "vector": between, "to_vector": last},
    }


class Between(NamedTuple):
    """A value in time a part x of the way from one to another."""

    x: float
    first: InTime
    last: InTime

    def __call__(self, t: float) -> float:
        return (1.0 - self.x) * at_time(self.first, t) + self.x * at_time(self.last, t)


def given(mass: Mass) -> dict[str, Any]:
    """Mass properties as a body's entry has them."""
    return {"mass": mass.mass, "center": mass.center.tolist(), "inertia": mass.inertia.tolist()}
