"""Random scenes that move in a plane, lying anywhere in space: as the oracle's dicts.

`kinematic`: every joint of the tree turns about the normal or shifts across it, so that nothing leaves the plane
whatever acts; points, masses and loads anywhere. `mirror`: joints that could leave it (balls, universals, free bodies),
but the scene is its own mirror image in the plane. Bodies' axes lie anyhow against the plane.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from tests.oracle.read import GROUND, Placed, model, placed, start_state
from tests.oracle.rows import assemble, coordinates, velocities
from tests.oracle.scenes import LOADS, Maker
from tests.oracle.solve import solve
from tests.oracle.transforms import combined, in_time_scaled, turned
from tests.oracle.turns import Array, about, cross, random_rotation
from tests.oracle.values import Harmonic

Z = np.array([0.0, 0.0, 1.0])
TREES = {
    "kinematic": ("pin", "pin", "slide", "weld"),
    "mirror": ("ball", "pin", "slide", "universal", "cylinder", "line", "plane", "weld", "free"),
}
PLANAR = ("ball", "pin", "slide", "line", "weld", "free")  # what a scene declared planar may have
CLOSURES = {
    "kinematic": ("pin", "ball", "line", "plane", "rod", "slide", "cylinder"), "mirror": ("ball", "line", "rod", "pin"),
}  # fmt: skip
AXES = tuple(np.roll(np.eye(3), k, axis=0) for k in range(3))
FLIP = np.diag([1.0, -1.0, -1.0])
FRAMES = (*AXES, FLIP, *(FLIP @ a for a in AXES))


@dataclass(frozen=True)
class Naming(Harmonic):
    """A value in time that a coordinate has a part in; the oracle does not know it."""

    text: str = ""

    @property
    def source(self) -> str:
        return f"({super().source})*({self.text})"


class FlatMaker(Maker):
    """Builds a flat scene in the plane z = 0, step by step."""

    def __init__(self, rng: np.random.Generator, mode: str, masses: str, frames: str) -> None:
        super().__init__(rng, masses)
        self.mode, self.frames = mode, frames
        self.own: dict[str, Array] = {GROUND: np.eye(3)}  # of each body: its axes -> those of the plane, turned
        if mode == "mirror":
            self.scene["gravity"][2] = 0.0

    @property
    def high(self) -> bool:
        return self.mode == "kinematic"

    def height(self) -> float:
        return float(self.rng.uniform(-1, 1)) if self.high else 0.0

    def flat(self, size: float = 1.0) -> Array:
        return np.array([*self.rng.uniform(-size, size, 2), self.height()])

    def spot(self, body: str) -> Array:
        return np.asarray(self.own[body].T @ self.flat())

    def body(self, name: str, kinds: Any, branching: float, roots: float, free: float) -> None:
        rng = self.rng
        self.own[name] = {"same": np.eye(3), "axes": FRAMES[rng.integers(len(FRAMES))],
                          "any": random_rotation(rng)}[self.frames]  # fmt: skip
        self.scene["bodies"][name] = {**self.mass_of(name), "points": {}}
        parent = self.names[-1] if self.names else GROUND
        if self.names and rng.random() < branching:
            parent = self.names[rng.integers(len(self.names))]
        if rng.random() < roots:
            parent = GROUND
        self.names.append(name)
        kind = str(rng.choice(list(kinds)))
        turn = about(Z, float(rng.uniform(-3, 3)))
        if kind == "free":
            self.place(name, Placed(self.flat(), turn @ self.own[name], np.zeros(3), np.zeros(3)))
            return
        a, b = (parent, name) if rng.random() < 0.7 else (name, parent)
        p, q = self.spot(a), self.spot(b)
        spec, offset, turn = self.kind(kind, a, b, turn)
        Fa, Fb = self.own[a], self.own[b]
        relative, offset = Fa.T @ turn @ Fb, Fa.T @ offset
        if b == name:
            A = placed(self.state, a)
            R = A.rotation @ relative
            self.place(name, Placed(A.point(p + offset) - R @ q, R, np.zeros(3), np.zeros(3)))
        else:
            B = placed(self.state, b)
            R = B.rotation @ relative.T
            self.place(name, Placed(B.point(q) - R @ (p + offset), R, np.zeros(3), np.zeros(3)))
        self.join(f"j_{name}", kind, spec, a, p, b, q)

    def direction(self) -> Array:
        angle = float(self.rng.uniform(-3, 3))
        return np.array([np.cos(angle), np.sin(angle), 0.0])

    def kind(self, kind: str, a: str, b: str, turn: Array) -> tuple[dict[str, Any], Array, Array]:
        """The keys of a joint, the offset of its `to` point and the turn of `to`, in axes of the plane."""
        rng, Fa, Fb = self.rng, self.own[a], self.own[b]
        sense = float(rng.choice([-1.0, 1.0])) * rng.uniform(0.5, 2)
        along, none = self.direction(), np.zeros(3)

        def both(d: Array, e: Array | None = None) -> dict[str, Any]:
            e = turn.T @ d if e is None else e
            return {"axis": (Fa.T @ d).tolist(), "to_axis": (Fb.T @ e).tolist()}

        travel = rng.uniform(-1, 1) * along
        if kind == "pin" and self.mode == "mirror" and self.frames != "same" and rng.random() < 0.2:
            return both(along), none, turn  # cannot turn without leaving the plane
        if kind == "pin":
            return both(sense * Z), none, turn
        if kind == "slide":
            return {"axis": (Fa.T @ along).tolist()}, travel, turn
        if kind == "universal":
            two = (Z, turn.T @ along) if rng.random() < 0.5 else (along, Z)
            return both(*two), none, turn
        if kind == "cylinder":
            return (both(sense * Z), none, turn) if rng.random() < 0.5 else (both(along), travel, turn)
        if kind == "line":
            return {"axis": (Fa.T @ along).tolist()}, travel, turn
        if kind == "plane":
            if rng.random() < 0.5:
                return {"normal": (Fa.T @ Z).tolist()}, 0.5 * travel + 0.5 * self.direction(), turn
            return {"normal": (Fa.T @ along).tolist()}, rng.uniform(-1, 1) * cross(Z, along), turn
        if kind == "rod":
            return {}, np.append(rng.uniform(-1, 1, 2), self.height()), turn
        return {}, none, turn  # ball, weld

    def closure(self, name: str, kinds: Any) -> None:
        rng = self.rng
        kind = str(rng.choice(list(kinds)))
        a, b = (str(x) for x in rng.permutation([*self.names, GROUND])[:2])
        A, B = placed(self.state, a), placed(self.state, b)
        turn = self.own[a] @ A.rotation.T @ B.rotation @ self.own[b].T
        p = self.spot(a)
        if kind in ("line", "plane") and self.high and rng.random() < 0.3:  # oblique ones hold in the plane, too
            d = self.own[a].T @ (self.direction() + rng.uniform(-1, 1) * Z)
            spec, offset = {"axis" if kind == "line" else "normal": d.tolist()}, np.zeros(3)
        else:
            spec, offset, _ = self.kind(kind, a, b, turn)
        q = B.rotation.T @ (A.point(p + self.own[a].T @ offset) - B.position)
        self.join(name, kind, spec, a, p, b, q)

    def mass_of(self, name: str) -> dict[str, Any]:
        rng, F = self.rng, self.own[name]
        a, b = self.flat(0.6), self.flat(0.6)
        if self.masses == "shapes":
            radius = float(rng.uniform(0.05, 0.2))
            box = about(Z, float(rng.uniform(-3, 3))) if self.mode == "mirror" else random_rotation(rng)
            ends = {"from": (F.T @ a).tolist(), "to": (F.T @ b).tolist()}
            several = [
                {"type": "cylinder", **ends, "radius": radius, "density": float(rng.uniform(5, 20))},
                {
                    "type": "box",
                    "center": (F.T @ a).tolist(),
                    "size": rng.uniform(0.1, 0.6, 3).tolist(),
                    "density": float(rng.uniform(5, 20)),
                    "orientation": {"matrix": (F.T @ box).tolist()},
                },
                {"type": "cone", **ends, "radius": radius, "to_radius": 0.3 * radius, "mass": 1.0},
                {"type": "rod", **ends, "mass": float(rng.uniform(0.5, 2))},
                {"type": "point", "at": (F.T @ b).tolist(), "mass": float(rng.uniform(0.1, 0.5))},
            ]
            return {"shapes": several[: rng.integers(1, 6)]}
        A = rng.standard_normal((8, 3)) * rng.uniform(0.1, 0.5, 3)
        T = A.T @ A / 8
        if self.mode == "mirror":
            T[2, :2] = T[:2, 2] = 0.0
        mass = float(rng.uniform(0.5, 3))
        inertia = F.T @ (mass * (np.trace(T) * np.eye(3) - T)) @ F
        return {"mass": mass, "center": (F.T @ a).tolist(), "inertia": ((inertia + inertia.T) / 2).tolist()}

    def set_moving(self) -> None:
        """Random velocities in the plane, less what the joints do not allow."""
        rng, scene = self.rng, model(self.scene)
        J = assemble(scene, self.state, 0.0).J
        moving = {
            n: s._replace(velocity=np.append(rng.standard_normal(2), 0.0), angular_velocity=rng.standard_normal() * Z)
            for n, s in self.state.items()
        }
        V = velocities(scene, moving)
        for _ in range(2):
            V = V - np.linalg.lstsq(J, J @ V, rcond=1e-10)[0] if len(J) else V
        for k, name in enumerate(scene.names):
            v, spin = V[6 * k : 6 * k + 3] * [1, 1, 0], V[6 * k + 3 : 6 * k + 6] * [0, 0, 1]
            v, spin = np.where(np.abs(v) < 1e-14, 0.0, v), np.where(np.abs(spin) < 1e-14, 0.0, spin)
            origin = v - cross(spin, self.state[name].rotation @ scene.masses[name].center)
            self.state[name] = self.state[name]._replace(velocity=origin, angular_velocity=spin)
            local = self.state[name].rotation.T @ spin
            self.scene["bodies"][name] |= {
                "velocity": origin.tolist(),
                "angular_velocity": spin.tolist() if k % 2 else {"vector": local.tolist(), "frame": "body"},
            }

    def load_force(self, in_time: bool) -> dict[str, Any]:
        on = self.some()
        body = self.rng.random() < 0.5
        vector: list[Any] = [self.value(3, in_time) for _ in range(3)]
        if not self.high:
            vector[2] = 0.0
        if body:
            vector = combined(self.own[on].T, vector) if self.frames == "any" else permuted(self.own[on], vector)
        return {"on": self.end("push", on, self.spot(on)), "vector": vector, "frame": "body" if body else "world"}

    def load_couple(self, in_time: bool) -> dict[str, Any]:
        given = self.load_force(in_time)
        vector: list[Any] = [0.0, 0.0, self.value(3, in_time)]
        if self.high:
            return given
        on = given["on"]["body"] if isinstance(given["on"], dict) else given["on"].split(".")[0]
        if given["frame"] == "body":
            vector = combined(self.own[on].T, vector) if self.frames == "any" else permuted(self.own[on], vector)
        return {**given, "vector": vector}

    def load_distributed(self, in_time: bool) -> dict[str, Any]:
        given = self.load_force(in_time)
        on = given["on"]["body"] if isinstance(given["on"], dict) else given["on"].split(".")[0]
        ends = {"from": self.spot(on).tolist(), "to": self.spot(on).tolist()}
        return {**given, "on": on, **ends, "to_vector": [in_time_scaled(x, -0.4, 1.0) for x in given["vector"]]}

    def on_joint(self, kinds: Any) -> str | None:
        """A pin in the plane is not loaded: it would leave it."""
        found = super().on_joint(kinds)
        if found is None or self.high or self.scene["joints"][found]["type"] != "pin":
            return found
        j = self.scene["joints"][found]
        a = j["from"]["body"] if isinstance(j["from"], dict) else j["from"].split(".")[0]
        return found if abs((self.own[a] @ np.array(j["axis"]))[2]) > 0.4 else None


def permuted(F: Array, vector: list[Any]) -> list[Any]:
    """F' v for signed permutations: no sums."""
    new: list[Any] = [0.0, 0.0, 0.0]
    for k in range(3):
        i = int(np.flatnonzero(F[k])[0])
        v = vector[k]
        new[i] = v.scaled(float(F[k, i])) if callable(v) else float(F[k, i] * v)
    return new


