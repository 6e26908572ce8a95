"""What holds of bushings in every scene: energy, either side, the world turned, time told faster, smaller scenes."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

from tests.oracle.transforms import turned
from tests.oracle.turns import about, attitude, random_rotation
from tests.shared.scenes import near, solved

pytestmark = pytest.mark.heavy
ENGINE = {
    "mass": 4.0, "center": [0.1, 0.02, 0.05], "inertia": [0.12, 0.15, 0.09],
    "points": {"c": [0, 0, 0], "d": [0.2, 0, 0]},
    "position": [0.01, 0.02, 0], "orientation": {"matrix": about(np.array([0.6, 0.0, 0.8]), 0.7).tolist()},
}  # fmt: skip
ROTOR = {
    "mass": 2.0, "center": [0, 0.05, 0], "inertia": [0.03, 0.04, 0.05], "points": {"a": [0, 0, 0]},
    "position": [0.2, 0.1, 0.1], "orientation": {"matrix": about(np.array([0.0, 1.0, 0.0]), -0.5).tolist()},
}  # fmt: skip
STIFF = {"stiffness": [200.0, 300.0, 500.0], "turning": [3.0, 9.0, 6.0]}
ANALYSIS = {"times": [0.0, 0.2, 0.4, 0.7], "tolerance": 1e-11}


def two_bodies(**mount: Any) -> dict[str, Any]:
    """An engine on a mount, a rotor on another in the engine: both fast, and turned by more than a radian."""
    return {
        "gravity": [0.5, 0.0, -9.81], "joints": {}, "ground": {"points": {"O": [0, 0, 0]}},
        "bodies": {
            "engine": {**ENGINE, "velocity": [0.5, 0.3, 0.1], "angular_velocity": [3.0, -4.0, 5.0]},
            "rotor": {**ROTOR, "velocity": [0.1, 0.2, 0.0], "angular_velocity": [3.0, -4.0, 2.0]},
        },
        "forces": {
            "mount": {"type": "bushing", "from": "ground.O", "to": "engine.c", **STIFF, **mount},
            "inner": {"type": "bushing", "from": "engine.d", "to": "rotor.a", "stiffness": [900.0, 400.0, 100.0],
                      "turning": [1.0, 2.0, 3.0], "orientation": {"axis": [1, 1, 0], "angle": 0.4}},
        },
        "analysis": ANALYSIS,
    }  # fmt: skip


DAMPED = {"damping": [3.0, 1.0, 2.0], "turning_damping": [0.1, 0.2, 0.3]}
PRELOADED = {"preload": [1.0, 2.0, 40.0], "turning_preload": [0.3, 0.2, -0.5]}
# of six numbers each, so that the 6 x 6 are positive definite and couple all directions
CROSSED = {
    "stiffness": [[200, 40, -20], [40, 300, 60], [-20, 60, 500]], "turning": [[3, 0.5, -1], [0.5, 9, 2], [-1, 2, 6]],
    "coupling": [[4, -7, 2], [5, 3, -6], [-3, 8, 5]],
}  # fmt: skip
CROSS_DAMPED = {
    "damping": [[3, 0.5, -0.4], [0.5, 1, 0.2], [-0.4, 0.2, 2]],
    "turning_damping": [[0.1, 0.02, 0], [0.02, 0.2, -0.03], [0, -0.03, 0.3]],
    "coupling_damping": [[0.1, -0.05, 0.1], [0.05, 0.1, 0.02], [-0.1, 0.1, 0.2]],
}  # fmt: skip
RUBBER = {"x": [-0.3, -0.1, 0.0, 0.2, 0.4], "y": [-90, -20, 1, 30, 160], "interpolation": "cubic", "outside": "hold"}
TWIST = {"x": [-3.2, -1.0, 0.5, 3.2], "y": [-25.0, -6.0, 2.0, 30.0], "interpolation": "pchip"}
COGS = {"x": [0.1, 0.2, 0.4], "y": [20.0, -30.0, 20.0], "interpolation": "cubic", "period": 0.3}
BY_TABLES = {"stiffness": ["rubber", 300.0, "cogs"], "turning": [3.0, "twist", "twist"]}
TABLES = {"rubber": RUBBER, "twist": TWIST, "cogs": COGS}


@pytest.mark.parametrize(
    "more", [{}, PRELOADED, DAMPED | PRELOADED, BY_TABLES | PRELOADED, BY_TABLES | DAMPED, CROSSED | PRELOADED,
             CROSSED | CROSS_DAMPED],
    ids=["springs", "preloaded", "damped", "tables", "damped-tables", "crossed", "crossed-damped"],
)  # fmt: skip
def test_energy(more: dict[str, Any]) -> None:
    """Springs, preloads and tables have a potential at any angle; what dampers take is work, and never given back."""
    found = solved(two_bodies(**more) | ({"tables": TABLES} if "turning" in more else {}))
    assert float(np.linalg.norm(found.forces["mount"]["turn"], axis=1).max()) > 1.0
    e = found.energy
    near(
        e["kinetic"] + e["potential"] - e["work"], e["kinetic"][0] + e["potential"][0], float(e["kinetic"].max()), 1e-10
    )
    if "damping" in more:
        assert (np.diff(e["work"]) < 0.0).all()
    else:
        near(e["work"], 0.0, float(e["kinetic"].max()), 1e-14)
    assert float(found.accuracy["balance_residual"]) < 1e-12


def test_alike_in_all_directions_it_has_no_axes() -> None:
    """Then either side may be `from`, axes may lie anyhow, and it is a spring of length 0 beside a turning one."""
    alike = two_bodies(stiffness=300.0, turning=5.0)
    wanted = solved(alike)
    other = two_bodies(stiffness=300.0, turning=5.0)
    other["forces"]["mount"] |= {"from": "engine.c", "to": "ground.O", "orientation": {"axis": [1, 2, 0], "angle": 1.0}}
    apart = two_bodies(stiffness=0.0, turning=5.0)
    apart["forces"]["spring"] = {
        "type": "spring",
        "from": "engine.c",
        "to": "ground.O",
        "stiffness": 300.0,
        "length": 0,
    }
    for scene in (other, apart):
        found = solved(scene)
        for name in ("engine", "rotor"):
            near(found.bodies[name]["position"], wanted.bodies[name]["position"], 1.0, 1e-9)
            near(found.bodies[name]["angular_velocity"], wanted.bodies[name]["angular_velocity"], 10.0, 1e-9)


def test_the_world_turned() -> None:
    """With it and the bodies' axes a bushing's axes turn; what it tells stands in its own."""
    R = random_rotation(np.random.default_rng(3))
    scene = two_bodies(**CROSSED, **CROSS_DAMPED, **PRELOADED)
    other = turned(scene, R)
    for load in other["forces"].values():
        load["orientation"] = {"matrix": (R @ attitude(load.get("orientation"))).tolist()}
    wanted, found = solved(scene), solved(other)
    for name in ("engine", "rotor"):
        near(found.bodies[name]["position"], wanted.bodies[name]["position"] @ R.T, 1.0, 1e-9)
    for quantity in ("force", "moment", "shift", "turn"):
        near(found.forces["mount"][quantity], wanted.forces["mount"][quantity], 100.0, 1e-9)


def test_faster() -> None:
    """k -> c^2 k and damping -> c d, with speeds c times as large and weight c^2: the same way in 1/c of the time."""
    c = 3.0
    scene, fast = (two_bodies(**CROSSED, **CROSS_DAMPED, **PRELOADED) for _ in range(2))
    powers = dict.fromkeys(("stiffness", "turning", "coupling", "preload", "turning_preload"), 2)
    powers |= dict.fromkeys(("damping", "turning_damping", "coupling_damping"), 1)
    fast["gravity"] = (c**2 * np.array(scene["gravity"])).tolist()
    for load in fast["forces"].values():
        load |= {key: (c**n * np.array(load[key])).tolist() for key, n in powers.items() if key in load}
    for body in fast["bodies"].values():
        body |= {key: (c * np.array(body[key])).tolist() for key in ("velocity", "angular_velocity") if key in body}
    fast["analysis"] = {"times": [t / c for t in ANALYSIS["times"]], "tolerance": 1e-11}
    wanted, found = solved(scene), solved(fast)
    near(found.bodies["rotor"]["position"], wanted.bodies["rotor"]["position"], 1.0, 1e-9)
    near(found.forces["mount"]["moment"], c**2 * wanted.forces["mount"]["moment"], 1000.0, 1e-9)


FLAT = """
heun: 1
SPACE
gravity: [0, -9.81, 0]
tables: {rubber: {x: [-9, -0.01, 0, 0.01, 9], y: [-9000, -20, 0, 20, 9000]}}
ground: {points: {O: [0, 0, 0], P: [0.5, 0.4, 0]}}
bodies:
  engine: {mass: 4, center: [0.1, 0.02, 0], inertia: [0.1, 0.15, 0.2], points: {c: [0, 0, 0], d: [0.2, 0, 0]},
           angular_velocity: [0, 0, 3], position: [0.02, 0.01, 0], orientation: {axis: [0, 0, 1], angle: 0.3}}
  arm: {mass: 1, center: [0.1, 0, 0], inertia: [0.01, 0.02, 0.03], points: {a: [0, 0, 0], e: [0.2, 0, 0]}}
  lid: {mass: 1, center: [0.1, 0, 0], inertia: [0.01, 0.02, 0.03], points: {a: [0, 0, 0], e: [0.2, 0, 0]}}
