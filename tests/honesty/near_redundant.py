"""Random scenes that are almost held twice, or almost not held: `near` between 1e-12 and 1e-3 says how nearly.

Each is drawn in world axes and statically determined: tests/shared/exact has its one right answer.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]
Rng = np.random.Generator


class NearScene(NamedTuple):
    """A scene, and the rates about z that its bodies are given."""

    scene: dict[str, Any]
    rates: dict[str, float]


def body(mass: float, center: Array, size: float, points: dict[str, Array], planar: bool = False) -> dict[str, Any]:
    """A body as drawn: a mass with a radius of gyration of about half the size."""
    moment = 0.2 * mass * size * size
    inertia: Any = moment if planar else [0.9 * moment, moment, 1.1 * moment]
    named = {name: [float(x) for x in p] for name, p in points.items()}
    return {"mass": mass, "center": [float(x) for x in center], "inertia": inertia, "points": named}


def scene_of(
    bodies: dict[str, Any], joints: dict[str, Any], ground: dict[str, Array], planar: bool, **more: Any
) -> dict[str, Any]:
    named = {name: [float(x) for x in p] for name, p in ground.items()}
    space = {"space": "planar"} if planar else {}
    return {
        "title": "nearly held twice",
        **space,
        "ground": {"points": named},
        "bodies": bodies,
        "joints": joints,
        **more,
    }


def flat(r: float, angle: float) -> Array:
    return np.array([r * math.cos(angle), r * math.sin(angle), 0.0])


def mass_of(rng: Rng) -> float:
    """A kilogram, or a mass ratio up to 1e6 either way."""
    return 1.0 if rng.random() < 0.5 else float(10.0 ** rng.uniform(-6, 6))


def some_loads(rng: Rng, on: str, planar: bool, force: float = 5.0, couple: float = 1.0) -> dict[str, Any]:
    """A force at `p` and a couple."""
    F, N = force * rng.standard_normal(3), couple * rng.standard_normal(3)
    if planar:
        F[2] = N[0] = N[1] = 0.0
    return {
        "push": {"type": "force", "on": f"{on}.p", "vector": F.tolist()},
        "turn": {"type": "couple", "on": on, "vector": N.tolist()},
    }


def weight(rng: Rng, planar: bool) -> list[float]:
    g = 9.81 * rng.standard_normal(3) * (rng.random() < 0.5)
    return [float(g[0]), float(g[1]), 0.0 if planar else float(g[2])]


def planar_rods(rng: Rng, near: float) -> NearScene:
    """A body on three rods of the plane whose lines miss one point by `near`: only the couple shows it."""
    size = float(10.0 ** rng.uniform(-2, 2))
    C = size * rng.uniform(-0.3, 0.3, 3) * [1, 1, 0]
    start = rng.uniform(0, 2)
    points, ground, joints = {"p": C + 0.2 * size * flat(1, rng.uniform(0, 6))}, {}, {}
    for k in range(3):
        angle = start + (2.0 + rng.uniform(-0.4, 0.4)) * k
        miss = near * size * flat(rng.choice([-1, 1]) * (k > 0), angle + math.pi / 2)
        points[f"b{k}"] = C + miss + size * flat(0.5, angle)
        ground[f"g{k}"] = C + miss + size * flat(rng.uniform(1, 2), angle)
        joints[f"r{k}"] = {"type": "rod", "from": f"ground.g{k}", "to": f"plate.b{k}"}
    plate = body(mass_of(rng), C, size, points, planar=True)
    more = {"gravity": weight(rng, True), "forces": some_loads(rng, "plate", True)}
    return NearScene(scene_of({"plate": plate}, joints, ground, True, **more), {})


def parallel_rods(rng: Rng, near: float) -> NearScene:
    """A beam on three rods of the plane, parallel but for `near`: what acts across loads them by 1/near."""
    size = float(10.0 ** rng.uniform(-2, 2))
    places = size * (rng.uniform(-1, 1, 3) + np.array([-2.5, 0.0, 2.5]))
    points, ground, joints = {"p": np.array([0.3 * size, 0.0, 0.0])}, {}, {}
    turn = rng.uniform(0, 6)
    c, s = math.cos(turn), math.sin(turn)
    R = np.array([[c, -s, 0], [s, c, 0], [0, 0, 1]])
    for k, x in enumerate(places):
        points[f"b{k}"] = R @ [x, 0, 0]
        ground[f"g{k}"] = R @ [x + near * size * (k == 1), -size, 0]
        joints[f"r{k}"] = {"type": "rod", "from": f"ground.g{k}", "to": f"beam.b{k}"}
    beam = body(mass_of(rng), R @ [0.1 * size, 0, 0], size, points, planar=True)
    more = {"gravity": weight(rng, True), "forces": some_loads(rng, "beam", True)}
    return NearScene(scene_of({"beam": beam}, joints, ground, True, **more), {})


def legs(rng: Rng, near: float) -> NearScene:
    """A table on four legs that lean by `near`, and two struts: nothing else resists a turn about the upright."""
    size = float(10.0 ** rng.uniform(-1, 1))
    points: dict[str, Array] = {"p": size * rng.uniform(-0.5, 0.5, 3)}
    ground, joints = {}, {}
    for k in range(4):
        corner = size * np.array([math.cos(k * math.pi / 2 + 0.3), math.sin(k * math.pi / 2 + 0.3), 0.0])
        lean = near * size * rng.uniform(0.3, 1) * np.array([-corner[1], corner[0], 0.0]) / size
        points[f"b{k}"], ground[f"g{k}"] = corner, corner + lean * (-1) ** k - [0, 0, size]
    for k, along in ((4, np.array([1.0, 0, 0])), (5, np.array([0.0, 1, 0]))):
        points[f"b{k}"], ground[f"g{k}"] = 0.3 * size * along, 2 * size * along
    for k in range(6):
        joints[f"r{k}"] = {"type": "rod", "from": f"ground.g{k}", "to": f"table.b{k}"}
    table = body(mass_of(rng), size * rng.uniform(-0.2, 0.2, 3), size, points)
    more = {"gravity": weight(rng, False), "forces": some_loads(rng, "table", False)}
    return NearScene(scene_of({"table": table}, joints, ground, False, **more), {})


def platform(rng: Rng, near: float) -> NearScene:
    """A platform on six rods that pass one line within `near`: only that resists a turn about the line."""
    size = float(10.0 ** rng.uniform(-1, 1))
    through, along = size * rng.uniform(-0.5, 0.5, 3), rng.standard_normal(3)
    along /= np.sqrt(along @ along)
    points: dict[str, Array] = {"p": size * rng.uniform(-0.5, 0.5, 3)}
    ground, joints = {}, {}
    for k in range(6):
        hit = through + along * size * rng.uniform(-2, 2)
        n = rng.standard_normal(3)
        n /= np.sqrt(n @ n)
        off = np.cross(along, n)
        hit = hit + near * size * off * (k == 5)
        a, b = rng.uniform(0.3, 0.9), rng.uniform(1.3, 2.5)
        points[f"b{k}"], ground[f"g{k}"] = hit + a * size * n, hit + b * size * n
        joints[f"r{k}"] = {"type": "rod", "from": f"ground.g{k}", "to": f"plate.b{k}"}
    plate = body(mass_of(rng), through, size, points)
    more = {"gravity": weight(rng, False), "forces": some_loads(rng, "plate", False)}
    return NearScene(scene_of({"plate": plate}, joints, ground, False, **more), {})


def shaft(rng: Rng, near: float) -> NearScene:
    """A shaft on a ball and a line, kept from turning by a rod that misses its axis by `near`."""
    size = float(10.0 ** rng.uniform(-1, 1))
    a, u = size * rng.uniform(-0.5, 0.5, 3), rng.standard_normal(3)
    u /= np.sqrt(u @ u)
    n = rng.standard_normal(3)
    n /= np.sqrt(n @ n)
    hit = a + 0.6 * size * u + near * size * np.cross(u, n)
    points = {"a": a, "b": a + size * u, "h": hit + 0.5 * size * n, "p": a + size * rng.uniform(-0.5, 0.5, 3)}
    ground = {"A": points["a"], "B": points["b"], "H": hit + 1.5 * size * n}
    joints = {
        "ball": {"type": "ball", "from": "ground.A", "to": "shaft.a"},
        "float": {"type": "line", "from": "ground.B", "to": "shaft.b", "axis": u.tolist()},
        "stop": {"type": "rod", "from": "ground.H", "to": "shaft.h"},
    }
    made = body(mass_of(rng), a + 0.5 * size * u + 0.1 * size * n, size, points)
    more = {"gravity": weight(rng, False), "forces": some_loads(rng, "shaft", False)}
    return NearScene(scene_of({"shaft": made}, joints, ground, False, **more), {})


def lever(rng: Rng, near: float) -> NearScene:
    """A lever of the plane on a pin, held by a rod that misses the pin by `near`."""
    size = float(10.0 ** rng.uniform(-2, 2))
    O, angle = size * rng.uniform(-1, 1, 3) * [1, 1, 0], rng.uniform(0, 6)
    miss = near * size * flat(1, angle + math.pi / 2)
    points = {"o": O, "h": O + miss + size * flat(0.7, angle), "p": O + size * flat(1, rng.uniform(0, 6))}
    ground = {"O": O, "H": O + miss + size * flat(1.9, angle)}
    joints = {
        "pin": {"type": "pin", "from": "ground.O", "to": "lever.o"},
        "stop": {"type": "rod", "from": "ground.H", "to": "lever.h"},
    }
    made = body(mass_of(rng), O + size * flat(0.3, rng.uniform(0, 6)), size, points, planar=True)
    more = {"gravity": weight(rng, True), "forces": some_loads(rng, "lever", True)}
    return NearScene(scene_of({"lever": made}, joints, ground, True, **more), {})


def toggle(rng: Rng, near: float) -> NearScene:
    """Two bars of the plane from wall to wall, straight but for `near`, loaded across: tension and thrust by 1/near."""
    size, angle = float(10.0 ** rng.uniform(-2, 2)), rng.uniform(0, 6)
    e, f = flat(1, angle), flat(1, angle + math.pi / 2)
    A, B, C = np.zeros(3), size * (e + near * f), size * rng.uniform(1.5, 2.5) * e
    bodies = {
        "left": body(mass_of(rng), 0.5 * (A + B), size, {"a": A, "b": B, "p": B}, planar=True),
        "right": body(mass_of(rng), 0.5 * (B + C), size, {"b": B, "c": C}, planar=True),
    }
    joints = {
        "A": {"type": "pin", "from": "ground.A", "to": "left.a"},
        "B": {"type": "pin", "from": "left.b", "to": "right.b"},
        "C": {"type": "pin", "from": "ground.C", "to": "right.c"},
    }
    forces = some_loads(rng, "left", True)
    del forces["turn"]
    more = {"gravity": weight(rng, True), "forces": forces}
    return NearScene(scene_of(bodies, joints, {"A": A, "C": C}, True, **more), {})


def four_bar(rng: Rng, near: float, parallel: bool) -> NearScene:
    """A four-bar of the plane that lies flat but for `near`, at rest or turning."""
    size, base = float(10.0 ** rng.uniform(-1, 1)), rng.uniform(0, 6)
    width = size * (1.0 if parallel else rng.uniform(0.6, 1.6))
    lift = 1.0 if parallel else rng.uniform(0.3, 2.0)
    A, D = np.zeros(3), size * flat(1.7, base)
    B = size * flat(1.0, base + near)
    C = D + (B if parallel else width * flat(1.0, base + near * lift))
    bodies = {
        "left": body(mass_of(rng), 0.5 * (A + B), size, {"a": A, "b": B, "p": B}, planar=True),
        "coupler": body(mass_of(rng), 0.5 * (B + C), size, {"b": B, "c": C}, planar=True),
        "right": body(mass_of(rng), 0.5 * (C + D), size, {"c": C, "d": D}, planar=True),
    }
    joints = {
        "A": {"type": "pin", "from": "ground.A", "to": "left.a"},
        "B": {"type": "pin", "from": "left.b", "to": "coupler.b"},
        "C": {"type": "pin", "from": "coupler.c", "to": "right.c"},
        "D": {"type": "pin", "from": "ground.D", "to": "right.d"},
    }
    forces = some_loads(rng, "left", True)
    rates = {"left": float(rng.uniform(0.5, 2))} if rng.random() < 0.5 else {}
    if rates:
        bodies["left"]["angular_velocity"] = [0.0, 0.0, rates["left"]]
    more = {"gravity": weight(rng, True), "forces": forces}
    return NearScene(scene_of(bodies, joints, {"A": A, "D": D}, True, **more), rates)


def parallelogram(rng: Rng, near: float) -> NearScene:
    return four_bar(rng, near, True)


def folded(rng: Rng, near: float) -> NearScene:
    return four_bar(rng, near, False)


FAMILIES: tuple[Callable[[Rng, float], NearScene], ...] = (
    planar_rods, parallel_rods, legs, platform, shaft, lever, toggle, parallelogram, folded,
)  # fmt: skip


def near_scene(seed: int) -> tuple[str, float, NearScene]:
    """The family's name, how near, and the scene."""
    rng = np.random.default_rng([20, seed])
    family = FAMILIES[seed % len(FAMILIES)]
    near = float(10.0 ** rng.uniform(-12, -3))
    return family.__name__, near, family(rng, near)


