"""Published mechanisms (manual/references.md) and redundant scenes (manual/theory.md), as dicts with full starts."""

from __future__ import annotations

import numpy as np

from tests.oracle.turns import Array, about
from tests.shared.published import printed_values

X, Y, Z = np.eye(3)

# ---- A03, Andrews' squeezer: (mass, inertia, centre, points) of each body, IVP Test Set
ANDREWS = {
    "K1": (0.04325, 2.194e-6, (0.00092, 0), {"O": (0, 0), "F": (0.007, 0)}),
    "K2": (0.00365, 4.410e-7, (-0.0115, 0), {"F": (0, 0), "E": (-0.028, 0)}),
    "K3": (0.02373, 5.255e-6, (0.01043, -0.01874), {"B": (0, 0), "E": (0, -0.035), "D": (0.02, -0.018)}),
    "K4": (0.00706, 5.667e-7, (0, -0.00579), {"G": (0, 0), "E": (0, -0.02)}),
    "K5": (0.07050, 1.169e-5, (0.02308, 0.00916), {"A": (0, 0), "G": (0.04, 0)}),
    "K6": (0.00706, 5.667e-7, (0.00579, 0), {"H": (0, 0), "E": (0.02, 0)}),
    "K7": (0.05498, 1.912e-5, (-0.00449, -0.01228), {"A": (0, 0), "H": (0, -0.04)}),
}
ANDREWS_GROUND = {"O": (0, 0), "A": (-0.06934, -0.00227), "B": (-0.03635, 0.03273), "C": (0.014, 0.072)}
ANDREWS_PINS = {  # name: first, second body, point, and which of the second is placed by it
    "O": ("ground", "K1", "O"),
    "F": ("K1", "K2", "F"),
    "B": ("ground", "K3", "B"),
    "A5": ("ground", "K5", "A"),
    "A7": ("ground", "K7", "A"),
    "G": ("K5", "K4", "G"),
    "H": ("K7", "K6", "H"),
    "E2": ("K2", "K3", "E"),
    "E4": ("K4", "K3", "E"),
    "E6": ("K6", "K3", "E"),
}
START = {
    "b": -0.0617138900142764496,
    "Th": 0.0,
    "g": 0.455279819163070380,
    "Ph": 0.222668390165885885,
    "de": 0.487364979543842550,
    "Om": -0.222668390165885885,
    "ep": 1.23054744454982119,
}
PINS = {"b": "O", "Th": "F", "g": "B", "Ph": "G", "de": "A5", "Om": "H", "ep": "A7"}  # whose angles they are


def at_the_end(quantity: str) -> dict[str, float]:
    """Angles, rates or accelerations at 0.03 s, as the IVP test set prints them."""
    printed = printed_values("andrews")
    paths = {name: f"coordinates.{pin}.{quantity}" for name, pin in PINS.items()}
    return {name: printed[path, 0.03] for name, path in paths.items() if (path, 0.03) in printed}


END, END_RATES = at_the_end("angle"), at_the_end("rate")


def andrews_angles(q: dict[str, float]) -> dict[str, float]:
    return {
        "K1": q["b"],
        "K2": q["b"] + q["Th"],
        "K3": q["g"],
        "K4": q["Ph"] + q["de"],
        "K5": q["de"],
        "K6": q["Om"] + q["ep"],
        "K7": q["ep"],
    }


def andrews(q: dict[str, float], rates: dict[str, float]) -> dict:
    flat = {k: np.array([*p, 0.0]) for k, p in ANDREWS_GROUND.items()}
    angles, spins = andrews_angles(q), andrews_angles(rates)
    bodies: dict = {}
    places = {"ground": (np.zeros(3), np.eye(3), np.zeros(3), 0.0)}
    for first, second, point in ANDREWS_PINS.values():
        if second in bodies:
            continue
        x, R, v, spin = places[first]
        p = flat[point] if first == "ground" else np.array([*ANDREWS[first][3][point], 0.0])
        at, speed = x + R @ p, v + spin * np.cross(Z, R @ p)
        turn = about(Z, angles[second])
        mass, inertia, center, points = ANDREWS[second]
        own = turn @ np.array([*points[point], 0.0])
        places[second] = (at - own, turn, speed - spins[second] * np.cross(Z, own), spins[second])
        bodies[second] = {
            "mass": mass,
            "inertia": [inertia] * 3,
            "center": [*center, 0.0],
            "points": {k: [*c, 0.0] for k, c in points.items()},
            "position": list(at - own),
            "orientation": {"matrix": turn.tolist()},
            "velocity": list(places[second][2]),
            "angular_velocity": [0, 0, spins[second]],
        }
    joints = {
        name: {"type": "pin", "axis": [0, 0, 1], "from": f"{a}.{p}", "to": f"{b}.{p}"}
        for name, (a, b, p) in ANDREWS_PINS.items()
    }
    forces = {
        "spring": {"type": "spring", "from": "ground.C", "to": "K3.D", "stiffness": 4530.0, "length": 0.07785},
        "motor": {"type": "torque", "joint": "O", "value": 0.033},
    }
    return {
        "ground": {"points": {k: list(p) for k, p in flat.items()}},
        "bodies": bodies,
        "joints": joints,
        "forces": forces,
    }


