"""Driven machines that hold something twice and pass poses at which what is open elsewhere is certain, or the reverse.

Whole seconds are quarter turns: links in line, cranks along the axes, flat loops. Each is drawn in the xy plane about z
and turned into the world by axes alone, so that such poses are met exactly.
"""

from __future__ import annotations

import math
from typing import Any

import numpy as np

from tests.oracle.values import Harmonic
from tests.shared.rod_drives import Apart

Array = np.ndarray[Any, np.dtype[np.float64]]
Rng = np.random.Generator
Scene = dict[str, Any]
X, Y, Z = np.eye(3)
O = np.zeros(3)  # the origin
QUARTER = math.pi / 2
TIMES = (0.0, 0.37, 1.0, 1.283, 2.0, 2.641, 3.0)  # special poses and usual ones in turn


def special(seed: int) -> tuple[str, Scene, Scene]:
    """A scene by its kind, and its twin in space: the same one, unless it is told in the plane."""
    rng = np.random.default_rng([31, seed])
    family = FAMILIES[seed % len(FAMILIES)]
    planar = family in PLANAR and rng.random() < 0.4
    draft = Draft(rng, np.eye(3) if planar else turned_by_axes(rng))
    kind = f"{family.__name__} {family(draft, rng)}"
    scene = draft.scene()
    return (f"{kind} planar", *flattened(scene)) if planar else (kind, scene, scene)


def at(r: float, quarters: float) -> Array:
    """A place in the plane at so many quarter turns, on an axis exactly where they are whole."""
    exact = {0.0: (1.0, 0.0), 1.0: (0.0, 1.0), 2.0: (-1.0, 0.0), 3.0: (0.0, -1.0)}
    angle = QUARTER * quarters
    c, s = exact.get(quarters % 4.0, (math.cos(angle), math.sin(angle)))
    return r * np.array([c, s, 0.0])


def steady(rate: float) -> Any:
    """A drive at a constant rate."""
    return Harmonic(0.0, rate, 0.0, 1.0, 0.0).drive()


def turned_by_axes(rng: Rng) -> Array:
    """A rotation that takes axes to axes."""
    Q = np.roll(np.eye(3), int(rng.integers(3)), axis=0) @ np.diag(rng.choice([-1.0, 1.0], 3))
    return np.asarray(Q if np.linalg.det(Q) > 0.0 else -Q)


class Draft:
    """A machine drawn in world axes, which Q takes into the world."""

    def __init__(self, rng: Rng, Q: Array) -> None:
        self.rng, self.Q = rng, Q
        self.bodies: Scene = {}
        self.joints: Scene = {}
        self.drives: Scene = {}
        self.forces: Scene = {}

    def scene(self) -> Scene:
        """The whole, pulled across by gravity."""
        parts = {"bodies": self.bodies, "joints": self.joints, "drives": self.drives, "forces": self.forces}
        return {"gravity": self.told([0.0, -9.81, 0.0]), **parts}

    def told(self, v: Any) -> list[float]:
        """A vector as it stands in the file."""
        return [float(x) for x in self.Q @ np.asarray(v, float)]

    def body(self, name: str, center: Array, size: float = 1.0) -> None:
        """A body about its centre, with a push on every other one."""
        mass = float(self.rng.uniform(0.5, 3.0))
        inertia = self.Q @ (mass * size**2 * (0.02 + np.diag([0.2, 0.22, 0.25]))) @ self.Q.T
        inertia = 0.5 * (inertia + inertia.T)
        self.bodies[name] = {"mass": mass, "center": self.told(center), "inertia": inertia.tolist()}
        if self.rng.random() < 0.5:
            place = self.told(center + self.rng.uniform(-0.3, 0.3, 3))
            push = self.told(self.rng.uniform(-5.0, 5.0, 3))
            self.forces[f"push_{name}"] = {"type": "force", "on": {"body": name, "at": place}, "vector": push}

    def joint(self, name: str, kind: str, a: str, b: str, p: Array, q: Array | None = None, **axes: Array) -> None:
        """A joint between places as drawn; without q both ends are at p."""
        ends = {"from": {"body": a, "at": self.told(p)}, "to": {"body": b, "at": self.told(p if q is None else q)}}
        self.joints[name] = {"type": kind, **ends, **{key: self.told(v) for key, v in axes.items()}}

    def drive(self, joint: str, law: Any, quantity: str = "angle") -> None:
        """A drive of a joint."""
        self.drives[f"d_{joint}"] = {"joint": joint, quantity: law}