# ---- held twice but for `near`: what the ideal drawing does, and what is written
class Hinged(NamedTuple):
    """A machine whose pins would agree in one axis but for `near`: as written nothing moves.

    ideal: the same with the axes in one; rates: as given to its bodies about z.
    """

    scene: dict[str, Any]
    ideal: dict[str, Any]
    rates: dict[str, float]


def door(rng: Rng, near: float) -> Hinged:
    """A door on two pins: the second one's axis stands `near` beside the first one's, or leans by it."""
    height, width, rate = float(rng.uniform(0.5, 3)), float(rng.uniform(0.3, 2)), float(rng.uniform(0.5, 2))
    beside, lean = (near * height * flat(1, rng.uniform(0, 6)), np.zeros(3))
    if rng.random() < 0.3:
        beside, lean = lean, beside / height
    lower, upper = np.zeros(3), np.array([0.0, 0.0, height])
    moving, couple = bool(rng.random() < 0.6), [0.0, 0.0, float(rng.uniform(1, 5))]

    def made(beside: Array, lean: Array) -> dict[str, Any]:
        points = {"l": lower, "u": upper + beside}
        leaf = body(10.0, np.array([width / 2, 0, height / 2]), width, points)
        axis = [float(lean[0]), float(lean[1]), 1.0]
        joints = {
            "lower": {"type": "pin", "from": "ground.L", "to": "leaf.l", "axis": [0.0, 0.0, 1.0]},
            "upper": {"type": "pin", "from": "ground.U", "to": "leaf.u", "axis": axis},
        }
        more: dict[str, Any] = {"gravity": [0.0, 0.0, -9.81]}
        if moving:
            leaf["angular_velocity"] = [0.0, 0.0, rate]
            more["analysis"] = {"duration": 0.5, "samples": 3}
        else:
            more["forces"] = {"turn": {"type": "couple", "on": "leaf", "vector": couple}}
        return scene_of({"leaf": leaf}, joints, {"L": lower, "U": upper + beside}, False, **more)

    return Hinged(made(beside, lean), made(np.zeros(3), np.zeros(3)), {"leaf": rate} if moving else {})


