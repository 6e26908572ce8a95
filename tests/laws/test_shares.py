"""Laws of loads by their causes: they add up, stand for runs with one cause each, and scale as their causes do."""

from __future__ import annotations

from collections.abc import Iterator
from functools import cache
from typing import Any

import numpy as np
import pytest

import heuncli
from heuncli.results.results import Results
from tests.oracle.read import state_at
from tests.oracle.turns import Array
from tests.oracle.values import Harmonic
from tests.shared.folders import SPECS
from tests.shared.loops import loop_scene
from tests.shared.redundant_supports import door
from tests.shared.scenes import moving, near, solved
from tests.shared.trees import cut_through, tree_scene

WANTED = frozenset({"motion", "foundation", "joints", "sections", "forces", "shares"})
ROUNDING = 1e-12  # of the largest share
SEEDS = [*(("tree", n) for n in range(3, 11)), *(("loop", n) for n in [*range(2, 8), *range(1000, 1006)])]
CASES = [("tree", 1), *(pytest.param(*case, marks=pytest.mark.heavy) for case in SEEDS)]


@cache
def scene_of(kind: str, seed: int) -> dict[str, Any]:
    """A random scene at one instant, cut through every body that has shapes."""
    made, _ = loop_scene(seed) if kind == "loop" else tree_scene(seed, masses="shapes")
    rng = np.random.default_rng(seed)
    cuts = {f"cut_{name}": cut_through(body, rng) for name, body in made["bodies"].items()}
    sections = {f"cut_{name}": {"body": name, **cuts[f"cut_{name}"]} for name in made["bodies"] if cuts[f"cut_{name}"]}
    return {**made, "sections": sections, "analysis": {"type": "state"}}


@cache
def run(kind: str, seed: int) -> Results:
    """Its results by cause."""
    return solved(scene_of(kind, seed), requested_reports=WANTED)


def blocks(found: Results) -> Iterator[tuple[str, dict[str, Any]]]:
    """Every block that has shares."""
    yield "foundation", found.foundation
    for kind in ("supports", "elements"):
        yield from ((f"{kind} {name}", block) for name, block in found.foundation.get(kind, {}).items())
    yield from ((f"joint {name}", block) for name, block in found.joints.items())
    yield from ((f"section {name}", block) for name, block in found.sections.items())


def size_of(found: Results) -> tuple[float, float]:
    """The largest force and the largest moment of any share."""
    sizes = [1.0, 1.0]
    for _, block in blocks(found):
        for share in block["shares"].values():
            for i, name in enumerate(("force", "moment")):
                sizes[i] = max(sizes[i], float(np.nan_to_num(np.abs(share[name])).max(initial=0.0)))
    return sizes[0], max(sizes)


@pytest.mark.parametrize(("kind", "seed"), CASES)
@pytest.mark.third
def test_shares_add_up(kind: str, seed: int) -> None:
    """All that is told of a wrench by cause, its resultants, drives and tensions too; what is open is open in each."""
    found = run(kind, seed)
    F, M = size_of(found)
    causes = ["gravity", *scene_of(kind, seed).get("forces", {}), "drives", "motion"]
    for name, block in blocks(found):
        assert list(block["shares"]) == causes
        for quantity in block["shares"]["motion"]:
            total = sum(share[quantity] for share in block["shares"].values())
            assert np.array_equal(np.isnan(total), np.isnan(block[quantity])), (name, quantity)
            near(np.nan_to_num(total), np.nan_to_num(block[quantity]), max(F, M), ROUNDING)


def still(scene: dict[str, Any]) -> dict[str, Any]:
    """The scene at rest, without weight and loads, its drives held."""
    moving = ("velocity", "angular_velocity")
    bodies = {name: {k: v for k, v in body.items() if k not in moving} for name, body in scene["bodies"].items()}
    drives = {
        name: {k: entry_of(v, 0.0, 0.0) if isinstance(v, tuple) else v for k, v in drive.items()}
        for name, drive in scene.get("drives", {}).items()
    }
    return {k: v for k, v in {**scene, "bodies": bodies, "drives": drives, "gravity": [0.0, 0.0, 0.0],
                              "forces": {}}.items() if v != {} or k == "bodies"}  # fmt: skip


