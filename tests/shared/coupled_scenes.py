"""Random scenes with every kind of machine element: carriers that move anyhow, elements on them, loads, a blow.

Where nothing but poses and some rates is drawn, heun assembles the rest; the scene then holds the state that was found,
so that it may be told otherwise.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import Any

import numpy as np

from heuncli.base.errors import HeunError
from heuncli.results.results import Array
from tests.oracle.read import GROUND, Placed, placed, state_at
from tests.oracle.scenes import Maker
from tests.oracle.turns import across, random_rotation, random_unit
from tests.shared.geared_scenes import belt, member, mesh, rubs, thread
from tests.shared.rolling_scenes import stand
from tests.shared.scenes import solved
from tests.shared.trees import cut_through

Scene = dict[str, Any]
TIMES = (0.0, 0.04, 0.08, 0.12)
HUNG = ("pin", "ball", "slide", "universal", "cylinder")
OF_JOINTS = ("gear", "screw", "belt", "ratio", "differential")
STARTS = {"pin": "rate", "slide": "speed"}
LOADS = ("force", "couple", "spring", "damper", "torque", "turn_spring", "bushing", "actuator")


class Parts:
    """A scene that grows by elements; coupled: the joints that are coupled by now."""

    def __init__(self, rng: np.random.Generator) -> None:
        self.rng, self.maker = rng, Maker(rng, "shapes" if rng.random() < 0.4 else "given")
        self.scene, self.coupled = self.maker.scene, set[str]()

    def base(self) -> str:
        """Some carrier, or the ground."""
        carriers = [name for name in self.maker.names if name.startswith("carrier")]
        return str(self.rng.choice([GROUND, *carriers, *carriers]))

    def couple(self, name: str, entry: Scene) -> None:
        """Enter a coupling."""
        self.scene.setdefault("couplings", {})[name] = entry
        self.coupled |= {word.partition(".")[0] for word in entry.get("of", ())}

    def loose(self, kinds: tuple[str, ...]) -> list[str]:
        """Joints of these kinds that nothing couples, in a random order."""
        found = [n for n, j in self.scene["joints"].items() if j["type"] in kinds and n not in self.coupled]
        return [found[k] for k in self.rng.permutation(len(found))]

    def member(self, base: str, name: str, kind: str, point: Array, axis: Array) -> str:
        """A body on a joint; the joint's name."""
        member(self.maker, self.rng, base, name, kind, point, axis)
        return f"j_{name}"

    def sign(self) -> float:
        return math.copysign(1.0, float(self.rng.standard_normal()))


def gears(form: str) -> Callable[[Parts, str], None]:
    """Two wheels, cones, a wheel and a rack, a thread, or pulleys."""

    def add(parts: Parts, name: str) -> None:
        make, names = {"screw": thread, "belt": belt}.get(form, mesh), (f"{name}a", f"{name}b")
        entry = make(parts.maker, parts.rng, parts.base(), form, names)
        if make is mesh and parts.rng.random() < 0.5:
            entry["pressure_angle"] = 0.35
        parts.couple(name, entry)

    return add


def threaded_cylinder(parts: Parts, name: str) -> None:
    joint = parts.member(parts.base(), name, "cylinder", parts.rng.uniform(-1, 1, 3), random_unit(parts.rng))
    lead = float(parts.rng.uniform(-3, 3))
    parts.couple(name, {"type": "screw", "of": [joint], "lead": lead, **rubs(lead)})


def ratio(parts: Parts, name: str) -> None:
    """Of two or three coordinates of the scene."""
    found = parts.loose(("pin", "slide"))
    while len(found) < 2:
        kind = str(parts.rng.choice(["pin", "slide"]))
        own = f"{name}{len(found)}"
        found.append(parts.member(parts.base(), own, kind, parts.rng.uniform(-1, 1, 3), random_unit(parts.rng)))
    of = found[:3]
    factors = [parts.sign() * float(parts.rng.uniform(0.5, 2)) for _ in of]
    parts.couple(name, {"type": "ratio", "of": of, "factors": factors})


def differential(parts: Parts, name: str) -> None:
    of = [
        parts.member(parts.base(), f"{name}{k}", "pin", parts.rng.uniform(-1, 1, 3), random_unit(parts.rng))
        for k in range(3)
    ]
    parts.couple(name, {"type": "differential", "of": of, "ratio": float(parts.rng.uniform(-2, -0.5))})