def four_hinges(rng: Rng, near: float) -> Hinged:
    """A four-bar in space on four pins that lean by `near`, each its own way: what lies across the plane is open."""
    A, D = np.zeros(3), np.array([1.7, 0.0, 0.0])
    B, C = flat(0.6, rng.uniform(0.5, 2.5)), D + flat(1.1, rng.uniform(0.7, 2.4))
    leans, rate = rng.uniform(-1, 1, (4, 2)), float(rng.uniform(0.5, 2))
    moving = bool(rng.random() < 0.5)

    def made(near: float) -> dict[str, Any]:
        bodies = {
            "left": body(1.0, 0.5 * (A + B), 1.0, {"a": A, "b": B}),
            "coupler": body(2.0, 0.5 * (B + C), 1.0, {"b": B, "c": C}),
            "right": body(1.0, 0.5 * (C + D), 1.0, {"c": C, "d": D}),
        }
        if moving:
            bodies["left"]["angular_velocity"] = [0.0, 0.0, rate]
        ends = (("ground.A", "left.a"), ("left.b", "coupler.b"), ("coupler.c", "right.c"), ("ground.D", "right.d"))
        joints = {
            name: {"type": "pin", "from": a, "to": b, "axis": [near * float(x), near * float(y), 1.0]}
            for name, (a, b), (x, y) in zip("ABCD", ends, leans, strict=True)
        }
        return scene_of(bodies, joints, {"A": A, "D": D}, False, gravity=[0.0, -9.81, 0.0])

    return Hinged(made(near), made(0.0), {"left": rate} if moving else {})


HINGED: tuple[Callable[[Rng, float], Hinged], ...] = (door, four_hinges)


def hinged_scene(seed: int) -> tuple[str, float, Hinged]:
    """The family's name, how near, and the scene."""
    rng = np.random.default_rng([21, seed])
    family = HINGED[seed % len(HINGED)]
    near = float(10.0 ** rng.uniform(-12, -3))
    return family.__name__, near, family(rng, near)
