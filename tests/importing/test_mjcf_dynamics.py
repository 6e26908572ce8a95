"""Random models of MuJoCo's, imported: their torques are those of its inverse dynamics, their motion is its own."""

from __future__ import annotations

import numpy as np
import pytest

from heuncli.scene.file_format.load import load
from heuncli.scene.importers.spec_text import format_spec
from heuncli.study.model.options import Options
from heuncli.study.workflow import solve
from tests.shared.imported import described, imported
from tests.shared.mjcf_trees import random_tree, words
from tests.shared.scenes import near

mujoco = pytest.importorskip("mujoco", reason="needs the package mujoco: pip install -e '.[test]'")
pytestmark = pytest.mark.heavy
REPORTS = frozenset({"motion", "joints"})


def key(model, q, v) -> str:
    return f'<keyframe><key name="start" qpos="{words(q)}" qvel="{words(v)}"/></keyframe>'


def random_state(model, rng):
    """Coordinates, rates and accelerations; of balls and free joints, quaternions of length 1."""
    v, a = rng.normal(size=model.nv), rng.normal(size=model.nv)
    q = np.array(model.qpos0)
    mujoco.mj_integratePos(model, q, rng.normal(size=model.nv), 1.0)
    return q, v, a


@pytest.mark.parametrize("seed", range(8))
def test_drives_hold_what_mujocos_inverse_dynamics_says(seed):
    rng = np.random.default_rng(seed)
    tree = random_tree(rng, 3 + seed, ("hinge", "slide"), loads=seed % 2 == 1)
    model = mujoco.MjModel.from_xml_string(tree.model())
    data = mujoco.MjData(model)
    q, v, a = random_state(model, rng)
    machine = described(tree.model(rest=key(model, q, v)), keyframe="start")
    accelerations = {model.joint(k).name: float(a[model.jnt_dofadr[k]]) for k in range(model.njnt)}
    drives = []
    for drive in machine.drives:
        joint, (coordinate, law) = drive.keys["joint"], list(drive.keys.items())[1]
        drives.append(drive._replace(keys={"joint": joint, coordinate: f"{law} + {accelerations[joint]!r}*t**2/2"}))
    assert len(drives) == model.nv and not machine.left_out
    study = solve(
        load("tree.yaml", format_spec(machine._replace(drives=tuple(drives)), "tree.yaml")),
        Options(requested_reports=REPORTS),
    )
    data.qpos[:], data.qvel[:], data.qacc[:] = q, v, a
    mujoco.mj_inverse(model, data)
    found = [study.results.joints[model.joint(k).name]["drive"][0] for k in range(model.njnt)]
    near(found, data.qfrc_inverse, float(np.abs(data.qfrc_inverse).max()), 1e-11)


@pytest.mark.parametrize("seed", range(8))
def test_what_is_let_go_accelerates_as_in_mujoco(seed):
    rng = np.random.default_rng(100 + seed)
    tree = random_tree(rng, 3 + seed, ("hinge", "slide", "ball", "free"), loads=seed % 2 == 1)
    model = mujoco.MjModel.from_xml_string(tree.model())
    data = mujoco.MjData(model)
    q, v, _ = random_state(model, rng)
    v[rng.random(model.nv) < 0.3] = 0.0  # a rate of 0 is one, where others are not
    text = imported(tree.model(rest=key(model, q, v)), keyframe="start", free=True)
    study = solve(load("tree.yaml", text), Options(requested_reports=REPORTS))
    data.qpos[:], data.qvel[:] = q, v
    mujoco.mj_forward(model, data)
    mujoco.mj_rnePostConstraint(model, data)
    size = float(np.abs(data.qacc).max())
    seen = 0
    for body in range(1, model.nbody):
        block = study.results.bodies.get(model.body(body).name.replace(" ", "_"))
        if block is None or model.body_mass[body] == 0.0:
            continue
        seen += 1
        found, moving = np.zeros(6), np.zeros(6)
        mujoco.mj_objectAcceleration(model, data, mujoco.mjtObj.mjOBJ_BODY, body, found, 0)
        mujoco.mj_objectVelocity(model, data, mujoco.mjtObj.mjOBJ_BODY, body, moving, 0)
        near(block["center"][0], data.xipos[body], 10.0, 1e-12)
        near(block["angular_velocity"][0], moving[:3], 10.0, 1e-12)
        near(block["center_velocity"][0], moving[3:], 10.0, 1e-12)
        near(block["angular_acceleration"][0], found[:3], size, 1e-10)
        near(block["center_acceleration"][0], found[3:] + model.opt.gravity, size, 1e-10)
    assert seen > 2