def flattened(scene: Scene) -> tuple[Scene, Scene]:
    """A scene told in the plane, with all that it holds across taken out, and its twin in space."""
    for body in scene["bodies"].values():
        body["center"][2] = 0.0
        about = float(body["inertia"][2][2])
        body["inertia"] = [about, about, about]
    for force in scene["forces"].values():
        force["vector"][2] = force["on"]["at"][2] = 0.0
    joints = scene["joints"]
    for name in [n for n, j in joints.items() if j["type"] == "plane" and abs(j["normal"][2]) == 1.0]:
        del joints[name]
    for joint in joints.values():
        joint["from"]["at"][2] = joint["to"]["at"][2] = 0.0
        if joint["type"] == "ball" or (joint["type"] in ("line", "cylinder") and abs(joint["axis"][2]) == 1.0):
            joint |= {"type": "pin", "axis": [0.0, 0.0, 1.0]}
    bodies = {name: {**body, "inertia": body["inertia"][2]} for name, body in scene["bodies"].items()}
    return {**scene, "space": "planar", "bodies": bodies}, scene


def start(rng: Rng) -> float:
    """Where a crank starts, in quarters."""
    return float(rng.choice([0.0, 0.0, 1.0, 2.0, 0.5, rng.uniform(0.0, 4.0)]))


HOLDS = ("pin", "ball", "line", "cylinder", "plane fixed", "plane turning", "line fixed", "line turning", "rod",
         "rod up", "rod down", "face")  # fmt: skip


def hold(d: Draft, name: str, a: str, b: str, p: Array, what: str, u: Array) -> None:
    """Something more that holds b to a while it turns about z through p; u: a direction in the plane as drawn."""
    n, rng = p + d.rng.uniform(-0.7, 0.7) * Z, d.rng
    kind, _, way = what.partition(" ")
    if kind in ("pin", "ball", "cylinder") or (kind == "line" and not way):
        d.joint(name, kind, a, b, n, **({} if kind == "ball" else {"axis": Z}))
    elif kind in ("plane", "line"):
        first, second = (a, b) if way == "fixed" else (b, a)
        d.joint(name, kind, first, second, n, **{"normal" if kind == "plane" else "axis": u})
    elif kind == "rod":
        first, second = (b, a) if way == "down" else (a, b)
        lifted = n + rng.uniform(0.3, 1.0) * Z if way == "up" else n
        d.joint(name, "rod", first, second, lifted, n + rng.uniform(0.5, 2.0) * u)
    else:
        d.joint(name, "plane", a, b, p + rng.uniform(-1.0, 1.0) * X, p + rng.uniform(0.3, 1.0) * u, normal=Z)


def arm(d: Draft, rng: Rng) -> str:
    """Arms one behind the other, each driven and held more than once."""
    before, p, words = "ground", O, []
    for k in range(int(rng.integers(1, 3))):
        tip = p + at(rng.uniform(0.5, 1.5), start(rng))
        name = f"arm{k}"
        d.body(name, 0.5 * (p + tip))
        d.joint(f"j{k}", "pin", before, name, p, axis=Z)
        d.drive(f"j{k}", steady(QUARTER * float(rng.choice([1, -1, 2]))))
        for i in range(int(rng.integers(k == 0, 3))):
            what = str(rng.choice(HOLDS))
            along = (tip - p) / np.linalg.norm(tip - p)
            u = at(1.0, float(rng.choice([0.0, 1.0, 0.5, 2 / 3]))) if rng.random() < 0.7 else along
            hold(d, f"h{k}{i}", before, name, p, what, u)
            words.append(what)
        before, p = name, tip
    return "+".join(words)