def entry_of(drive: tuple[Any, ...], rate: float, second: float) -> tuple[Any, ...]:
    """A drive with the same value at the start, and some share of its rate and of its acceleration."""
    value, u, udot = (f(0.0) for f in drive)
    # a sin whose curvature at its top is the acceleration
    return Harmonic(value + second * udot, rate * u, -second * udot, 1.0, np.pi / 2).drive()


def alone(scene: dict[str, Any], found: Results, cause: str) -> dict[str, Any] | None:
    """The scene with this cause alone, as a spec of its own; None for a load that no scene at rest can have."""
    if cause == "gravity":
        return {**still(scene), "gravity": scene["gravity"]}
    if cause in ("drives", "motion"):
        second, rate = float(cause == "drives"), float(cause == "motion")
        own = scene if cause == "motion" else still(scene)
        drives = {
            name: {k: entry_of(v, rate, second) if isinstance(v, tuple) else v for k, v in drive.items()}
            for name, drive in scene.get("drives", {}).items()
        }
        bare = {k: v for k, v in own.items() if k not in ("forces", "drives")}
        return {**bare, "gravity": [0.0, 0.0, 0.0], **({"drives": drives} if drives else {})}
    spec, value = scene["forces"][cause], float(found.forces[cause]["value"][0])
    if spec["type"] == "spring":
        spec = {"type": "actuator", "from": spec["from"], "to": spec["to"], "value": value}
    if spec["type"] in ("damper", "friction"):
        if scene["joints"][spec["joint"]]["type"] not in ("pin", "slide"):
            return None
        spec = {"type": "torque", "joint": spec["joint"], "value": value}
    return {**still(scene), "forces": {cause: spec}}


@pytest.mark.parametrize(("kind", "seed"), CASES)
@pytest.mark.third
def test_a_share_is_what_its_cause_does_alone(kind: str, seed: int) -> None:
    """Another run, of a scene at rest without weight and with this load only, and so on."""
    scene, found = scene_of(kind, seed), run(kind, seed)
    F, M = size_of(found)
    for cause in ["gravity", *scene.get("forces", {}), "drives", "motion"]:
        own = alone(scene, found, cause)
        if own is None:
            continue
        only = dict(blocks(solved(own, requested_reports=WANTED)))
        for name, block in blocks(found):
            for quantity in ("force", "moment"):
                share = np.nan_to_num(block["shares"][cause][quantity])
                told = np.nan_to_num(only[name][quantity]) if name in only else 0.0 * share
                near(share, told, max(F, M), ROUNDING)


@pytest.mark.parametrize(("kind", "seed"), CASES)
@pytest.mark.third
def test_the_share_of_motion_grows_with_the_square_of_the_speed(kind: str, seed: int) -> None:
    scene, found = scene_of(kind, seed), run(kind, seed)
    state = state_at(found.bodies, 0)
    bodies = {
        name: {**body, "velocity": (3.0 * state[name].velocity).tolist(),
               "angular_velocity": (3.0 * state[name].angular_velocity).tolist()}
        for name, body in scene["bodies"].items()
    }  # fmt: skip
    drives = {
        name: {k: entry_of(v, 3.0, 1.0) if isinstance(v, tuple) else v for k, v in drive.items()}
        for name, drive in scene.get("drives", {}).items()
    }
    faster = solved({**scene, "bodies": bodies, **({"drives": drives} if drives else {})}, requested_reports=WANTED)
    F, M = size_of(faster)
    for (_, block), (_, other) in zip(blocks(found), blocks(faster), strict=True):
        for quantity in ("force", "moment"):
            for cause, factor in (("motion", 9.0), ("gravity", 1.0), ("drives", 1.0)):
                own, its = (np.nan_to_num(b["shares"][cause][quantity]) for b in (block, other))
                near(factor * own, its, max(F, M), ROUNDING)


