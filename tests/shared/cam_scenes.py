"""Random scenes with a cam: on a carrier that moves anyhow, or the ground, what hangs on disc and follower, and loads."""

from __future__ import annotations

import math
from functools import cache
from typing import Any

import numpy as np
from scipy.interpolate import CubicSpline

from tests.oracle.read import GROUND, Placed, placed
from tests.oracle.scenes import Maker
from tests.oracle.turns import Array, across, random_rotation, random_unit
from tests.shared.trees import ABOUT, Case, case

HUNG = ("pin", "ball", "slide", "universal")
KINDS = tuple((joint, contact) for joint in ("slide", "pin") for contact in ("roller", "flat", "point"))
POINTS = 24  # of a lift
FIRST = 0.1  # of a table [rad]: no start stands on one of its points, where the lift's third derivative jumps
LEAST = {"slide": 0.04, "pin": 0.06}  # of a lift, m or rad


def cam_scene(seed: int) -> dict[str, Any]:
    """A cam of the kind that the number says, on the ground or a body, guided on both sides, so that it never lifts."""
    rng = np.random.default_rng(seed)
    joint, contact = KINDS[seed % len(KINDS)]
    maker = Maker(rng, "given")
    carrier = GROUND
    if rng.random() < 0.7:
        maker.body("carrier", HUNG, 0.0, 1.0, 0.0)
        carrier = "carrier"
    n = random_unit(rng)
    e, f = across(n)
    O = rng.uniform(-0.5, 0.5, 3)
    C = O + (0.5 * e + 0.05 * f if joint == "slide" else 0.45 * f) + rng.uniform(-0.2, 0.2) * n
    sense, way = (math.copysign(1.0, float(rng.standard_normal())) for _ in range(2))
    member(maker, carrier, "disc", "pin", O, sense * n, 0.0)
    if joint == "slide":
        first = float(rng.uniform(-0.3, 0.3))
        member(maker, carrier, "follower", "slide", rng.uniform(-0.5, 0.5, 3), way * e, first)
    else:
        first = 0.0
        pivot = O - 0.6 * e + 0.1 * f + rng.uniform(-0.2, 0.2) * n
        member(maker, carrier, "follower", "pin", pivot, way * n, first)
    own = maker.state["follower"]
    A = placed(maker.state, carrier)
    at = own.rotation.T @ (A.point(C) - own.position)
    entry: dict[str, Any] = {"type": "cam", "of": ["j_disc", "j_follower"], "lift": "lift", "contact": contact}
    if contact == "roller":
        entry["radius"] = 0.1
    elif contact == "flat":
        entry["normal"] = (own.rotation.T @ A.rotation @ (e + 0.1 * f if joint == "slide" else f - 0.2 * e)).tolist()
    phase = float(rng.uniform(-1, 1)) if seed % 2 else 0.0
    maker.scene["tables"] = {"lift": lift(rng, LEAST[joint], phase, first)}
    maker.scene["couplings"] = {
        "cam": entry | {"at": {"body": "follower", "at": at.tolist()}, "two_sided": True, "phase": phase}
    }
    for k in range(seed % 2 + 1):
        maker.body(f"b{k}", HUNG, 0.5, 0.0, 0.0)
    maker.set_moving()
    maker.loads(("force", "couple", "spring", "torque", "damper"), True)
    return maker.scene


def member(maker: Maker, carrier: str, name: str, kind: str, point: Array, axis: Array, travel: float) -> None:
    """A body on a joint from a point of the carrier, along an axis there, in any attitude, at angle zero or a travel."""
    maker.scene["bodies"][name] = {**maker.mass(), "points": {}}
    maker.names.append(name)
    A, R = placed(maker.state, carrier), random_rotation(maker.rng)
    q = maker.spot(name)
    still = np.zeros(3)
    maker.place(name, Placed(A.point(point + travel * axis) - R @ q, R, still, still))
    more = {"to_axis": (R.T @ A.rotation @ axis).tolist()} if kind == "pin" else {}
    maker.join(f"j_{name}", kind, {"axis": axis.tolist()} | more, carrier, point, name, q)


def lift(rng: np.random.Generator, size: float, phase: float, first: float) -> dict[str, Any]:
    """The table of a lift that is `first` where the disc's angle is zero."""
    x = FIRST + np.linspace(0.0, 2.0 * np.pi, POINTS + 1)
    turn = float(rng.uniform(0, 2 * np.pi))
    y = size * (np.sin(x + turn) + 0.2 * np.cos(2.0 * x))
    y[-1] = y[0]
    y = y + (first - float(CubicSpline(x, y, bc_type="periodic")(-phase)))
    y[-1] = y[0]
    return {"x": x.tolist(), "y": y.tolist(), "interpolation": "cubic", "period": 2.0 * np.pi}


@cache
def cammed(seed: int) -> Case:
    """A random scene's run, with the oracle's answer at every instant."""
    return case({**cam_scene(seed), "foundation": {"about": ABOUT.tolist()}})
