"""Random scenes that satisfy all joints exactly: trees of any joints, several trees, free bodies, loops, drives, loads.

Bodies are placed outward along the tree from random joint coordinates; loops are closed by extra joints whose points
and axes on `to` are read off the finished poses; velocities are random ones projected onto the null space of the rows.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import Any

import numpy as np

from heuncli.base.joint_kinds import kinds_accepting_load
from heuncli.base.load_kinds import LOAD_KINDS
from tests.oracle.read import GROUND, Placed, model, placed, start_state
from tests.oracle.rows import assemble, coordinates, gaps, rates, velocities
from tests.oracle.solve import solve
from tests.oracle.turns import Array, about, across, cross, random_rotation, random_unit, unit
from tests.oracle.values import Harmonic

ALL_KINDS = ("ball", "pin", "slide", "cylinder", "universal", "weld", "line", "plane", "rod")
LOADS = ("force", "couple", "spring", "actuator", "torque", "damper", "friction")  # each has a law in loads.py
SPREAD = ("force", "distributed", "turn_spring", "spring")
ELASTIC = ("force", "bushing", "spring")
DRIVEN = {"pin": "angle", "slide": "travel", "cylinder": "travel", "rod": "length"}


def random_scene(
    rng: np.random.Generator,
    n_bodies: int,
    kinds: Sequence[str] = ALL_KINDS,
    branching: float = 0.3,
    roots: float = 0.1,
    free: float = 0.0,
    loops: int = 0,
    loop_kinds: Sequence[str] = ("ball", "line", "plane", "rod"),
    drives: int = 0,
    loads: Sequence[str] = LOADS,
    masses: str = "given",
    in_time: bool = True,
) -> tuple[dict[str, Any], dict[str, Placed]]:
    """A scene and its state (the same as the scene's own held values).

    branching: chance that a body hangs on a random earlier one instead of the last; roots: on the ground; free: on
    nothing. masses: "given", "shapes", or "thin" (rods with all their joints and forces on the axis; meant for balls).
    in_time: whether loads vary with t. Scenes whose drives no motion can follow are thrown away.
    """
    for _ in range(100):
        maker = Maker(rng, masses)
        for k in range(n_bodies):
            maker.body(f"b{k}", kinds, branching, 1.0 if k == 0 else roots, free)
        for k in range(loops):
            maker.closure(f"loop{k}", loop_kinds)
        maker.set_moving()
        maker.drives(drives)
        maker.loads(loads, in_time)
        state = start_state(maker.scene)
        if solve(maker.scene, state).residual < 1e-9:
            return maker.scene, state
    raise RuntimeError("no scene found whose drives fit its loops")


class Maker:
    """Builds one scene step by step; keeps where each body is."""

    def __init__(self, rng: np.random.Generator, masses: str) -> None:
        self.rng, self.masses = rng, masses
        self.names: list[str] = []
        self.state: dict[str, Placed] = {}
        self.scene: dict[str, Any] = {
            "title": "random",
            "gravity": (rng.standard_normal(3) * 5).tolist(),
            "ground": {"points": {"O": [0.0, 0.0, 0.0]}},
            "bodies": {},
            "joints": {},
        }

    def body(self, name: str, kinds: Sequence[str], branching: float, roots: float, free: float) -> None:
        """A new body on a joint to an earlier one or the ground, or free."""
        rng = self.rng
        self.scene["bodies"][name] = {**self.mass(), "points": {}}
        parent = self.names[-1] if self.names else GROUND
        if self.names and rng.random() < branching:
            parent = self.names[rng.integers(len(self.names))]
        if rng.random() < roots:
            parent = GROUND
        self.names.append(name)
        at_rest = np.zeros(3)
        if rng.random() < free:
            self.place(name, Placed(rng.standard_normal(3), random_rotation(rng), at_rest, at_rest))
            return
        kind = str(rng.choice(list(kinds)))
        p, q = self.spot(parent), self.spot(name)
        spec, offset, relative = PLACE[kind](rng)
        A = placed(self.state, parent)
        if rng.random() < 0.7:
            R = A.rotation @ relative
            self.place(name, Placed(A.point(p) + A.rotation @ offset - R @ q, R, at_rest, at_rest))
            self.join(f"j_{name}", kind, spec, parent, p, name, q)
        else:  # the new body is `from`
            R = A.rotation @ relative.T
            self.place(name, Placed(A.point(p) - R @ (q + offset), R, at_rest, at_rest))
            self.join(f"j_{name}", kind, spec, name, q, parent, p)

    def place(self, name: str, where: Placed) -> None:
        self.state[name] = where
        pose = {"position": where.position.tolist(), "orientation": {"matrix": where.rotation.tolist()}}
        self.scene["bodies"][name] |= pose

    def join(self, name: str, kind: str, spec: dict[str, Any], a: str, p: Array, b: str, q: Array) -> None:
        """Enter a joint."""
        self.scene["joints"][name] = {"type": kind, "from": self.end(name, a, p), "to": self.end(name, b, q), **spec}

    def end(self, name: str, body: str, point: Array) -> str | dict[str, Any]:
        """A named point, or one in place."""
        if self.rng.random() < 0.3:
            return {"body": body, "at": point.tolist()}
        owner = self.scene["ground"] if body == GROUND else self.scene["bodies"][body]
        own = f"{name}_{len(owner['points'])}"
        owner["points"][own] = point.tolist()
        return f"{body}.{own}"

    def spot(self, body: str) -> Array:
        """Some point of a body; of a thin one on its axis."""
        if self.masses == "thin" and body != GROUND:
            rod = self.scene["bodies"][body]["shapes"][0]
            a, b = np.array(rod["from"]), np.array(rod["to"])
            return a + self.rng.uniform(-0.2, 1.2) * (b - a)
        return self.rng.uniform(-1, 1, 3)

    def mass(self) -> dict[str, Any]:
        """Mass properties of a body, one of the forms of a spec."""
        rng = self.rng
        a, b = rng.uniform(-0.6, 0.6, (2, 3)).tolist()
        if self.masses == "thin":
            return {"shapes": [{"type": "rod", "from": a, "to": b, "mass": float(rng.uniform(0.5, 2))}]}
        if self.masses == "shapes":
            radius = float(rng.uniform(0.05, 0.2))
            several = [
                {"type": "rod", "from": a, "to": b, "line_density": float(rng.uniform(0.5, 2))},
                {
                    "type": "cylinder",
                    "from": a,
                    "to": b,
                    "radius": radius,
                    "inner_radius": 0.4 * radius,
                    "density": float(rng.uniform(5, 20)),
                },
                {
                    "type": "cone",
                    "from": a,
                    "to": b,
                    "radius": radius,
                    "to_radius": 0.3 * radius,
                    "mass": float(rng.uniform(0.5, 2)),
                },
                {
                    "type": "box",
                    "center": a,
                    "size": rng.uniform(0.1, 0.6, 3).tolist(),
                    "density": float(rng.uniform(5, 20)),
                    "orientation": {"matrix": random_rotation(rng).tolist()},
                },
                {"type": "sphere", "center": b, "radius": radius, "mass": float(rng.uniform(0.5, 2))},
                {"type": "point", "at": b, "mass": float(rng.uniform(0.1, 0.5))},
            ]
            chosen = rng.permutation(6)[: rng.integers(1, 4)]
            solid = [several[k] for k in chosen]
            if all(s["type"] in ("rod", "point") for s in solid):
                solid.append(several[3])
            return {"shapes": solid}
        A = rng.standard_normal((8, 3)) * rng.uniform(0.1, 0.5, 3)
        T = A.T @ A / 8
        mass = float(rng.uniform(0.5, 3))
        inertia = mass * (np.trace(T) * np.eye(3) - T)
        return {"mass": mass, "center": a, "inertia": ((inertia + inertia.T) / 2).tolist()}

    def closure(self, name: str, kinds: Sequence[str]) -> None:
        """A joint between two bodies as they stand: its `to` point, axis or length follow from the poses."""
        rng = self.rng
        kind = str(rng.choice(list(kinds)))
        a, b = (str(x) for x in rng.permutation([*self.names, GROUND])[:2])
        A, B = placed(self.state, a), placed(self.state, b)
        p = self.spot(a)
        spec, offset, relative = PLACE[kind](rng)
        place = A.point(p) + A.rotation @ offset
        q = B.rotation.T @ (place - B.position)
        if kind in ("pin", "cylinder"):
            spec["to_axis"] = (B.rotation.T @ A.rotation @ unit(spec["axis"])).tolist()
        elif kind == "universal":
            spec["to_axis"] = (B.rotation.T @ A.rotation @ relative @ np.array(spec["to_axis"])).tolist()
        elif kind == "cv":
            spec["to_axis"] = (B.rotation.T @ A.rotation @ relative @ spec.get("to_axis", spec["axis"])).tolist()
        self.join(name, kind, spec, a, p, b, q)

    def set_moving(self) -> None:
        """Random velocities, less what the joints do not allow."""
        rng, scene = self.rng, model(self.scene)
        J = assemble(scene, self.state, 0.0).J
        moving = {
            n: s._replace(velocity=rng.standard_normal(3), angular_velocity=rng.standard_normal(3))
            for n, s in self.state.items()
        }
        V = velocities(scene, moving)
        for _ in range(2):  # the second pass takes away the rounding of the first
            V = V - np.linalg.lstsq(J, J @ V, rcond=1e-10)[0] if len(J) else V
        for k, name in enumerate(scene.names):
            v, spin = V[6 * k : 6 * k + 3], V[6 * k + 3 : 6 * k + 6]
            origin = v - cross(spin, self.state[name].rotation @ scene.masses[name].center)
            self.state[name] = self.state[name]._replace(velocity=origin, angular_velocity=spin)
            body = self.scene["bodies"][name]
            body["velocity"] = origin.tolist()
            local = self.state[name].rotation.T @ spin
            body["angular_velocity"] = spin.tolist() if k % 2 else {"vector": local.tolist(), "frame": "body"}

    def drives(self, count: int) -> None:
        """Prescribe some coordinates, starting where and as they are."""
        read = model(self.scene)
        able = [j for j in read.joints if j.kind in DRIVEN]
        chosen = [able[k] for k in self.rng.permutation(len(able))[:count]]
        if chosen:
            self.scene["drives"] = {}
        for j in chosen:
            quantity = DRIVEN[j.kind]
            now = coordinates(j, self.state)
            rate = now["rate"] if quantity == "angle" else now["speed"]
            value = Harmonic.starting(self.rng, now[quantity], rate)
            self.scene["drives"][f"d_{j.name}"] = {"joint": j.name, quantity: value.drive()}

    def loads(self, kinds: Sequence[str], in_time: bool) -> None:
        """One load of each kind that the scene can take."""
        forces: dict[str, Any] = {}
        for kind in kinds:
            spec = self.load_from_row(kind) if LOAD_KINDS[kind].sample else getattr(self, f"load_{kind}")(in_time)
            if spec is not None:
                forces[f"f_{kind}"] = {"type": kind, **spec}
        if forces:
            self.scene["forces"] = forces

    def value(self, size: float, in_time: bool) -> float | Harmonic:
        return Harmonic.random(self.rng, size) if in_time else float(size * self.rng.standard_normal())

    def some(self) -> str:
        return self.names[self.rng.integers(len(self.names))]

    def load_force(self, in_time: bool) -> dict[str, Any]:
        on = self.some()
        frame = "body" if self.rng.random() < 0.5 else "world"
        vector = [self.value(3, in_time) for _ in range(3)]
        return {"on": self.end("push", on, self.spot(on)), "vector": vector, "frame": frame}

    def load_couple(self, in_time: bool) -> dict[str, Any] | None:
        if self.masses == "thin":
            return None
        return self.load_force(in_time)

    def load_from_row(self, kind: str) -> dict[str, Any] | None:
        """A load that is numbers alone, between two points or in a joint that takes it."""
        if LOAD_KINDS[kind].is_in_joint:
            joint = self.on_joint([own.name for own in kinds_accepting_load(kind)])
            ends: dict[str, Any] | None = None if joint is None else {"joint": joint}
        else:
            a, b = self.pair()
            ends = {"from": a, "to": b}
        if ends is None:
            return None
        return ends | {key: float(self.rng.uniform(*most)) for key, most in LOAD_KINDS[kind].sample.items()}

    def load_actuator(self, in_time: bool) -> dict[str, Any]:
        a, b = self.pair()
        return {"from": a, "to": b, "value": self.value(3, in_time)}

    def pair(self) -> tuple[str | dict[str, Any], str | dict[str, Any]]:
        a, b = (str(x) for x in self.rng.permutation([*self.names, GROUND])[:2])
        return self.end("pair", a, self.spot(a)), self.end("pair", b, self.spot(b))

    def on_joint(self, kinds: Sequence[str]) -> str | None:
        driven = {d["joint"] for d in self.scene.get("drives", {}).values()}
        able = [n for n, j in self.scene["joints"].items() if j["type"] in kinds and n not in driven]
        return able[self.rng.integers(len(able))] if able else None

    def load_torque(self, in_time: bool) -> dict[str, Any] | None:
        joint = self.on_joint(("pin", "slide"))
        return None if joint is None else {"joint": joint, "value": self.value(2, in_time)}

    def load_damper(self, in_time: bool) -> dict[str, Any] | None:
        able = ("pin", "slide", "cylinder", "line", "plane", "ball", "universal")
        joint = self.on_joint(able[:5] if self.masses == "thin" else able)  # a ball's would twist the thin rod
        if joint is None:
            return None
        spec = {"joint": joint, "coefficient": float(self.rng.uniform(0.1, 1))}
        if self.scene["joints"][joint]["type"] == "cylinder":
            spec["sliding"] = float(self.rng.uniform(0.1, 1))
        return spec

    def load_distributed(self, in_time: bool) -> dict[str, Any]:
        """Linear or uniform along a line of a body; of a thin one along its axis."""
        on = self.some()
        spec = {
            "on": on,
            "from": self.spot(on).tolist(),
            "to": self.spot(on).tolist(),
            "frame": "world",
            "vector": [self.value(4, in_time) for _ in range(3)],
        }
        if self.rng.random() < 0.7:
            spec["to_vector"] = [self.value(4, in_time) for _ in range(3)]
        return spec | ({"frame": "body"} if self.rng.random() < 0.5 else {})

    def load_bushing(self, in_time: bool) -> dict[str, Any]:
        a, b = self.pair()
        spec: dict[str, Any] = {"from": a, "to": b, "orientation": {"matrix": random_rotation(self.rng).tolist()}}
        for key, most in (("stiffness", 10), ("turning", 5), ("damping", 1), ("turning_damping", 1)):
            spec[key] = self.rng.uniform(0, most, 3).tolist()
        for key in ("preload", "turning_preload"):
            spec[key] = self.rng.uniform(-2, 2, 3).tolist()
        if self.rng.random() < 0.5:
            spec["to_orientation"] = {"matrix": random_rotation(self.rng).tolist()}
        return spec

    def load_friction(self, in_time: bool) -> dict[str, Any] | None:
        joint = self.on_joint(("pin", "slide"))
        if joint is None:
            return None
        quantity = "torque" if self.scene["joints"][joint]["type"] == "pin" else "force"
        return {"joint": joint, quantity: float(self.rng.uniform(0.2, 2)), "speed": float(self.rng.uniform(0.3, 1))}


Placing = tuple[dict[str, Any], Array, Array]  # the joint's keys; offset of the `to` point, attitude of `to`, in `from`


def some_axis(rng: np.random.Generator) -> tuple[list[float], Array]:
    """An axis as given (any length) and at unit length."""
    given = random_unit(rng) * rng.uniform(0.5, 2)
    return given.tolist(), unit(given)


def turning(rng: np.random.Generator) -> Placing:
    """About an axis with the same components in both bodies, or with others in `to`."""
    given, axis = some_axis(rng)
    turn = about(axis, float(rng.uniform(-3, 3)))
    if rng.random() < 0.5:
        return {"axis": given}, np.zeros(3), turn
    R = turn @ random_rotation(rng)
    return {"axis": given, "to_axis": (R.T @ axis).tolist()}, np.zeros(3), R


def place_cylinder(rng: np.random.Generator) -> Placing:
    spec, _, R = turning(rng)
    return spec, rng.uniform(-1, 1) * unit(spec["axis"]), R


def place_slide(rng: np.random.Generator) -> Placing:
    given, axis = some_axis(rng)
    return {"axis": given}, rng.uniform(-1, 1) * axis, random_rotation(rng)


def place_universal(rng: np.random.Generator) -> Placing:
    given, axis = some_axis(rng)
    R = random_rotation(rng)
    e, f = across(axis)
    angle = rng.uniform(0, 6)
    return {"axis": given, "to_axis": (R.T @ (np.cos(angle) * e + np.sin(angle) * f)).tolist()}, np.zeros(3), R


def place_cv(rng: np.random.Generator) -> Placing:
    """Bent less than a right angle, and turned anyhow about the shaft."""
    given, axis = some_axis(rng)
    bend = about(unit(cross(axis, random_unit(rng))), float(rng.uniform(0.0, 1.3)))
    if rng.random() < 0.5:
        return {"axis": given}, np.zeros(3), bend @ about(axis, float(rng.uniform(-3, 3)))
    R = random_rotation(rng)
    return {"axis": given, "to_axis": (R.T @ bend @ axis).tolist()}, np.zeros(3), R


def place_plane(rng: np.random.Generator) -> Placing:
    given, normal = some_axis(rng)
    e, f = across(normal)
    return {"normal": given}, rng.uniform(-1, 1) * e + rng.uniform(-1, 1) * f, random_rotation(rng)


def place_rod(rng: np.random.Generator) -> Placing:
    length = float(rng.uniform(0.3, 1.5))
    return {"length": length} if rng.random() < 0.5 else {}, length * random_unit(rng), random_rotation(rng)


PLACE: dict[str, Callable[[np.random.Generator], Placing]] = {
    "ball": lambda rng: ({}, np.zeros(3), random_rotation(rng)),
    "weld": lambda rng: ({}, np.zeros(3), random_rotation(rng)),
    "pin": turning,
    "cylinder": place_cylinder,
    "slide": place_slide,
    "line": place_slide,
    "universal": place_universal,
    "cv": place_cv,
    "plane": place_plane,
    "rod": place_rod,
}


def misfit(scene: dict[str, Any], state: dict[str, Placed]) -> float:
    """Largest gap or rate of opening of any joint."""
    found = [*gaps(scene, state).values(), *rates(scene, state).values()]
    return max((float(np.abs(x).max()) for x in found if len(x)), default=0.0)