def test_a_force_off_the_piece_acts_through_the_acceleration_it_causes() -> None:
    """-m' x.., of a free body: the piece itself feels nothing of it."""
    rng = np.random.default_rng(5)
    body = {
        "shapes": [{"type": "box", "center": [0.1, 0.2, -0.1], "size": [2.0, 1.0, 0.6], "density": 1.0}],
        "points": {"far": [-0.8, 0.3, 0.1], "near": [0.9, 0.1, -0.2]},
        "angular_velocity": rng.standard_normal(3).tolist(),
    }
    forces = {name: {"type": "force", "on": f"box.{name}", "vector": rng.standard_normal(3).tolist()}
              for name in ("far", "near")}  # fmt: skip
    scene = {"gravity": [0.3, -2.0, 1.0], "ground": {"points": {"O": [0, 0, 0]}}, "bodies": {"box": body},
             "forces": forces,
             "sections": {"cut": {"body": "box", "at": [0.5, 0, 0], "normal": [1, 0, 0]}}}  # fmt: skip
    found = solved(scene, requested_reports=WANTED)
    m, A = 1.2, np.diag([1.0 + 0.36, 4.0 + 0.36, 4.0 + 1.0]) * 1.2 / 12
    piece, centre, middle = 0.6 * 1.0 * 0.6, np.array([0.8, 0.2, -0.1]), np.array([0.1, 0.2, -0.1])
    for name, told in forces.items():
        force = np.array(told["vector"])
        alpha = np.linalg.solve(A, np.cross(np.array(body["points"][name]) - middle, force))
        inertia = -piece * (force / m + np.cross(alpha, centre - middle))
        share = found.sections["cut"]["shares"][name]
        near(share["direct_force"][0], force if name == "near" else 0.0 * force, 1.0, ROUNDING)
        near(share["force"][0], share["direct_force"][0] + inertia, 1.0, ROUNDING)
    weight = found.sections["cut"]["shares"]["gravity"]
    near(weight["direct_force"][0], piece * np.array(scene["gravity"]), 1.0, ROUNDING)
    near(weight["force"][0], 0.0, 1.0, ROUNDING)  # the piece falls with the body
    near(weight["moment"][0], 0.0, 1.0, ROUNDING)


def fixed_point(seed: int) -> tuple[Results, dict[str, Array]]:
    """A box about a fixed point with two forces, and its data in body axes, which are the world's at this instant."""
    rng = np.random.default_rng(seed)
    sigma, g, on, off = rng.standard_normal((4, 3))
    scene = {
        "gravity": g.tolist(), "ground": {"points": {"O": [0, 0, 0]}},
        "bodies": {"box": {
            "shapes": [{"type": "box", "center": [1.0, 0.1, -0.05], "size": [2.0, 1.0, 0.6], "density": 1.0}],
            "points": {"face": [0, 0, 0], "on": [1.5, 0.2, 0.1], "off": [0.3, -0.3, 0.1]},
            "angular_velocity": sigma.tolist(),
        }},
        "joints": {"pivot": {"type": "ball", "from": "ground.O", "to": "box.face"}},
        "forces": {name: {"type": "force", "on": f"box.{name}", "vector": f.tolist()}
                   for name, f in (("on", on), ("off", off))},
        "sections": {"cut": {"body": "box", "at": [0.7, 0, 0], "normal": [1, 0, 0], "reduce_to": "ground.O"}},
    }  # fmt: skip
    return solved(scene, requested_reports=WANTED), {"sigma": sigma, "g": g, "on": on, "off": off}


def about_origin(low: Array, high: Array) -> tuple[float, Array, Array]:
    """Mass, centre, and inertia about the origin of a box of density 1 between two corners."""
    size, centre = high - low, 0.5 * (low + high)
    m = float(np.prod(size))
    T = np.diag(m * size**2 / 12) + m * np.outer(centre, centre)
    return m, centre, np.trace(T) * np.eye(3) - T


