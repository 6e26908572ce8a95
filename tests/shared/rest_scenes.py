"""Random scenes with a rest pose, each written twice: as a spec, and as a tree with equations of its own."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass, field
from typing import Any

import numpy as np

from tests.shared.rest_trees import GROUND, Body, Equations, Point, Tree, Vector, of_quaternion

G = 9.81
AXIS_Y = np.array([0.0, 1.0, 0.0])


@dataclass
class Scene:
    """spec: for heun; tree: for the equations, in the frame R."""

    kind: str
    seed: int
    spec: dict[str, Any]
    tree: Tree
    R: Vector


@dataclass
class Draft:
    """A scene under way. flat: in the xz plane; base: what it stands on, turned by R; pushed: along this axis alone."""

    rng: np.random.Generator
    flat: bool
    base: str = "ground"
    R: Vector = field(default_factory=lambda: np.eye(3))
    pushed: Vector | None = None
    tree: Tree = field(default_factory=Tree)
    bodies: dict[str, Any] = field(default_factory=dict)
    joints: dict[str, Any] = field(default_factory=dict)
    forces: dict[str, Any] = field(default_factory=dict)
    stops: dict[str, Any] = field(default_factory=dict)
    drives: dict[str, Any] = field(default_factory=dict)
    points: dict[str, Any] = field(default_factory=dict)
    ropes: dict[str, Any] = field(default_factory=dict)

    # ---- numbers -------------------------------------------------------------------------------------------------
    def uniform(self, a: float, b: float) -> float:
        return float(self.rng.uniform(a, b))

    def logarithmic(self, a: float, b: float) -> float:
        return float(math.exp(self.rng.uniform(math.log(a), math.log(b))))

    def vector(self, size: float) -> Vector:
        v = self.rng.uniform(-size, size, 3)
        return v * np.array([1.0, 0.0, 1.0]) if self.flat else v

    def direction(self) -> Vector:
        v = self.rng.normal(size=3)
        v = v * np.array([1.0, 0.0, 1.0]) if self.flat else v
        return np.asarray(v / np.linalg.norm(v))

    def chance(self, p: float) -> bool:
        return bool(self.rng.random() < p)

    def name(self, point: Point) -> str:
        """A point as an end of the spec; new ones get their name."""
        if point.body == GROUND:
            points, owner = self.points, self.base
        else:
            owner = self.tree.bodies[point.body].name
            points = self.bodies[owner]["points"]
            self.tree.bodies[point.body].points[f"p{len(points)}"] = point.place
        key = f"p{len(points)}"
        points[key] = point.place.tolist()
        return f"{owner}.{key}"

    # ---- bodies --------------------------------------------------------------------------------------------------
    def inertia(self, mass: float, length: float) -> Vector:
        a = mass * length**2 * self.rng.uniform(0.02, 0.1, 3)
        return np.array([a[1] + a[2], a[2] + a[0], a[0] + a[1]])

    def body(self, parent: int, joint: str, at: Vector, axes: list[Vector], start: list[float]) -> int:
        """A body more, with its joint."""
        k = len(self.tree.bodies)
        length = self.uniform(0.3, 1.2)
        end = length * self.direction()
        mass = self.logarithmic(0.3, 5.0)
        center = end * self.uniform(0.2, 0.8) + 0.1 * self.vector(length)
        inertia = self.inertia(mass, length)
        to = np.zeros(3)
        one = Body(f"b{k}", parent, joint, at, to, axes, start, mass, center, np.diag(inertia), {"end": end})
        self.tree.bodies.append(one)
        entry: dict[str, Any] = {"mass": mass, "center": center.tolist(), "inertia": inertia.tolist()}
        entry["points"] = {"o": [0.0, 0.0, 0.0], "end": end.tolist()}
        self.bodies[one.name] = entry
        if joint == "free":
            entry["position"], entry["orientation"] = list(start[:3]), {"quaternion": list(start[3:])}
            return k
        owner = self.base if parent == GROUND else self.tree.bodies[parent].name
        points = self.points if parent == GROUND else self.bodies[owner]["points"]
        key = f"a{k}"
        points[key] = at.tolist()
        row: dict[str, Any] = {"type": joint, "from": f"{owner}.{key}", "to": f"{one.name}.o"}
        if joint != "ball":
            row["axis"] = axes[0].tolist()
        if joint == "universal":
            row["to_axis"] = axes[1].tolist()
        if joint in ("pin", "slide"):
            row["initial"] = {"angle" if joint == "pin" else "travel": start[0]}
        else:
            R = Equations(self.tree).placed(np.array([x for b in self.tree.bodies for x in b.start]))[0][k]
            entry["orientation"] = {"matrix": (self.R @ R).tolist()}
        self.joints[f"j{k}"] = row
        return k

    def pin(self, parent: int, at: Vector) -> int:
        axis = AXIS_Y if self.flat else self.direction()
        return self.body(parent, "pin", at, [axis], [self.uniform(-math.pi, math.pi)])

    def slide(self, parent: int, at: Vector) -> int:
        return self.body(parent, "slide", at, [self.direction()], [self.uniform(-0.4, 0.4)])

    def ball(self, parent: int, at: Vector) -> int:
        q = self.rng.normal(size=4)
        return self.body(parent, "ball", at, [], (q / np.linalg.norm(q)).tolist())

    def universal(self, parent: int, at: Vector) -> int:
        a, b = self.direction(), self.direction()
        b = b - (a @ b) * a
        return self.body(
            parent, "universal", at, [a, b / np.linalg.norm(b)], [self.uniform(-1, 1), self.uniform(-1, 1)]
        )

    def free(self) -> int:
        q = self.rng.normal(size=4) if not self.flat else np.array([self.rng.normal(), 0.0, self.rng.normal(), 0.0])
        return self.body(
            GROUND, "free", np.zeros(3), [], [*self.vector(1.0).tolist(), *(q / np.linalg.norm(q)).tolist()]
        )

    def point(self, body: int) -> Point:
        """Some point of a body."""
        one = self.tree.bodies[body]
        return Point(body, one.points["end"] if self.chance(0.6) else one.points["end"] * self.uniform(0.3, 1.2))

    def ground(self, size: float = 1.5) -> Point:
        return Point(GROUND, self.vector(size))

    def place(self, point: Point) -> Vector:
        """Where a point is at the start."""
        if point.body == GROUND:
            return point.place
        eq = Equations(self.tree)
        R, r, *_ = eq.placed(eq.y0)
        return np.asarray(r[point.body] + R[point.body] @ point.place)

    # ---- loads ---------------------------------------------------------------------------------------------------
    def spring(self, a: Point, b: Point, k: float, length: float) -> None:
        self.tree.springs.append((a, b, k, length))
        row = {"type": "spring", "from": self.name(a), "to": self.name(b), "stiffness": k, "length": length}
        self.forces[f"f{len(self.forces)}"] = row

    def some_spring(self, body: int) -> None:
        a, b = self.ground(), self.point(body)
        if body > 0 and self.chance(0.25):
            a = self.point(int(self.rng.integers(body)))
        far = float(np.linalg.norm(self.place(a) - self.place(b)))
        self.spring(a, b, self.logarithmic(5.0, 300.0), 0.0 if self.chance(0.15) else far * self.uniform(0.2, 1.3))

    def push(self, point: Point, vector: Vector, follows: bool) -> None:
        if self.pushed is not None and not follows:
            vector = (vector @ self.pushed) * self.pushed
        self.tree.pushes.append((point, vector if follows else self.R.T @ vector, follows))
        row = {"type": "force", "on": self.name(point), "vector": vector.tolist()}
        self.forces[f"f{len(self.forces)}"] = row | ({"frame": "body"} if follows else {})

    def couple(self, body: int, vector: Vector, follows: bool) -> None:
        self.tree.couples.append((body, vector, follows))
        row = {"type": "couple", "on": self.tree.bodies[body].name, "vector": vector.tolist()}
        self.forces[f"f{len(self.forces)}"] = row | ({"frame": "body"} if follows else {})

    def torque(self, body: int, a: float = 0.0, b: float = 0.0, c: float = 0.0, d: float = 0.0, n: int = 1) -> None:
        """a + b x + c x^3 + d sin(n x + 0.4), x the coordinate."""
        self.tree.torques.append((body, a, b, c, d, float(n), 0.4))
        x = f"j{body}.{'angle' if self.tree.bodies[body].joint == 'pin' else 'travel'}"
        terms = [
            f"{a!r}",
            f"{b!r}*{x}" if b else "",
            f"{c!r}*{x}**3" if c else "",
            f"{d!r}*sin({n}*{x} + 0.4)" if d else "",
        ]
        row = {"type": "torque", "joint": f"j{body}", "value": " + ".join(term for term in terms if term)}
        self.forces[f"f{len(self.forces)}"] = row

    def turn_spring(self, body: int, k: float, angle: float) -> None:
        self.tree.torques.append((body, k * angle, -k, 0.0, 0.0, 1.0, 0.0))
        row = {"type": "turn_spring", "joint": f"j{body}", "stiffness": k, "angle": angle}
        self.forces[f"f{len(self.forces)}"] = row

    def law(self, body: int) -> None:
        """A torque by the coordinate: springs that harden, several wells, a constant."""
        a, b = self.uniform(-3.0, 3.0), self.logarithmic(2.0, 60.0)
        choice = int(self.rng.integers(4))
        if choice == 0:
            self.torque(body, a)
        elif choice == 1:
            self.torque(body, b=-b, c=-b)
        elif choice == 2:
            self.torque(body, a, d=b, n=int(self.rng.integers(1, 4)))
        else:
            self.torque(body, a * b, -b)

    # ---- closures and contacts -----------------------------------------------------------------------------------
    def rod(self, a: Point, b: Point) -> None:
        length = float(np.linalg.norm(self.place(a) - self.place(b)))
        self.tree.rods.append((a, b, length))
        self.joints[f"rod{len(self.joints)}"] = {
            "type": "rod",
            "from": self.name(a),
            "to": self.name(b),
            "length": length,
        }

    def line(self, point: Point) -> None:
        """The point stays on a line across the plane, or along some direction, through where it is."""
        axis, at = AXIS_Y if self.flat else self.direction(), self.place(point)
        self.tree.lines.append((point, at, axis))
        row = {"type": "line", "axis": axis.tolist(), "from": self.name(Point(GROUND, at)), "to": self.name(point)}
        self.joints[f"line{len(self.joints)}"] = row

    def rope(self, a: Point, b: Point, slack: float) -> None:
        """A rope, by so much of its span longer."""
        length = float(np.linalg.norm(self.place(a) - self.place(b))) * (1.0 + slack)
        self.tree.ropes.append((a, b, length, 1))
        row = {"type": "rod", "from": self.name(a), "to": self.name(b), "length": length, "tension_only": True}
        self.joints[f"rope{len(self.joints)}"] = row | ({"restitution": 0.3} if self.chance(0.3) else {})

    def stop(self, body: int) -> None:
        """Limits about the start, on one side or both; now and then at one."""
        one, q = self.tree.bodies[body], self.tree.bodies[body].start[0]
        wide = 1.0 if one.joint == "pin" else 0.4
        low, high = q - wide * self.uniform(0.02, 1.5), q + wide * self.uniform(0.02, 1.5)
        if self.chance(0.1):
            low = q
        sides = int(self.rng.integers(3))
        if sides != 1:
            self.tree.stops.append((body, low, 1))
        if sides != 0:
            self.tree.stops.append((body, high, -1))
        limits = [low if sides != 1 else None, high if sides != 0 else None]
        self.stops[f"s{body}"] = {"joint": f"j{body}", "angle" if one.joint == "pin" else "travel": limits}

    def span(self, a: Point, b: Point) -> None:
        """A distance between limits."""
        far = float(np.linalg.norm(self.place(a) - self.place(b)))
        low, high = far * self.uniform(0.6, 0.97), far * self.uniform(1.03, 1.5)
        self.tree.ropes += [(a, b, low, -1), (a, b, high, 1)]
        key = f"span{len(self.joints)}"
        self.joints[key] = {"type": "rod", "from": self.name(a), "to": self.name(b)}
        self.stops[key + "_s"] = {"joint": key, "length": [low, high]}

    def done(self, kind: str, seed: int, gravity: Vector) -> Scene:
        self.tree.gravity = self.R.T @ gravity
        spec: dict[str, Any] = {
            "gravity": gravity.tolist(),
            "ground": {"points": {"O": [0.0, 0.0, 0.0], **self.points}},
        }
        spec["bodies"] = self.bodies
        for key in ("joints", "drives", "forces", "stops"):
            if getattr(self, key):
                spec[key] = getattr(self, key)
        return Scene(kind, seed, spec | {"analysis": {"type": "rest"}}, self.tree, self.R)


# ---- kinds -------------------------------------------------------------------------------------------------------
def tree_of(d: Draft, most: int) -> None:
    """Some bodies one on another, springs and laws."""
    n = int(d.rng.integers(1, most + 1))
    for k in range(n):
        parent = GROUND if k == 0 else int(d.rng.integers(-1 if d.chance(0.2) else k - 1, k))
        at = 0.5 * d.vector(1.0) if parent == GROUND else d.tree.bodies[parent].points["end"]
        kinds = [d.pin, d.pin, d.pin, d.slide] if d.flat else [d.ball, d.universal, d.pin, d.pin, d.slide]
        kinds[int(d.rng.integers(len(kinds)))](parent, at)
    loads(d)


def loads(d: Draft) -> None:
    """What holds them: each slide by a spring."""
    for k, one in enumerate(d.tree.bodies):
        if one.joint in ("pin", "slide") and d.chance(0.25):
            d.law(k)
        if one.joint == "pin" and d.chance(0.2):
            d.turn_spring(k, d.logarithmic(1.0, 50.0), d.uniform(-1.0, 1.0))
        if one.joint == "slide":
            b, free = d.logarithmic(10.0, 300.0), d.uniform(-0.3, 0.3)
            d.torque(k, b * free, -b)
        if d.chance(0.5) or one.joint == "free":
            d.some_spring(k)
        if d.chance(0.1):
            d.push(d.point(k), d.uniform(1.0, 20.0) * d.direction(), False)


def plane(d: Draft) -> Vector:
    tree_of(d, 4)
    freedoms = len(d.tree.bodies)
    if freedoms >= 3 and d.chance(0.3):
        d.line(Point(freedoms - 1, d.tree.bodies[-1].points["end"]))
    elif freedoms >= 2 and d.chance(0.4):
        d.rod(d.ground(), d.point(freedoms - 1))
    return np.array([0.0, 0.0, -G])


def space(d: Draft) -> Vector:
    tree_of(d, 3)
    if len(d.tree.bodies) >= 2 and d.chance(0.4):
        d.rod(d.ground(), d.point(len(d.tree.bodies) - 1))
    return np.array([0.0, 0.0, -G])


def stops(d: Draft) -> Vector:
    d.flat = d.chance(0.6)
    tree_of(d, 3)
    limited = False
    for k, one in enumerate(d.tree.bodies):
        if one.joint in ("pin", "slide") and d.chance(0.6):
            d.stop(k)
            limited = True
    if not limited or d.chance(0.2):
        d.span(d.ground(), d.point(len(d.tree.bodies) - 1))
    return np.array([0.0, 0.0, -G])


def ropes(d: Draft) -> Vector:
    d.flat = d.chance(0.5)
    if d.chance(0.35):
        k = d.free()
        for _ in range(int(d.rng.integers(1, 4))):
            at = d.vector(1.0) + np.array([0.0, 0.0, 1.5])
            d.rope(Point(GROUND, at), d.point(k), 0.0 if d.chance(0.3) else d.uniform(0.01, 0.5))
        if d.chance(0.5):
            d.some_spring(k)
        return np.array([0.0, 0.0, -G])
    tree_of(d, 3)
    for _ in range(int(d.rng.integers(1, 4))):
        k = int(d.rng.integers(len(d.tree.bodies)))
        a = d.ground() if k == 0 or d.chance(0.7) else d.point(int(d.rng.integers(k)))
        d.rope(a, d.point(k), 0.0 if d.chance(0.2) else d.uniform(0.01, 0.5))
    return np.array([0.0, 0.0, -G])


def followers(d: Draft) -> Vector:
    d.flat = d.chance(0.7)
    tree_of(d, 3)
    for _ in range(int(d.rng.integers(1, 3))):
        k = int(d.rng.integers(len(d.tree.bodies)))
        if d.chance(0.8):
            d.push(d.point(k), d.logarithmic(0.5, 20.0) * d.direction(), True)
        else:
            axis = AXIS_Y if d.flat else d.direction()
            d.couple(k, d.logarithmic(0.3, 4.0) * axis, d.chance(0.5))
    return np.array([0.0, 0.0, -G])


def friction(d: Draft) -> Vector:
    """Brakes and dampers that shall do nothing."""
    d.flat = d.chance(0.6)
    tree_of(d, 3)
    for k, one in enumerate(d.tree.bodies):
        name, speed = f"f{len(d.forces)}", d.logarithmic(1e-6, 0.1)
        if one.joint in ("pin", "slide"):
            size = "torque" if one.joint == "pin" else "force"
            d.forces[name] = {"type": "friction", "joint": f"j{k}", size: d.logarithmic(0.1, 100.0), "speed": speed}
        if one.joint in ("ball", "universal", "pin", "slide") and d.chance(0.5):
            d.forces[name + "d"] = {"type": "damper", "joint": f"j{k}", "coefficient": d.logarithmic(0.01, 100.0)}
    for load in d.forces.values():
        if load["type"] in ("spring", "turn_spring"):
            load["damping"] = d.logarithmic(0.01, 100.0)
    return np.array([0.0, 0.0, -G])


def drives(d: Draft) -> Vector:
    """A turning table, a table at an angle, a carriage at constant speed."""
    kind = int(d.rng.integers(4))
    d.base = "table"
    table = {"mass": 2.0, "center": [0.0, 0.0, 0.0], "inertia": [0.3, 0.3, 0.4], "points": d.points}
    d.points["c"] = [0.0, 0.0, 0.0]
    gravity = np.array([0.0, 0.0, -G])
    row: dict[str, Any] = {"from": "ground.O", "to": "table.c"}
    d.flat = kind != 3 and d.chance(0.5)
    if kind in (0, 1):
        w = d.uniform(1.0, 9.0)
        axis = np.array([0.0, 0.0, 1.0])
        if kind == 1 and not d.flat:
            gravity, axis = np.zeros(3), d.direction()
        row |= {"type": "pin", "axis": axis.tolist()}
        d.tree.spin, d.pushed = w * axis, axis
        value: dict[str, Any] = {"rate": w} if d.chance(0.5) else {"angle": f"{w!r}*t"}
    elif kind == 2:
        row |= {"type": "slide", "axis": [1.0, 0.0, 0.0]}
        value = {"speed": d.uniform(0.1, 3.0)} if d.chance(0.5) else {"travel": f"{d.uniform(0.1, 3.0)!r}*t"}
    else:
        angle, axis = d.uniform(-3.0, 3.0), d.direction()
        row |= {"type": "pin", "axis": axis.tolist()}
        value = {"angle": angle}
        d.R = of_quaternion(np.array([math.cos(angle / 2), *(math.sin(angle / 2) * axis)]))
    tree_of(d, 3)
    if d.chance(0.3):
        d.stop(0) if d.tree.bodies[0].joint in ("pin", "slide") else None
    if d.chance(0.3):
        d.rope(d.ground(), d.point(len(d.tree.bodies) - 1), d.uniform(0.01, 0.4))
    d.bodies = {"table": table, **d.bodies}
    d.joints = {"jt": row, **d.joints}
    d.drives = {"w": {"joint": "jt", **value}}
    return gravity


KINDS: dict[str, Callable[[Draft], Vector]] = {
    "plane": plane, "space": space, "stops": stops, "ropes": ropes, "followers": followers, "friction": friction,
    "drives": drives,
}  # fmt: skip


def drawn(kind: str, seed: int) -> Scene:
    """A scene of a kind."""
    rng = np.random.default_rng([seed, list(KINDS).index(kind)])
    d = Draft(rng, flat=kind in ("plane",))
    gravity = KINDS[kind](d)
    return d.done(kind, seed, gravity)