def flat_scene(
    seed: int, mode: str = "", plane: str = "", kinds: Sequence[str] = (), loads: Sequence[str] = LOADS
) -> dict[str, Any]:
    """A random flat scene; plane: world | axes | any, where it lies; kinds: of joints, where they are others."""
    rng = np.random.default_rng(seed)
    mode = mode or ("kinematic", "mirror")[seed % 2]
    plane = plane or str(rng.choice(["world", "axes", "any"]))
    for _ in range(100):
        frames = str(rng.choice(["same", "axes", "any"])) if not kinds else "same"
        maker = FlatMaker(rng, mode, str(rng.choice(["given", "shapes"])), frames)
        for k in range(int(rng.integers(1, 6))):
            maker.body(f"b{k}", kinds or TREES[mode], 0.3, 1.0 if k == 0 else 0.2, 0.0)
        for k in range(int(rng.integers(0, 3))):
            maker.closure(f"loop{k}", CLOSURES[mode])
        maker.set_moving()
        maker.drives(int(rng.integers(0, 2)))
        maker.loads(loads, True)
        if solve(maker.scene, start_state(maker.scene)).residual < 1e-9:
            return more(rng, maker, plane)
    raise RuntimeError("no scene found whose drives fit its loops")


def more(rng: np.random.Generator, maker: FlatMaker, plane: str) -> dict[str, Any]:
    """With sections and blows, turned to where its plane is to lie."""
    scene = maker.scene
    Q = {"world": np.eye(3), "axes": FRAMES[rng.integers(len(FRAMES))], "any": random_rotation(rng)}[plane]
    named(rng, maker)
    if plane != "world":
        scene = turned(scene, Q)
    shaped = [n for n, b in scene["bodies"].items() if "shapes" in b and b["shapes"][0]["type"] == "cylinder"]
    cuts = {}
    for k, n in enumerate(shaped[:2]):
        s = scene["bodies"][n]["shapes"][0]
        a, b = np.array(s["from"]), np.array(s["to"])
        cuts[f"s{k}"] = {"body": n, "at": (a + rng.uniform(0.2, 0.8) * (b - a)).tolist(), "normal": (b - a).tolist()}
    loaded = {str(f.get("on", "")).split(".")[0] for f in scene.get("forces", {}).values() if f["type"] == "couple"}
    if cuts and not loaded:
        scene = {**scene, "sections": cuts}
    if rng.random() < 0.4:
        scene = {**scene, "impulses": {"blow": blow(rng, maker, Q)}}
    if rng.random() < 0.3 and not scene.get("drives"):
        scene = stopped(rng, maker, scene)
    return scene


