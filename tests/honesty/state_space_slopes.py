"""A, B, C, D of state spaces by differences of solved states, also where these move: random trees and loops.

    python -m tests.honesty.state_space_slopes --cases 200 [--seed FIRST] [--save FOLDER]

Each state is told by `initial` values of the chosen coordinates alone, assembled and solved by itself; coordinates,
rates, accelerations and the motion of points are read from its results. Nothing of the linear equations is used.
"""

from __future__ import annotations

import copy
import sys
import time
from collections import Counter
from contextlib import suppress
from typing import Any, NamedTuple

import numpy as np

from heuncli.analyses.lagrange.freed_scene import make_instant
from heuncli.analyses.lagrange.results import StateSpace
from heuncli.analyses.lagrange.study import LagrangeOptions, compute_results
from heuncli.base.errors import SolveError, SpecError
from heuncli.base.joint_kinds import RATES
from heuncli.results.results import Array, Results
from heuncli.scene.file_format.load import load
from tests.oracle.values import to_yaml
from tests.shared.hunts import asked_of
from tests.shared.scenes import solved

H = 2e-3  # [rad], [m], of their rates [1/s], of forces [N]: of differences of the fourth order
FINER = 8.0  # where the scene bends much: the error falls with its fourth power, rounding grows with it
SAME = 1e-6  # of the largest entry of the row
ROUNDING = 64.0 * float(np.finfo(float).eps)  # of the largest value: what an acceleration is summed from
DIRECTIONS = 2  # random ones of states and inputs together: a wrong entry shows in any


class Case(NamedTuple):
    """A scene told by coordinates, which of these are driven, its inputs and outputs."""

    tree: dict[str, Any]
    driven: dict[str, str]  # the coordinate of a drive
    forces: list[str]
    outputs: list[str]


def drawn(seed: int) -> dict[str, Any]:
    """A tree of pins, slides and cylinders, drawn at zero; every other one with rods that close loops."""
    rng = np.random.default_rng([seed, 41])
    planar = bool(rng.integers(2))
    count = int(rng.integers(2, 5))

    def vector(scale: float = 1.0) -> list[float]:
        v = scale * rng.normal(size=3)
        return [*v[:2].tolist(), 0.0 if planar else float(v[2])]

    places = {"ground": np.zeros(3)}
    points: dict[str, dict[str, Any]] = {"ground": {"O": [0, 0, 0]}}
    bodies: dict[str, Any] = {}
    joints: dict[str, Any] = {}
    for k in range(count):
        name, carrier = f"b{k}", str(rng.choice(list(places))) if k else "ground"
        place = np.array(vector(0.7))
        box = rng.uniform(0.3, 0.8, 3)
        inertia = [box[1] ** 2 + box[2] ** 2, box[0] ** 2 + box[2] ** 2, box[0] ** 2 + box[1] ** 2]
        own: dict[str, Any] = {"j": place, "tip": place + vector(0.6), "far": place + vector(0.6)}
        bodies[name] = {"mass": rng.uniform(0.5, 2.0), "center": place + vector(0.3), "inertia": inertia, "points": own}
        points[carrier][f"to_{name}"] = place
        points[name], places[name] = own, place
        kind = str(rng.choice(["pin", "pin", "slide"] if planar else ["pin", "slide", "cylinder"]))
        axis = [0, 0, 1] if planar and kind == "pin" else vector()
        joints[f"j{k}"] = {"type": kind, "from": f"{carrier}.to_{name}", "to": f"{name}.j", "axis": axis}
    for k in range(int(rng.integers(0, 3)) if count > 2 else 0):  # as long as drawn
        a, b = (str(x) for x in rng.permutation(["ground", *bodies])[:2])
        p, q = np.array(vector(1.5)), np.array(vector(1.5))
        points[a][f"p{k}"], points[b][f"q{k}"] = p, q
        joints[f"rod{k}"] = {
            "type": "rod",
            "from": f"{a}.p{k}",
            "to": f"{b}.q{k}",
            "length": float(np.sqrt((q - p) @ (q - p))),
        }
    found = {"ground": {"points": points["ground"]}, "bodies": bodies, "joints": joints, "gravity": vector(5.0)}
    return {**found, "forces": loads(rng, vector, joints), **({"space": "planar"} if planar else {})}


def loads(rng: np.random.Generator, vector: Any, joints: dict[str, Any]) -> dict[str, Any]:
    """Loads of all kinds that have a value, and some that change with the state."""
    last = [name for name in joints if name.startswith("j")]
    found: dict[str, Any] = {
        "world": {"type": "force", "on": "b0.tip", "vector": vector(10.0)},
        "body": {"type": "force", "on": "b1.far", "vector": vector(10.0), "frame": "body"},
        "push": {"type": "actuator", "from": "ground.O", "to": "b1.tip", "value": rng.normal() * 10.0},
        "spring": {
            "type": "spring",
            "from": "ground.O",
            "to": "b0.far",
            "stiffness": 30.0,
            "length": 0.4,
            "damping": 3.0,
        },
    }
    for name in last:
        if joints[name]["type"] != "cylinder":
            found[f"t_{name}"] = {"type": "torque", "joint": name, "value": rng.normal() * 10.0}
        if joints[name]["type"] == "pin" and rng.integers(2):
            own = {"type": "turn_spring", "joint": name, "stiffness": 20.0, "angle": 0.3, "damping": 1.0}
            found[f"s_{name}"] = own
    return found