@pytest.mark.parametrize("seed", range(4))
def test_u_w_of_59_and_P_Q_of_61(seed: int) -> None:
    """Heun's explicit shares of a body about a fixed point: (59) and (61), any axes.

    s' = k' + m'u + m'w, u = a* x J^-1 M_k, w = -[sigma._w x a* + sigma x (sigma x a*)];
    M' = P + Q, P = M'_k - J' J^-1 M_k, Q = J' J^-1 (sigma x J sigma) - sigma x J' sigma, about the fixed point.
    """
    found, data = fixed_point(seed)
    low, high = np.array([0.0, -0.4, -0.35]), np.array([2.0, 0.6, 0.25])
    m, centre, J = about_origin(low, high)
    m_piece, a, J_piece = about_origin(np.array([0.7, *low[1:]]), high)
    sigma = data["sigma"]
    shares = found.sections["cut"]["shares"]
    points = {"on": np.array([1.5, 0.2, 0.1]), "off": np.array([0.3, -0.3, 0.1])}
    loads = {"gravity": (m * data["g"], np.cross(centre, m * data["g"]), m_piece * data["g"],
                         np.cross(a, m_piece * data["g"]))}  # fmt: skip
    for name, x in points.items():
        F, M = data[name], np.cross(x, data[name])
        loads[name] = (F, M, F if name == "on" else 0.0 * F, M if name == "on" else 0.0 * M)
    for name, (_, M_k, k_piece, M_k_piece) in loads.items():
        u = np.cross(a, np.linalg.solve(J, M_k))
        near(shares[name]["force"][0], k_piece + m_piece * u, 10.0, ROUNDING)
        near(shares[name]["direct_force"][0], k_piece, 10.0, ROUNDING)
        P = M_k_piece - J_piece @ np.linalg.solve(J, M_k)
        near(shares[name]["moment"][0], P, 10.0, ROUNDING)
        near(shares[name]["direct_moment"][0], M_k_piece, 10.0, ROUNDING)
    turning = -np.linalg.solve(J, np.cross(sigma, J @ sigma))
    w = -(np.cross(turning, a) + np.cross(sigma, np.cross(sigma, a)))
    near(shares["motion"]["force"][0], m_piece * w, 10.0, ROUNDING)
    Q = -J_piece @ turning - np.cross(sigma, J_piece @ sigma)
    near(shares["motion"]["moment"][0], Q, 10.0, ROUNDING)
    assert not shares["drives"]["force"].any()


def test_the_door_is_open_along_its_hinges_in_every_share() -> None:
    """Its weight turns it against the hinges, its motion pulls at them; how they share the weight is open."""
    found = solved(door(), requested_reports=WANTED)
    for name, sign in (("top", -1.0), ("bottom", 1.0)):
        shares = found.joints[name]["shares"]
        assert np.isnan(shares["gravity"]["force"][0, 2]) and np.isnan(shares["motion"]["force"][0, 2])
        near(shares["gravity"]["force"][0, 0], sign * 5 * 9.81 * 0.4 / 1.6, 10.0, ROUNDING)
    near(found.foundation["shares"]["gravity"]["force"][0], (0.0, 0.0, -5 * 9.81), 10.0, ROUNDING)
    near(found.foundation["shares"]["motion"]["force"][0], (5 * 0.4 * 2.3**2, 0.0, 0.0), 10.0, ROUNDING)
    scene = door()
    scene["joints"]["top"]["stiffness"], scene["joints"]["bottom"]["stiffness"] = 3e8, 1e8
    split = solved(scene, requested_reports=WANTED)
    near(split.joints["top"]["shares"]["gravity"]["force"][0, 2], 0.75 * 49.05, 10.0, ROUNDING)
    near(split.joints["top"]["shares"]["motion"]["force"][0, 2], 0.0, 10.0, ROUNDING)


# Impulses

STRUCK = frozenset({"impulses", "shares"})


@cache
def struck(kind: str, seed: int) -> dict[str, Any]:
    """A random scene, cut, of which several blows are asked at once."""
    scene = {k: v for k, v in scene_of(kind, seed).items() if k != "forces"}
    rng = np.random.default_rng(seed)
    blows = {
        f"blow{n}": {"on": {"body": str(rng.choice(list(scene["bodies"]))), "at": rng.uniform(-1, 1, 3).tolist()},
                     "vector": rng.standard_normal(3).tolist(), "frame": ("world", "body")[n % 2]}
        for n in range(3)
    }  # fmt: skip
    return {**scene, "impulses": blows, "analysis": {"type": "impulse"}}


def blocks_of_blow(block: dict[str, Any]) -> Iterator[tuple[str, dict[str, Any]]]:
    """Every wrench of a blow that has shares."""
    yield "foundation", block["foundation"]
    for kind, parts in (("support", block["foundation"].get("supports", {})), ("joint", block["joints"]),
                        ("section", block.get("sections", {}))):  # fmt: skip
        yield from ((f"{kind} {name}", part) for name, part in parts.items())


