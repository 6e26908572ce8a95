"""The oracle's blows against closed cases (manual/theory.md, "Closed cases" 6, 7, 12, 13, 15), momentum and energy."""

from __future__ import annotations

import numpy as np
import pytest

from tests.oracle.blows import with_blows
from tests.oracle.checks import SEEDS, close, some_scene
from tests.oracle.impulses import energy_jump, state_after, struck, struck_section, work_of_blow
from tests.oracle.masses import Plane, cut, mass_of
from tests.oracle.read import GROUND, start_state
from tests.oracle.rows import rates
from tests.oracle.solve import Solution
from tests.oracle.theory_scenes import bar, golden_a, scene, slider_crank
from tests.oracle.turns import about, cross, random_unit

X, Y, Z = np.eye(3)


def hit(s: dict, on: str, vector: object, **more: object) -> Solution:
    """The jump of a scene hit once, in its own state."""
    blown = {**s, "impulses": {"blow": {"on": on, "vector": np.asarray(vector, dtype=float).tolist(), **more}}}
    found = struck(blown, start_state(s))
    assert found.residual <= 1e-12 and found.unbalanced <= 1e-12
    return found


@pytest.mark.parametrize("h", [0.5, 2 / 3, 1.0])
def test_6_centre_of_percussion(h: float) -> None:
    s = scene({"rod": {"mass": 1.0, "center": [0.5, 0, 0], "inertia": [0.1, 0.75, 0.75],
                       "points": {"a": [0, 0, 0], "h": [h, 0, 0]}}},
              {"hinge": {"type": "pin", "from": "ground.O", "to": "rod.a", "axis": [0, 0, 1]}})  # fmt: skip
    found = hit(s, "rod.h", Y)
    assert found.angular_acceleration["rod"][2] == pytest.approx(h)
    close(found.foundation_force, (1 - h / 2) * Y)


SPINS = {1: (6.0,), 2: (-6 / 7, 30 / 7), 3: (3 / 13, -15 / 13, 57 / 13), 4: (-6 / 97, 30 / 97, -114 / 97, 426 / 97)}


@pytest.mark.parametrize("n", [2, 3, 4])
def test_7_rods_in_line(n: int) -> None:
    bodies = {f"r{k}": bar(1.0, 1.0, np.eye(3), at=np.array([k, 0.0, 0.0])) for k in range(n)}
    joints = {f"j{k}": {"type": "ball", "from": f"r{k - 1}.end" if k else "ground.O", "to": f"r{k}.root"}
              for k in range(n)}  # fmt: skip
    found = hit(scene(bodies, joints), f"r{n - 1}.end", Y)
    close([found.angular_acceleration[f"r{k}"][2] for k in range(n)], SPINS[n])
    close(found.foundation_force, {2: 1 / 7, 3: -1 / 26, 4: 1 / 97}[n] * Y)


def test_12_slider_crank() -> None:
    found = hit(slider_crank(1.0, 0.0), "slider.pin", X)
    assert found.angular_acceleration["crank"][2] == pytest.approx(-3.8605403703980, rel=1e-13)
    assert found.acceleration["slider"][0] == pytest.approx(0.3858064468756, rel=1e-12)
    dead = hit(slider_crank(0.0, 0.0), "slider.pin", X)
    close(dead.angular_acceleration["crank"], np.zeros(3))
    close(dead.reactions["base"].force, -X)  # of the ground on the crank: the whole blow
    assert hit(slider_crank(1e-3, 0.0), "slider.pin", X).angular_acceleration["crank"][2] == pytest.approx(
        -0.02222209, abs=5e-9)  # fmt: skip


def test_13_ladder() -> None:
    tilt = 0.9
    foot, head = np.array([np.sin(tilt), 0, 0]), np.array([0, 0, np.cos(tilt)])
    along = head - foot
    ladder = bar(1.0, 1.0, np.column_stack([along, Y, np.cross(along, Y)]), at=foot)
    ladder["points"]["middle"] = [0.5, 0, 0]
    s = scene({"ladder": ladder},
              {"floor": {"type": "plane", "from": "ground.O", "to": "ladder.root", "normal": [0, 0, 1]},
               "wall": {"type": "plane", "from": "ground.O", "to": "ladder.end", "normal": [1, 0, 0]}})  # fmt: skip
    found = hit(s, "ladder.middle", X)
    assert -found.angular_acceleration["ladder"] @ Y == pytest.approx(0.9324149524059966, rel=1e-13)
    assert found.reactions["floor"].force[2] == pytest.approx(-0.3651928615793232, rel=1e-13)
    assert found.reactions["wall"].force[0] == pytest.approx(-0.7102007855099077, rel=1e-13)


def test_15_golden_a() -> None:
    s = golden_a()
    s["bodies"]["second"]["points"]["struck"] = [0.9, 0, 0.3]
    found = hit(s, "second.struck", [1, 2, -1])
    close(found.angular_acceleration["first"], (-0.075483415174485, 0.286832574335682, -0.35626988279587))
    close(found.angular_acceleration["second"], (0.601966902494389, 0.350331061757914, 3.023242844532551))
    close(found.foundation_force, (0.580282235181806, 0.534667104935139, -0.142293727664147))
    close(-found.reactions["elbow"].force, (0.745935957786883, 0.283868374106259, -0.379308862538035))


