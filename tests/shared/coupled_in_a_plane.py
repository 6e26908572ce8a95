"""Random scenes with machine elements that move in a plane which lies anywhere in space, as dicts of a spec.

Drawn as shared/flat_in_any_plane.py draws its scenes: upright ones at any heights on carriers that cannot leave the
plane, the others on carriers that could, and their own mirror images.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import Any

import numpy as np

from heuncli.results.results import Array
from heuncli.scene.shapes.rotations import rotation_matrix_about
from tests.shared.flat_in_any_plane import PLANES, Draft, Z, acting, loads

Scene = dict[str, Any]
HUNG = {True: ("pin", "slide across"), False: ("ball", "plane", "free")}


class Coupled(Draft):
    """A scene under construction, with what couples its joints; on: the body that carries all elements."""

    def __init__(self, rng: np.random.Generator, E: Array, upright: bool, own_axes: bool) -> None:
        super().__init__(rng, E, upright, own_axes)
        self.couplings: Scene = {}
        self.rolling: Scene = {}
        self.tables: Scene = {}
        self.on, self.welds = "ground", 0.0

    def member(self, name: str, kind: str, place: Array, axis: Array, on: str | None = None) -> str:
        """A body in a pin or slide at a place, along an axis in the plane's axes; the joint's name."""
        self.body(name, place)
        if self.rng.random() < self.welds:
            self.body(f"{name}_hub", place)
            self.joint(f"w_{name}", "weld", f"{name}_hub", name)
            name = f"{name}_hub"
        a, b = (on or self.on, name) if self.rng.random() < 0.6 else (name, on or self.on)
        same = self.axes(name).T @ self.axes(a) if name == b else self.axes(b).T @ self.axes(name)
        joint: Scene = {"type": kind, "axis": (self.axes(a) @ axis).tolist()}
        joint |= (
            {"to_axis": (self.axes(b) @ axis).tolist()} if kind == "pin" or not np.allclose(same, np.eye(3)) else {}
        )
        joint |= {"from": self.point(a, place), "to": self.point(b, place)}
        self.joints[f"j_{name}"] = joint
        return f"j_{name}"

    def point(self, body: str, place: Array) -> Scene:
        """A place of the plane as a point of a body."""
        return {"body": body, "at": self.to_body(body, place)}

    def normal(self) -> Array:
        """The plane's, either way."""
        return Z * (1.0 if self.rng.random() < 0.5 else -1.0)

    def beside(self, place: Array, most: float = 1.0) -> Array:
        """A place at another height, where that is free."""
        return place + most * self.height() * Z


def gears(draft: Coupled, name: str) -> None:
    P, out, (r1, r2) = draft.somewhere(), draft.across(), draft.rng.uniform(0.2, 0.7, 2)
    side = 1.0 if draft.rng.random() < 0.6 else -1.0
    r2 += 0.6 * (side < 0.0)
    one = draft.member(f"{name}1", "pin", draft.beside(P - r1 * out), draft.normal())
    other = draft.member(f"{name}2", "pin", draft.beside(P + side * r2 * out), draft.normal())
    helix = float(draft.rng.uniform(-0.4, 0.4)) if draft.upright else 0.0
    draft.couplings[name] = {"type": "gear", "of": [one, other], "at": draft.point(draft.on, P), "helix": helix,
                             "pressure_angle": 0.35}  # fmt: skip


def rack(draft: Coupled, name: str) -> None:
    P, out, r = draft.somewhere(), draft.across(), draft.rng.uniform(0.2, 0.7)
    one = draft.member(f"{name}1", "pin", draft.beside(P - r * out), draft.normal())
    other = draft.member(f"{name}2", "slide", draft.beside(P), np.cross(draft.normal(), out))
    draft.couplings[name] = {"type": "gear", "of": [one, other], "at": draft.point(draft.on, P)}


def belt(draft: Coupled, name: str) -> None:
    P = draft.somewhere()
    Q = P + draft.rng.uniform(0.9, 1.3) * draft.across()
    of = [draft.member(f"{name}{k}", "pin", draft.beside(place), draft.normal()) for k, place in enumerate((P, Q))]
    draft.couplings[name] = {
        "type": "belt", "of": of, "radii": draft.rng.uniform(0.1, 0.4, 2).tolist(), "pretension": 8.0,
        "crossed": bool(draft.rng.random() < 0.4),
    }  # fmt: skip


def ratio(draft: Coupled, name: str) -> None:
    kinds = [("pin", draft.normal()), ("slide", draft.across()), ("pin", draft.normal())]
    some = [kinds[k] for k in draft.rng.permutation(3)[: draft.rng.integers(2, 4)]]
    of = [draft.member(f"{name}{k}", kind, draft.somewhere(), axis) for k, (kind, axis) in enumerate(some)]
    draft.couplings[name] = {"type": "ratio", "of": of, "factors": draft.rng.uniform(0.5, 2.0, len(of)).tolist()}