def blow(rng: np.random.Generator, maker: FlatMaker, Q: Array) -> dict[str, Any]:
    """An impulse at a point of the plane, or anywhere, later in the run."""
    on = maker.some()
    vector = np.append(rng.standard_normal(2), rng.standard_normal() if maker.high else 0.0)
    point = maker.spot(on)
    frame = Q if rng.random() < 0.5 else maker.own[on].T
    given = {"vector": (frame @ vector).tolist(), "frame": "world" if frame is Q else "body", "time": 0.15}
    if frame is not Q:
        given["vector"] = (Q @ frame @ vector).tolist()  # `turned` turns the bodies' axes, too
    return {"on": {"body": on, "at": (Q @ point).tolist()}, **given}


def stopped(rng: np.random.Generator, maker: FlatMaker, scene: dict[str, Any]) -> dict[str, Any]:
    """With a limit near the start of some joint's coordinate."""
    able = [j for j in model(maker.scene).joints if j.kind in ("pin", "slide")]
    if not able:
        return scene
    j = able[rng.integers(len(able))]
    quantity = "angle" if j.kind == "pin" else "travel"
    now = coordinates(j, maker.state)
    rate = now["rate"] if j.kind == "pin" else now["speed"]
    limits = [now[quantity] - 0.05, None] if rate < 0 else [None, now[quantity] + 0.05]
    stop = {"joint": j.name, quantity: limits, "restitution": float(rng.choice([0.0, 0.5]))}
    return {**scene, "stops": {"stop": stop}}


def named(rng: np.random.Generator, maker: FlatMaker) -> None:
    """Some values in time made to depend on a coordinate."""
    able = [n for n, j in maker.scene["joints"].items() if j["type"] in ("pin", "slide")]
    if not able or rng.random() < 0.5:
        return
    words = {"pin": ("angle", "rate"), "slide": ("travel", "speed")}
    for f in maker.scene.get("forces", {}).values():
        key = next((k for k in ("value",) if callable(f.get(k))), None)
        n = able[rng.integers(len(able))]
        text = f"cos({n}.{words[maker.scene['joints'][n]['type']][rng.integers(2)]})"
        if key:
            f[key] = naming(f[key], text)


def naming(h: Harmonic, text: str) -> Naming:
    return Naming(h.offset, h.slope, h.amplitude, h.omega, h.phase, text)