def trammel(d: Draft, rng: Rng) -> str:
    """A bar whose ends go along two axes, its middle on a crank."""
    r = rng.uniform(0.5, 1.5)
    A = at(r, start(rng))
    middle, first, second = (str(rng.choice(kinds)) for kinds in (["pin", "ball"], *[["line", "plane"]] * 2))
    if (first, second) == ("plane", "plane"):
        middle = "pin"  # else the bar tilts
    d.body("crank", 0.5 * A)
    d.body("bar", A + 0.1 * X, 2 * r)
    d.joint("O", "pin", "ground", "crank", O, axis=Z)
    d.joint("A", middle, "crank", "bar", A, **({"axis": Z} if middle == "pin" else {}))
    for name, kind, end, along, across in (("B", first, 2 * A * X, X, Y), ("C", second, 2 * A * Y, Y, X)):
        d.joint(name, kind, "ground", "bar", O, end, **({"axis": along} if kind == "line" else {"normal": across}))
    d.drive("O", steady(QUARTER))
    return middle + first + second


def cranks(d: Draft, rng: Rng) -> str:
    """A coupler on three or four parallel cranks or rods, with one drive or two."""
    r, words = rng.uniform(0.5, 1.5), []
    lift = at(r, start(rng))
    third = Y * 1.5 if rng.random() < 0.5 else np.append(rng.uniform(-1.0, 3.0, 2), 0.0)
    feet = [O, 2.0 * X, third, *([X + Y] if rng.random() < 0.3 else [])]
    d.body("coupler", np.mean(feet, axis=0) + lift)
    for k, foot in enumerate(feet):
        words.append("rod" if k and rng.random() < 1 / 3 else "pins")
        if words[-1] == "rod":
            d.joint(f"R{k}", "rod", "ground", "coupler", foot, foot + lift)
            continue
        d.body(f"crank{k}", foot + 0.5 * lift)
        d.joint(f"O{k}", "pin", "ground", f"crank{k}", foot, axis=Z)
        kind = str(rng.choice(["pin", "line", "ball"]))
        d.joint(f"A{k}", kind, f"crank{k}", "coupler", foot + lift, **({} if kind == "ball" else {"axis": Z}))
    d.drive("O0", steady(QUARTER))
    if "O1" in d.joints and rng.random() < 0.3:
        d.drive("O1", steady(QUARTER))
    if all(joint["type"] != "pin" for name, joint in d.joints.items() if name.startswith("A")):
        for k, beside in enumerate((0.3 * X, 0.4 * Y, -0.4 * Y - 0.2 * X)):  # else it tilts
            d.joint(f"face{k}", "plane", "ground", "coupler", O, lift + beside, normal=Z)
    return "+".join(words)


def truss(d: Draft, rng: Rng) -> str:
    """A plate held by more rods than it needs to a frame that turns."""
    q, flat = start(rng), rng.random() < 0.5
    d.body("frame", at(0.5, q))
    d.joint("O", "pin", "ground", "frame", O, axis=Z)
    d.drive("O", steady(QUARTER))
    d.body("plate", at(1.0, q))
    for k in range(4 if flat else 7):
        u = at(1.0, float(rng.choice([0.0, 1.0, 2.0, 3.0, 0.5, 1.5, rng.uniform(0.0, 4.0)])))
        if not flat:
            u = [u, np.array([u[0], 0.0, u[1]]), np.array([0.0, u[0], u[1]]), Z][int(rng.integers(4))]
        x, y = np.round(rng.uniform(-1.0, 1.0, 2), int(rng.integers(0, 3)))
        p = np.array([x, y, 0.0 if flat else float(rng.choice([0.0, 0.5, -0.5]))])
        d.joint(f"r{k}", "rod", "frame", "plate", p, p + rng.uniform(0.5, 2.0) * u)
    for k in range(3 if flat else 0):
        d.joint(f"f{k}", "plane", "frame", "plate", O, np.append(rng.uniform(-1.0, 1.0, 2), 0.0), normal=Z)
    return "flat" if flat else "in space"