def values_of(found: Results) -> dict[str, float]:
    """All that may be an output, by its name."""
    values: dict[str, float] = {}
    for joint, own in found.coordinates.items():
        values |= {f"{joint}.{quantity}": float(column[0]) for quantity, column in own.items()}
    for point, own in found.points.items():
        for k, axis in enumerate("xyz"):
            values[f"{point}.{axis}"] = float(own["position"][0][k])
            values[f"{point}.v{axis}"] = float(own["velocity"][0][k])
    return values


def with_motion(scene: dict[str, Any], names: list[str], seed: int) -> tuple[dict[str, Any], dict[str, str]]:
    """The scene with `initial` values of its coordinates, one of them driven in every other; and the drive's."""
    rng = np.random.default_rng([seed, 42])
    tree, driven = copy.deepcopy(scene), {}
    for k, name in enumerate(names):
        joint, _, quantity = name.partition(".")
        value, rate = 0.3 * rng.normal(), float(2.0 * rng.normal())
        if k == 0 and len(names) > 1 and seed % 2 and tree["joints"][joint]["type"] != "cylinder":
            law = f"{value!r} + {rate!r}*t + {rng.normal()!r}*t**2"
            tree["drives"], driven = {"d": {"joint": joint, quantity: law}}, {"d": name}
        else:
            tree["joints"][joint].setdefault("initial", {}).update({quantity: float(value), RATES[quantity]: rate})
    return tree, driven


def moved(case: Case, changes: dict[str, float]) -> Results:
    """The state solved with coordinates, rates (`J.rate`), drives' accelerations (`drive: d`), forces changed."""
    tree = copy.deepcopy(case.tree)
    for name, by in changes.items():
        owner, _, quantity = name.partition(".")
        drive = next((d for d, own in case.driven.items() if own.partition(".")[0] == owner), None)
        if name.startswith("force "):
            add_to_force(tree["forces"][name.removeprefix("force ")], by)
        elif name in case.driven:
            add_to_drive(tree["drives"][name], f"{by!r}*t**2/2")
        elif drive is not None:
            add_to_drive(tree["drives"][drive], f"{by!r}" + ("*t" if quantity in RATES.values() else ""))
        else:
            tree["joints"][owner]["initial"][quantity] += by
    return solved({**tree, "analysis": {"type": "state"}, "report": ["motion", "points"]}, reduce=False)


def add_to_drive(drive: dict[str, Any], term: str) -> None:
    """Add a term to the law of a drive."""
    key = next(key for key in ("angle", "travel") if key in drive)
    drive[key] = f"({drive[key]}) + ({term})"


def add_to_force(force: dict[str, Any], by: float) -> None:
    """Add to the value of a load: along its vector, if it has one."""
    if "vector" in force:
        v = np.array(force["vector"], dtype=float)
        force["vector"] = (v + by * v / np.linalg.norm(v)).tolist()
    else:
        force["value"] = force["value"] + by


def slope(case: Case, changes: dict[str, float], names: list[str], h: float) -> tuple[Array, float]:
    """The derivative of some values along a direction, differences of the fourth order, and what rounding makes of it:
    an acceleration that is 0 is the sum of those that are not.
    """
    at = {}
    for k in (-2, -1, 1, 2):
        values = values_of(moved(case, {name: k * h * by for name, by in changes.items()}))
        at[k] = np.array([values[name] for name in names])
    near, far = at[1] - at[-1], at[2] - at[-2]
    turns = np.array([n.endswith(".angle") for n in names])
    near, far = (np.where(turns, np.angle(np.exp(1j * d)), d) for d in (near, far))
    largest = max(float(np.abs(values).max()) for values in at.values())
    return np.asarray((8.0 * near - far) / (12.0 * h)), 1.5 * ROUNDING * largest / h


def along(case: Case, space: StateSpace, direction: Array, h: float) -> tuple[Array, float, Array]:
    """[accelerations; outputs] along a direction of [states, inputs]: by differences, with their rounding, and by A, B,
    C, D.
    """
    n = len(space.states) // 2
    places = list(space.states[:n])
    wanted = [f"{name.partition('.')[0]}.{acceleration(name, case)}" for name in places] + list(space.outputs)
    inputs = [name.removesuffix(" acceleration") for name in space.inputs]
    of_drive = {own: drive for drive, own in case.driven.items()}
    columns = [*places, *map(rate_name, places), *(of_drive.get(name, f"force {name}") for name in inputs)]
    found, rounding = slope(case, dict(zip(columns, direction.tolist(), strict=True)), wanted, h)
    return found, rounding, np.vstack([np.hstack([space.A[n:], space.B[n:]]), np.hstack([space.C, space.D])])


