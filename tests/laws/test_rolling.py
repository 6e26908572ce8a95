"""Laws of what rolls: the world turned, entries reordered, all faster; causes add up; rolling takes no power."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

from heuncli.results.results import Results
from tests.oracle.turns import random_rotation
from tests.shared.rolling_scenes import rolling_scene
from tests.shared.scenes import moving, near, solved

TIMES = (0.0, 0.1, 0.2)
SEEDS = (1, 2, 4)


def run(scene: dict[str, Any], times: tuple[float, ...] = TIMES, **options: Any) -> Results:
    """A scene's run over the instants."""
    return solved(moving(scene, times, 1e-11), **options)


def bare(seed: int) -> dict[str, Any]:
    """A random scene with wheels, its loads left out, and its velocities in world axes."""
    scene, state = rolling_scene(seed)
    bodies = {
        name: body | {"angular_velocity": state[name].angular_velocity.tolist()}
        for name, body in scene["bodies"].items()
    }
    return {key: value for key, value in scene.items() if key != "forces"} | {"bodies": bodies}


@pytest.mark.heavy
@pytest.mark.parametrize("seed", SEEDS)
def test_the_world_turned(seed: int) -> None:
    """Everything turns with it, what the plane exerts, too; its numbers stay."""
    scene = bare(seed)
    R = random_rotation(np.random.default_rng(seed))
    turned = scene | {
        "gravity": (R @ scene["gravity"]).tolist(),
        "ground": {"points": {name: (R @ p).tolist() for name, p in scene["ground"]["points"].items()}},
        "bodies": {name: turned_body(body, R) for name, body in scene["bodies"].items()},
    }
    rim = dict(scene["rolling"]["rim"])
    if body_of(rim["on"]) == "ground":
        rim |= {"on": turned_end(rim["on"], R), "normal": (R @ rim["normal"]).tolist()}
    turned["rolling"] = {"rim": rim}
    turned["joints"] = {name: turned_joint(joint, R) for name, joint in scene["joints"].items()}
    one, two = run(scene), run(turned)
    size = max(1.0, float(np.abs(one.couplings["rim"]["force"]).max()))
    for name in ("normal", "friction", "force"):
        near(two.couplings["rim"][name], one.couplings["rim"][name], size, 1e-8)
    near(two.couplings["rim"]["on"]["wheel"]["force"], one.couplings["rim"]["on"]["wheel"]["force"] @ R.T, size, 1e-8)


def turned_body(body: dict[str, Any], R: Any) -> dict[str, Any]:
    """A body of the turned world."""
    more = {key: (R @ body[key]).tolist() for key in ("position", "velocity", "angular_velocity")}
    return body | more | {"orientation": {"matrix": (R @ np.array(body["orientation"]["matrix"])).tolist()}}


def body_of(end: str | dict[str, Any]) -> str:
    """Whose point an end is."""
    return end.partition(".")[0] if isinstance(end, str) else str(end["body"])


def turned_end(end: str | dict[str, Any], R: Any) -> str | dict[str, Any]:
    """An end on the ground."""
    return end if isinstance(end, str) else end | {"at": (R @ end["at"]).tolist()}


def turned_joint(joint: dict[str, Any], R: Any) -> dict[str, Any]:
    """A joint of the turned world: its end on the ground has its axes in the world's."""
    found = dict(joint)
    for end, key, other in (("from", "axis", "to_axis"), ("to", "to_axis", "axis")):
        if body_of(joint[end]) == "ground":
            found[end] = turned_end(joint[end], R)
            if "axis" in joint:
                both = {"axis": joint["axis"], "to_axis": joint.get("to_axis", joint["axis"])}
                found |= {key: (R @ both[key]).tolist(), other: both[other]}
    return found


@pytest.mark.heavy
@pytest.mark.parametrize("seed", SEEDS)
def test_all_faster(seed: int) -> None:
    """Speeds c times, gravity c^2 times: the same ways in 1 / c of the time, loads c^2 times."""
    scene, c = bare(seed), 2.0
    faster = scene | {"gravity": (c**2 * np.array(scene["gravity"])).tolist()}
    faster["bodies"] = {
        name: body | {key: (c * np.array(body[key])).tolist() for key in ("velocity", "angular_velocity")}
        for name, body in scene["bodies"].items()
    }
    one, two = run(scene), run(faster, tuple(t / c for t in TIMES))
    size = max(1.0, float(np.abs(one.couplings["rim"]["force"]).max()))
    for name in ("normal", "friction", "force"):
        near(two.couplings["rim"][name] / c**2, one.couplings["rim"][name], size, 1e-8)
    near(two.bodies["wheel"]["position"], one.bodies["wheel"]["position"], 1.0, 1e-8)


@pytest.mark.parametrize("seed", SEEDS)
def test_bodies_in_another_order(seed: int) -> None:
    """Nothing hangs on it."""
    scene = bare(seed)
    other = scene | {
        "bodies": dict(reversed(scene["bodies"].items())),
        "joints": dict(reversed(scene["joints"].items())),
    }
    one, two = run(scene), run(other)
    size = max(1.0, float(np.abs(one.couplings["rim"]["force"]).max()))
    for name in ("normal", "friction", "force"):
        near(two.couplings["rim"][name], one.couplings["rim"][name], size, 1e-8)


@pytest.mark.parametrize("seed", SEEDS)
def test_causes_add_up_and_rolling_takes_no_power(seed: int) -> None:
    """The shares of the normal force; without loads the energies stay."""
    one = run(bare(seed), requested_reports=frozenset({"joints", "shares", "energy"}))
    own = one.couplings["rim"]
    size = max(1.0, float(np.abs(own["force"]).max()))
    near(sum(share["normal"] for share in own["shares"].values()), own["normal"], size, 1e-8)
    assert one.accuracy["energy_drift"] <= 1e-9