def cardan(d: Draft, rng: Rng) -> str:
    """Two shafts in bearings with a universal joint between: each bearing more than it needs."""
    bend = float(rng.choice([math.pi / 6, math.pi / 4, rng.uniform(0.2, 1.0)]))
    u = np.array([0.0, math.sin(bend), math.cos(bend)])
    a = at(1.0, start(rng))
    b = np.cross(u, a)
    kind, second = str(rng.choice(["pin", "cylinder"])), str(rng.choice(["ball", "pin", "", ""]))
    d.body("one", -0.5 * Z)
    d.body("two", 0.5 * u)
    d.joint("O", "pin", "ground", "one", -Z, axis=Z)
    d.drive("O", steady(QUARTER))
    d.joint("U", "universal", "one", "two", O, axis=a, to_axis=b / np.linalg.norm(b))
    d.joint("P", kind, "ground", "two", u, axis=u)
    if second:
        d.joint("S", second, "ground", "one", -0.5 * Z, **({"axis": Z} if second == "pin" else {}))
    return kind + second


def two_drives(d: Draft, rng: Rng) -> str:
    """An arm driven twice: about its pin, and by a rod that pulls its tip."""
    q, r, g = start(rng), float(rng.uniform(0.5, 1.0)), float(rng.uniform(1.3, 2.5))
    tip, where = at(r, q), float(rng.choice([0.0, 1.0, 2.0]))
    d.body("arm", 0.5 * tip)
    d.joint("O", "pin", "ground", "arm", O, axis=Z)
    d.drive("O", steady(QUARTER))
    d.joint("R", "rod", "ground", "arm", at(g, where), tip)
    d.drive("R", Apart(g, r, QUARTER * (q - where), QUARTER).drive(), "length")
    return "rod"


def four_bar(d: Draft, rng: Rng) -> str:
    """Parallel pins that turn whole, or a parallelogram that passes its flat poses."""
    r, span, q = rng.uniform(0.4, 0.8), 2.0, start(rng)
    A, D, B = O, span * X, at(r, q)
    word = str(rng.choice(["parallelogram", "grashof"]))
    C = D + B if word == "parallelogram" else meeting(B, D, rng.uniform(1.8, 2.2), rng.uniform(1.7, 2.1))
    for name, p, s in (("left", A, B), ("coupler", B, C), ("right", C, D)):
        d.body(name, 0.5 * (p + s))
    d.joint("A", "pin", "ground", "left", A, axis=Z)
    d.joint("B", "pin", "left", "coupler", B, axis=Z)
    kinds = [str(rng.choice(["pin", "cylinder"])), str(rng.choice(["pin", "line", "cylinder"]))]
    d.joint("C", kinds[0], "coupler", "right", C, axis=Z)
    d.joint("D", kinds[1], "ground", "right", D, axis=Z)
    d.drive("A", steady(QUARTER))
    return "+".join([word, *kinds])


def meeting(a: Array, b: Array, from_a: float, from_b: float) -> Array:
    """The point so far from two others, left of the way from the first to the second."""
    way = b - a
    far = float(np.linalg.norm(way))
    x = (far * far + from_a * from_a - from_b * from_b) / (2.0 * far)
    return np.asarray(a + (x * way + math.sqrt(max(from_a * from_a - x * x, 0.01)) * np.cross(Z, way)) / far)


FAMILIES = (arm, arm, trammel, cranks, truss, cardan, two_drives, four_bar)
PLANAR = (trammel, cranks, truss, two_drives, four_bar)
