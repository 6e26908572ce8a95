"""Random scenes that move in a plane which lies anywhere in space, as dicts of a spec, for tests of that discovery.

Drawn in the axes of their plane, bodies in axes of their own. Upright ones have joints that cannot leave the plane, at
any heights, with loads and inertia that point out of it; the others could leave it, and are their own mirror image.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np

from heuncli.results.results import Array
from heuncli.scene.shapes.rotations import rotation_from_vector, rotation_matrix_about

X, Y, Z = np.eye(3)
TREE = {  # kinds of joints, and where their axes stand
    True: ("pin", "pin", "pin", "slide across", "weld", "hinges"),
    False: ("ball", "ball", "pin", "pin across", "slide across", "slide", "cylinder", "cylinder across", "universal",
            "universal back", "universal across", "weld", "line", "line across", "plane", "plane across", "free"),
}  # fmt: skip
CLOSING = {
    True: ("pin", "ball", "line across", "line", "cylinder", "rod", "plane across", "slide across", "universal"),
    False: ("ball", "rod", "line across", "pin", "plane across", "cylinder across"),
}
PLANES: dict[str, Array] = {  # the plane's axes as rows
    "xy": np.eye(3), "xz": np.eye(3)[[2, 0, 1]], "yz": np.eye(3)[[1, 2, 0]],
    "from below": np.diag([1.0, -1.0, -1.0]), "tilted": rotation_from_vector(np.array([0.3, -0.7, 0.4])),
}  # fmt: skip


class Draft:
    """A scene under construction: places and turns of its bodies in the plane's axes."""

    def __init__(self, rng: np.random.Generator, E: Array, upright: bool, own_axes: bool) -> None:
        self.rng, self.E, self.upright = rng, E, upright
        self.own_axes = own_axes
        self.x: dict[str, Array] = {"ground": np.zeros(3)}
        self.psi: dict[str, float] = {"ground": 0.0}
        self.S: dict[str, Array] = {"ground": E.T}  # from the plane's axes to the body's, where psi is zero
        self.bodies: dict[str, Any] = {}
        self.joints: dict[str, Any] = {}

    def height(self) -> float:
        return float(self.rng.uniform(-0.5, 0.5)) if self.upright else 0.0

    def somewhere(self, reach: float = 0.6) -> Array:
        return np.array([*self.rng.uniform(-reach, reach, 2), self.height()])

    def axes(self, body: str) -> Array:
        """From the plane's axes to the body's."""
        return self.S[body] @ rotation_matrix_about(Z, -self.psi[body])

    def to_body(self, body: str, place: Array) -> list[float]:
        return (self.axes(body) @ (place - self.x[body])).tolist()

    def across(self) -> Array:
        return rotation_matrix_about(Z, float(self.rng.uniform(0.0, 6.0))) @ X

    def body(self, name: str, near: Array) -> None:
        rng = self.rng
        self.x[name] = near + self.somewhere()
        self.psi[name] = float(rng.uniform(-1.0, 1.0))
        self.S[name] = self.E.T if not self.own_axes else rotation_from_vector(rng.normal(size=3))
        S = self.S[name]
        points = rng.normal(size=(5, 3)) * [0.4, 0.4, 0.4 if self.upright else 0.0]
        m = rng.uniform(0.2, 1.0, 5)
        c = m @ points / m.sum()
        if not self.upright:  # symmetric about the plane: thick, but as much above as below
            thick = 0.05 * m.sum() * np.diag([1.0, 1.0, 0.0])
        arms = points - c
        J = sum(mi * ((a @ a) * np.eye(3) - np.outer(a, a)) for mi, a in zip(m, arms, strict=True))
        J = J if self.upright else J + thick
        self.bodies[name] = {
            "mass": float(m.sum()), "center": (S @ c).tolist(), "inertia": (S @ (0.5 * (J + J.T)) @ S.T).tolist(),
            "position": (self.E.T @ self.x[name]).tolist(),
            "orientation": {"matrix": (self.E.T @ self.axes(name).T).tolist()},
        }  # fmt: skip

    def hinges(self, name: str, a: str, b: str) -> None:
        """A ball, and what slides along the normal through it, at another height."""
        place = 0.5 * (self.x[a] + self.x[b]) + self.somewhere(0.2)
        self.joint(name, "ball", a, b, place)
        self.joint(f"{name}_top", str(self.rng.choice(["line", "ball", "cylinder"])), a, b, place + 0.7 * Z)

    def joint(self, name: str, how: str, a: str, b: str, place: Array | None = None) -> None:
        rng = self.rng
        if how == "hinges":
            self.hinges(name, a, b)
            return
        kind, _, side = how.partition(" ")
        if place is None:
            place = 0.5 * (self.x[a] + self.x[b]) + self.somewhere(0.2)
            place[2] = self.x[b][2] + self.height()
        n = Z * (1.0 if rng.random() < 0.5 else -1.0)
        axis = self.across() if side == "across" else n
        end = place.copy()
        if kind in ("slide", "cylinder", "line") and side == "across":
            end = place + float(rng.uniform(-0.2, 0.2)) * axis
        if kind == "plane":
            within = np.cross(axis, Z) if side == "across" else self.across()
            end = place + 0.2 * within
        if kind == "rod":
            end = place + self.somewhere()
        made: dict[str, Any] = {"type": kind}
        made["from"] = {"body": a, "at": self.to_body(a, place)}
        made["to"] = {"body": b, "at": self.to_body(b, end)}
        if kind in ("pin", "slide", "cylinder", "line"):
            made["axis"] = (self.axes(a) @ axis).tolist()
        if kind == "plane":
            made["normal"] = (self.axes(a) @ axis).tolist()
        same = "axis" in made and np.allclose(self.axes(b).T @ made["axis"], axis)
        if kind in ("pin", "slide", "cylinder") and not same:
            made["to_axis"] = (self.axes(b) @ axis).tolist()
        if kind == "universal":
            first, second = (n, self.across()) if side == "" else (self.across(), n)
            if side == "across":
                second = np.cross(n, first)
            made["axis"], made["to_axis"] = (self.axes(a) @ first).tolist(), (self.axes(b) @ second).tolist()
        self.joints[name] = made


