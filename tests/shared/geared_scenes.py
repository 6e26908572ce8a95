"""Random scenes with gears, belts and screws: a carrier that moves anyhow, two members on it, what hangs on these."""

from __future__ import annotations

import math
from functools import cache
from typing import Any

import numpy as np

from tests.oracle.read import GROUND, Placed, placed
from tests.oracle.scenes import Maker
from tests.oracle.turns import Array, across, cross, random_rotation, random_unit
from tests.shared.trees import ABOUT, Case, case

HUNG = ("pin", "ball", "slide", "universal")
FORMS = ("external", "internal", "bevel", "rack", "screw")


def geared_scene(seed: int, form: str | None = None, loops: int = 0) -> dict[str, Any]:
    """A pair of FORMS, as its number says, or this one, on a body or the ground; loops: chains that are closed."""
    rng = np.random.default_rng(seed)
    maker = Maker(rng, "given")
    carrier = GROUND
    if seed % 3:
        maker.body("carrier", HUNG, 0.0, 1.0, 0.3)
        carrier = "carrier"
    form = form or FORMS[seed % len(FORMS)]
    couple = {"screw": thread, "belt": belt, "aside": belt}.get(form, mesh)
    maker.scene["couplings"] = {"mesh": couple(maker, rng, carrier, form)}
    for k in range(seed % 2 + 1):
        maker.body(f"b{k}", HUNG, 0.5, 0.0, 0.0)
    for k in range(loops):
        maker.closure(f"loop{k}", ("rod", "line", "plane", "ball"))
    maker.set_moving()
    maker.loads(("force", "couple", "spring", "torque", "damper"), True)
    return maker.scene


def mesh(
    maker: Maker, rng: np.random.Generator, carrier: str, form: str, names: tuple[str, str] = ("one", "two")
) -> dict[str, Any]:
    """Two members that move alike at a point, and the entry of their mesh; the carrier's axes."""
    P, n = rng.uniform(-1, 1, 3), random_unit(rng)
    out = across(n)[0]
    r1, r2 = rng.uniform(0.2, 0.5), rng.uniform(0.6, 0.9)
    first = ("pin", P - r1 * out + rng.uniform(-0.3, 0.3) * n, n)
    side = 1.0 if form == "external" else -1.0
    sense = math.copysign(1.0, float(rng.standard_normal()))
    second = ("pin", P + side * r2 * out + rng.uniform(-0.3, 0.3) * n, sense * n)
    if form == "bevel":
        other = math.cos(1.1) * n + math.sin(1.1) * out
        apex = P - 0.7 * n - 0.9 * other
        first, second = ("pin", apex + 0.8 * n, n), ("pin", apex + rng.uniform(0.2, 1) * other, sense * other)
    elif form == "rack":
        second = ("slide", P + rng.uniform(-1, 1, 3), sense * cross(n, out))
    for name, (kind, point, axis) in zip(names, (first, second), strict=True):
        member(maker, rng, carrier, name, kind, point, axis)
    of = [f"j_{name}" for name in (names if rng.random() < 0.5 else names[::-1])]
    helix = float(rng.uniform(-0.4, 0.4))
    at = {"body": carrier, "at": P.tolist()}
    return {"type": "gear", "of": of, "at": at, "helix": helix, "pressure_angle": 0.0}


def belt(
    maker: Maker, rng: np.random.Generator, carrier: str, form: str, names: tuple[str, str] = ("one", "two")
) -> dict[str, Any]:
    """Two pulleys, of parallel axes, and the entry of their belt; of form `aside` not in one plane."""
    n, P = random_unit(rng), rng.uniform(-1, 1, 3)
    Q = P + rng.uniform(0.85, 1.2) * across(n)[0] + (rng.uniform(-0.2, 0.2) * n if form == "aside" else 0.0)
    for name, point, axis in ((names[0], P, n), (names[1], Q, math.copysign(1.0, float(rng.standard_normal())) * n)):
        member(maker, rng, carrier, name, "pin", point, axis)
    sizes = {"radii": rng.uniform(0.1, 0.4, 2).tolist(), "crossed": bool(rng.random() < 0.4)}
    return {"type": "belt", "of": [f"j_{name}" for name in names], "pretension": float(rng.uniform(5, 40)), **sizes}


def thread(
    maker: Maker, rng: np.random.Generator, carrier: str, form: str, names: tuple[str, str] = ("one", "two")
) -> dict[str, Any]:
    """A spindle in a pin and a nut in a slide along it, and the entry of their thread."""
    n, (spindle, nut) = random_unit(rng), names
    member(maker, rng, carrier, spindle, "pin", rng.uniform(-1, 1, 3), n)
    sense = math.copysign(1.0, float(rng.standard_normal()))
    member(maker, rng, carrier, nut, "slide", rng.uniform(-1, 1, 3), sense * n)
    lead = float(rng.uniform(-3, 3))
    return {"type": form, "of": [f"j_{spindle}", f"j_{nut}"], "lead": lead, **rubs(lead)}


def rubs(lead: float) -> dict[str, Any]:
    """The friction of every other thread, as the digits of its lead say."""
    own = np.random.default_rng(int(1e6 * abs(lead)))
    if own.random() < 0.5:
        return {}
    numbers = {"coefficient": own.uniform(0.05, 0.3), "radius": own.uniform(0.1, 0.4), "speed": own.uniform(0.1, 1.0)}
    if own.random() < 0.5:
        numbers["flank_angle"] = own.uniform(0.1, 0.5)
    return {"friction": {key: float(value) for key, value in numbers.items()}}


def member(
    maker: Maker, rng: np.random.Generator, carrier: str, name: str, kind: str, point: Array, axis: Array
) -> None:
    """A body on a joint at a point of the carrier, along an axis there, in any attitude; either is `from`."""
    maker.scene["bodies"][name] = {**maker.mass(), "points": {}}
    maker.names.append(name)
    A, R = placed(maker.state, carrier), random_rotation(rng)
    q = maker.spot(name)
    shift = rng.uniform(-0.3, 0.3) * axis if kind != "pin" else np.zeros(3)
    maker.place(name, Placed(A.point(point + shift) - R @ q, R, np.zeros(3), np.zeros(3)))
    own = R.T @ A.rotation @ axis
    if rng.random() < 0.5:
        spec = {"axis": axis.tolist()} | ({"to_axis": own.tolist()} if kind != "slide" else {})
        maker.join(f"j_{name}", kind, spec, carrier, point, name, q)
    else:
        spec = {"axis": own.tolist()} | ({"to_axis": axis.tolist()} if kind != "slide" else {})
        maker.join(f"j_{name}", kind, spec, name, q, carrier, point)


@cache
def geared(seed: int, form: str | None = None, loops: int = 0) -> Case:
    """A random scene's run, with the oracle's answer at every instant."""
    return case({**geared_scene(seed, form, loops), "foundation": {"about": ABOUT.tolist()}})
