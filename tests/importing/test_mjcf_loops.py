"""Equalities of MuJoCo's, imported: loops close where MuJoCo says they do, and what drives them is d'Alembert's share.

Of a machine of coordinates q whose equalities leave q' = G u' (J G = 0, u the driven coordinates) the drives are
G^T tau, tau what MuJoCo's inverse dynamics of the open tree says of q, q', q'' as heun finds them.
"""

from __future__ import annotations

import re

import numpy as np
import pytest

from heuncli.scene.file_format.load import load
from heuncli.scene.importers.spec_text import format_spec
from heuncli.study.model.options import Options
from heuncli.study.workflow import solve
from tests.shared.imported import described
from tests.shared.mjcf_trees import random_tree, words
from tests.shared.scenes import near

mujoco = pytest.importorskip("mujoco", reason="needs the package mujoco: pip install -e '.[test]'")
pytestmark = pytest.mark.heavy
RATES = {"angle": "rate", "travel": "speed"}
POLE = (
    '<body name="pole" pos="0.5 2 1"><joint name="pole"/><geom size="0.1" pos="0 0 0.3"/>'
    '<site name="end" pos="0.4 0 0"/></body>'
)
DENSE = 'jacobian="dense"'


def closed(rng: np.random.Generator, names: list[str]) -> str:
    """One of each: a connect by a point, a rod, two couplings of which one hangs on the other; or a weld."""
    if rng.random() < 0.5:
        return f"""<tendon><spatial name="bar"><site site="wall"/><site site="end"/></spatial></tendon><equality>
            <connect name="closed" body1="b1" body2="b0" anchor="{words(rng.normal(size=3))}"/>
            <tendon tendon1="bar"/><joint joint1="{names[0]}" joint2="{names[1]}" polycoef="0.01 0.5 -2 0 0"/>
            <joint joint1="{names[2]}" joint2="{names[0]}" polycoef="-0.02 3 0 0.1 0"/>
            <joint joint1="{names[3]}" polycoef="0.03 0 0 0 0"/></equality>"""
    return '<equality><weld name="closed" body1="b0" body2="b1"/></equality>'


@pytest.mark.parametrize("seed", range(6))
def test_loops_close_and_are_driven_as_mujocos_own_rows_and_torques_say(seed):
    rng = np.random.default_rng(200 + seed)
    tree = random_tree(rng, 7, ("hinge", "slide"), loads=True)
    tree.text += POLE
    names = [name for name, _ in tree.joints]
    xml = tree.model(DENSE, closed(rng, names))
    model = mujoco.MjModel.from_xml_string(xml)
    data = mujoco.MjData(model)
    machine = described(xml)
    motions = {one.name: f"({one.name} + {rng.normal()!r}*t + {rng.normal()!r}*t**2)" for one in machine.parameters}
    drives = [
        drive._replace(
            keys={key: law if key == "joint" else with_motions(law, motions) for key, law in drive.keys.items()}
        )
        for drive in machine.drives
    ]
    moved = {
        parameter.name: f"{rng.normal() * 0.02 + _start(model, parameter.name)!r}" for parameter in machine.parameters
    }
    spec = load("loops.yaml", format_spec(machine._replace(drives=tuple(drives)), "loops.yaml"), overrides=moved)
    results = solve(spec, Options(requested_reports=frozenset({"motion", "joints"}))).results
    for number in range(model.njnt):
        name, at = model.joint(number).name, int(model.jnt_qposadr[number])
        block = results.coordinates[name]
        key = "angle" if "angle" in block else "travel"
        data.qpos[at] = block[key][0] + model.qpos0[at]
        data.qvel[at], data.qacc[at] = block[RATES[key]][0], block["acceleration"][0]
    acceleration = np.array(data.qacc)
    mujoco.mj_forward(model, data)
    J, gaps = np.array(data.efc_J).reshape(-1, model.nv)[: data.ne], np.array(data.efc_pos)[: data.ne]
    closing = np.array(
        [model.eq_type[number] != mujoco.mjtEq.mjEQ_JOINT for number in np.array(data.efc_id)[: data.ne]]
    )
    # couplings are drives, which have efforts of their own
    near(gaps, np.zeros(len(gaps)), 1.0, 1e-9)
    near(J @ data.qvel, np.zeros(len(gaps)), 1.0, 1e-8)
    J = J[closing]
    model.opt.disableflags |= int(mujoco.mjtDisableBit.mjDSBL_EQUALITY)
    data.qacc[:] = acceleration
    mujoco.mj_inverse(model, data)
    driven = [model.joint(str(drive.keys["joint"])).id for drive in machine.drives]
    _, s, V = np.linalg.svd(J)
    N = V[int((s > 1e-9).sum()) :].T
    G = N @ np.linalg.inv(N[driven])
    found = [results.joints[model.joint(number).name]["drive"][0] for number in driven]
    near(found, G.T @ data.qfrc_inverse, float(np.abs(data.qfrc_inverse).max() * np.abs(G).max()), 1e-9)


def with_motions(law: str, motions: dict[str, str]) -> str:
    """A law of drives with motions in the place of parameters."""
    return re.sub(r"[a-z]\w*", lambda found: motions.get(found[0], found[0]), law)


def _start(model, name: str) -> float:
    return float(model.qpos0[model.jnt_qposadr[model.joint(name).id]])