# ---- A02, N-four-bar
def windows(n: int, tilt: float, rate: float) -> dict:
    """n windows of unit rods, bars at `tilt` from upright, rolling over to +x."""
    up = np.array([np.sin(tilt), np.cos(tilt), 0.0])
    v = -rate * np.cross(Z, up)
    pin = {"type": "pin", "axis": [0, 0, 1]}

    def bar(along: Array, at: Array, speed: Array, spin: float) -> dict:
        return {
            "shapes": [{"type": "rod", "from": [0, 0, 0], "to": [1, 0, 0], "mass": 1.0}],
            "points": {"root": [0, 0, 0], "end": [1, 0, 0]},
            "position": list(at),
            "velocity": list(speed),
            "orientation": {"matrix": np.column_stack([along, np.cross(Z, along), Z]).tolist()},
            "angular_velocity": [0, 0, spin],
        }

    bodies, joints = {}, {}
    for i in range(n + 1):
        bodies[f"bar{i}"] = bar(up, i * X, np.zeros(3), -rate)
        joints[f"G{i}"] = {**pin, "from": f"bar{i}.root", "to": f"ground.G{i}"}
    for i in range(n):
        bodies[f"coupler{i}"] = bar(X, i * X + up, v, 0.0)
        joints[f"left{i}"] = {**pin, "from": f"bar{i}.end", "to": f"coupler{i}.root"}
        joints[f"right{i}"] = {**pin, "from": f"bar{i + 1}.end", "to": f"coupler{i}.end"}
    points = {f"G{i}": [i, 0, 0] for i in range(n + 1)}
    return {"gravity": [0, -9.81, 0], "ground": {"points": points}, "bodies": bodies, "joints": joints}


# ---- A04, Bricard
BRICARD_POINTS = [(0, 0, 0), (1, 0, 0), (1, -1, 0), (1, -1, 1), (0, -1, 1), (0, 0, 1)]
BRICARD_AXES = [Y, Z, X, Y, Z, X]


def bricard() -> dict:
    """Five bars, drawn in the world's axes, each hinged to the next; the last hinge is from the ground, as printed."""
    P = np.array(BRICARD_POINTS, dtype=float)
    bodies, joints = {}, {}
    for k in range(5):
        along = P[k + 1] - P[k]
        inertia = 1.01 / 12 * np.eye(3) + (1 / 600 - 1.01 / 12) * np.outer(along, along)
        bodies[f"rod{k + 1}"] = {"mass": 1.0, "center": list((P[k] + P[k + 1]) / 2), "inertia": inertia.tolist()}
    owners = ["ground", *bodies, "ground"]
    for k in range(6):
        a, b = (owners[k], owners[k + 1]) if k < 5 else (owners[6], owners[5])
        joints[f"P{k}"] = {
            "type": "pin",
            "axis": list(BRICARD_AXES[k]),
            "from": {"body": a, "at": list(P[k])},
            "to": {"body": b, "at": list(P[k])},
        }
    return {"gravity": [0, -9.81, 0], "bodies": bodies, "joints": joints}


# ---- manual/theory.md, "Redundancy"
BRICK = {"mass": 5.0, "center": [0, 0, 0], "inertia": [0.3, 0.5, 0.2]}


def held(points: dict, kind: dict, body: dict | None = None, **more: object) -> dict:
    """One body on joints of one kind to the ground, at the body's points in the world's axes."""
    body = {**BRICK, **(body or {}), "points": points}
    at = np.array(body.get("position", [0, 0, 0]))
    return {
        "gravity": [0, 0, -9.81],
        "bodies": {"body": body},
        **more,
        "joints": {
            name: {**kind, "from": {"body": "ground", "at": list(at + np.array(p))}, "to": f"body.{name}"}
            for name, p in points.items()
        },
    }


def four_bar(phi: float, theta: float, psi: float, lengths: tuple[float, ...], rates: tuple[float, ...]) -> dict:
    """Crank, coupler and rocker between parallel hinges A, B, C, D along z; attitudes φ, θ, ψ and their rates."""
    crank, coupler, rocker, base = lengths
    B = crank * np.array([np.cos(phi), np.sin(phi), 0])

    def bar(length: float, angle: float, at: np.ndarray, rate: float, v: np.ndarray) -> dict:
        return {
            "mass": length,
            "center": [length / 2, 0, 0],
            "inertia": [0.01, length**3 / 12, length**3 / 12],
            "points": {"root": [0, 0, 0], "end": [length, 0, 0]},
            "position": list(at),
            "velocity": list(v),
            "orientation": {"matrix": about(Z, angle).tolist()},
            "angular_velocity": [0, 0, rate],
        }

    pin = {"type": "pin", "axis": [0, 0, 1]}
    zero = np.zeros(3)
    return {
        "gravity": [0, -9.81, 0],
        "ground": {"points": {"A": [0, 0, 0], "D": [base, 0, 0]}},
        "bodies": {
            "crank": bar(crank, phi, zero, rates[0], zero),
            "coupler": bar(coupler, theta, B, rates[1], rates[0] * np.cross(Z, B)),
            "rocker": bar(rocker, psi, base * np.array([1.0, 0, 0]), rates[2], zero),
        },
        "joints": {
            "A": {**pin, "from": "ground.A", "to": "crank.root"},
            "B": {**pin, "from": "crank.end", "to": "coupler.root"},
            "C": {**pin, "from": "coupler.end", "to": "rocker.end"},
            "D": {**pin, "from": "ground.D", "to": "rocker.root"},
        },
    }


def beam() -> dict:
    points = {"a": [0, 0, 0], "b": [1, 0, 0], "c": [3, 0, 0]}
    s = held(points, {"type": "plane", "normal": [0, 0, 1]}, {"center": [1.5, 0, 0]})
    s["bodies"]["body"]["points"]["load"] = [1.2, 0, 0]
    load = {"type": "force", "on": "body.load", "vector": [0, 0, -10.0]}
    return {**s, "gravity": [0, 0, 0], "forces": {"load": load}}