joints:
  hinge: {type: pin, from: engine.d, to: arm.a, axis: [0, 0, 1], initial: {angle: 0.4, rate: 1}}
  fast: {type: weld, from: arm.e, to: lid.a}
forces:
  mount: {type: bushing, from: ground.O, to: engine.c, stiffness: {x: rubber, y: 300, z: 40}, turning: [1, 2, 6],
          damping: [3, 1, 2], turning_damping: 0.1, preload: [1, 40, 0], turning_preload: [0, 0, -0.5]}
  tip: {type: bushing, from: lid.e, to: ground.P, stiffness: [[90, 9, 0], [9, 40, 0], [0, 0, 10]], turning: [1, 2, 3],
        coupling: [[0, 0, 4], [0, 0, -5], [1, 2, 0]], coupling_damping: [[0, 0, 0.1], [0, 0, 0], [0, 0, 0]],
        damping: 0.5, turning_damping: 0.5,
        orientation: {axis: [0, 0, 1], angle: 0.4}}
  coil: {type: spring, from: ground.P, to: lid.e, force: "-table(rubber, length - 0.3) - 4*rate"}
analysis: {times: [0, 0.1, 0.25], tolerance: 1e-10}
"""


def test_smaller_scenes() -> None:
    """In a plane, found or declared, and with a body welded on, all is as of the scene that is drawn."""
    wanted = solved(FLAT.replace("SPACE", "space: spatial"), reduce=False)
    for space in ("space: planar", "space: auto"):
        found = solved(FLAT.replace("SPACE", space))
        assert found.model["space"] == "planar"
        near(found.bodies["lid"]["position"], wanted.bodies["lid"]["position"], 1.0, 1e-9)
        near(found.joints["fast"]["force"], wanted.joints["fast"]["force"], 100.0, 1e-8)
        for name in ("mount", "tip"):
            for quantity in ("force", "moment", "shift", "turn"):
                near(found.forces[name][quantity], wanted.forces[name][quantity], 100.0, 1e-8)


@pytest.mark.parametrize(
    "old, new",
    [
        ("turning_preload: [0, 0, -0.5]", "turning_preload: [0.3, 0, -0.5]"),
        ("turning_preload: [0, 0, -0.5]", "turning_preload: [0, 0, -0.5], orientation: {axis: [1, 0, 0], angle: 0.3}"),
        ("[9, 40, 0], [0, 0, 10]", "[9, 40, 3], [0, 3, 10]"),
        ("coupling: [[0, 0, 4]", "coupling: [[0, 1, 4]"),
    ],
)
def test_what_leaves_the_plane_is_no_planar_scene(old: str, new: str) -> None:
    """A moment across the normal, axes askew to it, or what couples it with the plane, turn a free body out of it."""
    flat = FLAT.replace("SPACE", "space: auto")
    assert flat.count(old) == 1
    assert solved(flat.replace(old, new)).model["space"] == "spatial"