def flat(seed: int, plane: str, upright: bool, own_axes: bool) -> dict[str, Any]:
    """A scene with some bodies in a tree, a closed loop or two, and loads of every kind."""
    rng = np.random.default_rng(seed)
    draft = Draft(rng, PLANES[plane], upright, own_axes)
    names = ["ground"]
    for i in range(int(rng.integers(2, 5))):
        name, parent = f"b{i}", names[int(rng.integers(max(0, len(names) - 2), len(names)))]
        draft.body(name, draft.x[parent])
        how = str(rng.choice(TREE[upright]))
        if how != "free":
            draft.joint(f"j{i}", how, *((parent, name) if rng.random() < 0.7 or forward(how) else (name, parent)))
        names.append(name)
    for k in range(int(rng.integers(0, 2 if len(names) < 4 else 3))):
        a, b = rng.choice(len(names), 2, replace=False)
        draft.joint(f"c{k}", str(rng.choice(CLOSING[upright])), names[a], names[b])
    return {
        "gravity": acting(draft, 9.81, Z if upright else 0.0 * Z).tolist(), "bodies": draft.bodies,
        "joints": draft.joints, "forces": loads(draft, names, plane), "space": "auto",
    }  # fmt: skip


def forward(how: str) -> bool:
    return how.partition(" ")[0] in ("line", "plane")


def acting(draft: Draft, size: float, out: Array) -> Array:
    """A force along the plane, and out of it where that may be; world axes."""
    return np.asarray(draft.E.T @ (size * (draft.across() + float(draft.rng.normal()) * out)))


def loads(draft: Draft, names: list[str], plane: str) -> dict[str, Any]:
    rng, up = draft.rng, draft.upright
    out = Z if up else 0.0 * Z
    bodies = names[1:]
    some: Callable[[], str] = lambda: str(rng.choice(bodies))  # noqa: E731
    found: dict[str, Any] = {}
    for i in range(2):
        on = some()
        at = draft.to_body(on, draft.x[on] + draft.somewhere())
        framed = bool(rng.random() < 0.5)
        force = acting(draft, 3.0, out)
        if framed:
            force = draft.axes(on) @ draft.E @ force
        vector: list[Any] = force.tolist()
        if up or (plane != "tilted" and not (framed and draft.own_axes)):
            vector = [f"{x!r}*sin({i + 2}*t + 0.3)" if abs(x) > 1e-9 else x for x in vector]
        found[f"f{i}"] = {"type": "force", "on": {"body": on, "at": at}, "vector": vector,
                          "frame": "body" if framed else "world"}  # fmt: skip
    turn = draft.E.T @ (Z + (draft.across() if up else 0.0 * Z))
    found["m"] = {"type": "couple", "on": some(), "vector": turn.tolist()}
    a, b = rng.choice(len(names), 2, replace=False)
    ends = {key: {"body": names[i], "at": draft.to_body(names[i], draft.x[names[i]] + draft.somewhere())}
            for key, i in (("from", a), ("to", b))}  # fmt: skip
    found["s"] = {"type": "spring", **ends, "stiffness": 30.0, "length": 0.3, "damping": 0.7}
    for name, joint in draft.joints.items():
        if joint["type"] in ("ball", "universal", "pin", "slide", "line", "plane"):
            found[f"d_{name}"] = {"type": "damper", "joint": name, "coefficient": 0.4}
    return found