def differential(draft: Coupled, name: str) -> None:
    of = [draft.member(f"{name}{k}", "pin", draft.somewhere(), draft.normal()) for k in range(3)]
    draft.couplings[name] = {"type": "differential", "of": of, "ratio": float(draft.rng.uniform(-2, -0.5))}


def cam(draft: Coupled, name: str) -> None:
    """A disc and a follower that slides or swings, both sides guided."""
    rng, Q, P = draft.rng, rotation_matrix_about(Z, float(draft.rng.uniform(0, 6))), draft.somewhere()
    slides = bool(rng.random() < 0.5)
    pivot, at = ([0.01, 0, 0], [0.01, 0.1, 0]) if slides else ([-0.3, 0.12, 0], [0.3, 0.02, 0])
    x = np.linspace(0.0, 2.0 * np.pi, 33)
    wave = 0.02 * np.sin(x) + 0.006 * np.cos(2.0 * x)
    lift = wave if slides else 0.1 + 4.0 * wave
    lift[-1] = lift[0]
    draft.tables[f"{name}_lift"] = {"x": x.tolist(), "y": lift.tolist(), "interpolation": "cubic", "period": math.tau}
    disc, follower = f"{name}1", f"{name}2"
    draft.body(disc, P)
    draft.x[follower], draft.psi[follower] = np.zeros(3), 0.0
    draft.body(follower, P)
    g = Q @ [0.1, 1, 0] if slides else Z
    own, foot = draft.axes(follower), P + Q @ pivot
    draft.joints[f"j_{disc}"] = {"type": "pin", "from": draft.point(draft.on, P), "to": draft.point(disc, P),
                                 "axis": (draft.axes(draft.on) @ Z).tolist(),
                                 "to_axis": (draft.axes(disc) @ Z).tolist()}  # fmt: skip
    draft.joints[f"j_{follower}"] = {
        "type": "slide" if slides else "pin", "from": draft.point(draft.on, foot),
        "to": {"body": follower, "at": [0.0, 0.0, 0.0]}, "axis": (draft.axes(draft.on) @ g).tolist(),
        "to_axis": (own @ g).tolist(),
    }  # fmt: skip
    contact = [{"contact": "roller", "radius": 0.02}, {"contact": "point"},
               {"contact": "flat", "normal": (own @ Q @ [0.15, 1, 0]).tolist()}][rng.integers(3)]  # fmt: skip
    for body, key in ((disc, "position"), (disc, "orientation"), (follower, "position"), (follower, "orientation")):
        if not slides or key == "position" or body == disc:
            del draft.bodies[body][key]  # heun puts them in mesh
    draft.couplings[name] = {
        "type": "cam", "of": [f"j_{disc}", f"j_{follower}"], "lift": f"{name}_lift", "two_sided": True,
        "at": {"body": follower, "at": (own @ Q @ at).tolist()}, **contact,
    }  # fmt: skip


def rope(draft: Coupled, name: str) -> None:
    """Over a sheave to what slides in its plane."""
    rng, P, n = draft.rng, draft.somewhere(), draft.normal()
    u = draft.across()
    v = np.cross(n, u)
    draft.welds = 0.0  # a sheave turns in its own pin
    draft.member(f"{name}s", "pin", draft.beside(P), n)
    end = draft.beside(P, 0.1) + rng.uniform(0.3, 0.5) * v - rng.uniform(0.8, 1.5) * u
    draft.member(f"{name}w", "slide", end, u)
    begin = draft.beside(P - rng.uniform(0.3, 0.5) * v - rng.uniform(0.8, 1.5) * u, 0.1)
    sheave = {"sheave": draft.point(f"{name}s", P), "radius": float(rng.uniform(0.1, 0.25)),
              "axis": (draft.axes(f"{name}s") @ n).tolist()}  # fmt: skip
    sheave |= {"slip": "none"} if rng.random() < 0.5 else {}
    draft.couplings[name] = {"type": "rope", "through": [draft.point(draft.on, begin), sheave,
                                                         draft.point(f"{name}w", end)]}  # fmt: skip


def points(draft: Coupled, name: str) -> None:
    """A rope through points of two bodies and the ground, taut."""
    swings = [f"{name}{k}" for k in range(2)]
    for own in swings:
        draft.member(own, "pin", draft.somewhere(), draft.normal())
    way = [draft.point(b, draft.x[b] + 2.0 * draft.somewhere()) for b in draft.rng.permutation([*swings, "ground"])]
    draft.couplings[name] = {"type": "rope", "through": way}