@pytest.mark.parametrize("seed", SEEDS)
def test_momentum_energy_and_rates(seed: int) -> None:
    """The joints close at the rates after it; what the impulses and drives work is what the energy gains."""
    s, state = some_scene(seed)
    blown = with_blows(s, seed)
    found = struck(blown, state)
    size = max(1.0, *(float(np.abs(a).max()) for a in found.angular_acceleration.values()))
    after = state_after(blown, state, found)
    for opening in rates(blown, after).values():
        close(opening, np.zeros(len(opening)), 10 * size)
    work = work_of_blow(blown, state, found)
    assert energy_jump(blown, state, found) == pytest.approx(work, rel=1e-9, abs=1e-10 * size)
    ground = np.zeros(3)
    for name, r in found.reactions.items():
        spec = s["joints"][name]
        sides = [str(spec[k] if isinstance(spec[k], str) else spec[k]["body"]).split(".")[0] for k in ("from", "to")]
        if GROUND in sides:
            sign = -1.0 if sides[0] == GROUND else 1.0
            ground = ground + sign * (r.force + driven_force(s, state, name, r.drive))
    close(ground, found.foundation_force, 100.0)


def driven_force(s: dict, state: dict, name: str, drive: float) -> np.ndarray:
    """A driven slide's thrust is apart from what its guide carries."""
    spec = s["joints"][name]
    if spec["type"] not in ("slide", "cylinder"):
        return np.zeros(3)
    owner = spec["from"]["body"] if isinstance(spec["from"], dict) else spec["from"].split(".")[0]
    R = np.eye(3) if owner == GROUND else state[owner].rotation
    axis = np.array(spec["axis"], dtype=float)
    return drive * (R @ axis / np.linalg.norm(axis))


@pytest.mark.parametrize("seed", range(0, 12, 3))
def test_several_at_once_are_the_sum(seed: int) -> None:
    s, state = some_scene(seed, drives=0)
    blown = with_blows(s, seed)
    parts = [struck({**blown, "impulses": {n: one}}, state) for n, one in blown["impulses"].items()]
    whole = struck(blown, state)
    for name in s["bodies"]:
        sums = [sum(getattr(p, what)[name] for p in parts) for what in ("acceleration", "angular_acceleration")]
        close(whole.acceleration[name], sums[0], 10.0)
        close(whole.angular_acceleration[name], sums[1], 10.0)


@pytest.mark.parametrize("seed", range(8))
def test_a_cut_by_dalembert(seed: int) -> None:
    """On a chain of bodies, where all is certain: the impulses on the piece, less its momentum's jump."""
    s, state = some_scene(seed, masses="shapes", loops=0, drives=0, roots=0.0, n_bodies=1)
    blown = with_blows(s, seed, couples=False)
    rng = np.random.default_rng(seed)
    plane = Plane(0.2 * rng.standard_normal(3), random_unit(rng))
    found = struck(blown, state)
    there = struck_section(blown, state, 0.0, "b0", plane.at, plane.normal)
    back = struck_section(blown, state, 0.0, "b0", plane.at, -plane.normal)
    close(there.force + back.force, np.zeros(3), 10.0)
    close(there.moment + back.moment, np.zeros(3), 10.0)
    piece, b = cut(blown["bodies"]["b0"], plane)[1], state["b0"]
    P, c = b.point(plane.at), b.point(piece.center)
    turn = found.angular_acceleration["b0"]
    speed = found.acceleration["b0"] + cross(turn, c - b.point(mass_of(blown["bodies"]["b0"]).center))
    force = -piece.mass * speed
    moment = -cross(c - P, piece.mass * speed) - b.rotation @ piece.inertia @ b.rotation.T @ turn
    acting = [(p.place, p.force, p.couple) for parts in found.loads.values() for p in parts]
    acting += [(r.point, *sided(s, name, r.force, r.moment)) for name, r in found.reactions.items()]
    for place, F, M in acting:
        if (place - P) @ (b.rotation @ plane.normal) > 0:
            force, moment = force + F, moment + cross(place - P, F) + M
    close(there.force, force, 10.0)
    close(there.moment, moment, 10.0)


def sided(s: dict, name: str, F: np.ndarray, M: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """What a joint with the ground exerts on the body."""
    to = s["joints"][name]["to"]
    owner = to["body"] if isinstance(to, dict) else to.split(".")[0]
    return (-F, -M) if owner == GROUND else (F, M)


def test_a_rate_that_jumps() -> None:
    """A flywheel of 2 kg m2 set going at 3 rad/s takes 6 N m s, whose counter-couple the ground takes."""
    drive = (lambda t: 3.0 * t, lambda t: 3.0, lambda t: 0.0)
    s = scene({"w": {"mass": 1.0, "center": [0, 0, 0], "inertia": [1, 1, 2], "points": {"o": [0, 0, 0]},
                     "orientation": {"matrix": about(Z, 0.0).tolist()}}},
              {"shaft": {"type": "pin", "from": "ground.O", "to": "w.o", "axis": [0, 0, 1]}},
              drives={"motor": {"joint": "shaft", "angle": drive}})  # fmt: skip
    found = struck(s, start_state(s))
    assert found.reactions["shaft"].drive == pytest.approx(6.0)
    close(found.foundation_moment, -6.0 * Z)
    assert energy_jump(s, start_state(s), found) == pytest.approx(9.0)
    assert work_of_blow(s, start_state(s), found) == pytest.approx(9.0)