def rope(parts: Parts, name: str) -> None:
    """Over a sheave to what slides in its plane."""
    rng, base, n, P = parts.rng, parts.base(), random_unit(parts.rng), parts.rng.uniform(-1, 1, 3)
    u, v = across(n)
    R = float(rng.uniform(0.1, 0.3))
    parts.member(base, f"{name}s", "pin", P, n)
    hub = parts.scene["joints"][f"j_{name}s"]
    end = next(hub[k] for k in ("from", "to") if owner(hub[k]) != base)
    S = placed(parts.maker.state, f"{name}s")
    axis = (S.rotation.T @ placed(parts.maker.state, base).rotation @ n).tolist()
    hung = P + rng.uniform(0.2, 0.5) * v - rng.uniform(0.8, 1.5) * u
    parts.member(base, f"{name}w", "slide", hung, u)
    own = parts.maker.state[f"{name}w"]
    top = (own.rotation.T @ (placed(parts.maker.state, base).point(hung) - own.position)).tolist()
    fixed = {"body": base, "at": (P - rng.uniform(0.2, 0.5) * v - rng.uniform(0.8, 1.5) * u).tolist()}
    way = [fixed, {"sheave": end, "radius": R, "axis": axis}, {"body": f"{name}w", "at": top}]
    if rng.random() < 0.5:
        way[1]["slip"] = "none"
    parts.couple(name, {"type": "rope", "through": way if rng.random() < 0.5 else way[::-1]})
    parts.coupled |= {f"j_{name}s", f"j_{name}w"}


def owner(end: Any) -> str:
    """The body of an end."""
    return str(end["body"] if isinstance(end, dict) else end.partition(".")[0])


def rope_through_points(parts: Parts, name: str) -> None:
    bodies = [str(b) for b in parts.rng.permutation([*parts.maker.names, GROUND])[:3]]
    if len(bodies) < 3:
        return
    way = [{"body": b, "at": (2.0 * parts.maker.spot(b)).tolist()} for b in bodies]
    parts.couple(name, {"type": "rope", "through": way})


def constant_velocity(parts: Parts, name: str) -> None:
    parts.maker.body(f"{name}a", ("pin", "universal"), 0.5, 0.3, 0.0)
    parts.maker.body(f"{name}b", ("cv",), 0.0, 0.0, 0.0)


def table_of(function: Callable[[Array], Array], x: Array, **more: Any) -> Scene:
    return {"x": x.tolist(), "y": function(x).tolist(), "interpolation": "cubic", **more}


def cam(parts: Parts, name: str) -> None:
    """A disc and a follower that slides or swings, both sides guided; heun puts them in mesh."""
    rng, base, Q = parts.rng, parts.base(), random_rotation(parts.rng)
    slides = bool(rng.random() < 0.5)
    pivot, at = ([0.01, 0, 0], [0.01, 0.1, 0]) if slides else ([-0.3, 0.12, 0], [0.3, 0.02, 0])
    contact = [{"contact": "roller", "radius": 0.02}, {"contact": "point"},
               {"contact": "flat", "normal": (Q @ [0.15, 1, 0]).tolist()}][rng.integers(3)]  # fmt: skip
    P, x = rng.uniform(-1, 1, 3), np.linspace(0.0, 2.0 * np.pi, 49)
    wave = 0.02 * np.sin(x) + 0.006 * np.cos(2.0 * x)
    lift = wave if slides else 0.1 + 4.0 * wave
    lift[-1] = lift[0]
    parts.scene.setdefault("tables", {})[f"{name}_lift"] = {
        "x": x.tolist(), "y": lift.tolist(), "interpolation": "cubic", "period": 2.0 * math.pi,
    }  # fmt: skip
    own = {"to": {"body": f"{name}d", "at": [0.0, 0.0, 0.0]}, "axis": (Q @ [0, 0, 1]).tolist()}
    start = {"initial": {"angle": float(rng.uniform(0, 6)), "rate": float(rng.uniform(-5, 5))}}
    parts.scene["joints"][f"{name}_shaft"] = {"type": "pin", "from": {"body": base, "at": P.tolist()}, **own, **start}
    parts.scene["joints"][f"{name}_guide"] = {
        "type": "slide" if slides else "pin", "from": {"body": base, "at": (P + Q @ pivot).tolist()},
        "to": {"body": f"{name}f", "at": [0.0, 0.0, 0.0]},
        "axis": (Q @ ([0.1, 1, 0] if slides else [0, 0, 1])).tolist(),
    }  # fmt: skip
    for body in (f"{name}d", f"{name}f"):
        parts.scene["bodies"][body] = {**parts.maker.mass(), "points": {}}
    where = {"body": f"{name}f", "at": (Q @ at).tolist()}
    parts.couple(name, {"type": "cam", "of": [f"{name}_shaft", f"{name}_guide"], "lift": f"{name}_lift", "at": where,
                        "two_sided": True, **contact})  # fmt: skip


