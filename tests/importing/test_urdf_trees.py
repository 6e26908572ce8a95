"""Random robots: imported, they are where their own kinematics has them, and as heavy, in every pose."""

from __future__ import annotations

import numpy as np
import pytest

from heuncli.scene.file_format.load import load
from heuncli.study.model.options import Options
from heuncli.study.workflow import solve
from tests.shared.imported import imported
from tests.shared.scenes import near
from tests.shared.urdf_trees import (
    MOVED,
    center_of,
    frames_at,
    holding_efforts,
    inertia_of,
    random_robot,
    urdf_text,
)

REPORTS = frozenset({"motion", "points", "joints"})


@pytest.mark.parametrize("seed", range(12))
@pytest.mark.third
def test_an_imported_robot_is_where_its_own_kinematics_has_it(seed):
    rng = np.random.default_rng(seed)
    robot = random_robot(rng, 3 + 4 * seed, right=seed % 3 == 2)
    text = imported(urdf_text(robot))
    q = {part.name: float(rng.uniform(-2, 2)) for part in robot.movable}
    spec = load("robot.yaml", text, overrides={f"to_{name}": f"{value!r}" for name, value in q.items()})
    results = solve(spec, Options(requested_reports=REPORTS)).results
    frames = frames_at(robot, q)
    size = max(float(np.abs(frame.origin).max()) for frame in frames.values()) + 1.0
    efforts = holding_efforts(robot, frames)
    heaviest = max(map(abs, efforts.values()), default=0.0) + 1.0
    assert {part.name for part in (robot.root, *robot.parts) if part.mass} == set(spec.bodies)
    for part in (robot.root, *robot.parts):
        if part.mass is None:
            (place,) = [block for name, block in results.points.items() if name.endswith(f".{part.name}")]
            near(place["position"][0], frames[part.name].origin, size, 1e-13)
            continue
        body, block = spec.bodies[part.name], results.bodies[part.name]
        assert body.mass == part.mass
        near(block["center"][0], center_of(part, frames), size, 1e-13)
        near(block["position"][0], frames[part.name].origin, size, 1e-13)
        R = block["rotation"][0]
        near(R @ np.array(body.inertia) @ R.T, inertia_of(part, frames), 0.05, 1e-13)
        if part.kind in MOVED and part is not robot.root:
            near(results.joints[part.joint]["drive"][0], efforts[part.name], heaviest, 1e-12)
