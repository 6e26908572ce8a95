"""Random scenes with a rope: over sheaves that a carrier takes along anyhow, or through points of bodies in space."""

from __future__ import annotations

from functools import cache
from typing import Any

import numpy as np

from tests.oracle.read import GROUND, Placed, model, placed
from tests.oracle.ropes import length, ropes
from tests.oracle.scenes import Maker
from tests.oracle.turns import Array, across, random_rotation, random_unit
from tests.shared.trees import ABOUT, Case, case

HUNG = ("pin", "ball", "slide", "universal")
KINDS = ("slides", "held", "stretches", "points", "stretching points")


def rope_scene(seed: int) -> dict[str, Any]:
    """A rope of the kind that the number says."""
    rng, kind = np.random.default_rng(seed), KINDS[seed % len(KINDS)]
    maker = Maker(rng, "given")
    through = through_points(maker) if "points" in kind else over_sheaves(maker, kind == "held")
    entry: dict[str, Any] = {"type": "rope", "through": through if seed % 2 else through[::-1]}
    if not seed % 2:
        turn = {"left": "right", "right": "left"}
        entry["through"] = [{**own, "side": turn[own["side"]]} if "side" in own else own for own in entry["through"]]
    maker.scene["couplings"] = {"rope": entry}
    for k in range(seed % 2):
        maker.body(f"b{k}", HUNG, 0.5, 0.0, 0.0)
    if "stretch" in kind:
        entry["stiffness"] = float(rng.uniform(100, 300))
        entry["damping"] = float(rng.uniform(0, 5))
        entry["length"] = 0.0
        entry["length"] = 0.95 * length(ropes(model(maker.scene))["rope"], maker.state)
    maker.set_moving()
    maker.loads(("force", "couple", "spring", "torque", "damper"), True)
    return maker.scene


def over_sheaves(maker: Maker, holds: bool) -> list[dict[str, Any]]:
    """From a point of the carrier down round a block, over a sheave on a pin, and down to a hand: in one plane."""
    rng, carrier = maker.rng, GROUND
    if rng.random() < 0.7:
        maker.body("carrier", HUNG, 0.0, 1.0, 0.0)
        carrier = "carrier"
    n, O = random_unit(rng), rng.uniform(-0.5, 0.5, 3)
    e, f = across(n)

    def at(x: float, y: float) -> Array:
        return O + x * e + y * f

    lean = float(rng.uniform(-0.1, 0.1))
    member(maker, carrier, "sheave", "pin", at(0.05, 0.0), n)
    member(maker, carrier, "block", "slide", at(-0.17, -0.9), f + lean * e)
    member(maker, carrier, "hand", "slide", at(0.4, -0.7), f - lean * e)
    A = placed(maker.state, carrier)

    def sheave(name: str, place: Array, radius: float, side: str) -> dict[str, Any]:
        own = maker.state[name]
        axis = (own.rotation.T @ A.rotation @ n).tolist()
        return {"sheave": on(maker, name, A.point(place)), "radius": radius, "axis": axis, "side": side}

    return [
        {"point": {"body": carrier, "at": at(-0.4, 0.1).tolist()}},
        sheave("block", at(-0.17, -0.9), 0.12, "left"),
        sheave("sheave", at(0.05, 0.0), 0.2, "right") | ({"slip": "none"} if holds else {}),
        {"point": on(maker, "hand", A.point(at(0.4, -0.7)))},
    ]


def through_points(maker: Maker) -> list[dict[str, Any]]:
    """Through points of the ground and of bodies that hang anyhow; two of one body side by side."""
    for k in range(3):
        maker.body(f"a{k}", HUNG, 0.4, 0.5, 0.1)
    spots = [(name, maker.spot(name)) for name in (GROUND, "a0", "a1", "a1", "a2")]
    return [{"point": {"body": name, "at": spot.tolist()}} for name, spot in spots]


def on(maker: Maker, name: str, place: Array) -> dict[str, Any]:
    """The point of a body that stands at a place."""
    own = maker.state[name]
    return {"body": name, "at": (own.rotation.T @ (place - own.position)).tolist()}


def member(maker: Maker, carrier: str, name: str, kind: str, point: Array, axis: Array) -> None:
    """A body on a joint at a point of the carrier, along an axis there, in any attitude."""
    maker.scene["bodies"][name] = {**maker.mass(), "points": {}}
    maker.names.append(name)
    A, R = placed(maker.state, carrier), random_rotation(maker.rng)
    q, still = maker.spot(name), np.zeros(3)
    maker.place(name, Placed(A.point(point) - R @ q, R, still, still))
    more = {"to_axis": (R.T @ A.rotation @ axis).tolist()} if kind == "pin" else {}
    maker.join(f"j_{name}", kind, {"axis": axis.tolist()} | more, carrier, point, name, q)


@cache
def roped(seed: int) -> Case:
    """A random scene's run, with the oracle's answer at every instant."""
    return case({**rope_scene(seed), "foundation": {"about": ABOUT.tolist()}})