def curve(parts: Parts, name: str) -> None:
    """A body on a path of a carrier, or the roller of one beside a path in a plane."""
    rng, base, Q = parts.rng, parts.base(), random_rotation(parts.rng)
    s = np.linspace(-3.0, 3.0, 13)
    beside: Scene = {}
    if rng.random() < 0.5:
        beside = {"radius": float(rng.uniform(0.2, 0.8)), "normal": (2.0 * Q[:, 2]).tolist()}
    way = Q @ np.array([s, 0.3 * np.sin(s), 0.0 * s if beside else 0.2 * np.cos(2.0 * s)])
    tables = parts.scene.setdefault("tables", {})
    for axis, y in zip("xyz", way, strict=True):
        tables[f"{name}_{axis}"] = {"x": s.tolist(), "y": y.tolist(), "interpolation": "cubic"}
    parts.scene["bodies"][name] = {**parts.maker.mass(), "points": {}}
    parts.scene["bodies"][name]["orientation"] = {"matrix": random_rotation(rng).tolist()}
    parts.scene["joints"][f"j_{name}"] = {
        "type": "curve", "from": {"body": base, "at": rng.uniform(-1, 1, 3).tolist()},
        "to": {"body": name, "at": rng.uniform(-0.3, 0.3, 3).tolist()},
        **{axis: f"{name}_{axis}" for axis in "xyz"}, **beside,
        "initial": {"travel": float(rng.uniform(-1, 1)), "speed": float(rng.uniform(-1, 1))},
    }  # fmt: skip


def tracks(parts: Parts, name: str) -> None:
    """The same with another point on a path that is the first's, shifted by less than the points are apart."""
    curve(parts, name)
    del parts.scene["bodies"][name]["orientation"]
    rng, joints = parts.rng, parts.scene["joints"]
    first, apart = joints[f"j_{name}"], float(rng.uniform(0.5, 1.0)) * random_unit(rng)
    shift = float(rng.uniform(0.4, 0.9)) * np.linalg.norm(apart) * random_unit(rng)
    joints[f"j_{name}_2"] = {
        "type": "curve", "from": {**first["from"], "at": (np.array(first["from"]["at"]) + shift).tolist()},
        "to": {**first["to"], "at": (np.array(first["to"]["at"]) + apart).tolist()},
        **{axis: f"{name}_{axis}" for axis in "xyz"},
    }  # fmt: skip


def wheel(parts: Parts, name: str) -> None:
    """One wheel or ball, on a plane of the ground or a carrier; what there is hangs on nothing of it."""
    if "rolling" in parts.scene:
        return
    rng, maker, on = parts.rng, parts.maker, parts.base()
    maker.body("wheel", HUNG, 0.0, 0.0, 1.0)
    entry: Scene = {"shape": "sphere"}
    if rng.random() < 0.7:
        entry = {"axis": random_unit(rng).tolist()} | ({"slides": "along"} if rng.random() < 0.2 else {})
    ends = {"wheel": maker.end("hub", "wheel", maker.spot("wheel")), "on": maker.end("road", on, maker.spot(on))}
    normal, radius = (2.0 * random_unit(rng)).tolist(), float(rng.uniform(0.2, 0.6))
    maker.scene["rolling"] = {name: {**ends, "normal": normal, "radius": radius, "held": True, **entry}}
    stand(maker, rng)


ELEMENTS: dict[str, Callable[[Parts, str], None]] = {
    **{form: gears(form) for form in ("external", "internal", "bevel", "rack", "screw", "belt")},
    "threaded": threaded_cylinder, "ratio": ratio, "differential": differential, "rope": rope,
    "points": rope_through_points, "cv": constant_velocity, "cam": cam, "curve": curve, "wheel": wheel,
    "tracks": tracks,
}  # fmt: skip
LAST = ("cam", "curve", "tracks")  # Maker does not know where these are