def wheel(draft: Coupled, name: str) -> None:
    """A disc or ball on a road of the ground or the carrier; on an axle of what slides along it, or alone."""
    rng, out = draft.rng, draft.across()
    R, C = float(rng.uniform(0.2, 0.5)), draft.somewhere()
    way = np.cross(Z, out)
    hub = draft.on if draft.upright else "ground"
    if draft.upright:
        draft.member(f"{name}c", "slide", C, way)
        draft.member(name, "pin", C, draft.normal(), f"{name}c")
    else:
        draft.body(name, C)
    entry: Scene = {"shape": "sphere"} if rng.random() < 0.3 else {"axis": (draft.axes(name) @ draft.normal()).tolist()}
    draft.rolling[name] = {
        "wheel": draft.point(name, C), "on": draft.point(hub, draft.beside(C - R * out)), "radius": R, "held": True,
        "normal": (draft.axes(hub) @ out).tolist(), **entry,
    }  # fmt: skip


def curve(draft: Coupled, name: str) -> None:
    """A body on a path of the carrier, or a roller that runs beside one; what it hangs on does not hold it upright."""
    rng, Q = draft.rng, rotation_matrix_about(Z, float(draft.rng.uniform(0, 6)))
    s, P, axes = np.linspace(-3.0, 3.0, 13), draft.somewhere(), draft.axes(draft.on)
    way = axes @ Q @ np.array([s, 0.3 * np.sin(s), 0.0 * s])
    told = "xyz" if way[2].any() else "xy"
    for axis, y in zip(told, way, strict=False):
        draft.tables[f"{name}_{axis}"] = {"x": s.tolist(), "y": y.tolist(), "interpolation": "cubic"}
    beside: Scene = {}
    if rng.random() < 0.5:
        beside = {"radius": float(rng.uniform(0.2, 0.8)), "normal": (axes @ draft.normal()).tolist()}
    draft.body(name, P)
    del draft.bodies[name]["position"]
    draft.joints[f"j_{name}"] = {
        "type": "curve", "from": draft.point(draft.on, P), "to": draft.point(name, P + 0.2 * draft.somewhere()),
        **{axis: f"{name}_{axis}" for axis in told}, **beside,
        "initial": {"travel": float(rng.uniform(-1, 1)), "speed": float(rng.uniform(-1, 1))},
    }  # fmt: skip


ELEMENTS: dict[str, Callable[[Coupled, str], None]] = {
    "gears": gears, "rack": rack, "belt": belt, "ratio": ratio, "differential": differential, "cam": cam, "rope": rope,
    "points": points, "wheel": wheel, "curve": curve,
}  # fmt: skip


def bed(draft: Coupled) -> None:
    """What carries all elements is a body of its own: welded to the carrier, on the ground held by a pin and a rod."""
    draft.body("bed", draft.x[draft.on])
    if draft.on == "ground" and draft.upright:
        draft.joint("foot", "pin", "ground", "bed")
        draft.joint("stay", "rod", "ground", "bed")
    else:
        draft.joint("foot", "weld", draft.on, "bed")
    draft.on, draft.welds = "bed", 0.5


def coupled_flat(seed: int, kinds: tuple[str, ...] = (), how: str = "drawn") -> Scene:
    """A random scene of one or two of ELEMENTS, or these, on a carrier or the ground.

    how: `welded`, with bodies that are one; `declared` planar; or as drawn.
    """
    rng = np.random.default_rng(seed)
    plane = "xy" if how == "declared" else str(rng.choice(list(PLANES)))
    kinds = kinds or tuple(str(kind) for kind in rng.choice(list(ELEMENTS), rng.integers(1, 3), replace=False))
    upright, own_axes = (bool(x < 0.5 and how != "declared") for x in rng.random(2))
    draft = Coupled(rng, PLANES[plane], upright and "curve" not in kinds, own_axes)
    if rng.random() < 0.75 or not draft.upright:
        draft.body("carrier", np.zeros(3))
        hung = str(rng.choice(HUNG[draft.upright] if how != "declared" else ("ball", "free")))
        if hung != "free":
            draft.joint("hang", hung, "ground", "carrier")
        draft.on = "carrier"
    if how == "welded":
        bed(draft)
    for kind in kinds:
        ELEMENTS[kind](draft, kind)
    names = ["ground", *draft.bodies]
    if "carrier" in draft.bodies and draft.joints.get("hang", {}).get("type") != "slide":
        draft.bodies["carrier"] |= {"angular_velocity": (draft.E.T @ Z * float(rng.normal())).tolist()}
    out = Z if draft.upright else 0.0 * Z
    scene = {
        "gravity": acting(draft, 9.81, out).tolist(), "bodies": draft.bodies, "joints": draft.joints,
        "forces": loads(draft, names, plane), "couplings": draft.couplings, "rolling": draft.rolling,
        "tables": draft.tables, "space": "planar" if how == "declared" else "auto",
    }  # fmt: skip
    return {key: value for key, value in scene.items() if value != {}}