def acceleration(name: str, case: Case) -> str:
    """What the results call the acceleration of a coordinate: a cylinder has two."""
    joint, _, quantity = name.partition(".")
    both = case.tree["joints"][joint]["type"] == "cylinder" and quantity == "angle"
    return "angular_acceleration" if both else "acceleration"


def rate_name(name: str) -> str:
    """J.rate of J.angle, J.speed of J.travel."""
    joint, _, quantity = name.partition(".")
    return f"{joint}.{RATES[quantity]}"


class Finding(NamedTuple):
    """what: "same", or what is not; ratio: the largest difference over the largest entry of its row."""

    what: str
    ratio: float
    more: str


def judged(seed: int) -> tuple[Finding, dict[str, Any]]:
    """One scene, with some of all that may be an output."""
    rng = np.random.default_rng([seed, 4])
    scene = drawn(seed)
    try:
        spec = load("scene.yaml", to_yaml({**scene, "analysis": {"type": "state"}}))
        names = list(compute_results(spec, make_instant(spec, None, None), LagrangeOptions()).names)
        tree, driven = with_motion(scene, names, seed)
        base = moved(Case(tree, driven, [], []), {})
    except (SolveError, SpecError) as error:
        return Finding("refused", 0.0, str(error)), scene
    forces = [name for name, own in scene["forces"].items() if own["type"] in ("force", "torque", "actuator")]
    inputs = [str(x) for x in rng.permutation(forces)[:2]] + [drive for drive in driven if rng.integers(2)]
    values = values_of(base)
    outputs = [n for n in values if not n.endswith("acceleration")]
    outputs = [str(x) for x in rng.permutation(outputs)[:12]]
    own = [n for n in names if n not in driven.values() and tree["joints"][n.partition(".")[0]]["type"] != "cylinder"]
    outputs += [f"{n.partition('.')[0]}.acceleration" for n in own[:1]]
    return by_differences(Case(tree, driven, forces, outputs), inputs, names, rng), tree


def by_differences(case: Case, inputs: list[str], names: list[str], rng: np.random.Generator) -> Finding:
    """The state space of a scene against differences, again finer where these are too coarse."""
    spec = load("scene.yaml", to_yaml({**case.tree, "analysis": {"type": "state"}}))
    question = LagrangeOptions(
        state_space=True, inputs=tuple(inputs), coordinates=tuple(names), outputs=tuple(case.outputs)
    )
    try:
        space = compute_results(spec, make_instant(spec, None, None), question).state_space
    except (SolveError, SpecError) as error:
        return Finding("refused", 0.0, str(error))
    assert space is not None
    rows = [*space.states[: len(space.states) // 2], *space.outputs]
    worst, more = 0.0, ""
    for _ in range(DIRECTIONS):
        direction = rng.normal(size=len(space.states) + len(space.inputs))
        off = np.full(len(rows), np.inf)
        for h in (H, H / FINER, H / FINER**2):
            with suppress(SolveError):
                found, rounding, right = along(case, space, direction, h)
                size = np.abs(right).max(axis=1, initial=0.0)
                size = np.maximum(size, SAME * size.max())
                off = np.minimum(off, np.maximum(np.abs(found - right @ direction) - rounding, 0.0) / size)
            if off.max() <= SAME:
                break
        if not np.isfinite(off.max()):
            return Finding("refused", 0.0, "the loops do not close beside the state")
        if off.max() > worst:
            worst, more = float(off.max()), rows[int(np.argmax(off))]
    return Finding("same" if worst <= SAME else "differs", worst, more)


def main() -> int:
    """Run the cases; 1 if one is wrong."""
    asked = asked_of("tests.honesty.state_space_slopes", __doc__, ["all"])
    counts: Counter[str] = Counter()
    ratios: list[float] = []
    begun = time.perf_counter()
    for seed in range(asked.seed, asked.seed + asked.cases):
        found, tree = judged(seed)
        counts[found.what] += 1
        if found.what in ("same", "differs"):
            ratios.append(found.ratio)
        if found.what in ("differs", "refused"):
            print(f"{seed}: {found.what} {found.ratio:.3g}: {found.more}", flush=True)
            if asked.save is not None:
                asked.save.mkdir(parents=True, exist_ok=True)
                (asked.save / f"{seed}.yaml").write_text(to_yaml(tree), encoding="utf-8")
    print(f"{asked.cases} scenes from {asked.seed}: {dict(counts)}, {time.perf_counter() - begun:.0f} s")
    print(f"differences of an entry over the largest of its row: {np.quantile(ratios, [0.5, 0.9, 0.99, 1.0])}")
    return int("differs" in counts)


if __name__ == "__main__":
    sys.exit(main())