@pytest.mark.parametrize(("kind", "seed"), CASES)
@pytest.mark.third
def test_a_blow_s_share_is_what_it_does_alone(kind: str, seed: int) -> None:
    """Of several at one instant; together they are the whole."""
    scene = struck(kind, seed)
    (whole,) = solved(scene, requested_reports=STRUCK).impulses
    apart = {
        name: solved({**scene, "impulses": {name: blow}}, requested_reports=STRUCK).impulses[0]
        for name, blow in scene["impulses"].items()
    }
    own = {name: dict(blocks_of_blow(block)) for name, block in apart.items()}
    for name, block in blocks_of_blow(whole):
        assert list(block["shares"]) == list(scene["impulses"])
        size = max(1.0, *(float(np.nan_to_num(np.abs(s[q])).max()) for s in block["shares"].values()
                          for q in ("force", "moment")))  # fmt: skip
        for quantity in ("force", "moment"):
            total = sum(share[quantity] for share in block["shares"].values())
            assert np.array_equal(np.isnan(total), np.isnan(block[quantity]))
            near(np.nan_to_num(total), np.nan_to_num(block[quantity]), size, ROUNDING)
            for blow, share in block["shares"].items():
                near(np.nan_to_num(share[quantity]), np.nan_to_num(own[blow][name][quantity]), size, ROUNDING)
        for blow, told in scene["impulses"].items():
            if name == "foundation" and told["frame"] == "world":
                near(block["shares"][blow]["direct_force"], told["vector"], 1.0, ROUNDING)


def test_a_drive_whose_rate_jumps_is_a_cause_of_its_own() -> None:
    """A rod of mass m and length L about its end: the drive's kink gives m L/2 times its jump, the blow its rest.

    Against the driven rod a blow does nothing but push the pin and the drive: all of it is direct.
    """
    m, L, jump, hit = 3.0, 0.8, 2.0, 0.5
    scene = {
        "ground": {"points": {"O": [0, 0, 0]}},
        "bodies": {"rod": {"shapes": [{"type": "rod", "from": [0, 0, 0], "to": [L, 0, 0], "mass": m}],
                           "points": {"end": [0, 0, 0], "at": [L / 3, 0, 0]}}},
        "joints": {"pin": {"type": "pin", "from": "ground.O", "to": "rod.end", "axis": [0, 0, 1]}},
        "drives": {"motor": {"joint": "pin", "angle": f"{jump}*max(t - 0.1, 0)"}},
        "impulses": {"blow": {"on": "rod.at", "vector": [0, hit, 0], "time": 0.1}},
        "analysis": {"duration": 0.2, "samples": 3},
    }  # fmt: skip
    (block,) = solved(scene, requested_reports=STRUCK).impulses
    shares = block["joints"]["pin"]["shares"]
    assert list(shares) == ["blow", "drives"]
    near(shares["drives"]["force"], (0.0, m * L / 2 * jump, 0.0), 1.0, ROUNDING)
    near(shares["drives"]["drive"], m * L**2 / 3 * jump, 1.0, ROUNDING)
    near(shares["blow"]["force"], (0.0, -hit, 0.0), 1.0, ROUNDING)
    near(shares["blow"]["drive"], -hit * L / 3, 1.0, ROUNDING)
    ground = block["foundation"]["shares"]
    near(ground["blow"]["force"], ground["blow"]["direct_force"], 1.0, ROUNDING)
    assert "direct_force" not in ground["drives"]


# Stops


def resting(analysis: dict[str, Any]) -> Results:
    """A rod on a stop, level, held up a little by a force; from its end hangs a bob that swings, wL against the rod."""
    scene = {
        "gravity": [0, 0, -9.81], "ground": {"points": {"O": [0, 0, 0]}},
        "bodies": {
            "rod": {"shapes": [{"type": "rod", "from": [0, 0, 0], "to": [1, 0, 0], "mass": 2.5}],
                    "points": {"p": [0, 0, 0], "q": [1, 0, 0], "m": [0.3, 0, 0]}},
            "bob": {"shapes": [{"type": "sphere", "center": [0, 0, -0.5], "radius": 0.05, "mass": 1.5}],
                    "points": {"p": [0, 0, 0]}, "position": [1, 0, 0], "angular_velocity": [0, 3, 0]},
        },
        "joints": {"A": {"type": "pin", "from": "ground.O", "to": "rod.p", "axis": [0, 1, 0]},
                   "B": {"type": "pin", "from": "rod.q", "to": "bob.p", "axis": [0, 1, 0]}},
        "stops": {"rest": {"joint": "A", "angle": [None, 0]}},
        "forces": {"push": {"type": "force", "on": "rod.m", "vector": [0, 0, 5]}},
        "sections": {"cut": {"body": "rod", "at": [0.5, 0, 0], "normal": [1, 0, 0]}},
        "analysis": analysis,
    }  # fmt: skip
    return solved(scene, requested_reports=WANTED)