def drawn(rng: np.random.Generator, kinds: tuple[str, ...]) -> Parts:
    """Carriers with these elements, loads, a blow and a latch, as poses and some rates."""
    parts = Parts(rng)
    maker = parts.maker
    for k in range(int(rng.integers(1, 3))):
        maker.body(f"carrier{k}", HUNG, 0.3, 1.0 if k == 0 else 0.3, 0.15)
    for k, kind in enumerate(sorted(kinds, key=LAST.__contains__)):
        ELEMENTS[kind](parts, f"{kind}{k}")
    for k in range(int(rng.integers(0, 2))):
        maker.body(f"hung{k}", HUNG, 0.8, 0.0, 0.0)
    maker.loads([kind for kind in LOADS if rng.random() < 0.5], True)
    if (motored := parts.loose(("pin",))) and rng.random() < 0.3:
        parts.scene.setdefault("forces", {})["motor"] = {
            "type": "motor", "joint": motored[0], "curve": "2 - 0.3*rate", "ratio": float(rng.uniform(1, 3)),
        }  # fmt: skip
    if rng.random() < 0.5:
        on = maker.some()
        vector = rng.standard_normal(3).tolist()
        parts.scene["impulses"] = {"blow": {"on": {"body": on, "at": maker.spot(on).tolist()}, "vector": vector,
                                            "time": 0.05}}  # fmt: skip
    of = [entry["of"][0] for entry in parts.scene.get("couplings", {}).values() if entry["type"] in OF_JOINTS]
    kinds_of = {n: j["type"] for n, j in parts.scene["joints"].items()}
    able = [
        n
        for n in [*parts.loose(tuple(STARTS)), *of]
        if kinds_of[n] in STARTS and "initial" not in parts.scene["joints"][n]
    ]
    if able and rng.random() < 0.25:
        parts.scene["latches"] = {"latch": {"joint": able[rng.integers(len(able))], "when": "t > 0.06"}}
    for joint in [able[k] for k in rng.permutation(len(able))[: rng.integers(1, 3)]]:
        parts.scene["joints"][joint]["initial"] = {STARTS[parts.scene["joints"][joint]["type"]]: float(rng.normal())}
    first = parts.scene["bodies"]["carrier0"]
    if "j_carrier0" not in parts.scene["joints"] or parts.scene["joints"]["j_carrier0"]["type"] == "ball":
        first["angular_velocity"] = rng.standard_normal(3).tolist()
    return parts


def coupled_scene(seed: int, kinds: tuple[str, ...] | None = None) -> Scene:
    """A random scene of one to three of ELEMENTS, or these, which holds the state that it starts with."""
    rng = np.random.default_rng(seed)
    for _ in range(50):
        some = tuple(str(kind) for kind in rng.choice(list(ELEMENTS), rng.integers(1, 4), replace=False))
        parts = drawn(rng, kinds or some)
        try:
            return held({**parts.scene, "analysis": {"times": list(TIMES), "tolerance": 1e-10}}, rng)
        except HeunError:
            continue
    raise RuntimeError("no scene found that fits")


def told(v: Array) -> list[float]:
    """A vector without what rounding leaves of nothing."""
    return np.where(np.abs(v) < 1e-15, 0.0, v).tolist()


def held(scene: Scene, rng: np.random.Generator) -> Scene:
    """The scene with the assembled state as what is given. Raises HeunError where it does not fit."""
    analysis = {"type": "state"}
    bare = {k: v for k, v in scene.items() if k not in ("impulses", "latches")}
    state: dict[str, Placed] = state_at(solved({**bare, "analysis": analysis}).bodies, 0)
    bodies = {}
    for name, body in scene["bodies"].items():
        now = state[name]
        bodies[name] = {
            **body, "position": now.position.tolist(), "orientation": {"matrix": now.rotation.tolist()},
            "velocity": told(now.velocity), "angular_velocity": told(now.angular_velocity),
        }  # fmt: skip
    joints = {n: {k: v for k, v in j.items() if k != "initial"} for n, j in scene["joints"].items()}
    cuts = {f"cut_{n}": {"body": n, **cut} for n, b in bodies.items() if (cut := cut_through(b, rng)) is not None}
    return {**scene, "bodies": bodies, "joints": joints, **({"sections": cuts} if cuts else {})}
