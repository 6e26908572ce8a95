"""Open loads shared by elasticity, against the least elastic energy of dense equations, and in other units and axes.

    python -m tests.honesty.splits --cases 1000 [--seed FIRST]

prints what differs by more than rounding of the stiffnesses' ratios makes, and the largest difference.
"""

from __future__ import annotations

import sys
from collections.abc import Mapping
from typing import Any

import numpy as np

from heuncli.results.results import Results
from tests.oracle.read import state_at
from tests.oracle.solve import solve
from tests.oracle.tellings import TELLINGS, Telling
from tests.shared.doubles import redundant_scene
from tests.shared.hunts import asked_of
from tests.shared.scenes import solved

Array = np.ndarray[Any, np.dtype[np.float64]]
Stiffness = dict[str, tuple[Array, Array]]
WAYS = ("inches, pounds", "mm, t, ms", "turned", "renamed")
DECADES = 4  # that a scene's stiffnesses span
# Squares of displacements are minimised in roots of stiffnesses: of 16 digits, two are lost to a ratio of 1e4, and some
# three to how nearly the supports of random scenes depend on each other.
SAME = 1e-10


def stiff(scene: Mapping[str, Any], seed: int) -> Stiffness:
    """Stiffnesses of all joints along and about the axes of `from` [N/m, N m/rad]."""
    rng = np.random.default_rng([seed, 5])
    return {
        name: (10.0 ** rng.uniform(5, 5 + DECADES, 3), 10.0 ** rng.uniform(5, 5 + DECADES, 3))
        for name in scene["joints"]
    }


def elastic(scene: dict[str, Any], by: Stiffness, force: float = 1.0, length: float = 1.0) -> Results:
    """The scene's results with these stiffnesses, in units in which 1 N is called `force` and 1 m `length`."""
    joints = {
        name: {
            **joint,
            "stiffness": {
                "force": (by[name][0] * force / length).tolist(),
                "moment": (by[name][1] * force * length).tolist(),
            },
        }
        for name, joint in scene["joints"].items()
    }
    return solved({**scene, "joints": joints})


def against_the_oracle(scene: dict[str, Any], by: Stiffness, found: Results) -> float:
    """The largest difference of a joint's load, of the largest load."""
    exact = solve(scene, state_at(found.bodies, 0), stiffness=by)
    size = max(float(np.abs(r.force).max()) for r in exact.reactions.values())
    far = exact.length
    worst = 0.0
    for name, joint in found.joints.items():
        own = exact.reactions[name]
        worst = max(worst, float(np.abs(joint["force"][0] - own.force).max()))
        worst = max(worst, float(np.abs(joint["moment"][0] - own.moment).max()) / far)
    return worst / size


def told_again(told: Telling, by: Stiffness, found: Results) -> float:
    """The largest difference of the loads in another telling, of the largest load."""
    names = {name: told.joints.get(name, name) for name in found.joints}
    other = elastic(told.scene, {names[name]: k for name, k in by.items()}, told.force, told.length)
    size = max(float(np.abs(joint["force"]).max()) for joint in found.joints.values())
    far = max(float(np.abs(joint["moment"]).max()) for joint in found.joints.values())
    worst = 0.0
    for name, joint in found.joints.items():
        same = other.joints[names[name]]
        force, moment = same["force"][0] / told.force, same["moment"][0] / told.moment
        worst = max(worst, float(np.abs(told.Q.T @ force - joint["force"][0]).max()) / size)
        worst = max(worst, float(np.abs(told.Q.T @ moment - joint["moment"][0]).max()) / max(far, size))
    return worst


def differences(seed: int) -> dict[str, float]:
    """Of one scene, by what it is compared with; nothing where the drawing holds nothing twice."""
    scene = redundant_scene(seed)[1]
    by = stiff(scene, seed)
    found = elastic(scene, by)
    if "split" not in found.model:
        return {}
    out = {"oracle": against_the_oracle(scene, by, found)}
    way = WAYS[seed % len(WAYS)]
    told = TELLINGS[way](scene, np.random.default_rng(seed))
    if way == "turned":  # stiffnesses along the axes of bodies turn with these, those along the ground's do not
        by = {name: (np.full(3, k.max()), np.full(3, m.max())) for name, (k, m) in by.items()}
        found = elastic(scene, by)
    return {**out, way: told_again(told, by, found)}


def main() -> None:
    asked = asked_of("tests.honesty.splits", __doc__)
    worst: dict[str, float] = {}
    count = wrong = 0
    for seed in range(asked.seed, asked.seed + asked.cases):
        try:
            found = differences(seed)
        except Exception as error:  # a finding, too
            print(seed, repr(error)[:300])
            continue
        count += bool(found)
        for name, off in found.items():
            worst[name] = max(worst.get(name, 0.0), off)
            if not off <= SAME:
                wrong += 1
                print(f"{seed} {name}: off by {off:.3g} of the largest load")
    sys.stdout.write(f"{count} scenes, {wrong} differ; largest differences: {worst}\n")


if __name__ == "__main__":
    main()