def test_what_rests_on_a_stop_is_held_by_it_in_every_share() -> None:
    """The stop carries the moment of the weights, less the force's, and the bob's m w^2 L on its lever."""
    found = resting({"type": "state"})
    shares = found.foundation["elements"]["rest"]["shares"]
    for cause, moment in (("gravity", 9.81 * (2.5 * 0.5 + 1.5)), ("push", -5 * 0.3), ("motion", 1.5 * 9 * 0.5)):
        near(shares[cause]["moment"][0], (0.0, moment, 0.0), 10.0, ROUNDING)
    pull = {"gravity": 9.81 * (2.5 * 0.5 + 1.5), "push": 0.0, "motion": 1.5 * 9 * 0.5}
    for cause, force in pull.items():  # the rod does not move: half of it and the bob hang on the cut
        near(found.sections["cut"]["shares"][cause]["force"][0], (0.0, 0.0, -force), 10.0, ROUNDING)


def test_shares_add_up_while_a_stop_holds_and_lets_go() -> None:
    found = resting({"duration": 1.0, "samples": 21})
    F, M = size_of(found)
    for _, block in blocks(found):
        for quantity in ("force", "moment"):
            total = sum(share[quantity] for share in block["shares"].values())
            near(total, block[quantity], max(F, M), ROUNDING)


def test_what_bears_in_a_blow_is_a_cause_by_its_name() -> None:
    """A rod held by the stop of its pin is struck at x: nothing moves, the pin gets H, the stop the moment H x.

    Without the stop the blow alone would turn it: the pin would get H (1 - 3 x/(2 L)). The rest is the stop's doing.
    """
    L, x, H = 1.0, 0.25, 2.0
    scene = {
        "ground": {"points": {"O": [0, 0, 0]}},
        "bodies": {"rod": {"shapes": [{"type": "rod", "from": [0, 0, 0], "to": [L, 0, 0], "mass": 2.0}],
                           "points": {"p": [0, 0, 0], "x": [x, 0, 0]}}},
        "joints": {"A": {"type": "pin", "from": "ground.O", "to": "rod.p", "axis": [0, 1, 0]}},
        "stops": {"rest": {"joint": "A", "angle": [None, 0]}},
        "impulses": {"down": {"on": "rod.x", "vector": [0, 0, -H]}},
        "analysis": {"type": "impulse"},
    }  # fmt: skip
    (block,) = solved(scene, requested_reports=STRUCK).impulses
    assert list(block["joints"]["A"]["shares"]) == ["down", "rest"]
    near(block["joints"]["A"]["force"], (0.0, 0.0, H), 1.0, ROUNDING)  # nothing moves: the stop's is a moment
    near(block["joints"]["A"]["shares"]["down"]["force"], (0.0, 0.0, H * (1.0 - 1.5 * x / L)), 1.0, ROUNDING)
    near(block["joints"]["A"]["shares"]["rest"]["force"], (0.0, 0.0, H * 1.5 * x / L), 1.0, ROUNDING)
    ground = block["foundation"]["elements"]["rest"]["shares"]
    near(ground["rest"]["moment"], (0.0, H * x, 0.0), 1.0, ROUNDING)
    near(ground["down"]["moment"], 0.0, 1.0, ROUNDING)


def test_a_load_of_nothing_is_a_cause_of_nothing() -> None:
    """Beside others, in a body that is cut."""
    scene = {
        "gravity": [0.0, 0.0, -9.81],
        "ground": {"points": {"O": [0.0, 0.0, 0.0]}},
        "bodies": {"bar": {"shapes": [{"type": "rod", "from": [0, 0, 0], "to": [1, 0, 0], "mass": 1}],
                           "points": {"a": [0, 0, 0], "b": [1, 0, 0]}}},
        "joints": {"A": {"type": "weld", "from": "ground.O", "to": "bar.a"}},
        "forces": {"none": {"type": "force", "on": "bar.b", "vector": [0, 0, 0]}},
        "sections": {"middle": {"body": "bar", "at": [0.5, 0, 0], "normal": [1, 0, 0]}},
    }  # fmt: skip
    own = solved(scene, requested_reports=WANTED).sections["middle"]["shares"]
    assert own["gravity"]["N"].tolist() == [0.0]
    assert own["gravity"]["Q2"] == pytest.approx([-4.905])
    assert not own["none"]["direct_force"].any() and not own["none"]["force"].any()


