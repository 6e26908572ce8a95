"""Random scenes with wheels: a wheel or ball on a plane of the ground or of a body, and what hangs on it."""

from __future__ import annotations

from functools import cache
from typing import Any

import numpy as np

from tests.oracle.read import GROUND, Placed, placed, start_state
from tests.oracle.scenes import Maker
from tests.oracle.turns import random_rotation, random_unit
from tests.oracle.wheels import height, wheels
from tests.shared.trees import ABOUT, Case, case

HUNG = ("pin", "ball", "slide", "universal", "cylinder")


def rolling_scene(seed: int) -> tuple[dict[str, Any], dict[str, Placed]]:
    """A wheel on a plane, tilted anyhow, what hangs on it, its loads, and a motion that it admits."""
    rng = np.random.default_rng(seed)
    maker = Maker(rng, "given")
    on = GROUND
    if seed % 2:
        maker.body("table", ("pin", "ball"), 0.0, 1.0, 0.0)
        on = "table"
    maker.body("wheel", HUNG, 0.0, 0.0, 1.0)
    normal, entry = random_unit(rng), {"shape": "sphere"}
    if seed % 3:
        entry = {"axis": random_unit(rng).tolist()} | ({"slides": "along"} if seed % 5 == 4 else {})
    ends = {"wheel": maker.end("hub", "wheel", maker.spot("wheel")), "on": maker.end("road", on, maker.spot(on))}
    radius = float(rng.uniform(0.2, 0.6))
    given = {**ends, "normal": (2.0 * normal).tolist(), "radius": radius, "held": True, **entry}
    maker.scene["rolling"] = {"rim": given}
    stand(maker, rng)
    for k in range(seed % 3):
        maker.body(f"b{k}", HUNG, 0.3, 0.0, 0.0)
    maker.set_moving()
    maker.loads(("force", "couple", "spring", "damper", "torque"), True)
    return maker.scene, start_state(maker.scene)


def stand(maker: Maker, rng: np.random.Generator) -> None:
    """Turn the wheel until it does not lie flat, and shift it onto its plane."""
    (wheel,) = wheels(maker.scene)
    while True:
        own = maker.state["wheel"]._replace(rotation=random_rotation(rng))
        n = placed(maker.state, wheel.a.body).rotation @ wheel.normal
        if wheel.axle is None or abs(float(n @ (own.rotation @ wheel.axle))) < 0.8:
            break
    maker.place("wheel", own)
    maker.place("wheel", own._replace(position=own.position - height(wheel, maker.state) * n))


@cache
def rolling(seed: int) -> Case:
    """A random scene's run, with the oracle's answer at every instant."""
    scene, _ = rolling_scene(seed)
    return case({**scene, "foundation": {"about": ABOUT.tolist()}})
