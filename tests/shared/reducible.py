"""Random scenes of which less than the whole can move them: welded clusters, structures that carry machines, round
bodies that may spin, driven machines; as the oracle's dicts."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import Any

import numpy as np

from tests.oracle.blows import with_blows
from tests.oracle.read import GROUND, Placed, model, placed, start_state
from tests.oracle.rows import coordinates
from tests.oracle.scenes import ALL_KINDS, DRIVEN, LOADS, Maker, random_scene
from tests.oracle.solve import solve
from tests.oracle.transforms import turned
from tests.oracle.turns import random_rotation
from tests.oracle.values import Harmonic
from tests.shared.moving_in_a_plane import FlatMaker

Scene = dict[str, Any]
WELDS = ("weld", "weld", "weld", "pin", "ball", "slide", "universal")


def welded(seed: int, loads: Sequence[str] = LOADS) -> Scene:
    """Bodies most of which are welded to each other or the ground, in loops, too."""
    rng = np.random.default_rng(seed)
    scene, _ = random_scene(
        rng, int(rng.integers(2, 7)), kinds=WELDS, roots=0.15, loops=int(rng.integers(0, 3)),
        loop_kinds=("weld", "ball", "plane", "rod"), drives=seed % 2, masses=str(rng.choice(["given", "shapes"])),
        loads=loads,
    )  # fmt: skip
    return struck(scene, seed)


def struck(scene: Scene, seed: int, **more: Any) -> Scene:
    """With blows in some."""
    return with_blows(scene, seed, 0.15, count=2, **more) if seed % 3 == 0 else scene


class RoundMaker(Maker):
    """Cylinders, thin to thick, or spheres, joined and loaded on their axes."""

    def __init__(self, rng: np.random.Generator) -> None:
        super().__init__(rng, "thin")

    def mass(self) -> dict[str, Any]:
        rng = self.rng
        a, b = rng.uniform(-0.6, 0.6, (2, 3)).tolist()
        radius = float(10 ** rng.uniform(-4, -0.5))
        rod = {"type": "cylinder", "from": a, "to": b, "radius": radius, "mass": float(rng.uniform(0.5, 2))}
        ball = {"type": "sphere", "center": b, "radius": 0.1, "mass": 0.3}
        return {"shapes": [rod, ball] if rng.random() < 0.3 else [rod]}


def round_scene(seed: int) -> Scene:
    """Round bodies on balls and the like, and others among them."""
    rng = np.random.default_rng(seed)
    for _ in range(100):
        maker = RoundMaker(rng)
        kinds = ("ball", "ball", "ball", "pin", "universal", "line", "plane") if seed % 2 else ("ball",)
        for k in range(int(rng.integers(1, 5))):
            maker.body(f"b{k}", kinds, 0.3, 1.0 if k == 0 else 0.2, 0.1)
        for k in range(int(rng.integers(0, 2))):
            maker.closure(f"loop{k}", ("ball", "rod", "plane"))
        maker.set_moving()
        maker.loads(("force", "spring", "actuator", "damper"), True)
        if solve(maker.scene, start_state(maker.scene)).residual < 1e-9:
            break
    scene = maker.scene
    if seed % 5 == 4:  # a couple, which may turn them about their axes
        scene = {
            **scene,
            "forces": {
                **scene["forces"],
                "c": {"type": "couple", "on": maker.some(), "vector": rng.standard_normal(3).tolist(), "frame": "body"},
            },
        }
    return struck(scene, seed, couples=seed % 2 == 0, thin=seed % 6 == 0)


def carried(seed: int, loads: Sequence[str] = LOADS) -> Scene:
    """A plate on six bars, or two bars to a point, that carry a machine."""
    rng = np.random.default_rng(seed)
    for _ in range(100):
        maker = Maker(rng, str(rng.choice(["given", "shapes"])))
        maker.names.append("plate")
        maker.scene["bodies"]["plate"] = {**maker.mass(), "points": {}}
        maker.place("plate", Placed(rng.standard_normal(3), random_rotation(rng), np.zeros(3), np.zeros(3)))
        for k in range(6 + seed % 2):
            a, b = GROUND, "plate"
            joint(maker, f"bar{k}", "rod", a, rng.uniform(-2, 2, 3), b, maker.spot(b), {})
        for k in range(int(rng.integers(1, 4))):
            maker.body(f"b{k}", ALL_KINDS[:-1], 0.5, 0.1, 0.0)
        for k in range(int(rng.integers(0, 2))):
            maker.closure(f"loop{k}", ("ball", "rod", "plane"))
        maker.set_moving()
        maker.drives(seed // 2 % 2)
        if any(maker.scene["joints"][d["joint"]]["type"] == "rod" for d in maker.scene.get("drives", {}).values()):
            continue
        maker.loads(loads, True)
        if solve(maker.scene, start_state(maker.scene)).residual < 1e-9:
            return struck(maker.scene, seed)
    raise RuntimeError("no scene found")


def joint(maker: Maker, name: str, kind: str, a: str, p: Any, b: str, q: Any, spec: dict[str, Any]) -> None:
    maker.join(name, kind, spec, a, np.asarray(p, dtype=float), b, np.asarray(q, dtype=float))


def driven(seed: int, loads: Sequence[str] = LOADS) -> Scene:
    """Every freedom is driven: chains of pins and slides in space, or in a plane with pairs of bars between them."""
    rng = np.random.default_rng(seed)
    for _ in range(200):
        flat = seed % 2 == 1
        maker = FlatMaker(rng, "kinematic", "given", str(rng.choice(["same", "any"]))) if flat else Maker(rng, "given")
        for k in range(int(rng.integers(1, 4))):
            kinds = ("pin", "slide") if flat else ("pin", "slide", "weld")
            maker.body(f"b{k}", kinds, 0.3, 1.0 if k == 0 else 0.2, 0.0)
        able = [n for n, j in maker.scene["joints"].items() if j["type"] != "weld"]
        for k in range(int(rng.integers(1, 3)) if flat else 0):
            pair(maker, k)
        maker.set_moving()
        drive_all(maker, able)
        maker.loads(loads, True)
        if able and solve(maker.scene, start_state(maker.scene)).residual < 1e-9:
            scene = maker.scene
            return struck(turned(scene, random_rotation(rng)) if seed % 4 == 3 else scene, seed)
    raise RuntimeError("no scene found")


def pair(maker: Maker, k: int) -> None:
    """Two bodies pinned to each other, and each to one of those that are there."""
    others = [*maker.names, GROUND]
    maker.body(f"u{k}", ("pin",), 1.0, 0.2, 0.0)
    first = maker.scene["joints"][f"j_u{k}"]
    maker.names, rest = [f"u{k}"], maker.names
    maker.body(f"v{k}", ("pin",), 0.0, 0.0, 0.0)
    root = {e["body"] if isinstance(e, dict) else e.split(".")[0] for e in (first["from"], first["to"])}
    left = [o for o in others if o not in root] or others
    maker.names = [f"v{k}"]
    a, b = f"v{k}", str(maker.rng.choice(left))
    A, B = placed(maker.state, a), placed(maker.state, b)
    p = maker.spot(a)
    q = B.rotation.T @ (A.point(p) - B.position)
    z = A.rotation.T @ np.array([0.0, 0.0, 1.0])
    spec = {"axis": z.tolist(), "to_axis": (B.rotation.T @ A.rotation @ z).tolist()}
    joint(maker, f"close{k}", "pin", a, p, b, q, spec)
    maker.names = [*rest, f"v{k}"]


def drive_all(maker: Maker, able: list[str]) -> None:
    """Prescribe these coordinates, starting where and as they are."""
    read = {j.name: j for j in model(maker.scene).joints}
    maker.scene["drives"] = {}
    for name in able:
        j = read[name]
        quantity = DRIVEN[j.kind]
        now = coordinates(j, maker.state)
        value = Harmonic.starting(maker.rng, now[quantity], now["rate"] if quantity == "angle" else now["speed"])
        maker.scene["drives"][f"d_{name}"] = {"joint": name, quantity: value.drive()}


FAMILIES: dict[str, Callable[[int], Scene]] = {
    "welded": welded, "round": round_scene, "carried": carried, "driven": driven,
}  # fmt: skip