def test_a_strike_leaves_no_share_to_drives_that_are_not() -> None:
    """What a stop holds behind a strike is of the weights and the motion: nothing is driven there."""
    scene = {
        "gravity": [0, 0, -9.81],
        "ground": {"points": {"O": [0, 0, 0]}},
        "bodies": {
            "arm": {"mass": 1, "center": [0.3, 0, 0], "inertia": [0.01, 0.02, 0.03],
                    "points": {"p": [0, 0, 0], "e": [0.5, 0, 0]}},
            "block": {"mass": 1, "center": [0.1, 0, 0.1], "inertia": [0.02, 0.03, 0.03], "points": {"p": [0, 0, 0]}},
        },
        "joints": {
            "pin": {"type": "pin", "from": "ground.O", "to": "arm.p", "axis": [0, 1, 0],
                    "initial": {"angle": 0.2, "rate": 6}},
            "guide": {"type": "slide", "from": "arm.e", "to": "block.p", "axis": [1, 0, 0.3],
                      "initial": {"travel": 0.05, "speed": 1}},
        },
        "stops": {"end": {"joint": "guide", "travel": [None, 0.1]}},
    }  # fmt: skip
    found = solved(moving(scene, [0.0, 0.1, 0.2]), requested_reports=WANTED)
    assert found.stops["end"]["force"][-1] < 0.0
    shares = found.foundation["shares"]
    assert not shares["drives"]["force"].any()
    near(sum(share["force"] for share in shares.values()), found.foundation["force"], 100.0)


@pytest.mark.heavy
@pytest.mark.parametrize("name", ["belt_drive", "screw_press"])
def test_shares_of_couplings_add_up(name: str) -> None:
    found = solved((SPECS / f"{name}.yaml").read_text(encoding="utf-8"), requested_reports=WANTED | {"couplings"})
    for coupling in found.couplings.values():
        parts = [share["force"] for share in coupling["shares"].values()]
        largest = np.max(np.abs(parts))
        assert largest > 1.0
        np.testing.assert_allclose(np.sum(parts, axis=0), coupling["force"], rtol=0, atol=1e-9 * largest)


def test_shares_of_a_rope_s_tensions_are_told() -> None:
    """Over a heavy sheave that holds it: M g (1 - (M - m)/(M + m + J/R^2)) before it, of weight alone; CSV, too."""
    scene = """{heun: 1, space: planar, gravity: [0, -10], ground: {points: {O: [0, 5], a: [-0.5, 0], b: [0.5, 0]}},
      bodies: {sheave: {mass: 1, center: [0, 0], inertia: 1, points: {hub: [0, 0]}},
        cage: {mass: 3, center: [0, 0], inertia: 1, points: {top: [0, 0]}},
        weight: {mass: 1, center: [0, 0], inertia: 1, points: {top: [0, 0]}}},
      joints: {axle: {type: pin, from: ground.O, to: sheave.hub},
        rails: {type: slide, from: ground.a, to: cage.top, axis: [0, 1]},
        guide: {type: slide, from: ground.b, to: weight.top, axis: [0, 1]}},
      couplings: {hoist: {type: rope,
        through: [cage.top, {sheave: sheave.hub, radius: 0.5, slip: none}, weight.top]}}, analysis: {type: state}}"""
    found = heuncli.solve(text=scene, by_cause=True)
    assert float(found["couplings.hoist.shares.gravity.tension"]) == pytest.approx(30 * (1 - 2 / 8), rel=1e-12)
    assert float(found["couplings.hoist.shares.gravity.last_tension"]) == pytest.approx(10 * (1 + 2 / 8), rel=1e-12)
    assert any("hoist,tension," in line and line.endswith(",gravity") for line in found.to_csv().splitlines())
